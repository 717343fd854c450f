//! A comparison as an atom: g with its rates as functions, and what is known of it: whom it reads, whether it can jump, where
//! its rates can.
//!
//! `smooth`: nothing in g jumps while its operands move continuously. `turns`: what is zero where dg/dt can jump. `affine`: g is a
//! weighted sum of states between its turns.

use rustc_hash::FxHashSet;

use crate::calculus::condition::Written;
use crate::calculus::derive;
use crate::calculus::draft::Draft;
use crate::calculus::graph::{Graph, Node, NodeId};
use crate::calculus::jumps;
use crate::calculus::print::{self, Names};
use crate::calculus::system::{Atom, Frame, Relation, Slot};
use crate::math::Op;

/// A comparison with its functions.
pub fn atom(
    draft: &mut Draft,
    frame: &Frame,
    relation: Relation,
    g: NodeId,
    written: Written,
    name: &str,
) -> Atom {
    // Beyond the limit nothing is derived any more: whoever asked for this will say so.
    let [first, second] = if draft.is_exhausted() { [g, g] } else { derive::rates(&mut draft.graph, g) };
    let value = draft.function(|| name.to_owned(), vec![g]);
    let rates = draft.function(|| format!("{name} rates"), vec![g, first, second]);
    let reach = if draft.is_exhausted() { vec![g] } else { draft.graph.reach(&[g]) };
    let (slots, folds) = slots_read(&draft.graph, frame, &reach);
    let smooth = is_smooth(&draft.graph, frame, &reach);
    let affine = smooth && folds.is_empty() && is_affine(&draft.graph, first);
    let turns = turns(&mut draft.graph, &reach);
    let turns = (!turns.is_empty()).then(|| draft.function(|| format!("{name} turns"), turns));
    let names = Names { types: &draft.types, frame };
    let text = print::short_comparison(&draft.graph, names, relation, g);
    let Written { span, sides } = written;
    Atom { relation, value, rates, smooth, jumps: None, turns, affine, slots, folds, text, sides, span }
}

/// The slots of agents that nodes read, by themselves or through aggregates, and those of the aggregates; rising.
pub fn slots_read(graph: &Graph, frame: &Frame, nodes: &[NodeId]) -> (Vec<usize>, Vec<usize>) {
    let (mut agents, mut folds) = (Vec::new(), Vec::new());
    for slot in nodes.iter().filter_map(|&id| graph.node(id).slot()) {
        match &frame.slots[slot] {
            Slot::Fold { number, .. } => {
                folds.push(slot);
                agents.extend(&frame.folds[*number].reads);
            }
            Slot::Root { .. } | Slot::Link { .. } => agents.push(slot),
        }
    }
    for slots in [&mut agents, &mut folds] {
        slots.sort_unstable();
        slots.dedup();
    }
    (agents, folds)
}

/// Whether nothing among the nodes, nor among the terms of the aggregates that they read, can jump between events.
pub fn is_smooth(graph: &Graph, frame: &Frame, nodes: &[NodeId]) -> bool {
    nodes.iter().all(|&id| {
        let smooth_term = match graph.node(id).slot().map(|slot| &frame.slots[slot]) {
            Some(Slot::Fold { number, .. }) => {
                frame.folds[*number].term.as_ref().is_none_or(|term| term.smooth)
            }
            Some(Slot::Root { .. } | Slot::Link { .. }) | None => true,
        };
        smooth_term && !jumps::can_jump(graph, id)
    })
}

/// Whether dg/dt is a sum of the rates of more than one state, with weights that move at the turns of g only.
fn is_affine(graph: &Graph, rate: NodeId) -> bool {
    let (mut pending, mut seen, mut rates) = (vec![rate], FxHashSet::default(), 0);
    while let Some(id) = pending.pop() {
        if !graph.moves(id) || !seen.insert(id) {
            continue;
        }
        match graph.node(id) {
            Node::Rate { .. } => rates += 1,
            Node::State { .. } | Node::Acceleration { .. } | Node::Time => return false,
            Node::Unary(Op::Sign, _) | Node::Constant(_) | Node::Aux { .. } => {}
            Node::Unary(_, a) => pending.push(a),
            Node::Binary(_, a, b) | Node::Select(_, a, b) => pending.extend([a, b]),
        }
    }
    rates > 1
}

/// What is zero where the rate of one of these nodes can jump.
fn turns(graph: &mut Graph, reach: &[NodeId]) -> Vec<NodeId> {
    let mut turns = Vec::new();
    for &id in reach.iter().filter(|&&id| graph.moves(id)).collect::<Vec<_>>() {
        match graph.node(id) {
            Node::Unary(Op::Abs, e) => turns.push(e),
            Node::Binary(Op::Min | Op::Max, a, b) => turns.push(graph.binary(Op::Sub, a, b)),
            Node::Unary(..) | Node::Binary(..) | Node::Select(..) | Node::Constant(_) | Node::Time => {}
            Node::State { .. } | Node::Rate { .. } | Node::Acceleration { .. } | Node::Aux { .. } => {}
        }
    }
    turns.retain(|&turn| graph.moves(turn));
    turns.sort_unstable();
    turns.dedup();
    turns
}
