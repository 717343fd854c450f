//! One step of one group: try, judge, keep; and stop it at the first kink of a flow (rule 15).
//!
//! A step never spans a kink: the flow holds its branches locked during a step, the surfaces at which a branch changes
//! are searched on the dense output, and the step is cut at the first of them. The lock changes when the group is next
//! advanced, so that an event before the kink can still undo it.

use rustc_hash::FxHashSet;

use crate::codegen::trace::Blame;
use crate::runtime::ahead::Way;
use crate::runtime::counts::Counts;
use crate::runtime::detect::CurveRows;
use crate::runtime::flow::{GroupFlow, Witness};
use crate::runtime::groups::{Group, KinkHit};
use crate::runtime::kinks::{kink_time, kinks_at_hand, turn};
use crate::runtime::limits::Limits;
use crate::runtime::population::{Agent, Agents};
use crate::runtime::solve::control::Accuracy;
use crate::runtime::solve::integrate::{Integrator, Stuck};
use crate::runtime::solve::method::{Flow as _, Stretch};
use crate::runtime::solve::switch::{Regime, Switch};
use crate::runtime::solve::{MethodName, Methods};

/// What became of an attempt to advance a group.
#[derive(Clone, Debug, PartialEq)]
pub enum Advance {
    /// Its clock has moved.
    Moved,
    /// Kinks were at its clock already: their locks have changed, the clock has not moved.
    Turned(Vec<KinkHit>),
    /// No step is possible from here.
    Blocked(Obstacle),
}

/// Why no step is possible.
#[derive(Clone, Debug, PartialEq)]
pub enum Obstacle {
    /// The flow is not a finite number at the clock or just after it.
    NonFinite {
        /// Whose.
        agent: usize,
        /// Which state.
        state: usize,
        /// What made it so, and when, s.
        made: Option<(f64, Blame)>,
    },
    /// The step needed for the accuracy is below the resolution of time.
    Underflow {
        /// Whose state is hardest.
        agent: usize,
        /// Which state.
        state: usize,
    },
}

/// Takes the steps; owns their scratch space.
pub struct Stepper {
    integrator: Integrator,
    methods: Methods,
    /// The agents and modes whose flows were stiff when they last moved by them.
    stiff: FxHashSet<(usize, usize)>,
    /// What steps are accepted by.
    pub accuracy: Accuracy,
    pieces_max: u32,
    x: Vec<f64>,
    /// What steps took so far.
    pub counts: Counts,
    absent: Vec<f64>,
}

impl Stepper {
    /// A stepper by these methods up to `time_end`.
    pub fn new(
        agents: &Agents<'_>,
        methods: Methods,
        accuracy: Accuracy,
        time_end: f64,
        limits: &Limits,
    ) -> Self {
        let steps_of_type = vec![0; agents.program.types.len()];
        let counts = Counts { steps_of_type, steps_of: vec![0; agents.len()], ..Counts::default() };
        Self {
            integrator: Integrator::new(methods, accuracy, time_end),
            methods,
            stiff: FxHashSet::default(),
            accuracy,
            pieces_max: limits.pieces_max,
            x: Vec::new(),
            counts,
            absent: vec![f64::NAN; agents.row_width()],
        }
    }

    /// Whether the method is chosen by what the flow is like.
    pub fn has_choice(&self) -> bool {
        matches!(self.methods, Methods::Automatic(_))
    }

    /// Whether the flow of an agent in a mode was stiff when it last moved by it.
    pub fn is_stiff(&self, agent: usize, mode: usize) -> bool {
        self.stiff.contains(&(agent, mode))
    }

    /// Another agent has the place of one that is dead.
    pub fn forget(&mut self, place: usize) {
        let steps_of = &mut self.counts.steps_of;
        steps_of.resize(steps_of.len().max(place + 1), 0);
        steps_of[place] = 0;
        if !self.stiff.is_empty() {
            self.stiff.retain(|&(agent, _)| agent != place);
        }
    }

