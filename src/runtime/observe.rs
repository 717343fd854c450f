//! What a run tells whoever watches it. An observer changes nothing (rule 16).

use std::io;

use crate::base::{Diagnostic, Span, number_text};
pub use crate::codegen::trace::Compared;

/// An agent as outputs know it: one that has been there at t = 0 has a name of its own, the others are called by type and
/// number, `Car#17`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Who {
    /// Its number; no other agent of the run has it.
    pub number: usize,
    /// The number of its type.
    pub ty: usize,
}

impl Who {
    /// The number of the agent that only watches the run.
    pub const HIDDEN: usize = usize::MAX - 1;

    /// Whether outputs know it.
    pub fn is_visible(self) -> bool {
        self.number != Self::HIDDEN
    }
}

/// Told of a run as it proceeds, in the order of time. An `Err` ends the run (the disk is full, say).
pub trait Observer {
    /// A transition has fired: called for each of its rows of the event log.
    fn event(&mut self, event: &Event<'_>) -> io::Result<()>;
    /// A row of record number `record` of the run's settings.
    fn sample(&mut self, _record: usize, _row: &Row<'_>) -> io::Result<()> {
        Ok(())
    }
    /// Of the samples of this record, which is thinned out, those with odd numbers (counted from 0) have been given up.
    fn thinned(&mut self, _record: usize) -> io::Result<()> {
        Ok(())
    }
    /// The state of an agent at the end; agents come in order of their numbers.
    fn last(&mut self, _last: &Last<'_>) -> io::Result<()> {
        Ok(())
    }
    /// Now and then: how far the run has come.
    fn progress(&mut self, _progress: &Progress) -> io::Result<()> {
        Ok(())
    }
    /// Whether it wants to be told why transitions fire. Asked once, before the run.
    fn wants_reasons(&self) -> bool {
        false
    }
    /// Why a transition fires; comes before its event.
    fn explanation(&mut self, _explanation: &Explanation<'_>) -> io::Result<()> {
        Ok(())
    }
    /// A root that could be neither excluded nor isolated.
    fn undecided(&mut self, _undecided: &Undecided) -> io::Result<()> {
        Ok(())
    }
}

/// Why a transition fired.
#[derive(Clone, Debug, PartialEq)]
pub struct Explanation<'a> {
    /// s.
    pub time: f64,
    /// Number of the micro-step in its instant, from 0.
    pub micro: usize,
    /// `Car.left`, `Bump.pair`.
    pub transition: &'a str,
    /// The agent; in an interaction the first participant.
    pub agent: Who,
    /// The other participant of an interaction.
    pub other: Option<Who>,
    /// Where the transition stands.
    pub span: Span,
    /// What made it fire.
    pub cause: Cause,
    /// The comparisons of its guard; of very many those that tell most.
    pub shown: Vec<ShownComparison>,
}

/// What made a transition fire.
#[derive(Clone, Debug, PartialEq)]
pub enum Cause {
    /// The flow, or the time, took its guard to where it is true.
    Flow,
    /// Its guard was true when its mode was entered (or at t = 0).
    Entry,
    /// Its delay was over.
    After {
        /// s.
        delay: f64,
    },
    /// Its period had passed once more.
    Every {
        /// s.
        period: f64,
    },
    /// The time that was drawn for a pair.
    Chance,
    /// A message.
    Message {
        /// From whom.
        sender: Who,
    },
    /// What these transitions wrote in the micro-step before made its guard true.
    Write {
        /// Their labels.
        by: Vec<String>,
    },
}

/// A comparison just before an instant and at it.
#[derive(Clone, Debug, PartialEq)]
pub struct ShownComparison {
    /// Just before; none where that says nothing (a delay was over, a mode was entered).
    pub before: Option<Compared>,
    /// On the state that the transition read.
    pub now: Compared,
}

/// A root that could be neither excluded nor isolated.
#[derive(Clone, Debug, PartialEq)]
pub struct Undecided {
    /// The stretch of time in question, s.
    pub from: f64,
    /// s.
    pub to: f64,
    /// The label of the transition; none for an invariant or an assert.
    pub transition: Option<String>,
    /// The agent; in an interaction the first participant.
    pub agent: Who,
    /// The other participant of an interaction.
    pub other: Option<Who>,
    /// Where the transition or the claim stands.
    pub span: Span,
    /// The comparison at both ends of the stretch.
    pub ends: [Compared; 2],
    /// Why.
    pub why: WhyUndecided,
}

