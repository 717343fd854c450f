//! From the graph to recurrences: one for each node that moves, or the few that it comes to.
//!
//! In: the rates of a flow. Out: a [`SeriesTape`], or why there is none. What jumps or has a kink is no series; flows hold
//! their branches locked ([`crate::calculus::kinks`]), so that what moves is smooth. One comparison of what moves is left in
//! them: whether `atan2` is continued beyond its cut, by which an angle differs by what does not move.

use rustc_hash::FxHashMap;

use crate::calculus::graph::{Graph, Node, NodeId};
use crate::codegen::series::{
    Fixed, FixedId, Instruction, Pair, Recurrence, RowId, SeriesTape, Source, Start, schedule,
};
use crate::math::Op;

/// The most instructions of a series.
const LENGTH_MAX: usize = 20_000;

/// Why a flow has no series.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoSeries {
    /// It reads the states of other agents.
    ReadsOthers,
    /// This operator jumps or has a kink, and nothing holds its branch.
    Jumps(Op),
    /// It would have more instructions than `LENGTH_MAX`.
    TooLong,
}

/// The series of the flow whose states move at these rates.
pub fn record(graph: &Graph, rates: &[NodeId]) -> Result<SeriesTape, NoSeries> {
    let mut recorder = Recorder::new(graph, rates.len());
    for id in graph.reach(rates) {
        let made = if graph.moves(id) { recorder.moving(id)? } else { Made::Fixed(recorder.still(id)) };
        recorder.made.insert(id, made);
        if recorder.instructions.len() > LENGTH_MAX {
            return Err(NoSeries::TooLong);
        }
    }
    let rows = rates.iter().map(|&id| recorder.row(id)).collect::<Result<Vec<_>, _>>()?;
    Ok(recorder.finish(rows))
}

/// What a node has become.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Made {
    /// It does not move.
    Fixed(FixedId),
    /// A series.
    Row(RowId),
    /// A truth at the begin of the step, made by an operator.
    Truth(RowId, Op),
}

/// Stands for the row of the rate of a state, which is known at the end: `RATE + state`.
const RATE: RowId = 1 << 31;

/// A series being written.
pub(super) struct Recorder<'g> {
    graph: &'g Graph,
    n_states: usize,
    made: FxHashMap<NodeId, Made>,
    fixed: Vec<Fixed>,
    known_fixed: FxHashMap<(u64, u64, [FixedId; 3]), FixedId>,
    instructions: Vec<Instruction>,
    n_rows: RowId,
    derivatives: FxHashMap<RowId, RowId>,
    lifted: FxHashMap<FixedId, RowId>,
    /// The row of the sine; that of the cosine is beside it.
    pub(super) pairs: FxHashMap<(RowId, Pair), (RowId, RowId)>,
}

impl<'g> Recorder<'g> {
    fn new(graph: &'g Graph, n_states: usize) -> Self {
        let mut recorder = Self {
            graph,
            n_states,
            made: FxHashMap::default(),
            fixed: Vec::new(),
            known_fixed: FxHashMap::default(),
            instructions: Vec::new(),
            n_rows: 0,
            derivatives: FxHashMap::default(),
            lifted: FxHashMap::default(),
            pairs: FxHashMap::default(),
        };
        for state in 0..n_states as RowId {
            let row = recorder.push(Recurrence::State { column: state, rate: RATE + state });
            recorder.derivatives.insert(row, RATE + state);
        }
        recorder
    }

    fn finish(self, rates: Vec<RowId>) -> SeriesTape {
        let Self { fixed, mut instructions, n_rows, n_states, .. } = self;
        for instruction in &mut instructions {
            for row in instruction.recurrence.operands_mut() {
                if *row >= RATE {
                    *row = rates[(*row - RATE) as usize];
                }
            }
        }
        let lengths = schedule::lengths(&instructions, n_rows as usize);
        let cycle = schedule::order(&mut instructions, n_rows as usize);
        let mut tape =
            SeriesTape { fixed, instructions, cycle, n_states, rates, lengths, operations: Vec::new() };
        tape.operations = schedule::operations(&tape);
        tape
    }

    /// A new row.
    pub(super) fn new_row(&mut self) -> RowId {
        self.n_rows += 1;
        self.n_rows - 1
    }

    pub(super) fn push_to(&mut self, to: RowId, lag: u32, recurrence: Recurrence) -> RowId {
        self.instructions.push(Instruction { to, lag, recurrence });
        to
    }

