//! The names that stand in an expression, whatever they mean.

use crate::syntax::ast::{Expr, ExprKind};

/// Adds every name, and every name behind a dot.
pub(super) fn names_in<'a>(expr: &'a Expr, names: &mut Vec<&'a str>) {
    match &expr.kind {
        ExprKind::Number { .. } | ExprKind::Text(_) => {}
        ExprKind::Name(name) => names.push(name),
        ExprKind::List(items) | ExprKind::And(items) | ExprKind::Or(items) => {
            items.iter().for_each(|item| names_in(item, names));
        }
        ExprKind::Field(base, name) => {
            names.push(&name.text);
            names_in(base, names);
        }
        ExprKind::Call { callee, args } => {
            names_in(callee, names);
            args.iter().for_each(|arg| names_in(arg, names));
        }
        ExprKind::Index(a, b) | ExprKind::Power(a, b) | ExprKind::Compare(_, a, b) => {
            names_in(a, names);
            names_in(b, names);
        }
        ExprKind::Prime(operand) | ExprKind::Unary(_, operand) | ExprKind::Is(operand, _) => {
            names_in(operand, names)
        }
        ExprKind::Sum(chain) => {
            names_in(&chain.first, names);
            chain.rest.iter().for_each(|link| names_in(&link.operand, names));
        }
        ExprKind::Product(chain) => {
            names_in(&chain.first, names);
            chain.rest.iter().for_each(|link| names_in(&link.operand, names));
        }
        ExprKind::If { condition, then, otherwise } => {
            [condition, then, otherwise].into_iter().for_each(|part| names_in(part, names));
        }
        ExprKind::Quantifier(quantifier) => {
            quantifier.filter.iter().chain(&quantifier.body).for_each(|part| names_in(part, names));
        }
    }
}
