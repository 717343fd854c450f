//! What discrete variables can hold in any run: what they start with, and what some action gives them.
//!
//! Found by going round all actions until nothing grows. What still grows after a few rounds counts as unbounded to
//! that side.

use crate::calculus::bounds::{Bounds, REAL};
use crate::calculus::reader::Reader;
use crate::calculus::system::{ActionList, ActionStep, Entry, FunctionId, Source, System, VarRef};
use crate::math::Interval;
use crate::math::draw::Distribution;

/// After so many rounds a variable that still grows is unbounded to the side on which it does.
const ROUNDS_MAX: usize = 4;

/// The bounds that hold in every run of this system, with whatever parameters its agents have.
pub fn bounds(system: &System) -> Bounds {
    grown(system, Bounds::at_start(system))
}

/// The bounds that hold in every run with the agents that there are at t = 0, and with those that they create.
pub fn bounds_of_population(system: &System) -> Bounds {
    let mut bounds = Bounds::of_population(system);
    add_births(system, &mut bounds);
    grown(system, bounds)
}

/// Adds what agents that are created can start with. What they are given may depend on discrete variables, and on parameters
/// of those who were created before: it is bounded by what these can hold in any run.
fn add_births(system: &System, bounds: &mut Bounds) {
    let any = grown(system, Bounds::at_start(system));
    let mut given: Vec<(usize, usize, Interval)> = Vec::new();
    for list in system.action_lists() {
        let mut reader = Reader::new(system, &any, &list.frame);
        for birth in list.births() {
            for (variable, source) in &birth.given {
                given.extend(started(system, &mut reader, birth.ty, *variable, source));
            }
        }
    }
    let born = given_births(system);
    for (number, ty) in system.types.iter().enumerate().filter(|(number, _)| born[*number]) {
        let mut reader = Reader::new(system, &any, &ty.initials.frame);
        for (variable, source) in &ty.initials.values {
            given.extend(started(system, &mut reader, number, *variable, source));
        }
    }
    for (ty, column, interval) in given {
        let known = &mut bounds.aux[ty][column];
        *known = known.hull(interval);
    }
}

/// By type, whether agents of it are created.
fn given_births(system: &System) -> Vec<bool> {
    let mut born = vec![false; system.types.len()];
    system.action_lists().flat_map(|list| list.births()).for_each(|birth| born[birth.ty] = true);
    born
}

/// The column of a parameter or a discrete variable, and what it can start with.
fn started(
    system: &System,
    reader: &mut Reader,
    ty: usize,
    variable: VarRef,
    source: &Source,
) -> Option<(usize, usize, Interval)> {
    let layout = &system.types[ty].layout;
    let column = match variable {
        VarRef::Param(k) => layout.param(k),
        VarRef::Discrete(k) => layout.discrete(k),
        VarRef::State(_) | VarRef::Link(_) | VarRef::Let(_) => return None,
    };
    let mut bound = |k: usize| {
        let form = reader.function(source.functions()[k]);
        reader.forms.interval(form)
    };
    let interval = match source {
        Source::Number(_) => bound(0),
        Source::Draw { distribution: Distribution::Uniform, .. } => bound(0).hull(bound(1)),
        Source::Draw { distribution: Distribution::Normal, .. } => REAL,
        Source::Draw { distribution: Distribution::Exponential, .. } => Interval { lo: 0.0, hi: REAL.hi },
    };
    Some((ty, column, interval.intersect(REAL).unwrap_or(REAL)))
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
    if !list.writes.iter().any(|(_, target)| matches!(target, Entry::Aux(_))) {
        return;
    }
    let mut given: Vec<(usize, usize, Interval)> = Vec::new();
    let mut reader = Reader::new(system, bounds, &list.frame);
    each_assignment(&list.steps, &mut |slot, target, value| {
        if let (Entry::Aux(column), Some(ty)) = (target, types.get(slot)) {
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
fn each_assignment(steps: &[ActionStep], each: &mut dyn FnMut(usize, Entry, Given)) {
    for step in steps {
        match step {
            ActionStep::Assign { slot, target, value, .. } => each(*slot, *target, Given::Value(*value)),
            ActionStep::Draw { slot, target, .. } => each(*slot, *target, Given::Draw),
            ActionStep::If { then, otherwise, .. } => {
                each_assignment(then, each);
                each_assignment(otherwise, each);
            }
            ActionStep::Emit { .. } | ActionStep::Goto { .. } | ActionStep::Stop { .. } => {}
            ActionStep::Create(_) | ActionStep::Destroy { .. } => {}
        }
    }
}
