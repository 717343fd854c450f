//! Zeno behaviour and chattering: one transition instance, or one kink, again and again while time stands still.
//!
//! It is found when `zeno_events` firings of one instance fall into an interval of four times as many times the resolution of
//! time: no spacing of theirs can be told from zero, or all are where a search goes on beyond what comes within rounding of its boundary. The limit time is estimated from the last two spacings that
//! could be resolved, d and d q: t + d q / (1 - q).

use rustc_hash::FxHashMap;

use crate::runtime::limits::Limits;
use crate::runtime::solve::time_resolution;

/// The firings of one instance.
#[derive(Clone, Copy, Debug)]
struct Track {
    /// The begin of the interval that is counted, s.
    since: f64,
    /// Firings in it.
    count: u32,
    /// The last firing, s.
    last: f64,
    /// The last two spacings that could be resolved, s.
    gaps: [f64; 2],
    /// The time after the last of them, s.
    resolved: f64,
    /// The instant (by number) of the last firing, and firings in it.
    instant: u64,
    in_instant: u32,
}

impl Default for Track {
    fn default() -> Self {
        Self {
            since: f64::NEG_INFINITY,
            count: 0,
            last: f64::NEG_INFINITY,
            gaps: [f64::NAN; 2],
            resolved: 0.0,
            instant: 0,
            in_instant: 0,
        }
    }
}

/// What a firing is found to be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Finding {
    /// Nothing special.
    Fine,
    /// Too many in one instant.
    Cycle,
    /// Too many in no time; the estimate of the limit time, s.
    Zeno(f64),
}

/// Counts firings.
#[derive(Clone, Debug)]
pub struct Repetitions {
    microsteps_max: u32,
    zeno_events: u32,
    tracks: FxHashMap<u32, Track>,
    kinks: FxHashMap<(usize, usize), Track>,
    /// The instances that fired last, in order.
    recent: Vec<u32>,
    /// The number of the instant at hand.
    pub instant: u64,
}

/// No spacing below this can be told from zero, in units of the resolution of time.
const APART: f64 = 4.0;
/// How many of the last firings are remembered to name a cycle.
const RECENT: usize = 64;

impl Repetitions {
    /// No firings yet.
    pub fn new(limits: &Limits) -> Self {
        Self {
            microsteps_max: limits.microsteps_max,
            zeno_events: limits.zeno_events,
            tracks: FxHashMap::default(),
            kinks: FxHashMap::default(),
            recent: Vec::new(),
            instant: 1,
        }
    }

    /// Counts a firing of an instance; `scheduled` ones (`every`) never count as Zeno behaviour.
    pub fn fired(&mut self, instance: u32, t: f64, scheduled: bool) -> Finding {
        if self.recent.len() == RECENT {
            self.recent.remove(0);
        }
        self.recent.push(instance);
        let (instant, limit) = (self.instant, self.zeno_events);
        let track = self.tracks.entry(instance).or_default();
        track.in_instant = if track.instant == instant { track.in_instant + 1 } else { 1 };
        let same_instant = track.instant == instant;
        track.instant = instant;
        if track.in_instant > self.microsteps_max {
            return Finding::Cycle;
        }
        if scheduled || same_instant {
            return Finding::Fine;
        }
        count(track, t, limit)
    }

    /// Counts a change of a kink's lock.
    pub fn turned(&mut self, agent: usize, kink: usize, t: f64) -> Finding {
        let limit = self.zeno_events;
        count(self.kinks.entry((agent, kink)).or_default(), t, limit)
    }

    /// Forgets the firings of an instance, whose number another has now.
    pub fn forget(&mut self, instance: u32) {
        self.tracks.remove(&instance);
    }

    /// Forgets the kinks of an agent, whose place another has now.
    pub fn forget_agent(&mut self, place: usize) {
        if !self.kinks.is_empty() {
            self.kinks.retain(|&(agent, _), _| agent != place);
        }
    }

    /// The instances that repeat, each once, in the order of their firing.
    pub fn cycle(&self, instance: u32) -> Vec<u32> {
        let before_last =
            self.recent[..self.recent.len().saturating_sub(1)].iter().rposition(|&other| other == instance);
        let mut cycle: Vec<u32> = Vec::new();
        for &other in &self.recent[before_last.unwrap_or(0)..] {
            if !cycle.contains(&other) {
                cycle.push(other);
            }
        }
        cycle
    }
}

fn count(track: &mut Track, t: f64, limit: u32) -> Finding {
    let gap = t - track.last;
    track.last = t;
    let resolution = time_resolution(t);
    if gap.is_finite() && gap > 1e3 * resolution {
        track.gaps = [track.gaps[1], gap];
        track.resolved = t;
    }
    if t - track.since > f64::from(limit) * APART * resolution {
        track.since = t;
        track.count = 1;
        return Finding::Fine;
    }
    track.count += 1;
    if track.count < limit {
        return Finding::Fine;
    }
    let ratio = track.gaps[1] / track.gaps[0];
    let estimate = track.resolved + track.gaps[1] * ratio / (1.0 - ratio);
    Finding::Zeno(if ratio < 1.0 && estimate.is_finite() { estimate.max(t) } else { t })
}
