//! Sleeping beyond a window (I6): how long a comparison cannot change, by where its agents can get to.

use smallvec::SmallVec;

use crate::codegen::kernel::AgentBox;
use crate::codegen::program::{FunctionId, Slot};
use crate::math::Interval;
use crate::runtime::act::Written;
use crate::runtime::engine::Engine;
use crate::runtime::paper::Form;
use crate::runtime::population::{ABSENT, Slots};
use crate::runtime::present::{Boxes, Depth, depth_read};
use crate::runtime::reach::anchor;
use crate::runtime::solve::control::Accuracy;

/// For each slot, bounds of the states of the agent in it.
pub type StateBoxes = SmallVec<[SmallVec<[Interval; 8]>; 2]>;

/// What an event means for a comparison.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Regard {
    /// Something that it reads may have changed.
    Changed,
    /// Nothing that it reads has changed, but that will change otherwise than it would have.
    AsBefore,
    /// Nor has anything by which it is certified.
    Far,
}

/// What is known of how far the two of a pair are apart.
enum Distance {
    /// Their rates have no bounds, or their distance does not decide.
    Unknown,
    /// They may be near.
    Near,
    /// They are not up to `until`, s, and `far` since ([`crate::runtime::guards::AtomState::far`]).
    Out {
        /// See above.
        until: f64,
        /// See above.
        far: f64,
    },
}

/// In groups larger than this a comparison does not try to sleep at once.
pub const FEW: u16 = 4;

/// For how many agents that step together the looks count between two tries to sleep, at most.
const SLEEPLESS_MAX: usize = 4096;
/// How often at most a shorter time is tried.
const TRIES: usize = 5;
/// By how much it is shorter.
const SHRINK: f64 = 0.25;

impl Engine<'_, '_> {
    /// Settles a comparison that cannot change before the end of the run, by where its agents can get to. False, and nothing
    /// is done, if that is not certain, or in the plain form.
    pub fn settle_far(&mut self, index: usize) -> bool {
        if self.form == Form::Plain || !self.time_end.is_finite() || !self.is_bounded(index) {
            return false;
        }
        let (_, slots) = self.guards.atom_slots(&self.agents, index);
        if self.largest_group(&slots) > FEW {
            return false;
        }
        if self.guards.atoms[index].left_out {
            return true;
        }
        let bound = self.value_range(index, (self.present.time, self.time_end));
        if bound.contains_zero() {
            return false;
        }
        let far = self.pure_since(index);
        let state = &mut self.guards.atoms[index];
        (state.truth, state.sideless, state.touched, state.rooted) = (bound.hi < 0.0, false, false, false);
        (state.certified, state.flip, state.settled, state.far) = (self.time_end, f64::INFINITY, false, far);
        state.version += 1;
        true
    }

    /// How many agents step together with one of these, at most.
    pub fn largest_group(&self, slots: &Slots) -> u16 {
        let groups =
            slots.iter().filter(|&&agent| agent != ABSENT).map(|&agent| self.agents.agents[agent].group);
        let most = groups.map(|group| self.groups.groups[group].members.len()).max().unwrap_or(0);
        most.min(SLEEPLESS_MAX) as u16
    }

    /// What is known of a comparison of which an agent was written, or follows another way from now on.
    pub fn regard(&mut self, index: usize, written: &Written) -> Regard {
        let (atom, slots) = self.guards.atom_slots(&self.agents, index);
        let kernel = self.program.kernel(atom.value);
        let by_more = !atom.folds.is_empty() || depth_read(kernel) != Depth::States;
        if by_more || self.leads_elsewhere(index, written) {
            return Regard::Changed;
        }
        let mut stays_far = self.guards.atoms[index].far <= self.present.time;
        for &slot in &atom.slots {
            let agent = slots[slot];
            let Some((before, aux)) = written.before.get(&agent) else {
                stays_far &= !written.restarted.contains(&agent);
                continue;
            };
            let moved = written.moves.iter().any(|change| change.agent == agent);
            self.present.make(&self.agents, &[agent], Depth::States);
            let now = self.present.states(agent);
            let mut read = kernel.reads().states.iter().filter(|read| read.0 == slot);
            let is_as_before = read.all(|&(_, column)| before[column] == now[column]);
            if moved || aux != &self.agents.agents[agent].aux || !is_as_before {
                return Regard::Changed;
            }
        }
        if stays_far { Regard::Far } else { Regard::AsBefore }
    }

