//! What the user may type, as data. The texts here are the help.

use std::path::PathBuf;

use clap::builder::PossibleValue;
use clap::{Args, Parser, Subcommand, ValueEnum};

use crate::model::ir::Integrator;
use crate::model::machinery::{AlgorithmName, BackendName, EngineName, Named};

/// A language, a compiler and a simulator for multi-agent hybrid systems
#[derive(Debug, Parser)]
#[command(name = "hyc", version, max_term_width = 100, propagate_version = true)]
pub(super) struct Arguments {
    /// Colours in messages: where a person reads and NO_COLOR is not set, or as said here
    #[arg(long, global = true, value_enum, default_value_t, value_name = "WHEN")]
    pub(super) color: ColourWhen,
    #[command(subcommand)]
    pub(super) command: Command,
}

#[derive(Debug, Subcommand)]
pub(super) enum Command {
    /// Compile a model and simulate it
    Run(Box<RunArguments>),
    /// Simulate a model, and write a page that shows the run in a browser
    Report(Box<ReportArguments>),
    /// Draw a run: from a table that it wrote, or from a model
    Plot(PlotArguments),
    /// Simulate a model by several algorithms, and say what each costs and misses
    Compare(CompareArguments),
    /// Say what is wrong with models
    Check(CheckArguments),
    /// Print a model at a stage of its way to the simulator
    Show(ShowArguments),
    /// Explain a code such as HY0203; without a code, list all
    Explain(ExplainArguments),
    /// Write a commented model that runs, to begin with
    New(NewArguments),
    /// Print a script that completes commands and options, for a shell
    Completions(CompletionsArguments),
    /// Print the manual page, for `man -l -`
    Man(ManArguments),
    /// Lay models out: blanks, indentation, line ends; never a word or a comment
    Fmt(FmtArguments),
}

#[derive(Debug, Args)]
pub(super) struct RunArguments {
    /// The model
    #[arg(value_name = "MODEL.hy")]
    pub(super) model: PathBuf,
    #[command(flatten)]
    pub(super) settings: SettingArguments,
    #[command(flatten)]
    pub(super) engine: EngineArguments,
    #[command(flatten)]
    pub(super) outputs: OutputArguments,
    /// What a false `assert` or `property` does to the exit code: 4, or 0
    #[arg(long = "assert", value_enum, default_value_t, value_name = "LEVEL")]
    pub(super) asserts: AssertLevel,
    /// Leave out warnings of this code (repeatable)
    #[arg(long, value_name = "CODE")]
    pub(super) allow: Vec<String>,
    /// Print neither progress nor summary, and no warnings about the model
    #[arg(short, long)]
    pub(super) quiet: bool,
}

/// What overrides params and `run { }`.
#[derive(Clone, Debug, Default, Args)]
pub(super) struct SettingArguments {
    /// Give a param another value, in its declared unit (repeatable)
    #[arg(short = 'p', long = "param", value_name = "NAME=VALUE", value_parser = pair)]
    pub(super) params: Vec<(String, String)>,
    /// Run until this time, in seconds
    #[arg(long, value_name = "T", value_parser = finite_not_negative, allow_negative_numbers = true)]
    pub(super) until: Option<f64>,
    /// Relative tolerance of a step
    #[arg(long, value_name = "E", value_parser = finite_positive)]
    pub(super) tolerance: Option<f64>,
    /// Absolute tolerance of a step; as the relative one unless given
    #[arg(long, value_name = "E", value_parser = finite_positive)]
    pub(super) absolute: Option<f64>,
    /// Seed of all random draws
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    pub(super) seed: Option<u64>,
}

/// How it is simulated.
#[derive(Debug, Default, Args)]
pub(super) struct EngineArguments {
    /// How the agents' clocks advance [default: masim]
    #[arg(long, value_enum, value_name = "NAME")]
    pub(super) algorithm: Option<AlgorithmName>,
    #[command(flatten)]
    pub(super) paper: PaperArguments,
    /// The form of the engine; both find the same events [default: fast]
    #[arg(long, value_enum, value_name = "FORM")]
    pub(super) engine: Option<EngineName>,
    /// The method of integration: `auto` (taylor, and stiff for agents in modes that are), `taylor` (Taylor series, order
    /// by the tolerance), `tsit5` (Runge-Kutta, orders 5 and 4), `adams` (predictor-corrector, orders 3 and 4), `stiff`
    /// (Rodas5P, orders 5 and 4)
    #[arg(long, value_name = "METHOD", value_parser = integrator)]
    pub(super) integrator: Option<Integrator>,
    /// What evaluates the equations: the interpreter, and machine code as soon as that pays; or one of the two (the same bits)
    /// [default: auto]
    #[arg(long, value_enum, value_name = "NAME")]
    pub(super) backend: Option<BackendName>,
    /// How many threads may work; changes no result (the plain engine uses one) [default: as many as the machine has]
    #[arg(short = 'j', long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub(super) threads: Option<u32>,
    /// Raise or lower a limit, such as max_steps=1e6; a wrong name lists all (repeatable)
    #[arg(long = "limit", value_name = "NAME=N", value_parser = limit)]
    pub(super) limits: Vec<(String, u64)>,
}

