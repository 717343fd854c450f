//! The arithmetic floor: what every operator of the language means, in numbers and in intervals.
//!
//! In: nothing but numbers. Out: [`Op`], the table of operators whose [`Op::eval`] is *the* meaning that the
//! interpreter, constant folding and machine code share bit for bit; [`elementary`], the functions behind it;
//! [`Interval`], bounds on an operator over a box; [`runge_kutta`], the coefficients that steps are made of; [`draw`],
//! random numbers; [`Numbers`], a number for each of some agents; [`Scale`], the sizes of units.
//! Promised: the same bits on every CPU and for every thread count, because nothing here looks at the CPU's
//! features and no multiplication is fused into an addition unless it is written so.

pub mod elementary;
pub mod op;
pub mod numbers;
pub mod interval;
pub mod runge_kutta;
pub mod draw;
pub mod scale;

pub use interval::Interval;
pub use numbers::{N_LANES, Numbers, Wide};
pub use op::{Binary, Op, Unary};
pub use scale::Scale;

#[cfg(test)]
mod tests;
