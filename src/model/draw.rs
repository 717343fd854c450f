//! Values drawn by `~`: a distribution with its parameters, and the number that it gives an agent.

use super::context::{Context, Scope};
use super::error::{TypeError, ValueError};
use super::evaluate::Known;
use super::ir::Draw;
use super::types::{Slot, Ty};
use super::units::Unit;
use crate::base::Diagnostic;
use crate::math::draw::{Distribution, Key};
use crate::syntax::ast;

impl<'a> Context<'a> {
    /// `Normal(30, 3)` behind `~`, for a variable of this type; none, and a diagnostic, if it is wrong.
    pub fn lower_draw(&mut self, scope: &mut Scope<'a>, expr: &'a ast::Expr, slot: Slot) -> Option<Draw> {
        let called = match &expr.kind {
            ast::ExprKind::Call { callee, args } => match &callee.kind {
                ast::ExprKind::Name(name) => Some((name, args)),
                _ => None,
            },
            _ => None,
        };
        let found = called.and_then(|(name, args)| {
            let found = Distribution::ALL.into_iter().find(|distribution| distribution.name() == name);
            found.map(|distribution| (distribution, args))
        });
        let Some((distribution, args)) = found else {
            self.report(ValueError::NotADistribution { span: expr.span });
            return None;
        };
        if !matches!(slot.ty, Ty::Real | Ty::Wrong) {
            let found = self.describe(slot.ty);
            let help = "draw a real number beside it, and make it what is needed: `u ~ Uniform(0, 6), k: int = floor(u)`";
            self.report(TypeError::NotAllowed { what: "a drawn value", found, span: expr.span, help });
            return None;
        }
        let needed = distribution.parameters().len();
        if !self.check_count(distribution.name(), needed, needed, args.len(), expr.span) {
            return None;
        }
        let slot = match distribution {
            Distribution::Uniform | Distribution::Normal => slot,
            Distribution::Exponential => Slot { unit: slot.unit.and_then(Unit::inverse), ..slot },
        };
        let values = args.iter().zip(distribution.parameters()).map(|(arg, name)| {
            let what = format!("{name} of `{}`", distribution.name());
            self.lower_into(scope, arg, Slot { ty: Ty::Real, ..slot }, &what)
        });
        let values = values.collect::<Vec<_>>();
        if slot.ty == Ty::Wrong || values.iter().any(|value| value.ty == Ty::Wrong) {
            return None;
        }
        let all = [values[0].id, values[needed - 1].id];
        Some(Draw { distribution, all })
    }

    /// The number that a draw gives the variable of a key, SI.
    pub fn draw(&mut self, draw: &Draw, known: &Known, key: Key) -> Result<f64, Box<Diagnostic>> {
        let distribution = draw.distribution;
        let mut values = Vec::with_capacity(2);
        for &parameter in draw.parameters() {
            values.push(self.evaluate(parameter, known)?);
        }
        if let Some((wrong, needs)) = distribution.problem(&values) {
            let parameter = format!("{} of `{}`", distribution.parameters()[wrong], distribution.name());
            let variable = format!("{}.{}", key.agent, key.variable);
            let span = self.model.exprs[draw.all[wrong]].span;
            let error = ValueError::BadDraw { parameter, needs, value: values[wrong], variable, span };
            return Err(Box::new(error.into()));
        }
        Ok(distribution.draw(&values, key))
    }
}
