//! The floor that reads: text in, syntax tree out.
//!
//! In: one file's text. Out: an [`Ast`], or diagnostics (`HY01xx`). Promised: no input makes it panic, overflow a
//! stack or take more than linear time; a tree that comes out has expressions that nest no deeper than
//! [`MAX_HEIGHT`] nodes. A long text is read in slices, whose tokens are dropped as soon as they have become part of the tree. It does not know what a name, a type, a unit or a number means.

pub mod ast;
mod error;
mod scan;
mod nesting;
mod grammar;
mod words;
mod foreign;
mod expected;
mod statements;
mod slices;
mod pieces;
mod build;
mod dump;
mod print;

pub use ast::Ast;
pub use words::keywords;

use crate::base::{Diagnostic, FileId, Span};
use error::SyntaxError;
use grammar::Rule;
use pieces::Unread;
use scan::Source;

/// How deep brackets, `if`s, quantifiers, `^` and prefix operators may nest together in a text.
pub const MAX_NESTING: usize = 256;

/// How many nodes may lie on a way from the root of an expression to a leaf. Parentheses are no nodes; a chain
/// `a + b + c` is one node however long it is.
pub const MAX_HEIGHT: usize = 1024;

/// The size of the largest file, in bytes.
pub const MAX_FILE_BYTES: usize = 16 << 20;

/// How many errors of one text are told.
const ERRORS_MAX: usize = 1_000;

/// About how many bytes of a text the grammar reads at once.
const SLICE_BYTES: usize = 16 << 10;

/// The stack on which this floor recurses: several times what the deepest text needs in a build without optimisation.
const STACK_BYTES: usize = 64 << 20;

/// The syntax tree of a text, or what is wrong with the text.
pub fn parse(file: FileId, text: &str) -> Result<Ast, Vec<Diagnostic>> {
    on_large_stack(|| read(file, text))
        .map_err(|errors| errors.iter().take(ERRORS_MAX).map(SyntaxError::diagnostic).collect())
}

fn read(file: FileId, text: &str) -> Result<Ast, Vec<SyntaxError>> {
    if text.len() > MAX_FILE_BYTES {
        return Err(vec![SyntaxError::FileTooLarge { span: Span::new(file, 0, 0), limit: MAX_FILE_BYTES }]);
    }
    let tokens = scan::scan(file, text).map_err(|error| vec![error])?;
    let source = Source { file, text, tokens: &tokens };
    nesting::check_nesting(source, MAX_NESTING).map_err(|error| vec![error])?;
    build::build(source, SLICE_BYTES).unwrap_or_else(|Unread| {
        // Read at once, a text is in the language or gives the error to tell.
        let pieces = grammar::read(Rule::file, text);
        let pieces = pieces.map_err(|error| vec![expected::explain(source, &error)])?;
        build::build_read(source, pieces).expect("the grammar and the tree builder agree")
    })
}

/// The text in the canonical layout: the same words and comments, and so the same tree, at other places.
pub fn format(file: FileId, text: &str) -> Result<String, Vec<Diagnostic>> {
    let ast = parse(file, text)?;
    let tokens = scan::scan(file, text).map_err(|error| vec![error.diagnostic()])?;
    Ok(on_large_stack(|| print::print(Source { file, text, tokens: &tokens }, &ast)))
}

/// Whether two texts of the language have the same tree, at other places, and the same comments.
pub fn same(text: &str, other: &str) -> bool {
    let meaning = |text: &str| {
        let (ast, tokens) = (parse(FileId(0), text).ok()?, scan::scan(FileId(0), text).ok()?);
        let comments: Vec<String> = print::comments(text, &tokens);
        Some((dump(&ast), comments))
    };
    meaning(text).is_some_and(|this| meaning(other) == Some(this))
}

/// The tree as an indented outline without places, for `hyc show --stage ast`.
pub fn dump(ast: &Ast) -> String {
    on_large_stack(|| dump::dump(ast))
}

/// Does the work on a thread whose stack suffices for everything within this floor's limits.
fn on_large_stack<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    std::thread::scope(|scope| {
        let thread = std::thread::Builder::new().name("syntax".to_string()).stack_size(STACK_BYTES);
        let handle = thread.spawn_scoped(scope, work).expect("the system grants another thread");
        handle.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
    })
}

#[cfg(test)]
mod tests;
