//! Which warnings are shown, and which count as errors.
//!
//! A warning is left out if `--allow` names its code, or a comment does, on its line or on the line above: `// allow HY0601`.
//! Of the others those that `--deny` names (or all, `--deny warnings`) become errors. So `--allow` wins over `--deny`.

use super::{Refused, explanations};
use crate::base::{Diagnostic, Severity, SourceMap, Span};

/// What the user says about warnings.
#[derive(Debug, Default)]
pub(super) struct Levels {
    allowed: Vec<String>,
    denied: Vec<String>,
    all_denied: bool,
}

impl Levels {
    /// Reads the options; each value is a code, or for `--deny` also `warnings`.
    pub(super) fn new(allow: &[String], deny: &[String]) -> Result<Self, Refused> {
        let codes = |words: &[String]| words.iter().map(|word| code(word)).collect::<Result<Vec<_>, _>>();
        let (all, some): (Vec<String>, Vec<String>) =
            deny.iter().cloned().partition(|word| word == "warnings");
        Ok(Self { allowed: codes(allow)?, denied: codes(&some)?, all_denied: !all.is_empty() })
    }

    /// The diagnostics that are shown, as bad as the user takes them, in the order of the text.
    pub(super) fn settle(&self, sources: &SourceMap, found: Vec<Diagnostic>) -> Vec<Diagnostic> {
        let mut shown: Vec<Diagnostic> = found
            .into_iter()
            .filter(|diagnostic| {
                diagnostic.severity != Severity::Warning || !self.allows(sources, diagnostic)
            })
            .map(|diagnostic| self.judge(diagnostic))
            .collect();
        shown.sort_by_key(|diagnostic| diagnostic.labels.first().map(|label| label.span));
        shown
    }

    fn allows(&self, sources: &SourceMap, diagnostic: &Diagnostic) -> bool {
        let by_comment =
            |span: Span| lines_about(sources, span).any(|line| comment_allows(line, diagnostic.code));
        self.allowed.iter().any(|code| code == diagnostic.code)
            || diagnostic.labels.first().is_some_and(|label| by_comment(label.span))
    }

    fn judge(&self, mut diagnostic: Diagnostic) -> Diagnostic {
        let denied = self.all_denied || self.denied.iter().any(|code| code == diagnostic.code);
        if denied && diagnostic.severity == Severity::Warning {
            diagnostic.severity = Severity::Error;
            diagnostic.notes.push("a warning, made an error by `--deny`".into());
        }
        diagnostic
    }
}

/// A code as it is listed.
fn code(word: &str) -> Result<String, Refused> {
    let code = word.trim().to_uppercase();
    match explanations().iter().any(|entry| entry.code == code) {
        true => Ok(code),
        false => Err(format!("there is no warning `{word}`; `hyc explain` lists all codes")),
    }
}

/// The line on which a place begins, and the one above.
fn lines_about(sources: &SourceMap, span: Span) -> impl Iterator<Item = &str> {
    let (line, _) = sources.line_column(span);
    (line.saturating_sub(2)..line).map(move |number| sources.file(span.file).line(number))
}

/// Whether the comment of a line says `allow` and then, among codes, this one.
fn comment_allows(line: &str, code: &str) -> bool {
    let Some((_, comment)) = line.split_once("//") else { return false };
    let mut words = comment.split([' ', ',', '\t']).filter(|word| !word.is_empty());
    words.any(|word| word == "allow")
        && words.take_while(|word| word.starts_with("HY")).any(|word| word == code)
}

/// "2 errors, 1 warning"; none if there is nothing.
pub(super) fn count(diagnostics: &[Diagnostic]) -> Option<String> {
    let of = |severity: Severity| diagnostics.iter().filter(|found| found.severity == severity).count();
    let words = [(of(Severity::Error), "error"), (of(Severity::Warning), "warning")];
    let words = words.into_iter().filter(|(n, _)| *n > 0);
    let words: Vec<String> =
        words.map(|(n, word)| format!("{n} {word}{}", if n == 1 { "" } else { "s" })).collect();
    (!words.is_empty()).then(|| words.join(", "))
}
