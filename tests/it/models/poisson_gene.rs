//! Is the noise of the genes what it must be? Against the moments that are known at every time, and, event by event, against the
//! method of next reactions with the same random numbers.

use hyc::math::draw::{Distribution, Key};

use crate::harness::{Case, Run, all_near};

const MINUTE: f64 = 60.0;
/// Per minute: messengers made and lost, protein made and lost.
const RATES: [f64; 4] = [2.0, 0.2, 1.5, 0.05];
const END: f64 = 40.0;

fn colony(cells: usize, seed: u64, minutes: f64) -> Run {
    Case::shipped("poisson_gene.hy").param("cells", cells).seed(seed).until(minutes * MINUTE).run()
}

/// Means of messengers and protein, their variances, and their covariance, after so many minutes, by small steps of the linear
/// equations for them.
fn moments(minutes: f64) -> [f64; 5] {
    let [k_m, d_m, k_p, d_p] = RATES;
    let rates = |[m, p, vm, vp, c]: [f64; 5]| {
        [
            k_m - d_m * m,
            k_p * m - d_p * p,
            k_m + d_m * m - 2.0 * d_m * vm,
            2.0 * k_p * c - 2.0 * d_p * vp,
            k_p * vm - (d_m + d_p) * c,
        ]
    };
    let n = 40_000;
    let h = minutes / f64::from(n);
    let mut x = [0.0; 5];
    for _ in 0..n {
        let first = rates(x);
        let middle = rates([0, 1, 2, 3, 4].map(|i| x[i] + 0.5 * h * first[i]));
        x = [0, 1, 2, 3, 4].map(|i| x[i] + h * middle[i]);
    }
    x
}

/// Mean, variance, and the variance of the latter as an estimate.
fn estimates(values: &[f64]) -> [f64; 3] {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let moment = |k: i32| values.iter().map(|value| (value - mean).powi(k)).sum::<f64>() / n;
    let variance = moment(2) * n / (n - 1.0);
    [mean, variance, (moment(4) - variance * variance) / n]
}

#[test]
fn means_and_variances_are_those_of_theory() {
    let (cells, minutes) = (200, 20.0);
    let run = colony(cells, 1, minutes);
    let all =
        |name: &str| -> Vec<f64> { (0..cells).map(|k| run.value(&format!("colony[{k}].{name}"))).collect() };
    let (m, p) = (all("m"), all("p"));
    let [mean_m, mean_p, var_m, var_p, cov] = moments(minutes);
    // a Poisson process with deaths stays one: its variance is its mean
    all_near(&[var_m], &[mean_m], 1e-6);
    let n = cells as f64;
    for (values, mean, variance) in [(&m, mean_m, var_m), (&p, mean_p, var_p)] {
        let [found, spread, doubt] = estimates(values);
        let (off, apart) = ((found - mean) / (variance / n).sqrt(), (spread - variance) / doubt.sqrt());
        assert!(off.abs() < 3.5 && apart.abs() < 3.5, "{found} for {mean}, {spread} for {variance}");
        // and the test would see half as much noise more or less: the doubt about a variance is about sqrt(2/n) of it
        assert!(0.5 * variance > 3.5 * doubt.sqrt());
    }
    let products: Vec<f64> = m.iter().zip(&p).map(|(m, p)| (m - mean_m) * (p - mean_p)).collect();
    let [found, spread, _] = estimates(&products);
    assert!(((found - cov) / (spread / n).sqrt()).abs() < 3.5, "{found} for {cov}");
    // how often there are none, one, two, ... messengers: Pearson's test, which has as many degrees of freedom as it has
    // classes beside the last, that as its mean, and twice that as its variance
    let (mut chi, mut freedom) = (0.0, 0.0);
    let mut share = (-mean_m).exp();
    let mut rest = (n, n);
    for k in 0..19 {
        let found = m.iter().filter(|value| **value == f64::from(k)).count() as f64;
        // the first classes, in which fewer than five are expected, are told with the last
        if n * share >= 5.0 {
            chi += (found - n * share).powi(2) / (n * share);
            freedom += 1.0;
            rest = (rest.0 - found, rest.1 - n * share);
        }
        share *= mean_m / f64::from(k + 1);
    }
    chi += (rest.0 - rest.1).powi(2) / rest.1;
    assert!(freedom > 8.0 && chi < freedom + 4.0 * (2.0_f64 * freedom).sqrt(), "{chi}, {freedom}");
}

#[test]
fn every_event_comes_when_the_method_of_next_reactions_has_it() {
    let run = colony(3, 7, END);
    let [k_m, d_m, ..] = RATES;
    for cell in 0..3 {
        let agent = format!("colony[{cell}]");
        let mut draws = [0, 0];
        let mut draw = |which: usize| {
            draws[which] += 1;
            let variable = ["Cell.read", "Cell.lose"][which];
            let key = Key { seed: 7, agent: &agent, variable, draw: draws[which] };
            Distribution::Exponential.draw(&[1.0], key)
        };
        let (mut time, mut m) = (0.0, 0.0);
        let mut left = [draw(0), draw(1)];
        let mut times = [Vec::new(), Vec::new()];
        loop {
            let hazards = [k_m, d_m * m];
            let next = [left[0] / hazards[0], left[1] / hazards[1]];
            let which = usize::from(next[1] < next[0]);
            let step = next[which];
            time += step;
            if time > END {
                break;
            }
            left = [0, 1].map(|k| left[k] - step * hazards[k]);
            left[which] = draw(which);
            m += [1.0, -1.0][which];
            times[which].push(time * MINUTE);
        }
        assert!(times[0].len() > 50 && times[1].len() > 30);
        all_near(&run.times_of("Cell.read", &agent), &times[0], 1e-3);
        all_near(&run.times_of("Cell.lose", &agent), &times[1], 1e-3);
    }
}

#[test]
fn a_cell_more_changes_no_other() {
    let [few, more] = [colony(2, 3, END), colony(4, 3, END)];
    for agent in ["colony[0]", "colony[1]"] {
        assert_eq!(few.times_of("Cell.read", agent), more.times_of("Cell.read", agent));
    }
}
