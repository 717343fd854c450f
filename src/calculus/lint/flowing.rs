//! What an agent is and does while it flows in one mode: its rates as forms, and what else may happen to it.

use rustc_hash::FxHashMap;

use crate::calculus::form::FormId;
use crate::calculus::graph::Node;
use crate::calculus::reader::Reader;
use crate::calculus::system::{Atom, Flow, Frame, Layout, System, TransitionSystem};

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
pub fn others(
    system: &System,
    number: usize,
    leaf: usize,
    but: Option<usize>,
) -> Option<Vec<&TransitionSystem>> {
    let ty = &system.types[number];
    let meets = system.interactions.iter().any(|interaction| interaction.types.contains(&number));
    let active = ty.modes[leaf].active.iter().flat_map(|&mode| &ty.modes[mode].transitions);
    (!meets).then(|| active.filter(|&&k| Some(k) != but).map(|&k| &ty.transitions[k]).collect())
}
