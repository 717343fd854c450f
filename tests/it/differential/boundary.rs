//! Comparisons on their boundary (rule 3): what the flow's first two rates say of them when a guard has fired or been armed.

use hyc::model::ir::ExprId;

use super::evaluate::{Literal, Scope};
use super::world::World;

/// A margin as small as this is on the boundary: models whose events depend on it are not robust and do not count.
const NEAR: f64 = 1e-9;
/// Rates below this are zero.
const STILL: f64 = 1e-6;
/// The distance in time of numeric rates, s.
const APART: f64 = 1e-4;

/// What has been decided of a comparison.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Verdict {
    /// Moving in: true in this instant.
    True,
    /// Moving out: false until it has really been false, or its rate points into the true region.
    Held,
    /// Staying: this, while it stays.
    Stays(bool),
}

/// The comparisons of one guard that are decided.
#[derive(Clone, Debug, Default)]
pub struct Boundary(Vec<(Literal, bool, Verdict)>);

/// Where a comparison is going.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Course {
    In,
    Out,
    Along,
}

/// The margin of a literal, positive where it is true, and whether it is true at zero.
fn margin(scope: &mut Scope<'_>, literal: &Literal, negated: bool) -> (f64, bool) {
    let (margin, closed) = scope.margin(literal);
    if negated { (-margin, !closed) } else { (margin, closed) }
}

/// The first of the first two rates that is not zero decides.
fn course(scope: &Scope<'_>, world: &World, literal: &Literal, negated: bool) -> Course {
    let at = |time: f64| {
        let there = world.flow(scope.model, time);
        let mut scope = Scope::new(scope.model, &there, scope.agents, scope.pair);
        margin(&mut scope, literal, negated).0
    };
    let mut here = Scope::new(scope.model, world, scope.agents, scope.pair);
    let here = margin(&mut here, literal, negated).0;
    let (before, after) = (at(world.time - APART), at(world.time + APART));
    let rates = [(after - before) / (2.0 * APART), (after - 2.0 * here + before) / (APART * APART)];
    match rates.iter().find(|rate| rate.abs() > STILL) {
        Some(rate) if *rate > 0.0 => Course::In,
        Some(_) => Course::Out,
        None => Course::Along,
    }
}

impl Boundary {
    /// Decides the comparisons of a guard that has just fired or been armed by a transition.
    pub fn settle(mut scope: Scope<'_>, world: &World, guard: ExprId) -> Self {
        let mut literals = Vec::new();
        scope.literals(guard, false, &mut literals);
        let mut decided = Vec::new();
        for (literal, negated) in literals {
            let (margin, closed) = margin(&mut scope, &literal, negated);
            if margin.abs() <= NEAR {
                let verdict = match course(&scope, world, &literal, negated) {
                    Course::In => Verdict::True,
                    Course::Out => Verdict::Held,
                    Course::Along => Verdict::Stays(closed),
                };
                decided.push((literal, negated, verdict));
            }
        }
        Self(decided)
    }

    /// The decided comparisons with the truth of the comparison as it stands, without the `not` around it.
    pub fn decided(&self, scope: &mut Scope<'_>, world: &World) -> Vec<(Literal, bool)> {
        let still = self
            .0
            .iter()
            .filter(|(literal, negated, verdict)| stands(scope, world, literal, *negated, *verdict));
        let truth = |verdict: Verdict| match verdict {
            Verdict::True => true,
            Verdict::Held => false,
            Verdict::Stays(truth) => truth,
        };
        still.map(|(literal, negated, verdict)| (literal.clone(), truth(*verdict) != *negated)).collect()
    }

    /// Whether a comparison of the guard is on its boundary without having been decided.
    pub fn is_left_open(&self, mut scope: Scope<'_>, guard: ExprId) -> bool {
        let mut literals = Vec::new();
        scope.literals(guard, false, &mut literals);
        literals.iter().any(|(literal, negated)| {
            let settled = self.0.iter().any(|(decided, ..)| decided == literal);
            let near = margin(&mut scope, literal, *negated).0.abs() <= NEAR;
            !settled && near
        })
    }

    /// What is left of it after some time.
    pub fn later(self, mut scope: Scope<'_>, world: &World) -> Self {
        let stand = |(literal, negated, verdict): &(Literal, bool, Verdict)| {
            *verdict != Verdict::True && stands(&mut scope, world, literal, *negated, *verdict)
        };
        Self(self.0.into_iter().filter(stand).collect())
    }
}

/// Whether a verdict still counts.
fn stands(scope: &mut Scope<'_>, world: &World, literal: &Literal, negated: bool, verdict: Verdict) -> bool {
    let (margin, closed) = margin(scope, literal, negated);
    let near = margin.abs() <= NEAR;
    let really_false = if closed { margin < 0.0 } else { margin <= 0.0 };
    match verdict {
        Verdict::True | Verdict::Stays(_) => near,
        Verdict::Held => near && !really_false && course(scope, world, literal, negated) != Course::In,
    }
}
