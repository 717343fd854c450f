//! The block interpreter: a tape over 32 agents at once, instruction by instruction, lane by lane the bits of the others.
//!
//! In: a tape, the columns of the agents as [`Block`]s. Out: a [`Block`] for each output, and whole steps of
//! [`TSIT5`] in the order of operations of `math::runge_kutta`. What a scalar instruction costs by being looked at is
//! shared by 32 lanes, and `math::lanes` has the CPU's widest instructions.
//! Loads and constants are operands of their own; sine and cosine of one angle are one instruction. Nothing is allocated once
//! the scratch space has the size of the longest tape. Lanes do not know each other: those without an agent may hold anything.

use std::ops::{Deref, DerefMut};

use rustc_hash::FxHashMap;

use crate::codegen::tape::{Instruction, Row, Tape};
use crate::math::Op;
use crate::math::lanes::{self, Term};
use crate::math::runge_kutta::TSIT5;

/// How many agents a block has.
pub const N_LANES: usize = 32;

/// A number for each agent of a block, on lines of the cache of its own.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(64))]
pub struct Block(pub [f64; N_LANES]);

impl Block {
    /// One number in all lanes.
    pub const fn splat(value: f64) -> Self {
        Self([value; N_LANES])
    }
}

impl Default for Block {
    fn default() -> Self {
        Self::splat(0.0)
    }
}

impl Deref for Block {
    type Target = [f64; N_LANES];
    #[inline]
    fn deref(&self) -> &Self::Target {
        &self.0
    }
}

impl DerefMut for Block {
    #[inline]
    fn deref_mut(&mut self) -> &mut Self::Target {
        &mut self.0
    }
}

/// The columns of a slot's agents: one [`Block`] for each column of a row.
#[derive(Clone, Copy, Debug, Default)]
pub struct BlockView<'a> {
    /// States.
    pub states: &'a [Block],
    /// Their rates; empty where not read.
    pub rates: &'a [Block],
    /// Their second rates; empty where not read.
    pub accelerations: &'a [Block],
    /// Auxiliary columns.
    pub aux: &'a [Block],
}

/// Registers and stages, reused from call to call and from tape to tape.
#[derive(Clone, Debug, Default)]
pub struct BlockScratch {
    /// Boxed, so that a result is written beside its operands and then exchanged for its register.
    #[allow(clippy::vec_box, reason = "exchanged, not copied")]
    registers: Vec<Box<Block>>,
    spare: [Box<Block>; 2],
    stage: Vec<Block>,
    stage_time: Block,
}

/// What a step writes.
#[derive(Debug)]
pub struct BlockStep<'a> {
    /// 7 n rates, stage by stage: the first n, at the start, are given.
    pub k: &'a mut [Block],
    /// The n new states.
    pub x_new: &'a mut [Block],
    /// The n errors.
    pub err: &'a mut [Block],
}

/// Where an operand stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Source {
    /// In a register.
    Register(u32),
    /// Among the constants.
    Constant(u32),
    /// The time.
    Time,
    /// In an agent's row.
    Column { slot: u32, row: Row, column: u32 },
}

/// One step of a block tape.
#[derive(Clone, Copy, Debug)]
enum Step {
    Unary { op: Op, a: Source, to: u32 },
    Binary { op: Op, a: Source, b: Source, to: u32 },
    Select { a: Source, b: Source, c: Source, to: u32 },
    SinCos { a: Source, sin: u32, cos: u32 },
}

/// A tape, ready to be run on blocks.
#[derive(Clone, Debug)]
pub(super) struct BlockTape {
    constants: Vec<Block>,
    steps: Vec<Step>,
    outputs: Vec<Source>,
    n_registers: usize,
}

/// What a tape's operands come from in one evaluation.
struct Leaves<'a> {
    slots: &'a [BlockView<'a>],
    /// In place of the states of slot 0.
    states: Option<&'a [Block]>,
    time: &'a Block,
}

