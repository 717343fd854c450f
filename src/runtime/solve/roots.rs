//! Certified detection: the first time at which a comparison changes its truth, found by excluding or isolating roots.
//!
//! A comparison is known to be true or false just after `s`. With f = g where it is false and f = -g where it is true,
//! it changes where f falls below zero. Over a piece of time the search looks, in this order, at: a bound of f; the
//! bound of f' (monotone: the signs at the ends decide); the bound of f'' (convex or concave: the extremum decides);
//! else it divides the piece. A bracketing method isolates the root to the last bits of the time.
//!
//! **On the boundary** at `s` (rule 3): |f| within rounding, or within |f'| times the resolution of time. Then the first
//! of f', f'' that is not zero within rounding decides: into f > 0 the comparison holds on (the zero at `s` is not a
//! root), into f < 0 it changes at once. If neither decides, `<=` is true and `<` false.

use crate::math::Interval;
use crate::runtime::solve::bracket::bracket;
pub use crate::runtime::solve::curve::{AT_TURN, Curve, Flip, Known, Search};
use crate::runtime::solve::curve::{Entry, LEAVES, Turned};
use crate::runtime::solve::{time_resolution, ulp};

/// Which way f goes from a point on the boundary.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// Into f > 0.
    Up,
    /// Into f < 0.
    Down,
    /// Not decided by the first two rates.
    Along,
}

/// After so many pieces a search asks whether f is zero all along, or not defined.
const PIECES_PATIENT: u32 = 24;

/// The first change of truth in (s, e], or at s where the boundary decides so. At most `pieces_max` pieces are looked at.
pub fn first_flip(curve: &mut dyn Curve, s: f64, e: f64, known: Known, pieces_max: u32) -> Search {
    let mut f = Turned::new(curve, s, e, &known);
    let (start, length) = (s, e - s);
    let small = length / 256.0;
    let mut pieces = vec![match beyond_graze(&mut f, s, e, &known) {
        Some(clear) => (clear, e, Entry::Clear),
        None => (s, e, Entry::Unsettled),
    }];
    let mut known_here = known;
    let mut looked_at = 0;
    while let Some((s, e, mut entry)) = pieces.pop() {
        if entry == Entry::Unsettled {
            entry = match enter(&mut f, (s, e), known_here) {
                Ok(entry) => entry,
                Err(flip) => return Search::Flip(flip),
            };
            if looked_at == 0 && entry == Entry::Boundary && f.stays_within(s, e, known.slack) {
                let is_given = known.settled || !known.touching();
                return if is_given { Search::Along } else { Search::Flip(Flip::touch(s)) };
            }
            known_here = Known { slack: 0.0, settled: false, grazed: false, joins: false, ..known_here };
        }
        looked_at += 1;
        if f.curve.given_up() {
            return Search::Until(s);
        }
        match look(&mut f, s, e, entry, &known) {
            Look::Clear => {}
            Look::Flip(flip) => return Search::Flip(flip),
            Look::Divide if looked_at >= PIECES_PATIENT && e - s < small && f.undefined_all_over(s, e) => {}
            Look::Divide if looked_at >= pieces_max && s - start > 1e-3 * length => return Search::Until(s),
            Look::Divide if looked_at >= pieces_max => return Search::Undecided,
            Look::Divide if divisible(s, e) => {
                let middle = 0.5 * (s + e);
                pieces.push((middle, e, f.entry_at(middle, entry, &known)));
                pieces.push((s, middle, entry));
            }
            Look::Divide => {
                if let Some(flip) = undecided(&mut f, s, e, entry, known.touching()) {
                    return Search::Flip(flip);
                }
            }
        }
        if (looked_at == PIECES_PATIENT || looked_at > PIECES_PATIENT && looked_at.is_power_of_two())
            && let Some(flip) = along(&mut f, &mut pieces, &known)
        {
            return Search::Flip(flip);
        }
    }
    Search::None
}

/// Just beyond a zero that was grazed at s, where f rises: the search goes on from there.
fn beyond_graze(f: &mut Turned<'_>, s: f64, e: f64, known: &Known) -> Option<f64> {
    let beyond = s + 2.0 * time_resolution(s);
    if !(known.grazed && known.touching() && beyond < e) {
        return None;
    }
    let jet = f.jet(beyond);
    (jet[0] > 0.0 && jet[1] > 0.0).then_some(beyond)
}

