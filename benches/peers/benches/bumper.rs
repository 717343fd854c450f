//! The bumper problem beside diffsol: `cargo bench -p peers`. Both run in turn, several times, in one process; medians of
//! processor time and their ratio, after the events have been compared up to where the two part (the problem is chaotic).
//!
//! diffsol gets what its users would write: closures for the right-hand side and one root function for all walls and all pairs
//! (`tsit45`), a restart at each root with the reset applied. Compiling the model is shown by itself.

#[path = "../../problem.rs"]
mod problem;

use std::io;
use std::sync::atomic::AtomicBool;

use cpu_time::ProcessTime;
use diffsol::{NalgebraMat, OdeBuilder, OdeSolverMethod, OdeSolverStopReason};
use hyc::base::SourceMap;
use hyc::codegen::program::Program;
use hyc::codegen::{self, Backend};
use hyc::model::{Files, Settings};
use hyc::runtime::observe::{Event, Observer};
use hyc::runtime::{self, Limits};
use problem::{Car, cars, csv, squares};

const TOLERANCE: f64 = 1e-6;
const END: f64 = 20.0;
const R: f64 = 1.0;
const A: f64 = 0.5;

/// An event: when, what (a wall by its letter, or a pair), and whose.
#[derive(Clone, Debug, PartialEq)]
struct Hit {
    time: f64,
    what: &'static str,
    first: usize,
    second: usize,
}

/// The letters of the walls, in the order of the roots.
const WALLS: [&str; 4] = ["left", "right", "bottom", "top"];

/// Half the side of the arena less the margin.
fn half_side(n: usize) -> f64 {
    5.0 * squares(n) as f64 - R / 2.0
}

/// The data of the model.
struct Shelf(String);

impl Files for Shelf {
    fn read(&mut self, _path: &str) -> io::Result<Vec<u8>> {
        Ok(self.0.clone().into_bytes())
    }
}

fn compiled(cars: &[Car]) -> Program {
    let text = include_str!("../../../models/bumper.hy");
    let params = vec![("N".into(), cars.len().to_string())];
    let settings = Settings { params, until: Some(END), tolerance: Some(TOLERANCE), ..Settings::default() };
    let mut sources = SourceMap::default();
    let file = sources.add("bumper.hy", text);
    let tree = hyc::syntax::parse(file, text).expect("a shipped model");
    let model = hyc::model::check(&tree, &mut sources, &mut Shelf(csv(cars)), &settings).model;
    let system = hyc::calculus::derive(&model.expect("a shipped model")).expect("a shipped model");
    codegen::compile(system, Backend::Jit).expect("a shipped model")
}

/// Writes the events down.
struct Log(Vec<Hit>);

impl Observer for Log {
    fn event(&mut self, event: &Event<'_>) -> io::Result<()> {
        let wall = WALLS.iter().find(|wall| event.transition == format!("Car.{wall}"));
        let (a, b) = (event.agent.number, event.other.unwrap_or(event.agent).number);
        self.0.push(Hit {
            time: event.time,
            what: wall.unwrap_or(&"pair"),
            first: a.min(b),
            second: a.max(b),
        });
        Ok(())
    }
}

fn by_hyc(program: &Program) -> Vec<Hit> {
    let mut log = Log(Vec::new());
    runtime::simulate(program, &Limits::default(), &AtomicBool::new(false), &mut log);
    log.0
}

/// All walls of all cars, then all pairs: positive away from the event.
fn roots(x: &[f64], half: f64, g: &mut [f64]) {
    let n = x.len() / 3;
    let at = |k: usize| (x[3 * k], x[3 * k + 1]);
    for k in 0..n {
        let (px, py) = at(k);
        g[4 * k..4 * k + 4].copy_from_slice(&[px + half, half - px, py + half, half - py]);
    }
    let mut place = 4 * n;
    for i in 0..n {
        for j in i + 1..n {
            let ((xi, yi), (xj, yj)) = (at(i), at(j));
            g[place] = (xi - xj).powi(2) + (yi - yj).powi(2) - R * R;
            place += 1;
        }
    }
}

/// The cars of pair number `k`, in the order of [`roots`].
fn pair(n: usize, mut k: usize) -> (usize, usize) {
    for i in 0..n {
        if k < n - 1 - i {
            return (i, i + 1 + k);
        }
        k -= n - 1 - i;
    }
    unreachable!("there are n (n - 1)/2 pairs")
}

