//! From a condition over nodes to a guard: atoms numbered, each with its rates, all as functions.

use rustc_hash::FxHashSet;

use crate::calculus::condition::{self, Cond, Sense, Written};
use crate::calculus::derive;
use crate::calculus::draft::Draft;
use crate::calculus::error::Error;
use crate::calculus::frame::Scope;
use crate::calculus::graph::{Graph, Node, NodeId};
use crate::calculus::print::{self, Names};
use crate::calculus::system::{Atom, Condition, Frame, Guard, Quantified, Range, Relation, Slot};
use crate::math::Op;
use crate::model::ir::{ExprId, Quantifier};

/// Lowers a boolean expression to a guard; `name` is for listings.
pub fn guard(
    draft: &mut Draft,
    scope: &mut Scope,
    expr: ExprId,
    sense: Sense,
    name: &str,
) -> Result<Guard, Error> {
    let cond = condition::lower(draft, scope, expr, sense)?;
    let guard = finish(draft, &scope.frame, cond, name);
    draft.check_work(draft.model.exprs[expr].span)?;
    Ok(guard)
}

/// Numbers the atoms of a condition.
pub fn finish(draft: &mut Draft, frame: &Frame, cond: Cond, name: &str) -> Guard {
    let mut numbering = Numbering { draft, frame, name, atoms: Vec::new(), nodes: Vec::new(), n_rising: 0 };
    let condition = numbering.condition(cond);
    Guard { condition, atoms: numbering.atoms, n_rising: numbering.n_rising }
}

struct Numbering<'d, 'm> {
    draft: &'d mut Draft<'m>,
    frame: &'d Frame,
    name: &'d str,
    atoms: Vec<Atom>,
    nodes: Vec<(Relation, NodeId)>,
    n_rising: usize,
}

impl Numbering<'_, '_> {
    /// As deep as the lowering was, which has a limit.
    fn condition(&mut self, cond: Cond) -> Condition {
        match cond {
            Cond::Constant(value) => Condition::Constant(value),
            Cond::Discrete(node) => {
                let name = self.name;
                Condition::Discrete(self.draft.function(|| format!("{name} test"), vec![node]))
            }
            Cond::Atom(relation, g, written) => Condition::Atom(self.atom(relation, g, written)),
            Cond::And(terms) => Condition::And(terms.into_iter().map(|term| self.condition(term)).collect()),
            Cond::Or(terms) => Condition::Or(terms.into_iter().map(|term| self.condition(term)).collect()),
            Cond::Quantified(kind, range, body) => {
                let body = Box::new(self.condition(*body));
                let Range { slot, ty, other } = range;
                let quantified = Quantified { slot, ty, other, body, near: Vec::new() };
                match kind {
                    Quantifier::Exists => Condition::Exists(quantified),
                    Quantifier::Forall => Condition::Forall(quantified),
                }
            }
            Cond::Rising(inner) => {
                let number = self.n_rising;
                self.n_rising += 1;
                Condition::Rising(number, Box::new(self.condition(*inner)))
            }
        }
    }

    fn atom(&mut self, relation: Relation, g: NodeId, written: Written) -> usize {
        if let Some(k) = self.nodes.iter().position(|&known| known == (relation, g)) {
            return k;
        }
        let name = format!("{} {}", self.name, self.atoms.len() + 1);
        let atom = atom(self.draft, self.frame, relation, g, written, &name);
        self.atoms.push(atom);
        self.nodes.push((relation, g));
        self.atoms.len() - 1
    }
}

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
    Atom { relation, value, rates, smooth, turns, affine, slots, folds, text, sides, span }
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
        smooth_term && !jumps(graph, id)
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

/// Whether the value of a node can jump while its operands move continuously.
fn jumps(graph: &Graph, id: NodeId) -> bool {
    let node = graph.node(id);
    let moving = |id| graph.moves(id);
    match node {
        Node::Select(condition, ..) => moving(condition),
        Node::Unary(op, a) | Node::Binary(op, a, _) => match op {
            Op::Sign | Op::Floor | Op::Ceil | Op::Round | Op::Trunc | Op::Not => moving(a),
            Op::Mod | Op::Lt | Op::Le | Op::Eq | Op::Ne | Op::And | Op::Or => moving(id),
            Op::Neg | Op::Add | Op::Sub | Op::Mul | Op::Div | Op::Powi | Op::Pow | Op::Sin | Op::Cos => false,
            Op::Tan | Op::Asin | Op::Acos | Op::Atan | Op::Sinh | Op::Cosh | Op::Tanh | Op::Asinh => false,
            Op::Acosh | Op::Atanh | Op::Exp | Op::Log | Op::Log2 | Op::Log10 | Op::Sqrt | Op::Cbrt => false,
            // The cut of atan2 has been taken out by an `if`.
            Op::Atan2 | Op::Abs | Op::Min | Op::Max | Op::Hypot | Op::Select => false,
        },
        Node::Constant(_) | Node::Time | Node::State { .. } | Node::Rate { .. } => false,
        Node::Acceleration { .. } | Node::Aux { .. } => false,
    }
}
