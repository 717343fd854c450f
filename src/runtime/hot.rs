//! Who has to be looked at in a window of time: agents whose guards could change in it are *hot*, and take their steps in
//! the plain form; all others are cold.

use crate::math::Interval;
use crate::runtime::agenda::Due;
use crate::runtime::engine::Engine;
use crate::runtime::leap::Covering;
use crate::runtime::population::ABSENT;

/// How often a comparison that is awake does not try to sleep.
const SKIP: u16 = 64;

/// How many agents are looked at in a window.
#[derive(Clone, Copy, Debug)]
pub struct Outlook {
    /// That took their steps in turn at the end of the last window, and could have been cold if no guard had concerned them.
    pub n_hot: usize,
    /// Whose steps are kept.
    pub n_tracked: usize,
}

impl Engine<'_, '_> {
    /// Divides the agents for the window from the present to `until`, and advances the cold ones.
    pub fn open_window(&mut self, until: f64) -> Outlook {
        self.agents.cold.clear_tracks();
        let rows = self.hot.iter().map(|&agent| &self.agents.agents[agent]);
        let n_hot = rows.filter(|row| self.agents.cold.may_be(row.ty, row.mode)).count();
        let doubtful = self.look_ahead(until);
        self.freeze_all();
        self.advance_cold(until);
        let doubtful = self.bound_doubts(doubtful, until);
        let mut doubted = Vec::new();
        for due in &doubtful {
            self.add_read(due.number as usize, &mut doubted);
        }
        doubted.into_iter().for_each(|agent| self.agents.cold.want_track(agent));
        let outlook = Outlook { n_hot, n_tracked: self.agents.cold.n_tracked() };
        let recorded = self.recorder.recorded_steps();
        recorded.iter().for_each(|&agent| self.agents.cold.want_track(agent));
        self.agents.cold.make_tracks(self.present.time, &self.crew);
        self.queue_steps(&recorded, until);
        self.follow_doubts(doubtful, until);
        self.has_thawed = false;
        outlook
    }

    /// Has the steps of cold agents written that end in the window from the present to `until`.
    fn queue_steps(&mut self, recorded: &[usize], until: f64) {
        let now = self.present.time;
        self.queues.steps.clear();
        for &agent in recorded {
            // The last step before it ran ahead may end in the window, too; a row that has been written is not written again.
            let is_here = |&time: &f64| now <= time && time <= until && time < self.time_end;
            let joints = self.agents.cold.joints(agent).filter(is_here);
            let due = |time| Due { time, number: agent as u32, version: 0 };
            self.queues.steps.extend(joints.map(due));
        }
    }

    /// When the next step of a cold agent ends of which every step is recorded, s.
    pub fn next_step(&mut self) -> f64 {
        let Self { queues, agents, .. } = self;
        // One that has just been brought back may be on the step that begins there.
        let is_there = |due: &Due| {
            let agent = due.number as usize;
            agents.cold.is_cold(agent) || agents.agents[agent].segment.start == due.time
        };
        while queues.steps.peek().is_some_and(|due| !is_there(due)) {
            queues.steps.pop();
        }
        queues.steps.peek().map_or(f64::INFINITY, |due| due.time)
    }

    /// Has all hot agents run ahead but those whose flow does not let them, and those that comparisons read which will change.
    fn freeze_all(&mut self) {
        let changing = self.changing();
        for agent in std::mem::take(&mut self.hot) {
            if changing.binary_search(&agent).is_ok() || !self.freeze(agent) {
                self.hot.push(agent);
            }
        }
        changing.into_iter().for_each(|agent| self.thaw(agent));
    }

    /// Advances the cold agents to `until`; those that can go no further, or may be stiff, are brought back.
    fn advance_cold(&mut self, until: f64) {
        let mut back = Vec::new();
        let from = self.present.time;
        let steps = self.agents.cold.advance((from, until), &self.crew, &mut |agent, look| {
            back.push((agent, look));
        });
        self.count_cold(&steps);
        for (agent, look) in back {
            if look && !self.stepper.has_choice() {
                continue;
            }
            self.thaw(agent);
            if look {
                let group = self.agents.agents[agent].group;
                self.groups.groups[group].integration.switch.ask();
            }
        }
    }

    /// Certifies doubtful comparisons by bounds of their agents over the window; returns those that it does not.
    fn bound_doubts(&mut self, mut doubtful: Vec<Due>, until: f64) -> Vec<Due> {
        doubtful.retain(|due| !self.foresee_by_bounds(due.number as usize, until));
        doubtful
    }

    /// Certifies doubtful comparisons by the tracks of their agents, as far as they go.
    fn follow_doubts(&mut self, doubtful: Vec<Due>, until: f64) {
        for due in doubtful {
            let index = due.number as usize;
            if self.is_bounded(index) {
                if self.foresee(index, until) {
                    continue;
                }
            } else {
                self.queues.uncertified.push(due);
            }
            // Nor will it sleep by the boxes of its agents' groups.
            self.guards.atoms[index].skip = SKIP;
        }
    }

    /// Has comparisons sleep beyond `until`; returns those that do not.
    fn look_ahead(&mut self, until: f64) -> Vec<Due> {
        let Self { queues, guards, .. } = self;
        let mut due = queues.uncertified.take_before(until);
        due.retain(|due| guards.atoms[due.number as usize].version == due.version);
        due.sort_unstable_by_key(|due| due.number);
        due.retain(|due| !self.sleep_beyond(due.number as usize, until));
        due
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
        if self.is_exposed(agent) {
            return false;
        }
        let row = &self.agents.agents[agent];
        let group = &mut self.groups.groups[row.group];
        if self.stepper.is_stiff(agent, row.mode)
            || group.integration.switch.is_asked()
            || group.members.len() != 1
            || !self.agents.followers(agent).is_empty()
            || !self.agents.cold.may_be(row.ty, row.mode)
            || group.clock == f64::INFINITY
        {
            return false;
        }
        let (clock, now, segment) = (group.clock, self.present.time, &row.segment);
        let bounds = row.states.iter().enumerate().map(|(state, &x)| {
            let here = Interval { lo: x, hi: x };
            if clock <= now { here } else { here.hull(segment.range(state, now.max(segment.start), clock)) }
        });
        self.agents.cold.freeze(agent, (row.ty, row.mode), (clock, &row.states), &row.aux, bounds);
        group.clock = f64::INFINITY;
        group.integration.restart();
        true
    }

    /// Brings a cold agent back: its last segment covers the present again, and it takes its steps in turn.
    pub fn thaw(&mut self, agent: usize) {
        self.thaw_at(agent, self.present.time);
    }

    /// The same for what happens from `time` on; nothing does between the present and that.
    pub fn thaw_at(&mut self, agent: usize, time: f64) {
        if !self.agents.cold.is_cold(agent) {
            return;
        }
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
