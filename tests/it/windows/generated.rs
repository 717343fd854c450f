//! The two forms on models that nobody has chosen: those of the differential test, and crowds in an arena.
//!
//! `HYC_MODELS=10000 cargo test windows -- --nocapture` runs so many, from number `HYC_FIRST` (0) on; `HYC_PRINT=1` prints
//! them.

use std::fmt::Write as _;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

use hyc::runtime::Algorithm;
use hyc::runtime::paper::Form;

use super::crowd;
use super::forms::{TOLERANCE, both, difference};
use super::lookouts;
use super::mates;
use crate::differential::dice::{WITH_AGGREGATES, WITH_EVENTS};
use crate::differential::generate;
use crate::harness::Case;

/// What rounding may come to over a run, as a factor of all speeds of a crowd.
const NUDGE: f64 = 1.0 + 1e-13;
/// Models that do very much in little time and are left out, of those that are run unless more are asked for.
const LONG: [u64; 4] = [164, 286, WITH_AGGREGATES + 20, WITH_AGGREGATES + 27];
/// Crowds that are left out for the same reason.
const LONG_CROWDS: [u64; 5] = [2, 5, 7, 12, 13];
/// How much less than up to the first doubtful event two runs have to agree, s.
const MARGIN: f64 = 1e-3;

fn setting(name: &str) -> Option<u64> {
    std::env::var(name)
        .ok()
        .map(|text| text.parse().unwrap_or_else(|_| panic!("{name} is no number: {text}")))
}

/// What became of many models.
#[derive(Default)]
struct Tally {
    whole: usize,
    parts: usize,
    events: usize,
    different: Vec<(u64, String)>,
}

/// Compares the two forms on a model: up to when, s, how many events, and the difference if there is one. Where the plain
/// form at other tolerances tells another story, neither has to be told.
fn compare(text: &str) -> (f64, usize, Option<String>) {
    let both = both(text);
    let found = difference(&both.fast, &both.plain, f64::INFINITY);
    let events = both.plain.events.len();
    let Some((time, story)) = found else { return (f64::INFINITY, events, None) };
    let mut until = f64::INFINITY;
    for tolerance in [0.1 * TOLERANCE, 0.5 * TOLERANCE, 10.0 * TOLERANCE] {
        let case = || Case::new(text).tolerance(tolerance).algorithm(Algorithm::Masim(Form::Plain));
        let nudged = text.contains("param nudge");
        let other = if nudged { case().param("nudge", NUDGE).run_any() } else { case().run_any() };
        if let Some((time, _)) = difference(&other, &both.plain, f64::INFINITY) {
            until = until.min(time);
        }
    }
    if until == f64::INFINITY || time < until - MARGIN {
        return (until, events, Some(story));
    }
    let events = both.plain.events.iter().filter(|event| event.time < until).count();
    (until, events, None)
}

fn tally(first: u64, models: u64, without: &[u64], model: &(dyn Fn(u64) -> String + Sync)) -> Tally {
    let (next, tally) = (AtomicU64::new(first), Mutex::new(Tally::default()));
    let work = || {
        loop {
            let number = next.fetch_add(1, Ordering::Relaxed);
            if number >= first + models {
                return;
            }
            if without.contains(&number) {
                continue;
            }
            let text = model(number);
            if setting("HYC_PRINT").is_some() {
                println!("{text}");
            }
            let (until, events, found) = compare(&text);
            let mut tally = tally.lock().unwrap();
            tally.events += events;
            match found {
                Some(story) => tally.different.push((number, format!("{story}\n{text}"))),
                None if until == f64::INFINITY => tally.whole += 1,
                None => tally.parts += 1,
            }
        }
    };
    let workers = std::thread::available_parallelism().map_or(1, usize::from);
    std::thread::scope(|scope| (0..workers).for_each(|_| drop(scope.spawn(work))));
    tally.into_inner().unwrap()
}

/// Fails if the forms differ on a model of these numbers, or if few of them are compared to their end.
#[track_caller]
fn agree(first: u64, models: u64, without: &[u64], model: &(dyn Fn(u64) -> String + Sync)) {
    let models = setting("HYC_MODELS").unwrap_or(models);
    let first = first + setting("HYC_FIRST").unwrap_or(0);
    let mut tally = tally(first, models, without, model);
    tally.different.sort();
    let Tally { whole, parts, events, different } = &tally;
    println!("{models} models: {whole} the same ({events} events), {parts} in part, {} not", different.len());
    let mut stories = String::new();
    for (number, story) in different {
        let _ = writeln!(stories, "---- model {number}: fast, expected as plain\n{story}");
    }
    assert!(different.is_empty(), "{stories}");
    if models >= 20 {
        assert!(10 * *whole as u64 >= 9 * models, "only {whole} of {models} models are robust");
        assert!(*events as u64 > 3 * models, "only {events} events in {models} models");
    }
}

#[test]
fn the_forms_agree_on_random_models() {
    agree(0, 300, &LONG, &generate::model);
}

#[test]
fn the_forms_agree_on_random_models_with_aggregates() {
    agree(WITH_AGGREGATES, 60, &LONG, &generate::model);
}

#[test]
fn the_forms_agree_on_random_models_with_events() {
    agree(WITH_EVENTS, 100, &LONG, &generate::model);
}

#[test]
fn the_forms_agree_on_crowds() {
    agree(0, 15, &LONG_CROWDS, &crowd::model);
}

#[test]
fn the_forms_agree_on_crowds_that_look_around() {
    agree(0, 16, &[], &lookouts::model);
}

#[test]
fn the_forms_agree_on_crowds_that_look_for_the_nearest() {
    agree(0, 16, &[], &mates::model);
}

/// Two that follow each other were bounded from where they would be, and not from where they had come to.
#[test]
fn the_forms_agree_on_those_who_look_for_each_other() {
    for number in [122, 251, 410] {
        agree(number, 1, &[], &mates::model);
    }
}