    /// Advances a group by one step, taken now or before; it may end early at a kink.
    pub fn advance(&mut self, agents: &mut Agents<'_>, group: &mut Group, curves: &mut CurveRows) -> Advance {
        if take_ahead(agents, group) {
            return Advance::Moved;
        }
        if !group.kinks.is_empty() {
            let hits = std::mem::take(&mut group.kinks);
            turn(agents, &hits);
            group.integration.restart();
            return Advance::Turned(hits);
        }
        if group.clock == f64::INFINITY {
            return Advance::Moved;
        }
        if let [agent] = group.members[..]
            && retake(agents, agent, group)
        {
            return Advance::Moved;
        }
        self.step(agents, group, curves)
    }

    /// Takes a step of a group from its clock.
    pub fn step(&mut self, agents: &mut Agents<'_>, group: &mut Group, curves: &mut CurveRows) -> Advance {
        let step_max = self.integrator.step_max;
        let led_until = led_until(agents, group);
        let known = led_until - group.clock;
        let wanted = group.integration.h;
        self.integrator.step_max = step_max.min(known);
        let accepted = self.accepted_step(agents, group);
        self.integrator.step_max = step_max;
        match accepted {
            Ok(mut stretch) => {
                if stretch.h >= known {
                    stretch.end = led_until;
                }
                if let (Some(wanted), Some(next)) = (wanted, &mut group.integration.h)
                    && stretch.h >= known
                {
                    // It was the leader's way that ended, not the accuracy.
                    *next = next.max(wanted);
                }
                let start = group.clock;
                self.keep(agents, group, &stretch);
                let advance = self.stop_at_kinks(agents, group, curves);
                let is_cut = advance == Advance::Moved && group.clock < stretch.end;
                if is_cut && self.is_by_stiff_method() && self.is_judged_beyond(agents, group) {
                    return self.step_again(agents, group, curves, start);
                }
                advance
            }
            Err(stuck) => Advance::Blocked(self.culprit(agents, group, stuck)),
        }
    }

    fn is_by_stiff_method(&self) -> bool {
        match self.methods {
            Methods::One(name) => name == MethodName::Stiff,
            Methods::Automatic(_) => self.integrator.regime() == Regime::Stiff,
        }
    }

    /// Whether the last step, which a kink has cut, was accepted by states at its end that are much larger than where it is cut.
    fn is_judged_beyond(&self, agents: &Agents<'_>, group: &Group) -> bool {
        let here = group.members.iter().flat_map(|&member| &agents.agents[member].states);
        self.x.iter().zip(&self.integrator.trial.x_new).zip(here).any(|((start, end), here)| {
            let allowed = |x: &f64| self.accuracy.allowed(start.abs().max(x.abs()));
            allowed(end) > 2.0 * allowed(here)
        })
    }

    /// Takes the last step again, no further than to the kink that has cut it: the flow before the kink does not lead to its end.
    fn step_again(
        &mut self,
        agents: &mut Agents<'_>,
        group: &mut Group,
        curves: &mut CurveRows,
        start: f64,
    ) -> Advance {
        let mut rest = self.x.as_slice();
        for &member in &group.members {
            let states = &mut agents.agents[member].states;
            let (own, others) = rest.split_at(states.len());
            states.copy_from_slice(own);
            rest = others;
        }
        let step_max = self.integrator.step_max;
        self.integrator.step_max = step_max.min(group.clock - start);
        (group.clock, group.kinks) = (start, Vec::new());
        group.integration.restart();
        let again = self.step(agents, group, curves);
        self.integrator.step_max = step_max;
        again
    }

    /// From now on no step is longer than `step_max`, and none leads beyond `stop`, both s.
    pub fn bound(&mut self, step_max: f64, stop: f64) {
        (self.integrator.step_max, self.integrator.stop) = (step_max, stop);
    }

    /// Finds the rates of a group that begins afresh, as far as they are defined.
    pub fn begin(&mut self, agents: &Agents<'_>, group: &mut Group) {
        self.with_flow(agents, group, |integrator, x, group, flow| {
            // What is not defined is met again, and reported, when a step is tried.
            let _ = integrator.begin(group.clock, x, &mut group.integration, flow);
        });
    }

    /// Takes a step that is good enough.
    fn accepted_step(&mut self, agents: &Agents<'_>, group: &mut Group) -> Result<Stretch, Stuck> {
        if group.integration.is_fresh() {
            self.recall(agents, group);
        }
        let before = group.integration.switch.regime;
        let found = self.counted_step(agents, group);
        if group.integration.switch.regime != before {
            self.remember(agents, group);
        }
        found
    }

