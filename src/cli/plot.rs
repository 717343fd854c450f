//! `hyc plot`: a picture of a run, from a table that it wrote or from a model that is run for it.

use std::fs;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use super::algorithm::{Computed, limits_of, single};
use super::arguments::{AssertLevel, EngineArguments, PlotArguments, SettingArguments};
use super::claims;
use super::film::Film;
use super::input::{load, name_of, reason};
use super::limits::Limits;
use super::refusal::refuse_endless;
use super::run::{RecordAll, cast_of, compile, conclude, settings_of, simulate};
use super::terminal::{say, say_aside, tell};
use super::{Exit, Refused};
use crate::base::Diagnostic;
use crate::model;
use crate::output::Tables;
use crate::picture::{Form, Traces, View, plot as draw};
use crate::runtime::observe::End;

/// The longest table that is read, bytes.
const TABLE_MAX: u64 = 1 << 30;

/// Draws, and says where the picture is.
pub(super) fn plot(arguments: &PlotArguments) -> Result<Exit, Refused> {
    let input = &arguments.input;
    let from_stdin = input.as_path() == Path::new("-");
    let (traces, exit) = if input.extension().is_some_and(|ending| ending == "hy") {
        if arguments.events.is_some() {
            return Err(format!(
                "`--events` is for a trajectory; the events of `{}` are there",
                input.display()
            ));
        }
        match traces_of_model(arguments)? {
            (Some(traces), exit) => (traces, exit),
            (None, exit) => return Ok(exit),
        }
    } else {
        if let Some(option) = set(&arguments.settings) {
            return Err(format!(
                "`{option}` is for a model that is run, and `{}` is a table",
                input.display()
            ));
        }
        let mut traces = traces_of_table(input)?;
        if let Some(log) = &arguments.events {
            let events = traces_of_table(log)?;
            if events.events.is_empty() && !events.columns.is_empty() {
                return Err(format!("`{}` is no event log", log.display()));
            }
            traces.mark(&events);
        }
        (traces, Exit::Fine)
    };
    let view = view(arguments, &traces)?;
    let out = arguments.out.clone().unwrap_or_else(|| match from_stdin {
        true => PathBuf::from("plot.svg"),
        false => Path::new(input.file_stem().unwrap_or_default()).with_extension("svg"),
    });
    let form = match out.extension().and_then(|ending| ending.to_str()) {
        Some("svg") => Form::Svg,
        Some("png") => Form::Png,
        Some(_) | None => return Err(format!("`{}`: pictures are `.svg` or `.png`", out.display())),
    };
    let title =
        if from_stdin { String::new() } else { name_of(Path::new(input.file_name().unwrap_or_default())) };
    let bytes = draw(&traces, &view, &title, form)?;
    fs::write(&out, bytes)
        .map_err(|error| format!("cannot write `{}`: {}", out.display(), reason(&error)))?;
    say(&format!("wrote {}\n", out.display()))?;
    Ok(exit)
}

/// An option that says how a model is run, if one is given.
fn set(settings: &SettingArguments) -> Option<&'static str> {
    let SettingArguments { params, until, tolerance, absolute, seed } = settings;
    let given = [
        (!params.is_empty(), "-p"),
        (until.is_some(), "--until"),
        (tolerance.is_some(), "--tolerance"),
        (absolute.is_some(), "--absolute"),
        (seed.is_some(), "--seed"),
    ];
    given.into_iter().find_map(|(is_given, name)| is_given.then_some(name))
}

