//! Which modes a change of mode leaves and which it enters (rule 4).
//!
//! A transition leaves the mode to which it belongs, and all that is active inside it; the agent itself is never left. The modes
//! around both its source and its target stay.

use crate::codegen::program::{AgentSystem, Destination, Inside};

/// A change of mode of one agent.
#[derive(Clone, Debug, PartialEq)]
pub struct Move {
    /// Who.
    pub agent: usize,
    /// The leaf it is in.
    pub from: usize,
    /// The leaf it goes to.
    pub to: usize,
    /// The modes left, inner first.
    pub left: Vec<usize>,
    /// The modes entered, outer first.
    pub entered: Vec<usize>,
}

/// The change of mode of an agent with these auxiliary columns, from leaf `from`, by a transition of mode `source`.
pub fn route(
    ty: &AgentSystem,
    (agent, aux): (usize, &[f64]),
    from: usize,
    source: usize,
    target: Destination,
) -> Move {
    let mode = target.mode.index();
    let scope = ty.modes[source].parent.map_or(0, |outside| {
        ty.around(mode).skip(1).find(|&around| ty.is_inside(outside, around)).unwrap_or(0)
    });
    let left = ty.around(from).take_while(|&mode| mode != scope).collect();
    let mut entered: Vec<usize> = ty.around(mode).take_while(|&mode| mode != scope).collect();
    entered.reverse();
    let mut inside = match (target.inside, ty.modes[mode].history) {
        (Inside::History, Some(column)) => Some(aux[column] as usize),
        (Inside::History | Inside::Initial, _) => ty.modes[mode].initial,
    };
    while let Some(mode) = inside {
        entered.push(mode);
        inside = ty.modes[mode].initial;
    }
    let to = entered.last().copied().unwrap_or(from);
    Move { agent, from, to, left, entered }
}

/// Fills in the histories of an agent that begins in this leaf.
pub fn begin_histories(ty: &AgentSystem, leaf: usize, aux: &mut [f64]) {
    for mode in &ty.modes {
        if let (Some(column), Some(initial)) = (mode.history, mode.initial) {
            aux[column] = initial as f64;
        }
    }
    remember(ty, &ty.modes[leaf].active, aux);
}

/// Notes in an agent's columns that these modes are active now.
pub fn remember(ty: &AgentSystem, entered: &[usize], aux: &mut [f64]) {
    for &mode in entered {
        let column = ty.modes[mode].parent.and_then(|parent| ty.modes[parent].history);
        if let Some(column) = column {
            aux[column] = mode as f64;
        }
    }
}
