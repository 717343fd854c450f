//! Why each transition fired, and which roots were left undecided: told to an observer that asks for it.
//!
//! Nothing here changes a run (rule 16): rows are made in a place of their own, which no count knows of. A guard is shown
//! at the instant, on the state that the transition read, and just before: on the near side of its root, or on the rows
//! that the last micro-step wrote over.

use rustc_hash::FxHashMap;

use crate::runtime::act::Written;
use crate::runtime::comparisons::{compare, telling};
use crate::runtime::engine::Engine;
use crate::runtime::failure::Failure;
use crate::runtime::guards::Origin;
use crate::runtime::instant::{By, Candidate};
use crate::runtime::notes::Notes;
use crate::runtime::observe::{Cause, Explanation, ShownComparison, Undecided, WhyUndecided};
use crate::runtime::population::Agents;
use crate::runtime::solve::ulp;

/// Which rows are shown as those before.
enum Before {
    /// Those at this time, s.
    Time(f64),
    /// Those that the last micro-step wrote over.
    Rows,
    /// None.
    Nothing,
}

impl Engine<'_, '_> {
    /// Notes what a micro-step has written, and by which instances.
    pub fn explain_writes(&mut self, written: &Written, fired: &[u32]) {
        let writers = fired.iter().map(|&instance| self.label(instance).0.to_string()).collect();
        if let Some(notes) = &mut self.notes {
            notes.before.clone_from(&written.before);
            notes.moved = written.moves.iter().map(|change| change.agent).collect();
            notes.born.clone_from(&written.born);
            notes.writers = writers;
        }
    }

    /// Tells why an instance fires now.
    pub fn explain(&mut self, candidate: Candidate, micro: usize) -> Result<(), Failure> {
        let first = self.guards.roots(candidate.instance)[0];
        if !self.agents.who(first).is_visible() {
            return Ok(());
        }
        let Some(mut notes) = self.notes.take() else { return Ok(()) };
        let told = self.explain_by(&mut notes, candidate, micro);
        self.notes = Some(notes);
        told
    }

    fn explain_by(&mut self, notes: &mut Notes, candidate: Candidate, micro: usize) -> Result<(), Failure> {
        self.tell_undecided_by(notes)?;
        let (instance, time) = (candidate.instance, self.present.time);
        let (cause, before) = self.cause(notes, candidate);
        let shown = self.shown(notes, instance, &before);
        let roots = self.guards.roots(instance);
        let (transition, span) = self.label(instance);
        let explanation = Explanation {
            time,
            micro,
            transition,
            agent: self.agents.who(roots[0]),
            other: roots.get(1).map(|&other| self.agents.who(other)),
            span,
            cause,
            shown,
        };
        Ok(self.observer.explanation(&explanation)?)
    }

    /// What made an instance fire.
    fn cause(&self, notes: &Notes, candidate: Candidate) -> (Cause, Before) {
        let (instance, time) = (candidate.instance, self.present.time);
        let state = &self.guards.instances[instance as usize];
        let is_scheduled = |due: f64| (due - time).abs() <= 4.0 * ulp(time);
        match candidate.by {
            By::Guard => {}
            By::Pulse(_) if self.is_gated(instance) => return (Cause::Chance, Before::Nothing),
            By::Pulse(_) => return (Cause::Every { period: state.delay }, Before::Nothing),
            By::Message => {
                let sender = self.mail.sender_at(state.roots[0] as usize);
                let sender = sender.expect("it fires by the message at its turn");
                return (Cause::Message { sender }, Before::Nothing);
            }
        }
        let roots = self.guards.atoms_of(instance).map(|index| &self.guards.atoms[index]);
        // What is true on its boundary because it was armed there has no time before it.
        let near = roots.filter(|atom| atom.rooted && atom.near < time).map(|atom| atom.near);
        if let Some(near) = near.min_by(f64::total_cmp) {
            return (Cause::Flow, Before::Time(near));
        }
        if state.aged && is_scheduled(state.entry + state.delay) && state.delay > 0.0 {
            return (Cause::After { delay: state.delay }, Before::Nothing);
        }
        let own_mode = self.guards.definition(instance).mode != 0;
        let moved = own_mode && notes.moved.contains(&(state.roots[0] as usize));
        let is_new = notes.born.contains(&(state.roots[0] as usize));
        if state.entry == time && (moved || is_new || notes.writers.is_empty()) {
            return (Cause::Entry, Before::Nothing);
        }
        match &notes.writers[..] {
            [] => (Cause::Flow, Before::Nothing),
            writers => (Cause::Write { by: writers.to_vec() }, Before::Rows),
        }
    }

