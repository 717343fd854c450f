//! Kernels: what the runtime calls. One safe interface over the interpreter and machine code.
//!
//! A kernel computes the outputs of one function of the system from the rows of the agents in its slots and the time.
//! Every call first compares the lengths of the rows with what the kernel reads ([`Reads`]) and panics if one is too
//! short: that is what makes the call into machine code sound. Nothing traps: an agent that is absent comes as rows
//! full of NaN.

use std::cell::RefCell;
use std::sync::{Arc, OnceLock};

use crate::codegen::block::{Block, BlockScratch, BlockStep, BlockTape, BlockView};
use crate::codegen::interpret;
use crate::codegen::jit::{KernelCode, StepCode, StepRows};
use crate::codegen::later::Later;
use crate::codegen::tape::{Instruction, Row, Tape};
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

impl<'a> AgentView<'a> {
    /// An agent that is not there: every row is this one, full of NaN and as long as any row is.
    #[inline]
    pub fn absent(row: &'a [f64]) -> Self {
        Self { states: row, rates: row, accelerations: row, aux: row }
    }
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

impl<'a> AgentBox<'a> {
    /// An agent that is not there: anything at all, and auxiliary columns that are NaN.
    #[inline]
    pub fn absent(row: &'a [Interval], aux: &'a [f64]) -> Self {
        Self { states: row, rates: row, accelerations: row, aux }
    }
}

/// How long the rows of the agent in a slot must be: the highest column read, plus one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SlotReads {
    /// States.
    pub states: usize,
    /// Their rates.
    pub rates: usize,
    /// Their second rates.
    pub accelerations: usize,
    /// Auxiliary columns.
    pub aux: usize,
}

/// What a kernel reads.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Reads {
    /// For each slot up to the last one that is read.
    pub slots: Vec<SlotReads>,
    /// Whether it reads the time.
    pub time: bool,
    /// The auxiliary columns that are read: slot and column, rising.
    pub columns: Vec<(usize, usize)>,
    /// The states that are read: slot and column, rising.
    pub states: Vec<(usize, usize)>,
    /// The states of which they, their rates or their second rates are read: slot and column, rising.
    pub moving: Vec<(usize, usize)>,
}

impl Reads {
    /// What a tape reads.
    fn of(tape: &Tape) -> Self {
        let mut reads = Self::default();
        for instruction in &tape.instructions {
            match *instruction {
                Instruction::Time { .. } => reads.time = true,
                Instruction::Load { slot, row, column, .. } => {
                    reads.include(slot as usize, row, column as usize + 1);
                    let place = (slot as usize, column as usize);
                    match row {
                        Row::Aux => reads.columns.push(place),
                        Row::States => {
                            reads.states.push(place);
                            reads.moving.push(place);
                        }
                        Row::Rates | Row::Accelerations => reads.moving.push(place),
                    }
                }
                Instruction::Apply { .. } => {}
            }
        }
        for columns in [&mut reads.columns, &mut reads.states, &mut reads.moving] {
            columns.sort_unstable();
            columns.dedup();
        }
        reads
    }

    fn include(&mut self, slot: usize, row: Row, length: usize) {
        if self.slots.len() <= slot {
            self.slots.resize(slot + 1, SlotReads::default());
        }
        let slot = &mut self.slots[slot];
        let width = match row {
            Row::States => &mut slot.states,
            Row::Rates => &mut slot.rates,
            Row::Accelerations => &mut slot.accelerations,
            Row::Aux => &mut slot.aux,
        };
        *width = length.max(*width);
    }

