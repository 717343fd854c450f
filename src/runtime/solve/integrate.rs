//! One step of an integration: tries by a method until the error is small enough.
//!
//! The method may change from step to step: the [`Switch`] of an integration says which takes the next.
//!
//! In: where the integration is, what is known of its past, the accuracy. Out: the stretch of the accepted step, with the
//! new states in the trial; or why there is none.

use std::collections::VecDeque;

use crate::math::elementary::pow;
use crate::runtime::solve::control::{Accuracy, Control};
use crate::runtime::solve::jacobian::Jacobian;
use crate::runtime::solve::method::{Flow, Method, Past, Start, Stretch, Trial};
use crate::runtime::solve::rodas5p::Rodas5p;
use crate::runtime::solve::segment::Segment;
use crate::runtime::solve::switch::{self, Regime, Switch, Vote};
use crate::runtime::solve::{self, Methods, ulp};

/// What one integration remembers from step to step.
#[derive(Clone, Debug, Default)]
pub struct Integration {
    /// The step to try next, s; none: to be estimated.
    pub h: Option<f64>,
    /// Memory of the step-size control.
    control: Control,
    /// Rates at the clock and before it.
    past: Past,
    /// Which method takes the next step, where there is a choice.
    pub switch: Switch,
    /// The last tries, oldest first; for messages.
    pub attempts: VecDeque<Attempt>,
}

/// A step that was tried.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Attempt {
    /// Where it begins, s.
    pub t: f64,
    /// Its length, s.
    pub h: f64,
    /// Its error in units of what is allowed; NaN if it met a number that is not finite.
    pub ratio: f64,
    /// Whether it was accepted.
    pub accepted: bool,
    /// How many were refused at the same time, this one included if it was.
    pub refused: u32,
}

/// How many tries are remembered.
const ATTEMPTS: usize = 5;

/// Operations that are taken for the right-hand sides of a step, for each equation, where methods are compared: ten for
/// each of the six of an explicit step, and of the eight of a stiff one with its Jacobian.
const EXPLICIT_RATES: u64 = 60;
/// See above.
const STIFF_RATES: u64 = 90;

impl Integration {
    /// An integration that begins with this step; none: to be estimated.
    pub fn new(h: Option<f64>) -> Self {
        Self { h, ..Self::default() }
    }

    /// Forgets the past: the next step begins afresh.
    pub fn restart(&mut self) {
        self.past.clear();
    }

    /// What is known of the rates, at the clock and before it.
    pub fn past(&self) -> &Past {
        &self.past
    }

    /// Whether the next step begins afresh.
    pub fn is_fresh(&self) -> bool {
        self.past.is_empty()
    }

    /// Notes a step that was taken elsewhere.
    pub fn note_accepted(&mut self, t: f64, h: f64, ratio: f64) {
        self.note(Attempt { t, h, ratio, accepted: true, refused: 0 });
    }

    /// Notes a try; of those at one time, the last.
    fn note(&mut self, mut attempt: Attempt) {
        attempt.refused = u32::from(!attempt.accepted);
        if let Some(before) = self.attempts.pop_back_if(|before| !before.accepted && before.t == attempt.t) {
            attempt.refused += before.refused;
        }
        if self.attempts.len() == ATTEMPTS {
            self.attempts.pop_front();
        }
        self.attempts.push_back(attempt);
    }
}

/// Why no step is possible.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stuck {
    /// The rates are not finite, here or however near after.
    NonFinite,
    /// The step needed for the accuracy is below the resolution of time.
    Underflow,
}

/// Takes steps; owns the scratch space of the methods.
pub struct Integrator {
    /// Takes the steps of [`Regime::Explicit`]; where there is no choice, all.
    method: Box<dyn Method>,
    /// Takes those of [`Regime::Stiff`].
    stiff: Option<Rodas5p>,
    /// Which of them took the last step.
    regime: Regime,
    /// Scratch: of a look whether a flow is stiff, and of the stiff step that is tried for it.
    jacobian: Jacobian,
    asked: Trial,
    accuracy: Accuracy,
    /// No step leads beyond, s; one that would nearly reach it ends there.
    pub stop: f64,
    /// No step is longer, s.
    pub step_max: f64,
    /// The last try; its states are the new ones when a step has been accepted.
    pub trial: Trial,
    /// Tries that were rejected.
    pub rejected: u64,
    /// Arithmetic operations of the method, without those of the right-hand sides.
    pub operations: u64,
}

