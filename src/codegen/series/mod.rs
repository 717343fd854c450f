//! Taylor series: the recurrences by which the coefficients of a flow's solution follow from its states, order by order.
//!
//! In: the rates of a flow, as nodes of the graph. Out: a [`SeriesTape`]: a straight list of recurrences over *rows*, each
//! the coefficients u_0, u_1, .. of u(t + s) = sum of u_k s^k, s in seconds. What cannot move during a step is no row but a
//! *fixed* number, computed once. Every function is brought to few recurrences by the differential equation that it
//! solves: `y = exp u` is y' = u' y, `y = atan u` is y' = u' / (1 + u^2), `(s, c) = (sin u, cos u)` is s' = u' c, c' = -u' s.
//! Coefficient 0 of every row is what `Op::eval` gives, so that coefficient 1 of a state is its rate, to the bit.
//! Source: Moore, Interval Analysis (1966), chapter 11; Jorba & Zou, Experimental Mathematics 14 (2005).

mod record;
mod compose;
mod schedule;
mod evaluate;
mod cpu;
mod dump;

pub use evaluate::ORDER_MAX;
pub use record::{NoSeries, record};

use smallvec::{SmallVec, smallvec};

use crate::math::Op;

/// A row of coefficients.
pub type RowId = u32;

/// A number that does not move during a step.
pub type FixedId = u32;

/// How a fixed number is made; number k of the list makes fixed number k.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fixed {
    /// A constant.
    Constant(f64),
    /// An auxiliary column of the agent in a slot.
    Load {
        /// Whose.
        slot: u32,
        /// Which.
        column: u32,
    },
    /// An operator of fixed numbers; operands beyond its arity repeat the first.
    Apply(Op, [FixedId; 3]),
}

/// An operand at order 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Source {
    /// It does not move.
    Fixed(FixedId),
    /// Coefficient 0 of a row.
    Row(RowId),
}

/// How the value at the begin of a step is made: operands beyond the operator's arity repeat the first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Start {
    /// The operator.
    pub op: Op,
    /// With what.
    pub operands: [Source; 3],
}

/// Which pair of functions: s' = u' c, and c' = -u' s or c' = u' s.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Pair {
    /// Sine and cosine.
    Circular,
    /// Their hyperbolic kin.
    Hyperbolic,
}

/// How the coefficients of a row, here y, follow from those of others.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Recurrence {
    /// A state: y' = rate.
    State {
        /// Which.
        column: u32,
        /// Its rate.
        rate: RowId,
    },
    /// The time.
    Time,
    /// A number that does not move.
    Lift(FixedId),
    /// `-a`.
    Neg(RowId),
    /// `a + b`.
    Add(RowId, RowId),
    /// `a - b`.
    Sub(RowId, RowId),
    /// `a + c`.
    Shift(RowId, FixedId),
    /// `c - a`.
    From(FixedId, RowId),
    /// `c a`.
    Scale(RowId, FixedId),
    /// `a / c`.
    Over {
        /// See above.
        a: RowId,
        /// See above.
        c: FixedId,
        /// 1 / c.
        inverse: FixedId,
    },
    /// `a b`.
    Mul(RowId, RowId),
    /// `a a`.
    Square(RowId),
    /// `a / b`.
    Div {
        /// See above.
        a: RowId,
        /// See above.
        b: RowId,
        /// Scratch: 1 / b_0.
        inverse: RowId,
    },
    /// y y = a.
    Root {
        /// See above.
        a: RowId,
        /// Scratch: 1 / (2 y_0).
        inverse: RowId,
        /// How y_0 is made.
        start: Start,
    },
    /// y = a'.
    Derive(RowId),
    /// y' = a.
    Integrate {
        /// See above.
        a: RowId,
        /// How y_0 is made.
        start: Start,
    },
    /// y' = a y.
    Exp {
        /// See above.
        a: RowId,
        /// How y_0 is made.
        start: Start,
    },
    /// y and its partner of `u`, by `a` = u'.
    SinCos {
        /// See above.
        pair: Pair,
        /// See above.
        u: RowId,
        /// See above.
        a: RowId,
        /// The row of the (hyperbolic) cosine.
        cosine: RowId,
    },
    /// `a` where a fixed number is true, else `b`.
    Choose(FixedId, RowId, RowId),
    /// A truth at the begin of the step, by which nothing but [`Recurrence::Turn`] may go.
    Truth(Start),
    /// `turned` where a truth holds, else `plain`; these differ by what does not move.
    Turn {
        /// A row of truth.
        truth: RowId,
        /// See above.
        turned: RowId,
        /// See above.
        plain: RowId,
    },
}

