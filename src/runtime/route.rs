//! Which modes a change of mode leaves and which it enters (rule 4).
//!
//! A transition leaves the mode to which it belongs, and all that is active inside it; the modes around both its source and its
//! target stay. The agent itself and its regions are never left. A transition of the agent itself leaves the modes of all
//! regions; those that its target does not name begin at their initial modes.

use crate::codegen::program::{AgentSystem, Destination, Inside};

/// A change of mode of one agent.
#[derive(Clone, Debug, PartialEq)]
pub struct Move {
    /// Who.
    pub agent: usize,
    /// Where it was, as logs tell it: the leaf of the region that changes, or the configuration if all do.
    pub from: usize,
    /// Where it will be.
    pub to: usize,
    /// The modes left, inner first.
    pub left: Vec<usize>,
    /// The modes entered, outer first.
    pub entered: Vec<usize>,
}

/// The change of mode of an agent with these auxiliary columns, from the configuration `from`, by a transition of mode `source`.
pub fn route(
    ty: &AgentSystem,
    (agent, aux): (usize, &[f64]),
    from: usize,
    source: usize,
    target: Destination,
) -> Move {
    let own = ty.region_of(source);
    let stays = match own {
        Some(region) => Stays::Mode(scope(ty, source, target.mode.index(), region)),
        None => Stays::Regions,
    };
    let active = &ty.modes[from].active;
    let mut left: Vec<usize> = active.iter().copied().filter(|&mode| stays.leaves(ty, mode)).collect();
    left.sort_by_key(|&mode| std::cmp::Reverse(ty.modes[mode].depth));
    let mut entered = Vec::new();
    for &region in ty.regions.iter().filter(|&&region| own.is_none_or(|own| own == region)) {
        if ty.is_inside(target.mode.index(), region) {
            descend(ty, aux, target, &mut entered);
        } else {
            begin(ty, ty.modes[region].initial, &mut entered);
        }
    }
    entered.retain(|&mode| stays.leaves(ty, mode));
    entered.sort_by_key(|&mode| ty.modes[mode].depth);
    let configuration = reached(ty, from, &left, &entered);
    let leaf = |configuration: usize| {
        let inside = |&&mode: &&usize| own.is_some_and(|own| ty.is_inside(mode, own));
        ty.modes[configuration].active.iter().rev().find(inside).copied().unwrap_or(configuration)
    };
    Move { agent, from: leaf(from), to: leaf(configuration), left, entered }
}

/// What a change of mode does not leave.
enum Stays {
    /// A mode, and all around it; what is in other regions.
    Mode(usize),
    /// The agent and its regions.
    Regions,
}

impl Stays {
    fn leaves(&self, ty: &AgentSystem, mode: usize) -> bool {
        match *self {
            Stays::Mode(scope) => mode != scope && ty.is_inside(mode, scope),
            Stays::Regions => mode != 0 && !ty.regions.contains(&mode),
        }
    }
}

/// The innermost mode around both source and target; of a transition of the region itself, that one.
fn scope(ty: &AgentSystem, source: usize, target: usize, region: usize) -> usize {
    if source == region {
        return region;
    }
    let outside = ty.modes[source].parent.unwrap_or(region);
    let mut around = ty.around(target).skip(1).take_while(|&around| ty.is_inside(around, region));
    around.find(|&around| ty.is_inside(outside, around)).unwrap_or(region)
}

/// The modes around a target, the target, and what is entered inside it.
fn descend(ty: &AgentSystem, aux: &[f64], target: Destination, entered: &mut Vec<usize>) {
    let mode = target.mode.index();
    entered.extend(ty.around(mode));
    let inside = match (target.inside, ty.modes[mode].history) {
        (Inside::History, Some(column)) => Some(aux[column] as usize),
        (Inside::History | Inside::Initial, _) => ty.modes[mode].initial,
    };
    begin(ty, inside, entered);
}

/// A mode and what is entered inside it by default.
fn begin(ty: &AgentSystem, mode: Option<usize>, entered: &mut Vec<usize>) {
    entered.extend(std::iter::successors(mode, |&mode| ty.modes[mode].initial));
}

/// The configuration of an agent that was in `from`, without the modes left and with those entered.
pub fn reached(ty: &AgentSystem, from: usize, left: &[usize], entered: &[usize]) -> usize {
    let sum = |modes: &[usize]| modes.iter().map(|&mode| ty.modes[mode].offset).sum::<usize>();
    from + sum(entered) - sum(left)
}

/// The configuration in which an agent begins that is to be in a mode (or in the root: by default), other regions in their initial
/// modes.
pub fn first(ty: &AgentSystem, mode: usize) -> usize {
    let leaf = |&region: &usize| {
        let named = if ty.is_inside(mode, region) { mode } else { region };
        std::iter::successors(Some(named), |&mode| ty.modes[mode].initial).last().unwrap_or(named)
    };
    let offsets: usize = ty.regions.iter().map(leaf).map(|leaf| ty.modes[leaf].offset).sum();
    let before =
        if ty.regions == [0] { 0 } else { ty.modes.iter().take_while(|mode| mode.active.is_empty()).count() };
    before + offsets
}

/// Fills in the histories of an agent that begins in this configuration.
pub fn begin_histories(ty: &AgentSystem, configuration: usize, aux: &mut [f64]) {
    for mode in &ty.modes {
        if let (Some(column), Some(initial)) = (mode.history, mode.initial) {
            aux[column] = initial as f64;
        }
    }
    remember(ty, &ty.modes[configuration].active, aux);
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
