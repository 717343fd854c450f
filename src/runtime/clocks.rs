//! What Algorithms 1 and 3 of the 2004 paper have in common: everything but the selection of steps.
//!
//! The population, arming, micro-steps and actions are those of [`crate::runtime::masim`]. What differs is how an event is
//! found: after a step it is looked whether a guard's g is zero, within `event_tolerance` or already beyond, while the
//! clocks of its agents agree within `synchronisation` (15). Nothing is searched for inside a step. Scheduled times
//! (`after`, `every`) and the end are times at which every step stops.
//!
//! Guards with aggregates whose members change while states flow are not for these algorithms: such a g jumps, and the
//! paper's "itself is smooth". Whoever calls them has refused such models ([`takes`]).
//!
//! Known weak points are kept: see `docs/PAPER.md`.

use crate::codegen::program::{ActionList, AgentSystem, Program, Relation};
use crate::runtime::audit::Audit;
use crate::runtime::certify::ENDLESS;
use crate::runtime::definition::{folds_read, gate_of, guard_of};
use crate::runtime::engine::Engine;
use crate::runtime::failure::{Failure, Reason};
use crate::runtime::groups::Group;
use crate::runtime::observe::{End, Outcome};
use crate::runtime::paper::Paper;
use crate::runtime::solve::extra_state::ExtraStates;
use crate::runtime::solve::step_select::StepSelect;
use crate::runtime::truth;
use crate::runtime::watch::{Watch, clock};

/// Whether the published algorithms can run a program: nobody comes or goes, no link is kept up to date, and the members of
/// every aggregate that a guard or a claim reads change at events only.
pub fn takes(program: &Program) -> bool {
    let makes = |list: &ActionList| !list.births().is_empty() || list.destroys();
    let follows = |ty: &AgentSystem| ty.links.iter().any(|link| !link.updates.is_empty());
    if program.action_lists().any(makes) || program.types.iter().any(follows) {
        return false;
    }
    let of_types = program.types.iter().flat_map(|ty| {
        let claims = ty.modes.iter().flat_map(|mode| &mode.claims);
        let claims = claims.map(|claim| (&claim.frame, Some(&claim.violation)));
        let guards = ty.transitions.iter().flat_map(|transition| {
            [guard_of(transition), gate_of(transition)].map(|guard| (&transition.frame, guard))
        });
        claims.chain(guards)
    });
    let pairs = program.interactions.iter().flat_map(|interaction| &interaction.transitions);
    let of_pairs = pairs.map(|pair| (&pair.transition.frame, guard_of(&pair.transition)));
    of_types.chain(of_pairs).all(|(frame, guard)| {
        let read = guard.map_or_else(Vec::new, |guard| folds_read(program, frame, guard));
        read.into_iter().all(|number| frame.folds[number].filter.atoms.is_empty())
    })
}

/// How many rounds of the loop pass between two reports of progress.
const ROUNDS: u64 = 256;

/// A run by an algorithm of 2004.
pub struct Clocks<'p, 'o> {
    /// Population, groups, guards, instants.
    pub engine: Engine<'p, 'o>,
    /// The numbers that the user gives.
    pub paper: Paper,
    /// The same, for Algorithms 2 and 4.
    pub select: StepSelect,
    /// The guards.
    pub watch: Watch<'p>,
    /// Gear & Osterby's extra states, where the algorithm has them.
    pub extra: Option<ExtraStates>,
    /// For each watched guard of the group that lags: its number and g_k.
    pub surveyed: Vec<(usize, f64)>,
    audit: Option<Audit>,
    rounds: u64,
}

/// What comes next.
pub enum Turn {
    /// The run has ended.
    End(End),
    /// Something happened: look again.
    Again,
    /// Group number so-and-so, which lags, is to take a step.
    Step(usize),
}

impl<'p, 'o> Clocks<'p, 'o> {
    /// A run that has not begun.
    pub fn new(engine: Engine<'p, 'o>, paper: Paper) -> Self {
        let select = StepSelect { gamma: paper.gamma, h_min: paper.h_min, h_max: paper.h_max };
        let watch = Watch::new(&engine);
        let audit = None;
        Self { engine, paper, select, watch, extra: None, surveyed: Vec::new(), audit, rounds: 0 }
    }

    /// Step 1 of the algorithms, and rule 6.
    pub fn begin(&mut self) -> Result<(), Failure> {
        self.engine.begin()?;
        if self.paper.audit {
            self.audit = Some(Audit::new(&self.engine));
        }
        self.after_instant(0.0);
        Ok(())
    }

