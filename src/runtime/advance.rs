//! One step of one group: try, judge, keep; and stop it at the first kink of a flow (rule 15).
//!
//! A step never spans a kink: the flow holds its branches locked during a step, the surfaces at which a branch changes
//! are searched on the dense output, and the step is cut at the first of them. The lock changes when the group is next
//! advanced, so that an event before the kink can still undo it.

use crate::codegen::kernel::{AgentView, StepKernel};
use crate::codegen::program::{Atom, Kink, KinkKind, Relation};
use crate::runtime::detect::{AtomCurve, CurveRows};
use crate::runtime::groups::{Group, KinkHit};
use crate::runtime::limits::Limits;
use crate::runtime::population::{ABSENT, Agents, Slots};
use crate::runtime::present::Views;
use crate::runtime::solve::control::Accuracy;
use crate::runtime::solve::roots::{Known, Search, first_flip};
use crate::runtime::solve::tsit5::{self, Accepted, ORDER, STAGES, StepRows};
use crate::runtime::solve::ulp;

/// Counts of steps.
#[derive(Clone, Debug, Default)]
pub struct Counts {
    /// Accepted, one for each member.
    pub steps: u64,
    /// Accepted, for each agent type.
    pub steps_of_type: Vec<u64>,
    /// Rejected, one for each member.
    pub rejected: u64,
    /// Right-hand sides, one for each member.
    pub rhs_evaluations: u64,
}

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
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Obstacle {
    /// The flow is not a finite number at the clock or just after it.
    NonFinite {
        /// Whose.
        agent: usize,
        /// Which state.
        state: usize,
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
    accuracy: Accuracy,
    time_end: f64,
    pieces_max: u32,
    rows: StepRows,
    x: Vec<f64>,
    /// What steps took so far.
    pub counts: Counts,
    absent: Vec<f64>,
}

impl Stepper {
    /// A stepper up to `time_end`.
    pub fn new(agents: &Agents<'_>, accuracy: Accuracy, time_end: f64, limits: &Limits) -> Self {
        let width = agents.row_width();
        let counts = Counts { steps_of_type: vec![0; agents.program.types.len()], ..Counts::default() };
        Self {
            accuracy,
            time_end,
            pieces_max: limits.pieces_max,
            rows: StepRows::default(),
            x: Vec::new(),
            counts,
            absent: vec![f64::NAN; width],
        }
    }

    /// Advances a group by one step, which may end early at a kink.
    pub fn advance(&mut self, agents: &mut Agents<'_>, group: &mut Group, curves: &mut CurveRows) -> Advance {
        if !group.kinks.is_empty() {
            let hits = std::mem::take(&mut group.kinks);
            turn(agents, &hits);
            group.first_rates.clear();
            return Advance::Turned(hits);
        }
        if group.clock == f64::INFINITY {
            return Advance::Moved;
        }
        let slots: Vec<Slots> =
            group.members.iter().map(|&agent| agents.slots(&agents.flow(agent).frame, &[agent])).collect();
        self.gather(agents, group);
        if group.first_rates.is_empty() && !self.first_rates(agents, group, &slots) {
            return Advance::Blocked(self.culprit(agents, group, true));
        }
        let (h, end) = match self.accepted_step(agents, group, &slots) {
            Ok(step) => step,
            Err(obstacle) => return Advance::Blocked(obstacle),
        };
        self.keep(agents, group, h, end);
        self.stop_at_kinks(agents, group, &slots, curves)
    }

    /// Collects the members' states in one row.
    fn gather(&mut self, agents: &Agents<'_>, group: &Group) {
        self.x.clear();
        for &agent in &group.members {
            self.x.extend_from_slice(&agents.agents[agent].states);
        }
        self.rows.resize(self.x.len());
    }

    /// f at the clock; false if it is not finite.
    fn first_rates(&mut self, agents: &Agents<'_>, group: &mut Group, slots: &[Slots]) -> bool {
        let n = self.x.len();
        let mut rates = std::mem::take(&mut group.first_rates);
        rates.resize(n, 0.0);
        group_rates(agents, group, slots, &self.absent, group.clock, &self.x, &mut rates);
        self.counts.rhs_evaluations += group.members.len() as u64;
        self.rows.k[..n].copy_from_slice(&rates);
        let finite = rates.iter().all(|rate| rate.is_finite());
        if finite {
            group.first_rates = rates;
        }
        finite
    }

    /// Tries steps until one is good enough. Its length and its end.
    fn accepted_step(
        &mut self,
        agents: &Agents<'_>,
        group: &mut Group,
        slots: &[Slots],
    ) -> Result<(f64, f64), Obstacle> {
        let n = self.x.len();
        let t = group.clock;
        self.rows.k[..n].copy_from_slice(&group.first_rates);
        let mut h = match group.h {
            Some(h) => h,
            None => self.first_step(agents, group, slots),
        };
        loop {
            let left = self.time_end - t;
            let (step, end) = if h >= left * (1.0 - 1e-12) { (left, self.time_end) } else { (h, t + h) };
            if end == self.time_end && end <= t + 2.0 * ulp(t) {
                // Not a step, but the end: what is left of the run cannot be told from none.
                self.try_step(agents, group, slots, t, step);
                self.rows.x_new.copy_from_slice(&self.x);
                return Ok((step, end));
            }
            if end <= t + 2.0 * ulp(t) {
                let non_finite = !self.rows.x_new.iter().chain(&self.rows.error).all(|v| v.is_finite());
                return Err(self.culprit(agents, group, non_finite));
            }
            self.try_step(agents, group, slots, t, step);
            let norm = self.accuracy.error_norm(&self.rows.error, &self.x, &self.rows.x_new);
            if norm <= 1.0 && self.rows.k[(STAGES - 1) * n..].iter().all(|rate| rate.is_finite()) {
                let next = step * group.control.accepted(norm, ORDER);
                group.h = Some(if step < h { next.max(h) } else { next }.min(1e100));
                return Ok((step, end));
            }
            self.counts.rejected += group.members.len() as u64;
            h = step * group.control.rejected(norm, ORDER);
        }
    }

    fn try_step(&mut self, agents: &Agents<'_>, group: &Group, slots: &[Slots], t: f64, h: f64) {
        self.counts.rhs_evaluations += (STAGES as u64 - 1) * group.members.len() as u64;
        if let Some(kernel) = whole_step(agents, group) {
            let views = views(agents, &slots[0], &self.absent, &self.x);
            kernel.step(&views, t, h, &mut self.rows.k, &mut self.rows.x_new, &mut self.rows.error);
            return;
        }
        let absent = &self.absent;
        tsit5::step(t, h, &self.x, &mut self.rows, &mut |t, x, rates| {
            group_rates(agents, group, slots, absent, t, x, rates);
        });
    }

    /// The first step of a group: Hairer, Norsett & Wanner, Solving ODEs I, II.4, with the second rates by one Euler step.
    fn first_step(&mut self, agents: &Agents<'_>, group: &Group, slots: &[Slots]) -> f64 {
        let n = self.x.len();
        let norm = |accuracy: &Accuracy, v: &[f64], x: &[f64]| {
            (0..n).fold(0.0_f64, |norm, i| {
                norm.max(v[i].abs() / (accuracy.absolute + accuracy.tolerance * x[i].abs()))
            })
        };
        let (d0, d1) =
            (norm(&self.accuracy, &self.x, &self.x), norm(&self.accuracy, &group.first_rates, &self.x));
        let h0 = if d0 < 1e-5 || d1 < 1e-5 { 1e-6 } else { 0.01 * d0 / d1 };
        let h0 = h0.min(self.time_end - group.clock);
        let moved: Vec<f64> = (0..n).map(|i| self.x[i] + h0 * group.first_rates[i]).collect();
        let mut rates = vec![0.0; n];
        group_rates(agents, group, slots, &self.absent, group.clock + h0, &moved, &mut rates);
        self.counts.rhs_evaluations += group.members.len() as u64;
        let difference: Vec<f64> = (0..n).map(|i| rates[i] - group.first_rates[i]).collect();
        let d2 = norm(&self.accuracy, &difference, &self.x) / h0;
        let largest = d1.max(d2);
        let h1 = if largest <= 1e-15 {
            (h0 * 1e-3).max(1e-6)
        } else {
            crate::math::elementary::pow(0.01 / largest, 1.0 / ORDER)
        };
        let h = h1.min(100.0 * h0);
        if h.is_finite() && h > 0.0 { h } else { h0.max(1e-12) }
    }

    /// Makes the accepted step the members' last segment.
    fn keep(&mut self, agents: &mut Agents<'_>, group: &mut Group, h: f64, end: f64) {
        let n = self.x.len();
        let step = Accepted { t: group.clock, h, end, k: &self.rows.k, n };
        let mut first = 0;
        for &member in &group.members {
            let agent = &mut agents.agents[member];
            let n_states = agent.states.len();
            tsit5::dense(&step, &agent.states, first, &mut agent.segment);
            agent.states.copy_from_slice(&self.rows.x_new[first..first + n_states]);
            first += n_states;
            self.counts.steps += 1;
            self.counts.steps_of_type[agent.ty] += 1;
        }
        group.first_rates.clear();
        group.first_rates.extend_from_slice(&self.rows.k[(STAGES - 1) * n..]);
        group.clock = end;
    }

    /// Cuts the group's new segments at the first kink on them.
    fn stop_at_kinks(
        &mut self,
        agents: &mut Agents<'_>,
        group: &mut Group,
        slots: &[Slots],
        curves: &mut CurveRows,
    ) -> Advance {
        let mut first = f64::INFINITY;
        let mut hits: Vec<KinkHit> = Vec::new();
        for (k, &agent) in group.members.iter().enumerate() {
            for (number, kink) in agents.flow(agent).kinks.iter().enumerate() {
                let until = first.min(group.clock);
                let Some((time, lock)) =
                    kink_time(agents, agent, kink, &slots[k], until, curves, self.pieces_max)
                else {
                    continue;
                };
                if time < first {
                    hits.clear();
                    first = time;
                }
                hits.push(KinkHit { agent, kink: number, lock });
            }
        }
        if hits.is_empty() {
            return Advance::Moved;
        }
        let start = agents.agents[group.members[0]].segment.start;
        cut(agents, group, first);
        if first > start {
            group.kinks = hits;
            return Advance::Moved;
        }
        turn(agents, &hits);
        Advance::Turned(hits)
    }

    /// The member and state at which a step fails: the first that is not finite, or the one with the largest error.
    fn culprit(&self, agents: &Agents<'_>, group: &Group, non_finite: bool) -> Obstacle {
        let n = self.x.len();
        let bad = |i: usize| {
            !(self.rows.x_new[i].is_finite() && (0..STAGES).all(|s| self.rows.k[s * n + i].is_finite()))
        };
        let share = |i: usize| {
            self.rows.error[i].abs() / (self.accuracy.absolute + self.accuracy.tolerance * self.x[i].abs())
        };
        let worst = if non_finite {
            (0..n).find(|&i| bad(i)).unwrap_or(0)
        } else {
            (0..n).max_by(|&i, &j| share(i).total_cmp(&share(j))).unwrap_or(0)
        };
        let mut first = 0;
        for &agent in &group.members {
            let n_states = agents.agents[agent].states.len();
            if worst < first + n_states {
                let state = worst - first;
                return if non_finite {
                    Obstacle::NonFinite { agent, state }
                } else {
                    Obstacle::Underflow { agent, state }
                };
            }
            first += n_states;
        }
        Obstacle::Underflow { agent: group.members[0], state: 0 }
    }
}

/// Cuts the last segments of a group at `t`, by dense output and without recomputation.
pub fn cut(agents: &mut Agents<'_>, group: &mut Group, t: f64) {
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
            agent.segment.end = t;
        }
        group.clock = t;
    }
    group.first_rates.clear();
    group.version += 1;
}

