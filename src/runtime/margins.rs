//! Margins of conditions: by how much a condition of a property holds, at a time and over a stretch of time.
//!
//! A comparison has its margin (minus its g), `and` and `forall` the least of theirs, `or` and `exists` the greatest; what is no
//! comparison of numbers holds, or fails, by an infinite margin. (G. E. Fainekos and G. J. Pappas, Theoretical Computer
//! Science 410, 2009.) Between events a margin is a function of the agents' dense output; its bounds over a stretch
//! come from bounds of g, g' and g'' there.

use crate::codegen::program::{Atom, Condition, Guard, Quantified, Relation};
use crate::math::Interval;
use crate::runtime::detect::{AtomCurve, CurveRows};
use crate::runtime::guards::{Guards, allowed};
use crate::runtime::population::{ABSENT, Agents, Slots};
use crate::runtime::present::Present;
use crate::runtime::robustness::{Extreme, Robustness};
use crate::runtime::solve::roots::Curve;
use crate::runtime::solve::time_resolution;
use crate::runtime::truth::{self, Side, Truths};

/// When a margin is asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum When {
    /// At a time that the agents' last segments cover.
    Along(f64),
    /// At the present instant, after its micro-steps.
    Now,
}

/// A margin at a time.
#[derive(Clone, Debug)]
pub struct Spot {
    /// The margin.
    pub value: f64,
    /// Its rate.
    pub slope: f64,
    /// Whether a margin of zero is enough: the comparison that decides is `<=` or `>=`.
    pub closed: bool,
    /// The number of the comparison that decides; none if none does.
    atom: Option<usize>,
    /// The slots with whoever quantifiers bind there.
    pub slots: Slots,
}

/// A margin over a stretch of time.
#[derive(Clone, Copy, Debug)]
pub struct Bound {
    /// None is less.
    pub least: Robustness,
    /// None is greater.
    pub greatest: Robustness,
    /// Contains its rates, of all comparisons that may decide.
    pub slope: Interval,
    /// Whether a comparison may decide for which zero is not enough, and whether one may for which it is.
    pub sides: [bool; 2],
}

impl Bound {
    /// Whether it is closed where it is zero, if this is the same all along; it is said also where it is nowhere zero.
    pub fn closed(&self) -> Option<bool> {
        let [open, closed] = self.sides;
        if open != closed {
            return Some(closed);
        }
        let (least, greatest) = (self.least, self.greatest);
        if least.value > 0.0 || least.value == 0.0 && least.closed {
            return Some(true);
        }
        (greatest.value < 0.0 || greatest.value == 0.0 && !greatest.closed).then_some(false)
    }
}

/// The margins of one condition.
pub struct Margins<'a, 'p> {
    /// The agents.
    pub agents: &'a Agents<'p>,
    /// The guards.
    pub guards: &'a Guards<'p>,
    /// Rows at the present instant.
    pub present: &'a mut Present,
    /// Scratch.
    pub rows: &'a mut CurveRows,
    /// The instance of the condition.
    pub instance: u32,
    /// The condition.
    pub guard: &'p Guard,
    /// If it is a quantifier: the only agent that this is to bind; none: all of its range.
    pub only: Option<usize>,
}

