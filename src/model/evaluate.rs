//! Evaluates constants and initial values: a stack machine over expressions, so that no chain is too long for it.
//!
//! Every operation counts against a budget, because functions that call functions can double the work at each level.

use super::ir::{ExprId, ExprKind, FunctionId, Model};
use crate::math::Op;

/// What an expression may read of the agent that is being made.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Known<'k> {
    /// The number of the agent in its array.
    pub index: f64,
    /// Its parameters so far.
    pub params: &'k [f64],
    /// Its states so far.
    pub states: &'k [f64],
    /// Its discrete variables so far.
    pub discretes: &'k [f64],
}

/// The machine; it keeps its stacks from one evaluation to the next.
#[derive(Debug)]
pub(super) struct Evaluator {
    steps_left: u64,
    work: Vec<Task>,
    values: Vec<f64>,
    locals: Vec<f64>,
}

#[derive(Clone, Copy, Debug)]
enum Task {
    Visit(ExprId),
    Apply(Op),
    Call(FunctionId, usize),
    Return { base: usize },
}

impl Evaluator {
    /// A machine with a budget of operations.
    pub fn new(steps: u64) -> Self {
        Self { steps_left: steps, work: Vec::new(), values: Vec::new(), locals: Vec::new() }
    }

    /// Adds to the budget.
    pub fn grant(&mut self, steps: u64) {
        self.steps_left = self.steps_left.saturating_add(steps);
    }

    /// The value of an expression that reads nothing but numbers, `index` and the agent's own initial data; none if the
    /// budget is used up.
    pub fn evaluate(&mut self, model: &Model, id: ExprId, known: &Known) -> Option<f64> {
        if let ExprKind::Number(value) = model.exprs[id].kind {
            return Some(value);
        }
        self.run(model, id, &[known.index], known)
    }

    /// The value of an expression that reads nothing but numbers and the parameters of its function; none if the budget is
    /// used up.
    pub fn evaluate_with(&mut self, model: &Model, id: ExprId, locals: &[f64]) -> Option<f64> {
        self.run(model, id, locals, &Known::default())
    }

    fn run(&mut self, model: &Model, id: ExprId, locals: &[f64], known: &Known) -> Option<f64> {
        self.work.clear();
        self.values.clear();
        self.locals.clear();
        self.locals.extend(locals);
        let mut base = 0;
        self.work.push(Task::Visit(id));
        while let Some(task) = self.work.pop() {
            if self.steps_left == 0 {
                return None;
            }
            self.steps_left -= 1;
            match task {
                Task::Visit(id) => self.visit(model, id, base, known),
                Task::Apply(op) => self.reduce(op),
                Task::Call(function, arity) => {
                    self.work.push(Task::Return { base });
                    base = self.locals.len();
                    let args = self.values.len() - arity;
                    self.locals.extend(self.values.drain(args..));
                    self.work.push(Task::Visit(model.functions[function].body));
                }
                Task::Return { base: caller } => {
                    self.locals.truncate(base);
                    base = caller;
                }
            }
        }
        self.values.pop()
    }

    fn visit(&mut self, model: &Model, id: ExprId, base: usize, known: &Known) {
        let value = match &model.exprs[id].kind {
            ExprKind::Number(value) => *value,
            ExprKind::Local(number) => self.locals[base + number],
            ExprKind::AgentParam(_, number) => known.params[*number],
            ExprKind::State(_, number) => known.states[*number],
            ExprKind::Discrete(_, number) => known.discretes[*number],
            ExprKind::Apply(op, operands) => {
                self.work.push(Task::Apply(*op));
                self.work.extend(operands.iter().rev().map(|&operand| Task::Visit(operand)));
                return;
            }
            ExprKind::Call(function, args) => {
                self.work.push(Task::Call(*function, args.len()));
                self.work.extend(args.iter().rev().map(|&arg| Task::Visit(arg)));
                return;
            }
            ExprKind::Time
            | ExprKind::Received(_)
            | ExprKind::SelfAgent
            | ExprKind::Participant(_)
            | ExprKind::Bound(_)
            | ExprKind::NoAgent
            | ExprKind::Link(..)
            | ExprKind::Rate(..)
            | ExprKind::Let(..)
            | ExprKind::Present(_)
            | ExprKind::Same(..)
            | ExprKind::Is(..)
            | ExprKind::Quantifier { .. }
            | ExprKind::Aggregate { .. }
            | ExprKind::Rising(_)
            | ExprKind::Crossing(_) => f64::NAN,
        };
        self.values.push(value);
    }

    fn reduce(&mut self, op: Op) {
        let first = self.values.len() - op.arity();
        let mut operands = [0.0; 3];
        operands[..op.arity()].copy_from_slice(&self.values[first..]);
        self.values.truncate(first);
        self.values.push(op.eval(operands));
    }
}
