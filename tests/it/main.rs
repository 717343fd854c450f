//! tests

mod syntax;
mod model;
mod codegen_systems;
mod codegen_bits;
mod codegen_program;
mod cli;
mod licences;
mod tidy;
mod errors;
mod documents;
