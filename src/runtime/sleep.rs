//! Sleeping beyond a window (I6): how long a comparison cannot change, by where its agents can get to.

use smallvec::SmallVec;

use crate::codegen::kernel::AgentBox;
use crate::codegen::program::Slot;
use crate::math::Interval;
use crate::runtime::act::Written;
use crate::runtime::engine::Engine;
use crate::runtime::paper::Form;
use crate::runtime::population::ABSENT;
use crate::runtime::present::{Boxes, Depth, depth_read};
use crate::runtime::solve::control::Accuracy;

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
        if self.guards.atoms[index].left_out {
            return true;
        }
        let bound = self.value_range(index, (self.present.time, self.time_end));
        if bound.contains_zero() {
            return false;
        }
        let far = self.is_pure(index);
        let state = &mut self.guards.atoms[index];
        (state.truth, state.touched, state.rooted) = (bound.hi < 0.0, false, false);
        (state.certified, state.flip, state.settled, state.far) = (self.time_end, f64::INFINITY, false, far);
        state.version += 1;
        true
    }

    /// Whether what was written leaves a comparison certified as far as it is: nothing that it reads has changed, nor what
    /// bounds the rates of that.
    pub fn stays_far(&mut self, index: usize, written: &Written) -> bool {
        if !self.guards.atoms[index].far {
            return false;
        }
        let (atom, slots) = self.guards.atom_slots(&self.agents, index);
        self.present.make(&self.agents, &slots, Depth::States);
        let states = &self.program.kernel(atom.value).reads().states;
        atom.slots.iter().all(|&slot| {
            let agent = slots[slot];
            let Some((before, aux)) = written.before.get(&agent) else {
                return !written.restarted.contains(&agent);
            };
            let moved = written.moves.iter().any(|change| change.agent == agent);
            let read = states.iter().filter(|read| read.0 == slot);
            let now = self.present.states(agent);
            !moved
                && aux == &self.agents.agents[agent].aux
                && read.into_iter().all(|&(_, column)| before[column] == now[column])
        })
    }

    /// Whether the box of each agent that a comparison reads rests on bounds of rates alone.
    fn is_pure(&self, index: usize) -> bool {
        let definition = self.guards.definition(self.guards.atoms[index].instance);
        let (atom, slots) = self.guards.atom_slots(&self.agents, index);
        let by_links = definition.frame.slots.iter().any(|slot| matches!(slot, Slot::Link { .. }));
        !by_links && atom.slots.iter().all(|&slot| self.reaches.is_pure(slots[slot]))
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
        let until = if self.is_bounded(index) { self.sleeping_time(index, least) } else { None };
        if let Some(until) = until {
            self.certified(index, until);
            self.guards.atoms[index].far = self.is_pure(index);
        }
        until.is_some()
    }

    /// Up to when a comparison cannot change, if that is certain up to `least` at least.
    fn sleeping_time(&mut self, index: usize, least: f64) -> Option<f64> {
        let state = self.guards.atoms[index];
        let (from, truth) = (state.certified, state.truth);
        let end = if self.time_end.is_finite() { self.time_end } else { least.max(from + 1e6) };
        let least = least.min(end);
        if let Some(until) = self.distant_until(index, from, end).filter(|&until| until >= least) {
            return Some(until);
        }
        let mut until = if state.stride > 0.0 { (from + state.stride).clamp(least, end) } else { end };
        for attempt in 0..TRIES {
            if attempt + 1 == TRIES {
                until = least;
            }
            let bound = self.value_range(index, (from, until));
            if if truth { bound.hi < 0.0 } else { bound.lo > 0.0 } {
                self.guards.atoms[index].stride = 2.0 * (until - from);
                return Some(until);
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
    fn distant_until(&mut self, index: usize, from: f64, end: f64) -> Option<f64> {
        let state = &self.guards.atoms[index];
        let definition = self.guards.definition(state.instance);
        let near = definition.near;
        if near.is_empty() || !self.time_end.is_finite() || definition.comparisons.len() != 1 || state.truth {
            return None;
        }
        let [a, b] = self.guards.instances[state.instance as usize].roots.map(|agent| agent as usize);
        let (agents, groups) = (&self.agents, &self.groups.groups);
        let now = self.present.time;
        let (ta, xa) = agents.anchor(a, groups[agents.agents[a].group].clock, now);
        let (tb, xb) = agents.anchor(b, groups[agents.agents[b].group].clock, now);
        let mut distant = None;
        for near in near {
            let ra = self.reaches.rate(agents, groups, a, near.own, (ta, &xa))?;
            let rb = self.reaches.rate(agents, groups, b, near.other, (tb, &xb))?;
            let (a, b) = (xa[near.own], xb[near.other]);
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
        distant
    }

    /// Bounds of a comparison's g over a stretch of time.
    fn value_range(&mut self, index: usize, (from, until): (f64, f64)) -> Interval {
        let (atom, slots) = self.guards.atom_slots(&self.agents, index);
        let mut states: SmallVec<[SmallVec<[Interval; 8]>; 2]> = SmallVec::new();
        let (agents, groups) = (&self.agents, &self.groups.groups);
        for (slot, &agent) in slots.iter().enumerate() {
            let mut bounds = SmallVec::new();
            if agent != ABSENT && atom.slots.contains(&slot) {
                let span = (self.present.time, from, until);
                self.reaches.states(agents, groups, &mut self.enclosures, agent, span, &mut bounds);
            }
            states.push(bounds);
        }
        let boxes: Boxes<'_> = slots
            .iter()
            .zip(&states)
            .map(|(&agent, states)| {
                let aux: &[f64] = if agent == ABSENT { &[] } else { &agents.agents[agent].aux };
                AgentBox { states, rates: &[], accelerations: &[], aux }
            })
            .collect();
        let mut out = [Interval::WHOLE];
        let kernel = self.program.kernel(atom.value);
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
    let range = within + 20.0 * (accuracy.absolute + accuracy.tolerance * size);
    let low = |t: f64| a + (t - ta) * ra.lo - (b + (t - tb) * rb.hi);
    let is_out = low(from) > range;
    if !is_out {
        return None;
    }
    // The bound is a line: above the range at both ends, above it between them.
    let closing = rb.hi - ra.lo;
    let meeting = (a - b - range - ta * ra.lo + tb * rb.hi) / closing;
    let until = if closing > 0.0 && meeting < end { meeting - 1e-9 * (meeting - from) } else { end };
    (until > from && low(until) > range).then_some(until)
}
