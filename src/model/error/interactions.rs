//! Failures of interactions: how many take part, and what only an agent does.

use crate::base::{Diagnostic, Span};

/// What an interaction cannot be.
pub(in crate::model) enum InteractionError {
    /// Not between two.
    Participants { count: usize, span: Span },
    /// It listens.
    Hears { span: Span },
}

impl From<InteractionError> for Diagnostic {
    fn from(error: InteractionError) -> Self {
        match error {
            InteractionError::Participants { count, span } => {
                let (label, help) = match count {
                    0 => ("none is named", "name two: `interaction Bump(a: Car, b: Car)`"),
                    1 => ("one is named", "what an agent does alone is a transition of its own type"),
                    _ => (
                        "more than two are named",
                        "bind the others by quantifiers in the guard, or write an interaction for each pair",
                    ),
                };
                Diagnostic::error("HY0206", format!("an interaction has two participants, not {count}"))
                    .label(span, label)
                    .help(help)
            }
            InteractionError::Hears { span } => {
                Diagnostic::error("HY0218", "an interaction hears no events: `on` belongs to an agent")
                    .label(span, "a message is for one agent, and this has two")
                    .help(
                        "let the agent hear it and write a `discrete`, which the interaction's `when` reads",
                    )
            }
        }
    }
}
