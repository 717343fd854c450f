//! Herds: agents of one type and mode that no guard can concern for a while, as rows of numbers, advanced many at a time.
//!
//! Such an agent is *cold*: it runs ahead alone, and leaves no segments but where a track is wanted of it ([`Tracks`]). A row
//! holds where it is, where its last step began, and where the steps began that lead over the present; from there its way
//! can be followed again, to the bit, by whoever asks where it was ([`Leaps::follow`]). In lanes, an agent that has come far
//! enough makes room for the next. Beside a row stand bounds of its states since the window began, by the dense output of its
//! steps.

use std::cell::RefCell;

use crate::math::lanes::{Level, Work};
use crate::math::{Interval, N_LANES, Numbers, Wide};
use crate::runtime::leap::{Covering, LeapRows, Leaps, STATES_MAX};
use crate::runtime::solve::segment::Segment;
use crate::runtime::tracks::Tracks;

/// Agents of one type and mode.
#[derive(Clone, Debug)]
pub struct Herd<'p> {
    /// How they move.
    pub leaps: Leaps<'p>,
    /// How many states each has.
    n: usize,
    /// How wide a row is: the states; time and states at the begin of the last step; those from which the way is followed;
    /// what does not move of the series.
    width: usize,
    /// By place.
    pub agents: Vec<u32>,
    /// How far each has come, s; infinite for one that is not cold.
    clocks: Vec<f64>,
    rows: Vec<f64>,
    /// For each place, bounds of the states since the window began, then over the last step.
    bounds: Vec<Interval>,
    /// By place.
    looks: Vec<Looks>,
    /// The steps in this window of those that something may concern in it.
    pub tracks: Tracks,
    /// Scratch.
    alone: RefCell<(LeapRows<f64>, Segment)>,
}

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
struct Looks {
    /// So many more.
    left: u32,
    /// So many from one look to the next.
    patience: u32,
}

/// No steps have been taken.
const NO_LOOKS: Looks = Looks { left: 256, patience: 256 };
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

impl<'p> Herd<'p> {
    /// No agents yet.
    pub fn new(leaps: Leaps<'p>) -> Self {
        let n = leaps.tape.n_states;
        let alone = RefCell::new((LeapRows::new(&leaps), Segment::default()));
        let tracks = Tracks::new(n, leaps.order + 1);
        let (agents, clocks, rows, bounds, looks) = Default::default();
        Self {
            leaps,
            n,
            width: 3 * n + 2 + leaps.tape.fixed.len(),
            agents,
            clocks,
            rows,
            bounds,
            looks,
            tracks,
            alone,
        }
    }

    fn row(&self, place: usize) -> &[f64] {
        &self.rows[place * self.width..][..self.width]
    }

    /// Takes an agent in, which gets the last place.
    pub fn push(&mut self, agent: usize) -> usize {
        self.agents.push(agent as u32);
        self.clocks.push(f64::INFINITY);
        self.looks.push(NO_LOOKS);
        self.rows.resize(self.agents.len() * self.width, 0.0);
        self.bounds.resize(self.agents.len() * 2 * self.n, Interval::WHOLE);
        self.agents.len() - 1
    }

    /// Takes an agent out; the one that had the last place, if there is another, has its place now.
    pub fn remove(&mut self, place: usize) -> Option<usize> {
        let (last, width) = (self.agents.len() - 1, self.width);
        self.tracks.remove(place, last);
        self.agents.swap_remove(place);
        self.clocks.swap_remove(place);
        self.looks.swap_remove(place);
        self.rows.copy_within(last * width.., place * width);
        self.rows.truncate(last * width);
        let width = 2 * self.n;
        self.bounds.copy_within(last * width.., place * width);
        self.bounds.truncate(last * width);
        self.agents.get(place).map(|&agent| agent as usize)
    }

    /// Has an agent go on from `(t, x)`; `bounds` are those of its states since the window began.
    pub fn start(
        &mut self,
        place: usize,
        (t, x): (f64, &[f64]),
        aux: &[f64],
        bounds: impl Iterator<Item = Interval>,
    ) {
        let (n, width) = (self.n, self.width);
        self.clocks[place] = t;
        let row = &mut self.rows[place * width..][..width];
        row[..n].copy_from_slice(x);
        for begin in [n, 2 * n + 1] {
            row[begin] = t;
            row[begin + 1..begin + 1 + n].copy_from_slice(x);
        }
        self.leaps.tape.fix(|_, column| aux[column as usize], &mut row[3 * n + 2..]);
        let (since, last) = self.bounds[place * 2 * n..][..2 * n].split_at_mut(n);
        since.iter_mut().zip(bounds).for_each(|(since, bound)| *since = bound);
        last.copy_from_slice(since);
    }

    /// Bounds of an agent's states from the begin of the window on to where it has come.
    pub fn bounds(&self, place: usize) -> &[Interval] {
        &self.bounds[place * 2 * self.n..][..self.n]
    }

    /// Has an agent go no further.
    pub fn halt(&mut self, place: usize) {
        self.clocks[place] = f64::INFINITY;
    }

    /// How far an agent has come, and its states there.
    pub fn now(&self, place: usize) -> (f64, &[f64]) {
        (self.clocks[place], &self.row(place)[..self.n])
    }

