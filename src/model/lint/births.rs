//! Links that nothing sets (HY0622), and agents each of which makes the next as it begins (HY0623).
//!
//! A link is set by whoever makes the agent, or by its own expression; what is written nowhere stays none, whatever the parameters
//! are. Births: only an action that stands in no `if`, in the entry of a mode in which the new agent begins, is certain.

use super::Warning;
use super::unused::{is_library, made, meant};
use crate::model::context::Context;
use crate::model::ir::{Action, Create, ExprKind, Model, TypeId};

/// Links that are read, and that no constructor names.
pub(super) fn unset_links(context: &Context, found: &mut Vec<Warning>) {
    let model = &context.model;
    if is_library(model) {
        return;
    }
    let (made, creations, read) = (made(model), model.creations(), read_links(model));
    for (id, ty) in model.types.iter_enumerated().filter(|(id, _)| made.contains(id)) {
        for (number, link) in ty.declared_links().iter().enumerate() {
            let is_set = link.required || !link.cases.is_empty();
            if is_set || meant(&link.name) || !read.contains(&(id, number)) {
                continue;
            }
            let in_system = context.instances.iter().any(|instance| {
                let constructor = &instance.constructor;
                constructor.agent.text == ty.name
                    && constructor.args.iter().any(|arg| arg.name.text == link.name)
            });
            let gives =
                |create: &&Create| create.ty == id && create.links.get(number).is_some_and(Option::is_some);
            if !in_system && !creations.iter().any(gives) {
                let (name, agent, span) = (link.name.clone(), ty.name.clone(), link.span);
                found.push(Warning::NeverSet { name, agent, span });
            }
        }
    }
}

/// Types each of whose agents makes another one of its type as it begins.
pub(super) fn endless(context: &Context, found: &mut Vec<Warning>) {
    let model = &context.model;
    for (id, ty) in model.types.iter_enumerated() {
        for mode in ty.modes.indices() {
            let next = ty.modes[mode].entry.iter().find_map(|action| match action {
                Action::Create(create) if create.ty == id && ty.is_inside(create.mode, mode) => Some(create),
                _ => None,
            });
            if let Some(create) = next {
                found.push(Warning::EndlessBirths { agent: ty.name.clone(), span: create.span });
            }
        }
    }
}

/// The links that some expression reads.
fn read_links(model: &Model) -> rustc_hash::FxHashSet<(TypeId, usize)> {
    let links = model.exprs.iter().filter_map(|expr| match expr.kind {
        ExprKind::Link(agent, number) => {
            let ty = crate::model::types::Ty::from(model.exprs[agent].ty).agent_type()?;
            Some((ty, number))
        }
        _ => None,
    });
    links.collect()
}
