//! Every operator over columns of numbers, with the instructions that this CPU has and the bits of [`Op::eval`].
//!
//! In: operands as slices of equal length, any length; 32 at a time is what the callers like. Out: a column.
//! The loops stand once, in `columns`, and are compiled for each [`Level`]; which of them runs is found out once.
//! Promised: the same bits at every level and those of [`Op::eval`] (up to a NaN's sign and payload). The source is the
//! scalar functions' own, of operations that IEEE 754 rounds correctly in lanes as well, and nothing is contracted.

mod level;
mod columns;

pub use level::{Level, Work};

use super::Op;

/// What fits every register: a column's last lanes are filled up to a multiple of this.
const WIDTH: usize = 8;

/// `op` of one operand over a column.
#[inline]
pub fn unary(op: Op, a: &[f64], out: &mut [f64]) {
    Level::best().unary(op, a, out);
}

/// `op` of two operands over columns.
#[inline]
pub fn binary(op: Op, a: &[f64], b: &[f64], out: &mut [f64]) {
    Level::best().binary(op, a, b, out);
}

/// [`Op::Select`] over columns: `b` where `a` is true, else `c`.
#[inline]
pub fn select(a: &[f64], b: &[f64], c: &[f64], out: &mut [f64]) {
    Level::best().select(a, b, c, out);
}

/// Sine and cosine of a column for little more than the price of one.
#[inline]
pub fn sin_cos(a: &[f64], sin: &mut [f64], cos: &mut [f64]) {
    Level::best().sin_cos(a, sin, cos);
}

/// `h ((w_1 k_1 + w_2 k_2) + ...)` over columns, from left to right; `h` times 0 without terms.
#[inline]
pub fn combination(h: &[f64], terms: &[Term<'_>], out: &mut [f64]) {
    Level::best().combination(h, terms, out);
}

/// `x + h ((w_1 k_1 + w_2 k_2) + ...)` over columns, in the order of [`combination`].
#[inline]
pub fn advance(x: &[f64], h: &[f64], terms: &[Term<'_>], out: &mut [f64]) {
    Level::best().advance(x, h, terms, out);
}

impl Level {
    /// [`unary`] with this level's instructions.
    pub fn unary(self, op: Op, a: &[f64], out: &mut [f64]) {
        assert!(op.arity() == 1 && a.len() == out.len(), "{op:?} of {} lanes into {}", a.len(), out.len());
        let (a, a_rest) = a.split_at(whole(a.len()));
        let (out, out_rest) = out.split_at_mut(a.len());
        self.run(columns::Task::Unary { op, a, out });
        if !a_rest.is_empty() {
            let mut last = [0.0; WIDTH];
            self.run(columns::Task::Unary { op, a: &filled(a_rest), out: &mut last });
            out_rest.copy_from_slice(&last[..out_rest.len()]);
        }
    }

    /// [`binary`] with this level's instructions.
    pub fn binary(self, op: Op, a: &[f64], b: &[f64], out: &mut [f64]) {
        assert!(
            op.arity() == 2 && a.len() == out.len() && b.len() == out.len(),
            "{op:?} into {} lanes",
            out.len()
        );
        let (a, a_rest) = a.split_at(whole(a.len()));
        let (b, b_rest) = b.split_at(a.len());
        let (out, out_rest) = out.split_at_mut(a.len());
        self.run(columns::Task::Binary { op, a, b, out });
        if !a_rest.is_empty() {
            let mut last = [0.0; WIDTH];
            let (a, b) = (&filled(a_rest), &filled(b_rest));
            self.run(columns::Task::Binary { op, a, b, out: &mut last });
            out_rest.copy_from_slice(&last[..out_rest.len()]);
        }
    }

    /// [`select`] with this level's instructions.
    pub fn select(self, a: &[f64], b: &[f64], c: &[f64], out: &mut [f64]) {
        let n = out.len();
        assert!(a.len() == n && b.len() == n && c.len() == n, "a choice of other than {n} lanes");
        self.run(columns::Task::Select { a, b, c, out });
    }

    /// [`sin_cos`] with this level's instructions.
    pub fn sin_cos(self, a: &[f64], sin: &mut [f64], cos: &mut [f64]) {
        assert!(
            a.len() == sin.len() && a.len() == cos.len(),
            "sine and cosine of other than {} lanes",
            a.len()
        );
        let (a, a_rest) = a.split_at(whole(a.len()));
        let (sin, sin_rest) = sin.split_at_mut(a.len());
        let (cos, cos_rest) = cos.split_at_mut(a.len());
        self.run(columns::Task::SinCos { a, sin, cos });
        if !a_rest.is_empty() {
            let (mut last_sin, mut last_cos) = ([0.0; WIDTH], [0.0; WIDTH]);
            let (sin, cos) = (&mut last_sin, &mut last_cos);
            self.run(columns::Task::SinCos { a: &filled(a_rest), sin, cos });
            sin_rest.copy_from_slice(&last_sin[..sin_rest.len()]);
            cos_rest.copy_from_slice(&last_cos[..cos_rest.len()]);
        }
    }

    /// [`combination`] with this level's instructions.
    pub fn combination(self, h: &[f64], terms: &[Term<'_>], out: &mut [f64]) {
        let n = out.len();
        assert!(
            h.len() == n && terms.iter().all(|term| term.column.len() == n),
            "terms of other than {n} lanes"
        );
        self.run(columns::Task::Combination { h, terms, out });
    }

    /// [`advance`] with this level's instructions.
    pub fn advance(self, x: &[f64], h: &[f64], terms: &[Term<'_>], out: &mut [f64]) {
        let n = out.len();
        assert!(x.len() == n && h.len() == n, "a step of other than {n} lanes");
        assert!(terms.iter().all(|term| term.column.len() == n), "terms of other than {n} lanes");
        self.run(columns::Task::Advance { x, h, terms, out });
    }
}

/// What a combination adds: a weight and a column.
#[derive(Clone, Copy, Debug)]
pub struct Term<'a> {
    /// The same for all lanes.
    pub weight: f64,
    /// What it weighs.
    pub column: &'a [f64],
}

/// The largest multiple of [`WIDTH`] that is not above `n`.
#[inline]
fn whole(n: usize) -> usize {
    n / WIDTH * WIDTH
}

/// A column's last lanes, and ones.
#[inline]
fn filled(rest: &[f64]) -> [f64; WIDTH] {
    let mut lanes = [1.0; WIDTH];
    lanes[..rest.len()].copy_from_slice(rest);
    lanes
}
