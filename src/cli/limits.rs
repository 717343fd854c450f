//! `--limit NAME=N`: the names of all limits, and the floor that each belongs to.

use super::Refused;
use crate::{model, runtime};

/// All limits, as the user set them.
#[derive(Clone, Debug, Default)]
pub(super) struct Limits {
    /// Of the model and its equations.
    pub(super) model: model::limits::Limits,
    /// Of the run.
    pub(super) run: runtime::limits::Limits,
}

impl Limits {
    /// The defaults with these changes.
    pub(super) fn new(given: &[(String, u64)]) -> Result<Self, Refused> {
        let mut limits = Self::default();
        let Self { model, run } = &mut limits;
        for (name, value) in given {
            let small = u32::try_from(*value).unwrap_or(u32::MAX);
            let size = usize::try_from(*value).unwrap_or(usize::MAX);
            match name.as_str() {
                "max_agents" => (model.agents_max, run.agents_max) = (size, size),
                "max_values" => model.values_max = size,
                "max_states" => model.states_max = size,
                "max_modes" => model.modes_max = size,
                "max_joining" => model.joining_max = size,
                "max_table_rows" => model.table_rows_max = size,
                "max_configurations" => model.configurations_max = size,
                "max_cells" => model.cells_max = size,
                "max_samples" => model.samples_max = *value,
                "max_evaluations" => model.evaluations_max = *value,
                "max_operations" => model.operations_max = *value,
                "max_microsteps" => run.microsteps_max = small,
                "zeno_events" => run.zeno_events = small,
                "max_steps" => run.steps_max = *value,
                "max_generations" => run.generations_max = small,
                "max_guards" => run.guards_max = size,
                "max_pieces" => run.pieces_max = small,
                _ => {
                    let of_model = "max_agents, max_values, max_states, max_modes, max_configurations, max_joining, max_table_rows, max_cells, max_samples, max_evaluations, max_operations";
                    let of_run =
                        "max_microsteps, zeno_events, max_steps, max_generations, max_guards, max_pieces";
                    return Err(format!("there is no limit `{name}`; there are {of_model}, {of_run}"));
                }
            }
        }
        Ok(limits)
    }
}
