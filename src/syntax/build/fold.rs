//! Folds a flat list of operands and operators into a tree, by precedence.
//!
//! `or` < `and` < `not` < comparisons < `+ -` < `* /` < prefix `-` < `^`; `^` joins from the right, all others from the left. Operators
//! of one precedence become one flat chain, however many there are: the fold holds what waits for its right operand and
//! nothing else.

use crate::base::Span;
use crate::syntax::ast::{Chain, ChainLink, CompareOp, Expr, ExprKind, ProductOp, SumOp, Target, UnaryOp};
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
    /// `<` and its like, of which the grammar never joins two
    Compare(CompareOp),
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
            Operator::Compare(_) => 3,
            Operator::Sum(_) => 4,
            Operator::Product(_) => 5,
            Operator::Neg => 6,
            Operator::Power => 7,
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
    left: Left,
    operator: Operator,
}

enum Left {
    Operand(Operand),
    /// A prefix has none, but a place of its own.
    Prefix(Span),
}

/// What such a list consists of.
pub enum Element {
    /// An operand with what stands behind it.
    Operand(Operand),
    /// A prefix of the next operand, and its place.
    Prefix(Operator, Span),
    /// What joins the last operand with the next.
    Infix(Operator),
    /// `is` with its mode.
    Is(Target),
}

impl Element {
    /// Whether the sum before it is complete.
    pub fn ends_arithmetic(&self) -> bool {
        match self {
            Element::Operand(_) | Element::Prefix(..) => false,
            Element::Infix(operator) => {
                operator.precedence() <= Operator::Compare(CompareOp::Less).precedence()
            }
            Element::Is(_) => true,
        }
    }
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
    /// Adds what comes next.
    pub fn add(&mut self, element: Element) {
        match element {
            Element::Operand(operand) => self.operand = Some(operand),
            Element::Prefix(operator, place) => {
                self.waiting.push(Waiting { left: Left::Prefix(place), operator });
            }
            Element::Infix(operator) => {
                self.join_while(|waiting| waiting.goes_before(operator));
                if let Some(left) = self.operand.take() {
                    self.waiting.push(Waiting { left: Left::Operand(left), operator });
                }
            }
            Element::Is(mode) => {
                self.join_while(|waiting| waiting.precedence() > Operator::Not.precedence());
                if let Some(left) = self.operand.take() {
                    let (span, height) = (left.outer.to(mode.span), left.height);
                    let kind = ExprKind::Is(left.boxed(), Box::new(mode));
                    self.operand = Some(Operand::node(kind, span, height));
                }
            }
        }
    }

    /// The tree of all operands; none, if there is none.
    pub fn finish(&mut self) -> Option<Operand> {
        self.join_while(|_| true);
        self.operand.take()
    }

    fn join_while(&mut self, goes_before: impl Fn(Operator) -> bool) {
        while self.waiting.last().is_some_and(|waiting| goes_before(waiting.operator))
            && let Some(right) = self.operand.take()
            && let Some(Waiting { left, operator }) = self.waiting.pop()
        {
            self.operand = Some(match left {
                Left::Operand(left) => self.join(left, operator, right),
                Left::Prefix(place) => prefix(operator, place, right),
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
                    Operator::Compare(op) => ExprKind::Compare(op, left.boxed(), right.boxed()),
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
