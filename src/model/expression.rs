//! From expressions of the text to expressions of the product: literals, operators, conditions, conversions.
//!
//! The lowering recurses over the nesting of the text, which the parser bounds; chains are loops. Whatever is wrong is
//! reported once and becomes a value of type [`Ty::Wrong`], which goes with everything.

use super::context::{Context, Scope, Value};
use super::error::{LimitError, TypeError};
use super::ir::{ExprId, ExprKind};
use super::limits;
use super::types::{Quantity, Slot, Ty};
use crate::base::Span;
use crate::math::{Op, Scale};
use crate::syntax::ast::{self, CompareOp, ProductOp, SumOp, UnaryOp};

impl<'a> Context<'a> {
    /// Checks an expression and adds it to the product.
    pub fn lower(&mut self, scope: &mut Scope<'a>, expr: &'a ast::Expr) -> Value {
        if self.depth > limits::DEPTH_MAX {
            self.report(LimitError::Depth { span: expr.span });
            return self.wrong(expr.span);
        }
        self.depth += 1;
        let value = self.lower_kind(scope, expr);
        self.depth -= 1;
        value
    }

    fn lower_kind(&mut self, scope: &mut Scope<'a>, expr: &'a ast::Expr) -> Value {
        let span = expr.span;
        match &expr.kind {
            ast::ExprKind::Number { value, text, unit } => {
                self.lower_literal(*value, text, unit.as_deref(), span)
            }
            ast::ExprKind::Text(_) => self.number(0.0, Ty::Text, span),
            ast::ExprKind::Name(name) => self.lower_name(scope, name, span),
            ast::ExprKind::List(items) => self.lower_list(scope, items, None, span),
            ast::ExprKind::Field(base, name) => self.lower_field(scope, base, name, span),
            ast::ExprKind::Call { callee, args } => self.lower_call(scope, callee, args, span),
            ast::ExprKind::Index(base, place) => self.lower_index(scope, base, place, span),
            ast::ExprKind::Prime(state) => self.lower_prime(scope, state, span),
            ast::ExprKind::Unary(UnaryOp::Neg, operand) => self.lower_negation(scope, operand, span),
            ast::ExprKind::Unary(UnaryOp::Not, operand) => {
                let condition = self.lower_condition(scope, operand);
                self.apply(Op::Not, [condition.id], condition.ty, span)
            }
            ast::ExprKind::Power(base, exponent) => self.lower_power(scope, base, exponent, span),
            ast::ExprKind::Sum(chain) => self.lower_sum(scope, chain, span),
            ast::ExprKind::Product(chain) => self.lower_product(scope, chain, span),
            ast::ExprKind::Compare(op, left, right) => self.lower_comparison(scope, *op, left, right, span),
            ast::ExprKind::Is(agent, target) => self.lower_is(scope, agent, target, span),
            ast::ExprKind::And(terms) => self.lower_terms(scope, Op::And, terms, span),
            ast::ExprKind::Or(terms) => self.lower_terms(scope, Op::Or, terms, span),
            ast::ExprKind::If { condition, then, otherwise } => {
                self.lower_if(scope, condition, [then, otherwise], Slot::plain(Ty::Wrong), span)
            }
            ast::ExprKind::Quantifier(quantifier) => self.lower_quantifier(scope, quantifier, span),
        }
    }

    /// An expression that goes into something with a declared type; a bare literal takes the declared unit. `what` names
    /// it at the beginning of a sentence.
    pub fn lower_into(
        &mut self,
        scope: &mut Scope<'a>,
        expr: &'a ast::Expr,
        slot: Slot,
        what: &str,
    ) -> Value {
        let value = self.lower_given(scope, expr, slot, what);
        self.expect(value, slot, what);
        value
    }

    /// As [`lower_into`](Self::lower_into), without a word about the dimension.
    pub fn lower_given(
        &mut self,
        scope: &mut Scope<'a>,
        expr: &'a ast::Expr,
        slot: Slot,
        what: &str,
    ) -> Value {
        if let (Ty::Real, Some(value)) = (slot.ty, bare_literal(expr)) {
            return self.declared_number(value, slot, expr.span);
        }
        let value = match &expr.kind {
            ast::ExprKind::If { condition, then, otherwise } if slot.unit.is_some() => {
                self.lower_if(scope, condition, [then, otherwise], slot, expr.span)
            }
            _ => self.lower(scope, expr),
        };
        let value = self.in_declared_unit(value, slot, expr.span);
        self.fit(value, slot.ty, expr.span, what)
    }