    /// In modes that its members were not in before, a group begins with the method that it last had there.
    fn recall(&mut self, agents: &Agents<'_>, group: &mut Group) {
        let modes = group.members.iter().map(|&agent| agents.agents[agent].mode);
        if modes.clone().eq(group.modes.iter().copied()) {
            return;
        }
        group.modes.clear();
        group.modes.extend(modes);
        let is_stiff = |(&agent, &mode): (&usize, &usize)| self.stiff.contains(&(agent, mode));
        let any_stiff = !self.stiff.is_empty() && group.members.iter().zip(&group.modes).any(is_stiff);
        group.integration.switch = Switch::to(if any_stiff { Regime::Stiff } else { Regime::Explicit });
    }

    /// Remembers which method a group has changed to.
    fn remember(&mut self, agents: &Agents<'_>, group: &Group) {
        for &agent in &group.members {
            let key = (agent, agents.agents[agent].mode);
            match group.integration.switch.regime {
                Regime::Stiff => self.stiff.insert(key),
                Regime::Explicit => self.stiff.remove(&key),
            };
        }
    }

    /// Accepted steps of each method, one for each member.
    pub fn steps_of_methods(&self) -> Vec<(MethodName, u64)> {
        let Counts { steps, steps_stiff, .. } = self.counts;
        match self.methods {
            Methods::One(name) => vec![(name, steps)],
            Methods::Automatic(name) => vec![(name, steps - steps_stiff), (MethodName::Stiff, steps_stiff)],
        }
    }

    /// Takes a step and counts what it takes.
    fn counted_step(&mut self, agents: &Agents<'_>, group: &mut Group) -> Result<Stretch, Stuck> {
        let n_members = group.members.len() as u64;
        let (rejected, operations) = (self.integrator.rejected, self.integrator.operations);
        let found = self.with_flow(agents, group, |integrator, x, group, flow| {
            integrator.step(group.clock, x, &mut group.integration, flow)
        });
        self.counts.operations += self.integrator.operations - operations;
        self.counts.rejected += (self.integrator.rejected - rejected) * n_members;
        found
    }

    /// Works on a group's integration, with all members' states in one row, and counts what that takes.
    fn with_flow<T>(
        &mut self,
        agents: &Agents<'_>,
        group: &mut Group,
        work: impl FnOnce(&mut Integrator, &[f64], &mut Group, &mut GroupFlow<'_, '_>) -> T,
    ) -> T {
        self.x.clear();
        for &agent in &group.members {
            self.x.extend_from_slice(&agents.agents[agent].states);
        }
        let members = std::mem::take(&mut group.members);
        self.counts.starts += if group.integration.is_fresh() { members.len() as u64 } else { 0 };
        let leaders = std::mem::take(&mut group.leaders);
        let mut flow = GroupFlow::new(agents, &members, &leaders, &self.absent);
        let done = work(&mut self.integrator, &self.x, group, &mut flow);
        self.counts.rhs_evaluations += flow.evaluations;
        self.counts.jacobians += flow.jacobians;
        self.counts.operations += flow.operations;
        (group.members, group.leaders) = (members, leaders);
        done
    }

    /// Makes the accepted step the members' last segment.
    fn keep(&mut self, agents: &mut Agents<'_>, group: &mut Group, stretch: &Stretch) {
        let mut first = 0;
        for &member in &group.members {
            let agent = &mut agents.agents[member];
            let n_states = agent.states.len();
            self.integrator.dense(stretch, &agent.states, first, &mut agent.segment);
            agent.states.copy_from_slice(&self.integrator.trial.x_new[first..first + n_states]);
            first += n_states;
            let is_stiff = self.integrator.regime() == Regime::Stiff;
            let n_new = u64::from(is_stiff || !agents.cold.has_counted(member, stretch.end));
            self.counts.steps += n_new;
            self.counts.steps_stiff += u64::from(is_stiff);
            self.counts.steps_of_type[agent.ty] += n_new;
            self.counts.steps_of[member] += n_new;
        }
        self.integrator.keep(stretch, &mut group.integration);
        group.clock = stretch.end;
    }

