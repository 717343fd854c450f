//! Expressions: a Pratt parser folds each layer's flat list of operands and operators into a tree.

use std::sync::LazyLock;

use pest::pratt_parser::{Assoc, Op, PrattParser};

use super::Builder;
use crate::base::Span;
use crate::syntax::ast::*;
use crate::syntax::error::SyntaxError;
use crate::syntax::grammar::{Parts, Piece, Rule};
use crate::syntax::{MAX_HEIGHT, MAX_NESTING};

/// `or` < `and` < `not`; the operands are comparisons.
static LOGIC: LazyLock<PrattParser<Rule>> = LazyLock::new(|| {
    PrattParser::new()
        .op(Op::infix(Rule::kw_or, Assoc::Left))
        .op(Op::infix(Rule::kw_and, Assoc::Left))
        .op(Op::prefix(Rule::kw_not))
});

/// `+ -` < `* /` < prefix `-` < `^`; the operands are postfix expressions.
static ARITHMETIC: LazyLock<PrattParser<Rule>> = LazyLock::new(|| {
    PrattParser::new()
        .op(Op::infix(Rule::plus, Assoc::Left) | Op::infix(Rule::minus, Assoc::Left))
        .op(Op::infix(Rule::times, Assoc::Left) | Op::infix(Rule::divide, Assoc::Left))
        .op(Op::prefix(Rule::negate))
        .op(Op::infix(Rule::power, Assoc::Right))
});

/// Units that are recognised where an index stands, to say that they cannot stand there.
const UNITS: [&str; 33] = [
    "s", "ms", "us", "ns", "min", "h", "d", "m", "km", "cm", "mm", "um", "g", "kg", "t", "N", "kN", "J",
    "kJ", "W", "kW", "Hz", "kHz", "Pa", "kPa", "bar", "rad", "deg", "K", "A", "V", "mol", "C",
];

/// An expression on its way into a tree.
struct Operand {
    expr: Expr,
    /// Its place with the parentheses around it.
    outer: Span,
    /// How many nodes lie on the longest way down.
    height: usize,
}

impl Operand {
    fn node(kind: ExprKind, span: Span, below: usize) -> Self {
        Self { expr: Expr { kind, span }, outer: span, height: below + 1 }
    }

    fn boxed(self) -> Box<Expr> {
        Box::new(self.expr)
    }
}

