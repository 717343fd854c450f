//! Failures of imports.

use crate::base::{Diagnostic, Span};

/// What is wrong with an import.
pub(in crate::model) enum ImportError {
    /// Files that import each other; `circle` names them in order, `via` is where each imports the next, `span` the last.
    Circle { circle: Vec<String>, via: Vec<Span>, span: Span },
    /// A file that cannot be read.
    Unreadable { path: String, why: String, span: Span },
}

impl From<ImportError> for Diagnostic {
    fn from(error: ImportError) -> Self {
        match error {
            ImportError::Circle { circle, via, span } => {
                let first = circle.first().cloned().unwrap_or_default();
                let title = match circle.as_slice() {
                    [own] => format!("`{own}` imports itself"),
                    _ => format!("imports go in a circle: {} -> {first}", circle.join(" -> ")),
                };
                let label = if via.is_empty() { "this file" } else { "and back" };
                let diagnostic = Diagnostic::error("HY0214", title).label(span, label);
                let steps = via.into_iter().zip(circle.into_iter().skip(1));
                let diagnostic = steps.fold(diagnostic, |diagnostic, (span, name)| {
                    diagnostic.label(span, format!("to `{name}`"))
                });
                diagnostic.help("move what both need into a file that both import")
            }
            ImportError::Unreadable { path, why, span } => {
                Diagnostic::error("HY0215", format!("cannot import `{path}`: {why}"))
                    .label(span, "imported here")
                    .help("the path of an import is relative to the file in which it stands")
            }
        }
    }
}
