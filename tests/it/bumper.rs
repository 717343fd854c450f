//! Does the bumper arena agree with its references? See `tests/data`: event logs and states at T = 20, computed at
//! order 20 and tolerance 2e-16. The cars are chaotic: every event has to be right for the last one to be.

use hyc::model::ir::Integrator;

use crate::harness::{Case, Run};

/// An event of the reference: time, transition, cars.
struct Reference {
    time: f64,
    transition: &'static str,
    agent: String,
    other: String,
}

fn rows(name: &str) -> Vec<Vec<String>> {
    let path = format!("{}/tests/data/{name}", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{path}: {error}"));
    text.lines().skip(1).map(|line| line.split(',').map(String::from).collect()).collect()
}

fn events(n: usize) -> Vec<Reference> {
    let event = |row: Vec<String>| Reference {
        time: row[0].parse().expect("a time"),
        transition: match row[1].as_str() {
            "L" => "Car.left",
            "R" => "Car.right",
            "B" => "Car.bottom",
            "T" => "Car.top",
            "P" => "Bump.pair",
            kind => panic!("no such kind of event: {kind}"),
        },
        agent: format!("cars[{}]", row[2]),
        other: if row[3] == "-1" { String::new() } else { format!("cars[{}]", row[3]) },
    };
    rows(&format!("ref_{n}.csv")).into_iter().map(event).collect()
}

fn case(n: usize, tolerance: f64) -> Case {
    let case = Case::shipped("bumper.hy").param("N", n).param("data", format!("bumper_{n}.csv"));
    case.tolerance(tolerance)
}

fn agrees(n: usize, tolerance: f64, time_error: f64, state_error: f64) {
    compare(n, &case(n, tolerance).run(), time_error, state_error);
}

fn agrees_with(integrator: Integrator, n: usize, tolerance: f64, time_error: f64, state_error: f64) {
    compare(n, &case(n, tolerance).integrator(integrator).run(), time_error, state_error);
}

fn agrees_with_adams(n: usize, tolerance: f64, time_error: f64, state_error: f64) {
    agrees_with(Integrator::Adams, n, tolerance, time_error, state_error);
}

fn compare(n: usize, run: &Run, time_error: f64, state_error: f64) {
    let reference = events(n);
    assert_eq!(run.events.len(), reference.len(), "{:#?}", run.log());
    for (event, expected) in run.events.iter().zip(&reference) {
        assert_eq!(event.transition, expected.transition, "{event:?}");
        assert_eq!((&event.agent, &event.other), (&expected.agent, &expected.other), "{event:?}");
        let off = (event.time - expected.time).abs();
        assert!(off <= time_error, "{event:?} is off by {off:e}");
    }
    for row in rows(&format!("ref_final_{n}.csv")) {
        for (variable, expected) in ["x", "y", "th"].iter().zip(&row[1..]) {
            let path = format!("cars[{}].{variable}", row[0]);
            let expected: f64 = expected.parse().expect("a number");
            let off = (run.value(&path) - expected).abs();
            assert!(off <= state_error, "{path} = {} is not {expected}: off by {off:e}", run.value(&path));
        }
    }
}

#[test]
fn loose_2() {
    agrees(2, 1e-6, 1e-3, 1e-2);
}

#[test]
fn loose_5() {
    agrees(5, 1e-6, 1e-3, 1e-2);
}

#[test]
fn loose_10() {
    agrees(10, 1e-6, 1e-3, 1e-2);
}

#[test]
fn loose_20() {
    agrees(20, 1e-6, 1e-3, 1e-2);
}

#[test]
fn loose_50() {
    agrees(50, 1e-6, 1e-3, 1e-2);
}

#[test]
fn tight_2() {
    agrees(2, 1e-10, 1e-7, 1e-5);
}

#[test]
fn tight_5() {
    agrees(5, 1e-10, 1e-7, 1e-5);
}

#[test]
fn tight_10() {
    agrees(10, 1e-10, 1e-7, 1e-5);
}

#[test]
fn tight_20() {
    agrees(20, 1e-10, 1e-7, 1e-5);
}

#[test]
fn tight_50() {
    agrees(50, 1e-10, 1e-7, 1e-5);
}

#[test]
fn adams_loose_2() {
    agrees_with_adams(2, 1e-6, 1e-3, 1e-2);
}

#[test]
fn adams_loose_5() {
    agrees_with_adams(5, 1e-6, 1e-3, 1e-2);
}

#[test]
fn adams_loose_10() {
    agrees_with_adams(10, 1e-6, 1e-3, 1e-2);
}

#[test]
fn adams_loose_20() {
    agrees_with_adams(20, 1e-6, 1e-3, 1e-2);
}

#[test]
fn adams_loose_50() {
    agrees_with_adams(50, 1e-6, 1e-3, 1e-2);
}

#[test]
fn adams_tight_2() {
    agrees_with_adams(2, 1e-10, 1e-7, 1e-5);
}

#[test]
fn adams_tight_5() {
    agrees_with_adams(5, 1e-10, 1e-7, 1e-5);
}

#[test]
fn adams_tight_10() {
    agrees_with_adams(10, 1e-10, 1e-7, 1e-5);
}

#[test]
fn adams_tight_20() {
    agrees_with_adams(20, 1e-10, 1e-7, 1e-5);
}

#[test]
fn adams_tight_50() {
    agrees_with_adams(50, 1e-10, 1e-7, 1e-5);
}

#[test]
fn taylor_loose() {
    for n in [2, 5, 10, 20, 50] {
        agrees_with(Integrator::Taylor, n, 1e-6, 1e-3, 1e-2);
    }
}

#[test]
fn taylor_tight() {
    for n in [2, 5, 10, 20, 50] {
        agrees_with(Integrator::Taylor, n, 1e-10, 1e-7, 1e-5);
    }
}

#[test]
fn who_is_not_in_an_event_is_not_cut() {
    let run = case(20, 1e-6).run();
    assert!(run.stats.cuts <= 2 * run.stats.events, "an event cuts those whom it writes: {:?}", run.stats);
}
