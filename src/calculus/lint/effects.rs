//! What transitions read and write of their own agent, and which of them stand beside which.

use rustc_hash::FxHashSet;

use crate::calculus::bounds::Bounds;
use crate::calculus::graph::{Node, NodeId};
use crate::calculus::system::{
    ActionList, ActionStep, AgentSystem, Condition, Destination, Entry, FunctionId, Guard, Inside, System,
    TransitionSystem, Trigger,
};

/// How many transitions of one mode are compared with each other.
pub const COMPARED_MAX: usize = 64;

/// The condition of a transition, if it has one.
pub fn guard(transition: &TransitionSystem) -> Option<&Guard> {
    match &transition.trigger {
        Trigger::When(guard) => Some(guard),
        Trigger::After { guard, .. } | Trigger::Every { guard, .. } => guard.as_ref(),
        Trigger::On { guard, .. } | Trigger::Rate { guard, .. } | Trigger::Chance { guard, .. } => {
            guard.as_ref()
        }
    }
}

/// The condition of a transition that waits for nothing else, and has no memory.
pub fn plain_guard(transition: &TransitionSystem) -> Option<&Guard> {
    match &transition.trigger {
        Trigger::When(guard) => {
            let crosses = |atom: &crate::calculus::system::Atom| {
                atom.relation == crate::calculus::system::Relation::Crossing
            };
            (guard.n_rising == 0 && !guard.atoms.iter().any(crosses)).then_some(guard)
        }
        Trigger::After { .. } | Trigger::Every { .. } | Trigger::On { .. } => None,
        Trigger::Rate { .. } | Trigger::Chance { .. } => None,
    }
}

/// Everything that a guard is computed from.
pub fn nodes(system: &System, guard: &Guard) -> Vec<NodeId> {
    let mut functions: Vec<FunctionId> = guard.atoms.iter().map(|atom| atom.value).collect();
    tests(&guard.condition, &mut functions);
    functions.into_iter().map(|function| system.functions[function].outputs[0]).collect()
}

fn tests(condition: &Condition, found: &mut Vec<FunctionId>) {
    match condition {
        Condition::Discrete(function) => found.push(*function),
        Condition::And(terms) | Condition::Or(terms) => terms.iter().for_each(|term| tests(term, found)),
        Condition::Exists(quantified) | Condition::Forall(quantified) => tests(&quantified.body, found),
        Condition::Rising(_, inner) => tests(inner, found),
        Condition::Constant(_) | Condition::Atom(_) => {}
    }
}

/// The columns that these nodes read, of whichever agent; `x'` counts as all states.
pub fn reads(system: &System, ty: &AgentSystem, roots: &[NodeId]) -> FxHashSet<Entry> {
    let mut found = FxHashSet::default();
    for id in system.graph.reach(roots) {
        match system.graph.node(id) {
            Node::State { column, .. } => {
                found.insert(Entry::State(column as usize));
            }
            Node::Aux { column, .. } => {
                found.insert(Entry::Aux(column as usize));
            }
            Node::Rate { .. } | Node::Acceleration { .. } => {
                found.extend((0..ty.layout.n_states).map(Entry::State));
                found.extend((0..ty.layout.n_aux()).map(Entry::Aux));
            }
            Node::Constant(_) | Node::Time => {}
            Node::Unary(..) | Node::Binary(..) | Node::Select(..) => {}
        }
    }
    found
}

/// What a transition of an agent type does to its agent: its own actions, those on leaving its mode, those on entering the target.
pub struct Effect<'s> {
    /// The transition's own actions.
    pub own: &'s ActionList,
    /// Columns that exit or entry actions write, or that it writes on some condition only.
    pub unclear: FxHashSet<Entry>,
    /// All columns that are written.
    pub writes: FxHashSet<Entry>,
    /// It may end the run, or change who there is.
    pub stops: bool,
}

