//! `hyc run`: a model through every floor, then what became of it.

use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use super::algorithm::{integrator, single};
use super::arguments::{AssertLevel, BackendName, RunArguments, SettingArguments};
use super::input::{Loaded, load, name_of};
use super::limits::Limits;
use super::progress::ProgressLine;
use super::refusal::{refuse_aggregates, refuse_endless, refuse_engine};
use super::sinks::{Sinks, prepare_folder};
use super::terminal::{complain, say, say_aside, tell};
use super::warnings::Levels;
use super::{Exit, Refused, claims};
use crate::base::{Diagnostic, SourceMap};
use crate::calculus;
use crate::codegen::program::Program;
use crate::codegen::{self, Backend};
use crate::model::{Model, Settings};
use crate::output::{Cast, Report, Sink, Tables, TypeColumns, statistics, summary};
use crate::runtime::observe::{End, Outcome};
use crate::runtime::{self, Algorithm};

/// Set by the user's interruption.
static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// Compiles, simulates, writes.
pub(super) fn run(arguments: &RunArguments) -> Result<Exit, Refused> {
    refuse_engine(&arguments.engine)?;
    let algorithm = single(&arguments.engine, arguments.outputs.stats.is_some())?;
    let limits = Limits::new(&arguments.engine.limits)?;
    let levels = Levels::new(&arguments.allow, &[])?;
    let begun = Instant::now();
    let loaded = load(&arguments.model, &settings_of(arguments, &limits)?)?;
    tell(&loaded.sources, &loaded.diagnostics);
    let exit = loaded.exit();
    let Loaded { sources, mut warnings, model: Some(model), inputs, .. } = loaded else { return Ok(exit) };
    refuse_endless(&model)?;
    let program = match compile(&model, arguments.engine.backend, &mut warnings) {
        Ok(program) => program,
        Err(diagnostics) => {
            tell(&sources, &diagnostics);
            return Ok(Exit::ModelErrors);
        }
    };
    if !arguments.quiet {
        tell(&sources, &levels.settle(&sources, warnings));
    }
    refuse_aggregates(algorithm, &program)?;
    let compile_seconds = begun.elapsed().as_secs_f64();

    let cast = cast_of(&program);
    let mut sinks = Sinks::new(&inputs);
    let (mut tables, stats_sink) = open_outputs(arguments, &program, &cast, &sources, &mut sinks)?;
    let begun = Instant::now();
    let outcome = simulate(algorithm, &program, &limits.run, &mut tables, arguments.quiet)?;
    let run_seconds = begun.elapsed().as_secs_f64();
    let flushed = tables.flush();

    let report = Report {
        model: &name_of(&arguments.model),
        algorithm: algorithm.name(),
        engine: algorithm.form().name(),
        integrator: program.run.integrator.name(),
        backend: backend_name(arguments.engine.backend),
        threads: 1,
        tolerance: program.run.tolerance,
        absolute: program.run.absolute.unwrap_or(program.run.tolerance),
        seed: program.run.seed,
        until: program.run.until,
        sources: &sources,
        cast: &cast,
        outcome: &outcome,
        functions: program.cost.functions,
        instructions: program.cost.instructions,
        code_bytes: program.cost.code_bytes,
        compile_seconds,
        run_seconds,
        files: sinks.names(),
    };
    tell(&sources, &outcome.warnings);
    tell(&sources, &claims::diagnostics(&outcome.false_asserts, &cast));
    if let Some(sink) = stats_sink {
        write_whole(sink, &statistics(&report))?;
    }
    if !arguments.quiet {
        let summary = summary(&report);
        if sinks.on_stdout() { say_aside(&summary) } else { say(&summary)? }
    }
    let exit = conclude(&outcome, &sources, arguments.asserts);
    match flushed {
        Err(error) if !matches!(outcome.end, End::Output(_)) => Err(error.to_string()),
        Ok(()) | Err(_) => Ok(exit),
    }
}

/// What the command line lays over the model.
fn settings_of(arguments: &RunArguments, limits: &Limits) -> Result<Settings, Refused> {
    let SettingArguments { params, until, tolerance, absolute, seed } = arguments.settings.clone();
    let integrator = integrator(arguments.engine.algorithm, arguments.engine.integrator)?;
    let record_all = arguments.outputs.record.is_some();
    let limits = limits.model;
    Ok(Settings { params, until, tolerance, absolute, seed, integrator, record_all, limits })
}

/// The lower floors, one after the other; adds to the warnings about the model.
pub(super) fn compile(
    model: &Model,
    backend: BackendName,
    warnings: &mut Vec<Diagnostic>,
) -> Result<Program, Vec<Diagnostic>> {
    let system = calculus::derive(model)?;
    warnings.extend(calculus::lint(&system));
    let backend = match backend {
        BackendName::Jit => Backend::Jit,
        BackendName::Interp => Backend::Interpreter,
    };
    codegen::compile(system, backend).map_err(|diagnostic| vec![diagnostic])
}

