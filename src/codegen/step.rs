//! A whole Runge-Kutta step as one function.
//!
//! In: the tape of a flow that reads no foreign state. Out: a function that makes all stages of [`TSIT5`] with the
//! states, the rates and the new state in registers, in the order of operations that `math::runge_kutta` lays down.

use std::sync::Arc;

use cranelift_codegen::ir::Value;

use crate::calculus::system::System;
use crate::codegen::emit::{Emitter, Leaves};
use crate::codegen::tape::{Instruction, Row, Tape};
use crate::math::runge_kutta::TSIT5;

/// The longest step that is made one function, in instructions; longer flows are stepped stage by stage.
///
/// Compilation grows faster than the function, and what a single function saves (calls, loads) is then small.
pub const STEP_LENGTH_MAX: usize = 6_000;

/// A step to be compiled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Task {
    /// The agent type.
    pub ty: usize,
    /// The mode.
    pub mode: usize,
    /// The number of the function that computes the rates.
    pub function: usize,
}

/// The steps worth compiling: of every mode whose flow reads no foreign state.
pub fn plan(system: &System, tapes: &[Arc<Tape>]) -> Vec<Task> {
    let mut tasks = Vec::new();
    for (ty, agent) in system.types.iter().enumerate() {
        for (mode, equations) in agent.modes.iter().enumerate() {
            let Some(flow) = equations.flow.as_ref().filter(|flow| flow.couples.is_empty()) else { continue };
            let function = flow.rates.index();
            if length(&tapes[function]) <= STEP_LENGTH_MAX {
                tasks.push(Task { ty, mode, function });
            }
        }
    }
    tasks
}

/// About how many instructions the step of a flow has.
fn length(tape: &Tape) -> usize {
    let combinations: usize = (1..=TSIT5.c.len()).map(|stage| 2 * stage).sum();
    (TSIT5.c.len() - 1) * tape.instructions.len() + combinations * tape.outputs.len()
}

/// Emits the step of a flow; parameters: table, time, h, k, x_new, err.
pub fn emit(emitter: &mut Emitter<'_, '_>, params: &[Value], tape: &Tape) {
    let n = tape.outputs.len();
    let &[_, time, h, k_rows, x_new, err] = params else { unreachable!("a step has six parameters") };
    let x: Vec<Value> = (0..n).map(|i| emitter.column(0, Row::States, i as u32)).collect();
    let reads_time =
        tape.instructions.iter().any(|instruction| matches!(instruction, Instruction::Time { .. }));
    let mut k: Vec<Vec<Value>> = vec![(0..n).map(|i| emitter.load(k_rows, i)).collect()];
    for stage in 1..TSIT5.c.len() {
        let states: Vec<Value> = (0..n)
            .map(|i| {
                let change = combination(emitter, &TSIT5.a[stage], &k, i, h);
                emitter.add(x[i], change)
            })
            .collect();
        let time = if reads_time { stage_time(emitter, time, stage, h) } else { time };
        let rates = emitter.tape(tape, &Leaves { time, states: Some(&states) });
        for (i, &rate) in rates.iter().enumerate() {
            emitter.store(rate, k_rows, stage * n + i);
        }
        k.push(rates);
        if stage + 1 == TSIT5.c.len() {
            states.iter().enumerate().for_each(|(i, &state)| emitter.store(state, x_new, i));
        }
    }
    for i in 0..n {
        let error = combination(emitter, &TSIT5.error, &k, i, h);
        emitter.store(error, err, i);
    }
}

/// `t + c_s h`.
fn stage_time(emitter: &mut Emitter<'_, '_>, time: Value, stage: usize, h: Value) -> Value {
    let fraction = emitter.constant(TSIT5.c[stage]);
    let delay = emitter.mul(fraction, h);
    emitter.add(time, delay)
}

/// `h ((w_1 k_1 + w_2 k_2) + ...)` for component `i`, weights that are 0 left out.
fn combination(
    emitter: &mut Emitter<'_, '_>,
    weights: &[f64],
    k: &[Vec<Value>],
    i: usize,
    h: Value,
) -> Value {
    let mut sum = None;
    for (&weight, rates) in weights.iter().zip(k).filter(|(weight, _)| **weight != 0.0) {
        let weight = emitter.constant(weight);
        let term = emitter.mul(weight, rates[i]);
        sum = Some(sum.map_or(term, |sum| emitter.add(sum, term)));
    }
    let sum = sum.unwrap_or_else(|| emitter.constant(0.0));
    emitter.mul(h, sum)
}
