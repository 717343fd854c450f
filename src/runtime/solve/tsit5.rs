//! One step of Tsitouras' Runge-Kutta pair 5(4) with its dense output, for any number of equations.
//!
//! The order of operations is that of [`crate::math::runge_kutta`], so that compiled whole steps give the same bits.

use crate::math::runge_kutta::TSIT5;
use crate::runtime::solve::control::Pace;
use crate::runtime::solve::method::{Flow, Method, Start, Stretch, Trial, Tsit5Rows};
use crate::runtime::solve::segment::Segment;

/// Stages of the method; the last one is the first of the next step.
const STAGES: usize = 7;
/// Order of the method.
pub const ORDER: f64 = 5.0;
/// The most that a step may be longer than the one before.
const GROW: f64 = 6.0;

/// The method.
#[derive(Clone, Debug, Default)]
pub struct Tsit5 {
    /// Rates of the stages: 7 rows of n.
    k: Vec<f64>,
    /// The states of the stage at hand.
    stage: Vec<f64>,
}

impl Method for Tsit5 {
    fn order(&self) -> f64 {
        ORDER
    }

    fn depth(&self) -> usize {
        1
    }

    /// Stages 48, error 14 and its norm 4.
    fn operations(&self, _n_known: usize) -> u64 {
        66
    }

    fn step(&mut self, start: &Start<'_>, flow: &mut dyn Flow, trial: &mut Trial) {
        let &Start { t, h, x, past } = start;
        let n = x.len();
        self.k.resize(STAGES * n, 0.0);
        self.k[..n].copy_from_slice(past.rates(0));
        trial.pace = Pace::Free { order: ORDER, grow: GROW };
        let rows = Tsit5Rows { x, k: &mut self.k, x_new: &mut trial.x_new, error: &mut trial.error };
        if !flow.tsit5(t, h, rows) {
            self.stages(start, flow, trial);
        }
        trial.rates.copy_from_slice(&self.k[(STAGES - 1) * n..]);
    }

    fn dense(&self, stretch: &Stretch, x: &[f64], first: usize, segment: &mut Segment) {
        let n = self.k.len() / STAGES;
        let &Stretch { t, h, end } = stretch;
        let coefficients = segment.reset(t, h, end, 5, x.len());
        for (i, c) in coefficients.chunks_exact_mut(5).enumerate() {
            c[0] = x[i];
            for (power, c) in c[1..].iter_mut().enumerate() {
                let sum =
                    (0..STAGES).fold(0.0, |sum, s| sum + TSIT5.dense[s][power] * self.k[s * n + first + i]);
                *c = h * sum;
            }
        }
    }
}

impl Tsit5 {
    /// The step, stage by stage.
    fn stages(&mut self, start: &Start<'_>, flow: &mut dyn Flow, trial: &mut Trial) {
        let &Start { t, h, x, .. } = start;
        let n = x.len();
        self.stage.resize(n, 0.0);
        for s in 1..STAGES {
            let (known, rest) = self.k.split_at_mut(s * n);
            for (i, (stage, x)) in self.stage.iter_mut().zip(x).enumerate() {
                *stage = x + h * weighted(&TSIT5.a[s][..s], known, n, i);
            }
            flow.rates(t + TSIT5.c[s] * h, &self.stage, &mut rest[..n]);
        }
        trial.x_new.copy_from_slice(&self.stage);
        for i in 0..n {
            trial.error[i] = h * weighted(&TSIT5.error, &self.k, n, i);
        }
    }
}

/// The sum of `weights[s] k_s[i]` from left to right, zero weights left out.
fn weighted(weights: &[f64], k: &[f64], n: usize, i: usize) -> f64 {
    let mut terms = weights.iter().enumerate().filter(|(_, w)| **w != 0.0).map(|(s, w)| w * k[s * n + i]);
    let first = terms.next().unwrap_or(0.0);
    terms.fold(first, |sum, term| sum + term)
}
