//! Bare numbers that are in SI beside something that is declared in another unit (HY0613): `v > 120` for a `v` in km/h.
//!
//! A bare number in the place of a value is in the declared unit; beside `+`, `-` or a comparison, and as a rate, it is in SI.
//! Zero and infinity are the same in both.

use super::Warning;
use crate::base::Span;
use crate::math::{Op, Scale};
use crate::model::context::Context;
use crate::model::dimension::in_unit;
use crate::model::ir::{ExprId, ExprKind};
use crate::model::types::Quantity;
use crate::model::units;

/// Looks at every sum, comparison and rate.
pub(super) fn numbers(context: &Context, found: &mut Vec<Warning>) {
    let firsts = firsts(context);
    for expr in context.model.exprs.iter() {
        let ExprKind::Apply(op, operands) = &expr.kind else { continue };
        let (a, b) = match (op, &operands[..]) {
            (Op::Add | Op::Sub | Op::Min | Op::Max | Op::Mod | Op::Hypot | Op::Atan2, &[a, b]) => (a, b),
            (Op::Lt | Op::Le | Op::Eq | Op::Ne, &[a, b]) => (a, b),
            (Op::Select, &[_, a, b]) => (a, b),
            _ => continue,
        };
        for (number, other) in [(a, b), (b, a)] {
            let Some(place) = declared(context, firsts[other.index()]) else { continue };
            if context.facts[number.index()].bare {
                check(context, number, place, "", found);
            }
        }
    }
    for (ty, names) in context.model.types.iter().zip(&context.agents) {
        for (state, rate, _) in ty.modes.iter().flat_map(|mode| &mode.flow) {
            let Some(place) = names.states[*state].place else { continue };
            if context.quantities.get(*rate).is_none() {
                check(context, *rate, place, "/s", found);
            }
        }
    }
}

/// Warns if the unit at `place`, over `per`, is not that of SI.
fn check(context: &Context, number: ExprId, place: Span, per: &'static str, found: &mut Vec<Warning>) {
    let expr = &context.model.exprs[number];
    let ExprKind::Number(value) = expr.kind else { return };
    let unit = context.sources.text(place).trim_matches(['[', ']']).trim();
    let Ok(parsed) = units::parse(unit) else { return };
    if parsed.scale == Scale::ONE || value == 0.0 || !value.is_finite() {
        return;
    }
    let (number, unit) = (context.sources.text(expr.span).to_string(), format!("{unit}{per}"));
    let si = units::parse(&format!("1{per}")).ok().and_then(|per| parsed.dimension.times(per.dimension));
    let Some(si) = si else { return };
    let (in_si, si) = (in_unit(si), si.to_string());
    found.push(Warning::Beside { number, span: expr.span, unit, in_si, si, place });
}

/// For each expression, the first name or literal of the sum that it is; operands stand before their users.
fn firsts(context: &Context) -> Vec<ExprId> {
    let mut firsts: Vec<ExprId> = Vec::with_capacity(context.model.exprs.len());
    for (id, expr) in context.model.exprs.iter_enumerated() {
        firsts.push(match &expr.kind {
            ExprKind::Apply(Op::Neg | Op::Abs | Op::Add | Op::Sub | Op::Min | Op::Max, operands) => {
                firsts[operands[0].index()]
            }
            _ => id,
        });
    }
    firsts
}

/// Where a name or a literal has its unit.
fn declared(context: &Context, id: ExprId) -> Option<Span> {
    let quantity = match context.quantities.get(id) {
        Some(quantity) => quantity,
        None => context.member_quantity(id),
    };
    match quantity {
        Quantity::Declared { place, .. } => Some(place),
        Quantity::Unchecked | Quantity::As(_) | Quantity::Of(_) => None,
    }
}
