//! Algorithm `masim`, fast form: the plain form in windows of time, with lists of near pairs.
//!
//! At the begin of a window the pairs are listed that can come within range for some time
//! ([`crate::runtime::near_pairs`]), and those agents run ahead that no guard can concern in the window
//! ([`crate::runtime::hot`]). A window cuts no step: its length changes no bit of any.

use crate::runtime::certify::ENDLESS;
use crate::runtime::cold::Cold;
use crate::runtime::engine::Engine;
use crate::runtime::failure::{Failure, Reason};
use crate::runtime::hot::Outlook;
use crate::runtime::observe::End;

/// So many pairs are new in a list, for each agent, that about as much work goes into them as into making the list.
const NEW_WANTED: f64 = 0.3;
/// So many agents take their steps in turn: to look ahead costs more.
const FEW: usize = 2;
/// The first list is for this share of the run.
const FIRST_LIST: f64 = 1.0 / 32.0;
/// The first window is this share of the run.
const FIRST_WINDOW: f64 = 1.0 / 256.0;
/// No window is a smaller share of the run.
const SHORTEST: f64 = 1e-6;
/// The most by which the time of a list, or of a window, grows or shrinks from one to the next.
const GROW: f64 = 2.0;
/// The share of agents that are hot at which a window is long enough.
const HOT_WANTED: f64 = 0.01;
/// The share of agents whose steps are kept at which it is.
const TRACKED_WANTED: f64 = 0.2;
/// A window in which agents take more steps than this is long enough, too.
const STEPS_WANTED: f64 = 8.0;
/// One in which they take fewer is too short, however many are hot.
const STEPS_LEAST: f64 = 0.5;

impl Engine<'_, '_> {
    /// Runs to the end.
    pub fn run_in_windows(&mut self) -> Result<End, Failure> {
        self.make_fields();
        self.make_herds();
        self.begin()?;
        let mut length = FIRST_WINDOW * self.horizon();
        loop {
            let from = self.present.time;
            if from > ENDLESS {
                return Err(Reason::NeverEnds { time: from, until: self.time_end }.into());
            }
            if self.has_fields() && self.neighbours.until <= from {
                let span = self.neighbours.span;
                let new = self.list_pairs((from + span).min(self.time_end))?;
                self.neighbours.span = self.next_span(new.len());
                new.into_iter().for_each(|new| self.await_pair(new));
            }
            let mut until = self.time_end;
            if self.has_fields() {
                until = until.min(self.neighbours.until);
            }
            if self.agents.cold.is_used() {
                until = until.min(from + length);
                self.window_end = until;
                let before = self.stepper.counts.steps;
                let outlook = self.open_window(until);
                length = (length * self.growth(outlook, before)).max(SHORTEST * self.horizon());
                self.mind_steps()?;
            }
            if let Some(end) = self.run_until(until)? {
                return Ok(end);
            }
            if until >= self.time_end {
                return self.finish();
            }
            self.present.go(until);
        }
    }

    /// Herds for those who may be cold; none if every step is watched, or for very few.
    fn make_herds(&mut self) {
        let is_watched = !self.program.properties().is_empty();
        let stay_few =
            self.agents.n_living() <= FEW && self.program.action_lists().all(|list| list.births().is_empty());
        if is_watched || !self.by_series || stay_few {
            return;
        }
        let accuracy = self.stepper.accuracy;
        self.agents.cold = Cold::new(self.program, self.agents.len(), accuracy, self.time_end);
        if self.agents.cold.is_used() {
            let may_be = |&agent: &usize| self.agents.cold.may_ever_be(self.agents.agents[agent].ty);
            self.hot = self.agents.living().into_iter().filter(may_be).collect();
        }
    }

    /// The time that the first list and the first window are shares of, s.
    fn horizon(&self) -> f64 {
        if self.time_end.is_finite() { self.time_end } else { 100.0 }
    }

    /// By how much the next window is to be longer than this one, in which the cold agents have taken their steps.
    fn growth(&self, Outlook { n_hot, n_tracked }: Outlook, steps_before: u64) -> f64 {
        let n = self.agents.n_living().max(1) as f64;
        let steps = (self.stepper.counts.steps - steps_before) as f64 / n;
        let hot = n_hot as f64 / n;
        let tracked = n_tracked as f64 / n;
        let most = (HOT_WANTED / hot).min(TRACKED_WANTED / tracked).min(STEPS_WANTED / steps);
        let wanted = most.max(STEPS_LEAST / steps);
        wanted.sqrt().clamp(1.0 / GROW, GROW)
    }

    /// Fails if the limit of steps has been passed.
    fn mind_steps(&mut self) -> Result<(), Failure> {
        let counts = &self.stepper.counts;
        if counts.steps + counts.rejected <= self.limits.steps_max {
            return Ok(());
        }
        // Somebody has taken steps, and may have died since.
        let agent = self.agents.living().first().copied().unwrap_or(0);
        self.thaw(agent);
        let place = self.place(agent);
        Err(Reason::StepLimit { place, limit: self.limits.steps_max }.into())
    }

    /// Makes the first lists, if there is anything to list; the instances are not armed.
    pub fn begin_lists(&mut self) -> Result<(), Failure> {
        if self.has_fields() {
            self.neighbours.span = FIRST_LIST * self.horizon();
            self.list_pairs(self.neighbours.span.min(self.time_end))?;
        }
        Ok(())
    }

    /// For how long the next lists are to hold, s: longer if few pairs were new in these, shorter if many were.
    fn next_span(&self, n_new: usize) -> f64 {
        let share = n_new as f64 / self.agents.n_living().max(1) as f64;
        let growth = (NEW_WANTED / share).sqrt().clamp(1.0 / GROW, GROW);
        (self.neighbours.span * growth).max(SHORTEST * self.horizon())
    }
}
