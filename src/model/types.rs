//! Types while a model is being checked: those of the product, and the few that never leave this floor.

use super::dimension::Dimension;
use super::ir::{AgentType, ExprId, Type, TypeId};
use super::units::Unit;
use crate::base::{Arena, Span};
use crate::math::Scale;

/// The type of an expression that is being checked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Ty {
    /// A real number.
    Real,
    /// A whole number.
    Int,
    /// True or false.
    Bool,
    /// A text; only parameters and file names are.
    Text,
    /// An agent that is there.
    Agent(TypeId),
    /// An agent, or none.
    Link(TypeId),
    /// `none`, before it is known of which type.
    Nobody,
    /// A list, by its number; no value holds one.
    List(usize),
    /// Something that has been reported already; it goes with everything.
    Wrong,
}

impl Ty {
    /// Whether arithmetic may use it.
    pub fn is_number(self) -> bool {
        matches!(self, Ty::Real | Ty::Int)
    }

    /// Whether it refers to an agent, or may.
    pub fn is_reference(self) -> bool {
        matches!(self, Ty::Agent(_) | Ty::Link(_) | Ty::Nobody)
    }

    /// The agent type that it refers to.
    pub fn agent_type(self) -> Option<TypeId> {
        match self {
            Ty::Agent(ty) | Ty::Link(ty) => Some(ty),
            Ty::Real | Ty::Int | Ty::Bool | Ty::Text | Ty::Nobody | Ty::List(_) | Ty::Wrong => None,
        }
    }

    /// The type in the product; those that never leave this floor become numbers, and a model with them is refused.
    pub fn ir(self) -> Type {
        match self {
            Ty::Int => Type::Int,
            Ty::Bool => Type::Bool,
            Ty::Agent(ty) => Type::Agent(ty),
            Ty::Link(ty) => Type::Link(ty),
            Ty::Real | Ty::Text | Ty::Nobody | Ty::List(_) | Ty::Wrong => Type::Real,
        }
    }

    /// In words, as something that is needed.
    pub fn describe_needed(self, types: &Arena<AgentType>) -> String {
        if self == Ty::Bool { "true or false".to_string() } else { self.describe(types) }
    }

    /// In words, with its article.
    pub fn describe(self, types: &Arena<AgentType>) -> String {
        match self {
            Ty::Real => "a real number".to_string(),
            Ty::Int => "a whole number".to_string(),
            Ty::Bool => "a condition".to_string(),
            Ty::Text => "a text".to_string(),
            Ty::Agent(ty) => format!("an agent `{}`", types[ty].name),
            Ty::Link(ty) => format!("a link to `{}`, which may be none", types[ty].name),
            Ty::Nobody => "`none`".to_string(),
            Ty::List(_) => "a list, of which one element is taken by `xs[0]`".to_string(),
            Ty::Wrong => "something that is wrong already".to_string(),
        }
    }
}

impl From<Type> for Ty {
    fn from(ty: Type) -> Ty {
        match ty {
            Type::Real => Ty::Real,
            Type::Int => Ty::Int,
            Type::Bool => Ty::Bool,
            Type::Agent(ty) => Ty::Agent(ty),
            Type::Link(ty) => Ty::Link(ty),
        }
    }
}

/// What stands side by side in `[a, b, c]`.
#[derive(Clone)]
pub(super) struct List {
    /// The elements, of one type.
    pub elements: Vec<super::context::Value>,
}

/// What a value goes into: a declared type, and the unit that a bare literal is in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Slot {
    /// The declared type.
    pub ty: Ty,
    /// The declared unit; none: its dimension is not checked.
    pub unit: Option<Unit>,
    /// Where the unit is declared; none if the language says it.
    pub place: Option<Span>,
}

impl Slot {
    /// A type without a unit.
    pub fn plain(ty: Ty) -> Slot {
        Slot { ty, unit: None, place: None }
    }

    /// A real number of a dimension that the language asks for; a bare literal is in SI.
    pub fn of(dimension: Dimension) -> Slot {
        Slot { ty: Ty::Real, unit: Some(Unit { dimension, scale: Scale::ONE }), place: None }
    }

    /// What a rate of it goes into.
    pub fn per_time(self) -> Slot {
        let dimension = self.unit.and_then(|unit| unit.dimension.over(Dimension::TIME));
        Slot { place: self.place, ..dimension.map_or(Slot::plain(Ty::Real), Slot::of) }
    }

    /// The size of the declared unit; that of SI if none is.
    pub fn scale(&self) -> Scale {
        self.unit.map_or(Scale::ONE, |unit| unit.scale)
    }

    /// What is known of the dimension of what it holds.
    pub fn quantity(&self) -> Quantity {
        match (self.unit, self.place) {
            (Some(unit), Some(place)) => Quantity::Declared { dimension: unit.dimension, place },
            (Some(_), None) | (None, _) => Quantity::Unchecked,
        }
    }
}

/// Where the dimension of a name or of a literal comes from.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) enum Quantity {
    /// It has no unit.
    #[default]
    Unchecked,
    /// It has a unit of its own.
    Declared {
        /// The unit's dimension.
        dimension: Dimension,
        /// Where the unit stands.
        place: Span,
    },
    /// It is a name for an expression.
    As(ExprId),
    /// It is the value of a constant expression.
    Of(ExprId),
}
