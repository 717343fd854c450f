//! Two transitions that lead back and forth between two modes, with conditions on opposite sides of one quantity.
//!
//! If both hold in a region (`x >= 19` one way, `x <= 20` back) the mode changes without end within one instant (HY0609). If they
//! share their boundary alone, that is fine where the flow goes on through it (rule 3); where the flows of both modes lead back to it, they
//! chatter (HY0610). Not reported if a transition writes what either condition reads, or what another one reads that may lead out.

use rustc_hash::{FxHashMap, FxHashSet};

use crate::calculus::bounds::Bounds;
use crate::calculus::form::{Form, FormId, Forms};
use crate::calculus::graph::Node;
use crate::calculus::lint::Warning;
use crate::calculus::lint::effects::{before, effect, plain_guard, read_by, reads};
use crate::calculus::lint::flowing::{add_rates, derivatives};
use crate::calculus::reader::Reader;
use crate::calculus::system::{Atom, Condition, Entry, Frame, Guard, Quantified, System, TransitionSystem};

/// How many transitions from one mode to another are compared with those back.
const COMPARED_MAX: usize = 32;

/// Looks at every two modes with transitions both ways.
pub fn transitions(system: &System, bounds: &Bounds, found: &mut Vec<Warning>) {
    let of_these = bounds.with_params(system);
    for (number, ty) in system.types.iter().enumerate().filter(|(_, ty)| ty.regions.len() == 1) {
        let mut between: FxHashMap<(usize, usize), Vec<usize>> = FxHashMap::default();
        for (k, transition) in ty.transitions.iter().enumerate() {
            if let Some(target) = transition.target.map(|target| target.mode.index())
                && transition.source != 0
                && !ty.is_inside(target, transition.source)
                && !ty.is_inside(transition.source, target)
            {
                between.entry((transition.source, target)).or_default().push(k);
            }
        }
        for (k, transition) in ty.transitions.iter().enumerate() {
            let Some(target) = transition.target else { continue };
            let back = between.get(&(target.mode.index(), transition.source));
            for &back in back.into_iter().flatten().filter(|&&back| back > k).take(COMPARED_MAX) {
                found.extend(Loop { system, number, there: k, back }.warning(bounds, &of_these));
            }
        }
    }
}

/// A transition, and one from its target back to its source.
struct Loop<'s> {
    system: &'s System,
    number: usize,
    there: usize,
    back: usize,
}

/// A comparison that makes its whole condition true by itself: for itself, for one agent, or for all.
#[derive(Clone, Copy)]
struct Side<'s> {
    atom: &'s Atom,
    frame: &'s Frame,
    asked: Asked<'s>,
}

#[derive(Clone, Copy)]
enum Asked<'s> {
    Itself,
    One(&'s Quantified),
    All(&'s Quantified),
}

impl<'s> Loop<'s> {
    fn warning(&self, bounds: &Bounds, of_these: &Bounds) -> Option<Warning> {
        let [there, back] = self.transitions();
        let (first, second) = (sides(there), sides(back));
        for (a, b) in first.iter().flat_map(|a| second.iter().map(move |b| (a, b))) {
            let Some(overlap) = self.overlap(bounds, a, b) else { continue };
            if self.changes_something(a, b) {
                continue;
            }
            let labels = [there.label.clone(), back.label.clone()];
            let spans = [a.atom.span, b.atom.span];
            match overlap {
                Overlap::Region => return Some(Warning::BothTrue { labels, spans }),
                Overlap::Boundary
                    if self.leads_back(of_these, a, back) && self.leads_back(of_these, b, there) =>
                {
                    return Some(Warning::Chattering { labels, spans });
                }
                Overlap::Boundary => {}
            }
        }
        None
    }

    fn transitions(&self) -> [&'s TransitionSystem; 2] {
        let transitions = &self.system.types[self.number].transitions;
        [&transitions[self.there], &transitions[self.back]]
    }

    /// Whether the two comparisons are of one quantity, on opposite sides, and where both are true.
    fn overlap(&self, bounds: &Bounds, a: &Side<'s>, b: &Side<'s>) -> Option<Overlap> {
        let renamed = alike(a.asked, b.asked)?;
        let mut reader = Reader::new(self.system, bounds, a.frame);
        let first = reader.function(a.atom.value);
        reader.read_as(b.frame, FxHashMap::default(), renamed);
        let second = reader.function(b.atom.value);
        overlap(&reader.forms, first, second)
    }

    /// Whether one of the transitions writes what the two comparisons read, or what may lead out of the loop.
    fn changes_something(&self, a: &Side, b: &Side) -> bool {
        let ty = &self.system.types[self.number];
        let transitions = self.transitions();
        let effects = transitions.map(|transition| effect(ty, transition));
        let writes: FxHashSet<Entry> = effects.iter().flat_map(|effect| effect.writes.clone()).collect();
        let compared = [a, b].map(|side| self.system.functions[side.atom.value].outputs[0]);
        let leads_out = [self.there, self.back].iter().any(|&k| {
            before(self.system, self.number, k)
                .is_none_or(|others| !writes.is_disjoint(&read_by(self.system, ty, &others)))
        });
        leads_out
            || effects.iter().any(|effect| effect.stops)
            || !writes.is_disjoint(&reads(self.system, ty, &compared))
    }

    /// Whether in the mode that `side` leads to, from which `back` starts, the flow makes the comparison of `side` false again.
    fn leads_back(&self, bounds: &Bounds, side: &Side<'s>, back: &TransitionSystem) -> bool {
        let ty = &self.system.types[self.number];
        let Some(flow) = &ty.modes[back.source].flow else { return false };
        let mut reader = Reader::new(self.system, bounds, side.frame);
        let g = reader.function(side.atom.value);
        let mut given = FxHashMap::default();
        if let Some((leaf @ Node::State { .. }, factor, constant)) = reader.forms.as_leaf(g) {
            given.insert(leaf, reader.forms.constant(-constant / factor));
        }
        if !add_rates(&mut reader, flow, &mut given) {
            return false;
        }
        let [_, rate, _] = derivatives(&mut reader, side.frame, side.atom, &given);
        reader.forms.interval(rate).lo > 0.0
    }
}

/// Where two opposite comparisons are both true.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Overlap {
    /// In a region.
    Region,
    /// On their boundary, which is one.
    Boundary,
}

