//! What is said on standard output and standard error.

use std::io::{self, IsTerminal, Write};

use super::Refused;
use crate::base::render::{Colours, render};
use crate::base::{Diagnostic, SourceMap};

/// Writes to standard output. That nobody reads any more is no failure.
pub(super) fn say(text: &str) -> Result<(), Refused> {
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(format!("cannot write to standard output: {error}"))
        }
        Ok(()) | Err(_) => Ok(()),
    }
}

/// Writes to standard error. Where that fails there is nobody left to tell.
pub(super) fn say_aside(text: &str) {
    let mut out = io::stderr().lock();
    let _ = out.write_all(text.as_bytes()).and_then(|()| out.flush());
}

/// Says in one line why a command was not done.
pub(super) fn complain(refused: &str) {
    let (on, off) = match colours() {
        Colours::Ansi => ("\x1b[1;31m", "\x1b[0m"),
        Colours::None => ("", ""),
    };
    say_aside(&format!("{on}error{off}: {refused}\n"));
}

/// Draws diagnostics on standard error.
pub(super) fn tell(sources: &SourceMap, diagnostics: &[Diagnostic]) {
    if !diagnostics.is_empty() {
        say_aside(&render(sources, diagnostics, colours()));
    }
}

/// Colours where a person reads, unless the environment asks for none (no-color.org).
fn colours() -> Colours {
    let refused = std::env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty());
    if io::stderr().is_terminal() && !refused { Colours::Ansi } else { Colours::None }
}