/// Opens every file that the run will write: those of `run { }` in the folder, those of the command line where it says.
fn open_outputs<'a>(
    arguments: &RunArguments,
    program: &Program,
    cast: &'a Cast,
    sources: &'a SourceMap,
    sinks: &mut Sinks,
) -> Result<(Tables<'a>, Option<Sink>), Refused> {
    let wanted = &arguments.outputs;
    let folder = prepare_folder(wanted.folder.as_deref())?;
    let mut tables = Tables::new(cast);
    let events = wanted.events.clone().or_else(|| program.run.events.as_ref().map(|file| folder.join(file)));
    if let Some(path) = events {
        tables.event_log(sinks.open(&path)?).map_err(|error| error.to_string())?;
    }
    let n_records = program.run.records.len();
    if wanted.record.is_some() && n_records > 1 {
        return Err(format!(
            "run {{ }} has {n_records} records with files of their own: leave `--record` out"
        ));
    }
    for record in &program.run.records {
        let path = match (&wanted.record, &record.file) {
            (Some(path), _) => path.clone(),
            (None, Some(file)) => folder.join(file),
            (None, None) => return Err("a `record` of the model names no file: add `--record FILE`".into()),
        };
        tables.trajectory(sinks.open(&path)?, &record.columns).map_err(|error| error.to_string())?;
    }
    if let Some(path) = &wanted.final_states {
        tables.final_states(sinks.open(path)?).map_err(|error| error.to_string())?;
    }
    if let Some(path) = &wanted.explain_events {
        tables.explanations(sinks.open(path)?, sources);
    }
    let stats = wanted.stats.as_deref().map(|path: &Path| sinks.open(path)).transpose()?;
    Ok((tables, stats))
}

/// Runs until its end or the user's interruption; a second interruption ends the process at once.
fn simulate(
    algorithm: Algorithm,
    program: &Program,
    limits: &runtime::Limits,
    tables: &mut Tables<'_>,
    quiet: bool,
) -> Result<Outcome, Refused> {
    let on_interrupt = || {
        if INTERRUPTED.swap(true, Ordering::SeqCst) {
            std::process::exit(Exit::Interrupted as i32);
        }
    };
    ctrlc::set_handler(on_interrupt).map_err(|error| format!("cannot listen for interruptions: {error}"))?;
    let line = std::rc::Rc::new(std::cell::RefCell::new(ProgressLine::new()));
    if !quiet {
        let line = line.clone();
        tables.on_progress(move |progress| line.borrow_mut().show(progress));
    }
    let outcome = runtime::simulate_by(algorithm, program, limits, &INTERRUPTED, tables);
    line.borrow_mut().clear();
    Ok(outcome)
}

/// Says how the run ended, if not well, and with which exit code the process ends.
fn conclude(outcome: &Outcome, sources: &SourceMap, asserts: AssertLevel) -> Exit {
    match &outcome.end {
        End::Error(diagnostic) => {
            tell(sources, std::slice::from_ref(diagnostic));
            Exit::RunError
        }
        End::Output(error) => {
            complain(&error.to_string());
            Exit::Usage
        }
        End::Interrupted => Exit::Interrupted,
        End::Until | End::Stop { .. } => {
            let claims_count = asserts == AssertLevel::Error && !outcome.false_asserts.is_empty();
            if claims_count { Exit::FalseClaim } else { Exit::Fine }
        }
    }
}

/// The names of the program's agents and columns.
fn cast_of(program: &Program) -> Cast {
    let mut agents = vec![String::new(); program.population.agents.len()];
    for block in &program.population.blocks {
        for k in 0..block.count {
            agents[block.first + k] =
                if block.array { format!("{}[{k}]", block.name) } else { block.name.clone() };
        }
    }
    let types = program.types.iter().map(|ty| TypeColumns {
        name: ty.name.clone(),
        states: ty.states.iter().map(|column| column.name.clone()).collect(),
        discretes: ty.discretes.iter().map(|column| column.name.clone()).collect(),
    });
    Cast { agents, types: types.collect() }
}

fn backend_name(backend: BackendName) -> &'static str {
    match backend {
        BackendName::Jit => "jit",
        BackendName::Interp => "interp",
    }
}

fn write_whole(mut sink: Sink, text: &str) -> Result<(), Refused> {
    sink.writer
        .write_all(text.as_bytes())
        .and_then(|()| sink.writer.flush())
        .map_err(|error| format!("cannot write `{}`: {error}", sink.name))
}
