//! Do the carts meet and part when they should? Alone and together they swing as pendulums of known frequency.

use super::first_root;
use crate::harness::{Case, near};

/// Mass, spring, place of rest.
const CARTS: [[f64; 3]; 2] = [[1.0, 20.0, -0.2], [2.0, 15.0, 0.2]];
const WIDTH: f64 = 0.1;
const HOLD: f64 = 4.0;

/// Both carts from one event to the next.
#[derive(Clone, Copy, Debug)]
struct Phase {
    start: f64,
    joined: bool,
    x: [f64; 2],
    v: [f64; 2],
}

impl Phase {
    /// Position and velocity of a swing about `rest`.
    fn swing(&self, x: f64, v: f64, w: f64, rest: f64, t: f64) -> [f64; 2] {
        let (sin, cos) = (w * (t - self.start)).sin_cos();
        let from_rest = x - rest;
        [rest + from_rest * cos + v / w * sin, v * cos - from_rest * w * sin]
    }

    fn at(&self, t: f64) -> Phase {
        let [[m0, k0, r0], [m1, k1, r1]] = CARTS;
        let [left, right] = if self.joined {
            let rest = (k0 * r0 + k1 * (r1 - WIDTH)) / (k0 + k1);
            let [x, v] = self.swing(self.x[0], self.v[0], ((k0 + k1) / (m0 + m1)).sqrt(), rest, t);
            [[x, v], [x + WIDTH, v]]
        } else {
            [(0, m0, k0, r0), (1, m1, k1, r1)]
                .map(|(i, m, k, r)| self.swing(self.x[i], self.v[i], (k / m).sqrt(), r, t))
        };
        Phase { start: t, joined: self.joined, x: [left[0], right[0]], v: [left[1], right[1]] }
    }

    /// What the glue has to bear.
    fn pull(&self) -> f64 {
        let [[m0, k0, r0], [m1, k1, r1]] = CARTS;
        (m0 * k1 * (r1 - self.x[1]) - m1 * k0 * (r0 - self.x[0])) / (m0 + m1)
    }

    /// Positive before the next event.
    fn margin(&self, t: f64) -> f64 {
        let then = self.at(t);
        if self.joined { HOLD - then.pull() } else { then.x[1] - then.x[0] - WIDTH }
    }

    fn next(&self, until: f64) -> Option<Phase> {
        let start = if self.margin(self.start + 1e-6) <= 0.0 && self.joined {
            self.start
        } else {
            let free = (1..).map(|k| self.start + 1e-4 * f64::from(k)).take_while(|t| *t <= until);
            free.clone().find(|t| self.margin(*t) <= 0.0)?;
            first_root(&|t| self.margin(t), self.start + 1e-4, 1e-4)
        };
        let mut next = self.at(start);
        next.joined = !self.joined;
        if next.joined {
            next.v = [(CARTS[0][0] * next.v[0] + CARTS[1][0] * next.v[1]) / (CARTS[0][0] + CARTS[1][0]); 2];
        }
        Some(next)
    }
}

#[test]
fn they_meet_three_times_and_part_twice() {
    let run = Case::shipped("collide_and_stick.hy").run();
    let mut phase = Phase { start: 0.0, joined: false, x: [-1.2, 1.0], v: [0.0, 0.0] };
    let mut events = run.events.chunks(2);
    while let Some(next) = phase.next(12.0) {
        let Some([left, right]) = events.next() else { panic!("no event at {}", next.start) };
        let expected = if next.joined { "Cart.meet" } else { "Cart.part" };
        for (event, agent) in [(left, "left"), (right, "right")] {
            assert_eq!((event.transition.as_str(), event.agent.as_str()), (expected, agent));
            near(event.time, next.start, 1e-8);
        }
        assert_eq!((left.time, left.micro), (right.time, right.micro));
        phase = next;
    }
    assert_eq!(run.log().len(), 10);
    assert!(phase.joined && events.next().is_none());
    let end = phase.at(12.0);
    for (i, agent) in ["left", "right"].into_iter().enumerate() {
        near(run.value(&format!("{agent}.x")), end.x[i], 1e-8);
        near(run.value(&format!("{agent}.v")), end.v[i], 1e-8);
    }
    // joined for nine seconds, they are as far apart as they were
    assert_eq!(run.value("left.v"), run.value("right.v"));
    near(run.value("right.x") - run.value("left.x"), WIDTH, 1e-12);
}
