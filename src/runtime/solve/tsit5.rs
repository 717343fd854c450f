//! One step of Tsitouras' Runge-Kutta pair 5(4) with its dense output, for any number of equations.
//!
//! The order of operations is that of [`crate::math::runge_kutta`], so that compiled whole steps give the same bits.

use crate::math::runge_kutta::TSIT5;
use crate::runtime::solve::segment::Segment;

/// Stages of the method; the last one is the first of the next step.
pub const STAGES: usize = 7;
/// Order of the method.
pub const ORDER: f64 = 5.0;

/// What a step computes: `k` holds the stages' rates one after the other, `k[..n]` is given.
#[derive(Clone, Debug, Default)]
pub struct StepRows {
    /// Rates of the stages: 7 rows of n.
    pub k: Vec<f64>,
    /// The result.
    pub x_new: Vec<f64>,
    /// The estimate of its error.
    pub error: Vec<f64>,
    /// The states of the stage at hand.
    stage: Vec<f64>,
}

impl StepRows {
    /// Makes room for `n` equations.
    pub fn resize(&mut self, n: usize) {
        self.k.resize(STAGES * n, 0.0);
        self.x_new.resize(n, 0.0);
        self.error.resize(n, 0.0);
        self.stage.resize(n, 0.0);
    }
}

/// A right-hand side: time, states, and where their rates go.
pub type Rates<'a> = dyn FnMut(f64, &[f64], &mut [f64]) + 'a;

/// An accepted step, from which dense output is made.
pub struct Accepted<'a> {
    /// Where it begins, s.
    pub t: f64,
    /// Its length, s.
    pub h: f64,
    /// Where it ends: t + h, or what that is meant to be, s.
    pub end: f64,
    /// Rates of the stages: 7 rows of n.
    pub k: &'a [f64],
    /// How many equations.
    pub n: usize,
}

/// Takes a step of length `h` from `(t, x)`; `rates(t, x, dx)` is the right-hand side.
pub fn step(t: f64, h: f64, x: &[f64], rows: &mut StepRows, rates: &mut Rates<'_>) {
    let n = x.len();
    for s in 1..STAGES {
        let (known, rest) = rows.k.split_at_mut(s * n);
        for (i, (stage, x)) in rows.stage.iter_mut().zip(x).enumerate() {
            *stage = x + h * weighted(&TSIT5.a[s][..s], known, n, i);
        }
        rates(t + TSIT5.c[s] * h, &rows.stage, &mut rest[..n]);
    }
    rows.x_new.copy_from_slice(&rows.stage);
    for i in 0..n {
        rows.error[i] = h * weighted(&TSIT5.error, &rows.k, n, i);
    }
}

/// The sum of `weights[s] k_s[i]` from left to right, zero weights left out.
fn weighted(weights: &[f64], k: &[f64], n: usize, i: usize) -> f64 {
    let mut terms = weights.iter().enumerate().filter(|(_, w)| **w != 0.0).map(|(s, w)| w * k[s * n + i]);
    let first = terms.next().unwrap_or(0.0);
    terms.fold(first, |sum, term| sum + term)
}

/// Writes the dense output of the states `x`, which begin at row `first` of a step.
pub fn dense(step: &Accepted<'_>, x: &[f64], first: usize, segment: &mut Segment) {
    let coefficients = segment.reset(step.t, step.h, step.end, 5, x.len());
    for (i, c) in coefficients.chunks_exact_mut(5).enumerate() {
        c[0] = x[i];
        for (power, c) in c[1..].iter_mut().enumerate() {
            let sum =
                (0..STAGES).fold(0.0, |sum, s| sum + TSIT5.dense[s][power] * step.k[s * step.n + first + i]);
            *c = step.h * sum;
        }
    }
}