/// Takes off the pieces over which |f| stays within rounding of zero: it is on the boundary all along. A change if that
/// is one.
fn along(f: &mut Turned<'_>, pieces: &mut Vec<(f64, f64, Entry)>, known: &Known) -> Option<Flip> {
    let &(s, _, entry) = pieces.last()?;
    let longest = (0..pieces.len()).find(|&k| f.stays_within(s, pieces[k].1, 0.0))?;
    pieces.truncate(longest);
    // What was settled to be false on its boundary is held so.
    (known.touching() && entry != Entry::Boundary).then_some(Flip::touch(s))
}

/// Rule 3, "On the boundary": by the first of two rates that is not zero within rounding.
pub fn direction(jet: &[f64; 3], rounding: &[f64; 3]) -> Direction {
    for order in 1..3 {
        if jet[order].abs() > rounding[order] {
            return if jet[order] > 0.0 { Direction::Up } else { Direction::Down };
        }
    }
    Direction::Along
}

/// Settles the start of a search: clear, on the boundary going up, or changing at once.
fn enter(f: &mut Turned<'_>, (s, e): (f64, f64), known: Known) -> Result<Entry, Flip> {
    let jet = f.jet(s);
    let by_rate = known.slack.max(jet[1].abs() * time_resolution(s)).min(1e-3 * (1.0 + jet[0].abs()));
    let band = by_rate.min(f.rounding_max);
    if jet[0] > f.rounding_max || jet[0] == f64::INFINITY {
        return Ok(Entry::Clear);
    }
    let rounding = f.rounding(s);
    // Where f moves so slowly that it may only seem to, the truth changes when it is really below zero.
    let slow = jet[1].abs() * 1e-6 <= rounding[0] && !known.touching();
    if slow && jet[0].abs() <= LEAVES * rounding[0] {
        return Ok(Entry::Boundary);
    }
    if jet[0] > band.max(rounding[0]) {
        return Ok(Entry::Clear);
    }
    if known.settled && jet[0] >= -band.max(rounding[0]) {
        return Ok(Entry::Boundary);
    }
    let flip = Flip::at(s);
    if jet[0] < -band.max(rounding[0]) {
        return Err(flip);
    }
    let direction = if f.curve.turns(s) { way_from(f, (s, e)) } else { direction(&jet, &rounding) };
    let passes = known.grazed || !known.touching();
    if direction != Direction::Up && passes && turns_back(f, s, &jet, band.max(rounding[0])) {
        return Ok(Entry::Boundary);
    }
    match direction {
        // Clear up to s, where one stretch ends and the next begins, and clear again from there.
        Direction::Up if known.joins && known.touching() && !known.grazed => Err(Flip::touch(s)),
        Direction::Up => Ok(Entry::Boundary),
        Direction::Down => Err(flip),
        Direction::Along if known.truth == known.closed => Ok(Entry::Boundary),
        Direction::Along => Err(flip),
    }
}

/// Which way f goes from s, where its rate is not the same on both sides: by what it is a little later.
fn way_from(f: &mut Turned<'_>, (s, e): (f64, f64)) -> Direction {
    let here = f.value(s);
    for share in [1e-6, 1e-4, 1e-2] {
        let t = s + share * (e - s);
        let change = f.value(t) - here;
        if change.abs() > f.rounding(t)[0] {
            return if change > 0.0 { Direction::Up } else { Direction::Down };
        }
    }
    Direction::Along
}

/// Whether an f within `band` of zero at t is positive again where its rate would have it below: there is a kink in
/// between, or more rates than two are zero at t, and f is zero at a single point.
fn turns_back(f: &mut Turned<'_>, t: f64, jet: &[f64; 3], band: f64) -> bool {
    let fall = if jet[1] < 0.0 { (band + jet[0].abs()) / -jet[1] } else { 0.0 };
    let soon = 2.0 * (time_resolution(t) + fall);
    soon.is_finite() && f.value(t + soon) > 0.0
}

