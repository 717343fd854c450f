//! Leaders first (rule 13, engine I1): before an agent takes a step, whoever its flow reads has come beyond it.
//!
//! A leader runs ahead of its clock as far as its followers need it, and its own leaders before it; what it has run ahead
//! becomes its own step by step when its turn comes ([`crate::runtime::ahead`]). It does not run beyond a kink of its
//! flow: the lock that changes there is that of the present.

use rustc_hash::FxHashSet;

use crate::runtime::advance::{Advance, Stepper};
use crate::runtime::ahead::Way;
use crate::runtime::detect::CurveRows;
use crate::runtime::engine::Engine;
use crate::runtime::groups::Group;
use crate::runtime::population::Agents;
use crate::runtime::solve::leads_on;
use crate::runtime::solve::segment::Segment;

impl Engine<'_, '_> {
    /// The group that is to be advanced instead of one that lags most: it, or one of its leaders that stands at the same
    /// time at a kink.
    pub fn first_to_move(&self, number: usize) -> usize {
        let mut first = number;
        loop {
            let group = &self.groups.groups[first];
            let is_there = |&&leader: &&usize| !leads_on(group.clock, self.agents.known_until(leader));
            match group.leaders.iter().find(is_there) {
                Some(&leader) => first = self.agents.agents[leader].group,
                None => return first,
            }
        }
    }

    /// Has the leaders of a group run ahead until the next step of it, if it is as long as expected, can be taken.
    pub fn run_leaders_ahead(&mut self, number: usize) {
        let group = &self.groups.groups[number];
        if group.leaders.is_empty() || self.agents.agents[group.members[0]].ahead.last().is_some() {
            return;
        }
        let mut stuck: FxHashSet<usize> = FxHashSet::default();
        let mut waiting = vec![number];
        while let Some(&number) = waiting.last() {
            let group = &self.groups.groups[number];
            let from = self.agents.known_until(group.members[0]);
            let needed = from + group.integration.h.unwrap_or(0.0);
            let lags = |leader: usize| {
                let known = self.agents.known_until(leader);
                (known < needed || !leads_on(from, known)) && known < self.time_end
            };
            let of_leaders = group.leaders.iter().filter(|&&leader| lags(leader));
            let mut groups = of_leaders.map(|&leader| self.agents.agents[leader].group);
            if let Some(next) = groups.find(|next| !stuck.contains(next)) {
                waiting.push(next);
                continue;
            }
            waiting.pop();
            if !waiting.is_empty() && !self.run_ahead(number) {
                stuck.insert(number);
            }
        }
    }

    /// Has a group take a step beyond all that is known of it. False if it can take none now.
    fn run_ahead(&mut self, number: usize) -> bool {
        let group = &mut self.groups.groups[number];
        let from = self.agents.known_until(group.members[0]);
        let is_beyond = |&leader: &usize| leads_on(from, self.agents.known_until(leader));
        if !group.kinks.is_empty() || !group.leaders.iter().all(is_beyond) {
            return false;
        }
        self.stepper.run_ahead(&mut self.agents, group, &mut self.curves)
    }
}

impl Stepper {
    /// Takes a step of a group from as far as it is known. False, and nothing is done, if that is not possible.
    fn run_ahead(&mut self, agents: &mut Agents<'_>, group: &mut Group, curves: &mut CurveRows) -> bool {
        let clock = group.clock;
        let from = agents.known_until(group.members[0]);
        let mut kept: Vec<Way> = Vec::with_capacity(group.members.len());
        for &member in &group.members {
            let agent = &mut agents.agents[member];
            let states = agent.ahead.last().map_or(&agent.states, |way| &way.states).clone();
            let segment = std::mem::take(&mut agent.segment);
            kept.push(Way { segment, states: std::mem::replace(&mut agent.states, states) });
        }
        group.clock = from;
        let advance = self.step(agents, group, curves);
        if let Advance::Turned(hits) = &advance {
            for hit in hits {
                let lock = agents.flow(hit.agent).kinks[hit.kink].lock;
                agents.agents[hit.agent].aux[lock] = hit.before;
            }
        }
        let has_moved = advance == Advance::Moved;
        for (&member, now) in group.members.iter().zip(kept) {
            let agent = &mut agents.agents[member];
            let segment: Segment = std::mem::replace(&mut agent.segment, now.segment);
            let states = std::mem::replace(&mut agent.states, now.states);
            if has_moved {
                agent.ahead.push(Way { segment, states });
            }
        }
        group.clock = clock;
        has_moved
    }
}
