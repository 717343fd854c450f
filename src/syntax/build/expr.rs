//! Expressions: each layer's flat list of operands and operators is folded into a tree; then what stands behind an operand, and
//! operands themselves.

use super::Builder;
use super::fold::{Fold, Operand, Operator};
use crate::base::Span;
use crate::syntax::ast::*;
use crate::syntax::error::SyntaxError;
use crate::syntax::grammar::Rule;
use crate::syntax::pieces::{Parts, Piece, Unread};
use crate::syntax::{MAX_HEIGHT, MAX_NESTING};

/// Units that are recognised where an index stands, to say that they cannot stand there.
const UNITS: [&str; 33] = [
    "s", "ms", "us", "ns", "min", "h", "d", "m", "km", "cm", "mm", "um", "g", "kg", "t", "N", "kN", "J",
    "kJ", "W", "kW", "Hz", "kHz", "Pa", "kPa", "bar", "rad", "deg", "K", "A", "V", "mol", "C",
];

impl Builder<'_> {
    /// The expression of a `Rule::expr`.
    pub(super) fn expr(&mut self, piece: Piece<'_>) -> Result<Expr, Unread> {
        let operand = self.logic(piece)?;
        if operand.height > MAX_HEIGHT {
            self.errors.push(SyntaxError::TooDeep { span: operand.expr.span, limit: MAX_HEIGHT });
        }
        Ok(operand.finished())
    }

    /// What an event carries.
    pub(super) fn call_args(&mut self, piece: Piece<'_>) -> Result<Vec<Expr>, Unread> {
        self.list(Parts::of(piece).all(Rule::expr), Self::expr)
    }

    /// The expression of a `Rule::expr` inside another one; `height` becomes at least its height.
    fn inner(&mut self, piece: Piece<'_>, height: &mut usize) -> Result<Expr, Unread> {
        let operand = self.logic(piece)?;
        *height = operand.height.max(*height);
        Ok(operand.finished())
    }

    fn logic(&mut self, piece: Piece<'_>) -> Result<Operand, Unread> {
        let mut fold = Fold::default();
        for part in Parts::of(piece) {
            let part = part?;
            match part.rule() {
                Rule::kw_not => fold.prefix(Operator::Not, self.place_of(&part)),
                Rule::kw_and => fold.infix(Operator::And, self.place_of(&part)),
                Rule::kw_or => fold.infix(Operator::Or, self.place_of(&part)),
                _ => {
                    let operand = self.comparison(part)?;
                    fold.operand(operand);
                }
            }
        }
        fold.finish().ok_or(Unread)
    }

    fn comparison(&mut self, piece: Piece<'_>) -> Result<Operand, Unread> {
        let mut parts = Parts::of(piece);
        let left = self.arithmetic(parts.expect(Rule::arithmetic)?)?;
        if parts.has(Rule::kw_is)? {
            let mode = self.plain_target(parts.expect(Rule::target)?)?;
            let (span, height) = (left.outer.to(mode.span), left.height);
            return Ok(Operand::node(ExprKind::Is(left.boxed(), Box::new(mode)), span, height));
        }
        let Some(op) = parts.next_if(Rule::compare_op)? else { return Ok(left) };
        let op = match op.as_str() {
            "<" => CompareOp::Less,
            "<=" => CompareOp::LessEqual,
            ">" => CompareOp::Greater,
            ">=" => CompareOp::GreaterEqual,
            "==" => CompareOp::Equal,
            _ => CompareOp::NotEqual,
        };
        let right = self.arithmetic(parts.expect(Rule::arithmetic)?)?;
        let (span, height) = (left.outer.to(right.outer), left.height.max(right.height));
        Ok(Operand::node(ExprKind::Compare(op, left.boxed(), right.boxed()), span, height))
    }

    fn arithmetic(&mut self, piece: Piece<'_>) -> Result<Operand, Unread> {
        let mut fold = Fold::default();
        for part in Parts::of(piece) {
            let part = part?;
            match part.rule() {
                Rule::negate => fold.prefix(Operator::Neg, self.place_of(&part)),
                Rule::plus => fold.infix(Operator::Sum(SumOp::Add), self.place_of(&part)),
                Rule::minus => fold.infix(Operator::Sum(SumOp::Sub), self.place_of(&part)),
                Rule::times => fold.infix(Operator::Product(ProductOp::Mul), self.place_of(&part)),
                Rule::divide => fold.infix(Operator::Product(ProductOp::Div), self.place_of(&part)),
                Rule::power => fold.infix(Operator::Power, self.place_of(&part)),
                _ => {
                    let operand = self.postfix(part)?;
                    fold.operand(operand);
                }
            }
        }
        let operand = fold.finish().ok_or(Unread);
        self.errors.append(&mut fold.errors);
        operand
    }

    /// The place of an operator's piece; operators hold no white space.
    fn place_of(&self, piece: &Piece<'_>) -> Span {
        let bytes = piece.range();
        Span::new(self.source.file, bytes.start, bytes.end)
    }

    fn postfix(&mut self, piece: Piece<'_>) -> Result<Operand, Unread> {
        let mut parts = Parts::of(piece);
        let mut operand = self.primary(parts.any()?)?;
        for (k, suffix) in parts.enumerate() {
            let suffix = suffix?;
            if k == MAX_NESTING {
                self.errors.push(SyntaxError::TooDeep { span: self.span(&suffix), limit: MAX_NESTING });
                break;
            }
            operand = self.suffix(operand, suffix)?;
        }
        Ok(operand)
    }

    fn suffix(&mut self, base: Operand, piece: Piece<'_>) -> Result<Operand, Unread> {
        let suffix_span = self.span(&piece);
        let (span, outer, mut height) = (base.outer.to(suffix_span), base.outer, base.height);
        let rule = piece.rule();
        let mut parts = Parts::of(piece);
        let kind = match rule {
            Rule::field => {
                parts.expect(Rule::dot)?;
                ExprKind::Field(base.boxed(), self.name(parts.expect(Rule::name)?))
            }
            Rule::prime => ExprKind::Prime(base.boxed()),
            Rule::subscript => {
                parts.expect(Rule::open_bracket)?;
                let index = self.inner(parts.expect(Rule::expr)?, &mut height)?;
                if self.is_unit_behind(&base.expr, &index) {
                    self.misplaced_unit(outer, index.span);
                }
                ExprKind::Index(base.boxed(), Box::new(index))
            }
            _ => {
                if !matches!(base.expr.kind, ExprKind::Name(_)) {
                    self.errors.push(SyntaxError::NotAFunction { span: suffix_span, callee: outer });
                }
                let args = self.list(parts.all(Rule::expr), |this, arg| this.inner(arg, &mut height))?;
                ExprKind::Call { callee: base.boxed(), args }
            }
        };
        Ok(Operand::node(kind, span, height))
    }

    fn primary(&mut self, piece: Piece<'_>) -> Result<Operand, Unread> {
        let span = self.span(&piece);
        let mut height = 0;
        let kind = match piece.rule() {
            Rule::number => self.number(piece)?,
            Rule::string => ExprKind::Text(self.text(piece).value),
            Rule::value_name => ExprKind::Name(piece.as_str().to_string()),
            Rule::paren => {
                let mut parts = Parts::of(piece);
                parts.expect(Rule::open_paren)?;
                return Ok(Operand { outer: span, ..self.logic(parts.expect(Rule::expr)?)? });
            }
            Rule::list => {
                let items = Parts::of(piece).all(Rule::expr);
                ExprKind::List(self.list(items, |this, item| this.inner(item, &mut height))?)
            }
            Rule::conditional => {
                let mut branches = Parts::of(piece).all(Rule::expr);
                let mut branch = || -> Result<Box<Expr>, Unread> {
                    Ok(Box::new(self.inner(branches.next().ok_or(Unread)??, &mut height)?))
                };
                ExprKind::If { condition: branch()?, then: branch()?, otherwise: branch()? }
            }
            Rule::quantifier => self.quantifier(Parts::of(piece), &mut height)?,
            _ => return Err(Unread),
        };
        Ok(Operand::node(kind, span, height))
    }

    fn number(&mut self, piece: Piece<'_>) -> Result<ExprKind, Unread> {
        let mut parts = Parts::of(piece);
        let literal = parts.expect(Rule::literal)?;
        let text = literal.as_str().to_string();
        let value = text.parse::<f64>().expect("the grammar's numbers are a subset of Rust's");
        if !value.is_finite() {
            self.errors.push(SyntaxError::NumberTooLarge { span: self.span(&literal) });
        }
        let unit = parts.next_if(Rule::unit)?.map(|unit| Box::new(self.unit(unit)));
        Ok(ExprKind::Number { value, text, unit })
    }

    fn quantifier(&mut self, mut parts: Parts<'_>, height: &mut usize) -> Result<ExprKind, Unread> {
        let kind = match parts.any()?.rule() {
            Rule::kw_exists => QuantifierKind::Exists,
            Rule::kw_forall => QuantifierKind::Forall,
            Rule::kw_count => QuantifierKind::Count,
            Rule::kw_sum => QuantifierKind::Sum,
            Rule::kw_min => QuantifierKind::Min,
            Rule::kw_max => QuantifierKind::Max,
            _ => QuantifierKind::Nearest,
        };
        let binder = self.name(parts.expect(Rule::name)?);
        parts.expect(Rule::kw_in)?;
        let other = parts.next_if(Rule::kw_other)?.map(|word| self.span(&word));
        let set = self.name(parts.expect(Rule::name)?);
        let filter = match parts.has(Rule::kw_where)? {
            true => Some(self.inner(parts.expect(Rule::expr)?, height)?),
            false => None,
        };
        let body = match parts.has(Rule::colon)? || parts.has(Rule::kw_by)? {
            true => Some(self.inner(parts.expect(Rule::expr)?, height)?),
            false => None,
        };
        Ok(ExprKind::Quantifier(Box::new(Quantifier { kind, binder, other, set, filter, body })))
    }

    /// Whether the brackets behind `base` can only be meant as a unit.
    fn is_unit_behind(&self, base: &Expr, index: &Expr) -> bool {
        let text = self.source.text.get(index.span.range()).unwrap_or_default();
        let mut words =
            text.split(|c: char| !c.is_ascii_alphabetic()).filter(|word| !word.is_empty()).peekable();
        let only_units = words.peek().is_some() && words.all(|word| UNITS.contains(&word));
        let indexable = match &base.kind {
            ExprKind::Name(_)
            | ExprKind::Field(..)
            | ExprKind::Index(..)
            | ExprKind::List(_)
            | ExprKind::Call { .. } => true,
            ExprKind::If { .. } | ExprKind::Quantifier(_) => true,
            ExprKind::Number { .. }
            | ExprKind::Text(_)
            | ExprKind::Prime(_)
            | ExprKind::Unary(..)
            | ExprKind::Power(..) => false,
            ExprKind::Sum(_) | ExprKind::Product(_) | ExprKind::Compare(..) | ExprKind::Is(..) => false,
            ExprKind::And(_) | ExprKind::Or(_) => false,
        };
        only_units && (!indexable || text.contains(['/', '^']))
    }
}
