//! Diagnostics for programs, as JSON.

use serde_json::{Value, json};

use crate::base::{Diagnostic, SourceMap, Span};

/// A diagnostic as an object: severity, code, title, labels with their places, notes, help.
pub fn diagnostic_json(sources: &SourceMap, diagnostic: &Diagnostic) -> Value {
    let labels = diagnostic.labels.iter().map(|label| {
        let mut place = place_json(sources, label.span);
        place["text"] = json!(label.text);
        place
    });
    json!({
        "severity": diagnostic.severity.word(),
        "code": diagnostic.code,
        "title": diagnostic.title,
        "labels": labels.collect::<Vec<_>>(),
        "notes": diagnostic.notes,
        "help": diagnostic.help,
    })
}

/// A place as an object. Lines and columns count from 1, columns in characters; the end is one past the last character.
fn place_json(sources: &SourceMap, span: Span) -> Value {
    let (line, column) = sources.line_column(span);
    let (end_line, end_column) = sources.line_column(Span { start: span.end, ..span });
    json!({
        "file": sources.file(span.file).name,
        "line": line,
        "column": column,
        "end_line": end_line,
        "end_column": end_column,
    })
}