impl Builder<'_> {
    /// The expression of a `Rule::expr`.
    pub(super) fn expr(&mut self, piece: Piece<'_>) -> Expr {
        let operand = self.logic(piece);
        if operand.height > MAX_HEIGHT {
            self.errors.push(SyntaxError::TooDeep { span: operand.expr.span, limit: MAX_HEIGHT });
        }
        operand.expr
    }

    /// What an event carries.
    pub(super) fn call_args(&mut self, piece: Piece<'_>) -> Vec<Expr> {
        Parts::of(piece).all(Rule::expr).map(|arg| self.expr(arg)).collect()
    }

    /// The expression of a `Rule::expr` inside another one; `height` becomes at least its height.
    fn inner(&mut self, piece: Piece<'_>, height: &mut usize) -> Expr {
        let operand = self.logic(piece);
        *height = operand.height.max(*height);
        operand.expr
    }

    fn logic(&mut self, piece: Piece<'_>) -> Operand {
        let (file, parts) = (self.file, Parts::of(piece).rest());
        LOGIC
            .map_primary(|part| self.comparison(part))
            .map_prefix(|op, operand| prefix(UnaryOp::Not, start_of(file, &op), operand))
            .map_infix(|left, op, right| {
                let span = left.outer.to(right.outer);
                let height = left.height.max(right.height + 1);
                let and = op.as_rule() == Rule::kw_and;
                let (kind, height) = match (left.expr.kind, and) {
                    (ExprKind::And(mut terms), true) => (ExprKind::And(push(&mut terms, right.expr)), height),
                    (ExprKind::Or(mut terms), false) => (ExprKind::Or(push(&mut terms, right.expr)), height),
                    (kind, _) => {
                        let terms = vec![Expr { kind, span: left.expr.span }, right.expr];
                        (
                            if and { ExprKind::And(terms) } else { ExprKind::Or(terms) },
                            height.max(left.height + 1),
                        )
                    }
                };
                Operand { expr: Expr { kind, span }, outer: span, height }
            })
            .parse(parts)
    }

    fn comparison(&mut self, piece: Piece<'_>) -> Operand {
        let mut parts = Parts::of(piece);
        let left = self.arithmetic(parts.expect(Rule::arithmetic));
        if parts.skip(Rule::kw_is) {
            let mode = self.plain_target(parts.expect(Rule::target));
            let (span, height) = (left.outer.to(mode.span), left.height);
            return Operand::node(ExprKind::Is(left.boxed(), mode), span, height);
        }
        let Some(op) = parts.next_if(Rule::compare_op) else { return left };
        let op = match op.as_str() {
            "<" => CompareOp::Less,
            "<=" => CompareOp::LessEqual,
            ">" => CompareOp::Greater,
            ">=" => CompareOp::GreaterEqual,
            "==" => CompareOp::Equal,
            _ => CompareOp::NotEqual,
        };
        let right = self.arithmetic(parts.expect(Rule::arithmetic));
        let (span, height) = (left.outer.to(right.outer), left.height.max(right.height));
        Operand::node(ExprKind::Compare(op, left.boxed(), right.boxed()), span, height)
    }

    fn arithmetic(&mut self, piece: Piece<'_>) -> Operand {
        let (file, parts) = (self.file, Parts::of(piece).rest());
        let mut units_behind_powers = Vec::new();
        let operand = ARITHMETIC
            .map_primary(|part| self.postfix(part))
            .map_prefix(|op, operand| prefix(UnaryOp::Neg, start_of(file, &op), operand))
            .map_infix(|left, op, right| {
                let op_span = start_of(file, &op);
                match op.as_rule() {
                    Rule::plus => sum(left, SumOp::Add, op_span, right),
                    Rule::minus => sum(left, SumOp::Sub, op_span, right),
                    Rule::times => product(left, ProductOp::Mul, op_span, right),
                    Rule::divide => product(left, ProductOp::Div, op_span, right),
                    _ => {
                        if let ExprKind::Number { unit: Some(unit), .. } = &right.expr.kind {
                            let span = unit.span;
                            let base = left.outer.to(Span { end: span.start, ..right.expr.span });
                            units_behind_powers.push(SyntaxError::MisplacedUnit {
                                span,
                                unit: unit.text.clone(),
                                base,
                            });
                        }
                        let (span, height) = (left.outer.to(right.outer), left.height.max(right.height));
                        Operand::node(ExprKind::Power(left.boxed(), right.boxed()), span, height)
                    }
                }
            })
            .parse(parts);
        self.errors.append(&mut units_behind_powers);
        operand
    }

    fn postfix(&mut self, piece: Piece<'_>) -> Operand {
        let mut parts = Parts::of(piece);
        let mut operand = self.primary(parts.next());
        for (k, suffix) in parts.rest().enumerate() {
            if k == MAX_NESTING {
                self.errors.push(SyntaxError::TooDeep { span: self.span(&suffix), limit: MAX_NESTING });
                break;
            }
            operand = self.suffix(operand, suffix);
        }
        operand
    }

    fn suffix(&mut self, base: Operand, piece: Piece<'_>) -> Operand {
        let suffix_span = self.span(&piece);
        let (span, outer, mut height) = (base.outer.to(suffix_span), base.outer, base.height);
        let rule = piece.as_rule();
        let mut parts = Parts::of(piece);
        let kind = match rule {
            Rule::field => {
                parts.expect(Rule::dot);
                ExprKind::Field(base.boxed(), self.name(parts.expect(Rule::name)))
            }
            Rule::prime => ExprKind::Prime(base.boxed()),
            Rule::subscript => {
                parts.expect(Rule::open_bracket);
                let index = self.inner(parts.expect(Rule::expr), &mut height);
                if self.is_unit_behind(&base.expr, &index) {
                    self.misplaced_unit(outer, index.span);
                }
                ExprKind::Index(base.boxed(), Box::new(index))
            }
            _ => {
                if !matches!(base.expr.kind, ExprKind::Name(_)) {
                    self.errors.push(SyntaxError::NotAFunction { span: suffix_span, callee: outer });
                }
                let args = parts.all(Rule::expr).map(|arg| self.inner(arg, &mut height)).collect();
                ExprKind::Call { callee: base.boxed(), args }
            }
        };
        Operand::node(kind, span, height)
    }

    fn primary(&mut self, piece: Piece<'_>) -> Operand {
        let span = self.span(&piece);
        let mut height = 0;
        let kind = match piece.as_rule() {
            Rule::number => self.number(piece),
            Rule::string => ExprKind::Text(self.text(piece).value),
            Rule::value_name => ExprKind::Name(piece.as_str().to_string()),
            Rule::paren => {
                let mut parts = Parts::of(piece);
                parts.expect(Rule::open_paren);
                return Operand { outer: span, ..self.logic(parts.expect(Rule::expr)) };
            }
            Rule::list => ExprKind::List(
                Parts::of(piece).all(Rule::expr).map(|item| self.inner(item, &mut height)).collect(),
            ),
            Rule::conditional => {
                let mut branches = Parts::of(piece).all(Rule::expr);
                let mut branch =
                    || Box::new(self.inner(branches.next().expect("`if` has three parts"), &mut height));
                ExprKind::If { condition: branch(), then: branch(), otherwise: branch() }
            }
            Rule::quantifier => self.quantifier(Parts::of(piece), &mut height),
            rule => unreachable!("{rule:?} is no primary of the grammar"),
        };
        Operand::node(kind, span, height)
    }

    fn number(&mut self, piece: Piece<'_>) -> ExprKind {
        let mut parts = Parts::of(piece);
        let literal = parts.expect(Rule::literal);
        let text = literal.as_str().to_string();
        let value = text.parse::<f64>().expect("the grammar's numbers are a subset of Rust's");
        if !value.is_finite() {
            self.errors.push(SyntaxError::NumberTooLarge { span: self.span(&literal) });
        }
        ExprKind::Number { value, text, unit: parts.next_if(Rule::unit).map(|unit| self.unit(unit)) }
    }

    fn quantifier(&mut self, mut parts: Parts<'_>, height: &mut usize) -> ExprKind {
        let kind = match parts.next().as_rule() {
            Rule::kw_exists => QuantifierKind::Exists,
            Rule::kw_forall => QuantifierKind::Forall,
            Rule::kw_count => QuantifierKind::Count,
            Rule::kw_sum => QuantifierKind::Sum,
            Rule::kw_min => QuantifierKind::Min,
            Rule::kw_max => QuantifierKind::Max,
            _ => QuantifierKind::Nearest,
        };
        let binder = self.name(parts.expect(Rule::name));
        parts.expect(Rule::kw_in);
        let other = parts.next_if(Rule::kw_other).map(|word| self.span(&word));
        let set = self.name(parts.expect(Rule::name));
        let filter = parts.skip(Rule::kw_where).then(|| self.inner(parts.expect(Rule::expr), height));
        let has_body = parts.skip(Rule::colon) || parts.skip(Rule::kw_by);
        let body = has_body.then(|| self.inner(parts.expect(Rule::expr), height));
        ExprKind::Quantifier(Box::new(Quantifier { kind, binder, other, set, filter, body }))
    }

    /// Whether the brackets behind `base` can only be meant as a unit.
    fn is_unit_behind(&self, base: &Expr, index: &Expr) -> bool {
        let text = self.text.get(index.span.range()).unwrap_or_default();
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

/// The place of an operator's piece; operators hold no white space.
fn start_of(file: crate::base::FileId, op: &Piece<'_>) -> Span {
    let span = op.as_span();
    Span::new(file, span.start(), span.end())
}

fn push(terms: &mut Vec<Expr>, term: Expr) -> Vec<Expr> {
    terms.push(term);
    std::mem::take(terms)
}

fn prefix(op: UnaryOp, op_span: Span, operand: Operand) -> Operand {
    let (span, height) = (op_span.to(operand.outer), operand.height);
    Operand::node(ExprKind::Unary(op, operand.boxed()), span, height)
}

fn sum(left: Operand, op: SumOp, op_span: Span, right: Operand) -> Operand {
    let (span, height) = (left.outer.to(right.outer), left.height.max(right.height + 1));
    let link = ChainLink { op, op_span, operand: right.expr };
    match left.expr.kind {
        ExprKind::Sum(chain) => longer(ExprKind::Sum, chain, link, span, height),
        kind => {
            let first = Box::new(Expr { kind, span: left.expr.span });
            longer(ExprKind::Sum, Chain { first, rest: Vec::new() }, link, span, height.max(left.height + 1))
        }
    }
}

fn product(left: Operand, op: ProductOp, op_span: Span, right: Operand) -> Operand {
    let (span, height) = (left.outer.to(right.outer), left.height.max(right.height + 1));
    let link = ChainLink { op, op_span, operand: right.expr };
    match left.expr.kind {
        ExprKind::Product(chain) => longer(ExprKind::Product, chain, link, span, height),
        kind => {
            let first = Box::new(Expr { kind, span: left.expr.span });
            longer(
                ExprKind::Product,
                Chain { first, rest: Vec::new() },
                link,
                span,
                height.max(left.height + 1),
            )
        }
    }
}

/// A chain with one more link.
fn longer<O>(
    kind: fn(Chain<O>) -> ExprKind,
    mut chain: Chain<O>,
    link: ChainLink<O>,
    span: Span,
    height: usize,
) -> Operand {
    chain.rest.push(link);
    Operand { expr: Expr { kind: kind(chain), span }, outer: span, height }
}