/// Why a root was left undecided.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WhyUndecided {
    /// The comparison comes within rounding of its boundary and no further: it fires there as if it touched it.
    Touch,
    /// The search was given up at the limit of pieces: the comparison counts as unchanged over the stretch.
    TooManyPieces {
        /// `max_pieces`.
        limit: u32,
    },
}

/// One row of the event log.
#[derive(Clone, Debug, PartialEq)]
pub struct Event<'a> {
    /// s.
    pub time: f64,
    /// Number of the micro-step in its instant, from 0.
    pub micro: usize,
    /// Its number among the rows of one firing, from 0: there is one for each mode that changes, and one if none does.
    pub row: usize,
    /// `Car.left`, `Bump.pair`.
    pub transition: &'a str,
    /// The agent (in an interaction: the first participant, or the one whose mode changes).
    pub agent: Who,
    /// The other participant of an interaction; by an `on` the sender of the message.
    pub other: Option<Who>,
    /// The mode it leaves and the one it enters, as paths; none where no mode changes.
    pub modes: Option<(&'a str, &'a str)>,
}

/// One row of a trajectory.
#[derive(Clone, Debug, PartialEq)]
pub struct Row<'a> {
    /// s.
    pub time: f64,
    /// Number of micro-steps executed at this instant before the row.
    pub micro: usize,
    /// The agent.
    pub agent: Who,
    /// The path of its mode; empty for an agent without modes.
    pub mode: &'a str,
    /// One cell a column of the record.
    pub cells: &'a [Cell],
}

/// One value of a trajectory, in the declared unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cell {
    /// The agent's type has no such variable (or not in this mode).
    Empty,
    /// A number.
    Number(f64),
    /// True or false.
    Bool(bool),
    /// An agent, or `none`.
    Agent(Option<Who>),
}

/// The state of an agent at the end of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Last<'a> {
    /// s.
    pub time: f64,
    /// The agent.
    pub agent: Who,
    /// The number of its type.
    pub ty: usize,
    /// The path of its mode.
    pub mode: &'a str,
    /// States, in declared units.
    pub states: &'a [f64],
    /// Discrete variables, in declared units.
    pub discretes: &'a [Cell],
}

/// How far a run has come.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// The smallest clock, s.
    pub time: f64,
    /// The end of the run, s; infinite if none is set.
    pub until: f64,
    /// How many agents there are.
    pub agents: u64,
    /// Events so far.
    pub events: u64,
    /// Accepted steps so far.
    pub steps: u64,
}

/// How a run ended and what it took.
#[derive(Debug)]
pub struct Outcome {
    /// How it ended.
    pub end: End,
    /// When it ended, s.
    pub time: f64,
    /// Counts.
    pub stats: Stats,
    /// Asserts that were false, in the order in which they first were.
    pub false_asserts: Vec<FalseAssert>,
    /// What the properties came to, in order of declaration.
    pub verdicts: Vec<Verdict>,
    /// Remarks for the user (two interactions on one agent in one instant, ...), each once.
    pub warnings: Vec<Diagnostic>,
}

/// What a property came to.
#[derive(Clone, Debug, PartialEq)]
pub struct Verdict {
    /// Its name.
    pub name: String,
    /// Where it is named.
    pub span: Span,
    /// Whether it holds.
    pub holds: bool,
    /// By how much: the worst margin, or the best of what has to happen once, SI; infinite where nothing is compared.
    pub margin: f64,
    /// When that was, s; none if the run did not come to its window.
    pub time: Option<f64>,
    /// What quantifiers bind there: the name, and the agent's.
    pub agents: Vec<(String, String)>,
}

impl Verdict {
    /// `margin 0.5 at t = 3 s for c = cars[2]`
    pub fn told(&self) -> String {
        let Some(time) = self.time else { return "its window was not reached".into() };
        let agents: Vec<String> =
            self.agents.iter().map(|(name, agent)| format!("{name} = {agent}")).collect();
        let agents = if agents.is_empty() { String::new() } else { format!(" for {}", agents.join(", ")) };
        let margin = if self.margin.is_finite() {
            format!("margin {} ", number_text(self.margin))
        } else {
            String::new()
        };
        format!("{margin}at t = {} s{agents}", number_text(time))
    }
}

