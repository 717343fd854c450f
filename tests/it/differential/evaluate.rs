//! The meaning of expressions, by a walk over the tree of `hyc::model::ir` in plain f64.

use std::cell::RefCell;

use hyc::math::Op;
use hyc::model::ir::{Aggregate, BinderId, ExprId, ExprKind, Model, Quantifier, Type, TypeId};

use super::world::World;

/// A comparison of reals inside a guard, with the agents that the quantifiers around it bind.
pub type Literal = (ExprId, Vec<(BinderId, usize)>);

/// The value of an expression: a number (truth: 1 and 0) or an agent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Value {
    /// A number.
    Number(f64),
    /// An agent, or none.
    Agent(Option<usize>),
}

/// Where an expression is read.
pub struct Scope<'a> {
    /// The model.
    pub model: &'a Model,
    /// The state of everything.
    pub world: &'a World,
    /// `self` twice, or the participants of an interaction.
    pub agents: [usize; 2],
    /// Whether the participants are two.
    pub pair: bool,
    /// Agents bound by quantifiers.
    pub bound: Vec<(BinderId, usize)>,
    /// Arguments of the function whose body is being read.
    pub locals: Vec<Value>,
    /// What the message carries that is being heard.
    pub received: Vec<f64>,
    /// Comparisons whose truth is decided (rule 3).
    pub decided: &'a [(Literal, bool)],
    /// Which way every branch of the expressions went.
    pub branches: Option<&'a RefCell<Vec<bool>>>,
}

impl<'a> Scope<'a> {
    /// The scope of an agent's own text, or of an interaction's.
    pub fn new(model: &'a Model, world: &'a World, agents: [usize; 2], pair: bool) -> Self {
        Self {
            model,
            world,
            agents,
            pair,
            bound: Vec::new(),
            locals: Vec::new(),
            received: Vec::new(),
            decided: &[],
            branches: None,
        }
    }

    /// A number.
    pub fn number(&mut self, expr: ExprId) -> f64 {
        match self.value(expr) {
            Value::Number(x) => x,
            Value::Agent(_) => panic!("an agent is no number"),
        }
    }

    /// Whether a condition holds.
    pub fn truth(&mut self, expr: ExprId) -> bool {
        self.number(expr) != 0.0
    }

    /// An agent, or none.
    pub fn agent(&mut self, expr: ExprId) -> Option<usize> {
        match self.value(expr) {
            Value::Agent(agent) => agent,
            Value::Number(_) => panic!("a number is no agent"),
        }
    }

    /// The agent that an expression names.
    pub fn named(&mut self, expr: ExprId) -> usize {
        self.agent(expr).expect("the generator makes no link that is none")
    }

    fn value(&mut self, expr: ExprId) -> Value {
        let model = self.model;
        Value::Number(match &model.exprs[expr].kind {
            ExprKind::Local(k) => return self.locals[*k],
            ExprKind::SelfAgent => return Value::Agent(Some(self.agents[0])),
            ExprKind::Participant(k) => return Value::Agent(Some(self.agents[*k])),
            ExprKind::Bound(binder) => {
                let found = self.bound.iter().rev().find(|(name, _)| name == binder);
                return Value::Agent(found.map(|(_, agent)| *agent));
            }
            ExprKind::NoAgent => return Value::Agent(None),
            ExprKind::Link(of, k) => {
                let of = self.named(*of);
                return Value::Agent(self.world.agents[of].links[*k]);
            }
            ExprKind::Call(function, arguments) => {
                let locals = arguments.iter().map(|argument| self.value(*argument)).collect();
                let outside = std::mem::replace(&mut self.locals, locals);
                let value = self.value(model.functions[*function].body);
                self.locals = outside;
                return value;
            }
            ExprKind::Received(k) => self.received[*k],
            ExprKind::Number(x) => *x,
            ExprKind::Time => self.world.time,
            ExprKind::State(of, k) => {
                let of = self.named(*of);
                self.world.states[self.world.agents[of].first + *k]
            }
            ExprKind::Discrete(of, k) => {
                let of = self.named(*of);
                self.world.agents[of].discretes[*k]
            }
            ExprKind::AgentParam(of, k) => {
                let of = self.named(*of);
                self.world.agents[of].params[*k]
            }
            ExprKind::Let(of, k) => {
                let of = self.named(*of);
                let mut inner = Scope::new(model, self.world, [of, of], false);
                inner.branches = self.branches;
                inner.number(model.types[self.world.agents[of].ty].lets[*k].value)
            }
            ExprKind::Apply(op, operands) => self.apply(expr, *op, operands),
            ExprKind::Present(of) => f64::from(self.agent(*of).is_some()),
            ExprKind::Same(a, b) => f64::from(self.agent(*a) == self.agent(*b)),
            ExprKind::Is(of, mode) => {
                let of = self.named(*of);
                f64::from(self.world.agents[of].active.contains(mode))
            }
            ExprKind::Quantifier { kind, binder, set, other, filter, body } => {
                let witness =
                    self.witness(*binder, *set, *other, *filter, *body, *kind == Quantifier::Exists);
                f64::from(witness.is_some() == (*kind == Quantifier::Exists))
            }
            ExprKind::Aggregate { kind, binder, set, other, filter, term } => {
                let mut terms = Vec::new();
                for candidate in self.members(*set, *other) {
                    self.bound.push((*binder, candidate));
                    if filter.is_none_or(|filter| self.truth(filter)) {
                        terms.push(term.map_or(1.0, |term| self.number(term)));
                    }
                    self.bound.pop();
                }
                match kind {
                    Aggregate::Count | Aggregate::Sum => terms.iter().sum(),
                    Aggregate::Min => terms.iter().copied().fold(f64::INFINITY, f64::min),
                    Aggregate::Max => terms.iter().copied().fold(f64::NEG_INFINITY, f64::max),
                }
            }
            ExprKind::Rate(..) | ExprKind::Rising(_) | ExprKind::Crossing(_) => {
                panic!("the generator does not write this")
            }
        })
    }

