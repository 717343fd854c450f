//! Births: what agents start with, as functions of those who make them and of themselves.

use crate::base::Span;
use crate::calculus::aggregate;
use crate::calculus::draft::Draft;
use crate::calculus::error::Error;
use crate::calculus::frame::{Env, EnvId, Scope, Value};
use crate::calculus::system::{Birth, Initials, Source};
use crate::model::ir::{Create, ExprId, Given, TypeId, VarRef};

/// A `create` in the scope of its list of actions.
pub fn birth(draft: &mut Draft, scope: &mut Scope, create: &Create, name: &str) -> Result<Birth, Error> {
    let name = format!("{name} create {}", draft.model.types[create.ty].name);
    let mut given = Vec::new();
    for (variable, value) in all(&create.params, &create.states, &create.discretes) {
        given.push((variable, source(draft, scope, Scope::TOP, value, &name)?));
    }
    let mut links = Vec::new();
    for (number, link) in create.links.iter().enumerate() {
        if let Some(link) = link {
            links.push((number, agent(draft, scope, *link, create.span)?));
        }
    }
    Ok(Birth { ty: create.ty.index(), mode: create.mode.index(), given, links, span: create.span })
}

/// The slot of an agent; none for `none`.
pub fn agent(
    draft: &mut Draft,
    scope: &mut Scope,
    agent: ExprId,
    span: Span,
) -> Result<Option<usize>, Error> {
    match aggregate::value(draft, scope, Scope::TOP, agent)? {
        Value::Agent(agent) => scope.slot(draft.model, agent, span),
        Value::Number(_) | Value::Delayed(..) => unreachable!("the model is typed"),
    }
}

/// What is declared of the types whose agents are created.
pub fn initials(draft: &mut Draft) {
    let model = draft.model;
    let mut types: Vec<TypeId> = model.creations().iter().map(|create| create.ty).collect();
    types.sort_unstable();
    types.dedup();
    for ty in types {
        let made = declared(draft, ty);
        draft.types[ty.index()].initials = draft.keep(made).unwrap_or_default();
    }
}

fn declared(draft: &mut Draft, id: TypeId) -> Result<Initials, Error> {
    let ty = &draft.model.types[id];
    let mut scope = Scope::of_self(id);
    // One agent is no array: its index is 0.
    let index = Value::Number(draft.graph.number(0.0));
    let env = scope.env(Env { locals: vec![index], ..Env::default() });
    let name = format!("{} initial", ty.name);
    let mut values = Vec::new();
    for (k, given) in ty.initials.params.iter().enumerate() {
        if let Some(given) = given {
            values.push((VarRef::Param(k), source(draft, &mut scope, env, given, &name)?));
        }
    }
    for &variable in &ty.initials.order {
        let given = match variable {
            VarRef::State(k) => &ty.initials.states[k],
            VarRef::Discrete(k) => &ty.initials.discretes[k],
            VarRef::Param(_) | VarRef::Link(_) | VarRef::Let(_) => &None,
        };
        if let Some(given) = given {
            values.push((variable, source(draft, &mut scope, env, given, &name)?));
        }
    }
    Ok(Initials { frame: scope.into_frame(), values })
}

fn source(
    draft: &mut Draft,
    scope: &mut Scope,
    env: EnvId,
    given: &Given,
    name: &str,
) -> Result<Source, Error> {
    let mut functions = Vec::new();
    for id in given.exprs() {
        let node = aggregate::number(draft, scope, env, id)?;
        functions.push(draft.function(|| name.to_owned(), vec![node]));
    }
    Ok(match given {
        Given::Value(_) => Source::Number(functions[0]),
        Given::Draw(draw) => Source::Draw {
            distribution: draw.distribution,
            parameters: functions,
            span: draft.model.exprs[draw.all[0]].span,
        },
    })
}

/// What is given of parameters, states and discrete variables.
fn all<'g>(
    params: &'g [Option<Given>],
    states: &'g [Option<Given>],
    discretes: &'g [Option<Given>],
) -> impl Iterator<Item = (VarRef, &'g Given)> {
    let params = params.iter().enumerate().map(|(k, given)| (VarRef::Param(k), given));
    let states = states.iter().enumerate().map(|(k, given)| (VarRef::State(k), given));
    let discretes = discretes.iter().enumerate().map(|(k, given)| (VarRef::Discrete(k), given));
    let all = params.chain(states).chain(discretes);
    all.filter_map(|(variable, given)| given.as_ref().map(|given| (variable, given)))
}
