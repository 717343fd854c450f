//! The state of a run, and the queues that order it in time.

use std::collections::BinaryHeap;
use std::sync::atomic::{self, AtomicBool};

use rustc_hash::FxHashMap;

use crate::base::{Diagnostic, Span};
use crate::codegen::program::{Integrator, Program};
use crate::codegen::trace::Compared;
use crate::math::Interval;
use crate::runtime::advance::Stepper;
use crate::runtime::agenda::{self, Agenda, Due, Waiting};
use crate::runtime::comparisons;
use crate::runtime::crew::Crew;
use crate::runtime::detect::CurveRows;
use crate::runtime::enclose::Enclosures;
use crate::runtime::exposed::Exposures;
use crate::runtime::failure::{Failure, Place, Reason};
use crate::runtime::groups::{Coupling, Groups};
use crate::runtime::guards::{Guards, Listing, Origin, TooManyGuards};
use crate::runtime::limits::Limits;
use crate::runtime::mail::Mail;
use crate::runtime::most::Most;
use crate::runtime::neighbours::Neighbours;
use crate::runtime::notes::Notes;
use crate::runtime::observe::{Cell, End, FalseAssert, Last, Observer, Outcome, Stats, TypeStats, Who};
use crate::runtime::paper::Form;
use crate::runtime::population::Agents;
use crate::runtime::present::{Depth, Present};
use crate::runtime::reach::Reaches;
use crate::runtime::record::Recorder;
use crate::runtime::repetition::Repetitions;

use crate::runtime::solve::control::Accuracy;
use crate::runtime::solve::{MethodName, Methods};
use crate::runtime::verdicts::Monitors;
use crate::runtime::zeros::Approach;

/// What is due when.
#[derive(Clone, Debug, Default)]
pub struct Queues {
    /// Atom instances, at the end of their certified stretch.
    pub uncertified: Agenda,
    /// Atom instances, at their next change.
    pub flips: BinaryHeap<Due>,
    /// Those of them that wait for something later, by atom instance.
    pub waiting: FxHashMap<u32, Waiting>,
    /// Guard instances with a delay or period; the version is their arming.
    pub schedules: BinaryHeap<Due>,
    /// Pairs whose hazard flows, at the end of what is known of it; void if their arming is another one.
    pub exposed: BinaryHeap<Due>,
    /// Groups, at their clocks; void if the clock has another value.
    pub clocks: BinaryHeap<Due>,
    /// Cold agents of which every step is recorded, at the ends of their steps in the window at hand; void if they are not cold.
    pub steps: BinaryHeap<Due>,
}

impl Queues {
    /// Atom instances have new numbers: by old number, `moved`.
    pub fn renumber_atoms(&mut self, moved: &[u32]) {
        self.uncertified.renumber(moved);
        agenda::renumber(&mut self.flips, moved);
        let waiting = std::mem::take(&mut self.waiting);
        self.waiting = waiting.into_iter().map(|(number, root)| (moved[number as usize], root)).collect();
        self.waiting.remove(&u32::MAX);
    }
}