impl BlockTape {
    /// The same function over blocks.
    pub(super) fn new(tape: &Tape) -> Self {
        let mut writer = Writer {
            block: Self {
                constants: tape.constants.iter().map(|&value| Block::splat(value)).collect(),
                steps: Vec::with_capacity(tape.instructions.len()),
                outputs: Vec::new(),
                n_registers: tape.n_registers,
            },
            sources: (0..tape.n_registers as u32).map(Source::Register).collect(),
            versions: vec![0; tape.n_registers],
            halves: FxHashMap::default(),
        };
        for (source, number) in writer.sources.iter_mut().zip(0..tape.constants.len()) {
            *source = Source::Constant(number as u32);
        }
        for &instruction in &tape.instructions {
            writer.write(instruction);
        }
        let Writer { mut block, sources, .. } = writer;
        block.outputs = tape.outputs.iter().map(|&register| sources[register as usize]).collect();
        block
    }

    /// Computes the outputs from what the agents have.
    pub(super) fn eval(
        &self,
        slots: &[BlockView<'_>],
        time: &Block,
        scratch: &mut BlockScratch,
        out: &mut [Block],
    ) {
        let BlockScratch { registers, spare, .. } = scratch;
        self.run(&Leaves { slots, states: None, time }, registers, spare, out);
    }

    /// A step of length `h` from `time`, each lane its own, of the flow whose rates this tape computes.
    pub(super) fn step(
        &self,
        slots: &[BlockView<'_>],
        time: &Block,
        h: &Block,
        scratch: &mut BlockScratch,
        to: BlockStep<'_>,
    ) {
        let n = self.outputs.len();
        let BlockStep { k, x_new, err } = to;
        let BlockScratch { registers, spare, stage, stage_time } = scratch;
        if stage.len() < n {
            stage.resize(n, Block::default());
        }
        let stage = &mut stage[..n];
        for s in 1..TSIT5.c.len() {
            for (i, state) in stage.iter_mut().enumerate() {
                let (terms, n_terms) = terms(&TSIT5.a[s], k, n, i);
                lanes::advance(&slots[0].states[i][..], &h[..], &terms[..n_terms], &mut state[..]);
            }
            let delay = Term { weight: TSIT5.c[s], column: &h[..] };
            lanes::advance(&time[..], &[1.0; N_LANES], &[delay], &mut stage_time[..]);
            let leaves = Leaves { slots, states: Some(stage), time: stage_time };
            self.run(&leaves, registers, spare, &mut k[s * n..(s + 1) * n]);
        }
        x_new[..n].copy_from_slice(stage);
        for (i, err) in err[..n].iter_mut().enumerate() {
            let (terms, n_terms) = terms(&TSIT5.error, k, n, i);
            lanes::combination(&h[..], &terms[..n_terms], &mut err[..]);
        }
    }

    #[allow(clippy::vec_box, reason = "exchanged, not copied")]
    fn run(
        &self,
        leaves: &Leaves<'_>,
        registers: &mut Vec<Box<Block>>,
        spare: &mut [Box<Block>; 2],
        out: &mut [Block],
    ) {
        if registers.len() < self.n_registers {
            registers.resize_with(self.n_registers, Box::default);
        }
        let [first, second] = spare;
        for &step in &self.steps {
            let at = |source| self.fetch(source, leaves, registers);
            match step {
                Step::Unary { op, a, to } => {
                    lanes::unary(op, at(a), &mut first[..]);
                    std::mem::swap(first, &mut registers[to as usize]);
                }
                Step::Binary { op, a, b, to } => {
                    lanes::binary(op, at(a), at(b), &mut first[..]);
                    std::mem::swap(first, &mut registers[to as usize]);
                }
                Step::Select { a, b, c, to } => {
                    lanes::select(at(a), at(b), at(c), &mut first[..]);
                    std::mem::swap(first, &mut registers[to as usize]);
                }
                Step::SinCos { a, sin, cos } => {
                    lanes::sin_cos(at(a), &mut first[..], &mut second[..]);
                    std::mem::swap(first, &mut registers[sin as usize]);
                    std::mem::swap(second, &mut registers[cos as usize]);
                }
            }
        }
        for (out, &source) in out.iter_mut().zip(&self.outputs) {
            out.copy_from_slice(self.fetch(source, leaves, registers));
        }
    }

    #[inline]
    fn fetch<'a>(&'a self, source: Source, leaves: &Leaves<'a>, registers: &'a [Box<Block>]) -> &'a [f64] {
        let block = match source {
            Source::Register(register) => &*registers[register as usize],
            Source::Constant(number) => &self.constants[number as usize],
            Source::Time => leaves.time,
            Source::Column { slot, row, column } => {
                let (agents, column) = (&leaves.slots[slot as usize], column as usize);
                match (row, leaves.states) {
                    (Row::States, Some(states)) if slot == 0 => &states[column],
                    (Row::States, _) => &agents.states[column],
                    (Row::Rates, _) => &agents.rates[column],
                    (Row::Accelerations, _) => &agents.accelerations[column],
                    (Row::Aux, _) => &agents.aux[column],
                }
            }
        };
        &block[..]
    }
}

