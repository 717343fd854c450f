//! What makes one instant (rule 4): the roots and scheduled times that are due together, and who fires by them.
//!
//! All that is due at exactly the same time is one instant; roots within the resolution of time wait for the last of them if they share an
//! agent, or watch the same and rounding does not tell them apart. Scheduled times are never moved: a root near one joins it.
use crate::codegen::program::{Relation, Trigger};
use crate::runtime::agenda::{Due, Waiting};
use crate::runtime::detect::AtomCurve;
use crate::runtime::engine::Engine;
use crate::runtime::failure::Failure;
use crate::runtime::guards::Origin;
use crate::runtime::instant::{By, Candidate};
use crate::runtime::population::ABSENT;
use crate::runtime::present::Depth;
use crate::runtime::solve::roots::Curve;
use crate::runtime::solve::time_resolution;
use crate::runtime::truth::Side;
use crate::runtime::zeros::{Zero, root_width};

/// Whom the causes of an instant write and read, by agents and by types; each rising.
#[derive(Debug, Default)]
struct Circle {
    written: Vec<usize>,
    read: Vec<usize>,
    written_types: Vec<usize>,
    read_types: Vec<usize>,
}

impl Engine<'_, '_> {
    /// The width of an instant at a time, s: roots of those who share an agent that lie within it of the first are in it (rule 4).
    pub fn event_tolerance(&self, time: f64) -> f64 {
        time_resolution(time).max(self.program.run.machinery.event_tolerance.unwrap_or(0.0))
    }

    /// The time of the next change of an atom, of the next scheduled time, or of the next message.
    pub fn next_cause(&mut self) -> f64 {
        let flips = &mut self.queues.flips;
        while flips.peek().is_some_and(|due| self.guards.atoms[due.number as usize].version != due.version) {
            flips.pop();
        }
        let schedules = &mut self.queues.schedules;
        while schedules
            .peek()
            .is_some_and(|due| self.guards.instances[due.number as usize].arming != due.version)
        {
            schedules.pop();
        }
        let time = |due: Option<&Due>| due.map_or(f64::INFINITY, |due| due.time);
        time(self.queues.flips.peek()).min(time(self.queues.schedules.peek())).min(self.mail.next_time())
    }

    /// Applies the changes that are due at `first`, and executes the instant if something fires.
    pub fn execute(&mut self, first: f64) -> Result<(), Failure> {
        let window = first + self.event_tolerance(first);
        let cover = self.cover().min(self.time_end);
        self.certify_up_to(window.min(cover));
        self.expose_up_to(window.min(cover))?;
        if self.interrupted() || self.has_thawed {
            // Something earlier may not have been found yet.
            return Ok(());
        }
        let mut flips = self.pop_flips(window);
        let (now, later): (Vec<Due>, Vec<Due>) =
            self.pop_schedules(window).into_iter().partition(|due| due.time == first);
        let arrived = self.mail.arrive(first);
        let causes: Vec<u32> = flips
            .iter()
            .filter(|due| due.time == first)
            .map(|due| self.instance_of(due))
            .chain(now.iter().map(|due| due.number))
            .chain(arrived.iter().flat_map(|message| self.listening(message)))
            .collect();
        let waits = now.is_empty() && arrived.is_empty() && self.wait(first, &causes, &mut flips, &later);
        self.queues.schedules.extend(later);
        if waits {
            self.queues.flips.extend(flips);
            return Ok(());
        }
        let is_alone = flips.iter().all(|due| due.time == first);
        let circle = if is_alone { Circle::default() } else { self.circle(&causes) };
        let window = self.since(first, &flips) + self.event_tolerance(first);
        let (joined, others): (Vec<Due>, Vec<Due>) = flips.into_iter().partition(|due| {
            due.time == first || due.time <= window && self.shares(&circle, self.instance_of(due))
        });
        self.queues.flips.extend(others);
        let near = joined.iter().map(|due| self.guards.atoms[due.number as usize].near).fold(first, f64::min);
        let changed: Vec<(usize, f64)> = joined.iter().map(|due| (due.number as usize, due.time)).collect();
        let mut time = first;
        if now.is_empty() && arrived.is_empty() {
            time = self.defined_side(time, near, &changed);
            time = self.after_turns(time, &changed);
        }
        self.present.go(time);
        self.approach.begin(time);
        let mut concerned: Vec<u32> = Vec::new();
        let mut refold: Vec<u32> = Vec::new();
        let mut at_once: Vec<usize> = Vec::new();
        for (index, root) in changed {
            if self.guards.atoms[index].certified >= root {
                at_once.push(index);
            }
            self.flip(index, root);
            let instance = self.guards.atoms[index].instance;
            concerned.push(instance);
            if self.guards.is_of_filter(index) && refold.last() != Some(&instance) {
                refold.push(instance);
            }
        }
        for instance in refold {
            self.settle_folds(instance);
        }
        self.happen(concerned, now, &at_once)
    }

