//! Links that follow from an expression: `nearest`, an agent that is named, one or the other by `if`.
//!
//! An expression is opened into cases, each with the tests on the way to it, and whom the link leads to if they hold. A
//! `nearest` that stands in a guard, a `let` or a flow is a link of its agent without a name.

use rustc_hash::FxHashSet;

use super::context::{Context, GlobalKind, Home, Scope, Value};
use super::error::{NameError, TypeError};
use super::ir::{ExprId, ExprKind, Link, LinkCase, LinkTarget, ModeId, TypeId};
use super::membership::Named;
use super::operands::for_each_operand;
use super::order::find_circle;
use super::types::Ty;
use crate::base::Span;
use crate::math::Op;
use crate::syntax::ast::{self, AgentItem, QuantifierKind};

/// Gives every link with an expression its cases.
pub(super) fn fill_links(context: &mut Context) {
    for number in 0..context.agents.len() {
        let ty = TypeId::new(number);
        let item = context.agents[number].item;
        let links = item.items.iter().filter_map(|part| match part {
            AgentItem::Link(link) => Some(link),
            _ => None,
        });
        for link in links {
            let Some(value) = &link.value else { continue };
            let links = &context.model.types[ty].links;
            let Some(place) = links.iter().position(|declared| declared.span == link.name.span) else {
                continue;
            };
            if context.is_of_system(value) {
                continue;
            }
            let mut scope = Scope::of(Home::Agent(ty, ModeId::new(0)));
            let target = context.model.types[ty].links[place].ty;
            let mut cases = Vec::new();
            context.cases(&mut scope, value, target, None, &mut cases);
            context.model.types[ty].links[place].cases = cases;
        }
    }
}

/// No link may need itself, over what its expression reads.
pub(super) fn check_circles(context: &mut Context) {
    let model = &context.model;
    let mut firsts = Vec::new();
    let mut all: Vec<(&str, Span)> = Vec::new();
    for ty in model.types.iter() {
        firsts.push(all.len());
        all.extend(ty.links.iter().map(|link| (link.name.as_str(), link.span)));
    }
    let mut needs = Vec::with_capacity(all.len());
    for ty in model.types.iter() {
        for link in &ty.links {
            let (mut needed, mut seen) = (Vec::new(), FxHashSet::default());
            let mut pending: Vec<ExprId> = link.cases.iter().flat_map(LinkCase::exprs).collect();
            while let Some(id) = pending.pop() {
                if !seen.insert(id) {
                    continue;
                }
                let of = |agent: ExprId| Ty::from(model.exprs[agent].ty).agent_type();
                match &model.exprs[id].kind {
                    ExprKind::Link(agent, k) => needed.extend(of(*agent).map(|ty| firsts[ty.index()] + k)),
                    ExprKind::Let(agent, k) => {
                        let item = of(*agent).and_then(|ty| model.types[ty].lets.get(*k));
                        pending.extend(item.map(|item| item.value));
                    }
                    ExprKind::Call(function, _) => pending.push(model.functions[*function].body),
                    _ => {}
                }
                for_each_operand(&model.exprs[id].kind, |operand| pending.push(operand));
            }
            needs.push(needed);
        }
    }
    if let Some(circle) = find_circle(&needs) {
        let names = circle.iter().map(|&k| (all[k].0.to_string(), all[k].1)).collect();
        context.report(NameError::Circle { names, what: "links need each other in a circle" });
    }
}