    /// What is worked out from bare literals alone is one: in the unit of what it goes into.
    fn in_declared_unit(&mut self, value: Value, slot: Slot, span: Span) -> Value {
        if slot.ty != Ty::Real || slot.scale() == Scale::ONE || !self.is_bare(value.id) {
            return value;
        }
        if let ExprKind::Number(number) = self.model.exprs[value.id].kind {
            return self.number(slot.scale().to_si(number), Ty::Real, span);
        }
        let unit = self.number(slot.scale().to_si(1.0), Ty::Real, span);
        self.apply(Op::Mul, [value.id, unit.id], Ty::Real, span)
    }

    fn is_bare(&self, id: ExprId) -> bool {
        match &self.model.exprs[id].kind {
            ExprKind::Number(_) => self.facts[id.index()].bare,
            ExprKind::Apply(op, operands) => {
                !op.is_boolean() && operands.iter().all(|&operand| self.is_bare(operand))
            }
            _ => false,
        }
    }

    /// A bare literal in the unit of what it goes into.
    fn declared_number(&mut self, value: f64, slot: Slot, span: Span) -> Value {
        let value = slot.scale().to_si(value);
        if !value.is_finite() {
            self.report(TypeError::TooLarge { span });
        }
        self.number(value, Ty::Real, span)
    }

    /// Converts a value to the type that is wanted, or reports that it cannot be.
    pub fn fit(&mut self, value: Value, want: Ty, span: Span, what: &str) -> Value {
        let fits = match (want, value.ty) {
            (Ty::Wrong, _) | (_, Ty::Wrong) => return Value { ty: Ty::Wrong, ..value },
            (Ty::Real, Ty::Int) => true,
            (Ty::Link(wanted), Ty::Agent(found)) => wanted == found,
            (Ty::Link(_), Ty::Nobody) => {
                self.model.exprs[value.id].ty = want.ir();
                true
            }
            (wanted, found) => wanted == found,
        };
        if fits {
            return Value { ty: want, ..value };
        }
        let what = what.to_string();
        if (want, value.ty) == (Ty::Int, Ty::Real) {
            let text = self.sources.text(span).to_string();
            self.report(TypeError::RealToInt { what, span, text });
        } else {
            let help = match (want, value.ty) {
                (Ty::Agent(wanted), Ty::Link(found)) if wanted == found => {
                    Some("declare a `link` instead, which may be none")
                }
                (Ty::Real | Ty::Int, Ty::Bool) => Some(
                    "declare what is true or false as a `bool`, `q: bool`; as a number it is `if c then 1 else 0`",
                ),
                _ => None,
            };
            let help = help.map(String::from);
            let (expected, found) = (want.describe_needed(&self.model.types), self.describe(value.ty));
            self.report(TypeError::Mismatch { what, expected, found, span, help });
        }
        Value { ty: Ty::Wrong, ..value }
    }

    /// An expression that must be a number.
    pub fn lower_number(&mut self, scope: &mut Scope<'a>, expr: &'a ast::Expr, operator: &str) -> Value {
        let value = self.lower(scope, expr);
        if value.ty.is_number() || value.ty == Ty::Wrong {
            return value;
        }
        let found = self.describe(value.ty);
        let operator = operator.to_string();
        self.report(TypeError::Operand { operator, needs: "numbers", found, span: expr.span });
        Value { ty: Ty::Wrong, ..value }
    }

    /// An expression that must be a condition; a link is one (whether it leads anywhere).
    pub fn lower_condition(&mut self, scope: &mut Scope<'a>, expr: &'a ast::Expr) -> Value {
        let value = self.lower(scope, expr);
        self.as_condition(value, expr.span)
    }

    fn as_condition(&mut self, value: Value, span: Span) -> Value {
        match value.ty {
            Ty::Bool | Ty::Wrong => value,
            Ty::Link(_) if self.choice(value).is_some() => {
                self.of_each(value, span, &mut |context, agent| context.as_condition(agent, span))
            }
            Ty::Link(_) => self.push(ExprKind::Present(value.id), Ty::Bool, span),
            Ty::Agent(_) => self.number(1.0, Ty::Bool, span),
            Ty::Nobody => self.number(0.0, Ty::Bool, span),
            Ty::Real | Ty::Int | Ty::Text | Ty::List(_) => {
                let found = self.describe(value.ty);
                self.report(TypeError::NotACondition { found, span });
                Value { ty: Ty::Wrong, ..value }
            }
        }
    }

