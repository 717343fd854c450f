//! The loops over lanes, one for each operator, written once and inlined into a function for each level.
//!
//! Everything here and below it is `inline(always)`, or it would be compiled for the baseline. A loop's body has no branch
//! on the usual path; lanes that need another one are redone by the scalar function. Functions of a crate go lane by lane.

use crate::math::Op;
use crate::math::elementary;

use super::level::Work;
use super::{Term, WIDTH};

/// Writes an expression in the operands' lanes into every lane. A macro, because a function that takes another one calls it.
macro_rules! each {
    ($out:ident, $a:ident: $value:expr) => {
        for (out, &$a) in $out.iter_mut().zip($a) {
            *out = $value;
        }
    };
    ($out:ident, $a:ident, $b:ident: $value:expr) => {
        for ((out, &$a), &$b) in $out.iter_mut().zip($a).zip($b) {
            *out = $value;
        }
    };
}

/// What a level is asked for; all slices of one call have the same length.
pub(super) enum Task<'a> {
    /// An operator of one operand.
    Unary { op: Op, a: &'a [f64], out: &'a mut [f64] },
    /// An operator of two operands.
    Binary { op: Op, a: &'a [f64], b: &'a [f64], out: &'a mut [f64] },
    /// `b` where `a` is true, else `c`.
    Select { a: &'a [f64], b: &'a [f64], c: &'a [f64], out: &'a mut [f64] },
    /// Sine and cosine.
    SinCos { a: &'a [f64], sin: &'a mut [f64], cos: &'a mut [f64] },
    /// `h` times the sum of the terms.
    Combination { h: &'a [f64], terms: &'a [Term<'a>], out: &'a mut [f64] },
    /// `x` and `h` times the sum of the terms.
    Advance { x: &'a [f64], h: &'a [f64], terms: &'a [Term<'a>], out: &'a mut [f64] },
}

impl Work for Task<'_> {
    #[inline(always)]
    fn work(self) {
        match self {
            Task::Unary { op, a, out } => unary(op, a, out),
            Task::Binary { op, a, b, out } => binary(op, a, b, out),
            Task::Select { a, b, c, out } => select(a, b, c, out),
            Task::SinCos { a, sin, cos } => sin_cos(a, sin, cos),
            Task::Combination { h, terms, out } => combination(h, terms, |_, change| change, out),
            Task::Advance { x, h, terms, out } => combination(h, terms, |lane, change| x[lane] + change, out),
        }
    }
}

/// One operand; operators of other arity do nothing.
#[inline(always)]
fn unary(op: Op, a: &[f64], out: &mut [f64]) {
    match op {
        Op::Neg => each!(out, a: -a),
        Op::Sin => {
            each!(out, a: elementary::sin_moderate(a));
            redo_huge(a, out, elementary::sin);
        }
        Op::Cos => {
            each!(out, a: elementary::cos_moderate(a));
            redo_huge(a, out, elementary::cos);
        }
        Op::Atan => each!(out, a: elementary::atan(a)),
        Op::Exp => each!(out, a: elementary::exp(a)),
        Op::Log => each!(out, a: elementary::log(a)),
        Op::Sqrt => each!(out, a: a.sqrt()),
        Op::Cbrt => each!(out, a: elementary::cbrt(a)),
        Op::Abs => each!(out, a: a.abs()),
        Op::Sign => each!(out, a: elementary::sign(a)),
        Op::Floor => each!(out, a: a.floor()),
        Op::Ceil => each!(out, a: a.ceil()),
        Op::Round => each!(out, a: elementary::round(a)),
        Op::Trunc => each!(out, a: a.trunc()),
        Op::Not => each!(out, a: truth(a == 0.0)),
        Op::Tan
        | Op::Asin
        | Op::Acos
        | Op::Sinh
        | Op::Cosh
        | Op::Tanh
        | Op::Asinh
        | Op::Acosh
        | Op::Atanh
        | Op::Log2
        | Op::Log10 => lane_by_lane(op, a, a, out),
        Op::Add
        | Op::Sub
        | Op::Mul
        | Op::Div
        | Op::Powi
        | Op::Pow
        | Op::Atan2
        | Op::Min
        | Op::Max
        | Op::Mod => {}
        Op::Hypot | Op::Lt | Op::Le | Op::Eq | Op::Ne | Op::And | Op::Or | Op::Select => {}
    }
}

/// Two operands; operators of other arity do nothing.
#[inline(always)]
fn binary(op: Op, a: &[f64], b: &[f64], out: &mut [f64]) {
    match op {
        Op::Add => each!(out, a, b: a + b),
        Op::Sub => each!(out, a, b: a - b),
        Op::Mul => each!(out, a, b: a * b),
        Op::Div => each!(out, a, b: a / b),
        Op::Powi => integer_power(a, b, out),
        Op::Pow => each!(out, a, b: elementary::pow(a, b)),
        Op::Atan2 => each!(out, a, b: elementary::atan2(a, b)),
        Op::Min => each!(out, a, b: elementary::minimum(a, b)),
        Op::Max => each!(out, a, b: elementary::maximum(a, b)),
        Op::Mod => lane_by_lane(op, a, b, out),
        Op::Hypot => each!(out, a, b: elementary::hypot(a, b)),
        Op::Lt => each!(out, a, b: truth(a < b)),
        Op::Le => each!(out, a, b: truth(a <= b)),
        Op::Eq => each!(out, a, b: truth(a == b)),
        Op::Ne => each!(out, a, b: truth(a != b)),
        Op::And => each!(out, a, b: truth((a != 0.0) & (b != 0.0))),
        Op::Or => each!(out, a, b: truth((a != 0.0) | (b != 0.0))),
        Op::Neg
        | Op::Sin
        | Op::Cos
        | Op::Tan
        | Op::Asin
        | Op::Acos
        | Op::Atan
        | Op::Sinh
        | Op::Cosh
        | Op::Tanh => {}
        Op::Asinh
        | Op::Acosh
        | Op::Atanh
        | Op::Exp
        | Op::Log
        | Op::Log2
        | Op::Log10
        | Op::Sqrt
        | Op::Cbrt => {}
        Op::Abs | Op::Sign | Op::Floor | Op::Ceil | Op::Round | Op::Trunc | Op::Not | Op::Select => {}
    }
}

/// `b` where `a` is true, else `c`.
#[inline(always)]
fn select(a: &[f64], b: &[f64], c: &[f64], out: &mut [f64]) {
    for (((out, &a), &b), &c) in out.iter_mut().zip(a).zip(b).zip(c) {
        *out = if a != 0.0 { b } else { c };
    }
}

/// Sine and cosine.
#[inline(always)]
fn sin_cos(a: &[f64], sin: &mut [f64], cos: &mut [f64]) {
    for ((sin, cos), &a) in sin.iter_mut().zip(cos.iter_mut()).zip(a) {
        (*sin, *cos) = elementary::sin_cos_moderate(a);
    }
    redo_huge(a, sin, elementary::sin);
    redo_huge(a, cos, elementary::cos);
}

/// `h` times the sum of the terms, [`WIDTH`] lanes after [`WIDTH`] lanes, and what `finish` makes of it.
#[inline(always)]
fn combination(h: &[f64], terms: &[Term<'_>], finish: impl Fn(usize, f64) -> f64, out: &mut [f64]) {
    let (chunks, rest) = out.as_chunks_mut::<WIDTH>();
    let n_whole = chunks.len() * WIDTH;
    for (start, out) in (0..n_whole).step_by(WIDTH).zip(chunks) {
        let mut sum = [0.0; WIDTH];
        for (place, term) in terms.iter().enumerate() {
            for (sum, k) in sum.iter_mut().zip(&term.column[start..start + WIDTH]) {
                *sum = if place == 0 { term.weight * k } else { *sum + term.weight * k };
            }
        }
        for (lane, (out, sum)) in (start..).zip(out.iter_mut().zip(&sum)) {
            *out = finish(lane, h[lane] * sum);
        }
    }
    for (lane, out) in (n_whole..).zip(rest) {
        let products = terms.iter().map(|term| term.weight * term.column[lane]);
        *out = finish(lane, h[lane] * products.reduce(|sum, product| sum + product).unwrap_or(0.0));
    }
}

/// Puts the scalar function's result where an angle is huge, infinite or NaN.
#[inline(always)]
fn redo_huge(a: &[f64], out: &mut [f64], scalar: fn(f64) -> f64) {
    let mut all_moderate = true;
    for &a in a {
        all_moderate &= elementary::is_moderate(a);
    }
    if !all_moderate {
        lanes_beyond(a, out, scalar);
    }
}

/// The scalar function on the lanes that are not moderate.
#[cold]
#[inline(never)]
fn lanes_beyond(a: &[f64], out: &mut [f64], scalar: fn(f64) -> f64) {
    for (out, &a) in out.iter_mut().zip(a) {
        if !elementary::is_moderate(a) {
            *out = scalar(a);
        }
    }
}

/// The operator itself, for lanes that share nothing.
#[inline(never)]
fn lane_by_lane(op: Op, a: &[f64], b: &[f64], out: &mut [f64]) {
    for ((out, &a), &b) in out.iter_mut().zip(a).zip(b) {
        *out = op.eval([a, b, 0.0]);
    }
}

/// True as a number.
#[inline(always)]
fn truth(holds: bool) -> f64 {
    if holds { 1.0 } else { 0.0 }
}

/// Integer powers: where all exponents are one integer, its bits are the loop outside and the lanes the one inside.
#[inline(always)]
fn integer_power(a: &[f64], b: &[f64], out: &mut [f64]) {
    let Some(&n) = b.first() else { return };
    let exponent = n as i32;
    if f64::from(exponent) != n || !b.iter().fold(true, |all, &b| all & (b == n)) {
        return lane_by_lane(Op::Powi, a, b, out);
    }
    let (chunks, rest) = a.as_chunks::<WIDTH>();
    let (out, out_rest) = out.as_chunks_mut::<WIDTH>();
    for (out, a) in out.iter_mut().zip(chunks) {
        *out = power_of_chunk(*a, exponent);
    }
    for (out, &a) in out_rest.iter_mut().zip(rest) {
        *out = elementary::powi(a, exponent);
    }
}

/// [`elementary::powi`] of some lanes, in its order of roundings.
#[inline(always)]
fn power_of_chunk<const N: usize>(x: [f64; N], n: i32) -> [f64; N] {
    let mut bits = n.unsigned_abs();
    let mut square = x;
    let mut product = [1.0; N];
    while bits != 0 {
        if bits & 1 != 0 {
            for (product, square) in product.iter_mut().zip(&square) {
                *product *= square;
            }
        }
        bits >>= 1;
        if bits != 0 {
            for square in &mut square {
                *square *= *square;
            }
        }
    }
    if n < 0 {
        for product in &mut product {
            *product = 1.0 / *product;
        }
    }
    product
}
