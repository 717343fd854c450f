//! The systems that the paper stands on, in numbers: what their ideas come to on the models that show them.

use std::fmt::Write as _;
use std::sync::atomic::AtomicBool;

use hyc::cli::compare::measure::{Measured, measure};
use hyc::codegen::program::Program;
use hyc::runtime::limits::Limits;
use hyc::runtime::paper::{Algorithm, Form, Paper};

use crate::cars::shipped;
use crate::report::Report;

/// Runs all models and tells.
pub fn tables(report: &mut Report) {
    location(report);
    multirate(report);
    bodies(report);
    aircraft(report);
    genes(report);
}

fn run(program: &mut Program, algorithm: Algorithm) -> Measured {
    let tolerance = program.run.tolerance;
    measure(program, algorithm, tolerance, &Limits::default(), &AtomicBool::new(false), true)
        .unwrap_or_else(|diagnostic| panic!("{diagnostic:#?}"))
}

/// Roots closer together than steps: `double_crossing.hy` against its closed form.
fn location(report: &mut Report) {
    const BALLS: usize = 12;
    const MODEL: &str = include_str!("../../models/double_crossing.hy");
    let n = [("n", BALLS.to_string())];
    let found = run(&mut shipped(MODEL, &n), Algorithm::Masim(Form::Plain));
    // The same flights with the barrier out of reach: every accepted step is a row.
    let steps = MODEL.replace("when x >= bar", "when x >= 2*bar");
    let steps = steps.replace("record Ball every 0.01 [s]", "record Ball");
    let flights = run(&mut shipped(&steps, &n), Algorithm::Masim(Form::Plain));
    let published = [Algorithm::Masim2004(Paper::default()), Algorithm::Sasim2004(Paper::default())];
    let published = published.map(|algorithm| run(&mut shipped(MODEL, &n), algorithm));
    let mut text = String::from(
        "| rises above the bar by, m | is above it for, s | events found | furthest from the closed form, s | \
         ends of steps above the bar, without events | events of masim-2004 | of sasim-2004 |\n\
         |---:|---:|---:|---:|---:|---:|---:|\n",
    );
    for ball in 0..BALLS {
        let over = 0.1f64.powi(ball as i32 + 1);
        let (middle, half) = ((5.0 + over).sqrt() / 5f64.sqrt(), (over / 5.0).sqrt());
        let events: Vec<f64> =
            found.events.iter().filter(|e| e.agent.number == ball).map(|e| e.time).collect();
        let errors = events.iter().zip([middle - half, middle + half]).map(|(t, exact)| (t - exact).abs());
        let ends = flights.rows.iter().filter(|row| row.agent.number == ball && row.cells[0] >= 5.0).count();
        let others = published
            .each_ref()
            .map(|run| run.events.iter().filter(|event| event.agent.number == ball).count());
        let _ = writeln!(
            text,
            "| {over:.0e} | {:.1e} | {} | {:.0e} | {ends} of {} | {} | {} |",
            2.0 * half,
            events.len(),
            errors.fold(0.0, f64::max),
            flights.rows.iter().filter(|row| row.agent.number == ball).count() - 1,
            others[0],
            others[1]
        );
    }
    let short = found.events.iter().filter(|event| event.agent.number == BALLS).count();
    let _ = write!(
        text,
        "\nOf the ball that stays 5e-6 m below the bar: {short} events. Roots that could be neither excluded nor isolated: {}.",
        found.stats.undecided_roots
    );
    report.table("location", &text);
}

/// Own clocks and coupled ones: `multirate.hy`.
fn multirate(report: &mut Report) {
    let mut text = String::from(
        "| hold, s | steps of the slow one, coupled | of the fast one, coupled | of the slow one, sampled | \
         of the fast one, holding | largest error of holding |\n|---:|---:|---:|---:|---:|---:|\n",
    );
    for hold in ["0.1", "0.05", "0.025", "0.0125"] {
        let given = [("hold", hold.to_string())];
        let run = run(
            &mut shipped(include_str!("../../models/multirate.hy"), &given),
            Algorithm::Masim(Form::Plain),
        );
        let steps =
            |name: &str| run.stats.types.iter().filter(|ty| ty.name == name).map(|ty| ty.steps).sum::<u64>();
        let (slow, coupled, held) = (steps("Slow"), steps("Coupled"), steps("Held"));
        // Agents in the order of the model: one_clock, led, own_clocks, alone; columns x, v, y.
        let y = |agent: usize| {
            run.rows.iter().filter(move |row| row.agent.number == agent).map(|row| row.cells[2])
        };
        let error = y(0).zip(y(2)).map(|(one, own)| (one - own).abs()).fold(0.0, f64::max);
        let _ =
            writeln!(text, "| {hold} | {coupled} | {coupled} | {} | {held} | {error:.4} |", slow - coupled);
    }
    report.table("multirate", &text);
}