    pub(super) fn push(&mut self, recurrence: Recurrence) -> RowId {
        let to = self.new_row();
        self.push_to(to, 0, recurrence)
    }

    /// One of derivatives: its coefficients are made a round later.
    pub(super) fn push_late(&mut self, recurrence: Recurrence) -> RowId {
        let to = self.new_row();
        self.push_to(to, 1, recurrence)
    }

    pub(super) fn constant(&mut self, value: f64) -> FixedId {
        self.number(Fixed::Constant(value))
    }

    pub(super) fn apply_fixed(&mut self, op: Op, operands: [FixedId; 3]) -> FixedId {
        self.number(Fixed::Apply(op, operands))
    }

    /// A fixed number, the same for the same.
    fn number(&mut self, fixed: Fixed) -> FixedId {
        let key = match fixed {
            Fixed::Constant(value) => (0, value.to_bits(), [0; 3]),
            Fixed::Load { slot, column } => (1, 0, [slot, column, 0]),
            Fixed::Apply(op, operands) => (2, op as u64, operands),
        };
        *self.known_fixed.entry(key).or_insert_with(|| {
            self.fixed.push(fixed);
            self.fixed.len() as FixedId - 1
        })
    }

    /// A node that does not move.
    fn still(&mut self, id: NodeId) -> FixedId {
        let of = |recorder: &Self, id: NodeId| match recorder.made[&id] {
            Made::Fixed(fixed) => fixed,
            Made::Row(_) | Made::Truth(..) => unreachable!("what is made of what moves moves"),
        };
        match self.graph.node(id) {
            Node::Constant(bits) => self.constant(f64::from_bits(bits)),
            Node::Aux { slot, column } => self.number(Fixed::Load { slot, column }),
            Node::Unary(op, a) => self.apply_fixed(op, [of(self, a); 3]),
            Node::Binary(op, a, b) => self.apply_fixed(op, [of(self, a), of(self, b), of(self, a)]),
            Node::Select(a, b, c) => self.apply_fixed(Op::Select, [a, b, c].map(|id| of(self, id))),
            Node::Time | Node::State { .. } | Node::Rate { .. } | Node::Acceleration { .. } => {
                unreachable!("these move")
            }
        }
    }

    /// A node that moves.
    fn moving(&mut self, id: NodeId) -> Result<Made, NoSeries> {
        Ok(match self.graph.node(id) {
            Node::Time => Made::Row(self.push(Recurrence::Time)),
            Node::State { slot: 0, column } => Made::Row(column),
            Node::State { .. } => return Err(NoSeries::ReadsOthers),
            Node::Rate { .. } | Node::Acceleration { .. } => unreachable!("a flow reads no rates"),
            Node::Constant(_) | Node::Aux { .. } => unreachable!("these do not move"),
            Node::Unary(op, a) if op.is_boolean() => self.truth(op, [a, a, a])?,
            Node::Binary(op, a, b) if op.is_boolean() => self.truth(op, [a, b, a])?,
            Node::Unary(op, a) => Made::Row(self.unary(op, a)?),
            Node::Binary(op, a, b) => Made::Row(self.binary(op, a, b)?),
            Node::Select(condition, a, b) => Made::Row(self.select(condition, a, b)?),
        })
    }

    fn truth(&mut self, op: Op, operands: [NodeId; 3]) -> Result<Made, NoSeries> {
        let operands = operands.map(|id| match self.made[&id] {
            Made::Fixed(fixed) => Source::Fixed(fixed),
            Made::Row(row) | Made::Truth(row, _) => Source::Row(row),
        });
        let row = self.push(Recurrence::Truth(Start { op, operands }));
        Ok(Made::Truth(row, op))
    }

    /// What a node is, as a smooth operand.
    fn source(&self, id: NodeId) -> Result<Source, NoSeries> {
        match self.made[&id] {
            Made::Fixed(fixed) => Ok(Source::Fixed(fixed)),
            Made::Row(row) => Ok(Source::Row(row)),
            Made::Truth(_, op) => Err(NoSeries::Jumps(op)),
        }
    }

    /// The row of a node, which may stand still.
    fn row(&mut self, id: NodeId) -> Result<RowId, NoSeries> {
        Ok(match self.source(id)? {
            Source::Row(row) => row,
            Source::Fixed(fixed) => self.lift(fixed),
        })
    }

