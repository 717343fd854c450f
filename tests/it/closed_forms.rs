//! Do runs agree with what can be worked out on paper?

use std::f64::consts::PI;

use crate::harness::{Case, all_near, near, simulate};

#[test]
fn bounces_of_a_ball() {
    let run = Case::shipped("bouncing_ball.hy").tolerance(1e-10).run();
    // t_n = t_1 (1 + 2 (e + ... + e^(n - 1)))
    let (first, e) = ((2.0f64 / 9.81).sqrt(), 0.8f64);
    let mut expected = Vec::new();
    let (mut time, mut flight) = (first, 2.0 * first * e);
    while time <= 4.0 {
        expected.push(time);
        time += flight;
        flight *= e;
    }
    assert_eq!(expected.len(), 19);
    all_near(&run.times("Ball.bounce"), &expected, 1e-9);
}

#[test]
fn a_ball_on_the_moon_from_another_height() {
    let case = Case::shipped("bouncing_ball.hy").param("g", 1.62).param("h", 2).param("e", 0.5);
    let run = case.until(4.5).run();
    let first = (4.0f64 / 1.62).sqrt();
    let expected = [first, 2.0 * first, 2.5 * first, 2.75 * first];
    all_near(&run.times("Ball.bounce")[..4], &expected[..4], 1e-9);
}

#[test]
fn switching_times_of_a_thermostat() {
    let run = Case::shipped("thermostat.hy").tolerance(1e-10).run();
    let (warming, cooling) = ((21.0f64 / 19.0).ln(), (11.0f64 / 9.0).ln());
    let mut time = (10.0f64 / 9.0).ln();
    let (mut cold, mut warm) = (Vec::new(), Vec::new());
    while time <= 3.0 {
        cold.push(time);
        if time + warming <= 3.0 {
            warm.push(time + warming);
        }
        time += warming + cooling;
    }
    assert!(cold.len() >= 9);
    all_near(&run.times("Room.cold"), &cold, 1e-9);
    all_near(&run.times("Room.warm"), &warm, 1e-9);
}

#[test]
fn two_tanks_run_empty() {
    // levels s^2 and u^2: s = 1 - c1 t/2; with w = u/s, s dw/ds = -(w - 1)^2/w, so log(w - 1) - 1/(w - 1) + log s
    // stays, and u = 1/e when s = 0. A level's error of 1e-12 is one of 1e-6 in time.
    let run = Case::shipped("two_tanks.hy").tolerance(1e-12).run();
    assert_eq!(run.log(), ["0 Tanks.dry tanks Both->Lower", "0 Tanks.empty tanks Lower->Empty"]);
    near(run.times("Tanks.dry")[0], 4.0, 1e-4);
    near(run.times("Tanks.empty")[0], 4.0 + 2.0 / std::f64::consts::E, 1e-4);
    assert_eq!([run.value("tanks.upper"), run.value("tanks.lower")], [0.0, 0.0]);
}

#[test]
fn two_tanks_at_the_models_own_tolerance() {
    let run = Case::shipped("two_tanks.hy").run();
    near(run.times("Tanks.dry")[0], 4.0, 1e-2);
    near(run.times("Tanks.empty")[0], 4.0 + 2.0 / std::f64::consts::E, 1e-2);
}

#[test]
fn a_sampled_controller() {
    // between samples y' = 4 (u - y) + load, solved exactly
    let run = Case::shipped("sampled_pi.hy").tolerance(1e-11).run();
    let decay = (-0.04f64).exp();
    let (mut y, mut u, mut i) = (0.0, 0.0, 0.0);
    let mut expected = vec![y];
    for k in 0..400 {
        let load = if k >= 200 { 0.5 } else { 0.0 };
        let rest: f64 = u + load / 4.0;
        y = rest + (y - rest) * decay;
        let error = 1.0 - y;
        (i, u) = (i + 0.01 * error, 2.0 * error + 10.0 * i);
        expected.push(y);
    }
    let ticks = run.times("Loop.sample");
    assert_eq!(ticks.len(), 400);
    assert!(ticks.iter().enumerate().all(|(k, time)| *time == (k + 1) as f64 * 0.01));
    let samples: Vec<f64> = run.column("loop", 0).iter().map(|sample| sample.1).collect();
    all_near(&samples, &expected, 1e-9);
    near(run.value("loop.u"), u, 1e-8);
    near(run.value("loop.i"), i, 1e-9);
}

