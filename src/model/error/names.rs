//! Failures of names: unknown, taken, circular, or out of place.

use super::{advised, with_similar_or};
use crate::base::{Diagnostic, Span};
use crate::model::foreign;

/// A name that cannot be used as it is.
pub(in crate::model) enum NameError {
    /// Nothing visible has this name.
    Unknown { what: &'static str, name: String, span: Span, similar: Option<String> },
    /// No such type.
    UnknownType { name: String, span: Span, similar: Option<String> },
    /// An agent type has no such member.
    NoMember { name: String, agent: String, span: Span, similar: Option<String>, mode: Option<String> },
    /// An agent type has no such mode.
    UnknownMode { name: String, inside: String, span: Span, similar: Option<String> },
    /// Declared twice in one scope.
    Taken { name: String, span: Span, first: Span },
    /// Definitions that need each other.
    Circle { names: Vec<(String, Span)>, what: &'static str },
    /// Functions that call each other.
    Recursion { names: Vec<(String, Span)> },
    /// A name that stands for something without a value.
    NotAValue { name: String, what: &'static str, span: Span, help: String },
    /// Something that cannot be called.
    NotAFunction { title: String, span: Span },
    /// Nothing that can be called has this name.
    UnknownFunction { name: String, span: Span, similar: Option<String> },
    /// A parameter without a default behind one that has one.
    DefaultsLast { name: String, span: Span },
    /// A name that has no meaning in this place.
    NotHere { name: String, span: Span, why: &'static str, help: &'static str },
    /// Only one of these may be in a file.
    Second { what: &'static str, span: Span, first: Span },
}

impl From<NameError> for Diagnostic {
    fn from(error: NameError) -> Self {
        match error {
            NameError::Unknown { what, name, span, similar } => {
                let unknown = Diagnostic::error("HY0201", format!("there is no {what} `{name}`"))
                    .label(span, "not known here");
                let otherwise = format!(
                    "declare `{name}`, or look where it is declared: what stands in an agent is known there only"
                );
                advised(unknown.help(otherwise), &name, foreign::value(&name), &similar)
            }
            NameError::UnknownType { name, span, similar } => {
                let unknown = Diagnostic::error("HY0202", format!("there is no type `{name}`"))
                    .label(span, "neither `real`, `int`, `bool` nor an agent type");
                let otherwise = format!("declare `agent {name} {{ }}`, or import the file that does");
                advised(unknown.help(otherwise), &name, foreign::ty(&name), &similar)
            }
            NameError::NoMember { name, agent, span, similar, mode } => {
                let title = format!("agent `{agent}` has no `{name}`");
                let missing = Diagnostic::error("HY0203", title).label(span, "not declared there");
                match mode {
                    Some(mode) => missing.help(format!(
                        "`{name}` is declared inside mode `{mode}`; declare it outside the modes to read it here"
                    )),
                    None => {
                        with_similar_or(missing, &similar, format!("declare `{name}` in `agent {agent}`"))
                    }
                }
            }
            NameError::UnknownMode { name, inside, span, similar } => with_similar_or(
                Diagnostic::error("HY0204", format!("{inside} has no mode `{name}`"))
                    .label(span, "no such mode"),
                &similar,
                format!("declare `mode {name} {{ }}` there"),
            ),
            NameError::Taken { name, span, first } => {
                Diagnostic::error("HY0205", format!("`{name}` is declared twice"))
                    .label(span, "declared again here")
                    .label(first, "first declared here")
                    .help("give one of them another name")
            }
            NameError::Circle { names, what } => {
                circle("HY0207", what, &names).help("one of them must be defined without the others")
            }
            NameError::Recursion { names } => {
                circle("HY0208", "functions call each other in a circle", &names)
                    .help("functions cannot be recursive; write what is repeated as a formula")
            }
            NameError::NotAValue { name, what, span, help } => {
                Diagnostic::error("HY0209", format!("`{name}` is {what}, not a value"))
                    .label(span, what)
                    .help(help)
            }
            NameError::NotAFunction { title, span } => {
                Diagnostic::error("HY0212", title).label(span, "called here")
            }
            NameError::UnknownFunction { name, span, similar } => {
                let title = format!("there is no function `{name}`");
                let unknown = Diagnostic::error("HY0212", title).label(span, "called here");
                advised(unknown, &name, foreign::function(&name), &similar)
            }
            NameError::DefaultsLast { name, span } => {
                Diagnostic::error("HY0213", format!("`{name}` has no default, but the one before it has"))
                    .label(span, "could never be left out")
                    .help("put the parameters that have a default last")
            }
            NameError::NotHere { name, span, why, help } => {
                Diagnostic::error("HY0210", format!("`{name}` {why}"))
                    .label(span, "cannot be used here")
                    .help(help)
            }
            NameError::Second { what, span, first } => {
                Diagnostic::error("HY0211", format!("there are two `{what}` blocks"))
                    .label(span, "the second one")
                    .label(first, "the first one")
                    .help("write all of it in one block")
            }
        }
    }
}

/// A circle of names, from the one that is declared first; the labels are the places of the declarations.
fn circle(code: &'static str, title: &str, names: &[(String, Span)]) -> Diagnostic {
    let first = (0..names.len()).min_by_key(|&k| names[k].1).unwrap_or(0);
    let names = [&names[first..], &names[..first]].concat();
    let path = names.iter().chain(names.first()).map(|(name, _)| name.as_str()).collect::<Vec<_>>();
    let diagnostic = Diagnostic::error(code, format!("{title}: {}", path.join(" -> ")));
    names.iter().enumerate().fold(diagnostic, |diagnostic, (k, (name, span))| {
        let (next, _) = &names[(k + 1) % names.len()];
        diagnostic.label(*span, format!("`{name}` needs `{next}`"))
    })
}
