//! The bumper problem at any size: the arena of `models/bumper.hy` and its cars, drawn by splitmix64, so that the numbers are those of
//! `models/bumper_N.csv`.

use std::fmt::Write as _;

/// A car: where it starts, and its constants.
#[derive(Clone, Copy, Debug)]
pub struct Car {
    /// Position, m.
    pub x: f64,
    /// Position, m.
    pub y: f64,
    /// Heading, rad.
    pub th: f64,
    /// Speed, m/s.
    pub v: f64,
    /// Frequency of its weaving, rad/s.
    pub w: f64,
    /// Phase of its weaving, rad.
    pub p: f64,
}

/// The generator: the same numbers on every machine.
struct Draws(u64);

impl Draws {
    /// Uniform in [0, 1).
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^= z >> 31;
        (z >> 11) as f64 * (1.0 / (1_u64 << 53) as f64)
    }
}

/// How many squares of 10 m the arena has along a side.
pub fn squares(n: usize) -> usize {
    (n as f64).sqrt().ceil() as usize
}

/// The cars: one in the middle of each square, a little displaced; speeds and frequencies spread over decades.
pub fn cars(n: usize, seed: u64) -> Vec<Car> {
    let m = squares(n);
    let mut draws = Draws(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15).wrapping_add(n as u64));
    let middle = |k: usize| (k as f64 + 0.5) * 10.0 - 5.0 * m as f64;
    let turn = std::f64::consts::TAU;
    let car = |k: usize| Car {
        x: middle(k % m) + (draws.next() * 6.0 - 3.0),
        y: middle(k / m) + (draws.next() * 6.0 - 3.0),
        th: draws.next() * turn,
        v: 0.2 * 10_f64.powf(draws.next()),
        w: 0.5 * 40_f64.powf(draws.next()),
        p: draws.next() * turn,
    };
    (0..n).map(car).collect()
}

/// The data file of these cars.
pub fn csv(cars: &[Car]) -> String {
    let mut text = "i,x,y,th,v,w,p\n".to_string();
    for (k, Car { x, y, th, v, w, p }) in cars.iter().enumerate() {
        let _ = writeln!(text, "{k},{x:?},{y:?},{th:?},{v:?},{w:?},{p:?}");
    }
    text
}
