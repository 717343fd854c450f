//! A run kept for pictures: sampled along with the run where its end is known, else in a second one like it.
//!
//! What is recorded never changes a run (rule 16), so the second one is the same; only its end is known by then.

use std::sync::atomic::{AtomicBool, Ordering};

use super::watch::{Watched, watch};
use crate::codegen::program::{Program, Record};
use crate::model::{Diagram, Model};
use crate::output::{Cast, Tables};
use crate::picture::Recording;
use crate::runtime::observe::{End, Outcome};
use crate::runtime::{self, Algorithm, Limits};

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
        let number = if program.run.until.is_some() { program.run.records.len() } else { 0 };
        Self { watched, recording: Recording::new(cast, diagrams, number), record: Some(record) }
    }

    /// Has a run sampled whose end is known: its record is the program's last.
    pub(super) fn begin<'r>(&'r mut self, program: &mut Program, tables: &mut Tables<'r>) {
        let Some(until) = program.run.until else { return };
        if let Some(record) = self.record.take() {
            program.run.records.push(Record { every: Some(self.watched.every(until)), ..record });
            tables.also(&mut self.recording);
        }
    }

    /// The run is over: one that has not been sampled runs again, up to where it came.
    pub(super) fn end(
        &mut self,
        algorithm: Algorithm,
        program: &mut Program,
        limits: &Limits,
        outcome: &Outcome,
        interrupt: &AtomicBool,
    ) {
        if let Some(record) = self.record.take() {
            program.run.records = vec![Record { every: Some(self.watched.every(outcome.time)), ..record }];
            if matches!(outcome.end, End::Interrupted) {
                program.run.until = Some(outcome.time);
                interrupt.store(false, Ordering::SeqCst);
            }
            runtime::simulate_by(algorithm, program, limits, interrupt, &mut self.recording);
        }
        self.recording.close();
    }
}
