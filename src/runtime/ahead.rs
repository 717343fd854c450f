//! The way ahead: steps of an agent beyond its clock, taken because the flows of others read it (rule 13).
//!
//! Whoever reads a leader in its flow needs the leader's way over the whole of its next step. The leader takes its steps in
//! time, keeps their dense output, and has them as its own when its clock comes to them. An event that writes it, or whom
//! it reads, cuts them away.

use std::collections::VecDeque;

use crate::runtime::solve::leads_on;
use crate::runtime::solve::segment::Segment;

/// One step beyond the clock.
#[derive(Clone, Debug)]
pub struct Way {
    /// The trajectory.
    pub segment: Segment,
    /// The states at its end.
    pub states: Vec<f64>,
}

/// The steps beyond the clock, the first of them first.
#[derive(Clone, Debug, Default)]
#[expect(clippy::box_collection, reason = "one word in every agent: few are followed")]
pub struct Ahead(Option<Box<VecDeque<Way>>>);

impl Ahead {
    /// The farthest step.
    pub fn last(&self) -> Option<&Way> {
        self.0.as_ref()?.back()
    }

    /// Adds a step.
    pub fn push(&mut self, way: Way) {
        self.0.get_or_insert_default().push_back(way);
    }

    /// Where each step ends, s.
    pub fn ends(&self) -> impl Iterator<Item = f64> {
        self.0.iter().flat_map(|ways| ways.iter()).map(|way| way.segment.end)
    }

    /// The trajectory of each step.
    pub fn segments(&self) -> impl Iterator<Item = &Segment> {
        self.0.iter().flat_map(|ways| ways.iter()).map(|way| &way.segment)
    }

    /// Takes the first step.
    pub fn pop(&mut self) -> Option<Way> {
        self.0.as_mut()?.pop_front()
    }

    /// Forgets all steps.
    pub fn clear(&mut self) {
        self.0 = None;
    }

    /// The step that covers `t`; of two, the first; beyond the last, the last.
    pub fn covering(&self, t: f64) -> Option<&Way> {
        let ways = self.0.as_ref()?;
        ways.iter().find(|way| t <= way.segment.end).or(ways.back())
    }

    /// The number of the step on which the way leads on from `t`.
    pub fn leading_from(&self, t: f64) -> Option<usize> {
        self.0.as_ref()?.iter().position(|way| leads_on(t, way.segment.end))
    }

    /// A step by its number.
    pub fn get(&mut self, number: usize) -> Option<&mut Way> {
        self.0.as_mut()?.get_mut(number)
    }
}
