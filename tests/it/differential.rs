//! Does the engine do what the language says? Random models, run by it and by a slow and obvious reference simulator.
//!
//! A model counts if the reference's own log is the same under half its step and a tenth of its tolerance. `cargo test` runs 200 models of each kind;
//! `HYC_MODELS=10000 cargo test differential -- --nocapture` runs so many, from number `HYC_FIRST` (0) on; with
//! `HYC_MODELS=1 HYC_FIRST=n HYC_PRINT=1` that is model n alone, printed first, and with `HYC_FILE=path` the model of that file.

pub mod dice;
mod evaluate;
mod modes;
mod world;
mod boundary;
mod point;
mod post;
mod reference;
pub mod generate;
mod tree;
mod compare;

use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

use compare::{Verdict, compare};
use dice::{WITH_AGGREGATES, WITH_EVENTS, WITH_LIVES};
use hyc::model::ir::Integrator;

/// A number from the environment.
fn setting(name: &str) -> Option<u64> {
    std::env::var(name)
        .ok()
        .map(|text| text.parse().unwrap_or_else(|_| panic!("{name} is no number: {text}")))
}

/// The model of a file.
fn read(path: String) -> String {
    std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{path}: {error}"))
}

/// What became of many models.
#[derive(Default)]
struct Tally {
    kept: usize,
    skipped: usize,
    events: usize,
    different: Vec<(u64, String)>,
}

/// Compares the models of these numbers, on all processors.
fn tally(integrator: Integrator, first: u64, models: u64) -> Tally {
    let (next, tally) = (AtomicU64::new(first), Mutex::new(Tally::default()));
    let work = || {
        loop {
            let number = next.fetch_add(1, Ordering::Relaxed);
            if number >= first + models {
                return;
            }
            let text = std::env::var("HYC_FILE").map_or_else(|_| generate::model(number), read);
            if setting("HYC_PRINT").is_some() {
                println!("{text}");
            }
            let verdict = compare(&text, integrator);
            let mut tally = tally.lock().unwrap();
            match verdict {
                Verdict::Same(events) => {
                    tally.kept += 1;
                    tally.events += events;
                }
                Verdict::Skipped => tally.skipped += 1,
                Verdict::Different(story) => tally.different.push((number, story)),
            }
        }
    };
    let workers = std::thread::available_parallelism().map_or(1, usize::from);
    std::thread::scope(|scope| (0..workers).for_each(|_| drop(scope.spawn(work))));
    tally.into_inner().unwrap()
}

#[test]
fn engine_and_reference_tell_the_same_story_of_random_models() {
    tell_the_same_story(Integrator::Auto, setting("HYC_FIRST").unwrap_or(0));
}

#[test]
fn so_they_do_of_models_with_aggregates() {
    tell_the_same_story(Integrator::Auto, WITH_AGGREGATES + setting("HYC_FIRST").unwrap_or(0));
}

#[test]
fn so_they_do_of_models_with_events() {
    tell_the_same_story(Integrator::Auto, WITH_EVENTS + setting("HYC_FIRST").unwrap_or(0));
}

#[test]
fn so_they_do_of_models_with_hierarchy_births_and_deaths() {
    tell_the_same_story(Integrator::Auto, WITH_LIVES + setting("HYC_FIRST").unwrap_or(0));
}

#[test]
fn so_they_do_by_the_paper_s_integrator() {
    tell_the_same_story(Integrator::Adams, setting("HYC_FIRST").unwrap_or(0));
}

fn tell_the_same_story(integrator: Integrator, first: u64) {
    let models = setting("HYC_MODELS").unwrap_or(200);
    let mut tally = tally(integrator, first, models);
    let Tally { kept, skipped, events, .. } = tally;
    tally.different.sort();
    println!(
        "{models} models: {kept} the same ({events} events), {skipped} skipped, {} different",
        tally.different.len()
    );
    for (number, story) in &tally.different {
        println!("---- model {number}: engine | reference\n{story}");
    }
    let numbers: Vec<u64> = tally.different.iter().map(|(number, _)| *number).collect();
    assert!(numbers.is_empty(), "models {numbers:?} differ; the first:\n{}", tally.different[0].1);
    if models >= 100 {
        assert!(2 * kept as u64 >= models, "only {kept} of {models} models are robust");
        assert!(events > 3 * kept, "only {events} events in {kept} models");
    }
}
