//! Intervals of the operations that are exact or rounded once: sums, products, quotients, integer powers, roundings.

use super::Interval;
use crate::math::elementary;

/// A lower bound of a product or quotient that was rounded to `x`: +0 came from an exact zero or from above.
#[inline(always)]
fn below(x: f64) -> f64 {
    if x.to_bits() == 0 { x } else { x.next_down() }
}

/// An upper bound of a product or quotient that was rounded to `x`: -0 came from an exact zero or from below.
#[inline(always)]
fn above(x: f64) -> f64 {
    if x == 0.0 && x.is_sign_negative() { x } else { x.next_up() }
}

/// What `a + b` loses when it is rounded to `sum`, exactly; NaN where something is infinite.
#[inline(always)]
fn lost(a: f64, b: f64, sum: f64) -> f64 {
    let of_b = sum - a;
    (a - (sum - of_b)) + (b - of_b)
}

/// A lower bound of `a + b`, exact where the sum is.
#[inline(always)]
fn sum_below(a: f64, b: f64) -> f64 {
    let sum = a + b;
    if lost(a, b, sum) >= 0.0 { sum } else { sum.next_down() }
}

/// An upper bound of `a + b`, exact where the sum is.
#[inline(always)]
fn sum_above(a: f64, b: f64) -> f64 {
    let sum = a + b;
    if lost(a, b, sum) <= 0.0 { sum } else { sum.next_up() }
}

/// The smaller one of two that are not NaN.
#[inline(always)]
fn smaller(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

/// The larger one of two that are not NaN.
#[inline(always)]
fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// A lower bound of `x^n` by the multiplications of [`elementary::powi`], for `x >= 0` and `n >= 1`.
#[inline]
fn power_below(x: f64, n: u32) -> f64 {
    power_rounded(x, n, below)
}

/// An upper bound of `x^n` by the multiplications of [`elementary::powi`], for `x >= 0` and `n >= 1`.
#[inline]
fn power_above(x: f64, n: u32) -> f64 {
    if x == 0.0 { 0.0 } else { power_rounded(x, n, above) }
}

/// `x^n` with every product passed through `rounded`.
#[inline(always)]
fn power_rounded(x: f64, n: u32, rounded: impl Fn(f64) -> f64) -> f64 {
    let mut bits = n >> n.trailing_zeros();
    let mut square = x;
    for _ in 0..n.trailing_zeros() {
        square = rounded(square * square);
    }
    let mut product = square;
    bits >>= 1;
    while bits != 0 {
        square = rounded(square * square);
        if bits & 1 != 0 {
            product = rounded(product * square);
        }
        bits >>= 1;
    }
    product
}

#[expect(
    clippy::should_implement_trait,
    reason = "the names of the operators, without their operators' traits"
)]
impl Interval {
    /// All negated members; exact.
    #[inline]
    pub fn neg(self) -> Self {
        Self { lo: -self.hi, hi: -self.lo }
    }

    /// All sums.
    #[inline]
    pub fn add(self, other: Self) -> Self {
        Self::new(sum_below(self.lo, other.lo), sum_above(self.hi, other.hi))
    }

    /// All differences.
    #[inline]
    pub fn sub(self, other: Self) -> Self {
        Self::new(sum_below(self.lo, -other.hi), sum_above(self.hi, -other.lo))
    }

    /// All products; WHOLE for zero times infinity.
    #[inline]
    pub fn mul(self, other: Self) -> Self {
        let (p, q) = (self.lo * other.lo, self.lo * other.hi);
        let (r, s) = (self.hi * other.lo, self.hi * other.hi);
        if (p + q + r + s).is_nan() {
            return Self::WHOLE; // a NaN among them, or both infinities
        }
        let (lo, hi) = (smaller(smaller(p, q), smaller(r, s)), larger(larger(p, q), larger(r, s)));
        if lo == 0.0 || hi == 0.0 {
            return self.mul_at_zero(other, lo, hi);
        }
        Self { lo: lo.next_down(), hi: hi.next_up() }
    }

    /// The product whose ends `lo` and `hi` are rounded, one of them to zero: exactly, or because it underflowed.
    #[cold]
    fn mul_at_zero(self, other: Self, lo: f64, hi: f64) -> Self {
        if self == Self::ZERO || other == Self::ZERO {
            return Self::ZERO;
        }
        let same_sign = (self.lo >= 0.0 && other.lo >= 0.0) || (self.hi <= 0.0 && other.hi <= 0.0);
        let opposite = (self.lo >= 0.0 && other.hi <= 0.0) || (self.hi <= 0.0 && other.lo >= 0.0);
        Self {
            lo: if same_sign && lo == 0.0 { 0.0 } else { lo.next_down() },
            hi: if opposite && hi == 0.0 { 0.0 } else { hi.next_up() },
        }
    }