/// A run in progress.
pub struct Engine<'p, 'o> {
    /// What is run.
    pub program: &'p Program,
    /// The agents.
    pub agents: Agents<'p>,
    /// Who steps with whom.
    pub groups: Groups,
    /// The guards.
    pub guards: Guards<'p>,
    /// Rows at the instant at hand.
    pub present: Present,
    /// Takes steps.
    pub stepper: Stepper,
    /// Who advances the cold agents.
    pub crew: Crew,
    /// Scratch for root searches, with their counts.
    pub curves: CurveRows,
    /// Scratch: rows as intervals.
    pub points: Vec<Interval>,
    /// Scratch: registers of interval kernels.
    pub registers: Vec<Interval>,
    /// Bounds for sleeping.
    pub enclosures: Enclosures,
    /// Where agents can get to.
    pub reaches: Reaches,
    /// The near pairs; none in the plain form.
    pub neighbours: Neighbours,
    /// Which form of the engine runs.
    pub form: Form,
    /// Whether steps go by Taylor series where there is one.
    pub by_series: bool,
    /// The agents that could be cold and are not.
    pub hot: Vec<usize>,
    /// The end of the window of time at hand, s.
    pub window_end: f64,
    /// Whether an agent has been brought back since this was last asked.
    pub has_thawed: bool,
    /// What is due when.
    pub queues: Queues,
    /// How agents came to the instant at hand.
    pub approach: Approach,
    /// Messages under way.
    pub mail: Mail,
    /// Hazards of pairs that flow.
    pub exposures: Exposures,
    /// Makes rows of trajectories.
    pub recorder: Recorder<'p>,
    pub slowest: Most,
    /// Who has had most events.
    pub busiest: Most,
    /// Watches for Zeno behaviour and chattering.
    pub repetitions: Repetitions,
    /// Who is told.
    pub observer: &'o mut dyn Observer,
    /// Set from another thread to end the run.
    pub interrupt: &'o AtomicBool,
    /// Limits.
    pub limits: Limits,
    /// The end of the run, s; infinite if none is set.
    pub time_end: f64,
    /// Events: firings of transitions.
    pub n_events: u64,
    /// Firings of each definition.
    pub firings: Vec<u64>,
    /// Events of each agent type.
    pub events_of_type: Vec<u64>,
    /// The same of each agent, by its place.
    pub events_of: Vec<u64>,
    /// Segments cut by events.
    pub n_cuts: u64,
    /// Roots neither excluded nor isolated.
    pub n_undecided: u64,
    /// Asserts that were false.
    pub false_asserts: Vec<FalseAssert>,
    /// What is known of the properties.
    pub monitors: Monitors<'p>,
    /// Remarks, each once.
    pub warnings: Vec<Diagnostic>,
    /// A `stop` action of this instant.
    pub stop: Option<StopRequest>,
    /// What explanations need to know, if the observer wants them.
    pub notes: Option<Box<Notes>>,
}

/// A `stop` action that has been executed.
#[derive(Clone, Debug, PartialEq)]
pub struct StopRequest {
    /// The text given with it.
    pub reason: Option<String>,
    /// Who.
    pub agent: Who,
    /// The label of the transition or the path of the mode.
    pub by: String,
}

impl StopRequest {
    /// The end of the run.
    pub fn end(self) -> End {
        End::Stop { reason: self.reason, by: self.agent.is_visible().then_some((self.agent, self.by)) }
    }
}

impl<'p, 'o> Engine<'p, 'o> {
    /// A run that has not begun.
    pub fn new(
        program: &'p Program,
        (form, coupling): (Form, Coupling),
        limits: &Limits,
        interrupt: &'o AtomicBool,
        observer: &'o mut dyn Observer,
    ) -> Result<Self, Failure> {
        let run = &program.run;
        let accuracy = Accuracy { tolerance: run.tolerance, absolute: run.absolute.unwrap_or(run.tolerance) };
        let time_end = run.until.unwrap_or(f64::INFINITY);
        let agents = Agents::new(program);
        let methods = methods(run.integrator);
        let listing = match form {
            Form::Fast => Listing::Near,
            Form::Plain => Listing::All,
        };
        let guards = Guards::new(&agents, listing, limits.guards_max)
            .map_err(|TooManyGuards { needed }| Reason::GuardLimit { needed, limit: limits.guards_max })?;
        Ok(Self {
            program,
            present: Present::new(&agents),
            stepper: Stepper::new(&agents, methods, accuracy, time_end, limits),
            crew: Crew::new(if form == Form::Fast { limits.threads_max } else { 1 }),
            curves: CurveRows::new(&agents),
            enclosures: Enclosures::new(&agents, accuracy),
            reaches: Reaches::new(&agents, accuracy, time_end),
            neighbours: Neighbours::default(),
            form,
            by_series: methods.first() == MethodName::Taylor,
            hot: Vec::new(),
            window_end: f64::INFINITY,
            has_thawed: false,
            recorder: Recorder::new(program, time_end),
            slowest: Most::default(),
            busiest: Most::default(),
            events_of: vec![0; agents.len()],
            repetitions: Repetitions::new(limits),
            groups: Groups::new(coupling),
            points: Vec::new(),
            registers: Vec::new(),
            queues: Queues::default(),
            approach: Approach::default(),
            mail: Mail::default(),
            exposures: Exposures::default(),
            notes: observer.wants_reasons().then(|| Box::new(Notes::new(&agents))),
            firings: vec![0; guards.definitions.len()],
            events_of_type: vec![0; program.types.len()],
            monitors: Monitors::new(program, &guards),
            agents,
            guards,
            observer,
            interrupt,
            limits: limits.clone(),
            time_end,
            n_events: 0,
            n_cuts: 0,
            n_undecided: 0,
            false_asserts: Vec::new(),
            warnings: Vec::new(),
            stop: None,
        })
    }

