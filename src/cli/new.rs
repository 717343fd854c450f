//! `hyc new`: a model to begin with.

use std::fs::File;
use std::io::{self, Write};
use std::path::PathBuf;

use super::arguments::NewArguments;
use super::input::reason;
use super::terminal::say;
use super::{Exit, Refused};

/// The model, with `NAME` where its name belongs.
const MODEL: &str = include_str!("new_model.hy");

/// Writes the model, and says what to type next. A file that is there stays as it is.
pub(super) fn new(arguments: &NewArguments) -> Result<Exit, Refused> {
    let name = arguments.name.strip_suffix(".hy").unwrap_or(&arguments.name);
    let path = PathBuf::from(format!("{name}.hy"));
    let is_name = !name.is_empty() && !name.ends_with(['/', '\\', '.']);
    let stem = path.file_stem().filter(|_| is_name);
    let stem = stem.and_then(|stem| stem.to_str()).ok_or("a name is needed: `hyc new robots`")?;
    let shown = path.display();
    let text = MODEL.replace("NAME", stem);
    File::create_new(&path).and_then(|mut file| file.write_all(text.as_bytes())).map_err(
        |error| match error.kind() {
            io::ErrorKind::AlreadyExists => format!("`{shown}` is there already; give another name"),
            _ => format!("cannot write `{shown}`: {}", reason(&error)),
        },
    )?;
    let typed = quoted(&shown.to_string());
    say(&format!(
        "wrote {shown}, a model that runs:\n\
         \x20 hyc run {typed}      simulate it\n\
         \x20 hyc report {typed}   simulate it, and write {stem}.html: open that in a browser\n"
    ))?;
    Ok(Exit::Fine)
}

/// A word as it is typed: between quotes, if a shell would take it for several or for something else.
fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_alphanumeric() || "/\\.:_-+@%,".contains(c);
    if word.chars().all(is_plain) { word.into() } else { format!("'{}'", word.replace('\'', "'\\''")) }
}
