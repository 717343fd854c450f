//! Names: what a name, a member behind a dot, a rate and a mode stand for in their scope.

use std::f64::consts::PI;

use super::context::{Context, Global, GlobalKind, Home, Meaning, Member, PairNames, Scope, Value};
use super::error::{ModeError, NameError, PropertyError, TypeError};
use super::ir::{Destination, ExprId, ExprKind, Inside, ModeId, TypeId};
use super::suggest::closest;
use super::types::Ty;
use super::units;
use crate::base::Span;
use crate::math::Op;
use crate::syntax::ast;

/// Constants and places of the language that are written as names.
const CONSTANTS: &[&str] = &["pi", "inf", "true", "false", "none", "time", "self", "index"];

impl<'a> Context<'a> {
    /// The value of a name.
    pub fn lower_name(&mut self, scope: &mut Scope<'a>, name: &'a str, span: Span) -> Value {
        if CONSTANTS.contains(&name) {
            return self.lower_constant(scope, name, span);
        }
        if let Some(&(_, binder)) = scope.bound.iter().rev().find(|(bound, _)| *bound == name) {
            let ty = self.model.binders[binder].ty;
            return self.push(ExprKind::Bound(binder), Ty::Agent(ty), span);
        }
        if let Some(&(_, link)) = scope.nearest.iter().find(|(bound, _)| *bound == name) {
            return link;
        }
        if let Some(number) = scope.locals.iter().position(|(local, _)| *local == name) {
            let slot = scope.locals[number].1;
            let value = self.push(ExprKind::Local(number), slot.ty, span);
            self.quantities.insert(value.id, slot.quantity());
            return value;
        }
        if let Some(number) = scope.received.iter().position(|(value, _)| *value == name) {
            let slot = scope.received[number].1;
            let value = self.push(ExprKind::Received(number), slot.ty, span);
            self.quantities.insert(value.id, slot.quantity());
            return value;
        }
        match scope.home {
            Home::Agent(ty, mode) => {
                if let Some(member) = self.visible_member(ty, mode, name) {
                    let agent = self.push(ExprKind::SelfAgent, Ty::Agent(ty), span);
                    return self.lower_member(agent, ty, member, name, span);
                }
            }
            Home::Initial(ty) => {
                if let Some(&(member, _)) = self.agents[ty.index()].members.get(name) {
                    let agent = self.push(ExprKind::SelfAgent, Ty::Agent(ty), span);
                    return self.lower_member(agent, ty, member, name, span);
                }
            }
            Home::Pair(number) => {
                if let Some(value) = self.lower_in_pair(number, name, span) {
                    return value;
                }
            }
            Home::File | Home::Function | Home::Construction => {}
        }
        match self.globals.get(name) {
            Some(&Global { kind: GlobalKind::Definition(number), .. }) => {
                self.lower_definition(number, name, span)
            }
            Some(&global) => self
                .lower_single(scope.home, global.kind, name, span)
                .unwrap_or_else(|| self.not_a_value(scope.home, global.kind, name, span)),
            None => self.unknown_name(scope, name, span),
        }
    }

    fn lower_constant(&mut self, scope: &Scope<'a>, name: &str, span: Span) -> Value {
        match (name, scope.home) {
            ("pi", _) => self.bare_number(PI, Ty::Real, span),
            ("inf", _) => self.bare_number(f64::INFINITY, Ty::Real, span),
            ("true", _) => self.number(1.0, Ty::Bool, span),
            ("false", _) => self.number(0.0, Ty::Bool, span),
            ("none", _) => self.push(ExprKind::NoAgent, Ty::Nobody, span),
            ("time", _) => self.push(ExprKind::Time, Ty::Real, span),
            ("self", Home::Agent(ty, _)) if self.is_watcher(ty) => {
                self.report(PropertyError::NoSelf { span });
                self.wrong(span)
            }
            ("self", Home::Agent(ty, _) | Home::Initial(ty)) => {
                self.push(ExprKind::SelfAgent, Ty::Agent(ty), span)
            }
            ("index", Home::Initial(_) | Home::Construction) => self.push(ExprKind::Local(0), Ty::Int, span),
            ("self", Home::Pair(_)) => {
                let help = "name one of the participants";
                self.not_here(name, span, "has no meaning in an interaction, which has two agents", help)
            }
            ("self", _) => {
                let help = "give the function a parameter of the agent's type";
                self.not_here(name, span, "is the agent whose text this is, and this is not an agent's", help)
            }
            _ => {
                let help = "keep it in a parameter: `agent Car(k: int)` and `cars = Car[N](k = index)`";
                self.not_here(name, span, "is known only while an agent is made", help)
            }
        }
    }

