//! Real powers: `x^y = e^(y log x)`, with the logarithm to twice the precision.
//!
//! `log m = 2 s (1 + z/3 + z^2/5 + z^3 P(z))` with `s = (m - 1)/(m + 1)` and `z = s^2`; the first terms are twofold, P is
//! a minimax fit (Remez).

use super::exponential::{LN_2_HIGH, LN_2_LOW, exp_twofold};
use super::logarithm::{Scaled, scaled};
use super::twofold::{Twofold, polynomial, product, sum, sum_ordered};

const ONE_THIRD: Twofold = Twofold { hi: 0.3333333333333333, lo: 1.850371707708594e-17 };
const ONE_FIFTH: Twofold = Twofold { hi: 0.2, lo: -1.1102230246251566e-17 };

const TAIL: [f64; 8] = [
    0.1428571428571426,
    0.11111111111126565,
    0.09090909087202644,
    0.07692308168703146,
    0.06666630405889147,
    0.058840384137817864,
    0.052162628833590685,
    0.05473831291716851,
];

/// `x^y`, within 1 unit in the last place; special cases as in C's Annex F.
///
/// `x^0` and `1^y` are 1 even for NaN; a negative `x` needs an integer `y` or gives NaN; -0 and -inf keep their sign
/// for odd `y`.
#[inline(always)]
pub fn pow(x: f64, y: f64) -> f64 {
    // Larger exponents give 0, 1 or infinity as well, and would overflow on the way.
    const Y_MAX: f64 = 1e20;
    let base = x.abs();
    let exponent = if y > Y_MAX { Y_MAX } else { y };
    let exponent = if exponent < -Y_MAX { -Y_MAX } else { exponent };
    let logarithm = log_twofold(base);
    let main = product(exponent, logarithm.hi);
    let value = exp_twofold(Twofold { hi: main.hi, lo: main.lo + exponent * logarithm.lo });

    let edge = base == 0.0 || base == f64::INFINITY;
    let value = if edge { if (base == 0.0) == (y > 0.0) { 0.0 } else { f64::INFINITY } } else { value };
    let even = is_integer(0.5 * y.abs());
    let integer = is_integer(y.abs());
    let value = if x.is_sign_negative() && integer && !even { -value } else { value };
    let undefined = (x < 0.0 && !integer && !edge) || x.is_nan() || y.is_nan();
    let value = if undefined { f64::NAN } else { value };
    if x == 1.0 || y == 0.0 { 1.0 } else { value }
}

/// Whether a number that is not negative is an integer; infinity is.
#[inline(always)]
fn is_integer(a: f64) -> bool {
    const TWO_TO_52: f64 = 4_503_599_627_370_496.0;
    a >= TWO_TO_52 || (a + TWO_TO_52) - TWO_TO_52 == a
}

/// The logarithm of a positive finite number, to about 2^-66 of its size.
#[inline(always)]
fn log_twofold(x: f64) -> Twofold {
    let Scaled { exponent, mantissa } = scaled(x);
    let s = Twofold { hi: mantissa - 1.0, lo: 0.0 }.over(sum(mantissa, 1.0));
    let z = s.times(s);
    let inner = sum_ordered(ONE_FIFTH.hi, z.hi * polynomial(z.hi, &TAIL));
    let inner = Twofold { hi: inner.hi, lo: inner.lo + ONE_FIFTH.lo };
    let series = z.times(ONE_THIRD.plus_smaller(z.times(inner)));
    let half = s.plus_smaller(s.times(series));
    let main = sum(exponent * LN_2_HIGH, 2.0 * half.hi);
    sum_ordered(main.hi, main.lo + (2.0 * half.lo + exponent * LN_2_LOW))
}