impl<'a> Context<'a> {
    /// The type of agent that an expression of a link leads to, as far as its text says.
    pub fn link_type(&self, value: &'a ast::Expr) -> Option<&'a ast::Name> {
        match &value.kind {
            ast::ExprKind::Quantifier(item) if item.kind == QuantifierKind::Nearest => {
                let instance = self.instances.iter().find(|instance| instance.name.text == item.set.text);
                Some(instance.map_or(&item.set, |instance| &instance.constructor.agent))
            }
            ast::ExprKind::If { then, otherwise, .. } => {
                self.link_type(then).or_else(|| self.link_type(otherwise))
            }
            _ => None,
        }
    }

    /// Whether an expression names agents of `system`: then it says where the link begins, as an argument does.
    pub fn is_of_system(&self, value: &'a ast::Expr) -> bool {
        let is_instance = |name: &str| matches!(self.globals.get(name), Some(global) if matches!(global.kind, GlobalKind::Instance));
        match &value.kind {
            ast::ExprKind::Name(name) => is_instance(name),
            ast::ExprKind::Index(base, _) => self.is_of_system(base),
            ast::ExprKind::If { then, otherwise, .. } => {
                self.is_of_system(then) || self.is_of_system(otherwise)
            }
            _ => false,
        }
    }

    /// The cases of an expression, behind a test.
    fn cases(
        &mut self,
        scope: &mut Scope<'a>,
        expr: &'a ast::Expr,
        ty: TypeId,
        test: Option<Value>,
        cases: &mut Vec<LinkCase>,
    ) {
        let span = expr.span;
        let condition = test.map(|test| test.id);
        let target = match &expr.kind {
            ast::ExprKind::If { condition, then, otherwise } => {
                let holds = self.lower_condition(scope, condition);
                let fails = self.apply(Op::Not, [holds.id], holds.ty, condition.span);
                for (branch, more) in [(then, holds), (otherwise, fails)] {
                    let test = match test {
                        Some(test) => self.apply(Op::And, [test.id, more.id], Ty::Bool, condition.span),
                        None => more,
                    };
                    self.cases(scope, branch, ty, Some(test), cases);
                }
                return;
            }
            ast::ExprKind::Quantifier(item) if item.kind == QuantifierKind::Nearest => {
                self.nearest(scope, item, ty, span)
            }
            _ => {
                let value = self.lower(scope, expr);
                let fitted = self.fit(value, Ty::Link(ty), span, "what a link leads to");
                if fitted.ty != Ty::Wrong {
                    self.cases_of(fitted, test, span, cases);
                }
                return;
            }
        };
        cases.extend(target.map(|target| LinkCase { condition, target, span }));
    }

    fn nearest(
        &mut self,
        scope: &mut Scope<'a>,
        item: &'a ast::Quantifier,
        ty: TypeId,
        span: Span,
    ) -> Option<LinkTarget> {
        let range = self.range(scope, item)?;
        if range.set != ty {
            let (expected, found) = (self.describe(Ty::Agent(ty)), self.describe(Ty::Agent(range.set)));
            let what = "what a link leads to".to_string();
            self.report(TypeError::Mismatch { what, expected, found, span, help: None });
            return None;
        }
        scope.bound.push((&item.binder.text, range.binder));
        let filter = self.filter(scope, &range, item).map(|filter| filter.id);
        let key = match &item.body {
            Some(key) => self.lower_number(scope, key, "by"),
            None => self.no_body("nearest", "a number behind `by`", span),
        };
        scope.bound.pop();
        let (binder, other) = (range.binder, range.other);
        (key.ty != Ty::Wrong).then_some(LinkTarget::Nearest { binder, other, filter, key: key.id })
    }

    /// A `nearest` that stands in an expression: a link without a name.
    pub fn lower_nearest(&mut self, scope: &mut Scope<'a>, item: &'a ast::Quantifier, span: Span) -> Value {
        let Home::Agent(ty, _) = scope.home else {
            let why = "is kept up to date for an agent, and this is no agent's text";
            let help = "declare it as a link of the agent: `link lead = nearest o in other Car by o.x - x`";
            self.report(NameError::NotHere { name: "nearest".to_string(), span, why, help });
            return self.wrong(span);
        };
        if !scope.bound.is_empty() {
            let why = "would be another one for each agent that is bound around it";
            let help = "declare it as a link of the agent that is bound: `o.lead`";
            self.report(NameError::NotHere { name: "nearest".to_string(), span, why, help });
            return self.wrong(span);
        }
        let Some(Named { ty: set, .. }) = self.set_named(&item.set) else { return self.wrong(span) };
        let Some(target) = self.nearest(scope, item, set, span) else { return self.wrong(span) };
        let links = &mut self.model.types[ty].links;
        let number = links.len();
        let cases = vec![LinkCase { condition: None, target, span }];
        let name = format!("nearest {}", item.binder.text);
        links.push(Link { name, ty: set, required: false, cases, span });
        let own = self.push(ExprKind::SelfAgent, Ty::Agent(ty), span);
        self.push(ExprKind::Link(own.id, number), Ty::Link(set), span)
    }
}
