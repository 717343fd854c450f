//! Foresight: whether a comparison can change in a window, by the tracks of the cold agents that it reads.
//!
//! A track is the dense output that would be certified if the agent took its steps in turn. Where bounds of it over pieces
//! of the window keep the comparison clear of zero, it is certified by them, and its agents stay cold.

use smallvec::SmallVec;

use crate::codegen::program::FunctionId;
use crate::math::Interval;
use crate::runtime::engine::Engine;
use crate::runtime::population::{ABSENT, Slots};
use crate::runtime::sleep::StateBoxes;

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
        let state = self.guards.atoms[index];
        let mut pieces: SmallVec<[(f64, f64); 8]> = SmallVec::new();
        pieces.push((state.certified, until));
        let mut n_pieces = 0;
        while let Some((from, to)) = pieces.pop() {
            n_pieces += 1;
            let Some(bound) = self.range_by_tracks(atom.value, &slots, (from, to)) else { return false };
            if state.is_kept_by(bound) {
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
    fn range_by_tracks(&mut self, function: FunctionId, slots: &Slots, span: (f64, f64)) -> Option<Interval> {
        let n_states =
            |&agent: &usize| if agent == ABSENT { 0 } else { self.agents.agents[agent].states.len() };
        let unknown = |agent: &usize| SmallVec::from_elem(Interval::WHOLE, n_states(agent));
        let mut states: StateBoxes = slots.iter().map(unknown).collect();
        for &(slot, state) in &self.program.kernel(function).reads().states {
            states[slot][state] = self.range_of_state(slots[slot], state, span)?;
        }
        Some(self.range_over(function, slots, &states, span))
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
