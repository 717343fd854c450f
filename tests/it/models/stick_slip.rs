//! Does the block stick and slip when it should? All its stretches are arcs of circles and straight lines.

use std::f64::consts::PI;

use crate::harness::{Case, all_near, near};

/// sqrt(k/m)
const W: f64 = 10.0;
const BELT: f64 = 0.2;
/// Friction as stretch of the spring, m: at rest, and in motion.
const AT_REST: f64 = 0.4 * 9.81 / 100.0;
const IN_MOTION: f64 = 0.25 * 9.81 / 100.0;

#[test]
fn on_a_belt_it_sticks_and_slips_for_ever() {
    let run = Case::shipped("stick_slip.hy").run();
    let rise = AT_REST - IN_MOTION;
    let slips = 2.0 / W * (PI - (rise * W / BELT).atan());
    let sticks = 2.0 * rise / BELT;
    let first = AT_REST / BELT;
    let pulled: Vec<f64> = (0..8).map(|k| first + f64::from(k) * (slips + sticks)).collect();
    let caught: Vec<f64> = pulled[..7].iter().map(|time| time + slips).collect();
    all_near(&run.times_of("Block.pulled", "driven"), &pulled, 1e-8);
    all_near(&run.times_of("Block.caught", "driven"), &caught, 1e-8);
    // while it sticks, its speed is the belt's, to the bit
    let stuck = run.samples[0].iter().filter(|sample| sample.agent == "driven" && sample.mode == "Stick");
    let speeds: Vec<f64> = stuck.map(|sample| sample.cells[1]).collect();
    assert!(speeds.len() >= 200 && speeds.iter().all(|speed| *speed == BELT));
}

#[test]
fn on_the_floor_it_loses_the_same_in_every_half_swing() {
    let run = Case::shipped("stick_slip.hy").run();
    let swings: Vec<&str> =
        run.events.iter().filter(|e| e.agent == "free").map(|e| e.transition.as_str()).collect();
    assert_eq!(
        swings,
        ["Block.pulled", "Block.overtake", "Block.fallback", "Block.overtake", "Block.joined"]
    );
    let times: Vec<f64> = run.events.iter().filter(|e| e.agent == "free").map(|e| e.time).collect();
    let turns: Vec<f64> = (0..5).map(|k| f64::from(k) * PI / W).collect();
    all_near(&times, &turns, 1e-9);
    near(run.value("free.x"), 0.23 - 8.0 * IN_MOTION, 1e-9);
    assert_eq!(run.value("free.v"), 0.0);
}

#[test]
fn with_one_friction_it_is_let_go_where_guard_and_rate_are_zero() {
    // v - belt and its rate are both zero then: the second rate decides that it slips
    let run = Case::shipped("stick_slip.hy").param("mu_s", 0.25).until(0.7).run();
    let first = IN_MOTION / BELT;
    all_near(&run.times_of("Block.pulled", "driven"), &[first], 1e-12);
    assert_eq!(run.mode("driven"), "Slower");
    let phase = W * (0.7 - first);
    near(run.value("driven.x"), IN_MOTION + BELT / W * phase.sin(), 1e-9);
    near(run.value("driven.v"), BELT * phase.cos(), 1e-8);
}