/// Sets the locks that some kinks change.
fn turn(agents: &mut Agents<'_>, hits: &[KinkHit]) {
    for hit in hits {
        let lock = agents.flow(hit.agent).kinks[hit.kink].lock;
        agents.agents[hit.agent].aux[lock] = hit.lock;
    }
}

/// When the new segment of an agent first meets a kink, and the value that its lock then takes.
fn kink_time(
    agents: &Agents<'_>,
    agent: usize,
    kink: &Kink,
    slots: &Slots,
    until: f64,
    curves: &mut CurveRows,
    pieces_max: u32,
) -> Option<(f64, f64)> {
    let lock = agents.agents[agent].aux[kink.lock];
    let start = agents.agents[agent].segment.start;
    let mut search = |atom: &Atom, truth: bool| {
        let closed = atom.relation == Relation::NonPositive;
        let reach = 2.0 * f64::EPSILON * until.abs();
        let known = Known { truth, closed, slack: 0.0, settled: false, grazed: false, reach };
        let mut curve = AtomCurve::new(agents, atom, slots, curves);
        let mut from = start;
        loop {
            match first_flip(&mut curve, from, until, known, pieces_max) {
                Search::None | Search::Undecided => return None,
                Search::Flip(flip) => return Some(flip.time),
                Search::Until(reached) => from = reached,
            }
        }
    };
    match &kink.kind {
        KinkKind::Branch(atom) => search(atom, lock != 0.0).map(|time| (time, 1.0 - lock)),
        KinkKind::Integer { below, above } => {
            let down = search(below, false).map(|time| (time, lock - 1.0));
            let up = search(above, false).map(|time| (time, lock + 1.0));
            match (down, up) {
                (Some(down), Some(up)) => Some(if down.0 <= up.0 { down } else { up }),
                (down, up) => down.or(up),
            }
        }
    }
}

