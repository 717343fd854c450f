//! `hyc run`: a model through every floor, then what became of it.

use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use super::algorithm::{Computed, limits_of, single};
use super::arguments::{AssertLevel, Outputs, RunArguments, SettingArguments};
use super::input::{Loaded, load, name_of};
use super::limits::Limits;
use super::progress::ProgressLine;
use super::refusal::{refuse_aggregates, refuse_endless, refuse_engine};
use super::sinks::{Sinks, prepare_folder};
use super::terminal::{complain, say, say_aside, tell};
use super::warnings::Levels;
use super::watch::watch;
use super::{Exit, Refused, claims};
use crate::base::{Diagnostic, SourceMap};
use crate::calculus;
use crate::codegen::program::{self, LetValue, Program, Record, VarRef};
use crate::codegen::{self, Backend};
use crate::model::ir::Integrator;
use crate::model::machinery::{BackendName, Named as _};
use crate::model::{self, Model, Settings};
use crate::output::{Cast, Column, Kind, Report, Sink, Tables, TypeColumns, statistics, summary};
use crate::picture::{Recording, Scene, page};
use crate::runtime::observe::{End, Outcome};
use crate::runtime::{self, Algorithm};

/// How many of the agents with most events are told.
const BUSIEST: usize = 8;

/// Set by the user's interruption.
static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// Compiles, simulates, writes.
pub(super) fn run(arguments: &RunArguments) -> Result<Exit, Refused> {
    refuse_engine(&arguments.engine)?;
    let limits = Limits::new(&arguments.engine.limits)?;
    let levels = Levels::new(&arguments.allow, &[])?;
    let begun = Instant::now();
    let record_all = if arguments.outputs.record.is_some() { RecordAll::Yes } else { RecordAll::No };
    let settings = settings_of(&arguments.settings, arguments.engine.integrator, record_all, &limits);
    let loaded = load(&arguments.model, &settings)?;
    tell(&loaded.sources, &loaded.diagnostics);
    let exit = loaded.exit();
    let Loaded { sources, mut warnings, model: Some(mut model), inputs, .. } = loaded else {
        return Ok(exit);
    };
    let limits = limits_of(&model, &arguments.engine.limits)?;
    let Computed { algorithm, backend } =
        single(&arguments.engine, &mut model, arguments.outputs.stats.is_some())?;
    refuse_endless(&model)?;
    let read_seconds = begun.elapsed().as_secs_f64();
    let mut program = match compile(&model, backend, &mut warnings) {
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
    let code_seconds = program.cost.seconds;
    let compile_parts = [
        ("reading", read_seconds),
        ("equations", compile_seconds - read_seconds - code_seconds),
        (code_of(backend), code_seconds),
    ];

    let cast = cast_of(&program);
    let mut sinks = Sinks::new(&inputs);
    let report_sink = arguments.outputs.report.as_deref().map(|path| sinks.open(path)).transpose()?;
    let (record, watched) = report_sink.as_ref().map(|_| watch(&model, &program)).transpose()?.unzip();
    let diagrams = model::diagrams(&model, &sources);
    let n_records = program.run.records.len();
    let mut recording = None;
    if watched.is_some() {
        recording = Some(Recording::new(&cast, &diagrams, n_records));
    }
    let (mut tables, stats_sink) = open_outputs(arguments, &program, &cast, &sources, &mut sinks)?;
    program.run.records.extend(record);
    if let Some(recording) = &mut recording {
        tables.also(recording);
    }
    let begun = Instant::now();
    let outcome = simulate(algorithm, &program, &limits.run, &mut tables, arguments.quiet)?;
    let run_seconds = begun.elapsed().as_secs_f64();
    let flushed = tables.finish();
    let (busiest, writing_seconds) = (tables.busiest(BUSIEST), tables.writing().as_secs_f64());
    drop(tables);

    let (functions, code_bytes) = program.machine_code();
    let report = Report {
        model: &name_of(&arguments.model),
        algorithm: algorithm.name(),
        engine: algorithm.form().name(),
        integrator: program.run.integrator.name(),
        backend: backend.name(),
        threads: 1,
        tolerance: program.run.tolerance,
        absolute: program.run.absolute.unwrap_or(program.run.tolerance),
        seed: program.run.seed,
        until: program.run.until,
        sources: &sources,
        cast: &cast,
        outcome: &outcome,
        functions,
        instructions: program.cost.instructions,
        code_bytes,
        busiest: &busiest,
        compile_parts: &compile_parts,
        writing_seconds,
        compile_seconds,
        run_seconds,
        files: sinks.names(),
    };
    tell(&sources, &outcome.warnings);
    tell(&sources, &claims::diagnostics(&outcome.false_asserts, &cast));
    tell(&sources, &claims::of_properties(&outcome.verdicts));
    if let Some(sink) = stats_sink {
        write_whole(sink, &statistics(&report))?;
    }
    let summary = summary(&report);
    if let (Some(sink), Some(watched), Some(mut recording)) = (report_sink, &watched, recording) {
        recording.close();
        let scene = Scene {
            title: &name_of(Path::new(arguments.model.file_name().unwrap_or_default())),
            source: sources.files().first().map_or("", |file| &file.text),
            diagrams: &diagrams,
            recording: &recording,
            columns: &watched.columns,
            plane: watched.plane,
            summary: &summary,
        };
        write_whole(sink, &page(&scene))?;
    }
    if !arguments.quiet {
        if sinks.on_stdout() { say_aside(&summary) } else { say(&summary)? }
    }
    let exit = conclude(&outcome, &sources, arguments.asserts);
    match flushed {
        Err(error) if !matches!(outcome.end, End::Output(_)) => Err(error.to_string()),
        Ok(()) | Err(_) => Ok(exit),
    }
}

/// What the command line lays over the model.
pub(super) fn settings_of(
    given: &SettingArguments,
    integrator: Option<Integrator>,
    record_all: RecordAll,
    limits: &Limits,
) -> Settings {
    let SettingArguments { params, until, tolerance, absolute, seed } = given.clone();
    let record_all = record_all == RecordAll::Yes;
    Settings { params, until, tolerance, absolute, seed, integrator, record_all, limits: limits.model }
}

/// Whether a model that records nothing records everything.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum RecordAll {
    Yes,
    No,
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
        BackendName::Auto => Backend::Auto,
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
    let named = wanted.named == Outputs::Written;
    let in_folder = |file: &String| folder.join(file);
    let events =
        wanted.events.clone().or_else(|| program.run.events.as_ref().filter(|_| named).map(in_folder));
    if let Some(path) = events {
        tables.event_log(sinks.open(&path)?).map_err(|error| error.to_string())?;
    }
    let n_records = program.run.records.len();
    if wanted.record.is_some() && n_records > 1 {
        return Err(format!(
            "run {{ }} has {n_records} records with files of their own: leave `--record` out"
        ));
    }
    for record in program.run.records.iter().filter(|_| named) {
        let path = match (&wanted.record, &record.file) {
            (Some(path), _) => path.clone(),
            (None, Some(file)) => folder.join(file),
            (None, None) => return Err("a `record` of the model names no file: add `--record FILE`".into()),
        };
        let columns = columns_of(program, record);
        tables.trajectory(sinks.open(&path)?, &columns).map_err(|error| error.to_string())?;
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
pub(super) fn simulate(
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
            let wrong =
                !outcome.false_asserts.is_empty() || outcome.verdicts.iter().any(|verdict| !verdict.holds);
            if wrong && asserts == AssertLevel::Error { Exit::FalseClaim } else { Exit::Fine }
        }
    }
}

