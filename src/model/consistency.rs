//! Pass 8: whether dimensions go together, in every expression and wherever a value goes into something that has a unit.
//!
//! Operands stand before their users, so one loop over the arena measures everything. The body of a function is measured once
//! with what its parameters declare; a parameter without a unit is unchecked there, and measured again for each call with the
//! dimensions of that call. What is found wrong is reported once and unchecked from then on, so that one mistake gives one error.

use std::rc::Rc;

use rustc_hash::{FxHashMap, FxHashSet};

use super::context::{Context, Goal};
use super::dimension::Dimension;
use super::error::DimensionError;
use super::ir::{ExprId, ExprKind, FunctionId, TypeId};
use super::limits;
use super::measure::{Exponent, Measure};
use super::operands::for_each_operand;
use super::types::{Quantity, Slot, Ty};
use crate::base::Span;
use crate::math::Op;

/// Checks all dimensions.
pub(super) fn check_dimensions(context: &mut Context) {
    let mut pass = Pass {
        reads_values: functions_with_open_powers(context),
        bodies: vec![None; context.model.functions.len()],
        measures: Vec::with_capacity(context.model.exprs.len()),
        known_calls: FxHashMap::default(),
        reported: FxHashSet::default(),
        steps_left: limits::INLINED_STEPS_MAX,
        context,
    };
    for id in pass.context.model.exprs.indices() {
        let measure = pass.measure(id, None);
        pass.measures.push(measure);
    }
    for goal in std::mem::take(&mut pass.context.goals) {
        pass.check_goal(&goal);
    }
}

/// What has been found out so far.
pub(super) struct Pass<'c, 'a> {
    pub(super) context: &'c mut Context<'a>,
    /// By expression.
    measures: Vec<Measure>,
    /// By function: the expressions of its body that depend on its parameters, operands first.
    bodies: Vec<Option<Rc<[ExprId]>>>,
    /// By function: whether a parameter stands in an exponent, here or in what it calls.
    reads_values: Vec<bool>,
    /// What calls with the same dimensions (and the same values, if they matter) come to.
    known_calls: FxHashMap<(FunctionId, Vec<Measure>, Vec<u64>), Measure>,
    /// The places of errors.
    reported: FxHashSet<Span>,
    steps_left: u64,
}

/// A call whose function is being measured.
pub(super) struct Frame<'f> {
    /// The call.
    pub call: ExprId,
    /// Its arguments.
    pub args: &'f [ExprId],
    /// The call in whose function it stands.
    pub around: Option<&'f Frame<'f>>,
    depth: usize,
    measures: Vec<Measure>,
    values: Vec<f64>,
    inside: FxHashMap<ExprId, Measure>,
}

impl Pass<'_, '_> {
    /// What is known of an expression that has been measured.
    pub(super) fn of(&self, id: ExprId, frame: Option<&Frame>) -> Measure {
        let inside = frame.and_then(|frame| frame.inside.get(&id));
        inside.copied().unwrap_or_else(|| self.measures[id.index()])
    }

    /// Reports an error, unless one at the same place has been reported.
    pub(super) fn report(&mut self, at: Span, error: DimensionError) {
        if self.reported.insert(at) {
            self.context.report(error);
        }
    }

