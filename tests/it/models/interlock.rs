//! Does the pump go on with what it did before the power failed? Straight lines, from one event to the next.

use crate::harness::{Case, all_near, near};

const LOW: f64 = 1.0;
const HIGH: f64 = 3.0;

/// The pump from one event to the next.
#[derive(Clone, Copy, PartialEq)]
enum Doing {
    Fill,
    Drain,
}

/// The times at which the pump turns over, and those at which the power fails, and the level at `until`.
fn lines(until: f64, up: f64, outage: f64) -> (Vec<f64>, Vec<f64>, f64) {
    let (mut t, mut level, mut doing) = (0.0, LOW, Doing::Fill);
    let (mut turns, mut fails) = (Vec::new(), Vec::new());
    let mut failure = up;
    loop {
        let speed = if doing == Doing::Fill { 0.5 } else { -0.25 };
        let goal = if doing == Doing::Fill { HIGH } else { LOW };
        let turn = t + (goal - level) / speed;
        if turn.min(failure) > until {
            return (turns, fails, level + speed * (until - t));
        }
        if turn < failure {
            turns.push(turn);
            (t, level) = (turn, goal);
            doing = if doing == Doing::Fill { Doing::Drain } else { Doing::Fill };
        } else {
            fails.push(failure);
            level += speed * (failure - t);
            t = failure + outage;
            failure = t + up;
        }
    }
}

#[test]
fn it_goes_on_with_what_it_did() {
    let run = Case::shipped("interlock.hy").run();
    let (turns, fails, level) = lines(40.0, 6.5, 2.0);
    let mut seen = [run.times("Pump.full"), run.times("Pump.empty")].concat();
    seen.sort_by(f64::total_cmp);
    assert!(turns.len() >= 5 && fails.len() >= 4);
    all_near(&seen, &turns, 1e-9);
    all_near(&run.times("Pump.trip"), &fails, 0.0);
    near(run.value("tank.level"), level, 1e-9);
    // the way back leads into the mode that it was tripped in
    let log = run.events.iter().filter(|event| event.agent == "pump");
    let modes: Vec<(&str, &str)> = log.map(|event| (event.from.as_str(), event.to.as_str())).collect();
    for (k, (from, to)) in modes.iter().enumerate().filter(|(_, (_, to))| *to == "Stopped") {
        assert_eq!((modes[k + 1].0, modes[k + 1].1), (*to, *from));
    }
}

#[test]
fn while_it_is_stopped_the_level_stands() {
    let run = Case::shipped("interlock.hy").run();
    let fails = lines(40.0, 6.5, 2.0).1;
    let level = run.column("tank", 0);
    for fail in fails {
        let during: Vec<f64> =
            level.iter().filter(|(t, _)| (fail..fail + 2.0).contains(t)).map(|(_, level)| *level).collect();
        assert!(during.len() >= 19 && during.iter().all(|level| *level == during[0]), "{during:?}");
    }
}
