//! Are the events of `masim` those of a run at 1e-12? Up to where, and what the first that differs looks like.

use std::fmt::Write as _;

use hyc::cli::compare::measure::{Logged, Measured, agreement};
use hyc::cli::compare::{TIGHT, WITHIN};
use hyc::runtime::paper::{Algorithm, Form};

use crate::arena::{SEEDS, SIZES, UNTIL, run};
use crate::cars::{SPREAD, bumper};
use crate::report::Report;

/// The three of the arena, and two that are tighter.
const TOLERANCES: [f64; 5] = [1e-3, 1e-4, 1e-5, 1e-7, 1e-9];

/// Runs the scenarios of the arena by `masim` at each tolerance, and tells.
pub fn table(report: &mut Report, tick: &dyn Fn(&str)) {
    tick("the events of masim");
    let mut all = TOLERANCES.map(Agreement::new);
    for n in SIZES {
        for seed in 1..=SEEDS {
            let mut program = bumper(n, seed, SPREAD, UNTIL, false);
            let tight = run(&mut program, Algorithm::Masim(Form::Plain), TIGHT, false);
            for agreement in &mut all {
                let run = run(&mut program, Algorithm::Masim(Form::Plain), agreement.tolerance, false);
                agreement.add(&run, &tight);
            }
        }
    }
    tell(report, &all);
}

/// How the runs at one tolerance compare with the tight ones.
struct Agreement {
    tolerance: f64,
    runs: usize,
    expected: usize,
    agreed: usize,
    to_the_end: usize,
    /// By how much the first event that differs has moved, s, where it is in both runs.
    moved: Vec<f64>,
    /// How many first events that differ are in one of the two runs only.
    in_one_only: usize,
}

impl Agreement {
    /// No runs yet.
    fn new(tolerance: f64) -> Self {
        let (runs, expected, agreed, to_the_end, in_one_only) = (0, 0, 0, 0, 0);
        Self { tolerance, runs, expected, agreed, to_the_end, moved: Vec::new(), in_one_only }
    }

    /// One more run, beside its tight one.
    fn add(&mut self, run: &Measured, tight: &Measured) {
        let (events, expected) = (&run.events, &tight.events);
        let n = agreement(events, expected, WITHIN);
        self.runs += 1;
        self.expected += expected.len();
        self.agreed += n;
        match (events.get(n), expected.get(n)) {
            (None, None) => self.to_the_end += 1,
            (ours, theirs) => {
                // The one that comes first, and the same one in the other run.
                let (first, others) = match (ours, theirs) {
                    (Some(ours), Some(theirs)) if ours.time < theirs.time => (ours, &expected[n..]),
                    (Some(ours), None) => (ours, &expected[n..]),
                    (_, Some(theirs)) => (theirs, &events[n..]),
                    (None, None) => return,
                };
                match others.iter().find(|event| is_same(event, first)) {
                    Some(same) => self.moved.push((same.time - first.time).abs()),
                    None => self.in_one_only += 1,
                }
            }
        }
    }

    /// The middle and the largest of what first events have moved by, s.
    fn moves(&self) -> String {
        let mut moved = self.moved.clone();
        moved.sort_by(f64::total_cmp);
        match (moved.get(moved.len() / 2), moved.last()) {
            (Some(middle), Some(last)) => format!("{middle:.4} / {last:.4}"),
            _ => String::new(),
        }
    }
}

fn is_same(a: &Logged, b: &Logged) -> bool {
    (&a.transition, a.agent, a.other) == (&b.transition, b.agent, b.other)
}

/// The table of all tolerances.
fn tell(report: &mut Report, all: &[Agreement]) {
    let mut text = String::from(
        "| tolerance of `masim` | events at 1e-12 | the same, up to the first that differs | runs that agree to the end | \
         in the others the first that differs has moved by (median / most), s | is in one run only |\n\
         |---|---:|---:|---:|---:|---:|\n",
    );
    for agreement in all {
        let Agreement { tolerance, runs, expected, agreed, to_the_end, in_one_only, .. } = agreement;
        let _ = writeln!(
            text,
            "| {tolerance:e} | {expected} | {agreed} | {to_the_end} of {runs} | {} | {in_one_only} |",
            agreement.moves()
        );
    }
    report.table("agreement", &text);
}
