//! Does the disturbance run through the platoon as control theory says? Against small fixed steps, and against the norms
//! and integrals that a transfer function gives.

use crate::harness::{Case, Run, near};

const KP: f64 = 0.3;
const KV: f64 = 0.6;
const N: usize = 10;

/// Speed and place of the first car relative to a steady drive, t after the start.
fn first(t: f64) -> [f64; 2] {
    let part = |t: f64, from: f64, length: f64| (t - from).clamp(0.0, length);
    let (brake, push) = (part(t, 5.0, 4.0), part(t, 9.0, 8.0));
    let rest = (t - 9.0 - push).max(0.0);
    let v = -2.0 * brake + push;
    let held = if t > 9.0 { -8.0 * push + 0.5 * push * push } else { 0.0 };
    [v, -brake * brake + held + rest * v]
}

/// Speeds relative to the steady drive of the followers at whole seconds, by the classical Runge-Kutta method.
fn small_steps(headway: f64, seconds: usize) -> Vec<[f64; N]> {
    // e: how much too far behind a car is; w: its speed, relative to the steady drive
    let rates = |t: f64, e: &[f64; N], w: &[f64; N]| {
        let mut out = ([0.0; N], [0.0; N]);
        for k in 0..N {
            let lead = if k == 0 { first(t)[0] } else { w[k - 1] };
            out.1[k] = KP * e[k] + KV * (lead - w[k]);
            out.0[k] = lead - w[k] - headway * out.1[k];
        }
        out
    };
    let add = |x: &[f64; N], k: &[f64; N], h: f64| std::array::from_fn(|i| x[i] + h * k[i]);
    let h = 1e-2;
    let (mut e, mut w) = ([0.0; N], [0.0; N]);
    let mut seen = vec![w];
    for n in 0..100 * seconds {
        let t = n as f64 * h;
        let k1 = rates(t, &e, &w);
        let k2 = rates(t + h / 2.0, &add(&e, &k1.0, h / 2.0), &add(&w, &k1.1, h / 2.0));
        let k3 = rates(t + h / 2.0, &add(&e, &k2.0, h / 2.0), &add(&w, &k2.1, h / 2.0));
        let k4 = rates(t + h, &add(&e, &k3.0, h), &add(&w, &k3.1, h));
        for i in 0..N {
            e[i] += h / 6.0 * (k1.0[i] + 2.0 * k2.0[i] + 2.0 * k3.0[i] + k4.0[i]);
            w[i] += h / 6.0 * (k1.1[i] + 2.0 * k2.1[i] + 2.0 * k3.1[i] + k4.1[i]);
        }
        if (n + 1) % 100 == 0 {
            seen.push(w);
        }
    }
    seen
}

/// Each car's deviation from the steady speed: the greatest, and the integral of its square.
fn deviations(run: &Run) -> Vec<[f64; 2]> {
    let deviation = |agent: String| {
        let speeds = run.column(&agent, 1).into_iter().map(|(_, v)| (v - 90.0) / 3.6);
        speeds.fold([0.0, 0.0], |[most, sum]: [f64; 2], w| [most.max(w.abs()), sum + 0.1 * w * w])
    };
    let cars = (0..N).map(|k| format!("cars[{k}]"));
    std::iter::once("first".to_owned()).chain(cars).map(deviation).collect()
}

#[test]
fn small_steps_lead_to_the_same_speeds() {
    for headway in [1.4, 0.6] {
        let run = Case::shipped("platoon.hy").param("Th", headway).run();
        let expected = small_steps(headway, 90);
        for k in 0..N {
            let speeds = run.column(&format!("cars[{k}]"), 1);
            for (second, row) in expected.iter().enumerate() {
                near((speeds[10 * second].1 - 90.0) / 3.6, row[k], 1e-6);
            }
        }
    }
}

#[test]
fn the_first_car_goes_through_its_modes() {
    let run = Case::shipped("platoon.hy").run();
    assert_eq!(
        run.log(),
        [
            "0 Car.brake first Cruise->Brake",
            "0 Car.push first Brake->Push",
            "0 Car.settle first Push->Steady"
        ]
    );
    assert_eq!(run.events.iter().map(|event| event.time).collect::<Vec<_>>(), [5.0, 9.0, 17.0]);
    for (time, x) in run.column("first", 0) {
        near(x, 25.0 * time + first(time)[1], 1e-7);
    }
}

#[test]
fn with_a_long_headway_the_disturbance_fades() {
    // kp Th^2 + 2 kv Th >= 2: |G(i w)| <= 1 for all w, so that no car's deviation has more energy than its leader's
    let run = Case::shipped("platoon.hy").run();
    let deviations = deviations(&run);
    assert!(deviations.windows(2).all(|pair| pair[1][1] < pair[0][1] && pair[1][0] < pair[0][0]));
    assert!(run.false_asserts.is_empty());
}

#[test]
fn with_a_short_headway_it_grows() {
    let run = Case::shipped("platoon.hy").param("Th", 0.6).run();
    let deviations = deviations(&run);
    assert!(deviations[1..].windows(2).all(|pair| pair[1][1] > pair[0][1] && pair[1][0] > pair[0][0]));
}

#[test]
fn every_car_loses_what_the_first_has_lost() {
    // G(0) = 1: 48 m, whoever it is and whatever the headway
    for headway in [1.4, 0.6] {
        let run = Case::shipped("platoon.hy").param("Th", headway).until(400.0).run();
        for k in 0..N {
            let start = -((k + 1) as f64) * (7.0 + headway * 25.0);
            near(run.value(&format!("cars[{k}].x")), start + 25.0 * 400.0 - 48.0, 1e-5);
        }
    }
}
