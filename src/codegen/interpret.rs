//! The interpreter: runs a tape on numbers or on intervals, instruction by instruction.
//!
//! In: a [`Tape`], the rows of the agents, registers. Out: the outputs. On numbers every operator is `Op::eval`, on
//! intervals `Interval::eval`: there is no other meaning here.

use crate::codegen::kernel::{AgentBox, AgentView};
use crate::codegen::tape::{Instruction, Row, Tape};
use crate::math::{Interval, Op};

/// What a register may hold.
pub trait Value: Copy {
    /// The value of a constant.
    fn constant(value: f64) -> Self;
    /// The operator's result; operands beyond its arity are not looked at.
    fn apply(op: Op, operands: [Self; 3]) -> Self;
}

impl Value for f64 {
    #[inline]
    fn constant(value: f64) -> Self {
        value
    }
    #[inline]
    fn apply(op: Op, operands: [Self; 3]) -> Self {
        op.eval(operands)
    }
}

impl Value for Interval {
    fn constant(value: f64) -> Self {
        Interval::point(value)
    }
    fn apply(op: Op, operands: [Self; 3]) -> Self {
        Interval::eval(op, &operands[..op.arity()])
    }
}

/// Where a tape's loads come from.
pub trait Agents {
    /// What the columns are.
    type Value: Value;
    /// One column.
    fn load(&self, slot: usize, row: Row, column: usize) -> Self::Value;
}

impl Agents for [AgentView<'_>] {
    type Value = f64;
    #[inline]
    fn load(&self, slot: usize, row: Row, column: usize) -> f64 {
        let agent = &self[slot];
        match row {
            Row::States => agent.states[column],
            Row::Rates => agent.rates[column],
            Row::Accelerations => agent.accelerations[column],
            Row::Aux => agent.aux[column],
        }
    }
}

impl Agents for [AgentBox<'_>] {
    type Value = Interval;
    fn load(&self, slot: usize, row: Row, column: usize) -> Interval {
        let agent = &self[slot];
        match row {
            Row::States => agent.states[column],
            Row::Rates => agent.rates[column],
            Row::Accelerations => agent.accelerations[column],
            Row::Aux => Interval::point(agent.aux[column]),
        }
    }
}

/// Runs a tape. `registers` holds at least `tape.n_registers` values, whatever they are; `out` at least as many as
/// the tape has outputs.
pub fn run<A: Agents + ?Sized>(
    tape: &Tape,
    agents: &A,
    time: A::Value,
    registers: &mut [A::Value],
    out: &mut [A::Value],
) {
    for (register, &value) in registers.iter_mut().zip(&tape.constants) {
        *register = A::Value::constant(value);
    }
    for instruction in &tape.instructions {
        match *instruction {
            Instruction::Time { to } => registers[to as usize] = time,
            Instruction::Load { to, slot, row, column } => {
                registers[to as usize] = agents.load(slot as usize, row, column as usize);
            }
            Instruction::Apply { to, op, operands } => {
                let operands = operands.map(|register| registers[register as usize]);
                registers[to as usize] = A::Value::apply(op, operands);
            }
        }
    }
    for (out, &register) in out.iter_mut().zip(&tape.outputs) {
        *out = registers[register as usize];
    }
}