/// What a look at a piece found.
enum Look {
    Clear,
    Flip(Flip),
    Divide,
}

fn look(f: &mut Turned<'_>, s: f64, e: f64, entry: Entry, known: &Known) -> Look {
    let [f0, f1, f2] = f.range(s, e);
    // Where g can jump, a plateau at zero is known to a few bits only.
    let plateau = if f.curve.smooth() { 0.0 } else { 16.0 * f64::EPSILON * f0.hi.abs().max(1.0) };
    if f0.lo > 0.0 || f0.lo >= -plateau && f.keeps_zero {
        return Look::Clear;
    }
    if f1.lo >= 0.0 {
        return Look::Clear;
    }
    if entry == Entry::Clear
        && (clears_by_mean_value(f, s, e, &f0, &f1) || clears_by_second_rate(f, s, e, &f2))
    {
        return Look::Clear;
    }
    let at_end = f.jet(e);
    let stays =
        |f: &mut Turned<'_>| entry == Entry::Boundary && !known.touching() && at_end[0] >= -f.rounding(e)[0];
    if f1.hi <= 0.0 && entry == Entry::Clear {
        return falling(f, s, e, &at_end, known);
    }
    if f1.hi < 0.0 {
        let flip = Flip::at(s);
        return if stays(f) { Look::Clear } else { Look::Flip(flip) };
    }
    if f2.hi <= 0.0 && stays(f) {
        // It stays above the chord.
        return Look::Clear;
    }
    if f2.lo >= 0.0 {
        return convex(f, s, e, entry, &at_end, known);
    }
    if f2.hi <= 0.0 {
        return concave(f, s, e, entry, &at_end, known);
    }
    Look::Divide
}

/// f(middle) outweighs all that f' can take away, with room for rounding.
fn clears_by_mean_value(f: &mut Turned<'_>, s: f64, e: f64, f0: &Interval, f1: &Interval) -> bool {
    let at_middle = f.value(0.5 * (s + e));
    let loss = f1.lo.abs().max(f1.hi.abs()) * 0.5 * (e - s);
    at_middle * (1.0 - 1e-9) > loss && at_middle > 1e-12 * (f0.hi - f0.lo)
}

/// f(middle) outweighs what f' there and the bound of f'' can take away.
fn clears_by_second_rate(f: &mut Turned<'_>, s: f64, e: f64, f2: &Interval) -> bool {
    if !f2.lo.is_finite() {
        return false;
    }
    let middle = 0.5 * (s + e);
    // The middle is rounded; how far the ends are from it is not.
    let radius = (middle - s).max(e - middle);
    let jet = f.jet(middle);
    let least = jet[0] - jet[1].abs() * radius + 0.5 * f2.lo.min(0.0) * radius * radius;
    least > 0.0 && {
        let rounding = f.rounding(middle);
        least > rounding[0] + rounding[1] * radius
    }
}

/// f falls from f(s) > 0.
fn falling(f: &mut Turned<'_>, s: f64, e: f64, at_end: &[f64; 3], known: &Known) -> Look {
    if at_end[0] <= 0.0 {
        return Look::Flip(isolate(f, s, e));
    }
    if due(f, e, at_end, known) {
        return Look::Flip(Flip::at(e));
    }
    Look::Clear
}

/// Whether f, positive at the end, falls to zero within `reach` after it, or is there within rounding: such a root is
/// found here, not at the start of what follows.
fn due(f: &mut Turned<'_>, e: f64, at_end: &[f64; 3], known: &Known) -> bool {
    let loss = -at_end[1] * known.reach;
    let suspicious = at_end[1] < 0.0 && at_end[0] <= loss.max(1e-9 * at_end[1].abs());
    if !suspicious || at_end[0] > loss && at_end[0] > f.rounding(e)[0] {
        return false;
    }
    known.touching() || !turns_back(f, e, at_end, 0.0)
}

