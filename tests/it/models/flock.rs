//! Do the birds fly as the same equations in small steps say, and join when these do?

use crate::harness::{Case, near};

const N: usize = 20;

/// x, y, u, v of each bird.
type Flock = Vec<[f64; 4]>;

fn rates(flock: &Flock) -> Flock {
    let rate = |own: &[f64; 4]| {
        let mut sums = [0.0; 2];
        for other in flock {
            let d2 = (other[0] - own[0]).powi(2) + (other[1] - own[1]).powi(2);
            let pull = 1.0 / (1.0 + d2 / 100.0).sqrt();
            (0..2).for_each(|k| sums[k] += (other[2 + k] - own[2 + k]) * pull);
        }
        [own[2], own[3], 2.0 / N as f64 * sums[0], 2.0 / N as f64 * sums[1]]
    };
    flock.iter().map(rate).collect()
}

fn moved(flock: &Flock, rates: &Flock, h: f64) -> Flock {
    flock.iter().zip(rates).map(|(x, r)| std::array::from_fn(|k| x[k] + h * r[k])).collect()
}

/// The classical Runge-Kutta method.
fn step(flock: &Flock, h: f64) -> Flock {
    let a = rates(flock);
    let b = rates(&moved(flock, &a, h / 2.0));
    let c = rates(&moved(flock, &b, h / 2.0));
    let d = rates(&moved(flock, &c, h));
    let mean: Flock = (0..N)
        .map(|i| std::array::from_fn(|k| (a[i][k] + 2.0 * b[i][k] + 2.0 * c[i][k] + d[i][k]) / 6.0))
        .collect();
    moved(flock, &mean, h)
}

/// How far from a bird's velocity that of another is at most.
fn spread(flock: &Flock, bird: usize) -> f64 {
    let apart = |other: &[f64; 4]| (other[2] - flock[bird][2]).hypot(other[3] - flock[bird][3]);
    flock.iter().map(apart).fold(0.0, f64::max)
}

#[test]
fn the_flock_flies_as_small_steps_say() {
    let run = Case::shipped("flock.hy").run();
    let rows = &run.samples[0];
    let at = |time: f64| -> Flock {
        let rows = rows.iter().filter(|row| (row.time - time).abs() < 1e-9);
        rows.map(|row| [row.cells[0], row.cells[1], row.cells[2], row.cells[3]]).collect()
    };
    let (mut flock, h) = (at(0.0), 0.005);
    assert_eq!(flock.len(), N);
    let mean = |flock: &Flock, k: usize| flock.iter().map(|bird| bird[k]).sum::<f64>() / N as f64;
    let (first, mut joined) = ([mean(&flock, 2), mean(&flock, 3)], [0.0; N]);
    for k in 0..1200 {
        let next = step(&flock, h);
        for (bird, joined) in joined.iter_mut().enumerate() {
            let (before, after) = (spread(&flock, bird), spread(&next, bird));
            if before > 0.1 && after <= 0.1 {
                *joined = h * (k as f64 + (before - 0.1) / (before - after));
            }
        }
        flock = next;
    }
    for (bird, (ours, small)) in at(6.0).iter().zip(&flock).enumerate() {
        (0..4).for_each(|k| near(ours[k], small[k], 1e-4));
        let times = run.times_of("Bird.join", &format!("birds[{bird}]"));
        assert_eq!(times.len(), 1, "bird {bird}");
        near(times[0], joined[bird], 1e-3);
    }
    for (k, start) in first.into_iter().enumerate() {
        near(mean(&at(6.0), 2 + k), start, 1e-6);
    }
}
