//! Conditions that are certainly true or false where leaves are known, off their boundaries; and what a condition says of leaves.

use crate::calculus::bounds::REAL;
use crate::calculus::graph::Node;
use crate::calculus::lint::effects::guard;
use crate::calculus::lint::flowing::Given;
use crate::calculus::lint::truth::{Truth, truth};
use crate::calculus::reader::Reader;
use crate::calculus::system::{Condition, Guard, Relation, TransitionSystem};
use crate::math::Interval;

/// Whether the condition of a transition is certainly false, and stays so for a while, from what leaves of the agent itself stand for.
pub fn is_false<'s>(reader: &mut Reader<'s>, given: &Given, transition: &'s TransitionSystem) -> bool {
    // Other agents would be mistaken for those of the frame that the leaves are read in.
    let Some(guard) = guard(transition).filter(|_| transition.frame.slots.len() == 1) else { return false };
    reader.read_as(&transition.frame, given.clone(), None);
    fails(reader, guard, &guard.condition)
}

/// Whether a condition is false off its boundary. What has a memory (`rising`, `crossing`) is not asked.
fn fails(reader: &mut Reader, guard: &Guard, condition: &Condition) -> bool {
    match condition {
        Condition::Constant(value) => !value,
        Condition::Discrete(_) => truth(reader, guard, condition) == Truth::Never,
        Condition::Atom(k) => {
            let atom = &guard.atoms[*k];
            let form = reader.function(atom.value);
            atom.relation != Relation::Crossing && reader.forms.interval(form).lo > 0.0
        }
        Condition::And(terms) => terms.iter().any(|term| fails(reader, guard, term)),
        Condition::Or(terms) => terms.iter().all(|term| fails(reader, guard, term)),
        Condition::Exists(quantified) => fails(reader, guard, &quantified.body),
        Condition::Forall(_) | Condition::Rising(..) => false,
    }
}

/// Whether a condition is true off its boundary.
pub fn holds(reader: &mut Reader, guard: &Guard, condition: &Condition) -> bool {
    match condition {
        Condition::Constant(value) => *value,
        Condition::Discrete(_) => truth(reader, guard, condition) == Truth::Always,
        Condition::Atom(k) => {
            let atom = &guard.atoms[*k];
            let form = reader.function(atom.value);
            atom.relation != Relation::Crossing && reader.forms.interval(form).hi < 0.0
        }
        Condition::And(terms) => terms.iter().all(|term| holds(reader, guard, term)),
        Condition::Or(terms) => terms.iter().any(|term| holds(reader, guard, term)),
        Condition::Exists(_) | Condition::Forall(_) | Condition::Rising(..) => false,
    }
}

/// Where single states lie when a condition is true.
pub fn restrictions(reader: &mut Reader, guard: &Guard) -> Vec<(Node, Interval)> {
    let mut found: Vec<(Node, Interval)> = Vec::new();
    for term in guard.condition.conjuncts() {
        let Condition::Atom(k) = term else { continue };
        let form = reader.function(guard.atoms[*k].value);
        let Some((leaf @ Node::State { slot: 0, .. }, factor, constant)) = reader.forms.as_leaf(form) else {
            continue;
        };
        let bound = -constant / factor;
        let side = match guard.atoms[*k].relation {
            // By a reset it may be beyond.
            Relation::Crossing => continue,
            Relation::NonPositive | Relation::Negative if factor > 0.0 => Interval::new(REAL.lo, bound),
            Relation::NonPositive | Relation::Negative => Interval::new(bound, REAL.hi),
        };
        match found.iter_mut().find(|(known, _)| *known == leaf) {
            Some((_, known)) => *known = known.intersect(side).unwrap_or(*known),
            None => found.push((leaf, side)),
        }
    }
    found
}