    fn not_here(&mut self, name: &str, span: Span, why: &'static str, help: &'static str) -> Value {
        self.report(NameError::NotHere { name: name.to_string(), span, why, help });
        self.wrong(span)
    }

    /// A member of an agent type or a `let` of a mode around this place.
    fn visible_member(&self, ty: TypeId, mode: ModeId, name: &str) -> Option<Member> {
        let names = &self.agents[ty.index()];
        let mut around = Some(mode);
        while let Some(id) = around {
            if let Some(&number) = names.mode_lets[id.index()].get(name) {
                return Some(Member::Let(number));
            }
            around = self.model.types[ty].modes[id].parent;
        }
        names.members.get(name).map(|(member, _)| *member)
    }

    fn lower_in_pair(&mut self, number: usize, name: &str, span: Span) -> Option<Value> {
        if let Some(participants) = self.pairs[number].participants {
            if let Some(which) = participants.iter().position(|(participant, _)| *participant == name) {
                return Some(self.push(ExprKind::Participant(which), Ty::Agent(participants[which].1), span));
            }
        } else if self.pairs[number].item.formals.iter().any(|formal| formal.name.text == name) {
            return Some(self.wrong(span));
        }
        let &definition = self.pairs[number].lets.get(name)?;
        Some(self.lower_definition(definition, name, span))
    }

    /// The value that a definition gives to the place where its name stands.
    fn lower_definition(&mut self, number: usize, name: &str, span: Span) -> Value {
        match self.mention(number) {
            Meaning::Number(value, ty) => {
                let value = self.number(value, ty, span);
                self.quantities.insert(value.id, self.definitions[number].quantity);
                value
            }
            Meaning::Text(_) => self.number(0.0, Ty::Text, span),
            Meaning::Shared(value) => value,
            Meaning::Function(_) => {
                let help = "call it: write its arguments in parentheses".to_string();
                self.report(NameError::NotAValue { name: name.to_string(), what: "a function", span, help });
                self.wrong(span)
            }
            Meaning::Let(..) | Meaning::Failed => self.wrong(span),
        }
    }

    fn not_a_value(&mut self, home: Home, kind: GlobalKind, name: &str, span: Span) -> Value {
        let watches = matches!(home, Home::Agent(ty, _) if self.is_watcher(ty));
        let (what, help) = match kind {
            GlobalKind::Agent(_) => {
                ("an agent type", format!("bind one of its agents: `exists o in other {name}: ...`"))
            }
            GlobalKind::Interaction => {
                ("an interaction", "interactions happen by themselves; nothing refers to them".to_string())
            }
            GlobalKind::Instance if watches => {
                let help =
                    format!("bind its agents: `forall o in {name}: o.x > 0`, or `exists o in {name}: ...`");
                ("a name of `system`", help)
            }
            GlobalKind::Instance | GlobalKind::Definition(_) => (
                "a name of `system`",
                "hand the agent over as an argument of agent type, or by a `link`".to_string(),
            ),
        };
        self.report(NameError::NotAValue { name: name.to_string(), what, span, help });
        self.wrong(span)
    }

    fn unknown_name(&mut self, scope: &Scope<'a>, name: &str, span: Span) -> Value {
        if !self.imports {
            let bound = scope.bound.iter().map(|(bound, _)| *bound);
            let locals = scope.locals.iter().map(|(local, _)| *local);
            let received = scope.received.iter().map(|(value, _)| *value);
            let of_file = self.globals.keys().copied();
            let own: Box<dyn Iterator<Item = &str>> = match scope.home {
                Home::Agent(ty, mode) => {
                    let names = &self.agents[ty.index()];
                    Box::new(names.mode_lets[mode.index()].keys().chain(names.members.keys()).copied())
                }
                Home::Initial(ty) => Box::new(self.agents[ty.index()].members.keys().copied()),
                Home::Pair(number) => {
                    let PairNames { lets, item, .. } = &self.pairs[number];
                    let participants = item.formals.iter().map(|formal| formal.name.text.as_str());
                    Box::new(lets.keys().copied().chain(participants))
                }
                Home::File | Home::Function | Home::Construction => Box::new(std::iter::empty()),
            };
            let constants = CONSTANTS.iter().copied();
            let known = constants.chain(bound).chain(locals).chain(received).chain(of_file).chain(own);
            let similar = closest(name, known);
            self.report(NameError::Unknown { what: "variable", name: name.to_string(), span, similar });
        }
        self.wrong(span)
    }

