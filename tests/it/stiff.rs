//! Does the method for stiff flows do what it says: order 5 against its steps, also where time is read, across events and
//! kinks and in groups; few steps where a flow is stiff? And is it chosen where it pays, and nowhere else?

use std::f64::consts::PI;

use hyc::model::ir::Integrator;
use hyc::runtime::limits::Limits;

use crate::accuracy::{slope, sweep};
use crate::harness::{Case, Ended, Run, near};

fn run(text: &str, tolerance: f64) -> Run {
    Case::new(text).integrator(Integrator::Stiff).tolerance(tolerance).run()
}

fn auto(text: &str) -> Run {
    Case::new(text).integrator(Integrator::Auto).run()
}

fn of_order_five(points: &[(f64, f64)]) {
    let order = -slope(points);
    // linear flows have a smaller error than the order promises
    assert!((4.5..=6.8).contains(&order), "order {order}: {points:?}");
    for pair in points.windows(2) {
        assert!(pair[1].1 < pair[0].1, "the error falls with the tolerance: {points:?}");
    }
    let last = points.last().expect("a sweep").1;
    assert!(last <= 1e-8, "{points:?}");
}

/// Accepted steps of a method.
fn steps_by(run: &Run, method: &str) -> u64 {
    run.stats.methods.iter().find(|(name, _)| name == method).map_or(0, |(_, steps)| *steps)
}

const OSCILLATOR: &str = "agent A { state x = 1, v = 0  flow { x' = v  v' = -x } }
    system { a = A() }  run { until 10 }";

#[test]
fn a_smooth_flow() {
    let error = |run: &Run| (run.value("a.x") - 10f64.cos()).hypot(run.value("a.v") + 10f64.sin());
    of_order_five(&sweep(|tolerance| run(OSCILLATOR, tolerance), error));
}

#[test]
fn a_flow_that_is_not_linear() {
    // the pendulum from rest at 90 degrees: against steps that are much shorter
    let text = "agent A { state x = 1.5707963267948966, v = 0  flow { x' = v  v' = -sin(x) } }
        system { a = A() }  run { until 10 }";
    let exact = Case::new(text).integrator(Integrator::Tsit5).tolerance(1e-13).run();
    let error =
        |run: &Run| (run.value("a.x") - exact.value("a.x")).hypot(run.value("a.v") - exact.value("a.v"));
    of_order_five(&sweep(|tolerance| run(text, tolerance), error));
}

#[test]
fn a_flow_that_reads_the_time() {
    let text = "agent A { state x = 1  flow { x' = x*cos(time) } }
        system { a = A() }  run { until 6  record a.x every 0.5 to \"x.csv\" }";
    let worst = |run: &Run| {
        let off = |(time, x): &(f64, f64)| (x - time.sin().exp()).abs();
        run.column("a", 0).iter().map(off).fold(0.0, f64::max)
    };
    of_order_five(&sweep(|tolerance| run(text, tolerance), worst));
}

#[test]
fn across_events() {
    // an elastic wall at -1/2: a phase of -4 pi/3 at each bounce
    let text = "agent A { state x = 1, v = 0  flow { x' = v  v' = -x }  wall: when x <= -0.5 { v := -v } }
        system { a = A() }  run { until 10 }";
    let phase = 10.0 - 2.0 * (4.0 * PI / 3.0);
    of_order_five(&sweep(
        |tolerance| run(text, tolerance),
        |run| {
            assert_eq!(run.times("A.wall").len(), 2);
            (run.value("a.x") - phase.cos()).hypot(run.value("a.v") + phase.sin())
        },
    ));
}

#[test]
fn across_events_that_read_the_time() {
    // x = exp(sin t), halved when it falls below 1, at each odd multiple of pi
    let text = "agent A { state x = 1  discrete n: int = 0  flow { x' = x*cos(time) }
                          low: when x <= 0.5^n and cos(time) < 0 { x := x/2  n := n + 1 } }
        system { a = A() }  run { until 12 }";
    let error = |run: &Run| {
        let times = run.times("A.low");
        assert_eq!(times.len(), 2, "{times:?}");
        let late = (times[0] - PI).abs().max((times[1] - 3.0 * PI).abs());
        late.max((run.value("a.x") - 12f64.sin().exp() / 4.0).abs())
    };
    of_order_five(&sweep(|tolerance| run(text, tolerance), error));
}

#[test]
fn in_a_coupled_group_that_reads_the_time() {
    // two masses, both driven: the sum moves freely, the difference as one oscillator
    let text = "agent Mass { link mate: Mass  state x, v = 0
                             flow { x' = v  v' = (if mate then mate.x - x else 0) + time } }
        system { a = Mass(x = 1, mate = b)  b = Mass(x = -1, mate = a) }  run { until 8 }";
    let (phase, drift) = (2f64.sqrt() * 8.0, 8f64.powi(3) / 6.0);
    let error = |run: &Run| {
        let (a, b) = (run.value("a.x") - drift, run.value("b.x") - drift);
        ((a - b) / 2.0 - phase.cos()).hypot((a + b) / 2.0)
    };
    of_order_five(&sweep(|tolerance| run(text, tolerance), error));
}

