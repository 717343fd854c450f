//! How a run is computed, as far as `run { }` says: by names and numbers that are no part of the model's meaning.
//!
//! What is none here is the command line's, or the default's.

use super::integrator::Integrator;

/// How the agents' clocks advance, by the names that users give.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum AlgorithmName {
    /// Each agent on its own clock; events certified.
    #[default]
    Masim,
    /// Algorithms 1 and 2 of Esposito & Kumar (2004), as published.
    Masim2004,
    /// Algorithms 3 and 4: one clock for all, as published.
    Sasim2004,
}

/// The form of the engine, by the names that users give.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum EngineName {
    /// Near pairs only; who cannot meet anybody runs ahead.
    #[default]
    Fast,
    /// Everything is looked at.
    Plain,
}

/// What evaluates the equations, by the names that users give.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BackendName {
    /// The interpreter, and machine code as soon as it pays.
    #[default]
    Auto,
    /// Machine code.
    Jit,
    /// The interpreter.
    Interp,
}

/// Names that a setting may have.
pub trait Named: Copy + PartialEq + 'static {
    /// All, by the names that users give.
    const NAMED: &'static [(&'static str, Self)];

    /// All, in words.
    const WORDS: &'static str;

    /// The one of this name.
    fn named(text: &str) -> Option<Self> {
        Self::NAMED.iter().find(|(name, _)| *name == text).map(|(_, value)| *value)
    }

    /// The name that users give it.
    fn name(self) -> &'static str {
        let named = Self::NAMED.iter().find(|(_, value)| *value == self);
        named.expect("every value has a name").0
    }
}

impl Named for Integrator {
    const NAMED: &'static [(&'static str, Self)] = &Integrator::NAMED;
    const WORDS: &'static str = "auto, taylor, tsit5, adams or stiff";
}

impl Named for AlgorithmName {
    const NAMED: &'static [(&'static str, Self)] =
        &[("masim", Self::Masim), ("masim-2004", Self::Masim2004), ("sasim-2004", Self::Sasim2004)];
    const WORDS: &'static str = "masim, masim-2004 or sasim-2004";
}

impl Named for EngineName {
    const NAMED: &'static [(&'static str, Self)] = &[("fast", Self::Fast), ("plain", Self::Plain)];
    const WORDS: &'static str = "fast or plain";
}

impl Named for BackendName {
    const NAMED: &'static [(&'static str, Self)] =
        &[("auto", Self::Auto), ("jit", Self::Jit), ("interp", Self::Interp)];
    const WORDS: &'static str = "auto, jit or interp";
}

/// What `run { }` says of how it is computed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Machinery {
    /// `algorithm`.
    pub algorithm: Option<AlgorithmName>,
    /// `engine`.
    pub engine: Option<EngineName>,
    /// `backend`.
    pub backend: Option<BackendName>,
    /// `threads`, from 1.
    pub threads: Option<u32>,
    /// `event_tolerance`: within this of the first, s, roots of those who share an agent are one instant.
    pub event_tolerance: Option<f64>,
    /// `max_microsteps`.
    pub microsteps_max: Option<u32>,
    /// `zeno_events`.
    pub zeno_events: Option<u32>,
    /// `gamma` of the algorithms of 2004.
    pub gamma: Option<f64>,
    /// Their `h_min`, s.
    pub h_min: Option<f64>,
    /// Their `h_max`, s.
    pub h_max: Option<f64>,
    /// Their `synchronisation`, s.
    pub synchronisation: Option<f64>,
}