    /// What stands behind a dot.
    pub fn lower_field(
        &mut self,
        scope: &mut Scope<'a>,
        base: &'a ast::Expr,
        name: &'a ast::Name,
        span: Span,
    ) -> Value {
        let agent = self.lower(scope, base);
        let Some(ty) = agent.ty.agent_type() else {
            if agent.ty != Ty::Wrong {
                let found = self.describe(agent.ty);
                self.report(TypeError::NotAnAgent { found, span: base.span });
            }
            return self.wrong(span);
        };
        match self.agents[ty.index()].members.get(name.text.as_str()) {
            Some(&(member, _)) => self.of_each(agent, span, &mut |context, agent| {
                context.lower_member(agent, ty, member, &name.text, span)
            }),
            None => {
                self.no_member(ty, name);
                self.wrong(span)
            }
        }
    }

    /// Reports that an agent type has no such member.
    pub fn no_member(&mut self, ty: TypeId, name: &ast::Name) {
        let names = &self.agents[ty.index()];
        let mode = names.mode_lets.iter().position(|lets| lets.contains_key(name.text.as_str()));
        let mode = mode.map(|number| self.model.types[ty].modes[ModeId::new(number)].path.clone());
        let similar = closest(&name.text, names.members.keys().copied());
        let agent = self.model.types[ty].name.clone();
        self.report(NameError::NoMember { name: name.text.clone(), agent, span: name.span, similar, mode });
    }

    fn lower_member(&mut self, agent: Value, ty: TypeId, member: Member, name: &str, span: Span) -> Value {
        let names = &self.agents[ty.index()];
        let (kind, ty) = match member {
            Member::Param(number) => (ExprKind::AgentParam(agent.id, number), names.params[number].ty),
            Member::State(number) => (ExprKind::State(agent.id, number), names.states[number].ty),
            Member::Discrete(number) => (ExprKind::Discrete(agent.id, number), names.discretes[number].ty),
            Member::Link(number) => {
                let link = &self.model.types[ty].links[number];
                let ty = if link.required { Ty::Agent(link.ty) } else { Ty::Link(link.ty) };
                (ExprKind::Link(agent.id, number), ty)
            }
            Member::Let(definition) => match self.mention(definition) {
                Meaning::Let(number, ty) => (ExprKind::Let(agent.id, number), ty),
                _ => return self.wrong(span),
            },
            Member::Twice => return self.wrong(span),
            Member::Event(_) => {
                let help = "events are sent by `emit` and received by `on`".to_string();
                self.report(NameError::NotAValue { name: name.to_string(), what: "an event", span, help });
                return self.wrong(span);
            }
        };
        self.push(kind, ty, span)
    }

    /// `x'`: the rate of a state.
    pub fn lower_prime(&mut self, scope: &mut Scope<'a>, state: &'a ast::Expr, span: Span) -> Value {
        let value = self.lower(scope, state);
        if value.ty == Ty::Wrong {
            return value;
        }
        if let Some(rate) = self.rate_of(value.id, span) {
            return rate;
        }
        let found = self.describe(value.ty);
        self.report(TypeError::Operand {
            operator: "'".to_string(),
            needs: "a state",
            found,
            span: state.span,
        });
        self.wrong(span)
    }

    /// The rate of a state, or of one of several by the agent that is chosen; none if it is something else.
    fn rate_of(&mut self, state: ExprId, span: Span) -> Option<Value> {
        match self.model.exprs[state].kind {
            ExprKind::State(agent, number) => Some(self.push(ExprKind::Rate(agent, number), Ty::Real, span)),
            ExprKind::Apply(Op::Select, ref operands) => {
                let (test, yes, no) = (operands[0], operands[1], operands[2]);
                let (yes, no) = (self.rate_of(yes, span)?, self.rate_of(no, span)?);
                Some(self.apply(Op::Select, [test, yes.id, no.id], Ty::Real, span))
            }
            _ => None,
        }
    }

