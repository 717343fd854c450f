//! What the comparisons of a guard compare, with numbers: for messages and explanations.
//!
//! A guard over quantifiers may have thousands of comparisons; a few are enough to see why it holds.

use crate::codegen::trace::{Compared, Point};
use crate::runtime::fold;
use crate::runtime::guards::Guards;
use crate::runtime::population::Agents;
use crate::runtime::present::Present;
use crate::runtime::truth::{self, Side, Truths};

/// How many comparisons of one guard are told.
const TOLD_MAX: usize = 6;

/// The comparisons of an instance that tell most: those that change at this instant, then those that hold, then the rest.
pub fn telling(guards: &Guards<'_>, instance: u32) -> Vec<usize> {
    let mut all: Vec<usize> =
        guards.atoms_of(instance).filter(|&index| !guards.atoms[index].left_out).collect();
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
    for index in telling(guards, instance) {
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
    let (instance, kernel) = (guards.atoms[index].instance, agents.program.kernel(atom.value));
    let folds = Truths { agents, guards, present: &*present }.gather(instance, kernel, &slots, Side::After);
    let frame = guards.definition(instance).frame;
    let leaves = truth::leaves(agents, present, kernel, &slots, &folds);
    let row = |agent: usize| present.view(agents, agent);
    let views = fold::views(&slots, &leaves, &row);
    let mut compared = agents.program.compared(atom, &Point { frame, slots: &views, time: present.time });
    let (_, bound) = guards.bindings(agents, index);
    let bound: Vec<String> = bound
        .iter()
        .rev()
        .map(|(binder, agent)| format!("{} = {}", frame.slots[binder.slot].name(), agents.name(*agent)))
        .collect();
    compared.bound = bound.join(", ");
    compared
}
