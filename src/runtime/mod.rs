//! From a program to what happens: events and samples, told to an observer.

mod solve;
pub mod limits;
pub mod observe;
mod population;
mod present;
mod groups;
mod guards;
mod truth;
mod detect;
mod enclose;
mod failure;
mod advance;
mod stiffness;
mod repetition;
mod record;
mod engine;
mod act;
mod arm;
mod instant;
mod certify;
mod gather;
mod masim;

use std::sync::atomic::AtomicBool;

use crate::codegen::program::Program;
use engine::Engine;
use failure::Failure;
pub use limits::Limits;
use observe::{End, Observer, Outcome, Stats};

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
    let mut engine = match Engine::new(program, limits, observer) {
        Ok(engine) => engine,
        Err(failure) => return stillborn(failure),
    };
    let end = match engine.run(interrupt) {
        Ok(end) => end,
        Err(failure) => end_of(failure),
    };
    let end = match engine.tell_last() {
        Ok(()) => end,
        Err(failure) => end_of(failure),
    };
    engine.outcome(end)
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
        warnings: Vec::new(),
    }
}
