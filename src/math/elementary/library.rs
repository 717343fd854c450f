//! The functions taken from `pxfm`, correctly rounded: the only file that names the crate.

/// Tangent.
#[inline]
pub fn tan(x: f64) -> f64 {
    pxfm::f_tan(x)
}

/// Arc sine, NaN beyond ±1.
#[inline]
pub fn asin(x: f64) -> f64 {
    pxfm::f_asin(x)
}

/// Arc cosine, NaN beyond ±1.
#[inline]
pub fn acos(x: f64) -> f64 {
    pxfm::f_acos(x)
}

/// Hyperbolic sine.
#[inline]
pub fn sinh(x: f64) -> f64 {
    if x == 0.0 { x } else { pxfm::f_sinh(x) } // the crate gives +0 for -0
}

/// Hyperbolic cosine.
#[inline]
pub fn cosh(x: f64) -> f64 {
    pxfm::f_cosh(x)
}

/// Hyperbolic tangent.
#[inline]
pub fn tanh(x: f64) -> f64 {
    pxfm::f_tanh(x)
}

/// Inverse hyperbolic sine.
#[inline]
pub fn asinh(x: f64) -> f64 {
    pxfm::f_asinh(x)
}

/// Inverse hyperbolic cosine, NaN below 1.
#[inline]
pub fn acosh(x: f64) -> f64 {
    pxfm::f_acosh(x)
}

/// Inverse hyperbolic tangent, infinite at ±1, NaN beyond.
#[inline]
pub fn atanh(x: f64) -> f64 {
    pxfm::f_atanh(x)
}

/// Logarithm to base 2, -inf at zero, NaN below.
#[inline]
pub fn log2(x: f64) -> f64 {
    pxfm::f_log2(x)
}

/// Logarithm to base 10, -inf at zero, NaN below.
#[inline]
pub fn log10(x: f64) -> f64 {
    pxfm::f_log10(x)
}
