//! Rows of trajectories (rule 16): samples at k d, every accepted step and both sides of every event, or samples that are thinned
//! out as the run goes on.

use std::collections::BTreeSet;

use rustc_hash::{FxHashMap, FxHashSet};

use crate::codegen::program::{Layout, LetValue, Pace, Program, Record, Thinning, VarRef};
use crate::math::Scale;
use crate::runtime::failure::Failure;
use crate::runtime::observe::{Cell, Observer, Row, Who};
use crate::runtime::population::{ABSENT, Agents};
use crate::runtime::present::{Depth, Present};
use crate::runtime::solve::scheduled;
use crate::runtime::truth;

/// Makes the rows that the records of a program ask for.
pub struct Recorder<'p> {
    program: &'p Program,
    records: Vec<Recording<'p>>,
    time_end: f64,
    /// The last instant with micro-steps, and how many it had.
    last_instant: (f64, usize),
    cells: Vec<Cell>,
}

/// Whether a row is written where one of the same agent and time has been.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Repeat {
    Never,
    Always,
}

struct Recording<'p> {
    record: &'p Record,
    /// The distance of samples, s; infinite where every step is recorded.
    every: f64,
    /// Samples written so far, and not given up.
    n_samples: u64,
    /// The rows of each of them, and the time of the last one; where they are thinned out.
    kept: Vec<usize>,
    last_sample: f64,
    /// The places of its agents that are alive, in the order of their numbers.
    roster: Vec<usize>,
    /// The time of the last row of each of them, by place; for records of every step.
    last: FxHashMap<usize, f64>,
}

impl<'p> Recorder<'p> {
    /// No rows yet.
    pub fn new(program: &'p Program, time_end: f64) -> Self {
        let records = program.run.records.iter().map(|record| Recording {
            record,
            every: match record.pace {
                Pace::EveryStep => f64::INFINITY,
                Pace::Every(every) => every,
                Pace::Thinning(thinning) => thinning.first,
            },
            n_samples: 0,
            kept: Vec::new(),
            last_sample: f64::NEG_INFINITY,
            roster: record.agents.clone(),
            last: FxHashMap::default(),
        });
        Self { program, records: records.collect(), time_end, last_instant: (f64::NAN, 0), cells: Vec::new() }
    }

    /// Takes an agent in that has been created.
    pub fn admit(&mut self, who: Who, place: usize) {
        for recording in &mut self.records {
            if recording.record.born[who.ty] {
                recording.roster.push(place);
            }
        }
    }

    /// Takes agents out that have died.
    pub fn dismiss(&mut self, dead: &FxHashSet<usize>) {
        for recording in &mut self.records {
            recording.roster.retain(|place| !dead.contains(place));
            recording.last.retain(|place, _| !dead.contains(place));
        }
    }

    /// The time of the next sample of any record; infinite for none.
    pub fn next(&self) -> f64 {
        self.records.iter().map(|recording| self.next_of(recording)).fold(f64::INFINITY, f64::min)
    }

    /// k d, or the end where k d misses it by rounding.
    fn next_of(&self, recording: &Recording<'_>) -> f64 {
        if recording.record.pace == Pace::EveryStep {
            return f64::INFINITY;
        }
        let time = scheduled(recording.n_samples as f64 * recording.every, self.time_end);
        if time > self.time_end { f64::INFINITY } else { time }
    }

    /// Writes the samples that are due at `time`.
    pub fn sample(
        &mut self,
        agents: &Agents<'_>,
        present: &mut Present,
        time: f64,
        observer: &mut dyn Observer,
    ) -> Result<(), Failure> {
        present.go(time);
        for number in 0..self.records.len() {
            if self.next_of(&self.records[number]) != time {
                continue;
            }
            self.records[number].n_samples += 1;
            self.sample_of(agents, present, number, observer)?;
            while self.records[number].is_full(time) {
                self.records[number].thin();
                observer.thinned(number)?;
            }
        }
        Ok(())
    }

