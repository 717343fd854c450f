//! What is refused before anything is done: what an algorithm cannot run, and a run without end.

use super::Refused;
use crate::codegen::program::{PairTransition, Program, Trigger};
use crate::model::Model;
use crate::model::ir::Action;
use crate::runtime::{Algorithm, published_take};

/// Refuses what the published algorithms cannot run.
pub(super) fn refuse_unpublished(algorithm: Algorithm, program: &Program) -> Result<(), Refused> {
    if matches!(algorithm, Algorithm::Masim(_)) {
        return Ok(());
    }
    let name = algorithm.name();
    if !program.properties().is_empty() {
        return Err(format!("`{name}` does not watch properties; there is `masim`"));
    }
    let flows =
        |pair: &PairTransition| matches!(pair.transition.trigger, Trigger::Chance { flows: true, .. });
    if program.interactions.iter().flat_map(|interaction| &interaction.transitions).any(flows) {
        return Err(format!(
            "`{name}` does not follow the rate of an interaction along the flow; there is `masim`"
        ));
    }
    if published_take(program) {
        return Ok(());
    }
    Err(format!(
        "`{name}` does not take agents that are created or destroyed, links with an expression, nor guards with count, sum, min or max over agents that come and go while states flow (their \
         `where` compares what flows): such a guard jumps; there is `masim`"
    ))
}

/// Refuses a model that neither `until` nor a `stop` ever ends.
pub(super) fn refuse_endless(model: &Model) -> Result<(), Refused> {
    if model.run.until.is_some() || model.action_lists().any(stops) {
        return Ok(());
    }
    Err("the run has no end: write `run { until 10 }`, add `--until 10`, or let an action `stop`".into())
}

fn stops(actions: &[Action]) -> bool {
    actions.iter().any(|action| match action {
        Action::Stop { .. } => true,
        Action::If { then, otherwise, .. } => stops(then) || stops(otherwise),
        Action::Assign { .. } | Action::Draw { .. } | Action::Emit { .. } | Action::Goto { .. } => false,
        Action::Create(_) | Action::Destroy { .. } => false,
    })
}