#[test]
fn an_elastic_wall_in_a_harmonic_well() {
    // x = cos t meets the wall at -1/2 at 2 pi/3 and goes back: period 4 pi/3
    let run = simulate(
        "agent A { state x = 1, v = 0  flow { x' = v  v' = -x }  wall: when x <= -0.5 { v := -v } }
         system { a = A() }  run { until 20  tolerance 1e-11 }",
    );
    let expected: Vec<f64> = (0..)
        .map(|k| 2.0 * PI / 3.0 + 4.0 * PI / 3.0 * f64::from(k))
        .take_while(|time| *time <= 20.0)
        .collect();
    all_near(&run.times("A.wall"), &expected, 1e-8);
}

#[test]
fn a_pursuit_on_a_line() {
    // the pursuer's speed is its distance: meets within 0.01 at log(100)
    let run = simulate(
        "agent Prey { state x = 1  flow { x' = 0 } }
         agent Dog(prey: Prey) { state x = 0  flow { x' = prey.x - x }
           near: when prey.x - x <= 0.01 { stop \"caught\" } }
         system { d = Dog(prey = p)  p = Prey() }  run { until 10  tolerance 1e-10 }",
    );
    near(run.time, 100f64.ln(), 1e-7);
}

#[test]
fn a_clock_of_time_in_the_flow() {
    // time in a flow is the stage's time: x' = t^4 is integrated exactly by a method of order five
    let run = simulate(
        "agent A { state x = 0  flow { x' = time^4 } }  system { a = A() }  run { until 3  tolerance 1e-2 }",
    );
    near(run.value("a.x"), 243.0 / 5.0, 1e-9);
}

/// A function in our words and in Rust's.
type Named = (&'static str, fn(f64) -> f64);

#[test]
fn every_function_in_a_flow() {
    let functions: [Named; 23] = [
        ("sin(time)", f64::sin),
        ("cos(time)", f64::cos),
        ("tan(time/2)", |t| (t / 2.0).tan()),
        ("asin(time/3)", |t| (t / 3.0).asin()),
        ("acos(time/3)", |t| (t / 3.0).acos()),
        ("atan(time)", f64::atan),
        ("atan2(time, 1 + time)", |t| t.atan2(1.0 + t)),
        ("sinh(time)", f64::sinh),
        ("cosh(time)", f64::cosh),
        ("tanh(time)", f64::tanh),
        ("asinh(time)", f64::asinh),
        ("acosh(1.5 + time)", |t| (1.5 + t).acosh()),
        ("atanh(time/3)", |t| (t / 3.0).atanh()),
        ("exp(-time)", |t| (-t).exp()),
        ("log(1 + time)", |t| (1.0 + t).ln()),
        ("log2(1 + time)", |t| (1.0 + t).log2()),
        ("log10(1 + time)", |t| (1.0 + t).log10()),
        ("sqrt(1 + time)", |t| (1.0 + t).sqrt()),
        ("cbrt(1 + time)", |t| (1.0 + t).cbrt()),
        ("hypot(time, 2)", |t| t.hypot(2.0)),
        ("(1 + time)^time", |t| (1.0 + t).powf(t)),
        ("(1 + time)^(-3)", |t| (1.0 + t).powi(-3)),
        ("clamp(time, 0.5, 1.5)", |t| t.clamp(0.5, 1.5)),
    ];
    let names: Vec<String> = (0..functions.len()).map(|k| format!("x{k}")).collect();
    let states: Vec<String> = names.iter().map(|name| format!("{name} = 0")).collect();
    let flow: Vec<String> =
        names.iter().zip(&functions).map(|(name, (text, _))| format!("{name}' = {text}")).collect();
    let run = simulate(&format!(
        "agent A {{ state {}  flow {{ {} }} }}  system {{ a = A() }}  run {{ until 2  tolerance 1e-10 }}",
        states.join(", "),
        flow.join("\n")
    ));
    for (name, (text, f)) in names.iter().zip(&functions) {
        let expected = crate::harness::integral(f, 0.0, 2.0);
        let off = (run.value(&format!("a.{name}")) - expected).abs();
        assert!(off <= 1e-7, "{text}: off by {off:e}");
    }
}
