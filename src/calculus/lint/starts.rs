//! Some of the agents that start in each mode.

use rustc_hash::FxHashMap;

use crate::calculus::system::{Instance, System};

/// Some of the agents that start in each mode.
pub struct Starts(FxHashMap<(usize, usize), Vec<usize>>);

impl Starts {
    /// How many of each mode are looked at.
    const MAX: usize = 64;

    /// The first ones of each type and mode.
    pub fn of(system: &System) -> Self {
        let mut found: FxHashMap<(usize, usize), Vec<usize>> = FxHashMap::default();
        for (number, agent) in system.population.agents.iter().enumerate() {
            let known = found.entry((agent.ty.index(), agent.mode.index())).or_default();
            if known.len() < Self::MAX {
                known.push(number);
            }
        }
        Self(found)
    }

    /// Their numbers.
    pub fn numbers(&self, ty: usize, mode: usize) -> &[usize] {
        self.0.get(&(ty, mode)).map_or(&[], Vec::as_slice)
    }

    /// What they start with.
    pub fn in_mode<'s>(&self, system: &'s System, ty: usize, mode: usize) -> Vec<&'s Instance> {
        self.numbers(ty, mode).iter().map(|&number| &system.population.agents[number]).collect()
    }
}