    /// The run is over: writes the last sample of the records that are thinned out.
    pub fn end(
        &mut self,
        agents: &Agents<'_>,
        present: &mut Present,
        observer: &mut dyn Observer,
    ) -> Result<(), Failure> {
        for number in 0..self.records.len() {
            let recording = &self.records[number];
            if matches!(recording.record.pace, Pace::Thinning(_)) && recording.last_sample < present.time {
                self.sample_of(agents, present, number, observer)?;
            }
        }
        Ok(())
    }

    /// Writes a row for each agent of a record at the present time.
    fn sample_of(
        &mut self,
        agents: &Agents<'_>,
        present: &mut Present,
        number: usize,
        observer: &mut dyn Observer,
    ) -> Result<(), Failure> {
        let time = present.time;
        let micro = if self.last_instant.0 == time { self.last_instant.1 } else { 0 };
        let recording = &mut self.records[number];
        let mut n_rows = recording.roster.len();
        if let Pace::Thinning(thinning) = recording.record.pace {
            n_rows = n_rows.min(thinning.agents_most);
            recording.kept.push(n_rows);
            recording.last_sample = time;
        }
        present.survey(agents, &recording.roster[..n_rows]);
        for k in 0..n_rows {
            let agent = self.records[number].roster[k];
            self.row(agents, present, number, agent, micro, observer)?;
        }
        Ok(())
    }

    /// Writes the first rows of the records of every step: the state before the instant t = 0.
    pub fn begin(
        &mut self,
        agents: &Agents<'_>,
        present: &mut Present,
        observer: &mut dyn Observer,
    ) -> Result<(), Failure> {
        for agent in agents.living() {
            self.write_every_step(agents, present, agent, 0, Repeat::Never, observer)?;
        }
        Ok(())
    }

    /// Writes the rows of an agent's accepted step that has become final.
    pub fn step(
        &mut self,
        agents: &Agents<'_>,
        present: &mut Present,
        agent: usize,
        time: f64,
        observer: &mut dyn Observer,
    ) -> Result<(), Failure> {
        present.go(time);
        self.write_every_step(agents, present, agent, 0, Repeat::Never, observer)
    }

    /// Writes the near side of an event in a micro-step.
    pub fn before_write(
        &mut self,
        agents: &Agents<'_>,
        present: &mut Present,
        agent: usize,
        micro: usize,
        observer: &mut dyn Observer,
    ) -> Result<(), Failure> {
        self.write_every_step(agents, present, agent, micro, Repeat::Never, observer)
    }

    /// Writes the far side of an event for the agents that it wrote.
    pub fn after_instant(
        &mut self,
        agents: &Agents<'_>,
        present: &mut Present,
        micro: usize,
        touched: &BTreeSet<(usize, usize)>,
        observer: &mut dyn Observer,
    ) -> Result<(), Failure> {
        let before = if self.last_instant.0 == present.time { self.last_instant.1 } else { 0 };
        self.last_instant = (present.time, before.max(micro));
        for &(_, agent) in touched.iter().filter(|(number, agent)| agents.number(*agent) == *number) {
            self.write_every_step(agents, present, agent, micro, Repeat::Always, observer)?;
        }
        Ok(())
    }

    /// Whether any record asks for every step.
    pub fn wants_steps(&self) -> bool {
        self.records.iter().any(|recording| recording.record.pace == Pace::EveryStep)
    }

    /// The agents of which every step is recorded, rising.
    pub fn recorded_steps(&self) -> Vec<usize> {
        let every_step = self.records.iter().filter(|recording| recording.record.pace == Pace::EveryStep);
        let mut agents: Vec<usize> = every_step.flat_map(|recording| &recording.roster).copied().collect();
        agents.sort_unstable();
        agents.dedup();
        agents
    }