impl<'p> Margins<'_, 'p> {
    fn slots(&self) -> Slots {
        self.guards.slots(self.agents, self.instance)
    }

    /// The margin at a time, and who decides it.
    pub fn at(&mut self, when: When) -> Spot {
        let guard = self.guard;
        let slots = self.slots();
        self.spot(&guard.condition, &slots, when)
    }

    /// Up to when the ways of the only agent, and of those to whom links lead from there, go on as they are known at `t`.
    pub fn known_from(&self, t: f64) -> Option<f64> {
        let (Condition::Forall(quantified) | Condition::Exists(quantified)) = &self.guard.condition else {
            return None;
        };
        let slots = self.bindings(quantified, &self.slots()).pop()?;
        let read = slots.into_iter().filter(|&agent| agent != ABSENT).map(|agent| &self.agents.agents[agent]);
        let ways = read.filter(|agent| !agent.states.is_empty()).map(|agent| &agent.segment);
        let mut until = f64::INFINITY;
        for way in ways {
            if way.start > t {
                return None;
            }
            until = until.min(way.end);
        }
        until.is_finite().then_some(until)
    }

    /// The margin over [s, e].
    pub fn over(&mut self, s: f64, e: f64) -> Bound {
        let guard = self.guard;
        let slots = self.slots();
        self.bound(&guard.condition, &slots, s, e)
    }

    /// How far from zero a margin may be and still count as zero: by rounding, and by the width to which times are known.
    fn slack(&mut self, spot: &Spot, when: When) -> f64 {
        let When::Along(t) = when else { return 0.0 };
        if spot.atom.is_none() { 0.0 } else { self.rounding(spot, t) + spot.slope.abs() * time_resolution(t) }
    }

    /// The rounding of a margin at a time.
    fn rounding(&mut self, spot: &Spot, t: f64) -> f64 {
        let Some(atom) = spot.atom else { return 0.0 };
        let atom = &self.guard.atoms[atom];
        let rounding = self.curve(atom, &spot.slots, |curve| curve.jet_range(t, t)[0].width());
        if rounding.is_finite() { rounding } else { 0.0 }
    }

    /// The rounding of the margin at a time, of whoever decides it there.
    pub fn rounding_at(&mut self, t: f64) -> f64 {
        let spot = self.at(When::Along(t));
        self.rounding(&spot, t)
    }

    /// The margin of a spot, with its slack.
    pub fn robustness(&mut self, spot: &Spot, when: When) -> Robustness {
        Robustness { value: spot.value, closed: spot.closed, slack: self.slack(spot, when) }
    }

    /// Whether a margin counts as zero.
    pub fn is_zero(&mut self, spot: &Spot, when: When) -> bool {
        spot.value == 0.0 || spot.value.is_finite() && spot.value.abs() <= self.slack(spot, when)
    }

    /// The names of the agents that quantifiers bind where a margin is decided, outermost first.
    pub fn bound_agents(&self, spot: &Spot) -> Vec<(String, String)> {
        let mut found = Vec::new();
        self.collect(&self.guard.condition, spot, &mut found);
        found
    }

    fn collect(&self, condition: &Condition, spot: &Spot, found: &mut Vec<(String, String)>) {
        match condition {
            Condition::Exists(quantified) | Condition::Forall(quantified) => {
                let frame = self.guards.definition(self.instance).frame;
                let agent = spot.slots[quantified.slot];
                if agent != ABSENT {
                    found.push((frame.slots[quantified.slot].name().to_string(), self.agents.name(agent)));
                }
                self.collect(&quantified.body, spot, found);
            }
            Condition::And(all) | Condition::Or(all) => {
                all.iter().for_each(|condition| self.collect(condition, spot, found));
            }
            Condition::Constant(_) | Condition::Discrete(_) | Condition::Atom(_) | Condition::Rising(..) => {}
        }
    }

    fn spot(&mut self, condition: &Condition, slots: &Slots, when: When) -> Spot {
        match condition {
            Condition::Constant(truth) => settled(*truth, slots),
            Condition::Discrete(_) | Condition::Rising(..) => {
                let truth = self.truths().part(self.instance, condition, &mut slots.clone());
                settled(truth, slots)
            }
            Condition::Atom(atom) => self.comparison(*atom, slots, when),
            Condition::And(all) => self.pick(Extreme::Least, all, slots, when),
            Condition::Or(all) => self.pick(Extreme::Greatest, all, slots, when),
            Condition::Forall(quantified) => self.pick_agent(Extreme::Least, quantified, slots, when),
            Condition::Exists(quantified) => self.pick_agent(Extreme::Greatest, quantified, slots, when),
        }
    }

    fn pick(&mut self, pick: Extreme, all: &[Condition], slots: &Slots, when: When) -> Spot {
        let mut best: Option<Spot> = None;
        for condition in all {
            let spot = self.spot(condition, slots, when);
            if best.as_ref().is_none_or(|best| self.is_preferred(pick, &spot, best, when)) {
                best = Some(spot);
            }
        }
        best.unwrap_or_else(|| settled(pick == Extreme::Least, slots))
    }

    fn pick_agent(&mut self, pick: Extreme, quantified: &Quantified, slots: &Slots, when: When) -> Spot {
        let mut best: Option<Spot> = None;
        for bound in self.bindings(quantified, slots) {
            let spot = self.spot(&quantified.body, &bound, when);
            if best.as_ref().is_none_or(|best| self.is_preferred(pick, &spot, best, when)) {
                best = Some(spot);
            }
        }
        best.unwrap_or_else(|| settled(pick == Extreme::Least, slots))
    }

    /// Whether a margin is preferred to another one of the same time.
    fn is_preferred(&mut self, pick: Extreme, spot: &Spot, to: &Spot, when: When) -> bool {
        if spot.closed != to.closed {
            let is_nearer = spot.value.abs() < to.value.abs();
            let (near, far) = if is_nearer { (spot, to) } else { (to, spot) };
            if self.is_zero(far, when) && self.is_zero(near, when) {
                return spot.closed == pick.prefers_closed();
            }
        }
        pick.prefers(spot.value, to.value)
    }

    /// Whether zero is enough for one comparison and not for another.
    pub fn is_mixed(&self) -> bool {
        let is_closed = |atom: &Atom| atom.relation == Relation::NonPositive;
        self.guard.atoms.iter().any(is_closed) && !self.guard.atoms.iter().all(is_closed)
    }

    /// The slots with each agent of a quantifier's range.
    fn bindings(&self, quantified: &Quantified, slots: &Slots) -> Vec<Slots> {
        let roots = self.guards.roots(self.instance);
        let frame = self.guards.definition(self.instance).frame;
        let bind = |agent: usize| {
            let mut bound = slots.clone();
            bound[quantified.slot] = agent;
            self.agents.follow_links(frame, &mut bound);
            bound
        };
        let range = match &self.only {
            Some(only) => std::slice::from_ref(only),
            None => &self.agents.of_type[quantified.ty],
        };
        range.iter().copied().filter(|&agent| allowed(quantified, &roots, agent)).map(bind).collect()
    }

    fn comparison(&mut self, number: usize, slots: &Slots, when: When) -> Spot {
        let atom = &self.guard.atoms[number];
        let [g, rate, _] = match when {
            When::Along(t) => self.curve(atom, slots, |curve| curve.jet(t)),
            When::Now => [self.now(atom, slots), 0.0, 0.0],
        };
        if g.is_nan() {
            // A comparison with an agent that is not there is false.
            return settled(false, slots);
        }
        let closed = atom.relation == Relation::NonPositive;
        Spot { value: -g, slope: -rate, closed, atom: Some(number), slots: slots.clone() }
    }

    fn now(&mut self, atom: &Atom, slots: &Slots) -> f64 {
        let kernel = self.agents.program.kernel(atom.value);
        let folds = self.truths().gather(self.instance, kernel, slots, Side::After);
        truth::evaluate(self.agents, self.present, kernel, slots, &folds)
    }

    fn curve<T>(&mut self, atom: &Atom, slots: &Slots, look: impl FnOnce(&mut AtomCurve<'_, '_>) -> T) -> T {
        let kernel = self.agents.program.kernel(atom.value);
        let folds = self.truths().gather(self.instance, kernel, slots, Side::After);
        look(&mut AtomCurve::new(self.agents, atom, slots, &folds, self.rows))
    }

    fn truths(&self) -> Truths<'_, 'p> {
        Truths { agents: self.agents, guards: self.guards, present: self.present }
    }

    fn bound(&mut self, condition: &Condition, slots: &Slots, s: f64, e: f64) -> Bound {
        match condition {
            Condition::Atom(atom) => self.comparison_bound(*atom, slots, s, e),
            Condition::And(all) => {
                let all = all.iter().map(|condition| self.bound(condition, slots, s, e)).collect::<Vec<_>>();
                together(Extreme::Least, &all)
            }
            Condition::Or(all) => {
                let all = all.iter().map(|condition| self.bound(condition, slots, s, e)).collect::<Vec<_>>();
                together(Extreme::Greatest, &all)
            }
            Condition::Forall(quantified) | Condition::Exists(quantified) => {
                let bindings = self.bindings(quantified, slots).into_iter();
                let all: Vec<Bound> =
                    bindings.map(|bound| self.bound(&quantified.body, &bound, s, e)).collect();
                let forall = matches!(condition, Condition::Forall(_));
                together(if forall { Extreme::Least } else { Extreme::Greatest }, &all)
            }
            Condition::Constant(_) | Condition::Discrete(_) | Condition::Rising(..) => {
                settled_bound(self.spot(condition, slots, When::Now).value > 0.0)
            }
        }
    }

    /// From the bounds of g, and from its value, rate and second rate in the middle with the bounds of its rates.
    fn comparison_bound(&mut self, number: usize, slots: &Slots, s: f64, e: f64) -> Bound {
        let atom = &self.guard.atoms[number];
        let middle = 0.5 * (s + e);
        let (jet, [g, rate, second]) =
            self.curve(atom, slots, |curve| (curve.jet(middle), curve.jet_range(s, e)));
        if jet[0].is_nan() && atom.slots.iter().any(|&slot| slots[slot] == ABSENT) {
            return settled_bound(false);
        }
        let r = 0.5 * (e - s);
        let rounding = 4.0 * f64::EPSILON * jet[0].abs();
        let mut value = g;
        let size = |bound: Interval| bound.lo.abs().max(bound.hi.abs());
        for room in [size(rate) * r, jet[1].abs() * r + 0.5 * size(second) * r * r] {
            let room = room + rounding;
            if room.is_finite() && jet[0].is_finite() {
                value = Interval { lo: value.lo.max(jet[0] - room), hi: value.hi.min(jet[0] + room) };
            }
        }
        if value.lo > value.hi {
            value = g;
        }
        let is_clear = value.lo > 0.0 || value.hi < 0.0;
        if is_clear && g.contains_zero() && self.is_mixed() {
            // What counts as zero does so in the bounds, too.
            let width = self.curve(atom, slots, |curve| curve.jet_range(middle, middle)[0].width());
            let slack = width + size(rate) * time_resolution(e);
            if slack.is_finite() && value.lo.max(-value.hi) <= slack {
                value = Interval { lo: value.lo.min(0.0), hi: value.hi.max(0.0) };
            }
        }
        let closed = atom.relation == Relation::NonPositive;
        let [least, greatest] = [-value.hi, -value.lo].map(|value| Robustness::exact(value, closed));
        Bound { least, greatest, slope: negative(rate), sides: [!closed, closed] }
    }
}

