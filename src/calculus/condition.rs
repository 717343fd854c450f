//! Conditions: boolean expressions of the model in negation normal form, their comparisons as smooth atoms.
//!
//! `not` is pushed down to the comparisons: `not (a <= b)` is `b < a`. `a <= b` is the atom `a - b <= 0`. What reads no
//! state, rate or time is a discrete test, and the tests of one `and` or `or` are merged into one. A comparison with an
//! agent that is not there is false, and so is its negation. Distances are compared by their squares, whose rates are
//! regular. What comes out is a [`Cond`], a tree over nodes; `guard` numbers its atoms.

use crate::base::Span;
use crate::calculus::build;
use crate::calculus::draft::Draft;
use crate::calculus::error::Error;
use crate::calculus::frame::{EnvId, Scope, Value};
use crate::calculus::graph::NodeId;
use crate::calculus::jumps;
use crate::calculus::system::{Range, Relation, Sides};
use crate::math::Op;
use crate::model::ir::{ExprId, ExprKind, Quantifier, Type};

/// How many comparisons and tests one condition may have (HY0305).
pub const PARTS_MAX: usize = 10_000;
/// How deep `if`, quantifiers, lets and functions of a condition may be nested (HY0306).
pub const DEPTH_MAX: usize = 500;

/// A condition over nodes.
#[derive(Clone, Debug, PartialEq)]
pub enum Cond {
    /// Always or never.
    Constant(bool),
    /// Not 0; changes at events only.
    Discrete(NodeId),
    /// `g relation 0`, and how that is written.
    Atom(Relation, NodeId, Written),
    /// All.
    And(Vec<Cond>),
    /// Any.
    Or(Vec<Cond>),
    /// A quantifier: its kind, the slot it binds, the type, without self, and what is to hold.
    Quantified(Quantifier, Range, Box<Cond>),
    /// `rising(c)`.
    Rising(Box<Cond>),
}

/// The text that an atom comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Written {
    /// Where it stands.
    pub span: Span,
    /// See [`Atom::sides`](crate::calculus::system::Atom).
    pub sides: Option<Sides>,
}

/// Whether a condition or its negation is lowered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sense {
    /// As written.
    Positive,
    /// Its negation.
    Negative,
}

impl Sense {
    pub fn opposite(self) -> Self {
        match self {
            Sense::Positive => Sense::Negative,
            Sense::Negative => Sense::Positive,
        }
    }
}

/// Lowers a boolean expression.
pub fn lower(draft: &mut Draft, scope: &mut Scope, expr: ExprId, sense: Sense) -> Result<Cond, Error> {
    lower_in(draft, scope, Scope::TOP, expr, sense)
}

/// Lowers a boolean expression in an environment.
pub fn lower_in(
    draft: &mut Draft,
    scope: &mut Scope,
    env: EnvId,
    expr: ExprId,
    sense: Sense,
) -> Result<Cond, Error> {
    let span = draft.model.exprs[expr].span;
    let reading = Reading::Truth;
    Lowering { draft, scope, span, reading, sides: None, parts: 0, depth: 0, quantifiers: 0 }
        .lower(env, expr, sense)
}

/// Lowers a boolean expression so that every comparison of numbers, moving or not, is an atom whose g is minus its margin.
pub fn lower_margins(draft: &mut Draft, scope: &mut Scope, expr: ExprId) -> Result<Cond, Error> {
    let span = draft.model.exprs[expr].span;
    let reading = Reading::Margin;
    Lowering { draft, scope, span, reading, sides: None, parts: 0, depth: 0, quantifiers: 0 }.lower(
        Scope::TOP,
        expr,
        Sense::Positive,
    )
}

/// `a < b`, for numbers that have been lowered.
pub fn less(draft: &mut Draft, scope: &mut Scope, a: NodeId, b: NodeId, span: Span) -> Result<Cond, Error> {
    let sides = Some(Sides { left: a, sign: "<", right: b });
    let reading = Reading::Truth;
    Lowering { draft, scope, span, reading, sides, parts: 0, depth: 0, quantifiers: 0 }.less(
        Relation::Negative,
        a,
        b,
        span,
    )
}

