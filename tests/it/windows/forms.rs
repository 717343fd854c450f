//! A model by the fast and by the plain form of the engine, and where the two runs differ.
//!
//! Both integrate at a tight tolerance; each form is run by the interpreter and by machine code, which must agree to the
//! bit. Events within [`TIE`] of each other may stand in another order where no agent has part in both.

use std::fmt::Write as _;

use hyc::runtime::Algorithm;
use hyc::runtime::paper::Form;

use crate::harness::{Case, Ended, Fired, Run};

/// Both forms integrate by this.
pub const TOLERANCE: f64 = 1e-11;
/// How far the times of an event may be apart, s.
pub const TIME: f64 = 1e-7;
/// How far values at a sample or at the end may be apart, in units of 1 + their size.
pub const VALUE: f64 = 1e-6;
/// Roots so near in time may be found in another order, s.
const TIE: f64 = 1e-9;

/// The two runs of a model.
pub struct Both {
    pub fast: Run,
    pub plain: Run,
}

/// Runs a model by both forms.
pub fn both(text: &str) -> Both {
    let run = |form| by(text, form, TOLERANCE);
    Both { fast: run(Form::Fast), plain: run(Form::Plain) }
}

/// Runs a model by one form.
pub fn by(text: &str, form: Form, tolerance: f64) -> Run {
    Case::new(text).tolerance(tolerance).algorithm(Algorithm::Masim(form)).run_any()
}

/// Fails unless both forms tell the same of a model, with at least so many events; returns the two runs.
#[track_caller]
pub fn same(text: &str, n_events: usize) -> Both {
    let both = both(text);
    if let Ended::Error(found) = &both.plain.end {
        panic!("the run ends in an error: {found:?}\n{text}");
    }
    if let Some((_, difference)) = difference(&both.fast, &both.plain, f64::INFINITY) {
        panic!("{difference}\n{text}");
    }
    let n = both.plain.events.len();
    assert!(n >= n_events, "only {n} events, not {n_events}\n{text}");
    both
}

/// The first difference of two runs before `until`, s: when, and in words. What is at the end counts, and is at infinity,
/// if `until` is infinite.
pub fn difference(ours: &Run, theirs: &Run, until: f64) -> Option<(f64, String)> {
    let (a, b) = (in_order(ours, until), in_order(theirs, until));
    for k in 0..a.len().max(b.len()) {
        let (Some(one), Some(other)) = (a.get(k), b.get(k)) else {
            let (time, events) = if a.len() > k { (a[k].time, &a) } else { (b[k].time, &b) };
            let story = format!("{} events, {} expected; beyond: {:?}", a.len(), b.len(), events[k]);
            return Some((time, story));
        };
        if what(one) != what(other) || (one.time - other.time).abs() > TIME {
            let story = format!("event {k}: {one:?}\n  expected {other:?}\n{}", drift(&a[..k], &b[..k]));
            return Some((one.time.min(other.time), story));
        }
    }
    if until < f64::INFINITY {
        return None;
    }
    let at_end = |story: Option<String>| story.map(|story| (f64::INFINITY, story));
    at_end(ends(ours, theirs)).or_else(|| at_end(samples(ours, theirs)))
}

/// From which event on the times were apart by how much, in words.
fn drift(ours: &[Fired], theirs: &[Fired]) -> String {
    let mut story = String::new();
    let mut bound = 1e-13;
    for (k, (one, other)) in ours.iter().zip(theirs).enumerate() {
        let apart = (one.time - other.time).abs();
        if apart > bound {
            let _ = writeln!(story, "  apart by {apart:e} s at event {k} {:?}", what(one));
            bound = 10.0 * apart;
        }
    }
    story
}

/// Everything of an event but its time.
fn what(event: &Fired) -> (usize, &str, &str, &str, &str, &str) {
    (event.micro, &event.transition, &event.agent, &event.other, &event.from, &event.to)
}

