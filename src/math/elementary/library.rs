//! Functions taken from the `libm` crate.

/// `tan(x)`.
#[inline]
pub fn tan(x: f64) -> f64 {
    libm::tan(x)
}

/// `asin(x)`.
#[inline]
pub fn asin(x: f64) -> f64 {
    libm::asin(x)
}

/// `acos(x)`.
#[inline]
pub fn acos(x: f64) -> f64 {
    libm::acos(x)
}

/// `sinh(x)`.
#[inline]
pub fn sinh(x: f64) -> f64 {
    libm::sinh(x)
}

/// `cosh(x)`.
#[inline]
pub fn cosh(x: f64) -> f64 {
    libm::cosh(x)
}

/// `tanh(x)`.
#[inline]
pub fn tanh(x: f64) -> f64 {
    libm::tanh(x)
}

/// `asinh(x)`.
#[inline]
pub fn asinh(x: f64) -> f64 {
    libm::asinh(x)
}

/// `acosh(x)`.
#[inline]
pub fn acosh(x: f64) -> f64 {
    libm::acosh(x)
}

/// `atanh(x)`.
#[inline]
pub fn atanh(x: f64) -> f64 {
    libm::atanh(x)
}

/// `log2(x)`.
#[inline]
pub fn log2(x: f64) -> f64 {
    libm::log2(x)
}

/// `log10(x)`.
#[inline]
pub fn log10(x: f64) -> f64 {
    libm::log10(x)
}

/// `cbrt(x)`.
#[inline]
pub fn cbrt(x: f64) -> f64 {
    libm::cbrt(x)
}

/// `sin(x)`.
#[inline]
pub fn sin(x: f64) -> f64 {
    libm::sin(x)
}

/// `cos(x)`.
#[inline]
pub fn cos(x: f64) -> f64 {
    libm::cos(x)
}

/// `atan(x)`.
#[inline]
pub fn atan(x: f64) -> f64 {
    libm::atan(x)
}

/// `exp(x)`.
#[inline]
pub fn exp(x: f64) -> f64 {
    libm::exp(x)
}

/// `log(x)`.
#[inline]
pub fn log(x: f64) -> f64 {
    libm::log(x)
}

/// `hypot` of two arguments.
#[inline]
pub fn hypot(a: f64, b: f64) -> f64 {
    libm::hypot(a, b)
}

/// `atan2` of two arguments.
#[inline]
pub fn atan2(a: f64, b: f64) -> f64 {
    libm::atan2(a, b)
}

/// `pow` of two arguments.
#[inline]
pub fn pow(a: f64, b: f64) -> f64 {
    libm::pow(a, b)
}
