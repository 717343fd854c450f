//! Arc tangent of one and of two arguments: one reduction to |t| <= sqrt(2) - 1, with the quotient to twice the precision.
//!
//! For `0 <= a <= b`: `atan(a/b) = t` with `t = a/b`, or `pi/4 + atan((a - b)/(a + b))` for the upper half; every other angle
//! is `m pi/4 ± atan(t)`. The coefficients are a minimax fit (Remez) of `(atan(t)/t - 1)/t^2` in `t^2`.

use super::twofold::{Twofold, polynomial, sum, sum_ordered};

const ARCTANGENT: [f64; 12] = [
    -0.33333333333333326,
    0.19999999999997692,
    -0.14285714285390796,
    0.11111111088351781,
    -0.09090908150813787,
    0.07692282900962555,
    -0.06666228861436498,
    0.058770424277412116,
    -0.052185373517147464,
    0.04504090754436113,
    -0.03348707538742241,
    0.015207985183216371,
];

/// What pi exceeds the nearest number by. The multiples of pi/4 up to 4 are exact products with the nearest number.
const PI_LOW: f64 = 1.2246467991473532e-16;

/// Arc tangent, within 1 unit in the last place.
#[inline(always)]
pub fn atan(x: f64) -> f64 {
    atan2(x, 1.0)
}

/// The angle of the point (x, y), within 1 unit in the last place; signed zeros and infinities as in C's Annex F.
#[inline(always)]
pub fn atan2(y: f64, x: f64) -> f64 {
    let (height, width) = (y.abs(), x.abs());
    let steep = height > width;
    let smaller = if steep { width } else { height };
    let larger = if steep { height } else { width };
    // Points at infinity or zero have the angle of a finite one.
    let infinite = larger == f64::INFINITY;
    let a = if infinite { if smaller == larger { 1.0 } else { 0.0 } } else { smaller };
    let b = if infinite || larger == 0.0 { 1.0 } else { larger };
    let backwards = x.is_sign_negative();
    let value = first_half(a, b, steep, backwards);
    if x.is_nan() || y.is_nan() { f64::NAN } else { value.copysign(y) }
}

/// The angle in [0, pi] for `0 <= a <= b`, `0 < b < inf`, where `a / b` is the tangent, seen from the axis that is nearer.
#[inline(always)]
fn first_half(a: f64, b: f64, steep: bool, backwards: bool) -> f64 {
    const HUGE: f64 = 3.273390607896142e150; // 2^500
    let plain = a / b;
    let scale = if b > HUGE { 1.0 / HUGE / 16.0 } else { 1.0 };
    let scale = if b < 1.0 / HUGE { HUGE * 16.0 } else { scale };
    let (a, b) = (a * scale, b * scale);

    let upper = a > b * (std::f64::consts::SQRT_2 - 1.0);
    let numerator = if upper { sum(a, -b) } else { Twofold { hi: a, lo: 0.0 } };
    let denominator = if upper { sum_ordered(b, a) } else { Twofold { hi: b, lo: 0.0 } };
    let t = numerator.over(denominator);
    let square = t.hi * t.hi;
    let tail = t.lo + t.hi * square * polynomial(square, &ARCTANGENT);

    let mirrored = steep != backwards;
    let from_axis = if upper { 1.0 } else { 0.0 };
    let back = if backwards { 4.0 } else { 0.0 };
    let eighths = if steep { 2.0 } else { back };
    let eighths = if mirrored { eighths - from_axis } else { eighths + from_axis };
    let sign = if mirrored { -1.0 } else { 1.0 };
    let main = sum_ordered(eighths * std::f64::consts::FRAC_PI_4, sign * t.hi);
    let value = main.hi + (main.lo + (eighths * (PI_LOW / 4.0) + sign * tail));
    // A small quotient is the angle itself, and rounds only once even if it is denormal.
    if plain < 1e-10 && !steep && !backwards { plain } else { value }
}
