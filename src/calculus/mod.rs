//! From a model to systems of equations.
//!
//! In: a `Model`. Out: a [`system::System`]: the flow, its Jacobian and second rates, guards with the rates of
//! Gear & Osterby's extra state, kinks, conditions in normal form.
//! Promised: simplification changes no value on valid input.

pub mod graph;
pub mod system;
