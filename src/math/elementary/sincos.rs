//! Sine and cosine: reduction modulo pi/2, both kernels on [-pi/4, pi/4], and a choice by quadrant without a branch.
//!
//! The coefficients are minimax fits (Remez) of `(sin(r)/r - 1)/r^2` and `(cos(r) - 1 + r^2/2)/r^4` in `r^2`.

use super::quadrant::{Angle, reduce, reduce_moderate};
use super::twofold::{polynomial, product};

const SINE: [f64; 6] = [
    -0.16666666666666632,
    0.00833333333332242,
    -0.00019841269829812538,
    2.7557313693587328e-06,
    -2.50507583837104e-08,
    1.5896811681197434e-10,
];

const COSINE: [f64; 6] = [
    0.0416666666666666,
    -0.0013888888888874131,
    2.4801587289486877e-05,
    -2.7557314353737077e-07,
    2.0875723470743457e-09,
    -1.135965836945903e-11,
];

/// Sine of a reduced angle, without its quadrant.
#[inline(always)]
fn sine_kernel(angle: Angle) -> f64 {
    let Angle { hi, lo, .. } = angle;
    let square = hi * hi;
    hi + (hi * (square * polynomial(square, &SINE)) + lo * (1.0 - 0.5 * square))
}

/// Cosine of a reduced angle, without its quadrant.
#[inline(always)]
fn cosine_kernel(angle: Angle) -> f64 {
    let Angle { hi, lo, .. } = angle;
    let square = product(hi, hi);
    let half = 0.5 * square.hi;
    let main = 1.0 - half;
    let rest = square.hi * square.hi * polynomial(square.hi, &COSINE) - (hi * lo + 0.5 * square.lo);
    main + (((1.0 - main) - half) + rest)
}

/// Sine, within 1 unit in the last place for every finite `x`; NaN for infinity.
#[inline]
pub fn sin(x: f64) -> f64 {
    sine(x, reduce(x))
}

/// Cosine, within 1 unit in the last place for every finite `x`; NaN for infinity.
#[inline]
pub fn cos(x: f64) -> f64 {
    cosine(reduce(x))
}

/// Both for little more than the price of one: the bits of [`sin`] and of [`cos`].
#[inline]
pub fn sin_cos(x: f64) -> (f64, f64) {
    let angle = reduce(x);
    (sine(x, angle), cosine(angle))
}

/// [`sin`] without a branch, where the angle is moderate; anything for others.
#[inline(always)]
pub(in crate::math) fn sin_moderate(x: f64) -> f64 {
    sine(x, reduce_moderate(x))
}

/// [`cos`] without a branch, where the angle is moderate; anything for others.
#[inline(always)]
pub(in crate::math) fn cos_moderate(x: f64) -> f64 {
    cosine(reduce_moderate(x))
}

/// [`sin_cos`] without a branch, where the angle is moderate; anything for others.
#[inline(always)]
pub(in crate::math) fn sin_cos_moderate(x: f64) -> (f64, f64) {
    let angle = reduce_moderate(x);
    (sine(x, angle), cosine(angle))
}

/// Below this `sin(x)` rounds to `x`; -0 stays -0.
const TINY: f64 = 1.0 / 134_217_728.0;

/// The sine of `x`, which is this angle.
#[inline(always)]
fn sine(x: f64, angle: Angle) -> f64 {
    let value = in_quadrant(angle.quadrant, sine_kernel(angle), cosine_kernel(angle));
    if x.abs() < TINY { x } else { value }
}

/// The cosine of this angle.
#[inline(always)]
fn cosine(angle: Angle) -> f64 {
    in_quadrant(angle.quadrant.wrapping_add(1), sine_kernel(angle), cosine_kernel(angle))
}

/// The sine of an angle in a quadrant from the sine and cosine of what exceeds the quadrant's start.
#[inline(always)]
fn in_quadrant(quadrant: u64, sine: f64, cosine: f64) -> f64 {
    let size = if quadrant & 1 == 0 { sine } else { cosine };
    f64::from_bits(size.to_bits() ^ (quadrant & 2) << 62)
}
