//! Steps by Taylor series of the order that the tolerance asks for; where a flow has none, by Tsitouras' pair.
//!
//! The series is expanded before the step is chosen, and says how long it may be ([`crate::runtime::solve::series_step`]). It is
//! the dense output too, and its value at the end is the new state. The error is the largest of three: the last term, the
//! one before it less e^2, and h / (p + 1) times what the rates at the end differ from the slope of the series there. The last
//! one costs an evaluation, and sees what a series cannot: that it was continued beyond a branch point, on which the
//! flow has no analytic continuation (`x' = -sqrt(x)` at 0), and that its last terms vanish by chance. A step whose series says
//! next to nothing is looked at between its ends, too: a pulse that comes later (`sin(time)^50` from 0 on) leaves no
//! trace in the terms, and may be over at the end.

use crate::runtime::solve::control::{Accuracy, Pace};
use crate::runtime::solve::method::{Flow, Method, SeriesRows, Start, Stretch, Trial};
use crate::runtime::solve::segment::{N_MAX, Segment};
use crate::runtime::solve::series_step::{self, LOOKS, errors, inside, is_quiet, look, look_inside, sum_up};
use crate::runtime::solve::tsit5::{self, Tsit5};

/// The most that the step of another method, should one follow, may be longer.
const GROW: f64 = 6.0;

/// The method.
#[derive(Clone, Debug)]
pub struct Taylor {
    order: usize,
    rows: SeriesRows,
    /// Whether the step at hand goes by a series.
    is_series: bool,
    /// Of each state the terms of the last trial at its end: c_k h^k.
    terms: Vec<f64>,
    /// States within a step, and their rates.
    inside: Vec<f64>,
    /// By which the step at hand has been chosen.
    accuracy: Accuracy,
    other: Tsit5,
}

impl Taylor {
    /// The method for a tolerance.
    pub fn new(tolerance: f64) -> Self {
        Self {
            order: series_step::order(tolerance, N_MAX - 1),
            rows: SeriesRows::default(),
            is_series: false,
            terms: Vec::new(),
            inside: Vec::new(),
            accuracy: Accuracy { tolerance, absolute: tolerance },
            other: Tsit5::default(),
        }
    }
}

impl Taylor {
    /// Looks at the rates between the ends of a step, if it is quiet.
    fn look_inside(&mut self, &Start { t, h, .. }: &Start<'_>, flow: &mut dyn Flow, trial: &mut Trial) {
        let quiet = is_quiet(&self.terms, self.order, self.accuracy);
        if quiet == 0.0 {
            return;
        }
        let n = trial.x_new.len();
        self.inside.resize(2 * n, 0.0);
        let (x, rates) = self.inside.split_at_mut(n);
        for share in (0..LOOKS).map(look) {
            inside(&self.terms, self.order, share, x);
            flow.rates(t + share * h, x, rates);
            look_inside(&self.terms, (self.order, share), (h, quiet), rates, &mut trial.error);
        }
    }
}

impl Method for Taylor {
    fn order(&self) -> f64 {
        tsit5::ORDER
    }

    fn depth(&self) -> usize {
        1
    }

    /// Powers and terms, their sum, the slope, the error 7 and its norm 4.
    fn operations(&self, n_known: usize) -> u64 {
        if self.is_series { 5 * self.order as u64 + 11 } else { self.other.operations(n_known) }
    }

    fn reach(&mut self, t: f64, x: &[f64], accuracy: Accuracy, flow: &mut dyn Flow) -> Option<f64> {
        self.is_series = flow.series(t, x, self.order, &mut self.rows);
        self.accuracy = accuracy;
        if self.is_series {
            let h = series_step::reach(&self.rows.coefficients, x.len(), self.order, accuracy);
            self.is_series = h > 0.0;
            return self.is_series.then_some(h);
        }
        None
    }

    fn step(&mut self, start: &Start<'_>, flow: &mut dyn Flow, trial: &mut Trial) {
        if !self.is_series {
            return self.other.step(start, flow, trial);
        }
        let &Start { t, h, x, .. } = start;
        let n_terms = self.order + 1;
        self.terms.resize(n_terms * x.len(), 0.0);
        sum_up(&self.rows.coefficients, self.order, h, &mut self.terms, &mut trial.x_new);
        flow.rates(t + h, &trial.x_new, &mut trial.rates);
        errors(&self.terms, self.order, h, &trial.rates, &mut trial.error);
        if !self.rows.is_polynomial {
            self.look_inside(start, flow, trial);
        }
        trial.pace = Pace::Free { order: self.order as f64, grow: GROW };
    }

