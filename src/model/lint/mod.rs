//! What a careful reader would ask about a model that is right: names without a use, modes that nothing enters, conditions
//! that are settled before the run.
//!
//! In: the model with its tables of names, without errors. Out: warnings (HY06xx), none of which stops a run. A name that
//! begins with `_` says that it is meant to be unused. What needs derivatives or bounds is asked by `calculus::lint`.

mod warning;
mod unused;
mod events;
mod births;
mod unreached;
mod settled;
mod repeated;
mod lookalike;
mod beside;
mod idle;

use super::context::Context;
use super::ir::{ExprId, Model, Transition, Trigger};
use super::operands::for_each_operand;
use crate::base::Diagnostic;
use warning::Warning;

/// Names that nothing uses, types without agents, modes that nothing enters: of an imported file other models may do so.
const OF_USE: [&str; 4] = ["HY0601", "HY0602", "HY0603", "HY0604"];

/// Everything worth a warning, in the order of the text.
pub(super) fn lint(context: &mut Context) -> Vec<Diagnostic> {
    if context.has_errors() {
        return Vec::new();
    }
    let mut found = Vec::new();
    unused::definitions(context, &mut found);
    unused::members(context, &mut found);
    unused::bound(context, &mut found);
    events::idle(context, &mut found);
    idle::run(context, &mut found);
    idle::effects(context, &mut found);
    births::unset_links(context, &mut found);
    births::endless(context, &mut found);
    unreached::modes(context, &mut found);
    lookalike::names(context, &mut found);
    beside::numbers(context, &mut found);
    settled::conditions(context, &mut found);
    repeated::conditions(context, &mut found);
    let mut found: Vec<Diagnostic> = found.into_iter().map(Diagnostic::from).collect();
    let main = context.model.files.last().copied();
    found.retain(|diagnostic| {
        let is_of_model = diagnostic.labels.first().is_none_or(|label| Some(label.span.file) == main);
        is_of_model || !OF_USE.contains(&diagnostic.code)
    });
    found.sort_by_key(|diagnostic| diagnostic.labels.first().map(|label| label.span));
    found.dedup();
    found
}

/// Every transition, those of agents first.
fn transitions(model: &Model) -> impl Iterator<Item = &Transition> {
    let own = model.types.iter().flat_map(|ty| &ty.transitions);
    own.chain(model.interactions.iter().flat_map(|interaction| &interaction.transitions))
}

/// The condition of a transition, if it has one.
fn guard(transition: &Transition) -> Option<ExprId> {
    match transition.trigger {
        Trigger::When(guard) => Some(guard),
        Trigger::After(_, guard) | Trigger::Every(_, guard) => guard,
        Trigger::On { guard, .. } | Trigger::Rate { guard, .. } => guard,
    }
}

/// Whether one of the expressions that `roots` are made of is such; what functions and `let`s of agents say is not entered.
fn any_within(model: &Model, roots: Vec<ExprId>, is_such: impl Fn(ExprId) -> bool) -> bool {
    let mut seen = rustc_hash::FxHashSet::default();
    let mut pending = roots;
    while let Some(id) = pending.pop() {
        if !seen.insert(id) {
            continue;
        }
        if is_such(id) {
            return true;
        }
        for_each_operand(&model.exprs[id].kind, |operand| pending.push(operand));
    }
    false
}
