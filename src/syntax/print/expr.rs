//! Expressions in the canonical layout: which parentheses the tree needs.
//!
//! Each kind of expression has a level of binding; an operand of a lower level than its place asks for stands in
//! parentheses. An `if` or a quantifier extends as far right as it can, so it needs them wherever something follows.

use std::ops::Fn;

use super::Printer;
use crate::syntax::ast::*;

/// How tightly an expression binds, from the loosest.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Binding {
    Open,
    Or,
    And,
    Not,
    Comparison,
    Sum,
    Product,
    Negation,
    Power,
    Postfix,
}

/// What stands behind an expression.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Follow {
    /// Nothing that an `if` or a quantifier could take for its own.
    End,
    /// An operator, a suffix, or a quantifier's `:`.
    More,
}

fn binding(expr: &Expr) -> Binding {
    match &expr.kind {
        ExprKind::If { .. } | ExprKind::Quantifier(_) => Binding::Open,
        ExprKind::Or(_) => Binding::Or,
        ExprKind::And(_) => Binding::And,
        ExprKind::Unary(UnaryOp::Not, _) => Binding::Not,
        ExprKind::Compare(..) | ExprKind::Is(..) => Binding::Comparison,
        ExprKind::Sum(_) => Binding::Sum,
        ExprKind::Product(_) => Binding::Product,
        ExprKind::Unary(UnaryOp::Neg, _) => Binding::Negation,
        ExprKind::Power(..) => Binding::Power,
        ExprKind::Number { .. } | ExprKind::Text(_) | ExprKind::Name(_) | ExprKind::List(_) => {
            Binding::Postfix
        }
        ExprKind::Field(..) | ExprKind::Call { .. } | ExprKind::Index(..) | ExprKind::Prime(_) => {
            Binding::Postfix
        }
    }
}

impl Printer {
    pub(super) fn expr(&mut self, expr: &Expr) {
        self.followed(expr, Follow::End);
    }

    fn followed(&mut self, expr: &Expr, follow: Follow) {
        match &expr.kind {
            ExprKind::Number { text, unit, value: _ } => {
                self.put(text);
                self.unit(unit.as_deref());
            }
            ExprKind::Text(text) => self.quoted(text),
            ExprKind::Name(name) => self.put(name),
            ExprKind::List(items) => self.enclosed("[", items, "]"),
            ExprKind::Field(base, field) => {
                self.operand(base, Binding::Postfix, Follow::More);
                self.put(".");
                self.put(&field.text);
            }
            ExprKind::Call { callee, args } => {
                self.operand(callee, Binding::Postfix, Follow::More);
                self.enclosed("(", args, ")");
            }
            ExprKind::Index(base, index) => {
                self.operand(base, Binding::Postfix, Follow::More);
                self.enclosed("[", std::slice::from_ref(index), "]");
            }
            ExprKind::Prime(base) => {
                self.operand(base, Binding::Postfix, Follow::More);
                self.put("'");
            }
            ExprKind::Unary(UnaryOp::Neg, operand) => {
                self.put("-");
                self.operand(operand, Binding::Negation, follow);
            }
            ExprKind::Unary(UnaryOp::Not, operand) => {
                self.put("not ");
                self.operand(operand, Binding::Not, follow);
            }
            ExprKind::Power(base, exponent) => {
                self.operand(base, Binding::Postfix, Follow::More);
                self.put("^");
                self.operand(exponent, Binding::Negation, follow);
            }
            ExprKind::Sum(chain) => {
                self.chain(chain, Binding::Product, follow, |op| format!(" {} ", op.sign()))
            }
            ExprKind::Product(chain) => {
                self.chain(chain, Binding::Negation, follow, |op| op.sign().to_string())
            }
            ExprKind::Compare(op, left, right) => {
                self.operand(left, Binding::Sum, Follow::More);
                self.put(&format!(" {} ", op.sign()));
                self.operand(right, Binding::Sum, follow);
            }
            ExprKind::Is(agent, mode) => {
                self.operand(agent, Binding::Sum, Follow::More);
                self.put(" is ");
                self.target(mode);
            }
            ExprKind::And(terms) => self.terms(terms, " and ", Binding::Not, follow),
            ExprKind::Or(terms) => self.terms(terms, " or ", Binding::And, follow),
            ExprKind::If { condition, then, otherwise } => {
                self.put("if ");
                self.expr(condition);
                self.put(" then ");
                self.expr(then);
                self.put(" else ");
                self.expr(otherwise);
            }
            ExprKind::Quantifier(quantifier) => self.quantifier(quantifier),
        }
    }

    /// An operand where something that binds at least like `place` may stand.
    fn operand(&mut self, expr: &Expr, place: Binding, follow: Follow) {
        let binds = binding(expr);
        if binds >= place || (binds == Binding::Open && follow == Follow::End) {
            self.followed(expr, follow);
        } else {
            self.put("(");
            self.expr(expr);
            self.put(")");
        }
    }

    fn enclosed(&mut self, open: &str, exprs: &[Expr], close: &str) {
        self.put(open);
        self.list(exprs, |p, expr| p.expr(expr));
        self.put(close);
    }

    fn chain<Op: Copy>(
        &mut self,
        chain: &Chain<Op>,
        place: Binding,
        follow: Follow,
        sign: impl Fn(Op) -> String,
    ) {
        self.operand(&chain.first, place, Follow::More);
        for (k, link) in chain.rest.iter().enumerate() {
            self.put(&sign(link.op));
            self.operand(&link.operand, place, if k + 1 < chain.rest.len() { Follow::More } else { follow });
        }
    }

    fn terms(&mut self, terms: &[Expr], word: &str, place: Binding, follow: Follow) {
        for (k, term) in terms.iter().enumerate() {
            self.put(if k > 0 { word } else { "" });
            self.operand(term, place, if k + 1 < terms.len() { Follow::More } else { follow });
        }
    }

    fn quantifier(&mut self, quantifier: &Quantifier) {
        let Quantifier { kind, binder, other, set, filter, body } = quantifier;
        let other = if other.is_some() { "other " } else { "" };
        self.put(&format!("{} {} in {other}{}", kind.word(), binder.text, set.text));
        if let Some(filter) = filter {
            self.put(" where ");
            let follow = if body.is_some() { Follow::More } else { Follow::End };
            self.operand(filter, Binding::Or, follow);
        }
        if let Some(body) = body {
            self.put(if *kind == QuantifierKind::Nearest { " by " } else { ": " });
            self.expr(body);
        }
    }
}
