//! Writes a text again in the canonical layout: what `hyc fmt` makes of a file.
//!
//! Words and comments stay as they are, and so does which statements share a line; blanks, indentation, empty lines and the
//! line ends within statements are the printer's. Two columns of indentation a brace, at most one empty line, lines
//! of at most 100 characters where they can be broken. The tree tells where: before the weakest operators first.

mod words;
mod layout;
mod columns;
mod writer;
mod expr;
mod items;

use super::ast::Ast;
use super::scan::{Source, Token};
use words::Words;
use writer::Writer;

/// The text of a source, whose tree is `ast`, laid out. Its lines end as the first one does.
pub fn print(source: Source<'_>, ast: &Ast) -> String {
    let mut writer = Writer::new(source.text, Words::new(source.text, source.tokens));
    writer.file(&ast.items, &items::item_span, &mut |w, item| w.item(item));
    let text = columns::text(layout::lines(writer.finish()));
    let first = source.text.find('\n').unwrap_or(0);
    if source.text[..first].ends_with('\r') { text.replace('\n', "\r\n") } else { text }
}

/// All comments of a text that has these tokens, in order.
pub fn comments(text: &str, tokens: &[Token]) -> Vec<String> {
    let comments = Words::new(text, tokens).comments.into_iter().flatten();
    comments.map(|comment| comment.text.to_string()).collect()
}
