//! Tests of the arithmetic floor.

mod elementary;
mod op;
mod lanes;
mod interval;
mod draw;