    /// Executes the instant at `time`, at which a step has ended, by what is scheduled then and by atoms that have been
    /// found at zero, within `tolerance` of g or already beyond.
    pub fn execute_at(&mut self, time: f64, zeros: &[usize], tolerance: f64) -> Result<(), Failure> {
        let now = self.pop_schedules(time);
        self.mail.arrive(time);
        self.present.go(time);
        self.approach.begin(time);
        let mut concerned: Vec<u32> = Vec::new();
        for &index in zeros {
            self.guards.atoms[index].leap = None;
            self.flip(index, time);
            let state = &mut self.guards.atoms[index];
            state.slack = state.slack.max(tolerance);
            state.near = time;
            concerned.push(state.instance);
        }
        self.happen(concerned, now, &[])
    }

    /// Executes the instant at the present time, if something fires by the instances whose atoms have changed or by what
    /// is scheduled. Those `at_once` changed where they had been settled last.
    fn happen(&mut self, mut concerned: Vec<u32>, now: Vec<Due>, at_once: &[usize]) -> Result<(), Failure> {
        let mut candidates = Vec::new();
        self.catch_up_with_all();
        // Links that the flow changed are updated first (rule 4).
        self.repetitions.instant += 1;
        let woken = self.refresh_links(&concerned)?;
        concerned.extend(woken);
        for due in now {
            concerned.push(due.number);
            candidates.extend(self.scheduled(due.number));
        }
        concerned.sort_unstable();
        concerned.dedup();
        let (mut claims, mut gates) = (false, false);
        for &instance in &concerned {
            if self.enabled(instance) {
                candidates.push(Candidate { instance, by: By::Guard });
            }
            let origin = self.guards.definition(instance).origin;
            claims |= matches!(origin, Origin::Claim(_));
            gates |= self.is_gated(instance);
        }
        candidates
            .retain(|candidate| candidate.by == By::Guard || self.truths().holds_now(candidate.instance));
        if !candidates.is_empty() || self.mail.is_waiting() {
            self.instant(candidates)?;
        }
        if claims {
            self.judge_claims(&concerned, at_once)?;
        }
        if gates {
            self.set_gates(&concerned)?;
        }
        self.calm(&concerned);
        Ok(())
    }

    /// Has roots wait that are to be one instant with something later (rule 4): with a scheduled time, or with the last root of those that share
    /// an agent, when all of their conditions are true. Whether any does. `flips` and `schedules` are all that are due within the tolerance
    /// of events from `first` on, `causes` whose roots are first.
    fn wait(&mut self, first: f64, causes: &[u32], flips: &mut [Due], schedules: &[Due]) -> bool {
        let since = self.since(first, flips);
        let (tolerance, width) = (self.event_tolerance(first), root_width(first));
        let arriving = self.mail.arriving(first, since + tolerance);
        if schedules.is_empty() && arriving.is_empty() && flips.iter().all(|due| due.time == first) {
            return false;
        }
        let circle = self.circle(causes);
        // What comes after the end comes never.
        let scheduled = schedules
            .iter()
            .map(|due| (due.time, vec![due.number]))
            .chain(arriving.iter().map(|(time, message)| (*time, self.listening(message))))
            .filter(|(time, _)| *time <= (since + tolerance).min(self.time_end))
            .filter(|(_, who)| who.iter().any(|&instance| self.shares(&circle, instance)))
            .min_by(|a, b| a.0.total_cmp(&b.0));
        let (until, who) = scheduled.unwrap_or_else(|| {
            let resolution = time_resolution(first);
            let later = flips.iter().filter(|due| due.time > first && due.time <= since + resolution);
            let joining = later
                .map(|due| (due.time, self.instance_of(due)))
                .filter(|&(_, instance)| self.is_of_transition(instance))
                .filter(|&(time, instance)| self.joins(&circle, instance, time - first <= width));
            let (times, who): (Vec<f64>, Vec<u32>) = joining.unzip();
            (times.into_iter().fold(first, f64::max), who)
        });
        if who.is_empty() {
            return false;
        }
        // Whoever shares with them waits, too, and so do claims about them.
        let circle = self.circle(&who);
        let are_near = until - first <= width;
        let near = causes.iter().copied().filter(|&cause| self.joins(&circle, cause, are_near));
        let circle = self.circle(&near.chain(who.iter().copied()).collect::<Vec<u32>>());
        let atoms = &self.guards.atoms;
        self.queues.waiting.retain(|&number, waiting| atoms[number as usize].version == waiting.version);
        let mut waits = false;
        for due in flips.iter_mut().filter(|due| due.time < until) {
            let instance = self.instance_of(due);
            let may_wait = !self.is_of_transition(instance) || until <= self.own_time(due) + tolerance;
            if may_wait && self.joins(&circle, instance, are_near) {
                waits = true;
                let root = Waiting { since: due.time, version: due.version };
                self.queues.waiting.entry(due.number).or_insert(root);
                due.time = until;
                self.guards.atoms[due.number as usize].flip = until;
            }
        }
        waits
    }

