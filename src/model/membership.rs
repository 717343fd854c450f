//! Names of `system` as sets: `exists r in ramps: ...`, where `ramps = Ramp[3]`.
//!
//! Whoever belongs to a name of `system` never changes, so it is a parameter of the agent, which no text can name: whether it
//! does. A set of that name is the type's, where the parameter is true. Who is created belongs to no name.

use super::context::{Context, Global, GlobalKind, Value};
use super::ir::{ExprKind, Given, Type, TypeId, Variable};
use super::types::{Slot, Ty};
use crate::base::Span;
use crate::math::Scale;
use crate::syntax::ast;

/// A set by its name.
#[derive(Clone, Copy, PartialEq)]
pub(super) struct Named {
    /// The type of its members.
    pub ty: TypeId,
    /// The number of its name in `system`; none: all of the type.
    pub block: Option<usize>,
}

/// Gives the parameters that have been asked for the values that agents have who are created.
pub(super) fn settle(context: &mut Context) {
    for ty in context.model.types.indices().collect::<Vec<_>>() {
        for (_, param) in context.model.types[ty].memberships.clone() {
            let span = context.model.types[ty].params[param].span;
            let no = context.number(0.0, Ty::Bool, span).id;
            let params = &mut context.model.types[ty].initials.params;
            params.resize(param, None);
            params.push(Some(Given::Value(no)));
        }
    }
}

impl<'a> Context<'a> {
    /// What a quantifier ranges over; none, and a diagnostic, if that is no set.
    pub fn set_named(&mut self, name: &'a ast::Name) -> Option<Named> {
        let is_instance =
            matches!(self.globals.get(name.text.as_str()), Some(Global { kind: GlobalKind::Instance, .. }));
        if !is_instance {
            return Some(Named { ty: self.agent_named(name)?, block: None });
        }
        let block = self.instances.iter().position(|instance| instance.name.text == name.text)?;
        let ty = self.agent_named(&self.instances[block].constructor.agent)?;
        Some(Named { ty, block: Some(block) })
    }

    /// That the agent bound by a quantifier belongs to the name of `system` that it ranges over; none if it ranges over a type.
    pub fn belongs(&mut self, set: Named, binder: super::ir::BinderId, span: Span) -> Option<Value> {
        let param = self.membership(set.ty, set.block?, span);
        let bound = self.push(ExprKind::Bound(binder), Ty::Agent(set.ty), span);
        Some(self.push(ExprKind::AgentParam(bound.id, param), Ty::Bool, span))
    }

    /// The parameter that says whether an agent belongs to a name of `system`.
    fn membership(&mut self, ty: TypeId, block: usize, span: Span) -> usize {
        let model = &mut self.model.types[ty];
        if let Some((_, param)) = model.memberships.iter().find(|(known, _)| *known == block) {
            return *param;
        }
        let name = format!("in {}", self.instances[block].name.text);
        model.params.push(Variable { name, ty: Type::Bool, unit: None, scale: Scale::ONE, span });
        let param = model.params.len() - 1;
        model.memberships.push((block, param));
        self.agents[ty.index()].params.push(Slot::plain(Ty::Bool));
        param
    }
}