    fn measure(&mut self, id: ExprId, frame: Option<&Frame>) -> Measure {
        let expr = &self.context.model.exprs[id];
        let computed = match &expr.kind {
            ExprKind::Number(_) => return self.number(id),
            ExprKind::Local(number) => return self.local(id, *number, frame),
            ExprKind::Time => Measure::Given(Dimension::TIME),
            ExprKind::State(..)
            | ExprKind::Rate(..)
            | ExprKind::Discrete(..)
            | ExprKind::AgentParam(..)
            | ExprKind::Let(..) => self.quantity_measure(self.context.member_quantity(id)),
            ExprKind::Apply(op, operands) => {
                let (op, arity) = (*op, operands.len());
                let mut all = [operands[0]; 3];
                all[..arity].copy_from_slice(operands);
                self.operator(id, op, &all[..arity], frame)
            }
            ExprKind::Call(function, args) => {
                let (function, args) = (*function, args.clone());
                self.call(id, function, &args, frame)
            }
            ExprKind::Aggregate { term: Some(term), .. } => self.of(*term, frame).named(),
            ExprKind::Aggregate { term: None, .. } => Measure::NUMBER,
            ExprKind::Received(_)
            | ExprKind::SelfAgent
            | ExprKind::Participant(_)
            | ExprKind::Bound(_)
            | ExprKind::NoAgent
            | ExprKind::Link(..)
            | ExprKind::Present(_)
            | ExprKind::Same(..)
            | ExprKind::Is(..)
            | ExprKind::Quantifier { .. }
            | ExprKind::Rising(_)
            | ExprKind::Crossing(_) => Measure::Unchecked,
        };
        match self.context.quantities.get(id) {
            None | Some(Quantity::Of(_)) => computed,
            Some(Quantity::As(_)) => computed.named(),
            Some(Quantity::Unchecked) => Measure::Unchecked,
            Some(Quantity::Declared { dimension, .. }) => Measure::Known(dimension),
        }
    }

    fn number(&self, id: ExprId) -> Measure {
        match self.context.quantities.get(id) {
            Some(Quantity::As(other)) if other == id => Measure::Unchecked,
            Some(quantity) => self.quantity_measure(quantity),
            None if self.context.facts[id.index()].bare => Measure::Bare,
            None => Measure::Unchecked,
        }
    }

    fn local(&self, id: ExprId, number: usize, frame: Option<&Frame>) -> Measure {
        match (self.context.quantities.get(id), frame) {
            (Some(Quantity::Declared { dimension, .. }), _) => Measure::Known(dimension),
            (_, Some(frame)) => frame.measures[number],
            (_, None) => Measure::Unchecked,
        }
    }

    /// That of a name.
    pub(super) fn quantity_measure(&self, quantity: Quantity) -> Measure {
        match quantity {
            Quantity::Unchecked => Measure::Unchecked,
            Quantity::Declared { dimension, .. } => Measure::Known(dimension),
            Quantity::As(other) => self.measures[other.index()].named(),
            Quantity::Of(other) => self.measures[other.index()],
        }
    }

    fn operator(&mut self, id: ExprId, op: Op, operands: &[ExprId], frame: Option<&Frame>) -> Measure {
        let of = |k: usize| self.of(operands[k], frame);
        let computed = match op {
            Op::Neg | Op::Abs | Op::Floor | Op::Ceil | Op::Round | Op::Trunc => Some(of(0)),
            Op::Add | Op::Sub | Op::Min | Op::Max | Op::Mod | Op::Hypot => {
                return self.join(id, op, [operands[0], operands[1]], frame);
            }
            Op::Atan2 => return self.join(id, op, [operands[0], operands[1]], frame).pure_number(),
            Op::Lt | Op::Le | Op::Eq | Op::Ne => {
                self.join(id, op, [operands[0], operands[1]], frame);
                Some(Measure::Unchecked)
            }
            Op::Select => return self.join(id, op, [operands[1], operands[2]], frame),
            Op::Mul => of(0).times(of(1)),
            Op::Div => of(0).over(of(1)),
            Op::Sqrt => of(0).power(1, 2),
            Op::Cbrt => of(0).power(1, 3),
            Op::Powi | Op::Pow => return self.power(id, operands[0], operands[1], frame),
            Op::Sign => Some(of(0).pure_number()),
            Op::Sin | Op::Cos | Op::Tan | Op::Asin | Op::Acos | Op::Atan | Op::Sinh | Op::Cosh | Op::Tanh => {
                return self.pure(op, operands[0], frame);
            }
            Op::Asinh | Op::Acosh | Op::Atanh | Op::Exp | Op::Log | Op::Log2 | Op::Log10 => {
                return self.pure(op, operands[0], frame);
            }
            Op::Not | Op::And | Op::Or => Some(Measure::Unchecked),
        };
        computed.unwrap_or_else(|| {
            let at = self.context.model.exprs[id].span;
            self.report(at, DimensionError::TooLarge { span: at });
            Measure::Unchecked
        })
    }

