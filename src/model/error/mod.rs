//! What can be wrong with a model: a variant per failure, each with its own code, and how each is told.

pub(super) mod names;
pub(super) mod types;
pub(super) mod dimensions;
pub(super) mod modes;
pub(super) mod events;
pub(super) mod interactions;
pub(super) mod data;
pub(super) mod imports;
pub(super) mod lists;
pub(super) mod properties;

pub(super) use data::{FileError, LimitError, OverrideError, RunError, SystemError, TableError, ValueError};
pub(super) use dimensions::{DimensionError, Evidence, Side};
pub(super) use events::EventError;
pub(super) use imports::ImportError;
pub(super) use interactions::InteractionError;
pub(super) use lists::ListError;
pub(super) use modes::{ActionError, ModeError};
pub(super) use names::NameError;
pub(super) use properties::PropertyError;
pub(super) use types::TypeError;

use crate::base::Diagnostic;

/// The same; where nothing is like it, what else to do.
fn with_similar_or(diagnostic: Diagnostic, similar: &Option<String>, help: impl Into<String>) -> Diagnostic {
    if similar.is_some() { with_similar(diagnostic, similar) } else { diagnostic.help(help) }
}

/// What to write for the name of something in another language, unless what is meant differs from it in capitals only; else the name
/// that is like it, if one is.
fn advised(
    diagnostic: Diagnostic,
    name: &str,
    foreign: Option<&'static str>,
    similar: &Option<String>,
) -> Diagnostic {
    let is_same = similar.as_ref().is_some_and(|similar| similar.eq_ignore_ascii_case(name));
    match foreign {
        Some(help) if !is_same => diagnostic.help(help),
        Some(_) | None => with_similar(diagnostic, similar),
    }
}

/// "did you mean", as a help.
fn with_similar(diagnostic: Diagnostic, similar: &Option<String>) -> Diagnostic {
    match similar {
        Some(similar) => diagnostic.help(format!("did you mean `{similar}`?")),
        None => diagnostic,
    }
}
