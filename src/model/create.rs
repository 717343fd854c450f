//! `create` and `destroy` among actions: what an agent is made of, and who is removed.
//!
//! Arguments are read where the action stands, on the state before the micro-step. What they do not give comes from what the
//! agent type declares, as at t = 0; `index` is 0.

use rustc_hash::FxHashMap;

use super::context::{Context, Member, Scope};
use super::error::{ActionError, SystemError};
use super::ir::{Action, Create, ExprKind, Given, TypeId};
use super::types::Ty;
use crate::base::Span;
use crate::syntax::ast::{self, GivenKind};

impl<'a> Context<'a> {
    /// `create Type(arguments) in Mode`; none, and a diagnostic, if it is wrong.
    pub fn create(&mut self, scope: &mut Scope<'a>, item: &'a ast::Constructor) -> Option<Action> {
        let ty = self.agent_named(&item.agent)?;
        if let Some(source) = &item.source {
            self.report(ActionError::CreatesMany { span: source.span, what: "a data file" });
        }
        if item.count.is_some() {
            self.report(ActionError::CreatesMany { span: item.span, what: "an array" });
        }
        let mode = self.start_mode(ty, item.start.as_deref());
        let names = &self.agents[ty.index()];
        let mut create = Create {
            ty,
            mode,
            params: vec![None; names.params.len()],
            states: vec![None; names.states.len()],
            discretes: vec![None; names.discretes.len()],
            links: vec![None; self.model.types[ty].links.len()],
            span: item.span,
        };
        let mut given = FxHashMap::default();
        for arg in &item.args {
            let (name, span) = (arg.name.text.as_str(), arg.name.span);
            if let Some(first) = given.insert(name, span) {
                let (name, help) = (name.to_string(), "leave one of them out");
                self.report(SystemError::GivenTwice { name, span, first, help });
            }
            self.member(scope, &mut create, arg);
        }
        self.miss(ty, &given, item.span);
        self.create_by_cases(create)
    }

    /// `destroy agent`; none, and a diagnostic, if it is not an agent.
    pub fn destroy(&mut self, scope: &mut Scope<'a>, agent: &'a ast::Expr, span: Span) -> Option<Action> {
        let value = self.lower(scope, agent);
        match value.ty {
            Ty::Agent(_) | Ty::Link(_) => self.act_on_each(value, &mut |context, agent| {
                let is_nobody = matches!(context.model.exprs[agent.id].kind, ExprKind::NoAgent);
                (!is_nobody).then_some(Action::Destroy { agent: agent.id, span })
            }),
            Ty::Wrong => None,
            Ty::Real | Ty::Int | Ty::Bool | Ty::Text | Ty::Nobody | Ty::List(_) => {
                let found = self.describe(value.ty);
                self.report(ActionError::DestroysNoAgent { span: agent.span, found });
                None
            }
        }
    }

    fn member(&mut self, scope: &mut Scope<'a>, create: &mut Create, arg: &'a ast::NamedArg) {
        let names = &self.agents[create.ty.index()];
        let (what, value) = (format!("`{}`", arg.name.text), &arg.given.value);
        let member = names.members.get(arg.name.text.as_str()).map(|(member, _)| *member);
        let (slot, place) = match member {
            Some(Member::Param(k)) => (names.params[k], &mut create.params[k]),
            Some(Member::State(k)) => (names.states[k], &mut create.states[k]),
            Some(Member::Discrete(k)) => (names.discretes[k], &mut create.discretes[k]),
            Some(Member::Link(k)) => {
                let link = &self.model.types[create.ty].links[k];
                let want = if link.required { Ty::Agent(link.ty) } else { Ty::Link(link.ty) };
                let agent = self.lower(scope, value);
                let agent = self.fit(agent, want, value.span, &what);
                create.links[k] = (agent.ty != Ty::Wrong).then_some(agent.id);
                return self.check_link_argument(create.ty, k, &arg.name);
            }
            Some(Member::Twice) => return,
            Some(Member::Let(_) | Member::Event(_)) | None => {
                let is_let = matches!(member, Some(Member::Let(_)));
                self.unknown_argument(create.ty, &arg.name, is_let);
                return;
            }
        };
        *place = match arg.given.kind {
            GivenKind::Value => {
                let value = self.lower_into(scope, value, slot, &what);
                (value.ty != Ty::Wrong).then_some(Given::Value(value.id))
            }
            GivenKind::Draw => self.lower_draw(scope, value, slot).map(Given::Draw),
        };
    }

    /// A link that follows from an expression is not given anything.
    pub fn check_link_argument(&mut self, ty: TypeId, link: usize, name: &ast::Name) {
        if !self.model.types[ty].links[link].cases.is_empty() {
            let (name, span) = (name.text.clone(), name.span);
            self.report(SystemError::FollowsLink { name, span });
        }
    }

    /// Reports what has no value, neither here nor where it is declared.
    fn miss(&mut self, ty: TypeId, given: &FxHashMap<&'a str, Span>, span: Span) {
        let model = &self.model.types[ty];
        let params = model.params.iter().map(|variable| ("parameter", &variable.name, variable.span));
        let states = model.states.iter().map(|variable| ("state", &variable.name, variable.span));
        let discretes =
            model.discretes.iter().map(|variable| ("discrete variable", &variable.name, variable.span));
        let links = model.links.iter().filter(|link| link.required);
        let links = links.map(|link| ("parameter", &link.name, link.span));
        let all = params.chain(states).chain(discretes).chain(links);
        let missing = all.filter(|(_, name, _)| {
            let member = self.agents[ty.index()].members.get(name.as_str());
            let is_named = member.is_some_and(|(member, _)| *member != Member::Twice);
            is_named && !given.contains_key(name.as_str()) && !self.declared_with_value(ty, name)
        });
        let missing = missing.map(|(kind, name, declared)| (kind, name.clone(), declared));
        for (kind, name, declared) in missing.collect::<Vec<_>>() {
            let agent = self.model.types[ty].name.clone();
            self.report(SystemError::Missing { kind, name, agent, span, declared });
        }
    }
}