    fn join(&mut self, id: ExprId, op: Op, sides: [ExprId; 2], frame: Option<&Frame>) -> Measure {
        let [a, b] = sides.map(|side| self.of(side, frame));
        a.join(b).unwrap_or_else(|dimensions| {
            self.report_unlike(id, op, sides, dimensions, frame);
            Measure::Unchecked
        })
    }

    /// A function of pure numbers.
    fn pure(&mut self, op: Op, operand: ExprId, frame: Option<&Frame>) -> Measure {
        let measure = self.of(operand, frame);
        if let Some(found) = measure.written().filter(|&found| found != Dimension::ONE) {
            self.report_not_pure(op, operand, found, frame);
        }
        measure.pure_number()
    }

    fn power(&mut self, id: ExprId, base: ExprId, exponent: ExprId, frame: Option<&Frame>) -> Measure {
        let value = match self.value(exponent, frame) {
            value if !value.is_nan() => Exponent::Constant(value),
            _ if self.context.facts[exponent.index()].varies => Exponent::Changes,
            _ => Exponent::Fixed,
        };
        let measure = self.of(base, frame);
        measure.to_the(self.of(exponent, frame), value).unwrap_or_else(|problem| {
            self.report_power(id, [base, exponent], problem, frame);
            Measure::Unchecked
        })
    }

    /// The value of a constant; NaN if it is none.
    fn value(&mut self, id: ExprId, frame: Option<&Frame>) -> f64 {
        let facts = self.context.facts[id.index()];
        let locals = match frame {
            Some(frame) if facts.pure => frame.values.as_slice(),
            _ if facts.closed => &[],
            _ => return f64::NAN,
        };
        let model = &self.context.model;
        self.context.evaluator.evaluate_with(model, id, locals).unwrap_or(f64::NAN)
    }

    fn call(&mut self, id: ExprId, function: FunctionId, args: &[ExprId], frame: Option<&Frame>) -> Measure {
        let signature = self.context.signatures[function.index()].clone();
        for (k, (&arg, (slot, _))) in args.iter().zip(&signature.formals).enumerate() {
            self.check_argument(id, function, k, arg, *slot, frame);
        }
        let body = self.context.model.functions[function].body;
        let declared = signature.result.unit.map(|unit| Measure::Known(unit.dimension));
        let open = |(arg, (slot, _)): (&ExprId, &(Slot, _))| match slot.unit {
            Some(_) => Measure::Unchecked,
            None => self.of(*arg, frame),
        };
        let measures = args.iter().zip(&signature.formals).map(open).collect::<Vec<_>>();
        let depth = frame.map_or(0, |frame| frame.depth) + 1;
        let unchecked = measures.iter().all(|&measure| measure == Measure::Unchecked);
        if unchecked || depth > limits::INLINED_DEPTH_MAX {
            return declared.unwrap_or(self.measures[body.index()]);
        }
        let values = match self.reads_values[function.index()] {
            true => args.iter().map(|&arg| self.value(arg, frame)).collect(),
            false => vec![f64::NAN; args.len()],
        };
        let bits = values.iter().map(|value| value.to_bits()).collect();
        let key = (function, measures.clone(), bits);
        if let Some(&known) = self.known_calls.get(&key) {
            return declared.unwrap_or(known);
        }
        let inside = FxHashMap::default();
        let mut inner = Frame { call: id, args, around: frame, depth, measures, values, inside };
        let found = self.measure_body(function, &mut inner);
        if let Some(found) = found {
            let what = format!("the value of `{}`", self.context.model.functions[function].name);
            self.check_slot(body, signature.result, &what, Some(&inner));
            self.known_calls.insert(key, found);
        }
        declared.or(found).unwrap_or(self.measures[body.index()])
    }

    /// Measures the body for one call; none once all calls together have taken too long.
    fn measure_body(&mut self, function: FunctionId, frame: &mut Frame) -> Option<Measure> {
        let exprs = self.body(function);
        self.steps_left = self.steps_left.checked_sub(exprs.len() as u64)?;
        for &id in exprs.iter() {
            let measure = self.measure(id, Some(frame));
            frame.inside.insert(id, measure);
        }
        Some(self.of(self.context.model.functions[function].body, Some(frame)))
    }

