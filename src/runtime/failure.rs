//! Why a run stops in error: a variant for each reason, with what a person needs to find the cause.

use crate::base::{Diagnostic, Span, number_text};
use crate::codegen::trace::{Blame, Compared, Valued};
use crate::runtime::population::Agents;
use crate::runtime::solve::integrate::Attempt;

/// A run's end in error, or by its observer.
#[derive(Debug)]
pub enum Failure {
    /// The model does what it may not.
    Model(Box<Diagnostic>),
    /// The observer could not take what it was told.
    Output(std::io::Error),
}

impl From<std::io::Error> for Failure {
    fn from(error: std::io::Error) -> Self {
        Failure::Output(error)
    }
}

impl From<Reason> for Failure {
    fn from(reason: Reason) -> Self {
        Failure::Model(Box::new(reason.diagnostic()))
    }
}

/// Where in a run something happened.
#[derive(Clone, Debug)]
pub struct Place {
    /// s.
    pub time: f64,
    /// The agent's path.
    pub agent: String,
    /// The path of its mode; empty for none.
    pub mode: String,
    /// Its states and discrete variables by name, SI.
    pub values: String,
    /// Its last steps, oldest first.
    pub attempts: Vec<Attempt>,
}

impl Place {
    /// The place of an agent with these states, after these steps.
    pub fn new(
        agents: &Agents<'_>,
        agent: usize,
        time: f64,
        states: &[f64],
        attempts: impl IntoIterator<Item = Attempt>,
    ) -> Self {
        let row = &agents.agents[agent];
        let system = &agents.program.types[row.ty];
        let named = system
            .states
            .iter()
            .zip(states)
            .map(|(column, value)| format!("{} = {}", column.name, number_text(*value)));
        let first = system.layout.discrete(0);
        let discretes = system.discretes.iter().zip(&row.aux[first..]);
        let discretes = discretes.map(|(column, value)| format!("{} = {}", column.name, number_text(*value)));
        let values = named.chain(discretes).collect::<Vec<_>>().join(", ");
        let attempts = attempts.into_iter().collect();
        Self { time, agent: agents.name(agent), mode: agents.mode(agent).path.clone(), values, attempts }
    }

    fn note(&self) -> String {
        let mode = if self.mode.is_empty() { String::new() } else { format!(" in mode {}", self.mode) };
        let values = if self.values.is_empty() { String::new() } else { format!(": {}", self.values) };
        format!("at t = {}: {}{mode}{values}", number_text(self.time), self.agent)
    }

    /// The diagnostic with the place, the agent's values and its last steps.
    pub fn add_to(&self, mut diagnostic: Diagnostic) -> Diagnostic {
        diagnostic = diagnostic.note(self.note());
        for (k, attempt) in self.attempts.iter().enumerate() {
            let who = if k == 0 { format!("the last steps of {}: ", self.agent) } else { String::new() };
            diagnostic = diagnostic.note(format!("{who}{}", step(attempt)));
        }
        diagnostic
    }
}

/// A step that was tried, in words.
fn step(attempt: &Attempt) -> String {
    let Attempt { t, h, ratio, accepted, refused } = attempt;
    let last = if ratio.is_nan() {
        "for a number in it is not finite".to_string()
    } else {
        format!("error {ratio:.2e} of what is allowed")
    };
    let outcome = match (accepted, refused) {
        (true, 0) => format!("accepted, {last}"),
        (true, tries) => format!("accepted after {tries} longer ones, {last}"),
        (false, 0 | 1) => format!("refused, {last}"),
        (false, tries) => format!("refused after {} longer ones, {last}", tries - 1),
    };
    format!("from t = {} by {h:.3e} s: {outcome}", number_text(*t))
}

/// The diagnostic with the numbers of some comparisons.
fn with_compared(mut diagnostic: Diagnostic, compared: &[Compared]) -> Diagnostic {
    for compared in compared {
        diagnostic = diagnostic.note(compared.numbers());
    }
    diagnostic
}

