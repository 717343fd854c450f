//! The limits of a model, by name: each guards memory or time against a model that asks for too much by mistake, and each has a
//! diagnostic that says which setting raises it (`--limit NAME=N`). The constants below are not to be raised: they are what
//! the stack holds, and what anybody reads.

/// Limits that the command line can raise or lower.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// `max_agents`: agents at t = 0.
    pub agents_max: usize,
    /// `max_values`: numbers that all agents hold together (parameters, states, discrete variables, links).
    pub values_max: usize,
    /// `max_states`: states of one agent type.
    pub states_max: usize,
    /// `max_modes`: modes of one agent type.
    pub modes_max: usize,
    /// `max_configurations`: combinations of modes of the regions of one agent type.
    pub configurations_max: usize,
    /// `max_joining`: agents by which a set that a flow reads may grow.
    pub joining_max: usize,
    /// `max_table_rows`: rows of a file that a `table` reads.
    pub table_rows_max: usize,
    /// `max_cells`: cells of one sample, agents by columns of a `record`.
    pub cells_max: usize,
    /// `max_samples`: samples of a `record ... every d`, up to the end of the run.
    pub samples_max: u64,
    /// `max_evaluations`: operations that all constants together may take.
    pub evaluations_max: u64,
    /// `max_operations`: work on the equations once lets and functions are put in, in nodes looked at.
    pub operations_max: u64,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            agents_max: 10_000_000,
            values_max: 200_000_000,
            states_max: 100_000,
            modes_max: 100_000,
            configurations_max: 1_000,
            joining_max: 32,
            table_rows_max: 1_000,
            cells_max: 10_000_000,
            samples_max: 1_000_000_000_000,
            evaluations_max: 50_000_000,
            operations_max: 200_000_000,
        }
    }
}

/// How many operations the initial values of an agent may take, on average.
pub const STEPS_PER_AGENT_MAX: u64 = 1_000;

/// How deep expressions may nest, over definitions that are looked up inside others; one expression alone stays below it.
pub const DEPTH_MAX: usize = 1_600;

/// What a definition that is looked up inside another counts in [`DEPTH_MAX`].
pub const DEPTH_OF_DEFINITION: usize = 8;

/// How many expressions of functions are measured again for the dimensions of their calls, all together; later calls are checked by
/// what their functions declare.
pub const INLINED_STEPS_MAX: u64 = 10_000_000;

/// How deep calls inside calls are measured again for their dimensions.
pub const INLINED_DEPTH_MAX: usize = 64;

/// How many agents an expression can reach, by links, quantifiers and the sets of flows (HY0304).
pub const REACHED_MAX: usize = 256;

/// How many branches an `if ... else if ...` among actions may have.
pub const BRANCHES_MAX: usize = 256;

/// How many errors, and how many warnings, of one model are told.
pub const DIAGNOSTICS_MAX: usize = 200;
