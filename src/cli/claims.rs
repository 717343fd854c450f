//! False asserts and properties as diagnostics.

use crate::base::{Diagnostic, number_text};
use crate::output::Cast;
use crate::runtime::observe::{Compared, FalseAssert, Verdict};

/// One warning for each assert that was false, in the order in which they first were.
pub(super) fn diagnostics(claims: &[FalseAssert], cast: &Cast) -> Vec<Diagnostic> {
    claims.iter().map(|claim| diagnostic(claim, cast)).collect()
}

/// One warning for each property that does not hold.
pub(super) fn of_properties(verdicts: &[Verdict]) -> Vec<Diagnostic> {
    let wrong = verdicts.iter().filter(|verdict| !verdict.holds);
    let told = wrong.map(|verdict| {
        Diagnostic::warning("HY0521", format!("the property `{}` is false", verdict.name))
            .label(verdict.span, verdict.told())
    });
    told.collect()
}

fn diagnostic(claim: &FalseAssert, cast: &Cast) -> Diagnostic {
    let time = number_text(claim.time);
    let title = match &claim.message {
        Some(message) => format!("an assert was false: {message}"),
        None => "an assert was false".into(),
    };
    let agent = cast.agent(claim.agent);
    let mode = if claim.mode.is_empty() { String::new() } else { format!(" in mode {}", claim.mode) };
    let first = format!("first at t = {time} s for `{agent}`{mode}");
    let mut diagnostic = Diagnostic::warning("HY0590", title).label(claim.span, first);
    diagnostic.notes.extend(claim.compared.iter().map(Compared::numbers));
    match claim.count {
        0 | 1 => diagnostic,
        count => diagnostic.note(format!("it became false {count} times, over all agents")),
    }
}