/// The diagnostic with what made a number that is not finite.
pub fn with_blame(diagnostic: Diagnostic, blame: Option<&Blame>) -> Diagnostic {
    let Some(Blame { span, made, operands }) = blame else { return diagnostic };
    let operands =
        operands.iter().map(|Valued { text, value }| format!("`{text}` = {}", number_text(*value)));
    let operands = operands.collect::<Vec<_>>().join(", ");
    let of = if operands.is_empty() { String::new() } else { format!(", with {operands}") };
    let labelled = match span {
        Some(span) => diagnostic.label(*span, format!("this is {}", made.value)),
        None => diagnostic,
    };
    labelled.note(format!("`{}` is {}{of}", made.text, made.value))
}

/// Why a run stops in error.
#[derive(Clone, Debug)]
pub enum Reason {
    /// Rule 8.
    InvariantFalse {
        /// Where.
        place: Place,
        /// The text given with it.
        message: Option<String>,
        /// What it compares.
        compared: Vec<Compared>,
        /// The invariant.
        span: Span,
    },
    /// A flow gives no finite number.
    FlowNotFinite {
        /// Where.
        place: Place,
        /// Which state.
        state: String,
        /// What made it so, and when, s.
        made: Option<(f64, Blame)>,
        /// Its equation.
        span: Span,
    },
    /// An action gives no finite number.
    ActionNotFinite {
        /// Where.
        place: Place,
        /// Which variable.
        variable: String,
        /// What it would have become.
        value: f64,
        /// What made it so.
        blame: Option<Blame>,
        /// The assignment.
        span: Span,
    },
    /// The accuracy asked for needs steps below the resolution of time.
    StepUnderflow {
        /// Where.
        place: Place,
        /// Which state is hardest.
        state: String,
        /// Its rate.
        rate: f64,
        /// The largest magnitude of an eigenvalue of the flow's Jacobian, 1/s.
        fastest: f64,
        /// Its equation.
        span: Span,
    },
    /// Rule 4: one transition fires too often in one instant.
    MicrostepLimit {
        /// Where.
        place: Place,
        /// The limit.
        limit: u32,
        /// The labels of the transitions that repeat.
        cycle: Vec<String>,
        /// What its guard compares.
        compared: Vec<Compared>,
        /// The transition.
        span: Span,
    },
    /// Rule 12.
    Zeno {
        /// Where.
        place: Place,
        /// The labels of the transitions that repeat.
        cycle: Vec<String>,
        /// How many times.
        count: u32,
        /// Where the times of the events converge to, s.
        limit_time: f64,
        /// What its guard compares.
        compared: Vec<Compared>,
        /// The transition.
        span: Span,
    },
    /// A flow switches its branch back and forth without time going on.
    ChatteringKink {
        /// Where.
        place: Place,
        /// How many times.
        count: u32,
        /// The rates on either side, by name.
        rates: [String; 2],
        /// The operator.
        span: Span,
    },
    /// `max_steps`.
    StepLimit {
        /// Where the smallest clock is.
        place: Place,
        /// The limit.
        limit: u64,
    },
    /// `max_guards`.
    GuardLimit {
        /// How many there would be.
        needed: u128,
        /// The limit.
        limit: usize,
    },
    /// A delay or period that is no length of time.
    BadDelay {
        /// Where.
        place: Place,
        /// Its value, s.
        value: f64,
        /// What made it so, if it is not finite.
        blame: Option<Blame>,
        /// The transition.
        span: Span,
    },
    /// A hazard of a pair that is no number from 0 on.
    BadHazard {
        /// Where.
        place: Place,
        /// Of which transition.
        label: String,
        /// Its value, 1/s.
        hazard: f64,
        /// What made it so, if it is not finite.
        blame: Option<Blame>,
        /// The transition.
        span: Span,
    },
    /// A hazard that is negative.
    NegativeRate {
        /// Where.
        place: Place,
        /// Of which transition.
        label: String,
        /// What is compared.
        compared: Vec<Compared>,
        /// The transition.
        span: Span,
    },
    /// A draw from a distribution whose parameter is out of range.
    BadDraw {
        /// Where.
        place: Place,
        /// Which parameter.
        parameter: String,
        /// What it has to be.
        needs: &'static str,
        /// Its value, SI.
        value: f64,
        /// What made it so, if it is not finite.
        blame: Option<Blame>,
        /// The action.
        span: Span,
    },
    /// A priority that is not a number, so that it orders nothing.
    BadPriority {
        /// Where.
        place: Place,
        /// What made it so.
        blame: Option<Blame>,
        /// The transition.
        span: Span,
    },
    /// Nothing can happen any more, and no end is set.
    NeverEnds {
        /// When, s.
        time: f64,
        /// The end that is set, s; infinite if there is none.
        until: f64,
    },
}

