//! Where a comparison jumps: its branches on either side of an instant, and the first change of its truth across its surfaces.
//!
//! Between two surfaces all branches are held by locks, and g is smooth: its roots are searched there as those of any other
//! comparison. At a surface there are three truths: that before it, which is known; that *at* it, by every lock that meets its
//! surface closed (`a <= b` true, `floor e` the whole number that e is); and that just *after* it, by the side to which the
//! rates of the surface lead. A lock meets its surface where it is zero within rounding, or within its rate times the
//! resolution of time: so `mod(x, 1) <= 0` is true where x is 1, whether or not a number can hold that point.

use std::sync::atomic::{AtomicBool, Ordering};

use crate::codegen::program::{Atom, Jumps, KinkKind, Relation};
use crate::math::Interval;
use crate::runtime::atom_state::{Leap, closed};
use crate::runtime::detect::{AtomCurve, CurveRows};
use crate::runtime::fold::Folded;
use crate::runtime::population::{Agents, Slots};
use crate::runtime::solve::roots::{Curve, Flip, Known, Search, first_flip};
use crate::runtime::solve::{time_resolution, ulp};
use crate::runtime::truth::Side;

/// Comparisons at one instant. `own` are the auxiliary columns of self with the locks.
pub trait Point {
    /// g, g', g'' of a smooth comparison.
    fn jet(&mut self, atom: &Atom, own: &[f64]) -> [f64; 3];
    /// What rounding may do to them.
    fn rounding(&mut self, atom: &Atom, own: &[f64]) -> [f64; 3];
}

/// The auxiliary columns of self with the locks as they are on one side of an instant. What moves to a surface within
/// `resolution` (s) meets it.
pub fn own_columns(
    point: &mut dyn Point,
    jumps: &Jumps,
    aux: &[f64],
    side: Side,
    resolution: f64,
) -> Vec<f64> {
    let mut own = aux.to_vec();
    own.resize(jumps.first, 0.0);
    own.resize(jumps.first + jumps.surfaces.len(), 0.0);
    for (k, kind) in jumps.surfaces.iter().enumerate() {
        let column = jumps.first + k;
        own[column] = match kind {
            KinkKind::Branch(atom) => {
                let met = Met::new(point, atom, &own, 0.0, resolution);
                let holds = met.jet[0] <= 0.0;
                let closed = match (met.is_near, side) {
                    (false, _) => holds,
                    (true, Side::At) => true,
                    (true, Side::After) => met.leads_down().unwrap_or(holds),
                };
                f64::from(u8::from(closed))
            }
            KinkKind::Integer { below, .. } => {
                // With the lock at 0 this is e itself.
                let e = point.jet(below, &own)[0];
                let (whole, floor) = (e.round(), e.floor());
                let met = Met::new(point, below, &own, whole, resolution);
                match (met.is_near, side) {
                    (false, _) => floor,
                    (true, Side::At) => whole,
                    (true, Side::After) => match met.leads_down() {
                        Some(true) => whole - 1.0,
                        Some(false) => whole,
                        None => floor,
                    },
                }
            }
        };
    }
    own
}

/// The truth of a comparison on one side of an instant, with these columns; `before` is that before the instant.
pub fn truth_of(
    point: &mut dyn Point,
    between: &Atom,
    own: &[f64],
    side: Side,
    resolution: f64,
    before: bool,
) -> bool {
    let met = Met::new(point, between, own, 0.0, resolution);
    match (met.is_near, side) {
        (false, _) => met.jet[0] < 0.0,
        (true, Side::At) => closed(between.relation, before),
        (true, Side::After) => met.leads_down().unwrap_or(closed(between.relation, before)),
    }
}

/// How something smooth lies to a level.
struct Met {
    jet: [f64; 3],
    rounding: [f64; 3],
    is_near: bool,
}

impl Met {
    fn new(point: &mut dyn Point, atom: &Atom, own: &[f64], level: f64, resolution: f64) -> Self {
        let (jet, rounding) = (point.jet(atom, own), point.rounding(atom, own));
        let distance = (jet[0] - level).abs();
        // Beside a pole neither the rate nor a bound of rounding says how near it is.
        let cap = 1e-3 * (1.0 + distance);
        let band = (jet[1].abs() * resolution).min(cap).max(rounding[0].min(cap));
        Self { jet, rounding, is_near: distance <= band }
    }