fn negative(x: Interval) -> Interval {
    Interval { lo: -x.hi, hi: -x.lo }
}

/// The margin of what is no comparison.
fn settled(truth: bool, slots: &Slots) -> Spot {
    let value = if truth { f64::INFINITY } else { f64::NEG_INFINITY };
    Spot { value, slope: 0.0, closed: true, atom: None, slots: slots.clone() }
}

/// Its bound.
fn settled_bound(truth: bool) -> Bound {
    let value = Robustness::exact(if truth { f64::INFINITY } else { f64::NEG_INFINITY }, true);
    Bound { least: value, greatest: value, slope: Interval::ZERO, sides: [false, true] }
}

/// The bound of the least, or greatest, of several.
fn together(pick: Extreme, all: &[Bound]) -> Bound {
    let neutral = Robustness::exact(pick.neutral(), true);
    let of_all = |end: fn(&Bound) -> Robustness| all.iter().map(end).fold(neutral, |a, b| pick.of(a, b));
    let (least, greatest) = (of_all(|bound| bound.least), of_all(|bound| bound.greatest));
    let may_decide =
        |bound: &&Bound| bound.least.value <= greatest.value && bound.greatest.value >= least.value;
    let decide = all.iter().filter(may_decide);
    let slopes = decide.clone().map(|bound| bound.slope);
    let slope =
        slopes.reduce(|hull, slope| Interval { lo: hull.lo.min(slope.lo), hi: hull.hi.max(slope.hi) });
    let sides = [0, 1].map(|side| decide.clone().any(|bound| bound.sides[side]));
    Bound { least, greatest, slope: slope.unwrap_or(Interval::ZERO), sides }
}
