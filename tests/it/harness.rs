//! How a test runs a model: through the doors of the floors, with both back ends, which must agree to the bit.

use std::fmt::Write as _;
use std::io;
use std::sync::atomic::AtomicBool;

use hyc::base::{Diagnostic, SourceMap};
use hyc::calculus::system::System;
use hyc::codegen::Backend;
use hyc::codegen::program::Program;
use hyc::model::ir::{Integrator, Model};
use hyc::model::{Files, Settings};
use hyc::runtime::Algorithm;
use hyc::runtime::limits::Limits;
use hyc::runtime::observe::{
    Cause, Cell, End, Explanation, FalseAssert, Last, Observer, Outcome, Row, ShownComparison, Stats,
    Undecided, Verdict, Who,
};
use hyc::runtime::paper::Form;

/// A model with what the command line says about its run.
#[derive(Default)]
pub struct Case {
    name: String,
    text: String,
    files: Vec<(String, String)>,
    settings: Settings,
    limits: Limits,
    algorithm: Algorithm,
}

/// A row of the event log with names.
#[derive(Clone, Debug, PartialEq)]
pub struct Fired {
    pub time: f64,
    pub micro: usize,
    pub transition: String,
    pub agent: String,
    pub other: String,
    pub from: String,
    pub to: String,
}

/// Why a transition fired, with names.
#[derive(Clone, Debug, PartialEq)]
pub struct Explained {
    pub time: f64,
    pub micro: usize,
    pub transition: String,
    pub agent: String,
    pub other: String,
    pub cause: Cause,
    pub shown: Vec<ShownComparison>,
}

/// Whether a run is to be explained.
#[derive(Clone, Copy, PartialEq)]
enum Reasons {
    Wanted,
    Unwanted,
}

/// A row of a trajectory.
#[derive(Clone, Debug, PartialEq)]
pub struct Sample {
    pub time: f64,
    pub micro: usize,
    pub agent: String,
    pub mode: String,
    pub cells: Vec<f64>,
}

/// The state of an agent at the end.
#[derive(Clone, Debug, PartialEq)]
pub struct Final {
    pub time: f64,
    pub agent: String,
    pub mode: String,
    pub values: Vec<(String, f64)>,
}

/// How a run ended.
#[derive(Clone, Debug, PartialEq)]
pub enum Ended {
    Until,
    Stop { reason: Option<String>, by: String },
    Error(Diagnostic),
}

/// All that a run told its observer.
#[derive(Clone, Debug)]
pub struct Run {
    pub events: Vec<Fired>,
    pub samples: Vec<Vec<Sample>>,
    pub explanations: Vec<Explained>,
    pub undecided: Vec<Undecided>,
    pub finals: Vec<Final>,
    pub end: Ended,
    pub time: f64,
    pub stats: Stats,
    pub false_asserts: Vec<FalseAssert>,
    pub verdicts: Vec<Verdict>,
    pub warnings: Vec<Diagnostic>,
    pub sources: SourceMap,
}

/// Runs a model that must be right, and must end without an error.
#[track_caller]
pub fn simulate(text: &str) -> Run {
    let [fast, plain] = both_forms(text);
    all_near(&fast.event_times(), &plain.event_times(), 1e-6);
    fast
}

/// The runs of a model by the fast and by the plain form of the engine, which must find the same events.
#[track_caller]
pub fn both_forms(text: &str) -> [Run; 2] {
    let runs = [Form::Fast, Form::Plain].map(|form| Case::new(text).algorithm(Algorithm::Masim(form)).run());
    assert_eq!(runs[0].log(), runs[1].log(), "the forms differ:\n{text}");
    runs
}

/// Runs a model by both forms of the engine, which must find the same events at the same times.
#[track_caller]
pub fn simulate_by_both_forms(text: &str) -> Run {
    let [fast, plain] = both_forms(text);
    all_near(&fast.event_times(), &plain.event_times(), 1e-6);
    plain
}

/// The same more closely; who is there at the end, and with which values, must be the same, too.
#[track_caller]
pub fn simulate_to_the_end(text: &str) -> Run {
    let [fast, plain] = both_forms(text);
    all_near(&fast.event_times(), &plain.event_times(), 1e-8);
    let names = |run: &Run| run.finals.iter().map(|last| last.agent.clone()).collect::<Vec<_>>();
    assert_eq!(names(&plain), names(&fast));
    let values =
        |run: &Run| run.finals.iter().flat_map(|last| &last.values).map(|(_, x)| *x).collect::<Vec<_>>();
    all_near(&values(&fast), &values(&plain), 1e-7);
    fast
}

