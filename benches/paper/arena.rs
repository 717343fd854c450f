//! Section 8 of the paper, figures 10 and 11: the cost of the algorithms on the bumper arena.

use std::fmt::Write as _;
use std::sync::atomic::AtomicBool;

use hyc::cli::compare::measure::{self, Measured};
use hyc::cli::compare::table::geometric_mean;
use hyc::cli::compare::{TIGHT, WITHIN};
use hyc::codegen::program::Program;
use hyc::runtime::limits::Limits;
use hyc::runtime::paper::{Algorithm, Form, Paper};

use crate::cars::{SPREAD, bumper};
use crate::figure::{Panel, Series, Style, falling_panel, figure, folder, log_panel, series, write};
use crate::fit;
use crate::report::Report;

/// The end of every run of the benchmark, s.
pub const UNTIL: f64 = 20.0;
/// Random initial conditions of each size, seeds 1 to 10.
pub const SEEDS: u64 = 10;
const TOLERANCES: [f64; 3] = [1e-3, 1e-4, 1e-5];
/// Numbers of cars.
pub const SIZES: std::ops::RangeInclusive<usize> = 2..=20;

/// One scenario under all three algorithms.
pub struct Trio {
    pub n: usize,
    pub seed: u64,
    pub tolerance: f64,
    pub masim: Measured,
    pub ma: Measured,
    pub sa: Measured,
}

/// What a run costs.
pub type Cost = fn(&Measured) -> f64;

/// One of the runs of a scenario.
type Of = fn(&Trio) -> &Measured;

/// The three ways to count a cost, by name.
pub const COSTS: [(&str, Cost); 3] = [
    ("right-hand sides", |run| run.stats.rhs_evaluations as f64),
    ("operations", |run| run.stats.operations as f64),
    ("CPU time", |run| run.seconds),
];

impl Trio {
    /// S (29).
    pub fn s(&self, cost: Cost) -> f64 {
        cost(&self.ma) / cost(&self.sa)
    }

    /// The same for `masim`.
    pub fn s_masim(&self, cost: Cost) -> f64 {
        cost(&self.masim) / cost(&self.sa)
    }
}

/// A program under an algorithm; one that stops in error ends the process.
pub fn run(program: &mut Program, algorithm: Algorithm, tolerance: f64, audit: bool) -> Measured {
    measure::measure(program, algorithm, tolerance, &Limits::default(), &AtomicBool::new(false), audit)
        .unwrap_or_else(|diagnostic| panic!("{diagnostic:#?}"))
}

/// All three algorithms on one program.
pub fn trio(program: &mut Program, n: usize, seed: u64, tolerance: f64, audit: bool) -> Trio {
    let paper = Paper::default();
    let masim = run(program, Algorithm::Masim(Form::Plain), tolerance, false);
    let ma = run(program, Algorithm::Masim2004(paper), tolerance, audit);
    let sa = run(program, Algorithm::Sasim2004(paper), tolerance, audit);
    Trio { n, seed, tolerance, masim, ma, sa }
}

/// The geometric mean of something over the runs that are chosen.
pub fn mean(trios: &[Trio], chosen: impl Fn(&Trio) -> bool, of: impl Fn(&Trio) -> f64) -> f64 {
    geometric_mean(trios.iter().filter(|trio| chosen(trio)).map(of))
}

/// Runs 570 scenarios under three algorithms, draws and tells.
pub fn figures(report: &mut Report, tick: &dyn Fn(&str)) {
    let mut trios = Vec::new();
    let mut csv = String::from(
        "n,seed,tolerance,algorithm,events,agreed,expected,missed,late,latest,steps,rhs_evaluations,guard_evaluations,\
         guard_polynomials,operations,cpu_seconds\n",
    );
    for n in SIZES {
        tick(&format!("bumper, N = {n}"));
        for seed in 1..=SEEDS {
            let mut program = bumper(n, seed, SPREAD, UNTIL, false);
            let tight = run(&mut program, Algorithm::Masim(Form::Plain), TIGHT, false);
            for tolerance in TOLERANCES {
                let trio = trio(&mut program, n, seed, tolerance, true);
                rows(&mut csv, &trio, &tight);
                trios.push(trio);
            }
        }
    }
    write(&folder().join("bumper.csv"), &csv);
    cost_against_size(&trios);
    let fits = speed_up_against_size(&trios);
    tell(report, &trios);
    tell_fits(report, &fits);
    tell_misses(report, &trios);
}

fn rows(csv: &mut String, trio: &Trio, tight: &Measured) {
    for (name, run) in [("masim", &trio.masim), ("masim-2004", &trio.ma), ("sasim-2004", &trio.sa)] {
        let stats = &run.stats;
        let misses = stats.misses.map_or(",,".into(), |m| format!("{},{},{:?}", m.missed, m.late, m.latest));
        let _ = writeln!(
            csv,
            "{},{},{:?},{name},{},{},{},{misses},{},{},{},{},{},{:?}",
            trio.n,
            trio.seed,
            trio.tolerance,
            run.events.len(),
            measure::agreement(&run.events, &tight.events, WITHIN),
            tight.events.len(),
            stats.steps,
            stats.rhs_evaluations,
            stats.guard_evaluations + stats.guard_ranges,
            stats.guard_polynomials,
            stats.operations,
            run.seconds,
        );
    }
}

