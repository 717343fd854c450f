//! The line that a person watches while a simulation runs.

use std::io::{self, IsTerminal};
use std::time::{Duration, Instant};

use super::terminal::say_aside;
use crate::runtime::observe::Progress;

/// Time between two drawings.
const PERIOD: Duration = Duration::from_millis(100);

/// A line on standard error that is drawn over again; nothing if no person watches.
pub(super) struct ProgressLine {
    watched: bool,
    drawn: Option<Instant>,
    begun: Instant,
}

impl ProgressLine {
    pub(super) fn new() -> Self {
        Self { watched: io::stderr().is_terminal(), drawn: None, begun: Instant::now() }
    }

    /// Draws, if the last drawing is old enough. Short runs draw nothing.
    pub(super) fn show(&mut self, progress: &Progress) {
        let since = self.drawn.unwrap_or(self.begun);
        if !self.watched || since.elapsed() < PERIOD {
            return;
        }
        self.drawn = Some(Instant::now());
        let share = match progress.until {
            until if until.is_finite() && until > 0.0 => {
                format!(" of {until} s ({:.0} %)", 100.0 * progress.time / until)
            }
            _ => " s".into(),
        };
        let Progress { time, events, steps, .. } = progress;
        say_aside(&format!("\r\x1b[Kt = {time:.6}{share}, {events} events, {steps} steps"));
    }

    /// Takes the line away.
    pub(super) fn clear(&mut self) {
        if self.drawn.take().is_some() {
            say_aside("\r\x1b[K");
        }
    }
}
