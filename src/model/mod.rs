//! From the tree of the text to a model: names, types, modes, data.
//!
//! In: an `Ast`, the data files it names, the settings of this run. Out: [`ir::Model`].
//! Promised: nothing after this floor sees a node of the syntax tree, and what it hands on is valid.

pub mod ir;
