//! `hyc run`: a model through every floor, then what became of it.

use std::io;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use super::algorithm::{Computed, limits_of, single};
use super::arguments::{AssertLevel, RunArguments, SettingArguments};
use super::film::Film;
use super::input::{Loaded, load, name_of};
use super::limits::Limits;
use super::outputs::{OutputFiles, kind_of};
use super::progress::ProgressLine;
use super::refusal::{refuse_endless, refuse_unpublished};
use super::sinks::Sinks;
use super::terminal::{complain, say, say_aside, tell};
use super::texts::{places, texts};
use super::warnings::Levels;
use super::{Exit, Refused, claims};
use crate::base::render::{Colours, render};
use crate::base::{Diagnostic, SourceMap};
use crate::calculus;
use crate::codegen::program::{Column, Program};
use crate::codegen::{self, Backend};
use crate::model::ir::Integrator;
use crate::model::machinery::{BackendName, Named as _};
use crate::model::{self, Model, Settings};
use crate::output::{Cast, Report, Sink, Tables, TypeColumns, statistics, summary, unwritten};
use crate::picture::{Scene, page};
use crate::runtime::observe::{End, Outcome};
use crate::runtime::{self, Algorithm};

/// Set by the user's interruption.
pub(super) static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// Compiles, simulates, writes.
pub(super) fn run(arguments: &RunArguments) -> Result<Exit, Refused> {
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
    let limits = limits_of(&model, &arguments.engine.limits, arguments.engine.threads)?;
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
    refuse_unpublished(algorithm, &program)?;
    let compile_seconds = begun.elapsed().as_secs_f64();
    let code_seconds = program.cost.seconds;
    let compile_parts = [
        ("reading", read_seconds),
        ("equations", compile_seconds - read_seconds - code_seconds),
        (code_of(backend), code_seconds),
    ];

    let cast = cast_of(&model, &program);
    let diagrams = model::diagrams(&model, &sources);
    let page_wanted = arguments.outputs.report.is_some();
    let mut film = page_wanted.then(|| Film::new(&model, &program, &cast, &diagrams));
    if let Some(film) = &mut film {
        film.watched.show(&arguments.outputs.xy)?;
    }
    let mut sinks = Sinks::new(&inputs);
    let opened = OutputFiles::open(&arguments.outputs, &program, &mut sinks)?;
    let (mut tables, whole) = opened.begin(&program, &cast, &sources)?;
    if let Some(film) = &mut film {
        film.begin(&mut program, &mut tables);
    }
    let begun = Instant::now();
    let outcome = simulate(algorithm, &program, &limits.run, &mut tables, arguments.quiet)?;
    let flushed = tables.finish();
    let run_seconds = begun.elapsed().as_secs_f64();
    let writing_seconds = tables.writing().as_secs_f64().min(run_seconds);
    drop(tables);
    let named = |&(who, count): &(_, u64)| (cast.agent(who).into_owned(), count);
    let [slowest, busiest]: [Vec<(String, u64)>; 2] =
        [&outcome.stats.slowest, &outcome.stats.busiest].map(|most| most.iter().map(named).collect());
    let (functions, code_bytes) = program.machine_code();
    let mut report = Report {
        model: &name_of(&arguments.model),
        algorithm: algorithm.name(),
        engine: algorithm.form().name(),
        integrator: program.run.integrator.name(),
        backend: backend.name(),
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
        slowest: &slowest,
        compile_parts: &compile_parts,
        writing_seconds,
        compile_seconds,
        run_seconds,
        page_seconds: None,
        files: sinks.names(),
    };
    tell(&sources, &outcome.warnings);
    tell(&sources, &claims::diagnostics(&outcome.false_asserts, &cast));
    tell(&sources, &claims::of_properties(&outcome.verdicts));
    if let (Some(sink), Some(film)) = (whole.page, &mut film) {
        let begun = Instant::now();
        film.end();
        let Film { watched, recording, .. } = &*film;
        let error = match &outcome.end {
            End::Error(diagnostic) => {
                Some(render(&sources, std::slice::from_ref(&**diagnostic), Colours::None))
            }
            End::Until | End::Stop { .. } | End::Interrupted | End::Output(_) => None,
        };
        let scene = Scene {
            title: &name_of(Path::new(arguments.model.file_name().unwrap_or_default())),
            texts: &texts(&model, &sources),
            places: &places(&model, &sources),
            diagrams: &diagrams,
            recording,
            columns: &watched.columns,
            plane: watched.plane(recording),
            landmarks: &watched.landmarks,
            summary: &summary(&report),
            error: error.as_deref(),
            left_out: &film.left_out(&outcome),
        };
        write_whole(sink, &page(&scene))?;
        report.page_seconds = Some(begun.elapsed().as_secs_f64());
    }
    if let Some(sink) = whole.statistics {
        write_whole(sink, &statistics(&report))?;
    }
    let summary = summary(&report);
    let is_left = matches!(&outcome.end, End::Output(error) if is_closed(error));
    if !arguments.quiet && !is_left {
        if sinks.on_stdout() { say_aside(&summary) } else { say(&summary)? }
    }
    let exit = conclude(&outcome, &sources, arguments.asserts);
    match flushed {
        Err(error) if !matches!(outcome.end, End::Output(_)) && !is_closed(&error) => Err(error.to_string()),
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

/// Whether nobody reads any more what a run writes, which is no failure.
fn is_closed(error: &io::Error) -> bool {
    error.kind() == io::ErrorKind::BrokenPipe
}

/// Has the user's interruption end a run; a second one ends the process at once.
pub(super) fn listen() -> Result<&'static AtomicBool, Refused> {
    let on_interrupt = || {
        if INTERRUPTED.swap(true, Ordering::SeqCst) {
            std::process::exit(Exit::Interrupted as i32);
        }
    };
    ctrlc::set_handler(on_interrupt).map_err(|error| format!("cannot listen for interruptions: {error}"))?;
    Ok(&INTERRUPTED)
}

/// Runs until its end or the user's interruption.
pub(super) fn simulate(
    algorithm: Algorithm,
    program: &Program,
    limits: &runtime::Limits,
    tables: &mut Tables<'_>,
    quiet: bool,
) -> Result<Outcome, Refused> {
    let interrupt = listen()?;
    let line = std::rc::Rc::new(std::cell::RefCell::new(ProgressLine::new()));
    if !quiet {
        let line = line.clone();
        tables.on_progress(move |progress| line.borrow_mut().show(progress));
    }
    let outcome = runtime::simulate_by(algorithm, program, limits, interrupt, tables);
    line.borrow_mut().clear();
    Ok(outcome)
}

/// Says how the run ended, if not well, and with which exit code the process ends.
pub(super) fn conclude(outcome: &Outcome, sources: &SourceMap, asserts: AssertLevel) -> Exit {
    match &outcome.end {
        End::Error(diagnostic) => {
            tell(sources, std::slice::from_ref(diagnostic));
            Exit::RunError
        }
        End::Output(error) if is_closed(error) => Exit::Fine,
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

/// The names of the program's agents and columns.
pub(super) fn cast_of(model: &Model, program: &Program) -> Cast {
    let mut agents = vec![String::new(); program.population.agents.len()];
    for block in &program.population.blocks {
        for k in 0..block.count {
            agents[block.first + k] =
                if block.array { format!("{}[{k}]", block.name) } else { block.name.clone() };
        }
    }
    let divided = model::divided_names(model);
    let names = |id, columns: &[Column]| {
        columns.iter().map(|column| model::column_name(model, id, &column.name, &divided)).collect()
    };
    let types = model.types.indices().zip(&program.types).map(|(id, ty)| TypeColumns {
        name: ty.name.clone(),
        states: names(id, &ty.states),
        discretes: names(id, &ty.discretes),
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
    match sink.writer.write_all(text.as_bytes()).and_then(|()| sink.writer.flush()) {
        Err(error) if !is_closed(&error) => Err(unwritten(&sink.name, &error).to_string()),
        Ok(()) | Err(_) => Ok(()),
    }
}