    /// The time and states from which its way is known.
    pub fn known(&self, place: usize) -> (f64, &[f64]) {
        let row = self.row(place);
        (row[2 * self.n + 1], &row[2 * self.n + 2..3 * self.n + 2])
    }

    /// The step of an agent that covers `t`, from its track or taken again from where its way is known, and the states at its
    /// end; none if it is at a step's begin that it can go no further.
    pub fn follow(&self, place: usize, t: f64, x: &mut [f64], segment: &mut Segment) -> Option<Covering> {
        if let Some(step) = self.tracks.covering(place, t) {
            let step = self.tracks.take(step, x, segment);
            return Some(Covering { h: step.h, ratio: step.ratio });
        }
        let (start, states) = self.known(place);
        x.copy_from_slice(states);
        let (rows, _) = &mut *self.alone.borrow_mut();
        rows.fixed.copy_from_slice(self.fixed(place));
        self.leaps.follow((start, t), x, rows, segment)
    }

    /// The states of an agent at `t`, from where its way is known on.
    pub fn states_at(&self, place: usize, t: f64, x: &mut [f64]) {
        let (clock, states) = self.now(place);
        if clock == t {
            return x.copy_from_slice(states);
        }
        let mut segment = std::mem::take(&mut self.alone.borrow_mut().1);
        self.follow(place, t, x, &mut segment);
        if segment.end != t {
            segment.states(t, x);
        }
        self.alone.borrow_mut().1 = segment;
    }

    /// What does not move of the series of an agent.
    pub fn fixed(&self, place: usize) -> &[f64] {
        &self.row(place)[3 * self.n + 2..]
    }

    /// Advances all that have not come as far as `until` until they have; what is known of their ways begins at `from` or
    /// before it.
    pub fn advance(&mut self, from: f64, until: f64) -> Advanced {
        let waiting = (0..self.clocks.len()).filter(|&place| self.clocks[place] < until).collect();
        self.advance_these(waiting, (from, until))
    }

    /// Makes the tracks that are wanted: the steps are taken again from where the ways are known, which is `from` or before it.
    pub fn make_tracks(&mut self, from: f64) {
        let tracked = self.tracks.wanted().iter().map(|&place| place as usize);
        let waiting = tracked.filter(|&place| self.clocks[place] < f64::INFINITY).collect();
        self.advance_these(waiting, (from, from));
    }

    fn advance_these(&mut self, waiting: Vec<usize>, (from, until): (f64, f64)) -> Advanced {
        let mut advanced = Advanced::default();
        let mut lanes = Lanes::new(&self.leaps);
        let mut waiting = waiting.into_iter();
        loop {
            for lane in 0..N_LANES {
                if lanes.place[lane] != NOBODY {
                    continue;
                }
                let Some(place) = waiting.next() else { break };
                self.board(place, lane, (from, until), &mut lanes);
            }
            if lanes.n_boarded <= FEW {
                break;
            }
            Level::best().run(Step { leaps: &self.leaps, lanes: &mut lanes });
            self.leave(&mut lanes, &mut advanced);
        }
        // The last few: one by one, with the same bits.
        let mut rows = LeapRows::new(&self.leaps);
        for lane in 0..N_LANES {
            if lanes.place[lane] != NOBODY {
                self.alone(lane, &lanes, &mut rows, &mut advanced);
            }
        }
        advanced
    }

    /// Puts an agent into a lane: where it is or, if a track is wanted of it, where its way is known from.
    fn board(&mut self, place: usize, lane: usize, (from, until): (f64, f64), lanes: &mut Lanes) {
        let (n, width) = (self.n, self.width);
        let row = &mut self.rows[place * width..][..width];
        if row[n] <= from {
            row.copy_within(n..2 * n + 1, 2 * n + 1);
            self.bounds.copy_within(place * 2 * n + n..place * 2 * n + 2 * n, place * 2 * n);
        }
        let is_tracked = self.tracks.wants(place);
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
                advanced.steps += u64::from(lanes.t.0[lane] > self.clocks[place]);
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
                advanced.unlooked.push(place);
            }
            if !good || goes_on {
                advanced.refused.push(place);
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
        self.tracks.push(lanes.place[lane], step, ratio, x_new[..n].iter().copied(), terms);
    }

    /// Advances one agent from where its lane has brought it.
    fn alone(&mut self, lane: usize, lanes: &Lanes, rows: &mut LeapRows<f64>, advanced: &mut Advanced) {
        let (n, width, place) = (self.n, self.width, lanes.place[lane]);
        rows.fixed.copy_from_slice(self.fixed(place));
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
                advanced.refused.push(place);
                break;
            }
            advanced.steps += u64::from(leap.end > self.clocks[place]);
            if lanes.is_tracked[lane] {
                let ratio = self.leaps.accuracy.error_norm(&rows.errors, &x[..n], &x_new[..n]);
                let (x_end, terms) = (x_new[..n].iter().copied(), rows.terms.iter().copied());
                self.tracks.push(place, (t, leap.h, leap.end), ratio, x_end, terms);
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
            advanced.unlooked.push(place);
        }
        if t < lanes.target[lane] && advanced.refused.last() != Some(&place) {
            advanced.refused.push(place);
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
