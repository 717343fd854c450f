//! Are guards found that hardly become true, and left alone that hardly do not?
//!
//! The flows are polynomials in time, integrated exactly, so that what is tested is the detection.

use std::f64::consts::PI;

use crate::harness::{Run, all_near, near, simulate};

/// x = t on an agent with one guard `hit`.
fn clock(guard: &str, until: f64) -> Vec<f64> {
    clock_run(guard, until).times("A.hit")
}

fn clock_run(guard: &str, until: f64) -> Run {
    simulate(&format!(
        "agent A {{ state x = 0  flow {{ x' = 1 }}  hit: when {guard} {{ }} }}
         system {{ a = A() }}  run {{ until {until}  tolerance 1e-10 }}"
    ))
}

/// x = (t - 1)^2 + least, as a state with x'' = 2.
fn parabola(least: &str, guard: &str) -> Vec<f64> {
    let run = simulate(&format!(
        "agent A {{ state x = 1 + {least}, v = -2  flow {{ x' = v  v' = 2 }}  hit: when {guard} {{ }} }}
         system {{ a = A() }}  run {{ until 3  tolerance 1e-10 }}"
    ));
    run.times("A.hit")
}

#[test]
fn a_dip_of_1e_4_time_units_is_found() {
    // below zero from 1 - 5e-5 to 1 + 5e-5
    all_near(&parabola("(-2.5e-9)", "x <= 0"), &[1.0 - 5e-5], 1e-10);
    all_near(&parabola("(-2.5e-9)", "x < 0"), &[1.0 - 5e-5], 1e-10);
    all_near(&clock("(x - 1)^2 <= 2.5e-9", 3.0), &[1.0 - 5e-5], 1e-10);
    all_near(&clock("(time - 1)^2 < 2.5e-9", 3.0), &[1.0 - 5e-5], 1e-10);
}

#[test]
fn a_guard_that_clears_zero_by_1e_6_gives_no_event() {
    all_near(&parabola("1e-6", "x <= 0"), &[], 0.0);
    all_near(&parabola("1e-6", "x < 0"), &[], 0.0);
    all_near(&clock("(x - 1)^2 + 1e-6 <= 0", 3.0), &[], 0.0);
    all_near(&clock("(x - 1)^2 + 1e-12 <= 0", 3.0), &[], 0.0);
    all_near(&clock("sin(x) >= 1.000001", 3.0), &[], 0.0);
    all_near(&clock("sin(x) >= 0.999999", 3.0), &[0.999999f64.asin()], 1e-10);
}

#[test]
fn dips_of_many_widths() {
    for exponent in 1..=10 {
        let half = 0.3f64.powi(exponent);
        let times = clock(&format!("(x - 1.23456789)^2 <= {:e}", half * half), 3.0);
        all_near(&times, &[1.23456789 - half], 1e-10);
    }
}

#[test]
fn a_pair_that_grazes() {
    // two cars pass at a distance of 1; the guard's radius is a little more or less
    let text = |r: &str| {
        format!(
            "agent Car(v: real) {{ state x, y  flow {{ x' = v  y' = 0 }} }}
             interaction Near(a: Car, b: Car) {{ pair: when (a.x - b.x)^2 + (a.y - b.y)^2 <= {r}^2 {{ }} }}
             system {{ a = Car(v = 1, x = -5, y = 0)  b = Car(v = -1, x = 5, y = 1) }}  run {{ until 10 }}"
        )
    };
    assert_eq!(simulate(&text("0.999999")).log(), [""; 0]);
    // 4 (t - 5)^2 + 1 = r^2
    let r: f64 = 1.000001;
    all_near(&simulate(&text("1.000001")).times("Near.pair"), &[5.0 - (r * r - 1.0).sqrt() / 2.0], 1e-10);
}

#[test]
fn a_fast_guard_on_a_constant_state_fires_every_time() {
    let run = simulate(
        "agent A { state c = 1  flow { c' = 0 }  hit: when c*sin(50*time) <= 0 { } }
         system { a = A() }  run { until 10 }",
    );
    let mut expected = vec![0.0];
    expected.extend((0..).map(|k| f64::from(2 * k + 1) * PI / 50.0).take_while(|time| *time <= 10.0));
    assert_eq!(expected.len(), 81);
    all_near(&run.times("A.hit"), &expected, 1e-11);
    let run = simulate(
        "agent A { state c = 1  flow { c' = 0 }  hit: when crossing(c*sin(50*time)) { } }
         system { a = A() }  run { until 10 }",
    );
    let expected: Vec<f64> =
        (1..).map(|k| f64::from(k) * PI / 50.0).take_while(|time| *time <= 10.0).collect();
    all_near(&run.times("A.hit"), &expected, 1e-11);
}