/// What is asked of a comparison.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Reading {
    /// Whether it holds.
    Truth,
    /// By how much.
    Margin,
}

pub(super) struct Lowering<'d, 'm> {
    pub draft: &'d mut Draft<'m>,
    pub scope: &'d mut Scope,
    /// Where the whole condition stands.
    pub span: Span,
    /// What is asked of a comparison.
    pub reading: Reading,
    /// The comparison at hand, as it is written.
    pub sides: Option<Sides>,
    pub parts: usize,
    pub depth: usize,
    quantifiers: usize,
}

impl Lowering<'_, '_> {
    /// A boolean expression.
    pub fn lower(&mut self, env: EnvId, expr: ExprId, sense: Sense) -> Result<Cond, Error> {
        self.depth += 1;
        if self.depth > DEPTH_MAX {
            return Err(Error::ConditionTooDeep { limit: DEPTH_MAX, span: self.span });
        }
        let result = self.lower_here(env, expr, sense);
        self.depth -= 1;
        result
    }

    fn lower_here(&mut self, mut env: EnvId, mut expr: ExprId, mut sense: Sense) -> Result<Cond, Error> {
        let model = self.draft.model;
        loop {
            let span = model.exprs[expr].span;
            match &model.exprs[expr].kind {
                ExprKind::Apply(Op::Not, operands) => {
                    expr = operands[0];
                    sense = sense.opposite();
                }
                ExprKind::Apply(op @ (Op::And | Op::Or), _) => return self.junction(env, expr, *op, sense),
                ExprKind::Apply(Op::Select, operands) => return self.choice(env, operands, sense),
                ExprKind::Apply(op @ (Op::Lt | Op::Le | Op::Eq | Op::Ne), operands) => {
                    return self.comparison(env, *op, [operands[0], operands[1]], sense, span);
                }
                ExprKind::Local(k) => match self.scope.env_of(env).locals[*k] {
                    Value::Delayed(outer, argument) => (env, expr) = (outer, argument),
                    Value::Number(node) => return self.test(node, sense, span),
                    Value::Agent(_) => unreachable!("the model is typed"),
                },
                ExprKind::Call(function, arguments) => {
                    let (inner, body) = self.open_call(env, *function, arguments)?;
                    return self.lower(inner, body, sense);
                }
                ExprKind::Let(agent, k) => {
                    let agent = self.agent(env, *agent)?;
                    return match build::open_let(self.draft, self.scope, agent, *k, span)? {
                        Some((inner, body)) => self.lower(inner, body, sense),
                        None => Ok(Cond::Constant(false)),
                    };
                }
                ExprKind::Quantifier { .. } => return self.quantifier(env, expr, sense),
                ExprKind::Rising(condition) => return self.rising(env, *condition, sense, span),
                ExprKind::Crossing(e) => return self.crossing(env, *e, sense, span),
                ExprKind::Number(_)
                | ExprKind::Discrete(..)
                | ExprKind::AgentParam(..)
                | ExprKind::Present(_)
                | ExprKind::Same(..)
                | ExprKind::Is(..)
                | ExprKind::Apply(..)
                | ExprKind::Time
                | ExprKind::Received(_)
                | ExprKind::SelfAgent
                | ExprKind::Participant(_)
                | ExprKind::Bound(_)
                | ExprKind::NoAgent
                | ExprKind::Link(..)
                | ExprKind::State(..)
                | ExprKind::Aggregate { .. }
                | ExprKind::Rate(..) => {
                    let node = self.number(env, expr)?;
                    return self.test(node, sense, span);
                }
            }
        }
    }

