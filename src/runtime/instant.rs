//! One instant: micro-steps until nothing is enabled (rule 4), then the claims about the state that results (rule 8).

use std::collections::BTreeSet;

use rustc_hash::{FxHashMap, FxHashSet};

use crate::base::Span;
use crate::codegen::program::{Atom, ClaimKind, ClaimSystem, Relation, Trigger};
use crate::codegen::trace::Compared;
use crate::runtime::act::{Claimed, Effect, Written, claims};
use crate::runtime::arm::Rule;
use crate::runtime::atom_state::{AtomState, closed};
use crate::runtime::engine::Engine;
use crate::runtime::failure::{Failure, Place, Reason, contested};
use crate::runtime::fate::Fate;
use crate::runtime::guards::Origin;
use crate::runtime::observe::{Event, FalseAssert};
use crate::runtime::population::Slots;
use crate::runtime::repetition::Finding;
use crate::runtime::truth::{self, Side};

/// An instance that may fire in the next micro-step.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Candidate {
    /// Which.
    pub instance: u32,
    /// By what.
    pub by: By,
}

/// What lets an instance fire.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum By {
    /// That it is armed and true.
    Guard,
    /// A time of its `every`, scheduled by this arming.
    Pulse(u32),
    /// The message at its turn.
    Message,
}

/// A candidate with what orders it (rule 4).
struct Ranked {
    candidate: Candidate,
    slots: Slots,
    priority: f64,
    depth: usize,
    declaration: usize,
}

impl Engine<'_, '_> {
    /// Executes the instant at the present time, from these candidates.
    pub fn instant(&mut self, mut candidates: Vec<Candidate>) -> Result<(), Failure> {
        self.repetitions.instant += 1;
        self.notes.iter_mut().for_each(|notes| notes.begin());
        let mut micro = 0;
        let mut touched_agents: BTreeSet<(usize, usize)> = BTreeSet::new();
        let mut concerned: Vec<u32> = candidates.iter().map(|candidate| candidate.instance).collect();
        let mut generations = 0;
        let mut restarted: FxHashSet<usize> = FxHashSet::default();
        // The loop ends an interrupted run; until then an instant without an end must not go on.
        while !self.interrupted() {
            self.deliver();
            candidates.extend(self.turns());
            candidates.sort_unstable();
            candidates.dedup();
            candidates.retain(|candidate| self.may_fire(*candidate));
            if candidates.is_empty() {
                if !self.mail.is_waiting() {
                    break;
                }
                // Whatever had its turn was missed; more is to come.
                micro += 1;
                continue;
            }
            let (chosen, passed) = self.choose(&candidates)?;
            let written = self.fire(&chosen, micro, &mut touched_agents)?;
            touched_agents.extend(written.born.iter().map(|&agent| (self.agents.number(agent), agent)));
            let fired: Vec<u32> = chosen.iter().map(|ranked| ranked.candidate.instance).collect();
            generations = if written.born.is_empty() { 0 } else { generations + 1 };
            if generations > self.limits.generations_max {
                let place = self.place(chosen[0].slots[0]);
                let (limit, span) = (self.limits.generations_max, self.label(fired[0]).1);
                return Err(Fate::Generations { place, limit, span }.into());
            }
            if self.notes.is_some() {
                self.explain_writes(&written, &fired);
            }
            restarted.extend(&written.restarted);
            let entered = self.change_modes(&written);
            let mut woken = self.wake(&written)?;
            for &instance in &fired {
                self.settle_fired(instance, &written);
            }
            woken.extend(self.refresh_links(&woken)?);
            for &instance in &entered {
                self.arm(instance, Rule::Rates)?;
            }
            woken.extend(entered);
            woken.sort_unstable();
            woken.dedup();
            for &instance in fired.iter().chain(&woken) {
                self.rearm(instance);
            }
            concerned.extend(fired.iter().chain(&woken));
            candidates = passed;
            candidates.retain(|candidate| candidate.by != By::Message);
            let enabled = woken.iter().copied().filter(|&instance| self.enabled(instance));
            candidates.extend(enabled.map(|instance| Candidate { instance, by: By::Guard }));
            micro += 1;
            self.release_crossings(&woken);
            self.compact_queues();
        }
        concerned.sort_unstable();
        concerned.dedup();
        self.turn_back(&concerned, &restarted);
        self.judge_claims(&concerned, &[])?;
        self.set_gates(&concerned)?;
        self.calm(&concerned);
        self.end_lives();
        self.recorder.after_instant(
            &self.agents,
            &mut self.present,
            micro,
            &touched_agents,
            self.observer,
        )?;
        Ok(())
    }

