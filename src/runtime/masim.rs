//! Algorithm `masim`, plain form: every agent on its own clock, the one that lags most first, events in order of time.
//!
//! The loop keeps these promises (engine I1 to I4): every last segment covers the smallest clock, the *cover*; every
//! comparison is certified up to the cover before any agent is advanced beyond it, so that one segment an agent is
//! enough; an event is executed when nothing earlier can be found any more; what it writes is cut there.

use std::sync::atomic::{AtomicBool, Ordering};

use crate::codegen::kernel::Kernel;
use crate::codegen::program::{Atom, Relation, Trigger};
use crate::runtime::act::Written;
use crate::runtime::advance::{Advance, Obstacle};
use crate::runtime::detect::AtomCurve;
use crate::runtime::engine::{Due, Engine};
use crate::runtime::failure::{Failure, Reason};
use crate::runtime::guards::{Origin, closed};
use crate::runtime::instant::Candidate;
use crate::runtime::observe::{End, Progress};
use crate::runtime::population::{ABSENT, Slots};
use crate::runtime::present::Depth;
use crate::runtime::repetition::Finding;
use crate::runtime::solve::roots::{Curve, Known, Search, first_flip};
use crate::runtime::solve::{time_resolution, ulp};
use crate::runtime::truth::{self, Side, depth_read};

/// How many rounds of the loop pass between two looks at the interrupt flag.
const ROUNDS: u64 = 1024;

/// A run without an end that gets here will not stop by itself, s.
const ENDLESS: f64 = 1e15;

impl Engine<'_, '_> {
    /// Runs to the end.
    pub fn run(&mut self, interrupt: &AtomicBool) -> Result<End, Failure> {
        self.begin()?;
        let mut rounds: u64 = 0;
        loop {
            if let Some(stop) = self.stop.take() {
                return Ok(End::Stop { reason: stop.reason, agent: stop.agent, by: stop.by });
            }
            rounds += 1;
            if rounds.is_multiple_of(ROUNDS) {
                if interrupt.load(Ordering::Relaxed) {
                    let cover = self.cover().min(self.time_end);
                    self.present.go(cover.max(self.present.time));
                    return Ok(End::Interrupted);
                }
                self.tell_progress()?;
            }
            let cover = self.cover().min(self.time_end);
            self.certify_up_to(cover);
            let cause = self.next_cause();
            let sample = self.recorder.next();
            if sample < cause && sample <= cover {
                self.recorder.sample(&self.agents, &mut self.present, sample, self.observer)?;
            } else if cause <= self.time_end && (cause + time_resolution(cause)).min(self.time_end) <= cover {
                self.execute(cause)?;
            } else if cover >= self.time_end {
                return self.finish();
            } else if cover > ENDLESS {
                return Err(Reason::NeverEnds { time: cover }.into());
            } else {
                self.advance_laggard(cover)?;
            }
        }
    }

    /// Rule 6: groups, locks, entry actions, arming, micro-steps at t = 0.
    fn begin(&mut self) -> Result<(), Failure> {
        self.present.go(0.0);
        let all: Vec<usize> = (0..self.agents.len()).collect();
        self.set_locks(all.iter().copied());
        let mut written = Written::default();
        for group in self.groups.divide(&mut self.agents, &all, 0.0, &|_| None) {
            self.queue_clock(group);
        }
        for &agent in &all {
            let modes = &self.program.types[self.agents.agents[agent].ty].modes;
            let above =
                std::iter::successors(Some(self.agents.agents[agent].mode), |&mode| modes[mode].parent);
            let mut entered: Vec<usize> = above.collect();
            entered.reverse();
            self.run_entries(agent, &entered, &mut written)?;
        }
        self.set_locks(written.restarted.iter().copied());
        self.recorder.begin(&self.agents, &mut self.present, self.observer)?;
        self.arm_all()?;
        let instances = 0..self.guards.instances.len() as u32;
        let enabled = instances.clone().filter(|&instance| self.enabled(instance));
        let candidates = enabled.map(|instance| Candidate { instance, pulse: false }).collect();
        self.instant(candidates)?;
        let claims: Vec<u32> = instances
            .filter(|&instance| matches!(self.guards.definition(instance).origin, Origin::Claim(_)))
            .collect();
        self.judge_claims(&claims)
    }

