//! From a model to systems of equations.
//!
//! In: a `Model`. Out: a [`system::System`]: the flow, its Jacobian and second rates, guards with the rates of
//! Gear & Osterby's extra state, kinks, conditions in normal form.
//! Promised: simplification changes no value on valid input.
//!
//! Letters: g is what an atom compares with zero, f a flow, x a state, u v w e any expressions, y the value of an
//! operator.

pub mod graph;
mod nonnegative;
mod relation;
mod layout;
mod range;
mod slot;
pub mod system;
pub mod access;
mod simplify;
pub mod evaluate;
pub(crate) mod derive;
pub mod print;
mod error;
mod draft;
mod frame;
mod build;
mod jumps;
mod condition;
mod extremes;
mod comparison;
mod atom;
mod locks;
mod guard;
mod aggregate;
mod kinks;
mod flow;
mod births;
mod links;
mod actions;
mod symmetry;
mod agents;
mod form;
mod bounds;
mod reader;
mod growth;
mod near;
mod dump;
mod lint;

use crate::base::Diagnostic;
use crate::calculus::draft::Draft;
pub use crate::calculus::dump::dump;
pub use crate::calculus::lint::lint;
use crate::calculus::system::System;
use crate::model::ir::Model;

/// The equations of a model, or why it has none.
pub fn derive(model: &Model) -> Result<System, Vec<Diagnostic>> {
    let mut draft = Draft::new(model);
    agents::mode_tree(&mut draft);
    agents::histories(&mut draft);
    agents::flows(&mut draft);
    agents::modes(&mut draft);
    agents::transitions(&mut draft);
    agents::lets(&mut draft);
    births::initials(&mut draft);
    links::updates(&mut draft);
    let mut interactions = agents::interactions(&mut draft);
    agents::number_declarations(&model.files, &mut draft.types, &mut interactions);
    draft.finish(interactions).map(near::ranges)
}

#[cfg(test)]
mod tests;
