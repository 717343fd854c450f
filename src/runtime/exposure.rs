//! Rule 11, of pairs: what is left of the hazard of an interaction whose rate changes along the flow.
//!
//! No agent has a state for it. A pair is *exposed* while its guard is true; then the hazard is integrated on the dense output of whom
//! it reads, by quadrature, up to the clock of the one that lags most, as a comparison is certified. What is found ahead is void
//! when one of them is written: before that, the hazard is taken away up to the instant.

use crate::codegen::program::{FunctionId, Slot, TransitionSystem, Trigger};
use crate::runtime::agenda::Due;
use crate::runtime::engine::Engine;
use crate::runtime::exposed::Exposure;
use crate::runtime::failure::Failure;
use crate::runtime::guards::Origin;
use crate::runtime::population::{ABSENT, Slots};
use crate::runtime::present::{Depth, Present, depth_read};
use crate::runtime::solve::quadrature::{Spent, spend};
use crate::runtime::solve::{scheduled, time_resolution};
use crate::runtime::truth;

/// The share of the tolerance of the run to which an integral over a stretch is known.
const SHARE: f64 = 1e-3;

/// So much of an integral may lie between the bounds of a stretch that is not divided.
const UNSEEN_MAX: f64 = 1.0;
/// Into so many stretches one is divided at most.
const STRETCHES_MAX: usize = 1024;

impl Engine<'_, '_> {
    /// A pair has become exposed or is so no more; its guard, its arming or what has fired may be the reason. `open`: whether its guard is
    /// true just after the instant.
    pub fn set_exposure(&mut self, instance: u32, transition: &TransitionSystem, open: bool) {
        let is_new = self.guards.instances[instance as usize].delay.is_nan();
        if is_new {
            let left = self.draw_for_pair(instance, transition, 1.0);
            self.guards.instances[instance as usize].delay = left;
            self.exposures.of.remove(&instance);
        } else {
            self.catch_up(instance);
        }
        let is_exposed = self.exposure(instance).is_some();
        let state = &mut self.guards.instances[instance as usize];
        if open && !is_exposed {
            let left = state.delay;
            self.expose_anew(instance, left);
            self.exposures.are_wide |= self.is_wide(instance);
        } else if !open && let Some(exposure) = self.exposures.of.remove(&instance) {
            state.arming += 1;
            state.delay = exposure.left;
        }
    }

    /// Whether the hazard of a pair reads more agents than the two.
    fn is_wide(&self, instance: u32) -> bool {
        let frame = self.guards.definition(instance).frame;
        frame.slots.len() > 2 || !frame.folds.is_empty()
    }

    /// The agents over which the hazard of a pair ranges.
    fn ranged_over(&self, instance: u32) -> Vec<usize> {
        let frame = self.guards.definition(instance).frame;
        let quantified = frame.slots.iter().skip(2).filter(|slot| matches!(slot, Slot::Root { .. }));
        let mut types: Vec<usize> = quantified.map(|slot| slot.ty()).collect();
        types.extend(frame.folds.iter().map(|fold| fold.range.ty));
        types.sort_unstable();
        types.dedup();
        types.iter().flat_map(|&ty| self.agents.of_type[ty].iter().copied()).collect()
    }

    fn exposure(&self, instance: u32) -> Option<&Exposure> {
        let arming = self.guards.instances[instance as usize].arming;
        self.exposures.of.get(&instance).filter(|exposure| exposure.arming == arming)
    }

    /// Whether a hazard that flows reads an agent now: then it takes its steps in turn.
    pub fn is_exposed(&self, agent: usize) -> bool {
        let of_agent =
            || self.guards.of_agent[agent].iter().any(|&instance| self.exposure(instance).is_some());
        !self.exposures.of.is_empty() && (self.exposures.are_wide || of_agent())
    }

