//! Does the paper's integrator do what it says: order 4 against its steps, also across events, kinks and in groups, few
//! restarts, an accurate dense output, the reference's events?

use std::f64::consts::PI;

use hyc::model::ir::Integrator;

use crate::accuracy::{slope, sweep};
use crate::harness::{Case, Run, near};

fn run(text: &str, tolerance: f64) -> Run {
    Case::new(text).integrator(Integrator::Adams).tolerance(tolerance).run()
}

fn of_order_four(points: &[(f64, f64)]) {
    let order = -slope(points);
    assert!((3.6..=4.8).contains(&order), "order {order}: {points:?}");
    for pair in points.windows(2) {
        assert!(pair[1].1 < pair[0].1, "the error falls with the tolerance: {points:?}");
    }
    let last = points.last().expect("a sweep").1;
    assert!(last <= 1e-8, "{points:?}");
}

const OSCILLATOR: &str = "agent A { state x = 1, v = 0  flow { x' = v  v' = -x } }
    system { a = A() }  run { until 10 }";

#[test]
fn a_smooth_flow() {
    let error = |run: &Run| (run.value("a.x") - 10f64.cos()).hypot(run.value("a.v") + 10f64.sin());
    of_order_four(&sweep(|tolerance| run(OSCILLATOR, tolerance), error));
}

#[test]
fn a_flow_that_reads_the_time() {
    let text = "agent A { state x = 1  flow { x' = x*cos(time) } }
        system { a = A() }  run { until 6  record a.x every 0.5 to \"x.csv\" }";
    let worst = |run: &Run| {
        let off = |(time, x): &(f64, f64)| (x - time.sin().exp()).abs();
        run.column("a", 0).iter().map(off).fold(0.0, f64::max)
    };
    of_order_four(&sweep(|tolerance| run(text, tolerance), worst));
}

#[test]
fn across_events() {
    // an elastic wall at -1/2: a phase of -4 pi/3 at each bounce
    let text = "agent A { state x = 1, v = 0  flow { x' = v  v' = -x }  wall: when x <= -0.5 { v := -v } }
        system { a = A() }  run { until 10 }";
    let phase = 10.0 - 2.0 * (4.0 * PI / 3.0);
    of_order_four(&sweep(
        |tolerance| run(text, tolerance),
        |run| {
            assert_eq!(run.times("A.wall").len(), 2);
            assert_eq!(run.stats.starts, 3, "one start at t = 0, one for each event");
            (run.value("a.x") - phase.cos()).hypot(run.value("a.v") + phase.sin())
        },
    ));
}

#[test]
fn the_times_of_events() {
    // the dense output locates them: their error falls as that of the states
    let text = "agent A { state x = 1, v = 0  flow { x' = v  v' = -x }  down: when x <= 0.3 { } }
        system { a = A() }  run { until 12 }";
    let exact = [0.3f64.acos(), 0.3f64.acos() + 2.0 * PI];
    let off = |run: &Run| {
        let times = run.times("A.down");
        assert_eq!(times.len(), 2);
        times.iter().zip(exact).map(|(time, exact)| (time - exact).abs()).fold(0.0, f64::max)
    };
    of_order_four(&sweep(|tolerance| run(text, tolerance), off));
}

#[test]
fn in_a_coupled_group() {
    let text = "agent Mass { link mate: Mass  state x, v = 0
                             flow { x' = v  v' = if mate then mate.x - x else 0 } }
        system { a = Mass(x = 1, mate = b)  b = Mass(x = -1, mate = a) }  run { until 8 }";
    let phase = 2f64.sqrt() * 8.0;
    let error = |run: &Run| {
        assert_eq!(run.stats.starts, 2, "both masses begin once");
        (run.value("a.x") - phase.cos()).hypot(run.value("a.v") / 2f64.sqrt() + phase.sin())
    };
    of_order_four(&sweep(|tolerance| run(text, tolerance), error));
}

#[test]
fn across_a_kink() {
    // half periods pi/sqrt(2) above zero and pi below
    let text = "agent A { state x = 0, v = 1  flow { x' = v  v' = -x - max(x, 0) } }
        system { a = A() }  run { until 8 }";
    let late = 8.0 - 2.0 * PI / 2f64.sqrt() - PI;
    let (x, v) = (-late.sin(), -late.cos());
    let error = |run: &Run| {
        assert_eq!(run.stats.starts, 5, "at t = 0, at the kink there, at three crossings of it");
        (run.value("a.x") - x).hypot(run.value("a.v") - v)
    };
    of_order_four(&sweep(|tolerance| run(text, tolerance), error));
}

#[test]
fn between_its_steps() {
    // the samples lie anywhere in the steps; the worst of them is as good as the end
    let text = "agent A { state x = 1, v = 0  flow { x' = v  v' = -x } }
        system { a = A() }  run { until 10  record a.x every 0.01 to \"x.csv\" }";
    let worst = |run: &Run| {
        let samples = run.column("a", 0);
        assert_eq!(samples.len(), 1001);
        samples.iter().map(|(time, x)| (x - time.cos()).abs()).fold(0.0, f64::max)
    };
    of_order_four(&sweep(|tolerance| run(text, tolerance), worst));
}

#[test]
fn a_step_that_is_refused_leaves_no_trace() {
    // a front that the steps before it do not announce: many are refused there
    let text = "agent A { state x = 0  flow { x' = tanh(100*(time - 3)) } }
        system { a = A() }  run { until 5 }";
    let run = run(text, 1e-9);
    assert!(run.stats.rejected >= 3, "{:?}", run.stats);
    assert_eq!(run.stats.starts, 1);
    near(run.value("a.x"), -1.0, 1e-9 * run.stats.steps as f64);
}

#[test]
fn two_evaluations_a_step() {
    let run = run(OSCILLATOR, 1e-9);
    let stats = &run.stats;
    let start = 2 + 2 * 6;
    assert_eq!(stats.rhs_evaluations, start + 2 * (stats.steps + stats.rejected - 2), "{stats:?}");
}

#[test]
fn only_who_is_written_starts_again() {
    let text = "agent A(v: real) { state x = 0  flow { x' = v + sin(x) }  turn: when x >= 1 { x := 0 } }
        system { a = A(v = 2)  b = A(v = 0.001) }  run { until 5 }";
    let run = run(text, 1e-7);
    assert_eq!(run.stats.starts, 2 + run.times_of("A.turn", "a").len() as u64);
    assert!(run.times_of("A.turn", "b").is_empty());
}

#[test]
fn the_model_can_ask_for_it() {
    let text = OSCILLATOR.replace("until 10", "until 10  integrator adams");
    let asked = Case::new(&text).run();
    let told = Case::new(OSCILLATOR).integrator(Integrator::Adams).run();
    assert_eq!(asked.bits(), told.bits());
    assert_ne!(asked.bits(), Case::new(OSCILLATOR).run().bits());
    assert_eq!(
        Case::new(&text).integrator(Integrator::Auto).run().bits(),
        Case::new(OSCILLATOR).run().bits()
    );
}
