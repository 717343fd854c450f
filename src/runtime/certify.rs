//! Certification (I2, I3, I6): each comparison is known not to change up to a time, or known to change at one.
use smallvec::SmallVec;

use crate::codegen::program::{Atom, Relation};
use crate::runtime::agenda::Due;
use crate::runtime::atom_state::{AtomState, Leap, closed};
use crate::runtime::branches::{Jumping, width};
use crate::runtime::detect::AtomCurve;
use crate::runtime::engine::Engine;
use crate::runtime::fold::{self, Folded};
use crate::runtime::observe::WhyUndecided;
use crate::runtime::population::{ABSENT, Slots};
use crate::runtime::present::Depth;
use crate::runtime::sleep::FEW;
use crate::runtime::solve::roots::{Curve, Known, Search, first_flip};
use crate::runtime::solve::{time_resolution, ulp};
use crate::runtime::truth::{self, Side};

/// A run without an end that gets here will not stop by itself, s.
pub const ENDLESS: f64 = 1e15;

/// How often at most a comparison is looked at before it tries again to sleep.
const BACKOFF_MAX: u16 = 64;

/// So many parts of a stretch are looked at for a side of a `crossing` that had none.
const PARTS_MAX: usize = 512;

impl Engine<'_, '_> {
    /// Certifies every atom up to the cover at least; without a cover, up to what happens next.
    pub fn certify_up_to(&mut self, cover: f64) {
        // The loop ends the run; until then a search of many roots must not go on.
        while !self.interrupted() {
            let until = self.enough(cover).min(self.window_end);
            let Some(due) = self.queues.uncertified.pop_before(until) else { return };
            if self.guards.atoms[due.number as usize].version == due.version {
                self.certify(due.number as usize, false);
            }
            if self.has_thawed {
                // The cover may have shrunk.
                return;
            }
        }
    }

    /// Up to when all has to be known, s: to the cover, but not beyond the instant that comes next.
    pub fn enough(&mut self, cover: f64) -> f64 {
        let cause = self.next_cause();
        if cover == f64::INFINITY {
            return (cause + 1.0).min(ENDLESS);
        }
        if cause < cover { cover.min(cause + 2.0 * self.event_tolerance(cause)) } else { cover }
    }

    /// Looks once more at every atom that is certified up to the cover only: a root that is due within the resolution of
    /// time counts as being there.
    pub fn certify_at(&mut self, cover: f64) {
        let mut due_here = Vec::new();
        let until = cover.next_up().min(self.window_end);
        while let Some(due) = self.queues.uncertified.pop_before(until) {
            if self.guards.atoms[due.number as usize].version == due.version {
                due_here.push(due.number as usize);
            }
        }
        for index in due_here {
            self.certify(index, true);
        }
    }

