//! The natural logarithm: `x = 2^k m` with `m` near 1, and `log m = 2 atanh((m - 1)/(m + 1))`.
//!
//! The coefficients are a minimax fit (Remez) of `(2 atanh(s)/s - 2)/s^2` in `s^2`, for m in [sqrt(1/2), sqrt(2)].

use super::exponential::{LN_2_HIGH, LN_2_LOW};
use super::quadrant::ROUNDER;
use super::twofold::{polynomial, sum_ordered};

const LOGARITHM: [f64; 7] = [
    0.6666666666666734,
    0.39999999999414293,
    0.2857142874247849,
    0.22222198563216028,
    0.18183564879784134,
    0.15314035468346898,
    0.14796109675617009,
];

/// The natural logarithm, within 1 unit in the last place; -inf at both zeros, NaN below.
#[inline(always)]
pub fn log(x: f64) -> f64 {
    let Scaled { exponent, mantissa } = scaled(x);
    // log(1 + f) = f - (f^2/2 - s (f^2/2 + R(s^2))) with s = f/(2 + f), so that f itself is not rounded.
    let f = mantissa - 1.0;
    let s = f / (2.0 + f);
    let square = s * s;
    let half = 0.5 * f * f;
    let rest = s * (half + square * polynomial(square, &LOGARITHM)) - half;
    let main = sum_ordered(exponent * LN_2_HIGH, f);
    let value = main.hi + (main.lo + (rest + exponent * LN_2_LOW));
    let value = if x == 0.0 { f64::NEG_INFINITY } else { value };
    let value = if x == f64::INFINITY { x } else { value };
    if x < 0.0 || x.is_nan() { f64::NAN } else { value }
}

/// A positive finite number as `2^exponent * mantissa`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scaled {
    /// An integer.
    pub exponent: f64,
    /// In [sqrt(1/2), sqrt(2)).
    pub mantissa: f64,
}

/// Takes the exponent off. Anything for numbers that are not positive and finite.
#[inline(always)]
pub(super) fn scaled(x: f64) -> Scaled {
    const TWO_TO_54: f64 = 18_014_398_509_481_984.0;
    let denormal = x < f64::MIN_POSITIVE;
    let bits = (if denormal { x * TWO_TO_54 } else { x }).to_bits();
    // The exponent and 1024, which is not negative: a shift without a sign is a shift of lanes on every CPU.
    let above = bits.wrapping_sub(std::f64::consts::FRAC_1_SQRT_2.to_bits()).wrapping_add(1024 << 52);
    let raised = above >> 52;
    let mantissa = f64::from_bits(bits.wrapping_sub(raised << 52).wrapping_add(1024 << 52));
    let zero = ROUNDER + if denormal { 1024.0 + 54.0 } else { 1024.0 };
    Scaled { exponent: f64::from_bits(ROUNDER.to_bits() + raised) - zero, mantissa }
}
