//! The truth of conditions: from the truths of their atoms, or straight from the rows of the present instant.

use crate::codegen::kernel::Kernel;
use crate::codegen::program::{Condition, Frame, FunctionId, Guard, Quantified, Relation};
use crate::runtime::guards::{Guards, allowed};
use crate::runtime::population::{Agents, Slots};
use crate::runtime::present::{Depth, Present};

/// Which truth of an atom that changes at the present instant counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// That at the instant: a closed comparison is true on its boundary, a crossing at its zero.
    At,
    /// That just after it.
    After,
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

impl Truths<'_, '_> {
    /// Whether the condition of an instance holds.
    pub fn holds(&self, instance: u32, side: Side) -> bool {
        match self.guards.definition(instance).guard {
            None => true,
            Some(guard) => {
                let mut slots = self.guards.slots(self.agents, instance);
                self.condition(instance, &guard.condition, &mut slots, side)
            }
        }
    }

    fn condition(&self, instance: u32, condition: &Condition, slots: &mut Slots, side: Side) -> bool {
        match condition {
            Condition::Constant(truth) => *truth,
            Condition::Discrete(function) => {
                let mut out = [0.0];
                let kernel = self.agents.program.kernel(*function);
                kernel.eval(&self.present.views(self.agents, slots), self.present.time, &mut out);
                out[0] != 0.0 && !out[0].is_nan()
            }
            Condition::Atom(atom) => {
                let state = &self.guards.atoms[self.guards.atom_index(self.agents, instance, *atom, slots)];
                let guard = self.guards.definition(instance).guard.expect("an atom belongs to a guard");
                match guard.atoms[*atom].relation {
                    Relation::Crossing => side == Side::At && state.touched,
                    Relation::NonPositive | Relation::Negative => {
                        state.truth || (side == Side::At && state.touched)
                    }
                }
            }
            Condition::And(all) => {
                all.iter().all(|condition| self.condition(instance, condition, slots, side))
            }
            Condition::Or(all) => {
                all.iter().any(|condition| self.condition(instance, condition, slots, side))
            }
            Condition::Exists(quantified) => self.first(instance, quantified, slots, side, true).is_some(),
            Condition::Forall(quantified) => self.first(instance, quantified, slots, side, false).is_none(),
            Condition::Rising(number, condition) => {
                self.guards.rising[self.guards.rising_index(self.agents, instance, *number, slots)]
                    && self.condition(instance, condition, slots, side)
            }
        }
    }

    /// The lowest agent of a quantifier's range for which its body is `wanted`.
    fn first(
        &self,
        instance: u32,
        quantified: &Quantified,
        slots: &mut Slots,
        side: Side,
        wanted: bool,
    ) -> Option<usize> {
        let roots = self.guards.roots(instance);
        let frame = self.guards.definition(instance).frame;
        let range = &self.agents.of_type[quantified.ty];
        range.iter().copied().filter(|&agent| allowed(quantified, &roots, agent)).find(|&agent| {
            slots[quantified.slot] = agent;
            self.agents.follow_links(frame, slots);
            self.condition(instance, &quantified.body, slots, side) == wanted
        })
    }

    /// The slots of an instance whose guard holds, with the witnesses of its outermost `exists` (rule 2).
    pub fn witnesses(&self, instance: u32, side: Side) -> Slots {
        let mut slots = self.guards.slots(self.agents, instance);
        let definition = self.guards.definition(instance);
        let wanted = definition.origin.transition().map_or(&[][..], |transition| &transition.witnesses);
        if wanted.is_empty() {
            return slots;
        }
        let guard = definition.guard.expect("witnesses come from a guard");
        let terms = match &guard.condition {
            Condition::And(terms) => terms.as_slice(),
            other => std::slice::from_ref(other),
        };
        for term in terms {
            if let Condition::Exists(quantified) = term
                && wanted.contains(&quantified.slot)
            {
                let mut bound = slots.clone();
                if let Some(agent) = self.first(instance, quantified, &mut bound, side, true) {
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
                if !self.condition(instance, condition, slots, Side::After) {
                    seen.push(self.guards.rising_index(self.agents, instance, *number, slots));
                }
            }
        }
    }
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
        Condition::Discrete(function) => value(agents, present, *function, slots) != 0.0,
        Condition::Atom(atom) => {
            let atom = &guard.atoms[*atom];
            let g = value(agents, present, atom.value, slots);
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

/// The single output of a function on the rows of the present instant.
pub fn value(agents: &Agents<'_>, present: &mut Present, function: FunctionId, slots: &Slots) -> f64 {
    let kernel = agents.program.kernel(function);
    present.make(agents, slots, depth_read(kernel));
    let mut out = [0.0];
    kernel.eval(&present.views(agents, slots), present.time, &mut out);
    out[0]
}

/// How deep the rows must be for a kernel.
pub fn depth_read(kernel: &Kernel) -> Depth {
    let slots = &kernel.reads().slots;
    if slots.iter().any(|slot| slot.accelerations > 0) {
        Depth::Accelerations
    } else if slots.iter().any(|slot| slot.rates > 0) {
        Depth::Rates
    } else {
        Depth::States
    }
}