/// Over the options of these in a help text.
const OF_2004: &str = "Options of masim-2004 and sasim-2004";

/// What the published algorithms take besides the tolerance; `run { }` has the same settings.
#[derive(Clone, Copy, Debug, Default, Args)]
pub(super) struct PaperArguments {
    /// The share of a guard that a step towards it leaves over [default: 0.1]
    #[arg(long, help_heading = OF_2004, value_name = "G", value_parser = share)]
    pub(super) gamma: Option<f64>,
    /// The least step that a guard may ask for, in seconds [default: 1e-10]
    #[arg(long, help_heading = OF_2004, value_name = "H", value_parser = finite_positive)]
    pub(super) h_min: Option<f64>,
    /// The longest step, in seconds [default: 0.5]
    #[arg(long, help_heading = OF_2004, value_name = "H", value_parser = finite_positive)]
    pub(super) h_max: Option<f64>,
    /// Clocks count as equal within this, in seconds [default: 1e-9]
    #[arg(long, help_heading = OF_2004, value_name = "E", value_parser = finite_positive)]
    pub(super) synchronisation: Option<f64>,
    /// A guard counts as zero within this, in its own unit [default: 1e-6]. With masim: roots within this time of each other
    /// are one instant if their transitions share an agent, in seconds [default: 1e-12]
    #[arg(long, help_heading = OF_2004, value_name = "E", value_parser = finite_positive)]
    pub(super) event_tolerance: Option<f64>,
}

/// What is written, and where.
#[derive(Debug, Default, Args)]
pub(super) struct OutputArguments {
    /// Where the files that run { } names go; made if it is not there
    #[arg(short = 'o', long = "out", value_name = "DIR")]
    pub(super) folder: Option<PathBuf>,
    /// Write the event log here; `-` is standard output
    #[arg(long, value_name = "FILE")]
    pub(super) events: Option<PathBuf>,
    /// Write the trajectory here; if run { } records nothing, all states at every step
    #[arg(long, value_name = "FILE")]
    pub(super) record: Option<PathBuf>,
    /// Write the state of every agent at the end here
    #[arg(long = "final", value_name = "FILE")]
    pub(super) final_states: Option<PathBuf>,
    /// Say why each transition fired, and which roots were left undecided: to standard output, or here
    #[arg(long, value_name = "FILE", num_args = 0..=1, require_equals = true, default_missing_value = "-")]
    pub(super) explain_events: Option<PathBuf>,
    /// Write counts and times here, as JSON
    #[arg(long, value_name = "FILE")]
    pub(super) stats: Option<PathBuf>,
    /// Write a page here that shows the run: open it in a browser
    #[arg(long, value_name = "FILE")]
    pub(super) report: Option<PathBuf>,
    /// What becomes of the files that run { } names
    #[arg(skip)]
    pub(super) named: Outputs,
    /// What the page shows across and up
    #[arg(skip)]
    pub(super) xy: Vec<String>,
}

/// What becomes of the files that `run { }` names.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Outputs {
    /// They are written.
    #[default]
    Written,
    /// They are left as they are.
    Left,
}

#[derive(Debug, Args)]
pub(super) struct ReportArguments {
    /// The model
    #[arg(value_name = "MODEL.hy")]
    pub(super) model: PathBuf,
    #[command(flatten)]
    pub(super) settings: SettingArguments,
    #[command(flatten)]
    pub(super) engine: EngineArguments,
    /// Where the page goes; in the current folder, with the model's name, if not given
    #[arg(short = 'o', long = "out", value_name = "FILE")]
    pub(super) out: Option<PathBuf>,
    /// What the plane of the page shows across and up at first: two variables, or `time` and one
    #[arg(long, value_name = "X,Y", value_delimiter = ',')]
    pub(super) xy: Vec<String>,
    /// Leave out warnings of this code (repeatable)
    #[arg(long, value_name = "CODE")]
    pub(super) allow: Vec<String>,
    /// Print neither progress nor summary, and no warnings about the model
    #[arg(short, long)]
    pub(super) quiet: bool,
}

