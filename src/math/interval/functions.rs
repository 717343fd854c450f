//! Intervals of the elementary functions: the values at the ends and at the extremes between them, two steps wider.
//!
//! Two steps, because both the value at an end and the value at a member may be off by 1 ulp, in opposite directions.

use std::f64::consts::{FRAC_1_PI, PI};

use super::Interval;
use crate::math::elementary as scalar;

/// Two steps down.
#[inline(always)]
fn below(x: f64) -> f64 {
    x.next_down().next_down()
}

/// Two steps up.
#[inline(always)]
fn above(x: f64) -> f64 {
    x.next_up().next_up()
}

/// Whether an integer lies in `[first, last]`, or may, within the rounding of both.
#[inline(always)]
fn may_hold_integer(first: f64, last: f64) -> bool {
    let slack = (first.abs() + last.abs() + 1.0) * (8.0 * f64::EPSILON);
    (first - slack).ceil() <= last + slack
}

impl Interval {
    /// The image under a function that never falls.
    #[inline(always)]
    fn rising(self, function: impl Fn(f64) -> f64) -> Self {
        if self.is_whole() {
            return self;
        }
        Self::new(below(function(self.lo)), above(function(self.hi)))
    }

    /// The image under a function that never rises.
    #[inline(always)]
    fn falling(self, function: impl Fn(f64) -> f64) -> Self {
        if self.is_whole() {
            return self;
        }
        Self::new(below(function(self.hi)), above(function(self.lo)))
    }

    /// Kept within bounds that the function itself never leaves. WHOLE stays.
    #[inline(always)]
    fn within(self, lo: f64, hi: f64) -> Self {
        if self.is_whole() { self } else { Self { lo: self.lo.clamp(lo, hi), hi: self.hi.clamp(lo, hi) } }
    }

    /// The image of sine or cosine, whose maxima lie at the integers of `x / (2 pi) + phase`.
    #[inline(always)]
    fn wave(self, function: impl Fn(f64) -> f64, phase: f64) -> Self {
        if !self.is_finite() {
            return Self::WHOLE;
        }
        if self.hi - self.lo > 2.0 * PI {
            return Self { lo: -1.0, hi: 1.0 };
        }
        let (first, last) = (self.lo * (0.5 * FRAC_1_PI) + phase, self.hi * (0.5 * FRAC_1_PI) + phase);
        let at_ends = Self::point(function(self.lo)).hull(Self::point(function(self.hi)));
        let lo = if may_hold_integer(first + 0.5, last + 0.5) { -1.0 } else { below(at_ends.lo) };
        let hi = if may_hold_integer(first, last) { 1.0 } else { above(at_ends.hi) };
        Self { lo: lo.max(-1.0), hi: hi.min(1.0) }
    }

    /// All sines; WHOLE if unbounded.
    #[inline]
    pub fn sin(self) -> Self {
        self.wave(scalar::sin, -0.25)
    }

    /// All cosines; WHOLE if unbounded.
    #[inline]
    pub fn cos(self) -> Self {
        self.wave(scalar::cos, 0.0)
    }

    /// All tangents; WHOLE if there may be a pole.
    #[inline]
    pub fn tan(self) -> Self {
        let pole = may_hold_integer(self.lo * FRAC_1_PI + 0.5, self.hi * FRAC_1_PI + 0.5);
        if pole || !self.is_finite() { Self::WHOLE } else { self.rising(scalar::tan) }
    }

    /// All arc sines; WHOLE beyond ±1.
    #[inline]
    pub fn asin(self) -> Self {
        if self.mag() > 1.0 { Self::WHOLE } else { self.rising(scalar::asin) }
    }

    /// All arc cosines; WHOLE beyond ±1.
    #[inline]
    pub fn acos(self) -> Self {
        if self.mag() > 1.0 { Self::WHOLE } else { self.falling(scalar::acos).within(0.0, f64::INFINITY) }
    }

    /// All arc tangents.
    #[inline]
    pub fn atan(self) -> Self {
        self.rising(scalar::atan)
    }

    /// All angles of points (x, y) with `y` in `self`; from -pi to pi where the box touches the cut along negative x.
    #[inline]
    pub fn atan2(self, x: Self) -> Self {
        let y = self;
        if y.is_whole() || x.is_whole() {
            return Self::WHOLE;
        }
        if y.contains_zero() && x.lo <= 0.0 {
            return Self { lo: -PI.next_up(), hi: PI.next_up() };
        }
        // The corner that is turned furthest clockwise, and the one furthest the other way.
        let (first, last) = if y.lo >= 0.0 {
            let first = if x.hi >= 0.0 { y.lo } else { y.hi };
            let last = if x.lo >= 0.0 { y.hi } else { y.lo };
            ((first, x.hi), (last, x.lo))
        } else if y.hi <= 0.0 {
            let first = if x.lo >= 0.0 { y.lo } else { y.hi };
            let last = if x.hi >= 0.0 { y.hi } else { y.lo };
            ((first, x.lo), (last, x.hi))
        } else {
            ((y.lo, x.lo), (y.hi, x.lo))
        };
        Self::new(below(scalar::atan2(first.0, first.1)), above(scalar::atan2(last.0, last.1)))
    }

