//! Transitions that never get their turn (HY0606), because the condition of one that comes before them, in their mode or in one around
//! it, is always true, and leads out of that mode.
//!
//! Order is by priority, then by declaration (rule 4). Agent-level transitions are not looked at: they stay armed when the mode changes.

use crate::calculus::bounds::Bounds;
use crate::calculus::lint::Warning;
use crate::calculus::lint::effects::{COMPARED_MAX, comes_before, plain_guard};
use crate::calculus::lint::truth::{Truth, truth};
use crate::calculus::reader::Reader;
use crate::calculus::system::{AgentSystem, System, TransitionSystem};

/// Looks at the transitions of every mode.
pub fn transitions(system: &System, bounds: &Bounds, found: &mut Vec<Warning>) {
    for ty in system.types.iter().filter(|ty| ty.regions.len() == 1) {
        let of_mode =
            |mode: usize| ty.modes[mode].transitions.iter().take(COMPARED_MAX).map(|&k| &ty.transitions[k]);
        let leaving = |mode: usize| {
            let all = if mode == 0 { None } else { Some(of_mode(mode)) };
            let leaving = all.into_iter().flatten();
            leaving.filter(|transition| always_leaves(system, bounds, ty, transition)).collect()
        };
        let firsts: Vec<Vec<&TransitionSystem>> = (0..ty.modes.len()).map(leaving).collect();
        for mode in 1..ty.modes.len() {
            for second in of_mode(mode) {
                let mut firsts = ty.around(mode).flat_map(|mode| &firsts[mode]);
                let first = firsts.find(|first| comes_before(system, first, second));
                found.extend(first.map(|first| Warning::Hidden {
                    label: second.label.clone(),
                    span: second.span,
                    by: first.label.clone(),
                    first: first.span,
                }));
            }
        }
    }
}

/// Whether a transition leaves its mode as soon as the mode is entered.
fn always_leaves(system: &System, bounds: &Bounds, ty: &AgentSystem, transition: &TransitionSystem) -> bool {
    let leaves =
        transition.target.is_some_and(|target| !ty.is_inside(target.mode.index(), transition.source));
    let Some(guard) = plain_guard(transition).filter(|_| leaves) else { return false };
    let mut reader = Reader::new(system, bounds, &transition.frame);
    reader.stay_in(&ty.modes, transition.source);
    truth(&mut reader, guard, &guard.condition) == Truth::Always
}
