//! What is known about a run when it is over: the settings it had, how it ended, what it took.

use super::cast::Cast;
use crate::base::SourceMap;
use crate::runtime::observe::Outcome;

/// A finished run.
pub struct Report<'a> {
    /// The model's path as the user wrote it.
    pub model: &'a str,
    /// `masim`.
    pub algorithm: &'a str,
    /// `plain`.
    pub engine: &'a str,
    /// `auto`, `tsit5`, `adams`, `stiff`.
    pub integrator: &'a str,
    /// `jit`, `interp`.
    pub backend: &'a str,
    /// Relative tolerance.
    pub tolerance: f64,
    /// Absolute tolerance.
    pub absolute: f64,
    /// Seed of all randomness.
    pub seed: u64,
    /// The end that was asked for, s; none: only a `stop` ends the run.
    pub until: Option<f64>,
    /// The texts that diagnostics point into.
    pub sources: &'a SourceMap,
    /// Names of the agents.
    pub cast: &'a Cast,
    /// How it ended, and counts.
    pub outcome: &'a Outcome,
    /// Functions of machine code.
    pub functions: usize,
    /// Instructions of all tapes.
    pub instructions: usize,
    /// Bytes of machine code.
    pub code_bytes: usize,
    /// Who had most events, and how many.
    pub busiest: &'a [(String, u64)],
    /// Who took most steps, and how many.
    pub slowest: &'a [(String, u64)],
    /// The parts of compiling, s.
    pub compile_parts: &'a [(&'a str, f64)],
    /// The part of the run that writing took, s.
    pub writing_seconds: f64,
    /// From text to program, s.
    pub compile_seconds: f64,
    /// From program to end, s.
    pub run_seconds: f64,
    /// What making the page took, s; none where there is none.
    pub page_seconds: Option<f64>,
    /// The files that were written.
    pub files: &'a [String],
}