#[test]
fn across_a_kink() {
    // half periods pi/sqrt(2) above zero and pi below
    let text = "agent A { state x = 0, v = 1  flow { x' = v  v' = -x - max(x, 0) } }
        system { a = A() }  run { until 8 }";
    let late = 8.0 - 2.0 * PI / 2f64.sqrt() - PI;
    let (x, v) = (-late.sin(), -late.cos());
    let error = |run: &Run| (run.value("a.x") - x).hypot(run.value("a.v") - v);
    of_order_five(&sweep(|tolerance| run(text, tolerance), error));
}

#[test]
fn between_its_steps() {
    let text = "agent A { state x = 1, v = 0  flow { x' = v  v' = -x } }
        system { a = A() }  run { until 10  record a.x every 0.01 to \"x.csv\" }";
    let worst = |run: &Run| {
        let samples = run.column("a", 0);
        assert_eq!(samples.len(), 1001);
        samples.iter().map(|(time, x)| (x - time.cos()).abs()).fold(0.0, f64::max)
    };
    of_order_five(&sweep(|tolerance| run(text, tolerance), worst));
}

#[test]
fn a_very_stiff_flow_is_followed_in_few_steps_across_events() {
    // x follows sin t, which it reaches within nanoseconds, also when it has been moved (Prothero & Robinson)
    let text = "agent A { state x = 0  flow { x' = 1e9*(sin(time) - x) + cos(time) }
                          up: when x >= 0.5 { }  kick: when time >= 1.2 { x := 0.8 } }
        system { a = A() }  run { until 2  tolerance 1e-9 }";
    for integrator in [Integrator::Stiff, Integrator::Auto] {
        let run = Case::new(text).integrator(integrator).run();
        near(run.value("a.x"), 2f64.sin(), 1e-9);
        assert_eq!(run.log(), ["0 A.up a", "0 A.kick a"]);
        near(run.events[0].time, 0.5f64.asin(), 1e-9);
        assert_eq!(run.events[1].time, 1.2);
        assert!(run.stats.steps + run.stats.rejected < 500, "{:?}", run.stats);
    }
}

#[test]
fn a_decay_to_rest_is_stiff_once_it_is_over() {
    let text = "agent A(k: real) { state x = 1  flow { x' = -k*x }  gone: when x <= 0.01 { } }
        system { fast = A(k = 1e4)  slow = A(k = 0.1) }  run { until 1000 }";
    let run = auto(text);
    near(run.times_of("A.gone", "fast")[0], 100f64.ln() / 1e4, 1e-8);
    near(run.times_of("A.gone", "slow")[0], 100f64.ln() / 0.1, 1e-2);
    assert!(run.stats.steps < 400, "{:?}", run.stats);
    assert!(steps_by(&run, "stiff") > 0 && steps_by(&run, "taylor") > 0, "{:?}", run.stats.methods);
}

#[test]
fn a_rod_of_coupled_cells_cools_by_its_first_mode() {
    // the slowest mode of the rod at first: it decays at 2 k (1 - cos(pi/(n + 1))), the fastest 1500 times as fast
    let text = "agent Cell(k: real) { link left: Cell  link right: Cell  state u
                  flow { u' = k*((if left then left.u else 0) + (if right then right.u else 0) - 2*u) }
                  half: when rising(u <= 0.5) { } }
        system { rod = Cell[60](k = 3721, u = sin(pi*(index + 1)/61),
                                left = if index == 0 then none else rod[index - 1],
                                right = if index == 59 then none else rod[index + 1]) }
        run { until 1  tolerance 1e-8 }";
    let decay = 2.0 * 3721.0 * (1.0 - (PI / 61.0).cos());
    for integrator in [Integrator::Stiff, Integrator::Auto] {
        let run = Case::new(text).integrator(integrator).run();
        assert_eq!(run.events.len(), 40);
        for cell in 10..50 {
            let begin = (PI * f64::from(cell + 1) / 61.0).sin();
            let time = run.times_of("Cell.half", &format!("rod[{cell}]"))[0];
            near(time, (2.0 * begin).ln() / decay, 1e-8);
            near(run.value(&format!("rod[{cell}].u")), begin * (-decay).exp(), 1e-8);
        }
        let steps = (run.stats.steps + run.stats.rejected) / 60;
        assert!(steps < 150, "{steps}");
        assert!(steps_by(&run, "stiff") >= 30 * 60, "{:?}", run.stats.methods);
    }
}

