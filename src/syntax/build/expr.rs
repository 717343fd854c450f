//! Expressions: the flat list of operands, of what stands behind them and of operators is folded into a tree; then operands
//! themselves.

use super::Builder;
use super::fold::{Element, Fold, Operand, Operator};
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
        let parts = Parts::of(piece);
        if self.is_worth_sharing(&parts) {
            let elements = |this: &mut Self, parts: Parts<'_>| {
                let mut elements = Vec::new();
                this.elements(parts, |_, element| elements.push(element))?;
                Ok(elements)
            };
            self.shared(parts, elements, |this, elements| {
                elements.into_iter().for_each(|element| this.fold(&mut fold, element));
            })?;
        } else {
            self.elements(parts, |this, element| this.fold(&mut fold, element))?;
        }
        let operand = fold.finish().ok_or(Unread);
        self.errors.append(&mut fold.errors);
        operand
    }

    fn fold(&mut self, fold: &mut Fold, element: Element) {
        let ends_arithmetic = element.ends_arithmetic();
        fold.add(element);
        if ends_arithmetic {
            self.errors.append(&mut fold.errors);
        }
    }

    /// Hands on the operands, each with what stands behind it, and what joins them.
    fn elements(
        &mut self,
        mut parts: Parts<'_>,
        mut take: impl FnMut(&mut Self, Element),
    ) -> Result<(), Unread> {
        let mut operand: Option<Operand> = None;
        let mut suffixes = 0;
        while let Some(part) = parts.next().transpose()? {
            let element = match part.rule() {
                Rule::unit | Rule::field | Rule::call_args | Rule::subscript | Rule::prime => {
                    suffixes += 1;
                    operand = Some(self.suffix(operand.ok_or(Unread)?, part, suffixes)?);
                    continue;
                }
                Rule::kw_not => Element::Prefix(Operator::Not, self.span(&part)),
                Rule::negate => Element::Prefix(Operator::Neg, self.span(&part)),
                Rule::operator => Element::Infix(arithmetic_operator(self.words(&part))),
                Rule::compare_op => Element::Infix(Operator::Compare(compare_operator(self.words(&part)))),
                Rule::kw_and => Element::Infix(Operator::And),
                Rule::kw_or => Element::Infix(Operator::Or),
                Rule::kw_is => Element::Is(self.plain_target(parts.expect(Rule::target)?)?),
                _ => {
                    suffixes = 0;
                    operand = Some(self.primary(part)?);
                    continue;
                }
            };
            operand.take().into_iter().for_each(|operand| take(self, Element::Operand(operand)));
            take(self, element);
        }
        operand.into_iter().for_each(|operand| take(self, Element::Operand(operand)));
        Ok(())
    }

    /// An operand with what stands behind it; `number` counts that from 1.
    fn suffix(&mut self, base: Operand, piece: Piece<'_>, number: usize) -> Result<Operand, Unread> {
        if number > MAX_NESTING {
            if number == MAX_NESTING + 1 {
                self.errors.push(SyntaxError::TooDeep { span: self.span(&piece), limit: MAX_NESTING });
            }
            return Ok(base);
        }
        let suffix_span = self.span(&piece);
        let (span, outer, mut height) = (base.outer.to(suffix_span), base.outer, base.height);
        let rule = piece.rule();
        if rule == Rule::unit {
            let ExprKind::Number { value, text, .. } = base.expr.kind else { return Err(Unread) };
            let unit = Some(Box::new(self.unit(piece)));
            return Ok(Operand::node(ExprKind::Number { value, text, unit }, span, 0));
        }
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
            Rule::literal => self.number(span),
            Rule::string => ExprKind::Text(self.text(piece).value),
            Rule::value_name => ExprKind::Name(self.source.text[span.range()].to_string()),
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

    fn number(&mut self, span: Span) -> ExprKind {
        let text = self.source.text[span.range()].to_string();
        let value = text.parse::<f64>().expect("the grammar's numbers are a subset of Rust's");
        if !value.is_finite() {
            self.errors.push(SyntaxError::NumberTooLarge { span });
        }
        ExprKind::Number { value, text, unit: None }
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

fn arithmetic_operator(sign: &str) -> Operator {
    match sign {
        "+" => Operator::Sum(SumOp::Add),
        "-" => Operator::Sum(SumOp::Sub),
        "*" => Operator::Product(ProductOp::Mul),
        "/" => Operator::Product(ProductOp::Div),
        _ => Operator::Power,
    }
}

fn compare_operator(sign: &str) -> CompareOp {
    match sign {
        "<" => CompareOp::Less,
        "<=" => CompareOp::LessEqual,
        ">" => CompareOp::Greater,
        ">=" => CompareOp::GreaterEqual,
        "==" => CompareOp::Equal,
        _ => CompareOp::NotEqual,
    }
}
