//! Arming, settling and waking (rules 2, 3 and 14): which guards look at the present instant afresh, and what they find.

use rustc_hash::FxHashSet;
use smallvec::SmallVec;

use crate::codegen::kernel::{AgentView, Kernel};
use crate::codegen::program::{Atom, Relation, Slot, Trigger};
use crate::runtime::act::Written;
use crate::runtime::agenda::Due;
use crate::runtime::atom_state::{AtomState, closed};
use crate::runtime::engine::Engine;
use crate::runtime::failure::{Failure, Reason};
use crate::runtime::fold::Folded;
use crate::runtime::guards::{Origin, inside};
use crate::runtime::population::{ABSENT, Agent, Slots};
use crate::runtime::present::{Depth, depth_read};
use crate::runtime::sleep::Regard;
use crate::runtime::solve::roots::{AT_TURN, Direction, direction};
use crate::runtime::solve::{scheduled, time_resolution};
use crate::runtime::truth::{self, Side, Truths};
use crate::runtime::zeros::Zero;

/// How an atom that lies on its boundary is settled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rule {
    /// At t = 0: `<=` is true on the boundary; nothing is held.
    Fresh,
    /// Armed by a transition into its mode, or just fired: the rates decide (rule 3).
    Rates,
    /// Something it reads was written.
    Woken,
}

/// Powers of ten of the times after which g is looked at from there, s.
const LATER: [i32; 3] = [-7, -5, -3];

