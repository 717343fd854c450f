//! What explanations need to know of the instant at hand; kept only for an observer that wants to be told.

use rustc_hash::FxHashMap;

use crate::runtime::observe::Undecided;
use crate::runtime::population::Agents;
use crate::runtime::present::Present;

/// See the head of this file.
pub struct Notes {
    /// Rows for what is shown: made apart, so that no count of the run knows of them.
    pub aside: Present,
    /// States and columns of the agents that the last micro-step of this instant wrote, as they were before.
    pub before: FxHashMap<usize, (Vec<f64>, Vec<f64>)>,
    /// The agents that it took into another mode.
    pub moved: Vec<usize>,
    /// The agents that it made.
    pub born: Vec<usize>,
    /// The labels of the transitions that fired in it.
    pub writers: Vec<String>,
    /// What could not be decided and has not been told yet.
    pub undecided: Vec<Undecided>,
}

impl Notes {
    /// For a run that has not begun.
    pub fn new(agents: &Agents<'_>) -> Self {
        let aside = Present::new(agents);
        let (before, moved, born) = (FxHashMap::default(), Vec::new(), Vec::new());
        Self { aside, before, moved, born, writers: Vec::new(), undecided: Vec::new() }
    }

    /// An instant begins: nothing has been written in it.
    pub fn begin(&mut self) {
        self.before.clear();
        self.moved.clear();
        self.born.clear();
        self.writers.clear();
    }
}