impl Integrator {
    /// An integrator up to `time_end`, s.
    pub fn new(methods: Methods, accuracy: Accuracy, time_end: f64) -> Self {
        Self {
            method: solve::method(methods.first(), accuracy),
            stiff: match methods {
                Methods::One(_) => None,
                Methods::Automatic(_) => Some(Rodas5p::default()),
            },
            regime: Regime::Explicit,
            jacobian: Jacobian::default(),
            asked: Trial::default(),
            accuracy,
            stop: time_end,
            step_max: f64::INFINITY,
            trial: Trial::default(),
            rejected: 0,
            operations: 0,
        }
    }

    /// Tries steps from `(t, x)` until one is good enough.
    pub fn step(
        &mut self,
        t: f64,
        x: &[f64],
        integration: &mut Integration,
        flow: &mut dyn Flow,
    ) -> Result<Stretch, Stuck> {
        self.trial.resize(x.len());
        self.begin(t, x, integration, flow)?;
        let reach = match integration.switch.regime {
            Regime::Explicit => self.method.reach(t, x, self.accuracy, flow),
            Regime::Stiff => None,
        };
        let mut h = match (reach, integration.h) {
            (Some(h), _) | (None, Some(h)) => h,
            (None, None) => self.first_step(t, x, integration, flow),
        };
        loop {
            let left = self.stop - t;
            let wanted = h.min(self.step_max);
            let (step, end) =
                if wanted >= left * (1.0 - 1e-12) { (left, self.stop) } else { (wanted, t + wanted) };
            let too_short = end <= t + 2.0 * ulp(t);
            if too_short && end < self.stop {
                return Err(if self.is_finite() { Stuck::Underflow } else { Stuck::NonFinite });
            }
            self.try_step(&Start { t, h: step, x, past: &integration.past }, integration.switch.regime, flow);
            let stretch = Stretch { t, h: step, end };
            if too_short {
                // Not a step, but the end: what is left of the run cannot be told from none.
                self.trial.x_new.copy_from_slice(x);
                return Ok(stretch);
            }
            let Trial { error, x_new, rates, pace } = &self.trial;
            let defined = rates.iter().all(|rate| rate.is_finite());
            let ratio = if defined { self.accuracy.error_norm(error, x, x_new) } else { f64::NAN };
            let accepted = ratio <= 1.0;
            integration.note(Attempt { t, h: step, ratio, accepted, refused: 0 });
            if accepted {
                let next = step * integration.control.accepted(ratio, *pace);
                let cut_short = step < wanted;
                integration.h = Some(if cut_short { next.max(h) } else { next }.min(1e100));
                self.look(&stretch, integration, flow);
                return Ok(stretch);
            }
            self.rejected += 1;
            h = step * integration.control.rejected(ratio, *pace);
        }
    }

    /// Tries one step by the method of a regime.
    fn try_step(&mut self, start: &Start<'_>, regime: Regime, flow: &mut dyn Flow) {
        self.regime = regime;
        let method: &mut dyn Method = match (&mut self.stiff, regime) {
            (Some(stiff), Regime::Stiff) => stiff,
            (None, _) | (_, Regime::Explicit) => &mut *self.method,
        };
        method.step(start, flow, &mut self.trial);
        self.operations += method.operations(start.past.len()) * start.x.len() as u64;
    }

    /// After an accepted step: whether the next is for the other method.
    fn look(&mut self, stretch: &Stretch, integration: &mut Integration, flow: &mut dyn Flow) {
        let Some(stiff) = &self.stiff else { return };
        if !integration.switch.is_due() {
            return;
        }
        let change = match self.regime {
            Regime::Stiff => switch::follows(stretch.h, stiff.jacobian()),
            Regime::Explicit => {
                flow.jacobian(stretch.end, &self.trial.x_new, &mut self.jacobian);
                !switch::follows(stretch.h, &self.jacobian) && self.stiff_pays(stretch, flow)
            }
        };
        integration.switch.count(if change { Vote::Change } else { Vote::Stay });
    }

