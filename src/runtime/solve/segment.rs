//! Dense output: the trajectory of one agent over one step as a polynomial for each state.
//!
//! A polynomial is x(t) = sum over k of c_k theta^k with theta = (t - start) / h, where h is the length of the step as
//! it was taken; an event may have cut the segment to a shorter [start, end]. Bounds over a stretch of time come from
//! the polynomial moved to the middle of the stretch: x in c_0 ± sum of |c_k| r^k, widened for the rounding of the move,
//! which is none at the start of the segment.

use crate::math::Interval;

/// The trajectory of one agent over [start, end].
#[derive(Clone, Debug, Default)]
pub struct Segment {
    /// s.
    pub start: f64,
    /// s; at most start + h.
    pub end: f64,
    h: f64,
    /// Coefficients of one state after the other, lowest power first.
    coefficients: Vec<f64>,
    n_coefficients: usize,
    /// See [`Segment::has_own_rates`], s.
    own_rates_until: Option<f64>,
}

/// The most coefficients of one state.
pub const N_MAX: usize = 24;

impl Segment {
    /// A segment at rest at one instant: the state does not move from it.
    pub fn at(t: f64, x: &[f64]) -> Self {
        let coefficients = x.to_vec();
        Self { start: t, end: t, h: 1.0, coefficients, n_coefficients: 1, own_rates_until: None }
    }

    /// Prepares for a step of length `h` from `t` with `n` coefficients a state, to be filled in.
    pub fn reset(&mut self, t: f64, h: f64, end: f64, n: usize, n_states: usize) -> &mut [f64] {
        debug_assert!(n <= N_MAX);
        self.start = t;
        self.end = end;
        self.h = h;
        self.n_coefficients = n;
        self.own_rates_until = None;
        self.coefficients.clear();
        self.coefficients.resize(n * n_states, 0.0);
        &mut self.coefficients
    }

    /// Makes it one whose own derivatives are its rates: a stiff flow answers an error of its states, however small, by
    /// rates that the solution does not have.
    pub fn own_rates(&mut self) {
        self.own_rates_until = Some(self.end);
    }

    /// Whether the rates at `t` are its own derivatives, not what the flow says of its states.
    pub fn has_own_rates(&self, t: f64) -> bool {
        self.own_rates_until.is_some_and(|until| t <= until)
    }

    /// Ends it at `t`, where the flow begins afresh.
    pub fn cut(&mut self, t: f64) {
        self.end = t;
        self.own_rates_until = self.own_rates_until.map(|until| until.min(t.next_down()));
    }

    /// Where `t` is in the step; not far beyond its ends, where the polynomial says nothing any more: a step can be shorter than
    /// the resolution of time, to which an event may be put before it or after it.
    fn theta(&self, t: f64) -> f64 {
        ((t - self.start) / self.h).clamp(-1.0, 2.0)
    }

    /// The states at `t`; `x` has one place for each.
    pub fn states(&self, t: f64, x: &mut [f64]) {
        let theta = self.theta(t);
        for (x, c) in x.iter_mut().zip(self.coefficients.chunks_exact(self.n_coefficients)) {
            *x = c.iter().rev().fold(0.0, |sum, c| sum * theta + c);
        }
    }

    /// States, their first and their second derivatives at `t`.
    pub fn jet(&self, t: f64, x: &mut [f64], dx: &mut [f64], ddx: &mut [f64]) {
        for i in 0..self.n_states() {
            [x[i], dx[i], ddx[i]] = self.state_jet(i, t);
        }
    }

    /// One state at `t`.
    pub fn state(&self, state: usize, t: f64) -> f64 {
        let theta = self.theta(t);
        self.polynomial(state).iter().rev().fold(0.0, |sum, c| sum * theta + c)
    }

    /// One state, its first and its second derivative at `t`.
    pub fn state_jet(&self, state: usize, t: f64) -> [f64; 3] {
        let theta = self.theta(t);
        let (mut p, mut dp, mut ddp) = (0.0, 0.0, 0.0);
        for &c in self.polynomial(state).iter().rev() {
            ddp = ddp * theta + dp;
            dp = dp * theta + p;
            p = p * theta + c;
        }
        [p, dp / self.h, 2.0 * ddp / (self.h * self.h)]
    }

