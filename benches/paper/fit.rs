//! Least squares: the paper's models (33) and (37), which are linear in two of their constants once two others are given.

use nalgebra::{Matrix2, Vector2};

/// A fitted curve.
pub struct Fit {
    /// (a + b exp(-c N)) (1 + d N): (33) with d = 0, (37) with its constants brought together.
    pub constants: [f64; 4],
    /// The root of the mean squared residual.
    pub rms: f64,
    /// The share of the variance that it explains.
    pub r2: f64,
}

impl Fit {
    /// The curve at N.
    pub fn at(&self, n: f64) -> f64 {
        let [a, b, c, d] = self.constants;
        (a + b * (-c * n).exp()) * (1.0 + d * n)
    }
}

/// Fits (33): a + b exp(-c N).
pub fn exponential(points: &[(f64, f64)]) -> Fit {
    fit(points, &[0.0])
}

/// Fits (37): (a + b exp(-c N)) (1 + d N).
pub fn speed_up(points: &[(f64, f64)]) -> Fit {
    let slopes: Vec<f64> = (0..=80).map(|k| 0.0025 * f64::from(k)).collect();
    fit(points, &slopes)
}

/// Tries decays and slopes on a grid that is made finer twice about the best.
fn fit(points: &[(f64, f64)], slopes: &[f64]) -> Fit {
    let (mut best, mut error) = ([0.0; 4], f64::INFINITY);
    let mut decays: Vec<f64> = (0..400).map(|k| 1e-3 * 10f64.powf(f64::from(k) * 0.01)).collect();
    let mut slopes = slopes.to_vec();
    for _ in 0..3 {
        for &c in &decays {
            for &d in &slopes {
                if let Some((constants, sum)) = linear(points, c, d)
                    && sum < error
                {
                    (best, error) = (constants, sum);
                }
            }
        }
        let [_, _, c, d] = best;
        decays = (-50..=50).map(|k| c * (1.0 + 5e-4 * f64::from(k))).collect();
        if slopes.len() > 1 {
            slopes = (-25..=25).map(|k| (d + 1e-4 * f64::from(k)).max(0.0)).collect();
        }
    }
    let n = points.len() as f64;
    let mean = points.iter().map(|p| p.1).sum::<f64>() / n;
    let variance: f64 = points.iter().map(|p| (p.1 - mean).powi(2)).sum();
    Fit { constants: best, rms: (error / n).sqrt(), r2: 1.0 - error / variance }
}

/// The best a and b for given c and d, and the sum of the squared residuals.
fn linear(points: &[(f64, f64)], c: f64, d: f64) -> Option<([f64; 4], f64)> {
    let mut normal = Matrix2::zeros();
    let mut right = Vector2::zeros();
    for &(n, s) in points {
        let row = Vector2::new(1.0, (-c * n).exp()) * (1.0 + d * n);
        normal += row * row.transpose();
        right += row * s;
    }
    let solution = normal.lu().solve(&right)?;
    let constants = [solution[0], solution[1], c, d];
    let curve = Fit { constants, rms: 0.0, r2: 0.0 };
    let sum: f64 = points.iter().map(|&(n, s)| (curve.at(n) - s).powi(2)).sum();
    // (37) has positive constants.
    (solution[0] >= 0.0 && solution[1] >= 0.0).then_some((constants, sum))
}