    /// Since when the boxes of the agents that a comparison reads rest on bounds of rates alone, s: the latest of their anchors.
    /// Infinite if one does not.
    fn pure_since(&self, index: usize) -> f64 {
        let definition = self.guards.definition(self.guards.atoms[index].instance);
        let (atom, slots) = self.guards.atom_slots(&self.agents, index);
        let by_links = definition.frame.slots.iter().any(|slot| matches!(slot, Slot::Link { .. }));
        let mut latest = if by_links { f64::INFINITY } else { 0.0 };
        for agent in atom.slots.iter().map(|&slot| slots[slot]) {
            let since = anchor(&self.agents, &self.groups.groups, agent).0;
            latest = f64::max(latest, if self.reaches.is_pure(agent) { since } else { f64::INFINITY });
        }
        latest
    }

    /// Whether a comparison can be bounded by the boxes of its agents.
    pub fn is_bounded(&self, index: usize) -> bool {
        let (atom, slots) = self.guards.atom_slots(&self.agents, index);
        let absent = atom.slots.iter().any(|&slot| slots[slot] == ABSENT);
        !absent && atom.folds.is_empty() && depth_read(self.program.kernel(atom.value)) == Depth::States
    }

    /// Has a comparison sleep beyond `least`, if it is certain that it cannot change before; the agents need not have come
    /// that far. False, and nothing is done, if it is not.
    pub fn sleep_beyond(&mut self, index: usize, least: f64) -> bool {
        let sleep = self.sleeping_time(index, least);
        if let Some((until, far)) = sleep {
            self.certified(index, until);
            self.guards.atoms[index].far = far;
        }
        sleep.is_some()
    }

    /// Up to when a comparison cannot change, if that is certain up to `least` at least; and since when it is far.
    fn sleeping_time(&mut self, index: usize, least: f64) -> Option<(f64, f64)> {
        let state = self.guards.atoms[index];
        let from = state.certified;
        let end = if self.time_end.is_finite() { self.time_end } else { least.max(from + 1e6) };
        let least = least.min(end);
        match self.distant_until(index, from, end) {
            Distance::Out { until, far } if until >= least => return Some((until, far)),
            Distance::Out { .. } | Distance::Near => return None,
            Distance::Unknown => {}
        }
        if !self.is_bounded(index) {
            return None;
        }
        let mut until = if state.stride > 0.0 { (from + state.stride).clamp(least, end) } else { end };
        for attempt in 0..TRIES {
            if attempt + 1 == TRIES {
                until = least;
            }
            let bound = self.value_range(index, (from, until));
            if state.is_kept_by(bound) {
                self.guards.atoms[index].stride = 2.0 * (until - from);
                return Some((until, self.pure_since(index)));
            }
            if until <= least {
                break;
            }
            until = (from + SHRINK * (until - from)).max(least);
        }
        self.guards.atoms[index].stride = (least - from).max(f64::MIN_POSITIVE);
        None
    }

    /// Up to when a pair stays out of the range of its condition, in one of the states that are compared, by bounds of the
    /// rates of both: a comparison that is the whole condition is false so long.
    fn distant_until(&mut self, index: usize, from: f64, end: f64) -> Distance {
        let Some(near) = self.guards.far_where_apart(index).filter(|_| self.time_end.is_finite()) else {
            return Distance::Unknown;
        };
        let instance = self.guards.atoms[index].instance;
        let [a, b] = self.guards.instances[instance as usize].roots.map(|agent| agent as usize);
        let (agents, groups) = (&self.agents, &self.groups.groups);
        let (ta, xa) = anchor(agents, groups, a);
        let (tb, xb) = anchor(agents, groups, b);
        let mut distant = None;
        for (near, [own, other]) in near.iter().filter_map(|near| Some((near, near.states()?))) {
            let Some(ra) = self.reaches.rate(agents, groups, a, own, from) else {
                return Distance::Unknown;
            };
            let Some(rb) = self.reaches.rate(agents, groups, b, other, from) else {
                return Distance::Unknown;
            };
            let (a, b) = (xa[own], xb[other]);
            let until = if a > b {
                out_of_range((a, ta, ra), (b, tb, rb), near.within, self.stepper.accuracy, (from, end))
            } else {
                out_of_range((b, tb, rb), (a, ta, ra), near.within, self.stepper.accuracy, (from, end))
            };
            distant = match (distant, until) {
                (Some(one), Some(other)) => Some(f64::max(one, other)),
                (one, other) => one.or(other),
            };
        }
        let is_pure = self.reaches.is_pure(a) && self.reaches.is_pure(b);
        let far = if is_pure { ta.max(tb) } else { f64::INFINITY };
        distant.map_or(Distance::Near, |until| Distance::Out { until, far })
    }