    fn may_fire(&self, candidate: Candidate) -> bool {
        let state = &self.guards.instances[candidate.instance as usize];
        match candidate.by {
            By::Guard => self.enabled(candidate.instance),
            By::Pulse(arming) => {
                state.active && state.arming == arming && self.truths().holds_now(candidate.instance)
            }
            // It has just been asked.
            By::Message => true,
        }
    }

    /// Orders the candidates and takes them greedily; those passed over come second.
    fn choose(&mut self, candidates: &[Candidate]) -> Result<(Vec<Ranked>, Vec<Candidate>), Failure> {
        let mut ranked = Vec::with_capacity(candidates.len());
        for &candidate in candidates {
            ranked.push(self.rank(candidate)?);
        }
        ranked.sort_by(|a, b| {
            let by_priority = b.priority.total_cmp(&a.priority);
            let by_place = (a.depth, a.declaration).cmp(&(b.depth, b.declaration));
            let number = |&agent: &usize| self.agents.number(agent);
            let by_number = a.slots.iter().map(number).cmp(b.slots.iter().map(number));
            by_priority.then(by_place).then(by_number).then(a.candidate.cmp(&b.candidate))
        });
        let mut taken: FxHashMap<(usize, Claimed), u32> = FxHashMap::default();
        let (mut chosen, mut passed) = (Vec::new(), Vec::new());
        for ranked in ranked {
            let claims = claims(self, ranked.candidate.instance, &ranked.slots);
            let conflict = claims.iter().find_map(|claim| taken.get(claim).map(|&first| (claim.0, first)));
            match conflict {
                Some((agent, first)) => {
                    self.note_contest(agent, first, ranked.candidate.instance);
                    passed.push(ranked.candidate);
                }
                None => {
                    let instance = ranked.candidate.instance;
                    taken.extend(claims.into_iter().map(|claim| (claim, instance)));
                    chosen.push(ranked);
                }
            }
        }
        Ok((chosen, passed))
    }

    fn rank(&mut self, candidate: Candidate) -> Result<Ranked, Failure> {
        let slots = match candidate.by {
            By::Guard if self.is_hazard(candidate.instance) => {
                let slots = self.guards.slots(&self.agents, candidate.instance);
                self.answer(candidate.instance).unwrap_or(slots)
            }
            By::Guard | By::Pulse(_) => self.truths().witnesses(candidate.instance),
            By::Message => self.answer(candidate.instance).expect("it has just been asked"),
        };
        let (transition, depth) = match self.guards.definition(candidate.instance).origin {
            Origin::Transition(transition) => (transition, transition.depth),
            Origin::Pair(pair) => (&pair.transition, 0),
            Origin::Gate(_) | Origin::Claim(_) | Origin::Link(_) => {
                unreachable!("only transitions are candidates")
            }
        };
        let mut priority = 0.0;
        if let Some(function) = transition.priority {
            let own = self.guards.roots(candidate.instance);
            let frame = &transition.frame;
            // Minus zero is zero.
            priority = 0.0 + truth::value(&self.agents, &mut self.present, function, frame, &slots, &own);
            if priority.is_nan() {
                let blame = self.blame(function, frame, &slots, &own);
                let place = self.place(slots[0]);
                return Err(Reason::BadPriority { place, blame, span: transition.span }.into());
            }
        }
        Ok(Ranked { candidate, slots, priority, depth, declaration: transition.declaration })
    }

