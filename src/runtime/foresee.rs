//! Foresight: whether a comparison can change in a window, by the tracks of the cold agents that it reads.
//!
//! A track is the dense output that would be certified if the agent took its steps in turn. Where bounds of it over pieces
//! of the window keep the comparison clear of zero, it is certified by them, and its agents stay cold.

use smallvec::SmallVec;

use crate::codegen::program::{FunctionId, Near};
use crate::math::Interval;
use crate::runtime::engine::Engine;
use crate::runtime::population::{ABSENT, Slots};
use crate::runtime::sleep::StateBoxes;

/// So many pieces of a window are looked at.
const PIECES_MAX: usize = 24;
/// A piece that is a smaller share of what is looked at is not divided.
const PIECE_LEAST: f64 = 1.0 / 16.0;

impl Engine<'_, '_> {
    /// Certifies a comparison that can be bounded by tracks up to `until`; or up to where it is not certain that it does not
    /// change, and false.
    pub fn foresee(&mut self, index: usize, until: f64) -> bool {
        let (atom, slots) = self.guards.atom_slots(&self.agents, index);
        let state = self.guards.atoms[index];
        let mut pieces: SmallVec<[(f64, f64); 8]> = SmallVec::new();
        pieces.push((state.certified, until));
        let least = PIECE_LEAST * (until - state.certified);
        let mut n_pieces = 0;
        while let Some((from, to)) = pieces.pop() {
            n_pieces += 1;
            let bound = self.range_by_tracks(atom.value, &slots, (from, to));
            if bound.is_some_and(|bound| state.is_kept_by(bound)) {
                continue;
            }
            let middle = 0.5 * (from + to);
            let is_small = to - from < least || !(from < middle && middle < to);
            if bound.is_none() || is_small || n_pieces + pieces.len() + 2 > PIECES_MAX {
                self.certified(index, from);
                return false;
            }
            pieces.extend([(middle, to), (from, middle)]);
        }
        self.certified(index, until);
        true
    }

    /// The same by bounds of the states of cold agents over all of the window that ends at `until`: a cheap look.
    pub fn foresee_by_bounds(&mut self, index: usize, until: f64) -> bool {
        if !self.is_bounded(index) {
            return false;
        }
        let state = self.guards.atoms[index];
        let cold = &self.agents.cold;
        if let Some(near) = self.guards.far_where_apart(index) {
            let [a, b] = self.guards.instances[state.instance as usize].roots.map(|agent| agent as usize);
            if !cold.is_cold(a) || !cold.is_cold(b) {
                return false;
            }
            let (a, b) = (cold.bounds(a), cold.bounds(b));
            let is_apart = |near: &Near| {
                near.states()
                    .is_some_and(|[own, other]| a[own].sub(b[other]).mig() > near.within * (1.0 + 1e-12))
            };
            if near.iter().any(is_apart) {
                self.certified(index, until);
                return true;
            }
            return false;
        }
        let (atom, slots) = self.guards.atom_slots(&self.agents, index);
        let mut states = StateBoxes::new();
        for (slot, &agent) in slots.iter().enumerate() {
            let is_read = atom.slots.contains(&slot);
            if is_read && !cold.is_cold(agent) {
                return false;
            }
            states.push(if is_read { cold.bounds(agent).into() } else { SmallVec::new() });
        }
        let bound = self.range_over(atom.value, &slots, &states, (state.certified, until));
        let is_kept = state.is_kept_by(bound);
        if is_kept {
            self.certified(index, until);
        }
        is_kept
    }

    /// Whether bounds of what a comparison reads exclude that it changes in [from, to], over which its agents are known.
    pub fn is_clear(&mut self, index: usize, span: (f64, f64)) -> bool {
        if !self.is_bounded(index) {
            return false;
        }
        let (atom, slots) = self.guards.atom_slots(&self.agents, index);
        let bound = self.range_by_tracks(atom.value, &slots, span);
        bound.is_some_and(|bound| self.guards.atoms[index].is_kept_by(bound))
    }

    /// Bounds of a function of states over [from, to]; none if it reads an agent whose way there is not known.
    pub fn range_by_tracks(
        &mut self,
        function: FunctionId,
        slots: &Slots,
        span: (f64, f64),
    ) -> Option<Interval> {
        let n_states =
            |&agent: &usize| if agent == ABSENT { 0 } else { self.agents.agents[agent].states.len() };
        let unknown = |agent: &usize| SmallVec::from_elem(Interval::WHOLE, n_states(agent));
        let mut states: StateBoxes = slots.iter().map(unknown).collect();
        for &(slot, state) in &self.program.kernel(function).reads().states {
            states[slot][state] = self.range_of_state(slots[slot], state, span)?;
        }
        Some(self.range_over(function, slots, &states, span))
    }

    /// Bounds of a state of an agent over [from, to], by its last segment and, if it is cold, its track.
    fn range_of_state(&self, agent: usize, state: usize, (from, to): (f64, f64)) -> Option<Interval> {
        let segment = &self.agents.agents[agent].segment;
        if !self.agents.cold.is_cold(agent) {
            let is_covered = segment.start <= from && to <= segment.end;
            return is_covered.then(|| segment.range(state, from, to));
        }
        let known = self.agents.cold.known_from(agent);
        if from >= known {
            return self.agents.cold.range(agent, state, (from, to));
        }
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
