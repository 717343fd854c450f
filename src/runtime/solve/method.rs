//! What every method of integration is to the engine: it tries a step, hands out its dense output, remembers the past.
//!
//! A method may use what is known of the [`Past`]: the rates at the ends of the steps since the last restart. Whoever
//! restarts an integration clears it. Whether a trial is good enough, and how long the next one is, is not for the
//! method to say ([`crate::runtime::solve::control`]).

use crate::runtime::solve::control::{Accuracy, Pace};
use crate::runtime::solve::jacobian::Jacobian;
use crate::runtime::solve::segment::Segment;

/// A right-hand side.
pub trait Flow {
    /// f(t, x) into `dx`.
    fn rates(&mut self, t: f64, x: &[f64], dx: &mut [f64]);

    /// A whole step of Tsitouras' pair as one function, with the bits of the plain one: fills in all but the first row of
    /// `k`, which is given. False, and nothing is done, where there is no such function.
    fn tsit5(&mut self, t: f64, h: f64, rows: Tsit5Rows<'_>) -> bool;

    /// The Taylor coefficients of the solution through (t, x) up to `order`, in 1/s^k, as the first rows of
    /// `rows.coefficients`: `order` + 1 for each state. False, and nothing is done, where the flow has no series.
    fn series(&mut self, _t: f64, _x: &[f64], _order: usize, _rows: &mut SeriesRows) -> bool {
        false
    }

    /// df/dx at (t, x).
    fn jacobian(&mut self, t: f64, x: &[f64], jacobian: &mut Jacobian);

    /// df/dt at (t, x), the states held, into `rates`.
    fn time_rates(&mut self, t: f64, x: &[f64], rates: &mut [f64]);
}

/// What a series is expanded in; kept from step to step.
#[derive(Clone, Debug, Default)]
pub struct SeriesRows {
    /// The states' rows, then those that the flow needs.
    pub coefficients: Vec<f64>,
    /// What does not move.
    pub fixed: Vec<f64>,
    /// Whether the states are polynomials of the time.
    pub is_polynomial: bool,
}

/// What a compiled step of Tsitouras' pair reads and fills in, for n equations.
pub struct Tsit5Rows<'a> {
    /// The states at its begin.
    pub x: &'a [f64],
    /// Rates of the stages: 7 rows of n, the first given.
    pub k: &'a mut [f64],
    /// The states at its end.
    pub x_new: &'a mut [f64],
    /// The estimate of their errors.
    pub error: &'a mut [f64],
}

/// Where a step begins, and how long it is to be.
#[derive(Clone, Copy, Debug)]
pub struct Start<'a> {
    /// s.
    pub t: f64,
    /// s.
    pub h: f64,
    /// The states.
    pub x: &'a [f64],
    /// The rates there, and at the times before: at least one.
    pub past: &'a Past,
}

/// What a step comes to.
#[derive(Clone, Debug, Default)]
pub struct Trial {
    /// The states at its end.
    pub x_new: Vec<f64>,
    /// The estimate of their errors.
    pub error: Vec<f64>,
    /// The rates at its end.
    pub rates: Vec<f64>,
    /// How the next step may be chosen from the error.
    pub pace: Pace,
}

impl Trial {
    /// Makes room for `n` equations.
    pub fn resize(&mut self, n: usize) {
        self.x_new.resize(n, 0.0);
        self.error.resize(n, 0.0);
        self.rates.resize(n, 0.0);
    }
}

/// The stretch that an accepted step covers.
#[derive(Clone, Copy, Debug)]
pub struct Stretch {
    /// Where it begins, s.
    pub t: f64,
    /// Its length, s.
    pub h: f64,
    /// Where it ends: t + h, or what that is meant to be, s.
    pub end: f64,
}

/// A method of integration with its scratch space; what it knows of an integration is in its [`Past`].
pub trait Method {
    /// The power of the step that the first guess of its length goes by.
    fn order(&self) -> f64;

    /// How many rates of the past it uses.
    fn depth(&self) -> usize;

    /// Arithmetic operations of a step for each equation, without the right-hand side, from this many rates of the past.
    fn operations(&self, n_known: usize) -> u64;

    /// The longest step that the method would take, s, where it knows before it tries one; a step from here follows.
    fn reach(&mut self, _t: f64, _x: &[f64], _accuracy: Accuracy, _flow: &mut dyn Flow) -> Option<f64> {
        None
    }

    /// Tries a step; `trial` has room for the equations.
    fn step(&mut self, start: &Start<'_>, flow: &mut dyn Flow, trial: &mut Trial);

    /// Writes the dense output of the last trial for the states `x` at its begin, which are its equations from `first` on.
    fn dense(&self, stretch: &Stretch, x: &[f64], first: usize, segment: &mut Segment);
}

/// The rates at the ends of the last steps since a restart, newest first.
#[derive(Clone, Debug, Default)]
pub struct Past {
    points: Vec<Point>,
    n_known: usize,
}

/// A time and the rates at it.
#[derive(Clone, Debug, Default)]
struct Point {
    t: f64,
    rates: Vec<f64>,
}

impl Past {
    /// How many times are known.
    pub fn len(&self) -> usize {
        self.n_known
    }

    /// Whether the integration has to begin.
    pub fn is_empty(&self) -> bool {
        self.n_known == 0
    }

    /// Forgets everything: a restart.
    pub fn clear(&mut self) {
        self.n_known = 0;
    }

    /// Adds the rates at a new time; of all, the newest `depth` are kept.
    pub fn push(&mut self, t: f64, rates: &[f64], depth: usize) {
        let last = self.n_known.min(depth - 1);
        if self.points.len() == last {
            self.points.push(Point::default());
        }
        self.points[..=last].rotate_right(1);
        let newest = &mut self.points[0];
        newest.t = t;
        newest.rates.clear();
        newest.rates.extend_from_slice(rates);
        self.n_known = last + 1;
    }

    /// The time of the `k`-th point, s; 0 is the newest.
    pub fn time(&self, k: usize) -> f64 {
        self.points[k].t
    }

    /// The rates at the `k`-th point.
    pub fn rates(&self, k: usize) -> &[f64] {
        &self.points[k].rates
    }
}