/// Runs a model that must be right, and must end in an error.
#[track_caller]
pub fn simulate_error(text: &str) -> (Run, Diagnostic) {
    Case::new(text).run_error()
}

/// What is wrong with a model that must be wrong: the messages in full.
#[track_caller]
pub fn refused(text: &str) -> String {
    words(&Case::new(text).refused().1)
}

/// The text of diagnostics without places.
pub fn words(diagnostics: &[Diagnostic]) -> String {
    let mut text = String::new();
    for diagnostic in diagnostics {
        let _ = writeln!(text, "{}[{}]: {}", diagnostic.severity.word(), diagnostic.code, diagnostic.title);
        for line in
            diagnostic.labels.iter().map(|label| &label.text).chain(&diagnostic.notes).chain(&diagnostic.help)
        {
            let _ = writeln!(text, "  {line}");
        }
    }
    text
}

/// Fails unless two numbers are as near as `tolerance`.
#[track_caller]
pub fn near(actual: f64, expected: f64, tolerance: f64) {
    let difference = (actual - expected).abs();
    assert!(difference <= tolerance, "{actual:?} is not {expected:?}: off by {difference:e} > {tolerance:e}");
}

/// Fails unless two lists of numbers are as near as `tolerance` and as long.
#[track_caller]
pub fn all_near(actual: &[f64], expected: &[f64], tolerance: f64) {
    assert_eq!(actual.len(), expected.len(), "\n  actual {actual:?}\nexpected {expected:?}");
    for (k, (actual, expected)) in actual.iter().zip(expected).enumerate() {
        let difference = (actual - expected).abs();
        assert!(difference <= tolerance, "number {k}: {actual:?} is not {expected:?}: off by {difference:e}");
    }
}

/// Simpson's rule, as accurate as its many points.
pub fn integral(f: impl Fn(f64) -> f64, from: f64, to: f64) -> f64 {
    let n = 20_000;
    let h = (to - from) / n as f64;
    let inner: f64 = (1..n).map(|k| f(from + k as f64 * h) * if k % 2 == 1 { 4.0 } else { 2.0 }).sum();
    (f(from) + inner + f(to)) * h / 3.0
}

impl Case {
    /// A model given as text.
    pub fn new(text: &str) -> Self {
        Self { name: "test.hy".into(), text: text.into(), ..Self::default() }
    }

    /// A model of the folder `models`.
    #[track_caller]
    pub fn shipped(name: &str) -> Self {
        let path = format!("{}/models/{name}", env!("CARGO_MANIFEST_DIR"));
        let text = std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{path}: {error}"));
        Self { name: path, text, ..Self::default() }
    }

    /// A file that the model names.
    pub fn file(mut self, name: &str, text: &str) -> Self {
        self.files.push((name.into(), text.into()));
        self
    }

    /// `-p name=value`
    pub fn param(mut self, name: &str, value: impl ToString) -> Self {
        self.settings.params.push((name.into(), value.to_string()));
        self
    }

    /// `--until`
    pub fn until(mut self, until: f64) -> Self {
        self.settings.until = Some(until);
        self
    }

    /// `--tolerance`
    pub fn tolerance(mut self, tolerance: f64) -> Self {
        self.settings.tolerance = Some(tolerance);
        self
    }

    /// `--seed`
    pub fn seed(mut self, seed: u64) -> Self {
        self.settings.seed = Some(seed);
        self
    }

    /// `--integrator`
    pub fn integrator(mut self, integrator: Integrator) -> Self {
        self.settings.integrator = Some(integrator);
        self
    }

    /// `--algorithm`, with the integrator that goes with it.
    pub fn algorithm(mut self, algorithm: Algorithm) -> Self {
        self.algorithm = algorithm;
        match algorithm {
            Algorithm::Masim(_) => self,
            Algorithm::Masim2004(_) | Algorithm::Sasim2004(_) => self.integrator(Integrator::Adams),
        }
    }

    /// `max_microsteps` and the like.
    pub fn limits(mut self, limits: Limits) -> Self {
        self.limits = limits;
        self
    }

    /// The tree of the text.
    pub fn ast(&self, sources: &mut SourceMap) -> Result<hyc::syntax::Ast, Vec<Diagnostic>> {
        let file = sources.add(self.name.clone(), self.text.clone());
        hyc::syntax::parse(file, &self.text)
    }

