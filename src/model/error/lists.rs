//! Failures of lists.

use crate::base::{Diagnostic, Span};

/// What is wrong with a list.
pub(in crate::model) enum ListError {
    /// A place that it does not have.
    OutOfRange { list: String, count: usize, index: f64, span: Span },
}

impl From<ListError> for Diagnostic {
    fn from(error: ListError) -> Self {
        match error {
            ListError::OutOfRange { list, count, index, span } => {
                let elements = if count == 1 { "1 element".to_string() } else { format!("{count} elements") };
                Diagnostic::error("HY0269", format!("`{list}[{index}]` does not exist"))
                    .label(span, format!("the list has {elements}, numbered from 0"))
            }
        }
    }
}
