//! Folds a flat list of operands and operators into a tree, by precedence.
//!
//! `or` < `and` < `not`, and `+ -` < `* /` < prefix `-` < `^`; `^` joins from the right, all others from the left. Operators
//! of one precedence become one flat chain, however many there are: the fold holds what waits for its right operand and
//! nothing else.

use crate::base::Span;
use crate::syntax::ast::{Chain, ChainLink, Expr, ExprKind, ProductOp, SumOp, UnaryOp};
use crate::syntax::error::SyntaxError;

/// An expression on its way into a tree.
pub struct Operand {
    /// The expression.
    pub expr: Expr,
    /// Its place with the parentheses around it.
    pub outer: Span,
    /// How many nodes lie on the longest way down.
    pub height: usize,
}

impl Operand {
    /// A node over others, the highest of which is so high.
    pub fn node(kind: ExprKind, span: Span, below: usize) -> Self {
        Self { expr: Expr { kind, span }, outer: span, height: below + 1 }
    }

    /// The expression, when nothing will be added to it.
    pub fn finished(mut self) -> Expr {
        match &mut self.expr.kind {
            ExprKind::Sum(chain) => chain.rest.shrink_to_fit(),
            ExprKind::Product(chain) => chain.rest.shrink_to_fit(),
            ExprKind::And(terms) | ExprKind::Or(terms) => terms.shrink_to_fit(),
            _ => {}
        }
        self.expr
    }

    /// The same, on its own.
    pub fn boxed(self) -> Box<Expr> {
        Box::new(self.finished())
    }
}

/// What joins operands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Operator {
    /// `or`
    Or,
    /// `and`
    And,
    /// `not`, a prefix
    Not,
    /// `+` and `-`
    Sum(SumOp),
    /// `*` and `/`
    Product(ProductOp),
    /// `-`, a prefix
    Neg,
    /// `^`
    Power,
}

impl Operator {
    fn precedence(self) -> u8 {
        match self {
            Operator::Or => 0,
            Operator::And => 1,
            Operator::Not => 2,
            Operator::Sum(_) => 3,
            Operator::Product(_) => 4,
            Operator::Neg => 5,
            Operator::Power => 6,
        }
    }

    /// Whether it takes the operand between them, if `next` comes behind that.
    fn goes_before(self, next: Operator) -> bool {
        let (this, next) = (self.precedence(), next.precedence());
        this > next || (this == next && self != Operator::Power)
    }
}

/// An operator that waits for its right operand.
struct Waiting {
    /// None of a prefix.
    left: Option<Operand>,
    operator: Operator,
    place: Span,
}

/// A list that is being folded: prefixes, an operand, an operator, and so on.
#[derive(Default)]
pub struct Fold {
    waiting: Vec<Waiting>,
    operand: Option<Operand>,
    /// What is wrong with the operands together.
    pub errors: Vec<SyntaxError>,
}

impl Fold {
    /// The next operand.
    pub fn operand(&mut self, operand: Operand) {
        self.operand = Some(operand);
    }

    /// A prefix of the next operand.
    pub fn prefix(&mut self, operator: Operator, place: Span) {
        self.waiting.push(Waiting { left: None, operator, place });
    }

    /// What joins the last operand with the next.
    pub fn infix(&mut self, operator: Operator, place: Span) {
        self.join_while(|waiting| waiting.goes_before(operator));
        let left = self.operand.take();
        self.waiting.push(Waiting { left, operator, place });
    }

    /// The tree of all operands; none, if there is none.
    pub fn finish(&mut self) -> Option<Operand> {
        self.join_while(|_| true);
        self.operand.take()
    }

    fn join_while(&mut self, goes_before: impl Fn(Operator) -> bool) {
        while self.waiting.last().is_some_and(|waiting| goes_before(waiting.operator))
            && let (Some(Waiting { left, operator, place }), Some(right)) =
                (self.waiting.pop(), self.operand.take())
        {
            self.operand = Some(match left {
                Some(left) => self.join(left, operator, right),
                None => prefix(operator, place, right),
            });
        }
    }

    fn join(&mut self, left: Operand, operator: Operator, right: Operand) -> Operand {
        let (outer, right_outer) = (left.outer.to(right.outer), right.outer);
        let height = left.height.max(right.height + 1);
        let higher = height.max(left.height + 1);
        let (kind, height) = match (left.expr.kind, operator) {
            (ExprKind::And(terms), Operator::And) => (ExprKind::And(with(terms, right.finished())), height),
            (ExprKind::Or(terms), Operator::Or) => (ExprKind::Or(with(terms, right.finished())), height),
            (ExprKind::Sum(chain), Operator::Sum(op)) => {
                (ExprKind::Sum(chain.with(op, right_outer, right.finished())), height)
            }
            (ExprKind::Product(chain), Operator::Product(op)) => {
                (ExprKind::Product(chain.with(op, right_outer, right.finished())), height)
            }
            (kind, operator) => {
                let left = Operand { expr: Expr { kind, span: left.expr.span }, ..left };
                let below = left.height.max(right.height);
                let kind = match operator {
                    Operator::And => ExprKind::And(vec![left.finished(), right.finished()]),
                    Operator::Or => ExprKind::Or(vec![left.finished(), right.finished()]),
                    Operator::Sum(op) => {
                        ExprKind::Sum(Chain::of(left.boxed(), op, right_outer, right.finished()))
                    }
                    Operator::Product(op) => {
                        ExprKind::Product(Chain::of(left.boxed(), op, right_outer, right.finished()))
                    }
                    Operator::Power | Operator::Neg | Operator::Not => {
                        self.refuse_unit_behind_power(&left, &right);
                        return Operand::node(ExprKind::Power(left.boxed(), right.boxed()), outer, below);
                    }
                };
                (kind, higher)
            }
        };
        Operand { expr: Expr { kind, span: outer }, outer, height }
    }

    fn refuse_unit_behind_power(&mut self, left: &Operand, right: &Operand) {
        if let ExprKind::Number { unit: Some(unit), .. } = &right.expr.kind {
            let base = left.outer.to(Span { end: unit.span.start, ..right.expr.span });
            let unit_text = unit.text.to_string();
            self.errors.push(SyntaxError::MisplacedUnit { span: unit.span, unit: unit_text, base });
        }
    }
}

fn with(mut terms: Vec<Expr>, term: Expr) -> Vec<Expr> {
    terms.push(term);
    terms
}

impl<O> Chain<O> {
    fn of(first: Box<Expr>, op: O, outer: Span, operand: Expr) -> Self {
        Self { first, rest: vec![ChainLink { op, outer, operand }] }
    }

    fn with(mut self, op: O, outer: Span, operand: Expr) -> Self {
        self.rest.push(ChainLink { op, outer, operand });
        self
    }
}

fn prefix(operator: Operator, place: Span, operand: Operand) -> Operand {
    let (span, height) = (place.to(operand.outer), operand.height);
    let op = if operator == Operator::Not { UnaryOp::Not } else { UnaryOp::Neg };
    Operand::node(ExprKind::Unary(op, operand.boxed()), span, height)
}
