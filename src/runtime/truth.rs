//! The truth of conditions: from the truths of their atoms, or straight from the rows of the present instant.

use crate::codegen::kernel::Kernel;
use crate::codegen::program::{Condition, Frame, FunctionId, Guard, Quantified, Relation};
use crate::runtime::fold::{self, Folded, Leaves};
use crate::runtime::guards::{Guards, allowed};
use crate::runtime::population::{Agents, Slots};
use crate::runtime::present::{Depth, Present, depth_read};

/// Which truth of an atom that changes at the present instant counts. A condition holds in an instant if it does on
/// either side: `x >= 0 and x < 0` never does, though each of its comparisons is true at or just after the zero of x.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// That at the instant: on its boundary `<=` is true and `<` false, a crossing is true at its zero.
    At,
    /// That just after it.
    After,
}

/// Where a condition stands, and when it is asked.
#[derive(Clone, Copy)]
struct At {
    /// The instance it belongs to.
    instance: u32,
    /// The place of its first comparison: it is the guard's, or an aggregate's.
    base: usize,
    /// When.
    side: Side,
}

/// Reads the truths of atoms.
#[derive(Clone, Copy)]
pub struct Truths<'a, 'p> {
    /// The agents.
    pub agents: &'a Agents<'p>,
    /// The guards.
    pub guards: &'a Guards<'p>,
    /// Rows for discrete tests (auxiliary columns only).
    pub present: &'a Present,
}

