//! Stretches: the agents of a herd in consecutive places, advanced many at a time in lanes, by one thread.
//!
//! In lanes, an agent that has come far enough makes room for the next. What becomes of one depends on its row alone, not on
//! who is beside it, nor in which stretch it is.

use crate::math::lanes::{Level, Work};
use crate::math::{Interval, N_LANES, Numbers, Wide};
use crate::runtime::leap::{LeapRows, Leaps, STATES_MAX};
use crate::runtime::tracks::{Kept, Tracks};

/// Steps taken, and those that were refused.
#[derive(Clone, Debug, Default)]
pub struct Advanced {
    /// Steps.
    pub steps: u64,
    /// The places of those that could go no further by such steps, or only by very many.
    pub refused: Vec<usize>,
    /// The places of those that have taken many, so that somebody should look whether their flow is stiff.
    pub unlooked: Vec<usize>,
}

/// How many steps an agent takes before somebody should look whether its flow is stiff.
#[derive(Clone, Copy, Debug)]
pub struct Looks {
    /// So many more.
    left: u32,
    /// So many from one look to the next.
    patience: u32,
    /// Steps that it has taken in its herd.
    pub steps: u64,
}

/// No steps have been taken.
pub const NO_LOOKS: Looks = Looks { left: 256, patience: 256, steps: 0 };
/// The patience doubles from look to look up to this.
const PATIENCE_MAX: u32 = 2048;

impl Looks {
    /// Counts steps; whether somebody should look.
    fn count(&mut self, steps: u32) -> bool {
        self.left = self.left.saturating_sub(steps);
        if self.left > 0 {
            return false;
        }
        self.patience = (2 * self.patience).min(PATIENCE_MAX);
        self.left = self.patience;
        true
    }
}

/// An agent that takes so many steps in a window is left to who can choose another method.
const STEPS_MAX: u32 = 200;
/// Up to this many lanes are cheaper one by one.
pub const FEW: usize = 3;

/// Rows of a herd.
pub struct Stretch<'h, 'p> {
    /// How they move.
    pub leaps: &'h Leaps<'p>,
    /// The place of the first row.
    pub first: usize,
    /// The places of those that are to be advanced.
    pub waiting: &'h [usize],
    /// How many states each has.
    pub n: usize,
    /// How wide a row is, see [`Herd`](crate::runtime::herd::Herd).
    pub width: usize,
    /// How far each has come, s.
    pub clocks: &'h mut [f64],
    /// The rows.
    pub rows: &'h mut [f64],
    /// Bounds of the states since the window began, then over the last step.
    pub bounds: &'h mut [Interval],
    /// Steps until somebody should look.
    pub looks: &'h mut [Looks],
    /// Of whom steps are kept.
    pub tracks: &'h Tracks,
    /// The steps that are kept.
    pub kept: Kept,
}

impl Stretch<'_, '_> {
    /// Advances all that are waiting up to `until`; what is known of their ways begins at `from` or before it.
    pub fn advance(mut self, (from, until): (f64, f64)) -> (Advanced, Kept) {
        let mut advanced = Advanced::default();
        let mut lanes = Lanes::new(self.leaps);
        let mut waiting = self.waiting.iter();
        loop {
            for lane in 0..N_LANES {
                if lanes.place[lane] != NOBODY {
                    continue;
                }
                let Some(&place) = waiting.next() else { break };
                self.board(place - self.first, lane, (from, until), &mut lanes);
            }
            if lanes.n_boarded <= FEW {
                break;
            }
            Level::best().run(Step { leaps: self.leaps, lanes: &mut lanes });
            self.leave(&mut lanes, &mut advanced);
        }
        // The last few: one by one, with the same bits.
        let mut rows = LeapRows::new(self.leaps);
        for lane in 0..N_LANES {
            if lanes.place[lane] != NOBODY {
                self.alone(lane, &lanes, &mut rows, &mut advanced);
            }
        }
        (advanced, self.kept)
    }

    /// Puts an agent into a lane: where it is or, if a track is wanted of it, where its way is known from.
    fn board(&mut self, place: usize, lane: usize, (from, until): (f64, f64), lanes: &mut Lanes) {
        let (n, width) = (self.n, self.width);
        let row = &mut self.rows[place * width..][..width];
        if row[n] <= from {
            row.copy_within(n..2 * n + 1, 2 * n + 1);
            self.bounds.copy_within(place * 2 * n + n..place * 2 * n + 2 * n, place * 2 * n);
        }
        let is_tracked = self.tracks.wants(self.first + place);
        let start = if is_tracked { row[2 * n + 1] } else { self.clocks[place] };
        let first = if is_tracked { 2 * n + 2 } else { 0 };
        lanes.place[lane] = place;
        lanes.is_tracked[lane] = is_tracked;
        lanes.taken[lane] = 0;
        lanes.n_boarded += 1;
        lanes.target[lane] = until.max(self.clocks[place]);
        lanes.t.0[lane] = start;
        lanes.last_t.0[lane] = row[n];
        for i in 0..n {
            lanes.x[i].0[lane] = row[first + i];
            lanes.last_x[i].0[lane] = row[n + 1 + i];
            let bound = self.bounds[place * 2 * n + i];
            (lanes.lows[i].0[lane], lanes.highs[i].0[lane]) = (bound.lo, bound.hi);
        }
        for (wide, &value) in lanes.rows.fixed.iter_mut().zip(&row[3 * n + 2..]) {
            wide.0[lane] = value;
        }
    }

