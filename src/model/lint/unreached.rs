//! Modes in which no agent ever is (HY0604): not initial, no agent starts there, no transition from a mode that is reached
//! leads there, no interaction. In a file without `system` an agent of another file may start in any mode.

use super::Warning;
use crate::model::context::Context;
use crate::model::ir::{Action, AgentType, ModeId, Model, TypeId};

/// Reports the outermost unreached modes of every type.
pub(super) fn modes(context: &Context, found: &mut Vec<Warning>) {
    let model = &context.model;
    if model.population.blocks.is_empty() {
        return;
    }
    let starts = starts(model);
    for (id, ty) in model.types.iter_enumerated() {
        let reached = reached(ty, &starts[id.index()]);
        let outermost = |mode: ModeId| {
            !reached[mode.index()] && ty.modes[mode].parent.is_some_and(|parent| reached[parent.index()])
        };
        for mode in ty.modes.indices().filter(|mode| outermost(*mode)) {
            let item = &ty.modes[mode];
            if !item.name.starts_with('_') {
                let (path, agent, span) = (item.path.clone(), ty.name.clone(), item.span);
                found.push(Warning::Unreached { path, agent, span });
            }
        }
    }
}

/// By type: the modes in which agents begin, and those into which interactions put them.
fn starts(model: &Model) -> Vec<Vec<ModeId>> {
    let mut starts = vec![vec![ModeId::new(0)]; model.types.len()];
    for agent in model.population.agents.iter() {
        let known = &mut starts[agent.ty.index()];
        if !known.contains(&agent.mode) {
            known.push(agent.mode);
        }
    }
    for create in model.creations() {
        starts[create.ty.index()].push(create.mode);
    }
    for interaction in model.interactions.iter() {
        for transition in &interaction.transitions {
            gotos(&transition.actions, &interaction.types, &mut starts);
        }
    }
    starts
}

fn gotos(list: &[Action], types: &[TypeId; 2], starts: &mut [Vec<ModeId>]) {
    for action in list {
        match action {
            Action::Goto { participant, target, .. } => starts[types[*participant].index()].push(target.mode),
            Action::If { then, otherwise, .. } => {
                gotos(then, types, starts);
                gotos(otherwise, types, starts);
            }
            Action::Assign { .. } | Action::Draw { .. } | Action::Emit { .. } | Action::Stop { .. } => {}
            Action::Create(_) | Action::Destroy { .. } => {}
        }
    }
}

/// By mode: whether an agent can be in it, or inside it.
fn reached(ty: &AgentType, starts: &[ModeId]) -> Vec<bool> {
    let mut reached = vec![false; ty.modes.len()];
    let mut from: Vec<Vec<ModeId>> = vec![Vec::new(); ty.modes.len()];
    for transition in &ty.transitions {
        from[transition.source.index()].extend(transition.target.map(|target| target.mode));
    }
    let mut pending = starts.to_vec();
    while let Some(mode) = pending.pop() {
        if std::mem::replace(&mut reached[mode.index()], true) {
            continue;
        }
        pending.extend(ty.modes[mode].parent);
        pending.extend(ty.modes[mode].initial);
        pending.extend(ty.modes[mode].children.iter().filter(|&&child| ty.modes[child].is_region));
        pending.extend(&from[mode.index()]);
    }
    reached
}
