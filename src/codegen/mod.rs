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
pub mod kernel;
pub mod program;
pub mod trace;

use std::time::Instant;

use crate::base::Diagnostic;
use crate::calculus::system::{AgentSystem, System};
use crate::codegen::jit::Code;
use crate::codegen::kernel::{Kernel, StepKernel};
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
}

/// Compiles every function of a system.
pub fn compile(system: System, backend: Backend) -> Result<Program, Diagnostic> {
    let start = Instant::now();
    let tapes = record(&system);
    let code = match backend {
        Backend::Interpreter => Code::none(tapes.len()),
        Backend::Jit => jit::assemble(&routine::routines(&system, &tapes), tapes.len())?,
    };
    let cost = measure(&tapes, &code, start);
    Ok(link(system, tapes, code, cost))
}

/// A tape for each function, same number.
fn record(system: &System) -> Vec<Tape> {
    system.functions.iter().map(|function| tape::record(&system.graph, &function.outputs)).collect()
}

/// What it took.
fn measure(tapes: &[Tape], code: &Code, start: Instant) -> Cost {
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
fn link(system: System, tapes: Vec<Tape>, code: Code, cost: Cost) -> Program {
    let modes = system.types.iter().map(|ty| ty.modes.len());
    let mut steps: Vec<Vec<Option<StepKernel>>> = modes.map(|n| (0..n).map(|_| None).collect()).collect();
    for (task, code) in code.steps {
        steps[task.ty][task.mode] = Some(StepKernel::new(&tapes[task.function], code));
    }
    let series = series(&system, |_, _, found| found.ok());
    let kernels = tapes.into_iter().zip(code.kernels).map(|(tape, code)| Kernel::new(tape, code)).collect();
    let System { graph, functions, types, interactions, population, run, watch } = system;
    Program { graph, functions, types, interactions, population, run, watch, kernels, steps, series, cost }
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