impl<'p> Engine<'p, '_> {
    /// Reads the truths of atoms at the present instant.
    pub fn truths(&self) -> Truths<'_, 'p> {
        Truths { agents: &self.agents, guards: &self.guards, present: &self.present }
    }

    /// Arms an instance, whose mode has just been entered.
    pub fn arm(&mut self, instance: u32, rule: Rule) -> Result<(), Failure> {
        let time = self.present.time;
        let state = &mut self.guards.instances[instance as usize];
        state.active = true;
        state.armed = true;
        state.aged = false;
        state.arming += 1;
        state.entry = time;
        state.periods = 0;
        self.draw_hazard(instance);
        for index in self.guards.atoms_of(instance) {
            // What was on its boundary in this instant is so still, if nothing has moved.
            if self.guards.atoms[index].certified != time {
                self.guards.atoms[index].slack = 0.0;
            }
            self.guards.atoms[index].sideless = true;
            if !self.guards.atoms[index].left_out && !self.settle_far(index) {
                self.settle(index, rule, &Written::default());
                if rule == Rule::Rates {
                    self.hold_until_calm(index);
                }
            }
        }
        let first = self.guards.instances[instance as usize].rising as usize;
        let n_rising = self.guards.definition(instance).n_rising;
        self.guards.rising[first..first + n_rising].fill(false);
        self.note_rising(instance);
        self.set_schedule(instance)
    }

    /// Whether an instance fires when nothing is left of a hazard.
    pub fn is_hazard(&self, instance: u32) -> bool {
        matches!(self.guards.definition(instance).trigger(), Some(Trigger::Rate { .. }))
    }

    /// Takes an instance out, whose mode has just been left.
    fn disarm(&mut self, instance: u32) {
        let state = &mut self.guards.instances[instance as usize];
        state.active = false;
        state.armed = false;
        state.arming += 1;
        for index in self.guards.atoms_of(instance) {
            self.guards.atoms[index].version += 1;
        }
    }

    /// Notes which conditions of `rising` are false now.
    pub fn note_rising(&mut self, instance: u32) {
        if self.guards.definition(instance).n_rising > 0 {
            for flag in self.truths().seen_false(instance) {
                self.guards.rising[flag] = true;
            }
        }
    }

    /// Reads the delay or period of an instance that is being armed, and puts its first time into the queue.
    fn set_schedule(&mut self, instance: u32) -> Result<(), Failure> {
        let Some(transition) = self.guards.definition(instance).origin.transition() else { return Ok(()) };
        let (function, least) = match &transition.trigger {
            Trigger::When(_) | Trigger::Rate { .. } | Trigger::On { .. } => return Ok(()),
            Trigger::Chance { .. } => {
                // Nothing has been drawn.
                self.guards.instances[instance as usize].delay = f64::NAN;
                return Ok(());
            }
            Trigger::After { delay, .. } => (*delay, 0.0),
            Trigger::Every { period, .. } => (*period, f64::MIN_POSITIVE),
        };
        let slots = self.guards.slots(&self.agents, instance);
        let own = self.guards.roots(instance);
        let value = truth::value(&self.agents, &mut self.present, function, &transition.frame, &slots, &own);
        let stands_still = least > 0.0 && value < time_resolution(self.present.time);
        if !(value >= least && value < f64::INFINITY) || stands_still {
            let blame = self.blame(function, &transition.frame, &slots, &own);
            let place = self.place(slots[0]);
            return Err(Reason::BadDelay { place, value, blame, span: transition.span }.into());
        }
        let state = &mut self.guards.instances[instance as usize];
        state.delay = value;
        if value == 0.0 {
            state.aged = true;
        } else {
            self.queue_schedule(instance);
        }
        Ok(())
    }

    /// Puts the next time of an `after` or `every` into the queue; a time within 4 ulp of the end is the end (rule 11).
    pub fn queue_schedule(&mut self, instance: u32) {
        let state = &self.guards.instances[instance as usize];
        let time = scheduled(state.entry + (state.periods + 1) as f64 * state.delay, self.time_end);
        self.queues.schedules.push(Due { time, number: instance, version: state.arming });
    }

    /// Finds the truth of an atom at the present instant, and has it certified from here on.
    pub fn settle(&mut self, index: usize, rule: Rule, written: &Written) {
        let (atom, slots) = self.guards.atom_slots(&self.agents, index);
        let time = self.present.time;
        let mut before = self.guards.atoms[index];
        // What has no side counts as not negative, whatever it was before it was armed.
        before.truth &= !(before.sideless && atom.relation == Relation::Crossing);
        let absent = atom.slots.iter().any(|&slot| slots[slot] == ABSENT);
        let kernel = self.program.kernel(atom.value);
        self.curves.evaluations += 1;
        self.curves.operations += kernel.operations();
        let folds = self.truths().gather(before.instance, kernel, &slots, Side::After);
        let g = truth::evaluate(&self.agents, &mut self.present, kernel, &slots, &folds);
        let (mut touched, mut enters, mut stands) = (false, false, false);
        let unchanged = rule == Rule::Woken
            && folds.is_empty()
            && !self.leads_elsewhere(index, written)
            && self.value_before(kernel, &slots, written) == Some(g);
        let zero = self.guards.zeros.get(index, time);
        let anew = folds.is_empty()
            && match rule {
                Rule::Fresh => false,
                Rule::Woken => !unchanged,
                Rule::Rates => self.value_before(kernel, &slots, written).is_some_and(|old| old != g),
            };
        let goes_on = rule == Rule::Rates && !anew;
        let by_approach = if goes_on { self.width_by_approach(atom, &slots) } else { 0.0 };
        // A zero that is written from what was zero in this instant is known no better than that was.
        let known = match (anew, rule) {
            (true, _) => zero.map_or(0.0, |zero| zero.width),
            (false, Rule::Fresh | Rule::Woken) if !unchanged => 0.0,
            (false, _) => before.slack.max(by_approach),
        };
        if anew {
            self.guards.atoms[index].slack = if g.abs() <= known { known } else { 0.0 };
        }
        let mut has_side = true;
        let truth = if g.is_nan() || absent && !g.is_finite() {
            has_side = false;
            false
        } else if unchanged && before.rooted {
            (touched, has_side) = (before.touched, !before.sideless);
            before.truth
        } else if unchanged && before.slack == 0.0 {
            // Off its boundary, and nothing that it reads has changed: only its rates have.
            has_side = !before.sideless;
            before.truth
        } else if let Some(jumps) = &atom.jumps {
            let given_afresh = rule == Rule::Fresh || rule == Rule::Woken && !unchanged;
            let side =
                if given_afresh && atom.relation != Relation::Crossing { Side::At } else { Side::After };
            let truth = self.truth_on(side, jumps, (&slots, &folds), before.truth);
            if atom.relation == Relation::Crossing && before.sideless {
                // Where neither side is told, it stays as it was.
                has_side = truth == self.truth_on(side, jumps, (&slots, &folds), !before.truth);
            }
            truth
        } else {
            // Where g can jump in a way that is not known, a bound of its rounding may be the height of the jump: then its sign
            // is taken as it is.
            let rounding = if atom.smooth { self.rounding(kernel, &slots, &folds) } else { 0.0 };
            let clear = g.abs() > known.max(rounding);
            let along = if unchanged { before.truth } else { closed(atom.relation, before.truth) };
            let is_hazard = rule == Rule::Rates && self.is_hazard(before.instance);
            let mut decide = || {
                let decided = self.decide(index, (g, rounding, known), &slots, &folds);
                has_side = decided.is_some();
                decided.unwrap_or(along)
            };
            match rule {
                // What is left of a hazard is as likely to be next to nothing as anything else.
                _ if is_hazard => g < 0.0,
                Rule::Rates => decide(),
                Rule::Woken if unchanged && clear => before.truth,
                Rule::Fresh | Rule::Woken if clear => g < 0.0,
                Rule::Woken if unchanged => decide(),
                Rule::Woken if zero.is_some_and(|zero| zero.by_rates) => {
                    // A `<=` that the rates have decided to be true is so for the whole instant, while it is on its boundary (rule 3).
                    stands =
                        before.rooted && before.truth && g.abs() <= known && closed(atom.relation, false);
                    stands || decide()
                }
                Rule::Fresh | Rule::Woken if atom.relation == Relation::Crossing => decide(),
                Rule::Fresh | Rule::Woken if atom.relation == Relation::Negative && atom.smooth => {
                    // The infimum of the times at which it is true is this one (rule 3), though it is not true at it.
                    enters = decide();
                    enters
                }
                Rule::Fresh | Rule::Woken => closed(atom.relation, false),
            }
        };
        // A sign that has changed in this instant has done so, whatever is written afterwards.
        if atom.relation == Relation::Crossing
            && rule == Rule::Woken
            && (before.touched || truth != before.truth && !before.sideless)
        {
            touched = true;
        }
        let state = &mut self.guards.atoms[index];
        state.truth = truth;
        state.sideless = before.sideless && !has_side;
        state.touched = touched;
        let by_rates = rule == Rule::Rates || zero.is_some_and(|zero| zero.by_rates);
        let width =
            zero.map_or_else(|| Zero::width_of(state.slack, time).max(by_approach), |zero| zero.width);
        let zero = (state.slack > 0.0).then_some(Zero { width, by_rates });
        state.rooted = enters || stands || rule == Rule::Woken && before.rooted && unchanged;
        if state.touched || state.rooted {
            self.guards.roused.push(index as u32);
        }
        if rule != Rule::Fresh {
            self.guards.zeros.set(index, time, zero);
        }
        let kept = unchanged && before.rooted;
        self.recertify(index, if kept { before.certified.max(time) } else { time });
        self.guards.atoms[index].settled = !(unchanged && before.slack == 0.0);
    }

    /// Whether a comparison reads something that was written.
    pub fn reads_written(&self, index: usize, written: &Written) -> bool {
        let (atom, slots) = self.guards.atom_slots(&self.agents, index);
        let is_written = |agent: usize| written.before.contains_key(&agent);
        if atom.slots.iter().any(|&slot| is_written(slots[slot])) || self.leads_elsewhere(index, written) {
            return true;
        }
        // What is written may be what a flow reads: then the rates are others.
        let follows_anew = |&slot: &usize| written.restarted.contains(&slots[slot]);
        if depth_read(self.program.kernel(atom.value)) != Depth::States && atom.slots.iter().any(follows_anew)
        {
            return true;
        }
        let quantified = &self.guards.definition(self.guards.atoms[index].instance).quantified;
        let may_belong = |&agent: &usize| quantified.contains(&self.agents.agents[agent].ty);
        !atom.folds.is_empty()
            && (written.before.keys().chain(&written.born).any(may_belong)
                || written.died.iter().any(|ty| quantified.contains(ty)))
    }

    /// Whether a link by which a comparison reaches an agent leads somewhere else now.
    pub fn leads_elsewhere(&self, index: usize, written: &Written) -> bool {
        if written.relinked.is_empty() {
            return false;
        }
        let (atom, slots) = self.guards.atom_slots(&self.agents, index);
        let frame = self.guards.definition(self.guards.atoms[index].instance).frame;
        atom.slots.iter().any(|&slot| {
            let mut slot = slot;
            while let Slot::Link { from, .. } = frame.slots[slot] {
                if written.relinked.contains(&slots[from]) {
                    return true;
                }
                slot = from;
            }
            false
        })
    }

    /// Has an atom certified from `time` on; what was found beyond is void.
    pub fn recertify(&mut self, index: usize, time: f64) {
        let state = &mut self.guards.atoms[index];
        if state.left_out {
            return;
        }
        state.certified = time;
        state.far = f64::INFINITY;
        state.flip = f64::INFINITY;
        state.settled = false;
        state.version += 1;
        let due = Due { time, number: index as u32, version: state.version };
        self.queues.uncertified.push(due);
    }

    /// Rule 3, "On the boundary": by the first of two rates that is not zero within rounding; none where neither decides.
    fn decide(
        &mut self,
        index: usize,
        (g, rounding, known): (f64, f64, f64),
        slots: &Slots,
        folds: &[Folded<'_>],
    ) -> Option<bool> {
        let (atom, _) = self.guards.atom_slots(&self.agents, index);
        let kernel = self.program.kernel(atom.rates);
        let jet = truth::jet(&self.agents, &mut self.present, kernel, slots, folds);
        let state = &mut self.guards.atoms[index];
        // Beside a pole the rate says nothing of how near zero is.
        let by_rate =
            known.max(jet[1].abs() * time_resolution(self.present.time)).min(1e-3 * (1.0 + g.abs()));
        let band = by_rate.max(rounding);
        if g.abs() > band || !jet[1].is_finite() {
            state.slack = if g.abs() > band { 0.0 } else { state.slack };
            return Some(g < 0.0);
        }
        state.slack = band;
        let bounds = if atom.smooth { self.jet_rounding(kernel, slots, folds, None) } else { [0.0; 3] };
        let direction = match self.direction_at_turn(atom, slots, folds) {
            Some(direction) => direction,
            None => direction(&jet, &bounds),
        };
        match direction {
            Direction::Up => Some(false),
            Direction::Down => Some(true),
            Direction::Along => None,
        }
    }

    /// The way that g goes from here, if its rates are not the same on both sides (`abs(x)` at 0): by what it is a little later on the
    /// way that states, rates and second rates foretell. None if its rates do not turn here, or it reads more than states.
    fn direction_at_turn(&mut self, atom: &Atom, slots: &Slots, folds: &[Folded<'_>]) -> Option<Direction> {
        let kernel = self.program.kernel(atom.value);
        let turns = self.program.kernel(atom.turns?);
        if !folds.is_empty() || depth_read(kernel) != Depth::States || depth_read(turns) != Depth::States {
            return None;
        }
        self.present.make(&self.agents, slots, Depth::Accelerations);
        let views = self.present.views(&self.agents, slots);
        let mut out: SmallVec<[f64; 4]> = SmallVec::from_elem(f64::NAN, turns.n_outputs());
        turns.eval(&views, self.present.time, &mut out);
        if !out.iter().any(|turn| turn.abs() <= AT_TURN) {
            return None;
        }
        let time = self.present.time;
        for exponent in LATER {
            let later = f64::powi(10.0, exponent) * (1.0 + time.abs());
            let moved: Vec<Vec<f64>> =
                slots.iter().map(|&agent| self.present.foretold(agent, later)).collect();
            let mut views = self.present.views(&self.agents, slots);
            for (view, states) in views.iter_mut().zip(&moved) {
                view.states = states;
            }
            let mut g = [0.0];
            kernel.eval(&views, time + later, &mut g);
            if g[0].abs() > 1e-3 * later.powi(2) {
                return Some(if g[0] > 0.0 { Direction::Up } else { Direction::Down });
            }
        }
        Some(Direction::Along)
    }

    /// The value of a kernel on the rows before the micro-step; none if a rate would be needed.
    fn value_before(&self, kernel: &Kernel, slots: &Slots, written: &Written) -> Option<f64> {
        if depth_read(kernel) != Depth::States {
            return None;
        }
        let mut views = self.present.views(&self.agents, slots);
        for (view, &agent) in views.iter_mut().zip(slots) {
            if let Some((states, aux)) = written.before.get(&agent) {
                *view = AgentView { states, rates: &[], accelerations: &[], aux };
            }
        }
        let mut out = [0.0];
        kernel.eval(&views, self.present.time, &mut out);
        Some(out[0])
    }

    /// Disarms what belongs to modes that a micro-step left or entered; returns the instances of those entered, which are to be
    /// armed when links lead where they should (rule 4).
    pub fn change_modes(&mut self, written: &Written) -> Vec<u32> {
        let mut entered = Vec::new();
        for change in &written.moves {
            for instance in self.guards.of_agent[change.agent].clone() {
                let definition = self.guards.definition(instance);
                if definition.mode == 0 || matches!(definition.origin, Origin::Pair(_)) {
                    continue;
                }
                let enters = change.entered.contains(&definition.mode);
                if enters || change.left.contains(&definition.mode) {
                    self.disarm(instance);
                }
                if enters {
                    entered.push(instance);
                }
            }
        }
        entered
    }

    /// Follows up what a micro-step wrote: arms what is new, settles what reads a written agent, has recertified what
    /// reads a restarted one. Returns the instances that may now fire, rising.
    pub fn wake(&mut self, written: &Written) -> Result<Vec<u32>, Failure> {
        let mut armed: FxHashSet<u32> = FxHashSet::default();
        let noticed = written.before.keys().filter(|&&agent| self.is_noticed(agent, written));
        let mut concerned: Vec<usize> = noticed.chain(&written.restarted).copied().collect();
        concerned.sort_unstable();
        concerned.dedup();
        armed.extend(self.relist(&concerned, &written.born)?);
        self.arm_born(written, &mut armed)?;
        let is_written = |agent: usize| written.before.contains_key(&agent);
        let is_concerned = |agent: usize| is_written(agent) || written.restarted.contains(&agent);
        let mut woken = Vec::new();
        let mut reading = self.reading(&concerned);
        for &ty in &written.died {
            reading.extend_from_slice(&self.guards.over_type[ty]);
        }
        reading.extend_from_slice(&written.bereft);
        reading.sort_unstable();
        reading.dedup();
        let mut reach: Vec<usize> = concerned.iter().flat_map(|&agent| self.agents.readers(agent)).collect();
        reach.sort_unstable();
        reach.dedup();
        self.monitors.doubt(&reach, |agent| self.agents.agents[agent].ty);
        for instance in reading {
            if !self.guards.instances[instance as usize].active {
                continue;
            }
            let fresh = armed.contains(&instance);
            for index in self.concerned_atoms(instance, &reach) {
                if self.guards.atoms[index].left_out {
                    continue;
                }
                let regard = if fresh { Regard::Changed } else { self.regard(index, written) };
                let (atom, slots) = self.guards.atom_slots(&self.agents, index);
                let mut read = atom.slots.iter().map(|&slot| slots[slot]);
                let AtomState { slack, rooted, touched, .. } = self.guards.atoms[index];
                let is_plain = slack == 0.0 && !rooted && !touched;
                let is_just_armed = fresh && self.guards.atoms[index].certified == self.present.time;
                if regard == Regard::Far || is_just_armed {
                    continue;
                } else if regard == Regard::AsBefore && is_plain {
                    self.recertify(index, self.present.time);
                } else if !fresh && self.reads_written(index, written) {
                    self.settle(index, Rule::Woken, written);
                } else if !atom.folds.is_empty() || read.any(is_concerned) {
                    let state = &self.guards.atoms[index];
                    if !state.rooted {
                        self.recertify(index, state.certified.min(self.present.time));
                    }
                }
            }
            woken.push(instance);
        }
        for &instance in &woken {
            self.note_rising(instance);
        }
        Ok(woken)
    }

    /// Whether what was written to an agent may be of interest to a guard.
    fn is_noticed(&self, agent: usize, written: &Written) -> bool {
        let Agent { ty, aux, .. } = &self.agents.agents[agent];
        written.relinked.contains(&agent) || self.guards.noticed.any(*ty, &written.before[&agent].1, aux)
    }

    /// The atoms of an instance that may read one of these agents, or reach one by links: all, if it is one of its own; else
    /// those that are bound to one, if it has no aggregates.
    fn concerned_atoms(&self, instance: u32, reach: &[usize]) -> Vec<usize> {
        let definition = self.guards.definition(instance);
        let is_own = self.guards.roots(instance).iter().any(|root| reach.binary_search(root).is_ok());
        if is_own || !definition.folds.is_empty() || definition.quantified.is_empty() {
            return self.guards.atoms_of(instance).collect();
        }
        let bound = reach.iter().filter(|&&agent| definition.binds(self.agents.agents[agent].ty));
        let mut atoms: Vec<usize> =
            bound.flat_map(|&agent| self.guards.atoms_at(&self.agents, instance, agent)).collect();
        atoms.sort_unstable();
        atoms.dedup();
        atoms
    }

    /// Arms the guards of agents that have come to be, and has those that range over them look at them; nothing is held.
    fn arm_born(&mut self, written: &Written, armed: &mut FxHashSet<u32>) -> Result<(), Failure> {
        for &agent in &written.born {
            for instance in self.guards.of_agent[agent].clone() {
                let definition = self.guards.definition(instance);
                let is_pair = matches!(definition.origin, Origin::Pair(_));
                let first = self.guards.instances[instance as usize].roots[0] as usize;
                if (is_pair || inside(&self.agents, first, definition.mode)) && armed.insert(instance) {
                    self.arm(instance, Rule::Fresh)?;
                }
            }
        }
        for &agent in &written.born {
            for instance in self.guards.over_type[self.agents.agents[agent].ty].clone() {
                if !self.guards.instances[instance as usize].active || armed.contains(&instance) {
                    continue;
                }
                for index in self.guards.atoms_at(&self.agents, instance, agent) {
                    if !self.guards.atoms[index].left_out && !self.settle_far(index) {
                        self.settle(index, Rule::Fresh, &Written::default());
                    }
                }
            }
        }
        Ok(())
    }

    /// The instances that read any of these agents (or reach them by links), rising.
    pub fn reading(&self, agents: &[usize]) -> Vec<u32> {
        let mut instances = Vec::new();
        for &agent in agents {
            for reader in self.agents.readers(agent) {
                instances.extend_from_slice(&self.guards.of_agent[reader]);
                instances.extend_from_slice(self.guards.candidates.looking_at(reader));
            }
        }
        let mut types: Vec<usize> = agents.iter().map(|&agent| self.agents.agents[agent].ty).collect();
        types.sort_unstable();
        types.dedup();
        for ty in types {
            instances.extend_from_slice(&self.guards.over_type[ty]);
        }
        instances.sort_unstable();
        instances.dedup();
        instances
    }

    /// Whether an instance would fire now.
    pub fn enabled(&self, instance: u32) -> bool {
        let state = &self.guards.instances[instance as usize];
        if !(state.active && state.armed) {
            return false;
        }
        let Some(transition) = self.guards.definition(instance).origin.transition() else { return false };
        match &transition.trigger {
            Trigger::Every { .. } | Trigger::On { .. } | Trigger::Chance { .. } => false,
            Trigger::After { .. } => state.aged && self.truths().holds_now(instance),
            Trigger::When(_) | Trigger::Rate { .. } => self.truths().holds_now(instance),
        }
    }

    /// Rule 2: a disarmed guard is armed again when it is next false.
    pub fn rearm(&mut self, instance: u32) {
        let state = &self.guards.instances[instance as usize];
        // What was true at the instant is so until its end, whatever else happens in it.
        if state.active && !state.armed && !self.truths().holds_now(instance) {
            self.guards.instances[instance as usize].armed = true;
        }
    }

    /// Arms everything that is active at t = 0.
    pub fn arm_all(&mut self) -> Result<(), Failure> {
        for instance in 0..self.guards.instances.len() as u32 {
            let definition = self.guards.definition(instance);
            if !self.guards.is_listed(instance) {
                continue;
            }
            let agent = self.guards.instances[instance as usize].roots[0] as usize;
            if matches!(definition.origin, Origin::Pair(_)) || inside(&self.agents, agent, definition.mode) {
                self.arm(instance, Rule::Fresh)?;
            }
        }
        Ok(())
    }
}