/// How a run ended.
#[derive(Debug)]
pub enum End {
    /// At `until`.
    Until,
    /// By a `stop` action.
    Stop {
        /// The text given with it.
        reason: Option<String>,
        /// By which agent, and the label of its transition or the path of its mode; none: by `stop when`.
        by: Option<(Who, String)>,
    },
    /// The user interrupted it.
    Interrupted,
    /// In error.
    Error(Box<Diagnostic>),
    /// What watched it failed.
    Output(io::Error),
}

/// An assert that was false.
#[derive(Clone, Debug)]
pub struct FalseAssert {
    /// Where it stands.
    pub span: Span,
    /// The text given with it.
    pub message: Option<String>,
    /// When it was first false, s.
    pub time: f64,
    /// For which agent.
    pub agent: Who,
    /// The path of the mode it was in.
    pub mode: String,
    /// What it compared.
    pub compared: Vec<Compared>,
    /// How often it became false, over all agents.
    pub count: u64,
}

/// Counts of a run. The same for the same model, seed and settings.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Stats {
    /// Events: how often transitions have fired, the sum of `transitions`. One may have several rows in the event log.
    pub events: u64,
    /// How many threads have worked.
    pub threads: u64,
    /// Accepted steps (a coupled group's step counts once for each member).
    pub steps: u64,
    /// Rejected steps.
    pub rejected: u64,
    /// Beginnings of an integration, at t = 0 and after each restart (a coupled group counts once for each member).
    pub starts: u64,
    /// Evaluations of right-hand sides, one an agent.
    pub rhs_evaluations: u64,
    /// Evaluations of Jacobians, one an agent: for stiff steps, and to tell whether a flow is stiff.
    pub jacobians: u64,
    /// Evaluations of guard expressions at a point.
    pub guard_evaluations: u64,
    /// Evaluations of guard expressions over an interval.
    pub guard_ranges: u64,
    /// Places that agents have had: as many as were alive at a time, for they are used again.
    pub places: u64,
    /// Places that guards and their comparisons have had.
    pub guard_places: u64,
    /// Guard instances over pairs (or larger tuples) that exist.
    pub pairs_listed: u64,
    /// Roots that could be neither excluded nor isolated.
    pub undecided_roots: u64,
    /// Segments that an event cut.
    pub cuts: u64,
    /// Guard polynomials (18) and (28) of the 2004 algorithms.
    pub guard_polynomials: u64,
    /// Arithmetic operations: of right-hand sides and guards as their tapes have them (a bound over an interval as two,
    /// a function such as `sin` as one), of the steps and of the guard polynomials by a count for each.
    pub operations: u64,
    /// What certified detection found on the same trajectories and a 2004 algorithm did not; none where nothing was
    /// compared.
    pub misses: Option<Misses>,
    /// Per agent type: name, agents, steps, events.
    pub types: Vec<TypeStats>,
    /// The agents that took most accepted steps, and how many.
    pub slowest: Vec<(Who, u64)>,
    /// The agents with most events, their own and those of interactions, and how many.
    pub busiest: Vec<(Who, u64)>,
    /// Per transition: label, firings.
    pub transitions: Vec<(String, u64)>,
    /// Per method of integration: its name, accepted steps.
    pub methods: Vec<(String, u64)>,
}

/// Events that a 2004 algorithm passes over, found by certified detection on the same trajectories.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Misses {
    /// Not executed at all.
    pub missed: u64,
    /// Executed more than 1e-3 s after their time.
    pub late: u64,
    /// The longest delay of one that was executed, s.
    pub latest: f64,
}

/// Counts of one agent type.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TypeStats {
    /// The type's name.
    pub name: String,
    /// How many agents there are at the end.
    pub agents: u64,
    /// How many have been created during the run.
    pub created: u64,
    /// How many have been destroyed.
    pub destroyed: u64,
    /// Their accepted steps.
    pub steps: u64,
    /// How often their transitions have fired (interactions count for the first participant's type).
    pub events: u64,
}
