//! The functions of one or two real arguments that no IEEE instruction gives, the same bits on every CPU.

pub mod exact;
pub mod library;

pub use exact::{maximum, minimum, modulo, powi, round, sign};
pub use library::*;