/// Figure 10: operations of every run at 1e-3.
fn cost_against_size(trios: &[Trio]) {
    let at = |of: &dyn Fn(&Trio) -> f64| -> Vec<(f64, f64)> {
        trios.iter().filter(|t| t.tolerance == 1e-3).map(|t| (t.n as f64, of(t))).collect()
    };
    let panels = COSTS.map(|(name, cost)| {
        log_panel(
            &format!("Cost at 1e-3: {name}"),
            "N",
            if name == "CPU time" { "s" } else { name },
            vec![
                series("sasim-2004", Style::Dots, at(&|t| cost(&t.sa))),
                series("masim-2004", Style::Dots, at(&|t| cost(&t.ma))),
                series("masim", Style::Dots, at(&|t| cost(&t.masim))),
            ],
        )
    });
    figure("figure_10", &panels);
}

/// Figure 11: S against N for the tolerances, with (37) fitted. The fits by cost and tolerance.
fn speed_up_against_size(trios: &[Trio]) -> Vec<(&'static str, f64, fit::Fit)> {
    let mut fits = Vec::new();
    let panels: Vec<Panel> = COSTS
        .into_iter()
        .map(|(name, cost)| {
            let mut all: Vec<Series> = Vec::new();
            for tolerance in TOLERANCES {
                let points: Vec<(f64, f64)> = SIZES
                    .map(|n| {
                        let s = mean(trios, |t| t.n == n && t.tolerance == tolerance, |t| t.s(cost));
                        (n as f64, s)
                    })
                    .collect();
                let fitted = fit::speed_up(&points);
                let curve = (20..=200).map(|k| 0.1 * f64::from(k)).map(|n| (n, fitted.at(n))).collect();
                all.push(series(format!("{tolerance:e}"), Style::Chain, points));
                all.push(series(format!("(37), {tolerance:e}"), Style::Dashes, curve));
                fits.push((name, tolerance, fitted));
            }
            falling_panel(&format!("S in {name}"), "N", "S", all)
        })
        .collect();
    figure("figure_11", &panels);
    fits
}

fn tell(report: &mut Report, trios: &[Trio]) {
    let mut text = String::from("| S = masim-2004 / sasim-2004: rhs / operations / CPU");
    text += " | 1e-3 | 1e-4 | 1e-5 |\n|---|---|---|---|\n";
    for n in [2, 5, 10, 15, 20] {
        let _ = write!(text, "| N = {n}");
        for tolerance in TOLERANCES {
            let s = COSTS.map(|(_, cost)| {
                format!("{:.2}", mean(trios, |t| t.n == n && t.tolerance == tolerance, |t| t.s(cost)))
            });
            let _ = write!(text, " | {}", s.join(" / "));
        }
        text += " |\n";
    }
    text += "\n| `masim` / sasim-2004: rhs / operations / CPU | 1e-3 | 1e-4 | 1e-5 |\n|---|---|---|---|\n";
    for n in [2, 10, 20] {
        let _ = write!(text, "| N = {n}");
        for tolerance in TOLERANCES {
            let s = COSTS.map(|(_, cost)| {
                format!("{:.3}", mean(trios, |t| t.n == n && t.tolerance == tolerance, |t| t.s_masim(cost)))
            });
            let _ = write!(text, " | {}", s.join(" / "));
        }
        text += " |\n";
    }
    let scenarios: Vec<&Trio> = trios.iter().filter(|t| t.tolerance == 1e-3).collect();
    for (name, cost) in COSTS {
        let lost = scenarios.iter().filter(|t| t.s(cost) >= 1.0).count();
        let _ = write!(
            text,
            "\nOf the {} scenarios at 1e-3, in {lost} masim-2004 costs at least as much as sasim-2004 in {name}.",
            scenarios.len()
        );
    }
    report.table("speed_up", &text);
}

fn tell_fits(report: &mut Report, fits: &[(&str, f64, fit::Fit)]) {
    let mut text = String::from(
        "| S in | tolerance | a | b | c | d | R² | rms residual |\n|---|---|---:|---:|---:|---:|---:|---:|\n",
    );
    for (name, tolerance, fitted) in fits {
        let [a, b, c, d] = fitted.constants;
        let _ = writeln!(
            text,
            "| {name} | {tolerance:e} | {a:.4} | {b:.4} | {c:.4} | {d:.4} | {:.4} | {:.4} |",
            fitted.r2, fitted.rms
        );
    }
    report.table("fits", &text);
}

/// What each algorithm passes over, over all scenarios of a tolerance.
fn tell_misses(report: &mut Report, trios: &[Trio]) {
    let mut text = String::from(
        "| tolerance | algorithm | events | missed | later than 1e-3 s | latest, s | runs with either |\n\
         |---|---|---:|---:|---:|---:|---:|\n",
    );
    for tolerance in TOLERANCES {
        let of: [(&str, Of); 2] = [("masim-2004", |t| &t.ma), ("sasim-2004", |t| &t.sa)];
        for (name, of) in of {
            let chosen: Vec<&Measured> = trios.iter().filter(|t| t.tolerance == tolerance).map(of).collect();
            let found: Vec<_> = chosen.iter().filter_map(|run| run.stats.misses).collect();
            let _ = writeln!(
                text,
                "| {tolerance:e} | {name} | {} | {} | {} | {:.1e} | {} of {} |",
                chosen.iter().map(|run| run.events.len()).sum::<usize>(),
                found.iter().map(|m| m.missed).sum::<u64>(),
                found.iter().map(|m| m.late).sum::<u64>(),
                found.iter().map(|m| m.latest).fold(0.0, f64::max),
                found.iter().filter(|m| m.missed + m.late > 0).count(),
                found.len()
            );
        }
    }
    report.table("misses", &text);
}
