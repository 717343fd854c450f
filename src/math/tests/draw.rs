//! Are the draws what theory says, the same for ever, and independent of each other?

use crate::math::draw::{Distribution, Key};
use crate::math::elementary;

const N: usize = 20_000;

/// The values of many agents, sorted.
fn sample(distribution: Distribution, parameters: &[f64], seed: u64) -> Vec<f64> {
    let mut values: Vec<f64> = (0..N)
        .map(|k| {
            let agent = format!("cars[{k}]");
            distribution.draw(parameters, Key { seed, agent: &agent, variable: "v", draw: 0 })
        })
        .collect();
    values.sort_by(f64::total_cmp);
    values
}

/// The largest distance of the sample's distribution from the true one, times the root of the size (Kolmogorov & Smirnov).
fn distance(sorted: &[f64], cumulative: impl Fn(f64) -> f64) -> f64 {
    let n = sorted.len() as f64;
    let gaps = sorted.iter().enumerate().map(|(k, &x)| {
        let p = cumulative(x);
        (p - k as f64 / n).max((k + 1) as f64 / n - p)
    });
    gaps.fold(0.0, f64::max) * n.sqrt()
}

/// The normal distribution's integral from minus infinity, by Simpson's rule from the mean.
fn normal(z: f64) -> f64 {
    let n = 400;
    let h = z / n as f64;
    let density = |x: f64| (-x * x / 2.0).exp() / (2.0 * std::f64::consts::PI).sqrt();
    let inner: f64 = (1..n).map(|k| density(k as f64 * h) * if k % 2 == 1 { 4.0 } else { 2.0 }).sum();
    0.5 + (density(0.0) + inner + density(z)) * h / 3.0
}

/// The first four moments about the mean.
fn moments(values: &[f64]) -> [f64; 4] {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let about = |power: i32| values.iter().map(|x| (x - mean).powi(power)).sum::<f64>() / n;
    [mean, about(2), about(3), about(4)]
}

/// A sample of this size exceeds the bound once in 10 000 seeds if the distribution is right.
const DISTANCE_MAX: f64 = 2.23;

#[test]
fn samples_follow_their_distributions() {
    for seed in [0, 1, 2026, u64::MAX] {
        let uniform = sample(Distribution::Uniform, &[-2.0, 3.0], seed);
        let exponential = sample(Distribution::Exponential, &[0.25], seed);
        let bell = sample(Distribution::Normal, &[30.0, 3.0], seed);
        let distances = [
            distance(&uniform, |x| (x + 2.0) / 5.0),
            distance(&exponential, |x| 1.0 - (-0.25 * x).exp()),
            distance(&bell, |x| normal((x - 30.0) / 3.0)),
        ];
        for found in distances {
            assert!(found < DISTANCE_MAX, "seed {seed}: {distances:?}");
        }
        assert!(uniform.iter().all(|x| (-2.0..=3.0).contains(x)) && exponential[0] > 0.0);
    }
}

/// Each moment within four of its own standard errors.
#[test]
fn samples_have_the_moments_of_their_distributions() {
    let root = (N as f64).sqrt();
    let check = |found: [f64; 4], theory: [f64; 4], errors: [f64; 4]| {
        for k in 0..4 {
            let off = (found[k] - theory[k]).abs() * root / errors[k];
            assert!(off < 4.0, "moment {}: {found:?} against {theory:?}", k + 1);
        }
    };
    let uniform = moments(&sample(Distribution::Uniform, &[-1.0, 1.0], 5));
    check(uniform, [0.0, 1.0 / 3.0, 0.0, 0.2], [0.58, 0.30, 0.38, 0.27]);
    let bell = moments(&sample(Distribution::Normal, &[0.0, 1.0], 5));
    check(bell, [0.0, 1.0, 0.0, 3.0], [1.0, 1.42, 3.88, 9.8]);
    let exponential = moments(&sample(Distribution::Exponential, &[1.0], 5));
    check(exponential, [1.0, 1.0, 2.0, 9.0], [1.0, 2.83, 15.5, 120.0]);
}

#[test]
fn neighbouring_keys_are_not_correlated() {
    let unit = |agent: &str, variable: &str, seed| {
        Distribution::Uniform.draw(&[-1.0, 1.0], Key { seed, agent, variable, draw: 0 })
    };
    let mut sums = [0.0; 4];
    for k in 0..N {
        let (here, next) = (format!("cars[{k}]"), format!("cars[{}]", k + 1));
        let x = unit(&here, "v", 1);
        let others = [unit(&next, "v", 1), unit(&here, "w", 1), unit(&here, "v", 2), unit("cars", &here, 1)];
        for (sum, other) in sums.iter_mut().zip(others) {
            *sum += x * other * 3.0 / (N as f64).sqrt();
        }
    }
    assert!(sums.iter().all(|sum| sum.abs() < 4.0), "{sums:?}");
}

/// The bits as another implementation has them, written in Python after the paper and checked against its test vector.
#[test]
fn bits_are_pinned() {
    let key = Key { seed: 1, agent: "cars[3]", variable: "v", draw: 0 };
    assert_eq!([key.word(0), key.word(1)], [0xb74d_7906_31b8_0e35, 0x7051_79ca_fe6b_a6ca]);
    let u = ((key.word(0) >> 12) as f64 + 0.5) / 4_503_599_627_370_496.0;
    assert_eq!(Distribution::Exponential.draw(&[2.0], key), -elementary::log(u) / 2.0);
    assert_eq!(Distribution::Uniform.draw(&[0.0, 1.0], key), u);
}

#[test]
fn parameters_out_of_range_are_named() {
    let problem = |distribution: Distribution, parameters: &[f64]| distribution.problem(parameters);
    assert_eq!(problem(Distribution::Uniform, &[1.0, 0.0]).map(|found| found.0), Some(1));
    assert_eq!(problem(Distribution::Uniform, &[f64::NEG_INFINITY, 0.0]).map(|found| found.0), Some(0));
    assert_eq!(problem(Distribution::Normal, &[0.0, -1e-300]).map(|found| found.0), Some(1));
    assert_eq!(problem(Distribution::Exponential, &[0.0]).map(|found| found.0), Some(0));
    assert_eq!(problem(Distribution::Exponential, &[f64::NAN]).map(|found| found.0), Some(0));
    assert_eq!(problem(Distribution::Uniform, &[1.0, 1.0]), None);
    assert_eq!(problem(Distribution::Normal, &[0.0, 0.0]), None);
}

#[test]
fn a_distribution_without_width_gives_its_value() {
    let key = Key { seed: 9, agent: "a", variable: "x", draw: 0 };
    for value in [0.1, -3.7, 1e300, f64::MIN_POSITIVE] {
        assert_eq!(Distribution::Uniform.draw(&[value, value], key), value);
        assert_eq!(Distribution::Normal.draw(&[value, 0.0], key), value);
    }
    assert!(Distribution::Uniform.draw(&[f64::MIN, f64::MAX], key).is_finite());
}
