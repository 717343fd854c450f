//! Tracks: the steps of cold agents in a window that something may concern in it, kept with their dense output.
//!
//! Where such an agent gets to can be bounded by its track instead of by bounds of its rates; and if its steps have to be
//! taken in turn after all, they are taken from here. A track is void beyond the time at which its agent is cut.

use crate::math::Interval;
use crate::runtime::solve::segment::{Segment, value_range};

/// One step.
#[derive(Clone, Copy, Debug)]
pub struct TrackStep {
    /// Where it begins, s.
    pub start: f64,
    /// Its length, s.
    pub h: f64,
    /// Where it ends, s.
    pub end: f64,
    /// Its error in units of what is allowed.
    pub ratio: f64,
    next: u32,
}

/// The first and the last step of a track, and whether there is to be one.
#[derive(Clone, Copy, Debug)]
struct Track {
    first: u32,
    last: u32,
    wanted: bool,
}

const NONE: u32 = u32::MAX;
const NO_TRACK: Track = Track { first: NONE, last: NONE, wanted: false };

/// The tracks of a herd in one window.
#[derive(Clone, Debug)]
pub struct Tracks {
    n_states: usize,
    n_terms: usize,
    steps: Vec<TrackStep>,
    /// For each step, the states at its end, then the terms of each state.
    values: Vec<f64>,
    /// By place.
    tracks: Vec<Track>,
    /// The places with a track.
    places: Vec<u32>,
}

/// Steps of several agents that are to be kept, those of each in order.
#[derive(Clone, Debug, Default)]
pub struct Kept {
    steps: Vec<TrackStep>,
    /// The place of each.
    places: Vec<u32>,
    /// For each, the states at its end, then the terms of each state.
    values: Vec<f64>,
}

impl Kept {
    /// Adds a step of length `h`: the states at its end, and the terms of the series.
    pub fn push(
        &mut self,
        place: usize,
        (start, h, end): (f64, f64, f64),
        ratio: f64,
        x_end: impl Iterator<Item = f64>,
        terms: impl Iterator<Item = f64>,
    ) {
        self.steps.push(TrackStep { start, h, end, ratio, next: NONE });
        self.places.push(place as u32);
        self.values.extend(x_end);
        self.values.extend(terms);
    }
}

impl Tracks {
    /// No tracks, of agents with `n_states` states and as many series of `n_terms` terms.
    pub fn new(n_states: usize, n_terms: usize) -> Self {
        let (steps, values, tracks, places) = Default::default();
        Self { n_states, n_terms, steps, values, tracks, places }
    }

    /// Forgets all tracks.
    pub fn clear(&mut self) {
        self.steps.clear();
        self.values.clear();
        for place in self.places.drain(..) {
            if let Some(track) = self.tracks.get_mut(place as usize) {
                *track = NO_TRACK;
            }
        }
    }

    /// From now on `place` is to have a track.
    pub fn want(&mut self, place: usize) {
        if self.tracks.len() <= place {
            self.tracks.resize(place + 1, NO_TRACK);
        }
        if !self.tracks[place].wanted {
            self.tracks[place].wanted = true;
            self.places.push(place as u32);
        }
    }

    /// Whether `place` is to have a track.
    pub fn wants(&self, place: usize) -> bool {
        self.tracks.get(place).is_some_and(|track| track.wanted)
    }

    /// The places that are to have a track.
    pub fn wanted(&self) -> &[u32] {
        &self.places
    }

    /// The agent at `place` goes; if another goes there from the last place, its track goes with it.
    pub fn remove(&mut self, place: usize, last: usize) {
        let moved = self.tracks.get(last).copied().unwrap_or(NO_TRACK);
        self.void(last);
        if place != last {
            self.void(place);
            if moved.wanted {
                self.want(place);
                self.tracks[place] = moved;
            }
        }
    }

    /// Adds steps to the tracks of their places.
    pub fn append(&mut self, kept: Kept) {
        for (&place, step) in kept.places.iter().zip(kept.steps) {
            let number = self.steps.len() as u32;
            self.steps.push(step);
            let track = &mut self.tracks[place as usize];
            if track.last == NONE {
                track.first = number;
            } else {
                self.steps[track.last as usize].next = number;
            }
            track.last = number;
        }
        self.values.extend_from_slice(&kept.values);
    }

    /// What is beyond the present of the agent at `place` is void.
    pub fn void(&mut self, place: usize) {
        if let Some(track) = self.tracks.get_mut(place) {
            (track.first, track.last) = (NONE, NONE);
        }
    }

    fn steps_of(&self, place: usize) -> impl Iterator<Item = usize> {
        let first = self.tracks.get(place).map_or(NONE, |track| track.first);
        let number = |step: u32| (step != NONE).then_some(step as usize);
        std::iter::successors(number(first), move |&step| number(self.steps[step].next))
    }

    /// Where a track begins, and where its steps end, s.
    pub fn joints(&self, place: usize) -> impl Iterator<Item = f64> {
        let begin = self.steps_of(place).next().map(|step| self.steps[step].start);
        begin.into_iter().chain(self.steps_of(place).map(|step| self.steps[step].end))
    }

    /// The number of the step that covers `t`: of two, the first.
    pub fn covering(&self, place: usize, t: f64) -> Option<usize> {
        self.steps_of(place)
            .find(|&step| t <= self.steps[step].end)
            .filter(|&step| self.steps[step].start <= t)
    }

    /// The number of the step that begins at `t`.
    pub fn beginning(&self, place: usize, t: f64) -> Option<usize> {
        self.steps_of(place)
            .find(|&step| self.steps[step].start >= t)
            .filter(|&step| self.steps[step].start == t)
    }

    /// A step by its number: its dense output to `segment`, the states at its end to `x`.
    pub fn take(&self, step: usize, x: &mut [f64], segment: &mut Segment) -> TrackStep {
        let TrackStep { start, h, end, .. } = self.steps[step];
        let (x_end, terms) = self.values_of(step).split_at(self.n_states);
        x.copy_from_slice(x_end);
        segment.reset(start, h, end, self.n_terms, self.n_states).copy_from_slice(terms);
        self.steps[step]
    }

    fn values_of(&self, step: usize) -> &[f64] {
        let width = self.n_states * (1 + self.n_terms);
        &self.values[step * width..][..width]
    }

    /// Bounds of a state of the agent at `place` over [s, e]; none if its track does not cover that.
    pub fn range(&self, place: usize, state: usize, (s, e): (f64, f64)) -> Option<Interval> {
        let mut hull: Option<Interval> = None;
        for step in self.steps_of(place) {
            let TrackStep { start, h, end, .. } = self.steps[step];
            if end < s {
                continue;
            }
            if hull.is_none() && start > s {
                return None;
            }
            let terms = &self.values_of(step)[self.n_states + state * self.n_terms..][..self.n_terms];
            let (from, to) = (start.max(s), end.min(e));
            let bound = value_range(terms, (from - start) / h, (to - start) / h);
            hull = Some(hull.map_or(bound, |hull| hull.hull(bound)));
            if end >= e {
                return hull;
            }
        }
        None
    }
}