    /// The checked model.
    pub fn model(&self, sources: &mut SourceMap) -> Result<Model, Vec<Diagnostic>> {
        let ast = self.ast(sources)?;
        let checked = self.check(&ast, sources);
        checked.model.ok_or(checked.diagnostics)
    }

    /// What a check of its tree comes to.
    pub fn check(&self, ast: &hyc::syntax::Ast, sources: &mut SourceMap) -> hyc::model::Checked {
        hyc::model::check(ast, sources, &mut Data(&self.files), &self.settings)
    }

    /// What is wrong with a model that must be wrong.
    #[track_caller]
    pub fn refused(&self) -> (SourceMap, Vec<Diagnostic>) {
        let mut sources = SourceMap::default();
        let diagnostics = match self.model(&mut sources) {
            Err(diagnostics) => diagnostics,
            Ok(model) => match hyc::calculus::derive(&model) {
                Err(diagnostics) => diagnostics,
                Ok(_) => panic!("the model should be refused:\n{}", self.text),
            },
        };
        assert!(diagnostics.iter().any(Diagnostic::is_error), "refused without an error: {diagnostics:#?}");
        (sources, diagnostics)
    }

    /// Its equations.
    #[track_caller]
    pub fn system(&self) -> (Model, System, SourceMap) {
        let mut sources = SourceMap::default();
        let model = self.model(&mut sources).unwrap_or_else(|found| self.fail(&found));
        let system = hyc::calculus::derive(&model).unwrap_or_else(|found| self.fail(&found));
        (model, system, sources)
    }

    /// Runs the model with both back ends, which must agree.
    #[track_caller]
    pub fn run_any(&self) -> Run {
        self.run_with(Reasons::Unwanted)
    }

    /// Runs the model with both back ends, and has it explained.
    #[track_caller]
    pub fn run_explained(&self) -> Run {
        self.run_with(Reasons::Wanted)
    }

    #[track_caller]
    fn run_with(&self, reasons: Reasons) -> Run {
        let (model, system, sources) = self.system();
        let [interpreted, compiled] = [Backend::Interpreter, Backend::Jit].map(|backend| {
            let program =
                hyc::codegen::compile(system.clone(), backend).unwrap_or_else(|found| self.fail(&[found]));
            self.observe(&model, &program, &sources, reasons)
        });
        let differences = interpreted.differences(&compiled);
        assert!(differences.is_empty(), "interpreter and machine code differ:\n{differences}");
        compiled
    }

    /// Runs a model that must not end in an error.
    #[track_caller]
    pub fn run(&self) -> Run {
        let run = self.run_any();
        if let Ended::Error(found) = &run.end {
            panic!(
                "the run ends in error at {}:\n{}\n{:#?}",
                run.time,
                words(std::slice::from_ref(found)),
                run.log_end()
            );
        }
        run
    }

    /// Runs a model that must end in an error.
    #[track_caller]
    pub fn run_error(&self) -> (Run, Diagnostic) {
        let run = self.run_any();
        match run.end.clone() {
            Ended::Error(found) => (run, found),
            end => {
                panic!(
                    "the run should end in an error, not by {end:?} at {}:\n{:#?}",
                    run.time,
                    run.log_end()
                )
            }
        }
    }

    fn observe(&self, model: &Model, program: &Program, sources: &SourceMap, reasons: Reasons) -> Run {
        let mut recorder = Recorder::new(model, reasons);
        let interrupt = AtomicBool::new(false);
        let outcome =
            hyc::runtime::simulate_by(self.algorithm, program, &self.limits, &interrupt, &mut recorder);
        recorder.run(outcome, sources.clone())
    }

    #[track_caller]
    fn fail(&self, found: &[Diagnostic]) -> ! {
        panic!("{} has errors:\n{}", self.name, words(found))
    }
}

/// The files of a case, and the data files of the folder `models`.
struct Data<'a>(&'a [(String, String)]);

impl Files for Data<'_> {
    fn read(&mut self, path: &str) -> io::Result<Vec<u8>> {
        if let Some((_, text)) = self.0.iter().find(|(name, _)| name == path) {
            return Ok(text.clone().into_bytes());
        }
        std::fs::read(format!("{}/models/{path}", env!("CARGO_MANIFEST_DIR")))
    }
}