    /// When a root is due, whatever it waits for, s.
    fn own_time(&self, due: &Due) -> f64 {
        let waiting = self.queues.waiting.get(&due.number).filter(|root| root.version == due.version);
        waiting.map_or(due.time, |root| root.since)
    }

    /// The first of the transitions' roots that are one instant at `first`, s.
    fn since(&self, first: f64, flips: &[Due]) -> f64 {
        let seeds = flips.iter().filter(|due| due.time == first);
        let seeds = seeds.filter(|due| self.is_of_transition(self.instance_of(due)));
        seeds.map(|due| self.own_time(due)).fold(first, f64::min)
    }

    /// The instance whose comparison changes.
    fn instance_of(&self, due: &Due) -> u32 {
        self.guards.atoms[due.number as usize].instance
    }

    fn is_of_transition(&self, instance: u32) -> bool {
        self.guards.definition(instance).origin.transition().is_some()
    }

    fn pop_flips(&mut self, window: f64) -> Vec<Due> {
        let mut flips = Vec::new();
        while let Some(&due) = self.queues.flips.peek() {
            if due.time > window {
                break;
            }
            self.queues.flips.pop();
            if self.guards.atoms[due.number as usize].version == due.version {
                flips.push(due);
            }
        }
        flips
    }

    fn pop_schedules(&mut self, window: f64) -> Vec<Due> {
        let mut schedules = Vec::new();
        while let Some(&due) = self.queues.schedules.peek() {
            if due.time > window {
                break;
            }
            self.queues.schedules.pop();
            if self.guards.instances[due.number as usize].arming == due.version {
                schedules.push(due);
            }
        }
        schedules
    }

    /// Whom these instances write and read.
    fn circle(&self, instances: &[u32]) -> Circle {
        let mut circle = Circle::default();
        for &instance in instances {
            circle.written.extend(self.guards.roots(instance));
            circle
                .read
                .extend(self.guards.slots(&self.agents, instance).iter().filter(|&&agent| agent != ABSENT));
            circle.read_types.extend(&self.guards.definition(instance).quantified);
        }
        circle.written_types.extend(circle.written.iter().map(|&agent| self.agents.agents[agent].ty));
        for list in [&mut circle.written, &mut circle.read, &mut circle.written_types, &mut circle.read_types]
        {
            list.sort_unstable();
            list.dedup();
        }
        circle
    }

    /// Rule 4: whether an instance writes what others read or write, or they what it reads (by agents).
    fn shares(&self, circle: &Circle, instance: u32) -> bool {
        let has = |list: &[usize], number: usize| list.binary_search(&number).is_ok();
        let is_read = |&agent: &usize| {
            has(&circle.read, agent) || has(&circle.read_types, self.agents.agents[agent].ty)
        };
        let definition = self.guards.definition(instance);
        self.guards.roots(instance).iter().any(is_read)
            || self.guards.slots(&self.agents, instance).iter().any(|&agent| has(&circle.written, agent))
            || definition.quantified.iter().any(|&ty| has(&circle.written_types, ty))
    }

    /// Whether the root of an instance is to be one instant with those of others: if they share an agent, or watch the same and the
    /// roots `are_near`, so that rounding does not tell them apart.
    fn joins(&self, circle: &Circle, instance: u32, are_near: bool) -> bool {
        let is_watched = |&agent: &usize| circle.read.binary_search(&agent).is_ok();
        self.shares(circle, instance)
            || are_near && self.guards.slots(&self.agents, instance).iter().any(is_watched)
    }

