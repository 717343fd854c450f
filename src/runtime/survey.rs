//! Where many cold agents are at one time: their steps are taken again in lanes, with the bits that one by one they have.

use crate::math::lanes::{Level, Work};
use crate::math::{N_LANES, Numbers, Wide};
use crate::runtime::herd::Herd;
use crate::runtime::leap::{LeapRows, Leaps, STATES_MAX};
use crate::runtime::solve::segment::Segment;
use crate::runtime::stretch::{FEW, NOBODY};

impl Herd<'_> {
    /// Tells the states at `t` of the agents at some places, whose ways are known from there or before.
    pub fn survey(&self, places: &[usize], t: f64, tell: &mut dyn FnMut(usize, &[f64])) {
        let n = self.leaps.tape.n_states;
        let mut states = [0.0; STATES_MAX];
        let mut alone = |place: usize, tell: &mut dyn FnMut(usize, &[f64])| {
            self.states_at(place, t, &mut states[..n]);
            tell(place, &states[..n]);
        };
        let is_known = |place: usize| self.now(place).0 == t || self.tracks.covering(place, t).is_some();
        let mut waiting = places.iter().copied();
        let mut seats = Seats::new(&self.leaps);
        let mut segment = Segment::default();
        loop {
            for lane in 0..N_LANES {
                if seats.place[lane] != NOBODY {
                    continue;
                }
                let next = waiting.by_ref().find(|&place| {
                    let is_known = is_known(place);
                    if is_known {
                        alone(place, tell);
                    }
                    !is_known
                });
                let Some(place) = next else { break };
                seats.take(lane, place, self);
            }
            if seats.n_taken <= FEW {
                break;
            }
            Level::best().run(Step { leaps: &self.leaps, seats: &mut seats });
            for lane in 0..N_LANES {
                let place = seats.place[lane];
                if place == NOBODY {
                    continue;
                }
                let (good, end) = (seats.good.0[lane] != 0.0, seats.end.0[lane]);
                if good && end < t {
                    continue;
                }
                if good {
                    let mut x = [0.0; STATES_MAX];
                    x.iter_mut().zip(&seats.x_new).for_each(|(x, wide)| *x = wide.0[lane]);
                    if end != t {
                        seats.dense(lane, &mut segment);
                        segment.states(t, &mut x[..n]);
                    }
                    tell(place, &x[..n]);
                } else {
                    alone(place, tell);
                }
                seats.leave(lane);
            }
            seats.go_on();
        }
        seats.place.into_iter().filter(|&place| place != NOBODY).for_each(|place| alone(place, tell));
    }
}

/// The agents whose steps are taken again at once.
struct Seats {
    place: [usize; N_LANES],
    n_taken: usize,
    t: Wide,
    x: Vec<Wide>,
    x_new: Vec<Wide>,
    h: Wide,
    end: Wide,
    good: Wide,
    rows: LeapRows<Wide>,
}

impl Seats {
    fn new(leaps: &Leaps<'_>) -> Self {
        let (zero, n) = (Wide::all(0.0), leaps.tape.n_states);
        Self {
            place: [NOBODY; N_LANES],
            n_taken: 0,
            t: zero,
            x: vec![zero; n],
            x_new: vec![zero; n],
            h: zero,
            end: zero,
            good: zero,
            rows: LeapRows::new(leaps),
        }
    }

    /// An agent begins where its way is known from.
    fn take(&mut self, lane: usize, place: usize, herd: &Herd<'_>) {
        let (start, states) = herd.known(place);
        self.place[lane] = place;
        self.n_taken += 1;
        self.t.0[lane] = start;
        self.x.iter_mut().zip(states).for_each(|(wide, &x)| wide.0[lane] = x);
        self.rows.fixed.iter_mut().zip(herd.fixed(place)).for_each(|(wide, &value)| wide.0[lane] = value);
    }

    fn leave(&mut self, lane: usize) {
        self.place[lane] = NOBODY;
        self.n_taken -= 1;
    }

    /// All begin their next steps.
    fn go_on(&mut self) {
        self.t = self.end;
        std::mem::swap(&mut self.x, &mut self.x_new);
    }

    /// The dense output of the last step of a lane.
    fn dense(&self, lane: usize, segment: &mut Segment) {
        let n = self.x.len();
        let n_terms = self.rows.terms.len() / n;
        let terms = segment.reset(self.t.0[lane], self.h.0[lane], self.end.0[lane], n_terms, n);
        terms.iter_mut().zip(&self.rows.terms).for_each(|(term, wide)| *term = wide.0[lane]);
    }
}

/// A step of all lanes.
struct Step<'a, 'p> {
    leaps: &'a Leaps<'p>,
    seats: &'a mut Seats,
}

impl Work for Step<'_, '_> {
    #[inline(always)]
    fn work(self) {
        let Seats { t, x, x_new, h, end, good, rows, .. } = self.seats;
        let leap = self.leaps.leap(*t, x, rows, x_new);
        (*h, *end, *good) = (leap.h, leap.end, leap.good);
    }
}
