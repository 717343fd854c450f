//! What there is to say about a model: as much of it as anybody reads is kept, the rest is counted.

use super::limits::DIAGNOSTICS_MAX;
use crate::base::Diagnostic;

/// So many are held before all but the first are left out: a giant text may have an error in every line.
const HELD_MAX: usize = 50 * DIAGNOSTICS_MAX;

/// Diagnostics as they come.
#[derive(Debug, Default)]
pub(super) struct Findings {
    held: Vec<Diagnostic>,
    n_left_out: usize,
}

impl Findings {
    /// Adds one.
    pub fn push(&mut self, diagnostic: Diagnostic) {
        self.held.push(diagnostic);
        if self.held.len() >= HELD_MAX {
            self.leave_out();
        }
    }

    /// How many there have been, those that were told twice included.
    pub fn count(&self) -> usize {
        self.n_left_out + self.held.len()
    }

    /// Whether an error is among them: errors come before all else.
    pub fn has_errors(&self) -> bool {
        self.held.iter().any(Diagnostic::is_error)
    }

    /// The first ones in the order of the text, errors before all else, and how many more there are.
    pub fn told(mut self) -> Vec<Diagnostic> {
        self.leave_out();
        if self.n_left_out > 0
            && let Some(last) = self.held.last_mut()
        {
            last.notes.push(format!("{} more like these are not shown", self.n_left_out));
        }
        self.held
    }

    fn leave_out(&mut self) {
        self.held.sort_by_key(|diagnostic| diagnostic.labels.first().map(|label| label.span));
        self.held.dedup();
        if self.held.len() > DIAGNOSTICS_MAX {
            self.held.sort_by_key(|diagnostic| !diagnostic.is_error());
            self.n_left_out += self.held.len() - DIAGNOSTICS_MAX;
            self.held.truncate(DIAGNOSTICS_MAX);
        }
    }
}

impl From<Vec<Diagnostic>> for Findings {
    fn from(held: Vec<Diagnostic>) -> Self {
        Self { held, n_left_out: 0 }
    }
}
