//! Do the concentrations pass their thresholds when they should? Against an extrapolation of order 8, and against the
//! values at 40 s and at 1e11 s that are published for this problem.

use hyc::model::ir::Integrator;

use super::extrapolation::System;
use crate::harness::{Case, Run, all_near};

const ROBERTSON: System<3> = System {
    rates: |&[a, b, c]| {
        let [slow, back, fast] = [0.04 * a, 1e4 * b * c, 3e7 * b * b];
        [back - slow, slow - back - fast, fast]
    },
    jacobian: |&[_, b, c]| {
        [[-0.04, 1e4 * c, 1e4 * b], [0.04, -1e4 * c - 6e7 * b, -1e4 * b], [0.0, 6e7 * b, 0.0]]
    },
};
const BEGIN: [f64; 3] = [1.0, 0.0, 0.0];
const FLOOR: [f64; 3] = [1e-10, 1e-15, 1e-10];

/// Hairer & Wanner, Solving ODEs II, IV.10, and the test set for initial value problems of Bari: to the digits given.
const AT_40: [f64; 3] = [0.715_827_068_719_3, 9.185_534_764_56e-6, 0.284_163_745_745_8];
const AT_1E11: [f64; 3] = [2.083_340_149_7e-8, 8.333_360_770_3e-14, 0.999_999_979_166_5];

fn relative(found: [f64; 3], expected: [f64; 3]) -> f64 {
    (0..3).map(|i| (found[i] / expected[i] - 1.0).abs()).fold(0.0, f64::max)
}

fn states(run: &Run) -> [f64; 3] {
    ["vessel.a", "vessel.b", "vessel.c"].map(|state| run.value(state))
}

#[test]
fn the_reference_is_the_published_solution() {
    let at = |until| ROBERTSON.follow(BEGIN, until, (1e-10, FLOOR), |_, _, _, _| {});
    assert!(relative(at(40.0), AT_40) < 2e-11, "{:?}", at(40.0));
    assert!(relative(at(1e11), AT_1E11) < 1e-8, "{:?}", at(1e11));
}

#[test]
fn thresholds_are_passed_when_the_reference_says() {
    let thresholds = [(2, 0.01), (0, 0.5), (1, 1e-6), (0, 0.1), (0, 1e-4)];
    let crossings = |tolerance| ROBERTSON.crossings(BEGIN, 1e11, (tolerance, FLOOR), &thresholds);
    let (reference, coarse) = (crossings(1e-10), crossings(1e-9));
    let run = Case::shipped("robertson.hy").run();
    for (k, name) in ["trace", "half", "starved", "tenth", "last"].into_iter().enumerate() {
        // b passes 1e-6 upwards, too, at first
        let last = *reference[k].last().unwrap();
        assert!(
            (coarse[k].last().unwrap() / last - 1.0).abs() < 1e-8,
            "{name}: the reference is not that good"
        );
        let times = run.times(&format!("Vessel.{name}"));
        assert_eq!(times.len(), 1, "{name}: {times:?}");
        assert!((times[0] / last - 1.0).abs() <= 1e-6, "{name}: {} is not {last}", times[0]);
    }
    assert_eq!(run.value("vessel.passed"), 5.0);
}

#[test]
fn the_end_is_the_published_one_in_a_bounded_number_of_steps() {
    for (integrator, steps_max) in [(Integrator::Auto, 1500), (Integrator::Stiff, 1500)] {
        let run = Case::shipped("robertson.hy").integrator(integrator).run();
        assert!(relative(states(&run), AT_1E11) < 1e-6, "{:?}", states(&run));
        assert!(run.stats.steps + run.stats.rejected <= steps_max, "{:?}", run.stats);
        // nothing is lost
        all_near(&[states(&run).iter().sum()], &[1.0], 1e-10);
    }
    let run = Case::shipped("robertson.hy").until(40.0).run();
    assert!(relative(states(&run), AT_40) < 1e-7, "{:?}", states(&run));
}

#[test]
fn explicit_steps_would_be_too_many() {
    // not even a second of it in as many steps as the others take for all of the 1e11 s
    let run = Case::shipped("robertson.hy").integrator(Integrator::Tsit5).until(2.0).run();
    assert!(run.stats.steps > 1500, "{:?}", run.stats);
}
