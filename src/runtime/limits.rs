//! The limits of a run: each has a name, a default, and a diagnostic that says which setting raises it.

/// Limits and accuracies of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Limits {
    /// `max_microsteps`: firings of one transition instance in one instant (rule 4).
    pub microsteps_max: u32,
    /// `zeno_events`: firings of one transition instance in an interval too short to resolve (rule 12).
    pub zeno_events: u32,
    /// `max_steps`: accepted and rejected steps of all agents.
    pub steps_max: u64,
    /// `max_agents`: agents at a time, counting those that die in an instant until its end.
    pub agents_max: usize,
    /// `max_generations`: micro-steps of one instant, in a row, in which agents are created.
    pub generations_max: u32,
    /// `max_guards`: guard instances over pairs (all pairs are listed).
    pub guards_max: usize,
    /// `threads`, `-j`: how many threads may work. No result depends on it.
    pub threads_max: usize,
    /// `max_pieces`: how many pieces of time one search for a root of one guard looks at. A step may take several searches.
    pub pieces_max: u32,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            microsteps_max: 1000,
            zeno_events: 100,
            steps_max: 10_000_000_000,
            agents_max: 10_000_000,
            generations_max: 100_000,
            guards_max: 50_000_000,
            threads_max: 1,
            pieces_max: 10_000,
        }
    }
}
