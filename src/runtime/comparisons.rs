//! What the comparisons of a guard compare, with numbers: for messages and explanations.
//!
//! A guard over quantifiers may have thousands of comparisons; a few are enough to see why it holds.

use crate::codegen::program::Condition;
use crate::codegen::trace::{Compared, Point};
use crate::runtime::guards::{AtomShape, Guards};
use crate::runtime::population::Agents;
use crate::runtime::present::Present;
use crate::runtime::truth::depth_read;

/// How many comparisons of one guard are told.
const TOLD_MAX: usize = 6;

/// The comparisons of an instance that tell most: those that change at this instant, then those that hold, then the rest.
pub fn telling(guards: &Guards<'_>, agents: &Agents<'_>, instance: u32) -> Vec<usize> {
    let range = guards.atom_range(instance);
    let mut all: Vec<usize> = range.filter(|&index| is_allowed(guards, agents, index)).collect();
    if all.len() > TOLD_MAX {
        let rank = |&index: &usize| {
            let state = &guards.atoms[index];
            (!(state.rooted || state.touched), !state.truth, index)
        };
        all.sort_unstable_by_key(rank);
        all.truncate(TOLD_MAX);
        all.sort_unstable();
    }
    all
}

/// The telling comparisons of an instance on the rows of `present`.
pub fn told(guards: &Guards<'_>, agents: &Agents<'_>, present: &mut Present, instance: u32) -> Vec<Compared> {
    let mut all = Vec::new();
    for index in telling(guards, agents, instance) {
        let compared = compare(guards, agents, present, index);
        if !all.contains(&compared) {
            all.push(compared);
        }
    }
    all
}

/// One comparison on the rows of `present`, with the agents that quantifiers bind.
pub fn compare(guards: &Guards<'_>, agents: &Agents<'_>, present: &mut Present, index: usize) -> Compared {
    let (atom, slots) = guards.atom_slots(agents, index);
    present.make(agents, &slots, depth_read(agents.program.kernel(atom.value)));
    let frame = guards.definition(guards.atoms[index].instance).frame;
    let views = present.views(agents, &slots);
    let mut compared = agents.program.compared(atom, &Point { frame, slots: &views, time: present.time });
    let bound = shape(guards, index).binders.iter();
    let bound: Vec<String> = bound
        .map(|&(slot, _)| format!("{} = {}", frame.slots[slot].name(), agents.name(slots[slot])))
        .collect();
    if !bound.is_empty() {
        compared.text.push_str(&format!(" for {}", bound.join(", ")));
    }
    compared
}

/// The shape of a comparison.
fn shape<'g>(guards: &'g Guards<'_>, index: usize) -> &'g AtomShape {
    let instance = guards.atoms[index].instance;
    let (definition, offset) = (guards.definition(instance), index - guards.atom_range(instance).start);
    &definition.atoms[definition.atoms.partition_point(|shape| shape.first <= offset) - 1]
}

/// Whether no quantifier that says `other` binds an agent of the instance itself.
fn is_allowed(guards: &Guards<'_>, agents: &Agents<'_>, index: usize) -> bool {
    let instance = guards.atoms[index].instance;
    let own = guards.roots(instance);
    let (_, slots) = guards.atom_slots(agents, index);
    let condition = guards.definition(instance).guard.map(|guard| &guard.condition);
    let mut binders = shape(guards, index).binders.iter();
    binders.all(|&(slot, _)| {
        !own.contains(&slots[slot]) || !condition.is_some_and(|condition| says_other(condition, slot))
    })
}

/// Whether the quantifier that binds a slot says `other`.
fn says_other(condition: &Condition, slot: usize) -> bool {
    match condition {
        Condition::Constant(_) | Condition::Discrete(_) | Condition::Atom(_) => false,
        Condition::And(all) | Condition::Or(all) => all.iter().any(|inner| says_other(inner, slot)),
        Condition::Exists(quantified) | Condition::Forall(quantified) => {
            quantified.slot == slot && quantified.other || says_other(&quantified.body, slot)
        }
        Condition::Rising(_, inner) => says_other(inner, slot),
    }
}
