//! What the paper argues and does not measure: the spread of time scales, many agents, the choice of gamma; and what an
//! optimistic simulation would roll back.

use std::fmt::Write as _;

use hyc::runtime::paper::{Algorithm, Form, Paper};

use crate::arena::{COSTS, SEEDS, Trio, UNTIL, mean, run, trio};
use crate::cars::{SPREAD, bumper};
use crate::figure::{Style, falling_panel, figure, log_panel, panel, series};
use crate::report::Report;

/// S against the spread of the agents' time scales: 20 cars, 1e-5.
pub fn spread(report: &mut Report, tick: &dyn Fn(&str)) {
    const SPREADS: [f64; 4] = [1.0, 4.0, 40.0, 400.0];
    let mut text = String::from(
        "| spread of w | S in right-hand sides | in operations | in CPU time | `masim` / sasim-2004: rhs / operations / CPU |\n\
         |---:|---:|---:|---:|---|\n",
    );
    let mut lines = COSTS.map(|(name, _)| (name, Vec::new()));
    for spread in SPREADS {
        tick(&format!("time scales, spread {spread}"));
        let trios: Vec<Trio> = (1..=SEEDS)
            .map(|seed| trio(&mut bumper(20, seed, spread, UNTIL, false), 20, seed, 1e-5, false))
            .collect();
        let s = COSTS.map(|(_, cost)| mean(&trios, |_| true, |t| t.s(cost)));
        let masim =
            COSTS.map(|(_, cost)| format!("{:.3}", mean(&trios, |_| true, |t| t.s_masim(cost)))).join(" / ");
        let _ = writeln!(text, "| {spread} | {:.2} | {:.2} | {:.2} | {masim} |", s[0], s[1], s[2]);
        for ((_, points), s) in lines.iter_mut().zip(s) {
            points.push((spread.log10(), s));
        }
    }
    report.table("spread", &text);
    let all = lines.into_iter().map(|(name, points)| series(name, Style::Chain, points)).collect();
    figure(
        "spread",
        &[falling_panel(
            "S against the spread of time scales (N = 20, 1e-5)",
            "log10 of the spread of w",
            "S",
            all,
        )],
    );
}

/// S for many agents, until 5 s at 1e-3.
pub fn many(report: &mut Report, tick: &dyn Fn(&str)) {
    let mut text = String::from(
        "| N | S rhs / operations / CPU | masim-2004, s | sasim-2004, s | masim, s | polynomials of masim-2004 | its steps |\n\
         |---:|---|---:|---:|---:|---:|---:|\n",
    );
    let mut times = [("sasim-2004", Vec::new()), ("masim-2004", Vec::new()), ("masim", Vec::new())];
    for n in [50, 100, 200, 500] {
        tick(&format!("{n} cars"));
        let trio = trio(&mut bumper(n, 1, SPREAD, 5.0, false), n, 1, 1e-3, false);
        let s = COSTS.map(|(_, cost)| format!("{:.2}", trio.s(cost))).join(" / ");
        let _ = writeln!(
            text,
            "| {n} | {s} | {:.3} | {:.3} | {:.4} | {} | {} |",
            trio.ma.seconds,
            trio.sa.seconds,
            trio.masim.seconds,
            trio.ma.stats.guard_polynomials,
            trio.ma.stats.steps
        );
        for ((_, points), run) in times.iter_mut().zip([&trio.sa, &trio.ma, &trio.masim]) {
            points.push((n as f64, run.seconds));
        }
    }
    let exponent = |points: &[(f64, f64)]| {
        let (first, last) = (points[0], points[points.len() - 1]);
        (last.1 / first.1).ln() / (last.0 / first.0).ln()
    };
    let exponents = times.iter().map(|(name, points)| format!("{name} N^{:.2}", exponent(points)));
    let _ =
        write!(text, "\nCPU time grows from N = 50 to 500 as: {}.", exponents.collect::<Vec<_>>().join(", "));
    report.table("many", &text);
    let all = times.into_iter().map(|(name, points)| series(name, Style::Chain, points)).collect();
    figure("many", &[log_panel("CPU time for 5 s at 1e-3", "N", "s", all)]);
}

