//! What discrete variables can hold in any run: what they start with, and what some action gives them.
//!
//! Found by going round all actions until nothing grows. What still grows after a few rounds counts as unbounded to
//! that side.

use crate::calculus::bounds::{Bounds, REAL};
use crate::calculus::reader::Reader;
use crate::calculus::system::{ActionList, ActionStep, FunctionId, System, Target};
use crate::math::Interval;

/// After so many rounds a variable that still grows is unbounded to the side on which it does.
const ROUNDS_MAX: usize = 4;

/// The bounds that hold in every run of this system, with whatever parameters its agents have.
pub fn bounds(system: &System) -> Bounds {
    grown(system, Bounds::at_start(system))
}

/// The bounds that hold in every run with the agents that there are at t = 0, and no others: none are created later.
pub fn bounds_of_population(system: &System) -> Bounds {
    grown(system, Bounds::of_population(system))
}

/// What holds from the start, widened by all that actions can give.
fn grown(system: &System, mut bounds: Bounds) -> Bounds {
    for round in 0.. {
        let before = bounds.aux.clone();
        go_round(system, &mut bounds);
        if bounds.aux == before {
            break;
        }
        if round >= ROUNDS_MAX {
            let columns = bounds.aux.iter_mut().flatten().zip(before.iter().flatten());
            columns.for_each(|(now, before)| *now = widened(*now, *before));
        }
    }
    bounds
}

/// As far as any number goes to the side on which it has grown.
fn widened(now: Interval, before: Interval) -> Interval {
    let lo = if now.lo < before.lo { REAL.lo } else { now.lo };
    let hi = if now.hi > before.hi { REAL.hi } else { now.hi };
    Interval { lo, hi }
}

/// Adds what every action can give.
fn go_round(system: &System, bounds: &mut Bounds) {
    for (number, ty) in system.types.iter().enumerate() {
        let modes = ty.modes.iter().flat_map(|mode| [&mode.entry, &mode.exit]);
        let lists = modes.chain(ty.transitions.iter().map(|transition| &transition.actions));
        lists.for_each(|list| add(system, bounds, list, &[number]));
    }
    for interaction in &system.interactions {
        for pair in &interaction.transitions {
            add(system, bounds, &pair.transition.actions, &interaction.types);
        }
    }
}

fn add(system: &System, bounds: &mut Bounds, list: &ActionList, types: &[usize]) {
    if !list.writes.iter().any(|(_, target)| matches!(target, Target::Aux(_))) {
        return;
    }
    let mut given: Vec<(usize, usize, Interval)> = Vec::new();
    let mut reader = Reader::new(system, bounds, &list.frame);
    each_assignment(&list.steps, &mut |slot, target, value| {
        if let (Target::Aux(column), Some(ty)) = (target, types.get(slot)) {
            let interval = match value {
                Given::Value(value) => {
                    let value = reader.function(value);
                    reader.forms.interval(value)
                }
                Given::Draw => REAL,
            };
            given.push((*ty, column, interval));
        }
    });
    for (ty, column, interval) in given {
        let known = &mut bounds.aux[ty][column];
        // An action that gives no finite number ends the run.
        *known = known.hull(interval.intersect(REAL).unwrap_or(REAL));
    }
}

/// What a column is given.
enum Given {
    /// One output.
    Value(FunctionId),
    /// Whatever is drawn.
    Draw,
}

/// Calls `each` with slot, column and value of every assignment, those in branches included.
fn each_assignment(steps: &[ActionStep], each: &mut dyn FnMut(usize, Target, Given)) {
    for step in steps {
        match step {
            ActionStep::Assign { slot, target, value, .. } => each(*slot, *target, Given::Value(*value)),
            ActionStep::Draw { slot, target, .. } => each(*slot, *target, Given::Draw),
            ActionStep::If { then, otherwise, .. } => {
                each_assignment(then, each);
                each_assignment(otherwise, each);
            }
            ActionStep::Emit { .. } | ActionStep::Goto { .. } | ActionStep::Stop { .. } => {}
        }
    }
}
