//! How near two agents must be for a condition over both to be true: the ranges by which pairs are listed instead of enumerated.
//!
//! In: a system. Out: the same, with a [`Near`] for every two states x of the one agent and y of the other for which the condition
//! is certainly false (of `forall`: true) wherever |x - y| > D. All of it is read as affine forms with y + d in the place of x; what
//! only depends on x - y then only depends on d, however it is written. Such a D is one for which the condition is settled both
//! for d in [D, oo) and for d in (-oo, -D], by intervals; the larger D, the easier, so the least one is found by bisection.
//!
//! Of `nearest` that depends on the link: see [`Keys`]. Who is farther away than the agent to which it leads does not matter.
//!
//! Everything else is unbounded: other states, rates, aggregates. Parameters and discrete variables are in the hull of what they
//! have in this population and of what actions give them; the time ends with the run. Boundaries count as true: an
//! event is found where g = 0.

use rustc_hash::FxHashMap;

use crate::calculus::bounds::{Bounds, REAL, TIME};
use crate::calculus::form::{Form, FormId};
use crate::calculus::graph::Node;
use crate::calculus::growth;
use crate::calculus::reader::Reader;
use crate::calculus::system::{
    AgentSystem, Atom, Condition, Entry, Frame, FunctionId, Guard, Keys, LinkUpdate, Near, Quantified,
    Relation, Slot, System, Trigger, Whither,
};
use crate::math::Interval;

/// A condition of more comparisons is not looked at.
const ATOMS_MAX: usize = 1000;
/// How many pairs of states are tried for one condition.
const CANDIDATES_MAX: usize = 16;
/// A range beyond this one is none.
const FAR: f64 = 1e100;
/// How much larger than the least that intervals can prove a range may be, relatively.
const PRECISION: f64 = 1e-9;
/// What functions can be.
type Values<'a> = dyn Fn(FunctionId) -> Interval + 'a;

/// The difference d: a leaf that no frame has.
const GAP: Node = Node::State { slot: u32::MAX, column: 0 };

/// Fills in every list of [`Near`].
pub fn ranges(mut system: System) -> System {
    if !has_pairs(&system) {
        return system;
    }
    let bounds = growth::bounds_of_population(&system);
    let mut interactions = std::mem::take(&mut system.interactions);
    for pair in interactions.iter_mut().flat_map(|interaction| &mut interaction.transitions) {
        let transition = &mut pair.transition;
        let Some(guard) = guard_of(&mut transition.trigger) else { continue };
        let frame = &transition.frame;
        let asker = Asker { system: &system, bounds: &bounds, frame, atoms: &guard.atoms };
        pair.near = asker.near(&guard.condition, 1, Settled::False);
        asker.quantifiers(&mut guard.condition);
        aggregates(&system, &bounds, &mut transition.frame);
    }
    system.interactions = interactions;
    for number in 0..system.types.len() {
        let mut transitions = std::mem::take(&mut system.types[number].transitions);
        let mut modes = std::mem::take(&mut system.types[number].modes);
        let own = transitions.iter_mut().filter_map(|transition| {
            guard_of(&mut transition.trigger).map(|guard| (&transition.frame, guard))
        });
        let claims = modes.iter_mut().flat_map(|mode| &mut mode.claims);
        for (frame, guard) in own.chain(claims.map(|claim| (&claim.frame, &mut claim.violation))) {
            Asker { system: &system, bounds: &bounds, frame, atoms: &guard.atoms }
                .quantifiers(&mut guard.condition);
        }
        let frames = transitions.iter_mut().map(|transition| &mut transition.frame);
        let of_claims = modes.iter_mut().flat_map(|mode| &mut mode.claims).map(|claim| &mut claim.frame);
        frames.chain(of_claims).for_each(|frame| aggregates(&system, &bounds, frame));
        (system.types[number].transitions, system.types[number].modes) = (transitions, modes);
        let mut links = std::mem::take(&mut system.types[number].links);
        let updates = links.iter_mut().flat_map(|link| &mut link.updates);
        updates.for_each(|update| nearest(&system, &bounds, update));
        system.types[number].links = links;
    }
    system
}

/// The lists of the aggregates of a frame that do not stand in one another.
fn aggregates(system: &System, bounds: &Bounds, frame: &mut Frame) {
    let ranges = frame.folds.iter().map(|fold| {
        let asker = Asker { system, bounds, frame, atoms: &fold.filter.atoms };
        let stands_alone = fold.around.is_empty();
        let near = || asker.near(&fold.filter.condition, fold.range.slot, Settled::False);
        stands_alone.then(near).unwrap_or_default()
    });
    let ranges: Vec<Vec<Near>> = ranges.collect();
    frame.folds.iter_mut().zip(ranges).for_each(|(fold, near)| fold.near = near);
}

