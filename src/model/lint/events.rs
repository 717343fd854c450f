//! Events that nobody emits, or nobody hears (HY0615).

use rustc_hash::FxHashSet;

use super::Warning;
use super::unused::{each_action, is_library, lists, meant};
use crate::model::context::Context;
use crate::model::ir::{Action, Model, Trigger, TypeId};
use crate::model::types::Ty;

/// Events of types that have agents.
pub(super) fn idle(context: &Context, found: &mut Vec<Warning>) {
    let model = &context.model;
    if is_library(model) {
        return;
    }
    let (emitted, heard) = (emitted(model), heard(model));
    for (id, ty) in model.types.iter_enumerated() {
        let is_made = model.population.blocks.iter().any(|block| block.ty == id);
        for (number, event) in ty.events.iter().enumerate() {
            let (emitted, heard) = (emitted.contains(&(id, number)), heard.contains(&(id, number)));
            if is_made && !(emitted && heard) && !meant(&event.name) {
                let (name, agent, span) = (event.name.clone(), ty.name.clone(), event.span);
                found.push(Warning::IdleEvent { name, agent, span, emitted, heard });
            }
        }
    }
}

/// The events that some action emits.
fn emitted(model: &Model) -> FxHashSet<(TypeId, usize)> {
    let mut emitted = FxHashSet::default();
    for list in lists(model) {
        each_action(list, &mut |action| {
            if let Action::Emit { agent, event, .. } = action
                && let Some(ty) = Ty::from(model.exprs[*agent].ty).agent_type()
            {
                emitted.insert((ty, *event));
            }
        });
    }
    emitted
}

/// The events for which some agent has an `on`.
fn heard(model: &Model) -> FxHashSet<(TypeId, usize)> {
    let made = |id: TypeId| model.population.blocks.iter().any(|block| block.ty == id);
    let types = model.types.iter_enumerated().filter(|(id, _)| made(*id));
    let triggers = types.flat_map(|(_, ty)| &ty.transitions).map(|transition| &transition.trigger);
    let events = triggers.flat_map(|trigger| match trigger {
        Trigger::On { events, .. } => events.as_slice(),
        Trigger::When(_) | Trigger::After(..) | Trigger::Every(..) | Trigger::Rate { .. } => &[],
    });
    events.copied().collect()
}
