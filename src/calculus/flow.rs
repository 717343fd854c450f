//! The equations of a configuration, which is a leaf mode or one of each region: rates with their kinks locked, second rates, the Jacobian, who is coupled.

use crate::base::Span;
use crate::calculus::build::{self, Halt};
use crate::calculus::derive;
use crate::calculus::draft::Draft;
use crate::calculus::error::Error;
use crate::calculus::frame::Scope;
use crate::calculus::graph::{Graph, Node, NodeId};
use crate::calculus::kinks;
use crate::calculus::system::{Flow, JacobianEntry};
use crate::math::Op;
use crate::model::ir::{ExprId, ModeId, Transition, Trigger, TypeId};

/// The flow with these modes active.
pub fn flow(draft: &mut Draft, ty: TypeId, active: &[usize], name: &str) -> Result<Flow, Error> {
    let mut scope = Scope::of_self(ty);
    let equations = equations(draft, ty, active);
    let (exprs, mut spans): (Vec<ExprId>, Vec<Span>) = equations.into_iter().unzip();
    scope.equations = Some(exprs.clone());
    let mut plain = Vec::with_capacity(exprs.len());
    for &expr in &exprs {
        plain.push(number(draft, &mut scope, expr)?);
    }
    for (hazard, transition) in draft.model.types[ty].rates().enumerate() {
        plain.push(hazard_rate(draft, &mut scope, (ty, active), hazard, transition)?);
        spans.push(transition.span);
    }
    let (rates, kinks) = kinks::lock(draft, &mut scope, ty.index(), &plain, name);
    let mut accelerations: Vec<NodeId> = Vec::with_capacity(rates.len());
    for (&rate, &span) in rates.iter().zip(&spans) {
        draft.check_work(span)?;
        accelerations.push(derive::along_flow(&mut draft.graph, rate));
    }
    let (mut entries, mut values) = (Vec::new(), Vec::new());
    for (row, (&rate, &span)) in rates.iter().zip(&spans).enumerate() {
        draft.check_work(span)?;
        jacobian_row(&mut draft.graph, row, rate, &mut entries, &mut values);
    }
    let couples = couples(&draft.graph, &plain);
    Ok(Flow {
        rates: draft.function(|| format!("{name} flow"), rates),
        accelerations: draft.function(|| format!("{name} second rates"), accelerations),
        jacobian: entries,
        jacobian_values: draft.function(|| format!("{name} Jacobian"), values),
        kinks,
        couples,
        spans,
        frame: scope.into_frame(),
    })
}

fn number(draft: &mut Draft, scope: &mut Scope, expr: ExprId) -> Result<NodeId, Error> {
    build::number(draft, scope, Scope::TOP, expr).map_err(|halt| match halt {
        Halt::Failed(error) => error,
        Halt::Aggregate(..) => unreachable!("the model lets no aggregate stand in a flow"),
    })
}

/// The rate of what is left of a hazard (rule 11): less the hazard in the mode of the transition while its gate is open, else 0.
fn hazard_rate(
    draft: &mut Draft,
    scope: &mut Scope,
    (ty, active): (TypeId, &[usize]),
    hazard: usize,
    transition: &Transition,
) -> Result<NodeId, Error> {
    let zero = draft.graph.number(0.0);
    let Trigger::Rate { rate, guard, .. } = transition.trigger else { return Ok(zero) };
    if !active.contains(&transition.source.index()) {
        return Ok(zero);
    }
    let rate = number(draft, scope, rate)?;
    let less = derive::negative(&mut draft.graph, rate);
    if guard.is_none() {
        return Ok(less);
    }
    let column = draft.layout(ty.index()).gate(hazard) as u32;
    let gate = draft.graph.intern(Node::Aux { slot: 0, column });
    let open = draft.graph.binary(Op::Lt, zero, gate);
    Ok(draft.graph.select(open, less, zero))
}

/// The equation of every state, in order; the model has checked that each has one.
fn equations(draft: &Draft, ty: TypeId, active: &[usize]) -> Vec<(ExprId, Span)> {
    let ty = &draft.model.types[ty];
    let mut found: Vec<Option<(ExprId, Span)>> = vec![None; ty.states.len()];
    for &mode in active {
        for &(state, rate, span) in &ty.modes[ModeId::new(mode)].flow {
            found[state] = Some((rate, span));
        }
    }
    found
        .into_iter()
        .map(|equation| equation.expect("every state has one equation in every configuration"))
        .collect()
}

/// The entries of a row of df/dx that are not always 0.
fn jacobian_row(
    graph: &mut Graph,
    row: usize,
    rate: NodeId,
    entries: &mut Vec<JacobianEntry>,
    values: &mut Vec<NodeId>,
) {
    for (leaf, value) in derive::gradient(graph, rate) {
        if let Node::State { slot, column } = leaf {
            entries.push(JacobianEntry { row, slot: slot as usize, column: column as usize });
            values.push(value);
        }
    }
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
