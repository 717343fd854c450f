//! What the equations give away about conditions: those that are never true, never false, true at single points only, true
//! again at once, or dear to look at.
//!
//! In: a system. Out: warnings (HY06xx), none of which stops a run. Values are bounded by intervals over affine forms
//! (`form`), states by nothing at all, discrete variables by what they are ever given (`growth`). A warning is given only where
//! the bounds are certain, so most of what is odd passes; what is told is so.

mod truth;
mod effects;
mod warning;
mod flowing;
mod certain;
mod starts;
mod never;
mod hidden;
mod again;
mod opposite;
mod oneself;
mod pairs;
mod broken;
mod zeno;

use crate::base::Diagnostic;
use crate::calculus::growth;
use crate::calculus::system::System;
use warning::Warning;

/// Everything worth a warning, in the order of the text.
pub fn lint(system: &System) -> Vec<Diagnostic> {
    let mut found: Vec<Warning> = Vec::new();
    let bounds = growth::bounds(system);
    never::transitions(system, &bounds, &mut found);
    hidden::transitions(system, &bounds, &mut found);
    again::transitions(system, &bounds, &mut found);
    opposite::transitions(system, &bounds, &mut found);
    oneself::conditions(system, &bounds, &mut found);
    pairs::conditions(system, &bounds, &mut found);
    let starts = starts::Starts::of(system);
    broken::invariants(system, &bounds, &starts, &mut found);
    zeno::transitions(system, &bounds, &starts, &mut found);
    let mut found: Vec<Diagnostic> = found.into_iter().map(Diagnostic::from).collect();
    found.sort_by_key(|diagnostic| diagnostic.labels.first().map(|label| label.span));
    found.dedup();
    found
}