    /// Takes those out of their lanes that have come far enough, or cannot go on.
    fn leave(&mut self, lanes: &mut Lanes, advanced: &mut Advanced) {
        for lane in 0..N_LANES {
            let place = lanes.place[lane];
            if place == NOBODY {
                continue;
            }
            let good = lanes.good.0[lane] != 0.0;
            lanes.taken[lane] += 1;
            if good {
                // What a track takes again has been counted.
                let is_new = u64::from(lanes.t.0[lane] > self.clocks[place]);
                advanced.steps += is_new;
                self.looks[place].steps += is_new;
                if lanes.is_tracked[lane] {
                    self.track(lane, lanes);
                }
            }
            let goes_on = good && lanes.t.0[lane] < lanes.target[lane];
            if goes_on && (lanes.taken[lane] < STEPS_MAX || lanes.is_tracked[lane]) {
                continue;
            }
            lanes.place[lane] = NOBODY;
            lanes.n_boarded -= 1;
            if lanes.is_tracked[lane] {
                continue;
            }
            // After a refused step it is where that began, and has come there by none that is known.
            let (t, x) = if good { (lanes.t, &lanes.x) } else { (lanes.last_t, &lanes.last_x) };
            let (n, width) = (self.n, self.width);
            let row = &mut self.rows[place * width..][..width];
            self.clocks[place] = t.0[lane];
            row[n] = lanes.last_t.0[lane];
            for i in 0..n {
                row[i] = x[i].0[lane];
                row[n + 1 + i] = lanes.last_x[i].0[lane];
                let [since, last] = [0, n].map(|first| place * 2 * n + first + i);
                self.bounds[since] = Interval { lo: lanes.lows[i].0[lane], hi: lanes.highs[i].0[lane] };
                let LeapRows { lows, highs, .. } = &lanes.rows;
                self.bounds[last] = Interval { lo: lows[i].0[lane], hi: highs[i].0[lane] };
            }
            if self.looks[place].count(lanes.taken[lane]) {
                advanced.unlooked.push(self.first + place);
            }
            if !good || goes_on {
                advanced.refused.push(self.first + place);
            }
        }
    }

    /// Adds the last step of a lane to the track of its agent.
    fn track(&mut self, lane: usize, lanes: &Lanes) {
        let LeapRows { terms, errors, .. } = &lanes.rows;
        let of_lane = |row: &[Wide], out: &mut [f64; STATES_MAX]| {
            out.iter_mut().zip(row).for_each(|(out, wide)| *out = wide.0[lane]);
        };
        let [mut error, mut x, mut x_new] = [[0.0; STATES_MAX]; 3];
        of_lane(errors, &mut error);
        of_lane(&lanes.last_x, &mut x);
        of_lane(&lanes.x, &mut x_new);
        let n = self.n;
        let ratio = self.leaps.accuracy.error_norm(&error[..n], &x[..n], &x_new[..n]);
        let step = (lanes.last_t.0[lane], lanes.h.0[lane], lanes.t.0[lane]);
        let terms = terms.iter().map(|wide| wide.0[lane]);
        let place = self.first + lanes.place[lane];
        self.kept.push(place, step, ratio, x_new[..n].iter().copied(), terms);
    }

