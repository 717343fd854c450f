//! One step by Taylor series of one agent or of many in lanes, to be taken again at will: it depends on time and states only.
//!
//! The step is that of [`crate::runtime::solve::taylor`] with its first try; where that would not be accepted, the step is
//! refused, and the agent is left to who can try again. One source, the same bits in every lane.

use crate::codegen::series::SeriesTape;
use crate::math::{Numbers, Wide};
use crate::runtime::solve::control::Accuracy;
use crate::runtime::solve::segment::{N_MAX, Segment};
use crate::runtime::solve::series_step::{
    LOOKS, bounds, errors, inside, is_quiet, look, look_inside, reach, sum_up,
};

/// The series of a flow, with all that a step depends on besides time and states.
#[derive(Clone, Copy, Debug)]
pub struct Leaps<'p> {
    /// The series.
    pub tape: &'p SeriesTape,
    /// Its order.
    pub order: usize,
    /// What a step is accepted by.
    pub accuracy: Accuracy,
    /// No step leads beyond, s.
    pub stop: f64,
}

/// Scratch for steps.
#[derive(Clone, Debug, Default)]
pub struct LeapRows<T> {
    /// What does not move.
    pub fixed: Vec<T>,
    coefficients: Vec<T>,
    rates: Vec<T>,
    /// The terms of each state's series at the end of the step.
    pub terms: Vec<T>,
    ends: Vec<T>,
    inside: Vec<T>,
    /// The error of each state in the last step.
    pub errors: Vec<T>,
    /// Bounds of each state over the last step: [`Leaps::bound`].
    pub lows: Vec<T>,
    /// See `lows`.
    pub highs: Vec<T>,
}

impl<T: Numbers> LeapRows<T> {
    /// Room for the steps of a flow.
    pub fn new(leaps: &Leaps<'_>) -> Self {
        let zero = T::all(0.0);
        Self {
            fixed: vec![zero; leaps.tape.fixed.len()],
            coefficients: vec![zero; leaps.tape.n_coefficients(leaps.order)],
            rates: vec![zero; leaps.tape.n_coefficients(1)],
            terms: vec![zero; leaps.tape.n_states * (leaps.order + 1)],
            ends: vec![zero; leaps.tape.n_states],
            inside: vec![zero; leaps.tape.n_states],
            errors: vec![zero; leaps.tape.n_states],
            lows: vec![zero; leaps.tape.n_states],
            highs: vec![zero; leaps.tape.n_states],
        }
    }

    /// The rates are the first coefficients of a series of order 1.
    #[inline(always)]
    fn take_rates(&mut self) {
        for (end, row) in self.ends.iter_mut().zip(self.rates.chunks_exact(2)) {
            *end = row[1];
        }
    }
}

/// What a step comes to.
#[derive(Clone, Copy, Debug)]
pub struct Leap<T> {
    /// Its length, s.
    pub h: T,
    /// Where it ends, s.
    pub end: T,
    /// 1 if it is good enough, 0 if it is refused.
    pub good: T,
}

