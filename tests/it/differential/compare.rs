//! A model by the engine and by the reference, and where their histories differ.

use std::fmt::Write as _;
use std::io;
use std::sync::atomic::AtomicBool;

use hyc::base::{Diagnostic, SourceMap};
use hyc::codegen::Backend;
use hyc::model::ir::{Integrator, Model};
use hyc::model::{Files, Settings};
use hyc::runtime::limits::Limits;
use hyc::runtime::observe::{Cell, End, Event, Last, Observer, Progress};

use super::generate;
use super::reference::{self, Row};

/// The reference's step, s; a model counts only if half of it makes no difference.
const STEP: f64 = 0.01;
/// How far the two may be apart, s.
const TIME: f64 = 1e-5;
/// How far the reference may be from itself, s.
const TIME_OF_ITSELF: f64 = 2e-6;
/// How much other rates must make no difference to a model whose two histories differ.
const NUDGE: f64 = 1e-9;
/// How far states may be apart at the end.
const STATE: f64 = 1e-4;

/// How a model fared.
pub enum Verdict {
    /// Both say the same: so many events.
    Same(usize),
    /// The reference does not agree with itself, or does too much.
    Skipped,
    /// They differ: the whole story.
    Different(String),
}

/// A history to compare: the log, and mode and values of every agent at the end.
struct Story {
    rows: Vec<Row>,
    ends: Vec<(String, Vec<f64>)>,
    error: Option<String>,
}

/// Runs a model both ways, the engine by this method.
pub fn compare(text: &str, integrator: Integrator) -> Verdict {
    let model = match checked(text, integrator) {
        Ok(model) => model,
        Err(found) => return Verdict::Different(format!("the model is refused:\n{text}\n{found}")),
    };
    let refer = |step: f64, nudge: f64| {
        let history = reference::run(&model, step, nudge, generate::is_ordered)?;
        let world = history.world;
        let end = |agent: &super::world::Agent| {
            let ty = &model.types[agent.ty];
            let mut values = world.states[agent.first..agent.first + ty.states.len()].to_vec();
            values.extend(&agent.discretes);
            (ty.modes[agent.mode].path.clone(), values)
        };
        Some(Story { rows: history.rows, ends: world.agents.iter().map(end).collect(), error: None })
    };
    let (Some(coarse), Some(fine)) = (refer(STEP, 0.0), refer(0.5 * STEP, 0.0)) else {
        return Verdict::Skipped;
    };
    if difference(&coarse, &fine, TIME_OF_ITSELF).is_some() {
        return Verdict::Skipped;
    }
    let ours = engine(&model);
    let Some(first) = difference(&ours, &fine, TIME) else { return Verdict::Same(fine.rows.len()) };
    // The reference may have missed an event between two steps, or rounding may decide what happens.
    for (step, nudge) in [(0.05 * STEP, 0.0), (0.5 * STEP, NUDGE), (0.5 * STEP, -NUDGE)] {
        let robust =
            refer(step, nudge).is_some_and(|again| difference(&again, &fine, TIME_OF_ITSELF).is_none());
        if !robust {
            return Verdict::Skipped;
        }
    }
    let mut story = format!("{text}\n{first}\n");
    for (who, rows) in [("engine", &ours.rows), ("reference", &fine.rows)] {
        let _ = writeln!(story, "{who}:");
        for row in rows {
            let _ = writeln!(story, "  {}", line(row));
        }
    }
    Verdict::Different(story)
}

fn line(row: &Row) -> String {
    let other = row.other.map_or(String::new(), |other| format!(" with {other}"));
    let modes = row.modes.as_ref().map_or(String::new(), |(from, to)| format!(" {from} -> {to}"));
    format!("{:.9} {} of {}{other}{modes}", row.time, row.label, row.agent)
}