    /// What the run came to.
    pub fn outcome(mut self, end: End) -> Outcome {
        if let Some(audit) = &mut self.audit {
            audit.end();
        }
        let misses = self.audit.as_ref().map(|audit| audit.misses);
        let mut outcome = self.engine.outcome(end);
        outcome.stats.guard_evaluations += self.watch.evaluations;
        outcome.stats.guard_polynomials = self.watch.polynomials;
        outcome.stats.operations += self.watch.operations;
        outcome.stats.misses = misses;
        outcome
    }

    /// Everything between two steps: the end, samples, events.
    pub fn between_steps(&mut self) -> Result<Turn, Failure> {
        if let Some(stop) = self.engine.stop.take() {
            return Ok(Turn::End(stop.end()));
        }
        let cover = self.engine.cover().min(self.engine.time_end);
        self.rounds += 1;
        if self.engine.interrupted() {
            self.engine.present.go(cover);
            return Ok(Turn::End(End::Interrupted));
        }
        if self.rounds.is_multiple_of(ROUNDS) {
            self.engine.tell_progress()?;
        }
        let Some(due) = self.engine.queues.clocks.peek() else { return Ok(Turn::End(self.engine.finish()?)) };
        let lagging = due.number as usize;
        if self.engine.recorder.next() < cover {
            return self.sample();
        }
        if self.meet(lagging, cover)? {
            return Ok(Turn::Again);
        }
        if self.engine.recorder.next() == cover {
            return self.sample();
        }
        if cover >= self.engine.time_end {
            for group in 0..self.engine.groups.groups.len() {
                if self.meet(group, cover)? {
                    return Ok(Turn::Again);
                }
            }
            return Ok(Turn::End(self.engine.finish()?));
        }
        if cover > ENDLESS {
            self.engine.present.go(cover);
            return Err(Reason::NeverEnds { time: cover, until: self.engine.time_end }.into());
        }
        Ok(Turn::Step(lagging))
    }

    fn sample(&mut self) -> Result<Turn, Failure> {
        let engine = &mut self.engine;
        let time = engine.recorder.next();
        engine.recorder.sample(&engine.agents, &mut engine.present, time, engine.observer)?;
        Ok(Turn::Again)
    }

    /// Step 3: the lagging group takes a step, no longer than the guards let it (27); the step-size control takes the
    /// minimum with h_err, and reduces the step while its error is too large.
    pub fn step(&mut self, lagging: usize, h_g: f64) -> Result<(), Failure> {
        let stop = self.next_schedule().min(self.engine.time_end);
        self.engine.stepper.bound(self.select.bounded(h_g), stop);
        let cover = self.engine.groups.groups[lagging].clock;
        self.engine.advance_laggard(cover)?;
        self.forget_searches();
        self.predict(lagging);
        Ok(())
    }

    /// Makes the predictor polynomials of a group's members, with the rates at its clock if it begins afresh.
    pub fn predict(&mut self, group: usize) {
        let engine = &mut self.engine;
        if engine.groups.groups[group].integration.is_fresh() {
            engine.stepper.begin(&engine.agents, &mut engine.groups.groups[group]);
        }
        self.watch.predict(&mut self.engine, group);
    }

    /// g_k of a guard: the extra state where there is one, else g with every agent at its own clock.
    fn value(&mut self, index: usize) -> f64 {
        match &self.extra {
            Some(extra) => extra.g[index],
            None => self.watch.value(&self.engine, index),
        }
    }

