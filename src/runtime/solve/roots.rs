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
use crate::runtime::solve::{time_resolution, ulp};

/// g along a trajectory.
pub trait Curve {
    /// g, g', g'' at t; g'' may be NaN where it is not known.
    fn jet(&mut self, t: f64) -> [f64; 3];
    /// Whether g cannot jump. Where it can, only its own bounds hold over a stretch, and no rounding is told from a jump.
    fn smooth(&self) -> bool;
    /// Bounds of g, g', g'' over [s, e].
    fn jet_range(&mut self, s: f64, e: f64) -> [Interval; 3];
}

/// What is known of a comparison at the start of a search.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Known {
    /// Its truth (for `crossing`: whether g is on the negative side).
    pub truth: bool,
    /// Whether it is true where g is exactly zero, so that touching zero makes it true.
    pub closed: bool,
    /// How far from zero g may be at the start and count as on the boundary, beyond what the rates there say.
    pub slack: f64,
    /// Whether the truth has been settled at the start itself, by a root or by the rates there: if it lies on the
    /// boundary, it is not asked again which way it goes.
    pub settled: bool,
    /// Whether it grazed zero at the start itself: it does not do so again before it has left it.
    pub grazed: bool,
    /// A root that is due within this time after the end counts as at the end, s.
    pub reach: f64,
}

/// A change of truth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flip {
    /// When; the new truth holds here or just after, s.
    pub time: f64,
    /// The last time at which the old truth held as far as is known, s.
    pub near: f64,
    /// Not isolated: the comparison came within rounding of zero, or the limit of pieces was reached.
    pub undecided: bool,
}

impl Flip {
    /// Within rounding of zero.
    fn touch(time: f64) -> Self {
        Self { time, near: time, undecided: true }
    }

    /// Below zero from here on.
    fn at(time: f64) -> Self {
        Self { time, near: time, undecided: false }
    }
}

/// The result of a search.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Search {
    /// No change in (s, e].
    None,
    /// The first change.
    Flip(Flip),
    /// No change up to here; the limit of pieces was reached.
    Until(f64),
    /// The limit of pieces was reached, and hardly any way was made.
    Undecided,
}

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

/// g with its sign turned so that the present truth is f > 0. A g that is no number counts as false; where zero belongs
/// to the present truth, it counts as the least number above it.
struct Turned<'a> {
    curve: &'a mut dyn Curve,
    turned: bool,
    keeps_zero: bool,
    /// A bound of rounding above this is none: it is the height of a pole.
    rounding_max: f64,
}

impl<'a> Turned<'a> {
    fn new(curve: &'a mut dyn Curve, s: f64, e: f64, known: &Known) -> Self {
        let keeps_zero = known.closed == known.truth;
        let mut f = Self { curve, turned: known.truth, keeps_zero, rounding_max: 0.0 };
        let size = [s, e]
            .map(|t| f.curve.jet(t)[0].abs())
            .into_iter()
            .filter(|size| size.is_finite())
            .fold(1.0, f64::max);
        f.rounding_max = 1e-3 * size;
        f
    }

    fn jet(&mut self, t: f64) -> [f64; 3] {
        let jet = self.curve.jet(t);
        if jet[0].is_nan() {
            return [if self.turned { f64::NEG_INFINITY } else { f64::INFINITY }, f64::NAN, f64::NAN];
        }
        let mut jet = if self.turned { jet.map(|v| -v) } else { jet };
        if jet[0] == 0.0 && self.keeps_zero {
            jet[0] = f64::from_bits(1);
        }
        jet
    }

    fn value(&mut self, t: f64) -> f64 {
        self.jet(t)[0]
    }

    /// How a piece is entered that begins in the middle of one entered so.
    fn entry_at(&mut self, t: f64, before: Entry, known: &Known) -> Entry {
        let value = self.value(t);
        if value > 0.0 && before == Entry::Clear {
            return Entry::Clear;
        }
        // Near a boundary a number that rounding may have made is not clear of it, nor beyond it.
        let rounding = self.rounding(t)[0];
        let stays = before == Entry::Boundary && !known.touching();
        if stays && value.abs() <= LEAVES * rounding {
            Entry::Boundary
        } else if value > rounding {
            Entry::Clear
        } else {
            Entry::Unsettled
        }
    }

