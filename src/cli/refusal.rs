//! Options of the interface that are not built yet: each is refused by its name.

use super::Refused;
use super::arguments::{Algorithm, CheckArguments, Engine, EngineArguments, Format, Integrator};

/// What `hyc fmt` says.
pub(super) const FORMATTER: &str = "`hyc fmt` is not built yet: the printer does not keep comments so far";

/// Refuses what the engine cannot do yet.
pub(super) fn refuse_engine(arguments: &EngineArguments) -> Result<(), Refused> {
    match arguments.algorithm {
        Algorithm::Masim => {}
        Algorithm::Masim2004 => return Err(not_built("--algorithm masim-2004", "masim")),
        Algorithm::Sasim2004 => return Err(not_built("--algorithm sasim-2004", "masim")),
    }
    match arguments.engine {
        Engine::Plain => {}
        Engine::Fast => return Err(not_built("--engine fast", "plain")),
    }
    match arguments.integrator {
        Integrator::Auto | Integrator::Tsit5 => Ok(()),
        Integrator::Taylor => Err(not_built("--integrator taylor", "tsit5")),
        Integrator::Adams => Err(not_built("--integrator adams", "tsit5")),
        Integrator::Stiff => Err(not_built("--integrator stiff", "tsit5")),
    }
}

/// Refuses what the checker cannot do yet.
pub(super) fn refuse_check(arguments: &CheckArguments) -> Result<(), Refused> {
    if arguments.deny.is_some() {
        return Err("`--deny` is not built yet; warnings do not change the exit code".into());
    }
    match arguments.format {
        Format::Text | Format::Json => Ok(()),
        Format::Sarif => Err(not_built("--format sarif", "json")),
    }
}

fn not_built(option: &str, instead: &str) -> Refused {
    format!("`{option}` is not built yet; there is `{instead}`")
}