    /// Whether the user wants the run to end.
    pub fn interrupted(&self) -> bool {
        self.interrupt.load(atomic::Ordering::Relaxed)
    }

    /// Writes the last rows of the records that have one at the end, wherever that is.
    pub fn record_end(&mut self) -> Result<(), Failure> {
        self.recorder.end(&self.agents, &mut self.present, self.observer)
    }

    /// Tells the observer the state of every agent at the present time (rule 12).
    pub fn tell_last(&mut self) -> Result<(), Failure> {
        self.tell_undecided()?;
        let time = self.present.time;
        let visible = self.agents.visible();
        self.present.survey(&self.agents, &visible);
        for agent in visible {
            let row = &self.agents.agents[agent];
            let system = &self.program.types[row.ty];
            let states: Vec<f64> = self
                .present
                .states(agent)
                .iter()
                .zip(&system.states)
                .map(|(value, column)| column.scale.from_si(*value))
                .collect();
            let first = system.layout.discrete(0);
            let discretes: Vec<Cell> = system
                .discretes
                .iter()
                .zip(&row.aux[first..])
                .map(|(column, &value)| {
                    if column.boolean {
                        Cell::Bool(value != 0.0)
                    } else {
                        Cell::Number(column.scale.from_si(value))
                    }
                })
                .collect();
            let mode = &self.agents.mode(agent).path;
            self.observer.last(&Last {
                time,
                agent: self.agents.who(agent),
                ty: row.ty,
                mode,
                states: &states,
                discretes: &discretes,
            })?;
        }
        Ok(())
    }

    /// Takes note of how many steps and events an agent has had, which will have no more.
    pub fn note_counts(&mut self, agent: usize) {
        let steps = self.stepper.counts.steps_of[agent] + self.agents.cold.steps_of(agent);
        self.slowest.note(self.agents.who(agent), steps);
        let events = self.events_of.get_mut(agent).map_or(0, std::mem::take);
        self.busiest.note(self.agents.who(agent), events);
    }

    /// Counts an event of an agent.
    pub fn count_event(&mut self, agent: usize) {
        if self.events_of.len() <= agent {
            self.events_of.resize(agent + 1, 0);
        }
        self.events_of[agent] += 1;
    }

    /// What the run came to.
    pub fn outcome(mut self, end: End) -> Outcome {
        self.agents.living().into_iter().for_each(|agent| self.note_counts(agent));
        let counts = &self.stepper.counts;
        let hidden = self.program.watcher();
        let types = self.program.types.iter().enumerate().filter(|(ty, _)| Some(*ty) != hidden);
        let types = types.map(|(ty, system)| TypeStats {
            name: system.name.clone(),
            agents: self.agents.of_type[ty].len() as u64,
            created: self.agents.turnover[ty][0],
            destroyed: self.agents.turnover[ty][1],
            steps: counts.steps_of_type[ty],
            events: self.events_of_type[ty],
        });
        let labels =
            self.guards.definitions.iter().zip(&self.firings).filter_map(|(definition, &firings)| {
                match definition.origin {
                    Origin::Transition(_) if Some(definition.ty) == hidden => None,
                    Origin::Transition(transition) => Some((transition.label.clone(), firings)),
                    Origin::Pair(pair) => Some((pair.transition.label.clone(), firings)),
                    Origin::Gate(_) | Origin::Claim(_) | Origin::Link(_) => None,
                }
            });
        let methods =
            self.stepper.steps_of_methods().into_iter().map(|(name, n)| (name.name().to_string(), n));
        let stats = Stats {
            events: self.n_events,
            threads: self.crew.n_threads() as u64,
            steps: counts.steps,
            rejected: counts.rejected,
            starts: counts.starts,
            rhs_evaluations: counts.rhs_evaluations + self.present.rhs_evaluations,
            jacobians: counts.jacobians,
            guard_evaluations: self.curves.evaluations,
            guard_ranges: self.curves.ranges + self.enclosures.ranges + self.reaches.ranges,
            places: self.agents.len() as u64,
            guard_places: (self.guards.instances.len() + self.guards.atoms.len()) as u64,
            pairs_listed: self.guards.n_pairs,
            undecided_roots: self.n_undecided,
            cuts: self.n_cuts,
            guard_polynomials: 0,
            operations: counts.operations
                + self.present.operations
                + self.curves.operations
                + self.enclosures.operations
                + self.reaches.operations,
            misses: None,
            types: types.collect(),
            slowest: self.slowest.told(),
            busiest: self.busiest.told(),
            transitions: labels.collect(),
            methods: methods.collect(),
        };
        Outcome {
            end,
            time: self.present.time,
            stats,
            false_asserts: self.false_asserts,
            verdicts: self.monitors.verdicts(),
            warnings: self.warnings,
        }
    }

