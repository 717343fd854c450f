//! Expressions.

use super::{Name, Target, UnitText};
use crate::base::Span;

/// An expression.
#[derive(Clone, Debug, PartialEq)]
pub struct Expr {
    /// Which kind.
    pub kind: ExprKind,
    /// Its place; parentheses around it do not count.
    pub span: Span,
}

/// The kinds of expressions.
#[derive(Clone, Debug, PartialEq)]
pub enum ExprKind {
    /// `10 [ms]`
    Number {
        /// The literal's value, in the unit written; finite.
        value: f64,
        /// The literal as written, without the unit.
        text: String,
        /// The unit behind it.
        unit: Option<Box<UnitText>>,
    },
    /// `"cars.csv"`
    Text(String),
    /// A variable, function, constant, agent type, instance: any name.
    Name(String),
    /// `[a, b, c]`, never empty
    List(Vec<Expr>),
    /// `o.x`
    Field(Box<Expr>, Name),
    /// `f(a, b)`
    Call {
        /// What is called.
        callee: Box<Expr>,
        /// The arguments, by position.
        args: Vec<Expr>,
    },
    /// `cars[3]`
    Index(Box<Expr>, Box<Expr>),
    /// `x'`
    Prime(Box<Expr>),
    /// `-x`, `not p`
    Unary(UnaryOp, Box<Expr>),
    /// `base ^ exponent`
    Power(Box<Expr>, Box<Expr>),
    /// `a + b - c`
    Sum(Chain<SumOp>),
    /// `a * b / c`
    Product(Chain<ProductOp>),
    /// `a <= b`
    Compare(CompareOp, Box<Expr>, Box<Expr>),
    /// `o is Drive.Brake`
    Is(Box<Expr>, Box<Target>),
    /// `p and q and r`: two operands or more
    And(Vec<Expr>),
    /// `p or q or r`: two operands or more
    Or(Vec<Expr>),
    /// `if c then a else b`
    If {
        /// The condition.
        condition: Box<Expr>,
        /// The value where it holds.
        then: Box<Expr>,
        /// The value elsewhere.
        otherwise: Box<Expr>,
    },
    /// `exists o in other Car: o.x > x`
    Quantifier(Box<Quantifier>),
}

/// Operands joined from left to right by operators of one precedence.
#[derive(Clone, Debug, PartialEq)]
pub struct Chain<Op> {
    /// The first operand.
    pub first: Box<Expr>,
    /// Operators, each with the operand to its right; never empty.
    pub rest: Vec<ChainLink<Op>>,
}

/// One operator of a [`Chain`] and the operand to its right.
#[derive(Clone, Debug, PartialEq)]
pub struct ChainLink<Op> {
    /// The operator.
    pub op: Op,
    /// The place of the operand with the parentheses around it.
    pub outer: Span,
    /// The operand to its right.
    pub operand: Expr,
}

/// `-` and `not` before an operand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UnaryOp {
    /// `-`
    Neg,
    /// `not`
    Not,
}

/// `+` and `-` between operands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SumOp {
    /// `+`
    Add,
    /// `-`
    Sub,
}

/// `*` and `/`
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ProductOp {
    /// `*`
    Mul,
    /// `/`
    Div,
}

/// The comparisons.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CompareOp {
    /// `<`
    Less,
    /// `<=`
    LessEqual,
    /// `>`
    Greater,
    /// `>=`
    GreaterEqual,
    /// `==`
    Equal,
    /// `!=`
    NotEqual,
}

/// An expression over a set of agents.
#[derive(Clone, Debug, PartialEq)]
pub struct Quantifier {
    /// What is asked of the set.
    pub kind: QuantifierKind,
    /// The name of an agent of the set within `filter` and `body`.
    pub binder: Name,
    /// The word `other`, if it stands there: without the agent that asks.
    pub other: Option<Span>,
    /// An agent type or an instance.
    pub set: Name,
    /// The condition after `where`.
    pub filter: Option<Expr>,
    /// The expression after `:` or `by`.
    pub body: Option<Expr>,
}

/// What is asked of a set of agents.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum QuantifierKind {
    /// Whether the body holds for one.
    Exists,
    /// Whether the body holds for all.
    Forall,
    /// For how many the body holds.
    Count,
    /// The sum of the body.
    Sum,
    /// The least value of the body.
    Min,
    /// The greatest value of the body.
    Max,
    /// The agent with the least value of the body.
    Nearest,
}

impl SumOp {
    /// As it is written.
    pub fn sign(self) -> &'static str {
        match self {
            SumOp::Add => "+",
            SumOp::Sub => "-",
        }
    }
}

impl ProductOp {
    /// As it is written.
    pub fn sign(self) -> &'static str {
        match self {
            ProductOp::Mul => "*",
            ProductOp::Div => "/",
        }
    }
}

impl CompareOp {
    /// As it is written.
    pub fn sign(self) -> &'static str {
        match self {
            CompareOp::Less => "<",
            CompareOp::LessEqual => "<=",
            CompareOp::Greater => ">",
            CompareOp::GreaterEqual => ">=",
            CompareOp::Equal => "==",
            CompareOp::NotEqual => "!=",
        }
    }
}

impl QuantifierKind {
    /// As it is written.
    pub fn word(self) -> &'static str {
        match self {
            QuantifierKind::Exists => "exists",
            QuantifierKind::Forall => "forall",
            QuantifierKind::Count => "count",
            QuantifierKind::Sum => "sum",
            QuantifierKind::Min => "min",
            QuantifierKind::Max => "max",
            QuantifierKind::Nearest => "nearest",
        }
    }
}
