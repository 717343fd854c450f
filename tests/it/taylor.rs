//! Do steps by Taylor series do what they say: errors that fall with the tolerance, also across events and kinks, long steps
//! when it is tight, another method where there is no series, the reference's events?

use std::f64::consts::PI;

use hyc::codegen;
use hyc::model::ir::Integrator;

use crate::harness::{Case, Ended, Run, integral, near};

fn run(text: &str, tolerance: f64) -> Run {
    Case::new(text).integrator(Integrator::Taylor).tolerance(tolerance).run()
}

/// Fails unless the error stays below so many tolerances, from loose to tight.
fn falls_with_the_tolerance(text: &str, factor: f64, error: impl Fn(&Run) -> f64) {
    for tolerance in [1e-3, 1e-5, 1e-7, 1e-9, 1e-11] {
        let found = error(&run(text, tolerance));
        assert!(found <= factor * tolerance, "{found:e} at {tolerance:e}");
    }
}

const OSCILLATOR: &str = "agent A { state x = 1, v = 0  flow { x' = v  v' = -x } }
    system { a = A() }  run { until 10 }";

#[test]
fn a_smooth_flow() {
    falls_with_the_tolerance(OSCILLATOR, 20.0, |run| {
        (run.value("a.x") - 10f64.cos()).hypot(run.value("a.v") + 10f64.sin())
    });
}

#[test]
fn long_steps_where_the_tolerance_is_tight() {
    let tsit5 = Case::new(OSCILLATOR).integrator(Integrator::Tsit5).tolerance(1e-10).run();
    let taylor = run(OSCILLATOR, 1e-10);
    assert!(taylor.stats.steps * 8 < tsit5.stats.steps, "{} {}", taylor.stats.steps, tsit5.stats.steps);
    assert_eq!(taylor.stats.rejected, 0);
}

