//! The line that a person watches while a simulation runs.

use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::runtime::observe::Progress;

/// Runs that are shorter draw nothing.
const WAIT: Duration = Duration::from_millis(300);
/// Time between two drawings.
const PERIOD: Duration = Duration::from_millis(100);
/// How finely the bar is divided.
const PARTS: u64 = 1000;

/// A bar on standard error; hidden if no person watches.
pub(super) struct ProgressLine {
    bar: ProgressBar,
    begun: Instant,
    drawn: Option<Instant>,
}

impl ProgressLine {
    pub(super) fn new() -> Self {
        let bar = ProgressBar::with_draw_target(Some(PARTS), ProgressDrawTarget::stderr());
        Self { bar, begun: Instant::now(), drawn: None }
    }

    /// Draws, if the last drawing is old enough.
    pub(super) fn show(&mut self, progress: &Progress) {
        let due = match self.drawn {
            Some(drawn) => drawn.elapsed() >= PERIOD,
            None => self.begun.elapsed() >= WAIT,
        };
        if self.bar.is_hidden() || !due {
            return;
        }
        let ends = progress.until.is_finite() && progress.until > 0.0;
        if self.drawn.replace(Instant::now()).is_none() {
            let template = if ends { "{bar:24} {msg}, {eta} left" } else { "{spinner} {msg}" };
            self.bar.set_style(ProgressStyle::with_template(template).expect("the template is well formed"));
        }
        if ends {
            self.bar.set_position((PARTS as f64 * progress.time / progress.until) as u64);
        } else {
            self.bar.tick();
        }
        self.bar.set_message(message(progress, self.begun.elapsed().as_secs_f64()));
    }

    /// Takes the line away.
    pub(super) fn clear(&self) {
        self.bar.finish_and_clear();
    }
}

/// `t = 12.5 of 30 s, 66 agents, 1234 events, 56 k steps/s`
fn message(progress: &Progress, seconds: f64) -> String {
    let Progress { time, until, agents, events, steps } = progress;
    // to a hundred-thousandth of the run
    let decimals = if until.is_finite() && *until > 0.0 { 5.0 - until.log10().floor() } else { 4.0 };
    let time = format!("{time:.*}", decimals.clamp(4.0, 20.0) as usize);
    let time = if until.is_finite() { format!("{time} of {until} s") } else { format!("{time} s") };
    let rate = match *steps as f64 / seconds.max(1e-3) {
        rate if rate < 1e4 => format!("{rate:.0}"),
        rate if rate < 1e6 => format!("{:.0} k", rate / 1e3),
        rate => format!("{:.1} M", rate / 1e6),
    };
    format!("t = {time}, {agents} agents, {events} events, {rate} steps/s")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_line_says_how_far_how_many_and_how_fast() {
        let progress = Progress { time: 12.5, until: 30.0, agents: 66, events: 1234, steps: 112_000 };
        assert_eq!(message(&progress, 2.0), "t = 12.5000 of 30 s, 66 agents, 1234 events, 56 k steps/s");
        let short = Progress { time: 0.000_412, until: 0.001, ..progress };
        assert!(message(&short, 2.0).starts_with("t = 0.00041200 of 0.001 s, "), "{}", message(&short, 2.0));
        let endless = Progress { until: f64::INFINITY, steps: 3_000_000, ..progress };
        assert_eq!(message(&endless, 1.0), "t = 12.5000 s, 66 agents, 1234 events, 3.0 M steps/s");
    }
}
