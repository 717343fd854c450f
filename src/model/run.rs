//! Passes 6 and 8: `run { }`, with the command line laid over it.

use rustc_hash::FxHashMap;

use super::Settings;
use super::context::{Context, Home, Scope};
use super::dimension::Dimension;
use super::error::{FileError, LimitError, RunError};
use super::ir::Pace;
use super::machinery::Named;
use super::suggest::closest;
use super::types::{Slot, Ty};
use crate::base::Span;
use crate::syntax::ast::{self, ExprKind, Item, RunSettingKind};

/// The settings of `run { }`.
pub const SETTINGS: [&str; 19] = [
    "until",
    "tolerance",
    "absolute",
    "seed",
    "integrator",
    "record",
    "events",
    "stop",
    "algorithm",
    "engine",
    "backend",
    "threads",
    "event_tolerance",
    "max_microsteps",
    "zeno_events",
    "gamma",
    "h_min",
    "h_max",
    "synchronisation",
];

/// What one might look for, and no model contains.
const STEP_SIZES: [&str; 6] = ["step", "step_max", "step_min", "max_step", "min_step", "dt"];

/// A setting that is one number: its name, what it must be, the test.
struct Number {
    name: &'static str,
    needs: &'static str,
    /// None: absolute tolerances are of all states.
    dimension: Option<Dimension>,
    allowed: fn(f64) -> bool,
}

const UNTIL: Number = Number {
    name: "until",
    needs: "a time from 0 on",
    dimension: Some(Dimension::TIME),
    allowed: |value| value >= 0.0 && value.is_finite(),
};
const TOLERANCE: Number = Number {
    name: "tolerance",
    needs: "a number above 0",
    dimension: Some(Dimension::ONE),
    allowed: |value| value > 0.0 && value.is_finite(),
};
const ABSOLUTE: Number = Number {
    name: "absolute",
    needs: "a number above 0",
    dimension: None,
    allowed: |value| value > 0.0 && value.is_finite(),
};
const EVERY: Number = Number {
    name: "every",
    needs: "a time above 0",
    dimension: Some(Dimension::TIME),
    allowed: |value| value > 0.0 && value.is_finite(),
};
const SEED: Number = Number {
    name: "seed",
    needs: "a whole number from 0 to 2^53",
    dimension: Some(Dimension::ONE),
    allowed: |value| value.fract() == 0.0 && (0.0..=9_007_199_254_740_992.0).contains(&value),
};

const EVENT_TOLERANCE: Number = step("event_tolerance");
const GAMMA: Number = Number {
    name: "gamma",
    needs: "a number from 0, below 1",
    dimension: Some(Dimension::ONE),
    allowed: |value| (0.0..1.0).contains(&value),
};

/// A setting that is a length of time.
const fn step(name: &'static str) -> Number {
    Number {
        name,
        needs: "a time above 0",
        dimension: Some(Dimension::TIME),
        allowed: |value| value > 0.0 && value.is_finite(),
    }
}

/// A setting that counts.
const fn count(name: &'static str) -> Number {
    Number {
        name,
        needs: "a whole number from 1 to 2^31",
        dimension: Some(Dimension::ONE),
        allowed: |value| value.fract() == 0.0 && (1.0..=2_147_483_648.0).contains(&value),
    }
}

/// Fills in the settings that are numbers or names.
pub(super) fn settle<'a>(context: &mut Context<'a>, items: &[&'a Item], settings: &Settings) {
    if let Some(run) = only_run(items) {
        context.model.run.span = Some(run.span);
        let mut set = FxHashMap::default();
        for setting in &run.settings {
            context.setting(setting, &mut set);
        }
        context.ordered_steps(&set);
    }
    context.lay_over(settings);
}

