//! The evaluator compiled for what processors have: one source, several sets of instructions, the same bits.

use crate::codegen::series::SeriesTape;
use crate::math::Wide;
use crate::math::lanes::{Level, Work};

/// What the states of lanes are expanded from, and where to: see [`SeriesTape::expand_numbers`].
struct Expansion<'a> {
    tape: &'a SeriesTape,
    time: Wide,
    states: &'a [Wide],
    fixed: &'a [Wide],
    order: usize,
    rows: &'a mut [Wide],
}

impl Work for Expansion<'_> {
    #[inline(always)]
    fn work(self) {
        let Self { tape, time, states, fixed, order, rows } = self;
        tape.expand_numbers(time, states, fixed, order, rows);
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
        Level::best().run(Expansion { tape: self, time, states, fixed, order, rows });
    }
}