#[test]
fn the_choice_is_made_for_each_agent_and_mode_and_remembered() {
    // in Fast x is where it wants to be within microseconds; each mode lasts a second, a thousand times
    let text = "agent A { state x = 0, y = 0, age = 0
                          initial mode Slow { flow { x' = 1 - x  y' = x  age' = 1 }
                                              leave: when age >= 1 -> Fast { age := 0 } }
                          mode Fast { flow { x' = 1e6*(cos(y) - x)  y' = x  age' = 1 }
                                      back: when age >= 1 -> Slow { age := 0 } } }
        system { a = A() }  run { until 1000 }";
    let run = auto(text);
    assert!(run.events.len() >= 999);
    // were each visit to begin with explicit steps again, 32 and more of them would come before the stiff ones
    let explicit = steps_by(&run, "taylor");
    assert!(explicit < 500 * 30, "{:?}", run.stats.methods);
    let limits = Limits { steps_max: 100_000, ..Limits::default() };
    let (_, error) = Case::new(text).integrator(Integrator::Tsit5).until(3.0).limits(limits).run_error();
    assert_eq!(error.code, "HY0508");
}

#[test]
fn the_methods_events_agree() {
    let text = "agent A { state x = 1, v = 0  flow { x' = v  v' = -x - 1e3*(v + sin(x)) }
                          down: when x <= 0.5 { }  again: when x <= 0.01 { x := 1 } }
        system { a = A() }  run { until 30  tolerance 1e-9 }";
    let runs = [Integrator::Tsit5, Integrator::Stiff, Integrator::Auto]
        .map(|integrator| Case::new(text).integrator(integrator).run());
    assert!(runs[0].events.len() >= 10);
    for run in &runs[1..] {
        assert_eq!(run.log(), runs[0].log());
        for (event, other) in run.events.iter().zip(&runs[0].events) {
            near(event.time, other.time, 1e-6);
        }
        assert!(run.stats.steps < runs[0].stats.steps / 3, "{:?} {:?}", run.stats, runs[0].stats);
    }
}

#[test]
fn what_is_not_stiff_is_left_alone() {
    // at loose tolerances h omega is near the edge of stability, and still it is no stiffness
    for tolerance in [1e-2, 1e-3, 1e-6, 1e-12] {
        let texts = [
            OSCILLATOR.replace("until 10", "until 500"),
            OSCILLATOR
                .replace("v' = -x", "v' = -1e6*x")
                .replace("x = 1", "x = 1e-3")
                .replace("until 10", "until 1"),
            "agent A { state x = 0, y = 1, z = 20
                       flow { x' = 10*(y - x)  y' = x*(28 - z) - y  z' = x*y - 8/3*z } }
             system { a = A() }  run { until 50 }"
                .to_string(),
        ];
        for text in texts {
            let [auto, taylor] = [Integrator::Auto, Integrator::Taylor]
                .map(|integrator| Case::new(&text).integrator(integrator).tolerance(tolerance).run());
            assert_eq!(steps_by(&auto, "stiff"), 0, "{text} {tolerance}");
            assert_eq!(auto.bits(), taylor.bits());
        }
    }
}

#[test]
fn shipped_models_that_are_not_stiff_are_left_alone() {
    // Cars that follow at rest with each other move slowly along a flow that is fast: the other method pays there.
    let stiff = ["robertson.hy", "van_der_pol.hy", "highway.hy"];
    let mut models: Vec<String> = std::fs::read_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/models"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .filter(|name| name.ends_with(".hy") && !stiff.contains(&name.as_str()))
        .collect();
    models.sort();
    assert!(models.len() >= 20);
    for name in models {
        let [auto, taylor] = [Integrator::Auto, Integrator::Taylor]
            .map(|integrator| Case::shipped(&name).integrator(integrator).run_any());
        assert_eq!(steps_by(&auto, "stiff"), 0, "{name}");
        assert!(auto.bits() == taylor.bits(), "{name}");
    }
}

#[test]
fn a_jacobian_that_is_infinite_stops_nothing() {
    // the slope of the root is infinite where it begins
    let text = "agent A { state x = 0  flow { x' = 1 + sqrt(x) }  when x >= 1 { } }
        system { a = A() }  run { until 1  tolerance 1e-8 }";
    let run = run(text, 1e-8);
    assert_eq!(run.end, Ended::Until);
    // t = 2 (r - log(1 + r)) with r = sqrt(x)
    let r = run.value("a.x").sqrt();
    near(2.0 * (r - (1.0 + r).ln()), 1.0, 1e-6);
}

#[test]
fn an_undefined_flow_is_reported_as_ever() {
    let text = "agent A { state x = 1  flow { x' = -sqrt(x) - 0.1 } }  system { a = A() }  run { until 9 }";
    let (_, explicit) = Case::new(text).integrator(Integrator::Tsit5).run_error();
    let (_, stiff) = Case::new(text).integrator(Integrator::Stiff).run_error();
    assert_eq!(stiff.code, explicit.code);
}

#[test]
fn the_model_can_ask_for_it() {
    let text = OSCILLATOR.replace("until 10", "until 10  integrator stiff");
    let asked = Case::new(&text).run();
    let told = Case::new(OSCILLATOR).integrator(Integrator::Stiff).run();
    assert_eq!(asked.bits(), told.bits());
    assert_eq!(asked.stats.methods, [("stiff".to_string(), asked.stats.steps)]);
    assert_ne!(asked.bits(), Case::new(OSCILLATOR).run().bits());
}
