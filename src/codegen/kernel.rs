//! Kernels: what the runtime calls. One safe interface over the interpreter and machine code.

use crate::math::Interval;

/// The rows of one agent, as a kernel reads them.
#[derive(Clone, Copy, Debug)]
pub struct AgentView<'a> {
    /// States.
    pub states: &'a [f64],
    /// Their rates; empty where no kernel called with this view reads them.
    pub rates: &'a [f64],
    /// Their second rates; empty likewise.
    pub accelerations: &'a [f64],
    /// Auxiliary columns.
    pub aux: &'a [f64],
}

/// The same over a stretch of time.
#[derive(Clone, Copy, Debug)]
pub struct AgentBox<'a> {
    /// States.
    pub states: &'a [Interval],
    /// Their rates; empty where not read.
    pub rates: &'a [Interval],
    /// Their second rates; empty where not read.
    pub accelerations: &'a [Interval],
    /// Auxiliary columns (they change at events only).
    pub aux: &'a [f64],
}