/// Fills in the trajectories to write, once the agents are known.
pub(super) fn trajectories<'a>(context: &mut Context<'a>, items: &[&'a Item], settings: &Settings) {
    for setting in only_run(items).into_iter().flat_map(|run| &run.settings) {
        if let RunSettingKind::Record { columns, period, file } = &setting.kind {
            context.record(columns, period.as_ref(), file, setting.span);
        }
    }
    if settings.record_all && context.model.run.records.is_empty() {
        let record = context.everything(Pace::EveryStep);
        context.model.run.records.extend(record);
    }
}

/// The `run` of a model; a second one is refused.
fn only_run<'a>(items: &[&'a Item]) -> Option<&'a ast::Run> {
    items.iter().find_map(|item| match item {
        Item::Run(run) => Some(run),
        _ => None,
    })
}

impl<'a> Context<'a> {
    fn setting(&mut self, item: &'a ast::RunSetting, set: &mut FxHashMap<String, Span>) {
        match &item.kind {
            RunSettingKind::Until(value) => {
                self.only_once("until", item.span, set);
                if let Some(value) = self.run_number(&UNTIL, value) {
                    self.model.run.until = Some(value);
                }
            }
            RunSettingKind::StopWhen(_) | RunSettingKind::Record { .. } => {}
            RunSettingKind::Output { name, file } if name.text == "events" => {
                self.only_once("events", item.span, set);
                self.file_name(file);
                self.model.run.events = Some(file.value.clone());
            }
            RunSettingKind::Output { name, .. } => self.unknown_setting(name),
            RunSettingKind::Set { name, value } => {
                self.only_once(&name.text, item.span, set);
                match name.text.as_str() {
                    "integrator" => {
                        if let Some(integrator) = self.named(name, value) {
                            self.model.run.integrator = integrator;
                        }
                    }
                    "algorithm" => self.model.run.machinery.algorithm = self.named(name, value),
                    "engine" => self.model.run.machinery.engine = self.named(name, value),
                    "backend" => self.model.run.machinery.backend = self.named(name, value),
                    _ => self.set_number(name, value),
                }
            }
        }
    }

    fn only_once(&mut self, name: &str, span: Span, set: &mut FxHashMap<String, Span>) {
        if let Some(first) = set.insert(name.to_string(), span) {
            self.report(RunError::Twice { name: name.to_string(), span, first });
        }
    }

    fn file_name(&mut self, file: &ast::Text) {
        if file.value.trim().is_empty() {
            let why = "the name is empty".to_string();
            self.report(FileError::Unreadable { path: file.value.clone(), why, span: file.span });
        }
    }

    fn set_number(&mut self, name: &'a ast::Name, value: &'a ast::Expr) {
        let setting = match name.text.as_str() {
            "tolerance" => TOLERANCE,
            "absolute" => ABSOLUTE,
            "seed" => SEED,
            "event_tolerance" => EVENT_TOLERANCE,
            "threads" => count("threads"),
            "max_microsteps" => count("max_microsteps"),
            "zeno_events" => count("zeno_events"),
            "gamma" => GAMMA,
            "h_min" => step("h_min"),
            "h_max" => step("h_max"),
            "synchronisation" => step("synchronisation"),
            size if STEP_SIZES.contains(&size) => {
                return self.report(RunError::StepSize { name: size.to_string(), span: name.span });
            }
            _ => return self.unknown_setting(name),
        };
        let Some(value) = self.run_number(&setting, value) else { return };
        let run = &mut self.model.run;
        let machinery = &mut run.machinery;
        match name.text.as_str() {
            "tolerance" => run.tolerance = value,
            "absolute" => run.absolute = Some(value),
            "event_tolerance" => machinery.event_tolerance = Some(value),
            "threads" => machinery.threads = Some(value as u32),
            "max_microsteps" => machinery.microsteps_max = Some(value as u32),
            "zeno_events" => machinery.zeno_events = Some(value as u32),
            "gamma" => machinery.gamma = Some(value),
            "h_min" => machinery.h_min = Some(value),
            "h_max" => machinery.h_max = Some(value),
            "synchronisation" => machinery.synchronisation = Some(value),
            _ => run.seed = value as u64,
        }
    }

