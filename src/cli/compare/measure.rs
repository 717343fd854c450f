//! One run of a program under one algorithm: what happened, and what it cost.

use std::io;
use std::sync::atomic::AtomicBool;

use super::processor::processor_seconds;
use crate::base::Diagnostic;
use crate::codegen::program::Program;
use crate::model::ir::Integrator;
use crate::runtime::limits::Limits;
use crate::runtime::observe::{End, Event, Observer, Outcome, Row, Stats, Who};
use crate::runtime::paper::{Algorithm, Paper};
use crate::runtime::simulate_by;

/// An event, to be compared with that of another run.
#[derive(Clone, Debug, PartialEq)]
pub struct Logged {
    /// s.
    pub time: f64,
    /// `Car.left`.
    pub transition: String,
    /// The agent.
    pub agent: Who,
    /// The other participant of an interaction.
    pub other: Option<Who>,
}

/// A row of a recorded trajectory: agent, time, the cells that are numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Recorded {
    /// s.
    pub time: f64,
    /// The agent.
    pub agent: Who,
    /// What is recorded; NaN for what is no number.
    pub cells: Vec<f64>,
}

/// What a run came to.
#[derive(Clone, Debug, Default)]
pub struct Measured {
    /// Firings of transitions, in order of time.
    pub events: Vec<Logged>,
    /// The rows that the program's records ask for.
    pub rows: Vec<Recorded>,
    /// Counts.
    pub stats: Stats,
    /// Processor time of the run without compilation, s: the least of several runs, if it is short.
    pub seconds: f64,
}

/// Runs are repeated until they have taken this long together, s, but at most [`REPEATS`] times.
const LONG_ENOUGH: f64 = 0.05;
const REPEATS: usize = 3;

/// Runs a program under an algorithm: once with its misses counted, if `audit` says so, then to be timed. The published
/// algorithms integrate by Adams' method, `masim` by that of the program.
///
/// Fails with what ended the run, if that is an error; one that is interrupted is measured up to there.
pub fn measure(
    program: &mut Program,
    algorithm: Algorithm,
    tolerance: f64,
    limits: &Limits,
    interrupt: &AtomicBool,
    audit: bool,
) -> Result<Measured, Box<Diagnostic>> {
    let own = (program.run.tolerance, program.run.integrator);
    program.run.tolerance = tolerance;
    if !matches!(algorithm, Algorithm::Masim(_)) {
        program.run.integrator = Integrator::Adams;
    }
    let measured = run_and_time(program, with_audit(algorithm, audit), limits, interrupt);
    (program.run.tolerance, program.run.integrator) = own;
    measured
}

fn run_and_time(
    program: &Program,
    algorithm: Algorithm,
    limits: &Limits,
    interrupt: &AtomicBool,
) -> Result<Measured, Box<Diagnostic>> {
    let mut measured = Measured::default();
    let begun = processor_seconds();
    measured.stats = run(program, algorithm, limits, interrupt, &mut measured)?.stats;
    let taken = processor_seconds() - begun;
    // The audit's own work is not the algorithm's.
    let (mut least, mut total) =
        if measured.stats.misses.is_some() { (f64::INFINITY, 0.0) } else { (taken, taken) };
    for _ in 0..REPEATS {
        if total > LONG_ENOUGH {
            break;
        }
        let begun = processor_seconds();
        run(program, with_audit(algorithm, false), limits, interrupt, &mut Nobody)?;
        let taken = processor_seconds() - begun;
        (least, total) = (least.min(taken), total + taken);
    }
    measured.seconds = least;
    Ok(measured)
}

fn with_audit(algorithm: Algorithm, audit: bool) -> Algorithm {
    match algorithm {
        Algorithm::Masim(form) => Algorithm::Masim(form),
        Algorithm::Masim2004(paper) => Algorithm::Masim2004(Paper { audit, ..paper }),
        Algorithm::Sasim2004(paper) => Algorithm::Sasim2004(Paper { audit, ..paper }),
    }
}

fn run(
    program: &Program,
    algorithm: Algorithm,
    limits: &Limits,
    interrupt: &AtomicBool,
    observer: &mut dyn Observer,
) -> Result<Outcome, Box<Diagnostic>> {
    let outcome = simulate_by(algorithm, program, limits, interrupt, observer);
    match outcome.end {
        End::Error(diagnostic) => Err(diagnostic),
        End::Until | End::Stop { .. } | End::Interrupted | End::Output(_) => Ok(outcome),
    }
}

/// How many events from the first on are those of the reference, per transition and agents, with times that differ by no
/// more than `within`, s: the system may be chaotic, and beyond the first that has moved by more nothing is compared.
pub fn agreement(events: &[Logged], reference: &[Logged], within: f64) -> usize {
    let same = |(event, expected): &(&Logged, &Logged)| {
        (event.time - expected.time).abs() <= within
            && (&event.transition, event.agent, event.other)
                == (&expected.transition, expected.agent, expected.other)
    };
    events.iter().zip(reference).take_while(same).count()
}

impl Observer for Measured {
    fn event(&mut self, event: &Event<'_>) -> io::Result<()> {
        let Event { time, agent, other, .. } = *event;
        if event.row == 0 {
            self.events.push(Logged { time, transition: event.transition.into(), agent, other });
        }
        Ok(())
    }
    fn sample(&mut self, _record: usize, row: &Row<'_>) -> io::Result<()> {
        use crate::runtime::observe::Cell;
        let number = |cell: &Cell| match *cell {
            Cell::Number(value) => value,
            Cell::Bool(_) | Cell::Agent(_) | Cell::Empty => f64::NAN,
        };
        let cells = row.cells.iter().map(number).collect();
        self.rows.push(Recorded { time: row.time, agent: row.agent, cells });
        Ok(())
    }
}

/// An observer that keeps nothing.
struct Nobody;

impl Observer for Nobody {
    fn event(&mut self, _: &Event<'_>) -> io::Result<()> {
        Ok(())
    }
}
