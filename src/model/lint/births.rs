//! Links that nothing sets (HY0622), and agents each of which makes the next as it begins (HY0623).
//!
//! A link is set by whoever makes the agent, or by its own expression; what is written nowhere stays none, whatever the parameters
//! are. Births: only an action that stands in no `if`, in the entry of a mode in which the new agent begins, is certain.

use super::Warning;
use super::unused::{each_action, is_library, lists, meant};
use crate::model::context::Context;
use crate::model::ir::{Action, ExprKind, ModeId, Model, TypeId};

/// Links that are read, and that no constructor names.
pub(super) fn unset_links(context: &Context, found: &mut Vec<Warning>) {
    let model = &context.model;
    if is_library(model) {
        return;
    }
    let made =
        |ty: TypeId| model.population.blocks.iter().any(|block| block.ty == ty) || is_created(model, ty);
    let read = read_links(model);
    for (id, ty) in model.types.iter_enumerated().filter(|(id, _)| made(*id)) {
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
            if !in_system && !is_given(model, id, number) {
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
                Action::Create(create) if create.ty == id && begins_in(model, id, create.mode, mode) => {
                    Some(create)
                }
                _ => None,
            });
            if let Some(create) = next {
                found.push(Warning::EndlessBirths { agent: ty.name.clone(), span: create.span });
            }
        }
    }
}

/// Whether an agent that starts in a leaf is in a mode then.
fn begins_in(model: &Model, ty: TypeId, leaf: ModeId, mode: ModeId) -> bool {
    model.types[ty].is_inside(leaf, mode)
}

fn is_created(model: &Model, ty: TypeId) -> bool {
    model.creations().iter().any(|create| create.ty == ty)
}

/// Whether some `create` gives a link an agent.
fn is_given(model: &Model, ty: TypeId, link: usize) -> bool {
    let mut given = false;
    for list in lists(model) {
        each_action(list, &mut |action| {
            if let Action::Create(create) = action {
                given |= create.ty == ty && create.links.get(link).is_some_and(Option::is_some);
            }
        });
    }
    given
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
