//! The integrator of Esposito & Kumar (2004): Adams' predictor-corrector for unequal steps, PECE, of orders 3 and 4.
//!
//! With the rates f at the last three times t_0 > t_1 > t_2, `u_k = t_k - t_0`, and Newton's divided differences f01, f012:
//!
//! ```text
//! predictor   x(s) = x_0 + integral from 0 to s of f_0 + f01 z + f012 z (z - u_1)             Adams-Bashforth, eq. (11)
//! evaluate    f* = f(t_0 + h, x(h))
//! corrector   x(s) = the predictor + f*012 integral of z (z - u_1)(z - u_2)                   Adams-Moulton, of order 4
//! evaluate    the rates that the next step begins with: f at the corrected x(h)
//! error       f*012 integral from 0 to h of z (z - u_1)(z - h)
//! ```
//!
//! where f*012 is the third divided difference with f*. The error is Milne's: the difference of the predictor and the
//! corrector is a multiple of f*012, and so is the error of the corrector of order 3 on f*, f_0, f_1; at unequal steps the
//! ratio is that of the two integrals. The step goes on with order 4. The corrector's polynomial is the dense output, of
//! order 4 too; it ends in the new state.
//!
//! After a restart two steps of Tsitouras' pair give the rates that are missing.

use crate::runtime::solve::control::Pace;
use crate::runtime::solve::method::{Flow, Method, Past, Start, Stretch, Trial};
use crate::runtime::solve::segment::Segment;
use crate::runtime::solve::tsit5::{self, Tsit5};

/// How many rates of the past the predictor uses: m of eq. (11).
pub const POINTS: usize = 3;
/// Order of the corrector; the estimated error falls with its power of the step.
const ORDER: f64 = 4.0;
/// The most that a step may be longer than the one before; the predictor gets worse beyond what it has seen.
const GROW: f64 = 2.0;

/// The method.
#[derive(Clone, Debug, Default)]
pub struct Adams {
    starter: Tsit5,
    /// Whether the last trial was a Runge-Kutta step.
    starting: bool,
    /// Of each equation the coefficients of theta, theta^2, .. of the corrector's polynomial, theta in [0, 1].
    quartics: Vec<[f64; 4]>,
    /// The predicted states.
    predicted: Vec<f64>,
}

impl Method for Adams {
    fn order(&self) -> f64 {
        ORDER
    }

    fn depth(&self) -> usize {
        POINTS
    }

    /// Differences 9, predictor 9, its value 4, corrector 21, its value 4, norm of the error 4.
    fn operations(&self, n_known: usize) -> u64 {
        if n_known < POINTS { self.starter.operations(n_known) } else { 51 }
    }

    fn step(&mut self, start: &Start<'_>, flow: &mut dyn Flow, trial: &mut Trial) {
        self.starting = start.past.len() < POINTS;
        if self.starting {
            self.starter.step(start, flow, trial);
            trial.pace = Pace::Hold { order: tsit5::ORDER };
            return;
        }
        let &Start { t, h, x, past } = start;
        trial.pace = Pace::Free { order: ORDER, grow: GROW };
        self.quartics.clear();
        self.predicted.clear();
        for (i, &x) in x.iter().enumerate() {
            let [linear, square, cubic] = predictor(past, i);
            let quartic = [linear * h, square * h * h, cubic * h * h * h, 0.0];
            self.predicted.push(at_end(x, &quartic));
            self.quartics.push(quartic);
        }
        flow.rates(t + h, &self.predicted, &mut trial.rates);
        let (v1, v2) = ((past.time(1) - past.time(0)) / h, (past.time(2) - past.time(0)) / h);
        for (i, quartic) in self.quartics.iter_mut().enumerate() {
            let [f01, f012] = differences(past, i);
            let first = trial.rates[i] - past.rates(0)[i];
            let second = (first - h * f01) / (1.0 - v1);
            let third = h * ((second - h * h * f012) / (1.0 - v2));
            quartic[1] += third * (v1 * v2 / 2.0);
            quartic[2] -= third * ((v1 + v2) / 3.0);
            quartic[3] = third / 4.0;
            trial.x_new[i] = at_end(x[i], quartic);
            trial.error[i] = third * (v1 / 6.0 - 1.0 / 12.0);
        }
        flow.rates(t + h, &trial.x_new, &mut trial.rates);
    }

