//! Agents that are chosen by `if`: `(if c then a else b).x` is `if c then a.x else b.x`, and so on wherever an agent is asked
//! for something.
//!
//! While a model is read a chosen agent is an `if` like any other. Whoever takes an agent opens it, so that none is left
//! in what this floor hands on: numbers and conditions by cases, actions by an `if` around them, a link by its cases.

use super::context::{Context, Home, Scope, Value};
use super::error::{ActionError, TypeError};
use super::ir::{Action, Create, ExprId, ExprKind, Link, LinkCase, LinkTarget};
use super::limits;
use super::types::Ty;
use crate::base::Span;
use crate::math::Op;

/// An agent by cases: a test, the agent if it holds, the agent if not.
#[derive(Clone, Copy)]
pub(super) struct Choice {
    /// The test.
    pub test: Value,
    /// Whom it names where that holds.
    pub yes: Value,
    /// Whom it names elsewhere.
    pub no: Value,
}

impl<'a> Context<'a> {
    /// The type of an agent that is one or the other; none if they are of different types.
    pub fn chosen_type(yes: Ty, no: Ty) -> Option<Ty> {
        match (yes, no) {
            (Ty::Nobody, Ty::Nobody) => Some(Ty::Nobody),
            (Ty::Agent(a), Ty::Agent(b)) => (a == b).then_some(Ty::Agent(a)),
            (Ty::Nobody, other) | (other, Ty::Nobody) => other.agent_type().map(Ty::Link),
            (a, b) => (a.agent_type() == b.agent_type()).then_some(Ty::Link(a.agent_type()?)),
        }
    }

    /// The cases of an agent that is chosen.
    pub fn choice(&self, agent: Value) -> Option<Choice> {
        if !agent.ty.is_reference() {
            return None;
        }
        let ExprKind::Apply(Op::Select, operands) = &self.model.exprs[agent.id].kind else { return None };
        let test = Value { id: operands[0], ty: Ty::Bool };
        let of = |id: ExprId| {
            let nobody = matches!(self.model.exprs[id].kind, ExprKind::NoAgent);
            // `none` reads as an agent of the type of the others, who is not there.
            let own = Ty::from(self.model.exprs[id].ty);
            let ty = if nobody { agent.ty.agent_type().map_or(Ty::Nobody, Ty::Link) } else { own };
            Value { id, ty }
        };
        Some(Choice { test, yes: of(operands[1]), no: of(operands[2]) })
    }

    /// What is asked of an agent, by cases if it is chosen.
    pub fn of_each(
        &mut self,
        agent: Value,
        span: Span,
        ask: &mut dyn FnMut(&mut Self, Value) -> Value,
    ) -> Value {
        let Some(Choice { test, yes, no }) = self.choice(agent) else { return ask(self, agent) };
        let [yes, no] = [yes, no].map(|agent| self.of_each(agent, span, ask));
        self.by_cases(test, yes, no, span)
    }

    /// One value or the other.
    fn by_cases(&mut self, test: Value, yes: Value, no: Value, span: Span) -> Value {
        let ty = match (yes.ty, no.ty) {
            (Ty::Wrong, _) | (_, Ty::Wrong) => Ty::Wrong,
            (a, b) if a.is_reference() => Self::chosen_type(a, b).unwrap_or(Ty::Wrong),
            (a, _) => a,
        };
        self.apply(Op::Select, [test.id, yes.id, no.id], ty, span)
    }

    /// A call, by cases of those of its arguments that are chosen agents.
    pub fn call_by_cases(
        &mut self,
        function: super::ir::FunctionId,
        args: Vec<Value>,
        ty: Ty,
        span: Span,
    ) -> Value {
        let n_cases = args.iter().fold(1_usize, |n, &arg| n.saturating_mul(self.n_cases(arg)));
        if n_cases > limits::BRANCHES_MAX {
            self.report(ActionError::TooManyBranches { span, most: limits::BRANCHES_MAX });
            return self.wrong(span);
        }
        let Some(k) = args.iter().position(|&arg| self.choice(arg).is_some()) else {
            let args = args.iter().map(|value| value.id).collect();
            return self.push(ExprKind::Call(function, args), ty, span);
        };
        self.of_each(args[k], span, &mut |context, agent| {
            let mut args = args.clone();
            args[k] = agent;
            context.call_by_cases(function, args, ty, span)
        })
    }