    /// The end: the last rows, and the state of every agent at T (rule 12).
    fn finish(&mut self) -> Result<End, Failure> {
        if self.time_end == f64::INFINITY {
            return Err(Reason::NeverEnds { time: self.present.time }.into());
        }
        let end = self.time_end;
        for agent in 0..self.agents.len() {
            self.recorder.step(&self.agents, &mut self.present, agent, end, self.observer)?;
        }
        self.present.go(end);
        Ok(End::Until)
    }

    fn tell_progress(&mut self) -> Result<(), Failure> {
        let progress = Progress {
            time: self.cover().min(self.time_end),
            until: self.time_end,
            events: self.n_events,
            steps: self.stepper.counts.steps,
        };
        Ok(self.observer.progress(&progress)?)
    }

    /// The time of the next change of an atom or of the next scheduled time.
    fn next_cause(&mut self) -> f64 {
        let flips = &mut self.queues.flips;
        while flips.peek().is_some_and(|due| self.guards.atoms[due.number as usize].version != due.version) {
            flips.pop();
        }
        let schedules = &mut self.queues.schedules;
        while schedules
            .peek()
            .is_some_and(|due| self.guards.instances[due.number as usize].arming != due.version)
        {
            schedules.pop();
        }
        let time = |due: Option<&Due>| due.map_or(f64::INFINITY, |due| due.time);
        time(self.queues.flips.peek()).min(time(self.queues.schedules.peek()))
    }

    /// Certifies every atom up to the cover at least.
    fn certify_up_to(&mut self, cover: f64) {
        while let Some(&due) = self.queues.uncertified.peek() {
            if due.time >= cover {
                return;
            }
            self.queues.uncertified.pop();
            if self.guards.atoms[due.number as usize].version == due.version {
                self.certify(due.number as usize, false);
            }
        }
    }

    /// Looks once more at every atom that is certified up to the cover only: a root that is due within the resolution of
    /// time counts as being there.
    fn certify_at(&mut self, cover: f64) {
        let mut due_here = Vec::new();
        while let Some(due) = self.queues.uncertified.peek().copied().filter(|due| due.time <= cover) {
            self.queues.uncertified.pop();
            if self.guards.atoms[due.number as usize].version == due.version {
                due_here.push(due.number as usize);
            }
        }
        for index in due_here {
            self.certify(index, true);
        }
    }

    /// Certifies one atom on the stretch that all its agents' segments cover, or finds its next change there.
    fn certify(&mut self, index: usize, blocked: bool) {
        let (atom, slots) = self.guards.atom_slots(&self.agents, index);
        let from = self.guards.atoms[index].certified;
        let mut to = self.time_end;
        for &slot in &atom.slots {
            if slots[slot] != ABSENT {
                to = to.min(self.groups.groups[self.agents.agents[slots[slot]].group].clock);
            }
        }
        let kernel = self.program.kernel(atom.value);
        let absent = atom.slots.iter().any(|&slot| slots[slot] == ABSENT);
        if absent && truth::value(&self.agents, &mut self.present, atom.value, &slots).is_nan() {
            self.certified(index, self.time_end);
            return;
        }
        if depth_read(kernel) == Depth::States && !blocked {
            if let Some(until) = self.sleep(index, atom, kernel, &slots, from, to) {
                self.certified(index, until);
                return;
            }
        }
        let state = self.guards.atoms[index];
        let known = Known {
            truth: state.truth,
            closed: closed(atom.relation, state.truth),
            slack: state.slack,
            settled: state.settled,
            reach: if blocked { time_resolution(to) } else { 2.0 * ulp(to) },
        };
        let mut curve = AtomCurve::new(&self.agents, atom, &slots, &mut self.curves);
        match first_flip(&mut curve, from, to, known, self.limits.pieces_max) {
            Search::None => self.certified(index, to),
            Search::Flip(flip) => {
                self.n_undecided += u64::from(flip.undecided);
                let state = &mut self.guards.atoms[index];
                state.flip = flip.time;
                state.near = flip.near;
                state.touch = flip.undecided;
                state.version += 1;
                self.queues.flips.push(Due { time: flip.time, number: index as u32, version: state.version });
            }
        }
    }

