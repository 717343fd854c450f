//! Where agents get to before the lists of near pairs are made anew.
//!
//! Boxes of those who follow others rest on the boxes of these: whoever leaves its box takes its followers with it.

use rustc_hash::FxHashSet;

use crate::math::Interval;
use crate::runtime::engine::Engine;
use crate::runtime::neighbours::Way;

impl Engine<'_, '_> {
    /// Boxes of an agent's states from the present instant up to when the lists are made anew.
    pub fn way(&mut self, agent: usize) -> Way {
        if let Some(Some(way)) = self.neighbours.ways.get(agent) {
            return way.clone();
        }
        if !self.has_company(agent) {
            return self.way_alone(agent);
        }
        let mut ways = std::mem::take(&mut self.neighbours.ways);
        ways.resize(self.agents.len(), None);
        let mut waiting = vec![agent];
        while let Some(&next) = waiting.last() {
            let leaders = &self.groups.groups[self.agents.agents[next].group].leaders;
            let before = waiting.len();
            if ways[next].is_none() {
                waiting.extend(leaders.iter().filter(|&&leader| ways[leader].is_none()));
            }
            if waiting.len() == before {
                waiting.pop();
                if ways[next].is_none() {
                    self.lay(next, &mut ways);
                }
            }
        }
        let way = ways[agent].clone().unwrap_or_default();
        self.neighbours.ways = ways;
        way
    }

    /// The way of an agent, by those whom it follows.
    fn lay(&mut self, agent: usize, ways: &mut [Option<Way>]) {
        let span = (self.present.time, self.neighbours.until);
        let group = &self.groups.groups[self.agents.agents[agent].group];
        if group.leaders.is_empty() {
            ways[agent] = Some(self.way_alone(agent));
            return;
        }
        let agents = &self.agents;
        let leader = |agent: usize| ways[agent].as_deref();
        let boxes = self.enclosures.led(agents, group, &leader, span);
        let mut boxes = boxes.into_iter().flatten();
        for &member in &group.members {
            let n = agents.agents[member].states.len();
            ways[member] = Some((0..n).map(|_| boxes.next().unwrap_or(Interval::WHOLE)).collect());
        }
    }

    /// The way of an agent whose group follows nobody.
    fn way_alone(&mut self, agent: usize) -> Way {
        let span = (self.present.time, self.neighbours.until);
        let (agents, groups) = (&self.agents, &self.groups.groups);
        let mut states = Way::new();
        self.reaches.way(agents, groups, &mut self.enclosures, agent, span, &mut states);
        states
    }

    /// Whether an agent follows others, or may be followed: then its way is kept.
    fn has_company(&self, agent: usize) -> bool {
        let follows = !self.groups.groups[self.agents.agents[agent].group].leaders.is_empty();
        follows || self.agents.may_be_followed(agent)
    }

    /// The ways of some agents lead somewhere else from the present instant on. Returns them with those who follow them out of
    /// the boxes that they had.
    pub fn go_other_ways(&mut self, agents: &[usize]) -> Vec<usize> {
        let take = |ways: &mut Vec<Option<Way>>, agent: usize| ways.get_mut(agent).and_then(Option::take);
        let (mut all, mut known) = (agents.to_vec(), FxHashSet::from_iter(agents.iter().copied()));
        let before = agents.iter().map(|&agent| take(&mut self.neighbours.ways, agent));
        let mut before: Vec<Option<Way>> = before.collect();
        let mut next = 0;
        while next < all.len() {
            let (agent, old) = (all[next], before[next].take());
            next += 1;
            if !self.agents.may_be_followed(agent) {
                continue;
            }
            let new = self.way(agent);
            let is_within = |old: Way| {
                old.len() == new.len() && old.iter().zip(&new).all(|(old, &new)| old.encloses(new))
            };
            if old.is_some_and(is_within) {
                continue;
            }
            for follower in self.agents.followers(agent) {
                if known.insert(follower) {
                    all.push(follower);
                    before.push(take(&mut self.neighbours.ways, follower));
                }
            }
        }
        all
    }
}
