//! Transitions that never get their turn (HY0606), because another one of their mode, or of one around it, waits for the same
//! condition, comes before them, and leaves that mode.
//!
//! The same is what stands in the text in the same words: two conditions that only have the same value in this run are no
//! slip. Those that are always true are found in `calculus::lint`.

use rustc_hash::FxHashMap;

use super::Warning;
use crate::model::context::Context;
use crate::model::evaluate::Known;
use crate::model::ir::{AgentType, ExprId, ModeId, Transition, Trigger, TypeId};

/// Looks at the transitions of every mode but the agent's own, which stay armed when the mode changes.
pub(super) fn conditions(context: &mut Context, found: &mut Vec<Warning>) {
    for number in 0..context.model.types.len() {
        let ty = TypeId::new(number);
        let mut first: FxHashMap<(ModeId, String), usize> = FxHashMap::default();
        // Beside other regions, what comes first may have to wait for what one of them writes.
        if context.model.types[ty].has_regions() {
            continue;
        }
        for k in context.in_order(ty) {
            let transition = &context.model.types[ty].transitions[k.1];
            let Some(words) = context.words_of(transition) else { continue };
            let model = &context.model.types[ty];
            let mut around = std::iter::successors(Some(transition.source), |&mode| model.modes[mode].parent);
            if let Some(by) = around.find_map(|mode| first.get(&(mode, words.clone())).copied()) {
                let by = &context.model.types[ty].transitions[by];
                found.push(Warning::Hidden {
                    label: transition.label.clone(),
                    span: transition.span,
                    by: by.label.clone(),
                    first: by.span,
                });
            } else if leaves(&context.model.types[ty], transition) {
                first.insert((transition.source, words), k.1);
            }
        }
    }
}

/// Whether a transition leads out of its mode.
fn leaves(ty: &AgentType, transition: &Transition) -> bool {
    transition.target.is_some_and(|target| !ty.is_inside(target.mode, transition.source))
}

impl Context<'_> {
    /// Numbers of the transitions that wait for a condition and whose priority is a constant, in the order in which they have their turn;
    /// with their priorities.
    fn in_order(&mut self, ty: TypeId) -> Vec<(f64, usize)> {
        let transitions = &self.model.types[ty].transitions;
        let waiting = transitions
            .iter()
            .enumerate()
            .filter(|(_, item)| item.source.index() != 0 && matches!(item.trigger, Trigger::When(_)));
        let priorities: Vec<(usize, Option<ExprId>)> = waiting.map(|(k, item)| (k, item.priority)).collect();
        let mut order: Vec<(f64, usize)> = Vec::new();
        for (k, priority) in priorities {
            let value = match priority {
                None => Some(0.0),
                Some(id) if self.facts[id.index()].closed => {
                    self.evaluator.evaluate(&self.model, id, &Known::default())
                }
                Some(_) => None,
            };
            order.extend(value.map(|value| (value, k)));
        }
        let depth = |k: usize| self.model.types[ty].modes[self.model.types[ty].transitions[k].source].depth;
        order.sort_by(|a, b| b.0.total_cmp(&a.0).then((depth(a.1), a.1).cmp(&(depth(b.1), b.1))));
        order
    }

    /// The words of its condition, without the space between them.
    fn words_of(&self, transition: &Transition) -> Option<String> {
        let Trigger::When(guard) = transition.trigger else { return None };
        let text = self.sources.text(self.model.exprs[guard].span);
        Some(text.split_whitespace().collect::<Vec<_>>().join(" "))
    }
}