    /// Notes that an atom does not change before `until`.
    fn certified(&mut self, index: usize, until: f64) {
        let state = &mut self.guards.atoms[index];
        if until > state.certified {
            state.slack = 0.0;
            state.settled = false;
        }
        state.certified = until;
        state.version += 1;
        if until < self.time_end {
            self.queues.uncertified.push(Due { time: until, number: index as u32, version: state.version });
        }
    }

    /// I6: how long an atom cannot change, if that is longer than its segments reach.
    fn sleep(
        &mut self,
        index: usize,
        atom: &Atom,
        kernel: &Kernel,
        slots: &Slots,
        from: f64,
        to: f64,
    ) -> Option<f64> {
        let used = &atom.slots;
        let state = &mut self.guards.atoms[index];
        if state.stride < 0.0 {
            // Not worth trying for a while.
            state.stride += 1.0;
            return None;
        }
        let truth = state.truth;
        let left = if self.time_end.is_finite() { self.time_end - from } else { 1e6 };
        let least = 2.0 * (to - from);
        let mut horizon = if state.stride > 0.0 { state.stride } else { left }.min(left);
        let mut here = None;
        for _ in 0..4 {
            if horizon <= least {
                break;
            }
            let bound = self.enclosures.value_range(
                &self.agents,
                &self.groups.groups,
                kernel,
                slots,
                used,
                from,
                horizon,
            );
            if bound.is_some_and(|bound| if truth { bound.hi < 0.0 } else { bound.lo > 0.0 }) {
                self.guards.atoms[index].stride = 2.0 * horizon;
                return Some((from + horizon).min(self.time_end));
            }
            // As far as a straight line from g here to the worst of the bound stays clear, with room.
            let here = *here.get_or_insert_with(|| {
                AtomCurve::new(&self.agents, atom, slots, &mut self.curves).jet(from)[0]
            });
            let worst = bound.map_or(f64::NAN, |bound| if truth { bound.hi } else { bound.lo });
            let share = 0.7 * here / (here - worst);
            horizon *= if share.is_finite() { share.clamp(1e-3, 0.25) } else { 0.2 };
        }
        self.guards.atoms[index].stride = -4.0;
        None
    }

    /// Applies the changes that are due at `first`, and executes the instant if something fires.
    fn execute(&mut self, first: f64) -> Result<(), Failure> {
        let window = first + time_resolution(first);
        let cover = self.cover().min(self.time_end);
        self.certify_up_to(window.min(cover));
        let flips = self.pop_flips(window);
        let schedules = self.pop_schedules(window);
        let seeds: Vec<u32> = flips
            .iter()
            .filter(|due| due.time == first)
            .map(|due| self.guards.atoms[due.number as usize].instance)
            .chain(schedules.iter().filter(|due| due.time == first).map(|due| due.number))
            .collect();
        let joins = |engine: &Self, instance: u32, time: f64| {
            time == first || seeds.iter().any(|&seed| engine.share_an_agent(seed, instance))
        };
        let (mut now, mut time) = (Vec::new(), first);
        for due in schedules {
            if joins(self, due.number, due.time) {
                time = due.time;
                now.push(due);
            } else {
                self.queues.schedules.push(due);
            }
        }
        let (mut changed, mut near) = (Vec::new(), first);
        for due in flips {
            let index = due.number as usize;
            if joins(self, self.guards.atoms[index].instance, due.time) {
                near = near.min(self.guards.atoms[index].near);
                changed.push(index);
            } else {
                self.queues.flips.push(due);
            }
        }
        if now.is_empty() {
            time = self.defined_side(time, near, &changed);
        }
        self.present.go(time);
        let mut concerned: Vec<u32> = Vec::new();
        for index in changed {
            self.flip(index);
            concerned.push(self.guards.atoms[index].instance);
        }
        let mut candidates = Vec::new();
        for due in now {
            concerned.push(due.number);
            candidates.extend(self.scheduled(due.number));
        }
        concerned.sort_unstable();
        concerned.dedup();
        let mut claims = false;
        for &instance in &concerned {
            if self.enabled(instance) {
                candidates.push(Candidate { instance, pulse: false });
            }
            claims |= matches!(self.guards.definition(instance).origin, Origin::Claim(_));
        }
        candidates.retain(|candidate| !candidate.pulse || self.truths().holds(candidate.instance, Side::At));
        if !candidates.is_empty() {
            self.instant(candidates)?;
        }
        if claims {
            self.judge_claims(&concerned)?;
        }
        for instance in concerned {
            self.calm(instance);
        }
        Ok(())
    }

