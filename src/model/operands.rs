//! The expressions that an expression is made of.

use super::ir::{ExprId, ExprKind};

/// Calls `each` with every operand, the agent of a member included, in the order of the text.
pub(super) fn for_each_operand(kind: &ExprKind, mut each: impl FnMut(ExprId)) {
    match kind {
        ExprKind::Number(_)
        | ExprKind::Time
        | ExprKind::Local(_)
        | ExprKind::Received(_)
        | ExprKind::SelfAgent
        | ExprKind::Participant(_)
        | ExprKind::Bound(_)
        | ExprKind::NoAgent => {}
        ExprKind::Link(agent, _)
        | ExprKind::State(agent, _)
        | ExprKind::Rate(agent, _)
        | ExprKind::Discrete(agent, _)
        | ExprKind::AgentParam(agent, _)
        | ExprKind::Let(agent, _)
        | ExprKind::Present(agent)
        | ExprKind::Is(agent, _) => each(*agent),
        ExprKind::Apply(_, operands) => operands.iter().for_each(|&id| each(id)),
        ExprKind::Call(_, arguments) => arguments.iter().for_each(|&id| each(id)),
        ExprKind::Same(left, right) => {
            each(*left);
            each(*right);
        }
        ExprKind::Quantifier { filter, body, .. } => {
            filter.iter().for_each(|&id| each(id));
            each(*body);
        }
        ExprKind::Aggregate { filter, term, .. } => {
            filter.iter().chain(term).for_each(|&id| each(id));
        }
        ExprKind::Rising(operand) | ExprKind::Crossing(operand) => each(*operand),
    }
}