    /// Looks at the guards of a group's members for events at the cover, (15), and executes the instant. Whether there was
    /// one; if not, what has been found of the guards is in `surveyed`.
    fn meet(&mut self, group: usize, cover: f64) -> Result<bool, Failure> {
        self.surveyed.clear();
        self.engine.present.go(cover);
        let mut zeros: Vec<usize> = Vec::new();
        for member in 0..self.engine.groups.groups[group].members.len() {
            let agent = self.engine.groups.groups[group].members[member];
            for k in 0..self.watch.of_agent[agent].len() {
                let index = self.watch.of_agent[agent][k] as usize;
                if !self.watch.guards[index].has(agent) {
                    continue;
                }
                if let Some(audit) = &mut self.audit {
                    audit.follow(&mut self.engine, &self.watch, index, cover);
                }
                if self.watch.is_watched(&self.engine, index) {
                    let g = self.value(index);
                    let beyond = (g < 0.0) != self.engine.guards.atoms[index].truth;
                    let is_zero = g.abs() <= self.paper.event_tolerance || beyond && !g.is_nan();
                    if is_zero && self.is_synchronous(index, cover) {
                        zeros.push(index);
                    } else {
                        self.surveyed.push((index, g));
                    }
                } else if self.leaves_zero(index) {
                    zeros.push(index);
                }
            }
        }
        let scheduled = self.next_schedule() <= cover;
        if zeros.is_empty() && !scheduled {
            return Ok(false);
        }
        zeros.sort_unstable();
        zeros.dedup();
        for &index in &zeros {
            self.watch.guards[index].at_zero = true;
            if let Some(audit) = &mut self.audit {
                audit.seen(index, cover);
            }
        }
        self.engine.execute_at(cover, &zeros, self.paper.event_tolerance)?;
        self.after_instant(cover);
        Ok(true)
    }

    /// Whether all clocks of a guard's agents agree with the cover: tau = 0 for all of them.
    fn is_synchronous(&self, index: usize, cover: f64) -> bool {
        let agents = self.watch.agents(index);
        agents.iter().all(|&agent| clock(&self.engine, agent) - cover <= self.paper.synchronisation)
    }

    /// A guard that is true, or has been found at zero, is looked at where all its agents are known, by dense output. One
    /// that has become false is watched again; whether one has become true after all.
    fn leaves_zero(&mut self, index: usize) -> bool {
        let guard = &self.watch.guards[index];
        let instance = guard.instance;
        if !self.engine.guards.instances[instance as usize].active {
            return false;
        }
        let (atom, slots) = (guard.atom, self.watch.slots(index));
        let kernel = self.engine.program.kernel(atom.value);
        let folds = self.watch.folds(index);
        let g = truth::evaluate(&self.engine.agents, &mut self.engine.present, kernel, slots, folds);
        self.watch.evaluations += 1;
        self.watch.operations += kernel.operations();
        if g.abs() <= self.paper.event_tolerance || g.is_nan() {
            return false;
        }
        self.watch.guards[index].at_zero = false;
        let (is_true, was_true) = (g < 0.0, self.engine.guards.atoms[index].truth);
        if is_true == was_true {
            return false;
        }
        if is_true || atom.relation == Relation::Crossing {
            return true;
        }
        let state = &mut self.engine.guards.atoms[index];
        (state.truth, state.slack) = (false, 0.0);
        self.engine.calm(&[instance]);
        if let Some(audit) = &mut self.audit {
            audit.settle(&self.engine, index, self.engine.present.time);
        }
        false
    }

    /// After an instant, step 1 again for those whom it has written: their guards are settled, and those at zero have to
    /// leave it first.
    fn after_instant(&mut self, time: f64) {
        self.forget_searches();
        self.watch.gather(&self.engine);
        self.give_clocks(time);
        for group in 0..self.engine.groups.groups.len() {
            let Group { members, integration, .. } = &self.engine.groups.groups[group];
            if !members.is_empty() && integration.is_fresh() {
                self.predict(group);
            }
        }
        for agent in 0..self.engine.agents.len() {
            if clock(&self.engine, agent) != time {
                continue;
            }
            for k in 0..self.watch.of_agent[agent].len() {
                let index = self.watch.of_agent[agent][k] as usize;
                let g = self.watch.value(&self.engine, index);
                self.watch.guards[index].at_zero = g.abs() <= self.paper.event_tolerance;
                if let Some(audit) = &mut self.audit {
                    audit.settle(&self.engine, index, time);
                }
            }
        }
        self.restart_extra(time);
    }

    /// Agents without states have clocks here as well: their guards are met at times, too.
    fn give_clocks(&mut self, time: f64) {
        for number in 0..self.engine.groups.groups.len() {
            let group = &mut self.engine.groups.groups[number];
            if !group.members.is_empty() && group.clock == f64::INFINITY {
                group.clock = time;
                self.engine.queue_clock(number);
            }
        }
    }

    /// What certified detection has put down to be searched, or found: it is not asked here.
    fn forget_searches(&mut self) {
        self.engine.queues.uncertified.clear();
        self.engine.queues.flips.clear();
    }

    /// The next time of an `after` or `every`, s.
    fn next_schedule(&mut self) -> f64 {
        self.engine.next_cause()
    }
}