    /// Cuts the group's new segments at the first kink on them.
    fn stop_at_kinks(
        &mut self,
        agents: &mut Agents<'_>,
        group: &mut Group,
        curves: &mut CurveRows,
    ) -> Advance {
        let start = agents.agents[group.members[0]].segment.start;
        let ways: Vec<(usize, Option<usize>)> =
            group.leaders.iter().map(|&leader| (leader, agents.way_from(leader, start))).collect();
        ways.iter().for_each(|&(leader, way)| agents.exchange(leader, way));
        let hits = self.first_kinks(agents, group, curves);
        ways.iter().for_each(|&(leader, way)| agents.exchange(leader, way));
        let Some((first, hits)) = hits else { return Advance::Moved };
        shorten(agents, group, first);
        if first > start {
            group.kinks = hits;
            return Advance::Moved;
        }
        turn(agents, &hits);
        Advance::Turned(hits)
    }

    /// Takes a group, which can go no further, to the kinks that it reaches within the resolution of time: beyond them the flow
    /// as it is locked may not be defined (`sqrt(abs(time - 1))` at 1). False, and nothing is done, if there are none.
    pub fn creep_to_kinks(
        &mut self,
        agents: &mut Agents<'_>,
        group: &mut Group,
        curves: &mut CurveRows,
    ) -> bool {
        let clock = group.clock;
        let at_hand: Vec<(f64, KinkHit)> =
            group.members.iter().flat_map(|&agent| kinks_at_hand(agents, agent, clock, curves)).collect();
        let Some(end) = at_hand.iter().map(|&(time, _)| time).max_by(f64::total_cmp) else { return false };
        let mut hits: Vec<KinkHit> = at_hand.into_iter().map(|(_, hit)| hit).collect();
        let mut rates = self.finite_rates(agents, group);
        if rates.is_none() {
            // The locks may have turned already, a little before their kinks.
            turn(agents, &hits);
            rates = self.finite_rates(agents, group);
            for hit in &mut hits {
                std::mem::swap(&mut hit.before, &mut hit.lock);
            }
        }
        let Some(rates) = rates else {
            turn(agents, &hits);
            return false;
        };
        let (h, mut first) = (end - clock, 0);
        for &member in &group.members {
            let Agent { states, segment, .. } = &mut agents.agents[member];
            let n = states.len();
            let coefficients = segment.reset(clock, h, end, 2, n);
            for ((pair, x), &rate) in coefficients.chunks_exact_mut(2).zip(states).zip(&rates[first..]) {
                pair.copy_from_slice(&[*x, rate * h]);
                *x += rate * h;
            }
            first += n;
        }
        group.clock = end;
        group.integration.restart();
        group.kinks = hits;
        true
    }

    /// The rates of a group at its clock, if all are finite.
    fn finite_rates(&mut self, agents: &Agents<'_>, group: &mut Group) -> Option<Vec<f64>> {
        let mut rates = Vec::new();
        self.with_flow(agents, group, |_, x, group, flow| {
            rates.resize(x.len(), 0.0);
            flow.rates(group.clock, x, &mut rates);
        });
        rates.iter().all(|rate| rate.is_finite()).then_some(rates)
    }

    /// When the group's new segments first meet a kink, and all that they meet then.
    fn first_kinks(
        &mut self,
        agents: &Agents<'_>,
        group: &Group,
        curves: &mut CurveRows,
    ) -> Option<(f64, Vec<KinkHit>)> {
        let mut first = f64::INFINITY;
        let mut hits: Vec<KinkHit> = Vec::new();
        for &agent in &group.members {
            let flow = agents.flow(agent);
            if flow.kinks.is_empty() {
                continue;
            }
            let slots = agents.slots(&flow.frame, &[agent]);
            for (number, kink) in flow.kinks.iter().enumerate() {
                let until = first.min(group.clock);
                let Some((time, lock)) =
                    kink_time(agents, agent, kink, &slots, until, curves, self.pieces_max)
                else {
                    continue;
                };
                if time < first {
                    hits.clear();
                    first = time;
                }
                let before = agents.agents[agent].aux[kink.lock];
                hits.push(KinkHit { agent, kink: number, before, lock });
            }
        }
        (!hits.is_empty()).then_some((first, hits))
    }