/// The machine code of a whole step, for a group of one.
fn whole_step<'p>(agents: &Agents<'p>, group: &Group) -> Option<&'p StepKernel> {
    let [agent] = group.members[..] else { return None };
    let agent = &agents.agents[agent];
    agents.program.steps[agent.ty][agent.mode].as_ref()
}

/// The right-hand sides of all members at (t, x).
fn group_rates(
    agents: &Agents<'_>,
    group: &Group,
    slots: &[Slots],
    absent: &[f64],
    t: f64,
    x: &[f64],
    rates: &mut [f64],
) {
    let mut first = 0;
    for (k, &agent) in group.members.iter().enumerate() {
        let n = agents.agents[agent].states.len();
        let views = if let [_] = group.members[..] {
            views(agents, &slots[k], absent, x)
        } else {
            group_views(agents, group, &slots[k], absent, x)
        };
        let kernel = agents.program.kernel(agents.flow(agent).rates);
        kernel.eval(&views, t, &mut rates[first..first + n]);
        first += n;
    }
}

/// Views for an agent whose flow reads no foreign states: `x` is its own.
fn views<'a>(agents: &'a Agents<'_>, slots: &Slots, absent: &'a [f64], x: &'a [f64]) -> Views<'a> {
    slots
        .iter()
        .enumerate()
        .map(|(slot, &agent)| {
            if agent == ABSENT {
                return AgentView { states: absent, rates: absent, accelerations: absent, aux: absent };
            }
            let other = &agents.agents[agent];
            let states = if slot == 0 || agent == slots[0] { x } else { &other.states };
            AgentView { states, rates: &[], accelerations: &[], aux: &other.aux }
        })
        .collect()
}

/// Views for a member of a group; `x` holds the states of all members one after the other.
fn group_views<'a>(
    agents: &'a Agents<'_>,
    group: &Group,
    slots: &Slots,
    absent: &'a [f64],
    x: &'a [f64],
) -> Views<'a> {
    slots
        .iter()
        .map(|&agent| {
            if agent == ABSENT {
                return AgentView { states: absent, rates: absent, accelerations: absent, aux: absent };
            }
            let mut first = 0;
            let mut states: &[f64] = &agents.agents[agent].states;
            for &member in &group.members {
                let n = agents.agents[member].states.len();
                if member == agent {
                    states = &x[first..first + n];
                    break;
                }
                first += n;
            }
            AgentView { states, rates: &[], accelerations: &[], aux: &agents.agents[agent].aux }
        })
        .collect()
}
