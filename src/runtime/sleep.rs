//! Sleeping beyond a window (I6): how long a comparison cannot change, by where its agents can get to.

use smallvec::SmallVec;

use crate::codegen::kernel::AgentBox;
use crate::math::Interval;
use crate::runtime::engine::Engine;
use crate::runtime::population::ABSENT;
use crate::runtime::present::{Boxes, Depth, depth_read};

/// How often at most a shorter time is tried.
const TRIES: usize = 5;
/// By how much it is shorter.
const SHRINK: f64 = 0.25;

impl Engine<'_, '_> {
    /// Up to when a comparison cannot change, if that is certain up to `least` at least; the agents need not have come
    /// that far.
    pub fn sleep_beyond(&mut self, index: usize, least: f64) -> Option<f64> {
        let (atom, slots) = self.guards.atom_slots(&self.agents, index);
        let kernel = self.program.kernel(atom.value);
        let absent = atom.slots.iter().any(|&slot| slots[slot] == ABSENT);
        if absent || !atom.folds.is_empty() || depth_read(kernel) != Depth::States {
            return None;
        }
        let state = self.guards.atoms[index];
        let (from, truth) = (state.certified, state.truth);
        let end = if self.time_end.is_finite() { self.time_end } else { least.max(from + 1e6) };
        let least = least.min(end);
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

    /// Bounds of a comparison's g over a stretch of time.
    fn value_range(&mut self, index: usize, (from, until): (f64, f64)) -> Interval {
        let (atom, slots) = self.guards.atom_slots(&self.agents, index);
        let mut states: SmallVec<[SmallVec<[Interval; 8]>; 2]> = SmallVec::new();
        let (agents, groups) = (&self.agents, &self.groups.groups);
        for (slot, &agent) in slots.iter().enumerate() {
            let mut bounds = SmallVec::new();
            if agent != ABSENT && atom.slots.contains(&slot) {
                self.reaches.states(agents, groups, &mut self.enclosures, agent, (from, until), &mut bounds);
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