    /// The least step of the algorithms of 2004 is no longer than the longest.
    fn ordered_steps(&mut self, set: &FxHashMap<String, Span>) {
        let machinery = &self.model.run.machinery;
        if let (Some(least), Some(most)) = (machinery.h_min, machinery.h_max)
            && least > most
        {
            let (name, needs) = ("h_min".to_string(), "no more than `h_max`");
            let span = set.get("h_min").copied().unwrap_or_default();
            self.report(RunError::OutOfRange { name, needs, found: least.to_string(), span });
        }
    }

    /// A setting that is one of some names; a hyphen in it reads as a difference, and it may stand in quotes.
    fn named<T: Named>(&mut self, setting: &ast::Name, value: &ast::Expr) -> Option<T> {
        let text = match &value.kind {
            ExprKind::Text(text) => text.clone(),
            _ => self.sources.text(value.span).split_whitespace().collect(),
        };
        let named = T::named(&text);
        if named.is_none() {
            let found = match &value.kind {
                ExprKind::Name(_) | ExprKind::Text(_) => format!("`{text}`"),
                _ => "an expression".into(),
            };
            let (name, needs) = (setting.text.clone(), T::WORDS);
            self.report(RunError::OutOfRange { name, needs, found, span: value.span });
        }
        named
    }

    fn unknown_setting(&mut self, name: &ast::Name) {
        let similar = closest(&name.text, SETTINGS);
        self.report(RunError::Unknown { name: name.text.clone(), span: name.span, similar });
    }

    fn run_number(&mut self, setting: &Number, expr: &'a ast::Expr) -> Option<f64> {
        let what = format!("`{}`", setting.name);
        let slot = setting.dimension.map_or(Slot::plain(Ty::Real), Slot::of);
        let value = self.lower_into(&mut Scope::of(Home::File), expr, slot, &what);
        let value = self.constant(value, expr, &what)?;
        self.in_range(setting, value, expr.span)
    }

    fn in_range(&mut self, setting: &Number, value: f64, span: Span) -> Option<f64> {
        if (setting.allowed)(value) {
            return Some(value);
        }
        self.report(RunError::OutOfRange {
            name: setting.name.to_string(),
            needs: setting.needs,
            found: value.to_string(),
            span,
        });
        None
    }

    fn lay_over(&mut self, settings: &Settings) {
        if let Some(value) = self.given(&UNTIL, settings.until) {
            self.model.run.until = Some(value);
        }
        if let Some(value) = self.given(&TOLERANCE, settings.tolerance) {
            self.model.run.tolerance = value;
        }
        if let Some(value) = self.given(&ABSOLUTE, settings.absolute) {
            self.model.run.absolute = Some(value);
        }
        if let Some(seed) = settings.seed {
            self.model.run.seed = seed;
        }
        if let Some(integrator) = settings.integrator {
            self.model.run.integrator = integrator;
        }
    }

    fn given(&mut self, setting: &Number, value: Option<f64>) -> Option<f64> {
        let value = value?;
        if (setting.allowed)(value) {
            return Some(value);
        }
        let span = self.command_line(&format!("--{} ", setting.name), &value.to_string());
        self.in_range(setting, value, span)
    }

    fn record(
        &mut self,
        items: &'a [ast::Expr],
        period: Option<&'a ast::Expr>,
        file: &'a ast::Text,
        span: Span,
    ) {
        let mut choice = self.nothing_chosen();
        for item in items {
            self.choose(item, &mut choice);
        }
        let every = period.and_then(|period| self.run_number(&EVERY, period));
        if let (Some(every), Some(period), Some(until)) = (every, period, self.model.run.until) {
            let most = self.model.limits.samples_max;
            if until / every > most as f64 {
                self.report(LimitError::Samples { most, span: period.span });
            }
        }
        self.file_name(file);
        let pace = every.map_or(Pace::EveryStep, Pace::Every);
        let record = self.chosen(choice, pace, &file.value, span);
        self.model.run.records.extend(record);
    }
}
