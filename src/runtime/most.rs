//! Who has most of something, of all agents that have lived: steps, events.

use std::cmp::Reverse;

use crate::runtime::observe::Who;

/// So many are told.
const TOLD: usize = 8;
/// So many are looked through at once.
const GATHERED: usize = 256;

/// Those with most so far.
#[derive(Clone, Debug, Default)]
pub struct Most {
    found: Vec<(Who, u64)>,
}

impl Most {
    /// Takes note of an agent that will have no more than `count`.
    pub fn note(&mut self, who: Who, count: u64) {
        if who.is_visible() && count > 0 {
            self.found.push((who, count));
        }
        if self.found.len() >= GATHERED {
            self.choose();
        }
    }

    /// Those with most; among equals, in the order of their numbers.
    pub fn told(mut self) -> Vec<(Who, u64)> {
        self.choose();
        self.found
    }

    fn choose(&mut self) {
        self.found.sort_unstable_by_key(|&(who, count)| (Reverse(count), who));
        self.found.truncate(TOLD);
    }
}
