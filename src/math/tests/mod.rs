//! Tests of the arithmetic floor.

mod elementary;
mod op;
mod interval;
mod draw;