/// Writes everything down.
struct Recorder {
    agents: Vec<String>,
    types: Vec<String>,
    variables: Vec<(Vec<String>, Vec<String>)>,
    events: Vec<Fired>,
    samples: Vec<Vec<Sample>>,
    explanations: Vec<Explained>,
    undecided: Vec<Undecided>,
    finals: Vec<Final>,
    reasons: Reasons,
}

impl Recorder {
    fn new(model: &Model, reasons: Reasons) -> Self {
        let population = &model.population;
        let agents = (0..population.agents.len()).map(|agent| population.agent_name(agent)).collect();
        let names =
            |variables: &[hyc::model::ir::Variable]| variables.iter().map(|v| v.name.clone()).collect();
        let variables = model.types.iter().map(|ty| (names(&ty.states), names(&ty.discretes))).collect();
        let samples = model.run.records.iter().map(|_| Vec::new()).collect();
        let types = model.types.iter().map(|ty| ty.name.clone()).collect();
        Self {
            agents,
            types,
            variables,
            events: Vec::new(),
            samples,
            explanations: Vec::new(),
            undecided: Vec::new(),
            finals: Vec::new(),
            reasons,
        }
    }

    /// `cars[3]`, `Car#17`
    fn name(&self, who: Who) -> String {
        self.agents
            .get(who.number)
            .cloned()
            .unwrap_or_else(|| format!("{}#{}", self.types[who.ty], who.number))
    }

    fn run(self, outcome: Outcome, sources: SourceMap) -> Run {
        let end = match outcome.end {
            End::Until => Ended::Until,
            End::Stop { reason, by } => {
                Ended::Stop { reason, by: by.map_or_else(|| "stop when".into(), |(_, by)| by) }
            }
            End::Error(found) => Ended::Error(*found),
            End::Interrupted => panic!("nobody interrupted the run"),
            End::Output(error) => panic!("the recorder never fails: {error}"),
        };
        Run {
            events: self.events,
            samples: self.samples,
            explanations: self.explanations,
            undecided: self.undecided,
            finals: self.finals,
            end,
            time: outcome.time,
            stats: outcome.stats,
            false_asserts: outcome.false_asserts,
            verdicts: outcome.verdicts,
            warnings: outcome.warnings,
            sources,
        }
    }
}

/// A cell as a number: booleans 1 and 0, agents by number, `none` -1, an empty cell NaN.
fn number(cell: &Cell) -> f64 {
    match cell {
        Cell::Empty => f64::NAN,
        Cell::Number(x) => *x,
        Cell::Bool(b) => f64::from(u8::from(*b)),
        Cell::Agent(agent) => agent.map_or(-1.0, |who| who.number as f64),
    }
}

impl Observer for Recorder {
    fn event(&mut self, event: &hyc::runtime::observe::Event<'_>) -> io::Result<()> {
        let (from, to) = event.modes.unwrap_or(("", ""));
        self.events.push(Fired {
            time: event.time,
            micro: event.micro,
            transition: event.transition.into(),
            agent: self.name(event.agent),
            other: event.other.map_or(String::new(), |other| self.name(other)),
            from: from.into(),
            to: to.into(),
        });
        Ok(())
    }

    fn sample(&mut self, record: usize, row: &Row<'_>) -> io::Result<()> {
        let agent = self.name(row.agent);
        self.samples[record].push(Sample {
            time: row.time,
            micro: row.micro,
            agent,
            mode: row.mode.into(),
            cells: row.cells.iter().map(number).collect(),
        });
        Ok(())
    }

    fn last(&mut self, last: &Last<'_>) -> io::Result<()> {
        let (states, discretes) = &self.variables[last.ty];
        let states = states.iter().cloned().zip(last.states.iter().copied());
        let discretes = discretes.iter().cloned().zip(last.discretes.iter().map(number));
        self.finals.push(Final {
            time: last.time,
            agent: self.name(last.agent),
            mode: last.mode.into(),
            values: states.chain(discretes).collect(),
        });
        Ok(())
    }

    fn wants_reasons(&self) -> bool {
        self.reasons == Reasons::Wanted
    }

    fn explanation(&mut self, told: &Explanation<'_>) -> io::Result<()> {
        self.explanations.push(Explained {
            time: told.time,
            micro: told.micro,
            transition: told.transition.into(),
            agent: self.name(told.agent),
            other: told.other.map_or(String::new(), |other| self.name(other)),
            cause: told.cause.clone(),
            shown: told.shown.clone(),
        });
        Ok(())
    }

