//! Comparisons that are zero at the instant at hand: what is written from such a zero is zero again, as well as the root is known (rule 3).

use rustc_hash::FxHashMap;

use crate::runtime::solve::{time_resolution, ulp};

/// How well the time of a root is known, in units of its last place; the rounding of the states there included.
const ROOT_ULPS: f64 = 64.0;

/// What is known of a comparison that is on its boundary.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Zero {
    /// What is computed from it may be as far from zero.
    pub width: f64,
    /// Whether its rates decide while it stays there: it has fired there, or has been armed there by a transition.
    pub by_rates: bool,
}

impl Zero {
    /// Of a root at `t` with this rate. None if the rate says nothing.
    pub fn of_root(rate: f64, t: f64) -> Option<Self> {
        let width = rate.abs() * ROOT_ULPS * ulp(t);
        width.is_finite().then_some(Self { width, by_rates: false })
    }

    /// Its width, from that of a boundary: a rate times the resolution of time.
    pub fn width_of(slack: f64, t: f64) -> f64 {
        slack * ROOT_ULPS * ulp(t) / time_resolution(t)
    }
}

/// By atom, for one instant.
#[derive(Debug, Default)]
pub struct Zeros {
    at: f64,
    known: FxHashMap<u32, Zero>,
}

impl Zeros {
    /// What is known of a comparison at `time`.
    pub fn get(&self, index: usize, time: f64) -> Option<Zero> {
        if self.at != time || self.known.is_empty() {
            return None;
        }
        self.known.get(&(index as u32)).copied()
    }

    /// Notes whether a comparison is on its boundary at `time`; what was known of other times is forgotten.
    pub fn set(&mut self, index: usize, time: f64, zero: Option<Zero>) {
        if self.at != time {
            self.forget();
            self.at = time;
        }
        match zero {
            Some(zero) => _ = self.known.insert(index as u32, zero),
            None => _ = self.known.remove(&(index as u32)),
        }
    }

    /// Forgets everything: comparisons have other numbers now.
    pub fn forget(&mut self) {
        self.known.clear();
    }
}
