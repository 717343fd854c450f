//! From `--algorithm` and the options of the published algorithms to what the runtime takes.

use super::Refused;
use super::arguments::{AlgorithmName, EngineArguments, PaperArguments};
use crate::model::ir::Integrator;
use crate::runtime::paper::{Algorithm, Form, Paper};

/// The algorithm by its name, with the numbers that the user gives; `audit` has its misses counted.
pub(super) fn algorithm(
    name: AlgorithmName,
    form: Form,
    given: &PaperArguments,
    audit: bool,
) -> Result<Algorithm, Refused> {
    let paper = paper(given, audit)?;
    match name {
        AlgorithmName::Masim => Ok(Algorithm::Masim(form)),
        AlgorithmName::Masim2004 => Ok(Algorithm::Masim2004(paper)),
        AlgorithmName::Sasim2004 => Ok(Algorithm::Sasim2004(paper)),
    }
}

/// The same for a single run, where an option that its algorithm does not know is refused.
pub(super) fn single(arguments: &EngineArguments, audit: bool) -> Result<Algorithm, Refused> {
    let PaperArguments { gamma, h_min, h_max, synchronisation, event_tolerance } = arguments.paper;
    if arguments.algorithm == AlgorithmName::Masim {
        let options = [
            ("--gamma", gamma),
            ("--h-min", h_min),
            ("--h-max", h_max),
            ("--synchronisation", synchronisation),
            ("--event-tolerance", event_tolerance),
        ];
        if let Some((name, _)) = options.iter().find(|(_, value)| value.is_some()) {
            return Err(format!("`{name}` belongs to `--algorithm masim-2004` and `sasim-2004`"));
        }
    }
    algorithm(arguments.algorithm, arguments.engine.form(), &arguments.paper, audit)
}

fn paper(given: &PaperArguments, audit: bool) -> Result<Paper, Refused> {
    let defaults = Paper::default();
    let paper = Paper {
        gamma: given.gamma.unwrap_or(defaults.gamma),
        h_min: given.h_min.unwrap_or(defaults.h_min),
        h_max: given.h_max.unwrap_or(defaults.h_max),
        synchronisation: given.synchronisation.unwrap_or(defaults.synchronisation),
        event_tolerance: given.event_tolerance.unwrap_or(defaults.event_tolerance),
        audit,
    };
    if paper.h_min > paper.h_max {
        return Err(format!("`--h-min` {} is more than `--h-max` {}", paper.h_min, paper.h_max));
    }
    Ok(paper)
}

/// The method of integration that an algorithm runs with: the published ones have Adams' only.
pub(super) fn integrator(
    name: AlgorithmName,
    given: Option<Integrator>,
) -> Result<Option<Integrator>, Refused> {
    match (name, given) {
        (AlgorithmName::Masim, given) => Ok(given),
        (
            AlgorithmName::Masim2004 | AlgorithmName::Sasim2004,
            None | Some(Integrator::Auto | Integrator::Adams),
        ) => Ok(Some(Integrator::Adams)),
        (AlgorithmName::Masim2004 | AlgorithmName::Sasim2004, Some(other)) => {
            Err(format!("the algorithms of 2004 integrate by `adams`, not by `{}`", other.name()))
        }
    }
}