    fn pop_flips(&mut self, window: f64) -> Vec<Due> {
        let mut flips = Vec::new();
        while let Some(&due) = self.queues.flips.peek() {
            if due.time > window {
                break;
            }
            self.queues.flips.pop();
            if self.guards.atoms[due.number as usize].version == due.version {
                flips.push(due);
            }
        }
        flips
    }

    fn pop_schedules(&mut self, window: f64) -> Vec<Due> {
        let mut schedules = Vec::new();
        while let Some(&due) = self.queues.schedules.peek() {
            if due.time > window {
                break;
            }
            self.queues.schedules.pop();
            if self.guards.instances[due.number as usize].arming == due.version {
                schedules.push(due);
            }
        }
        schedules
    }

    /// Rule 4: whether one writes what the other reads or writes (by agents).
    fn share_an_agent(&self, a: u32, b: u32) -> bool {
        let reads = |reader: u32, agent: usize| {
            let definition = self.guards.definition(reader);
            self.guards.slots(&self.agents, reader).contains(&agent)
                || definition.quantified.contains(&self.agents.agents[agent].ty)
        };
        let touches =
            |writer: u32, reader: u32| self.guards.roots(writer).iter().any(|&agent| reads(reader, agent));
        touches(a, b) || touches(b, a)
    }

    /// The true side of the roots, or the near side if the flows are not defined on the true one (rule 3).
    fn defined_side(&mut self, time: f64, near: f64, changed: &[usize]) -> f64 {
        if near >= time {
            return time;
        }
        let mut agents: Vec<usize> = Vec::new();
        for &index in changed {
            let instance = self.guards.atoms[index].instance;
            for agent in self.guards.roots(instance) {
                if !agents.contains(&agent) {
                    agents.push(agent);
                }
            }
        }
        let mut defined = |time: f64| {
            self.present.go(time);
            agents.iter().all(|&agent| {
                self.present.make(&self.agents, &[agent], Depth::Rates);
                self.present.rates(agent).iter().all(|rate| rate.is_finite())
            })
        };
        if !defined(time) && defined(near) { near } else { time }
    }

    /// Changes the truth of an atom at the present instant.
    fn flip(&mut self, index: usize) {
        let (atom, slots) = self.guards.atom_slots(&self.agents, index);
        let time = self.present.time;
        let jet = { AtomCurve::new(&self.agents, atom, &slots, &mut self.curves).jet(time) };
        let state = &mut self.guards.atoms[index];
        state.touched = match atom.relation {
            Relation::NonPositive => state.truth,
            Relation::Negative => false,
            Relation::Crossing => true,
        };
        state.truth = !state.truth;
        state.rooted = true;
        let slack = jet[1].abs() * time_resolution(time);
        self.recertify(index, time);
        let state = &mut self.guards.atoms[index];
        state.slack = if slack.is_finite() { slack } else { 0.0 };
        state.settled = !state.touch;
    }

