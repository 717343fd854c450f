//! A run without agents (HY0624), and transitions that nobody would miss (HY0625).
//!
//! A transition that only has a label marks an instant in the event log; one that has none, no target and no actions does nothing.

use super::Warning;
use super::transitions;
use super::unused::is_library;
use crate::base::Span;
use crate::model::context::Context;

/// A model that is to be run, of which `system` makes no agent.
pub(super) fn run(context: &Context, found: &mut Vec<Warning>) {
    let model = &context.model;
    if let Some(span) = model.run.span.filter(|_| is_library(model)) {
        let ty = model.visible_types().next().map(|id| model.types[id].name.clone());
        // The word itself: the block may have many lines.
        let span = Span { end: span.end.min(span.start + "run".len() as u32), ..span };
        found.push(Warning::NobodyRuns { ty, span });
    }
}

/// Transitions without a label, a target and actions.
pub(super) fn effects(context: &Context, found: &mut Vec<Warning>) {
    for transition in transitions(&context.model) {
        let is_labelled = !transition.label.contains('#');
        if transition.target.is_none() && transition.actions.is_empty() && !is_labelled {
            found.push(Warning::NoEffect { span: transition.span });
        }
    }
}
