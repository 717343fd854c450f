//! Reduction of an angle modulo pi/2, right for every finite double.
//!
//! Up to [`LIMIT`] by Cody and Waite's method with pi/2 in four parts, the first three of 33 bits, so that their
//! products with the number of quadrants are exact; two parts would lose 50 000 units in the last place next to a
//! multiple of pi/2. Beyond it by Payne and Hanek's: the product with the bits of 2/pi that matter, in integers.

use super::twofold::{Twofold, product, sum, sum_ordered};

/// An angle as `quadrant * pi/2 + (hi + lo)`, |hi| at most pi/4 or barely more; only the quadrant's last two bits count.
#[derive(Clone, Copy, Debug)]
pub(super) struct Angle {
    pub quadrant: u64,
    pub hi: f64,
    pub lo: f64,
}

/// Up to here the number of quadrants has at most 20 bits.
const LIMIT: f64 = 1_600_000.0;

/// 1.5 * 2^52: adding it rounds to an integer, which then stands in the low bits.
pub(super) const ROUNDER: f64 = 6_755_399_441_055_744.0;

/// pi/2, rounded down to 33 bits.
const PART_1: f64 = 1.5707963267341256;
/// What then remains of pi/2, to 33 bits.
const PART_2: f64 = 6.077100506303966e-11;
/// What then remains of pi/2, to 33 bits.
const PART_3: f64 = 2.0222662487111665e-21;
/// What then remains of pi/2.
const PART_4: f64 = 8.4784276603689e-32;

/// The reduced angle; NaN parts for NaN and infinity.
#[inline(always)]
pub(super) fn reduce(x: f64) -> Angle {
    if is_moderate(x) { reduce_moderate(x) } else { reduce_huge(x) }
}

/// Whether [`reduce_moderate`] is right for `x`.
#[inline(always)]
pub(in crate::math) fn is_moderate(x: f64) -> bool {
    x.abs() <= LIMIT
}

/// Cody and Waite's reduction for |x| <= [`LIMIT`]; anything for others.
#[inline(always)]
pub(super) fn reduce_moderate(x: f64) -> Angle {
    let shifted = x * std::f64::consts::FRAC_2_PI + ROUNDER;
    let quadrant = shifted.to_bits();
    let count = shifted - ROUNDER;
    let first = x - count * PART_1;
    let second = sum(first, -(count * PART_2));
    let third = sum(second.hi, -(count * PART_3));
    let all = sum_ordered(third.hi, (second.lo + third.lo) - count * PART_4);
    Angle { quadrant, hi: all.hi, lo: all.lo }
}

/// The bits of 2/pi after 64 zeros, the point before those.
const TWO_OVER_PI: [u64; 20] = [
    0,
    0xa2f9836e4e441529,
    0xfc2757d1f534ddc0,
    0xdb6295993c439041,
    0xfe5163abdebbc561,
    0xb7246e3a424dd2e0,
    0x06492eea09d1921c,
    0xfe1deb1cb129a73e,
    0xe88235f52ebb4484,
    0xe99c7026b45f7e41,
    0x3991d639835339f4,
    0x9c845f8bbdf9283b,
    0x1ff897ffde05980f,
    0xef2f118b5a0a6d1f,
    0x6d367ecf27cb09b7,
    0x4f463f669e5fea2d,
    0x7527bac7ebe5f17b,
    0x3d0739f78a5292ea,
    0x6bfb5fb11f8d5d08,
    0x56033046fc7b6bab,
];

/// Payne and Hanek's reduction, for |x| > [`LIMIT`], NaN and infinity.
#[cold]
#[inline(never)]
fn reduce_huge(x: f64) -> Angle {
    if !x.is_finite() {
        return Angle { quadrant: 0, hi: f64::NAN, lo: f64::NAN };
    }
    let bits = x.abs().to_bits();
    let mantissa = (bits & ((1 << 52) - 1)) | (1 << 52);
    let exponent = (bits >> 52) as i32 - 1075; // |x| = mantissa * 2^exponent
    // Bits of 2/pi whose products are multiples of 4 quadrants are left out: the 192 taken begin at weight 2.
    let start = (exponent + 62) as usize;
    let window = |limb: usize| {
        let (word, shift) = (start / 64 + limb, start % 64);
        let next = TWO_OVER_PI.get(word + 1).copied().unwrap_or(0);
        if shift == 0 { TWO_OVER_PI[word] } else { TWO_OVER_PI[word] << shift | next >> (64 - shift) }
    };
    let low = u128::from(window(2)) * u128::from(mantissa);
    let middle = u128::from(window(1)) * u128::from(mantissa) + (low >> 64);
    let top = window(0).wrapping_mul(mantissa).wrapping_add((middle >> 64) as u64);
    // top.middle.low is |x| / (pi/2) modulo 4, its first two bits the quadrant.
    let whole = (u128::from(top) << 64) | u128::from(middle as u64);
    let fraction = (whole << 2 | u128::from(low as u64 >> 62)) as i128; // of a quadrant, in 2^-128, in [-1/2, 1/2)
    let quadrant = (top >> 62) as i32 + i32::from(fraction < 0);
    let hi = fraction as f64;
    let lo = fraction.wrapping_sub(hi as i128) as f64;
    let unit = f64::from_bits((1023 - 128) << 52);
    let half_pi = Twofold { hi: std::f64::consts::FRAC_PI_2, lo: 6.123233995736766e-17 };
    let main = product(hi * unit, half_pi.hi);
    let all = sum_ordered(main.hi, main.lo + (hi * unit * half_pi.lo + lo * unit * half_pi.hi));
    if x < 0.0 {
        Angle { quadrant: -quadrant as u64, hi: -all.hi, lo: -all.lo }
    } else {
        Angle { quadrant: quadrant as u64, hi: all.hi, lo: all.lo }
    }
}
