//! tests

mod syntax;
mod codegen_systems;
mod codegen_bits;
mod codegen_program;
