//! Quantifiers: conditions over sets of agents (`exists`, `forall`) and numbers of them (`count`, `sum`, `min`, `max`).

use super::context::{Context, Home, Scope, Value};
use super::error::{NameError, TypeError};
use super::ir::{Aggregate, Binder, BinderId, ExprId, ExprKind, Quantifier, TypeId};
use super::types::Ty;
use crate::base::Span;
use crate::math::Op;
use crate::syntax::ast::{self, QuantifierKind};

/// What a quantifier asks for.
#[derive(Clone, Copy)]
enum Asks {
    /// A condition.
    Truth(Quantifier),
    /// A number.
    Number(Aggregate),
}

/// What a quantifier ranges over.
pub(super) struct Range {
    /// The name it binds.
    pub binder: BinderId,
    /// The type of its members.
    pub set: TypeId,
    /// That a member belongs to the name of `system` that stands for the set, if one does.
    pub belongs: Option<Value>,
    /// Without the agent that asks.
    pub other: bool,
}

impl<'a> Context<'a> {
    /// `exists o in other Car where p: q`, `sum o in Car: o.x`.
    pub fn lower_quantifier(
        &mut self,
        scope: &mut Scope<'a>,
        item: &'a ast::Quantifier,
        span: Span,
    ) -> Value {
        let asks = match item.kind {
            QuantifierKind::Exists => Asks::Truth(Quantifier::Exists),
            QuantifierKind::Forall => Asks::Truth(Quantifier::Forall),
            QuantifierKind::Count => Asks::Number(Aggregate::Count),
            QuantifierKind::Sum => Asks::Number(Aggregate::Sum),
            QuantifierKind::Min => Asks::Number(Aggregate::Min),
            QuantifierKind::Max => Asks::Number(Aggregate::Max),
            QuantifierKind::Nearest => return self.lower_nearest(scope, item, span),
        };
        let Some(range) = self.range(scope, item) else { return self.wrong(span) };
        scope.bound.push((&item.binder.text, range.binder));
        let filter = self.filter(scope, &range, item);
        let value = match asks {
            Asks::Truth(kind) => self.lower_truth(scope, kind, range, filter, item.body.as_ref(), span),
            Asks::Number(Aggregate::Count) => {
                self.lower_count(scope, range, filter, item.body.as_ref(), span)
            }
            Asks::Number(kind) => self.lower_fold(scope, kind, range, filter, item.body.as_ref(), span),
        };
        scope.bound.pop();
        value
    }

    /// What a quantifier ranges over; none, and a diagnostic, if that is no set.
    pub fn range(&mut self, scope: &Scope<'a>, item: &'a ast::Quantifier) -> Option<Range> {
        if let (Some(other), Home::File | Home::Function | Home::Initial(_) | Home::Construction) =
            (item.other, scope.home)
        {
            let why = "leaves out the agent that asks, and here none asks";
            let help = "leave `other` out, and compare by `!=` with an agent that is a parameter";
            self.report(NameError::NotHere { name: "other".to_string(), span: other, why, help });
        }
        let named = self.set_named(&item.set)?;
        let binder = self.model.binders.push(Binder {
            name: item.binder.text.clone(),
            ty: named.ty,
            block: named.block,
            span: item.binder.span,
        });
        let belongs = self.belongs(named, binder, item.set.span);
        Some(Range { binder, set: named.ty, belongs, other: item.other.is_some() })
    }

    /// `where`, for those who belong to the set.
    pub fn filter(
        &mut self,
        scope: &mut Scope<'a>,
        range: &Range,
        item: &'a ast::Quantifier,
    ) -> Option<Value> {
        let filter = item.filter.as_ref().map(|filter| self.lower_condition(scope, filter));
        match (range.belongs, filter) {
            (Some(belongs), Some(filter)) => {
                let span = self.model.exprs[filter.id].span;
                Some(self.apply(Op::And, [belongs.id, filter.id], filter.ty, span))
            }
            (belongs, filter) => belongs.or(filter),
        }
    }

    fn lower_truth(
        &mut self,
        scope: &mut Scope<'a>,
        kind: Quantifier,
        range: Range,
        filter: Option<Value>,
        body: Option<&'a ast::Expr>,
        span: Span,
    ) -> Value {
        let body = match (body, kind) {
            (Some(body), _) => self.lower_condition(scope, body),
            (None, Quantifier::Exists) => self.number(1.0, Ty::Bool, span),
            (None, Quantifier::Forall) => self.no_body("forall", "a condition behind `:`", span),
        };
        let Range { binder, set, other, .. } = range;
        let ty = joined(filter, Some(body), Ty::Bool);
        let filter = id(filter);
        self.push(ExprKind::Quantifier { kind, binder, set, other, filter, body: body.id }, ty, span)
    }

