//! What numbers of one column are in: a column is named by a variable alone, and types may declare one name in different units.
//!
//! Whoever names what is recorded is told of it; where everything is recorded, each type then has a column of its own.

use std::collections::BTreeSet;

use rustc_hash::FxHashMap;

use super::ir::{AgentType, Model, Type, TypeId, VarRef};
use super::units;
use crate::math::Scale;

/// What the numbers of a variable are in.
#[derive(Clone, Copy, Debug)]
pub(super) struct Measure<'m> {
    /// The declared unit; none: SI, whatever its dimension.
    pub unit: Option<&'m str>,
    scale: Scale,
}

impl Measure<'_> {
    /// Whether numbers of both can stand in one column. What has no unit goes with any unit of SI itself.
    pub fn goes_with(&self, other: &Measure<'_>) -> bool {
        let (a, b) = (self.scale.factor(), other.scale.factor());
        (a - b).abs() <= SAME * a.max(b) && self.is_of_one_kind_with(other)
    }

    /// Whether both are of one dimension, as far as it is declared, so that one unit would do for them.
    pub fn is_of_one_kind_with(&self, other: &Measure<'_>) -> bool {
        let dimension = |unit| units::parse(unit).ok().map(|unit| unit.dimension);
        match (self.unit, other.unit) {
            (Some(own), Some(other)) => own == other || dimension(own) == dimension(other),
            (None, _) | (_, None) => true,
        }
    }
}

/// Sizes that differ by less, as a share of them, are one: mL and cm^3.
const SAME: f64 = 1e-12;

/// What a recordable variable is in; none if it is no number.
pub(super) fn measure<'m>(model: &'m Model, ty: &'m AgentType, variable: VarRef) -> Option<Measure<'m>> {
    let (kind, unit, scale) = match variable {
        VarRef::State(k) => (ty.states[k].ty, &ty.states[k].unit, ty.states[k].scale),
        VarRef::Discrete(k) => (ty.discretes[k].ty, &ty.discretes[k].unit, ty.discretes[k].scale),
        VarRef::Param(k) => (ty.params[k].ty, &ty.params[k].unit, ty.params[k].scale),
        VarRef::Let(k) => (model.exprs[ty.lets[k].value].ty, &ty.lets[k].unit, ty.lets[k].scale),
        VarRef::Link(_) => return None,
    };
    matches!(kind, Type::Real | Type::Int).then_some(Measure { unit: unit.as_deref(), scale })
}

/// The names that several types have among their states and discrete variables, in different units: in tables of all agents each of
/// these types has a column of its own.
pub fn divided_names(model: &Model) -> BTreeSet<String> {
    let mut first: FxHashMap<&str, Measure<'_>> = FxHashMap::default();
    let mut divided = BTreeSet::new();
    for ty in model.visible_types().map(|ty| &model.types[ty]) {
        for (name, variable) in ty.declared.iter().filter(|(_, variable)| is_kept(*variable)) {
            let Some(measure) = measure(model, ty, *variable) else { continue };
            let known = first.entry(name).or_insert(measure);
            if !known.goes_with(&measure) {
                divided.insert(name.clone());
            } else if known.unit.is_none() {
                *known = measure;
            }
        }
    }
    divided
}

/// What is recorded of an agent of which no variable is named.
pub(super) fn is_kept(variable: VarRef) -> bool {
    matches!(variable, VarRef::State(_) | VarRef::Discrete(_))
}

/// The column of a variable in tables of all agents, where these names are divided.
pub fn column_name(model: &Model, ty: TypeId, name: &str, divided: &BTreeSet<String>) -> String {
    if divided.contains(name) { format!("{}.{name}", model.types[ty].name) } else { name.to_string() }
}
