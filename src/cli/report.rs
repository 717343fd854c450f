//! `hyc report`: the page of a run, and nothing else of it.

use std::path::PathBuf;

use super::arguments::{OutputArguments, Outputs, ReportArguments, RunArguments};
use super::{Exit, Refused, run};

/// Runs the model for its page alone: the files that it names are not written.
pub(super) fn report(arguments: ReportArguments) -> Result<Exit, Refused> {
    let ReportArguments { model, settings, engine, out, xy, allow, quiet } = arguments;
    let page =
        out.unwrap_or_else(|| PathBuf::from(model.file_stem().unwrap_or_default()).with_extension("html"));
    let named = Outputs::Left;
    let outputs = OutputArguments { report: Some(page), named, xy, ..OutputArguments::default() };
    run::run(&RunArguments { model, settings, engine, outputs, asserts: Default::default(), allow, quiet })
}
