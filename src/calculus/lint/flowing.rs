//! What an agent is and does while it flows in one mode: its rates as forms, and what else may happen to it.

use rustc_hash::FxHashMap;

use crate::calculus::bounds::REAL;
use crate::calculus::form::FormId;
use crate::calculus::graph::Node;
use crate::calculus::lint::effects::guard;
use crate::calculus::lint::truth::{Truth, truth};
use crate::calculus::reader::Reader;
use crate::calculus::system::{
    AgentSystem, Atom, Condition, Flow, Frame, Guard, Instance, Layout, Relation, System, TransitionSystem,
};
use crate::math::Interval;

/// What leaves stand for.
pub type Given = FxHashMap<Node, FormId>;

/// Adds x' and x'' of the agent itself, by the equations of a flow, to what leaves stand for. False if it reads other agents.
pub fn add_rates<'s>(reader: &mut Reader<'s>, flow: &'s Flow, given: &mut Given) -> bool {
    if flow.frame.slots.len() != 1 {
        return false;
    }
    for (function, leaf) in [(flow.rates, rate as fn(u32) -> Node), (flow.accelerations, acceleration)] {
        reader.read_as(&flow.frame, given.clone(), None);
        for (column, node) in reader.system.functions[function].outputs.iter().enumerate() {
            given.insert(leaf(column as u32), reader.node(*node));
        }
    }
    true
}

fn rate(column: u32) -> Node {
    Node::Rate { slot: 0, column }
}

fn acceleration(column: u32) -> Node {
    Node::Acceleration { slot: 0, column }
}

/// g, dg/dt and d2g/dt2 of a comparison, from what leaves stand for.
pub fn derivatives<'s>(reader: &mut Reader<'s>, frame: &'s Frame, atom: &Atom, given: &Given) -> [FormId; 3] {
    reader.read_as(frame, given.clone(), None);
    let outputs = &reader.system.functions[atom.rates].outputs;
    [0, 1, 2].map(|k| reader.node(outputs[k]))
}

/// The agent itself is in this configuration.
pub fn stand_in(reader: &mut Reader, leaf: usize, given: &mut Given) {
    given.insert(Node::Aux { slot: 0, column: Layout::MODE as u32 }, reader.forms.constant(leaf as f64));
}

/// The other transitions that an agent may take in a configuration, by itself. None if there are interactions as well.
pub fn others<'s>(
    system: &'s System,
    number: usize,
    leaf: usize,
    but: Option<usize>,
) -> Option<Vec<&'s TransitionSystem>> {
    let ty = &system.types[number];
    let meets = system.interactions.iter().any(|interaction| interaction.types.contains(&number));
    let active = ty.modes[leaf].active.iter().flat_map(|&mode| &ty.modes[mode].transitions);
    (!meets).then(|| active.filter(|&&k| Some(k) != but).map(|&k| &ty.transitions[k]).collect())
}

/// Whether the condition of a transition is certainly false, from what leaves of the agent itself stand for.
pub fn is_false<'s>(reader: &mut Reader<'s>, given: &Given, transition: &'s TransitionSystem) -> bool {
    // Other agents would be mistaken for those of the frame that the leaves are read in.
    let Some(guard) = guard(transition).filter(|_| transition.frame.slots.len() == 1) else { return false };
    reader.read_as(&transition.frame, given.clone(), None);
    truth(reader, guard, &guard.condition) == Truth::Never
}

/// The configuration that is entered with a mode; none if its history decides.
pub fn entered(ty: &AgentSystem, transition: &TransitionSystem) -> Option<usize> {
    use crate::calculus::system::{Destination, Inside};
    let mode = match transition.target {
        None => return Some(transition.source),
        Some(Destination { mode, inside: Inside::Initial }) => mode.index(),
        Some(Destination { mode, inside: Inside::History }) => {
            return ty.modes[mode.index()].initial.is_none().then_some(mode.index());
        }
    };
    std::iter::successors(Some(mode), |&mode| ty.modes[mode].initial).last()
}

/// Where single states lie when a condition is true.
pub fn restrictions(reader: &mut Reader, guard: &Guard) -> Vec<(Node, Interval)> {
    let mut found: Vec<(Node, Interval)> = Vec::new();
    for term in guard.condition.conjuncts() {
        let Condition::Atom(k) = term else { continue };
        let form = reader.function(guard.atoms[*k].value);
        let Some((leaf @ Node::State { slot: 0, .. }, factor, constant)) = reader.forms.as_leaf(form) else {
            continue;
        };
        let bound = -constant / factor;
        let side = match guard.atoms[*k].relation {
            Relation::Crossing => Interval::point(bound),
            Relation::NonPositive | Relation::Negative if factor > 0.0 => Interval::new(REAL.lo, bound),
            Relation::NonPositive | Relation::Negative => Interval::new(bound, REAL.hi),
        };
        match found.iter_mut().find(|(known, _)| *known == leaf) {
            Some((_, known)) => *known = known.intersect(side).unwrap_or(*known),
            None => found.push((leaf, side)),
        }
    }
    found
}

/// Some of the agents that start in each mode.
pub struct Starts(FxHashMap<(usize, usize), Vec<usize>>);

impl Starts {
    /// How many of each mode are looked at.
    const MAX: usize = 64;

    /// The first ones of each type and mode.
    pub fn of(system: &System) -> Self {
        let mut found: FxHashMap<(usize, usize), Vec<usize>> = FxHashMap::default();
        for (number, agent) in system.population.agents.iter().enumerate() {
            let known = found.entry((agent.ty.index(), agent.mode.index())).or_default();
            if known.len() < Self::MAX {
                known.push(number);
            }
        }
        Self(found)
    }

    /// Their numbers.
    pub fn numbers(&self, ty: usize, mode: usize) -> &[usize] {
        self.0.get(&(ty, mode)).map_or(&[], Vec::as_slice)
    }

    /// What they start with.
    pub fn in_mode<'s>(&self, system: &'s System, ty: usize, mode: usize) -> Vec<&'s Instance> {
        self.numbers(ty, mode).iter().map(|&number| &system.population.agents[number]).collect()
    }
}
