//! What a search for roots is told and tells, and the comparison that it looks at, turned so that its present truth is f > 0.

use crate::math::Interval;

/// g along a trajectory.
pub trait Curve {
    /// g, g', g'' at t; g'' may be NaN where it is not known.
    fn jet(&mut self, t: f64) -> [f64; 3];
    /// g at t, the same number as in the jet.
    fn value(&mut self, t: f64) -> f64 {
        self.jet(t)[0]
    }
    /// Whether g cannot jump. Where it can, only its own bounds hold over a stretch, and no rounding is told from a jump.
    fn smooth(&self) -> bool;
    /// Bounds of g, g', g'' over [s, e].
    fn jet_range(&mut self, s: f64, e: f64) -> [Interval; 3];
    /// Whether the rate of g is not the same on both sides of t.
    fn turns(&mut self, _t: f64) -> bool {
        false
    }
    /// Whether nobody waits for the search any more: it then ends where it is.
    fn given_up(&self) -> bool {
        false
    }
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
    /// Whether it is known up to the start by a search of its own, which may have left a zero at the start itself.
    pub joins: bool,
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
    pub fn touch(time: f64) -> Self {
        Self { time, near: time, undecided: true }
    }

    /// Below zero from here on.
    pub fn at(time: f64) -> Self {
        Self { time, near: time, undecided: false }
    }
}

/// The result of a search.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Search {
    /// No change in (s, e].
    None,
    /// Nor that: it is on its boundary at s, and stays there.
    Along,
    /// The first change.
    Flip(Flip),
    /// No change up to here; the limit of pieces was reached.
    Until(f64),
    /// The limit of pieces was reached, and hardly any way was made.
    Undecided,
}

impl Known {
    /// Whether coming within rounding of zero changes the truth.
    pub fn touching(&self) -> bool {
        self.closed && !self.truth
    }
}

/// A surface on which the rate of g turns is here if what is zero there is no larger.
pub const AT_TURN: f64 = 1e-13;

/// How the search enters a piece.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Entry {
    /// f > 0 at its start.
    Clear,
    /// f is zero within rounding at its start, and the present truth holds on until f is really below zero.
    Boundary,
    /// f is not positive at its start, and did not change before.
    Unsettled,
}

/// What is on the boundary has left it when it is so many roundings away from it; what is not is there within one.
pub const LEAVES: f64 = 4.0;

/// At so many points f is looked at to tell that it stays zero.
const SAMPLES: u32 = 16;

/// g with its sign turned so that the present truth is f > 0. A g that is no number counts as false; where zero belongs
/// to the present truth, it counts as the least number above it.
pub struct Turned<'a> {
    /// g.
    pub curve: &'a mut dyn Curve,
    turned: bool,
    /// Whether zero belongs to the present truth.
    pub keeps_zero: bool,
    /// A bound of rounding above this is none: it is the height of a pole.
    pub rounding_max: f64,
}

impl<'a> Turned<'a> {
    /// f over [s, e], of which this is known at s.
    pub fn new(curve: &'a mut dyn Curve, s: f64, e: f64, known: &Known) -> Self {
        let keeps_zero = known.closed == known.truth;
        let mut f = Self { curve, turned: known.truth, keeps_zero, rounding_max: 0.0 };
        let size = [s, e]
            .map(|t| f.curve.value(t).abs())
            .into_iter()
            .filter(|size| size.is_finite())
            .fold(1.0, f64::max);
        f.rounding_max = 1e-3 * size;
        f
    }

    /// f, f', f'' at t.
    pub fn jet(&mut self, t: f64) -> [f64; 3] {
        let [g, rate, second] = self.curve.jet(t);
        let turn = |rate: f64| if self.turned { -rate } else { rate };
        let rates = [rate, second].map(|rate| if g.is_nan() { f64::NAN } else { turn(rate) });
        [self.turn(g), rates[0], rates[1]]
    }

    /// f at t.
    pub fn value(&mut self, t: f64) -> f64 {
        let g = self.curve.value(t);
        self.turn(g)
    }

    /// f where this is g.
    fn turn(&self, g: f64) -> f64 {
        match (g, self.turned) {
            (g, turned) if g.is_nan() => {
                if turned {
                    f64::NEG_INFINITY
                } else {
                    f64::INFINITY
                }
            }
            (0.0, _) if self.keeps_zero => f64::from_bits(1),
            (g, true) => -g,
            (g, false) => g,
        }
    }

    /// How a piece is entered that begins in the middle of one entered so.
    pub fn entry_at(&mut self, t: f64, before: Entry, known: &Known) -> Entry {
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

    /// Whether f is within rounding of zero, or within `band`, at all of many points of [s, e], which lie at no regular distance.
    pub fn stays_within(&mut self, s: f64, e: f64, band: f64) -> bool {
        let share = |k: u32| (f64::from(k) * 0.618_033_988_749_894_9).fract();
        let points = [e, s, 0.5 * (s + e)].into_iter().chain((1..SAMPLES).map(|k| s + (e - s) * share(k)));
        let is_within = |f: &mut Self, t: f64| {
            let size = f.value(t).abs();
            size <= band || size <= LEAVES * f.rounding(t)[0]
        };
        self.curve.smooth() && points.into_iter().all(|t| is_within(self, t))
    }

    /// Whether g is no number at some points of [s, e], its ends among them.
    pub fn undefined_all_over(&mut self, s: f64, e: f64) -> bool {
        (0..5).all(|k| self.curve.value(s + (e - s) * 0.25 * f64::from(k)).is_nan())
    }

    /// Bounds of f, f', f'' over [s, e].
    pub fn range(&mut self, s: f64, e: f64) -> [Interval; 3] {
        let range = self.curve.jet_range(s, e);
        if self.turned { range.map(|v| Interval { lo: -v.hi, hi: -v.lo }) } else { range }
    }

    /// The rounding bounds of f, f', f'' at t.
    pub fn rounding(&mut self, t: f64) -> [f64; 3] {
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