    /// Whether these agents have all columns that are read.
    #[inline]
    pub(super) fn fit(&self, slots: &[AgentView<'_>]) -> bool {
        slots.len() >= self.slots.len()
            && self.slots.iter().zip(slots).all(|(reads, agent)| {
                (agent.states.len() >= reads.states)
                    & (agent.rates.len() >= reads.rates)
                    & (agent.accelerations.len() >= reads.accelerations)
                    & (agent.aux.len() >= reads.aux)
            })
    }
}

/// By what a kernel is evaluated.
#[derive(Debug)]
pub(super) enum Means {
    /// The interpreter.
    Tape,
    /// Machine code.
    Code(KernelCode),
    /// The interpreter, until there is machine code; the number of the function.
    Later(Arc<Later>, usize),
}

/// A function of a system that can be called.
#[derive(Debug)]
pub struct Kernel {
    tape: Arc<Tape>,
    reads: Reads,
    operations: u64,
    means: Means,
    /// Made when a block is evaluated for the first time.
    block: OnceLock<BlockTape>,
}

impl Kernel {
    /// A kernel of a tape.
    pub(super) fn new(tape: Arc<Tape>, means: Means) -> Self {
        let is_applied = |instruction: &&Instruction| matches!(instruction, Instruction::Apply { .. });
        let operations = tape.instructions.iter().filter(is_applied).count() as u64;
        Self { reads: Reads::of(&tape), operations, tape, means, block: OnceLock::new() }
    }