    fn undecided(&mut self, told: &Undecided) -> io::Result<()> {
        self.undecided.push(told.clone());
        Ok(())
    }
}

impl Run {
    /// When each event was, s.
    pub fn event_times(&self) -> Vec<f64> {
        self.events.iter().map(|event| event.time).collect()
    }

    /// The times at which a transition has fired.
    pub fn times(&self, transition: &str) -> Vec<f64> {
        self.events.iter().filter(|event| event.transition == transition).map(|event| event.time).collect()
    }

    /// The times at which a transition of one agent has fired.
    pub fn times_of(&self, transition: &str, agent: &str) -> Vec<f64> {
        let of_agent =
            self.events.iter().filter(|event| event.transition == transition && event.agent == agent);
        of_agent.map(|event| event.time).collect()
    }

    /// The log without times: `micro transition agent`, with `other` and modes where there are any.
    pub fn log(&self) -> Vec<String> {
        let line = |event: &Fired| {
            let mut line = format!("{} {} {}", event.micro, event.transition, event.agent);
            if !event.other.is_empty() {
                let _ = write!(line, " {}", event.other);
            }
            if !event.to.is_empty() {
                let _ = write!(line, " {}->{}", event.from, event.to);
            }
            line
        };
        self.events.iter().map(line).collect()
    }

    /// The last rows of the log, for messages.
    fn log_end(&self) -> Vec<String> {
        let log = self.log();
        log[log.len().saturating_sub(8)..].to_vec()
    }

    /// A state or discrete variable at the end, as `agent.variable`.
    #[track_caller]
    pub fn value(&self, path: &str) -> f64 {
        let (agent, variable) = path.rsplit_once('.').expect("agent.variable");
        let values = &self.agent(agent).values;
        let found = values.iter().find(|(name, _)| name == variable);
        found.unwrap_or_else(|| panic!("no {variable} in {values:?}")).1
    }

    /// The mode of an agent at the end.
    #[track_caller]
    pub fn mode(&self, agent: &str) -> &str {
        &self.agent(agent).mode
    }

    /// The end of an agent.
    #[track_caller]
    pub fn agent(&self, agent: &str) -> &Final {
        self.finals.iter().find(|last| last.agent == agent).unwrap_or_else(|| panic!("no agent {agent}"))
    }

    /// One column of the first record for one agent, with its times.
    pub fn column(&self, agent: &str, column: usize) -> Vec<(f64, f64)> {
        let of_agent = self.samples[0].iter().filter(|sample| sample.agent == agent);
        of_agent.map(|sample| (sample.time, sample.cells[column])).collect()
    }

    /// Everything that a run must not change with what watches it, to the bit, as text.
    pub fn bits(&self) -> String {
        let mut text = String::new();
        for event in &self.events {
            let _ = writeln!(text, "{:016x} {event:?}", event.time.to_bits());
        }
        for last in &self.finals {
            let bits: Vec<u64> = last.values.iter().map(|(_, value)| value.to_bits()).collect();
            let _ = writeln!(text, "{:016x} {last:?} {bits:x?}", last.time.to_bits());
        }
        let _ = writeln!(text, "{:?} at {:016x}", self.end, self.time.to_bits());
        text
    }

    /// Where two runs of the same model differ; empty if nowhere.
    fn differences(&self, other: &Run) -> String {
        let all = |run: &Run| {
            let mut text = run.bits();
            for sample in run.samples.iter().flatten() {
                let bits: Vec<u64> = sample.cells.iter().map(|value| value.to_bits()).collect();
                let _ = writeln!(text, "{:016x} {sample:?} {bits:x?}", sample.time.to_bits());
            }
            let _ = writeln!(
                text,
                "{:?}\n{:?}\n{:?}\n{:?}",
                run.stats, run.false_asserts, run.verdicts, run.warnings
            );
            text
        };
        let (ours, theirs) = (all(self), all(other));
        let mut text = String::new();
        for (ours, theirs) in ours.lines().zip(theirs.lines()).filter(|(ours, theirs)| ours != theirs).take(5)
        {
            let _ = writeln!(text, "- {ours}\n+ {theirs}");
        }
        if text.is_empty() && ours.lines().count() != theirs.lines().count() {
            text.push_str("one has more lines than the other\n");
        }
        text
    }
}