/// f'' >= 0: one minimum at most.
fn convex(f: &mut Turned<'_>, s: f64, e: f64, entry: Entry, at_end: &[f64; 3], known: &Known) -> Look {
    if entry == Entry::Boundary {
        let at_start = f.jet(s)[1];
        if at_start < 0.0 && at_start < -f.rounding(s)[1] && (known.touching() || sinks(f, s, e, at_end)) {
            return Look::Flip(Flip::at(s));
        }
        return Look::Clear;
    }
    if at_end[1] <= 0.0 {
        return falling(f, s, e, at_end, known);
    }
    if f.jet(s)[1] >= 0.0 {
        return Look::Clear;
    }
    let (before, after) = turning_point(f, s, e);
    let lowest = if f.value(before) < f.value(after) { before } else { after };
    let value = f.value(lowest);
    let rounding = f.rounding(lowest)[0];
    if value < -rounding {
        return Look::Flip(isolate(f, s, lowest));
    }
    if value > rounding || !known.touching() {
        return Look::Clear;
    }
    Look::Flip(Flip::touch(lowest))
}

/// Whether an f with one minimum is really below zero somewhere.
fn sinks(f: &mut Turned<'_>, s: f64, e: f64, at_end: &[f64; 3]) -> bool {
    let lowest = if at_end[1] <= 0.0 { e } else { turning_point(f, s, e).0 };
    f.value(lowest) < -LEAVES * f.rounding(lowest)[0]
}

/// f'' <= 0: it stays above the chord.
fn concave(f: &mut Turned<'_>, s: f64, e: f64, entry: Entry, at_end: &[f64; 3], known: &Known) -> Look {
    if at_end[0] > 0.0 {
        if due(f, e, at_end, known) {
            return Look::Flip(Flip::at(e));
        }
        return Look::Clear;
    }
    let from = match entry {
        Entry::Clear => s,
        Entry::Boundary | Entry::Unsettled => {
            let (rising, sinking) = if f.jet(s)[1] <= 0.0 { (s, s) } else { turning_point(f, s, e) };
            if f.value(rising).max(f.value(sinking)) <= 0.0 {
                // It never rose above zero by more than rounding, and now its rate points down.
                return Look::Flip(Flip { time: sinking, near: rising, undecided: false });
            }
            if f.value(sinking) > 0.0 { sinking } else { rising }
        }
    };
    Look::Flip(isolate(f, from, e))
}

/// A piece too small to divide, or one piece too many.
fn undecided(f: &mut Turned<'_>, s: f64, e: f64, entry: Entry, touching: bool) -> Option<Flip> {
    let [at_start, at_end] = [f.value(s), f.value(e)];
    let band = f.rounding(e)[0].max(f.jet(e)[1].abs() * time_resolution(e)).min(f.rounding_max);
    if entry == Entry::Boundary && at_end.abs() <= band {
        return None;
    }
    let onto_plateau = at_end == 0.0 && at_start > 0.0 && !f.keeps_zero;
    if at_end < 0.0 || onto_plateau && f.value(e + 2.0 * time_resolution(e)) <= 0.0 {
        let (mut near, mut time) = (s, s.next_up());
        while time < e && f.value(time) > 0.0 {
            (near, time) = (time, time.next_up());
        }
        return Some(Flip { time: time.min(e), near, undecided: false });
    }
    let within = |f: &mut Turned<'_>, t: f64, value: f64| value.abs() <= f.rounding(t)[0];
    if touching && at_start > 0.0 && within(f, e, at_end) {
        return Some(Flip { time: e, near: s, undecided: true });
    }
    None
}

/// Pieces are divided down to a few bits of the time.
fn divisible(s: f64, e: f64) -> bool {
    e - s > 4.0 * ulp(e)
}

/// Neighbouring times between which the monotone f' changes its sign in [s, e].
fn turning_point(f: &mut Turned<'_>, s: f64, e: f64) -> (f64, f64) {
    let rising = f.jet(e)[1] > 0.0;
    bracket(s, e, &mut |t| {
        let rate = f.jet(t)[1];
        if rising { -rate } else { rate }
    })
}

/// The root in [s, e] of an f that is positive at s, not positive at e, and falls.
fn isolate(f: &mut Turned<'_>, s: f64, e: f64) -> Flip {
    let (near, time) = bracket(s, e, &mut |t| f.value(t));
    Flip { time, near, undecided: false }
}
