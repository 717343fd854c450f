//! Who has to be looked at in a window of time: agents whose guards could change in it are *hot*, and take their steps in
//! the plain form; all others are cold.

use crate::runtime::engine::{Due, Engine};
use crate::runtime::leap::Covering;
use crate::runtime::population::ABSENT;

/// How often a comparison that is awake does not try to sleep.
const SKIP: u16 = 64;

/// How many agents are looked at in a window.
#[derive(Clone, Copy, Debug)]
pub struct Outlook {
    /// That take their steps in turn, and could be cold if no guard concerned them.
    pub n_hot: usize,
    /// Whose steps are kept.
    pub n_tracked: usize,
}

impl Engine<'_, '_> {
    /// Divides the agents for the window from the present to `until`, and advances the cold ones.
    pub fn open_window(&mut self, until: f64) -> Outlook {
        let from = self.present.time;
        self.agents.cold.clear_tracks();
        let doubtful = self.look_ahead(until);
        let changing = self.changing();
        let hot = std::mem::take(&mut self.hot);
        for agent in hot {
            if changing.binary_search(&agent).is_ok() || !self.freeze(agent) {
                self.hot.push(agent);
            }
        }
        for &agent in &changing {
            self.thaw(agent);
        }
        let mut doubted = Vec::new();
        for due in &doubtful {
            self.add_read(due.number as usize, &mut doubted);
        }
        for &agent in &doubted {
            self.agents.cold.want_track(agent);
        }
        let mut refused = Vec::new();
        let steps = self.agents.cold.advance(from, until, &mut |agent| refused.push(agent));
        self.count_cold(&steps);
        for agent in refused {
            self.thaw(agent);
        }
        let mut needed = Vec::new();
        for due in doubtful {
            let index = due.number as usize;
            if !self.foresee(index, until) {
                // Nor will it sleep by the boxes of its agents' groups.
                self.guards.atoms[index].skip = SKIP;
                self.add_read(index, &mut needed);
                self.queues.uncertified.push(due);
            }
        }
        for agent in needed {
            self.thaw(agent);
        }
        self.has_thawed = false;
        let rows = self.hot.iter().map(|&agent| &self.agents.agents[agent]);
        let n_hot = rows.filter(|row| self.agents.cold.may_be(row.ty, row.mode)).count();
        Outlook { n_hot, n_tracked: self.agents.cold.n_tracked() }
    }

    /// Has comparisons sleep beyond `until`; returns those that do not.
    fn look_ahead(&mut self, until: f64) -> Vec<Due> {
        let mut doubtful = Vec::new();
        while let Some(due) = self.queues.uncertified.peek().copied().filter(|due| due.time < until) {
            self.queues.uncertified.pop();
            let index = due.number as usize;
            if self.guards.atoms[index].version == due.version && !self.sleep_beyond(index, until) {
                doubtful.push(due);
            }
        }
        doubtful
    }

    /// The agents that comparisons read which will change, rising.
    fn changing(&self) -> Vec<usize> {
        let mut agents = Vec::new();
        for due in &self.queues.flips {
            self.add_read(due.number as usize, &mut agents);
        }
        agents.sort_unstable();
        agents.dedup();
        agents
    }

    /// Adds the agents that a comparison reads.
    fn add_read(&self, index: usize, agents: &mut Vec<usize>) {
        let (atom, slots) = self.guards.atom_slots(&self.agents, index);
        agents.extend(atom.slots.iter().map(|&slot| slots[slot]).filter(|&agent| agent != ABSENT));
        let instance = self.guards.atoms[index].instance;
        for &ty in if atom.folds.is_empty() { &[][..] } else { &self.guards.definition(instance).quantified }
        {
            agents.extend_from_slice(&self.agents.of_type[ty]);
        }
    }

    /// Has an agent run ahead alone, if its flow lets it. False if not.
    fn freeze(&mut self, agent: usize) -> bool {
        let row = &self.agents.agents[agent];
        let group = &mut self.groups.groups[row.group];
        if self.stepper.is_stiff(agent, row.mode)
            || group.members.len() != 1
            || !self.agents.followers(agent).is_empty()
            || !self.agents.cold.may_be(row.ty, row.mode)
            || group.clock == f64::INFINITY
        {
            return false;
        }
        self.agents.cold.freeze(agent, row.ty, row.mode, (group.clock, &row.states), &row.aux);
        group.clock = f64::INFINITY;
        group.integration.restart();
        true
    }

    /// Brings a cold agent back: its last segment covers the present again, and it takes its steps in turn.
    pub fn thaw(&mut self, agent: usize) {
        if !self.agents.cold.is_cold(agent) {
            return;
        }
        let time = self.present.time;
        let cold = &mut self.agents.cold;
        let row = &mut self.agents.agents[agent];
        let clock = if cold.knows(agent, time) {
            let covering = cold.follow(agent, time, &mut row.states, &mut row.segment);
            if let Some(Covering { h, ratio }) = covering {
                self.groups.groups[row.group].integration.note_accepted(row.segment.start, h, ratio);
            }
            row.segment.end
        } else {
            let (clock, states) = cold.known(agent);
            row.states.copy_from_slice(&states);
            clock
        };
        cold.thaw(agent);
        let number = row.group;
        self.groups.groups[number].clock = clock;
        self.groups.groups[number].integration.restart();
        self.queue_clock(number);
        self.hot.push(agent);
        self.has_thawed = true;
    }

    /// Counts the steps of cold agents, by herd.
    fn count_cold(&mut self, steps: &[u64]) {
        for (herd, &steps) in steps.iter().enumerate() {
            let (ty, n_rates, operations) = self.agents.cold.cost(herd);
            let counts = &mut self.stepper.counts;
            counts.steps += steps;
            counts.steps_of_type[ty] += steps;
            counts.rhs_evaluations += steps * n_rates;
            counts.operations += steps * operations;
        }
    }
}
