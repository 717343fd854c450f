//! Do the algorithms of 2004 do what the paper says, where it is right: clocks that meet at an event geometrically, a smaller
//! cost than one clock for all; and where it is not, is what they miss reported?

use hyc::runtime::Algorithm;
use hyc::runtime::paper::Paper;

use crate::harness::{Case, Run, all_near, near};

fn masim(gamma: f64) -> Algorithm {
    Algorithm::Masim2004(Paper { gamma, audit: true, ..Paper::default() })
}

fn sasim() -> Algorithm {
    Algorithm::Sasim2004(Paper { audit: true, ..Paper::default() })
}

/// The two cars with every accepted step recorded.
fn cars(model: &str, until: f64) -> Case {
    let path = format!("{}/models/{model}", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(path).unwrap();
    let text = text.replace("record fast, slow every 0.05 [s]", "record fast, slow");
    Case::new(&text).until(until)
}

/// Step k of Algorithm 1: the guard with each car at its own clock, and how far the one that lags lags.
struct Step {
    g: f64,
    tau: f64,
}

/// The steps in the order in which they were taken: the car that lags first.
fn steps(run: &Run) -> Vec<Step> {
    let of = |name: &str| {
        let rows = run.samples[0].iter().filter(|row| row.agent == name);
        rows.map(|row| (row.time, row.cells[0], row.cells[1])).collect::<Vec<_>>()
    };
    let cars = [of("fast"), of("slow")];
    let mut at = [0, 0];
    let mut steps = Vec::new();
    while at[0] + 1 < cars[0].len() && at[1] + 1 < cars[1].len() {
        let lagging = usize::from(cars[1][at[1]].0 < cars[0][at[0]].0);
        at[lagging] += 1;
        let [(t1, x1, y1), (t2, x2, y2)] = [cars[0][at[0]], cars[1][at[1]]];
        steps.push(Step { g: (x1 - x2).powi(2) + (y1 - y2).powi(2) - 1.0, tau: -(t1 - t2).abs() });
    }
    steps
}

#[test]
fn two_cars_meet_geometrically() {
    let run = cars("two_cars.hy", 6.5936).algorithm(masim(0.5)).tolerance(1e-6).run();
    let steps = steps(&run);
    let near: Vec<&Step> = steps.iter().filter(|step| step.g < 0.02 && step.g > 1e-3).collect();
    assert!(near.len() >= 6, "{} steps", near.len());
    for round in near.windows(3) {
        let (g, tau) = (round[2].g / round[0].g, round[2].tau / round[0].tau);
        assert!((g - 0.5).abs() < 0.02, "g falls by {g} a round");
        assert!((tau - 0.5).abs() < 0.1, "tau falls by {tau} a round");
    }
}

#[test]
fn the_algorithms_find_the_events_of_the_two_cars() {
    let expected = cars("two_cars.hy", 20.0).tolerance(1e-10).run();
    for algorithm in [masim(0.5), masim(0.1), sasim()] {
        let run = cars("two_cars.hy", 20.0).algorithm(algorithm).tolerance(1e-7).run();
        assert_eq!(run.events.len(), expected.events.len(), "{algorithm:?}");
        for (event, expected) in run.events.iter().zip(&expected.events) {
            assert_eq!((&event.transition, &event.agent), (&expected.transition, &expected.agent));
            near(event.time, expected.time, 1e-4);
        }
        let misses = run.stats.misses.unwrap();
        assert_eq!((misses.missed, misses.late), (0, 0), "{algorithm:?}");
    }
}

#[test]
fn a_near_miss_slows_the_cars_down_and_lets_them_go() {
    let run = cars("near_miss.hy", 20.0).algorithm(masim(0.5)).tolerance(1e-6).run();
    assert!(run.events.is_empty(), "{:?}", run.log());
    let steps = steps(&run);
    let nearest = steps.iter().map(|step| step.g).fold(f64::INFINITY, f64::min);
    assert!(nearest.abs() < 0.01, "with each car at its own clock: {nearest}");
    let lag = |wanted: &dyn Fn(&&Step) -> bool| {
        let lags: Vec<f64> = steps.iter().filter(wanted).map(|step| -step.tau).collect();
        lags.iter().sum::<f64>() / lags.len() as f64
    };
    let (at, away) = (lag(&|step| step.g < 0.02), lag(&|step| step.g > 1.0));
    assert!(at < 0.25 * away, "the clocks differ by {at} there, by {away} elsewhere");
}

fn bumper(n: usize, algorithm: Algorithm, tolerance: f64) -> Run {
    let case = Case::shipped("bumper.hy").param("N", n).param("data", format!("bumper_{n}.csv"));
    case.algorithm(algorithm).tolerance(tolerance).run()
}

#[test]
fn own_clocks_cost_less_than_one_for_all() {
    for n in [10, 20] {
        let own = bumper(n, masim(0.1), 1e-4).stats.rhs_evaluations as f64;
        let one = bumper(n, sasim(), 1e-4).stats.rhs_evaluations as f64;
        assert!(own / one < 0.6, "N = {n}: S = {}", own / one);
    }
}

#[test]
fn what_gamma_zero_misses_is_counted() {
    let found = bumper(10, masim(0.1), 1e-5);
    let misses = found.stats.misses.unwrap();
    assert_eq!((misses.missed, misses.late, found.events.len()), (0, 0, 5));
    let missing = bumper(10, masim(0.0), 1e-5);
    let misses = missing.stats.misses.unwrap();
    assert!(misses.missed + misses.late > 0 && missing.events.len() < 5, "{misses:?}");
}

#[test]
fn scheduled_times_and_agents_without_states_are_met() {
    let text = "agent Lamp { discrete lit: bool = false
            off: every 1 [s] when not lit { lit := true }
            late: when time >= 2.5 { lit := false } }
        agent Ball { state y = 1, v = 0  flow { y' = v  v' = -9.81 }
            hit: when y <= 0 { v := -0.8*v } }
        system { lamp = Lamp()  ball = Ball() }  run { until 3 }";
    let expected = Case::new(text).tolerance(1e-10).run();
    assert!(expected.events.len() > 5);
    for algorithm in [masim(0.1), sasim()] {
        let run = Case::new(text).algorithm(algorithm).tolerance(1e-8).run();
        let names = |run: &Run| run.events.iter().map(|event| event.transition.clone()).collect::<Vec<_>>();
        assert_eq!(names(&run), names(&expected), "{algorithm:?}: {:?}", run.log());
        for (event, expected) in run.events.iter().zip(&expected.events) {
            near(event.time, expected.time, 1e-5);
        }
    }
}

