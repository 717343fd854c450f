//! The equations of a leaf mode: rates with their kinks locked, second rates, the Jacobian, who is coupled.

use rustc_hash::FxHashMap;

use crate::base::Span;
use crate::calculus::build;
use crate::calculus::derive;
use crate::calculus::draft::Draft;
use crate::calculus::error::Error;
use crate::calculus::frame::Scope;
use crate::calculus::graph::{Graph, Node, NodeId};
use crate::calculus::kinks;
use crate::calculus::system::{Flow, JacobianEntry, Slot};
use crate::math::Op;
use crate::model::ir::{ExprId, ModeId, TypeId};

/// The flow of a leaf.
pub fn flow(draft: &mut Draft, ty: TypeId, leaf: ModeId, name: &str) -> Result<Flow, Error> {
    let mut scope = Scope::of_self(ty);
    let equations = equations(draft, ty, leaf);
    let (exprs, spans): (Vec<ExprId>, Vec<Span>) = equations.into_iter().unzip();
    scope.equations = Some(exprs.clone());
    let mut plain = Vec::with_capacity(exprs.len());
    for &expr in &exprs {
        plain.push(build::number(draft, &mut scope, Scope::TOP, expr)?);
    }
    check_absent(draft, &scope, &plain, &spans)?;
    let (rates, kinks) = kinks::lock(draft, &scope, ty.index(), &plain, name);
    let accelerations: Vec<NodeId> =
        rates.iter().map(|&rate| derive::along_flow(&mut draft.graph, rate)).collect();
    let (jacobian, values) = jacobian(&mut draft.graph, &rates);
    let couples = couples(&draft.graph, &plain);
    Ok(Flow {
        rates: draft.function(|| format!("{name} flow"), rates),
        accelerations: draft.function(|| format!("{name} second rates"), accelerations),
        jacobian,
        jacobian_values: draft.function(|| format!("{name} Jacobian"), values),
        kinks,
        couples,
        spans,
        frame: scope.frame,
    })
}

/// The equation of every state, in order; the model has checked that each has one.
fn equations(draft: &Draft, ty: TypeId, leaf: ModeId) -> Vec<(ExprId, Span)> {
    let ty = &draft.model.types[ty];
    let mut found: Vec<Option<(ExprId, Span)>> = vec![None; ty.states.len()];
    let mut mode = Some(leaf);
    while let Some(id) = mode {
        for &(state, rate, span) in &ty.modes[id].flow {
            found[state] = Some((rate, span));
        }
        mode = ty.modes[id].parent;
    }
    found.into_iter().map(|equation| equation.expect("every state has one equation in every leaf")).collect()
}

/// The entries of df/dx that are not always 0.
fn jacobian(graph: &mut Graph, rates: &[NodeId]) -> (Vec<JacobianEntry>, Vec<NodeId>) {
    let (mut entries, mut values) = (Vec::new(), Vec::new());
    for (row, &rate) in rates.iter().enumerate() {
        for (leaf, value) in derive::gradient(graph, rate) {
            if let Node::State { slot, column } = leaf {
                entries.push(JacobianEntry { row, slot: slot as usize, column: column as usize });
                values.push(value);
            }
        }
    }
    (entries, values)
}

/// The foreign slots whose states are read, kinks included.
fn couples(graph: &Graph, plain: &[NodeId]) -> Vec<usize> {
    let mut slots: Vec<usize> = graph
        .reach(plain)
        .into_iter()
        .filter_map(|id| match graph.node(id) {
            Node::State { slot, .. } if slot > 0 => Some(slot as usize),
            _ => None,
        })
        .collect();
    slots.sort_unstable();
    slots.dedup();
    slots
}

/// Rule 10: a flow never reads through a link that may be none.
///
/// For every node, the slots that may be absent and are read unless an `if` asks first. Slots that are reached by a
/// required link of one that is there are always there.
fn check_absent(draft: &Draft, scope: &Scope, plain: &[NodeId], spans: &[Span]) -> Result<(), Error> {
    let graph = &draft.graph;
    let may_be_absent = |slot: usize| match &scope.frame.slots[slot] {
        Slot::Root { .. } => false,
        Slot::Link { from, link, .. } => {
            !draft.model.types[TypeId::new(scope.frame.slots[*from].ty())].links[*link].required
        }
    };
    let mut needs: FxHashMap<NodeId, Vec<usize>> = FxHashMap::default();
    for id in graph.reach(plain) {
        let node = graph.node(id);
        let mut set: Vec<usize> = match node {
            Node::Select(c, a, b) => {
                let (then, otherwise) = (sure(draft, scope, c, true), sure(draft, scope, c, false));
                let a = needs[&a].iter().filter(|slot| !then.contains(slot));
                let b = needs[&b].iter().filter(|slot| !otherwise.contains(slot));
                a.chain(b).chain(&needs[&c]).copied().collect()
            }
            Node::Unary(..) | Node::Binary(..) => {
                node.operands().flat_map(|operand| needs[&operand].iter().copied()).collect()
            }
            Node::Constant(_) | Node::Time | Node::State { .. } | Node::Rate { .. } => node
                .slot()
                .into_iter()
                .flat_map(|slot| upwards(scope, slot))
                .filter(|&s| may_be_absent(s))
                .collect(),
            Node::Acceleration { .. } | Node::Aux { .. } => node
                .slot()
                .into_iter()
                .flat_map(|slot| upwards(scope, slot))
                .filter(|&s| may_be_absent(s))
                .collect(),
        };
        set.sort_unstable();
        set.dedup();
        needs.insert(id, set);
    }
    match plain.iter().zip(spans).find_map(|(rate, &span)| Some((*needs[rate].first()?, span))) {
        Some((slot, span)) => {
            Err(Error::FlowReadsNone { link: scope.frame.slots[slot].name().to_owned(), span })
        }
        None => Ok(()),
    }
}

/// A slot and the slots that it is reached from.
fn upwards(scope: &Scope, slot: usize) -> Vec<usize> {
    let mut chain = vec![slot];
    while let Slot::Link { from, .. } = scope.frame.slots[chain[chain.len() - 1]] {
        chain.push(from);
    }
    chain
}

/// The slots that are there if a condition is true (or, for `holds` false, if it is not).
fn sure(draft: &Draft, scope: &Scope, condition: NodeId, holds: bool) -> Vec<usize> {
    let (mut found, mut pending) = (Vec::new(), vec![(condition, holds)]);
    while let Some((condition, holds)) = pending.pop() {
        match draft.graph.node(condition) {
            Node::Unary(Op::Not, inner) => pending.push((inner, !holds)),
            Node::Binary(Op::And, a, b) if holds => pending.extend([(a, true), (b, true)]),
            Node::Binary(Op::Or, a, b) if !holds => pending.extend([(a, false), (b, false)]),
            // `0 <= link column`: the link is not none.
            Node::Binary(Op::Le, zero, column) if holds && draft.graph.is_zero(zero) => {
                let slots = scope.frame.slots.iter().enumerate();
                found.extend(slots.filter(|(_, slot)| leads_by(draft, scope, slot, column)).map(|(k, _)| k));
            }
            _ => {}
        }
    }
    found
}

/// Whether a slot is reached by the link that this column holds.
fn leads_by(draft: &Draft, scope: &Scope, slot: &Slot, column: NodeId) -> bool {
    let (Slot::Link { from, link, .. }, Node::Aux { slot, column }) = (slot, draft.graph.node(column)) else {
        return false;
    };
    let layout = draft.layout(scope.frame.slots[*from].ty());
    *from == slot as usize && layout.link(*link) == column as usize
}
