//! Transitions that the constants of the file keep from ever firing (HY0605).
//!
//! A term of a guard's outermost `and` that reads nothing but constants and is false. A bare truth value is a switch
//! (`when noisy and ...` with `param noisy: bool = false`), thrown on purpose, and not reported. What only the agents'
//! variables rule out is found in `calculus::lint`.

use super::{Warning, guard, transitions};
use crate::base::Span;
use crate::math::Op;
use crate::model::context::Context;
use crate::model::evaluate::Known;
use crate::model::ir::{ExprId, ExprKind, Model, Trigger, Type};

/// A constant that decides over a transition.
struct Question {
    /// The constant.
    id: ExprId,
    /// The value with which the transition never fires.
    never: f64,
    label: String,
    transition: Span,
}

/// Looks at every guard and every delay.
pub(super) fn conditions(context: &mut Context, found: &mut Vec<Warning>) {
    for Question { id, never, label, transition } in questions(context) {
        let value = context.evaluator.evaluate(&context.model, id, &Known::default());
        if value != Some(never) {
            continue;
        }
        let span = context.model.exprs[id].span;
        found.push(if never == 0.0 {
            Warning::NeverTrue { label, span, transition }
        } else {
            Warning::Endless { label, span }
        });
    }
}

fn questions(context: &Context) -> Vec<Question> {
    let (model, mut questions) = (&context.model, Vec::new());
    let is_closed = |id: ExprId| context.facts[id.index()].closed;
    for transition in transitions(model) {
        let question = |id: ExprId, never: f64| {
            let (label, transition) = (transition.label.clone(), transition.span);
            Question { id, never, label, transition }
        };
        let terms = guard(transition).map_or(Vec::new(), |guard| terms(model, guard));
        let closed = terms.into_iter().filter(|&id| is_closed(id) && !is_switch(model, id));
        questions.extend(closed.map(|id| question(id, 0.0)));
        if let Trigger::After(delay, _) = transition.trigger
            && is_closed(delay)
        {
            questions.push(question(delay, f64::INFINITY));
        }
    }
    questions
}

/// The terms of the outermost `and`.
fn terms(model: &Model, guard: ExprId) -> Vec<ExprId> {
    let (mut terms, mut pending) = (Vec::new(), vec![guard]);
    while let Some(id) = pending.pop() {
        match &model.exprs[id].kind {
            ExprKind::Apply(Op::And, operands) => pending.extend(operands),
            _ => terms.push(id),
        }
    }
    terms
}

/// Whether it is a truth value as such, or its negation.
fn is_switch(model: &Model, id: ExprId) -> bool {
    match &model.exprs[id].kind {
        ExprKind::Number(_) => model.exprs[id].ty == Type::Bool,
        ExprKind::Apply(Op::Not, operands) => is_switch(model, operands[0]),
        _ => false,
    }
}
