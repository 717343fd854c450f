//! `hyc completions` and `hyc man`: what a shell and its manual should know of the command line, from its definition.

use clap::CommandFactory;

use super::arguments::{Arguments, CompletionsArguments, ManArguments};
use super::terminal::say;
use super::{Exit, Refused};

/// Prints a script for the shell.
pub(super) fn completions(arguments: &CompletionsArguments) -> Result<Exit, Refused> {
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, &mut Arguments::command(), "hyc", &mut script);
    say(&String::from_utf8_lossy(&script))?;
    Ok(Exit::Fine)
}

/// Prints the page of `hyc`, or of one of its commands, for `man`.
pub(super) fn man(arguments: &ManArguments) -> Result<Exit, Refused> {
    let mut whole = Arguments::command();
    whole.build();
    let page = match &arguments.command {
        None => whole,
        Some(name) => {
            let known = whole.get_subcommands().find(|command| command.get_name() == name);
            known.cloned().ok_or_else(|| format!("there is no command `{name}`; `hyc --help` lists all"))?
        }
    };
    let title = page.get_bin_name().unwrap_or("hyc").replace(' ', "-");
    let mut text = Vec::new();
    clap_mangen::Man::new(page)
        .title(title)
        .render(&mut text)
        .map_err(|error| format!("cannot make the page: {error}"))?;
    say(&String::from_utf8_lossy(&text))?;
    Ok(Exit::Fine)
}