    /// Whether, after an explicit step, a stiff one would be good enough that is longer by twice what it costs more.
    fn stiff_pays(&mut self, stretch: &Stretch, flow: &mut dyn Flow) -> bool {
        let (Some(stiff), x) = (&mut self.stiff, &self.trial.x_new) else { return false };
        let explicit = self.method.operations(self.method.depth()) + EXPLICIT_RATES;
        let ratio = (stiff.operations_with(&self.jacobian) + STIFF_RATES) as f64 / explicit as f64;
        let h = 2.0 * ratio * stretch.h;
        if stretch.end + h > self.stop {
            return false;
        }
        let mut past = Past::default();
        past.push(stretch.end, &self.trial.rates, 1);
        self.asked.resize(x.len());
        stiff.step(&Start { t: stretch.end, h, x, past: &past }, flow, &mut self.asked);
        self.operations += stiff.operations(1) * x.len() as u64;
        let Trial { error, x_new, rates, .. } = &self.asked;
        rates.iter().all(|rate| rate.is_finite()) && self.accuracy.error_norm(error, x, x_new) <= 1.0
    }

    /// Which method took the last step, where there is a choice.
    pub fn regime(&self) -> Regime {
        self.regime
    }

    /// Does again what failed last, for a flow that looks on.
    pub fn again(&mut self, t: f64, x: &[f64], integration: &Integration, flow: &mut dyn Flow) {
        match integration.attempts.back() {
            Some(last) if !integration.is_fresh() => {
                let start = Start { t, h: last.h, x, past: &integration.past };
                if integration.switch.regime == Regime::Explicit {
                    self.method.reach(t, x, self.accuracy, flow);
                }
                self.try_step(&start, integration.switch.regime, flow);
            }
            Some(_) | None => flow.rates(t, x, &mut self.trial.rates),
        }
    }

    /// Writes the dense output of the accepted step for the states `x` at its begin, equations from `first` on.
    pub fn dense(&self, stretch: &Stretch, x: &[f64], first: usize, segment: &mut Segment) {
        match (&self.stiff, self.regime) {
            (Some(stiff), Regime::Stiff) => stiff.dense(stretch, x, first, segment),
            (None, _) | (_, Regime::Explicit) => self.method.dense(stretch, x, first, segment),
        }
    }

    /// Goes on from the end of the accepted step, for which dense output has been written.
    pub fn keep(&mut self, stretch: &Stretch, integration: &mut Integration) {
        integration.past.push(stretch.end, &self.trial.rates, self.method.depth());
    }

    /// Whether all numbers of the last try are finite.
    fn is_finite(&self) -> bool {
        let Trial { x_new, error, rates, .. } = &self.trial;
        x_new.iter().chain(error).chain(rates).all(|value| value.is_finite())
    }

    /// Finds the rates at the clock, where they are not known.
    pub fn begin(
        &mut self,
        t: f64,
        x: &[f64],
        integration: &mut Integration,
        flow: &mut dyn Flow,
    ) -> Result<(), Stuck> {
        if !integration.past.is_empty() {
            return Ok(());
        }
        self.trial.resize(x.len());
        let Trial { x_new, error, rates, .. } = &mut self.trial;
        x_new.copy_from_slice(x);
        error.fill(0.0);
        flow.rates(t, x, rates);
        if !rates.iter().all(|rate| rate.is_finite()) {
            return Err(Stuck::NonFinite);
        }
        integration.past.push(t, rates, self.method.depth());
        Ok(())
    }

    /// The first step: Hairer, Norsett & Wanner, Solving ODEs I, II.4, with the second rates by one Euler step.
    fn first_step(&self, t: f64, x: &[f64], integration: &Integration, flow: &mut dyn Flow) -> f64 {
        let n = x.len();
        let norm = |v: &[f64]| {
            (0..n).fold(0.0_f64, |norm, i| norm.max(v[i].abs() / self.accuracy.allowed(x[i].abs())))
        };
        let first_rates = integration.past.rates(0);
        let (d0, d1) = (norm(x), norm(first_rates));
        let h0 = if d0 < 1e-5 || d1 < 1e-5 { 1e-6 } else { 0.01 * d0 / d1 };
        let h0 = h0.min(self.stop - t);
        let moved: Vec<f64> = (0..n).map(|i| x[i] + h0 * first_rates[i]).collect();
        let mut rates = vec![0.0; n];
        flow.rates(t + h0, &moved, &mut rates);
        let difference: Vec<f64> = (0..n).map(|i| rates[i] - first_rates[i]).collect();
        let d2 = norm(&difference) / h0;
        let largest = d1.max(d2);
        let h1 = if largest <= 1e-15 {
            (h0 * 1e-3).max(1e-6)
        } else {
            pow(0.01 / largest, 1.0 / self.method.order())
        };
        let h = h1.min(100.0 * h0);
        if h.is_finite() && h > 0.0 { h } else { h0.max(1e-12) }
    }
}
