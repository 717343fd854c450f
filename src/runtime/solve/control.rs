//! Step-size control: when a step is good enough, and how long the next one should be.
//!
//! A step is accepted when max over i of |err_i| / (absolute + tolerance |x_i|) <= 1. The next step follows the
//! proportional-integral rule of Gustafsson (1991), as in Hairer & Wanner, Solving ODEs II, IV.2.

use crate::math::Interval;
use crate::math::elementary::{exp, log};

/// The accuracy asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Accuracy {
    /// Relative.
    pub tolerance: f64,
    /// Absolute, in the unit of each state.
    pub absolute: f64,
}

impl Accuracy {
    /// The error that is allowed of a state of this size.
    #[inline(always)]
    pub fn allowed(&self, size: f64) -> f64 {
        self.absolute + self.tolerance * size
    }

    /// The size of the error in units of what is allowed; NaN if any number is.
    pub fn error_norm(&self, error: &[f64], x: &[f64], x_new: &[f64]) -> f64 {
        let mut norm: f64 = 0.0;
        for i in 0..error.len() {
            let scale = self.allowed(x[i].abs().max(x_new[i].abs()));
            let ratio = error[i].abs() / scale;
            if ratio.is_nan() || !x_new[i].is_finite() {
                return f64::NAN;
            }
            norm = norm.max(ratio);
        }
        norm
    }

    /// Bounds of a state with room for what the integration may be off by.
    pub fn padded(&self, bound: Interval) -> Interval {
        let pad = 10.0 * self.allowed(bound.mag());
        Interval { lo: bound.lo - pad, hi: bound.hi + pad }
    }
}

/// The memory of the controller of one group.
#[derive(Clone, Copy, Debug)]
pub struct Control {
    /// Error norm of the last accepted step.
    last: f64,
}

impl Default for Control {
    fn default() -> Self {
        Self { last: 1e-4 }
    }
}

const SAFETY: f64 = 0.9;
const SHRINK: f64 = 0.2;

/// How the next step may be chosen; `order` is the power of the step with which the estimated error falls.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Pace {
    /// As the errors say, but at most `grow` times as long.
    Free {
        /// See above.
        order: f64,
        /// At least 1.
        grow: f64,
    },
    /// As long as it was: the steps that start a method of several steps lie evenly, and their errors are not its own.
    Hold {
        /// See above.
        order: f64,
    },
}

impl Default for Pace {
    fn default() -> Self {
        Pace::Hold { order: 1.0 }
    }
}

impl Control {
    /// The factor for the next step after an accepted one with this error norm.
    pub fn accepted(&mut self, norm: f64, pace: Pace) -> f64 {
        let Pace::Free { order, grow } = pace else { return 1.0 };
        let norm = norm.max(1e-10);
        let factor = SAFETY * pow(norm, -0.7 / order) * pow(self.last, 0.4 / order);
        self.last = norm.max(1e-4);
        factor.clamp(SHRINK, grow)
    }

    /// The factor for another try after a rejected step; a quarter where the error is no number.
    pub fn rejected(&self, norm: f64, pace: Pace) -> f64 {
        let (Pace::Free { order, .. } | Pace::Hold { order }) = pace;
        if norm.is_finite() { (SAFETY * pow(norm, -1.0 / order)).clamp(SHRINK, 0.9) } else { 0.25 }
    }
}

/// x^y for x > 0, near enough for a step size.
fn pow(x: f64, y: f64) -> f64 {
    exp(y * log(x))
}