    /// Bounds of one state and its first and second derivatives over [s, e].
    pub fn jet_range(&self, state: usize, s: f64, e: f64) -> [Interval; 3] {
        let c = self.polynomial(state);
        let n = c.len();
        let (middle, radius) = self.middle(s, e);
        let radius = radius.abs() * (1.0 + 1e-15);
        let mut moved = [0.0; N_MAX];
        let moved = &mut moved[..n];
        moved.copy_from_slice(c);
        shift(moved, middle);
        let (d, dd) = (moved.get(1).copied().unwrap_or(0.0), moved.get(2).copied().unwrap_or(0.0));
        // A rate at a point is a coefficient that was made by a product with h, divided by h again.
        let own = |value: f64| if s == e { 4.0 * f64::EPSILON * value.abs() } else { 0.0 };
        let own = [0.0, own(d), own(2.0 * dd)];
        let (above, moving) = (spread(moved, radius), spread(c, middle.abs()));
        let centres = [moved[0], d, 2.0 * dd];
        let scales = [1.0, 1.0 / self.h, 1.0 / (self.h * self.h)];
        std::array::from_fn(|order| {
            let rounding = moving[order] * (8 * n) as f64 * f64::EPSILON + own[order];
            let scale = scales[order];
            around(centres[order] * scale, above[order] * scale, rounding * scale)
        })
    }

    /// Middle and radius of [s, e] in units of the step.
    fn middle(&self, s: f64, e: f64) -> (f64, f64) {
        let (from, to) = ((s - self.start) / self.h, (e - self.start) / self.h);
        (0.5 * (from + to), 0.5 * (to - from))
    }

    fn polynomial(&self, state: usize) -> &[f64] {
        &self.coefficients[state * self.n_coefficients..][..self.n_coefficients]
    }

    fn n_states(&self) -> usize {
        self.coefficients.len() / self.n_coefficients.max(1)
    }
}

impl Segment {
    /// Bounds of one state over [s, e].
    pub fn range(&self, state: usize, s: f64, e: f64) -> Interval {
        value_range(self.polynomial(state), (s - self.start) / self.h, (e - self.start) / self.h)
    }

    /// How high a power the polynomials have.
    pub fn degree(&self) -> usize {
        self.n_coefficients.saturating_sub(1)
    }

    /// Bounds of what the `power`-th term of a state's polynomial moved to the middle of [s, e] is at e.
    pub fn term_range(&self, state: usize, s: f64, e: f64, power: usize) -> Interval {
        let c = self.polynomial(state);
        let (middle, radius) = self.middle(s, e);
        let mut moved = [0.0; N_MAX];
        let moved = &mut moved[..c.len()];
        moved.copy_from_slice(c);
        shift(moved, middle);
        let reach = middle.abs() + radius.abs();
        let size = c.iter().skip(1).rev().fold(0.0, |sum, c| (sum + c.abs()) * reach);
        let value = moved.get(power).copied().unwrap_or(0.0) * radius.powi(power as i32);
        around(value, 0.0, size * (8 * c.len()) as f64 * f64::EPSILON)
    }
}

/// Bounds of the polynomial with coefficients `c`, lowest power first, over [from, to] of its argument: by value and rate at
/// the middle, and a bound of the second rate.
pub fn value_range(c: &[f64], from: f64, to: f64) -> Interval {
    let (middle, radius) = (0.5 * (from + to), 0.5 * (to - from).abs());
    let reach = from.abs().max(to.abs());
    let (mut p, mut dp) = (0.0, 0.0);
    let (mut size, mut slope, mut bend) = (0.0, 0.0, 0.0);
    for &c in c.iter().rev() {
        dp = dp * middle + p;
        p = p * middle + c;
        // Of the sum of |c_k| reach^k, and of its first two derivatives, half of the second.
        bend = bend * reach + slope;
        slope = slope * reach + size;
        size = size * reach + c.abs();
    }
    around(p, (dp.abs() + bend * radius) * radius, size * (8 * c.len()) as f64 * f64::EPSILON)
}

/// Moves a polynomial's origin to `by` (repeated synthetic division).
fn shift(c: &mut [f64], by: f64) {
    let n = c.len();
    for low in 0..n.saturating_sub(1) {
        for k in (low..n - 1).rev() {
            c[k] += by * c[k + 1];
        }
    }
}

/// Bounds what the terms above the first of a polynomial, of its first and of its second derivative add within `radius` of
/// the origin.
fn spread(c: &[f64], radius: f64) -> [f64; 3] {
    let mut sums = [0.0; 3];
    for k in (1..c.len()).rev() {
        let (power, size) = (k as f64, c[k].abs());
        for (order, falling) in [1.0, power, power * (power - 1.0)].into_iter().enumerate() {
            if k > order {
                sums[order] = sums[order] * radius + falling * size;
            }
        }
    }
    sums.map(|sum| sum * radius)
}

fn around(centre: f64, radius: f64, rounding: f64) -> Interval {
    let radius = (radius * (1.0 + 1e-14) + rounding).next_up();
    if radius.is_nan() || centre.is_nan() {
        return Interval::WHOLE;
    }
    if radius <= f64::MIN_POSITIVE * 2.0 {
        return Interval { lo: centre, hi: centre };
    }
    Interval { lo: (centre - radius).next_down(), hi: (centre + radius).next_up() }
}
