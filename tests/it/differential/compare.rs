//! A model by the engine and by the reference, and where their histories differ.

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::io;
use std::sync::atomic::AtomicBool;

use hyc::base::{Diagnostic, SourceMap};
use hyc::codegen::Backend;
use hyc::model::ir::{Integrator, Model};
use hyc::model::{Files, Settings};
use hyc::runtime::limits::Limits;
use hyc::runtime::observe::{Cell, End, Event, Last, Observer};

use super::generate;
use super::modes;
use super::reference::{self, Pace, Row};

/// The reference's step, s, and how closely it encloses times; a model counts only if half of the one and a tenth of the other
/// make no difference.
const STEP: f64 = 0.01;
const TOLERANCE: f64 = 1e-12;
/// How far the two may be apart, s.
const TIME: f64 = 1e-5;
/// How far the reference may be from itself, s.
const TIME_OF_ITSELF: f64 = 2e-6;
/// How much other rates must make no difference to a model whose two histories differ.
const NUDGE: f64 = 1e-9;
/// What margins are on the boundary; what depends on this, other than on the last bits, is not robust.
const NEAR: f64 = 1e-9;
const VERY_NEAR: f64 = 1e-13;
/// How far from what is not robust a comparison stops, s.
const MARGIN: f64 = 1e-3;
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

/// A history to compare: the log, and number, mode and values of every agent at the end.
struct Story {
    rows: Vec<Row>,
    ends: Vec<Ending>,
    /// Up to when it counts, s.
    until: f64,
    /// How and when it failed.
    error: Option<(f64, String)>,
}

/// Number, mode and values of an agent.
type Ending = (usize, String, Vec<f64>);

/// A difference: when it shows, s; infinite if in the states at the end only. In words.
type Difference = (f64, String);

/// Runs a model both ways, the engine by this method.
pub fn compare(text: &str, integrator: Integrator) -> Verdict {
    let model = match checked(text, integrator) {
        Ok(model) => model,
        Err(found) => return Verdict::Different(format!("the model is refused:\n{text}\n{found}")),
    };
    let refer = |pace: Pace| {
        let reference::History { rows, until, world } = reference::run(&model, pace, generate::is_ordered);
        let end = |(number, agent): (usize, &super::world::Agent)| {
            let ty = &model.types[agent.ty];
            let mut values = world.states[agent.first..agent.first + ty.states.len()].to_vec();
            values.extend(&agent.discretes);
            (number, modes::name(ty, &agent.active), values)
        };
        let living = world.agents.iter().enumerate().filter(|(_, agent)| agent.lives);
        Story { rows, ends: living.map(end).collect(), until, error: None }
    };
    let end = model.run.until.expect("the generator writes an end");
    let usual = Pace { step: STEP, tolerance: TOLERANCE, nudge: 0.0, near: NEAR, wary: false };
    let half = Pace { step: 0.5 * STEP, tolerance: 0.1 * TOLERANCE, ..usual };
    let fine = refer(half);
    let mut until = agreement(&refer(usual), &fine, end);
    if until <= 0.0 {
        return Verdict::Skipped;
    }
    let ours = engine(&model, until);
    if difference(&ours, &fine, TIME, until).is_some() {
        // The reference may have missed an event between two steps, or rounding may decide what happens.
        let shorter = Pace { step: 0.02 * STEP, ..half };
        let nudges = [NUDGE, -NUDGE].map(|nudge| Pace { nudge, ..half });
        let close = Pace { near: VERY_NEAR, tolerance: 0.0, ..half };
        for pace in [Pace { wary: true, ..half }, shorter, nudges[0], nudges[1], close] {
            until = agreement(&refer(pace), &fine, until);
        }
    }
    let events = fine.rows.iter().filter(|row| row.time < until).count();
    if until <= 0.0 || until < end && events == 0 {
        return Verdict::Skipped;
    }
    let Some((_, first)) = difference(&ours, &fine, TIME, until) else { return Verdict::Same(events) };
    let mut story = format!("{text}\n{first} (compared up to {until})\n");
    for (who, rows) in [("engine", &ours.rows), ("reference", &fine.rows)] {
        let _ = writeln!(story, "{who}:");
        for row in rows.iter().filter(|row| row.time < until) {
            let _ = writeln!(story, "  {}", line(row));
        }
    }
    Verdict::Different(story)
}