    /// Rule 5: two interactions that want the same column of one agent; said once.
    fn note_contest(&mut self, agent: usize, first: u32, second: u32) {
        let pair = |instance: u32| matches!(self.guards.definition(instance).origin, Origin::Pair(_));
        if !pair(first) || !pair(second) || self.warnings.iter().any(|warning| warning.code == "HY0520") {
            return;
        }
        let name = self.agents.name(agent);
        self.warnings.push(contested(self.present.time, &name, self.label(first), self.label(second)));
    }

    /// Fires the chosen transitions together: all read the state before.
    fn fire(
        &mut self,
        chosen: &[Ranked],
        micro: usize,
        touched: &mut BTreeSet<(usize, usize)>,
    ) -> Result<Written, Failure> {
        let mut effects: Vec<Effect> = Vec::with_capacity(chosen.len());
        for ranked in chosen {
            let instance = ranked.candidate.instance;
            self.explain(ranked.candidate, micro)?;
            self.count_firing(instance)?;
            effects.push(self.effect(instance, &ranked.slots)?);
            if ranked.candidate.by == By::Message {
                self.note_heard(instance);
            }
            self.guards.instances[instance as usize].armed = false;
        }
        for effect in &effects {
            let agents = effect
                .writes
                .iter()
                .map(|write| write.agent)
                .chain(effect.moves.iter().map(|change| change.agent))
                .chain(effect.doomed.iter().map(|doomed| doomed.agent));
            for agent in agents {
                if touched.insert((self.agents.number(agent), agent)) {
                    self.recorder.before_write(
                        &self.agents,
                        &mut self.present,
                        agent,
                        micro,
                        self.observer,
                    )?;
                }
            }
        }
        for (ranked, effect) in chosen.iter().zip(&effects) {
            self.log(ranked, effect, micro)?;
        }
        self.carry_out(effects)
    }

    pub fn count_firing(&mut self, instance: u32) -> Result<(), Failure> {
        let trigger = self.guards.definition(instance).trigger();
        // Whoever emits is counted; that many emit at once is nothing to complain of.
        let scheduled =
            matches!(trigger, Some(Trigger::Every { .. } | Trigger::Chance { .. } | Trigger::On { .. }));
        let time = self.present.time;
        let finding = self.repetitions.fired(instance, time, scheduled);
        if finding == Finding::Fine {
            return Ok(());
        }
        let Finding::Zeno(limit_time) = finding else { return Err(self.goes_round(instance).into()) };
        let (place, cycle, compared, span) = self.cycle(instance);
        let count = self.limits.zeno_events;
        Err(Reason::Zeno { place, cycle, count, limit_time, compared, span }.into())
    }

    /// One instant does not end.
    fn goes_round(&mut self, instance: u32) -> Reason {
        let (place, cycle, compared, span) = self.cycle(instance);
        let limit = self.limits.microsteps_max;
        Reason::MicrostepLimit { place, limit, cycle, compared, span }
    }

    /// Where an instance fires again and again: its agent, the transitions that fire in turn, what it compares, its span.
    fn cycle(&mut self, instance: u32) -> (Place, Vec<String>, Vec<Compared>, Span) {
        let agent = self.guards.instances[instance as usize].roots[0] as usize;
        let place = self.place(agent);
        let compared = self.told(instance);
        let (_, span): (&str, Span) = self.label(instance);
        let cycle = self.repetitions.cycle(instance);
        let cycle = cycle.iter().map(|&other| format!("`{}`", self.label(other).0)).collect();
        (place, cycle, compared, span)
    }