    /// All quotients; WHOLE if the divisor contains zero or both are unbounded.
    #[inline]
    pub fn div(self, divisor: Self) -> Self {
        if divisor.contains_zero() {
            return Self::WHOLE;
        }
        let (a, b) = if divisor.lo > 0.0 { (self, divisor) } else { (self.neg(), divisor.neg()) };
        let lo = a.lo / if a.lo >= 0.0 { b.hi } else { b.lo };
        let hi = a.hi / if a.hi >= 0.0 { b.lo } else { b.hi };
        let undefined = b.hi == f64::INFINITY && (a.lo == f64::NEG_INFINITY || a.hi == f64::INFINITY);
        if undefined {
            return Self::WHOLE;
        }
        Self { lo: if a.lo == 0.0 { 0.0 } else { below(lo) }, hi: if a.hi == 0.0 { 0.0 } else { above(hi) } }
    }

    /// All integer powers. The exponent is one number (WHOLE otherwise); one that is no integer of i32 size is a real
    /// power's.
    #[inline]
    pub fn powi(self, exponent: Self) -> Self {
        if !exponent.is_point() {
            return Self::WHOLE;
        }
        let n = exponent.lo as i32;
        if f64::from(n) != exponent.lo {
            return self.pow(exponent);
        }
        if n == 0 {
            return Self::ONE;
        }
        if self.is_whole() {
            return Self::WHOLE;
        }
        let power = self.power_of_positive(n.unsigned_abs());
        if n > 0 {
            power
        } else if self.contains_zero() {
            Self::WHOLE
        } else {
            power.inverse_of_power()
        }
    }

    /// All powers with a positive integer: monotone if it is odd, symmetric if it is even.
    #[inline]
    fn power_of_positive(self, n: u32) -> Self {
        if n.is_multiple_of(2) {
            Self { lo: power_below(self.mig(), n), hi: power_above(self.mag(), n) }
        } else {
            let lo = if self.lo >= 0.0 { power_below(self.lo, n) } else { -power_above(-self.lo, n) };
            let hi = if self.hi >= 0.0 { power_above(self.hi, n) } else { -power_below(-self.hi, n) };
            Self { lo, hi }
        }
    }

    /// `1 / self` for the power of an interval without zero, whose own end may have underflowed to zero.
    #[inline]
    fn inverse_of_power(self) -> Self {
        if self.hi <= 0.0 && self.lo < 0.0 {
            return self.neg().inverse_of_power().neg();
        }
        if self.lo < 0.0 { Self::WHOLE } else { Self::new(below(1.0 / self.hi), above(1.0 / self.lo.abs())) }
    }

    /// All absolute values; exact.
    #[inline]
    pub fn abs(self) -> Self {
        if self.is_whole() { self } else { Self { lo: self.mig(), hi: self.mag() } }
    }

    /// All signs; exact.
    #[inline]
    pub fn sign(self) -> Self {
        if self.is_whole() { self } else { self.monotone_exact(elementary::sign) }
    }

    /// All minima; exact.
    #[inline]
    pub fn min(self, other: Self) -> Self {
        if self.is_whole() || other.is_whole() {
            return Self::WHOLE;
        }
        Self { lo: smaller(self.lo, other.lo), hi: smaller(self.hi, other.hi) }
    }

    /// All maxima; exact.
    #[inline]
    pub fn max(self, other: Self) -> Self {
        if self.is_whole() || other.is_whole() {
            return Self::WHOLE;
        }
        Self { lo: larger(self.lo, other.lo), hi: larger(self.hi, other.hi) }
    }

    /// All integers below; exact.
    #[inline]
    pub fn floor(self) -> Self {
        self.monotone_exact(f64::floor)
    }

    /// All integers above; exact.
    #[inline]
    pub fn ceil(self) -> Self {
        self.monotone_exact(f64::ceil)
    }

    /// All nearest integers; exact.
    #[inline]
    pub fn round(self) -> Self {
        self.monotone_exact(elementary::round)
    }

    /// All integer parts; exact.
    #[inline]
    pub fn trunc(self) -> Self {
        self.monotone_exact(f64::trunc)
    }

    /// The image under a function that never falls and does not round.
    #[inline(always)]
    fn monotone_exact(self, function: impl Fn(f64) -> f64) -> Self {
        Self { lo: function(self.lo), hi: function(self.hi) }
    }

    /// All remainders; WHOLE if the divisor contains zero or something is unbounded.
    #[inline]
    pub fn modulo(self, divisor: Self) -> Self {
        if divisor.contains_zero() || !self.is_finite() || !divisor.is_finite() {
            return Self::WHOLE;
        }
        if divisor.is_point() && sum_above(self.hi, -self.lo) < divisor.mag() {
            let (first, last) =
                (elementary::modulo(self.lo, divisor.lo), elementary::modulo(self.hi, divisor.lo));
            if first < last || self.is_point() {
                // Shorter than a period and not past its end: the remainder only grows.
                return Self { lo: first.next_down(), hi: last.next_up() };
            }
        }
        if self.lo >= 0.0 && self.hi < divisor.lo { self } else { divisor.hull(Self::ZERO) }
    }

    /// All square roots; WHOLE if some member is negative.
    #[inline]
    pub fn sqrt(self) -> Self {
        if self.lo < 0.0 {
            return Self::WHOLE;
        }
        let hi = if self.hi == 0.0 { 0.0 } else { self.hi.sqrt().next_up() };
        Self { lo: below(self.lo.sqrt().abs()), hi }
    }
}
