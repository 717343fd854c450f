//! Tapes: a function as a flat list of instructions over few registers, the one form that both back ends run.
//!
//! In: a list of nodes of the graph. Out: a [`Tape`]. Registers `0..constants.len()` hold the constants and are never
//! written again; the others are reused as soon as their value is read for the last time. An instruction reads its
//! operands before it writes its result, so both may share a register.

use std::fmt;

use rustc_hash::{FxHashMap, FxHashSet};

use crate::calculus::graph::{Graph, Node, NodeId};
use crate::math::Op;

/// A place for a value.
pub type Register = u32;

/// A row of an agent.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Row {
    /// Its states.
    States,
    /// Their rates.
    Rates,
    /// Their second rates.
    Accelerations,
    /// Its auxiliary columns.
    Aux,
}

/// One step of a tape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Instruction {
    /// The time.
    Time {
        /// Where it goes.
        to: Register,
    },
    /// A column of an agent.
    Load {
        /// Where it goes.
        to: Register,
        /// Whose.
        slot: u32,
        /// Of which row.
        row: Row,
        /// Which.
        column: u32,
    },
    /// An operator.
    Apply {
        /// Where the result goes.
        to: Register,
        /// What to do.
        op: Op,
        /// With what; those beyond the operator's arity repeat the first.
        operands: [Register; 3],
    },
}

/// A function, ready to be run or compiled.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tape {
    /// What the first registers hold.
    pub constants: Vec<f64>,
    /// What to do, in order.
    pub instructions: Vec<Instruction>,
    /// Where the results are at the end, in order.
    pub outputs: Vec<Register>,
    /// How many registers there are, constants included.
    pub n_registers: usize,
}

impl Tape {
    /// The value of a register that holds a constant.
    pub fn constant(&self, register: Register) -> Option<f64> {
        self.constants.get(register as usize).copied()
    }
}

/// Writes the tape that computes `outputs`.
pub fn record(graph: &Graph, outputs: &[NodeId]) -> Tape {
    let order = needed(graph, outputs);
    let mut recorder = Recorder::new(graph, &order, outputs);
    for (position, &node) in order.iter().enumerate() {
        recorder.write(graph, position, node);
    }
    let Recorder { mut tape, place, .. } = recorder;
    tape.outputs = outputs.iter().map(|node| place[node]).collect();
    tape
}

/// The nodes that `outputs` rest on, operands before users.
fn needed(graph: &Graph, outputs: &[NodeId]) -> Vec<NodeId> {
    let mut known: FxHashSet<NodeId> = FxHashSet::default();
    let mut pending: Vec<NodeId> = outputs.to_vec();
    while let Some(node) = pending.pop() {
        if known.insert(node) {
            pending.extend(operands(graph.node(node)));
        }
    }
    let mut order: Vec<NodeId> = known.into_iter().collect();
    order.sort_unstable();
    order
}

/// The operands of a node, first to last.
fn operands(node: Node) -> impl Iterator<Item = NodeId> {
    let list = match node {
        Node::Constant(_)
        | Node::Time
        | Node::State { .. }
        | Node::Rate { .. }
        | Node::Acceleration { .. }
        | Node::Aux { .. } => [None; 3],
        Node::Unary(_, a) => [Some(a), None, None],
        Node::Binary(_, a, b) => [Some(a), Some(b), None],
        Node::Select(a, b, c) => [Some(a), Some(b), Some(c)],
    };
    list.into_iter().flatten()
}

/// A tape being written.
struct Recorder {
    tape: Tape,
    /// The register of each node met so far.
    place: FxHashMap<NodeId, Register>,
    /// The position of each node's last reader; outputs are read at the very end.
    last_reader: FxHashMap<NodeId, usize>,
    /// Registers to be used again.
    free: Vec<Register>,
}

impl Recorder {
    fn new(graph: &Graph, order: &[NodeId], outputs: &[NodeId]) -> Self {
        let mut last_reader = FxHashMap::default();
        for (position, &node) in order.iter().enumerate() {
            for operand in operands(graph.node(node)) {
                last_reader.insert(operand, position);
            }
        }
        for &output in outputs {
            last_reader.insert(output, usize::MAX);
        }
        let mut recorder =
            Self { tape: Tape::default(), place: FxHashMap::default(), last_reader, free: Vec::new() };
        for &node in order {
            if let Node::Constant(bits) = graph.node(node) {
                recorder.place.insert(node, recorder.tape.constants.len() as Register);
                recorder.tape.constants.push(f64::from_bits(bits));
            }
        }
        recorder.tape.n_registers = recorder.tape.constants.len();
        recorder
    }

    /// Writes the instruction of one node.
    fn write(&mut self, graph: &Graph, position: usize, node: NodeId) {
        let load = |to, slot, row, column| Instruction::Load { to, slot, row, column };
        let instruction = match graph.node(node) {
            Node::Constant(_) => return,
            Node::Time => Instruction::Time { to: self.allocate() },
            Node::State { slot, column } => load(self.allocate(), slot, Row::States, column),
            Node::Rate { slot, column } => load(self.allocate(), slot, Row::Rates, column),
            Node::Acceleration { slot, column } => load(self.allocate(), slot, Row::Accelerations, column),
            Node::Aux { slot, column } => load(self.allocate(), slot, Row::Aux, column),
            Node::Unary(op, a) => self.apply(position, op, [a, a, a]),
            Node::Binary(op, a, b) => self.apply(position, op, [a, b, a]),
            Node::Select(a, b, c) => self.apply(position, Op::Select, [a, b, c]),
        };
        let (Instruction::Time { to } | Instruction::Load { to, .. } | Instruction::Apply { to, .. }) =
            instruction;
        self.place.insert(node, to);
        self.tape.instructions.push(instruction);
    }

    fn apply(&mut self, position: usize, op: Op, nodes: [NodeId; 3]) -> Instruction {
        let operands = nodes.map(|node| self.place[&node]);
        for (k, node) in nodes.iter().enumerate() {
            let constant = (operands[k] as usize) < self.tape.constants.len();
            let repeated = nodes[..k].contains(node);
            if self.last_reader[node] == position && !constant && !repeated {
                self.free.push(operands[k]);
            }
        }
        Instruction::Apply { to: self.allocate(), op, operands }
    }

    fn allocate(&mut self) -> Register {
        self.free.pop().unwrap_or_else(|| {
            let register = Register::try_from(self.tape.n_registers)
                .expect("fewer registers than nodes, fewer than 2^32");
            self.tape.n_registers += 1;
            register
        })
    }
}

impl fmt::Display for Row {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Row::States => "state",
            Row::Rates => "rate",
            Row::Accelerations => "acceleration",
            Row::Aux => "aux",
        })
    }
}

impl fmt::Display for Instruction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Instruction::Time { to } => write!(f, "r{to} = time"),
            Instruction::Load { to, slot, row, column } => write!(f, "r{to} = slot{slot}.{row}[{column}]"),
            Instruction::Apply { to, op, operands } => {
                write!(f, "r{to} = {}", op.name())?;
                operands[..op.arity()].iter().try_for_each(|operand| write!(f, " r{operand}"))
            }
        }
    }
}

/// A line for each constant and instruction, then the outputs.
impl fmt::Display for Tape {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (register, value) in self.constants.iter().enumerate() {
            writeln!(f, "  r{register} = {value:?}")?;
        }
        for instruction in &self.instructions {
            writeln!(f, "  {instruction}")?;
        }
        f.write_str("  return")?;
        self.outputs.iter().try_for_each(|output| write!(f, " r{output}"))?;
        writeln!(f)
    }
}
