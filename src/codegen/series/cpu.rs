//! The evaluator compiled for what processors have: one source, several sets of instructions, the same bits.

use crate::codegen::series::SeriesTape;
use crate::math::Wide;

/// A set of instructions that lanes are advanced with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Level {
    /// What every processor of the kind has.
    Baseline,
    /// Four lanes an instruction.
    #[cfg(target_arch = "x86_64")]
    Avx2,
    /// Eight lanes an instruction.
    #[cfg(target_arch = "x86_64")]
    Avx512,
}

/// The best that this processor has.
#[inline]
fn level() -> Level {
    #[cfg(target_arch = "x86_64")]
    {
        if is_x86_feature_detected!("avx512f")
            && is_x86_feature_detected!("avx512dq")
            && is_x86_feature_detected!("avx512vl")
        {
            return Level::Avx512;
        }
        if is_x86_feature_detected!("avx2") {
            return Level::Avx2;
        }
    }
    Level::Baseline
}

/// What the states of lanes are expanded from, and where to: see [`SeriesTape::expand_numbers`].
struct Expansion<'a> {
    tape: &'a SeriesTape,
    time: Wide,
    states: &'a [Wide],
    fixed: &'a [Wide],
    order: usize,
    rows: &'a mut [Wide],
}

impl Expansion<'_> {
    #[inline(always)]
    fn run(self) {
        let Self { tape, time, states, fixed, order, rows } = self;
        tape.expand_numbers(time, states, fixed, order, rows);
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx512f,avx512dq,avx512vl")]
    fn run_avx512(self) {
        self.run();
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2")]
    fn run_avx2(self) {
        self.run();
    }
}

impl SeriesTape {
    /// [`SeriesTape::fix_numbers`] of one agent.
    pub fn fix(&self, load: impl Fn(u32, u32) -> f64, values: &mut [f64]) {
        self.fix_numbers(load, values);
    }

    /// [`SeriesTape::fix_numbers`] of lanes.
    pub fn fix_wide(&self, load: impl Fn(u32, u32) -> Wide, values: &mut [Wide]) {
        self.fix_numbers(load, values);
    }

    /// [`SeriesTape::expand_numbers`] of one agent.
    pub fn expand(&self, time: f64, states: &[f64], fixed: &[f64], order: usize, rows: &mut [f64]) {
        self.expand_numbers(time, states, fixed, order, rows);
    }

    /// [`SeriesTape::expand_numbers`] of lanes, in the widest instructions there are.
    pub fn expand_wide(&self, time: Wide, states: &[Wide], fixed: &[Wide], order: usize, rows: &mut [Wide]) {
        let expansion = Expansion { tape: self, time, states, fixed, order, rows };
        match level() {
            Level::Baseline => expansion.run(),
            #[cfg(target_arch = "x86_64")]
            // SAFETY: the processor has been found to have these instructions.
            Level::Avx2 => unsafe { expansion.run_avx2() },
            #[cfg(target_arch = "x86_64")]
            // SAFETY: as above.
            Level::Avx512 => unsafe { expansion.run_avx512() },
        }
    }
}