    fn dense(&self, stretch: &Stretch, x: &[f64], first: usize, segment: &mut Segment) {
        if !self.is_series {
            return self.other.dense(stretch, x, first, segment);
        }
        let &Stretch { t, h, end } = stretch;
        let n_terms = self.order + 1;
        let own = || self.terms.chunks_exact(n_terms).skip(first).take(x.len());
        let used = |terms: &[f64]| terms.iter().rposition(|term| *term != 0.0).map_or(1, |last| last + 1);
        let n_used = own().map(used).max().unwrap_or(1);
        let coefficients = segment.reset(t, h, end, n_used, x.len());
        for (c, terms) in coefficients.chunks_exact_mut(n_used).zip(own()) {
            c.copy_from_slice(&terms[..n_used]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::runtime::solve::jacobian::Jacobian;
    use crate::runtime::solve::method::{Past, Tsit5Rows};

    /// x' = x, whose coefficients are x / k!.
    struct Growth;

    impl Flow for Growth {
        fn rates(&mut self, _t: f64, x: &[f64], dx: &mut [f64]) {
            dx.copy_from_slice(x);
        }

        fn tsit5(&mut self, _t: f64, _h: f64, _rows: Tsit5Rows<'_>) -> bool {
            false
        }

        fn series(&mut self, _t: f64, x: &[f64], order: usize, rows: &mut SeriesRows) -> bool {
            rows.coefficients = x.to_vec();
            (1..=order).for_each(|k| rows.coefficients.push(rows.coefficients[k - 1] / k as f64));
            true
        }

        fn jacobian(&mut self, _t: f64, _x: &[f64], jacobian: &mut Jacobian) {
            jacobian.reset(1);
            jacobian.push(0, 0, 1.0);
        }

        fn time_rates(&mut self, _t: f64, _x: &[f64], rates: &mut [f64]) {
            rates[0] = 0.0;
        }
    }

    fn step(taylor: &mut Taylor, h: f64) -> Trial {
        let accuracy = Accuracy { tolerance: 1e-4, absolute: 1e-4 };
        let (mut trial, mut past) = (Trial::default(), Past::default());
        trial.resize(1);
        past.push(0.0, &[1.0], 1);
        taylor.reach(0.0, &[1.0], accuracy, &mut Growth).expect("it has a series");
        taylor.step(&Start { t: 0.0, h, x: &[1.0], past: &past }, &mut Growth, &mut trial);
        trial
    }

    #[test]
    fn the_error_of_a_step_falls_with_the_power_of_the_order_and_is_within_the_estimate() {
        let mut taylor = Taylor::new(1e-4);
        let error = |trial: &Trial, h: f64| (trial.x_new[0] - h.exp()).abs();
        let (long, short) = (step(&mut taylor, 0.5), step(&mut taylor, 0.25));
        let power = (error(&long, 0.5) / error(&short, 0.25)).log2();
        assert!((power - (taylor.order as f64 + 1.0)).abs() < 0.1, "{power} at order {}", taylor.order);
        for (trial, h) in [(&long, 0.5_f64), (&short, 0.25)] {
            let term = |k: usize| (1..=k).fold(1.0, |term, j| term * h / j as f64);
            let estimate = term(taylor.order).max((-2.0_f64).exp() * term(taylor.order - 1));
            assert!((trial.error[0] / estimate - 1.0).abs() < 1e-12, "{} is not {estimate}", trial.error[0]);
            assert!(error(trial, h) < estimate);
        }
    }

    #[test]
    fn the_new_state_is_the_end_of_the_dense_output_to_the_bit() {
        let mut taylor = Taylor::new(1e-10);
        let trial = step(&mut taylor, 0.75);
        let (mut segment, mut x) = (Segment::default(), [0.0]);
        taylor.dense(&Stretch { t: 2.0, h: 0.75, end: 2.75 }, &[1.0], 0, &mut segment);
        segment.states(2.75, &mut x);
        assert_eq!(x[0].to_bits(), trial.x_new[0].to_bits());
    }
}
