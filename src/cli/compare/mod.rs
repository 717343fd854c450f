//! `hyc compare`: the same model under several algorithms, beside a run at a tight tolerance.

mod processor;
pub mod measure;
mod sweep;
pub mod table;

use std::path::Path;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

use super::algorithm::{algorithm, limits_of};
use super::arguments::CompareArguments;
use super::input::{Loaded, load};
use super::refusal::{refuse_aggregates, refuse_endless};
use super::run::compile;
use super::terminal::{say, tell};
use super::{Exit, Refused};
use crate::codegen::program::Program;
use crate::model::Settings;
use crate::model::machinery::Named as _;
use crate::runtime::paper::{Algorithm, Form};
use measure::{agreement, measure};
use sweep::{Cell, cells, swept};
use table::Entry;

/// The tolerance of the run that all others are compared with.
pub const TIGHT: f64 = 1e-12;

/// Times of events that differ by no more are those of one event, s.
pub const WITHIN: f64 = 1e-3;

/// Runs, compares, prints.
pub(super) fn compare(arguments: &CompareArguments) -> Result<Exit, Refused> {
    let parameters: Vec<_> =
        arguments.params.iter().map(|(name, value)| swept(name, value)).collect::<Result<_, _>>()?;
    let cells = cells(&parameters, arguments.seeds);
    let n_runs = cells.len() * (1 + arguments.tolerance.len().max(1) * arguments.algorithms.len());
    let bar = progress_bar(n_runs as u64);
    let mut entries = Vec::new();
    for cell in &cells {
        bar.set_message(message(cell));
        let exit = run_cell(arguments, cell, &bar, &mut entries)?;
        if exit != Exit::Fine {
            return Ok(exit);
        }
    }
    bar.finish_and_clear();
    let names: Vec<&str> = arguments.algorithms.iter().map(|algorithm| algorithm.name()).collect();
    if let Some(path) = &arguments.csv {
        write(path, &table::csv(&entries, &names))?;
    }
    say(&table::table(&entries, &names))?;
    Ok(Exit::Fine)
}

/// All runs of one setting; anything but `Fine` ends the comparison.
fn run_cell(
    arguments: &CompareArguments,
    cell: &Cell,
    bar: &ProgressBar,
    entries: &mut Vec<Entry>,
) -> Result<Exit, Refused> {
    let settings = Settings {
        params: cell.params.clone(),
        until: arguments.until,
        seed: cell.seed,
        limits: super::limits::Limits::new(&arguments.limits)?.model,
        ..Settings::default()
    };
    let Loaded { sources, diagnostics, model, .. } = match load(&arguments.model, &settings)? {
        loaded if loaded.model.is_none() => {
            tell(&loaded.sources, &loaded.diagnostics);
            return Ok(loaded.exit());
        }
        loaded => loaded,
    };
    tell(&sources, &diagnostics);
    let Some(model) = model else { return Ok(Exit::ModelErrors) };
    refuse_endless(&model)?;
    let limits = limits_of(&model, &arguments.limits)?.run;
    let machinery = &model.run.machinery;
    let algorithms: Vec<Algorithm> = (arguments.algorithms.iter())
        .map(|&name| algorithm(name, Form::Plain, &arguments.paper, machinery, true))
        .collect::<Result<_, _>>()?;
    let backend = arguments.backend.or(machinery.backend).unwrap_or_default();
    let mut program = match compile(&model, backend, &mut Vec::new()) {
        Ok(program) => program,
        Err(diagnostics) => {
            tell(&sources, &diagnostics);
            return Ok(Exit::ModelErrors);
        }
    };
    for &algorithm in &algorithms {
        refuse_aggregates(algorithm, &program)?;
    }
    program.run.records.clear();
    program.run.absolute = None;
    let tolerances = match arguments.tolerance.as_slice() {
        [] => vec![program.run.tolerance],
        given => given.to_vec(),
    };
    let seed = program.run.seed;
    let runs = |program: &mut Program, algorithm: Algorithm, tolerance: f64| {
        let measured = measure(program, algorithm, tolerance, &limits, true);
        bar.inc(1);
        measured.map_err(|diagnostic| tell(&sources, std::slice::from_ref(&diagnostic)))
    };
    let Ok(tight) = runs(&mut program, Algorithm::Masim(Form::Plain), TIGHT) else {
        return Ok(Exit::RunError);
    };
    for &tolerance in &tolerances {
        for (number, &algorithm) in algorithms.iter().enumerate() {
            let Ok(measured) = runs(&mut program, algorithm, tolerance) else { return Ok(Exit::RunError) };
            entries.push(Entry {
                label: cell.label.clone(),
                seed,
                tolerance,
                algorithm: number,
                agreed: agreement(&measured.events, &tight.events, WITHIN),
                expected: tight.events.len(),
                measured,
            });
        }
    }
    Ok(Exit::Fine)
}

/// On standard error, where a person watches.
fn progress_bar(n: u64) -> ProgressBar {
    let bar = ProgressBar::new(n);
    if let Ok(style) = ProgressStyle::with_template("{bar:30} {pos}/{len} runs, {eta} left {msg}") {
        bar.set_style(style);
    }
    bar.enable_steady_tick(Duration::from_millis(200));
    bar
}

fn message(cell: &Cell) -> String {
    match cell.seed {
        Some(seed) => format!("{} seed={seed}", cell.label),
        None => cell.label.clone(),
    }
}

fn write(path: &Path, text: &str) -> Result<(), Refused> {
    std::fs::write(path, text).map_err(|error| format!("cannot write `{}`: {error}", path.display()))
}
