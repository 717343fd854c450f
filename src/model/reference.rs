//! Arguments that link agents to agents of `system`: `cars[index - 1]`, `none`, one or the other by `if`.

use super::context::{Context, GlobalKind, Home, Scope};
use super::error::{SystemError, TypeError, ValueError};
use super::ir::{ExprId, TypeId};
use super::plan::{Plan, Reference};
use super::suggest::closest;
use super::types::Ty;
use crate::base::Span;
use crate::syntax::ast;

impl<'a> Context<'a> {
    /// Fills in the links of a plan; every block is known by now.
    pub fn plan_links(&mut self, plan: &mut Plan<'a>) {
        for arg in &plan.item.constructor.args {
            let links = &self.model.types[plan.ty].links;
            let Some(number) = links.iter().position(|link| link.name == arg.name.text) else { continue };
            let target = links[number].ty;
            if arg.given.kind == ast::GivenKind::Value {
                plan.links[number] = self.reference(&arg.given.value, target);
            }
        }
        let own = self.agents[plan.ty.index()].item;
        for part in &own.items {
            let ast::AgentItem::Link(link) = part else { continue };
            let links = &self.model.types[plan.ty].links;
            let place = links.iter().position(|declared| declared.span == link.name.span);
            if let (Some(value), Some(place)) = (&link.value, place)
                && self.is_of_system(value)
                && !plan.item.constructor.args.iter().any(|arg| arg.name.text == link.name.text)
            {
                let target = links[place].ty;
                plan.links[place] = self.reference(value, target);
            }
        }
    }

    fn reference(&mut self, expr: &'a ast::Expr, target: TypeId) -> Option<Reference> {
        let span = expr.span;
        match &expr.kind {
            ast::ExprKind::Name(name) if name == "none" => Some(Reference::Nobody(span)),
            ast::ExprKind::Name(name) => {
                let block = self.block(name, span, target)?;
                if self.model.population.blocks[block].array {
                    let found = format!("an array; say which of its agents: `{name}[0]`");
                    self.report(SystemError::NotAnInstance { span, found, similar: None });
                    return None;
                }
                Some(Reference::Agent { block, index: None, span })
            }
            ast::ExprKind::Index(base, index) => {
                let ast::ExprKind::Name(name) = &base.kind else { return self.no_instance(span) };
                let index = self.argument(index, Ty::Int, "an index")?;
                let block = self.block(name, base.span, target)?;
                if !self.model.population.blocks[block].array {
                    let found = format!("an element of `{name}`, which is a single agent");
                    self.report(SystemError::NotAnInstance { span, found, similar: None });
                    return None;
                }
                Some(Reference::Agent { block, index: Some(index), span })
            }
            ast::ExprKind::If { condition, then, otherwise } => {
                let test = self.argument(condition, Ty::Bool, "a condition");
                let then = self.reference(then, target);
                let otherwise = self.reference(otherwise, target);
                Some(Reference::If(test?, Box::new(then?), Box::new(otherwise?)))
            }
            _ => self.no_instance(span),
        }
    }

    fn no_instance(&mut self, span: Span) -> Option<Reference> {
        let found = "an expression".to_string();
        self.report(SystemError::NotAnInstance { span, found, similar: None });
        None
    }

    /// An index or a condition, which may read `index` and constants.
    fn argument(&mut self, expr: &'a ast::Expr, ty: Ty, what: &str) -> Option<ExprId> {
        let value = self.lower(&mut Scope::of(Home::Construction), expr);
        let value = self.fit(value, ty, expr.span, what);
        if value.ty == Ty::Wrong {
            return None;
        }
        if !self.facts[value.id.index()].pure {
            self.report(ValueError::NotConstant { what: what.to_string(), span: expr.span });
            return None;
        }
        Some(value.id)
    }

    /// The block of this name, whose agents must be of the type.
    fn block(&mut self, name: &str, span: Span, target: TypeId) -> Option<usize> {
        let blocks = &self.model.population.blocks;
        let Some(block) = blocks.iter().position(|block| block.name == name) else {
            if !matches!(self.globals.get(name), Some(global) if matches!(global.kind, GlobalKind::Instance))
            {
                let similar = closest(name, blocks.iter().map(|block| block.name.as_str()));
                let found = format!("`{name}`");
                self.report(SystemError::NotAnInstance { span, found, similar });
            }
            return None;
        };
        let found = blocks[block].ty;
        if found != target {
            let (expected, found) = (self.describe(Ty::Agent(target)), self.describe(Ty::Agent(found)));
            let what = "this link".to_string();
            self.report(TypeError::Mismatch { what, expected, found, span, help: None });
            return None;
        }
        Some(block)
    }
}