#[derive(Debug, Args)]
pub(super) struct PlotArguments {
    /// A trajectory, an event log, or a model; `-` is a table on standard input
    #[arg(value_name = "RUN.csv|MODEL.hy")]
    pub(super) input: PathBuf,
    #[command(flatten)]
    pub(super) settings: SettingArguments,
    /// Where the picture goes, .svg or .png; in the current folder, with the name of the input, if not given
    #[arg(short = 'o', long = "out", value_name = "FILE")]
    pub(super) out: Option<PathBuf>,
    /// The event log of a trajectory, whose events are marked
    #[arg(long, value_name = "LOG.csv")]
    pub(super) events: Option<PathBuf>,
    /// Draw one column, or `time`, against another, as paths in a plane
    #[arg(long, value_name = "X,Y", value_delimiter = ',')]
    pub(super) xy: Vec<String>,
    /// Draw these columns over time; without it the first six
    #[arg(long, value_name = "A,B,..", value_delimiter = ',', conflicts_with = "xy")]
    pub(super) columns: Vec<String>,
}

#[derive(Debug, Args)]
pub(super) struct CompareArguments {
    /// The model
    #[arg(value_name = "MODEL.hy")]
    pub(super) model: PathBuf,
    /// Which algorithms, separated by commas; costs are told in terms of the last
    #[arg(long, value_enum, value_delimiter = ',', default_value = ALL, value_name = "A,B,..")]
    pub(super) algorithms: Vec<AlgorithmName>,
    /// Give a param a value, or a range of values: FROM:TO or FROM:TO:STEP (repeatable)
    #[arg(short = 'p', long = "param", value_name = "NAME=VALUES", value_parser = pair)]
    pub(super) params: Vec<(String, String)>,
    /// Run with each seed from 1 to this
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    pub(super) seeds: Option<u64>,
    /// Relative tolerances of a step, separated by commas
    #[arg(long, value_delimiter = ',', value_name = "E,F,..", value_parser = finite_positive)]
    pub(super) tolerance: Vec<f64>,
    /// Run until this time, in seconds
    #[arg(long, value_name = "T", value_parser = finite_not_negative, allow_negative_numbers = true)]
    pub(super) until: Option<f64>,
    /// What evaluates the equations: the interpreter, and machine code as soon as that pays; or one of the two (the same bits)
    /// [default: auto]
    #[arg(long, value_enum, value_name = "NAME")]
    pub(super) backend: Option<BackendName>,
    /// Write a row for each run here
    #[arg(long, value_name = "FILE")]
    pub(super) csv: Option<PathBuf>,
    /// Raise or lower a limit, as for `run` (repeatable)
    #[arg(long = "limit", value_name = "NAME=N", value_parser = limit)]
    pub(super) limits: Vec<(String, u64)>,
    #[command(flatten)]
    pub(super) paper: PaperArguments,
}

#[derive(Debug, Args)]
pub(super) struct CheckArguments {
    /// The models
    #[arg(value_name = "MODEL.hy", required = true)]
    pub(super) models: Vec<PathBuf>,
    /// Give a param another value, in its declared unit (repeatable)
    #[arg(short = 'p', long = "param", value_name = "NAME=VALUE", value_parser = pair)]
    pub(super) params: Vec<(String, String)>,
    /// Raise or lower a limit, such as max_agents=2e7; a wrong name lists all (repeatable)
    #[arg(long = "limit", value_name = "NAME=N", value_parser = limit)]
    pub(super) limits: Vec<(String, u64)>,
    /// The form of the diagnostics
    #[arg(long, value_enum, default_value_t)]
    pub(super) format: Format,
    /// Take warnings for errors: those of this code, or all with `warnings` (repeatable)
    #[arg(long, value_name = "CODE")]
    pub(super) deny: Vec<String>,
    /// Leave out warnings of this code (repeatable; wins over --deny)
    #[arg(long, value_name = "CODE")]
    pub(super) allow: Vec<String>,
}

#[derive(Debug, Args)]
pub(super) struct ShowArguments {
    /// The model
    #[arg(value_name = "MODEL.hy")]
    pub(super) model: PathBuf,
    /// Which form of the model
    #[arg(long, value_enum)]
    pub(super) stage: Stage,
    /// The form of the picture of `--stage modes` [default: dot]
    #[arg(long, value_enum, value_name = "FORM")]
    pub(super) format: Option<PictureForm>,
    /// Give a param another value, in its declared unit (repeatable)
    #[arg(short = 'p', long = "param", value_name = "NAME=VALUE", value_parser = pair)]
    pub(super) params: Vec<(String, String)>,
    /// Raise or lower a limit, such as max_agents=2e7; a wrong name lists all (repeatable)
    #[arg(long = "limit", value_name = "NAME=N", value_parser = limit)]
    pub(super) limits: Vec<(String, u64)>,
}

#[derive(Debug, Args)]
pub(super) struct ExplainArguments {
    /// A code; without one, all codes are listed
    #[arg(value_name = "CODE")]
    pub(super) code: Option<String>,
}