    /// Counts one firing, and writes its rows of the event log.
    fn log(&mut self, ranked: &Ranked, effect: &Effect, micro: usize) -> Result<(), Failure> {
        let instance = ranked.candidate.instance;
        if !self.agents.who(ranked.slots[0]).is_visible() {
            return Ok(());
        }
        let (label, _) = self.label(instance);
        let definition = self.guards.instances[instance as usize].definition as usize;
        let pair = matches!(self.guards.definition(instance).origin, Origin::Pair(_));
        let time = self.present.time;
        let ty = self.agents.agents[ranked.slots[0]].ty;
        let sender =
            if ranked.candidate.by == By::Message { self.mail.sender_at(ranked.slots[0]) } else { None };
        let agent = self.agents.who(ranked.slots[0]);
        self.firings[definition] += 1;
        self.n_events += 1;
        self.events_of_type[ty] += 1;
        let n_participants = if pair { 2 } else { 1 };
        ranked.slots[..n_participants].iter().for_each(|&agent| self.count_event(agent));
        let mut event = Event { time, micro, row: 0, transition: label, agent, other: sender, modes: None };
        if effect.moves.is_empty() {
            event.other = if pair { Some(self.agents.who(ranked.slots[1])) } else { sender };
            self.observer.event(&event)?;
            return Ok(());
        }
        for (row, change) in effect.moves.iter().enumerate() {
            event.row = row;
            let modes = &self.program.types[self.agents.agents[change.agent].ty].modes;
            event.agent = self.agents.who(change.agent);
            if pair {
                let other = ranked.slots.get(usize::from(change.agent == ranked.slots[0]));
                event.other = other.map(|&other| self.agents.who(other));
            }
            event.modes = Some((&modes[change.from].path, &modes[change.to].path));
            self.observer.event(&event)?;
        }
        Ok(())
    }

    /// A guard that has just fired looks at its boundary by the rates along the new flow (rule 3): where it had its root,
    /// and where a reset may have put it there.
    pub fn settle_fired(&mut self, instance: u32, written: &Written) {
        if !self.guards.instances[instance as usize].active {
            return;
        }
        for index in self.guards.atoms_of(instance) {
            let state = &mut self.guards.atoms[index];
            let was_rooted = state.rooted;
            state.touched = false;
            state.rooted = false;
            if was_rooted || self.reads_written(index, written) {
                self.settle(index, Rule::Rates, written);
                self.hold_until_calm(index);
            }
        }
        if !self.guards.definition(instance).folds.is_empty() {
            self.settle_folds(instance);
        }
        self.note_rising(instance);
    }

    /// Whether a comparison of aggregates has other members at the very instant than just after it, and holds with those.
    fn true_exactly_now(&mut self, instance: u32, atom: &Atom, slots: &Slots) -> bool {
        let kernel = self.program.kernel(atom.value);
        let [exactly, after] =
            [Side::At, Side::After].map(|side| self.truths().gather(instance, kernel, slots, side));
        let g = truth::evaluate(&self.agents, &mut self.present, kernel, slots, &exactly);
        if g == truth::evaluate(&self.agents, &mut self.present, kernel, slots, &after) {
            return false;
        }
        g < 0.0 || g.abs() <= self.rounding(kernel, slots, &exactly) && closed(atom.relation, false)
    }

    /// Settles the comparisons of aggregates of an instance, some of which have other members now.
    pub fn settle_folds(&mut self, instance: u32) {
        for index in self.guards.atoms_of(instance) {
            let (atom, slots) = self.guards.atom_slots(&self.agents, index);
            if !atom.folds.is_empty() {
                let before = self.guards.atoms[index];
                self.settle(index, Rule::Rates, &Written::default());
                let touched = match atom.relation {
                    Relation::Crossing => !before.sideless && self.guards.atoms[index].truth != before.truth,
                    Relation::NonPositive | Relation::Negative => {
                        self.true_exactly_now(instance, atom, &slots)
                    }
                };
                self.guards.atoms[index].touched |= before.touched || touched;
                self.guards.roused.push(index as u32);
            }
        }
    }

    /// A `<=` that moves in from its boundary, where it has fired or been armed by a transition, is true like a root: until the end of the
    /// instant, whatever turns its flow, unless it is written off its boundary (rule 3).
    pub fn hold_until_calm(&mut self, index: usize) {
        let (atom, _) = self.guards.atom_slots(&self.agents, index);
        let is_plain =
            atom.relation == Relation::NonPositive && atom.jumps.is_none() && atom.folds.is_empty();
        let state = &mut self.guards.atoms[index];
        if state.truth && state.slack > 0.0 && is_plain {
            (state.rooted, state.near) = (true, self.present.time);
            self.guards.roused.push(index as u32);
        }
    }

