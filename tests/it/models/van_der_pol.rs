//! Does the oscillator creep and jump when it should? Against an extrapolation of order 8, and against the values at 2000 s
//! that are published for this problem.

use hyc::model::ir::Integrator;

use super::extrapolation::System;
use crate::harness::{Case, near};

const VAN_DER_POL: System<2> = System {
    rates: |&[x, y]| [y, 1000.0 * (1.0 - x * x) * y - x],
    jacobian: |&[x, y]| [[0.0, 1.0], [-2000.0 * x * y - 1.0, 1000.0 * (1.0 - x * x)]],
};
const BEGIN: [f64; 2] = [2.0, 0.0];
const FLOOR: [f64; 2] = [1e-3, 1e-6];

/// Test set for initial value problems of Bari, in its time of 1000 s: at 2.
const AT_2000: [f64; 2] = [1.706_167_732_17, -0.892_809_701_02e-3];

#[test]
fn the_reference_is_the_published_solution() {
    let [x, y] = VAN_DER_POL.follow(BEGIN, 2000.0, (1e-10, FLOOR), |_, _, _, _| {});
    near(x, AT_2000[0], 1e-10);
    near(y, AT_2000[1], 1e-12);
}

#[test]
fn it_creeps_and_jumps_when_the_reference_says() {
    let thresholds = [(0, 1.5), (0, 0.0), (0, 1.0), (1, 100.0)];
    let crossings = |tolerance| VAN_DER_POL.crossings(BEGIN, 4000.0, (tolerance, FLOOR), &thresholds);
    let (reference, coarse) = (crossings(1e-10), crossings(1e-9));
    let every_other =
        |times: &[f64], first: usize| -> Vec<f64> { times.iter().skip(first).step_by(2).copied().collect() };
    for integrator in [Integrator::Auto, Integrator::Stiff] {
        let run = Case::shipped("van_der_pol.hy").integrator(integrator).run();
        // each threshold is passed one way and the other, by turns
        for (name, k, first) in [("near", 0, 0), ("falls", 1, 0), ("rises", 2, 1), ("flash", 3, 0)] {
            let (expected, coarse) = (every_other(&reference[k], first), every_other(&coarse[k], first));
            let times = run.times(&format!("Oscillator.{name}"));
            assert_eq!(times.len(), expected.len(), "{name}: {times:?} {expected:?}");
            for (k, time) in times.into_iter().enumerate() {
                assert!((coarse[k] / expected[k] - 1.0).abs() < 1e-8, "the reference is not that good");
                assert!((time / expected[k] - 1.0).abs() <= 1e-6, "{name}: {time} is not {}", expected[k]);
            }
        }
        assert!(run.stats.steps + run.stats.rejected <= 3000, "{:?}", run.stats);
    }
}

#[test]
fn the_state_at_2000_is_the_published_one() {
    for integrator in [Integrator::Auto, Integrator::Stiff] {
        let run = Case::shipped("van_der_pol.hy").integrator(integrator).until(2000.0).run();
        near(run.value("oscillator.x"), AT_2000[0], 1e-6);
        near(run.value("oscillator.y"), AT_2000[1], 1e-9);
    }
}

#[test]
fn it_creeps_by_stiff_steps_and_jumps_by_explicit_ones() {
    let run = Case::shipped("van_der_pol.hy").run();
    let names: Vec<&str> = run.stats.methods.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["taylor", "stiff"]);
    assert!(run.stats.methods.iter().all(|(_, steps)| *steps > 200), "{:?}", run.stats.methods);
    // without a choice, some five million steps: 1000 for each second
    let second =
        |until: f64| Case::shipped("van_der_pol.hy").integrator(Integrator::Tsit5).until(until).run();
    let steps = second(2.0).stats.steps - second(1.0).stats.steps;
    assert!(steps > 500, "{steps}");
}
