//! How a run is computed: the command line's options over the settings of `run { }`, as the runtime takes them.

use std::num::NonZero;
use std::thread;

use super::Refused;
use super::arguments::{EngineArguments, PaperArguments};
use super::limits::Limits;
use crate::model::Model;
use crate::model::ir::{Integrator, Machinery};
use crate::model::machinery::{AlgorithmName, BackendName, EngineName};
use crate::runtime::paper::{Algorithm, Form, Paper};

/// How a single run is computed.
pub(super) struct Computed {
    pub(super) algorithm: Algorithm,
    pub(super) backend: BackendName,
}

/// The algorithm by its name, with the numbers that the user gives; `audit` has its misses counted.
pub(super) fn algorithm(
    name: AlgorithmName,
    form: Form,
    given: &PaperArguments,
    model: &Machinery,
    audit: bool,
) -> Result<Algorithm, Refused> {
    let paper = paper(given, model, audit)?;
    match name {
        AlgorithmName::Masim => Ok(Algorithm::Masim(form)),
        AlgorithmName::Masim2004 => Ok(Algorithm::Masim2004(paper)),
        AlgorithmName::Sasim2004 => Ok(Algorithm::Sasim2004(paper)),
    }
}

/// What a single run is computed by; an option that its algorithm does not know is refused. The model takes what the command line
/// says of its run.
pub(super) fn single(
    arguments: &EngineArguments,
    model: &mut Model,
    audit: bool,
) -> Result<Computed, Refused> {
    let run = &mut model.run;
    let name = arguments.algorithm.or(run.machinery.algorithm).unwrap_or_default();
    let PaperArguments { gamma, h_min, h_max, synchronisation, event_tolerance } = arguments.paper;
    if name == AlgorithmName::Masim {
        let options = [
            ("--gamma", gamma),
            ("--h-min", h_min),
            ("--h-max", h_max),
            ("--synchronisation", synchronisation),
        ];
        if let Some((name, _)) = options.iter().find(|(_, value)| value.is_some()) {
            return Err(format!("`{name}` belongs to `--algorithm masim-2004` and `sasim-2004`"));
        }
        run.machinery.event_tolerance = event_tolerance.or(run.machinery.event_tolerance);
    } else {
        // Of an algorithm of its own the model knows which methods that has.
        let own = if arguments.algorithm.is_none() { Some(run.integrator) } else { None };
        run.integrator = published(arguments.integrator.or(own))?;
    }
    let form = form(arguments.engine.or(run.machinery.engine).unwrap_or_default());
    let algorithm = algorithm(name, form, &arguments.paper, &run.machinery, audit)?;
    let backend = arguments.backend.or(run.machinery.backend).unwrap_or_default();
    Ok(Computed { algorithm, backend })
}

/// Lays the limits that a model sets under those of the command line. As many threads as the machine has may work, unless
/// somebody says how many.
pub(super) fn limits_of(
    model: &Model,
    given: &[(String, u64)],
    threads: Option<u32>,
) -> Result<Limits, Refused> {
    let mut all = Vec::new();
    let machinery = &model.run.machinery;
    let own = [("max_microsteps", machinery.microsteps_max), ("zeno_events", machinery.zeno_events)];
    all.extend(own.into_iter().filter_map(|(name, value)| Some((name.to_string(), u64::from(value?)))));
    all.extend_from_slice(given);
    let mut limits = Limits::new(&all)?;
    let threads = threads.or(machinery.threads).map(|threads| threads as usize);
    limits.run.threads_max =
        threads.unwrap_or_else(|| thread::available_parallelism().map_or(1, NonZero::get));
    Ok(limits)
}

fn form(name: EngineName) -> Form {
    match name {
        EngineName::Fast => Form::Fast,
        EngineName::Plain => Form::Plain,
    }
}

fn paper(given: &PaperArguments, model: &Machinery, audit: bool) -> Result<Paper, Refused> {
    let defaults = Paper::default();
    let paper = Paper {
        gamma: given.gamma.or(model.gamma).unwrap_or(defaults.gamma),
        h_min: given.h_min.or(model.h_min).unwrap_or(defaults.h_min),
        h_max: given.h_max.or(model.h_max).unwrap_or(defaults.h_max),
        synchronisation: given.synchronisation.or(model.synchronisation).unwrap_or(defaults.synchronisation),
        event_tolerance: given.event_tolerance.unwrap_or(defaults.event_tolerance),
        audit,
    };
    if paper.h_min > paper.h_max {
        return Err(format!("`--h-min` {} is more than `--h-max` {}", paper.h_min, paper.h_max));
    }
    Ok(paper)
}

/// The method of integration of the published algorithms: they have Adams' only.
fn published(given: Option<Integrator>) -> Result<Integrator, Refused> {
    match given {
        None | Some(Integrator::Auto | Integrator::Adams) => Ok(Integrator::Adams),
        Some(other) => Err(format!("the algorithms of 2004 integrate by `adams`, not by `{}`", other.name())),
    }
}