/// Up to when two histories of the reference agree, and a little less, s: no event lies near that time. 0 if they do not.
fn agreement(other: &Story, fine: &Story, until: f64) -> f64 {
    let common = until.min(fine.until).min(other.until);
    let mut until = match difference(other, fine, TIME_OF_ITSELF, common) {
        None if common == until => return until,
        None => common,
        Some((time, _)) if time == f64::INFINITY => return 0.0,
        Some((time, _)) => time,
    };
    until -= MARGIN;
    for row in fine.rows.iter().rev() {
        if (row.time - until).abs() < MARGIN {
            until = row.time - MARGIN;
        }
    }
    until
}

fn line(row: &Row) -> String {
    let other = row.other.map_or(String::new(), |other| format!(" with {other}"));
    let modes = row.modes.as_ref().map_or(String::new(), |(from, to)| format!(" {from} -> {to}"));
    format!("{:.9} {} of {}{other}{modes}", row.time, row.label, row.agent)
}

/// The first difference: agents' own logs are compared, for the order of events of unrelated agents is free.
fn difference(ours: &Story, theirs: &Story, tolerance: f64, until: f64) -> Option<Difference> {
    let mut first: Option<Difference> = ours.error.clone().filter(|(time, _)| *time < until);
    let mut found = |time: f64, text: String| {
        if first.as_ref().is_none_or(|(before, _)| time < *before) {
            first = Some((time, text));
        }
    };
    let all = ours.rows.iter().chain(&theirs.rows);
    let agents: BTreeSet<usize> = all.flat_map(|row| [row.agent].into_iter().chain(row.other)).collect();
    for agent in agents {
        let own = |story: &Story| -> Vec<Row> {
            let concerns = |row: &&Row| row.time < until && (row.agent == agent || row.other == Some(agent));
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
    let to_the_end = ours.until <= until && theirs.until <= until;
    let numbers = |story: &Story| story.ends.iter().map(|(number, ..)| *number).collect::<Vec<_>>();
    if to_the_end && numbers(ours) != numbers(theirs) {
        found(f64::INFINITY, format!("who lives at the end: {:?} | {:?}", numbers(ours), numbers(theirs)));
    }
    for (a, b) in ours.ends.iter().zip(&theirs.ends).filter(|_| to_the_end) {
        let near = |(a, b): (&f64, &f64)| (a - b).abs() <= STATE * (1.0 + b.abs());
        if a.1 != b.1 || !a.2.iter().zip(&b.2).all(near) {
            found(f64::INFINITY, format!("an agent at the end: {a:?} | {b:?}"));
        }
    }
    first
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
fn engine(model: &Model, until: f64) -> Story {
    let mut writer = Writer { rows: Vec::new(), ends: Vec::new() };
    let mut time = 0.0;
    let mut run = |writer: &mut Writer| -> Result<(), Diagnostic> {
        let system = hyc::calculus::derive(model).map_err(|mut found| found.remove(0))?;
        let mut program = hyc::codegen::compile(system, Backend::Interpreter)?;
        program.run.until = Some(until);
        let limits = Limits { steps_max: 10_000_000, ..Limits::default() };
        let outcome = hyc::runtime::simulate(&program, &limits, &AtomicBool::new(false), writer);
        time = outcome.time;
        match outcome.end {
            End::Until => Ok(()),
            End::Error(found) => Err(*found),
            end => panic!("no model ends so: {end:?}"),
        }
    };
    let error = run(&mut writer).err();
    let error = error.map(|d| (time, format!("{}: {} {:?} {:?}", d.code, d.title, d.labels, d.notes)));
    Story { rows: writer.rows, ends: writer.ends, until, error }
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
    ends: Vec<Ending>,
}

impl Observer for Writer {
    fn event(&mut self, event: &Event<'_>) -> io::Result<()> {
        self.rows.push(Row {
            time: event.time,
            label: event.transition.into(),
            agent: event.agent.number,
            other: event.other.map(|other| other.number),
            modes: event.modes.map(|(from, to)| (from.into(), to.into())),
        });
        Ok(())
    }

    fn last(&mut self, last: &Last<'_>) -> io::Result<()> {
        let number = |cell: &Cell| match cell {
            Cell::Number(x) => *x,
            Cell::Bool(truth) => f64::from(u8::from(*truth)),
            Cell::Empty | Cell::Agent(_) => f64::NAN,
        };
        let values = last.states.iter().copied().chain(last.discretes.iter().map(number)).collect();
        self.ends.push((last.agent.number, last.mode.into(), values));
        Ok(())
    }
}