/// The first difference: agents' own logs are compared, for the order of events of unrelated agents is free.
fn difference(ours: &Story, theirs: &Story, tolerance: f64) -> Option<String> {
    if let Some(error) = &ours.error {
        return Some(error.clone());
    }
    let mut first: Option<(f64, String)> = None;
    let mut found = |time: f64, text: String| {
        if first.as_ref().is_none_or(|(before, _)| time < *before) {
            first = Some((time, text));
        }
    };
    for agent in 0..theirs.ends.len() {
        let own = |story: &Story| -> Vec<Row> {
            let concerns = |row: &&Row| row.agent == agent || row.other == Some(agent);
            story.rows.iter().filter(concerns).cloned().collect()
        };
        let (a, b) = (own(ours), own(theirs));
        let same = |a: &Row, b: &Row| {
            (a.time - b.time).abs() <= tolerance
                && Row { time: 0.0, ..a.clone() } == Row { time: 0.0, ..b.clone() }
        };
        let k = a.iter().zip(&b).take_while(|(a, b)| same(a, b)).count();
        if k < a.len().max(b.len()) {
            let say = |row: Option<&Row>| row.map_or("nothing".to_string(), line);
            let time = a
                .get(k)
                .map_or(f64::INFINITY, |row| row.time)
                .min(b.get(k).map_or(f64::INFINITY, |row| row.time));
            found(time, format!("agent {agent}, its event {k}: {} | {}", say(a.get(k)), say(b.get(k))));
        }
    }
    for (agent, (a, b)) in ours.ends.iter().zip(&theirs.ends).enumerate() {
        let near = |(a, b): (&f64, &f64)| (a - b).abs() <= STATE * (1.0 + b.abs());
        if a.0 != b.0 || !a.1.iter().zip(&b.1).all(near) {
            found(f64::INFINITY, format!("agent {agent} at the end: {a:?} | {b:?}"));
        }
    }
    first.map(|(_, text)| text)
}

/// The model of a text.
fn checked(text: &str, integrator: Integrator) -> Result<Model, String> {
    let mut sources = SourceMap::default();
    let file = sources.add("generated.hy", text);
    let say = |found: Vec<Diagnostic>| {
        found
            .iter()
            .map(|d| format!("{}: {} {:?} {:?}\n", d.code, d.title, d.notes, d.help))
            .collect::<String>()
    };
    let ast = hyc::syntax::parse(file, text).map_err(say)?;
    let settings = Settings { integrator: Some(integrator), ..Settings::default() };
    let checked = hyc::model::check(&ast, &mut sources, &mut NoFiles, &settings);
    checked.model.ok_or_else(|| say(checked.diagnostics))
}

/// What the engine makes of it.
fn engine(model: &Model) -> Story {
    let mut writer = Writer { rows: Vec::new(), ends: Vec::new() };
    let run = |writer: &mut Writer| -> Result<(), Diagnostic> {
        let system = hyc::calculus::derive(model).map_err(|mut found| found.remove(0))?;
        let program = hyc::codegen::compile(system, Backend::Interpreter)?;
        let limits = Limits { steps_max: 10_000_000, ..Limits::default() };
        match hyc::runtime::simulate(&program, &limits, &AtomicBool::new(false), writer).end {
            End::Until => Ok(()),
            End::Error(found) => Err(*found),
            end => panic!("no model ends so: {end:?}"),
        }
    };
    let error =
        run(&mut writer).err().map(|d| format!("{}: {} {:?} {:?}", d.code, d.title, d.labels, d.notes));
    Story { rows: writer.rows, ends: writer.ends, error }
}

/// No model has data.
struct NoFiles;

impl Files for NoFiles {
    fn read(&mut self, path: &str) -> io::Result<Vec<u8>> {
        panic!("nobody reads {path}")
    }
}

/// Writes down what the engine tells.
struct Writer {
    rows: Vec<Row>,
    ends: Vec<(String, Vec<f64>)>,
}

impl Observer for Writer {
    fn event(&mut self, event: &Event<'_>) -> io::Result<()> {
        self.rows.push(Row {
            time: event.time,
            label: event.transition.into(),
            agent: event.agent,
            other: event.other,
            modes: event.modes.map(|(from, to)| (from.into(), to.into())),
        });
        Ok(())
    }

    fn sample(&mut self, _record: usize, _row: &hyc::runtime::observe::Row<'_>) -> io::Result<()> {
        Ok(())
    }

    fn last(&mut self, last: &Last<'_>) -> io::Result<()> {
        let number = |cell: &Cell| match cell {
            Cell::Number(x) => *x,
            Cell::Bool(truth) => f64::from(u8::from(*truth)),
            Cell::Empty | Cell::Agent(_) => f64::NAN,
        };
        let values = last.states.iter().copied().chain(last.discretes.iter().map(number)).collect();
        self.ends.push((last.mode.into(), values));
        Ok(())
    }

    fn progress(&mut self, _progress: &Progress) -> io::Result<()> {
        Ok(())
    }
}
