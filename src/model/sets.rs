//! Sets that flows read (rule 13): `sum o in other Car: sin(o.th - th)` in a flow couples its owner with every car.
//!
//! In: a model with its population. Out: the same, where each agent whose flow ranges over a type has a link to every agent of
//! it. Nothing in the text names these links, and nothing but births and deaths changes them; by them the flow is a formula over agents
//! like any other, with its derivatives, its kinks and its couplings.

use std::sync::Arc;

use rustc_hash::FxHashSet;

use super::context::Context;
use super::error::LimitError;
use super::ir::{AgentType, ExprId, ExprKind, Link, Set, Trigger, Type, TypeId};
use super::limits::REACHED_MAX;
use super::membership::Named;
use super::operands::for_each_operand;
use crate::base::Span;

/// Gives agents links to all members of the sets that their flows read.
pub(super) fn fill(context: &mut Context) {
    let ranges =
        |id| matches!(context.model.exprs[id].kind, ExprKind::Quantifier { .. } | ExprKind::Aggregate { .. });
    if context.has_errors() || !context.model.exprs.indices().any(ranges) {
        return;
    }
    let created: FxHashSet<TypeId> = context.model.creations().iter().map(|create| create.ty).collect();
    for ty in context.model.types.indices().collect::<Vec<_>>() {
        for (set, span) in sets_read(context, ty) {
            // Who is created belongs to no name of `system`.
            let grows = set.block.is_none() && created.contains(&set.ty);
            let room = if grows { context.model.limits.joining_max } else { 0 };
            link_all(context, ty, set, room, span);
        }
    }
}

/// The sets that flows and hazards of a type range over, each once, with where they first do.
fn sets_read(context: &Context, ty: TypeId) -> Vec<(Named, Span)> {
    let model = &context.model;
    let rates = model.types[ty].transitions.iter().filter_map(|transition| match transition.trigger {
        Trigger::Rate { rate, .. } => Some(rate),
        _ => None,
    });
    let flows = equations(&model.types[ty]).map(|(_, rate)| rate);
    let mut pending: Vec<ExprId> = flows.chain(rates).collect();
    pending.reverse();
    let (mut seen, mut found) = (FxHashSet::default(), Vec::<(Named, Span)>::new());
    while let Some(id) = pending.pop() {
        if !seen.insert(id) {
            continue;
        }
        let expr = &model.exprs[id];
        match &expr.kind {
            ExprKind::Quantifier { binder, .. } | ExprKind::Aggregate { binder, .. } => {
                let binder = &model.binders[*binder];
                let set = Named { ty: binder.ty, block: binder.block };
                if !found.iter().any(|(known, _)| *known == set) {
                    found.push((set, expr.span));
                }
            }
            ExprKind::Let(agent, number) => pending.extend(context.let_value(*agent, *number)),
            ExprKind::Rate(agent, state) => {
                if let Type::Agent(ty) | Type::Link(ty) = model.exprs[*agent].ty {
                    pending.extend(
                        equations(&model.types[ty]).filter(|(of, _)| of == state).map(|(_, rate)| rate),
                    );
                }
            }
            ExprKind::Call(function, _) => pending.push(model.functions[*function].body),
            _ => {}
        }
        for_each_operand(&expr.kind, |operand| pending.push(operand));
    }
    found
}

/// The equations of a type, in all its modes: of which state, and what.
fn equations(ty: &AgentType) -> impl Iterator<Item = (usize, ExprId)> {
    ty.modes.iter().flat_map(|mode| &mode.flow).map(|&(state, rate, _)| (state, rate))
}

/// Gives every agent of a type a link to each of a set, and room for those who come to be.
fn link_all(context: &mut Context, ty: TypeId, set: Named, room: usize, span: Span) {
    let Named { ty: of, block } = set;
    let model = &mut context.model;
    let agents = &model.population.agents;
    let within = match block.and_then(|number| model.population.blocks.get(number)) {
        Some(block) => block.first..block.first + block.count,
        None => 0..agents.len(),
    };
    let members: Vec<usize> = within.filter(|&number| agents[number].ty == of).collect();
    let count = members.len();
    if count + room > 2 * REACHED_MAX {
        // No equation can read them: they would only take memory, by the square of their number.
        return context.report(LimitError::Reached { count: count + room, most: REACHED_MAX, span });
    }
    let present = members.iter().map(|&number| model.population.agent_name(number));
    let names: Vec<String> = present.chain((count..count + room).map(|k| format!("member {k}"))).collect();
    let links = names.into_iter().map(|name| Link { name, ty: of, required: false, cases: Vec::new(), span });
    let owner = &mut model.types[ty];
    owner.sets.push(Set { ty: of, block, first: owner.links.len(), count, room });
    owner.links.extend(links);
    for agent in Arc::make_mut(&mut model.population.agents).iter_mut().filter(|agent| agent.ty == ty) {
        agent.links.extend(members.iter().map(|&member| Some(member)));
        agent.links.extend(std::iter::repeat_n(None, room));
    }
}
