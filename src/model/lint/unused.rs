//! Names that nothing mentions (HY0601), discrete variables that nothing reads (HY0602), types without agents (HY0603).
//!
//! A file without `system` is a library: what it declares may be used elsewhere, so only what nobody else can see is looked
//! at: parameters of functions, bound agents, participants. States are output, and never unused; so are labels. A variable
//! that is recorded is used, and so is one that exists because the data file has its column. An agent type without agents is told once, not once for each of its members.

use rustc_hash::FxHashSet;

use super::{Warning, any_within, guard};
use crate::base::Span;
use crate::model::context::{Body, Context, Meaning, Progress};
use crate::model::ir::{
    Action, Aggregate, ExprId, ExprKind, Given, Interaction, Model, Trigger, TypeId, VarRef,
};
use crate::model::types::Ty;
use crate::syntax::ast::Formal;

/// A name that says of itself that it is not used.
pub(super) fn meant(name: &str) -> bool {
    name.starts_with('_')
}

fn unused(name: &str, what: String, span: Span) -> Option<Warning> {
    (!meant(name)).then(|| Warning::Unused { name: name.to_string(), what, span })
}

/// Parameters, `let`s and functions of the file, `let`s of interactions, parameters of functions.
pub(super) fn definitions(context: &Context, found: &mut Vec<Warning>) {
    let is_library = is_library(&context.model);
    for definition in &context.definitions {
        let name = definition.name;
        let what = match definition.body {
            Body::Param(_) => "a parameter of the file",
            Body::Let(_) => "a definition",
            Body::Function(_) => "a function that nothing calls",
            Body::PairLet(..) => "a definition of the interaction",
            Body::AgentLet(..) => continue,
        };
        if !definition.used && (!is_library || matches!(definition.body, Body::PairLet(..))) {
            found.extend(unused(&name.text, what.to_string(), name.span));
        }
        let (Body::Function(item), Progress::Done(Meaning::Function(function))) =
            (definition.body, definition.progress)
        else {
            continue;
        };
        let body = context.model.functions[function].body;
        for (k, formal) in item.formals.iter().enumerate() {
            let reads =
                |id: ExprId| matches!(context.model.exprs[id].kind, ExprKind::Local(number) if number == k);
            if !meant(&formal.name.text) && !any_within(&context.model, vec![body], reads) {
                let what = format!("a parameter that `{}` does not read", name.text);
                found.extend(unused(&formal.name.text, what, formal.name.span));
            }
        }
    }
}

/// Whether the file makes no agents.
pub(super) fn is_library(model: &Model) -> bool {
    model.population.blocks.is_empty()
}

/// The types of which `system` or some action makes agents.
pub(super) fn made(model: &Model) -> FxHashSet<TypeId> {
    let mut made: FxHashSet<TypeId> = model.population.blocks.iter().map(|block| block.ty).collect();
    made.extend(model.creations().iter().map(|create| create.ty));
    made
}

/// Parameters, links, `let`s and discrete variables of agents; and types without agents.
pub(super) fn members(context: &Context, found: &mut Vec<Warning>) {
    let model = &context.model;
    if is_library(model) {
        return;
    }
    let made = made(model);
    let (read, written) = (read(model), written(model));
    for (id, ty) in model.visible_types().map(|id| (id, &model.types[id])) {
        if !made.contains(&id) {
            if !meant(&ty.name) {
                found.push(Warning::NoAgents { name: ty.name.clone(), span: ty.span });
            }
            continue;
        }
        let idle = |variable: VarRef| {
            !read.contains(&(id, variable)) && !context.from_data.contains(&(id, variable))
        };
        for (_, param) in ty.params.iter().enumerate().filter(|(k, _)| idle(VarRef::Param(*k))) {
            found.extend(unused(&param.name, format!("a parameter of `{}`", ty.name), param.span));
        }
        for (_, link) in ty.links.iter().enumerate().filter(|(k, _)| idle(VarRef::Link(*k))) {
            found.extend(unused(&link.name, format!("a link of `{}`", ty.name), link.span));
        }
        for (_, item) in ty.lets.iter().enumerate().filter(|(k, _)| idle(VarRef::Let(*k))) {
            found.extend(unused(&item.name, format!("a definition of `{}`", ty.name), item.span));
        }
        // What nobody runs here may be recorded by whoever does.
        if model.run.span.is_none() {
            continue;
        }
        for (k, discrete) in ty.discretes.iter().enumerate().filter(|(k, _)| idle(VarRef::Discrete(*k))) {
            if !meant(&discrete.name) {
                let written = written.contains(&(id, k));
                let (name, agent, span) = (discrete.name.clone(), ty.name.clone(), discrete.span);
                found.push(Warning::NeverRead { name, agent, span, written });
            }
        }
    }
}

