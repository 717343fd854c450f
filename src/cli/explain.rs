//! `hyc explain`: what a code means. The texts are those of `docs/ERRORS.md`, compiled in.

use super::arguments::ExplainArguments;
use super::terminal::say;
use super::{Exit, Refused};

/// The one source of all explanations.
const TEXT: &str = include_str!("../../docs/ERRORS.md");

/// An entry of the list of errors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Explanation {
    /// `HY0203`.
    pub code: &'static str,
    /// One line.
    pub title: &'static str,
    /// Markdown, with examples in fences.
    pub body: &'static str,
}

/// All entries in the order of the file. An entry begins with `## HYxxxx title` and ends where the next heading is.
pub fn explanations() -> Vec<Explanation> {
    let sections = TEXT.split("\n## ").skip(1);
    let entry = |section: &'static str| {
        let (heading, body) = section.split_once('\n')?;
        let (code, title) = heading.split_once(' ')?;
        let body = body.split("\n# ").next()?;
        code.starts_with("HY").then(|| Explanation { code, title: title.trim(), body: body.trim() })
    };
    sections.filter_map(entry).collect()
}

/// Prints the entry of a code; without a code, the list of all.
pub(super) fn explain(arguments: &ExplainArguments) -> Result<Exit, Refused> {
    let entries = explanations();
    let Some(code) = &arguments.code else {
        let lines = entries.iter().map(|entry| format!("{}  {}\n", entry.code, entry.title));
        say(&lines.collect::<String>())?;
        return Ok(Exit::Fine);
    };
    let wanted = code.trim().to_uppercase();
    match entries.iter().find(|entry| entry.code == wanted) {
        Some(entry) => {
            say(&format!("{}: {}\n\n{}\n", entry.code, entry.title, without_fences(entry.body)))?;
            Ok(Exit::Fine)
        }
        None => Err(format!("there is no code `{code}`; `hyc explain` lists all")),
    }
}

/// Examples indented, for a terminal.
fn without_fences(body: &str) -> String {
    let mut inside = false;
    let mut lines = Vec::new();
    for line in body.lines() {
        if line.starts_with("```") {
            inside = !inside;
        } else if inside && !line.is_empty() {
            lines.push(format!("    {line}"));
        } else {
            lines.push(line.to_string());
        }
    }
    lines.join("\n")
}