/// The ranges of a link to whoever is nearest.
fn nearest(system: &System, bounds: &Bounds, update: &mut LinkUpdate) {
    let Whither::Nearest { range, filter, key, near, keys } = &mut update.target else { return };
    let asker = Asker { system, bounds, frame: &update.frame, atoms: &filter.atoms };
    (*near, *keys) = asker.nearest(&filter.condition, *key, range.slot).into_iter().unzip();
    let mut conditions = vec![&mut update.stale.condition];
    while let Some(condition) = conditions.pop() {
        match condition {
            Condition::And(terms) | Condition::Or(terms) => conditions.extend(terms),
            Condition::Exists(better) if better.slot == range.slot => better.near.clone_from(near),
            _ => {}
        }
    }
}

/// Whether any condition is over more than one agent that is not named by a link.
fn has_pairs(system: &System) -> bool {
    let binds = |frame: &Frame| frame.slots.iter().skip(1).any(|slot| matches!(slot, Slot::Root { .. }));
    let of_type = |ty: &AgentSystem| {
        let claims = ty.modes.iter().flat_map(|mode| &mode.claims).map(|claim| &claim.frame);
        claims.chain(ty.transitions.iter().map(|transition| &transition.frame)).any(binds)
    };
    let has_links = |ty: &AgentSystem| ty.links.iter().any(|link| !link.updates.is_empty());
    !system.interactions.is_empty() || system.types.iter().any(|ty| of_type(ty) || has_links(ty))
}

fn guard_of(trigger: &mut Trigger) -> Option<&mut Guard> {
    match trigger {
        Trigger::When(guard) => Some(guard),
        Trigger::After { guard, .. } | Trigger::Every { guard, .. } => guard.as_mut(),
        Trigger::On { guard, .. } | Trigger::Rate { guard, .. } | Trigger::Chance { guard, .. } => {
            guard.as_mut()
        }
    }
}

/// What a condition is certain to be.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Settled {
    False,
    True,
}

/// The comparisons of one guard, and whom they are about.
struct Asker<'s> {
    system: &'s System,
    bounds: &'s Bounds,
    frame: &'s Frame,
    atoms: &'s [Atom],
}

