//! Does an agent step on its own clock while nobody's flow reads it, and what does it cost to be read? Against cosines.

use crate::harness::{Case, Run, near};

const W: f64 = 50.0;

fn run(hold: f64) -> Run {
    Case::shipped("multirate.hy").param("hold", hold).tolerance(1e-11).run()
}

/// y and y' of the coupled oscillator, which is led by cos(t).
fn coupled(t: f64) -> [f64; 2] {
    let c = W * W / (W * W - 1.0);
    [c * t.cos() - c * (W * t).cos(), -c * t.sin() + c * W * (W * t).sin()]
}

/// y and y' of the one that holds its samples: from each to the next a cosine about it.
fn held(hold: f64, t: f64) -> [f64; 2] {
    let (mut y, mut v, mut from) = (0.0, 0.0, 0.0f64);
    let mut k = 0;
    loop {
        let to = (f64::from(k + 1) * hold).min(t);
        let (sin, cos) = (W * (to - from)).sin_cos();
        let about = y - (f64::from(k) * hold).cos();
        (y, v) = (y - about + about * cos + v / W * sin, v * cos - about * W * sin);
        if to >= t {
            return [y, v];
        }
        (from, k) = (to, k + 1);
    }
}

#[test]
fn both_go_as_their_closed_forms_say() {
    for hold in [0.1, 0.03] {
        let run = run(hold);
        for agent in ["led", "alone"] {
            near(run.value(&format!("{agent}.x")), 6f64.cos(), 1e-8);
        }
        for (agent, end) in [("one_clock", coupled(6.0)), ("own_clocks", held(hold, 6.0))] {
            near(run.value(&format!("{agent}.y")), end[0], 1e-6);
            near(run.value(&format!("{agent}.v")), end[1], 1e-6 * W);
        }
    }
}

#[test]
fn who_is_read_by_a_flow_and_who_is_sampled_keep_their_own_clocks() {
    let stats = run(0.1).stats;
    let steps = |name: &str| stats.types.iter().find(|ty| ty.name == name).unwrap().steps;
    // there are two slow ones, one that a flow reads and one that is sampled
    let slow = steps("Slow");
    assert!(20 * slow < steps("Coupled") + steps("Held"), "{slow} of {stats:?}");
}

#[test]
fn holding_costs_an_error_of_the_size_of_the_hold() {
    let worst = |hold: f64| {
        let run = run(hold);
        // columns x, v, y of all three types
        let (own, one) = (run.column("own_clocks", 2), run.column("one_clock", 2));
        own.iter().zip(&one).map(|(own, one)| (own.1 - one.1).abs()).fold(0.0, f64::max)
    };
    let errors = [0.02, 0.01, 0.005].map(worst);
    for (error, hold) in errors.iter().zip([0.02, 0.01, 0.005]) {
        assert!((0.4 * hold..0.7 * hold).contains(error), "{errors:?}");
    }
}