    /// Certifies one atom on the stretch that all its agents' segments cover, or finds its next change there.
    fn certify(&mut self, index: usize, blocked: bool) {
        let (atom, slots) = self.guards.atom_slots(&self.agents, index);
        let from = self.guards.atoms[index].certified;
        self.guards.atoms[index].far = f64::INFINITY;
        let kernel = self.program.kernel(atom.value);
        let folds = self.truths().gather(self.guards.atoms[index].instance, kernel, &slots, Side::After);
        let mut to = self.time_end;
        let read = atom.slots.iter().map(|&slot| slots[slot]).filter(|&agent| agent != ABSENT);
        let cold = read.clone().chain(fold::members(&folds)).filter(|&agent| self.agents.cold.is_cold(agent));
        let cold: SmallVec<[usize; 4]> = cold.collect();
        if !cold.is_empty() {
            if !self.sleep_beyond(index, self.window_end) {
                self.recertify(index, from);
                // All else is certified up to `from`.
                let told = self.recorder.next().min(self.next_step());
                let time = from.min(self.next_cause()).min(told).max(self.present.time);
                cold.into_iter().for_each(|agent| self.thaw_at(agent, time));
            }
            return;
        }
        for agent in read.chain(fold::members(&folds)) {
            to = to.min(self.groups.groups[self.agents.agents[agent].group].clock);
        }
        to = to.min(self.known_end(index, from));
        if to == f64::INFINITY {
            // Nothing but the time is read, and the run has no end: a stretch at a time.
            to = from + from.max(1.0);
        }
        let absent = atom.slots.iter().any(|&slot| slots[slot] == ABSENT);
        if absent && truth::evaluate(&self.agents, &mut self.present, kernel, &slots, &folds).is_nan() {
            let sideless = self.guards.atoms[index].sideless;
            self.certified(index, self.time_end);
            self.guards.atoms[index].sideless = sideless;
            return;
        }
        let by_rates = fold::depth(self.program, kernel, &folds) != Depth::States;
        if !blocked
            && !by_rates
            && let Some(until) = self.sleep(index, (atom, &slots, &folds), from, to)
        {
            self.certified(index, until);
            return;
        }
        // At a kink the flow may turn back from a boundary that it reaches there.
        let touches = may_touch(atom, &self.guards.atoms[index]) && self.ends_at_kink(&slots, to);
        if !blocked && !touches && self.is_clear(index, (from, to)) {
            self.certified(index, to);
            return;
        }
        let state = self.guards.atoms[index];
        let known = Known {
            truth: state.truth,
            closed: closed(atom.relation, state.truth),
            slack: state.slack,
            settled: state.settled,
            grazed: state.grazed == from,
            joins: !state.settled && state.slack == 0.0,
            reach: if blocked || touches { time_resolution(to) } else { 2.0 * ulp(to) },
        };
        let (search, leap) = self.search(atom, (&slots, &folds), from, to, known);
        let end = match &search {
            Search::Flip(flip) => flip.time,
            Search::Until(until) => *until,
            Search::None | Search::Along | Search::Undecided => to,
        };
        let sideless = state.sideless
            && atom.relation == Relation::Crossing
            && self.has_no_side((atom, &slots, &folds), (from, end));
        match search {
            Search::None => {
                // It may not have left its boundary yet.
                let stays = known.settled && atom.smooth && self.is_on_boundary((atom, &slots, &folds), to);
                self.certified(index, to);
                self.guards.atoms[index].settled = stays;
            }
            Search::Along => {
                self.certified(index, to);
                let state = &mut self.guards.atoms[index];
                (state.slack, state.settled) = (known.slack, known.settled);
            }
            Search::Until(until) => self.certified(index, until),
            Search::Undecided => {
                self.n_undecided += 1;
                let limit = self.limits.pieces_max;
                self.note_undecided(index, from, to, WhyUndecided::TooManyPieces { limit });
                self.certified(index, to);
            }
            // Where a branch of a flow changes, rates go on by another one: it is looked at from there. Zero itself counts.
            Search::Flip(flip)
                if by_rates
                    && !known.touching()
                    && flip.time >= to - time_resolution(to)
                    && self.ends_at_kink(&slots, to) =>
            {
                self.certified(index, to);
            }
            Search::Flip(flip) => {
                if flip.undecided {
                    self.n_undecided += 1;
                    self.note_undecided(index, flip.near, flip.time, WhyUndecided::Touch);
                }
                let state = &mut self.guards.atoms[index];
                state.flip = flip.time;
                state.near = flip.near;
                state.touch = flip.undecided;
                state.leap = leap;
                if flip.undecided {
                    state.grazed = flip.time;
                }
                state.version += 1;
                self.queues.flips.push(Due { time: flip.time, number: index as u32, version: state.version });
            }
        }
        self.guards.atoms[index].sideless = sideless;
    }

    /// Up to when a comparison, certified up to `from`, is worth looking at, s: an event of those who step together with the agents that it reads has all of
    /// them begin anew, and roots beyond it are void. Infinite if none is known.
    fn known_end(&mut self, index: usize, from: f64) -> f64 {
        let cause = self.next_cause();
        let end = cause + 2.0 * self.event_tolerance(cause);
        let Some(due) = self.queues.flips.peek().filter(|due| due.time == cause && from < end) else {
            return f64::INFINITY;
        };
        let groups_of = |index: usize| {
            let (atom, slots) = self.guards.atom_slots(&self.agents, index);
            let read = atom.slots.iter().map(|&slot| slots[slot]).filter(|&agent| agent != ABSENT);
            let groups = read.map(|agent| self.agents.agents[agent].group);
            let together = |&group: &usize| self.groups.groups[group].members.len() > 1;
            groups.filter(together).collect::<SmallVec<[usize; 4]>>()
        };
        let own = groups_of(index);
        let shares =
            !own.is_empty() && groups_of(due.number as usize).iter().any(|group| own.contains(group));
        if shares { end } else { f64::INFINITY }
    }

