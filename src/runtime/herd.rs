//! Herds: agents of one type and mode that no guard can concern for a while, as rows of numbers, advanced many at a time.
//!
//! Such an agent is *cold*: it runs ahead alone, and leaves no segments but where a track is wanted of it ([`Tracks`]). A row
//! holds where it is, where its last step began, and where the steps began that lead over the present; from there its way
//! can be followed again, to the bit, by whoever asks where it was ([`Leaps::follow`]). Beside a row stand bounds of its states since the window began, by the dense output of its
//! steps.

use std::cell::RefCell;

use crate::math::Interval;
use crate::runtime::crew::Crew;
use crate::runtime::leap::{Covering, LeapRows, Leaps};
use crate::runtime::solve::segment::Segment;
use crate::runtime::stretch::{Advanced, Looks, NO_LOOKS, Stretch};
use crate::runtime::tracks::{Kept, Tracks};

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

impl<'p> Herd<'p> {
    /// No agents yet.
    pub fn new(leaps: Leaps<'p>) -> Self {
        let n = leaps.tape.n_states;
        let alone = RefCell::new((LeapRows::new(&leaps), Segment::default()));
        let tracks = Tracks::new(n, leaps.order + 1);
        let width = 3 * n + 2 + leaps.tape.fixed.len();
        Self {
            leaps,
            n,
            width,
            agents: Vec::new(),
            clocks: Vec::new(),
            rows: Vec::new(),
            bounds: Vec::new(),
            looks: Vec::new(),
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

    /// How many steps an agent has taken here.
    pub fn steps_of(&self, place: usize) -> u64 {
        self.looks[place].steps
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
    pub fn advance(&mut self, from: f64, until: f64, crew: &Crew) -> Advanced {
        let is_waiting = |place: &usize| self.clocks[*place] < until;
        let waiting: Vec<usize> = (0..self.clocks.len()).filter(is_waiting).collect();
        self.advance_these(waiting, (from, until), crew)
    }

    /// Makes the tracks that are wanted: the steps are taken again from where the ways are known, which is `from` or before it.
    pub fn make_tracks(&mut self, from: f64, crew: &Crew) {
        let tracked = self.tracks.wanted().iter().map(|&place| place as usize);
        let mut waiting: Vec<usize> = tracked.filter(|&place| self.clocks[place] < f64::INFINITY).collect();
        waiting.sort_unstable();
        self.advance_these(waiting, (from, from), crew);
    }

    /// Advances the agents in some places, rising, by stretches of places; how many stretches there are changes no bit.
    fn advance_these(&mut self, waiting: Vec<usize>, span: (f64, f64), crew: &Crew) -> Advanced {
        let stretches = self.stretches(&waiting, crew.shares(waiting.len()));
        let done = crew.map(stretches, |stretch| stretch.advance(span));
        let mut advanced = Advanced::default();
        for (part, kept) in done {
            advanced.steps += part.steps;
            advanced.refused.extend(part.refused);
            advanced.unlooked.extend(part.unlooked);
            self.tracks.append(kept);
        }
        advanced.refused.sort_unstable();
        advanced.unlooked.sort_unstable();
        advanced
    }

    /// So many stretches, about as many agents waiting in each.
    fn stretches<'h>(&'h mut self, waiting: &'h [usize], n_stretches: usize) -> Vec<Stretch<'h, 'p>> {
        let (n, width) = (self.n, self.width);
        let mut clocks = self.clocks.as_mut_slice();
        let mut rows = self.rows.as_mut_slice();
        let mut bounds = self.bounds.as_mut_slice();
        let mut looks = self.looks.as_mut_slice();
        let mut stretches = Vec::with_capacity(n_stretches);
        let mut first = 0;
        for waiting in waiting.chunks(waiting.len().div_ceil(n_stretches).max(1)) {
            let n_places = waiting[waiting.len() - 1] + 1 - first;
            stretches.push(Stretch {
                leaps: &self.leaps,
                first,
                waiting,
                n,
                width,
                clocks: clocks.split_off_mut(..n_places).unwrap_or_default(),
                rows: rows.split_off_mut(..n_places * width).unwrap_or_default(),
                bounds: bounds.split_off_mut(..n_places * 2 * n).unwrap_or_default(),
                looks: looks.split_off_mut(..n_places).unwrap_or_default(),
                tracks: &self.tracks,
                kept: Kept::default(),
            });
            first += n_places;
        }
        stretches
    }
}
