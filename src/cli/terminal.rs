//! What is said on standard output and standard error.

use std::io::{self, IsTerminal, Write};
use std::sync::OnceLock;

use super::Refused;
use super::arguments::ColourWhen;
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

/// What the user says about colours; said once, before anything else is.
static WHEN: OnceLock<ColourWhen> = OnceLock::new();

/// Takes note of `--color`.
pub(super) fn set_colours(when: ColourWhen) {
    // Only the first word counts, and there is only one.
    let _ = WHEN.set(when);
}

/// Colours as `--color` says; else, in this order, none if NO_COLOR is set (no-color.org), some if CLICOLOR_FORCE is and not 0,
/// none if CLICOLOR is 0 (bixense.com/clicolors), and some where a person reads.
fn colours() -> Colours {
    let set = |name: &str| std::env::var_os(name).filter(|value| !value.is_empty());
    let wanted = match WHEN.get().copied().unwrap_or_default() {
        ColourWhen::Always => true,
        ColourWhen::Never => false,
        ColourWhen::Auto if set("NO_COLOR").is_some() => false,
        ColourWhen::Auto if set("CLICOLOR_FORCE").is_some_and(|value| value != "0") => true,
        ColourWhen::Auto if set("CLICOLOR").is_some_and(|value| value == "0") => false,
        ColourWhen::Auto => io::stderr().is_terminal(),
    };
    if wanted { Colours::Ansi } else { Colours::None }
}
