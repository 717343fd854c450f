//! What the compiler and the simulator take: `cargo bench` prints tables, in a few minutes. Times are medians
//! of wall-clock time: run it on a quiet machine.
//!
//! Compiling is from text to machine code. A right-hand side is one evaluation of an agent's flow, by the interpreter and by machine code.
//! The bumper problem and the swarm are run to t = 20 s, the highway to 100 s; steps are all accepted and rejected ones. Operators over lanes are timed on 32 lanes.

mod lanes;
mod problem;

use std::collections::HashMap;
use std::hint::black_box;
use std::io;
use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use hyc::base::SourceMap;
use hyc::calculus;
use hyc::codegen::kernel::AgentView;
use hyc::codegen::program::Program;
use hyc::codegen::{self, Backend};
use hyc::math::{N_LANES, Numbers, Wide};
use hyc::model::{self, Files, Settings};
use hyc::runtime::observe::{Event, Last, Observer, Outcome, Row};
use hyc::runtime::{self, Algorithm, Form, Limits};
use hyc::syntax;

/// The data files of a model, by name.
#[derive(Default)]
struct Shelf(HashMap<String, Vec<u8>>);

impl Files for Shelf {
    fn read(&mut self, path: &str) -> io::Result<Vec<u8>> {
        match self.0.get(path) {
            Some(text) => Ok(text.clone()),
            None => std::fs::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("models").join(path)),
        }
    }
}

/// Takes what a run says, and keeps nothing.
struct Silence;

impl Observer for Silence {
    fn event(&mut self, event: &Event<'_>) -> io::Result<()> {
        black_box(event);
        Ok(())
    }

    fn sample(&mut self, _record: usize, row: &Row<'_>) -> io::Result<()> {
        black_box(row);
        Ok(())
    }

    fn last(&mut self, last: &Last<'_>) -> io::Result<()> {
        black_box(last);
        Ok(())
    }
}

fn compile(text: &str, shelf: &mut Shelf, settings: &Settings, backend: Backend) -> Program {
    let mut sources = SourceMap::default();
    let file = sources.add("bench.hy", text);
    let tree = syntax::parse(file, text).expect("a shipped model");
    let model = model::check(&tree, &mut sources, shelf, settings).model.expect("a shipped model");
    let system = calculus::derive(&model).expect("a shipped model");
    codegen::compile(system, backend).expect("a shipped model")
}

fn simulate(program: &Program) -> Outcome {
    simulate_by(Form::default(), program)
}

/// A run in one form of the engine.
fn simulate_by(form: Form, program: &Program) -> Outcome {
    let (limits, interrupt) = (Limits::default(), AtomicBool::new(false));
    runtime::simulate_by(Algorithm::Masim(form), program, &limits, &interrupt, &mut Silence)
}

/// A run that takes longer than this is not repeated, s.
const LONG: f64 = 5.0;

/// The median of so many runs after a first one, in seconds; of a long one that alone.
fn median(runs: usize, mut work: impl FnMut()) -> f64 {
    let mut timed = || {
        let begun = Instant::now();
        work();
        begun.elapsed().as_secs_f64()
    };
    let first = timed();
    if first > LONG {
        return first;
    }
    let mut times: Vec<f64> = (0..runs).map(|_| timed()).collect();
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}

fn models() -> Vec<(String, String)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("models");
    let mut models: Vec<(String, String)> = std::fs::read_dir(folder)
        .expect("the folder of models")
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| path.extension().is_some_and(|extension| extension == "hy"))
        .map(|path| {
            let name = path.file_stem().map_or(String::new(), |stem| stem.to_string_lossy().into_owned());
            (name, std::fs::read_to_string(path).expect("a model"))
        })
        .collect();
    models.sort();
    models
}

/// Text to program, and one run, for each shipped model.
fn compile_times() {
    println!("\n| model | check (ms) | compile, interpreter (ms) | compile, machine code (ms) | run (ms) |");
    println!("|---|---|---|---|---|");
    for (name, text) in models() {
        let settings = Settings::default();
        let mut shelf = Shelf::default();
        let check = median(9, || {
            let mut sources = SourceMap::default();
            let file = sources.add("bench.hy", text.as_str());
            let tree = syntax::parse(file, &text).expect("a shipped model");
            black_box(model::check(&tree, &mut sources, &mut shelf, &settings));
        });
        let [interpreter, jit] = [Backend::Interpreter, Backend::Jit]
            .map(|backend| median(9, || drop(black_box(compile(&text, &mut shelf, &settings, backend)))));
        let program = compile(&text, &mut shelf, &settings, Backend::Jit);
        let run = median(3, || drop(black_box(simulate(&program))));
        let [check, interpreter, jit, run] = [check, interpreter, jit, run].map(|seconds| seconds * 1e3);
        println!("| {name} | {check:.2} | {interpreter:.2} | {jit:.2} | {run:.1} |");
    }
}

