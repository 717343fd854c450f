//! Foresight: whether a comparison can change in a window, by the tracks of the cold agents that it reads.
//!
//! A track is the dense output that would be certified if the agent took its steps in turn. Where bounds of it over pieces
//! of the window keep the comparison clear of zero, it is certified by them, and its agents stay cold.

use smallvec::SmallVec;

use crate::codegen::kernel::AgentBox;
use crate::codegen::program::FunctionId;
use crate::math::Interval;
use crate::runtime::engine::Engine;
use crate::runtime::population::{ABSENT, Slots};
use crate::runtime::present::Boxes;

/// So many pieces of a window are looked at.
const PIECES_MAX: usize = 24;

impl Engine<'_, '_> {
    /// Certifies a comparison up to `until`, if it is certain by tracks that it does not change before. False, and nothing is
    /// done, if it is not.
    pub fn foresee(&mut self, index: usize, until: f64) -> bool {
        if !self.is_bounded(index) {
            return false;
        }
        let (atom, slots) = self.guards.atom_slots(&self.agents, index);
        let state = &self.guards.atoms[index];
        let truth = state.truth;
        let mut pieces: SmallVec<[(f64, f64); 8]> = SmallVec::new();
        pieces.push((state.certified, until));
        let mut n_pieces = 0;
        while let Some((from, to)) = pieces.pop() {
            n_pieces += 1;
            let Some(bound) = self.range_by_tracks(atom.value, &slots, (from, to)) else { return false };
            if if truth { bound.hi < 0.0 } else { bound.lo > 0.0 } {
                continue;
            }
            let middle = 0.5 * (from + to);
            if n_pieces + pieces.len() + 2 > PIECES_MAX || !(from < middle && middle < to) {
                return false;
            }
            pieces.extend([(middle, to), (from, middle)]);
        }
        self.certified(index, until);
        true
    }

    /// Bounds of a function of states over [from, to]; none if it reads an agent whose way there is not known.
    fn range_by_tracks(
        &mut self,
        function: FunctionId,
        slots: &Slots,
        (from, to): (f64, f64),
    ) -> Option<Interval> {
        let kernel = self.program.kernel(function);
        let n_states =
            |&agent: &usize| if agent == ABSENT { 0 } else { self.agents.agents[agent].states.len() };
        let firsts: SmallVec<[usize; 4]> = slots
            .iter()
            .scan(0, |next, agent| {
                let first = *next;
                *next += n_states(agent);
                Some(first)
            })
            .collect();
        let total = slots.iter().map(n_states).sum();
        let mut states: SmallVec<[Interval; 16]> = SmallVec::from_elem(Interval::WHOLE, total);
        for &(slot, state) in &kernel.reads().states {
            states[firsts[slot] + state] = self.range_of_state(slots[slot], state, (from, to))?;
        }
        let boxes: Boxes<'_> = slots
            .iter()
            .zip(&firsts)
            .map(|(agent, &first)| {
                let aux: &[f64] = if *agent == ABSENT { &[] } else { &self.agents.agents[*agent].aux };
                AgentBox { states: &states[first..][..n_states(agent)], rates: &[], accelerations: &[], aux }
            })
            .collect();
        let mut out = [Interval::WHOLE];
        self.reaches.ranges += 1;
        self.reaches.operations += 2 * kernel.operations();
        kernel.range(&boxes, Interval { lo: from, hi: to }, &mut self.registers, &mut out);
        Some(out[0])
    }

    /// Bounds of a state of an agent over [from, to], by its last segment and its track.
    fn range_of_state(&self, agent: usize, state: usize, (from, to): (f64, f64)) -> Option<Interval> {
        if !self.agents.cold.is_cold(agent) {
            return None;
        }
        let known = self.agents.cold.known_from(agent);
        if from >= known {
            return self.agents.cold.range(agent, state, (from, to));
        }
        let segment = &self.agents.agents[agent].segment;
        if !(segment.start <= from && known <= segment.end) {
            return None;
        }
        let before = segment.range(state, from, to.min(known));
        if to <= known {
            return Some(before);
        }
        Some(before.hull(self.agents.cold.range(agent, state, (known, to))?))
    }
}
