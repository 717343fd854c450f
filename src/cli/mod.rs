//! The command line: the only floor that reads files, prints, or ends the process.
//!
//! In: the words that the user typed. Out: files, text, and an exit code ([`Exit`]) that scripts can rest on.
//! Promised: no option is ever ignored; a closed pipe is not an error;
//! what a run has computed is on disk before the process ends.

mod arguments;
mod terminal;
mod explain;
mod limits;
pub mod compare;
mod input;
mod progress;
mod sinks;
mod outputs;
mod claims;
mod warnings;
mod sarif;
mod refusal;
mod algorithm;
mod landmarks;
mod watch;
mod film;
mod texts;
mod run;
mod report;
mod plot;
mod check;
mod show;
mod new;
mod fmt;
mod shell;

use std::ffi::OsString;
use std::process::ExitCode;

use clap::Parser;

use arguments::{Arguments, Command};
pub use explain::{Explanation, explanations};

/// How a command can end; the number is the exit code.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Exit {
    /// All is well.
    Fine = 0,
    /// The model has errors.
    ModelErrors = 1,
    /// Wrong usage, or a file that cannot be read or written.
    Usage = 2,
    /// The run stopped in error; its outputs up to then are complete.
    RunError = 3,
    /// The run ended, and a claim of the model was false.
    FalseClaim = 4,
    /// Interrupted by the user.
    Interrupted = 130,
}

impl From<Exit> for ExitCode {
    fn from(exit: Exit) -> Self {
        ExitCode::from(exit as u8)
    }
}

/// What ends a command before its work is done: one line for the user.
type Refused = String;

/// Does what the words say; the first word is the program's name.
pub fn main(words: impl IntoIterator<Item = OsString>) -> Exit {
    let arguments = match Arguments::try_parse_from(words) {
        Ok(arguments) => arguments,
        Err(error) => return usage(&error),
    };
    terminal::set_colours(arguments.color);
    let done = match arguments.command {
        Command::Run(arguments) => run::run(&arguments),
        Command::Report(arguments) => report::report(*arguments),
        Command::Plot(arguments) => plot::plot(&arguments),
        Command::Compare(arguments) => compare::compare(&arguments),
        Command::Check(arguments) => check::check(&arguments),
        Command::Show(arguments) => show::show(&arguments),
        Command::Explain(arguments) => explain::explain(&arguments),
        Command::New(arguments) => new::new(&arguments),
        Command::Completions(arguments) => shell::completions(&arguments),
        Command::Man(arguments) => shell::man(&arguments),
        Command::Fmt(arguments) => fmt::fmt(&arguments),
    };
    done.unwrap_or_else(|refused| {
        terminal::complain(&refused);
        Exit::Usage
    })
}

/// Prints what the argument parser has to say: help and version are fine, all else is wrong usage.
fn usage(error: &clap::Error) -> Exit {
    // Where even this cannot be printed there is nobody to tell.
    let _ = error.print();
    if error.use_stderr() { Exit::Usage } else { Exit::Fine }
}
