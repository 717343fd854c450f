//! Guards that look at every pair of agents (HY0614), where there are so many pairs that it takes most of the time.
//!
//! A guard over two agents is looked at for near pairs only if its condition bounds a difference of their states: see
//! `near`. Which pairs there are is known from the population; a condition that is never true is another matter.

use crate::base::Span;
use crate::calculus::bounds::Bounds;
use crate::calculus::lint::Warning;
use crate::calculus::lint::effects::{guard, nodes};
use crate::calculus::lint::oneself::first_atom;
use crate::calculus::lint::truth::{Truth, truth};
use crate::calculus::reader::Reader;
use crate::calculus::system::{
    Condition, Frame, Guard, LinkUpdate, PairTransition, Quantified, System, Whither,
};

/// So many pairs are nobody's concern.
const PAIRS_MAX: usize = 100_000;

/// Looks at every interaction, and at the quantifiers in guards and claims.
pub fn conditions(system: &System, bounds: &Bounds, found: &mut Vec<Warning>) {
    let mut n_agents = vec![0; system.types.len()];
    system.population.agents.iter().for_each(|agent| n_agents[agent.ty.index()] += 1);
    let census = Census { system, bounds, n_agents };
    for interaction in &system.interactions {
        for pair in &interaction.transitions {
            census.interaction(interaction.types, pair, found);
        }
    }
    for ty in &system.types {
        for transition in &ty.transitions {
            if let Some(guard) = guard(transition) {
                let owner = Owner { frame: &transition.frame, guard, span: transition.span };
                census.quantifiers(&owner, &guard.condition, found);
                census.aggregates(&owner, found);
            }
        }
        for claim in ty.modes.iter().flat_map(|mode| &mode.claims) {
            let owner = Owner { frame: &claim.frame, guard: &claim.violation, span: claim.span };
            census.quantifiers(&owner, &claim.violation.condition, found);
            census.aggregates(&owner, found);
        }
        for update in ty.links.iter().flat_map(|link| &link.updates) {
            census.nearest(update, found);
        }
    }
}

/// Whose condition it is.
struct Owner<'s> {
    frame: &'s Frame,
    guard: &'s Guard,
    span: Span,
}

/// How many there are of each type.
struct Census<'s> {
    system: &'s System,
    bounds: &'s Bounds,
    n_agents: Vec<usize>,
}

impl Census<'_> {
    fn interaction(&self, types: [usize; 2], pair: &PairTransition, found: &mut Vec<Warning>) {
        let transition = &pair.transition;
        let Some(guard) = guard(transition) else { return };
        let owner = Owner { frame: &transition.frame, guard, span: transition.span };
        let ordered = self.pairs(types);
        let n_pairs = if pair.symmetric { ordered / 2 } else { ordered };
        let span = first_atom(guard, &guard.condition).unwrap_or(transition.span);
        if pair.near.is_empty() && n_pairs > PAIRS_MAX && self.may_hold(&owner, &guard.condition) {
            found.push(Warning::AllPairs { name: transition.label.clone(), span, n_pairs });
        }
        self.quantifiers(&owner, &guard.condition, found);
        self.aggregates(&owner, found);
    }

    /// The aggregates whose members move, or are chosen by what moves.
    fn aggregates(&self, owner: &Owner, found: &mut Vec<Warning>) {
        let read = self.system.graph.reach(&nodes(self.system, owner.guard));
        let is_read = |slot: usize| read.iter().any(|&id| self.system.graph.node(id).slot() == Some(slot));
        for fold in owner.frame.folds.iter().filter(|fold| is_read(fold.slot)) {
            let n_pairs = self.pairs([owner.frame.slots[0].ty(), fold.range.ty]);
            let changes = fold.moves || !fold.filter.atoms.is_empty();
            if fold.near.is_empty() && changes && n_pairs > PAIRS_MAX {
                let span = first_atom(&fold.filter, &fold.filter.condition).unwrap_or(owner.span);
                let name = owner.frame.slots[fold.slot].name().to_string();
                found.push(Warning::AllPairs { name, span, n_pairs });
            }
        }
    }

    /// Who is nearest is found among all.
    fn nearest(&self, update: &LinkUpdate, found: &mut Vec<Warning>) {
        let Whither::Nearest { range, near, .. } = &update.target else { return };
        let n_pairs = self.pairs([update.frame.slots[0].ty(), range.ty]);
        if near.is_empty() && n_pairs > PAIRS_MAX {
            let name = update.label.clone();
            found.push(Warning::AllAsked { name, span: update.span, n_pairs });
        }
    }

    fn quantifiers(&self, owner: &Owner, condition: &Condition, found: &mut Vec<Warning>) {
        match condition {
            Condition::Exists(quantified) | Condition::Forall(quantified) => {
                let Quantified { slot, ty, body, near, .. } = quantified;
                let n_pairs = self.pairs([owner.frame.slots[0].ty(), *ty]);
                if near.is_empty() && n_pairs > PAIRS_MAX && self.may_hold(owner, condition) {
                    let span = first_atom(owner.guard, body).unwrap_or(owner.span);
                    let name = owner.frame.slots[*slot].name().to_string();
                    found.push(Warning::AllPairs { name, span, n_pairs });
                }
                self.quantifiers(owner, body, found);
            }
            Condition::And(terms) | Condition::Or(terms) => {
                terms.iter().for_each(|term| self.quantifiers(owner, term, found));
            }
            Condition::Rising(_, inner) => self.quantifiers(owner, inner, found),
            Condition::Constant(_) | Condition::Discrete(_) | Condition::Atom(_) => {}
        }
    }

    /// How many pairs of agents of these types there are, either of two of one type first.
    fn pairs(&self, [first, second]: [usize; 2]) -> usize {
        let (n, m) = (self.n_agents[first], self.n_agents[second]);
        n.saturating_mul(if first == second { m.saturating_sub(1) } else { m })
    }

    fn may_hold(&self, owner: &Owner, condition: &Condition) -> bool {
        let mut reader = Reader::new(self.system, self.bounds, owner.frame);
        truth(&mut reader, owner.guard, condition) != Truth::Never
    }
}