    fn dense(&self, stretch: &Stretch, x: &[f64], first: usize, segment: &mut Segment) {
        if self.starting {
            return self.starter.dense(stretch, x, first, segment);
        }
        let &Stretch { t, h, end } = stretch;
        let coefficients = segment.reset(t, h, end, 5, x.len());
        for (i, c) in coefficients.chunks_exact_mut(5).enumerate() {
            c[0] = x[i];
            c[1..].copy_from_slice(&self.quartics[first + i]);
        }
    }
}

/// The predictor polynomial of equation `i`: the coefficients of h, h^2, h^3 in x(t_0 + h) - x(t_0), by eq. (11).
pub fn predictor(past: &Past, i: usize) -> [f64; 3] {
    let [f01, f012] = differences(past, i);
    let u1 = past.time(1) - past.time(0);
    [past.rates(0)[i], (f01 - u1 * f012) / 2.0, f012 / 3.0]
}

/// The same of however many rates are known: none leave a state where it is.
pub fn extrapolation(past: &Past, i: usize) -> [f64; 3] {
    match past.len() {
        0 => [0.0; 3],
        1 => [past.rates(0)[i], 0.0, 0.0],
        2 => [
            past.rates(0)[i],
            (past.rates(0)[i] - past.rates(1)[i]) / (past.time(0) - past.time(1)) / 2.0,
            0.0,
        ],
        _ => predictor(past, i),
    }
}

/// The first and the second divided difference of the rates of equation `i`: on the last two and the last three times.
fn differences(past: &Past, i: usize) -> [f64; 2] {
    let (t0, t1, t2) = (past.time(0), past.time(1), past.time(2));
    let (f0, f1, f2) = (past.rates(0)[i], past.rates(1)[i], past.rates(2)[i]);
    let f01 = (f0 - f1) / (t0 - t1);
    let f12 = (f1 - f2) / (t1 - t2);
    [f01, (f01 - f12) / (t0 - t2)]
}

