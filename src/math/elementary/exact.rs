//! Functions with one exact answer (or one fixed order of roundings), and what they do with NaN, -0 and infinity.

/// -1, 0 or 1. Both zeros give +0; NaN gives NaN.
#[inline(always)]
pub fn sign(x: f64) -> f64 {
    if x > 0.0 {
        1.0
    } else if x < 0.0 {
        -1.0
    } else if x == 0.0 {
        0.0
    } else {
        x
    }
}

/// The smaller one; NaN if either is NaN; -0 is smaller than +0.
#[inline(always)]
pub fn minimum(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() {
        f64::NAN
    } else if a < b || (a == b && a.is_sign_negative()) {
        a
    } else {
        b
    }
}

/// The larger one; NaN if either is NaN; +0 is larger than -0.
#[inline(always)]
pub fn maximum(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() {
        f64::NAN
    } else if a > b || (a == b && a.is_sign_positive()) {
        a
    } else {
        b
    }
}

/// To the nearest integer, halves away from zero. The sign of a zero result is that of `x`.
#[inline(always)]
pub fn round(x: f64) -> f64 {
    x.round()
}

/// `a - b floor(a / b)`, computed from the exact remainder: in [0, b) for positive `b`, in (b, 0] for negative.
///
/// A zero has the sign of `b`. A value that would round to `b` is the neighbour of `b` nearer to zero. For infinite
/// `b` the result is `a`, or `b` if their signs differ. NaN if `b` is zero or `a` infinite.
#[inline]
pub fn modulo(a: f64, b: f64) -> f64 {
    let rest = a % b;
    if rest == 0.0 {
        return 0.0_f64.copysign(b);
    }
    if (rest < 0.0) == (b < 0.0) || rest.is_nan() {
        return rest;
    }
    let moved = rest + b;
    if moved == b && b.is_finite() { if b > 0.0 { b.next_down() } else { b.next_up() } } else { moved }
}

/// `x` to an integer power by repeated multiplication.
///
/// The order of the roundings is part of the meaning: with `square` running through x, x^2, x^4, ..., the result
/// starts as the first `square` whose bit is set in `|n|`, counted from the lowest, and is multiplied by the later
/// ones in turn. A negative `n` gives `1 / x^|n|`. `x^0` is 1 for every `x`, NaN too.
#[inline]
pub fn powi(x: f64, n: i32) -> f64 {
    let mut bits = n.unsigned_abs();
    let mut square = x;
    let mut product = 1.0;
    while bits != 0 {
        if bits & 1 != 0 {
            product *= square;
        }
        bits >>= 1;
        if bits != 0 {
            square *= square;
        }
    }
    if n < 0 { 1.0 / product } else { product }
}