    /// Whether g, which was zero at the beginning of a stretch, is positive nowhere in it but for rounding: then it has had no side.
    fn has_no_side(
        &mut self,
        (atom, slots, folds): (&Atom, &Slots, &[Folded<'_>]),
        span: (f64, f64),
    ) -> bool {
        let mut curve = AtomCurve::new(&self.agents, atom, slots, folds, &mut self.curves);
        let mut parts = vec![span];
        for _ in 0..PARTS_MAX {
            let Some((from, to)) = parts.pop() else { return true };
            let middle = 0.5 * (from + to);
            let rounding = if atom.smooth { width(curve.jet_range(middle, middle)[0]) } else { 0.0 };
            if curve.jet(middle)[0] > rounding {
                return false;
            }
            if curve.jet_range(from, to)[0].hi > rounding && from < middle && middle < to {
                parts.extend([(from, middle), (middle, to)]);
            }
        }
        true
    }

    /// Whether g is within rounding of zero at a time.
    fn is_on_boundary(&mut self, (atom, slots, folds): (&Atom, &Slots, &[Folded<'_>]), time: f64) -> bool {
        let mut curve = AtomCurve::new(&self.agents, atom, slots, folds, &mut self.curves);
        let (value, bound) = (curve.jet(time)[0], curve.jet_range(time, time)[0]);
        value.abs() <= width(bound)
    }

    /// Whether the step of an agent in some slots ends at `time` because a branch of its flow changes there.
    fn ends_at_kink(&self, slots: &Slots, time: f64) -> bool {
        slots.iter().filter(|&&agent| agent != ABSENT).any(|&agent| {
            let group = &self.groups.groups[self.agents.agents[agent].group];
            group.clock == time && !group.kinks.is_empty()
        })
    }

    /// The first change of a comparison in (from, to]; and its truths there, if that is where it jumps.
    fn search(
        &mut self,
        atom: &Atom,
        (slots, folds): (&Slots, &[Folded<'_>]),
        from: f64,
        to: f64,
        known: Known,
    ) -> (Search, Option<Leap>) {
        let (pieces_max, interrupt) = (self.limits.pieces_max, self.interrupt);
        let (agents, rows) = (&self.agents, &mut self.curves);
        if let Some(jumps) = &atom.jumps {
            let mut jumping = Jumping { agents, atom, jumps, slots, folds, rows, interrupt, pieces_max };
            return jumping.first_change(from, to, known);
        }
        let mut curve = AtomCurve::new(agents, atom, slots, folds, rows).with_interrupt(interrupt);
        (first_flip(&mut curve, from, to, known, pieces_max), None)
    }

    /// Notes that an atom does not change before `until`.
    pub fn certified(&mut self, index: usize, until: f64) {
        let state = &mut self.guards.atoms[index];
        if until > state.certified {
            (state.slack, state.settled, state.sideless) = (0.0, false, false);
        }
        state.certified = until;
        state.far = f64::INFINITY;
        state.version += 1;
        if until < self.time_end {
            let due = Due { time: until, number: index as u32, version: state.version };
            self.queues.uncertified.push(due);
        }
    }

    /// I6: how long an atom cannot change, if that is longer than its segments reach.
    pub fn sleep(
        &mut self,
        index: usize,
        (atom, slots, folds): (&Atom, &Slots, &[Folded<'_>]),
        from: f64,
        to: f64,
    ) -> Option<f64> {
        let state = &mut self.guards.atoms[index];
        if state.skip > 0 {
            state.skip -= 1;
            return None;
        }
        let together = self.largest_group(slots);
        let state = &mut self.guards.atoms[index];
        if together > FEW && state.backoff == 0 {
            // To bound all of them costs as much as many steps, and whatever happens to one of them ends it.
            (state.backoff, state.skip) = (together, together);
            return None;
        }
        let truth = state.truth;
        let left = if self.time_end.is_finite() { self.time_end - from } else { 1e6 };
        let least = 2.0 * (to - from);
        let mut horizon = if state.stride > 0.0 { state.stride } else { left }.min(left);
        let mut here = None;
        for _ in 0..4 {
            if horizon <= least {
                break;
            }
            let groups = &self.groups.groups;
            let bound =
                self.enclosures.value_range(&self.agents, groups, (atom, slots, folds), from, horizon);
            if bound.is_some_and(|bound| self.guards.atoms[index].is_kept_by(bound)) {
                let state = &mut self.guards.atoms[index];
                (state.stride, state.backoff) = (2.0 * horizon, 0);
                return Some((from + horizon).min(self.time_end));
            }
            // As far as a straight line from g here to the worst of the bound stays clear, with room.
            let here = *here.get_or_insert_with(|| {
                AtomCurve::new(&self.agents, atom, slots, folds, &mut self.curves).jet(from)[0]
            });
            let worst = bound.map_or(f64::NAN, |bound| if truth { bound.hi } else { bound.lo });
            let share = 0.7 * here / (here - worst);
            horizon *= if share.is_finite() { share.clamp(1e-3, 0.25) } else { 0.2 };
        }
        let state = &mut self.guards.atoms[index];
        state.backoff = (2 * state.backoff).clamp(4, BACKOFF_MAX.max(8 * together));
        (state.skip, state.stride) = (state.backoff, 8.0 * least);
        None
    }

    /// What reads these agents is certified no further than `time`.
    pub fn doubt(&mut self, agents: &[usize], time: f64) {
        for instance in self.reading(agents) {
            if !self.guards.instances[instance as usize].active {
                continue;
            }
            for index in self.guards.atoms_of(instance) {
                let state = &self.guards.atoms[index];
                if state.certified > time && state.flip == f64::INFINITY {
                    self.recertify(index, time);
                }
            }
        }
    }
}

/// Whether a comparison is false and becomes true where it comes to zero.
pub fn may_touch(atom: &Atom, state: &AtomState) -> bool {
    atom.relation == Relation::NonPositive && atom.jumps.is_none() && !state.truth
}
