//! Transitions into their own mode that leave their condition true (HY0607): entering the mode arms them afresh, they fire again, and so
//! on within one instant.
//!
//! Certain if the actions write nothing that the condition reads; or if every comparison, computed from what they write, is at least as
//! true as before: its g is not above what it was, or below zero whatever the state is. Not reported if the condition reads other agents, if the actions may end the run, or
//! if they write what a transition reads that has its turn before and may lead out, unless that one is certainly false then.

use rustc_hash::FxHashMap;

use crate::calculus::bounds::Bounds;
use crate::calculus::form::FormId;
use crate::calculus::graph::{Node, NodeId};
use crate::calculus::lint::Warning;
use crate::calculus::lint::certain::{is_false, restrictions};
use crate::calculus::lint::effects::{Effect, before, effect, nodes, plain_guard, read_by, reads};
use crate::calculus::reader::Reader;
use crate::calculus::system::{
    ActionStep, Condition, Frame, FunctionId, Guard, Relation, System, TransitionSystem,
};

/// Looks at every transition into its own mode.
pub fn transitions(system: &System, bounds: &Bounds, found: &mut Vec<Warning>) {
    for (number, ty) in system.types.iter().enumerate().filter(|(_, ty)| ty.regions.len() == 1) {
        for (k, transition) in ty.transitions.iter().enumerate() {
            let into_itself = transition.source != 0
                && transition.target.is_some_and(|target| target.mode.index() == transition.source);
            if into_itself && let Some(untouched) = fires_again(system, bounds, number, k) {
                let mode = ty.modes[transition.source].path.clone();
                let (label, span) = (transition.label.clone(), transition.span);
                found.push(Warning::Again { label, span, mode, untouched });
            }
        }
    }
}

/// Whether it fires again at once, and if so whether nothing that its condition reads is written.
fn fires_again(system: &System, bounds: &Bounds, number: usize, k: usize) -> Option<bool> {
    let ty = &system.types[number];
    let transition = &ty.transitions[k];
    let guard = plain_guard(transition)?;
    let effect = effect(ty, transition);
    let roots = nodes(system, guard);
    if effect.stops || reads_others(system, &roots) {
        return None;
    }
    let read = reads(system, ty, &roots);
    let untouched = effect.writes.is_disjoint(&read);
    let mut kept = Kept::new(system, bounds, transition, guard, &effect);
    if !untouched && (!effect.unclear.is_disjoint(&read) || !kept.condition(&guard.condition)) {
        return None;
    }
    let mut earlier = before(system, number, k)?.into_iter();
    let leads_out = earlier.any(|other| {
        let read = read_by(system, ty, &[other]);
        let is_own = ty.transitions.iter().any(|own| std::ptr::eq(own, other));
        let unmoved = effect.writes.is_disjoint(&read);
        let certain = is_own && effect.unclear.is_disjoint(&read);
        !(unmoved || certain && kept.keeps_false(other))
    });
    (!leads_out).then_some(untouched)
}

/// Whether a condition reads other agents, which may do something at the same instant.
fn reads_others(system: &System, roots: &[NodeId]) -> bool {
    let graph = &system.graph;
    graph.reach(roots).into_iter().any(|id| graph.node(id).slot().is_some_and(|slot| slot > 0))
}

/// Compares the condition after the actions with that before them.
struct Kept<'s> {
    guard: &'s Guard,
    /// What the guard's functions were before.
    before: FxHashMap<FunctionId, FormId>,
    /// What the actions write.
    written: FxHashMap<Node, FormId>,
    frame: &'s Frame,
    after: Reader<'s>,
}

impl<'s> Kept<'s> {
    fn new(
        system: &'s System,
        bounds: &'s Bounds,
        transition: &'s TransitionSystem,
        guard: &'s Guard,
        effect: &Effect,
    ) -> Self {
        let frame = &transition.frame;
        let mut reader = Reader::new(system, bounds, frame);
        for (leaf, interval) in restrictions(&mut Reader::new(system, bounds, frame), guard) {
            reader.bound(leaf, interval);
        }
        let before = guard.functions().into_iter().map(|function| (function, reader.function(function)));
        let before = before.collect();
        let mut written = FxHashMap::default();
        for step in &effect.own.steps {
            let ActionStep::Assign { slot: 0, target, value, .. } = step else { continue };
            written.insert(target.leaf(0), reader.function(*value));
        }
        reader.read_as(frame, written.clone(), None);
        Self { guard, before, written, frame, after: reader }
    }

    /// Whether the condition of another transition of the agent is certainly false after the actions.
    fn keeps_false(&mut self, other: &'s TransitionSystem) -> bool {
        let is_false = is_false(&mut self.after, &self.written, other);
        self.after.read_as(self.frame, self.written.clone(), None);
        is_false
    }

    /// Whether the condition is true after the actions if it was true before.
    fn condition(&mut self, condition: &Condition) -> bool {
        match condition {
            Condition::Constant(value) => *value,
            Condition::Discrete(function) => {
                let after = self.after.function(*function);
                self.before[function] == after || self.after.forms.interval(after).is_true()
            }
            Condition::Atom(k) => {
                let atom = &self.guard.atoms[*k];
                self.atom(atom.relation, atom.value)
            }
            Condition::And(terms) | Condition::Or(terms) => terms.iter().all(|term| self.condition(term)),
            Condition::Exists(quantified) | Condition::Forall(quantified) => self.condition(&quantified.body),
            Condition::Rising(..) => false,
        }
    }

    fn atom(&mut self, relation: Relation, value: FunctionId) -> bool {
        let (before, after) = (self.before[&value], self.after.function(value));
        let forms = &mut self.after.forms;
        // On its boundary the rates decide (rule 3), and may hold it false.
        if forms.interval(after).hi < 0.0 {
            return relation != Relation::Crossing;
        }
        let change = forms.plus(after, -1.0, before);
        relation != Relation::Crossing && change.is_some_and(|change| forms.interval(change).hi <= 0.0)
    }
}