    /// Where the first of two rates that is not zero within rounding leads.
    fn leads_down(&self) -> Option<bool> {
        let order = (1..3).find(|&order| self.jet[order].abs() > self.rounding[order])?;
        Some(self.jet[order] < 0.0)
    }
}

/// A comparison that jumps, with its agents.
pub struct Jumping<'a, 'p> {
    /// The agents.
    pub agents: &'a Agents<'p>,
    /// The comparison.
    pub atom: &'a Atom,
    /// Where it jumps.
    pub jumps: &'a Jumps,
    /// Its agents.
    pub slots: &'a Slots,
    /// Its aggregates.
    pub folds: &'a [Folded<'a>],
    /// Scratch.
    pub rows: &'a mut CurveRows,
    /// Ends the search.
    pub interrupt: &'a AtomicBool,
    /// The most pieces of one search, and the most stretches between surfaces.
    pub pieces_max: u32,
}

/// A surface that is met next.
#[derive(Clone, Copy)]
struct Next {
    flip: Flip,
    column: usize,
    lock: f64,
}

/// A surface was searched in too many pieces.
struct GivenUp;

impl<'p> Jumping<'_, 'p> {
    /// The first change in (from, to], or at `from` where the boundary decides so; and if it is at a surface, the truths there.
    pub fn first_change(&mut self, from: f64, to: f64, mut known: Known) -> (Search, Option<Leap>) {
        let mut s = from;
        // At the joint of two steps what will be met soon has not been met; just after an instant what was met with it has been.
        let resolution = if known.settled { time_resolution(s) } else { 0.0 };
        let mut own = self.own(s, Side::After, resolution);
        if known.joins
            && self.own(s - 2.0 * time_resolution(s), Side::After, 0.0) != own
            && let Some(leap) = self.change_at(s, known.truth)
        {
            // The surface is where one search ended and the next begins.
            return (Search::Flip(Flip::at(s)), Some(leap));
        }
        let mut at_once = 0;
        for _ in 0..self.pieces_max {
            if self.interrupt.load(Ordering::Relaxed) {
                return (Search::Until(s), None);
            }
            if self.stays_clear(s, to, &known) {
                return (Search::None, None);
            }
            let Ok(next) = self.next_surface(&own, s, to) else { return (Search::Undecided, None) };
            if let Some(next) = next.filter(|next| next.flip.time <= s) {
                // It leads there at once, though its first two rates did not say so.
                own[next.column] = next.lock;
                at_once += 1;
                if at_once > 2 * self.jumps.surfaces.len() {
                    return (Search::Undecided, None);
                }
                continue;
            }
            at_once = 0;
            let end = next.map_or(to, |next| next.flip.time);
            let reach = if next.is_some() { 0.0 } else { known.reach };
            let pieces_max = self.pieces_max;
            let jumps = self.jumps;
            let interrupt = self.interrupt;
            let mut curve = self.curve(&jumps.between, &own).with_interrupt(interrupt);
            let search = first_flip(&mut curve, s, end, Known { reach, ..known }, pieces_max);
            // What changes as a surface is met is told by both of its sides, not by g going on beyond it.
            let is_at_end = matches!(search, Search::Flip(flip) if flip.time >= end - time_resolution(end));
            let near = match next {
                Some(next) => next.flip.near,
                None if is_at_end && self.meets_soon(&own, end) => end,
                None => return (search, None),
            };
            match search {
                Search::None | Search::Along => {}
                Search::Flip(_) if is_at_end => {}
                Search::Flip(_) | Search::Until(_) | Search::Undecided => return (search, None),
            }
            if let Some(leap) = self.change_at(end, known.truth) {
                return (Search::Flip(Flip { time: end, near, undecided: false }), Some(leap));
            }
            if end >= to {
                return (Search::None, None);
            }
            s = end;
            own = self.own(s, Side::After, time_resolution(s));
            known = Known { slack: 0.0, settled: true, grazed: false, joins: false, ..known };
        }
        (Search::Until(s), None)
    }

    /// Whether a surface is met at t or within the resolution of time after it.
    fn meets_soon(&mut self, own: &[f64], t: f64) -> bool {
        self.own(t, Side::After, time_resolution(t)) != own
    }

    /// The truths at a surface that is met at t, if one of them is another than that before it.
    fn change_at(&mut self, t: f64, before: bool) -> Option<Leap> {
        let leap = self.leap(t, before);
        let is_crossing = self.atom.relation == Relation::Crossing;
        (leap.after != before || !is_crossing && leap.at != before).then_some(leap)
    }

    /// The truths at a surface that is met at t.
    fn leap(&mut self, t: f64, before: bool) -> Leap {
        let (jumps, resolution) = (self.jumps, time_resolution(t));
        let [at, after] = [Side::At, Side::After].map(|side| {
            let own = self.own(t, side, resolution);
            truth_of(&mut Along { jumping: self, t }, &jumps.between, &own, side, resolution, before)
        });
        Leap { at, after }
    }

    fn own(&mut self, t: f64, side: Side, resolution: f64) -> Vec<f64> {
        let (agents, jumps) = (self.agents, self.jumps);
        let aux = &agents.agents[self.slots[0]].aux;
        own_columns(&mut Along { jumping: self, t }, jumps, aux, side, resolution)
    }

    fn curve<'s>(&'s mut self, atom: &'s Atom, own: &'s [f64]) -> AtomCurve<'s, 'p> {
        AtomCurve::new(self.agents, atom, self.slots, self.folds, self.rows).with_own(own)
    }

    /// Whether g, with all its jumps, is bounded away from zero.
    fn stays_clear(&mut self, s: f64, e: f64, known: &Known) -> bool {
        let mut curve = AtomCurve::new(self.agents, self.atom, self.slots, self.folds, self.rows);
        let bound = curve.jet_range(s, e)[0];
        if known.truth { bound.hi < 0.0 } else { bound.lo > 0.0 }
    }

    /// The surface that is met first in [s, e].
    fn next_surface(&mut self, own: &[f64], s: f64, e: f64) -> Result<Option<Next>, GivenUp> {
        let jumps = self.jumps;
        let mut first: Option<Next> = None;
        for (k, kind) in jumps.surfaces.iter().enumerate() {
            let column = jumps.first + k;
            let lock = own[column];
            let changes = match kind {
                KinkKind::Branch(atom) => [Some((atom, lock != 0.0, 1.0 - lock)), None],
                KinkKind::Integer { below, above } => {
                    [Some((below, false, lock - 1.0)), Some((above, false, lock + 1.0))]
                }
            };
            for (atom, truth, lock) in changes.into_iter().flatten() {
                let until = first.map_or(e, |first| first.flip.time);
                if let Some(flip) = self.meets(atom, truth, own, s, until)?
                    && first.is_none_or(|first| flip.time < first.flip.time)
                {
                    first = Some(Next { flip, column, lock });
                }
            }
        }
        Ok(first)
    }

    /// When a surface is met in [s, e].
    fn meets(
        &mut self,
        atom: &Atom,
        truth: bool,
        own: &[f64],
        s: f64,
        e: f64,
    ) -> Result<Option<Flip>, GivenUp> {
        let closed = atom.relation == Relation::NonPositive;
        let known = Known {
            truth,
            closed,
            slack: 0.0,
            settled: true,
            grazed: true,
            joins: false,
            reach: 2.0 * ulp(e),
        };
        let (mut from, pieces_max) = (s, self.pieces_max);
        let mut curve = self.curve(atom, own);
        loop {
            match first_flip(&mut curve, from, e, known, pieces_max) {
                Search::None => return Ok(None),
                // A surface that holds where it is zero has been reached.
                Search::Along => return Ok(known.touching().then(|| Flip::touch(from))),
                Search::Undecided => return Err(GivenUp),
                Search::Flip(flip) => return Ok(Some(flip)),
                Search::Until(reached) => from = reached,
            }
        }
    }
}

/// A point of the trajectories.
struct Along<'j, 'a, 'p> {
    jumping: &'j mut Jumping<'a, 'p>,
    t: f64,
}

impl Point for Along<'_, '_, '_> {
    fn jet(&mut self, atom: &Atom, own: &[f64]) -> [f64; 3] {
        let t = self.t;
        self.jumping.curve(atom, own).jet(t)
    }

    fn rounding(&mut self, atom: &Atom, own: &[f64]) -> [f64; 3] {
        let t = self.t;
        self.jumping.curve(atom, own).jet_range(t, t).map(width)
    }
}

/// What can be told of the size of rounding from a bound of a point.
pub fn width(bound: Interval) -> f64 {
    let width = bound.hi - bound.lo;
    if width.is_finite() { width } else { 0.0 }
}