    /// How many agents a choice is between.
    fn n_cases(&self, agent: Value) -> usize {
        let (mut n, mut pending) = (0_usize, vec![agent]);
        while let Some(agent) = pending.pop() {
            match self.choice(agent) {
                Some(Choice { yes, no, .. }) if n <= limits::BRANCHES_MAX => pending.extend([yes, no]),
                _ => n += 1,
            }
        }
        n
    }

    /// An action that takes an agent, by cases if that is chosen.
    pub fn act_on_each(
        &mut self,
        agent: Value,
        act: &mut dyn FnMut(&mut Self, Value) -> Option<Action>,
    ) -> Option<Action> {
        let Some(Choice { test, yes, no }) = self.choice(agent) else { return act(self, agent) };
        let [then, otherwise] =
            [yes, no].map(|agent| self.act_on_each(agent, act).into_iter().collect::<Vec<_>>());
        Some(Action::If { condition: test.id, then, otherwise })
    }

    /// A `create`, by cases of those of its links that are chosen.
    pub fn create_by_cases(&mut self, create: Create) -> Option<Action> {
        let links = (create.links.iter().zip(&self.model.types[create.ty].links))
            .map(|(id, link)| id.map(|id| Value { id, ty: Ty::Link(link.ty) }))
            .collect::<Vec<_>>();
        let n_cases = links.iter().flatten().fold(1_usize, |n, &link| n.saturating_mul(self.n_cases(link)));
        if n_cases > limits::BRANCHES_MAX {
            self.report(ActionError::TooManyBranches { span: create.span, most: limits::BRANCHES_MAX });
            return None;
        }
        let Some(k) = links.iter().position(|link| link.is_some_and(|link| self.choice(link).is_some()))
        else {
            return Some(Action::Create(Box::new(create)));
        };
        self.act_on_each(links[k]?, &mut |context, agent| {
            let mut create = create.clone();
            create.links[k] = Some(agent.id);
            context.create_by_cases(create)
        })
    }

    /// Whom a link leads to, by cases, each behind its test.
    pub fn cases_of(&mut self, agent: Value, test: Option<Value>, span: Span, cases: &mut Vec<LinkCase>) {
        let Some(Choice { test: holds, yes, no }) = self.choice(agent) else {
            let target = match self.model.exprs[agent.id].kind {
                ExprKind::NoAgent => LinkTarget::Nobody,
                _ => LinkTarget::Agent(agent.id),
            };
            let condition = test.map(|test| test.id);
            return cases.push(LinkCase { condition, target, span });
        };
        let fails = self.apply(Op::Not, [holds.id], holds.ty, span);
        for (branch, more) in [(yes, holds), (no, fails)] {
            let test = match test {
                Some(test) => self.apply(Op::And, [test.id, more.id], Ty::Bool, span),
                None => more,
            };
            self.cases_of(branch, Some(test), span, cases);
        }
    }

    /// A chosen agent as a link of its own, without a name, for what follows an agent and is no value.
    pub fn as_link(&mut self, scope: &Scope<'a>, agent: Value, span: Span) -> Value {
        let (Some(set), Some(_), Home::Agent(ty, _)) =
            (agent.ty.agent_type(), self.choice(agent), scope.home)
        else {
            return agent;
        };
        let mut cases = Vec::new();
        self.cases_of(agent, None, span, &mut cases);
        let links = &mut self.model.types[ty].links;
        let number = links.len();
        links.push(Link { name: format!("chosen {number}"), ty: set, required: false, cases, span });
        let own = self.push(ExprKind::SelfAgent, Ty::Agent(ty), span);
        self.push(ExprKind::Link(own.id, number), Ty::Link(set), span)
    }

    /// Reports agents of different types behind `then` and `else`.
    pub fn choice_of_unlike(&mut self, yes: Ty, no: Ty, span: Span) {
        let expected = format!("{}, as what follows `then`", self.describe(yes));
        let found = self.describe(no);
        let what = "what follows `else`".to_string();
        self.report(TypeError::Mismatch { what, expected, found, span, help: None });
    }
}
