//! Comparisons on their boundary (rule 3): what the flow's first two rates say of them when a guard has fired or been armed.

use hyc::model::ir::ExprId;

use super::evaluate::{Literal, Scope};
use super::world::World;

/// Rates below this are zero.
const STILL: f64 = 1e-6;
/// The distance in time of numeric rates, s.
const APART: f64 = 1e-4;

/// What has been decided of a comparison.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Verdict {
    /// Moving in, and true at the boundary: true in this instant.
    True,
    /// Moving in: true while it does.
    Enters,
    /// Moving out, or staying and false at the boundary: false until it has really been false, or its rate points into the true region.
    Held,
    /// Staying, and true at the boundary: true while it stays.
    Stays,
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
            if margin.abs() <= world.near {
                let verdict = match course(&scope, world, &literal, negated) {
                    Course::In if closed => Verdict::True,
                    Course::In => Verdict::Enters,
                    Course::Along if closed => Verdict::Stays,
                    Course::Along | Course::Out => Verdict::Held,
                };
                decided.push((literal, negated, verdict));
            }
        }
        Self(decided)
    }

    /// The decided comparisons with the truth of the comparison as it stands, without the `not` around it.
    pub fn decided(&self, scope: &mut Scope<'_>, world: &World) -> Vec<(Literal, bool)> {
        let truth = |(literal, negated, verdict): &(Literal, bool, Verdict)| {
            if !is_near(scope, literal, *negated) {
                return None;
            }
            let truth = match verdict {
                Verdict::True | Verdict::Stays => true,
                Verdict::Held | Verdict::Enters => course(scope, world, literal, *negated) == Course::In,
            };
            Some((literal.clone(), truth != *negated))
        };
        self.0.iter().filter_map(truth).collect()
    }

    /// Whether a comparison of the guard is on its boundary without having been decided.
    pub fn is_left_open(&self, mut scope: Scope<'_>, guard: ExprId) -> bool {
        let mut literals = Vec::new();
        scope.literals(guard, false, &mut literals);
        literals.iter().any(|(literal, negated)| {
            let settled = self.0.iter().any(|(decided, ..)| decided == literal);
            let near = margin(&mut scope, literal, *negated).0.abs() <= scope.world.near;
            !settled && near
        })
    }

    /// What is left of it after a write: what has been written off its boundary has really been true or false.
    pub fn while_near(self, mut scope: Scope<'_>) -> Self {
        let near = |(literal, negated, _): &(Literal, bool, Verdict)| is_near(&mut scope, literal, *negated);
        Self(self.0.into_iter().filter(near).collect())
    }

    /// What is left of it after some time.
    pub fn later(self, mut scope: Scope<'_>, world: &World) -> Self {
        let stands = |(literal, negated, verdict): &(Literal, bool, Verdict)| {
            let near = is_near(&mut scope, literal, *negated);
            match verdict {
                Verdict::True | Verdict::Enters => false,
                Verdict::Stays => near,
                Verdict::Held => near && course(&scope, world, literal, *negated) != Course::In,
            }
        };
        Self(self.0.into_iter().filter(stands).collect())
    }

    /// What is true from the start on, where nothing is held: what is on its boundary and moves in.
    pub fn fresh(self) -> Self {
        Self(
            self.0
                .into_iter()
                .filter(|(.., verdict)| matches!(verdict, Verdict::True | Verdict::Enters))
                .collect(),
        )
    }
}

fn is_near(scope: &mut Scope<'_>, literal: &Literal, negated: bool) -> bool {
    margin(scope, literal, negated).0.abs() <= scope.world.near
}