    /// `xs[3]` in an expression.
    pub fn lower_index(
        &mut self,
        scope: &mut Scope<'a>,
        base: &'a ast::Expr,
        place: &'a ast::Expr,
        span: Span,
    ) -> Value {
        let value = self.lower(scope, base);
        if let Ty::List(list) = value.ty {
            return self.lower_element(scope, list, (base, place), span);
        }
        if value.ty != Ty::Wrong {
            let found = self.describe(value.ty);
            let needs = "a list, or in `system` an array of agents";
            let text = self.sources.text(place.span);
            let is_unit = text.contains(char::is_alphabetic) && units::parse(text).is_ok();
            let error = if is_unit {
                TypeError::UnitBehind { unit: text.to_string(), base: base.span, span: place.span }
            } else {
                TypeError::Operand { operator: "[ ]".to_string(), needs, found, span: base.span }
            };
            self.report(error);
        }
        self.wrong(span)
    }

    /// `o is Brake`.
    pub fn lower_is(
        &mut self,
        scope: &mut Scope<'a>,
        agent: &'a ast::Expr,
        target: &'a ast::Target,
        span: Span,
    ) -> Value {
        let value = self.lower(scope, agent);
        let Some(ty) = value.ty.agent_type() else {
            if value.ty != Ty::Wrong {
                let found = self.describe(value.ty);
                let needs = "an agent on its left";
                self.report(TypeError::Operand {
                    operator: "is".to_string(),
                    needs,
                    found,
                    span: agent.span,
                });
            }
            return self.wrong(span);
        };
        let from = match (scope.home, &self.model.exprs[value.id].kind) {
            (Home::Agent(_, mode), ExprKind::SelfAgent) => mode,
            _ => ModeId::new(0),
        };
        match self.resolve_mode(ty, from, target) {
            Some(mode) => self.of_each(value, span, &mut |context, agent| {
                context.push(ExprKind::Is(agent.id, mode), Ty::Bool, span)
            }),
            None => self.wrong(span),
        }
    }

    /// The mode that a path names when it is written in mode `from`: the first name is looked up there, then in the
    /// modes around it. None, and a diagnostic, if there is none.
    pub fn resolve_mode(&mut self, ty: TypeId, from: ModeId, target: &ast::Target) -> Option<ModeId> {
        let modes = &self.model.types[ty].modes;
        let child = |of: ModeId, name: &str| {
            modes[of].children.iter().copied().find(|&child| modes[child].name == name)
        };
        let mut around = Some(from);
        let mut found = None;
        while let (Some(id), None) = (around, found) {
            found = child(id, &target.path[0].text);
            around = modes[id].parent;
        }
        let mut inside = ModeId::new(0);
        for (k, name) in target.path.iter().enumerate() {
            let next = if k == 0 { found } else { child(inside, &name.text) };
            let Some(next) = next else {
                if !self.agents[ty.index()].incomplete {
                    self.unknown_mode(ty, inside, name);
                }
                return None;
            };
            inside = next;
        }
        Some(inside)
    }

    /// Where a change of mode leads that is written in mode `from`.
    pub fn resolve_destination(
        &mut self,
        ty: TypeId,
        from: ModeId,
        target: &ast::Target,
    ) -> Option<Destination> {
        let mode = self.resolve_mode(ty, from, target)?;
        let model = &self.model.types[ty];
        if let (Some(own), Some(other)) = (model.region_of(from), model.region_of(mode))
            && own != other
        {
            let [from, to] = [own, other].map(|region| model.modes[region].name.clone());
            self.report(ModeError::AcrossRegions { from, to, span: target.span });
            return None;
        }
        let Some(span) = target.history else { return Some(Destination { mode, inside: Inside::Initial }) };
        let item = &self.model.types[ty].modes[mode];
        if item.children.is_empty() {
            let (path, declared) = (item.path.clone(), item.span);
            self.report(ModeError::NoHistory { path, declared, span });
            return None;
        }
        Some(Destination { mode, inside: Inside::History })
    }

    fn unknown_mode(&mut self, ty: TypeId, inside: ModeId, name: &ast::Name) {
        let modes = &self.model.types[ty].modes;
        let similar = closest(&name.text, modes.iter().skip(1).map(|mode| mode.name.as_str()));
        let owner = if inside.index() == 0 {
            format!("agent `{}`", modes[inside].name)
        } else {
            format!("mode `{}`", modes[inside].path)
        };
        self.report(NameError::UnknownMode {
            name: name.text.clone(),
            inside: owner,
            span: name.span,
            similar,
        });
    }
}