    /// The true side of the roots, or the near side if the flows are not defined on the true one (rule 3).
    fn defined_side(&mut self, time: f64, near: f64, changed: &[(usize, f64)]) -> f64 {
        if near >= time {
            return time;
        }
        let roots = |&(index, _): &(usize, f64)| self.guards.roots(self.guards.atoms[index].instance);
        let mut agents: Vec<usize> = changed.iter().flat_map(roots).collect();
        agents.sort_unstable();
        agents.dedup();
        let mut defined = |time: f64| {
            self.present.go(time);
            agents.iter().all(|&agent| {
                self.present.make(&self.agents, &[agent], Depth::Rates);
                self.present.rates(agent).iter().all(|rate| rate.is_finite())
            })
        };
        if !defined(time) && defined(near) { near } else { time }
    }

    /// Roots that were found just before a kink, beyond which their flows have turned by now, are at the kink: what the flow of one side
    /// says of the other is wrong by rounding. None is moved beyond anything else that is due.
    fn after_turns(&mut self, time: f64, changed: &[(usize, f64)]) -> f64 {
        let mut latest = time;
        let window = time + time_resolution(time);
        for &(index, _) in changed {
            let (atom, slots) = self.guards.atom_slots(&self.agents, index);
            let read = atom.slots.iter().map(|&slot| slots[slot]).filter(|&agent| agent != ABSENT);
            let turning = read.filter(|&agent| !self.agents.flow(agent).kinks.is_empty());
            let starts = turning.map(|agent| self.agents.agents[agent].segment.start);
            latest = starts.filter(|&start| start <= window).fold(latest, f64::max);
        }
        if latest < self.next_cause() { latest } else { time }
    }

    /// Changes the truth of an atom at the present instant. Its root may lie a little later; it is certified from there on.
    fn flip(&mut self, index: usize, root: f64) {
        let (atom, slots) = self.guards.atom_slots(&self.agents, index);
        let time = self.present.time;
        let waiting = self.queues.waiting.remove(&(index as u32));
        let waiting = waiting.filter(|waiting| waiting.version == self.guards.atoms[index].version);
        let since = waiting.map_or(root, |waiting| waiting.since);
        let kernel = self.program.kernel(atom.value);
        let folds = self.truths().gather(self.guards.atoms[index].instance, kernel, &slots, Side::After);
        let jet = { AtomCurve::new(&self.agents, atom, &slots, &folds, &mut self.curves).jet(time) };
        let state = &mut self.guards.atoms[index];
        state.touched = match (atom.relation, state.leap) {
            (Relation::Crossing, _) => !state.sideless,
            (Relation::NonPositive, None) => state.truth,
            (Relation::Negative, _) | (Relation::NonPositive, Some(_)) => false,
        };
        state.truth = state.leap.map_or(!state.truth, |leap| leap.after);
        state.sideless = false;
        state.rooted = true;
        self.guards.roused.push(index as u32);
        let state = &mut self.guards.atoms[index];
        // Across a jump the rate says nothing of how near zero g is.
        let zero =
            if state.leap.is_some() { None } else { Zero::of_root(jet[1], (time - since).abs(), time) };
        let slack = if state.leap.is_some() { 0.0 } else { jet[1].abs() * self.event_tolerance(time) };
        self.guards.zeros.set(index, time, zero);
        self.recertify(index, root.max(time));
        let state = &mut self.guards.atoms[index];
        state.slack = if slack.is_finite() { slack } else { 0.0 };
        state.settled = !state.touch;
    }

    /// A scheduled time of an instance has come: its delay is over, or its period has passed once more.
    fn scheduled(&mut self, instance: u32) -> Option<Candidate> {
        let transition = self.guards.definition(instance).origin.transition()?;
        let periodic = matches!(transition.trigger, Trigger::Every { .. });
        let state = &mut self.guards.instances[instance as usize];
        if matches!(transition.trigger, Trigger::Chance { .. }) {
            state.delay = f64::NAN;
            return Some(Candidate { instance, by: By::Pulse(state.arming) });
        }
        if !periodic {
            state.aged = true;
            return None;
        }
        state.periods += 1;
        self.queue_schedule(instance);
        Some(Candidate { instance, by: By::Pulse(self.guards.instances[instance as usize].arming) })
    }
}
