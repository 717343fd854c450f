//! Algorithm `masim`, plain form: every agent on its own clock, the one that lags most first, events in order of time.
//!
//! The loop keeps these promises (engine I1 to I4): every last segment covers the smallest clock, the *cover*; every
//! comparison is certified up to the cover before any agent is advanced beyond it, so that one segment an agent is
//! enough; an event is executed when nothing earlier can be found any more; what it writes is cut there.

use crate::base::Span;
use crate::codegen::program::Kink;
use crate::runtime::act::Written;
use crate::runtime::advance::{Advance, Obstacle};
use crate::runtime::agenda::Due;
use crate::runtime::certify::{ENDLESS, may_touch};
use crate::runtime::engine::Engine;
use crate::runtime::failure::{Failure, Reason};
use crate::runtime::groups::KinkHit;
use crate::runtime::guards::Origin;
use crate::runtime::instant::{By, Candidate};
use crate::runtime::observe::{End, Progress};
use crate::runtime::present::Depth;
use crate::runtime::repetition::Finding;
use crate::runtime::solve::time_resolution;
use crate::runtime::stiffness::fastest_rate;

/// How many rounds of the loop pass between two reports of progress.
const ROUNDS: u64 = 1024;

impl Engine<'_, '_> {
    /// Runs to the end.
    pub fn run(&mut self) -> Result<End, Failure> {
        self.begin()?;
        match self.run_until(self.time_end)? {
            Some(end) => Ok(end),
            None => self.finish(),
        }
    }

    /// Runs until all is known up to `until`, s; or to an end that comes before.
    pub fn run_until(&mut self, until: f64) -> Result<Option<End>, Failure> {
        let mut rounds: u64 = 0;
        loop {
            if let Some(stop) = self.stop.take() {
                return Ok(Some(stop.end()));
            }
            rounds += 1;
            if rounds.is_multiple_of(ROUNDS) {
                self.tell_progress()?;
                self.compact_queues();
            }
            let cover = self.cover().min(until);
            self.certify_up_to(cover);
            self.expose_up_to(cover)?;
            if self.interrupted() {
                // Tables are complete up to there.
                let told = self.recorder.next().min(self.next_step()).max(self.present.time);
                let known = self.known_until(cover).min(told);
                self.present.go(known);
                return Ok(Some(End::Interrupted));
            }
            if std::mem::take(&mut self.has_thawed) {
                continue;
            }
            let cause = self.next_cause();
            self.watch_up_to(cover.min(cause));
            let (sample, step) = (self.recorder.next(), self.next_step());
            if step < cause && step <= cover && step <= sample {
                self.record_step()?;
            } else if sample < cause && sample <= cover {
                self.recorder.sample(&self.agents, &mut self.present, sample, self.observer)?;
            } else if cause < f64::INFINITY
                && cause <= self.time_end
                && (cause + self.event_tolerance(cause)).min(self.time_end) <= cover
            {
                self.execute(cause)?;
            } else if cover >= until {
                return Ok(None);
            } else if cover > ENDLESS {
                self.present.go(cover);
                return Err(Reason::NeverEnds { time: cover, until: self.time_end }.into());
            } else {
                self.advance_laggard(cover)?;
            }
        }
    }

    /// Writes the row of the step of a cold agent that ends next.
    fn record_step(&mut self) -> Result<(), Failure> {
        let Some(due) = self.queues.steps.pop() else { return Ok(()) };
        self.recorder.step(&self.agents, &mut self.present, due.number as usize, due.time, self.observer)
    }

    /// Rule 6: groups, locks, entry actions, arming, micro-steps at t = 0.
    pub fn begin(&mut self) -> Result<(), Failure> {
        self.present.go(0.0);
        let all = self.agents.living();
        self.place_all();
        self.set_links(&all);
        self.set_locks(all.iter().copied());
        let mut written = Written::default();
        for group in self.groups.divide(&mut self.agents, &all, 0.0, &|_| None) {
            self.queue_clock(group);
        }
        let entries: Vec<(usize, &[usize])> =
            all.iter().map(|&agent| (agent, self.agents.mode(agent).active.as_slice())).collect();
        self.run_entries(&entries, &mut written)?;
        self.turn_over(&mut written)?;
        self.regroup(&mut written);
        self.end_lives();
        self.set_locks(written.restarted.iter().copied());
        self.recorder.begin(&self.agents, &mut self.present, self.observer)?;
        self.begin_lists()?;
        self.arm_all()?;
        let instances = 0..self.guards.instances.len() as u32;
        self.refresh_links(&instances.clone().collect::<Vec<u32>>())?;
        let enabled = instances.clone().filter(|&instance| self.enabled(instance));
        let candidates = enabled.map(|instance| Candidate { instance, by: By::Guard }).collect();
        self.instant(candidates)?;
        let claims: Vec<u32> = instances
            .filter(|&instance| matches!(self.guards.definition(instance).origin, Origin::Claim(_)))
            .collect();
        self.judge_claims(&claims, &[])?;
        let all: Vec<u32> = (0..self.guards.instances.len() as u32).collect();
        self.set_gates(&all)
    }

    /// Up to when nothing happens that has not been carried out, s; not beyond the cover.
    fn known_until(&mut self, cover: f64) -> f64 {
        let certified = self.queues.uncertified.from();
        let exposed = self.queues.exposed.peek().map_or(f64::INFINITY, |due| due.time);
        cover.min(certified).min(exposed).min(self.next_cause()).max(self.present.time)
    }

    /// The end: the last rows, and the state of every agent at T (rule 12).
    pub fn finish(&mut self) -> Result<End, Failure> {
        if self.time_end == f64::INFINITY {
            return Err(Reason::NeverEnds { time: self.present.time, until: self.time_end }.into());
        }
        let end = self.time_end;
        for agent in self.agents.living() {
            self.recorder.step(&self.agents, &mut self.present, agent, end, self.observer)?;
        }
        self.present.go(end);
        Ok(End::Until)
    }

