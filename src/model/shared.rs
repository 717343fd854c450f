//! Whole numbers that agents compare with each other's: the lane of a car, the floor of a lift, the track of a train.
//!
//! `o.lane == lane + 1` asks who is beside an agent, so the number says where it is. A counter is compared with constants, or with
//! what its own agent has.

use rustc_hash::FxHashSet;

use super::ir::{ExprId, ExprKind, Model, Type, TypeId, VarRef};
use super::operands::for_each_operand;
use crate::math::Op;

/// The whole discrete variables and parameters of one agent type that some `==` has on both sides, of different agents.
pub fn shared_places(model: &Model) -> FxHashSet<(TypeId, VarRef)> {
    let mut found = FxHashSet::default();
    for expr in model.exprs.iter() {
        let ExprKind::Apply(Op::Eq, operands) = &expr.kind else { continue };
        let [left, right] = operands[..] else { continue };
        let (left, right) = (whole_numbers(model, left), whole_numbers(model, right));
        for (place, agent) in &left {
            let of_another = |(other_place, other): &(_, ExprId)| {
                other_place == place && !is_same(&model.exprs[*agent].kind, &model.exprs[*other].kind)
            };
            if right.iter().any(of_another) {
                found.insert(*place);
            }
        }
    }
    found
}

/// The whole variables that an expression reads, each with its agent.
fn whole_numbers(model: &Model, root: ExprId) -> Vec<((TypeId, VarRef), ExprId)> {
    let (mut found, mut pending) = (Vec::new(), vec![root]);
    while let Some(id) = pending.pop() {
        let expr = &model.exprs[id];
        let read = match expr.kind {
            ExprKind::Discrete(agent, number) => Some((agent, VarRef::Discrete(number))),
            ExprKind::AgentParam(agent, number) => Some((agent, VarRef::Param(number))),
            _ => None,
        };
        if let Some((agent, variable)) = read.filter(|_| expr.ty == Type::Int)
            && let Type::Agent(ty) | Type::Link(ty) = model.exprs[agent].ty
        {
            found.push(((ty, variable), agent));
        }
        // Conditions within it are looked at by themselves.
        if matches!(expr.kind, ExprKind::Apply(..)) {
            for_each_operand(&expr.kind, |operand| pending.push(operand));
        }
    }
    found
}

/// Whether two expressions certainly name the same agent.
fn is_same(agent: &ExprKind, other: &ExprKind) -> bool {
    match (agent, other) {
        (ExprKind::SelfAgent, ExprKind::SelfAgent) => true,
        (ExprKind::Participant(a), ExprKind::Participant(b)) | (ExprKind::Local(a), ExprKind::Local(b)) => {
            a == b
        }
        (ExprKind::Bound(a), ExprKind::Bound(b)) => a == b,
        (ExprKind::Link(_, a), ExprKind::Link(_, b)) => a == b,
        _ => false,
    }
}