/// The columns of a record: each has room for what the agents of any type have there.
fn columns_of(program: &Program, record: &Record) -> Vec<Column> {
    let kind = |k: usize| {
        let of_types = program.types.iter().zip(&record.variables);
        let kinds = of_types.filter_map(|(ty, variables)| {
            Some(match variables[k]? {
                VarRef::State(_) => Kind::Number,
                VarRef::Discrete(number) => kind_of(&ty.discretes[number]),
                VarRef::Param(number) => kind_of(&ty.params[number]),
                VarRef::Link(_) => Kind::Text,
                VarRef::Let(number) => match ty.lets[number].value {
                    LetValue::Condition(_) => Kind::Bool,
                    LetValue::Number(_) => kind_of(&ty.lets[number].column),
                },
            })
        });
        kinds.reduce(Kind::with).unwrap_or(Kind::Number)
    };
    record.columns.iter().enumerate().map(|(k, name)| Column::new(name, kind(k))).collect()
}

fn kind_of(column: &program::Column) -> Kind {
    if column.boolean { Kind::Bool } else { Kind::Number }
}

/// The names of the program's agents and columns.
pub(super) fn cast_of(program: &Program) -> Cast {
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
        discrete_kinds: ty.discretes.iter().map(kind_of).collect(),
    });
    Cast { agents, types: types.collect() }
}

/// What code generation makes.
fn code_of(backend: BackendName) -> &'static str {
    match backend {
        BackendName::Jit => "machine code",
        BackendName::Auto | BackendName::Interp => "tapes",
    }
}

fn write_whole(mut sink: Sink, text: &str) -> Result<(), Refused> {
    sink.writer
        .write_all(text.as_bytes())
        .and_then(|()| sink.writer.flush())
        .map_err(|error| format!("cannot write `{}`: {error}", sink.name))
}
