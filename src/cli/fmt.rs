//! `hyc fmt`: lays models out.

use std::fs;
use std::path::{Path, PathBuf};

use super::arguments::FmtArguments;
use super::input::{name_of, read_text, reason};
use super::terminal::{say, tell};
use super::{Exit, Refused};
use crate::base::SourceMap;
use crate::syntax;

/// Lays out each model in its place, or from standard input to standard output. A text with a syntax error stays as it is.
pub(super) fn fmt(arguments: &FmtArguments) -> Result<Exit, Refused> {
    let standard = [PathBuf::from("-")];
    let models = if arguments.models.is_empty() { &standard[..] } else { &arguments.models };
    let mut worst = Exit::Fine;
    for path in models {
        worst = worst.max(fmt_one(path, arguments.check)?);
    }
    Ok(worst)
}

fn fmt_one(path: &Path, check: bool) -> Result<Exit, Refused> {
    let text = read_text(path)?;
    let mut sources = SourceMap::default();
    let file = sources.add(name_of(path), text.as_str());
    let laid_out = match syntax::format(file, &text) {
        Ok(laid_out) => laid_out,
        Err(diagnostics) => {
            tell(&sources, &diagnostics);
            return Ok(Exit::ModelErrors);
        }
    };
    let name = path.display();
    if !syntax::same(&text, &laid_out) {
        return Err(format!(
            "`{name}` is left as it is: laid out, it would mean something else; please report this"
        ));
    }
    let changes = laid_out != text;
    match (check, path.to_str()) {
        (true, _) if changes => {
            say(&format!("{name}\n"))?;
            return Ok(Exit::ModelErrors);
        }
        (false, Some("-")) => say(&laid_out)?,
        (false, _) if changes => {
            fs::write(path, laid_out).map_err(|error| format!("cannot write `{name}`: {}", reason(&error)))?
        }
        (true | false, _) => {}
    }
    Ok(Exit::Fine)
}
