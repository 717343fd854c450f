//! Numbers as unevaluated sums of two f64, and the error-free steps that make them.
//!
//! `hi + lo` is exact where the name says sum or product (Dekker 1971, Knuth): no fused multiply-add is used,
//! because without hardware for it one costs as much as a whole function, and the bits would depend on the CPU.

/// `hi + lo`, where `lo` is at most half a unit in the last place of `hi`, or nearly so.
#[derive(Clone, Copy, Debug)]
pub(super) struct Twofold {
    pub hi: f64,
    pub lo: f64,
}

/// `a + b` exactly.
#[inline(always)]
pub(super) fn sum(a: f64, b: f64) -> Twofold {
    let hi = a + b;
    let of_b = hi - a;
    Twofold { hi, lo: (a - (hi - of_b)) + (b - of_b) }
}

/// `a + b` exactly, where `|a| >= |b|` or `a` is zero.
#[inline(always)]
pub(super) fn sum_ordered(a: f64, b: f64) -> Twofold {
    let hi = a + b;
    Twofold { hi, lo: (a - hi) + b }
}

/// The upper and lower half of the bits of `a`, whose products are exact. `|a|` is at most 2^996.
#[inline(always)]
fn halves(a: f64) -> (f64, f64) {
    const SPLITTER: f64 = 134_217_729.0; // 2^27 + 1
    let scaled = SPLITTER * a;
    let upper = scaled - (scaled - a);
    (upper, a - upper)
}

/// `a * b` exactly, unless it under- or overflows.
#[inline(always)]
pub(super) fn product(a: f64, b: f64) -> Twofold {
    let hi = a * b;
    let (a_upper, a_lower) = halves(a);
    let (b_upper, b_lower) = halves(b);
    let rest = ((a_upper * b_upper - hi) + a_upper * b_lower) + a_lower * b_upper;
    Twofold { hi, lo: rest + a_lower * b_lower }
}

impl Twofold {
    /// The product to about 2^-102 of its size.
    #[inline(always)]
    pub(super) fn times(self, other: Twofold) -> Twofold {
        let main = product(self.hi, other.hi);
        sum_ordered(main.hi, main.lo + (self.hi * other.lo + self.lo * other.hi))
    }

    /// The sum to about 2^-102 of this operand's size, which must be the larger one.
    #[inline(always)]
    pub(super) fn plus_smaller(self, other: Twofold) -> Twofold {
        let main = sum_ordered(self.hi, other.hi);
        sum_ordered(main.hi, main.lo + (self.lo + other.lo))
    }

    /// The quotient to about 2^-102 of its size.
    #[inline(always)]
    pub(super) fn over(self, divisor: Twofold) -> Twofold {
        let hi = self.hi / divisor.hi;
        let back = product(hi, divisor.hi);
        let rest = ((self.hi - back.hi) - back.lo) + (self.lo - hi * divisor.lo);
        Twofold { hi, lo: rest / divisor.hi }
    }
}

/// The polynomial with these coefficients, from the constant one up; even and odd powers in two chains.
#[inline(always)]
pub(super) fn polynomial<const N: usize>(z: f64, coefficients: &[f64; N]) -> f64 {
    let square = z * z;
    let mut even = 0.0;
    let mut odd = 0.0;
    for (power, &coefficient) in coefficients.iter().enumerate().rev() {
        if power % 2 == 0 {
            even = even * square + coefficient;
        } else {
            odd = odd * square + coefficient;
        }
    }
    even + z * odd
}