/// The variables of agents that some expression reads or that are recorded.
fn read(model: &Model) -> FxHashSet<(TypeId, VarRef)> {
    let mut read = FxHashSet::default();
    for expr in model.exprs.iter() {
        let (agent, variable) = match expr.kind {
            ExprKind::Link(agent, k) => (agent, VarRef::Link(k)),
            ExprKind::Discrete(agent, k) => (agent, VarRef::Discrete(k)),
            ExprKind::AgentParam(agent, k) => (agent, VarRef::Param(k)),
            ExprKind::Let(agent, k) => (agent, VarRef::Let(k)),
            _ => continue,
        };
        if let Some(ty) = Ty::from(model.exprs[agent].ty).agent_type() {
            read.insert((ty, variable));
        }
    }
    for record in &model.run.records {
        for (ty, variables) in model.types.indices().zip(&record.variables) {
            read.extend(variables.iter().flatten().map(|variable| (ty, *variable)));
        }
    }
    read
}

/// The discrete variables that some action writes.
fn written(model: &Model) -> FxHashSet<(TypeId, usize)> {
    let mut written = FxHashSet::default();
    for list in lists(model) {
        each_action(list, &mut |action| {
            if let Action::Assign { agent, variable: VarRef::Discrete(k), .. }
            | Action::Draw { agent, variable: VarRef::Discrete(k), .. } = action
                && let Some(ty) = Ty::from(model.exprs[*agent].ty).agent_type()
            {
                written.insert((ty, *k));
            }
        });
    }
    written
}

/// All lists of actions.
pub(super) fn lists(model: &Model) -> impl Iterator<Item = &Vec<Action>> {
    let own = model.types.iter().flat_map(|ty| {
        let modes = ty.modes.iter().flat_map(|mode| [&mode.entry, &mode.exit]);
        modes.chain(ty.transitions.iter().map(|transition| &transition.actions))
    });
    let pairs = model.interactions.iter().flat_map(|interaction| &interaction.transitions);
    own.chain(pairs.map(|transition| &transition.actions))
}

/// Calls `each` with every action, those in branches included.
pub(super) fn each_action<'m>(list: &'m [Action], each: &mut dyn FnMut(&'m Action)) {
    for action in list {
        each(action);
        if let Action::If { then, otherwise, .. } = action {
            each_action(then, each);
            each_action(otherwise, each);
        }
    }
}

/// Agents that quantifiers bind, and participants of interactions.
pub(super) fn bound(context: &Context, found: &mut Vec<Warning>) {
    let model = &context.model;
    let mut idle = vec![true; model.binders.len()];
    for expr in model.exprs.iter() {
        match expr.kind {
            ExprKind::Bound(binder) => idle[binder.index()] = false,
            // `exists o in Car` asks for no more than that there is one.
            ExprKind::Quantifier { binder, filter: None, body, .. } if is_number(model, body) => {
                idle[binder.index()] = false;
            }
            // `count o in Car` asks how many there are.
            ExprKind::Aggregate { kind: Aggregate::Count, binder, filter: None, .. } => {
                idle[binder.index()] = false;
            }
            _ => {}
        }
    }
    for (binder, _) in model.binders.iter().zip(idle).filter(|(_, idle)| *idle) {
        let what = "bound here, but what follows does not ask about it".to_string();
        found.extend(unused(&binder.name, what, binder.span));
    }
    for names in &context.pairs {
        if let Some(id) = names.id {
            participants(model, &model.interactions[id], &names.item.formals, found);
        }
    }
}

fn is_number(model: &Model, id: ExprId) -> bool {
    matches!(model.exprs[id].kind, ExprKind::Number(_))
}

fn participants(model: &Model, interaction: &Interaction, formals: &[Formal], found: &mut Vec<Warning>) {
    for (which, formal) in formals.iter().enumerate().take(2) {
        let mut roots = Vec::new();
        let mut moved = false;
        for transition in &interaction.transitions {
            roots.extend(guard(transition).into_iter().chain(transition.priority));
            if let Trigger::After(time, _) | Trigger::Every(time, _) | Trigger::Rate { rate: time, .. } =
                transition.trigger
            {
                roots.push(time);
            }
            each_action(&transition.actions, &mut |action| match action {
                Action::Assign { agent, value, .. } => roots.extend([*agent, *value]),
                Action::Draw { agent, parameters, .. } => {
                    roots.push(*agent);
                    roots.extend(parameters);
                }
                Action::Emit { agent, values, delay, .. } => {
                    roots.push(*agent);
                    roots.extend(values.iter().chain(delay));
                }
                Action::If { condition, .. } => roots.push(*condition),
                Action::Goto { participant, .. } => moved |= *participant == which,
                Action::Create(create) => {
                    let given = create.params.iter().chain(&create.states).chain(&create.discretes);
                    roots.extend(given.flatten().flat_map(Given::exprs));
                    roots.extend(create.links.iter().flatten());
                }
                Action::Destroy { agent, .. } => roots.push(*agent),
                Action::Stop { .. } => {}
            });
        }
        let is_it = |id: ExprId| matches!(model.exprs[id].kind, ExprKind::Participant(k) if k == which);
        if !moved && !any_within(model, roots, is_it) {
            let what = format!("takes part in `{}`, but has no part in it", interaction.name);
            found.extend(unused(&formal.name.text, what, formal.name.span));
        }
    }
}