fn traces_of_table(path: &Path) -> Result<Traces, Refused> {
    if path == Path::new("-") {
        let refuse = |why: &str| format!("cannot read standard input: {why}");
        let mut text = String::new();
        let read = io::stdin().take(TABLE_MAX).read_to_string(&mut text);
        read.map_err(|error| refuse(&reason(&error)))?;
        return Traces::read(&text).map_err(|why| refuse(&why));
    }
    let refuse = |why: &str| format!("cannot read `{}`: {why}", path.display());
    let size = fs::metadata(path).map_err(|error| refuse(&reason(&error)))?.len();
    if size > TABLE_MAX {
        return Err(refuse("it is larger than 1 GiB; record less often"));
    }
    let ending = path.extension().and_then(|ending| ending.to_str()).map(str::to_ascii_lowercase);
    if matches!(ending.as_deref(), Some("arrow" | "arrows" | "feather" | "parquet")) {
        return Err(refuse("only tables in CSV are drawn; have the run write one, or plot the model"));
    }
    let text = fs::read_to_string(path).map_err(|error| refuse(&reason(&error)))?;
    Traces::read(&text).map_err(|why| refuse(&why))
}

/// Runs the model, and says how that ended, if not well; no file that it names is written.
fn traces_of_model(arguments: &PlotArguments) -> Result<(Option<Traces>, Exit), Refused> {
    let loaded =
        load(&arguments.input, &settings_of(&arguments.settings, None, RecordAll::No, &Limits::default()))?;
    tell(&loaded.sources, &loaded.diagnostics);
    let (exit, sources) = (loaded.exit(), loaded.sources);
    let Some(mut model) = loaded.model else { return Ok((None, exit)) };
    let limits = limits_of(&model, &[], None)?;
    let Computed { algorithm, backend } = single(&EngineArguments::default(), &mut model, false)?;
    let mut warnings: Vec<Diagnostic> = Vec::new();
    let mut program = match compile(&model, backend, &mut warnings) {
        Ok(program) => program,
        Err(diagnostics) => {
            tell(&sources, &diagnostics);
            return Ok((None, Exit::ModelErrors));
        }
    };
    refuse_endless(&model)?;
    let (cast, diagrams) = (cast_of(&model, &program), model::diagrams(&model, &sources));
    let mut film = Film::new(&model, &program, &cast, &diagrams);
    let mut tables = Tables::new(&cast);
    film.begin(&mut program, &mut tables);
    let outcome = simulate(algorithm, &program, &limits.run, &mut tables, false)?;
    drop(tables);
    tell(&sources, &claims::diagnostics(&outcome.false_asserts, &cast));
    tell(&sources, &claims::of_properties(&outcome.verdicts));
    if matches!(outcome.end, End::Interrupted) {
        say_aside(&format!("interrupted at t = {} s\n", outcome.time));
    }
    // What has been computed until then is drawn.
    let exit = conclude(&outcome, &sources, AssertLevel::Error);
    film.end();
    let labels = film.watched.columns.iter().map(|column| match &column.unit {
        Some(unit) => format!("{}, {unit}", column.name),
        None => column.name.clone(),
    });
    Ok((Some(Traces::of(&film.recording, &labels.collect::<Vec<_>>())), exit))
}

/// What `--xy` and `--columns` ask for; without them everything over time.
fn view(arguments: &PlotArguments, traces: &Traces) -> Result<View, Refused> {
    let find = |name: &String| {
        let known = |column: &String| column == name || column.split(',').next() == Some(name.as_str());
        let bare = |column: &String| column.split(',').next().unwrap_or_default().to_string();
        let there: Vec<String> = traces.columns.iter().map(bare).collect();
        traces.columns.iter().position(known).ok_or_else(|| match &there[..] {
            [] => format!("there is no column `{name}`: an event log has times and agents only"),
            _ => format!("there is no column `{name}`; there are {}", there.join(", ")),
        })
    };
    let axis = |name: &String| if name == "time" { Ok(None) } else { find(name).map(Some) };
    match &arguments.xy[..] {
        [] if arguments.columns.is_empty() => Ok(View::OverTime((0..traces.columns.len()).collect())),
        [] => Ok(View::OverTime(arguments.columns.iter().map(find).collect::<Result<_, _>>()?)),
        [across, up] => Ok(View::Plane(axis(across)?, axis(up)?)),
        _ => Err("`--xy` takes two columns: `--xy x,y`".into()),
    }
}