#[test]
fn a_guard_may_be_one_of_all_members_of_an_aggregate_that_events_change() {
    let text = "agent Pump(v: real) { state x = 0  discrete runs: bool = true
            flow { x' = v*(1 + 0.5*sin(3*v*time)) }
            off:   when x >= 2 { runs := false }
            full:  when (sum o in Pump where o.runs: o.x) >= 2.4 { }
            apart: when (max o in Pump: o.x) - (min o in other Pump: o.x) >= 0.5 { } }
        system { a = Pump(v = 1)  b = Pump(v = 0.6)  c = Pump(v = 0.25) }  run { until 6 }";
    let expected = Case::new(text).tolerance(1e-10).run();
    // while all are on, after the first is off, and after the second is
    assert!(expected.times_of("Pump.full", "a").len() >= 2, "{:?}", expected.log());
    assert_eq!(expected.times("Pump.off").len(), 2, "{:?}", expected.log());
    for algorithm in [masim(0.5), masim(0.1), sasim()] {
        let run = Case::new(text).algorithm(algorithm).tolerance(1e-8).run();
        assert_eq!(run.events.len(), expected.events.len(), "{algorithm:?}: {:?}", run.log());
        // Each guard has its own agents, and is seen when their clocks agree: not all at exactly the same time.
        for transition in ["Pump.off", "Pump.full", "Pump.apart"] {
            for agent in ["a", "b", "c"] {
                let times = [&run, &expected].map(|run| run.times_of(transition, agent));
                all_near(&times[0], &times[1], 1e-4);
            }
        }
        let misses = run.stats.misses.unwrap();
        assert_eq!((misses.missed, misses.late), (0, 0), "{algorithm:?}");
    }
}

#[test]
fn what_is_never_negative_is_not_found_negative_within_a_tolerance() {
    let model = "agent A { state x = 0, v = 1  discrete n: int = 0
           flow { x' = v  v' = -x }
           invariant x^2 >= 0
           assert abs(x) >= 0 \"a distance\"
           q: rate 0.5*x^2 when v > 0 { n := n + 1 } }
         system { a = A() }
         run { until 25  seed 4 }";
    for algorithm in [masim(0.5), sasim()] {
        let run = Case::new(model).algorithm(algorithm).run();
        assert_eq!(run.time, 25.0);
        assert!(run.false_asserts.is_empty());
        assert!(run.events.len() > 3);
    }
}