    /// The comparisons of an instance, before and at the instant.
    fn shown(&mut self, notes: &mut Notes, instance: u32, before: &Before) -> Vec<ShownComparison> {
        let told = telling(&self.guards, instance);
        let aside = &mut notes.aside;
        aside.go(self.present.time);
        aside.forget();
        let mut shown: Vec<ShownComparison> = told
            .iter()
            .map(|&index| ShownComparison {
                before: None,
                now: compare(&self.guards, &self.agents, aside, index),
            })
            .collect();
        match before {
            Before::Nothing => return shown,
            Before::Time(near) => aside.go(*near),
            Before::Rows => exchange(&mut self.agents, &mut notes.before),
        }
        aside.forget();
        for (shown, &index) in shown.iter_mut().zip(&told) {
            shown.before = Some(compare(&self.guards, &self.agents, aside, index));
        }
        if let Before::Rows = before {
            exchange(&mut self.agents, &mut notes.before);
        }
        let mut seen: Vec<ShownComparison> = Vec::new();
        shown.retain(|shown| {
            let is_new = !seen.contains(shown);
            seen.push(shown.clone());
            is_new
        });
        shown
    }

    /// Notes a root that could be neither excluded nor isolated.
    pub fn note_undecided(&mut self, index: usize, from: f64, to: f64, why: WhyUndecided) {
        let Some(notes) = &mut self.notes else { return };
        let mut at = |time: f64| {
            notes.aside.go(time);
            notes.aside.forget();
            compare(&self.guards, &self.agents, &mut notes.aside, index)
        };
        let ends = [at(from), at(to)];
        let instance = self.guards.atoms[index].instance;
        let roots = self.guards.roots(instance);
        let is_claim = matches!(self.guards.definition(instance).origin, Origin::Claim(_));
        let (label, span) = match self.guards.definition(instance).origin {
            Origin::Transition(transition) | Origin::Gate(transition) => {
                (transition.label.clone(), transition.span)
            }
            Origin::Pair(pair) => (pair.transition.label.clone(), pair.transition.span),
            Origin::Claim(claim) => (String::new(), claim.span),
            Origin::Link(update) => (update.label.clone(), update.span),
        };
        let transition = (!is_claim).then_some(label);
        notes.undecided.push(Undecided {
            from,
            to,
            transition,
            agent: self.agents.who(roots[0]),
            other: roots.get(1).map(|&other| self.agents.who(other)),
            span,
            ends,
            why,
        });
    }

    /// Tells what is known of undecided roots so far.
    pub fn tell_undecided(&mut self) -> Result<(), Failure> {
        let Some(mut notes) = self.notes.take() else { return Ok(()) };
        let told = self.tell_undecided_by(&mut notes);
        self.notes = Some(notes);
        told
    }

    fn tell_undecided_by(&mut self, notes: &mut Notes) -> Result<(), Failure> {
        for undecided in notes.undecided.drain(..) {
            self.observer.undecided(&undecided)?;
        }
        Ok(())
    }
}

/// Exchanges the agents' rows with those written over; a second time it undoes that.
fn exchange(agents: &mut Agents<'_>, before: &mut FxHashMap<usize, (Vec<f64>, Vec<f64>)>) {
    agents.changes += 1;
    for (&agent, (states, aux)) in before {
        std::mem::swap(&mut agents.agents[agent].states, states);
        std::mem::swap(&mut agents.agents[agent].aux, aux);
    }
}