    /// What stands behind the colon of `count` is one condition more.
    fn lower_count(
        &mut self,
        scope: &mut Scope<'a>,
        range: Range,
        filter: Option<Value>,
        body: Option<&'a ast::Expr>,
        span: Span,
    ) -> Value {
        let body = body.map(|body| self.lower_condition(scope, body));
        let ty = joined(filter, body, Ty::Int);
        let filter = match (filter, body) {
            (Some(filter), Some(body)) => Some(self.apply(Op::And, [filter.id, body.id], Ty::Bool, span).id),
            (filter, body) => id(filter.or(body)),
        };
        let Range { binder, set, other, .. } = range;
        let kind = Aggregate::Count;
        self.push(ExprKind::Aggregate { kind, binder, set, other, filter, term: None }, ty, span)
    }

    fn lower_fold(
        &mut self,
        scope: &mut Scope<'a>,
        kind: Aggregate,
        range: Range,
        filter: Option<Value>,
        term: Option<&'a ast::Expr>,
        span: Span,
    ) -> Value {
        let term = match term {
            Some(term) => self.lower_term(scope, kind, term),
            None => self.no_body(kind.name(), "a number behind `:`", span),
        };
        let ty = joined(filter, Some(term), term.ty);
        let Range { binder, set, other, .. } = range;
        let (filter, term) = (id(filter), Some(term.id));
        self.push(ExprKind::Aggregate { kind, binder, set, other, filter, term }, ty, span)
    }

    /// What is folded: a number. A comparison there was most likely meant to compare the whole.
    fn lower_term(&mut self, scope: &mut Scope<'a>, kind: Aggregate, term: &'a ast::Expr) -> Value {
        let value = self.lower(scope, term);
        if value.ty.is_number() || value.ty == Ty::Wrong {
            return value;
        }
        let (what, expected) =
            (format!("what stands behind the `:` of `{}`", kind.name()), "a number".to_string());
        let help = (value.ty == Ty::Bool).then(|| {
            format!(
                "it extends as far right as it can; to compare the whole write `({} ... : ...) >= 1`",
                kind.name()
            )
        });
        let found = self.describe(value.ty);
        self.report(TypeError::Mismatch { what, expected, found, span: term.span, help });
        Value { ty: Ty::Wrong, ..value }
    }

    /// A condition that chooses between numbers: in a number a quantifier counts, how many there are or how many are otherwise.
    pub fn counted(&mut self, condition: Value) -> Value {
        // A chain of `and` or `or`, however long, is a loop.
        let (mut rest, mut first) = (Vec::new(), condition);
        while let ExprKind::Apply(op @ (Op::And | Op::Or), operands) = &self.model.exprs[first.id].kind
            && self.facts[first.id.index()].quantified
        {
            let [left, right] = [0, 1].map(|k| Value { id: operands[k], ty: condition.ty });
            rest.push((*op, right, self.model.exprs[first.id].span));
            first = left;
        }
        let mut all = self.counted_part(first);
        for (op, right, span) in rest.into_iter().rev() {
            let right = self.counted(right);
            all = self.apply(op, [all.id, right.id], condition.ty, span);
        }
        all
    }

    fn counted_part(&mut self, part: Value) -> Value {
        if !self.facts[part.id.index()].quantified {
            return part;
        }
        let span = self.model.exprs[part.id].span;
        match self.model.exprs[part.id].kind.clone() {
            ExprKind::Apply(op @ (Op::Not | Op::Select), operands) => {
                let all: Vec<ExprId> =
                    operands.iter().map(|&id| self.counted(Value { id, ty: part.ty }).id).collect();
                match all[..] {
                    [operand] => self.apply(op, [operand], part.ty, span),
                    [test, yes, no] => self.apply(op, [test, yes, no], part.ty, span),
                    _ => part,
                }
            }
            ExprKind::Quantifier { kind, binder, set, other, filter, body } => {
                let body = match kind {
                    Quantifier::Exists => body,
                    Quantifier::Forall => self.apply(Op::Not, [body], Ty::Bool, span).id,
                };
                let filter = match filter {
                    Some(filter) => self.apply(Op::And, [filter, body], Ty::Bool, span).id,
                    None => body,
                };
                let (kind_of, filter) = (Aggregate::Count, Some(filter));
                let count = ExprKind::Aggregate { kind: kind_of, binder, set, other, filter, term: None };
                let count = self.push(count, Ty::Int, span);
                let half = self.number(0.5, Ty::Real, span);
                let operands = match kind {
                    Quantifier::Exists => [half.id, count.id],
                    Quantifier::Forall => [count.id, half.id],
                };
                self.apply(Op::Lt, operands, Ty::Bool, span)
            }
            _ => part,
        }
    }

    pub fn no_body(&mut self, quantifier: &str, needs: &'static str, span: Span) -> Value {
        let (operator, found) = (quantifier.to_string(), "all of it".to_string());
        self.report(TypeError::Operand { operator, needs, found, span });
        self.wrong(span)
    }
}

/// The type of a quantifier whose parts are right.
fn joined(filter: Option<Value>, body: Option<Value>, ty: Ty) -> Ty {
    if filter.iter().chain(&body).any(|part| part.ty == Ty::Wrong) { Ty::Wrong } else { ty }
}

fn id(value: Option<Value>) -> Option<ExprId> {
    value.map(|value| value.id)
}