    /// Takes hazards away up to the present that read an agent, who is about to be written or to follow another way.
    pub fn catch_up_with(&mut self, agent: usize) {
        if self.exposures.of.is_empty() || self.exposures.are_wide {
            return;
        }
        for k in 0..self.guards.of_agent[agent].len() {
            self.catch_up(self.guards.of_agent[agent][k]);
        }
    }

    /// The same for all, at the begin of an instant, if a hazard reads more agents than its two: their sets and links may change.
    pub fn catch_up_with_all(&mut self) {
        if self.exposures.are_wide {
            let Self { exposures, guards, .. } = self;
            exposures
                .of
                .retain(|&instance, exposure| guards.instances[instance as usize].arming == exposure.arming);
            exposures.are_wide = !exposures.of.is_empty();
            let all: Vec<u32> = exposures.of.keys().copied().collect();
            all.into_iter().for_each(|instance| self.catch_up(instance));
        }
    }

    /// Takes the hazard of a pair away up to the present; what is known of it beyond is void.
    fn catch_up(&mut self, instance: u32) {
        let now = self.present.time;
        // What is due now has been collected, and fires in this instant.
        let Some(&exposure) = self.exposure(instance).filter(|exposure| exposure.due != Some(now)) else {
            return;
        };
        let left = if exposure.undefined.is_some() && exposure.known <= now {
            // What has no hazard beyond ends here.
            exposure.rest
        } else {
            match self.spend(instance, (exposure.since, now), exposure.left) {
                Spent::Left(left) | Spent::Undefined { left, .. } => left,
                Spent::At(_) => 0.0,
            }
        };
        self.expose_anew(instance, left);
    }

    /// A pair is exposed from the present on, with this left; what was known of it is void.
    fn expose_anew(&mut self, instance: u32, left: f64) {
        let now = self.present.time;
        let state = &mut self.guards.instances[instance as usize];
        state.arming += 1;
        let arming = state.arming;
        self.exposures.of.insert(instance, Exposure::beginning(arming, now, left));
        self.queues.exposed.push(Due { time: now, number: instance, version: arming });
    }

    /// Follows the hazards of all exposed pairs up to the cover at least.
    pub fn expose_up_to(&mut self, cover: f64) -> Result<(), Failure> {
        let mut waiting = Vec::new();
        let mut done = Ok(());
        while let Some(&due) = self.queues.exposed.peek() {
            let enough = self.enough(cover);
            if due.time >= enough || self.interrupted() {
                break;
            }
            self.queues.exposed.pop();
            let valid = self.exposure(due.number).filter(|exposure| exposure.arming == due.version);
            let Some(&Exposure { undefined, .. }) = valid else { continue };
            if let Some(hazard) = undefined {
                // What comes with it may end it: a guard whose boundary it is.
                let soon = due.time + self.event_tolerance(due.time);
                if soon < enough && soon < self.next_cause() {
                    done = Err(self.no_hazard(due, hazard));
                    break;
                }
                waiting.push(due);
                continue;
            }
            self.expose(due);
            if self.has_thawed {
                waiting.push(due);
                break;
            }
        }
        self.queues.exposed.extend(waiting);
        done
    }

