//! Do the shipped models run, and end as they say?

mod rectifier;
mod stick_slip;
mod aircraft;
mod sector;
mod genetic_switch;
mod poisson_gene;
mod relay_clock;
mod navigation;
mod collide_and_stick;
mod billiards;
mod epidemic;
mod platoon;
mod extrapolation;
mod robertson;
mod van_der_pol;
mod double_crossing;
mod multirate;
mod flock;
mod swarm;
mod highway;
mod interlock;
mod convoy;
mod join_split;
mod metro;

use crate::harness::{Case, Ended, near};

/// Where f, positive at `from`, first is not: found in steps of `step`, then by halving.
fn first_root(f: &dyn Fn(f64) -> f64, from: f64, step: f64) -> f64 {
    let sign = f(from).signum();
    let n = (0..).find(|n| f(from + step * f64::from(n + 1)) * sign <= 0.0).expect("there is a root");
    let (mut lo, mut hi) = (from + step * f64::from(n), from + step * f64::from(n + 1));
    for _ in 0..60 {
        let middle = 0.5 * (lo + hi);
        if f(middle) * sign > 0.0 { lo = middle } else { hi = middle }
    }
    hi
}

#[test]
fn two_cars_meet() {
    let run = Case::shipped("two_cars.hy").run();
    assert_eq!(run.end, Ended::Until);
    let close = run.times("Car.close");
    // both see each other at the same root
    assert_eq!(close[0], close[1]);
    near(close[0], 6.5936, 1e-3);
    let clear = run.times("Car.clear");
    near(clear[0], 7.0997, 1e-3);
    assert_eq!(
        run.log()[..4],
        [
            "0 Car.close fast Spiral->Avoid",
            "0 Car.close slow Spiral->Avoid",
            "0 Car.clear fast Avoid->Spiral",
            "0 Car.clear slow Avoid->Spiral"
        ]
    );
    // a second meeting; 30 s at 20 samples a second, both ends, two cars
    near(close[2], 25.785, 1e-2);
    assert_eq!(run.samples[0].len(), 2 * 601);
    assert_eq!([run.mode("fast"), run.mode("slow")], ["Spiral", "Spiral"]);
}

#[test]
fn near_misses() {
    let run = Case::shipped("near_miss.hy").run();
    assert!(run.events.is_empty(), "{:?}", run.log());
    // the least distance of the samples is just above R
    let (fast, slow) = (run.column("fast", 0), run.column("slow", 0));
    let (fast_y, slow_y) = (run.column("fast", 1), run.column("slow", 1));
    let distance = |k: usize| (fast[k].1 - slow[k].1).hypot(fast_y[k].1 - slow_y[k].1);
    let least = (0..fast.len()).map(distance).fold(f64::INFINITY, f64::min);
    assert!((1.0014..1.05).contains(&least), "{least}");
    // a little nearer, and they meet
    let run = Case::shipped("near_miss.hy").param("y0", -1.2).until(8.0).run();
    near(run.times("Car.close")[0], 6.8344, 1e-3);
}

#[test]
fn bumper_runs_with_each_data_file() {
    for n in [2, 5, 10, 20, 50] {
        let run = Case::shipped("bumper.hy")
            .param("N", n)
            .param("data", format!("bumper_{n}.csv"))
            .until(3.0)
            .run();
        assert_eq!(run.finals.len(), n);
        let half = 5.0 * (n as f64).sqrt().ceil() - 0.5;
        assert!(run.finals.iter().all(|last| last.values[..2].iter().all(|(_, at)| at.abs() <= half + 1e-6)));
    }
}

#[test]
fn bumper_stays_in_its_arena() {
    let run = Case::shipped("bumper.hy").run();
    assert_eq!(run.finals.len(), 20);
    assert!(run.finals.iter().all(|last| last.values[..2].iter().all(|(_, at)| at.abs() <= 24.5 + 1e-6)));
}

#[test]
fn a_jam_on_the_static_highway() {
    let run = Case::shipped("highway_static.hy").run();
    assert_eq!(run.end, Ended::Until);
    assert!(run.false_asserts.is_empty(), "{:?}", run.false_asserts);
    assert_eq!(run.finals.len(), 66);
    assert!(run.events.len() >= 150, "{}", run.events.len());
    // the first of each lane stops and starts again, six seconds later
    for lane in 0..3 {
        let agent = format!("cars[{lane}]");
        let (stop, start) = (run.times_of("Car.still", &agent), run.times_of("Car.resume", &agent));
        assert_eq!((stop.len(), start.len()), (1, 1));
        near(start[0] - stop[0], 6.0, 1e-12);
    }
    // nobody overtakes anybody: in each lane the cars are in the order of their numbers, a car's length apart
    for k in 3..66 {
        let (car, lead) = (run.value(&format!("cars[{k}].x")), run.value(&format!("cars[{}].x", k - 3)));
        assert!(lead - car > 5.0, "cars[{k}] at {car}, its leader at {lead}");
    }
    // cars have braked, stopped and started again because of those in front of them
    assert!(run.times("Car.panic").len() >= 20 && run.times("Car.start").len() >= 20);
    assert!(run.events.iter().filter(|event| event.transition == "Car.follow").count() >= 60);
}

#[test]
fn the_ball_loses_energy_at_its_bounces_only() {
    let run = Case::shipped("bouncing_ball.hy").run();
    let energy = |k: usize, x: &[(f64, f64)], v: &[(f64, f64)]| v[k].1 * v[k].1 / 2.0 + 9.81 * x[k].1;
    let (x, v) = (run.column("ball", 0), run.column("ball", 1));
    assert_eq!(x.len(), 401);
    let bounces = run.times("Ball.bounce");
    for k in 0..x.len() {
        assert!(x[k].1 >= -1e-9);
        let before = bounces.iter().filter(|time| **time <= x[k].0).count();
        near(energy(k, &x, &v), 9.81 * 0.64f64.powi(i32::try_from(before).expect("few")), 1e-9);
    }
}

#[test]
fn the_thermostat_keeps_its_room() {
    let run = Case::shipped("thermostat.hy").run();
    let inside = run.column("room", 0).iter().all(|(_, t)| (19.0 - 1e-9..=21.0 + 1e-9).contains(t));
    assert!(inside);
    assert_eq!(run.column("room", 0).len(), 301);
}

#[test]
fn the_tanks_run_empty() {
    let run = Case::shipped("two_tanks.hy").run();
    assert_eq!(run.mode("tanks"), "Empty");
    let levels = run.samples[0].iter().flat_map(|sample| sample.cells.clone());
    assert!(levels.into_iter().all(|level| level >= 0.0));
}

#[test]
fn the_controller_settles() {
    let run = Case::shipped("sampled_pi.hy").run();
    near(run.value("loop.y"), 1.0, 1e-2);
    // against the load of 0.5 the controller holds 1 - 0.5/4
    near(run.value("loop.u"), 0.875, 1e-2);
}
