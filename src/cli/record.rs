//! What `--record FILE` asks for: the model's own record in another file, or, where it has none, all states.

use std::path::Path;

use super::Refused;
use crate::model::ir::{Model, Record, VarRef};

/// Lays `--record` over the model's records.
pub(super) fn arrange_records(model: &mut Model, wanted: Option<&Path>) -> Result<(), Refused> {
    match (wanted, model.run.records.len()) {
        (None, _) | (Some(_), 1) => Ok(()),
        (Some(_), 0) => {
            let everything = all_states(model);
            model.run.records.push(everything);
            Ok(())
        }
        (Some(_), records) => {
            Err(format!("run {{ }} has {records} records with files of their own: leave `--record` out"))
        }
    }
}

/// The states of all agents at every accepted step.
fn all_states(model: &Model) -> Record {
    let mut columns: Vec<String> = Vec::new();
    for state in model.types.iter().flat_map(|ty| &ty.states) {
        if !columns.contains(&state.name) {
            columns.push(state.name.clone());
        }
    }
    let variables = model.types.iter().map(|ty| {
        let place = |column: &String| ty.states.iter().position(|state| state.name == *column);
        columns.iter().map(|column| place(column).map(VarRef::State)).collect()
    });
    Record {
        agents: (0..model.population.agents.len()).collect(),
        variables: variables.collect(),
        columns,
        every: None,
        file: None,
        span: model.run.span.unwrap_or_default(),
    }
}
