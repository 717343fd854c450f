//! A run kept for pictures, sampled along with it: wherever it ends, there are neither few samples nor many.
//!
//! What is recorded never changes a run (rule 16).

use super::watch::{AGENTS_MOST, Watched, watch};
use crate::codegen::program::{Program, Record};
use crate::model::{Diagram, Model};
use crate::output::{Cast, Tables};
use crate::picture::{EVENTS_MAX, Recording};
use crate::runtime::observe::Outcome;

/// What is sampled, and the samples.
pub(super) struct Film<'a> {
    pub(super) watched: Watched,
    pub(super) recording: Recording<'a>,
    /// Not yet a record of the program.
    record: Option<Record>,
}

impl<'a> Film<'a> {
    /// Nothing sampled yet.
    pub(super) fn new(model: &Model, program: &Program, cast: &'a Cast, diagrams: &[Diagram]) -> Self {
        let (record, watched) = watch(model, program);
        let place = (program.run.records.len(), record.columns.len());
        Self { watched, recording: Recording::new(cast, diagrams, place), record: Some(record) }
    }

    /// Has the run sampled: its record is the program's last.
    pub(super) fn begin<'r>(&'r mut self, program: &mut Program, tables: &mut Tables<'r>) {
        program.run.records.extend(self.record.take());
        tables.also(&mut self.recording);
    }

    /// The run is over.
    pub(super) fn end(&mut self) {
        self.recording.close();
    }

    /// What is not shown of the run, a sentence each; empty if all is.
    pub(super) fn left_out(&self, outcome: &Outcome) -> String {
        let Recording { times, events, n_events, .. } = &self.recording;
        let n_ever: u64 = outcome.stats.types.iter().map(|ty| ty.agents + ty.destroyed).sum();
        let n_unseen = n_ever.saturating_sub(self.recording.n_sampled() as u64);
        let mut text = Vec::new();
        if n_unseen > 0 {
            let apart = match times[..] {
                [first, second, ..] => {
                    format!(", which are {} s apart", crate::base::number_text(second - first))
                }
                [_] | [] => String::new(),
            };
            text.push(format!(
                "{n_unseen} of {n_ever} agents are not shown: they lived between two samples{apart}, or there were more than \
                 {AGENTS_MOST} at a time."
            ));
        }
        if *n_events > events.len() as u64 {
            text.push(format!("Of {n_events} rows of the event log the first {EVENTS_MAX} are shown."));
        }
        text.join(" ")
    }
}