#[test]
fn a_flow_that_reads_the_time_and_its_dense_output() {
    let text = "agent A { state x = 1  flow { x' = x*cos(time) } }
        system { a = A() }  run { until 6  record a.x every 0.05 to \"x.csv\" }";
    falls_with_the_tolerance(text, 50.0, |run| {
        let off = |(time, x): &(f64, f64)| (x - time.sin().exp()).abs();
        run.column("a", 0).iter().map(off).fold(0.0, f64::max)
    });
}

#[test]
fn across_events() {
    // an elastic wall at -1/2: a phase of -4 pi/3 at each bounce
    let text = "agent A { state x = 1, v = 0  flow { x' = v  v' = -x }  wall: when x <= -0.5 { v := -v } }
        system { a = A() }  run { until 10 }";
    let phase = 10.0 - 2.0 * (4.0 * PI / 3.0);
    falls_with_the_tolerance(text, 20.0, |run| {
        assert_eq!(run.times("A.wall").len(), 2);
        (run.value("a.x") - phase.cos()).hypot(run.value("a.v") + phase.sin())
    });
}

#[test]
fn across_kinks() {
    // x' = |sin t|: 2 for each half turn
    let text = "agent A { state x = 0, s = 0, c = 1  flow { x' = abs(s)  s' = c  c' = -s } }
        system { a = A() }  run { until 10 }";
    falls_with_the_tolerance(text, 50.0, |run| {
        (run.value("a.x") - (6.0 + 1.0 - (10.0 - 3.0 * PI).cos())).abs()
    });
}

#[test]
fn an_angle_across_its_cut() {
    // (x, y) turns; the angle jumps from pi to -pi at t = pi
    let text = "agent A { state a = 0, x = 1, y = 0  flow { a' = atan2(y, x)  x' = -y  y' = x } }
        system { a = A() }  run { until 5 }";
    let exact = PI * PI / 2.0 + ((5.0 - 2.0 * PI).powi(2) - PI * PI) / 2.0;
    falls_with_the_tolerance(text, 50.0, |run| (run.value("a.a") - exact).abs());
}

#[test]
fn the_terms_that_say_the_step_may_vanish_by_chance() {
    // cos(t^2) has every fourth coefficient, cos(t^4) every eighth
    for (power, tolerance) in [(2, 1e-4), (2, 1e-7), (2, 1e-9), (4, 1e-6), (4, 1e-9)] {
        let text = format!(
            "agent A {{ state x = 0  flow {{ x' = cos(time^{power}) }} }}
             system {{ a = A() }}  run {{ until 3 }}"
        );
        let exact = integral(|t| t.powi(power).cos(), 0.0, 3.0);
        near(run(&text, tolerance).value("a.x"), exact, 50.0 * tolerance);
    }
}

#[test]
fn no_step_goes_on_beyond_a_branch_point() {
    // x = (1 - t/2)^2 up to t = 2, which as a polynomial would rise again: there x' would be +sqrt(x)
    let text = "agent A { state x = 1  flow { x' = -sqrt(x) }  low: when x <= 0.0001 { } }
        system { a = A() }  run { until 1.99 }";
    let found = run(text, 1e-8);
    near(found.times("A.low")[0], 1.98, 1e-6);
    let on = Case::new(&text.replace("1.99", "3")).integrator(Integrator::Taylor).tolerance(1e-8).run_any();
    match on.end {
        Ended::Error(_) => near(on.time, 2.0, 1e-3),
        _ => assert!(on.value("a.x").abs() < 1e-6, "{}", on.value("a.x")),
    }
}

#[test]
fn a_series_that_is_not_finite_is_left_to_the_other_method() {
    // the root has no series at 0: with u = sqrt(x), t = 2 u - 2 log(1 + u)
    let text = "agent A { state x = 0  flow { x' = 1 + sqrt(x) } }
        system { a = A() }  run { until 1 }";
    let u = run(text, 1e-8).value("a.x").sqrt();
    near(2.0 * u - 2.0 * u.ln_1p(), 1.0, 1e-5);
}

#[test]
fn who_reads_others_goes_by_the_other_method() {
    let text = "agent A { state x = 1  link o: A  flow { x' = if o then -o.x else 0 } }
        system { a = A(o = b)  b = A(o = a) }  run { until 3 }";
    let other = Case::new(text).integrator(Integrator::Tsit5).run();
    let same = Case::new(text).integrator(Integrator::Taylor).run();
    assert_eq!(other.bits(), same.bits());
}

#[test]
fn what_falls_is_exact_at_once() {
    let text = "agent Ball { state h = 1, v = 0  flow { h' = v  v' = -2 }  bounce: when h <= 0 { v := -v } }
        system { ball = Ball() }  run { until 4 }";
    let found = run(text, 1e-6);
    near(found.times("Ball.bounce")[0], 1.0, 1e-12);
    near(found.times("Ball.bounce")[1], 3.0, 1e-12);
    assert!(found.stats.steps <= 3, "a parabola is one step: {:?}", found.stats);
}

#[test]
fn the_model_can_ask_for_it() {
    let text = OSCILLATOR.replace("until 10", "until 10  integrator taylor");
    let asked = Case::new(&text).run();
    assert_eq!(asked.bits(), Case::new(OSCILLATOR).integrator(Integrator::Taylor).run().bits());
    assert_ne!(asked.bits(), Case::new(OSCILLATOR).integrator(Integrator::Tsit5).run().bits());
}

#[test]
fn the_listing_says_which_modes_have_a_series() {
    let text = "agent A { state x = 1  link o: A
          initial mode Alone { flow { x' = -x }  when x <= 0.5 -> Led }
          mode Led { flow { x' = if o then o.x - x else 0 } } }
        system { a = A(o = b)  b = A(o = a) }  run { until 3 }";
    let (_, system, _) = Case::new(text).system();
    let listing = codegen::dump_tape(&system);
    assert!(listing.contains("A.Alone flow series: 2 recurrences"), "{listing}");
    assert!(listing.contains("A.Led flow has no series: it reads other agents' states"), "{listing}");
}

#[test]
fn a_pulse_that_leaves_no_trace_in_the_series_before_it_is_seen() {
    for integrator in [Integrator::Auto, Integrator::Taylor] {
        let run = Case::new(
            "agent A { state y = 0  flow { y' = tanh(20*sin(4*time)) } }
             agent B { state y = 0  flow { y' = sin(time)^50 }  full: when y >= 1 {} }
             agent C { state y = 0  flow { y' = exp(-(time - 10)^2) } }
             agent E { state y = 0  flow { y' = tanh(50*sin(time)) } }
             system { a = A()  b = B()  c = C()  e = E() }
             run { until 50  tolerance 1e-9 }",
        )
        .integrator(integrator)
        .run();
        let expected = [
            ("a", integral(|t| (20.0 * (4.0 * t).sin()).tanh(), 0.0, 50.0)),
            ("b", integral(|t| t.sin().powi(50), 0.0, 50.0)),
            ("c", std::f64::consts::PI.sqrt()),
            ("e", integral(|t| (50.0 * t.sin()).tanh(), 0.0, 50.0)),
        ];
        for (agent, expected) in expected {
            near(run.value(&format!("{agent}.y")), expected, 1e-6);
        }
        assert_eq!(run.times("B.full").len(), 1);
    }
}