    /// Whether f is near the boundary at all of many points of [s, e], which lie at no regular distance.
    fn stays_within_rounding(&mut self, s: f64, e: f64) -> bool {
        let share = |k: u32| (f64::from(k) * 0.618_033_988_749_894_9).fract();
        let points = [s, e, 0.5 * (s + e)].into_iter().chain((1..SAMPLES).map(|k| s + (e - s) * share(k)));
        self.curve.smooth() && points.into_iter().all(|t| self.value(t).abs() <= LEAVES * self.rounding(t)[0])
    }

    fn undefined_all_over(&mut self, s: f64, e: f64) -> bool {
        (0..5).all(|k| self.curve.jet(s + (e - s) * 0.25 * f64::from(k))[0].is_nan())
    }

    fn range(&mut self, s: f64, e: f64) -> [Interval; 3] {
        let range = self.curve.jet_range(s, e);
        if self.turned { range.map(|v| Interval { lo: -v.hi, hi: -v.lo }) } else { range }
    }

    /// The rounding bounds of f, f', f'' at t.
    fn rounding(&mut self, t: f64) -> [f64; 3] {
        if !self.curve.smooth() {
            return [0.0; 3];
        }
        let width = self
            .range(t, t)
            .map(|bound| bound.hi - bound.lo)
            .map(|width| if width.is_finite() { width } else { 0.0 });
        let own = if width[0] <= self.rounding_max { width[0] } else { 0.0 };
        [own.max(f64::MIN_POSITIVE), width[1], width[2]]
    }
}

/// How the search enters a piece.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Entry {
    /// f > 0 at its start.
    Clear,
    /// f is zero within rounding at its start, and the present truth holds on until f is really below zero.
    Boundary,
    /// f is not positive at its start, and did not change before.
    Unsettled,
}

/// What is on the boundary has left it when it is so many roundings away from it; what is not is there within one.
const LEAVES: f64 = 4.0;

/// At so many points f is looked at to tell that it stays zero.
const SAMPLES: u32 = 16;

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
            entry = match enter(&mut f, s, known_here) {
                Ok(entry) => entry,
                Err(flip) => return Search::Flip(flip),
            };
            known_here.slack = 0.0;
            known_here.settled = false;
            known_here.grazed = false;
            if looked_at == 0 && entry == Entry::Boundary && f.stays_within_rounding(s, e) {
                return if known.touching() { Search::Flip(Flip::touch(s)) } else { Search::None };
            }
        }
        looked_at += 1;
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

impl Known {
    /// Whether coming within rounding of zero changes the truth.
    fn touching(&self) -> bool {
        self.closed && !self.truth
    }
}

/// Takes off the pieces over which |f| stays within rounding of zero: it is on the boundary all along. A change if that
/// is one.
fn along(f: &mut Turned<'_>, pieces: &mut Vec<(f64, f64, Entry)>, known: &Known) -> Option<Flip> {
    let s = pieces.last()?.0;
    let longest = (0..pieces.len()).find(|&k| f.stays_within_rounding(s, pieces[k].1))?;
    pieces.truncate(longest);
    known.touching().then_some(Flip::touch(s))
}

fn decide(jet: &[f64; 3], rounding: &[f64; 3]) -> Direction {
    for order in 1..3 {
        if jet[order].abs() > rounding[order] {
            return if jet[order] > 0.0 { Direction::Up } else { Direction::Down };
        }
    }
    Direction::Along
}

/// Settles the start of a search: clear, on the boundary going up, or changing at once.
fn enter(f: &mut Turned<'_>, s: f64, known: Known) -> Result<Entry, Flip> {
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
    let direction = decide(&jet, &rounding);
    let passes = known.grazed || !known.touching();
    if direction != Direction::Up && passes && turns_back(f, s, &jet, band.max(rounding[0])) {
        return Ok(Entry::Boundary);
    }
    match direction {
        Direction::Up => Ok(Entry::Boundary),
        Direction::Down => Err(flip),
        Direction::Along if known.truth == known.closed => Ok(Entry::Boundary),
        Direction::Along => Err(flip),
    }
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
    let (middle, radius) = (0.5 * (s + e), 0.5 * (e - s));
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
