//! All tables of a run as one observer; each is there only if it is asked for.

use std::io;
use std::time::{Duration, Instant};

use super::cast::Cast;
use super::columns::Column;
use super::event_log::EventLog;
use super::explanations::Explanations;
use super::final_states::FinalStates;
use super::table::Sink;
use super::trajectory::Trajectory;
use crate::base::SourceMap;
use crate::runtime::observe::{Event, Explanation, Last, Observer, Progress, Row, Undecided};

/// How long what has been told may wait before it is in the files.
const WAIT: Duration = Duration::from_secs(1);
/// So many rows are timed, then one of as many; no power of two, as batches and numbers of agents often are.
const TIMED: u64 = 61;

/// The observer that writes tables. Begin with [`Tables::new`], add what is wanted, end with [`Tables::finish`].
pub struct Tables<'a> {
    cast: &'a Cast,
    event_log: Option<EventLog>,
    trajectories: Vec<Trajectory>,
    final_states: Option<FinalStates>,
    explanations: Option<Explanations<'a>>,
    on_progress: Box<dyn FnMut(&Progress) + 'a>,
    also: Option<&'a mut dyn Observer>,
    flushed: Instant,
    /// Rows so far, and the time that making them took, as those say that were timed.
    rows: u64,
    making: Duration,
}

impl<'a> Tables<'a> {
    /// An observer that writes nothing yet.
    pub fn new(cast: &'a Cast) -> Self {
        Self {
            cast,
            event_log: None,
            trajectories: Vec::new(),
            final_states: None,
            explanations: None,
            on_progress: Box::new(|_| {}),
            also: None,
            flushed: Instant::now(),
            rows: 0,
            making: Duration::ZERO,
        }
    }

    /// Adds the event log. Fails if its header cannot be written.
    pub fn event_log(&mut self, sink: Sink) -> io::Result<()> {
        self.event_log = Some(EventLog::new(sink)?);
        Ok(())
    }

    /// Adds the table of the next record of the run's settings; records must be added in their order, all of them.
    pub fn trajectory(&mut self, sink: Sink, columns: &[Column]) -> io::Result<()> {
        self.trajectories.push(Trajectory::new(sink, columns)?);
        Ok(())
    }

    /// Adds the table of final states.
    pub fn final_states(&mut self, sink: Sink) -> io::Result<()> {
        self.final_states = Some(FinalStates::new(sink, self.cast)?);
        Ok(())
    }

    /// Adds the text that says why each transition fired; its places are in `sources`.
    pub fn explanations(&mut self, sink: Sink, sources: &'a SourceMap) {
        self.explanations = Some(Explanations::new(sink, sources));
    }

    /// Says what to do when the run tells how far it is.
    pub fn on_progress(&mut self, action: impl FnMut(&Progress) + 'a) {
        self.on_progress = Box::new(action);
    }

    /// Adds an observer that is told the same events and samples.
    pub fn also(&mut self, observer: &'a mut dyn Observer) {
        self.also = Some(observer);
    }

    /// Hands on all that has been written, and the ends of the tables. Tries every table, and returns the first failure.
    pub fn finish(&mut self) -> io::Result<()> {
        let mut results = Vec::new();
        results.extend(self.event_log.as_mut().map(EventLog::finish));
        results.extend(self.trajectories.iter_mut().map(Trajectory::finish));
        results.extend(self.final_states.as_mut().map(FinalStates::finish));
        results.extend(self.explanations.as_mut().map(Explanations::flush));
        results.into_iter().collect()
    }

    /// How long writing took: about, as to the making of rows, of which some are timed; to the point, as to handing them on.
    pub fn writing(&self) -> Duration {
        self.making + self.handing()
    }

    /// How long it took to hand on the rows that had come together.
    fn handing(&self) -> Duration {
        let of_log = self.event_log.iter().map(EventLog::handing);
        let of_trajectories = self.trajectories.iter().map(Trajectory::handing);
        let of_final_states = self.final_states.iter().map(FinalStates::handing);
        of_log.chain(of_trajectories).chain(of_final_states).sum()
    }

    fn flush(&mut self) -> io::Result<()> {
        self.flushed = Instant::now();
        self.event_log.as_mut().map_or(Ok(()), EventLog::flush)?;
        self.trajectories.iter_mut().try_for_each(Trajectory::flush)?;
        self.explanations.as_mut().map_or(Ok(()), Explanations::flush)
    }

    fn timed(&mut self, write: impl FnOnce(&mut Self) -> io::Result<()>) -> io::Result<()> {
        self.rows += 1;
        let each = self.rows <= TIMED;
        if !each && !self.rows.is_multiple_of(TIMED) {
            return write(self);
        }
        let (begun, handing) = (Instant::now(), self.handing());
        let written = write(self);
        let making = begun.elapsed().saturating_sub(self.handing() - handing);
        self.making += making * if each { 1 } else { TIMED as u32 };
        written
    }
}

impl Observer for Tables<'_> {
    fn event(&mut self, event: &Event<'_>) -> io::Result<()> {
        if let Some(also) = &mut self.also {
            also.event(event)?;
        }
        if self.event_log.is_none() {
            return Ok(());
        }
        self.timed(|tables| tables.event_log.as_mut().map_or(Ok(()), |log| log.event(tables.cast, event)))
    }

    fn sample(&mut self, record: usize, row: &Row<'_>) -> io::Result<()> {
        if let Some(also) = &mut self.also {
            also.sample(record, row)?;
        }
        if record >= self.trajectories.len() {
            return Ok(());
        }
        self.timed(|tables| tables.trajectories[record].sample(tables.cast, row))
    }

    fn thinned(&mut self, record: usize) -> io::Result<()> {
        self.also.as_mut().map_or(Ok(()), |also| also.thinned(record))
    }

    fn last(&mut self, last: &Last<'_>) -> io::Result<()> {
        self.timed(|tables| match &mut tables.final_states {
            Some(table) => table.last(tables.cast, last),
            None => Ok(()),
        })
    }

    fn progress(&mut self, progress: &Progress) -> io::Result<()> {
        (self.on_progress)(progress);
        if self.flushed.elapsed() >= WAIT { self.flush() } else { Ok(()) }
    }

    fn wants_reasons(&self) -> bool {
        self.explanations.is_some()
    }

    fn explanation(&mut self, explanation: &Explanation<'_>) -> io::Result<()> {
        match &mut self.explanations {
            Some(text) => text.explanation(self.cast, explanation),
            None => Ok(()),
        }
    }

    fn undecided(&mut self, undecided: &Undecided) -> io::Result<()> {
        match &mut self.explanations {
            Some(text) => text.undecided(self.cast, undecided),
            None => Ok(()),
        }
    }
}
