//! From a program to what happens: events and samples, told to an observer.
//!
//! In: a `Program`, limits, a flag that interrupts. Out: an [`observe::Outcome`]; on the way, everything that happens, in
//! order of time. Promised: the same bytes for the same program, on either back end.
//!
//! # The rules of time and events
//!
//! Numbered as in the language reference (`docs/LANGUAGE.md`), each with its place here; the tests of rule N are
//! `rule_NN_...` in `tests/it/rules/`.
//!
//! | rule | in a sentence | where |
//! |---|---|---|
//! | 1 state | states flow, discretes stay, lets follow, links refer | `population` |
//! | 2 arming | a guard fires at the first instant it is armed and true; firing disarms, being false arms | `arm`, `truth` |
//! | 3 the instant | the infimum of the times at which the condition is true; on its boundary the rates decide | `solve::roots`, `branches`, `arm` |
//! | 4 micro-steps | one instant is a sequence of micro-steps, each on the state before it | `instant`, `gather`, `route` |
//! | 5 who may write | agents write themselves, interactions their participants | `act`, `guards` |
//! | 6 t = 0 | locks, groups, entry actions, arming, micro-steps, claims | `masim` |
//! | 7 after a reset | only what a write concerns restarts | `act` |
//! | 8 claims | a false invariant ends the run, a false assert is reported | `instant` |
//! | 9 events | what is emitted is heard in the next micro-step, one message an agent, in the order of the senders | `mail`, `hear` |
//! | 11 time | `after` and `every` count from entry, as products; hazards are integrated with the flow | `arm`, `gather`, `hazard` |
//! | 12 end | `until`, `stop`, errors; the state of all at that time | `masim`, `repetition` |
//! | 13 coupling | who read each other's states in their flows step together, a follower after its leader | `groups`, `leaders` |
//! | 14 reads across agents | a write wakes the guards that read it, and no others | `arm` |
//! | 15 kinks | a step never spans a surface at which a branch of the flow changes | `advance` |
//! | 16 output | recording changes nothing | `record` |
//!
//! # The engine
//!
//! `masim` is the loop: certify what the smallest clock allows, write samples, execute the earliest instant, else
//! advance the group that lags most. `certify` excludes or isolates roots on the agents' dense output, or puts a
//! comparison to sleep by an enclosure of the flows (`enclose`).
//!
//! `windows` runs that loop for one window of time after another, the fast form: pairs are listed when they are near (`near_pairs`,
//! `grid`, `reach`), comparisons sleep beyond the window (`sleep`), and agents that nothing can happen to run ahead in lanes
//! (`hot`, `cold`, `herd`, `leap`).

mod solve;
pub mod limits;
pub mod paper;
pub mod observe;
mod leap;
mod tracks;
mod agenda;
mod crew;
mod stretch;
mod herd;
mod survey;
mod cold;
mod ahead;
mod route;
mod inputs;
mod population;
mod present;
mod exposed;
mod groups;
mod fold;
mod definition;
mod noticed;
mod candidates;
mod zeros;
mod atom_state;
mod guards;
mod truth;
mod flow_rates;
mod detect;
mod branches;
mod enclose;
mod reach;
mod grid;
mod comparisons;
mod notes;
mod flow;
mod failure;
mod fate;
mod kinks;
mod counts;
mod advance;
mod stiffness;
mod repetition;
mod mail;
mod record;
mod most;
mod neighbours;
mod robustness;
mod signal;
mod margins;
mod lookout;
mod verdicts;
mod engine;
mod leaders;
mod point;
mod asked;
mod nominate;
mod seats;
mod lives;
mod act;
mod send;
mod arm;
mod exposure;
mod hazard;
mod ways;
mod near_pairs;
mod sleep;
mod scopes;
mod foresee;
mod hot;
mod hear;
mod links;
mod monitors;
mod instant;
mod certify;
mod explain;
mod gather;
mod masim;
mod windows;
mod watch;
mod audit;
mod clocks;
mod masim_2004;
mod sasim_2004;

use std::sync::atomic::AtomicBool;

use crate::codegen::program::Program;
use clocks::Clocks;
pub use clocks::takes as published_take;
use engine::Engine;
use failure::Failure;
use groups::Coupling;
pub use limits::Limits;
use observe::{End, Observer, Outcome, Stats};
pub use paper::{Algorithm, Form};

/// Runs a program and tells the observer what happens.
///
/// The run goes on until the program's end, a `stop`, an error, or until `interrupt` is set from another thread. What
/// had been computed until then has been told to the observer in every case.
pub fn simulate(
    program: &Program,
    limits: &Limits,
    interrupt: &AtomicBool,
    observer: &mut dyn Observer,
) -> Outcome {
    simulate_by(Algorithm::default(), program, limits, interrupt, observer)
}

/// The same by another algorithm.
pub fn simulate_by(
    algorithm: Algorithm,
    program: &Program,
    limits: &Limits,
    interrupt: &AtomicBool,
    observer: &mut dyn Observer,
) -> Outcome {
    let forms = (algorithm.form(), coupling(algorithm));
    let mut engine = match Engine::new(program, forms, limits, interrupt, observer) {
        Ok(engine) => engine,
        Err(failure) => return stillborn(failure),
    };
    let (mut clocks, end) = match algorithm {
        Algorithm::Masim(form) => {
            let end = match form {
                Form::Fast => engine.run_in_windows(),
                Form::Plain => engine.run(),
            };
            let end = last_words(&mut engine, end);
            return engine.outcome(end);
        }
        Algorithm::Masim2004(paper) => {
            let mut clocks = Clocks::new(engine, paper);
            let end = clocks.masim();
            (clocks, end)
        }
        Algorithm::Sasim2004(paper) => {
            let mut clocks = Clocks::new(engine, paper);
            let end = clocks.sasim();
            (clocks, end)
        }
    };
    let end = last_words(&mut clocks.engine, end);
    clocks.outcome(end)
}

/// Who shares a clock.
fn coupling(algorithm: Algorithm) -> Coupling {
    match algorithm {
        Algorithm::Masim(_) => Coupling::Mutual,
        Algorithm::Masim2004(_) => Coupling::Connected,
        Algorithm::Sasim2004(_) => Coupling::Together,
    }
}

/// Tells the observer the last state of every agent.
fn last_words(engine: &mut Engine<'_, '_>, end: Result<End, Failure>) -> End {
    if let Ok(End::Until | End::Stop { .. }) = end {
        engine.watch_now();
    }
    let end = end.unwrap_or_else(end_of);
    engine.record_end().and_then(|()| engine.tell_last()).map_or_else(end_of, |()| end)
}

fn end_of(failure: Failure) -> End {
    match failure {
        Failure::Model(diagnostic) => End::Error(diagnostic),
        Failure::Output(error) => End::Output(error),
    }
}

/// The outcome of a run that could not begin.
fn stillborn(failure: Failure) -> Outcome {
    Outcome {
        end: end_of(failure),
        time: 0.0,
        stats: Stats::default(),
        false_asserts: Vec::new(),
        verdicts: Vec::new(),
        warnings: Vec::new(),
    }
}