    /// The member and state at which a step fails: the one whose rate is not finite first, or the one with the largest
    /// error.
    fn culprit(&mut self, agents: &Agents<'_>, group: &Group, stuck: Stuck) -> Obstacle {
        match stuck {
            Stuck::NonFinite => self.undefined(agents, group),
            Stuck::Underflow => {
                let error = &self.integrator.trial.error;
                let scale = |i: usize| self.accuracy.allowed(self.x[i].abs());
                let share = |i: usize| error[i].abs() / scale(i);
                let worst = (0..self.x.len()).max_by(|&i, &j| share(i).total_cmp(&share(j)));
                let (agent, state) = member(agents, group, worst.unwrap_or(0));
                Obstacle::Underflow { agent, state }
            }
        }
    }

    /// Takes the step that met a number that is not finite again, and looks where it comes from.
    fn undefined(&mut self, agents: &Agents<'_>, group: &Group) -> Obstacle {
        let mut flow = GroupFlow::new(agents, &group.members, &group.leaders, &self.absent);
        let mut witness = Witness { flow: &mut flow, found: None };
        self.integrator.again(group.clock, &self.x, &group.integration, &mut witness);
        let found = witness.found;
        let trial = &self.integrator.trial;
        let grown =
            || (0..self.x.len()).find(|&i| !(trial.x_new[i].is_finite() && trial.rates[i].is_finite()));
        let index = found.as_ref().map(|undefined| undefined.index).or_else(grown);
        let (agent, state) = member(agents, group, index.unwrap_or(0));
        let made = found.and_then(|undefined| Some((undefined.time, flow.blame(&undefined)?)));
        Obstacle::NonFinite { agent, state, made }
    }
}

/// The member, and the state of it, that state `index` of a group is.
fn member(agents: &Agents<'_>, group: &Group, index: usize) -> (usize, usize) {
    let mut state = index;
    for &agent in &group.members {
        let n_states = agents.agents[agent].states.len();
        if state < n_states {
            return (agent, state);
        }
        state -= n_states;
    }
    unreachable!("a group has the states of its members")
}

/// Cuts the last segments of a group at `t`, by dense output and without recomputation; what has been taken beyond is void.
pub fn cut(agents: &mut Agents<'_>, group: &mut Group, t: f64) {
    for &member in &group.members {
        agents.agents[member].ahead.clear();
        agents.cold.void_track(member);
    }
    shorten(agents, group, t);
}

/// Ends the last step of a group at `t`.
fn shorten(agents: &mut Agents<'_>, group: &mut Group, t: f64) {
    group.kinks.clear();
    if group.clock == f64::INFINITY {
        return;
    }
    if group.clock != t {
        for &member in &group.members {
            let agent = &mut agents.agents[member];
            let mut states = std::mem::take(&mut agent.states);
            agent.segment.states(t, &mut states);
            agent.states = states;
        }
        group.clock = t;
    }
    for &member in &group.members {
        agents.agents[member].segment.cut(t);
        agents.divert(member);
    }
    group.integration.restart();
    group.version += 1;
}

/// Has a group take its next step as it has been taken ahead of its clock.
fn take_ahead(agents: &mut Agents<'_>, group: &mut Group) -> bool {
    let mut has_moved = false;
    for &member in &group.members {
        let agent = &mut agents.agents[member];
        if let Some(Way { segment, states }) = agent.ahead.pop() {
            group.clock = segment.end;
            (agent.segment, agent.states) = (segment, states);
            has_moved = true;
        }
    }
    has_moved
}

/// Up to when a group may step: as far as its leaders are known; if its flow has kinks, on one step of each leader.
fn led_until(agents: &Agents<'_>, group: &Group) -> f64 {
    let has_kinks = || group.members.iter().any(|&member| !agents.flow(member).kinks.is_empty());
    if group.leaders.is_empty() {
        return f64::INFINITY;
    }
    let until = |leader: usize| {
        if has_kinks() { agents.way_until(leader, group.clock) } else { agents.known_until(leader) }
    };
    group.leaders.iter().map(|&leader| until(leader)).fold(f64::INFINITY, f64::min)
}

/// Has an agent take its next step from its track, if it has been taken there.
fn retake(agents: &mut Agents<'_>, agent: usize, group: &mut Group) -> bool {
    let Agents { agents, cold, .. } = agents;
    let Agent { states, segment, .. } = &mut agents[agent];
    let Some(step) = cold.kept_step(agent, group.clock, states, segment) else { return false };
    group.integration.note_accepted(step.start, step.h, step.ratio);
    group.clock = step.end;
    true
}