/// The effect of a transition. Of the modes inside those that it leaves and enters each may be the one that is active.
pub fn effect<'s>(ty: &'s AgentSystem, transition: &'s TransitionSystem) -> Effect<'s> {
    let target = transition.target.map_or(transition.source, |target| target.mode.index());
    let all = || 0..ty.modes.len();
    let concerned = |mode: usize, of: usize| ty.is_inside(mode, of) || ty.is_inside(of, mode);
    let exits = all().filter(|&mode| concerned(mode, transition.source)).map(|mode| &ty.modes[mode].exit);
    let entries = all().filter(|&mode| concerned(mode, target)).map(|mode| &ty.modes[mode].entry);
    let others: Vec<&ActionList> = exits.chain(entries).collect();
    let targets = |list: &ActionList| list.writes.iter().map(|(_, target)| *target).collect::<Vec<_>>();
    let mut unclear: FxHashSet<Entry> = others.iter().flat_map(|list| targets(list)).collect();
    for step in &transition.actions.steps {
        if let ActionStep::If { then, otherwise, .. } = step {
            conditional(then, &mut unclear);
            conditional(otherwise, &mut unclear);
        }
    }
    let mut writes = unclear.clone();
    writes.extend(targets(&transition.actions));
    let stops = |list: &ActionList| list.stops() || list.creates() || list.destroys();
    let stops = stops(&transition.actions) || others.into_iter().any(stops);
    Effect { own: &transition.actions, unclear, writes, stops }
}

fn conditional(steps: &[ActionStep], found: &mut FxHashSet<Entry>) {
    for step in steps {
        match step {
            ActionStep::Assign { target, .. } | ActionStep::Draw { target, .. } => {
                found.insert(*target);
            }
            ActionStep::If { then, otherwise, .. } => {
                conditional(then, found);
                conditional(otherwise, found);
            }
            ActionStep::Emit { .. } | ActionStep::Goto { .. } | ActionStep::Stop { .. } => {}
            ActionStep::Create(_) | ActionStep::Destroy { .. } => {}
        }
    }
}

/// Transitions that have their turn before number `k` of a type while its source is active, and may lead out of it: those of modes
/// around it and inside it, those before it in its own mode, and interactions. None if there are more than [`COMPARED_MAX`].
pub fn before(system: &System, number: usize, k: usize) -> Option<Vec<&TransitionSystem>> {
    let ty = &system.types[number];
    let own = &ty.transitions[k];
    let mut found: Vec<&TransitionSystem> = Vec::new();
    let inside = |&mode: &usize| mode != own.source && ty.is_inside(mode, own.source);
    for mode in ty.around(own.source).chain((0..ty.modes.len()).filter(inside)) {
        let others = ty.modes[mode].transitions.iter().filter(|&&other| other != k);
        found.extend(
            others.map(|&other| &ty.transitions[other]).filter(|other| !comes_before(system, own, other)),
        );
    }
    let pairs = system.interactions.iter().filter(|interaction| interaction.types.contains(&number));
    found.extend(pairs.flat_map(|interaction| &interaction.transitions).map(|pair| &pair.transition));
    (found.len() <= COMPARED_MAX).then_some(found)
}

/// Whether the first of two transitions of one agent has its turn before the second, whatever the state is.
pub fn comes_before(system: &System, first: &TransitionSystem, second: &TransitionSystem) -> bool {
    let priority = |transition: &TransitionSystem| match transition.priority {
        None => Some(0.0),
        Some(function) => system.graph.constant(system.functions[function].outputs[0]),
    };
    match (priority(first), priority(second)) {
        (Some(a), Some(b)) if a == b => (first.depth, first.declaration) < (second.depth, second.declaration),
        (Some(a), Some(b)) => a > b,
        (None, _) | (_, None) => false,
    }
}

/// The columns that the conditions of some transitions read.
pub fn read_by(system: &System, ty: &AgentSystem, transitions: &[&TransitionSystem]) -> FxHashSet<Entry> {
    let guards = transitions.iter().filter_map(|transition| guard(transition));
    guards.flat_map(|guard| reads(system, ty, &nodes(system, guard))).collect()
}

/// What parameters can hold, too: those of the agents that there are, unless others are created.
pub fn with_params(system: &System, bounds: &Bounds) -> Bounds {
    if system.creates() { bounds.clone() } else { bounds.with_params(system) }
}

/// Whether some action may end the run, or remove agents, at any time.
pub fn may_end(system: &System) -> bool {
    system.action_lists().any(|list| list.destroys() || list.stops())
}

/// The configuration that is entered with a mode; none if its history decides.
pub fn entered(ty: &AgentSystem, transition: &TransitionSystem) -> Option<usize> {
    let mode = match transition.target {
        None => return Some(transition.source),
        Some(Destination { mode, inside: Inside::Initial }) => mode.index(),
        Some(Destination { mode, inside: Inside::History }) => {
            return ty.modes[mode.index()].initial.is_none().then_some(mode.index());
        }
    };
    std::iter::successors(Some(mode), |&mode| ty.modes[mode].initial).last()
}
