//! Algorithm `masim`, fast form: the plain form in windows of time, with lists of near pairs.
//!
//! Between two windows the pairs are listed that can come within range in the next ([`crate::runtime::near_pairs`]).

use crate::runtime::engine::Engine;
use crate::runtime::failure::Failure;
use crate::runtime::observe::End;

/// As many pairs are listed for an agent as balance, about, what listing and what looking at pairs costs.
const PAIRS_WANTED: f64 = 0.5;
/// The first list is for this share of the run.
const FIRST_SHARE: f64 = 1.0 / 32.0;
/// The most by which the time of a list grows or shrinks from one to the next.
const GROW: f64 = 2.0;

impl Engine<'_, '_> {
    /// Runs to the end.
    pub fn run_in_windows(&mut self) -> Result<End, Failure> {
        self.make_fields();
        self.begin()?;
        loop {
            let until = if self.has_fields() { self.neighbours.until.min(self.time_end) } else { self.time_end };
            if let Some(end) = self.run_until(until)? {
                return Ok(end);
            }
            if until >= self.time_end {
                return self.finish();
            }
            self.present.go(until);
            let span = self.next_span();
            for instance in self.list_pairs(until + span)? {
                self.meet(instance);
            }
        }
    }

    /// Makes the first lists, if there is anything to list; the instances are not armed.
    pub fn begin_lists(&mut self) -> Result<(), Failure> {
        if self.has_fields() {
            let end = if self.time_end.is_finite() { self.time_end } else { 1.0 / FIRST_SHARE };
            self.neighbours.span = FIRST_SHARE * end;
            self.list_pairs(self.neighbours.span)?;
        }
        Ok(())
    }

    /// For how long the next lists are to hold, s: longer if few pairs are listed, shorter if many are.
    fn next_span(&mut self) -> f64 {
        let n_listed: usize = self.neighbours.fields.iter().map(|field| field.listed.len()).sum();
        let share = n_listed as f64 / self.agents.len() as f64;
        self.neighbours.span *= (PAIRS_WANTED / share).sqrt().clamp(1.0 / GROW, GROW);
        self.neighbours.span
    }
}