    /// A scheduled time of an instance has come: its delay is over, or its period has passed once more.
    fn scheduled(&mut self, instance: u32) -> Option<Candidate> {
        let trigger = match self.guards.definition(instance).origin {
            Origin::Transition(transition) => &transition.trigger,
            Origin::Pair(pair) => &pair.transition.trigger,
            Origin::Claim(_) => return None,
        };
        let periodic = matches!(trigger, Trigger::Every { .. });
        let state = &mut self.guards.instances[instance as usize];
        if !periodic {
            state.aged = true;
            return None;
        }
        state.periods += 1;
        self.queue_schedule(instance);
        Some(Candidate { instance, pulse: true })
    }

    /// Advances the group that lags most.
    fn advance_laggard(&mut self, cover: f64) -> Result<(), Failure> {
        let Some(due) = self.queues.clocks.pop() else { return Ok(()) };
        let number = due.number as usize;
        if self.groups.groups[number].clock != due.time {
            return Ok(());
        }
        if self.recorder.wants_steps() {
            for k in 0..self.groups.groups[number].members.len() {
                let agent = self.groups.groups[number].members[k];
                self.recorder.step(&self.agents, &mut self.present, agent, cover, self.observer)?;
            }
        }
        if self.stepper.counts.steps + self.stepper.counts.rejected > self.limits.steps_max {
            return Err(Reason::StepLimit { time: cover, limit: self.limits.steps_max }.into());
        }
        let advance =
            self.stepper.advance(&mut self.agents, &mut self.groups.groups[number], &mut self.curves);
        self.queue_clock(number);
        match advance {
            Advance::Moved => Ok(()),
            Advance::Turned(hits) => {
                for hit in &hits {
                    if let Finding::Zeno(_) = self.repetitions.turned(hit.agent, hit.kink, cover) {
                        return Err(self.chattering(hit.agent, hit.kink, cover).into());
                    }
                }
                self.groups.groups[number].version += 1;
                let members = self.groups.groups[number].members.clone();
                self.doubt(&members, cover);
                Ok(())
            }
            Advance::Blocked(obstacle) => self.unblock(obstacle, cover),
        }
    }

    /// What reads these agents is certified no further than `time`.
    fn doubt(&mut self, agents: &[usize], time: f64) {
        for instance in self.reading(agents) {
            if !self.guards.instances[instance as usize].active {
                continue;
            }
            for index in self.guards.atom_range(instance) {
                let state = &self.guards.atoms[index];
                if state.certified > time && state.flip == f64::INFINITY {
                    self.recertify(index, time);
                }
            }
        }
    }

    /// I5: no step is possible. An event within the resolution of time may be what ends this flow; else the run fails.
    fn unblock(&mut self, obstacle: Obstacle, cover: f64) -> Result<(), Failure> {
        self.certify_at(cover);
        let cause = self.next_cause();
        if cause <= cover + time_resolution(cover) && cause <= self.time_end {
            return self.execute(cause);
        }
        let (agent, state, non_finite) = match obstacle {
            Obstacle::NonFinite { agent, state } => (agent, state, true),
            Obstacle::Underflow { agent, state } => (agent, state, false),
        };
        self.present.go(cover);
        let place = self.place(agent);
        let flow = self.agents.flow(agent);
        let name = self.program.types[self.agents.agents[agent].ty].states[state].name.clone();
        let span = flow.spans[state];
        if non_finite {
            return Err(Reason::FlowNotFinite { place, state: name, span }.into());
        }
        let fastest = crate::runtime::stiffness::fastest_rate(&self.agents, &mut self.present, agent);
        Err(Reason::StepUnderflow { place, state: name, fastest, span }.into())
    }

    fn chattering(&mut self, agent: usize, kink: usize, time: f64) -> Reason {
        self.present.go(time);
        let span = self.agents.flow(agent).kinks[kink].span;
        Reason::ChatteringKink { place: self.place(agent), count: self.limits.zeno_events, span }
    }
}