    /// Bounds of a comparison's g over a stretch of time.
    fn value_range(&mut self, index: usize, (from, until): (f64, f64)) -> Interval {
        let (atom, slots) = self.guards.atom_slots(&self.agents, index);
        let mut states = StateBoxes::new();
        let (agents, groups) = (&self.agents, &self.groups.groups);
        for (slot, &agent) in slots.iter().enumerate() {
            let mut bounds = SmallVec::new();
            if agent != ABSENT && atom.slots.contains(&slot) {
                self.reaches.states(agents, groups, &mut self.enclosures, agent, (from, until), &mut bounds);
            }
            states.push(bounds);
        }
        self.range_over(atom.value, &slots, &states, (from, until))
    }

    /// Bounds of a function of states, given bounds of these, over a stretch of time.
    pub fn range_over(
        &mut self,
        function: FunctionId,
        slots: &Slots,
        states: &StateBoxes,
        (from, until): (f64, f64),
    ) -> Interval {
        let agents = &self.agents;
        let boxes: Boxes<'_> = slots
            .iter()
            .zip(states)
            .map(|(&agent, states)| {
                let aux: &[f64] = if agent == ABSENT { &[] } else { &agents.agents[agent].aux };
                AgentBox { states, rates: &[], accelerations: &[], aux }
            })
            .collect();
        let mut out = [Interval::WHOLE];
        let kernel = self.program.kernel(function);
        self.reaches.ranges += 1;
        self.reaches.operations += 2 * kernel.operations();
        kernel.range(&boxes, Interval { lo: from, hi: until }, &mut self.registers, &mut out);
        out[0]
    }
}

/// Up to when `above` stays more than `within` above `below`, from `from` on and not beyond `end`: each a value, the time at
/// which it is taken, and bounds of its rate.
fn out_of_range(
    above: (f64, f64, Interval),
    below: (f64, f64, Interval),
    within: f64,
    accuracy: Accuracy,
    (from, end): (f64, f64),
) -> Option<f64> {
    let ((a, ta, ra), (b, tb, rb)) = (above, below);
    let size = a.abs() + b.abs() + (end - ta) * ra.mag() + (end - tb) * rb.mag();
    let range = within + 20.0 * accuracy.allowed(size);
    let slope = |t: f64, since: f64, after: f64, before: f64| if t < since { before } else { after };
    let low =
        |t: f64| a + (t - ta) * slope(t, ta, ra.lo, ra.hi) - (b + (t - tb) * slope(t, tb, rb.hi, rb.lo));
    let is_out = low(from) > range;
    if !is_out {
        return None;
    }
    // The bound is concave, and a line from the later of the two times on: above the range at both ends of a stretch, above it
    // between them.
    let closing = rb.hi - ra.lo;
    let meeting = (a - b - range - ta * ra.lo + tb * rb.hi) / closing;
    let until = if closing > 0.0 && meeting < end { meeting - 1e-9 * (meeting - from) } else { end };
    (until > from && low(until) > range).then_some(until)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn out_of_range_holds_whatever_the_rates_do() {
        let mut state = 7_u64;
        let mut die = |low: f64, high: f64| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            low + (high - low) * (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        let accuracy = Accuracy { tolerance: 1e-9, absolute: 1e-9 };
        let (mut n_out, mut n_bounded) = (0, 0);
        for _ in 0..20_000 {
            // The times at which the values are known lie before, in and beyond the stretch.
            let mut side = |at: f64| {
                let (one, other) = (die(-2.0, 2.0), die(-2.0, 2.0));
                (at + die(-3.0, 3.0), die(-1.0, 3.0), Interval { lo: one.min(other), hi: one.max(other) })
            };
            let (above, below) = (side(3.0), side(0.0));
            let (from, end) = (1.0, 1.0 + die(0.0, 5.0));
            let within = 0.5;
            let Some(until) = out_of_range(above, below, within, accuracy, (from, end)) else { continue };
            n_out += 1;
            n_bounded += u32::from(until < end);
            assert!(from < until && until <= end);
            for k in 0..=20 {
                let t = from + (until - from) * f64::from(k) / 20.0;
                // The worst that may be at t, on either side of where the value is known.
                let least = |(x, since, rate): (f64, f64, Interval), sign: f64| {
                    let ends = [rate.lo, rate.hi].map(|rate| sign * (x + (t - since) * rate));
                    sign * ends[0].min(ends[1])
                };
                let gap = least(above, 1.0) - least(below, -1.0);
                assert!(gap > within, "{above:?} {below:?} at {t} of [{from}, {until}]: {gap}");
            }
        }
        assert!(n_out > 2000 && n_bounded > 500, "{n_out} {n_bounded}");
    }
}