    /// `and` and `or`; chains are lists here, however long.
    fn junction(&mut self, env: EnvId, expr: ExprId, op: Op, sense: Sense) -> Result<Cond, Error> {
        let model = self.draft.model;
        let (mut terms, mut pending) = (Vec::new(), vec![expr]);
        while let Some(next) = pending.pop() {
            match &model.exprs[next].kind {
                ExprKind::Apply(inner, operands) if *inner == op => pending.extend(operands.iter().rev()),
                _ => terms.push(self.lower(env, next, sense)?),
            }
        }
        let all = (op == Op::And) == (sense == Sense::Positive);
        Ok(self.join(if all { Op::And } else { Op::Or }, terms))
    }

    /// `and` or `or` of conditions: nested ones opened, constants applied, discrete tests merged and put first.
    pub fn join(&mut self, op: Op, terms: Vec<Cond>) -> Cond {
        let neutral = op == Op::And;
        let (mut discrete, mut rest): (Option<NodeId>, Vec<Cond>) = (None, Vec::new());
        let flat = terms.into_iter().flat_map(|term| match (term, op) {
            (Cond::And(inner), Op::And) | (Cond::Or(inner), Op::Or) => inner,
            (term, _) => vec![term],
        });
        for term in flat {
            match term {
                Cond::Constant(value) if value == neutral => {}
                Cond::Constant(value) => return Cond::Constant(value),
                Cond::Discrete(node) => {
                    discrete =
                        Some(discrete.map_or(node, |before| self.draft.graph.binary(op, before, node)));
                }
                term if rest.contains(&term) && rest.len() < 100 => {}
                term => rest.push(term),
            }
        }
        let mut all: Vec<Cond> = Vec::with_capacity(rest.len() + 1);
        if let Some(node) = discrete {
            match self.draft.graph.constant(node) {
                Some(value) if (value != 0.0) == neutral => {}
                Some(_) => return Cond::Constant(!neutral),
                None => all.push(Cond::Discrete(node)),
            }
        }
        all.append(&mut rest);
        match (all.len(), op) {
            (0, _) => Cond::Constant(neutral),
            (1, _) => all.remove(0),
            (_, Op::And) => Cond::And(all),
            _ => Cond::Or(all),
        }
    }

    /// `if c then p else q` of booleans: `c and p or not c and q`.
    fn choice(&mut self, env: EnvId, operands: &[ExprId], sense: Sense) -> Result<Cond, Error> {
        let holds = self.lower(env, operands[0], Sense::Positive)?;
        if let Cond::Constant(value) = holds {
            return self.lower(env, operands[if value { 1 } else { 2 }], sense);
        }
        let fails = self.lower(env, operands[0], Sense::Negative)?;
        let (then, otherwise) = (self.lower(env, operands[1], sense)?, self.lower(env, operands[2], sense)?);
        Ok(self.either(holds, fails, then, otherwise))
    }

    pub fn either(&mut self, holds: Cond, fails: Cond, then: Cond, otherwise: Cond) -> Cond {
        let first = self.join(Op::And, vec![holds, then]);
        let second = self.join(Op::And, vec![fails, otherwise]);
        self.join(Op::Or, vec![first, second])
    }

    fn quantifier(&mut self, env: EnvId, expr: ExprId, sense: Sense) -> Result<Cond, Error> {
        let model = self.draft.model;
        let span = model.exprs[expr].span;
        let ExprKind::Quantifier { kind, binder, set, other, filter, body } = &model.exprs[expr].kind else {
            unreachable!("called for quantifiers only")
        };
        let slot = self.scope.bind(model.binders[*binder].name.clone(), *set, *other, span)?;
        if env == Scope::TOP && self.quantifiers == 0 {
            self.scope.witnesses.insert(*binder, slot);
        }
        let inner = self.scope.bound_env(env, *binder, slot);
        let kind = match (kind, sense) {
            (Quantifier::Exists, Sense::Positive) | (Quantifier::Forall, Sense::Negative) => {
                Quantifier::Exists
            }
            (Quantifier::Forall, Sense::Positive) | (Quantifier::Exists, Sense::Negative) => {
                Quantifier::Forall
            }
        };
        self.quantifiers += 1;
        let filter_sense = match kind {
            Quantifier::Exists => Sense::Positive,
            Quantifier::Forall => Sense::Negative,
        };
        let mut terms = Vec::new();
        if let Some(filter) = filter {
            terms.push(self.lower(inner, *filter, filter_sense)?);
        }
        terms.push(self.lower(inner, *body, sense)?);
        self.quantifiers -= 1;
        Ok(self.over(kind, Range { slot, ty: set.index(), other: *other }, terms))
    }