    fn write_every_step(
        &mut self,
        agents: &Agents<'_>,
        present: &mut Present,
        agent: usize,
        micro: usize,
        repeat: Repeat,
        observer: &mut dyn Observer,
    ) -> Result<(), Failure> {
        for number in 0..self.records.len() {
            let recording = &mut self.records[number];
            if recording.record.pace != Pace::EveryStep {
                continue;
            }
            if !recording.roster.contains(&agent)
                || repeat == Repeat::Never && recording.last.get(&agent) == Some(&present.time)
            {
                continue;
            }
            recording.last.insert(agent, present.time);
            self.row(agents, present, number, agent, micro, observer)?;
        }
        Ok(())
    }

    fn row(
        &mut self,
        agents: &Agents<'_>,
        present: &mut Present,
        number: usize,
        agent: usize,
        micro: usize,
        observer: &mut dyn Observer,
    ) -> Result<(), Failure> {
        present.make(agents, &[agent], Depth::States);
        let record = self.records[number].record;
        let mut cells = std::mem::take(&mut self.cells);
        cells.clear();
        for variable in &record.variables[agents.agents[agent].ty] {
            cells.push(variable.map_or(Cell::Empty, |variable| self.cell(agents, present, agent, variable)));
        }
        let (who, mode) = (agents.who(agent), &agents.mode(agent).path);
        let row = Row { time: present.time, micro, agent: who, mode, cells: &cells };
        let told = observer.sample(number, &row);
        self.cells = cells;
        Ok(told?)
    }

    /// A variable of an agent in its declared unit.
    fn cell(&self, agents: &Agents<'_>, present: &mut Present, agent: usize, variable: VarRef) -> Cell {
        let row = &agents.agents[agent];
        let system = &self.program.types[row.ty];
        let layout: &Layout = &system.layout;
        let number = |value: f64, boolean: bool, scale: Scale| {
            if boolean { Cell::Bool(value != 0.0) } else { Cell::Number(scale.from_si(value)) }
        };
        match variable {
            VarRef::State(k) => number(present.states(agent)[k], false, system.states[k].scale),
            VarRef::Discrete(k) => {
                number(row.aux[layout.discrete(k)], system.discretes[k].boolean, system.discretes[k].scale)
            }
            VarRef::Param(k) => {
                number(row.aux[layout.param(k)], system.params[k].boolean, system.params[k].scale)
            }
            VarRef::Link(k) => {
                let target = agents.linked(agent, k);
                Cell::Agent((target != ABSENT).then(|| agents.who(target)))
            }
            VarRef::Let(k) => {
                let definition = &system.lets[k];
                if definition.mode != 0 && !crate::runtime::guards::inside(agents, agent, definition.mode) {
                    return Cell::Empty;
                }
                let slots = agents.slots(&definition.frame, &[agent]);
                match &definition.value {
                    LetValue::Number(function) => {
                        let value =
                            truth::value(agents, present, *function, &definition.frame, &slots, &[agent]);
                        number(value, definition.column.boolean, definition.column.scale)
                    }
                    LetValue::Condition(guard) => {
                        Cell::Bool(truth::test(agents, present, guard, &definition.frame, &slots, &[agent]))
                    }
                }
            }
        }
    }
}

/// Before [`Thinning::coarse_until`] this share of samples and rows is enough.
const COARSE: usize = 8;

impl Recording<'_> {
    /// Whether it has more samples or rows than it may have at this time.
    fn is_full(&self, time: f64) -> bool {
        let Pace::Thinning(Thinning {
            samples_most,
            rows_enough,
            samples_least,
            rows_most,
            coarse_until,
            ..
        }) = self.record.pace
        else {
            return false;
        };
        let share = if time < coarse_until { COARSE } else { 1 };
        let (n_samples, n_rows) = (self.kept.len().saturating_sub(1), self.kept.iter().sum::<usize>());
        n_samples > 1
            && (n_samples > samples_most / share
                || n_rows > rows_enough / share && n_samples > samples_least / share
                || n_rows > rows_most / share)
    }

    /// Gives up every second sample, those with odd numbers.
    fn thin(&mut self) {
        let mut number = 0;
        self.kept.retain(|_| {
            number += 1;
            number % 2 == 1
        });
        self.n_samples = self.n_samples.div_ceil(2);
        self.every *= 2.0;
    }
}