impl<'p> Truths<'_, 'p> {
    /// Whether the condition of an instance holds at the present instant or just after it.
    pub fn holds_now(&self, instance: u32) -> bool {
        self.holds(instance, Side::At) || self.holds(instance, Side::After)
    }

    /// Whether the condition of an instance holds on one side of the present instant.
    pub fn holds(&self, instance: u32, side: Side) -> bool {
        match self.guards.definition(instance).guard {
            None => true,
            Some(guard) => {
                let at = At { instance, base: self.guards.definition(instance).base, side };
                let mut slots = self.guards.slots(self.agents, instance);
                self.condition(at, &guard.condition, &mut slots)
            }
        }
    }

    /// Whether a part of an instance's condition holds just after the present instant, with these bindings.
    pub fn part(&self, instance: u32, condition: &Condition, slots: &mut Slots) -> bool {
        let base = self.guards.definition(instance).base;
        self.condition(At { instance, base, side: Side::After }, condition, slots)
    }

    fn condition(&self, at: At, condition: &Condition, slots: &mut Slots) -> bool {
        match condition {
            Condition::Constant(truth) => *truth,
            Condition::Discrete(function) => self.discrete(at, *function, slots),
            Condition::Atom(atom) => {
                let atom = at.base + atom;
                let index = self.guards.atom_index(self.agents, at.instance, atom, slots);
                self.atom(at, self.guards.definition(at.instance).comparisons[atom].relation, index)
            }
            Condition::And(all) => cheap_first(all).all(|condition| self.condition(at, condition, slots)),
            Condition::Or(all) => cheap_first(all).any(|condition| self.condition(at, condition, slots)),
            Condition::Exists(quantified) => self.first(at, quantified, slots, true).is_some(),
            Condition::Forall(quantified) => self.first(at, quantified, slots, false).is_none(),
            Condition::Rising(number, condition) => {
                self.guards.rising[self.guards.rising_index(self.agents, at.instance, *number, slots)]
                    && self.condition(at, condition, slots)
            }
        }
    }

    fn atom(&self, at: At, relation: Relation, index: usize) -> bool {
        let state = &self.guards.atoms[index];
        if let (Some(leap), true) = (state.leap, state.rooted)
            && at.side == Side::At
            && relation != Relation::Crossing
        {
            return leap.at;
        }
        match (relation, at.side) {
            (Relation::Crossing, side) => side == Side::At && state.touched,
            (Relation::NonPositive, Side::At) => state.truth || state.touched,
            (Relation::Negative, Side::At) => state.truth && !state.rooted,
            (Relation::NonPositive | Relation::Negative, Side::After) => state.truth,
        }
    }

    /// A test of auxiliary columns, perhaps of aggregates with the members that they have on that side.
    fn discrete(&self, at: At, function: FunctionId, slots: &Slots) -> bool {
        let kernel = self.agents.program.kernel(function);
        let holds = |folds: &[Folded<'_>]| {
            let time = self.present.time;
            let row = |agent: usize| self.present.view(self.agents, agent);
            let leaves = fold::leaves(self.agents.program, folds, Depth::States, time, &row);
            let mut out = [0.0];
            kernel.eval(&fold::views(slots, &leaves, &row), time, &mut out);
            out[0] != 0.0 && !out[0].is_nan()
        };
        holds(&self.gather(at.instance, kernel, slots, at.side))
    }

    /// The aggregates that a kernel of an instance reads, with the members that they have on one side of the instant.
    pub fn gather(&self, instance: u32, kernel: &Kernel, slots: &Slots, side: Side) -> Vec<Folded<'p>> {
        let definition = self.guards.definition(instance);
        if definition.folds.is_empty() {
            return Vec::new();
        }
        let roots = self.guards.roots(instance);
        let frame = definition.frame;
        let told = (frame, Some(&definition.shared));
        let among = |number: usize| {
            let candidates = self.guards.candidates_at(instance, frame.folds[number].range.slot)?;
            Some(candidates.iter().map(|candidate| candidate.agent as usize).collect())
        };
        let mut belongs = |number: usize, slots: &mut Slots| {
            let at = At { instance, base: definition.base_of(number), side };
            self.condition(at, &frame.folds[number].filter.condition, slots)
        };
        fold::gather(self.agents, told, kernel, slots, &roots, (&among, &mut belongs))
    }

    /// The lowest agent of a quantifier's range for which its body is `wanted`.
    fn first(&self, at: At, quantified: &Quantified, slots: &mut Slots, wanted: bool) -> Option<usize> {
        let roots = self.guards.roots(at.instance);
        let frame = self.guards.definition(at.instance).frame;
        let mut is_wanted = |agent: usize| {
            slots[quantified.slot] = agent;
            self.agents.follow_links(frame, slots);
            self.condition(at, &quantified.body, slots) == wanted
        };
        if let Some(candidates) = self.guards.candidates_at(at.instance, quantified.slot) {
            return candidates
                .iter()
                .map(|candidate| candidate.agent as usize)
                .find(|&agent| is_wanted(agent));
        }
        let range = &self.agents.of_type[quantified.ty];
        range
            .iter()
            .copied()
            .filter(|&agent| allowed(quantified, &roots, agent))
            .find(|&agent| is_wanted(agent))
    }

    /// The slots of an instance whose guard holds, with the witnesses of its outermost `exists` (rule 2).
    pub fn witnesses(&self, instance: u32) -> Slots {
        let mut slots = self.guards.slots(self.agents, instance);
        let definition = self.guards.definition(instance);
        let wanted = definition.origin.transition().map_or(&[][..], |transition| &transition.witnesses);
        if wanted.is_empty() {
            return slots;
        }
        let guard = definition.guard.expect("witnesses come from a guard");
        let side = if self.holds(instance, Side::At) { Side::At } else { Side::After };
        for term in guard.condition.conjuncts() {
            if let Condition::Exists(quantified) = term
                && wanted.contains(&quantified.slot)
            {
                let mut bound = slots.clone();
                let at = At { instance, base: definition.base, side };
                if let Some(agent) = self.first(at, quantified, &mut bound, true) {
                    slots[quantified.slot] = agent;
                }
            }
        }
        self.agents.follow_links(definition.frame, &mut slots);
        slots
    }

    /// The `rising` flags of an instance whose conditions are false now.
    pub fn seen_false(&self, instance: u32) -> Vec<usize> {
        let mut seen = Vec::new();
        if let Some(guard) = self.guards.definition(instance).guard
            && guard.n_rising > 0
        {
            let mut slots = self.guards.slots(self.agents, instance);
            self.collect_false(instance, &guard.condition, &mut slots, &mut seen);
        }
        seen
    }

    fn collect_false(&self, instance: u32, condition: &Condition, slots: &mut Slots, seen: &mut Vec<usize>) {
        match condition {
            Condition::Constant(_) | Condition::Discrete(_) | Condition::Atom(_) => {}
            Condition::And(all) | Condition::Or(all) => {
                all.iter().for_each(|condition| self.collect_false(instance, condition, slots, seen));
            }
            Condition::Exists(quantified) | Condition::Forall(quantified) => {
                let roots = self.guards.roots(instance);
                for &agent in &self.agents.of_type[quantified.ty] {
                    if allowed(quantified, &roots, agent) {
                        slots[quantified.slot] = agent;
                        self.agents.follow_links(self.guards.definition(instance).frame, slots);
                        self.collect_false(instance, &quantified.body, slots, seen);
                    }
                }
            }
            Condition::Rising(number, condition) => {
                // What is true at this instant has not been false in it yet, though it is so just after.
                let base = self.guards.definition(instance).base;
                let holds = |side| self.condition(At { instance, base, side }, condition, &mut slots.clone());
                if !holds(Side::At) && !holds(Side::After) {
                    seen.push(self.guards.rising_index(self.agents, instance, *number, slots));
                }
            }
        }
    }
}

/// Some conditions, those first whose truth is at hand.
fn cheap_first(all: &[Condition]) -> impl Iterator<Item = &Condition> {
    let is_cheap = |condition: &Condition| matches!(condition, Condition::Constant(_) | Condition::Atom(_));
    let cheap = all.iter().filter(move |condition| is_cheap(condition));
    cheap.chain(all.iter().filter(move |condition| !is_cheap(condition)))
}

/// Whether a condition holds for the rows of the present instant, comparison by comparison (tests in actions, lets).
/// `own` are the agents that `other` leaves out.
pub fn test(
    agents: &Agents<'_>,
    present: &mut Present,
    guard: &Guard,
    frame: &Frame,
    slots: &Slots,
    own: &[usize],
) -> bool {
    let mut slots = slots.clone();
    test_condition(agents, present, guard, frame, &guard.condition, &mut slots, own)
}