/// Missed events and steps against gamma: 20 cars, 1e-4, 30 seeds.
pub fn gamma(report: &mut Report, tick: &dyn Fn(&str)) {
    const SEEDS: u64 = 30;
    let mut text = String::from(
        "| gamma | missed | late | latest, s | seeds without either | steps, mean |\n|---:|---:|---:|---:|---:|---:|\n",
    );
    let (mut misses, mut steps) = (Vec::new(), Vec::new());
    for gamma in [0.0, 0.03, 0.1, 0.3, 0.5, 0.9] {
        tick(&format!("gamma = {gamma}"));
        let algorithm = Algorithm::Masim2004(Paper { gamma, ..Paper::default() });
        let runs: Vec<_> = (1..=SEEDS)
            .map(|seed| run(&mut bumper(20, seed, SPREAD, UNTIL, false), algorithm, 1e-4, true))
            .collect();
        let found: Vec<_> = runs.iter().filter_map(|run| run.stats.misses).collect();
        let missed: u64 = found.iter().map(|m| m.missed).sum();
        let late: u64 = found.iter().map(|m| m.late).sum();
        let latest = found.iter().map(|m| m.latest).fold(0.0, f64::max);
        let right = found.iter().filter(|m| m.missed + m.late == 0).count();
        let mean = runs.iter().map(|run| run.stats.steps as f64).sum::<f64>() / SEEDS as f64;
        let _ =
            writeln!(text, "| {gamma} | {missed} | {late} | {latest:.1e} | {right} of {SEEDS} | {mean:.0} |");
        misses.push((gamma, (missed + late) as f64));
        steps.push((gamma, mean));
    }
    tick("masim");
    let masim = (1..=SEEDS)
        .map(|seed| {
            run(&mut bumper(20, seed, SPREAD, UNTIL, false), Algorithm::Masim(Form::Plain), 1e-4, false)
        })
        .map(|run| run.stats.steps as f64)
        .sum::<f64>();
    let _ = writeln!(text, "| `masim` | | | | | {:.0} |", masim / SEEDS as f64);
    report.table("gamma", &text);
    figure(
        "gamma",
        &[
            panel(
                "Missed or late events, 30 seeds",
                "gamma",
                "events",
                vec![series("", Style::Chain, misses)],
            ),
            panel("Steps", "gamma", "steps of a run, mean", vec![series("", Style::Chain, steps)]),
        ],
    );
}

/// What an optimistic simulation would undo: every car runs ahead to the end of the present window; a car that an event
/// rewrites takes its steps from the event to the end of the window again.
pub fn roll_back(report: &mut Report, tick: &dyn Fn(&str)) {
    tick("roll-back");
    let mut text = String::from(
        "| window, s | steps undone, of all | roll-backs of more than one step, of all rewritten cars |\n|---:|---:|---:|\n",
    );
    let runs: Vec<_> = (1..=SEEDS)
        .map(|seed| {
            run(&mut bumper(20, seed, SPREAD, UNTIL, true), Algorithm::Masim(Form::Plain), 1e-5, false)
        })
        .collect();
    for window in [0.1, 0.5, 2.0, 5.0, UNTIL] {
        let (mut undone, mut all, mut long, mut rewritten) = (0, 0, 0, 0);
        for run in &runs {
            let mut steps: Vec<Vec<f64>> = vec![Vec::new(); 20];
            run.rows.iter().for_each(|row| steps[row.agent.number].push(row.time));
            all += run.stats.steps;
            for event in &run.events {
                let end = ((event.time / window).floor() + 1.0) * window;
                for car in [Some(event.agent), event.other].into_iter().flatten() {
                    let again =
                        steps[car.number].iter().filter(|&&t| t > event.time && t <= end).count() as u64;
                    undone += again;
                    long += u64::from(again > 1);
                    rewritten += 1;
                }
            }
        }
        let _ = writeln!(
            text,
            "| {window} | {:.1} % | {:.0} % |",
            100.0 * undone as f64 / all as f64,
            100.0 * long as f64 / f64::from(rewritten)
        );
    }
    let cuts: u64 = runs.iter().map(|run| run.stats.cuts).sum();
    let events: usize = runs.iter().map(|run| run.events.len()).sum();
    let steps: u64 = runs.iter().map(|run| run.stats.steps).sum();
    let _ = write!(
        text,
        "\n`masim` cut {cuts} segments at {events} events in {steps} steps, and undid none of them."
    );
    report.table("roll_back", &text);
}
