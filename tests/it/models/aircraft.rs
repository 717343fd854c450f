//! Do the aircraft keep apart, and come back to their courses? In each mode the way of one relative to the other is a
//! straight line or half a circle.

use std::f64::consts::PI;

use crate::harness::{Case, near};

const SPEED: f64 = 250.0;
const RADIUS: f64 = 10e3;
const ALERT: f64 = 20e3;

#[test]
fn they_fly_around_each_other() {
    for angle in [100.0f64, 120.0, 150.0, 180.0] {
        let run = Case::shipped("aircraft.hy").param("angle", angle).run();
        // of relative to own speed; of the relative half circle to one's own
        let ratio = 2.0 * (angle.to_radians() / 2.0).sin();
        let conflict = (60e3 * ratio - ALERT) / (SPEED * ratio);
        let done = conflict + PI * RADIUS / SPEED;
        for agent in ["first", "second"] {
            let log = [run.times_of("Aircraft.conflict", agent), run.times_of("Aircraft.done", agent)];
            assert_eq!([log[0].len(), log[1].len()], [1, 1]);
            near(log[0][0], conflict, 1e-8);
            near(log[1][0], done, 1e-8);
        }
        assert!(run.false_asserts.is_empty());
        // on the half circle the distance goes from ALERT to its end; then they fly apart
        let least = ALERT.min(2.0 * ratio * RADIUS - ALERT);
        let [x, y] = [0, 1].map(|c| (run.column("first", c), run.column("second", c)));
        let distances = (0..x.0.len()).map(|k| (x.0[k].1 - x.1[k].1).hypot(y.0[k].1 - y.1[k].1));
        let seen = distances.fold(f64::INFINITY, f64::min);
        assert!(seen >= least / 1e3 - 1e-6 && seen <= least / 1e3 + 0.5, "{seen} at {angle}");
    }
}

#[test]
fn they_come_back_to_their_courses() {
    let run = Case::shipped("aircraft.hy").run();
    for (agent, course) in [("first", 0.0), ("second", 120f64.to_radians())] {
        let [x, y] = ["x", "y"].map(|name| run.value(&format!("{agent}.{name}")));
        near(x * f64::sin(course) - y * f64::cos(course), 0.0, 1e-8);
        near(run.value(&format!("{agent}.phi")).to_radians(), course, 1e-9);
        // half a circle takes pi/2 times as long as its diameter
        let on_course = -60.0 + (SPEED * 600.0 - (PI - 2.0) * RADIUS) / 1e3;
        near(x * f64::cos(course) + y * f64::sin(course), on_course, 1e-8);
    }
}

#[test]
fn on_courses_too_much_alike_the_manoeuvre_fails() {
    // at 60 degrees the relative half circle leads through zero: the distance is ALERT cos(omega tau/2)
    let run = Case::shipped("aircraft.hy").param("angle", 60).until(260.0).run();
    let tau = 2.0 * RADIUS / SPEED * (9.26e3 / ALERT).acos();
    assert_eq!(run.false_asserts.len(), 1);
    near(run.false_asserts[0].time, 160.0 + tau, 1e-7);
}
