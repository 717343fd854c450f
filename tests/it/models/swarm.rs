//! Do drones meet when they should, and lose no energy? Their ways between meetings are circles and swings, known on paper.

use super::first_root;
use crate::harness::{Case, near};

#[derive(Clone, Copy, Debug)]
struct Drone {
    turn: f64,
    rise: f64,
    level: f64,
    x: [f64; 3],
    v: [f64; 3],
}

impl Drone {
    /// The shipped drone of this number, at the start.
    fn shipped(number: usize) -> Self {
        let k = number as f64;
        let floors = [number % 3, number / 3 % 3, number / 9].map(|place| 12.0 * place as f64);
        Self {
            turn: 0.3 + 0.1 * (3 * number % 7) as f64,
            rise: 0.3 + 0.1 * (5 * number % 8) as f64,
            level: floors[2],
            x: [
                floors[0] + 0.1 * (7 * number % 11) as f64,
                floors[1] + 0.1 * (5 * number % 13) as f64,
                floors[2],
            ],
            v: [5.0 * (2.0 * k + 1.0).sin(), 5.0 * (3.0 * k).cos(), 2.5 * (5.0 * k).sin()],
        }
    }

    /// After so long without a meeting.
    fn after(&self, t: f64) -> Self {
        let (sin, cos) = (self.turn * t).sin_cos();
        let ([u, v, w], [x, y, z]) = (self.v, self.x);
        let (swing_sin, swing_cos) = (self.rise * t).sin_cos();
        let height = z - self.level;
        Self {
            x: [
                x + (u * sin - v * (1.0 - cos)) / self.turn,
                y + (u * (1.0 - cos) + v * sin) / self.turn,
                self.level + height * swing_cos + w / self.rise * swing_sin,
            ],
            v: [u * cos - v * sin, u * sin + v * cos, w * swing_cos - height * self.rise * swing_sin],
            ..*self
        }
    }

    fn gap(&self, other: &Self) -> f64 {
        (0..3).map(|k| (self.x[k] - other.x[k]).powi(2)).sum::<f64>() - 9.0
    }

    fn energy(&self) -> f64 {
        self.v.iter().map(|v| v * v).sum::<f64>() + (self.rise * (self.x[2] - self.level)).powi(2)
    }
}

/// The meetings up to `end`: the pairs are looked at every `step`, and a meeting between two looks is found by halving.
fn meetings(drones: &mut [Drone], end: f64, step: f64) -> Vec<(f64, usize, usize)> {
    let (mut time, mut met) = (0.0, Vec::new());
    while time < end {
        let to = end.min(time + step);
        let mut first: Option<(f64, usize, usize)> = None;
        for a in 0..drones.len() {
            for b in a + 1..drones.len() {
                let gap = |t: f64| drones[a].after(t).gap(&drones[b].after(t));
                if gap(0.0) <= 1e-9 || gap(to - time) > 0.0 {
                    continue;
                }
                let met = first_root(&gap, 0.0, to - time);
                if first.is_none_or(|(t, ..)| met < t) {
                    first = Some((met, a, b));
                }
            }
        }
        let length = first.map_or(to - time, |(t, ..)| t);
        drones.iter_mut().for_each(|drone| *drone = drone.after(length));
        time += length;
        if let Some((_, a, b)) = first {
            (drones[a].v, drones[b].v) = (drones[b].v, drones[a].v);
            met.push((time, a, b));
        }
        if to >= end && first.is_none() {
            break;
        }
    }
    met
}

#[test]
fn the_swarm_meets_as_worked_out() {
    let mut drones: Vec<Drone> = (0..27).map(Drone::shipped).collect();
    let energy: f64 = drones.iter().map(Drone::energy).sum();
    let expected = meetings(&mut drones, 20.0, 0.01);
    let run = Case::shipped("swarm.hy").tolerance(1e-10).run();
    assert!(expected.len() > 8, "{expected:?}");
    assert_eq!(run.events.len(), expected.len());
    for (event, (time, a, b)) in run.events.iter().zip(&expected) {
        near(event.time, *time, 1e-6);
        assert_eq!([&event.agent, &event.other], [&format!("drones[{a}]"), &format!("drones[{b}]")]);
    }
    let value = |drone: usize, name: &str| run.value(&format!("drones[{drone}].{name}"));
    let last = |k: usize| Drone {
        x: ["x", "y", "z"].map(|name| value(k, name)),
        v: ["vx", "vy", "vz"].map(|name| value(k, name)),
        ..drones[k]
    };
    near((0..27).map(|k| last(k).energy()).sum(), energy, 1e-6 * energy);
}

#[test]
fn a_swarm_lists_few_pairs() {
    // over a list's time no single box maps into itself, but the boxes of pieces of it do
    let run = Case::shipped("swarm.hy").param("n", 200).run();
    assert!(run.events.len() > 100);
    assert!(run.stats.pairs_listed < 200 * 50, "{} pairs were listed", run.stats.pairs_listed);
}