/// The polynomial at theta = 1, in the order of operations in which a segment evaluates it.
fn at_end(x: f64, quartic: &[f64; 4]) -> f64 {
    (((quartic[3] + quartic[2]) + quartic[1]) + quartic[0]) + x
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::runtime::solve::jacobian::Jacobian;

    /// Unequal times of the past, newest first.
    const TIMES: [f64; 3] = [0.75, 0.45, 0.4];
    const H: f64 = 0.3125;

    /// x' = p(t) with these coefficients: what Adams' method gets from it.
    struct Polynomial<'a>(&'a [f64]);

    impl Polynomial<'_> {
        fn at(&self, t: f64) -> f64 {
            self.0.iter().rev().fold(0.0, |sum, c| sum * t + c)
        }

        fn integral(&self, from: f64, to: f64) -> f64 {
            let power = |k: usize| (to.powi(k as i32 + 1) - from.powi(k as i32 + 1)) / (k as f64 + 1.0);
            self.0.iter().enumerate().map(|(k, c)| c * power(k)).sum()
        }

        fn past(&self) -> Past {
            let mut past = Past::default();
            for t in TIMES.into_iter().rev() {
                past.push(t, &[self.at(t)], POINTS);
            }
            past
        }
    }

    impl Flow for Polynomial<'_> {
        fn rates(&mut self, t: f64, _x: &[f64], dx: &mut [f64]) {
            dx[0] = self.at(t);
        }

        fn tsit5(&mut self, _t: f64, _h: f64, _rows: crate::runtime::solve::method::Tsit5Rows<'_>) -> bool {
            false
        }

        fn jacobian(&mut self, _t: f64, _x: &[f64], jacobian: &mut Jacobian) {
            jacobian.reset(1);
        }

        fn time_rates(&mut self, t: f64, _x: &[f64], rates: &mut [f64]) {
            rates[0] = (1..self.0.len()).rev().fold(0.0, |sum, k| sum * t + k as f64 * self.0[k]);
        }
    }

    /// A step from x = 2: the trial, and the dense output.
    fn step(flow: &mut Polynomial<'_>) -> (Trial, Segment) {
        let (mut adams, mut trial, mut segment) = (Adams::default(), Trial::default(), Segment::default());
        trial.resize(1);
        let past = flow.past();
        adams.step(&Start { t: TIMES[0], h: H, x: &[2.0], past: &past }, flow, &mut trial);
        adams.dense(&Stretch { t: TIMES[0], h: H, end: TIMES[0] + H }, &[2.0], 0, &mut segment);
        (trial, segment)
    }

    #[test]
    fn the_predictor_is_exact_for_rates_of_degree_two() {
        let flow = Polynomial(&[1.0, -2.0, 3.0]);
        let [linear, square, cubic] = predictor(&flow.past(), 0);
        for h in [0.1, H, 1.0] {
            let predicted = h * (linear + h * (square + h * cubic));
            assert!((predicted - flow.integral(TIMES[0], TIMES[0] + h)).abs() < 1e-14);
        }
    }

    #[test]
    fn the_corrector_is_exact_for_rates_of_degree_three_everywhere_in_the_step() {
        let mut flow = Polynomial(&[1.0, -2.0, 3.0, 5.0]);
        let (trial, segment) = step(&mut flow);
        for k in 0..=10 {
            let t = TIMES[0] + H * f64::from(k) / 10.0;
            let mut x = [0.0];
            segment.states(t, &mut x);
            assert!((x[0] - 2.0 - flow.integral(TIMES[0], t)).abs() < 1e-14, "t = {t}");
        }
        assert_eq!(trial.rates, [flow.at(TIMES[0] + H)]);
    }

    #[test]
    fn the_dense_output_ends_in_the_new_state_to_the_bit() {
        let mut flow = Polynomial(&[0.3, 1.7, -2.9, 4.1, -1.3]);
        let (trial, segment) = step(&mut flow);
        let mut x = [0.0];
        segment.states(TIMES[0] + H, &mut x);
        assert_eq!(x[0].to_bits(), trial.x_new[0].to_bits());
    }

    #[test]
    fn the_error_is_that_of_the_corrector_of_order_three() {
        // the quadratic through the rates at t + h, t, t - 0.3 of a cubic, integrated over the step
        let mut flow = Polynomial(&[1.0, -2.0, 3.0, 5.0]);
        let (trial, _) = step(&mut flow);
        let z = [TIMES[0] + H, TIMES[0], TIMES[1]];
        let third = 5.0;
        let missing = |t: f64| third * (t - z[0]) * (t - z[1]) * (t - z[2]);
        // Simpson's rule is exact for a cubic
        let (a, b) = (z[1], z[0]);
        let expected = (b - a) / 6.0 * (missing(a) + 4.0 * missing(0.5 * (a + b)) + missing(b));
        assert!((trial.error[0] - expected).abs() < 1e-14, "{} is not {expected}", trial.error[0]);
    }

    #[test]
    fn equal_steps_give_the_coefficients_of_the_textbook() {
        // x' of (1, 0, 0), (0, 1, 0), (0, 0, 1) at t, t - 1, t - 2: 23/12, -16/12, 5/12
        for (k, weight) in [23.0 / 12.0, -16.0 / 12.0, 5.0 / 12.0].into_iter().enumerate() {
            let mut past = Past::default();
            for j in (0..3).rev() {
                past.push(-(j as f64), &[f64::from(u8::from(j == k))], POINTS);
            }
            let [linear, square, cubic] = predictor(&past, 0);
            assert!((linear + square + cubic - weight).abs() < 1e-15, "weight {k}");
        }
    }
}