#[derive(Debug, Args)]
pub(super) struct NewArguments {
    /// The model's name; `hyc new robots` writes `robots.hy`
    #[arg(value_name = "NAME")]
    pub(super) name: String,
}

#[derive(Debug, Args)]
pub(super) struct CompletionsArguments {
    /// The shell
    #[arg(value_enum, value_name = "SHELL")]
    pub(super) shell: clap_complete::Shell,
}

#[derive(Debug, Args)]
pub(super) struct ManArguments {
    /// The command that the page is about; without one, the program
    #[arg(value_name = "COMMAND")]
    pub(super) command: Option<String>,
}

#[derive(Debug, Args)]
pub(super) struct FmtArguments {
    /// The models; `-`, or none: from standard input to standard output
    #[arg(value_name = "MODEL.hy")]
    pub(super) models: Vec<PathBuf>,
    /// Write nothing; list what would change, and exit with 1 if anything would
    #[arg(long)]
    pub(super) check: bool,
}

/// All algorithms, as `--algorithms` has them.
const ALL: &str = "masim,masim-2004,sasim-2004";

/// The names that a setting may have, with what the help says of each.
macro_rules! choices {
    ($name:ident { $($variant:ident: $help:literal,)* }) => {
        impl ValueEnum for $name {
            fn value_variants<'a>() -> &'a [Self] {
                &[$($name::$variant),*]
            }

            fn to_possible_value(&self) -> Option<PossibleValue> {
                let help = match self {
                    $($name::$variant => $help,)*
                };
                Some(PossibleValue::new(self.name()).help(help))
            }
        }
    };
}

choices!(AlgorithmName {
    Masim: "Each agent has its own clock; exact about who reads whom",
    Masim2004: "Algorithms 1 and 2 of Esposito & Kumar (2004), as published: may miss events",
    Sasim2004: "Algorithms 3 and 4: one clock for all, as published: may miss events",
});
choices!(EngineName {
    Fast: "Lists near pairs only, and lets those run ahead who cannot meet anybody",
    Plain: "Looks at everything: slow and simple",
});
choices!(BackendName {
    Auto: "The interpreter, and machine code as soon as it pays",
    Jit: "Machine code",
    Interp: "The interpreter",
});

/// What a false `assert` means.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(super) enum AssertLevel {
    /// Exit code 4
    #[default]
    Error,
    /// A warning
    Warn,
}

/// The form of diagnostics.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(super) enum Format {
    /// For people, on standard error
    #[default]
    Text,
    /// For programs, on standard output
    Json,
    /// For code hosts and editors, on standard output: SARIF 2.1.0
    Sarif,
}

/// A form of the model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum Stage {
    /// The syntax tree
    Ast,
    /// Names resolved, types known, agents made
    Model,
    /// Equations, guards with their rates, Jacobians
    System,
    /// The instructions of the interpreter
    Tape,
    /// The input of the machine code generator
    Clif,
    /// The modes of each agent type, as a diagram
    Modes,
}

/// The form of a mode diagram.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum PictureForm {
    /// For Graphviz
    Dot,
    /// A picture
    Svg,
}

/// Whether messages have colours.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(super) enum ColourWhen {
    /// Where a person reads, unless NO_COLOR is set or CLICOLOR is 0; CLICOLOR_FORCE has them everywhere
    #[default]
    Auto,
    /// Always
    Always,
    /// Never
    Never,
}

fn integrator(text: &str) -> Result<Integrator, String> {
    <Integrator as Named>::named(text).ok_or_else(|| format!("write {}", <Integrator as Named>::WORDS))
}

fn pair(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((name, value)) if !name.trim().is_empty() => Ok((name.trim().into(), value.trim().into())),
        Some(_) | None => Err("write NAME=VALUE".into()),
    }
}

/// A count; `1e9` is one too.
fn limit(text: &str) -> Result<(String, u64), String> {
    let (name, value) = pair(text)?;
    let count =
        value.parse::<f64>().ok().filter(|count| count.fract() == 0.0 && (1.0..=1e18).contains(count));
    match count {
        Some(count) => Ok((name, count as u64)),
        None => Err(format!("`{value}` is not a whole number from 1")),
    }
}

fn share(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if (0.0..1.0).contains(&value) => Ok(value),
        Ok(_) | Err(_) => Err("a number from 0, below 1, is needed".into()),
    }
}

fn finite_positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() && value > 0.0 => Ok(value),
        Ok(_) | Err(_) => Err("a positive number is needed".into()),
    }
}

fn finite_not_negative(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() && value >= 0.0 => Ok(value),
        Ok(_) | Err(_) => Err("a number that is not negative is needed".into()),
    }
}
