//! Where the values of an agent stand: the columns of its rows, in order.

use crate::calculus::graph::Node;
use crate::math::Scale;

/// The columns of an agent type.
///
/// Auxiliary columns in order: number, mode, time of entry, parameters, discretes, links, what a message carries, gates, histories, locks. Numbers
/// of agents are held as reals, -1 for none. A history holds the number of a mode: the submode that was active last. A lock holds the branch that
/// a kink of the flow has taken (rule 15).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Layout {
    /// How many states, hazards included.
    pub n_states: usize,
    /// How many of them, the last ones, are what is left of the hazards of its `rate` transitions, each with a gate: 1 while the
    /// guard of the transition is true, else 0.
    pub n_hazards: usize,
    /// How many parameters.
    pub n_params: usize,
    /// How many discrete variables.
    pub n_discretes: usize,
    /// How many links.
    pub n_links: usize,
    /// How many values the messages carry that it hears (the most that any event does).
    pub n_received: usize,
    /// How many modes remember which of their submodes was active last.
    pub n_histories: usize,
    /// How many locks (the most that any mode needs).
    pub n_locks: usize,
}

impl Layout {
    /// Column of the agent's own number.
    pub const NUMBER: usize = 0;
    /// Column of the number of the (leaf) mode.
    pub const MODE: usize = 1;
    /// Column of the time at which the mode was entered, s.
    pub const ENTRY: usize = 2;

    /// Column of parameter k.
    pub fn param(&self, k: usize) -> usize {
        3 + k
    }
    /// Column of discrete variable k.
    pub fn discrete(&self, k: usize) -> usize {
        3 + self.n_params + k
    }
    /// Column of link k.
    pub fn link(&self, k: usize) -> usize {
        3 + self.n_params + self.n_discretes + k
    }
    /// Column of value k of the message at hand.
    pub fn received(&self, k: usize) -> usize {
        3 + self.n_params + self.n_discretes + self.n_links + k
    }
    /// Number of the state that is left of hazard k.
    pub fn hazard(&self, k: usize) -> usize {
        self.n_states - self.n_hazards + k
    }
    /// Column of the gate of hazard k.
    pub fn gate(&self, k: usize) -> usize {
        self.received(self.n_received) + k
    }
    /// Column of history k.
    pub fn history(&self, k: usize) -> usize {
        self.gate(self.n_hazards) + k
    }
    /// Column of lock k.
    pub fn lock(&self, k: usize) -> usize {
        self.history(self.n_histories) + k
    }
    /// How many auxiliary columns there are.
    pub fn n_aux(&self) -> usize {
        self.lock(self.n_locks)
    }
}

/// A named column with its unit for output.
#[derive(Clone, Debug)]
pub struct Column {
    /// Its name.
    pub name: String,
    /// What one declared unit is in SI.
    pub scale: Scale,
    /// Whether it holds a boolean.
    pub boolean: bool,
}

/// A value of an agent by where it stands in its rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Entry {
    /// A state.
    State(usize),
    /// A parameter or a discrete variable, by its auxiliary column (absolute index).
    Aux(usize),
}

impl Entry {
    /// The leaf that reads it of the agent in a slot.
    pub fn leaf(self, slot: usize) -> Node {
        let slot = slot as u32;
        match self {
            Entry::State(column) => Node::State { slot, column: column as u32 },
            Entry::Aux(column) => Node::Aux { slot, column: column as u32 },
        }
    }
}