/// The terms of a stage for component `i`, weights that are 0 left out, and how many they are.
#[inline]
fn terms<'a>(weights: &[f64; 7], k: &'a [Block], n: usize, i: usize) -> ([Term<'a>; 7], usize) {
    let mut terms = [Term { weight: 0.0, column: &[] }; 7];
    let mut n_terms = 0;
    for (stage, &weight) in weights.iter().enumerate().filter(|(_, weight)| **weight != 0.0) {
        terms[n_terms] = Term { weight, column: &k[stage * n + i][..] };
        n_terms += 1;
    }
    (terms, n_terms)
}

/// Which half of a sine and cosine, and where it is computed: a step that can become both.
#[derive(Clone, Copy, Debug)]
struct Half {
    op: Op,
    step: usize,
}

/// A block tape being written.
struct Writer {
    block: BlockTape,
    /// Where the value of each register of the tape stands.
    sources: Vec<Source>,
    /// How often each register has been written: a register holds several values in turn.
    versions: Vec<u32>,
    /// Sines and cosines so far, by their angle; a register's with its version.
    halves: FxHashMap<(Source, u32), Half>,
}

impl Writer {
    fn write(&mut self, instruction: Instruction) {
        match instruction {
            Instruction::Time { to } => self.sources[to as usize] = Source::Time,
            Instruction::Load { to, slot, row, column } => {
                self.sources[to as usize] = Source::Column { slot, row, column };
            }
            Instruction::Apply { to, op, operands } => {
                let [a, b, c] = operands.map(|register| self.sources[register as usize]);
                if matches!(op, Op::Sin | Op::Cos) && self.joins(op, a, to) {
                    return;
                }
                self.block.steps.push(match op.arity() {
                    1 => Step::Unary { op, a, to },
                    2 => Step::Binary { op, a, b, to },
                    _ => Step::Select { a, b, c, to },
                });
                self.sources[to as usize] = Source::Register(to);
                self.versions[to as usize] += 1;
            }
        }
    }

    /// Whether the other half of this sine or cosine is there already: then one step computes both, this one into a register
    /// of its own.
    fn joins(&mut self, op: Op, angle: Source, to: u32) -> bool {
        let version = match angle {
            Source::Register(register) => self.versions[register as usize],
            Source::Constant(_) | Source::Time | Source::Column { .. } => 0,
        };
        let step = self.block.steps.len();
        let half = *self.halves.entry((angle, version)).or_insert(Half { op, step });
        if half.op == op {
            return false;
        }
        let Step::Unary { a, to: other, .. } = self.block.steps[half.step] else { return false };
        let own = self.block.n_registers as u32;
        self.block.n_registers += 1;
        self.versions.push(0);
        let (sin, cos) = if op == Op::Sin { (own, other) } else { (other, own) };
        self.block.steps[half.step] = Step::SinCos { a, sin, cos };
        self.sources[to as usize] = Source::Register(own);
        true
    }
}
