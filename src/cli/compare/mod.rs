//! `hyc compare`: the same model under several algorithms, beside a run at a tight tolerance.

mod processor;
pub mod measure;
mod sweep;
pub mod table;

use std::fs::File;
use std::io::Write;
use std::path::PathBuf;
use std::sync::atomic::Ordering;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

use super::algorithm::{algorithm, limits_of};
use super::arguments::CompareArguments;
use super::input::{Loaded, load, reason};
use super::refusal::{refuse_endless, refuse_unpublished};
use super::run::{INTERRUPTED, compile, listen};
use super::terminal::{say, say_aside, tell};
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

/// Runs, compares, prints: rows as they come, and a table of all settings that were completed.
pub(super) fn compare(arguments: &CompareArguments) -> Result<Exit, Refused> {
    let parameters: Vec<_> =
        arguments.params.iter().map(|(name, value)| swept(name, value)).collect::<Result<_, _>>()?;
    let cells = cells(&parameters, arguments.seeds);
    let n_runs = cells.len() * (1 + arguments.tolerance.len().max(1) * arguments.algorithms.len());
    let bar = progress_bar(n_runs as u64);
    let names: Vec<&str> = arguments.algorithms.iter().map(|algorithm| algorithm.name()).collect();
    let mut rows = Rows { path: arguments.csv.clone(), file: None };
    let mut entries = Vec::new();
    let mut exit = Exit::Fine;
    listen()?;
    for (number, cell) in cells.iter().enumerate() {
        bar.set_message(message(cell));
        let n_before = entries.len();
        let mut keep = |entry: Entry| {
            rows.write(&entry, &names)?;
            entries.push(entry);
            Ok(())
        };
        exit = run_cell(arguments, cell, &bar, &mut keep)?;
        if exit != Exit::Fine {
            entries.truncate(n_before);
            let done = format!("{number} of {} settings are complete\n", cells.len());
            bar.suspend(|| say_aside(&done));
            break;
        }
    }
    bar.finish_and_clear();
    if !entries.is_empty() {
        say(&table::table(&entries, &names))?;
    }
    Ok(exit)
}

/// The file with a row for each run; made when the first one comes.
struct Rows {
    path: Option<PathBuf>,
    file: Option<File>,
}

impl Rows {
    fn write(&mut self, entry: &Entry, algorithms: &[&str]) -> Result<(), Refused> {
        let Some(path) = &self.path else { return Ok(()) };
        let mut text = table::row(entry, algorithms);
        let mut append = || {
            if self.file.is_none() {
                self.file = Some(File::create(path)?);
                text.insert_str(0, table::COLUMNS);
            }
            self.file.as_mut().map_or(Ok(()), |file| file.write_all(text.as_bytes()))
        };
        append().map_err(|error| format!("cannot write `{}`: {}", path.display(), reason(&error)))
    }
}

/// All runs of one setting; anything but `Fine` ends the comparison.
fn run_cell(
    arguments: &CompareArguments,
    cell: &Cell,
    bar: &ProgressBar,
    keep: &mut dyn FnMut(Entry) -> Result<(), Refused>,
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
    let limits = limits_of(&model, &arguments.limits, Some(1))?.run;
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
        refuse_unpublished(algorithm, &program)?;
    }
    program.run.records.clear();
    program.run.absolute = None;
    let tolerances = match arguments.tolerance.as_slice() {
        [] => vec![program.run.tolerance],
        given => given.to_vec(),
    };
    let seed = program.run.seed;
    let runs = |program: &mut Program, algorithm: Algorithm, tolerance: f64| {
        let measured = measure(program, algorithm, tolerance, &limits, &INTERRUPTED, true);
        bar.inc(1);
        measured.map_err(|diagnostic| tell(&sources, std::slice::from_ref(&diagnostic)))
    };
    let Ok(tight) = runs(&mut program, Algorithm::Masim(Form::Plain), TIGHT) else {
        return Ok(Exit::RunError);
    };
    let is_interrupted = || INTERRUPTED.load(Ordering::SeqCst);
    for &tolerance in &tolerances {
        for (number, &algorithm) in algorithms.iter().enumerate() {
            // What is interrupted is no measurement.
            if is_interrupted() {
                return Ok(Exit::Interrupted);
            }
            let Ok(measured) = runs(&mut program, algorithm, tolerance) else { return Ok(Exit::RunError) };
            if is_interrupted() {
                return Ok(Exit::Interrupted);
            }
            keep(Entry {
                label: cell.label.clone(),
                seed,
                tolerance,
                algorithm: number,
                agreed: agreement(&measured.events, &tight.events, WITHIN),
                expected: tight.events.len(),
                measured,
            })?;
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
