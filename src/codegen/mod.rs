//! From systems of equations to a program that runs.
//!
//! In: a [`System`]. Out: a [`Program`]: the structure of the system with a kernel for each of its functions.
//! Promised: each function is compiled once, however many agents there are; a kernel gives the same bits interpreted
//! and as machine code, those of `Op::eval` in the order of the graph; the same system gives the same code.

mod tape;
pub mod series;
pub mod block;
mod interpret;
mod emit;
mod step;
mod routine;
mod jit;
mod later;
pub mod kernel;
pub mod program;
pub mod trace;

use std::sync::Arc;
use std::time::Instant;

use crate::base::Diagnostic;
use crate::calculus::system::{AgentSystem, System};
use crate::codegen::jit::Code;
use crate::codegen::kernel::{Kernel, Means, StepKernel, StepMeans};
use crate::codegen::later::Later;
use crate::codegen::program::{Cost, Program};
use crate::codegen::series::{NoSeries, SeriesTape};
use crate::codegen::tape::Tape;

/// What runs a kernel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Backend {
    /// The interpreter: runs everywhere, compiles in no time.
    Interpreter,
    /// Machine code made by Cranelift.
    Jit,
    /// The interpreter, and machine code as soon as it pays.
    Auto,
}

/// Compiles every function of a system.
pub fn compile(system: System, backend: Backend) -> Result<Program, Diagnostic> {
    let start = Instant::now();
    let tapes = record(&system);
    let (mut code, mut later) = (Code::none(tapes.len()), None);
    match backend {
        Backend::Interpreter => {}
        Backend::Jit => code = jit::assemble(&routine::routines(&system, &tapes), tapes.len())?,
        Backend::Auto => later = Some(Arc::new(Later::new(&routine::routines(&system, &tapes), &tapes))),
    }
    let cost = measure(&tapes, &code, start);
    Ok(link(system, tapes, code, later, cost))
}

/// A tape for each function, same number.
fn record(system: &System) -> Vec<Arc<Tape>> {
    let tape = |outputs: &[_]| Arc::new(tape::record(&system.graph, outputs));
    system.functions.iter().map(|function| tape(&function.outputs)).collect()
}

/// What it took.
fn measure(tapes: &[Arc<Tape>], code: &Code, start: Instant) -> Cost {
    let compiled = code.kernels.iter().flatten().count();
    Cost {
        functions: compiled + code.steps.len(),
        interpreted: tapes.len() - compiled,
        instructions: tapes.iter().map(|tape| tape.instructions.len()).sum(),
        code_bytes: code.bytes,
        seconds: start.elapsed().as_secs_f64(),
    }
}

/// Puts structure, tapes and machine code together.
fn link(system: System, tapes: Vec<Arc<Tape>>, code: Code, later: Option<Arc<Later>>, cost: Cost) -> Program {
    let modes = system.types.iter().map(|ty| ty.modes.len());
    let mut steps: Vec<Vec<Option<StepKernel>>> = modes.map(|n| (0..n).map(|_| None).collect()).collect();
    for (task, code) in code.steps {
        steps[task.ty][task.mode] = Some(StepKernel::new(&tapes[task.function], StepMeans::Code(code)));
    }
    for (number, task) in later.iter().flat_map(|later| later.steps()).enumerate() {
        let means = later.clone().map(|later| StepMeans::Later(later, number));
        steps[task.ty][task.mode] = means.map(|means| StepKernel::new(&tapes[task.function], means));
    }
    let series = series(&system, |_, _, found| found.ok());
    let means = |number: usize, code: Option<_>| match (code, &later) {
        (Some(code), _) => Means::Code(code),
        (None, Some(later)) => Means::Later(Arc::clone(later), number),
        (None, None) => Means::Tape,
    };
    let kernels = tapes.into_iter().zip(code.kernels).enumerate();
    let kernels = kernels.map(|(number, (tape, code))| Kernel::new(tape, means(number, code))).collect();
    let System { graph, functions, types, interactions, population, run, watch } = system;
    Program {
        graph,
        functions,
        types,
        interactions,
        population,
        run,
        watch,
        kernels,
        steps,
        series,
        cost,
        later,
    }
}

/// What is made of the series of each mode's flow, or of why there is none: for each type, for each mode.
fn series<T>(
    system: &System,
    make: impl Fn(&AgentSystem, usize, Result<SeriesTape, NoSeries>) -> Option<T>,
) -> Vec<Vec<Option<T>>> {
    let of_mode = |agent: &AgentSystem, mode: usize| {
        let flow = agent.modes[mode].flow.as_ref()?;
        let found = match flow.couples[..] {
            [] => series::record(&system.graph, &system.functions[flow.rates].outputs),
            [..] => Err(NoSeries::ReadsOthers),
        };
        make(agent, mode, found)
    };
    let of_type = |agent: &AgentSystem| (0..agent.modes.len()).map(|mode| of_mode(agent, mode)).collect();
    system.types.iter().map(of_type).collect()
}

/// The tapes of all functions and the series of all flows, as text (`hyc show --stage tape`).
pub fn dump_tape(system: &System) -> String {
    let tapes = record(system);
    let listings = system.functions.iter().zip(&tapes).map(|(function, tape)| {
        let (n, m) = (tape.instructions.len(), tape.n_registers);
        format!("{}: {n} instructions, {m} registers\n{tape}", function.name)
    });
    let series = series(system, |agent, mode, found| {
        let flow = agent.modes[mode].flow.as_ref()?;
        let name = &system.functions[flow.rates].name;
        Some(match found {
            Ok(tape) => format!("{name} series: {} recurrences\n{tape}", tape.instructions.len()),
            Err(reason) => format!("{name} has no series: {reason}\n"),
        })
    });
    listings.chain(series.into_iter().flatten().flatten()).collect::<Vec<_>>().join("\n")
}

/// The Cranelift IR of all functions, before optimisation, as text (`hyc show --stage clif`): the same on every host.
pub fn dump_clif(system: &System) -> String {
    let tapes = record(system);
    let routines = routine::routines(system, &tapes);
    let listings = routines.iter().enumerate().map(|(number, routine)| routine.listing(number));
    listings.collect::<Vec<_>>().join("\n")
}
