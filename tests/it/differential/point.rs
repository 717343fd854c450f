//! Does a guard hang on a single point of a step? Then rounding decides what happens, and the model does not count.
//!
//! A point is a zero of a comparison, or where it comes near zero and turns back. A guard hangs on it if it is the same on
//! both sides, and another with the comparisons that are near zero there all true, or all false: `x >= 0 and x <= 0`,
//! or a graze.

use hyc::model::ir::{ExprId, Model};

use super::evaluate::{Literal, Scope};
use super::world::World;

/// A margin as small as this may be zero.
const NEAR: f64 = 1e-7;
/// A margin that comes near zero within a part of a step is not larger than this there.
const MAYBE_NEAR: f64 = 1e-2;
/// How far before and after a point its sides are looked at, s; more than what is near takes at usual rates.
const APART: f64 = 1e-6;
/// Into how many parts a step is divided in search of points.
const PARTS: u32 = 4;

/// Whose guard it is.
pub struct Guard<'a> {
    /// The model.
    pub model: &'a Model,
    /// See [`Scope::agents`].
    pub agents: [usize; 2],
    /// See [`Scope::pair`].
    pub pair: bool,
    /// The condition.
    pub condition: ExprId,
}

impl Guard<'_> {
    fn scope<'s>(&'s self, world: &'s World) -> Scope<'s> {
        Scope::new(self.model, world, self.agents, self.pair)
    }

    /// Whether it hangs on a point between `start` and the time `end`.
    pub fn hangs_on_a_point(&self, start: &World, end: f64) -> bool {
        let mut literals = Vec::new();
        self.scope(start).literals(self.condition, false, &mut literals);
        literals.iter().any(|(literal, _)| {
            let margin = |time: f64| self.scope(&start.flow(self.model, time)).margin(literal).0;
            let points = points(start.time + 2.0 * APART, end, &margin);
            points.into_iter().any(|point| self.hangs_on(start, point, &literals))
        })
    }

    fn hangs_on(&self, start: &World, point: f64, literals: &[(Literal, bool)]) -> bool {
        let truth = |time: f64| self.scope(&start.flow(self.model, time)).truth(self.condition);
        let here = start.flow(self.model, point);
        let is_near = |literal: &Literal| self.scope(&here).margin(literal).0.abs() <= NEAR;
        let assumed = |holds: bool| {
            let near = literals.iter().filter(|(literal, _)| is_near(literal));
            let decided: Vec<(Literal, bool)> =
                near.map(|(literal, negated)| (literal.clone(), holds != *negated)).collect();
            let mut scope = self.scope(&here);
            scope.decided = &decided;
            scope.truth(self.condition)
        };
        let before = truth(point - APART);
        before == truth(point + APART) && (assumed(true) != before || assumed(false) != before)
    }
}

/// Zeros of a function, and where it comes near zero and turns back.
fn points(from: f64, to: f64, margin: &dyn Fn(f64) -> f64) -> Vec<f64> {
    let times: Vec<f64> = (0..=PARTS).map(|k| from + (to - from) * f64::from(k) / f64::from(PARTS)).collect();
    let margins: Vec<f64> = times.iter().map(|time| margin(*time)).collect();
    let mut found = Vec::new();
    if from >= to {
        return found;
    }
    for k in 1..times.len() {
        if (margins[k - 1] > 0.0) != (margins[k] > 0.0) {
            found.push(zero(times[k - 1], times[k], margin));
        }
    }
    for k in 0..times.len() {
        let (before, after) = (k.saturating_sub(1), (k + 1).min(times.len() - 1));
        let lowest = margins[k].abs() <= margins[before].abs().min(margins[after].abs());
        if lowest && margins[k].abs() <= MAYBE_NEAR {
            let turns = nearest(times[before], times[after], margin);
            found.extend(Some(turns).filter(|turns| margin(*turns).abs() <= NEAR));
        }
    }
    found
}

/// A zero between two times at which the signs differ.
fn zero(mut before: f64, mut after: f64, margin: &dyn Fn(f64) -> f64) -> f64 {
    let positive = margin(before) > 0.0;
    while after - before > 1e-13 * after.max(1.0) {
        let middle = 0.5 * (before + after);
        if (margin(middle) > 0.0) == positive { before = middle } else { after = middle }
    }
    after
}

/// Where a function with one turn is nearest to zero, by thirds.
fn nearest(mut before: f64, mut after: f64, margin: &dyn Fn(f64) -> f64) -> f64 {
    while after - before > 1e-9 {
        let [a, b] = [1.0, 2.0].map(|k| before + (after - before) * k / 3.0);
        if margin(a).abs() < margin(b).abs() { after = b } else { before = a }
    }
    0.5 * (before + after)
}