/// The text of a shipped model.
fn shipped(name: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("models").join(name);
    std::fs::read_to_string(path).expect("a shipped model")
}

/// The bumper problem with N cars.
fn bumper(n: usize, backend: Backend) -> Program {
    let mut shelf = Shelf::default();
    shelf.0.insert("cars.csv".into(), problem::csv(&problem::cars(n, 1)).into_bytes());
    let params = vec![("N".into(), n.to_string()), ("data".into(), "cars.csv".into())];
    compile(&shipped("bumper.hy"), &mut shelf, &Settings { params, ..Settings::default() }, backend)
}

/// The swarm with n drones.
fn swarm(n: usize) -> Program {
    let settings = Settings { params: vec![("n".into(), n.to_string())], ..Settings::default() };
    compile(&shipped("swarm.hy"), &mut Shelf::default(), &settings, Backend::Jit)
}

/// The highway with so many lanes, until as many cars leave as enter: some 13 a lane.
fn highway(lanes: usize) -> Program {
    let params = vec![("lanes".into(), lanes.to_string())];
    let settings = Settings { params, until: Some(100.0), ..Settings::default() };
    compile(&shipped("highway.hy"), &mut Shelf::default(), &settings, Backend::Jit)
}

/// How many evaluations are timed together: one alone is shorter than the clock's tick.
const REPEATS: usize = 20_000;

/// The first car's rows, as a kernel reads them: its states and its auxiliary columns.
fn rows(program: &Program) -> (Vec<f64>, Vec<f64>) {
    let car = &program.population.agents[0];
    let layout = &program.types[0].layout;
    let mut aux = vec![0.0; layout.n_aux()];
    for (k, &value) in car.params.iter().enumerate() {
        aux[layout.param(k)] = value;
    }
    (car.states.clone(), aux)
}

/// One right-hand side of a car, in seconds.
fn right_hand_side(program: &Program) -> f64 {
    let (states, aux) = rows(program);
    let flow = program.types[0].modes[0].flow.as_ref().expect("a car has one mode");
    let kernel = program.kernel(flow.rates);
    let car = [AgentView { states: &states, rates: &[], accelerations: &[], aux: &aux }];
    let mut rates = vec![0.0; states.len()];
    let all = median(31, || {
        for k in 0..REPEATS {
            kernel.eval(black_box(&car), k as f64 * 1e-3, &mut rates);
            black_box(&rates);
        }
    });
    all / REPEATS as f64
}

/// One whole step of a car in machine code, in seconds.
fn whole_step(program: &Program) -> f64 {
    let (states, aux) = rows(program);
    let step = program.steps[0][0].as_ref().expect("the flow of a car reads no other agent");
    let car = [AgentView { states: &states, rates: &[], accelerations: &[], aux: &aux }];
    let n = states.len();
    let (mut stages, mut end, mut error) = (vec![0.0; 7 * n], vec![0.0; n], vec![0.0; n]);
    let all = median(31, || {
        for k in 0..REPEATS {
            step.step(black_box(&car), k as f64 * 1e-3, 0.01, &mut stages, &mut end, &mut error);
            black_box(&end);
        }
    });
    all / REPEATS as f64
}