    /// Computes the outputs, the same bits on every back end. `out` must hold at least as many as there are.
    #[inline]
    pub fn eval(&self, slots: &[AgentView<'_>], time: f64, out: &mut [f64]) {
        assert!(self.reads.fit(slots), "a row is shorter than the kernel's reads");
        assert!(out.len() >= self.tape.outputs.len(), "no room for the kernel's outputs");
        match self.code() {
            // SAFETY: the rows are as long as the code reads and `out` is as long as it writes, both just asserted.
            Some(code) => unsafe { code.call(self.reads.slots.len(), slots, time, out) },
            None => interpret_numbers(&self.tape, slots, time, out),
        }
    }

    /// Its machine code, if there is some by now.
    #[inline]
    fn code(&self) -> Option<&KernelCode> {
        match &self.means {
            Means::Tape => None,
            Means::Code(code) => Some(code),
            Means::Later(later, number) => {
                later.code(self.tape.instructions.len())?.kernels[*number].as_ref()
            }
        }
    }

    /// Computes the outputs of 32 agents, lane by lane the bits of [`eval`](Self::eval).
    ///
    /// `out` must hold at least as many blocks as there are outputs. Panics if a column that is read is missing.
    pub fn eval_block(
        &self,
        slots: &[BlockView<'_>],
        time: &Block,
        scratch: &mut BlockScratch,
        out: &mut [Block],
    ) {
        assert!(out.len() >= self.tape.outputs.len(), "no room for the kernel's outputs");
        self.block().eval(slots, time, scratch, out);
    }

    /// A step of 32 agents whose rates this kernel computes, lane by lane the bits of [`StepKernel::step`]: each lane from
    /// its own time, s, of its own length `h`, s.
    ///
    /// Slot 0 holds the n states; of the other slots only auxiliary columns are read.
    pub fn step_block(
        &self,
        slots: &[BlockView<'_>],
        time: &Block,
        h: &Block,
        scratch: &mut BlockScratch,
        to: BlockStep<'_>,
    ) {
        let n = self.tape.outputs.len();
        let room = to.k.len() >= 7 * n && to.x_new.len() >= n && to.err.len() >= n;
        assert!(room, "no room for the step");
        self.block().step(slots, time, h, scratch, to);
    }

    fn block(&self) -> &BlockTape {
        self.block.get_or_init(|| BlockTape::new(&self.tape))
    }

    /// Bounds the outputs: each contains what `eval` gives for every member of the boxes at every time in `time`.
    ///
    /// `registers` is scratch space, reused from call to call.
    pub fn range(
        &self,
        slots: &[AgentBox<'_>],
        time: Interval,
        registers: &mut Vec<Interval>,
        out: &mut [Interval],
    ) {
        assert!(out.len() >= self.tape.outputs.len(), "no room for the kernel's outputs");
        if registers.len() < self.tape.n_registers {
            registers.resize(self.tape.n_registers, time);
        }
        interpret::run(&self.tape, slots, time, registers, out);
    }

    /// How many outputs there are.
    pub fn n_outputs(&self) -> usize {
        self.tape.outputs.len()
    }

    /// How many arithmetic operations an evaluation takes: those of its tape, a function such as `sin` as one.
    pub fn operations(&self) -> u64 {
        self.operations
    }

    /// What it reads.
    pub fn reads(&self) -> &Reads {
        &self.reads
    }

    /// Whether it runs as machine code.
    pub fn is_compiled(&self) -> bool {
        match &self.means {
            Means::Tape => false,
            Means::Code(_) => true,
            Means::Later(later, number) => later.made().is_some_and(|code| code.kernels[*number].is_some()),
        }
    }
}

/// Registers that fit on the stack; more are kept per thread.
const N_STACK_REGISTERS: usize = 32;

thread_local! {
    static REGISTERS: RefCell<Vec<f64>> = const { RefCell::new(Vec::new()) };
}

/// Runs a tape on numbers without allocating (but for the first long tape of a thread).
fn interpret_numbers(tape: &Tape, slots: &[AgentView<'_>], time: f64, out: &mut [f64]) {
    if tape.n_registers <= N_STACK_REGISTERS {
        interpret::run(tape, slots, time, &mut [0.0; N_STACK_REGISTERS], out);
        return;
    }
    REGISTERS.with_borrow_mut(|registers| {
        if registers.len() < tape.n_registers {
            registers.resize(tape.n_registers, 0.0);
        }
        interpret::run(tape, slots, time, registers, out);
    });
}

/// A whole step of the explicit Runge-Kutta pair [`TSIT5`](crate::math::runge_kutta::TSIT5) in one function.
#[derive(Debug)]
pub struct StepKernel {
    n: usize,
    reads: Reads,
    means: StepMeans,
}

/// By what a step is taken.
#[derive(Debug)]
pub(super) enum StepMeans {
    /// Machine code.
    Code(StepCode),
    /// Machine code, when there is some; the number of the step.
    Later(Arc<Later>, usize),
}

impl StepKernel {
    /// A step of the flow whose rates `tape` computes.
    pub(super) fn new(tape: &Tape, means: StepMeans) -> Self {
        let n = tape.outputs.len();
        let mut reads = Reads::of(tape);
        if n > 0 {
            reads.include(0, Row::States, n);
        }
        Self { n, reads, means }
    }

    /// A step from `time`, s, of length `h`, s, in the order of operations that
    /// [`runge_kutta`](crate::math::runge_kutta) lays down.
    ///
    /// Slot 0 holds the n states at `time`; of the other slots only auxiliary columns are read. `k` holds 7 n rates,
    /// stage by stage: the first n, at the start, are given, the others are written. `x_new` and `err` receive n each.
    /// False, and nothing is done, if there is no code for it yet.
    #[inline]
    pub fn step(
        &self,
        slots: &[AgentView<'_>],
        time: f64,
        h: f64,
        k: &mut [f64],
        x_new: &mut [f64],
        err: &mut [f64],
    ) -> bool {
        let code = match &self.means {
            StepMeans::Code(code) => code,
            StepMeans::Later(later, number) => match later.made().and_then(|code| code.steps.get(*number)) {
                Some((_, code)) => code,
                None => return false,
            },
        };
        assert!(self.reads.fit(slots), "a row is shorter than the kernel's reads");
        let room = k.len() >= 7 * self.n && x_new.len() >= self.n && err.len() >= self.n;
        assert!(room, "no room for the step");
        // SAFETY: all lengths that the code relies on were just asserted.
        unsafe { code.call(self.reads.slots.len(), slots, time, h, StepRows { k, x_new, err }) };
        true
    }

    /// How many states there are.
    pub fn n_states(&self) -> usize {
        self.n
    }

    /// What it reads.
    pub fn reads(&self) -> &Reads {
        &self.reads
    }
}