impl Asker<'_> {
    /// The lists of all quantifiers in a condition.
    fn quantifiers(&self, condition: &mut Condition) {
        let (quantified, far) = match condition {
            Condition::Exists(quantified) => (quantified, Settled::False),
            Condition::Forall(quantified) => (quantified, Settled::True),
            Condition::And(terms) | Condition::Or(terms) => {
                return terms.iter_mut().for_each(|term| self.quantifiers(term));
            }
            Condition::Rising(_, inner) => return self.quantifiers(inner),
            Condition::Constant(_) | Condition::Discrete(_) | Condition::Atom(_) => return,
        };
        let Quantified { slot, body, near, .. } = quantified;
        *near = self.near(body, *slot, far);
        self.quantifiers(body);
    }

    /// The ranges beyond which a condition over the agents in slots 0 and `slot` is settled.
    fn near(&self, condition: &Condition, slot: usize, far: Settled) -> Vec<Near> {
        if self.atoms.len() > ATOMS_MAX {
            return Vec::new();
        }
        let mut functions = Vec::new();
        self.functions(condition, &mut functions);
        let candidates = self.candidates(&functions, slot);
        let ranges = candidates.into_iter().filter_map(|(own, other)| {
            let within = self.range(condition, &functions, [own, other], slot, far)?;
            Some(Near { own, other, within })
        });
        ranges.collect()
    }

    /// How near an agent must be whose key is less than some number, if `filter` holds for it.
    fn nearest(&self, filter: &Condition, key: FunctionId, slot: usize) -> Vec<(Near, Keys)> {
        let graph = &self.system.graph;
        let read = graph.reach(&self.system.functions[key].outputs);
        let mut slots = read.iter().filter_map(|&id| graph.node(id).slot());
        if self.atoms.len() > ATOMS_MAX || !slots.all(|read| read == 0 || read == slot) {
            return Vec::new();
        }
        let mut functions = vec![key];
        self.functions(filter, &mut functions);
        let candidates = self.candidates(&functions, slot);
        let ranges = candidates.into_iter().filter_map(|(own, other)| {
            let within = self.range(filter, &functions, [own, other], slot, Settled::False);
            let within = within.unwrap_or(f64::INFINITY);
            let keys = self.apart(&functions, [own, other], slot, &|values| {
                let excluded = self.is_settled(filter, Settled::False, values);
                if excluded { f64::INFINITY } else { values(key).lo }
            });
            let says = within.is_finite() || !keys.is_empty();
            says.then_some((Near { own, other, within }, keys))
        });
        ranges.collect()
    }

    /// The least of something over all who are so far apart in states [own, other], for each distance.
    fn apart(
        &self,
        functions: &[FunctionId],
        [own, other]: [Entry; 2],
        slot: usize,
        least: &dyn Fn(&Values<'_>) -> f64,
    ) -> Keys {
        let (reader, forms) = self.gap_reader(functions, [own, other], slot);
        Keys::new(|within| {
            let sides = [Interval::new(within, REAL.hi), Interval::new(REAL.lo, -within)];
            let of_side = sides.map(|side| {
                let narrowed = reader.forms.narrowed(GAP, side);
                least(&|function| narrowed.interval(forms[&function]))
            });
            let least = of_side[0].min(of_side[1]);
            if least < -FAR { f64::NEG_INFINITY } else { least }
        })
    }

    /// Everything that a condition computes.
    fn functions(&self, condition: &Condition, found: &mut Vec<FunctionId>) {
        match condition {
            Condition::Constant(_) => {}
            Condition::Discrete(function) => found.push(*function),
            Condition::Atom(k) => found.push(self.atoms[*k].value),
            Condition::And(terms) | Condition::Or(terms) => {
                terms.iter().for_each(|term| self.functions(term, found));
            }
            Condition::Exists(quantified) | Condition::Forall(quantified) => {
                self.functions(&quantified.body, found);
            }
            Condition::Rising(_, inner) => self.functions(inner, found),
        }
    }

    /// The pairs of states, or of columns, of which some sum has the difference, in order.
    fn candidates(&self, functions: &[FunctionId], slot: usize) -> Vec<(Entry, Entry)> {
        let mut reader = self.reader(functions, None);
        functions.iter().for_each(|&function| {
            reader.function(function);
        });
        let states = |form: &Form, of: usize| {
            let leaves = form.terms.iter().map(|&(term, factor)| (reader.forms.leaf_of(term), factor));
            let states = leaves.filter_map(|(leaf, factor)| match leaf {
                Some(Node::State { slot, column }) if slot as usize == of => {
                    Some((Entry::State(column as usize), factor))
                }
                Some(Node::Aux { slot, column }) if slot as usize == of => {
                    let layout = &self.system.types[self.frame.slots[of].ty()].layout;
                    let is_variable = (layout.param(0)..layout.link(0)).contains(&(column as usize));
                    is_variable.then_some((Entry::Aux(column as usize), factor))
                }
                _ => None,
            });
            states.collect::<Vec<_>>()
        };
        let mut found: Vec<(Entry, Entry)> = Vec::new();
        for form in reader.forms.all() {
            let others = states(form, slot);
            for (own, factor) in states(form, 0) {
                let opposite = others.iter().filter(|(_, other)| *other == -factor);
                found.extend(opposite.map(|&(other, _)| (own, other)));
            }
        }
        found.sort_unstable();
        found.dedup();
        found.truncate(CANDIDATES_MAX);
        found
    }

    /// A reader of all that these functions read; with a `gap`, the first leaf is the second one and d.
    fn reader(&self, functions: &[FunctionId], gap: Option<[Node; 2]>) -> Reader<'_> {
        let mut reader = Reader::new(self.system, self.bounds, self.frame);
        let roots: Vec<_> =
            functions.iter().map(|&function| self.system.functions[function].outputs[0]).collect();
        let mut given: FxHashMap<Node, FormId> = FxHashMap::default();
        let run = Interval::new(0.0, self.system.run.until.unwrap_or(TIME.hi));
        for id in self.system.graph.reach(&roots) {
            let node = self.system.graph.node(id);
            let known = match node.slot().map(|slot| &self.frame.slots[slot]) {
                None if node == Node::Time => run,
                // An agent that is not there reads as NaN.
                Some(Slot::Link { .. }) => Interval::WHOLE,
                Some(Slot::Root { .. }) => self.bounds.leaf(self.frame, node),
                None | Some(Slot::Fold { .. }) => continue,
            };
            let form = match known {
                known if known.is_point() => reader.forms.constant(known.lo),
                known => reader.forms.leaf(node, known),
            };
            given.insert(node, form);
        }
        if let Some([own, other]) = gap {
            let of_other = match other {
                Node::State { .. } => REAL,
                column => self.bounds.leaf(self.frame, column),
            };
            let (other, gap) = (reader.forms.leaf(other, of_other), reader.forms.leaf(GAP, REAL));
            let sum = reader.forms.plus(other, 1.0, gap).expect("both are finite");
            given.insert(own, sum);
        }
        reader.read_as(self.frame, given, None);
        reader
    }

    /// The least D that can be shown, for states [own, other]; none if there is none.
    fn range(
        &self,
        condition: &Condition,
        functions: &[FunctionId],
        [own, other]: [Entry; 2],
        slot: usize,
        far: Settled,
    ) -> Option<f64> {
        let (reader, forms) = self.gap_reader(functions, [own, other], slot);
        least(|within| {
            let sides = [Interval::new(within, REAL.hi), Interval::new(REAL.lo, -within)];
            sides.into_iter().all(|side| {
                let narrowed = reader.forms.narrowed(GAP, side);
                self.is_settled(condition, far, &|function| narrowed.interval(forms[&function]))
            })
        })
    }

    /// A reader with the forms of some functions, in which [own, other] have the difference d.
    fn gap_reader(
        &self,
        functions: &[FunctionId],
        [own, other]: [Entry; 2],
        slot: usize,
    ) -> (Reader<'_>, FxHashMap<FunctionId, FormId>) {
        let mut reader = self.reader(functions, Some([own.leaf(0), other.leaf(slot)]));
        let forms = functions.iter().map(|&function| (function, reader.function(function))).collect();
        (reader, forms)
    }

    /// Whether a condition certainly is what it is to be, for all values of its functions.
    fn is_settled(&self, condition: &Condition, settled: Settled, values: &Values<'_>) -> bool {
        let of = |condition: &Condition| self.is_settled(condition, settled, values);
        match (condition, settled) {
            (Condition::Constant(value), _) => *value == (settled == Settled::True),
            (Condition::Discrete(function), Settled::False) => values(*function).is_false(),
            (Condition::Discrete(function), Settled::True) => values(*function).is_true(),
            (Condition::Atom(k), _) => {
                let atom = &self.atoms[*k];
                let g = values(atom.value);
                match (atom.relation, settled) {
                    (Relation::NonPositive | Relation::Negative, Settled::False) => g.lo > 0.0,
                    (Relation::NonPositive | Relation::Negative, Settled::True) => g.hi < 0.0,
                    (Relation::Crossing, Settled::False) => !g.contains_zero(),
                    (Relation::Crossing, Settled::True) => false,
                }
            }
            (Condition::And(terms), Settled::True) | (Condition::Or(terms), Settled::False) => {
                terms.iter().all(of)
            }
            (Condition::And(terms), Settled::False) | (Condition::Or(terms), Settled::True) => {
                terms.iter().any(of)
            }
            (Condition::Exists(quantified), Settled::False)
            | (Condition::Forall(quantified), Settled::True) => of(&quantified.body),
            // There may be nobody to ask.
            (Condition::Exists(_), Settled::True) | (Condition::Forall(_), Settled::False) => false,
            (Condition::Rising(_, inner), Settled::False) => of(inner),
            (Condition::Rising(..), Settled::True) => false,
        }
    }
}

/// A number for which `beyond` holds, hardly larger than the least one of such; none if there is none up to [`FAR`].
///
/// What holds for a number must hold for every larger one. Positive floating-point numbers are ordered as their bits are, so
/// halving these finds small and large numbers equally fast.
fn least(beyond: impl Fn(f64) -> bool) -> Option<f64> {
    if !beyond(FAR) {
        return None;
    }
    let nothing = f64::from_bits(1);
    if beyond(nothing) {
        return Some(0.0);
    }
    let (mut lo, mut hi) = (nothing.to_bits(), FAR.to_bits());
    while f64::from_bits(hi) - f64::from_bits(lo) > PRECISION * f64::from_bits(hi) && hi - lo > 1 {
        let mid = lo + (hi - lo) / 2;
        if beyond(f64::from_bits(mid)) { hi = mid } else { lo = mid }
    }
    // Constants of forms are rounded.
    Some(f64::from_bits(hi) * (1.0 + PRECISION))
}
