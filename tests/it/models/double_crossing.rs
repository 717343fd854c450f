//! Are both roots of a guard found where no step ends between them? Against the parabola's, and against what a look at the
//! ends of steps would have seen.

use hyc::model::ir::Integrator;

use crate::harness::{Case, Run, near};

const BAR: f64 = 5.0;
const G: f64 = 10.0;

/// When a ball that rises so far above the bar passes it, upwards and downwards.
fn passes(over: f64) -> [f64; 2] {
    let (middle, half) = ((2.0 * (BAR + over) / G).sqrt(), (2.0 * over / G).sqrt());
    [middle - half, middle + half]
}

fn agrees(run: &Run, n: usize) {
    assert_eq!(run.events.len(), 2 * n, "{:?}", run.log());
    for k in 0..n {
        let agent = format!("balls[{k}]");
        for (transition, expected) in
            ["Ball.up", "Ball.down"].into_iter().zip(passes(0.1f64.powi(k as i32 + 1)))
        {
            let times = run.times_of(transition, &agent);
            assert_eq!(times.len(), 1, "{transition} of {agent}");
            // an error of rounding in x is one of its size over the speed at the bar in the time
            near(times[0], expected, 1e-13 + 1e-14 / (2.0 * G * 0.1f64.powi(k as i32 + 1)).sqrt());
        }
    }
    assert!(run.times_of("Ball.up", "short").is_empty());
    assert_eq!(run.stats.undecided_roots, 0);
}

#[test]
fn every_ball_is_seen_twice_and_the_short_one_never() {
    agrees(&Case::shipped("double_crossing.hy").run(), 8);
    agrees(&Case::shipped("double_crossing.hy").integrator(Integrator::Adams).run(), 8);
    // 0.28 ms, 2.8 us, 28 ns above the bar
    agrees(&Case::shipped("double_crossing.hy").param("n", 12).run(), 12);
}

#[test]
fn no_step_ends_between_the_two() {
    // the same flights without the barrier: every accepted step is a row
    let path = format!("{}/models/double_crossing.hy", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(path).unwrap();
    let text =
        text.replace("when x >= bar", "when x >= 2*bar").replace("record Ball every 0.01 [s]", "record Ball");
    let run = Case::new(&text).run();
    assert!(run.events.is_empty());
    let above = |k: usize| run.column(&format!("balls[{k}]"), 0).iter().any(|(_, x)| *x >= BAR);
    assert!((3..8).all(|k| !above(k)), "a look at the ends of the steps would have seen them");
}
