//! Properties: their worst or best margins so far, from stretch to stretch of the agents' dense output.
//!
//! Each stretch ends where all agents are known and nothing happens before; within it a condition's margin is continuous but
//! for its own jumps. Its extremes are found by branch and bound: pieces that cannot hold a better value are left out, pieces on
//! which the rate keeps its sign have it at an end. So nothing is sampled, and nothing of the run is changed.

use std::collections::VecDeque;

use crate::codegen::program::ClaimSystem;
use crate::runtime::engine::Engine;
use crate::runtime::lookout::Lookout;
use crate::runtime::margins::{Bound, Margins, Spot, When};
use crate::runtime::robustness::{Extreme, Robustness};
use crate::runtime::signal::{ACCURACY, Origin, Piece};
use crate::runtime::solve::time_resolution;
use crate::runtime::verdicts::{Decider, Found, Trace, Watched};

/// After so many pieces of one stretch the best value so far is taken: none of those left is longer than this part of it. What stays the
/// same (the distance of two in step) has no extreme, and bounds may take very small pieces to tell.
const PIECES_MAX: usize = 4096;

/// The same for `until`, which goes from left to right.
const UNTIL_PIECES_MAX: usize = 100_000;

/// How much wider than at a point, by rounding alone, a bound may be: it is a sum of as many terms.
const ROUNDINGS: f64 = 32.0;

/// A trace goes on for so long behind its last window: a window may be a point of time, a stretch of a signal is not. s.
const BEYOND: f64 = 1e-6;

/// How often a shorter stretch is tried over which a member does not come to decide.
const HALVES_MAX: usize = 8;

/// So many pieces of one stretch are halved because their margin may be zero on both sides.
const SIDED_MAX: usize = 1000;

/// What is not better than the best by this share of it is not looked for.
const SHARE: f64 = 1e-14;

