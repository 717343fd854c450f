//! All tables of a run as one observer; each is there only if it is asked for.

use std::io;

use super::cast::Cast;
use super::event_log::EventLog;
use super::explanations::Explanations;
use super::final_states::FinalStates;
use super::table::Sink;
use super::trajectory::Trajectory;
use crate::base::SourceMap;
use crate::runtime::observe::{Event, Explanation, Last, Observer, Progress, Row, Undecided};

/// The observer that writes tables. Begin with [`Tables::new`], add what is wanted, end with [`Tables::flush`].
pub struct Tables<'a> {
    cast: &'a Cast,
    event_log: Option<EventLog>,
    trajectories: Vec<Trajectory>,
    final_states: Option<FinalStates>,
    explanations: Option<Explanations<'a>>,
    on_progress: Box<dyn FnMut(&Progress) + 'a>,
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
        }
    }

    /// Adds the event log. Fails if its header cannot be written.
    pub fn event_log(&mut self, sink: Sink) -> io::Result<()> {
        self.event_log = Some(EventLog::new(sink)?);
        Ok(())
    }

    /// Adds the table of the next record of the run's settings; records must be added in their order, all of them.
    pub fn trajectory(&mut self, sink: Sink, columns: &[String]) -> io::Result<()> {
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

    /// Hands on all that has been written. Tries every table, and returns the first failure.
    pub fn flush(&mut self) -> io::Result<()> {
        let mut results = Vec::new();
        results.extend(self.event_log.as_mut().map(EventLog::flush));
        results.extend(self.trajectories.iter_mut().map(Trajectory::flush));
        results.extend(self.final_states.as_mut().map(FinalStates::flush));
        results.extend(self.explanations.as_mut().map(Explanations::flush));
        results.into_iter().collect()
    }
}

impl Observer for Tables<'_> {
    fn event(&mut self, event: &Event<'_>) -> io::Result<()> {
        match &mut self.event_log {
            Some(log) => log.event(self.cast, event),
            None => Ok(()),
        }
    }

    fn sample(&mut self, record: usize, row: &Row<'_>) -> io::Result<()> {
        match self.trajectories.get_mut(record) {
            Some(trajectory) => trajectory.sample(self.cast, row),
            None => Ok(()),
        }
    }

    fn last(&mut self, last: &Last<'_>) -> io::Result<()> {
        match &mut self.final_states {
            Some(table) => table.last(self.cast, last),
            None => Ok(()),
        }
    }

    fn progress(&mut self, progress: &Progress) -> io::Result<()> {
        (self.on_progress)(progress);
        Ok(())
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
