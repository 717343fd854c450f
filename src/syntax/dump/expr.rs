//! Expressions in the outline.

use std::ops::Fn;

use super::{Outline, target, unit_after};
use crate::syntax::ast::*;

impl Outline {
    pub(super) fn expr(&mut self, expr: &Expr) {
        match &expr.kind {
            ExprKind::Number { text, unit, value: _ } => self.line(&format!("{text}{}", unit_after(unit))),
            ExprKind::Text(text) => self.line(&format!("{text:?}")),
            ExprKind::Name(name) => self.line(name),
            ExprKind::List(items) => self.node("list", |o| o.exprs(items)),
            ExprKind::Field(base, field) => self.node(&format!(".{}", field.text), |o| o.expr(base)),
            ExprKind::Call { callee, args } => self.node("call", |o| {
                o.expr(callee);
                o.exprs(args);
            }),
            ExprKind::Index(base, index) => self.pair("index", base, index),
            ExprKind::Prime(base) => self.node("prime", |o| o.expr(base)),
            ExprKind::Unary(UnaryOp::Neg, operand) => self.node("negate", |o| o.expr(operand)),
            ExprKind::Unary(UnaryOp::Not, operand) => self.node("not", |o| o.expr(operand)),
            ExprKind::Power(base, exponent) => self.pair("^", base, exponent),
            ExprKind::Sum(chain) => self.chain("sum", chain, SumOp::sign),
            ExprKind::Product(chain) => self.chain("product", chain, ProductOp::sign),
            ExprKind::Compare(op, left, right) => self.pair(op.sign(), left, right),
            ExprKind::Is(agent, mode) => self.node(&format!("is {}", target(mode)), |o| o.expr(agent)),
            ExprKind::And(terms) => self.node("and", |o| o.exprs(terms)),
            ExprKind::Or(terms) => self.node("or", |o| o.exprs(terms)),
            ExprKind::If { condition, then, otherwise } => self.node("if", |o| {
                o.expr(condition);
                o.expr(then);
                o.expr(otherwise);
            }),
            ExprKind::Quantifier(quantifier) => self.quantifier(quantifier),
        }
    }

    fn exprs(&mut self, exprs: &[Expr]) {
        exprs.iter().for_each(|expr| self.expr(expr));
    }

    fn pair(&mut self, line: &str, left: &Expr, right: &Expr) {
        self.node(line, |o| {
            o.expr(left);
            o.expr(right);
        });
    }

    fn chain<Op: Copy>(&mut self, line: &str, chain: &Chain<Op>, sign: impl Fn(Op) -> &'static str) {
        self.node(line, |o| {
            o.expr(&chain.first);
            for link in &chain.rest {
                o.node(sign(link.op), |o| o.expr(&link.operand));
            }
        });
    }

    fn quantifier(&mut self, quantifier: &Quantifier) {
        let Quantifier { kind, binder, other, set, filter, body } = quantifier;
        let other = if other.is_some() { "other " } else { "" };
        self.node(&format!("{} {} in {other}{}", kind.word(), binder.text, set.text), |o| {
            o.labelled("where", filter);
            o.labelled("body", body);
        });
    }
}
