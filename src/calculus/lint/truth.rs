//! Whether a condition is always true, never, or either, as far as the bounds tell.

use crate::calculus::reader::Reader;
use crate::calculus::system::{Condition, Guard, Relation};
use crate::math::Interval;

/// What is known of a condition.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Truth {
    /// It is false at all times.
    Never,
    /// Nothing.
    Maybe,
    /// It is true at all times.
    Always,
}

/// The truth of a condition of a guard. A comparison with an agent that may be absent is never always true.
pub fn truth(reader: &mut Reader, guard: &Guard, condition: &Condition) -> Truth {
    match condition {
        Condition::Constant(true) => Truth::Always,
        Condition::Constant(false) => Truth::Never,
        Condition::Discrete(function) => {
            let node = reader.system.functions[*function].outputs[0];
            let form = reader.node(node);
            let value = reader.forms.interval(form);
            let links = reader.reads_links(node);
            verdict(value.is_true() && !value.is_whole() && !links, value.is_false())
        }
        Condition::Atom(k) => {
            let atom = &guard.atoms[*k];
            let node = reader.system.functions[atom.value].outputs[0];
            let form = reader.node(node);
            let value = reader.forms.interval(form);
            let always = holds(atom.relation, value) && !reader.reads_links(node);
            verdict(always, fails(atom.relation, value))
        }
        Condition::And(terms) => {
            let truths = terms.iter().map(|term| truth(reader, guard, term));
            truths.min().unwrap_or(Truth::Always)
        }
        Condition::Or(terms) => {
            let truths = terms.iter().map(|term| truth(reader, guard, term));
            truths.max().unwrap_or(Truth::Never)
        }
        // There may be nobody to ask.
        // Not `min` and `max`: behind a recursive call in the tail position rustc 1.95 takes them away.
        Condition::Exists(quantified) => match truth(reader, guard, &quantified.body) {
            Truth::Never => Truth::Never,
            Truth::Maybe | Truth::Always => Truth::Maybe,
        },
        Condition::Forall(quantified) => match truth(reader, guard, &quantified.body) {
            Truth::Never | Truth::Maybe => Truth::Maybe,
            Truth::Always => Truth::Always,
        },
        Condition::Rising(_, inner) => match truth(reader, guard, inner) {
            Truth::Never | Truth::Always => Truth::Never,
            Truth::Maybe => Truth::Maybe,
        },
    }
}

fn verdict(always: bool, never: bool) -> Truth {
    if always {
        Truth::Always
    } else if never {
        Truth::Never
    } else {
        Truth::Maybe
    }
}

/// Whether the comparison is true for all these values.
pub fn holds(relation: Relation, value: Interval) -> bool {
    match relation {
        Relation::NonPositive => value.hi <= 0.0,
        Relation::Negative => value.hi < 0.0,
        Relation::Crossing => false,
    }
}

/// Whether the comparison is false for all these values.
pub fn fails(relation: Relation, value: Interval) -> bool {
    match relation {
        Relation::NonPositive => value.lo > 0.0,
        Relation::Negative => value.lo >= 0.0,
        Relation::Crossing => value.lo > 0.0 || value.hi < 0.0,
    }
}
