//! Quantifiers without `other` whose body is settled for the agent itself (HY0611): `exists o in Car: dist(self, o) <= 1` is always
//! true, because every car is near itself.

use rustc_hash::FxHashMap;

use crate::base::Span;
use crate::calculus::bounds::Bounds;
use crate::calculus::lint::Warning;
use crate::calculus::lint::effects::guard;
use crate::calculus::lint::truth::{Truth, truth};
use crate::calculus::reader::Reader;
use crate::calculus::system::{Condition, Frame, Guard, Quantified, System};

/// Looks at the guards and claims of every agent type.
pub fn conditions(system: &System, bounds: &Bounds, found: &mut Vec<Warning>) {
    for ty in &system.types {
        for transition in &ty.transitions {
            if let Some(guard) = guard(transition) {
                let (frame, span) = (&transition.frame, transition.span);
                Asker { system, bounds, frame, guard, span, negated: false }.look_at(&guard.condition, found);
            }
        }
        for claim in ty.modes.iter().flat_map(|mode| &mode.claims) {
            let (guard, span) = (&claim.violation, claim.span);
            Asker { system, bounds, frame: &claim.frame, guard, span, negated: true }
                .look_at(&guard.condition, found);
        }
    }
}

/// A condition that an agent asks.
struct Asker<'s> {
    system: &'s System,
    bounds: &'s Bounds,
    frame: &'s Frame,
    guard: &'s Guard,
    span: Span,
    /// The text says the opposite: a claim is kept as what violates it.
    negated: bool,
}

impl Asker<'_> {
    fn look_at(&self, condition: &Condition, found: &mut Vec<Warning>) {
        match condition {
            Condition::Exists(quantified) => self.quantified(quantified, Truth::Always, found),
            Condition::Forall(quantified) => self.quantified(quantified, Truth::Never, found),
            Condition::And(terms) | Condition::Or(terms) => {
                terms.iter().for_each(|term| self.look_at(term, found));
            }
            Condition::Rising(_, inner) => self.look_at(inner, found),
            Condition::Constant(_) | Condition::Discrete(_) | Condition::Atom(_) => {}
        }
    }

    /// A quantifier, and with which truth of its body for the agent itself it is settled.
    fn quantified(&self, quantified: &Quantified, settled: Truth, found: &mut Vec<Warning>) {
        let Quantified { slot, ty, other, body, .. } = quantified;
        self.look_at(body, found);
        if *other || self.frame.slots[0].ty() != *ty {
            return;
        }
        let truth_for = |renamed: Option<(usize, usize)>| {
            let mut reader = Reader::new(self.system, self.bounds, self.frame);
            reader.read_as(self.frame, FxHashMap::default(), renamed);
            truth(&mut reader, self.guard, body)
        };
        // What is settled for everybody is no matter of oneself.
        if truth_for(Some((*slot, 0))) != settled || truth_for(None) == settled {
            return;
        }
        found.push(Warning::Oneself {
            name: self.frame.slots[*slot].name().to_string(),
            ty: self.system.types[*ty].name.clone(),
            span: first_atom(self.guard, body).unwrap_or(self.span),
            holds: (settled == Truth::Always) != self.negated,
        });
    }
}

/// Where the first comparison of a condition stands.
pub fn first_atom(guard: &Guard, condition: &Condition) -> Option<Span> {
    match condition {
        Condition::Atom(k) => Some(guard.atoms[*k].span),
        Condition::And(terms) | Condition::Or(terms) => terms.iter().find_map(|term| first_atom(guard, term)),
        Condition::Exists(quantified) | Condition::Forall(quantified) => first_atom(guard, &quantified.body),
        Condition::Rising(_, inner) => first_atom(guard, inner),
        Condition::Constant(_) | Condition::Discrete(_) => None,
    }
}