    /// A crossing is true for one micro-step only.
    fn release_crossings(&mut self, woken: &[u32]) {
        let is_spent = |&index: &u32| {
            let AtomState { instance, touched, rooted, .. } = self.guards.atoms[index as usize];
            let is_woken = touched && !rooted && woken.binary_search(&instance).is_ok();
            // What is enabled by it has been collected; it fires in the next micro-step or never.
            is_woken && self.guards.instances[instance as usize].active && !self.enabled(instance)
        };
        let spent: Vec<u32> = self.guards.roused.iter().copied().filter(is_spent).collect();
        spent.into_iter().for_each(|index| self.guards.atoms[index as usize].touched = false);
    }

    /// What changed at a root, and has neither fired nor been written, goes on along the new flow: where that turns back, it does not
    /// change after all (rule 2: what is false at a single point has not been false).
    fn turn_back(&mut self, concerned: &[u32], restarted: &FxHashSet<usize>) {
        for index in self.guards.roused.clone() {
            let index = index as usize;
            let (atom, slots) = self.guards.atom_slots(&self.agents, index);
            let AtomState { instance, rooted, leap, .. } = self.guards.atoms[index];
            let is_root = rooted && leap.is_none() && atom.relation != Relation::Crossing;
            let reads_anew = atom.slots.iter().any(|&slot| restarted.contains(&slots[slot]));
            let is_active = self.guards.instances[instance as usize].active;
            if is_root && is_active && reads_anew && concerned.binary_search(&instance).is_ok() {
                self.settle(index, Rule::Rates, &Written::default());
            }
        }
    }

    /// Ends the instant for some instances, rising: what was true only at it is so no more.
    pub fn calm(&mut self, concerned: &[u32]) {
        self.guards.calm(concerned);
        for &instance in concerned {
            self.note_rising(instance);
            self.rearm(instance);
        }
    }

    /// Rule 8: invariants that are false now end the run, asserts are noted. What changed `at_once`, where it had been settled,
    /// is not settled again: the search has looked further than its rates, and would change it back.
    pub fn judge_claims(&mut self, concerned: &[u32], at_once: &[usize]) -> Result<(), Failure> {
        for &instance in concerned {
            let Origin::Claim(claim) = self.guards.definition(instance).origin else { continue };
            // Properties are judged by their margins, along the way.
            if claim.kind == ClaimKind::Property || !self.guards.instances[instance as usize].active {
                continue;
            }
            for index in self.guards.atoms_of(instance).filter(|index| !at_once.contains(index)) {
                self.settle(index, Rule::Rates, &Written::default());
            }
            let state = &self.guards.instances[instance as usize];
            if !(state.armed && self.truths().holds(instance, Side::After)) {
                continue;
            }
            let agent = state.roots[0] as usize;
            match claim.kind {
                ClaimKind::Invariant => {
                    let (place, compared) = (self.place(agent), self.told(instance));
                    let (message, span) = (claim.message.clone(), claim.span);
                    return Err(Reason::InvariantFalse { place, message, compared, span }.into());
                }
                ClaimKind::Rate => {
                    let (place, compared) = (self.place(agent), self.told(instance));
                    let label = claim.message.clone().unwrap_or_default();
                    return Err(Reason::NegativeRate { place, label, compared, span: claim.span }.into());
                }
                ClaimKind::Assert | ClaimKind::Property => {
                    self.guards.instances[instance as usize].armed = false;
                    match self.false_asserts.iter_mut().find(|known| known.span == claim.span) {
                        Some(known) => known.count += 1,
                        None => self.note_assert(claim, instance, agent),
                    }
                }
            }
        }
        Ok(())
    }

    /// Notes that an assert is false for the first time.
    fn note_assert(&mut self, claim: &ClaimSystem, instance: u32, agent: usize) {
        let time = self.present.time;
        let compared = self.told(instance);
        let mode = self.agents.mode(agent).path.clone();
        let (span, message) = (claim.span, claim.message.clone());
        let agent = self.agents.who(agent);
        self.false_asserts.push(FalseAssert { span, message, time, agent, mode, compared, count: 1 });
    }
}