    fn lower_literal(&mut self, value: f64, text: &str, unit: Option<&ast::UnitText>, span: Span) -> Value {
        let Some(unit) = unit else {
            let ty = if text.contains(['.', 'e', 'E']) { Ty::Real } else { Ty::Int };
            return self.bare_number(value, ty, span);
        };
        // Of a number in a unit that is none nothing else is said.
        let Some(unit) = self.unit(unit) else { return self.wrong(span) };
        let unit = Slot { ty: Ty::Real, unit: Some(unit), place: Some(span) };
        let number = self.declared_number(value, unit, span);
        self.quantities.insert(number.id, unit.quantity());
        number
    }

    fn lower_negation(&mut self, scope: &mut Scope<'a>, operand: &'a ast::Expr, span: Span) -> Value {
        let value = self.lower_number(scope, operand, "-");
        if let (ast::ExprKind::Number { .. }, ExprKind::Number(number)) =
            (&operand.kind, &self.model.exprs[value.id].kind)
        {
            let negative = -number;
            let operand = value.id;
            let value = self.number(negative, value.ty, span);
            self.facts[value.id.index()].bare = self.facts[operand.index()].bare;
            if let Some(quantity) = self.quantities.get(operand) {
                self.quantities.insert(value.id, quantity);
            }
            return value;
        }
        self.apply(Op::Neg, [value.id], value.ty, span)
    }

    fn lower_power(
        &mut self,
        scope: &mut Scope<'a>,
        base: &'a ast::Expr,
        exponent: &'a ast::Expr,
        span: Span,
    ) -> Value {
        let base = self.lower_number(scope, base, "^");
        let power = self.lower_number(scope, exponent, "^");
        if base.ty == Ty::Wrong || power.ty == Ty::Wrong {
            return self.wrong(span);
        }
        if self.facts[power.id.index()].closed {
            let Some(constant) = self.evaluate_closed(power.id) else { return self.wrong(span) };
            if f64::from(constant as i32) == constant {
                let whole = base.ty == Ty::Int && power.ty == Ty::Int && constant >= 0.0;
                let number = self.number(constant, Ty::Int, exponent.span);
                self.quantities.insert(number.id, Quantity::Of(power.id));
                let ty = if whole { Ty::Int } else { Ty::Real };
                return self.apply(Op::Powi, [base.id, number.id], ty, span);
            }
        }
        self.apply(Op::Pow, [base.id, power.id], Ty::Real, span)
    }

    fn lower_sum(&mut self, scope: &mut Scope<'a>, chain: &'a ast::Chain<SumOp>, all: Span) -> Value {
        let name = |op| match op {
            SumOp::Add => "+",
            SumOp::Sub => "-",
        };
        let mut sum =
            self.lower_number(scope, &chain.first, chain.rest.first().map_or("+", |link| name(link.op)));
        for link in &chain.rest {
            let operand = self.lower_number(scope, &link.operand, name(link.op));
            let op = match link.op {
                SumOp::Add => Op::Add,
                SumOp::Sub => Op::Sub,
            };
            let span = Span { end: link.outer.end, ..all };
            sum = self.apply(op, [sum.id, operand.id], join_numbers(sum.ty, operand.ty), span);
        }
        sum
    }

    fn lower_product(&mut self, scope: &mut Scope<'a>, chain: &'a ast::Chain<ProductOp>, all: Span) -> Value {
        let name = |op| match op {
            ProductOp::Mul => "*",
            ProductOp::Div => "/",
        };
        let mut product =
            self.lower_number(scope, &chain.first, chain.rest.first().map_or("*", |link| name(link.op)));
        for link in &chain.rest {
            let operand = self.lower_number(scope, &link.operand, name(link.op));
            let joined = join_numbers(product.ty, operand.ty);
            let (op, ty) = match link.op {
                ProductOp::Mul => (Op::Mul, joined),
                ProductOp::Div => (Op::Div, if joined == Ty::Wrong { Ty::Wrong } else { Ty::Real }),
            };
            let span = Span { end: link.outer.end, ..all };
            product = self.apply(op, [product.id, operand.id], ty, span);
        }
        product
    }

