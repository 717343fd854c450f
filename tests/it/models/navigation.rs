//! Do the robots cross the edges of their cells when they should? Within a cell the flow is linear: two exponentials.

use super::first_root;
use crate::harness::{Case, all_near};

/// A robot in a cell: when it came, where, how fast, and the wind.
#[derive(Clone, Copy)]
struct Visit {
    start: f64,
    cell: [i32; 2],
    at: [f64; 2],
    velocity: [f64; 2],
    wind: [f64; 2],
}

impl Visit {
    /// A = [-1.2, 0.1; 0.1, -1.2] has the eigenvectors (1, 1) and (1, -1), with -1.1 and -1.3.
    fn parts(&self) -> [(f64, f64); 2] {
        let [du, dv] = [0, 1].map(|i| self.velocity[i] - self.wind[i]);
        [(-1.1, 0.5 * (du + dv)), (-1.3, 0.5 * (du - dv))]
    }

    fn velocity(&self, t: f64) -> [f64; 2] {
        let [sum, difference] = self.parts().map(|(rate, size)| size * (rate * (t - self.start)).exp());
        [self.wind[0] + sum + difference, self.wind[1] + sum - difference]
    }

    fn position(&self, t: f64) -> [f64; 2] {
        let dt = t - self.start;
        let [sum, difference] = self.parts().map(|(rate, size)| size * (rate * dt).exp_m1() / rate);
        [self.at[0] + self.wind[0] * dt + sum + difference, self.at[1] + self.wind[1] * dt + sum - difference]
    }

    /// How far it is from the nearest edge of its cell, and which way that lies.
    fn margin(&self, t: f64) -> (f64, [i32; 2]) {
        let at = self.position(t);
        let [column, row] = self.cell.map(f64::from);
        let edges = [
            (at[0] - column, [-1, 0]),
            (column + 1.0 - at[0], [1, 0]),
            (at[1] - row, [0, -1]),
            (row + 1.0 - at[1], [0, 1]),
        ];
        edges.into_iter().min_by(|a, b| a.0.total_cmp(&b.0)).expect("four")
    }
}

/// Kind and wind of each cell of the shipped map.
fn map() -> Vec<([i32; 2], i32, [f64; 2])> {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/models/navigation_map.csv");
    let text = std::fs::read_to_string(path).unwrap();
    let cell = |line: &str| {
        let numbers: Vec<i32> = line.split(',').map(|number| number.parse().unwrap()).collect();
        let (sin, cos) = f64::from(numbers[3]).to_radians().sin_cos();
        ([numbers[0], numbers[1]], numbers[2], [sin, cos])
    };
    text.lines().skip(1).map(cell).collect()
}

/// The cells that a robot comes through until it rests, with times.
fn way(at: [f64; 2], velocity: [f64; 2]) -> Vec<Visit> {
    let map = map();
    let look_up = |cell: [i32; 2]| map.iter().find(|entry| entry.0 == cell).expect("nobody leaves the map");
    let first = at.map(|x| x.floor() as i32);
    let mut visits = vec![Visit { start: 0.0, cell: first, at, velocity, wind: look_up(first).2 }];
    loop {
        let here = visits[visits.len() - 1];
        if look_up(here.cell).1 == 1 {
            return visits;
        }
        let start = first_root(&|t| here.margin(t).0, here.start + 1e-4, 1e-4);
        let across = here.margin(start).1;
        let cell = [here.cell[0] + across[0], here.cell[1] + across[1]];
        let wind = look_up(cell).2;
        visits.push(Visit { start, cell, at: here.position(start), velocity: here.velocity(start), wind });
    }
}

#[test]
fn eight_robots_cross_the_map() {
    let run = Case::shipped("navigation.hy").run();
    assert!(run.false_asserts.is_empty());
    for k in 0..8 {
        let agent = format!("robots[{k}]");
        let number = f64::from(k);
        let visits = way([0.5, (number + 0.5) * 3.6 / 8.0], [0.3 * (number % 3.0 - 1.0), 0.2]);
        let times: Vec<f64> = visits.iter().map(|visit| visit.start).collect();
        all_near(&run.times_of("Robot.cross", &agent), &times, 1e-8);
        let last = visits[visits.len() - 1];
        all_near(&run.times_of("Robot.arrive", &agent), &[last.start], 1e-8);
        assert_eq!(run.mode(&agent), "Rest");
        let [x, y, column, row] =
            ["x", "y", "column", "row"].map(|name| run.value(&format!("{agent}.{name}")));
        all_near(&[x, y], &last.at, 1e-8);
        assert_eq!([column, row], last.cell.map(f64::from));
        // between the edges
        for (time, x) in run.column(&agent, 0).into_iter().filter(|(time, _)| *time < last.start) {
            let visit = visits.iter().rfind(|visit| visit.start <= time).expect("one begins at 0");
            all_near(&[x], &visit.position(time)[..1], 1e-8);
        }
    }
}