    pub(super) fn lift(&mut self, fixed: FixedId) -> RowId {
        if let Some(&row) = self.lifted.get(&fixed) {
            return row;
        }
        let row = self.push(Recurrence::Lift(fixed));
        self.lifted.insert(fixed, row);
        row
    }

    pub(super) fn derivative(&mut self, a: RowId) -> RowId {
        if let Some(&row) = self.derivatives.get(&a) {
            return row;
        }
        let row = self.push_late(Recurrence::Derive(a));
        self.derivatives.insert(a, row);
        row
    }

    fn select(&mut self, condition: NodeId, a: NodeId, b: NodeId) -> Result<RowId, NoSeries> {
        match self.made[&condition] {
            Made::Fixed(fixed) => {
                let (a, b) = (self.row(a)?, self.row(b)?);
                Ok(self.push(Recurrence::Choose(fixed, a, b)))
            }
            Made::Row(_) => Err(NoSeries::Jumps(Op::Select)),
            Made::Truth(truth, op) => {
                let differs = |of: NodeId, from: NodeId| match self.graph.node(of) {
                    Node::Binary(Op::Add, u, v) => {
                        (u == from && !self.graph.moves(v)) || (v == from && !self.graph.moves(u))
                    }
                    _ => false,
                };
                if !(differs(a, b) || differs(b, a)) {
                    return Err(NoSeries::Jumps(op));
                }
                let (turned, plain) = (self.row(a)?, self.row(b)?);
                Ok(self.push(Recurrence::Turn { truth, turned, plain }))
            }
        }
    }

    fn binary(&mut self, op: Op, a: NodeId, b: NodeId) -> Result<RowId, NoSeries> {
        let sources = (self.source(a)?, self.source(b)?);
        Ok(match (op, sources) {
            (Op::Add, (Source::Row(a), Source::Row(b))) => self.push(Recurrence::Add(a, b)),
            (Op::Add, (Source::Row(a), Source::Fixed(c)) | (Source::Fixed(c), Source::Row(a))) => {
                self.push(Recurrence::Shift(a, c))
            }
            (Op::Sub, (Source::Row(a), Source::Row(b))) => self.push(Recurrence::Sub(a, b)),
            (Op::Sub, (Source::Row(a), Source::Fixed(c))) => {
                let minus = self.apply_fixed(Op::Neg, [c; 3]);
                self.push(Recurrence::Shift(a, minus))
            }
            (Op::Sub, (Source::Fixed(c), Source::Row(a))) => self.push(Recurrence::From(c, a)),
            (Op::Mul, (Source::Row(a), Source::Row(b))) if a == b => self.push(Recurrence::Square(a)),
            (Op::Mul, (Source::Row(a), Source::Row(b))) => self.push(Recurrence::Mul(a, b)),
            (Op::Mul, (Source::Row(a), Source::Fixed(c)) | (Source::Fixed(c), Source::Row(a))) => {
                self.push(Recurrence::Scale(a, c))
            }
            (Op::Div, (Source::Row(a), Source::Fixed(c))) => self.over(a, c, 0),
            (Op::Div, (a, Source::Row(b))) => {
                let a = self.as_row(a);
                self.quotient(a, b, 0)
            }
            (Op::Powi, (Source::Row(a), Source::Fixed(n))) => match self.fixed[n as usize] {
                Fixed::Constant(exponent) if f64::from(exponent as i32) == exponent => {
                    self.integer_power(a, exponent as i32)
                }
                _ => self.real_power(Op::Powi, a, n),
            },
            (Op::Pow, (Source::Row(a), Source::Fixed(r))) => self.real_power(Op::Pow, a, r),
            (Op::Pow | Op::Powi, (a, Source::Row(b))) => self.general_power(op, a, b),
            (Op::Hypot, (a, b)) => {
                let squares = self.sum_of_squares(a, b);
                self.root(squares, Start { op, operands: [a, b, a] })
            }
            (Op::Atan2, (y, x)) => self.angle(y, x),
            (Op::Min | Op::Max | Op::Mod, _) => return Err(NoSeries::Jumps(op)),
            (Op::Add | Op::Sub | Op::Mul | Op::Div | Op::Powi | Op::Pow, _) => {
                unreachable!("one of the operands moves")
            }
            (Op::Lt | Op::Le | Op::Eq | Op::Ne | Op::And | Op::Or | Op::Not | Op::Select, _) => {
                unreachable!("{} is done elsewhere", op.name())
            }
            (Op::Neg | Op::Sin | Op::Cos | Op::Tan | Op::Asin | Op::Acos | Op::Atan | Op::Sinh, _)
            | (Op::Cosh | Op::Tanh | Op::Asinh | Op::Acosh | Op::Atanh | Op::Exp | Op::Log, _)
            | (Op::Log2 | Op::Log10 | Op::Sqrt | Op::Cbrt | Op::Abs | Op::Sign | Op::Floor, _)
            | (Op::Ceil | Op::Round | Op::Trunc, _) => {
                unreachable!("{} has one operand", op.name())
            }
        })
    }

