//! Section 6 of the paper, figures 3 to 6: two cars that meet, and two that nearly do, with gamma = 0.5.

use hyc::cli::compare::measure::{Measured, measure};
use hyc::runtime::limits::Limits;
use hyc::runtime::paper::{Algorithm, Form, Paper};
use plotters::prelude::SeriesLabelPosition;
use std::sync::atomic::AtomicBool;

use crate::cars::two_cars;
use crate::figure::{Panel, Style, figure, log_panel, panel, series};
use crate::report::Report;

/// A step of Algorithm 1: which car, where its clock has come to, how long the step was, the guard with each car at its own
/// clock, and the lag of the one that lags.
struct Step {
    car: usize,
    t: f64,
    h: f64,
    g: f64,
    tau: f64,
}

/// The steps in the order in which they are taken: the car that lags first.
fn steps(run: &Measured, until: f64) -> Vec<Step> {
    let of = |car: usize| {
        let rows = run.rows.iter().filter(|row| row.agent.number == car && row.time <= until);
        rows.map(|row| (row.time, row.cells[0], row.cells[1])).collect::<Vec<_>>()
    };
    let cars = [of(0), of(1)];
    let mut at = [0, 0];
    let mut steps = Vec::new();
    while at[0] + 1 < cars[0].len() && at[1] + 1 < cars[1].len() {
        let car = usize::from(cars[1][at[1]].0 < cars[0][at[0]].0);
        let before = cars[car][at[car]].0;
        at[car] += 1;
        let [(t1, x1, y1), (t2, x2, y2)] = [cars[0][at[0]], cars[1][at[1]]];
        let g = (x1 - x2).powi(2) + (y1 - y2).powi(2) - 1.0;
        let t = cars[car][at[car]].0;
        steps.push(Step { car, t, h: t - before, g, tau: (t1 - t2).abs() });
    }
    steps
}

/// Runs both examples and draws them.
pub fn figures(report: &mut Report) {
    let paper = Paper { gamma: 0.5, ..Paper::default() };
    let examples = [
        ("figure_3", "figure_4", include_str!("../../models/two_cars.hy"), 30.0),
        ("figure_5", "figure_6", include_str!("../../models/near_miss.hy"), 12.0),
    ];
    for (first, second, text, until) in examples {
        let mut program = two_cars(text, until);
        let run = measure(
            &mut program,
            Algorithm::Masim2004(paper),
            1e-5,
            &Limits::default(),
            &AtomicBool::new(false),
            true,
        )
        .expect("the cars can be simulated");
        let masim = measure(
            &mut program,
            Algorithm::Masim(Form::Plain),
            1e-5,
            &Limits::default(),
            &AtomicBool::new(false),
            false,
        )
        .expect("the cars can be simulated");
        let event = run.events.first().map(|event| event.time);
        let until = event.unwrap_or(until);
        let steps = steps(&run, until);
        draw(first, second, &run, &steps, until);
        tell(report, first, event, &steps, &masim);
    }
}

fn draw(first: &str, second: &str, run: &Measured, steps: &[Step], until: f64) {
    let path = |car: usize| {
        let rows = run.rows.iter().filter(|row| row.agent.number == car && row.time <= until);
        rows.map(|row| (row.cells[0], row.cells[1])).collect::<Vec<_>>()
    };
    let numbered = |of: &dyn Fn(&Step) -> f64| {
        steps.iter().enumerate().map(|(k, step)| (k as f64, of(step))).collect::<Vec<_>>()
    };
    let sizes = |car: usize| {
        steps.iter().filter(|step| step.car == car).map(|step| (step.t, step.h)).collect::<Vec<_>>()
    };
    figure(
        first,
        &[
            panel(
                "The cars' paths",
                "x, m",
                "y, m",
                vec![series("car 1, fast", Style::Line, path(0)), series("car 2", Style::Line, path(1))],
            ),
            panel("The guard", "step k", "g", vec![series("g", Style::Line, numbered(&|step| step.g))]),
        ],
    );
    figure(
        second,
        &[
            Panel {
                legend: SeriesLabelPosition::LowerLeft,
                ..log_panel(
                    "Step sizes",
                    "t, s",
                    "h, s",
                    vec![series("h1", Style::Chain, sizes(0)), series("h2", Style::Chain, sizes(1))],
                )
            },
            log_panel(
                "How far the clocks differ",
                "step k",
                "|tau|, s",
                vec![series("tau", Style::Line, numbered(&|step| step.tau))],
            ),
        ],
    );
}

/// The approach in numbers.
fn tell(report: &mut Report, name: &str, event: Option<f64>, steps: &[Step], masim: &Measured) {
    let nearest = steps.iter().enumerate().min_by(|a, b| a.1.g.abs().total_cmp(&b.1.g.abs()));
    let Some((k, nearest)) = nearest else { return };
    let close: Vec<&Step> = steps.iter().filter(|step| step.g > 1e-5 && step.g < 0.02).collect();
    let ratio = |of: &dyn Fn(&Step) -> f64| {
        let ratios: Vec<f64> = close.windows(3).map(|round| of(round[2]) / of(round[0])).collect();
        hyc::cli::compare::table::geometric_mean(ratios.into_iter())
    };
    let lag = |steps: &mut dyn Iterator<Item = &Step>| steps.map(|step| step.tau).fold(0.0, f64::max);
    let time = |event: Option<f64>| event.map_or("none".into(), |t| format!("{t:.4}"));
    let of_masim = masim.events.first().map(|event| event.time);
    let until = of_masim.unwrap_or(f64::INFINITY);
    let steps_of_masim: usize = (0..2)
        .map(|car| {
            let rows = masim.rows.iter().filter(|row| row.agent.number == car && row.time <= until);
            let mut times: Vec<f64> = rows.map(|row| row.time).collect();
            // An event has two rows; the first row is where the car starts.
            times.dedup();
            times.len() - 1
        })
        .sum();
    let rows = vec![
        ("event at, s".to_string(), time(event)),
        ("event at by `masim`, s".into(), time(of_masim)),
        ("steps".into(), steps.len().to_string()),
        ("steps of `masim`".into(), steps_of_masim.to_string()),
        ("the guard is nearest to zero at step".into(), format!("{k}, g = {:.1e}", nearest.g)),
        ("largest lag of a clock, s".into(), format!("{:.3}", lag(&mut steps.iter()))),
        ("largest lag while 0 < g < 0.02, s".into(), format!("{:.4}", lag(&mut close.iter().copied()))),
    ];
    let mut text = String::from("| | |\n|---|---|\n");
    for (what, value) in rows {
        text += &format!("| {what} | {value} |\n");
    }
    if event.is_some() {
        text += &format!("| g falls in a round by (gamma = 0.5) | {:.3} |\n", ratio(&|step| step.g));
        text += &format!("| tau falls in a round by | {:.3} |\n", ratio(&|step| step.tau));
    }
    report.table(name, &text);
}
