//! The tests of the whole product: each file is named after a question and asks it of models, not of inner functions.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod syntax;
mod model;
mod calculus;
mod codegen_systems;
mod codegen_bits;
mod codegen_blocks;
mod codegen_program;
mod cli;
mod cli_warnings;
mod licences;
mod tidy;
mod errors;
mod harness;
mod documents;
mod models;
mod stages;
mod rules;
mod run_errors;
mod explanations;
mod instants;
mod nearness;
mod lints;
mod crowds;
mod grazes;
mod poles;
mod jumps;
mod closed_forms;
mod bumper;
mod accuracy;
mod adams;
mod stiff;
mod taylor;
mod paper;
mod compare;
mod differential;
mod draws;
mod systems_biology;
mod units;
mod robust;
mod windows;
mod aggregates;
mod limits;