    fn unary(&mut self, op: Op, a: NodeId) -> Result<RowId, NoSeries> {
        let u = self.row(a)?;
        let start = Start { op, operands: [Source::Row(u); 3] };
        Ok(match op {
            Op::Neg => self.push(Recurrence::Neg(u)),
            Op::Sqrt => self.root(u, start),
            Op::Cbrt => {
                let third = self.constant(1.0 / 3.0);
                self.power_with(start, u, third)
            }
            Op::Exp => {
                let rate = self.derivative(u);
                self.push(Recurrence::Exp { a: rate, start })
            }
            Op::Log => {
                let rate = self.rate_over(u, u);
                self.push(Recurrence::Integrate { a: rate, start })
            }
            Op::Log2 | Op::Log10 => {
                let base = if op == Op::Log2 { std::f64::consts::LN_2 } else { std::f64::consts::LN_10 };
                let (rate, base) = (self.rate_over(u, u), self.constant(base));
                let rate = self.over(rate, base, 1);
                self.push(Recurrence::Integrate { a: rate, start })
            }
            Op::Sin => self.pair(Pair::Circular, u).0,
            Op::Cos => self.pair(Pair::Circular, u).1,
            Op::Sinh => self.pair(Pair::Hyperbolic, u).0,
            Op::Cosh => self.pair(Pair::Hyperbolic, u).1,
            Op::Tan | Op::Tanh => self.tangent(op, u, start),
            Op::Asin | Op::Acos => {
                let inside = self.one_less_square(u);
                let below = self.square_root(inside);
                let rate = self.rate_over(u, below);
                let rate = if op == Op::Acos { self.push_late(Recurrence::Neg(rate)) } else { rate };
                self.push(Recurrence::Integrate { a: rate, start })
            }
            Op::Acosh => {
                let (one, minus) = (self.constant(1.0), self.constant(-1.0));
                let (low, high) =
                    (self.push(Recurrence::Shift(u, minus)), self.push(Recurrence::Shift(u, one)));
                let inside = self.push(Recurrence::Mul(low, high));
                let below = self.square_root(inside);
                let rate = self.rate_over(u, below);
                self.push(Recurrence::Integrate { a: rate, start })
            }
            Op::Atanh => {
                let below = self.one_less_square(u);
                let rate = self.rate_over(u, below);
                self.push(Recurrence::Integrate { a: rate, start })
            }
            Op::Atan | Op::Asinh => {
                let one = self.constant(1.0);
                let square = self.push(Recurrence::Square(u));
                let inside = self.push(Recurrence::Shift(square, one));
                let below = if op == Op::Asinh { self.square_root(inside) } else { inside };
                let rate = self.rate_over(u, below);
                self.push(Recurrence::Integrate { a: rate, start })
            }
            Op::Abs | Op::Sign | Op::Floor | Op::Ceil | Op::Round | Op::Trunc => {
                return Err(NoSeries::Jumps(op));
            }
            Op::Not => unreachable!("a truth is done elsewhere"),
            Op::Add | Op::Sub | Op::Mul | Op::Div | Op::Powi | Op::Pow | Op::Atan2 | Op::Min | Op::Max => {
                unreachable!("{} has two operands", op.name())
            }
            Op::Mod | Op::Hypot | Op::Lt | Op::Le | Op::Eq | Op::Ne | Op::And | Op::Or | Op::Select => {
                unreachable!("{} has more than one operand", op.name())
            }
        })
    }

    fn as_row(&mut self, source: Source) -> RowId {
        match source {
            Source::Row(row) => row,
            Source::Fixed(fixed) => self.lift(fixed),
        }
    }
}
