//! `hyc check`: what is wrong with models, for people or for programs.

use std::path::Path;

use serde_json::{Value, json};

use super::arguments::{CheckArguments, Format};
use super::input::{load, name_of, settings_with};
use super::refusal::refuse_check;
use super::terminal::{complain, say, tell};
use super::{Exit, Refused};
use crate::base::{Diagnostic, SourceMap, Span};
use crate::calculus;
use crate::calculus::system::System;
use crate::model::Settings;

/// Checks each model; the worst of them decides the exit code.
pub(super) fn check(arguments: &CheckArguments) -> Result<Exit, Refused> {
    refuse_check(arguments)?;
    let settings = settings_with(&arguments.params);
    let mut worst = Exit::Fine;
    let mut found = Vec::new();
    for path in &arguments.models {
        match check_one(path, &settings) {
            Ok(checked) => {
                worst = worst.max(checked.exit);
                match arguments.format {
                    Format::Text | Format::Sarif => tell_checked(path, &checked)?,
                    Format::Json => found.push(model_json(path, &checked)),
                }
            }
            Err(refused) => {
                complain(&refused);
                worst = Exit::Usage;
            }
        }
    }
    if arguments.format == Format::Json {
        let text = serde_json::to_string_pretty(&json!({ "models": found })).expect("every key is a string");
        say(&(text + "\n"))?;
    }
    Ok(worst)
}

/// What is known about a model after all the floors that can refuse it.
struct CheckedModel {
    sources: SourceMap,
    diagnostics: Vec<Diagnostic>,
    system: Option<System>,
    exit: Exit,
}

fn check_one(path: &Path, settings: &Settings) -> Result<CheckedModel, Refused> {
    let mut loaded = load(path, settings)?;
    let system = match loaded.model.as_ref().map(calculus::derive) {
        Some(Ok(system)) => Some(system),
        Some(Err(diagnostics)) => {
            loaded.diagnostics.extend(diagnostics);
            None
        }
        None => None,
    };
    let exit = if system.is_some() { Exit::Fine } else { loaded.exit() };
    let (sources, diagnostics) = (loaded.sources, loaded.diagnostics);
    Ok(CheckedModel { sources, diagnostics, system, exit })
}

/// Diagnostics on standard error, one line for each sound model on standard output.
fn tell_checked(path: &Path, checked: &CheckedModel) -> Result<(), Refused> {
    tell(&checked.sources, &checked.diagnostics);
    let Some(system) = &checked.system else { return Ok(()) };
    let mut text = format!("{}: no errors\n", name_of(path));
    for (label, symmetric) in interactions(system) {
        let pairs = if symmetric {
            "one flag for each unordered pair (the same when the two change places)"
        } else {
            "one flag for each ordered pair"
        };
        text.push_str(&format!("  {label}: {pairs}\n"));
    }
    say(&text)
}

/// Each transition of an interaction, and whether it is symmetric (rule 5).
fn interactions(system: &System) -> impl Iterator<Item = (&str, bool)> {
    let transitions = system.interactions.iter().flat_map(|interaction| &interaction.transitions);
    transitions.map(|pair| (pair.transition.label.as_str(), pair.symmetric))
}

fn model_json(path: &Path, checked: &CheckedModel) -> Value {
    let sources = &checked.sources;
    let diagnostics = checked.diagnostics.iter().map(|diagnostic| diagnostic_json(sources, diagnostic));
    let pairs = checked.system.iter().flat_map(interactions);
    json!({
        "model": name_of(path),
        "ok": checked.system.is_some(),
        "diagnostics": diagnostics.collect::<Vec<_>>(),
        "interactions": pairs
            .map(|(label, symmetric)| json!({ "transition": label, "unordered": symmetric }))
            .collect::<Vec<_>>(),
    })
}

fn diagnostic_json(sources: &SourceMap, diagnostic: &Diagnostic) -> Value {
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

/// Lines and columns count from 1, columns in characters; the end is one past the last character.
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
