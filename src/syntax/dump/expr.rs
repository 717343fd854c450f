//! An expression on one line, each node that is not a leaf or a suffix in parentheses of its own.

use std::fmt;

use super::{target, unit_after};
use crate::syntax::ast::*;

/// Shows an expression with its structure made plain: `(a + (b*c))`.
pub struct Flat<'e>(pub &'e Expr);

impl fmt::Display for Flat<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.0.kind {
            ExprKind::Number { text, unit, value: _ } => write!(f, "{text}{}", unit_after(unit.as_deref())),
            ExprKind::Text(text) => write!(f, "{text:?}"),
            ExprKind::Name(name) => f.write_str(name),
            ExprKind::List(items) => joined(f, "[", items, ", ", "]"),
            ExprKind::Field(base, field) => write!(f, "{}.{}", Flat(base), field.text),
            ExprKind::Call { callee, args } => {
                write!(f, "{}", Flat(callee))?;
                joined(f, "(", args, ", ", ")")
            }
            ExprKind::Index(base, index) => write!(f, "{}[{}]", Flat(base), Flat(index)),
            ExprKind::Prime(base) => write!(f, "{}'", Flat(base)),
            ExprKind::Unary(UnaryOp::Neg, operand) => write!(f, "(-{})", Flat(operand)),
            ExprKind::Unary(UnaryOp::Not, operand) => write!(f, "(not {})", Flat(operand)),
            ExprKind::Power(base, exponent) => write!(f, "({}^{})", Flat(base), Flat(exponent)),
            ExprKind::Sum(chain) => {
                write!(f, "({}", Flat(&chain.first))?;
                chain
                    .rest
                    .iter()
                    .try_for_each(|link| write!(f, " {} {}", link.op.sign(), Flat(&link.operand)))?;
                f.write_str(")")
            }
            ExprKind::Product(chain) => {
                write!(f, "({}", Flat(&chain.first))?;
                chain
                    .rest
                    .iter()
                    .try_for_each(|link| write!(f, "{}{}", link.op.sign(), Flat(&link.operand)))?;
                f.write_str(")")
            }
            ExprKind::Compare(op, left, right) => write!(f, "({} {} {})", Flat(left), op.sign(), Flat(right)),
            ExprKind::Is(agent, mode) => write!(f, "({} is {})", Flat(agent), target(mode)),
            ExprKind::And(terms) => joined(f, "(", terms, " and ", ")"),
            ExprKind::Or(terms) => joined(f, "(", terms, " or ", ")"),
            ExprKind::If { condition, then, otherwise } => {
                write!(f, "(if {} then {} else {})", Flat(condition), Flat(then), Flat(otherwise))
            }
            ExprKind::Quantifier(quantifier) => write_quantifier(f, quantifier),
        }
    }
}

fn joined(f: &mut fmt::Formatter<'_>, open: &str, exprs: &[Expr], between: &str, close: &str) -> fmt::Result {
    f.write_str(open)?;
    for (k, expr) in exprs.iter().enumerate() {
        write!(f, "{}{}", if k > 0 { between } else { "" }, Flat(expr))?;
    }
    f.write_str(close)
}

fn write_quantifier(f: &mut fmt::Formatter<'_>, quantifier: &Quantifier) -> fmt::Result {
    let Quantifier { kind, binder, other, set, filter, body } = quantifier;
    let other = if other.is_some() { "other " } else { "" };
    write!(f, "({} {} in {other}{}", kind.word(), binder.text, set.text)?;
    filter.iter().try_for_each(|filter| write!(f, " where {}", Flat(filter)))?;
    body.iter().try_for_each(|body| write!(f, ": {}", Flat(body)))?;
    f.write_str(")")
}
