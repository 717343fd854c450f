//! Machine code in memory.

use crate::codegen::kernel::AgentView;

/// Machine code of a kernel.
#[derive(Debug)]
pub struct KernelCode {}

impl KernelCode {
    pub(super) unsafe fn call(
        &self,
        _n_slots: usize,
        _slots: &[AgentView<'_>],
        _time: f64,
        _out: &mut [f64],
    ) {
    }
}

/// Machine code of a step.
#[derive(Debug)]
pub struct StepCode {}

impl StepCode {
    #[allow(clippy::too_many_arguments)]
    pub(super) unsafe fn call(
        &self,
        _n_slots: usize,
        _slots: &[AgentView<'_>],
        _time: f64,
        _h: f64,
        _k: &mut [f64],
        _x_new: &mut [f64],
        _err: &mut [f64],
    ) {
    }
}
