//! Failures of events: who has them, who emits and who hears them.

use super::with_similar;
use crate::base::{Diagnostic, Span};

/// What is wrong with an `emit` or an `on`.
pub(in crate::model) enum EventError {
    /// Nobody has an event of this name: the type of the sender, or any.
    Unknown { name: String, owner: Option<String>, span: Span, similar: Option<String> },
    /// Events of one name that carry different things, and no word of which is meant.
    Differ { name: String, span: Span, declared: [(String, Span); 2] },
    /// In an interaction, an event without its sender.
    WhoEmits { name: String, span: Span, participants: Option<[String; 2]> },
    /// An agent emits for another one.
    EmitsForOther { place: String, span: Span },
    /// `on` binds more or fewer values than the event carries.
    Bound { name: String, found: usize, carried: usize, span: Span, declared: Span },
}

impl From<EventError> for Diagnostic {
    fn from(error: EventError) -> Self {
        match error {
            EventError::Unknown { name, owner, span, similar } => {
                let title = match &owner {
                    Some(owner) => format!("agent type `{owner}` has no event `{name}`"),
                    None => format!("no agent type has an event `{name}`"),
                };
                let diagnostic = Diagnostic::error("HY0236", title).label(span, "no such event");
                match similar {
                    Some(_) => with_similar(diagnostic, &similar),
                    None => diagnostic.help(format!("declare it in the agent that emits it: `event {name}`")),
                }
            }
            EventError::Differ { name, span, declared: [(a, first), (b, second)] } => {
                let title = format!("`{a}` and `{b}` both have an event `{name}`, with different values");
                Diagnostic::error("HY0237", title)
                    .label(span, "which of them?")
                    .label(first, format!("that of `{a}`"))
                    .label(second, format!("that of `{b}`"))
                    .help(format!("say whose, `on {name} from ...`, or call one of them otherwise"))
            }
            EventError::WhoEmits { name, span, participants } => {
                let help = match participants {
                    Some([a, b]) => format!("write `emit {a}.{name}` or `emit {b}.{name}`"),
                    None => format!("write who emits `{name}`, before a dot"),
                };
                Diagnostic::error(
                    "HY0238",
                    format!("who emits `{name}`? An interaction has two participants"),
                )
                .label(span, "neither")
                .help(help)
            }
            EventError::EmitsForOther { place, span } => {
                Diagnostic::error("HY0239", format!("an agent emits only its own events, not `{place}`"))
                    .label(span, "belongs to another agent")
                    .help("only an `interaction` may let the agents that take part in it emit")
            }
            EventError::Bound { name, found, carried, span, declared } => {
                let values = |n: usize| if n == 1 { "1 value".to_string() } else { format!("{n} values") };
                Diagnostic::error(
                    "HY0259",
                    format!("event `{name}` carries {}, and `on` binds {found}", values(carried)),
                )
                .label(span, format!("{} bound here", values(found)))
                .label(declared, "declared here")
                .help(format!("bind all of them, or none: `on {name}`"))
            }
        }
    }
}