    fn lower_terms(&mut self, scope: &mut Scope<'a>, op: Op, terms: &'a [ast::Expr], span: Span) -> Value {
        let values = terms.iter().map(|term| self.lower_condition(scope, term)).collect::<Vec<_>>();
        self.join_terms(op, terms, values, span)
    }

    /// Conditions joined by `and` or `or`, from left to right; `span` is the place of all.
    pub fn join_terms(&mut self, op: Op, terms: &'a [ast::Expr], values: Vec<Value>, span: Span) -> Value {
        let mut all = values[0];
        let last = values.len() - 1;
        for (k, (term, value)) in terms.iter().zip(values).enumerate().skip(1) {
            let ty = if all.ty == Ty::Wrong { Ty::Wrong } else { value.ty };
            let end = if k == last { span.end } else { term.span.end };
            all = self.apply(op, [all.id, value.id], ty, Span { end, ..span });
        }
        all
    }

    /// A branch of an `if` that goes into something: a bare literal is in its declared unit.
    fn lower_branch(&mut self, scope: &mut Scope<'a>, branch: &'a ast::Expr, slot: Slot) -> Value {
        match (&branch.kind, bare_literal(branch)) {
            (_, Some(value)) if slot.unit.is_some() => self.declared_number(value, slot, branch.span),
            (ast::ExprKind::If { condition, then, otherwise }, _) => {
                self.lower_if(scope, condition, [then, otherwise], slot, branch.span)
            }
            _ => {
                let value = self.lower(scope, branch);
                self.in_declared_unit(value, slot, branch.span)
            }
        }
    }