#[test]
fn a_fast_guard_that_hardly_reaches() {
    // 1 - sin(50 t) <= 1e-8: true for 6e-6 around each top
    let width = (1.0 - 1e-8f64).asin();
    let expected: Vec<f64> =
        (0..).map(|k| (width + 2.0 * PI * f64::from(k)) / 50.0).take_while(|time| *time <= 3.0).collect();
    all_near(&clock("sin(50*x) >= 1 - 1e-8", 3.0), &expected, 1e-9);
    all_near(&clock("sin(50*x) >= 1 + 1e-8", 3.0), &[], 0.0);
}

#[test]
fn true_at_the_start_fires_at_the_start() {
    assert_eq!(clock("x <= 0", 1.0), [0.0]);
    assert_eq!(clock("x <= 5", 1.0), [0.0]);
    assert_eq!(clock("x >= 0", 1.0), [0.0]);
    assert_eq!(clock("x > 0", 1.0), [0.0]);
    assert_eq!(clock("x > -1", 1.0), [0.0]);
}

#[test]
fn a_flow_that_is_not_defined_beyond_its_guard() {
    let run = simulate(
        "agent A { state x = 0, y = 0
           initial mode Go { flow { x' = 1  y' = sqrt(1 - x) }  end: when x >= 1 -> Done }
           mode Done { flow { x' = 0  y' = 0 } } }
         system { a = A() }  run { until 2  tolerance 1e-10 }",
    );
    all_near(&run.times("A.end"), &[1.0], 1e-9);
    near(run.value("a.y"), 2.0 / 3.0, 1e-7);
    // x' = sqrt(1 - x): x = 1 - (1 - t/2)^2, which only touches 1; the state's error of 1e-10 is one of 1e-5 in time
    let run = simulate(
        "agent A { state x = 0
           initial mode Go { flow { x' = sqrt(1 - x) }  end: when x >= 1 -> Done }
           mode Done { flow { x' = 0 } } }
         system { a = A() }  run { until 3  tolerance 1e-10 }",
    );
    all_near(&run.times("A.end"), &[2.0], 1e-3);
    near(run.value("a.x"), 1.0, 1e-8);
}

#[test]
fn a_flow_that_is_not_defined_beyond_a_guard_of_time() {
    // 1/(2 - t) up to t = 1.75, as the logarithm's rate: y = log(2/(2 - t))
    let run = simulate(
        "agent A { state y = 0
           initial mode Go { flow { y' = 1/(2 - time) }  end: when time >= 1.75 -> Done }
           mode Done { flow { y' = 0 } } }
         system { a = A() }  run { until 3  tolerance 1e-10 }",
    );
    near(run.value("a.y"), 8f64.ln(), 1e-8);
}

#[test]
fn exactly_zero_after_a_reset() {
    let text = |guard: &str, v: &str| {
        format!(
            "agent A {{ state x = 5  discrete v = 0
                        flow {{ x' = v }}
                        put: after 1 {{ x := 0  v := {v} }}
                        hit: when {guard} {{ }}
                        turn: after 2 {{ v := -({v}) }} }}
             system {{ a = A() }}  run {{ until 4 }}"
        )
    };
    // x = v (t - 1) from 1 to 2, back at zero at 3, then on the other side
    let at = |guard: &str, v: &str| simulate(&text(guard, v)).times("A.hit");
    all_near(&at("x <= 0", "1"), &[1.0, 3.0], 1e-11);
    all_near(&at("x < 0", "1"), &[3.0], 1e-11);
    all_near(&at("x <= 0", "-1"), &[1.0], 1e-11);
    all_near(&at("x < 0", "-1"), &[1.0], 1e-11);
    all_near(&at("x <= 0", "0"), &[1.0], 1e-11);
    all_near(&at("x < 0", "0"), &[], 0.0);
    all_near(&at("crossing(x)", "-1"), &[1.0, 3.0], 1e-11);
    all_near(&at("crossing(x)", "1"), &[3.0], 1e-11);
}

#[test]
fn a_body_that_sticks_and_lets_go() {
    // it comes to rest at x = 0 with v = 0 (g = dg/dt = 0), is let go upwards at 2, and lands once
    let run = simulate(
        "agent Body { state x = 0.5, v = -1  discrete a = 1
           initial mode Fly { flow { x' = v  v' = a }  land: when x <= 0 -> Stick { x := 0  v := 0 }
                              fall: after 1.5 { a := -1 } }
           mode Stick { flow { x' = 0  v' = 0 }
                        lift: when time >= 2 and time < 2.5 -> Fly { a := 1 } } }
         system { body = Body() }  run { until 10 }",
    );
    // x = (1 - t)^2/2 touches zero at 1. Up from 2: x = s^2/2 until s = 1.5, v = 1.5, x = 1.125; then a = -1:
    // 1.125 + 1.5 u - u^2/2 = 0 at u = 1.5 + sqrt(4.5)
    assert_eq!(
        run.log(),
        [
            "0 Body.land body Fly->Stick",
            "0 Body.lift body Stick->Fly",
            "0 Body.fall body",
            "0 Body.land body Fly->Stick"
        ]
    );
    near(run.events[0].time, 1.0, 1e-6);
    near(run.events[1].time, 2.0, 1e-11);
    near(run.events[2].time, 3.5, 1e-11);
    near(run.events[3].time, 5.0 + 4.5f64.sqrt(), 1e-10);
    assert_eq!(run.mode("body"), "Stick");
}

#[test]
fn a_body_that_is_let_go_while_its_guard_stays_true() {
    // resting on the floor with `x <= 0` true and fired; pushed up, it lands again
    let run = simulate(
        "agent Body { state x = 0, v = 0  discrete a = 0, n = 0
           flow { x' = v  v' = a }
           floor_hit: when x <= 0 { x := 0  v := 0  a := 0  n := n + 1 }
           push: after 1 { a := 1 }
           let_go: after 2 { a := -1 } }
         system { body = Body() }  run { until 8 }",
    );
    // up: 1/2 at t = 2 with v = 1, then 1/2 + u - u^2/2 = 0 at u = 1 + sqrt 2
    all_near(&run.times("Body.floor_hit"), &[0.0, 3.0 + 2f64.sqrt()], 1e-10);
    near(run.value("body.x"), 0.0, 1e-15);
}

#[test]
fn a_root_at_the_end_of_a_step() {
    // at the end of the run; at a kink, at which every step ends; at another's event; at a scheduled time
    all_near(&clock("x >= 3", 3.0), &[3.0], 1e-11);
    all_near(&clock("(x - 3)^2 <= 0", 3.0), &[3.0], 1e-7);
    let run = simulate(
        "agent A { state x = 0, y = 0  flow { x' = 1  y' = abs(x - 1) }
                   hit: when x >= 1 { }  strict: when x > 1 { }  through: when crossing(x - 1) { }
                   tick: every 1 { y := y } }
         system { a = A() }  run { until 3 }",
    );
    for label in ["A.hit", "A.strict", "A.through"] {
        all_near(&run.times(label), &[1.0], 1e-11);
    }
    assert_eq!(run.times("A.tick"), [1.0, 2.0, 3.0]);
}

#[test]
fn a_root_at_every_tick() {
    // sin(pi t) has a root at each tick of a clock that cuts the steps
    let run = simulate(
        "agent A { state x = 0  discrete d = 1  flow { x' = d }
                   up: when crossing(sin(pi*time)) { }
                   tick: every 1 { d := -d } }
         system { a = A() }  run { until 10.5 }",
    );
    let expected: Vec<f64> = (1..=10).map(f64::from).collect();
    all_near(&run.times("A.up"), &expected, 1e-11);
}

#[test]
fn two_crossings_in_one_step() {
    all_near(&clock("(x - 1)*(x - 1.001) <= 0", 10.0), &[1.0], 1e-10);
    all_near(&clock("(x - 1)*(x - 1.001) >= 0", 10.0), &[0.0, 1.001], 1e-10);
    all_near(&clock("(x - 1)*(x - 1.000001) < 0", 10.0), &[1.0], 1e-9);
    all_near(&clock("x >= 1 and x <= 1.00001", 10.0), &[1.0], 1e-11);
    all_near(&clock("x < 1 or x >= 1.00001", 10.0), &[0.0, 1.00001], 1e-11);
}

#[test]
fn three_crossings_in_one_step() {
    all_near(&clock("crossing((x - 1)*(x - 2)*(x - 3))", 10.0), &[1.0, 2.0, 3.0], 1e-10);
    all_near(&clock("(x - 1)*(x - 2)*(x - 3) >= 0", 10.0), &[1.0, 3.0], 1e-10);
    all_near(&clock("(x - 1)*(x - 2)*(x - 3) <= 0", 10.0), &[0.0, 2.0], 1e-10);
}

#[test]
fn jumps_of_a_guard() {
    all_near(&clock("floor(x) >= 2", 10.0), &[2.0], 1e-11);
    all_near(&clock("mod(x, 1) >= 0.5", 3.0), &[0.5, 1.5, 2.5], 1e-11);
    all_near(&clock("mod(x, 1) < 0.5", 3.2), &[0.0, 1.0, 2.0, 3.0], 1e-11);
    all_near(&clock("sign(x - 1) > 0", 3.0), &[1.0], 1e-11);
    all_near(&clock("(if x < 1 then -1 else 1) >= 0", 3.0), &[1.0], 1e-11);
    all_near(&clock("atan2(sin(x), cos(x)) < 0", 7.0), &[PI], 1e-11);
    all_near(&clock("abs(x - 1) <= 0.25", 3.0), &[0.75], 1e-11);
    all_near(&clock("max(x, 2*x - 3) >= 4", 8.0), &[3.5], 1e-11);
    all_near(&clock("min(x, 2) >= 2", 8.0), &[2.0], 1e-11);
}

#[test]
fn singular_rates() {
    // the distance to (3, 0) of a body that runs through it, the root of which has an infinite rate
    all_near(&clock("sqrt((x - 3)^2) <= 0.001", 8.0), &[2.999], 1e-11);
    all_near(&clock("hypot(x - 3, 0) <= 0.001", 8.0), &[2.999], 1e-11);
    all_near(&clock("sqrt(x) >= 1.5", 8.0), &[2.25], 1e-11);
    all_near(&clock("cbrt(x - 3) >= 0", 8.0), &[3.0], 1e-10);
    all_near(&clock("acos(1 - x) >= 1.5", 1.9), &[1.0 - 1.5f64.cos()], 1e-11);
}

/// What the four relations do in one situation: g(t), and the times for `g <= 0` and for `g < 0`.
fn pairing(g: &str, run: &dyn Fn(&str) -> Vec<f64>, weak: &[f64], strict: &[f64], tolerance: f64) {
    let guards = [
        (format!("{g} <= 0"), weak),
        (format!("{g} < 0"), strict),
        (format!("-({g}) >= 0"), weak),
        (format!("-({g}) > 0"), strict),
        (format!("0 >= {g}"), weak),
        (format!("0 > {g}"), strict),
    ];
    for (guard, expected) in guards {
        let times = run(&guard);
        let agree = times.len() == expected.len()
            && times.iter().zip(expected).all(|(a, b)| (a - b).abs() <= tolerance);
        assert!(agree, "{guard}: {times:?}, expected {expected:?}");
    }
}

#[test]
fn pairings_touch() {
    let run = |guard: &str| clock(guard, 3.0);
    // from outside: true at a single point, then never
    pairing("(x - 1)^2", &run, &[1.0], &[], 1e-7);
    // from inside: true from the start, false (if strict) at a single point, which does not arm
    pairing("(-(x - 1)^2)", &run, &[0.0], &[0.0], 0.0);
}

#[test]
fn pairings_cross() {
    let run = |guard: &str| clock(guard, 3.0);
    pairing("(1 - x)", &run, &[1.0], &[1.0], 1e-11);
    pairing("(x - 1)", &run, &[0.0], &[0.0], 0.0);
    pairing("(1 - x)*(2 - x)", &run, &[1.0], &[1.0], 1e-11);
    pairing("(-(1 - x)*(2 - x))", &run, &[0.0, 2.0], &[0.0, 2.0], 1e-11);
}

#[test]
fn pairings_start_at_zero() {
    let run = |guard: &str| clock(guard, 3.0);
    // moving in; moving out; in and out with a rate of zero; out and in again
    pairing("(-x)", &run, &[0.0], &[0.0], 0.0);
    pairing("x", &run, &[0.0], &[], 0.0);
    pairing("(-x^2)", &run, &[0.0], &[0.0], 1e-7);
    pairing("x^2", &run, &[0.0], &[], 0.0);
    pairing("x*(2 - x)", &run, &[0.0, 2.0], &[2.0], 1e-11);
    pairing("x^3", &run, &[0.0], &[], 0.0);
}

#[test]
fn pairings_stay_at_zero() {
    let run = |guard: &str| {
        simulate(&format!(
            "agent A {{ state x = 0, y = 1  flow {{ x' = 0  y' = -y }}  hit: when {guard} {{ }} }}
             system {{ a = A() }}  run {{ until 3 }}"
        ))
        .times("A.hit")
    };
    pairing("x", &run, &[0.0], &[], 0.0);
    pairing("(x*y)", &run, &[0.0], &[], 0.0);
}

#[test]
fn pairings_leave_zero() {
    // x stays at zero until 1, then leaves it at the rate v
    let run = |v: &str, guard: &str| {
        simulate(&format!(
            "agent A {{ state x = 0  discrete v = 0  flow {{ x' = v }}  go: after 1 {{ v := {v} }}  hit: when {guard} {{ }} }}
             system {{ a = A() }}  run {{ until 3 }}"
        ))
        .times("A.hit")
    };
    pairing("x", &|guard| run("-1", guard), &[0.0], &[1.0], 1e-11);
    pairing("x", &|guard| run("1", guard), &[0.0], &[], 1e-11);
}

#[test]
fn pairings_arrive_and_stay() {
    // x comes down to zero at 1 and stays there
    let run = |guard: &str| {
        simulate(&format!(
            "agent A {{ state x = 1  discrete v = -1  flow {{ x' = v }}
                        halt: when x <= 0 {{ v := 0  x := 0 }}  hit: when {guard} {{ }} }}
             system {{ a = A() }}  run {{ until 3 }}"
        ))
        .times("A.hit")
    };
    for guard in ["x <= 0", "-x >= 0"] {
        all_near(&run(guard), &[1.0], 1e-11);
    }
}

#[test]
fn kinks_of_a_guard_in_one_step() {
    // the first of four roots, three turns of the guard apart
    all_near(&clock("abs(abs(x - 1) - 0.5) <= 0.1", 3.0), &[0.4, 1.4], 1e-11);
    all_near(&clock("abs(abs(abs(x - 4) - 2) - 1) < 0.25", 8.0), &[0.75, 2.75, 4.75, 6.75], 1e-11);
    all_near(&clock("max(min(x, 4 - x), min(x - 3, 9 - x)) <= 1", 7.0), &[0.0, 3.0], 1e-11);
}

#[test]
fn zero_all_along_is_on_the_boundary_all_along() {
    // within rounding of zero at all times: the weak ones are true from the start, the strict ones never
    let still = ["sin(x)^2 + cos(x)^2 - 1", "(x + 1)^2 - x^2 - 2*x - 1", "exp(x)*exp(-x) - 1", "x - 3*(x/3)"];
    for g in still {
        pairing(g, &|guard| clock(guard, 6.0), &[0.0], &[], 0.0);
    }
}

#[test]
fn equal_agents_are_not_apart() {
    // the same flow from the same state, one after a reset: equal within rounding
    let text = |guard: &str| {
        format!(
            "agent A {{ state x = 0, y = 1  flow {{ x' = 2*y  y' = -2*x }}  swing: when x >= 0.9 {{ }} }}
             interaction Each(a: A, b: A) {{ pair: when {guard} {{ }} }}
             system {{ p = A()  q = A()  r = A() }}  run {{ until 20  tolerance 1e-9 }}"
        )
    };
    for guard in ["a.x > b.x", "a.x < b.x", "(a.x - b.x)^2 + (a.y - b.y)^2 > 0", "a.x + a.y > b.y + b.x"] {
        assert_eq!(simulate(&text(guard)).times("Each.pair"), [0.0; 0], "{guard}");
    }
    for guard in ["a.x >= b.x", "a.x <= b.x", "(a.x - b.x)^2 + (a.y - b.y)^2 <= 0"] {
        let times = simulate(&text(guard)).times("Each.pair");
        assert!(times.iter().all(|time| *time == 0.0) && !times.is_empty(), "{guard}: {times:?}");
    }
}

#[test]
fn a_pair_that_stays_on_its_boundary() {
    // both are at the distance of the guard all along, after the first has fired at the start
    let run = simulate(
        "agent A { state x, y  flow { x' = 0.2*time  y' = 0.3 - 0.1*time^2 } }
         interaction Swap(a: A, b: A) { pair: when (a.x - b.x)^2 + (a.y - b.y)^2 <= 1 { a.x := b.x  b.x := a.x } }
         interaction Far(a: A, b: A) { pair: when abs(a.x - b.x) < 0.6 { a.x := b.x  b.x := a.x } }
         system { p = A(x = 0, y = 0)  q = A(x = 0.6, y = 0.8) }  run { until 3 }",
    );
    assert_eq!(run.log(), ["0 Swap.pair p q"]);
}
