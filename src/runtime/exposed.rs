//! Pairs whose hazard flows and whose guard is true: how much of it has been taken away, and what is known of it beyond.

use rustc_hash::FxHashMap;

use crate::runtime::present::Present;

/// A pair that is exposed.
#[derive(Clone, Copy, Debug)]
pub struct Exposure {
    /// The arming of its instance; void if that has another one now.
    pub arming: u32,
    /// Up to when the hazard has been taken away for good, s.
    pub since: f64,
    /// What is left then.
    pub left: f64,
    /// Up to when the integral is known, s; infinite if nothing is left before the end of that.
    pub known: f64,
    /// What is left then.
    pub rest: f64,
    /// When nothing is left, s.
    pub due: Option<f64>,
    /// What the hazard is from `known` on, if that is no hazard.
    pub undefined: Option<f64>,
}

impl Exposure {
    /// With this left at `now`, and nothing known beyond.
    pub fn beginning(arming: u32, now: f64, left: f64) -> Self {
        Self { arming, since: now, left, known: now, rest: left, due: None, undefined: None }
    }
}

/// All pairs that are exposed.
#[derive(Default)]
pub struct Exposures {
    /// By the number of their instance.
    pub of: FxHashMap<u32, Exposure>,
    /// Whether there is a hazard that reads more agents than the two.
    pub are_wide: bool,
    /// Rows of times between the last instant and the cover.
    pub rows: Option<Present>,
}
