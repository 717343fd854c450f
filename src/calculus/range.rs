//! Over which agents a quantifier or an aggregate goes, and how near two agents must be to matter to each other.

use crate::calculus::layout::Entry;

/// Agents that a quantifier binds one after the other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Range {
    /// The slot it binds.
    pub slot: usize,
    /// The type.
    pub ty: usize,
    /// Without self (in an interaction: without both participants).
    pub other: bool,
}

/// `|a.x - b.y| <= within`, for x a state, a parameter or a discrete variable of the agent in slot 0 and y one of the agent in
/// slot 1 or in that of a quantifier.
///
/// Bounds of differences of real numbers: where states are so large that their own rounding counts, so it does here.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Near {
    /// Of the agent in slot 0.
    pub own: Entry,
    /// Of the other one.
    pub other: Entry,
    /// At least 0; infinite if it depends on the link (see [`Keys`]).
    pub within: f64,
}

impl Near {
    /// What is compared of the agent on one side, 0 or 1.
    pub fn entry(&self, side: usize) -> Entry {
        if side == 0 { self.own } else { self.other }
    }

    /// The two states, if it is of states.
    pub fn states(&self) -> Option<[usize; 2]> {
        match (self.own, self.other) {
            (Entry::State(own), Entry::State(other)) => Some([own, other]),
            _ => None,
        }
    }
}

/// By how near another agent is, a lower bound of a key: of `nearest o in S where F(o) by K(o)`, what K(o) is at least where F(o) holds
/// and `|a.x - o.y|` is at least 2^((j - 96)/4), for j = 0, 1, ...; rising.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Keys(Vec<f64>);

/// How many distances there are to an octave.
const PER_OCTAVE: i32 = 4;
/// The exponents of two of the least distance and of one beyond the greatest.
const OCTAVES: std::ops::Range<i32> = -24..40;

impl Keys {
    /// Asks for a bound at each distance.
    pub fn new(mut least: impl FnMut(f64) -> f64) -> Self {
        let mut greatest = f64::NEG_INFINITY;
        // Who is farther away is also at least so far away.
        let mut bound = |k| {
            greatest = f64::max(greatest, least(distance(k)));
            greatest
        };
        Self((0..PER_OCTAVE * OCTAVES.len() as i32).map(&mut bound).collect())
    }

    /// Beyond which distance nobody has a lesser key; infinite if that is not known.
    pub fn within(&self, key: f64) -> f64 {
        if key.is_nan() {
            return f64::INFINITY;
        }
        let found = self.0.partition_point(|&least| least < key);
        if found == self.0.len() { f64::INFINITY } else { distance(found as i32) }
    }

    /// What the key of anybody beyond a distance is at least.
    pub fn beyond(&self, within: f64) -> f64 {
        let nearer = (0..self.0.len()).take_while(|&k| distance(k as i32) <= within).count();
        if nearer == 0 { f64::NEG_INFINITY } else { self.0[nearer - 1] }
    }

    /// Whether nothing is known.
    pub fn is_empty(&self) -> bool {
        self.0.iter().all(|&least| least == f64::NEG_INFINITY)
    }
}

fn distance(k: i32) -> f64 {
    f64::exp2(f64::from(OCTAVES.start * PER_OCTAVE + k) / f64::from(PER_OCTAVE))
}