    fn apply(&mut self, expr: ExprId, op: Op, operands: &[ExprId]) -> f64 {
        if let Some((_, truth)) =
            self.decided.iter().find(|((id, bound), _)| *id == expr && *bound == self.bound)
        {
            return f64::from(*truth);
        }
        let mut values = [0.0; 3];
        if op == Op::Select {
            let first = self.truth(operands[0]);
            self.branch(first);
            return self.number(operands[if first { 1 } else { 2 }]);
        }
        for (value, operand) in values.iter_mut().zip(operands) {
            *value = self.number(*operand);
        }
        match op {
            Op::Abs => self.branch(values[0] < 0.0),
            Op::Min | Op::Max => self.branch(values[0] < values[1]),
            _ => {}
        }
        op.eval(values)
    }

    fn branch(&self, way: bool) {
        if let Some(branches) = self.branches {
            branches.borrow_mut().push(way);
        }
    }

    /// The first agent of a set for which filter and body are true (`sought`), or the filter true and the body false.
    pub fn witness(
        &mut self,
        binder: BinderId,
        set: TypeId,
        other: bool,
        filter: Option<ExprId>,
        body: ExprId,
        sought: bool,
    ) -> Option<usize> {
        for candidate in self.members(set, other) {
            self.bound.push((binder, candidate));
            let found = filter.is_none_or(|filter| self.truth(filter)) && self.truth(body) == sought;
            self.bound.pop();
            if found {
                return Some(candidate);
            }
        }
        None
    }

    fn members(&self, set: TypeId, other: bool) -> Vec<usize> {
        let out =
            |agent: &usize| other && (*agent == self.agents[0] || self.pair && *agent == self.agents[1]);
        let of_type = |agent: &usize| self.world.agents[*agent].ty == set && self.world.agents[*agent].lives;
        (0..self.world.agents.len()).filter(of_type).filter(|agent| !out(agent)).collect()
    }

    /// All comparisons of reals in a guard, each with whether an odd number of `not` stands before it.
    pub fn literals(&mut self, expr: ExprId, negated: bool, found: &mut Vec<(Literal, bool)>) {
        let model = self.model;
        match &model.exprs[expr].kind {
            ExprKind::Apply(Op::Not, operands) => self.literals(operands[0], !negated, found),
            ExprKind::Apply(Op::And | Op::Or, operands) => {
                operands.iter().for_each(|operand| self.literals(*operand, negated, found));
            }
            ExprKind::Apply(Op::Lt | Op::Le | Op::Eq, operands) => {
                if operands.iter().any(|operand| model.exprs[*operand].ty == Type::Real) {
                    found.push(((expr, self.bound.clone()), negated));
                }
                operands.iter().for_each(|operand| self.filters(*operand, found));
            }
            ExprKind::Quantifier { binder, set, other, filter, body, kind } => {
                for candidate in self.members(*set, *other) {
                    self.bound.push((*binder, candidate));
                    if let Some(filter) = filter {
                        self.literals(*filter, negated != (*kind == Quantifier::Forall), found);
                    }
                    self.literals(*body, negated, found);
                    self.bound.pop();
                }
            }
            _ => {}
        }
    }

    /// The comparisons in the filters of aggregates.
    fn filters(&mut self, expr: ExprId, found: &mut Vec<(Literal, bool)>) {
        let model = self.model;
        match &model.exprs[expr].kind {
            ExprKind::Aggregate { binder, set, other, filter: Some(filter), .. } => {
                for candidate in self.members(*set, *other) {
                    self.bound.push((*binder, candidate));
                    self.literals(*filter, false, found);
                    self.bound.pop();
                }
            }
            ExprKind::Apply(_, operands) => operands.iter().for_each(|operand| self.filters(*operand, found)),
            _ => {}
        }
    }

    /// What a comparison compares with zero: positive where it is true; and whether zero itself is.
    pub fn margin(&mut self, literal: &Literal) -> (f64, bool) {
        let model = self.model;
        let ExprKind::Apply(op, operands) = &model.exprs[literal.0].kind else { panic!("no comparison") };
        let outside = std::mem::replace(&mut self.bound, literal.1.clone());
        let margin = self.number(operands[1]) - self.number(operands[0]);
        self.bound = outside;
        (margin, *op == Op::Le)
    }
}