    /// The smallest clock: all agents are known up to here.
    pub fn cover(&mut self) -> f64 {
        while let Some(due) = self.queues.clocks.peek() {
            if self.groups.groups[due.number as usize].clock == due.time {
                return due.time;
            }
            self.queues.clocks.pop();
        }
        f64::INFINITY
    }

    /// Takes void entries out of the queues that have become much longer than there are things to be due.
    pub fn compact_queues(&mut self) {
        let Self { queues, guards, groups, .. } = self;
        queues.uncertified.compact(4 * guards.atoms.len() + 1024, |due| {
            guards.atoms[due.number as usize].version == due.version
        });
        compact(&mut queues.flips, guards.atoms.len(), |due| {
            guards.atoms[due.number as usize].version == due.version
        });
        compact(&mut queues.schedules, guards.instances.len(), |due| {
            guards.instances[due.number as usize].arming == due.version
        });
        compact(&mut queues.exposed, guards.instances.len(), |due| {
            guards.instances[due.number as usize].arming == due.version
        });
        compact(&mut queues.clocks, groups.groups.len(), |due| {
            groups.groups[due.number as usize].clock == due.time
        });
    }

    /// Enters a group's clock into the queue.
    pub fn queue_clock(&mut self, group: usize) {
        let time = self.groups.groups[group].clock;
        if time < f64::INFINITY {
            self.queues.clocks.push(Due { time, number: group as u32, version: 0 });
        }
    }

    /// Where an agent is at the present instant.
    pub fn place(&mut self, agent: usize) -> Place {
        self.present.make(&self.agents, &[agent], Depth::States);
        let attempts = &self.groups.groups[self.agents.agents[agent].group].integration.attempts;
        let states = self.present.states(agent);
        Place::new(&self.agents, agent, self.present.time, states, attempts.iter().copied())
    }

    /// What the guard of an instance compares at the present instant.
    pub fn told(&mut self, instance: u32) -> Vec<Compared> {
        comparisons::told(&self.guards, &self.agents, &mut self.present, instance)
    }

    /// Label and place in the source of an instance's transition or claim.
    pub fn label(&self, instance: u32) -> (&'p str, Span) {
        match self.guards.definition(instance).origin {
            Origin::Transition(transition) | Origin::Gate(transition) => (&transition.label, transition.span),
            Origin::Pair(pair) => (&pair.transition.label, pair.transition.span),
            Origin::Claim(claim) => (claim.message.as_deref().unwrap_or("invariant"), claim.span),
            Origin::Link(update) => (&update.label, update.span),
        }
    }
}

/// Takes out what is void from a queue with many entries for each of `n` things.
fn compact(queue: &mut BinaryHeap<Due>, n: usize, is_valid: impl Fn(&Due) -> bool) {
    if queue.len() > 4 * n + 1024 {
        queue.retain(is_valid);
    }
}

/// The methods that a setting stands for.
fn methods(integrator: Integrator) -> Methods {
    match integrator {
        Integrator::Auto => Methods::Automatic(MethodName::Taylor),
        Integrator::Adams => Methods::One(MethodName::Adams),
        Integrator::Tsit5 => Methods::One(MethodName::Tsit5),
        Integrator::Stiff => Methods::One(MethodName::Stiff),
        Integrator::Taylor => Methods::One(MethodName::Taylor),
    }
}
