//! Do the genes switch when they should? Against one right-hand side without modes, integrated in small fixed steps.

use super::first_root;
use crate::harness::{Case, all_near};

const HOUR: f64 = 3600.0;

/// Rates of size, signal and enzyme, in hours and nmol/L: the three modes are one clamped line.
fn rates([n, signal, enzyme]: [f64; 3]) -> [f64; 3] {
    let share = ((signal - 0.5) / 4.5).clamp(0.0, 1.0);
    [1.2 * n * (1.0 - n), n * (1.0 + 0.1 * enzyme) - signal, 50.0 * share - 0.5 * enzyme]
}

/// A step of the classical Runge-Kutta method.
fn step(x: [f64; 3], h: f64) -> [f64; 3] {
    let add = |k: [f64; 3], h: f64| [0, 1, 2].map(|i| x[i] + h * k[i]);
    let k1 = rates(x);
    let k2 = rates(add(k1, h / 2.0));
    let k3 = rates(add(k2, h / 2.0));
    let k4 = rates(add(k3, h));
    [0, 1, 2].map(|i| x[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]))
}

/// When the signal passes a threshold, upwards or downwards, in hours; the water is changed every 15 h.
fn crossings(threshold: f64) -> (Vec<f64>, Vec<f64>) {
    let (h, mut x) = (1.0 / 2000.0, [0.01, 0.0, 0.0]);
    let (mut up, mut down) = (Vec::new(), Vec::new());
    for k in 0..44 * 2000 {
        let time = f64::from(k) * h;
        let before = x[1] >= threshold;
        if k > 0 && k % 30_000 == 0 {
            x = [x[0] / 50.0, x[1] / 50.0, x[2]];
            if before && x[1] < threshold {
                down.push(time);
            }
        }
        let (here, after) = (x[1] >= threshold, step(x, h)[1] >= threshold);
        if here != after {
            let root = first_root(&|part| step(x, part)[1] - threshold, 0.0, h);
            if after { up.push(time + root) } else { down.push(time + root) }
        }
        x = step(x, h);
    }
    (up, down)
}

#[test]
fn the_colony_lights_up_three_times() {
    let run = Case::shipped("genetic_switch.hy").tolerance(1e-11).run();
    let hours = |transition: &str| -> Vec<f64> { run.times(transition).iter().map(|t| t / HOUR).collect() };
    let (wakes, fades) = crossings(0.5);
    let (reaches, dims) = crossings(5.0);
    assert_eq!([wakes.len(), fades.len(), reaches.len(), dims.len()], [3, 2, 3, 2]);
    all_near(&hours("Colony.waken"), &wakes, 1e-7);
    all_near(&hours("Colony.reach"), &reaches, 1e-7);
    all_near(&hours("Colony.fade"), &[15.0, 30.0], 0.0);
    all_near(&hours("Colony.dim"), &[15.0, 30.0], 0.0);
    assert_eq!((fades, dims), (vec![15.0, 30.0], vec![15.0, 30.0]));
    // fresh water: two thresholds in one instant, in the order of the modes
    let micro: Vec<(usize, &str)> =
        run.events[2..5].iter().map(|e| (e.micro, e.transition.as_str())).collect();
    assert_eq!(micro, [(0, "Colony.flush"), (1, "Colony.dim"), (2, "Colony.fade")]);
}

#[test]
fn the_end_is_that_of_small_steps() {
    let run = Case::shipped("genetic_switch.hy").tolerance(1e-11).until(14.0 * HOUR).run();
    let mut x = [0.01, 0.0, 0.0];
    for _ in 0..28_000 {
        x = step(x, 1.0 / 2000.0);
    }
    let end = ["n", "signal", "enzyme"].map(|name| run.value(&format!("colony.{name}")));
    all_near(&end, &x, 1e-7);
}