    /// Tells how far the run has come.
    pub fn tell_progress(&mut self) -> Result<(), Failure> {
        let progress = Progress {
            time: self.cover().min(self.time_end),
            until: self.time_end,
            agents: self.agents.len() as u64,
            events: self.n_events,
            steps: self.stepper.counts.steps,
        };
        self.tell_undecided()?;
        Ok(self.observer.progress(&progress)?)
    }

    /// Advances the group that lags most.
    pub fn advance_laggard(&mut self, cover: f64) -> Result<(), Failure> {
        let Some(due) = self.queues.clocks.pop() else { return Ok(()) };
        let lagging = due.number as usize;
        if self.groups.groups[lagging].clock != due.time {
            return Ok(());
        }
        let number = self.first_to_move(lagging);
        if number != lagging {
            self.queue_clock(lagging);
        }
        self.run_leaders_ahead(number);
        if self.recorder.wants_steps() {
            for k in 0..self.groups.groups[number].members.len() {
                let agent = self.groups.groups[number].members[k];
                self.recorder.step(&self.agents, &mut self.present, agent, cover, self.observer)?;
            }
        }
        if self.stepper.counts.steps + self.stepper.counts.rejected > self.limits.steps_max {
            self.present.go(cover);
            let place = self.place(self.groups.groups[number].members[0]);
            return Err(Reason::StepLimit { place, limit: self.limits.steps_max }.into());
        }
        let advance =
            self.stepper.advance(&mut self.agents, &mut self.groups.groups[number], &mut self.curves);
        self.queue_clock(number);
        match advance {
            Advance::Moved => Ok(()),
            Advance::Turned(hits) => {
                self.present.forget();
                let mut chattering = None;
                for hit in &hits {
                    if let Finding::Zeno(_) = self.repetitions.turned(hit.agent, hit.kink, cover) {
                        chattering = chattering.or(Some(hit));
                    }
                }
                self.groups.groups[number].version += 1;
                let members = self.groups.groups[number].members.clone();
                members.iter().for_each(|&member| self.agents.divert(member));
                self.doubt(&members, cover);
                self.relist_turned(&members, cover)?;
                match chattering {
                    None => Ok(()),
                    // What the flow reaches where it turns back may be what ends it.
                    Some(_) if self.touches_by(cover, &members) => {
                        let cause = self.next_cause();
                        self.execute(cause)
                    }
                    Some(hit) => Err(self.chattering(hit, cover).into()),
                }
            }
            Advance::Blocked(obstacle) => self.unblock(number, obstacle, cover),
        }
    }

    /// Whether what comes next comes up to `time`, and is that a comparison of some of these agents touches its boundary.
    fn touches_by(&mut self, time: f64, members: &[usize]) -> bool {
        let cause = self.next_cause();
        let touches = |due: &Due| {
            let (atom, slots) = self.guards.atom_slots(&self.agents, due.number as usize);
            atom.slots.iter().any(|&slot| members.contains(&slots[slot]))
                && may_touch(atom, &self.guards.atoms[due.number as usize])
        };
        cause <= time && self.queues.flips.peek().is_some_and(touches)
    }

    /// I5: no step is possible. An event within the resolution of time may be what ends this flow; else the run fails.
    fn unblock(&mut self, group: usize, obstacle: Obstacle, cover: f64) -> Result<(), Failure> {
        self.certify_at(cover);
        let cause = self.next_cause();
        if cause <= cover + time_resolution(cover) && cause <= self.time_end {
            return self.execute(cause);
        }
        let crept =
            self.stepper.creep_to_kinks(&mut self.agents, &mut self.groups.groups[group], &mut self.curves);
        if crept {
            self.queue_clock(group);
            return Ok(());
        }
        self.present.go(cover);
        Err(match obstacle {
            Obstacle::NonFinite { agent, state, made } => {
                let (state, span) = self.equation(agent, state);
                Reason::FlowNotFinite { place: self.place(agent), state, made, span }.into()
            }
            Obstacle::Underflow { agent, state } => {
                let fastest = fastest_rate(&self.agents, &mut self.present, agent);
                self.present.make(&self.agents, &[agent], Depth::Rates);
                let rate = self.present.rates(agent)[state];
                let (state, span) = self.equation(agent, state);
                Reason::StepUnderflow { place: self.place(agent), state, rate, fastest, span }.into()
            }
        })
    }

    /// The name of a state, and where its equation stands.
    fn equation(&self, agent: usize, state: usize) -> (String, Span) {
        let system = &self.program.types[self.agents.agents[agent].ty];
        (system.state_name(state), self.agents.flow(agent).spans[state])
    }

    fn chattering(&mut self, hit: &KinkHit, time: f64) -> Reason {
        self.present.go(time);
        let agent = hit.agent;
        let Kink { lock, span, .. } = self.agents.flow(agent).kinks[hit.kink];
        let rates = [hit.before, hit.lock].map(|side| {
            self.agents.agents[agent].aux[lock] = side;
            self.present.forget();
            self.named_rates(agent)
        });
        Reason::ChatteringKink { place: self.place(agent), count: self.limits.zeno_events, rates, span }
    }

    /// `x' = 1, y' = -2`
    fn named_rates(&mut self, agent: usize) -> String {
        self.present.make(&self.agents, &[agent], Depth::Rates);
        let states = &self.program.types[self.agents.agents[agent].ty].states;
        let named = states.iter().zip(self.present.rates(agent));
        named.map(|(state, rate)| format!("{}' = {rate}", state.name)).collect::<Vec<_>>().join(", ")
    }
}
