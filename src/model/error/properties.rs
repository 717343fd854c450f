//! Failures of properties.

use crate::base::{Diagnostic, Span, number_text};

/// What is wrong with a property.
pub(in crate::model) enum PropertyError {
    /// A window that ends before it begins, or begins in the past.
    Window { from: f64, to: f64, span: Span },
    /// `self` where there is no agent.
    NoSelf { span: Span },
}

impl From<PropertyError> for Diagnostic {
    fn from(error: PropertyError) -> Self {
        match error {
            PropertyError::Window { from, to, span } => {
                let (from, to) = (number_text(from), number_text(to));
                Diagnostic::error("HY0216", "a window is from one time to a later one, from now on")
                    .label(span, format!("this one is from {from} s to {to} s"))
                    .help("write `[0, 5]` for the next five seconds, `[2, inf]` for all from two seconds on")
            }
            PropertyError::NoSelf { span } => {
                Diagnostic::error("HY0217", "a property is of the whole system, not of an agent")
                    .label(span, "there is no `self` here")
                    .help("bind the agents that it is about: `forall c in Car: c.v >= 0`")
            }
        }
    }
}