fn test_condition(
    agents: &Agents<'_>,
    present: &mut Present,
    guard: &Guard,
    frame: &Frame,
    condition: &Condition,
    slots: &mut Slots,
    roots: &[usize],
) -> bool {
    let every = |present: &mut Present, condition: &Condition, slots: &mut Slots| {
        test_condition(agents, present, guard, frame, condition, slots, roots)
    };
    match condition {
        Condition::Constant(truth) => *truth,
        Condition::Discrete(function) => value(agents, present, *function, frame, slots, roots) != 0.0,
        Condition::Atom(atom) => {
            let atom = &guard.atoms[*atom];
            let g = value(agents, present, atom.value, frame, slots, roots);
            match atom.relation {
                Relation::NonPositive => g <= 0.0,
                Relation::Negative => g < 0.0,
                Relation::Crossing => false,
            }
        }
        Condition::And(all) => all.iter().all(|condition| every(present, condition, slots)),
        Condition::Or(all) => all.iter().any(|condition| every(present, condition, slots)),
        Condition::Exists(quantified) | Condition::Forall(quantified) => {
            let exists = matches!(condition, Condition::Exists(_));
            let found = agents.of_type[quantified.ty].iter().any(|&agent| {
                if !allowed(quantified, roots, agent) {
                    return false;
                }
                slots[quantified.slot] = agent;
                agents.follow_links(frame, slots);
                every(present, &quantified.body, slots) == exists
            });
            found == exists
        }
        Condition::Rising(_, _) => false,
    }
}

/// The single output of a function on the rows of the present instant. `own` are the agents that `other` leaves out.
pub fn value(
    agents: &Agents<'_>,
    present: &mut Present,
    function: FunctionId,
    frame: &Frame,
    slots: &Slots,
    own: &[usize],
) -> f64 {
    let kernel = agents.program.kernel(function);
    let folds = gather(agents, present, kernel, frame, slots, own);
    evaluate(agents, present, kernel, slots, &folds)
}

/// The aggregates that a kernel reads, with their members by the rows of the present instant.
pub fn gather<'f>(
    agents: &Agents<'_>,
    present: &mut Present,
    kernel: &Kernel,
    frame: &'f Frame,
    slots: &Slots,
    own: &[usize],
) -> Vec<Folded<'f>> {
    let mut belongs = |number: usize, slots: &mut Slots| {
        let filter = &frame.folds[number].filter;
        test_condition(agents, present, filter, frame, &filter.condition, slots, own)
    };
    fold::gather(agents, (frame, None), kernel, slots, own, (&|_| None, &mut belongs))
}

/// The single output of a kernel that reads these aggregates, on the rows of the present instant.
pub fn evaluate(
    agents: &Agents<'_>,
    present: &mut Present,
    kernel: &Kernel,
    slots: &Slots,
    folds: &[Folded<'_>],
) -> f64 {
    let mut out = [0.0];
    outputs(agents, present, kernel, slots, folds, None, &mut out);
    out[0]
}

/// Value, rate and second rate by a kernel that reads these aggregates, on the rows of the present instant.
pub fn jet(
    agents: &Agents<'_>,
    present: &mut Present,
    kernel: &Kernel,
    slots: &Slots,
    folds: &[Folded<'_>],
) -> [f64; 3] {
    jet_with(agents, present, kernel, slots, folds, None)
}

/// The same with these auxiliary columns of self instead of its own.
pub fn jet_with(
    agents: &Agents<'_>,
    present: &mut Present,
    kernel: &Kernel,
    slots: &Slots,
    folds: &[Folded<'_>],
    own: Option<&[f64]>,
) -> [f64; 3] {
    let mut out = [0.0; 3];
    present.make(agents, slots, Depth::Accelerations);
    outputs(agents, present, kernel, slots, folds, own, &mut out);
    out
}

fn outputs(
    agents: &Agents<'_>,
    present: &mut Present,
    kernel: &Kernel,
    slots: &Slots,
    folds: &[Folded<'_>],
    own: Option<&[f64]>,
    out: &mut [f64],
) {
    let leaves = leaves(agents, present, kernel, slots, folds);
    let row = |agent: usize| present.view(agents, agent);
    let mut views = fold::views(slots, &leaves, &row);
    if let Some(own) = own {
        views[0].aux = own;
    }
    kernel.eval(&views, present.time, out);
}

/// The values of the aggregates that a kernel reads; all rows that it needs are made.
pub fn leaves(
    agents: &Agents<'_>,
    present: &mut Present,
    kernel: &Kernel,
    slots: &Slots,
    folds: &[Folded<'_>],
) -> Leaves<f64> {
    let depth = fold::depth(agents.program, kernel, folds);
    present.make(agents, slots, depth);
    if !folds.is_empty() {
        present.make(agents, &fold::involved(slots, folds), depth);
    }
    let row = |agent: usize| present.view(agents, agent);
    fold::leaves(agents.program, folds, depth_read(kernel), present.time, &row)
}
