//! Are the coefficients those of a method of order 5, and does a step do what they say?
//!
//! The coefficients of Hairer & Wanner's form come from the matrix G of the gamma_ij by a = alpha/G, C = 1/gamma - 1/G,
//! m = b/G. Turned back they give alpha, beta = alpha + G and b, for which the order conditions are those of rooted trees:
//! a node with one child carries beta, a node with several carries alpha (Solving ODEs II, IV.7).

use nalgebra::{Complex, SMatrix, SVector};

use super::*;
use crate::runtime::solve::method::{Past, Tsit5Rows};

type Matrix = SMatrix<f64, STAGES, STAGES>;
type Row = SVector<f64, STAGES>;

/// alpha, gamma and beta.
fn matrices() -> [Matrix; 3] {
    let full = |rows: [&[f64]; STAGES]| Matrix::from_fn(|i, j| rows[i].get(j).copied().unwrap_or(0.0));
    let inverse = Matrix::identity() / GAMMA - full(C);
    let gamma = inverse.try_inverse().expect("a triangle");
    let alpha = full(A) * gamma;
    [alpha, gamma, alpha + gamma]
}

/// Weights of the k from weights of the u.
fn weights(of_u: impl Fn(usize) -> f64) -> Row {
    matrices()[1].transpose() * Row::from_fn(|i, _| of_u(i))
}

fn of_result(i: usize) -> f64 {
    A[STAGES - 1].get(i).copied().unwrap_or(1.0)
}

fn of_embedded(i: usize) -> f64 {
    A[STAGES - 1].get(i).copied().unwrap_or(0.0)
}

/// A rooted tree: order, elementary weight at each stage, density.
#[derive(Clone, Debug)]
struct Tree {
    order: i32,
    at_stages: Row,
    density: f64,
}

/// All rooted trees of at most 5 nodes: a root over every multiset of smaller trees.
fn trees() -> Vec<Tree> {
    let [alpha, _, beta] = matrices();
    let mut trees = vec![Tree { order: 1, at_stages: Row::repeat(1.0), density: 1.0 }];
    for order in 2..=5 {
        let mut grown = Vec::new();
        let mut branches: Vec<(i32, usize, Vec<usize>)> = vec![(order - 1, 0, Vec::new())];
        while let Some((nodes, first, chosen)) = branches.pop() {
            if nodes == 0 {
                let at_stages = match chosen[..] {
                    [only] => beta * trees[only].at_stages,
                    _ => chosen.iter().fold(Row::repeat(1.0), |product, &child| {
                        product.component_mul(&(alpha * trees[child].at_stages))
                    }),
                };
                let below: f64 = chosen.iter().map(|&child| trees[child].density).product();
                grown.push(Tree { order, at_stages, density: f64::from(order) * below });
                continue;
            }
            for (child, tree) in trees.iter().enumerate().skip(first) {
                if tree.order <= nodes {
                    let mut chosen = chosen.clone();
                    chosen.push(child);
                    branches.push((nodes - tree.order, child, chosen));
                }
            }
        }
        trees.extend(grown);
    }
    assert_eq!(trees.len(), 1 + 1 + 2 + 4 + 9);
    trees
}

/// Rounding of coefficients of a size up to a hundred and sixteen digits.
const ROUNDING: f64 = 2e-13;

#[test]
fn the_method_has_order_five_and_the_embedded_one_exactly_four() {
    let (result, embedded) = (weights(of_result), weights(of_embedded));
    let mut defect: f64 = 0.0;
    for tree in trees() {
        let miss = (result.dot(&tree.at_stages) - 1.0 / tree.density).abs();
        assert!(miss < ROUNDING, "{tree:?}: {miss}");
        let miss = (embedded.dot(&tree.at_stages) - 1.0 / tree.density).abs();
        assert!(tree.order == 5 || miss < ROUNDING, "embedded, {tree:?}: {miss}");
        defect = defect.max(miss);
    }
    assert!(defect > 1e-4, "{defect}");
}

#[test]
fn the_dense_output_has_order_four_everywhere() {
    for step in 0..=20 {
        let theta = f64::from(step) / 20.0;
        let of_u = |j: usize| {
            let [d1, d2, d3] = DENSE.map(|row| row[j]);
            theta * of_result(j) + theta * (1.0 - theta) * (d1 + theta * (d2 + theta * d3))
        };
        let weights = weights(of_u);
        for tree in trees().into_iter().filter(|tree| tree.order <= 4) {
            let miss = weights.dot(&tree.at_stages) - theta.powi(tree.order) / tree.density;
            assert!(miss.abs() < ROUNDING, "theta {theta}, {tree:?}: {miss}");
        }
    }
}

#[test]
fn stages_stand_where_their_rows_sum_to() {
    let [alpha, gamma, _] = matrices();
    for i in 0..STAGES {
        assert!((alpha.row(i).sum() - TIMES[i]).abs() < ROUNDING, "time of stage {i}");
        assert!((gamma.row(i).sum() - TIME_RATES[i]).abs() < ROUNDING, "df/dt of stage {i}");
    }
}

#[test]
fn method_and_embedded_method_are_stiffly_accurate() {
    let beta = matrices()[2];
    let (result, embedded) = (weights(of_result), weights(of_embedded));
    for j in 0..STAGES {
        assert!((beta[(STAGES - 1, j)] - result[j]).abs() < ROUNDING, "result, {j}");
        assert!((beta[(STAGES - 2, j)] - embedded[j]).abs() < ROUNDING, "embedded, {j}");
    }
}

