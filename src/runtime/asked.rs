//! Conditions that nobody follows along the flow: asked at an instant, comparison by comparison, with rule 3's boundary.

use crate::codegen::program::{Atom, Condition, Frame, Guard, Relation};
use crate::runtime::atom_state::closed;
use crate::runtime::engine::Engine;
use crate::runtime::guards::allowed;
use crate::runtime::population::Slots;
use crate::runtime::solve::roots::{Direction, direction};
use crate::runtime::solve::time_resolution;
use crate::runtime::truth::{self, Side};

/// A condition and who asks.
#[derive(Clone, Copy)]
pub struct Question<'q> {
    /// What is asked.
    pub guard: &'q Guard,
    /// The agents it reads.
    pub frame: &'q Frame,
    /// Those that `other` leaves out.
    pub own: &'q [usize],
    /// An instance that follows the same condition along the flow, if there is one: its candidates are all who matter.
    pub followed: Option<u32>,
}

impl Engine<'_, '_> {
    /// Whether a condition holds at the present instant or just after it: then the slots, with the agents in those of
    /// `witnesses` for which it does.
    pub fn ask(&mut self, question: &Question<'_>, slots: Slots, witnesses: &[usize]) -> Option<Slots> {
        let condition = &question.guard.condition;
        let side = [Side::At, Side::After]
            .into_iter()
            .find(|&side| self.is_so(question, side, condition, &mut slots.clone()))?;
        let mut found = slots.clone();
        for term in condition.conjuncts() {
            if let Condition::Exists(quantified) = term
                && witnesses.contains(&quantified.slot)
            {
                let mut bound = slots.clone();
                if self.is_so(question, side, term, &mut bound) {
                    found[quantified.slot] = bound[quantified.slot];
                }
            }
        }
        self.agents.follow_links(question.frame, &mut found);
        Some(found)
    }

    /// Whether a part of it holds on one side; an `exists` that does leaves its agent in its slot.
    fn is_so(
        &mut self,
        question: &Question<'_>,
        side: Side,
        condition: &Condition,
        slots: &mut Slots,
    ) -> bool {
        match condition {
            Condition::Constant(truth) => *truth,
            Condition::Discrete(function) => {
                let (frame, own) = (question.frame, question.own);
                let value = truth::value(&self.agents, &mut self.present, *function, frame, slots, own);
                value != 0.0 && !value.is_nan()
            }
            Condition::Atom(atom) => self.is_met(question, side, &question.guard.atoms[*atom], slots),
            Condition::And(all) => all.iter().all(|condition| self.is_so(question, side, condition, slots)),
            Condition::Or(all) => all.iter().any(|condition| self.is_so(question, side, condition, slots)),
            Condition::Exists(quantified) | Condition::Forall(quantified) => {
                let exists = matches!(condition, Condition::Exists(_));
                let near = question
                    .followed
                    .and_then(|instance| self.guards.candidates_at(instance, quantified.slot));
                let range: Vec<usize> = match near {
                    Some(near) => near.iter().map(|candidate| candidate.agent as usize).collect(),
                    None => self.agents.of_type[quantified.ty].clone(),
                };
                let found = range.into_iter().any(|agent| {
                    if !allowed(quantified, question.own, agent) {
                        return false;
                    }
                    slots[quantified.slot] = agent;
                    self.agents.follow_links(question.frame, slots);
                    self.is_so(question, side, &quantified.body, slots) == exists
                });
                found == exists
            }
            Condition::Rising(..) => false,
        }
    }

    /// Whether a comparison is true on one side. On its boundary `<=` is true at the instant; just after it the first of two
    /// rates that is not zero within rounding decides.
    fn is_met(&mut self, question: &Question<'_>, side: Side, atom: &Atom, slots: &Slots) -> bool {
        let Question { frame, own, .. } = *question;
        let (value, rates) = (self.program.kernel(atom.value), self.program.kernel(atom.rates));
        let folds = truth::gather(&self.agents, &mut self.present, rates, frame, slots, own);
        let jet = truth::jet(&self.agents, &mut self.present, rates, slots, &folds);
        let g = jet[0];
        if !atom.smooth || g.is_nan() {
            return g < 0.0 || g == 0.0 && closed(atom.relation, false);
        }
        let by_rate = (jet[1].abs() * time_resolution(self.present.time)).min(1e-3 * (1.0 + g.abs()));
        let band = self.rounding(value, slots, &folds).max(by_rate);
        if g.abs() > band {
            return g < 0.0;
        }
        if side == Side::After {
            let bounds = self.jet_rounding(rates, slots, &folds, None);
            match direction(&jet, &bounds) {
                Direction::Up => return false,
                Direction::Down => return true,
                Direction::Along => {}
            }
        }
        atom.relation != Relation::Crossing && closed(atom.relation, false)
    }
}
