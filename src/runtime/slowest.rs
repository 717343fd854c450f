//! Who took most steps, of all agents that have lived.

use std::cmp::Reverse;

use crate::runtime::observe::Who;

/// So many are told.
const TOLD: usize = 8;
/// So many are looked through at once.
const GATHERED: usize = 256;

/// Those with most steps so far.
#[derive(Clone, Debug, Default)]
pub struct Slowest {
    found: Vec<(Who, u64)>,
}

impl Slowest {
    /// Takes note of an agent that takes no more steps.
    pub fn note(&mut self, who: Who, steps: u64) {
        if who.is_visible() && steps > 0 {
            self.found.push((who, steps));
        }
        if self.found.len() >= GATHERED {
            self.choose();
        }
    }

    /// Those with most steps; among equals, in the order of their numbers.
    pub fn told(mut self) -> Vec<(Who, u64)> {
        self.choose();
        self.found
    }

    fn choose(&mut self) {
        self.found.sort_unstable_by_key(|&(who, steps)| (Reverse(steps), who));
        self.found.truncate(TOLD);
    }
}
