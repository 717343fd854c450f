//! Roots by a last Newton step with an exact residual: the cube root and the hypotenuse, hardly off the nearest number.

use super::twofold::{Twofold, product, sum_ordered};

/// Outside [1/2^500, 2^500] arguments are scaled by 2^-600 or 2^600, so that no product under- or overflows.
const FAR: f64 = 3.273390607896142e150; // 2^500
const SCALE: f64 = 4.149515568880993e180; // 2^600
const SCALE_ROOT: f64 = 1.6069380442589903e60; // 2^200

/// Cube root, within 1 unit in the last place; odd, with ±0 and ±inf as they are.
#[inline(always)]
pub fn cbrt(x: f64) -> f64 {
    /// 2/3 of the bits of 1, less what makes the worst error of the first guess smallest.
    const GUESS: u64 = 0x2a9f_7893_0000_0000;
    let size = x.abs();
    let (large, small) = (size > FAR, size < 1.0 / FAR);
    let scaled = if large { size * (1.0 / SCALE) } else { size };
    let scaled = if small { size * SCALE } else { scaled };

    let guess = f64::from_bits(scaled.to_bits() / 3 + GUESS);
    let root = halley(halley(guess, scaled), scaled);
    let square = product(root, root);
    let cube = product(square.hi, root);
    let residual = (scaled - cube.hi) - (cube.lo + square.lo * root);
    let root = root + residual / (3.0 * square.hi);

    let root = if large { root * SCALE_ROOT } else { root };
    let root = if small { root * (1.0 / SCALE_ROOT) } else { root };
    if x == 0.0 || !x.is_finite() { x } else { root.copysign(x) }
}

/// A step of Halley's method for the cube root of `x`: an error of e becomes 2/3 e^3.
#[inline(always)]
fn halley(root: f64, x: f64) -> f64 {
    let cube = root * root * root;
    root * ((cube + 2.0 * x) / (2.0 * cube + x))
}

/// `sqrt(a^2 + b^2)` within 1 unit in the last place; infinite if either is, even if the other is NaN.
#[inline(always)]
pub fn hypot(a: f64, b: f64) -> f64 {
    let (a, b) = (a.abs(), b.abs());
    let longer = if a < b { b } else { a };
    let shorter = if a < b { a } else { b };
    let (large, small) = (longer > FAR, longer < 1.0 / FAR);
    let scale = if large { 1.0 / SCALE } else { 1.0 };
    let scale = if small { SCALE } else { scale };
    let back = if large { SCALE } else { 1.0 };
    let back = if small { 1.0 / SCALE } else { back };

    let square = sum_of_squares(longer * scale, shorter * scale);
    let root = square.hi.sqrt();
    let again = product(root, root);
    let residual = ((square.hi - again.hi) - again.lo) + square.lo;
    let value = (root + residual / (2.0 * root)) * back;

    let value = if longer == 0.0 { 0.0 } else { value };
    let value = if a.is_nan() || b.is_nan() { f64::NAN } else { value };
    if a == f64::INFINITY || b == f64::INFINITY { f64::INFINITY } else { value }
}

/// `longer^2 + shorter^2` to about 2^-102 of its size.
#[inline(always)]
fn sum_of_squares(longer: f64, shorter: f64) -> Twofold {
    let (first, second) = (product(longer, longer), product(shorter, shorter));
    let main = sum_ordered(first.hi, second.hi);
    Twofold { hi: main.hi, lo: main.lo + (first.lo + second.lo) }
}
