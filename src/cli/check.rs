//! `hyc check`: what is wrong with models, for people or for programs.

use std::path::Path;

use serde_json::{Value, json};

use super::arguments::{CheckArguments, Format};
use super::input::{free, load, name_of, settings_with};
use super::terminal::{complain, say, say_aside, tell};
use super::warnings::{Levels, count};
use super::{Exit, Refused, sarif};
use crate::base::{Diagnostic, SourceMap};
use crate::calculus;
use crate::calculus::system::System;
use crate::model::Settings;
use crate::output::diagnostic_json;

/// Checks each model; the worst of them decides the exit code.
pub(super) fn check(arguments: &CheckArguments) -> Result<Exit, Refused> {
    let settings = settings_with(&arguments.params, &arguments.limits)?;
    let levels = Levels::new(&arguments.allow, &arguments.deny)?;
    let mut worst = Exit::Fine;
    let mut found = Vec::new();
    for path in &arguments.models {
        match check_one(path, &settings, &levels) {
            Ok(checked) => {
                worst = worst.max(checked.exit);
                if arguments.format == Format::Text {
                    tell_checked(path, &checked)?;
                    free(checked.system, &checked.sources);
                } else {
                    found.push((path, checked));
                }
            }
            Err(refused) => {
                complain(&refused);
                worst = Exit::Usage;
            }
        }
    }
    let log = match arguments.format {
        Format::Text => return Ok(worst),
        Format::Json => {
            let models = found.iter().map(|(path, checked)| model_json(path, checked));
            json!({ "models": models.collect::<Vec<_>>() })
        }
        Format::Sarif => {
            sarif::log(found.iter().map(|(_, checked)| (&checked.sources, checked.diagnostics.as_slice())))
        }
    };
    say(&(serde_json::to_string_pretty(&log).expect("every key is a string") + "\n"))?;
    Ok(worst)
}

/// What is known about a model after all the floors that can refuse it.
struct CheckedModel {
    sources: SourceMap,
    diagnostics: Vec<Diagnostic>,
    system: Option<System>,
    exit: Exit,
}

fn check_one(path: &Path, settings: &Settings, levels: &Levels) -> Result<CheckedModel, Refused> {
    let mut loaded = load(path, settings)?;
    let mut exit = loaded.exit();
    let model = loaded.model.take();
    let derived = model.as_ref().map(calculus::derive);
    free(model, &loaded.sources);
    let system = match derived {
        Some(Ok(system)) => {
            loaded.warnings.extend(calculus::lint(&system));
            Some(system)
        }
        Some(Err(diagnostics)) => {
            loaded.diagnostics.extend(diagnostics);
            None
        }
        None => None,
    };
    let mut found = loaded.diagnostics;
    found.extend(loaded.warnings);
    let diagnostics = levels.settle(&loaded.sources, found);
    if system.is_some() {
        let denied = diagnostics.iter().any(Diagnostic::is_error);
        exit = if denied { Exit::ModelErrors } else { Exit::Fine };
    }
    Ok(CheckedModel { sources: loaded.sources, diagnostics, system, exit })
}

/// Diagnostics and their number on standard error, one line for each model without errors on standard output.
fn tell_checked(path: &Path, checked: &CheckedModel) -> Result<(), Refused> {
    tell(&checked.sources, &checked.diagnostics);
    let name = name_of(path);
    let count = count(&checked.diagnostics);
    let Some(system) = checked.system.as_ref().filter(|_| checked.exit == Exit::Fine) else {
        say_aside(&format!("{name}: {}\n", count.unwrap_or_default()));
        return Ok(());
    };
    let mut text = match count {
        Some(count) => format!("{name}: no errors, {count}\n"),
        None => format!("{name}: no errors\n"),
    };
    for (label, symmetric) in interactions(system) {
        let pairs = if symmetric {
            "one flag for each unordered pair (the same when the two change places)"
        } else {
            "one flag for each ordered pair"
        };
        text.push_str(&format!("  {label}: {pairs}\n"));
    }
    for (reader, set, count) in sets(system) {
        text.push_str(&format!(
            "  {reader}: its flow reads all {count} agents of {set}; who read each other step together\n"
        ));
    }
    say(&text)
}

/// Each transition of an interaction, and whether it is symmetric (rule 5).
fn interactions(system: &System) -> impl Iterator<Item = (&str, bool)> {
    let transitions = system.interactions.iter().flat_map(|interaction| &interaction.transitions);
    transitions.map(|pair| (pair.transition.label.as_str(), pair.symmetric))
}

/// Each type whose flow reads a set, what that is a set of, and its size (rule 13).
fn sets(system: &System) -> impl Iterator<Item = (&str, &str, usize)> {
    system.types.iter().flat_map(|ty| {
        ty.sets.iter().map(|set| (ty.name.as_str(), system.types[set.ty].name.as_str(), set.count))
    })
}

fn model_json(path: &Path, checked: &CheckedModel) -> Value {
    let sources = &checked.sources;
    let diagnostics = checked.diagnostics.iter().map(|diagnostic| diagnostic_json(sources, diagnostic));
    let pairs = checked.system.iter().flat_map(interactions);
    json!({
        "model": name_of(path),
        "ok": checked.exit == Exit::Fine,
        "diagnostics": diagnostics.collect::<Vec<_>>(),
        "interactions": pairs
            .map(|(label, symmetric)| json!({ "transition": label, "unordered": symmetric }))
            .collect::<Vec<_>>(),
        "sets": checked.system.iter().flat_map(sets)
            .map(|(reader, set, count)| json!({ "reader": reader, "set": set, "count": count }))
            .collect::<Vec<_>>(),
    })
}