/// What root number `root` at this state means, if g falls there; its reset is applied.
fn react(cars: &[Car], x: &mut [f64], root: usize, time: f64) -> Option<Hit> {
    let n = cars.len();
    let velocity = |x: &[f64], k: usize| (cars[k].v * x[3 * k + 2].cos(), cars[k].v * x[3 * k + 2].sin());
    if root < 4 * n {
        let (k, wall) = (root / 4, root % 4);
        let (vx, vy) = velocity(x, k);
        if [vx, -vx, vy, -vy][wall] >= 0.0 {
            return None;
        }
        x[3 * k + 2] = (-x[3 * k + 1]).atan2(-x[3 * k]);
        return Some(Hit { time, what: WALLS[wall], first: k, second: k });
    }
    let (i, j) = pair(n, root - 4 * n);
    let (dx, dy) = (x[3 * i] - x[3 * j], x[3 * i + 1] - x[3 * j + 1]);
    let ((ux, uy), (vx, vy)) = (velocity(x, i), velocity(x, j));
    if dx * (ux - vx) + dy * (uy - vy) >= 0.0 {
        return None;
    }
    x[3 * i + 2] = dy.atan2(dx);
    x[3 * j + 2] = (-dy).atan2(-dx);
    Some(Hit { time, what: "pair", first: i, second: j })
}

fn by_diffsol(cars: &[Car]) -> Vec<Hit> {
    let n = cars.len();
    let half = half_side(n);
    let (of_rhs, of_init) = (cars.to_vec(), cars.to_vec());
    let problem = OdeBuilder::<NalgebraMat<f64>>::new()
        .rtol(TOLERANCE)
        .atol([TOLERANCE])
        .h0(1e-3)
        .rhs(move |x: &[f64], _p: &[f64], t: f64, dx: &mut [f64]| {
            for (k, car) in of_rhs.iter().enumerate() {
                let th = x[3 * k + 2];
                dx[3 * k] = car.v * th.cos();
                dx[3 * k + 1] = car.v * th.sin();
                dx[3 * k + 2] = A * car.w * (car.w * t + car.p).sin();
            }
        })
        .init(
            move |_p: &[f64], _t: f64, x: &mut [f64]| {
                for (k, car) in of_init.iter().enumerate() {
                    x[3 * k..3 * k + 3].copy_from_slice(&[car.x, car.y, car.th]);
                }
            },
            3 * n,
        )
        .root(move |x: &[f64], _p: &[f64], _t: f64, g: &mut [f64]| roots(x, half, g), 4 * n + n * (n - 1) / 2)
        .build()
        .expect("a problem");
    let mut solver = problem.tsit45().expect("a solver");
    solver.set_stop_time(END).expect("the end is ahead");
    let mut log = Vec::new();
    loop {
        match solver.step().expect("a step") {
            OdeSolverStopReason::InternalTimestep => {}
            OdeSolverStopReason::TstopReached => return log,
            OdeSolverStopReason::RootFound(time, root) => {
                solver.state_mut_back(time).expect("back to the root");
                let state = solver.state_mut();
                log.extend(react(cars, state.y.batch_as_mut_slice(0), root, time));
                solver.set_stop_time(END).expect("the end is ahead");
            }
        }
    }
}

/// How many events the two have in common from the start: the same, at times within 1e-3 s.
fn agreement(a: &[Hit], b: &[Hit]) -> usize {
    let same = |(a, b): &(&Hit, &Hit)| {
        (a.what, a.first, a.second) == (b.what, b.first, b.second) && (a.time - b.time).abs() <= 1e-3
    };
    a.iter().zip(b).take_while(same).count()
}

fn seconds(work: impl FnOnce()) -> f64 {
    let begun = ProcessTime::now();
    work();
    begun.elapsed().as_secs_f64()
}

fn median(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}

fn main() {
    println!(
        "| N | events in common, of hyc's, of diffsol's | hyc (ms) | diffsol tsit45 (ms) | diffsol / hyc | hyc, compiling (ms) |"
    );
    println!("|---|---|---|---|---|---|");
    for (n, runs) in [(5, 31), (20, 21), (100, 7), (200, 5)] {
        let cars = cars(n, 1);
        let mut program = None;
        let compiling = seconds(|| program = Some(compiled(&cars)));
        let program = program.expect("it was just made");
        let (ours, theirs) = (by_hyc(&program), by_diffsol(&cars));
        let common = agreement(&ours, &theirs);
        assert!(common > 0 || ours.is_empty(), "not one event in common: {ours:?} {theirs:?}");
        let (mut hyc, mut diffsol) = (Vec::new(), Vec::new());
        for _ in 0..runs {
            hyc.push(seconds(|| drop(by_hyc(&program))));
            diffsol.push(seconds(|| drop(by_diffsol(&cars))));
        }
        let (hyc, diffsol) = (median(hyc) * 1e3, median(diffsol) * 1e3);
        println!(
            "| {n} | {common}, {}, {} | {hyc:.2} | {diffsol:.2} | {:.1} | {:.1} |",
            ours.len(),
            theirs.len(),
            diffsol / hyc,
            compiling * 1e3
        );
    }
}
