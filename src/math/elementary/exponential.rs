//! The exponential function: `x = k ln 2 + r`, a polynomial for `e^r`, and scaling by `2^k` in two steps.
//!
//! The coefficients are a minimax fit (Remez) of `(e^r - 1 - r)/r^2` on |r| <= ln(2)/2.

use super::quadrant::ROUNDER;
use super::twofold::{Twofold, polynomial, sum, sum_ordered};

/// ln 2, rounded down to 32 bits: its products with exponents are exact.
pub(super) const LN_2_HIGH: f64 = 0.6931471803691238;
/// What then remains of ln 2.
pub(super) const LN_2_LOW: f64 = 1.9082149292705877e-10;

/// What the field of the exponent in a number's bits is above the exponent.
const BIAS: u64 = 1023;

const EXPONENTIAL: [f64; 11] = [
    0.5,
    0.1666666666666667,
    0.041666666666666685,
    0.008333333333326134,
    0.0013888888888874398,
    0.0001984126987482399,
    2.480158734733946e-05,
    2.7557255396471e-06,
    2.7557252912472866e-07,
    2.510521838664829e-08,
    2.0921589370829142e-09,
];

/// `e^x`, within 1 unit in the last place, gradual underflow included.
#[inline(always)]
pub fn exp(x: f64) -> f64 {
    exp_twofold(Twofold { hi: x, lo: 0.0 })
}

/// `e^(hi + lo)`, where `lo` is small against 1, unless `hi` is out of range anyway.
#[inline(always)]
pub(super) fn exp_twofold(x: Twofold) -> f64 {
    // Beyond these the result is infinite or zero anyway; NaN stays.
    let capped = if x.hi > 710.0 { 710.0 } else { x.hi };
    let hi = if capped < -746.0 { -746.0 } else { capped };
    let shifted = hi * std::f64::consts::LOG2_E + ROUNDER;
    let fields = shifted.to_bits().wrapping_sub(ROUNDER.to_bits()).wrapping_add(2 * BIAS);
    let count = shifted - ROUNDER;
    let lo = if hi == x.hi { x.lo } else { 0.0 };
    let rest = sum(hi - count * LN_2_HIGH, lo - count * LN_2_LOW);
    let tail = rest.hi * rest.hi * polynomial(rest.hi, &EXPONENTIAL);
    let main = sum_ordered(1.0, rest.hi);
    let value = main.hi + (main.lo + (tail + rest.lo * (1.0 + rest.hi)));
    // The exponent in two halves, each with its bias: `fields` is their sum, and not negative.
    let first = fields >> 1;
    value * f64::from_bits(first << 52) * f64::from_bits(fields.wrapping_sub(first) << 52)
}