impl<'p> Engine<'p, '_> {
    /// Watches the properties on the way to `time`, up to which all agents are known and nothing happens.
    pub fn watch_up_to(&mut self, time: f64) {
        let from = self.monitors.done;
        if self.monitors.properties.is_empty() || time <= from || time == f64::INFINITY {
            return;
        }
        let mut monitors = std::mem::take(&mut self.monitors);
        for (_, watched) in &mut monitors.properties {
            self.watch(&monitors.conditions, watched, When::Along(from), (from, time));
        }
        monitors.done = time;
        self.monitors = monitors;
    }

    /// Watches the properties at the present instant, after its micro-steps.
    pub fn watch_now(&mut self) {
        let time = self.present.time;
        let mut monitors = std::mem::take(&mut self.monitors);
        for (_, watched) in &mut monitors.properties {
            self.watch(&monitors.conditions, watched, When::Now, (time, time));
        }
        self.monitors = monitors;
    }

    fn watch(
        &mut self,
        conditions: &[(u32, &'p ClaimSystem)],
        watched: &mut Watched,
        when: When,
        (s, e): (f64, f64),
    ) {
        match watched {
            Watched::Extreme { extreme, condition, window, found, lookout } => {
                let (s, e) = (s.max(window[0]), e.min(window[1]));
                let mut margins = self.margins(conditions[*condition]);
                let of_type = &margins.agents.of_type;
                let lookout = lookout.as_mut().filter(|lookout| !of_type[lookout.ty].is_empty());
                if let Some(lookout) = lookout {
                    return watch_members(&mut margins, (*extreme, found), lookout, when, (s, e));
                }
                match when {
                    When::Now if s <= e => consider(&mut margins, *extreme, s, When::Now, found),
                    When::Along(_) if s <= e => search(&mut margins, *extreme, (s, e), found),
                    When::Now | When::Along(_) => {}
                }
            }
            Watched::Nested { operators, inner } => {
                let ahead =
                    operators.iter().map(|(_, window)| window[1]).sum::<f64>() + inner.ahead() + BEYOND;
                let e = e.min(ahead);
                if s < e {
                    for (condition, trace) in inner.traces() {
                        follow(&mut self.margins(conditions[condition]), (s, e), trace);
                    }
                }
            }
            Watched::Until { before, goal, window, least, found } => {
                let pair = [conditions[*before], conditions[*goal]];
                let e = e.min(window[1]);
                if s > e {
                    return;
                }
                if when == When::Now {
                    self.attain(pair, s, When::Now, window[0], (least, found));
                    return;
                }
                if s < window[0] {
                    let until = e.min(window[0]);
                    search(&mut self.margins(pair[0]), Extreme::Least, (s, until), least);
                }
                if e >= window[0] {
                    self.attain_within(pair, (s.max(window[0]), e), least, found);
                }
            }
        }
    }

    fn margins(&mut self, (instance, claim): (u32, &'p ClaimSystem)) -> Margins<'_, 'p> {
        Margins {
            agents: &self.agents,
            guards: &self.guards,
            present: &mut self.present,
            rows: &mut self.curves,
            instance,
            guard: &claim.violation,
            only: None,
        }
    }

    /// `before` until `goal`, if the goal is taken at `t`.
    fn attain(
        &mut self,
        [before, goal]: [(u32, &'p ClaimSystem); 2],
        t: f64,
        when: When,
        from: f64,
        (least, found): (&mut Option<Found>, &mut Option<Found>),
    ) {
        let mut margins = self.margins(goal);
        let spot = margins.at(when);
        let goal = Found::new(&mut margins, &spot, t, when);
        let here = least.as_ref().filter(|least| goal.margin.exceeds(least.margin)).unwrap_or(&goal);
        if t >= from && found.as_ref().is_none_or(|found| here.margin.exceeds(found.margin)) {
            *found = Some(here.clone());
        }
        if when == When::Now {
            consider(&mut self.margins(before), Extreme::Least, t, when, least);
        }
    }

    /// The greatest of min(goal, least of `before` so far) over [s, e]: from left to right, what cannot be greater left out.
    fn attain_within(
        &mut self,
        pair: [(u32, &'p ClaimSystem); 2],
        (s, e): (f64, f64),
        least: &mut Option<Found>,
        found: &mut Option<Found>,
    ) {
        let [before, goal] = pair;
        let mut pieces = vec![(s, e)];
        let mut looked_at = 0;
        while let Some((x, y)) = pieces.pop() {
            looked_at += 1;
            self.attain(pair, x, When::Along(x), x, (least, found));
            let known = |found: &Option<Found>, extreme: Extreme| {
                found.as_ref().map_or(Robustness::exact(extreme.neutral(), true), |found| found.margin)
            };
            let best = known(found, Extreme::Greatest);
            let floor = known(least, Extreme::Least);
            let held = self.margins(before).over(x, y);
            let reached = self.margins(goal).over(x, y);
            let most = Extreme::Least.of(reached.greatest, floor);
            let lowest = Extreme::Least.of(floor, held.least);
            let sides = [reached.sides[0] || !floor.closed, reached.sides[1] || floor.closed];
            if !may_improve(Extreme::Greatest, most, &sides, best, 0.0) || !floor.exceeds(reached.least) {
                // Nothing better here; or only `before` counts, which never rises.
            } else if !reached.greatest.exceeds(lowest) || !floor.exceeds(held.least) {
                // Only the goal counts, or the least so far.
                let mut top = None;
                search(&mut self.margins(goal), Extreme::Greatest, (x, y), &mut top);
                let top = match (top, &*least) {
                    (Some(top), Some(least)) if top.margin.exceeds(least.margin) => Some(least.clone()),
                    (top, _) => top,
                };
                if top.as_ref().is_some_and(|top| top.margin.exceeds(best)) {
                    *found = top;
                }
            } else if y - x > time_resolution(y) && looked_at < UNTIL_PIECES_MAX {
                let middle = 0.5 * (x + y);
                pieces.extend([(middle, y), (x, middle)]);
                continue;
            }
            search(&mut self.margins(before), Extreme::Least, (x, y), least);
            self.attain(pair, y, When::Along(y), y, (least, found));
        }
    }
}

/// Watches a quantifier member by member, each from when on it may come to decide.
fn watch_members(
    margins: &mut Margins<'_, '_>,
    (extreme, found): (Extreme, &mut Option<Found>),
    lookout: &mut Lookout,
    when: When,
    (s, e): (f64, f64),
) {
    if !std::mem::replace(&mut lookout.has_begun, true) {
        margins.agents.of_type[lookout.ty].iter().for_each(|&member| lookout.doubt(member));
    }
    let agents = margins.agents;
    let ty = lookout.ty;
    let is_member = |place: usize| agents.is_alive(place) && agents.agents[place].ty == ty;
    let is_watched = s <= e;
    if when == When::Now {
        for member in lookout.take_doubted() {
            if is_watched && is_member(member) {
                margins.only = Some(member);
                consider(margins, extreme, s, When::Now, found);
            }
        }
        return;
    }
    if !is_watched {
        return;
    }
    // Of a point of time all are looked at that have not been.
    let end = if s < e { e } else { e.next_up() };
    let mut looked_at = Vec::new();
    while let Some(member) = lookout.next_before(end) {
        if !is_member(member) {
            continue;
        }
        margins.only = Some(member);
        let known = margins.known_from(s).filter(|&known| known > e);
        let best = found.as_ref().map(|found| found.margin);
        let stays = |until: f64| {
            let bound = margins.over(s, until);
            let is_worse = |best: Robustness| {
                let end = end_of(&bound, extreme);
                extreme.prefers(best.value, end.value) && !may_change_side(extreme, end, &bound.sides, best)
            };
            best.is_some_and(is_worse)
        };
        match known.and_then(|known| farthest((s, e), known, stays)) {
            Some(until) => looked_at.push((member, until)),
            None => {
                search(margins, extreme, (s, e), found);
                looked_at.push((member, e));
            }
        }
    }
    looked_at.into_iter().for_each(|(member, until)| lookout.look_again(member, until));
}

/// A time beyond `e` up to which something stays as it is from `s` on: `known`, or less by halves.
fn farthest((s, e): (f64, f64), known: f64, mut stays: impl FnMut(f64) -> bool) -> Option<f64> {
    let halves = std::iter::successors(Some(known), |until| Some(s + 0.5 * (until - s)));
    halves.take(HALVES_MAX).take_while(|&until| until > e).find(|&until| stays(until))
}

/// Whether a value is less than the least so far, by more than rounding.
fn improves(value: f64, least: f64) -> bool {
    value < least && (least.is_infinite() || least - value > SHARE * least.abs())
}

/// The end of a bound at which the extreme may be.
fn end_of(bound: &Bound, extreme: Extreme) -> Robustness {
    match extreme {
        Extreme::Least => bound.least,
        Extreme::Greatest => bound.greatest,
    }
}

/// Whether margins up to `end`, on these sides where they are zero, may be better than the best so far, by more than `noise`.
fn may_improve(extreme: Extreme, end: Robustness, sides: &[bool; 2], best: Robustness, noise: f64) -> bool {
    let sign = extreme.sign();
    improves(sign * end.value + noise, sign * best.value) || may_change_side(extreme, end, sides, best)
}

/// Whether the best so far is zero, and they may be zero on the better side.
fn may_change_side(extreme: Extreme, end: Robustness, sides: &[bool; 2], best: Robustness) -> bool {
    let (end, best, has_better) = match extreme {
        Extreme::Least => (end.turned(), best.turned(), sides[0]),
        Extreme::Greatest => (end, best, sides[1]),
    };
    let is_reached = end.value > 0.0 || end.closed && end.value >= -best.slack;
    has_better && best.is_zero() && !best.closed && is_reached
}

/// Whether a margin is better than the best so far, by more than rounding, or zero as that is and on the better side.
fn is_better(
    margins: &mut Margins<'_, '_>,
    extreme: Extreme,
    (spot, when): (&Spot, When),
    best: Robustness,
) -> bool {
    if spot.closed != best.closed && best.is_zero() && margins.is_zero(spot, when) {
        return spot.closed == extreme.prefers_closed();
    }
    improves(extreme.sign() * spot.value, extreme.sign() * best.value)
}

/// Takes the margin at `t` if it is better.
fn consider(margins: &mut Margins<'_, '_>, extreme: Extreme, t: f64, when: When, found: &mut Option<Found>) {
    let spot = margins.at(when);
    if found.as_ref().is_none_or(|found| is_better(margins, extreme, (&spot, when), found.margin)) {
        *found = Some(Found::new(margins, &spot, t, when));
    }
}

/// The extreme of a margin over [s, e], if it is better than what was found before.
fn search(margins: &mut Margins<'_, '_>, extreme: Extreme, (s, e): (f64, f64), found: &mut Option<Found>) {
    let mut best = found.as_ref().map(|found| found.margin);
    let mut time = None;
    let mut look = |margins: &mut Margins<'_, '_>, t: f64| {
        let when = When::Along(t);
        let spot = margins.at(when);
        if best.is_none_or(|best| is_better(margins, extreme, (&spot, when), best)) {
            (best, time) = (Some(margins.robustness(&spot, when)), Some(t));
        }
        best.expect("a margin that nothing is found beside is the best")
    };
    look(margins, s);
    let mut best = look(margins, e);
    let noise = margins.rounding_at(0.5 * (s + e)) * ROUNDINGS;
    let mut pieces = VecDeque::from([(s, e)]);
    let mut looked_at = 0;
    // Longer pieces first.
    while let Some((a, b)) = pieces.pop_front() {
        looked_at += 1;
        let bound = margins.over(a, b);
        let may_improve = may_improve(extreme, end_of(&bound, extreme), &bound.sides, best, noise);
        let monotone = bound.slope.lo >= 0.0 || bound.slope.hi <= 0.0;
        if !may_improve || monotone || b - a <= time_resolution(b) {
            continue;
        }
        if looked_at > PIECES_MAX {
            break;
        }
        let middle = 0.5 * (a + b);
        best = look(margins, middle);
        pieces.extend([(a, middle), (middle, b)]);
    }
    if let Some(time) = time {
        let settled = settle(margins, extreme.sign(), time, (s, e));
        let spot = margins.at(When::Along(settled));
        // As near to it a zero may be on the other side.
        let (time, spot) =
            if spot.closed == best.closed { (settled, spot) } else { (time, margins.at(When::Along(time))) };
        *found = Some(Found::new(margins, &spot, time, When::Along(time)));
    }
}

/// The time of a least value to the last bits: where the rate changes its sign, near `t`, within [s, e].
fn settle(margins: &mut Margins<'_, '_>, sign: f64, t: f64, (s, e): (f64, f64)) -> f64 {
    let mut rate = |t: f64| sign * margins.at(When::Along(t)).slope;
    let mut width = time_resolution(t);
    while width < e - s {
        let (mut a, mut b) = ((t - width).max(s), (t + width).min(e));
        if rate(a) < 0.0 && rate(b) > 0.0 {
            while b - a > time_resolution(t) {
                let middle = 0.5 * (a + b);
                if rate(middle) < 0.0 { a = middle } else { b = middle }
            }
            return 0.5 * (a + b);
        }
        width *= 4.0;
        // The value is that of t within rounding: so is that of all times so near, and of no others.
        if width > 1e-3 * (e - s) {
            break;
        }
    }
    t
}

/// Adds the margin over [s, e] to a trace: by cubics through both ends of pieces, halved until each hits it inside, too.
fn follow(margins: &mut Margins<'_, '_>, (s, e): (f64, f64), trace: &mut Trace) {
    let mut pending = vec![(s, e)];
    let (is_mixed, mut n_sided) = (margins.is_mixed(), 0);
    while let Some((a, b)) = pending.pop() {
        let spots = [0.0, 0.25, 0.5, 0.75, 1.0].map(|share| {
            let t = a + share * (b - a);
            (t, margins.at(When::Along(t)))
        });
        let [first, .., last] = &spots;
        let (values, slopes) = ([first.1.value, last.1.value], [first.1.slope, last.1.slope]);
        let closed = spots[2].1.closed;
        let mut piece = if values[0].is_finite() && values[1].is_finite() {
            Piece::through(a, b, values, slopes, closed)
        } else {
            Piece::constant(a, b, Robustness::exact(spots[2].1.value, closed), Origin::Later(0.0))
        };
        let hits = spots.iter().all(|(t, spot)| {
            let miss = (piece.at(*t) - spot.value).abs();
            piece.at(*t) == spot.value || miss <= ACCURACY * spot.value.abs().max(1.0)
        });
        let asks_side = hits && is_mixed && piece.reaches_zero();
        let side = if asks_side { margins.over(a, b).closed() } else { Some(closed) };
        piece.closed = side.unwrap_or(closed);
        let has_sides = side.is_none() && n_sided < SIDED_MAX;
        if (!hits || has_sides) && b - a > time_resolution(b) {
            n_sided += usize::from(has_sides);
            let middle = spots[2].0;
            pending.extend([(middle, b), (a, middle)]);
            continue;
        }
        trace.pieces.push(piece);
        let spot = &spots[2].1;
        let decider = Decider { from: a, closed: piece.closed, agents: margins.bound_agents(spot) };
        let same = |known: &Decider| known.closed == decider.closed && known.agents == decider.agents;
        if !trace.deciders.last().is_some_and(same) {
            trace.deciders.push(decider);
        }
    }
}