    /// All of these conditions for one agent of a range, or one of them for every agent.
    pub fn over(&mut self, kind: Quantifier, range: Range, terms: Vec<Cond>) -> Cond {
        let body = self.join(joined_by(kind), terms);
        match (kind, &body) {
            (Quantifier::Exists, Cond::Constant(false)) | (Quantifier::Forall, Cond::Constant(true)) => body,
            _ => Cond::Quantified(kind, range, Box::new(body)),
        }
    }

    fn rising(&mut self, env: EnvId, condition: ExprId, sense: Sense, span: Span) -> Result<Cond, Error> {
        not_negated("rising", sense, span)?;
        Ok(Cond::Rising(Box::new(self.lower(env, condition, Sense::Positive)?)))
    }

    fn crossing(&mut self, env: EnvId, e: ExprId, sense: Sense, span: Span) -> Result<Cond, Error> {
        not_negated("crossing", sense, span)?;
        let g = self.number(env, e)?;
        let g = jumps::to_be_locked(&mut self.draft.graph, g);
        self.sides = None;
        self.atom(Relation::Crossing, g, span)
    }

    fn comparison(
        &mut self,
        env: EnvId,
        op: Op,
        [a, b]: [ExprId; 2],
        sense: Sense,
        span: Span,
    ) -> Result<Cond, Error> {
        let equality = matches!(op, Op::Eq | Op::Ne);
        if equality && self.draft.model.exprs[a].ty == Type::Bool {
            let same = (op == Op::Eq) == (sense == Sense::Positive);
            let (holds, fails) = (self.lower(env, a, Sense::Positive)?, self.lower(env, a, Sense::Negative)?);
            let (then, otherwise) =
                (self.lower(env, b, Sense::Positive)?, self.lower(env, b, Sense::Negative)?);
            return Ok(if same {
                self.either(holds, fails, then, otherwise)
            } else {
                self.either(holds, fails, otherwise, then)
            });
        }
        let spans = [a, b].map(|side| self.draft.model.exprs[side].span);
        let (a, b) = (self.number(env, a)?, self.number(env, b)?);
        self.sides = Some(sides(op, a, b, spans[1] < spans[0]));
        if equality {
            return self.equality((op == Op::Eq) == (sense == Sense::Positive), a, b, span);
        }
        match (op, sense) {
            (Op::Le, Sense::Positive) => self.less(Relation::NonPositive, a, b, span),
            (Op::Le, Sense::Negative) => self.less(Relation::Negative, b, a, span),
            (_, Sense::Positive) => self.less(Relation::Negative, a, b, span),
            (_, Sense::Negative) => self.less(Relation::NonPositive, b, a, span),
        }
    }
}

/// `a op b`; the source says `b > a` for `a < b` if the two are exchanged.
fn sides(op: Op, a: NodeId, b: NodeId, exchanged: bool) -> Sides {
    let sign = match (op, exchanged) {
        (Op::Le, false) => "<=",
        (Op::Le, true) => ">=",
        (Op::Eq, _) => "==",
        (Op::Ne, _) => "!=",
        (_, false) => "<",
        (_, true) => ">",
    };
    let (left, right) = if exchanged { (b, a) } else { (a, b) };
    Sides { left, sign, right }
}

/// What joins the conditions below a quantifier.
fn joined_by(kind: Quantifier) -> Op {
    match kind {
        Quantifier::Exists => Op::And,
        Quantifier::Forall => Op::Or,
    }
}

/// An event holds at an instant; its negation would hold nearly always.
fn not_negated(word: &'static str, sense: Sense, span: Span) -> Result<(), Error> {
    match sense {
        Sense::Positive => Ok(()),
        Sense::Negative => Err(Error::EventNegated { word, span }),
    }
}
