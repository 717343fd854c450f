//! What is known of the instant at hand only as well as its time is: comparisons that are zero at it, and what is written from such a
//! zero; states that came to it along a flow that ends there (rule 3).

use rustc_hash::FxHashMap;

use crate::runtime::solve::{time_resolution, ulp};

/// How well the time of a root is known, in units of its last place; the rounding of the states there included.
const ROOT_ULPS: f64 = 64.0;

/// How well the time of a root at `t` is known, s: roots that are no farther apart are not told apart. At most the resolution of time.
pub fn root_width(t: f64) -> f64 {
    (ROOT_ULPS * ulp(t)).min(time_resolution(t))
}

/// What is known of a comparison that is on its boundary.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Zero {
    /// What is computed from it may be as far from zero.
    pub width: f64,
    /// Whether its rates decide while it stays there: it has fired there, or has been armed there by a transition.
    pub by_rates: bool,
}

impl Zero {
    /// Of a root with this rate, looked at `t`, which is up to `off` s away from it. None if the rate says nothing.
    pub fn of_root(rate: f64, off: f64, t: f64) -> Option<Self> {
        let width = rate.abs() * (off + root_width(t));
        width.is_finite().then_some(Self { width, by_rates: false })
    }

    /// Its width, from that of a boundary: a rate times the resolution of time.
    pub fn width_of(slack: f64, t: f64) -> f64 {
        slack * root_width(t) / time_resolution(t)
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

/// How agents came to the instant at hand: what goes on from there is known as well as its time is, by the rates along the flows that
/// led there.
#[derive(Debug, Default)]
pub struct Approach {
    at: f64,
    /// By agent whose flow ends here: its rates before, zero of what has been written.
    rates: FxHashMap<usize, Vec<f64>>,
}

impl Approach {
    /// Begins an instant at `at`.
    pub fn begin(&mut self, at: f64) {
        if self.at != at {
            self.at = at;
            self.rates.clear();
        }
    }

    /// Notes the rates along which an agent came to the instant at `at`, if nothing is known of that.
    pub fn note(&mut self, agent: usize, at: f64, rates: impl FnOnce() -> Vec<f64>) {
        self.begin(at);
        self.rates.entry(agent).or_insert_with(rates);
    }

    /// Notes that a state of an agent is given at `at`, not reached.
    pub fn give(&mut self, agent: usize, state: usize, at: f64) {
        self.begin(at);
        if let Some(rates) = self.rates.get_mut(&agent) {
            rates[state] = 0.0;
        }
    }

    /// The rates along which an agent came to the instant at `at`.
    pub fn rates(&self, agent: usize, at: f64) -> Option<&[f64]> {
        if self.at == at { self.rates.get(&agent).map(Vec::as_slice) } else { None }
    }
}