/// Bodies with own clocks: `billiards.hy`.
fn bodies(report: &mut Report) {
    let mut text = String::from(
        "| discs | events | integrations begun by `masim` | by masim-2004 | by sasim-2004 | missed / late by masim-2004 | \
         by sasim-2004 |\n|---:|---:|---:|---:|---:|---|---|\n",
    );
    for n in [6, 12, 24] {
        let given = [("n", n.to_string()), ("half", (5.0 * (f64::from(n) / 12.0).sqrt()).to_string())];
        let paper = Paper::default();
        let algorithms =
            [Algorithm::Masim(Form::Plain), Algorithm::Masim2004(paper), Algorithm::Sasim2004(paper)];
        let runs = algorithms
            .map(|algorithm| run(&mut shipped(include_str!("../../models/billiards.hy"), &given), algorithm));
        let missed = runs.each_ref().map(|run| {
            run.stats.misses.map_or(String::new(), |misses| format!("{} / {}", misses.missed, misses.late))
        });
        let starts = runs.each_ref().map(|run| run.stats.starts);
        let _ = writeln!(
            text,
            "| {n} | {} | {} | {} | {} | {} | {} |",
            runs[0].events.len(),
            starts[0],
            starts[1],
            starts[2],
            missed[1],
            missed[2]
        );
    }
    report.table("bodies", &text);
}

/// Two aircraft at several angles: `aircraft.hy`.
fn aircraft(report: &mut Report) {
    let mut text = String::from(
        "| angle between the courses | manoeuvre begins, s | ends, s | least distance, km | in closed form, km |\n\
         |---:|---:|---:|---:|---:|\n",
    );
    for angle in [60, 90, 120, 150, 180] {
        let given = [("angle", angle.to_string())];
        let run = run(
            &mut shipped(include_str!("../../models/aircraft.hy"), &given),
            Algorithm::Masim(Form::Plain),
        );
        let at = |agent: usize| run.rows.iter().filter(move |row| row.agent.number == agent);
        let distance =
            at(0).zip(at(1)).map(|(a, b)| (a.cells[0] - b.cells[0]).hypot(a.cells[1] - b.cells[1]));
        let of = |name: &str| {
            run.events
                .iter()
                .find(|e| e.transition == name)
                .map_or("never".into(), |e| format!("{:.2}", e.time))
        };
        // Of relative to own speed; the relative half circle begins at 20 km and ends on the other side.
        let ratio = 2.0 * (f64::from(angle).to_radians() / 2.0).sin();
        let exact = if ratio > 1.0 { (20.0 * (ratio - 1.0)).min(20.0) } else { 0.0 };
        let _ = writeln!(
            text,
            "| {angle}° | {} | {} | {:.2} | {exact:.2} |",
            of("Aircraft.conflict"),
            of("Aircraft.done"),
            distance.fold(f64::INFINITY, f64::min)
        );
    }
    report.table("aircraft", &text);
}

/// Thresholds: `genetic_switch.hy`.
fn genes(report: &mut Report) {
    let mut text = String::from("| transition | at, h |\n|---|---|\n");
    let run =
        run(&mut shipped(include_str!("../../models/genetic_switch.hy"), &[]), Algorithm::Masim(Form::Plain));
    for name in ["waken", "reach", "flush", "dim", "fade"] {
        let of = run.events.iter().filter(|event| event.transition == format!("Colony.{name}"));
        let times: Vec<String> = of.map(|event| format!("{:.4}", event.time / 3600.0)).collect();
        let _ = writeln!(text, "| `{name}` | {} |", times.join(", "));
    }
    report.table("genes", &text);
}
