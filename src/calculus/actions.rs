//! Lists of actions: right-hand sides as functions, tests as guards, and what may be written.

use std::sync::Arc;

use crate::base::Span;
use crate::calculus::aggregate;
use crate::calculus::births;
use crate::calculus::condition::Sense;
use crate::calculus::draft::Draft;
use crate::calculus::error::Error;
use crate::calculus::frame::{AgentRef, Scope, Value};
use crate::calculus::guard;
use crate::calculus::system::{ActionList, ActionStep, Condition, Entry, FunctionId, Guard};
use crate::model::ir::{Action, ExprId, Type, TypeId, VarRef};

/// Lowers a list of actions in a scope; the frame is put in by whoever owns the scope, when it is complete.
pub fn actions(
    draft: &mut Draft,
    scope: &mut Scope,
    actions: &[Action],
    name: &str,
) -> Result<ActionList, Error> {
    let mut list = ActionList { steps: steps(draft, scope, actions, name)?, ..ActionList::default() };
    collect_writes(draft, scope, &list.steps, &mut list.writes);
    list.writes.sort_unstable();
    list.writes.dedup();
    list.writes.shrink_to_fit();
    Ok(list)
}

/// As deep as `if` is nested in the source.
fn steps(
    draft: &mut Draft,
    scope: &mut Scope,
    actions: &[Action],
    name: &str,
) -> Result<Vec<ActionStep>, Error> {
    let mut steps = Vec::with_capacity(actions.len());
    for action in actions {
        steps.push(match action {
            Action::Assign { agent, variable, value, span } => {
                assign(draft, scope, *agent, *variable, *value, *span, name)?
            }
            Action::Draw { agent, variable, distribution, parameters, span } => {
                let slot = writer(draft, scope, *agent)?;
                let (target, written) = target(draft, scope, slot, *variable);
                let stream = draft.stream(scope.frame.slots[slot].ty(), &written);
                let parameters = numbers(draft, scope, parameters, &format!("{name} {written}"))?;
                let distribution = *distribution;
                ActionStep::Draw { slot, target, distribution, parameters, stream, span: *span }
            }
            Action::Emit { agent, event, values, delay, span } => {
                let slot = writer(draft, scope, *agent)?;
                let values = numbers(draft, scope, values, &format!("{name} emits"))?;
                let delay = numbers(draft, scope, delay.as_slice(), &format!("{name} emits after"))?;
                let delay = delay.first().copied();
                ActionStep::Emit { slot, event: *event, values, delay, span: *span }
            }
            Action::If { condition, then, otherwise } => ActionStep::If {
                condition: test(draft, scope, *condition, name)?,
                then: self::steps(draft, scope, then, name)?,
                otherwise: self::steps(draft, scope, otherwise, name)?,
            },
            Action::Goto { participant, target, span } => {
                ActionStep::Goto { slot: *participant, target: *target, span: *span }
            }
            Action::Stop { reason, span } => ActionStep::Stop { reason: reason.clone(), span: *span },
            Action::Create(create) => {
                ActionStep::Create(Arc::new(births::birth(draft, scope, create, name)?))
            }
            Action::Destroy { agent, span } => match births::agent(draft, scope, *agent, *span)? {
                Some(slot) => ActionStep::Destroy { slot, span: *span },
                None => continue,
            },
        });
    }
    Ok(steps)
}

fn test(draft: &mut Draft, scope: &mut Scope, condition: ExprId, name: &str) -> Result<Guard, Error> {
    guard::guard(draft, scope, condition, Sense::Positive, &format!("{name} if"))
}

/// A boolean that is no number (it has a quantifier) is assigned by a choice between true and false.
fn assign(
    draft: &mut Draft,
    scope: &mut Scope,
    agent: ExprId,
    variable: VarRef,
    value: ExprId,
    span: Span,
    name: &str,
) -> Result<ActionStep, Error> {
    let slot = writer(draft, scope, agent)?;
    let (target, written) = target(draft, scope, slot, variable);
    let node = match aggregate::number(draft, scope, Scope::TOP, value) {
        Err(Error::QuantifierInNumber { .. }) if draft.model.exprs[value].ty == Type::Bool => {
            let condition = test(draft, scope, value, name)?;
            let outcomes =
                if let Condition::Constant(known) = condition.condition { [known; 2] } else { [true, false] };
            let [then, otherwise] = outcomes.map(|outcome| {
                let node = draft.graph.number(f64::from(u8::from(outcome)));
                let value = draft.function(|| outcome.to_string(), vec![node]);
                vec![ActionStep::Assign { slot, target, value, span }]
            });
            return Ok(ActionStep::If { condition, then, otherwise });
        }
        node => node?,
    };
    let value = draft.function(|| format!("{name} {written}"), vec![node]);
    Ok(ActionStep::Assign { slot, target, value, span })
}

/// The slot of whoever is written, or emits.
fn writer(draft: &mut Draft, scope: &mut Scope, agent: ExprId) -> Result<usize, Error> {
    match aggregate::value(draft, scope, Scope::TOP, agent)? {
        Value::Agent(AgentRef::Slot(slot)) => Ok(slot),
        Value::Agent(AgentRef::Link { .. } | AgentRef::Absent) | Value::Number(_) | Value::Delayed(..) => {
            unreachable!("the model lets only self and participants be written")
        }
    }
}

/// A function of one output for each of some numbers.
fn numbers(
    draft: &mut Draft,
    scope: &mut Scope,
    exprs: &[ExprId],
    name: &str,
) -> Result<Vec<FunctionId>, Error> {
    let mut functions = Vec::with_capacity(exprs.len());
    for &expr in exprs {
        let node = aggregate::number(draft, scope, Scope::TOP, expr)?;
        functions.push(draft.function(|| name.to_owned(), vec![node]));
    }
    Ok(functions)
}

/// The column that is written, and its name.
fn target(draft: &Draft, scope: &Scope, slot: usize, variable: VarRef) -> (Entry, String) {
    let ty = scope.frame.slots[slot].ty();
    let model = &draft.model.types[TypeId::new(ty)];
    match variable {
        VarRef::State(k) => (Entry::State(k), model.states[k].name.clone()),
        VarRef::Discrete(k) => (Entry::Aux(draft.layout(ty).discrete(k)), model.discretes[k].name.clone()),
        VarRef::Param(_) | VarRef::Link(_) | VarRef::Let(_) => {
            unreachable!("the model lets only states and discretes be written")
        }
    }
}

/// Who destroys an agent writes all of it.
fn collect_writes(draft: &Draft, scope: &Scope, steps: &[ActionStep], writes: &mut Vec<(usize, Entry)>) {
    for step in steps {
        match step {
            ActionStep::Assign { slot, target, .. } | ActionStep::Draw { slot, target, .. } => {
                writes.push((*slot, *target));
            }
            ActionStep::If { then, otherwise, .. } => {
                collect_writes(draft, scope, then, writes);
                collect_writes(draft, scope, otherwise, writes);
            }
            ActionStep::Destroy { slot, .. } => {
                let layout = draft.layout(scope.frame.slots[*slot].ty());
                writes.extend((0..layout.n_states).map(|k| (*slot, Entry::State(k))));
                writes.extend((0..layout.n_discretes).map(|k| (*slot, Entry::Aux(layout.discrete(k)))));
            }
            ActionStep::Emit { .. }
            | ActionStep::Goto { .. }
            | ActionStep::Stop { .. }
            | ActionStep::Create(_) => {}
        }
    }
}
