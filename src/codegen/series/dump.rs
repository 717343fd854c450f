//! Series as text, for `hyc show --stage tape`.

use std::fmt;

use crate::codegen::series::{
    ENDLESS, Fixed, Instruction, NoSeries, Pair, Recurrence, SeriesTape, Source, Start,
};

impl fmt::Display for Source {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Source::Fixed(id) => write!(f, "c{id}"),
            Source::Row(row) => write!(f, "u{row}"),
        }
    }
}

impl fmt::Display for Start {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.op.name())?;
        self.operands[..self.op.arity()].iter().try_for_each(|operand| write!(f, " {operand}"))
    }
}

impl fmt::Display for Fixed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Fixed::Constant(value) => write!(f, "{value:?}"),
            Fixed::Load { slot, column } => write!(f, "slot{slot}.aux[{column}]"),
            Fixed::Apply(op, operands) => {
                f.write_str(op.name())?;
                operands[..op.arity()].iter().try_for_each(|id| write!(f, " c{id}"))
            }
        }
    }
}

/// Primes are derivatives along the flow.
impl fmt::Display for Instruction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let to = self.to;
        match &self.recurrence {
            Recurrence::State { column, rate } => write!(f, "u{to}' = u{rate} from state[{column}]"),
            Recurrence::Time => write!(f, "u{to} = time"),
            Recurrence::Lift(c) => write!(f, "u{to} = c{c}"),
            Recurrence::Neg(a) => write!(f, "u{to} = -u{a}"),
            Recurrence::Add(a, b) => write!(f, "u{to} = u{a} + u{b}"),
            Recurrence::Sub(a, b) => write!(f, "u{to} = u{a} - u{b}"),
            Recurrence::Shift(a, c) => write!(f, "u{to} = u{a} + c{c}"),
            Recurrence::From(c, a) => write!(f, "u{to} = c{c} - u{a}"),
            Recurrence::Scale(a, c) => write!(f, "u{to} = u{a} c{c}"),
            Recurrence::Over { a, c, .. } => write!(f, "u{to} = u{a} / c{c}"),
            Recurrence::Mul(a, b) => write!(f, "u{to} = u{a} u{b}"),
            Recurrence::Square(a) => write!(f, "u{to} = u{a} u{a}"),
            Recurrence::Div { a, b, .. } => write!(f, "u{to} = u{a} / u{b}"),
            Recurrence::Root { a, start, .. } => write!(f, "u{to} u{to} = u{a} from {start}"),
            Recurrence::Derive(a) => write!(f, "u{to} = u{a}'"),
            Recurrence::Integrate { a, start } => write!(f, "u{to}' = u{a} from {start}"),
            Recurrence::Exp { a, start } => write!(f, "u{to}' = u{a} u{to} from {start}"),
            Recurrence::SinCos { pair, u, cosine, .. } => {
                let names = match pair {
                    Pair::Circular => "sin, cos",
                    Pair::Hyperbolic => "sinh, cosh",
                };
                write!(f, "u{to}, u{cosine} = {names} u{u}")
            }
            Recurrence::Choose(c, a, b) => write!(f, "u{to} = if c{c} then u{a} else u{b}"),
            Recurrence::Truth(start) => write!(f, "u{to} = {start}"),
            Recurrence::Turn { truth, turned, plain } => {
                write!(f, "u{to} = if u{truth} then u{turned} else u{plain}")
            }
        }
    }
}

/// A line for each fixed number and each recurrence; short rows with their lengths.
impl fmt::Display for SeriesTape {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (k, fixed) in self.fixed.iter().enumerate() {
            writeln!(f, "  c{k} = {fixed}")?;
        }
        for (k, instruction) in self.instructions.iter().enumerate() {
            let turn = if self.cycle.contains(&k) { "~ " } else { "  " };
            write!(f, "{turn}{instruction}")?;
            match self.lengths[instruction.to as usize] {
                ENDLESS => writeln!(f)?,
                length => writeln!(f, "    ({length} coefficients)")?,
            }
        }
        Ok(())
    }
}

impl fmt::Display for NoSeries {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            NoSeries::ReadsOthers => f.write_str("it reads other agents' states"),
            NoSeries::Jumps(op) => write!(f, "`{}` of what moves has no series", op.name()),
            NoSeries::TooLong => f.write_str("it is too long"),
        }
    }
}