    fn body(&mut self, function: FunctionId) -> Rc<[ExprId]> {
        let model = &self.context.model;
        let body = &mut self.bodies[function.index()];
        Rc::clone(body.get_or_insert_with(|| {
            let mut seen = FxHashSet::default();
            let mut work = vec![model.functions[function].body];
            while let Some(id) = work.pop() {
                if seen.insert(id) {
                    for_each_operand(&model.exprs[id].kind, |operand| work.push(operand));
                }
            }
            let mut exprs = seen.into_iter().collect::<Vec<_>>();
            exprs.sort_unstable();
            let mut depends = FxHashSet::default();
            for &id in &exprs {
                let mut any = matches!(model.exprs[id].kind, ExprKind::Local(_));
                for_each_operand(&model.exprs[id].kind, |operand| any |= depends.contains(&operand));
                if any {
                    depends.insert(id);
                }
            }
            exprs.retain(|id| depends.contains(id));
            Rc::from(exprs)
        }))
    }

    fn check_argument(
        &mut self,
        call: ExprId,
        function: FunctionId,
        number: usize,
        arg: ExprId,
        slot: Slot,
        frame: Option<&Frame>,
    ) {
        let model = &self.context.model;
        let callee = &model.functions[function];
        let what = format!("argument `{}` of `{}`", callee.params[number].0, callee.name);
        // A default stands in the declaration, where it has been checked.
        let (outer, inner) = (model.exprs[call].span, model.exprs[arg].span);
        if outer.file == inner.file && outer.start <= inner.start && inner.end <= outer.end {
            self.check_slot(arg, slot, &what, frame);
        }
    }

    fn check_goal(&mut self, goal: &Goal) {
        self.check_slot(goal.value, goal.slot, &goal.what, None);
    }

    /// What goes into something that has a unit must have its dimension.
    fn check_slot(&mut self, value: ExprId, slot: Slot, what: &str, frame: Option<&Frame>) {
        let measure = self.of(value, frame);
        let (Some(unit), Some(found)) = (slot.unit, measure.dimension()) else { return };
        if unit.dimension != found && (slot.place.is_some() || measure.written().is_some()) {
            self.report_slot(value, slot, unit.dimension, found, what, frame);
        }
    }
}

impl Context<'_> {
    /// Where the dimension of a member of an agent comes from.
    pub(super) fn member_quantity(&self, id: ExprId) -> Quantity {
        let names = |agent: &ExprId| {
            let ty: Option<TypeId> = Ty::from(self.model.exprs[*agent].ty).agent_type();
            ty.map(|ty| &self.agents[ty.index()])
        };
        let slot = match &self.model.exprs[id].kind {
            ExprKind::State(agent, number) => names(agent).map(|names| names.states[*number]),
            ExprKind::Rate(agent, number) => names(agent).map(|names| names.states[*number].per_time()),
            ExprKind::Discrete(agent, number) => names(agent).map(|names| names.discretes[*number]),
            ExprKind::AgentParam(agent, number) => names(agent).map(|names| names.params[*number]),
            ExprKind::Let(agent, number) => {
                return names(agent).map_or(Quantity::Unchecked, |names| names.lets[*number]);
            }
            _ => None,
        };
        slot.map_or(Quantity::Unchecked, |slot| slot.quantity())
    }
}

/// For each function, whether a parameter stands in an exponent, in it or in what it calls; callees stand before callers.
fn functions_with_open_powers(context: &Context) -> Vec<bool> {
    let model = &context.model;
    let is_open_power = |id: ExprId| match &model.exprs[id].kind {
        ExprKind::Apply(Op::Pow | Op::Powi, operands) => !context.facts[operands[1].index()].closed,
        _ => false,
    };
    let mut found: Vec<bool> = Vec::with_capacity(model.functions.len());
    for function in model.functions.iter() {
        let mut seen = FxHashSet::default();
        let mut work = vec![function.body];
        let mut any = false;
        while let Some(id) = work.pop() {
            if !any && seen.insert(id) {
                any |= is_open_power(id);
                if let ExprKind::Call(callee, _) = &model.exprs[id].kind {
                    any |= found.get(callee.index()).copied().unwrap_or(false);
                }
                for_each_operand(&model.exprs[id].kind, |operand| work.push(operand));
            }
        }
        found.push(any);
    }
    found
}