impl Leaps<'_> {
    /// A step from `(t, x)` for the numbers in `rows.fixed`; the states at its end go to `x_new`.
    #[inline(always)]
    pub fn leap<T: Expand>(&self, t: T, x: &[T], rows: &mut LeapRows<T>, x_new: &mut [T]) -> Leap<T> {
        let (order, n) = (self.order, x.len());
        T::expand(self.tape, t, x, &rows.fixed, order, &mut rows.coefficients);
        let stop = self.stop;
        let h = reach(&rows.coefficients, n, order, self.accuracy);
        let h = h.zip(t, |h, t| if h >= (stop - t) * (1.0 - 1e-12) { stop - t } else { h });
        let end = t.zip(h, |t, h| if h == stop - t { stop } else { t + h });
        sum_up(&rows.coefficients, order, h, &mut rows.terms, x_new);
        T::expand(self.tape, end, x_new, &rows.fixed, 1, &mut rows.rates);
        rows.take_rates();
        errors(&rows.terms, order, h, &rows.ends, &mut rows.errors);
        if !self.tape.is_polynomial() {
            let quiet = is_quiet(&rows.terms, order, self.accuracy);
            if quiet.is_any() {
                self.look_inside((t, h), quiet, rows);
            }
        }
        let mut good = end.zip(t, |end, t| if end > t { 1.0 } else { 0.0 });
        for i in 0..n {
            let size = x[i].zip(x_new[i], |x, x_new| larger(x.abs(), x_new.abs()));
            let allowed = size.map(|size| self.accuracy.allowed(size));
            // NaN is no number that is small enough.
            let accepted =
                rows.errors[i].zip(allowed, |error, allowed| if error <= allowed { 1.0 } else { 0.0 });
            good = good.zip(accepted, |good, accepted| good * accepted);
        }
        Leap { h, end, good }
    }

    /// Looks at the rates between the ends of a quiet step.
    #[inline(always)]
    fn look_inside<T: Expand>(&self, (t, h): (T, T), quiet: T, rows: &mut LeapRows<T>) {
        for share in (0..LOOKS).map(look) {
            inside(&rows.terms, self.order, share, &mut rows.inside);
            let time = t.zip(h, |t, h| t + share * h);
            T::expand(self.tape, time, &rows.inside, &rows.fixed, 1, &mut rows.rates);
            rows.take_rates();
            look_inside(&rows.terms, (self.order, share), (h, quiet), &rows.ends, &mut rows.errors);
        }
    }

    /// Bounds the states over the step from `x` to `x_new` that `rows` holds.
    #[inline(always)]
    pub fn bound<T: Numbers>(&self, x: &[T], x_new: &[T], rows: &mut LeapRows<T>) {
        let LeapRows { terms, lows, highs, .. } = rows;
        bounds(terms, self.order, (x, x_new), (lows, highs));
    }
}

/// A step that covers a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Covering {
    /// Its length, s.
    pub h: f64,
    /// Its error in units of what is allowed.
    pub ratio: f64,
}

/// Numbers in which a series can be expanded; what does it is compiled once.
pub trait Expand: Numbers {
    /// Whether any of the numbers is not 0.
    fn is_any(self) -> bool;

    /// [`SeriesTape::expand_numbers`].
    fn expand(
        tape: &SeriesTape,
        time: Self,
        states: &[Self],
        fixed: &[Self],
        order: usize,
        rows: &mut [Self],
    );
}

impl Expand for f64 {
    #[inline(always)]
    fn is_any(self) -> bool {
        self != 0.0
    }

    fn expand(tape: &SeriesTape, time: f64, states: &[f64], fixed: &[f64], order: usize, rows: &mut [f64]) {
        tape.expand(time, states, fixed, order, rows);
    }
}

impl Expand for Wide {
    #[inline(always)]
    fn is_any(self) -> bool {
        self.0.iter().any(|&lane| lane != 0.0)
    }

    fn expand(
        tape: &SeriesTape,
        time: Wide,
        states: &[Wide],
        fixed: &[Wide],
        order: usize,
        rows: &mut [Wide],
    ) {
        tape.expand_wide(time, states, fixed, order, rows);
    }
}

/// The larger of two; NaN if the first is.
#[inline(always)]
fn larger(a: f64, b: f64) -> f64 {
    if b > a { b } else { a }
}

impl Leaps<'_> {
    /// Follows an agent from `(t, x)` until a step covers `until`, s: its dense output in `segment`, and the states at its
    /// end in `x`. None if a step is refused before: then `x` holds the states at its begin, and `segment` rests there.
    pub fn follow(
        &self,
        (mut t, until): (f64, f64),
        x: &mut [f64],
        rows: &mut LeapRows<f64>,
        segment: &mut Segment,
    ) -> Option<Covering> {
        let mut x_new = [0.0; STATES_MAX];
        let x_new = &mut x_new[..x.len()];
        loop {
            let leap = self.leap(t, x, rows, x_new);
            if leap.good == 0.0 {
                *segment = Segment::at(t, x);
                return None;
            }
            if leap.end >= until {
                let n_terms = self.order + 1;
                debug_assert!(n_terms <= N_MAX);
                let terms = segment.reset(t, leap.h, leap.end, n_terms, x.len());
                terms.copy_from_slice(&rows.terms);
                let ratio = self.accuracy.error_norm(&rows.errors, x, x_new);
                x.copy_from_slice(x_new);
                return Some(Covering { h: leap.h, ratio });
            }
            x.copy_from_slice(x_new);
            t = leap.end;
        }
    }
}

/// The most states of an agent that is followed so; agents of more are stepped one by one.
pub const STATES_MAX: usize = 32;