    /// Advances one agent from where its lane has brought it.
    fn alone(&mut self, lane: usize, lanes: &Lanes, rows: &mut LeapRows<f64>, advanced: &mut Advanced) {
        let (n, width, place) = (self.n, self.width, lanes.place[lane]);
        rows.fixed.copy_from_slice(&self.rows[place * width..][3 * n + 2..width]);
        let mut t = lanes.t.0[lane];
        let mut last_t = lanes.last_t.0[lane];
        let (mut x, mut last_x, mut x_new) = ([0.0; STATES_MAX], [0.0; STATES_MAX], [0.0; STATES_MAX]);
        for i in 0..n {
            (x[i], last_x[i]) = (lanes.x[i].0[lane], lanes.last_x[i].0[lane]);
        }
        let mut since: [Interval; STATES_MAX] = [Interval::WHOLE; STATES_MAX];
        for (since, (low, high)) in since.iter_mut().zip(lanes.lows.iter().zip(&lanes.highs)) {
            *since = Interval { lo: low.0[lane], hi: high.0[lane] };
        }
        let steps_max = if lanes.is_tracked[lane] { u32::MAX } else { STEPS_MAX };
        let mut taken = lanes.taken[lane];
        for _ in 0..steps_max {
            if t >= lanes.target[lane] {
                break;
            }
            taken += 1;
            let leap = self.leaps.leap(t, &x[..n], rows, &mut x_new[..n]);
            if leap.good == 0.0 {
                advanced.refused.push(self.first + place);
                break;
            }
            let is_new = u64::from(leap.end > self.clocks[place]);
            advanced.steps += is_new;
            self.looks[place].steps += is_new;
            if lanes.is_tracked[lane] {
                let ratio = self.leaps.accuracy.error_norm(&rows.errors, &x[..n], &x_new[..n]);
                let (x_end, terms) = (x_new[..n].iter().copied(), rows.terms.iter().copied());
                self.kept.push(self.first + place, (t, leap.h, leap.end), ratio, x_end, terms);
            }
            self.leaps.bound(&x[..n], &x_new[..n], rows);
            for (since, (&lo, &hi)) in since.iter_mut().zip(rows.lows.iter().zip(&rows.highs)) {
                *since = since.hull(Interval { lo, hi });
            }
            (last_t, last_x) = (t, x);
            (t, x) = (leap.end, x_new);
        }
        if lanes.is_tracked[lane] {
            return;
        }
        if self.looks[place].count(taken) {
            advanced.unlooked.push(self.first + place);
        }
        if t < lanes.target[lane] && advanced.refused.last() != Some(&(self.first + place)) {
            advanced.refused.push(self.first + place);
        }
        let row = &mut self.rows[place * width..][..width];
        self.clocks[place] = t;
        row[..n].copy_from_slice(&x[..n]);
        row[n] = last_t;
        row[n + 1..2 * n + 1].copy_from_slice(&last_x[..n]);
        let (bounds, last) = self.bounds[place * 2 * n..][..2 * n].split_at_mut(n);
        bounds.copy_from_slice(&since[..n]);
        for (i, last) in last.iter_mut().enumerate() {
            *last = Interval { lo: rows.lows[i], hi: rows.highs[i] };
        }
    }
}

/// No agent is in a lane.
pub const NOBODY: usize = usize::MAX;

/// The agents that are advanced at once.
struct Lanes {
    place: [usize; N_LANES],
    is_tracked: [bool; N_LANES],
    /// How far each is to come, s.
    target: [f64; N_LANES],
    /// Steps in this window.
    taken: [u32; N_LANES],
    n_boarded: usize,
    t: Wide,
    h: Wide,
    x: Vec<Wide>,
    last_t: Wide,
    last_x: Vec<Wide>,
    x_new: Vec<Wide>,
    /// Bounds of the states since the window began.
    lows: Vec<Wide>,
    highs: Vec<Wide>,
    good: Wide,
    rows: LeapRows<Wide>,
}

impl Lanes {
    fn new(leaps: &Leaps<'_>) -> Self {
        let (zero, n) = (Wide::all(0.0), leaps.tape.n_states);
        Self {
            place: [NOBODY; N_LANES],
            is_tracked: [false; N_LANES],
            target: [0.0; N_LANES],
            taken: [0; N_LANES],
            n_boarded: 0,
            t: zero,
            h: zero,
            x: vec![zero; n],
            last_t: zero,
            last_x: vec![zero; n],
            x_new: vec![zero; n],
            lows: vec![zero; n],
            highs: vec![zero; n],
            good: zero,
            rows: LeapRows::new(leaps),
        }
    }
}

/// A step of all lanes.
struct Step<'a, 'p> {
    leaps: &'a Leaps<'p>,
    lanes: &'a mut Lanes,
}

impl Work for Step<'_, '_> {
    #[inline(always)]
    fn work(self) {
        let Lanes { t, h, x, last_t, last_x, x_new, lows, highs, good, rows, .. } = self.lanes;
        let leap = self.leaps.leap(*t, x, rows, x_new);
        self.leaps.bound(x, x_new, rows);
        for (low, &new) in lows.iter_mut().zip(&rows.lows) {
            *low = low.zip(new, |low, new| if new < low { new } else { low });
        }
        for (high, &new) in highs.iter_mut().zip(&rows.highs) {
            *high = high.zip(new, |high, new| if new > high { new } else { high });
        }
        *last_t = *t;
        *h = leap.h;
        *t = leap.end;
        *good = leap.good;
        std::mem::swap(x, last_x);
        std::mem::swap(x, x_new);
    }
}
