//! Draws diagnostics for people: the one file that names the rendering library.

use codespan_reporting::diagnostic as drawn;
use codespan_reporting::files::SimpleFiles;
use codespan_reporting::term;
use codespan_reporting::term::termcolor::{Ansi, NoColor, WriteColor};

use super::diagnostic::{Diagnostic, Severity};
use super::source::SourceMap;

/// Whether the text carries terminal colours.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Colours {
    /// ANSI escape codes.
    Ansi,
    /// Plain text.
    None,
}

/// A line of the source that has more bytes is not shown.
const LINE_MAX: usize = 2_000;

/// The diagnostics as text, in the order given, an empty line after each.
pub fn render(sources: &SourceMap, diagnostics: &[Diagnostic], colours: Colours) -> String {
    let bytes = match colours {
        Colours::Ansi => draw(sources, diagnostics, Ansi::new(Vec::new())).into_inner(),
        Colours::None => draw(sources, diagnostics, NoColor::new(Vec::new())).into_inner(),
    };
    String::from_utf8_lossy(&bytes).into_owned()
}

fn draw<W: WriteColor>(sources: &SourceMap, diagnostics: &[Diagnostic], mut writer: W) -> W {
    let mut files = SimpleFiles::new();
    for file in sources.files() {
        files.add(file.name.as_str(), file.text.as_str());
    }
    let config = term::Config { tab_width: 4, ..term::Config::default() };
    for diagnostic in diagnostics {
        let long = diagnostic.labels.iter().any(|label| sources.line_of(label.span).len() > LINE_MAX);
        let drawn = if long { to_drawn(&without_lines(sources, diagnostic)) } else { to_drawn(diagnostic) };
        term::emit_to_write_style(&mut writer, &config, &files, &drawn)
            .expect("writing to memory cannot fail, and every span lies in its file");
    }
    writer
}

/// The same with its places in words.
fn without_lines(sources: &SourceMap, diagnostic: &Diagnostic) -> Diagnostic {
    let places = diagnostic.labels.iter().map(|label| {
        let (line, column) = sources.line_column(label.span);
        format!("{}:{line}:{column}: {}", sources.file(label.span.file).name, label.text)
    });
    let notes = places.chain(diagnostic.notes.iter().cloned()).collect();
    Diagnostic { labels: Vec::new(), notes, ..diagnostic.clone() }
}

fn to_drawn(diagnostic: &Diagnostic) -> drawn::Diagnostic<usize> {
    let severity = match diagnostic.severity {
        Severity::Error => drawn::Severity::Error,
        Severity::Warning => drawn::Severity::Warning,
        Severity::Note => drawn::Severity::Note,
    };
    let labels = diagnostic.labels.iter().enumerate().map(|(k, label)| {
        let style = if k == 0 { drawn::LabelStyle::Primary } else { drawn::LabelStyle::Secondary };
        drawn::Label::new(style, label.span.file.0 as usize, label.span.range()).with_message(&label.text)
    });
    let help = diagnostic.help.iter().map(|help| format!("help: {help}"));
    drawn::Diagnostic::new(severity)
        .with_code(diagnostic.code)
        .with_message(&diagnostic.title)
        .with_labels(labels.collect())
        .with_notes(diagnostic.notes.iter().cloned().chain(help).collect())
}
