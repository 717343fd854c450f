//! The floor that reads: text in, syntax tree out.
//!
//! In: one file's text. Out: an [`Ast`], or diagnostics (`HY01xx`). Promised: no input makes it panic, overflow a
//! stack or take more than linear time; a tree that comes out has expressions that nest no deeper than
//! [`MAX_NESTING`] brackets and prefixes. It does not know what a name, a type, a unit or a number means.

pub mod ast;

pub use ast::Ast;

use crate::base::{Diagnostic, FileId};

/// How deep brackets, `if`s, quantifiers, `^` and prefix operators may nest together.
pub const MAX_NESTING: usize = 256;

/// The syntax tree of a text, or what is wrong with the text.
pub fn parse(file: FileId, _text: &str) -> Result<Ast, Vec<Diagnostic>> {
    let _ = file;
    Ok(Ast { items: Vec::new() })
}

/// The tree as a text in the canonical layout; parsing it gives the same tree, at other places.
pub fn print(_ast: &Ast) -> String {
    String::new()
}

/// The tree as an indented outline without places, for `hyc show --stage ast`.
pub fn dump(_ast: &Ast) -> String {
    String::new()
}
