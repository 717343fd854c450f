//! What the functions of a program read of its agents, whoever they are: how wide rows are, which columns flows read, who is followed,
//! how long chains of links are.

use crate::codegen::program::{Flow, Frame, ModeSystem, Program, Slot};

/// The columns of the longest row of any agent type.
pub fn row_width(program: &Program) -> usize {
    program.types.iter().map(|ty| ty.layout.n_aux().max(ty.layout.n_states)).max().unwrap_or(0)
}

/// The auxiliary columns that each flow depends on. Locks are not among those of its kinks: events do not write them.
pub fn flow_inputs(program: &Program) -> Vec<Vec<Vec<(usize, usize)>>> {
    let of_flow = |flow: &Flow| {
        let mut columns = program.kernel(flow.rates).reads().columns.clone();
        for kink in &flow.kinks {
            columns.extend_from_slice(&program.kernel(kink.initial).reads().columns);
        }
        columns.sort_unstable();
        columns.dedup();
        columns
    };
    let of_mode = |mode: &ModeSystem| mode.flow.as_ref().map_or_else(Vec::new, of_flow);
    program.types.iter().map(|ty| ty.modes.iter().map(of_mode).collect()).collect()
}

/// For each type, whether any flow reads states of another agent of it.
pub fn is_followed(program: &Program) -> Vec<bool> {
    let mut is_followed = vec![false; program.types.len()];
    for mode in program.types.iter().flat_map(|ty| &ty.modes) {
        for flow in mode.flow.iter() {
            flow.couples.iter().for_each(|&slot| is_followed[flow.frame.slots[slot].ty()] = true);
        }
    }
    is_followed
}

/// The longest chain of links in any frame of the program.
pub fn longest_chain(program: &Program) -> usize {
    let mut longest = 0;
    let mut visit = |frame: &Frame| {
        let mut depths = vec![0; frame.slots.len()];
        for (k, slot) in frame.slots.iter().enumerate() {
            if let Slot::Link { from, .. } = slot {
                depths[k] = depths[*from] + 1;
                longest = longest.max(depths[k]);
            }
        }
    };
    for ty in &program.types {
        for mode in &ty.modes {
            mode.flow.iter().for_each(|flow| visit(&flow.frame));
            mode.claims.iter().for_each(|claim| visit(&claim.frame));
        }
        ty.transitions.iter().for_each(|transition| visit(&transition.frame));
        ty.links.iter().flat_map(|link| &link.updates).for_each(|update| visit(&update.frame));
    }
    let pairs = program.interactions.iter().flat_map(|interaction| &interaction.transitions);
    pairs.for_each(|pair| visit(&pair.transition.frame));
    longest
}
