//! What every floor stands on: source files and spans, typed indices and arenas, diagnostics as data.
//!
//! In: nothing. Out: vocabulary. It knows no word of the language; [`render`] alone names the library that draws
//! diagnostics on a terminal.

pub mod arena;
pub mod source;
pub mod diagnostic;
pub mod number;
pub mod render;

pub use arena::{Arena, Idx};
pub use diagnostic::{Diagnostic, Label, Severity};
pub use number::{append_number, number_text, write_number};
pub use source::{FileId, SourceMap, Span};