    /// All hyperbolic sines.
    #[inline]
    pub fn sinh(self) -> Self {
        self.rising(scalar::sinh)
    }

    /// All hyperbolic cosines.
    #[inline]
    pub fn cosh(self) -> Self {
        self.abs().rising(scalar::cosh).within(1.0, f64::INFINITY)
    }

    /// All hyperbolic tangents.
    #[inline]
    pub fn tanh(self) -> Self {
        self.rising(scalar::tanh).within(-1.0, 1.0)
    }

    /// All inverse hyperbolic sines.
    #[inline]
    pub fn asinh(self) -> Self {
        self.rising(scalar::asinh)
    }

    /// All inverse hyperbolic cosines; WHOLE below 1.
    #[inline]
    pub fn acosh(self) -> Self {
        if self.lo < 1.0 { Self::WHOLE } else { self.rising(scalar::acosh).within(0.0, f64::INFINITY) }
    }

    /// All inverse hyperbolic tangents; WHOLE at ±1 and beyond.
    #[inline]
    pub fn atanh(self) -> Self {
        if self.mag() >= 1.0 { Self::WHOLE } else { self.rising(scalar::atanh) }
    }

    /// All exponentials.
    #[inline]
    pub fn exp(self) -> Self {
        self.rising(scalar::exp).within(0.0, f64::INFINITY)
    }

    /// All natural logarithms; WHOLE at zero and below.
    #[inline]
    pub fn log(self) -> Self {
        if self.lo <= 0.0 { Self::WHOLE } else { self.rising(scalar::log) }
    }

    /// All logarithms to base 2; WHOLE at zero and below.
    #[inline]
    pub fn log2(self) -> Self {
        if self.lo <= 0.0 { Self::WHOLE } else { self.rising(scalar::log2) }
    }

    /// All logarithms to base 10; WHOLE at zero and below.
    #[inline]
    pub fn log10(self) -> Self {
        if self.lo <= 0.0 { Self::WHOLE } else { self.rising(scalar::log10) }
    }

    /// All cube roots.
    #[inline]
    pub fn cbrt(self) -> Self {
        self.rising(scalar::cbrt)
    }

    /// All hypotenuses.
    #[inline]
    pub fn hypot(self, other: Self) -> Self {
        if self.is_whole() || other.is_whole() {
            return Self::WHOLE;
        }
        let (lo, hi) = (scalar::hypot(self.mig(), other.mig()), scalar::hypot(self.mag(), other.mag()));
        Self { lo: below(lo).max(0.0), hi: if hi == 0.0 { 0.0 } else { above(hi) } }
    }

    /// All real powers. A base that is negative somewhere needs one integer as exponent, or the result is WHOLE; so it is
    /// where a base of zero meets a negative exponent.
    #[inline]
    pub fn pow(self, exponent: Self) -> Self {
        if exponent == Self::ZERO {
            return Self::ONE;
        }
        let pole = self.contains_zero() && exponent.lo < 0.0;
        if pole || self.is_whole() || exponent.is_whole() {
            return Self::WHOLE;
        }
        if self.lo >= 0.0 {
            return self.pow_of_positive(exponent);
        }
        let n = exponent.lo as i32;
        if !(exponent.is_point() && f64::from(n) == exponent.lo) {
            return Self::WHOLE;
        }
        if n % 2 == 0 {
            self.abs().pow_of_positive(exponent)
        } else if self.hi <= 0.0 {
            self.neg().pow_of_positive(exponent).neg()
        } else {
            // Both signs, so the exponent is positive and the power rises.
            self.rising_power(exponent.lo)
        }
    }

    /// All powers with an odd positive integer.
    #[inline]
    fn rising_power(self, exponent: f64) -> Self {
        Self::new(below(scalar::pow(self.lo, exponent)), above(scalar::pow(self.hi, exponent)))
    }

    /// All powers of a base that is nowhere negative: monotone in either operand, so the corners bound it.
    #[inline]
    fn pow_of_positive(self, exponent: Self) -> Self {
        let corner = |x: f64, y: f64| Self::point(scalar::pow(x.abs(), y));
        let at_lo = corner(self.lo, exponent.lo).hull(corner(self.hi, exponent.lo));
        if exponent.is_point() {
            return Self { lo: below(at_lo.lo).max(0.0), hi: above(at_lo.hi) };
        }
        let at_hi = corner(self.lo, exponent.hi).hull(corner(self.hi, exponent.hi));
        let all = at_lo.hull(at_hi);
        Self { lo: below(all.lo).max(0.0), hi: above(all.hi) }
    }
}