/// The expansion of a car by the order of a tolerance: alone, and of each of as many as lanes, in seconds.
fn expansions(program: &Program, order: usize) -> [f64; 2] {
    let (states, aux) = rows(program);
    let series = program.series[0][0].as_ref().expect("the flow of a car has a series");
    let (mut fixed, mut room) = (vec![0.0; series.fixed.len()], vec![0.0; series.n_coefficients(order)]);
    let alone = median(31, || {
        for k in 0..REPEATS {
            series.fix(|_, column| black_box(&aux)[column as usize], &mut fixed);
            series.expand(k as f64 * 1e-3, black_box(&states), &fixed, order, &mut room);
            black_box(&room);
        }
    });
    let wide_aux: Vec<Wide> = aux.iter().map(|&x| Wide::all(x)).collect();
    // Lanes that differ: no number is known beforehand.
    let wide_states: Vec<Wide> =
        states.iter().map(|&x| Wide(std::array::from_fn(|lane| x + 0.01 * lane as f64))).collect();
    let nothing = Wide::all(0.0);
    let (mut fixed, mut room) =
        (vec![nothing; series.fixed.len()], vec![nothing; series.n_coefficients(order)]);
    series.fix_wide(|_, column| wide_aux[column as usize], &mut fixed);
    let rounds = REPEATS / N_LANES;
    let together = median(31, || {
        for k in 0..rounds {
            series.expand_wide(Wide::all(k as f64 * 1e-3), black_box(&wide_states), &fixed, order, &mut room);
            black_box(&room);
        }
    });
    [alone / REPEATS as f64, together / (rounds * N_LANES) as f64]
}

/// A Taylor step's expansion against a whole Runge-Kutta step of the same car.
fn series(program: &Program) {
    println!(
        "\n| bumper, one car: order | alone (ns) | in {N_LANES} lanes (ns) | Runge-Kutta step, alone (ns) |"
    );
    println!("|---|---|---|---|");
    let step = whole_step(program) * 1e9;
    for order in [8, 10, 12, 14] {
        let [alone, together] = expansions(program, order).map(|seconds| seconds * 1e9);
        println!("| {order} | {alone:.0} | {together:.1} | {step:.0} |");
    }
}

/// The interpreter against machine code: a right-hand side, a whole step, and a whole run.
fn back_ends() {
    println!("\n| bumper, N = 20 | interpreter | machine code | ratio |");
    println!("|---|---|---|---|");
    let programs = [Backend::Interpreter, Backend::Jit].map(|backend| bumper(20, backend));
    let [interpreter, jit] = programs.each_ref().map(right_hand_side);
    let ratio = interpreter / jit;
    println!("| right-hand side (ns) | {:.0} | {:.0} | {ratio:.2} |", interpreter * 1e9, jit * 1e9);
    println!("| Runge-Kutta step of six, in one function (ns) | | {:.0} | |", whole_step(&programs[1]) * 1e9);
    let mut steps = 0;
    let [interpreter, jit] = programs.each_ref().map(|program| {
        median(31, || {
            let outcome = simulate(program);
            steps = outcome.stats.steps + outcome.stats.rejected;
        })
    });
    let ratio = interpreter / jit;
    println!("| run (ms) | {:.2} | {:.2} | {ratio:.2} |", interpreter * 1e3, jit * 1e3);
    let per_step = |seconds: f64| seconds * 1e9 / steps as f64;
    println!(
        "| run, per step with its detection (ns) | {:.0} | {:.0} | {ratio:.2} |",
        per_step(interpreter),
        per_step(jit)
    );
}

/// One model at several sizes, counted in `unit`, in the fast form, and up to `plain_max` in the plain one, which lists all pairs.
fn sizes(model: &str, unit: &str, sizes: &[usize], plain_max: usize, program: impl Fn(usize) -> Program) {
    println!(
        "\n| {model}: {unit} | compile (ms) | run (ms) | steps | events | run / {unit} (us) | plain form, run (ms) |"
    );
    println!("|---|---|---|---|---|---|---|");
    for &n in sizes {
        let begun = Instant::now();
        let program = program(n);
        let compiled = begun.elapsed().as_secs_f64() * 1e3;
        let (mut steps, mut events) = (0, 0);
        let run = median(if n > 100 { 3 } else { 5 }, || {
            let outcome = simulate(&program);
            (steps, events) = (outcome.stats.steps + outcome.stats.rejected, outcome.stats.events);
        });
        let plain = (n <= plain_max).then(|| median(3, || drop(simulate_by(Form::Plain, &program))));
        println!(
            "| {n} | {compiled:.1} | {:.2} | {steps} | {events} | {:.1} | {} |",
            run * 1e3,
            run * 1e6 / n as f64,
            plain.map_or("".into(), |plain| format!("{:.2}", plain * 1e3))
        );
    }
}

fn main() {
    compile_times();
    back_ends();
    series(&bumper(20, Backend::Jit));
    let cars = [2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 20_000];
    sizes("bumper", "N", &cars, 500, |n| bumper(n, Backend::Jit));
    sizes("swarm", "n", &[27, 200, 1000, 10_000], 200, swarm);
    sizes("highway", "lanes", &[8, 80, 800], 8, highway);
    lanes::table();
}
