//! Gear & Osterby's extra states (eqs. 8-10 of the 2004 paper): guards that are integrated like states.
//!
//! To x' = f(x) with the guard g(x) < 0 is added x_{N+1}' = dg/dx f(x), and the guard becomes the linear one x_{N+1} < 0.
//! All guards of a run are one row. Like every state they are integrated by Adams' method: their rates at the last three
//! times give the predictor (11), with the rate at the end of the step the corrector of order 4. Nothing depends on
//! them, so that the corrector is a quadrature. While the method is being started they are set to g itself, and their
//! second rates stand in for the rates of the past.

use crate::runtime::solve::adams::{self, POINTS};
use crate::runtime::solve::method::Past;

/// The extra states of a run and their past rates.
#[derive(Clone, Debug, Default)]
pub struct ExtraStates {
    /// x_{N+1}, one for each guard.
    pub g: Vec<f64>,
    /// Their second rates when they were last set.
    second: Vec<f64>,
    past: Past,
}

impl ExtraStates {
    /// Begins afresh at `t`, where the guards and their first two rates have these values.
    pub fn restart(&mut self, t: f64, g: &[f64], rates: &[f64], second: &[f64]) {
        self.past.clear();
        self.start(t, g, rates, second);
    }

    /// Whether three rates are known, so that the method can take over.
    pub fn is_started(&self) -> bool {
        self.past.len() == POINTS
    }

    /// Takes the step to `t` while the method is being started: the guards are what they are there.
    pub fn start(&mut self, t: f64, g: &[f64], rates: &[f64], second: &[f64]) {
        for (own, given) in [(&mut self.g, g), (&mut self.second, second)] {
            own.clear();
            own.extend_from_slice(given);
        }
        self.past.push(t, rates, POINTS);
    }

    /// Takes the step to `t`, where the guards' rates are these.
    pub fn step(&mut self, t: f64, rates: &[f64]) {
        let past = &self.past;
        let weights = weights(t, [past.time(0), past.time(1), past.time(2)]);
        for (i, g) in self.g.iter_mut().enumerate() {
            *g += weights[0] * rates[i]
                + weights[1] * past.rates(0)[i]
                + weights[2] * past.rates(1)[i]
                + weights[3] * past.rates(2)[i];
        }
        self.past.push(t, rates, POINTS);
    }

    /// The predictor polynomial of guard `i` without its constant (11).
    pub fn predictor(&self, i: usize) -> [f64; 3] {
        match self.is_started() {
            true => adams::predictor(&self.past, i),
            false => [self.past.rates(0)[i], self.second[i] / 2.0, 0.0],
        }
    }
}

/// What the integral from `t_0` to `t` of a cubic is in terms of its values at t and at t_0 > t_1 > t_2: the weights of
/// the corrector of Adams and Moulton at unequal steps.
fn weights(t: f64, [t0, t1, t2]: [f64; 3]) -> [f64; 4] {
    let h = t - t0;
    let nodes = [1.0, 0.0, (t1 - t0) / h, (t2 - t0) / h];
    std::array::from_fn(|k| {
        let others: Vec<f64> = (0..4).filter(|&j| j != k).map(|j| nodes[j]).collect();
        let &[a, b, c] = others.as_slice() else { unreachable!("three of four") };
        // Integral from 0 to 1 of (u - a)(u - b)(u - c).
        let integral = 0.25 - (a + b + c) / 3.0 + (a * b + a * c + b * c) / 2.0 - a * b * c;
        let scale = (nodes[k] - a) * (nodes[k] - b) * (nodes[k] - c);
        h * integral / scale
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_guard_that_is_a_quartic_is_integrated_exactly() {
        let g = |t: f64| t.powi(4) - 2.0 * t.powi(3) + t - 5.0;
        let rate = |t: f64| 4.0 * t.powi(3) - 6.0 * t.powi(2) + 1.0;
        let times = [0.0, 0.1, 0.35, 0.5, 1.1, 1.3, 2.0];
        let mut extra = ExtraStates::default();
        extra.restart(times[0], &[g(times[0])], &[rate(times[0])], &[0.0]);
        for &t in &times[1..] {
            if extra.is_started() {
                extra.step(t, &[rate(t)]);
            } else {
                extra.start(t, &[g(t)], &[rate(t)], &[0.0]);
            }
            assert!((extra.g[0] - g(t)).abs() < 1e-13, "{t}: {} {}", extra.g[0], g(t));
        }
    }

    #[test]
    fn at_equal_steps_the_weights_are_those_of_the_textbook() {
        let found = weights(3.0, [2.0, 1.0, 0.0]);
        for (found, expected) in found.into_iter().zip([9.0, 19.0, -5.0, 1.0]) {
            assert!((found - expected / 24.0).abs() < 1e-15, "{found}");
        }
    }
}