/// The events before `until`; those of other agents that are ties with them stand by name.
fn in_order(run: &Run, until: f64) -> Vec<Fired> {
    let mut events: Vec<Fired> = run.events.iter().filter(|event| event.time < until).cloned().collect();
    let mut begin = 0;
    for k in 1..=events.len() {
        if k == events.len() || events[k].time - events[k - 1].time > TIE {
            sort_ties(&mut events[begin..k]);
            begin = k;
        }
    }
    events
}

/// Sorts events, but for those that have an agent in common.
fn sort_ties(events: &mut [Fired]) {
    let share = |a: &Fired, b: &Fired| {
        [&b.agent, &b.other]
            .into_iter()
            .any(|name| !name.is_empty() && (*name == a.agent || *name == a.other))
    };
    let key = |event: &Fired| (event.transition.clone(), event.agent.clone(), event.other.clone());
    for k in 1..events.len() {
        let mut k = k;
        while k > 0 && !share(&events[k - 1], &events[k]) && key(&events[k]) < key(&events[k - 1]) {
            events.swap(k - 1, k);
            k -= 1;
        }
    }
}

fn is_near(a: f64, b: f64) -> bool {
    a.to_bits() == b.to_bits()
        || (a - b).abs() <= VALUE * (1.0 + a.abs().max(b.abs()))
        || a.is_nan() && b.is_nan()
}

/// How the ends differ.
fn ends(ours: &Run, theirs: &Run) -> Option<String> {
    let mut story = String::new();
    match (&ours.end, &theirs.end) {
        (Ended::Error(one), Ended::Error(other)) if one.code == other.code => {}
        (one, other) if one == other => {}
        (one, other) => {
            let _ = writeln!(story, "ends by {one:?}, expected {other:?}");
        }
    }
    if (ours.time - theirs.time).abs() > TIME {
        let _ = writeln!(story, "ends at {}, expected {}", ours.time, theirs.time);
    }
    for (one, other) in ours.finals.iter().zip(&theirs.finals) {
        let same = one.agent == other.agent
            && one.mode == other.mode
            && (one.time - other.time).abs() <= TIME
            && one.values.iter().zip(&other.values).all(|(one, other)| is_near(one.1, other.1));
        if !same && story.len() < 2000 {
            let _ = writeln!(story, "at the end {one:?}\n  expected {other:?}");
        }
    }
    if ours.finals.len() != theirs.finals.len() {
        let _ = writeln!(story, "{} agents at the end, not {}", ours.finals.len(), theirs.finals.len());
    }
    let claims = |run: &Run| -> Vec<_> {
        let claim = |claim: &hyc::runtime::observe::FalseAssert| {
            (claim.message.clone(), claim.agent, claim.mode.clone(), claim.count)
        };
        run.false_asserts.iter().map(claim).collect()
    };
    if claims(ours) != claims(theirs) {
        let _ = writeln!(story, "asserts {:?}\n  expected {:?}", claims(ours), claims(theirs));
    }
    for (one, other) in ours.false_asserts.iter().zip(&theirs.false_asserts) {
        if (one.time - other.time).abs() > TIME {
            let _ = writeln!(story, "an assert is false at {}, expected {}", one.time, other.time);
        }
    }
    (!story.is_empty()).then_some(story)
}

/// How the records differ.
fn samples(ours: &Run, theirs: &Run) -> Option<String> {
    for (record, (one, other)) in ours.samples.iter().zip(&theirs.samples).enumerate() {
        if one.len() != other.len() {
            return Some(format!("record {record}: {} rows, not {}", one.len(), other.len()));
        }
        for (one, other) in one.iter().zip(other) {
            let same = one.agent == other.agent
                && one.mode == other.mode
                && one.micro == other.micro
                && (one.time - other.time).abs() <= TIME
                && one.cells.iter().zip(&other.cells).all(|(&one, &other)| is_near(one, other));
            if !same {
                return Some(format!("record {record}: {one:?}\n  expected {other:?}"));
            }
        }
    }
    None
}