impl Reason {
    /// As a message to a person.
    pub fn diagnostic(&self) -> Diagnostic {
        match self {
            Reason::InvariantFalse { place, message, compared, span } => {
                let diagnostic = Diagnostic::error("HY0501", "an invariant became false")
                    .label(*span, message.clone().unwrap_or_else(|| "false".into()));
                place
                    .add_to(with_compared(diagnostic, compared))
                    .help("add a transition that leaves the mode, or acts, where the invariant ends")
            }
            Reason::FlowNotFinite { place, state, made, span } => {
                let diagnostic =
                    Diagnostic::error("HY0502", format!("the rate of `{state}` is not a finite number"))
                        .label(*span, "this equation");
                let blamed = with_blame(diagnostic, made.as_ref().map(|(_, blame)| blame));
                let blamed = match made {
                    Some((time, _)) if *time != place.time => blamed.note(format!("that is so at t = {}", number_text(*time))),
                    Some(_) | None => blamed,
                };
                place
                    .add_to(blamed)
                    .help("guard the place where it is not defined with a transition, or clamp the argument")
            }
            Reason::ActionNotFinite { place, variable, value, blame, span } => {
                let diagnostic =
                    Diagnostic::error("HY0503", format!("an action gives `{variable}` the value {value}"))
                        .label(*span, "this assignment");
                place
                    .add_to(with_blame(diagnostic, blame.as_ref()))
                    .help("check the operands: a division by zero, a root or logarithm of a negative number?")
            }
            Reason::StepUnderflow { place, state, rate, fastest, span } => {
                let diagnostic =
                    Diagnostic::error("HY0504", format!("the step for `{state}` fell below the resolution of time"))
                        .label(*span, "this equation is the hardest");
                place
                    .add_to(diagnostic)
                    .note(format!("`{state}'` is {rate:.3e} here; the fastest rate of the flow's Jacobian is {fastest:.3e} 1/s"))
                    .help("a solution that goes to infinity? a tolerance that is too small? a stiff mode?")
            }
            Reason::MicrostepLimit { place, limit, cycle, compared, span } => {
                let diagnostic =
                    Diagnostic::error("HY0505", format!("a transition fired {limit} times in one instant"))
                        .label(*span, "this transition");
                place
                    .add_to(with_compared(diagnostic, compared))
                    .note(format!("the cycle: {}", cycle.join(", ")))
                    .help("make a guard of the cycle false by its action, or raise the limit: `--limit max_microsteps=N`")
            }
            Reason::Zeno { place, cycle, count, limit_time, compared, span } => {
                let title = format!("Zeno behaviour: {count} events in a time too short to resolve");
                let diagnostic = Diagnostic::error("HY0506", title).label(*span, "this transition");
                place
                    .add_to(with_compared(diagnostic, compared))
                    .note(format!("the cycle: {}", cycle.join(", ")))
                    .note(format!("the times of the events converge to about t = {}", number_text(*limit_time)))
                    .help("add a mode for what comes after (a ball at rest), or hysteresis between the guards; the limit is called `zeno_events`")
            }
            Reason::ChatteringKink { place, count, rates, span } => {
                let title = format!("chattering: a flow switched its branch {count} times in no time");
                let diagnostic = Diagnostic::error("HY0507", title)
                    .label(*span, "the flows on both sides push back to where this changes");
                place
                    .add_to(diagnostic)
                    .note(format!("on one side {}", rates[0]))
                    .note(format!("on the other {}", rates[1]))
                    .help("write a mode for the sliding motion, or replace the jump by a steep but continuous function")
            }
            Reason::StepLimit { place, limit } => {
                place.add_to(Diagnostic::error("HY0508", format!("more than {limit} steps"))).help(
                    "a larger tolerance or an earlier `until` needs fewer steps; or raise the limit: `--limit max_steps=N`",
                )
            }
            Reason::GuardLimit { needed, limit } => {
                Diagnostic::error("HY0509", format!("{needed} guard instances are more than {limit}"))
                    .note("every pair of agents of an interaction or a quantifier counts")
                    .help("use fewer agents, or raise the limit: `--limit max_guards=N`")
            }
            Reason::BadDelay { place, value, blame, span } => {
                let diagnostic = Diagnostic::error("HY0510", format!("a delay or period of {value} s"))
                    .label(*span, "here");
                place
                    .add_to(with_blame(diagnostic, blame.as_ref()))
                    .help("a delay must be finite and at least 0, a period finite and at least 1e-12 s")
            }
            Reason::BadHazard { place, label, hazard, blame, span } => {
                let title = format!("the rate of `{label}` became {hazard}");
                let diagnostic = Diagnostic::error("HY0514", title).label(*span, "this transition");
                place
                    .add_to(with_blame(diagnostic, blame.as_ref()))
                    .help("a rate is a number from 0 on: say when it counts, `rate ... when ...`, or clamp it: `max(..., 0)`")
            }
            Reason::NegativeRate { place, label, compared, span } => {
                let title = format!("the rate of `{label}` became negative");
                let diagnostic = Diagnostic::error("HY0514", title).label(*span, "this transition");
                place
                    .add_to(with_compared(diagnostic, compared))
                    .help("say when the rate counts, `rate ... when ...`, or clamp it: `max(..., 0)`")
            }
            Reason::BadDraw { place, parameter, needs, value, blame, span } => {
                let title = format!("{parameter} is {}, and has to be {needs}", number_text(*value));
                let diagnostic = Diagnostic::error("HY0513", title).label(*span, "this draw");
                place
                    .add_to(with_blame(diagnostic, blame.as_ref().filter(|_| !value.is_finite())))
                    .help("guard the draw with an `if`, or clamp the parameter: `max(sd, 0)`")
            }
            Reason::BadPriority { place, blame, span } => {
                let diagnostic = Diagnostic::error("HY0512", "a priority that is not a number")
                    .label(*span, "of this transition");
                place
                    .add_to(with_blame(diagnostic, blame.as_ref()))
                    .help("check the operands: a division of zero by zero, a root or logarithm of a negative number?")
            }
            Reason::NeverEnds { time, until } if until.is_finite() => {
                Diagnostic::error("HY0511", "the run is longer than it can be followed")
                    .note(format!("at t = {}, of {}", number_text(*time), number_text(*until)))
                    .help("instants so late lie too far from one another: write a smaller `until`, or take a larger unit of time")
            }
            Reason::NeverEnds { time, .. } => {
                Diagnostic::error("HY0511", "nothing can happen any more, and the run has no end")
                    .note(format!("at t = {time}"))
                    .help("write `until` in `run { }` or pass --until")
            }
        }
    }
}

/// A warning: two interactions want the same agent in one instant (rule 5).
pub fn contested(time: f64, agent: &str, first: (&str, Span), second: (&str, Span)) -> Diagnostic {
    Diagnostic::warning("HY0520", "two interactions on one agent in one instant")
        .label(second.1, format!("`{}` was tested again after the other", second.0))
        .label(first.1, format!("`{}` went first", first.0))
        .note(format!("first at t = {time}, {agent}; said once"))
        .help("rule 5: they go in the order of declaration, then of the agents' numbers")
}
