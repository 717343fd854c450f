//! hyc: a language, a compiler and a simulator for multi-agent hybrid systems.

pub mod base;
pub mod math;
pub mod syntax;
pub mod model;
pub mod calculus;
pub mod codegen;
pub mod runtime;
pub mod output;
pub mod cli;