/// The comparisons that alone make the condition of a transition true.
fn sides(transition: &TransitionSystem) -> Vec<Side<'_>> {
    let Some(guard) = plain_guard(transition) else { return Vec::new() };
    let mut found = Vec::new();
    each_alone(guard, &guard.condition, Asked::Itself, &mut |atom, asked| {
        found.push(Side { atom, frame: &transition.frame, asked });
    });
    found
}

fn each_alone<'s>(
    guard: &'s Guard,
    condition: &'s Condition,
    asked: Asked<'s>,
    each: &mut dyn FnMut(&'s Atom, Asked<'s>),
) {
    match (condition, asked) {
        (Condition::Atom(k), _) => each(&guard.atoms[*k], asked),
        (Condition::Or(terms), _) => terms.iter().for_each(|term| each_alone(guard, term, asked, each)),
        (Condition::Exists(quantified), Asked::Itself) => {
            each_alone(guard, &quantified.body, Asked::One(quantified), each);
        }
        (Condition::Forall(quantified), Asked::Itself) => {
            each_alone(guard, &quantified.body, Asked::All(quantified), each);
        }
        (
            Condition::Constant(_)
            | Condition::Discrete(_)
            | Condition::And(_)
            | Condition::Rising(..)
            | Condition::Exists(_)
            | Condition::Forall(_),
            _,
        ) => {}
    }
}

/// Whether both are asked of the same agents, so that one is true where the other becomes true; with the slot of the second to be
/// read as that of the first.
fn alike(a: Asked, b: Asked) -> Option<Option<(usize, usize)>> {
    match (a, b) {
        (Asked::Itself, Asked::Itself) => Some(None),
        (Asked::One(a), Asked::One(b)) | (Asked::One(a), Asked::All(b)) | (Asked::All(a), Asked::One(b)) => {
            (a.ty == b.ty && a.other == b.other).then_some(Some((b.slot, a.slot)))
        }
        (Asked::All(_), Asked::All(_)) | (Asked::Itself, _) | (_, Asked::Itself) => None,
    }
}

/// Where `first <= 0` and `second <= 0` are both true, if the two are opposite: `second = c - k first` with k > 0.
fn overlap(forms: &Forms, first: FormId, second: FormId) -> Option<Overlap> {
    let (Form { terms: a, constant: p }, Form { terms: b, constant: q }) =
        (forms.get(first), forms.get(second));
    let k = -b.first()?.1 / a.first()?.1;
    let opposite = |((s, x), (t, y)): (&(usize, f64), &(usize, f64))| s == t && near(*y, -k * x);
    if k <= 0.0 || a.len() != b.len() || !a.iter().zip(b).all(opposite) {
        return None;
    }
    // first <= 0 and c <= k first
    if near(*q, -k * p) {
        return Some(Overlap::Boundary);
    }
    (q + k * p < 0.0).then_some(Overlap::Region)
}

/// Equal but for rounding.
fn near(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-12 * a.abs().max(b.abs())
}