    /// Follows the hazard of a pair from where it is known on.
    fn expose(&mut self, due: Due) {
        let Due { time: from, number: instance, version: arming } = due;
        let slots = self.guards.slots(&self.agents, instance);
        let mut to = f64::INFINITY;
        if self.is_wide(instance) {
            to = self.cover().min(self.window_end);
            for agent in self.ranged_over(instance) {
                self.thaw_at(agent, from);
            }
        }
        for &agent in slots.iter().filter(|&&agent| agent != ABSENT) {
            self.thaw_at(agent, from);
            to = to.min(self.groups.groups[self.agents.agents[agent].group].clock);
        }
        if to == f64::INFINITY {
            // Nothing but the time flows: a stretch at a time.
            to = from + from.max(1.0);
        }
        let to = to.min(self.time_end);
        let Some(left) = self.exposure(instance).map(|exposure| exposure.rest) else { return };
        if self.has_thawed || to <= from {
            return;
        }
        let mut ahead = Exposure { known: to, ..Exposure::beginning(arming, from, left) };
        match self.spend(instance, (from, to), left) {
            Spent::Left(rest) => ahead.rest = rest,
            Spent::At(time) => {
                let time = scheduled(time, self.time_end);
                (ahead.known, ahead.due) = (f64::INFINITY, Some(time));
                self.queues.schedules.push(Due { time, number: instance, version: arming });
            }
            Spent::Undefined { time, value, left } => {
                (ahead.known, ahead.rest, ahead.undefined) = (time, left, Some(value));
            }
        }
        self.exposures.of.insert(instance, ahead);
        if ahead.known < self.time_end {
            self.queues.exposed.push(Due { time: ahead.known, ..due });
        }
    }

    /// Divides a stretch where bounds of a hazard allow more than quadrature may see by its values: a peak between them.
    fn stretches(&mut self, rate: FunctionId, slots: &Slots, whole: (f64, f64)) -> Vec<(f64, f64)> {
        let kernel = self.program.kernel(rate);
        let (mut parts, mut found) = (vec![whole], Vec::new());
        if depth_read(kernel) != Depth::States || slots.contains(&ABSENT) {
            return parts;
        }
        while let Some((from, to)) = parts.pop() {
            let bound = self.range_by_tracks(rate, slots, (from, to));
            let unseen = bound.map_or(0.0, |bound| (bound.hi - bound.lo) * (to - from));
            let middle = 0.5 * (from + to);
            let is_divisible = from < middle && middle < to && found.len() + parts.len() < STRETCHES_MAX;
            if unseen.is_finite() && unseen > UNSEEN_MAX && is_divisible {
                parts.extend([(middle, to), (from, middle)]);
            } else {
                found.push((from, to));
            }
        }
        found
    }

    /// Takes the hazard of a pair over a stretch, on which its agents are known, away from `left`.
    fn spend(&mut self, instance: u32, (from, to): (f64, f64), left: f64) -> Spent {
        let Origin::Pair(pair) = self.guards.definition(instance).origin else { return Spent::Left(left) };
        let Trigger::Chance { rate, .. } = pair.transition.trigger else { return Spent::Left(left) };
        if to <= from {
            return Spent::Left(left);
        }
        let (slots, own) = (self.guards.slots(&self.agents, instance), self.guards.roots(instance));
        let stretches = self.stretches(rate, &slots, (from, to));
        let mut rows = self.exposures.rows.take().unwrap_or_else(|| Present::new(&self.agents));
        rows.make_room(self.agents.len());
        rows.forget();
        let mut n_values = 0;
        let mut hazard = |time: f64| {
            n_values += 1;
            rows.go(time);
            truth::value(&self.agents, &mut rows, rate, &pair.transition.frame, &slots, &own)
        };
        let accuracy = SHARE * self.program.run.tolerance.min(1e-3);
        let mut spent = Spent::Left(left);
        for stretch in stretches {
            let Spent::Left(left) = spent else { break };
            spent = spend(&mut hazard, stretch, left, accuracy, 0.25 * time_resolution(from));
        }
        self.curves.evaluations += n_values;
        self.curves.operations += n_values * self.program.kernel(rate).operations();
        self.exposures.rows = Some(rows);
        spent
    }

    /// The hazard of a pair is negative or not finite from here on.
    fn no_hazard(&mut self, due: Due, hazard: f64) -> Failure {
        self.present.go(due.time);
        let instance = due.number;
        let (slots, own) = (self.guards.slots(&self.agents, instance), self.guards.roots(instance));
        let Origin::Pair(pair) = self.guards.definition(instance).origin else {
            unreachable!("only pairs are exposed")
        };
        self.bad_hazard(&pair.transition, (&slots, &own), hazard)
    }
}