    fn lower_if(
        &mut self,
        scope: &mut Scope<'a>,
        condition: &'a ast::Expr,
        [then, otherwise]: [&'a ast::Expr; 2],
        slot: Slot,
        span: Span,
    ) -> Value {
        let condition = self.lower_condition(scope, condition);
        let [yes, no] = [then, otherwise].map(|branch| self.lower_branch(scope, branch, slot));
        let ty = match (yes.ty, no.ty) {
            (Ty::Wrong, _) | (_, Ty::Wrong) => Ty::Wrong,
            (Ty::Bool, Ty::Bool) => Ty::Bool,
            (a, b) if a.is_number() && b.is_number() => join_numbers(a, b),
            (a, b) if a.is_reference() && b.is_reference() => Self::chosen_type(a, b).unwrap_or_else(|| {
                self.choice_of_unlike(a, b, otherwise.span);
                Ty::Wrong
            }),
            (a, b) => {
                let (expected, found) = (self.describe(a), self.describe(b));
                let what = "what follows `else`".to_string();
                let expected = format!("{expected}, as what follows `then`");
                self.report(TypeError::Mismatch { what, expected, found, span: otherwise.span, help: None });
                Ty::Wrong
            }
        };
        let ty = if condition.ty == Ty::Wrong { Ty::Wrong } else { ty };
        let condition = if ty == Ty::Bool { condition } else { self.counted(condition) };
        self.apply(Op::Select, [condition.id, yes.id, no.id], ty, span)
    }

    fn lower_comparison(
        &mut self,
        scope: &mut Scope<'a>,
        op: CompareOp,
        left: &'a ast::Expr,
        right: &'a ast::Expr,
        span: Span,
    ) -> Value {
        let (a, b) = match op {
            CompareOp::Equal | CompareOp::NotEqual => {
                return self.lower_equality(scope, op, left, right, span);
            }
            CompareOp::Less | CompareOp::LessEqual | CompareOp::Greater | CompareOp::GreaterEqual => {
                let name = comparison_name(op);
                (self.lower_number(scope, left, name), self.lower_number(scope, right, name))
            }
        };
        if a.ty == Ty::Wrong || b.ty == Ty::Wrong {
            return self.wrong(span);
        }
        let (op, operands) = match op {
            CompareOp::Less => (Op::Lt, [a.id, b.id]),
            CompareOp::Greater => (Op::Lt, [b.id, a.id]),
            CompareOp::LessEqual => (Op::Le, [a.id, b.id]),
            CompareOp::GreaterEqual | CompareOp::Equal | CompareOp::NotEqual => (Op::Le, [b.id, a.id]),
        };
        self.apply(op, operands, Ty::Bool, span)
    }

    fn lower_equality(
        &mut self,
        scope: &mut Scope<'a>,
        op: CompareOp,
        left: &'a ast::Expr,
        right: &'a ast::Expr,
        span: Span,
    ) -> Value {
        let (a, b) = (self.lower(scope, left), self.lower(scope, right));
        let same = match (a.ty, b.ty) {
            (Ty::Wrong, _) | (_, Ty::Wrong) => return self.wrong(span),
            (Ty::Bool, Ty::Bool) => self.apply(Op::Eq, [a.id, b.id], Ty::Bool, span),
            (x, y) if x.is_number() && y.is_number() => {
                let varies = [a, b].iter().any(|value| {
                    let facts = self.facts[value.id.index()];
                    facts.varies || facts.varies_with_locals
                });
                if varies {
                    let [left, right] = [left, right].map(|side| self.sources.text(side.span).to_string());
                    self.report(TypeError::EqualReals { span, left, right });
                    return self.wrong(span);
                }
                self.apply(Op::Eq, [a.id, b.id], Ty::Bool, span)
            }
            (Ty::Nobody, Ty::Nobody) => self.number(1.0, Ty::Bool, span),
            (Ty::Nobody, y) if y.is_reference() => self.absent(b, span),
            (x, Ty::Nobody) if x.is_reference() => self.absent(a, span),
            (x, y) if x.agent_type().is_some() && x.agent_type() == y.agent_type() => self.same(a, b, span),
            (x, y) => {
                let (expected, found) = (x.describe_needed(&self.model.types), self.describe(y));
                let what = format!("the right side of `{}`", comparison_name(op));
                let expected = format!("{expected}, as the left one");
                self.report(TypeError::Mismatch { what, expected, found, span: right.span, help: None });
                return self.wrong(span);
            }
        };
        match op {
            CompareOp::NotEqual => self.apply(Op::Not, [same.id], Ty::Bool, span),
            CompareOp::Equal
            | CompareOp::Less
            | CompareOp::LessEqual
            | CompareOp::Greater
            | CompareOp::GreaterEqual => same,
        }
    }

    /// Whether two references name the same agent, by cases if one is chosen.
    fn same(&mut self, a: Value, b: Value, span: Span) -> Value {
        if self.choice(a).is_some() {
            return self.of_each(a, span, &mut |context, a| context.same(a, b, span));
        }
        if self.choice(b).is_some() {
            return self.of_each(b, span, &mut |context, b| context.same(a, b, span));
        }
        let is_nobody = |id| matches!(self.model.exprs[id].kind, ExprKind::NoAgent);
        match (is_nobody(a.id), is_nobody(b.id)) {
            (true, true) => self.number(1.0, Ty::Bool, span),
            (true, false) => self.absent(b, span),
            (false, true) => self.absent(a, span),
            (false, false) => self.push(ExprKind::Same(a.id, b.id), Ty::Bool, span),
        }
    }

    fn absent(&mut self, reference: Value, span: Span) -> Value {
        let present = self.as_condition(reference, span);
        self.apply(Op::Not, [present.id], Ty::Bool, span)
    }
}

/// The value of a literal without a unit, possibly negated.
pub(super) fn bare_literal(expr: &ast::Expr) -> Option<f64> {
    match &expr.kind {
        ast::ExprKind::Number { value, unit: None, .. } => Some(*value),
        ast::ExprKind::Unary(UnaryOp::Neg, operand) => match &operand.kind {
            ast::ExprKind::Number { value, unit: None, .. } => Some(-*value),
            _ => None,
        },
        _ => None,
    }
}

/// The type of a sum or a product of two numbers.
pub(super) fn join_numbers(a: Ty, b: Ty) -> Ty {
    match (a, b) {
        (Ty::Wrong, _) | (_, Ty::Wrong) => Ty::Wrong,
        (Ty::Int, Ty::Int) => Ty::Int,
        _ => Ty::Real,
    }
}

fn comparison_name(op: CompareOp) -> &'static str {
    match op {
        CompareOp::Less => "<",
        CompareOp::LessEqual => "<=",
        CompareOp::Greater => ">",
        CompareOp::GreaterEqual => ">=",
        CompareOp::Equal => "==",
        CompareOp::NotEqual => "!=",
    }
}
