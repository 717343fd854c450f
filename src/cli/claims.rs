//! False asserts as diagnostics.

use crate::base::Diagnostic;
use crate::output::{Cast, write_number};
use crate::runtime::observe::FalseAssert;

/// One warning for each assert that was false, in the order in which they first were.
pub(super) fn diagnostics(claims: &[FalseAssert], cast: &Cast) -> Vec<Diagnostic> {
    claims.iter().map(|claim| diagnostic(claim, cast)).collect()
}

fn diagnostic(claim: &FalseAssert, cast: &Cast) -> Diagnostic {
    let mut time = String::new();
    write_number(&mut time, claim.time);
    let title = match &claim.message {
        Some(message) => format!("an assert was false: {message}"),
        None => "an assert was false".into(),
    };
    let agent = cast.agents.get(claim.agent).map_or("an agent", String::as_str);
    let first = format!("first at t = {time} s for `{agent}`");
    let diagnostic = Diagnostic::warning("HY0590", title).label(claim.span, first);
    match claim.count {
        0 | 1 => diagnostic,
        count => diagnostic.note(format!("it became false {count} times, over all agents")),
    }
}