/// The factor by which a step of length 1 multiplies the solution of x' = z x.
fn stability(weights: &Row, z: Complex<f64>) -> Complex<f64> {
    let beta = matrices()[2].map(|entry| Complex::new(entry, 0.0));
    let matrix = SMatrix::<Complex<f64>, STAGES, STAGES>::identity() - beta * z;
    let ones = SVector::<Complex<f64>, STAGES>::repeat(Complex::new(1.0, 0.0));
    let stages = matrix.lu().solve(&ones).expect("no pole on the left");
    Complex::new(1.0, 0.0) + z * weights.map(|weight| Complex::new(weight, 0.0)).dot(&stages)
}

#[test]
fn both_are_l_stable() {
    for weights in [weights(of_result), weights(of_embedded)] {
        for power in -60..=60 {
            let y = 10f64.powf(f64::from(power) / 10.0);
            let factor = stability(&weights, Complex::new(0.0, y)).norm();
            assert!(factor <= 1.0 + 1e-12, "at {y} i: {factor}");
            let factor = stability(&weights, Complex::new(-y, y)).norm();
            assert!(factor <= 1.0 + 1e-12, "at {y} (i - 1): {factor}");
        }
        assert!(stability(&weights, Complex::new(-1e6, 0.0)).norm() < 1e-4);
    }
}

/// x' = -2 x + 3 y + sin t, y' = -x y + t^2: neither linear nor autonomous.
struct Coupled;

impl Flow for Coupled {
    fn rates(&mut self, t: f64, x: &[f64], dx: &mut [f64]) {
        dx[0] = -2.0 * x[0] + 3.0 * x[1] + t.sin();
        dx[1] = -x[0] * x[1] + t * t;
    }

    fn tsit5(&mut self, _t: f64, _h: f64, _rows: Tsit5Rows<'_>) -> bool {
        false
    }

    fn jacobian(&mut self, _t: f64, x: &[f64], jacobian: &mut Jacobian) {
        jacobian.reset(2);
        let entries = [(0, 0, -2.0), (0, 1, 3.0), (1, 0, -x[1]), (1, 1, -x[0])];
        entries.into_iter().for_each(|(row, column, value)| jacobian.push(row, column, value));
    }

    fn time_rates(&mut self, t: f64, _x: &[f64], rates: &mut [f64]) {
        rates.copy_from_slice(&[t.cos(), 2.0 * t]);
    }
}

const T: f64 = 0.3;
const X: [f64; 2] = [1.2, -0.7];

/// A step of length `h`: the trial, and the dense output.
fn step(h: f64) -> (Trial, Segment) {
    let (mut rodas, mut trial, mut segment) = (Rodas5p::default(), Trial::default(), Segment::default());
    trial.resize(2);
    let (mut past, mut rates) = (Past::default(), [0.0; 2]);
    Coupled.rates(T, &X, &mut rates);
    past.push(T, &rates, 1);
    rodas.step(&Start { t: T, h, x: &X, past: &past }, &mut Coupled, &mut trial);
    rodas.dense(&Stretch { t: T, h, end: T + h }, &X, 0, &mut segment);
    (trial, segment)
}

/// The exact solution at T + h to rounding: the classical Runge-Kutta method in 2000 steps.
fn exact(h: f64) -> [f64; 2] {
    let (n, mut x) = (2000, X);
    let dt = h / f64::from(n);
    for k in 0..n {
        let t = T + dt * f64::from(k);
        let slope = |x: [f64; 2], at: f64| {
            let mut dx = [0.0; 2];
            Coupled.rates(t + at * dt, &x, &mut dx);
            dx
        };
        let moved = |k: [f64; 2], part: f64| [0, 1].map(|i| x[i] + part * dt * k[i]);
        let k1 = slope(x, 0.0);
        let k2 = slope(moved(k1, 0.5), 0.5);
        let k3 = slope(moved(k2, 0.5), 0.5);
        let k4 = slope(moved(k3, 1.0), 1.0);
        x = [0, 1].map(|i| x[i] + dt / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]));
    }
    x
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[test]
fn the_error_of_a_step_falls_with_its_sixth_power_the_estimate_and_the_dense_output_with_the_fifth() {
    let errors = |h: f64| {
        let (trial, segment) = step(h);
        let estimate = trial.error.iter().fold(0.0_f64, |norm, error| norm.max(error.abs()));
        let within = (1..8).map(|k| {
            let part = h * f64::from(k) / 8.0;
            let mut x = [0.0; 2];
            segment.states(T + part, &mut x);
            distance(&x, &exact(part))
        });
        [distance(&trial.x_new, &exact(h)), estimate, within.fold(0.0, f64::max)]
    };
    let (long, short) = (errors(0.05), errors(0.025));
    let powers: Vec<f64> = long.iter().zip(short).map(|(long, short)| (long / short).log2()).collect();
    assert!((5.5..6.5).contains(&powers[0]), "{powers:?}");
    assert!((4.5..5.5).contains(&powers[1]), "{powers:?}");
    assert!((4.5..5.5).contains(&powers[2]), "{powers:?}");
}

#[test]
fn the_dense_output_ends_in_the_new_state_to_the_bit() {
    let (trial, segment) = step(0.125);
    let mut x = [0.0; 2];
    segment.states(T + 0.125, &mut x);
    assert_eq!(x.map(f64::to_bits), [0, 1].map(|i| trial.x_new[i].to_bits()));
    segment.states(T, &mut x);
    assert_eq!(x, X);
    let mut rates = [0.0; 2];
    Coupled.rates(T + 0.125, &trial.x_new, &mut rates);
    assert_eq!(trial.rates, rates, "the rates at its end are those that the next step begins with");
}