/// A recurrence and where its coefficients go.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Instruction {
    /// The row that it fills.
    pub to: RowId,
    /// In round k of the orders it makes coefficient k - lag.
    pub lag: u32,
    /// What it does.
    pub recurrence: Recurrence,
}

/// The length of a row whose coefficients go on for ever.
pub const ENDLESS: u32 = u32::MAX;

/// The series of a flow.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SeriesTape {
    /// Numbers that do not move.
    pub fixed: Vec<Fixed>,
    /// In the order in which they are done, see [`SeriesTape::cycle`].
    pub instructions: Vec<Instruction>,
    /// Which of the instructions wait for each other: these are done round by round, an order at a time; those before
    /// and after them one by one, all orders at once.
    pub cycle: std::ops::Range<usize>,
    /// How many states there are: these are the first rows.
    pub n_states: usize,
    /// The rows of their rates.
    pub rates: Vec<RowId>,
    /// Of each row, how many of its first coefficients can differ from 0.
    pub lengths: Vec<u32>,
    /// For each order, how many arithmetic operations an expansion takes, a function such as `sin` as one.
    operations: Vec<u64>,
}

impl SeriesTape {
    /// How many rows there are.
    pub fn n_rows(&self) -> usize {
        self.lengths.len()
    }

    /// How many numbers the coefficients of all rows are, up to this order.
    pub fn n_coefficients(&self, order: usize) -> usize {
        self.n_rows() * (order + 1)
    }

    /// Whether the states are polynomials of the time, whatever they begin from.
    pub fn is_polynomial(&self) -> bool {
        self.lengths[..self.n_states].iter().all(|&length| length < ENDLESS)
    }

    /// How many arithmetic operations an expansion takes, a function such as `sin` as one.
    pub fn operations(&self, order: usize) -> u64 {
        self.operations[order]
    }

    /// How many coefficients of its row an instruction makes up to an order.
    #[inline(always)]
    fn count(&self, instruction: &Instruction, order: usize) -> usize {
        let wanted = match instruction.recurrence {
            Recurrence::State { .. } => order + 1,
            _ => order - instruction.lag as usize,
        };
        wanted.min(self.lengths[instruction.to as usize] as usize)
    }
}

impl Recurrence {
    /// The rows of others that it reads, to be renamed.
    pub fn operands_mut(&mut self) -> SmallVec<[&mut RowId; 4]> {
        fn of_start(start: &mut Start) -> impl Iterator<Item = &mut RowId> {
            start.operands.iter_mut().filter_map(|source| match source {
                Source::Row(row) => Some(row),
                Source::Fixed(_) => None,
            })
        }
        match self {
            Recurrence::Time | Recurrence::Lift(_) => SmallVec::new(),
            Recurrence::State { rate: a, .. } | Recurrence::Over { a, .. } => smallvec![a],
            Recurrence::Neg(a) | Recurrence::Shift(a, _) | Recurrence::From(_, a) => smallvec![a],
            Recurrence::Scale(a, _) | Recurrence::Square(a) | Recurrence::Derive(a) => smallvec![a],
            Recurrence::Add(a, b) | Recurrence::Sub(a, b) | Recurrence::Mul(a, b) => smallvec![a, b],
            Recurrence::Div { a, b, .. } | Recurrence::Choose(_, a, b) => smallvec![a, b],
            Recurrence::SinCos { u, a, .. } => smallvec![u, a],
            Recurrence::Turn { truth, turned, plain } => smallvec![truth, turned, plain],
            Recurrence::Truth(start) => of_start(start).collect(),
            Recurrence::Root { a, start, .. }
            | Recurrence::Integrate { a, start }
            | Recurrence::Exp { a, start } => std::iter::once(a).chain(of_start(start)).collect(),
        }
    }

    /// The rows of others that it reads.
    pub fn operands(mut self) -> SmallVec<[RowId; 4]> {
        self.operands_mut().into_iter().map(|row| *row).collect()
    }

    /// The rows beside its own that it fills.
    pub fn fills(&self) -> Option<RowId> {
        match self {
            Recurrence::Div { inverse, .. } | Recurrence::Root { inverse, .. } => Some(*inverse),
            Recurrence::SinCos { cosine, .. } => Some(*cosine),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests;
