//! Why transitions fired, for people: a paragraph for each event, in the order of the event log.
//!
//! Comparisons are shown as the model writes them, with the numbers of both sides in SI just before the event and at it. A
//! *margin* is how far a comparison is on its true side; it is negative where the comparison is false.

use std::io::{self, BufWriter, Write};

use super::cast::Cast;
use super::table::{Sink, unwritten};
use crate::base::{SourceMap, Span, number_text};
use crate::runtime::observe::{Cause, Compared, Explanation, Undecided, Who, WhyUndecided};

/// The text of explanations, written as the run proceeds.
pub(super) struct Explanations<'a> {
    sources: &'a SourceMap,
    name: String,
    writer: BufWriter<Box<dyn Write + Send>>,
}

impl<'a> Explanations<'a> {
    pub(super) fn new(sink: Sink, sources: &'a SourceMap) -> Self {
        Self { sources, name: sink.name, writer: BufWriter::new(sink.writer) }
    }

    pub(super) fn explanation(&mut self, cast: &Cast, told: &Explanation<'_>) -> io::Result<()> {
        let who = participants(cast, told.agent, told.other);
        let micro = if told.micro == 0 { String::new() } else { format!(", micro-step {}", told.micro) };
        let mut lines =
            vec![format!("t = {} s{micro}: `{}` of {who}", number_text(told.time), told.transition)];
        lines.push(format!("  {}: {}", self.place(told.span), self.first_line(told.span)));
        lines.push(format!("  {}", because(cast, &told.cause)));
        for shown in &told.shown {
            lines.push(format!("    {}", self.comparison(&shown.now)));
            if let Some(before) = &shown.before {
                lines.push(format!("      just before: {}", numbers(before)));
            }
            lines.push(format!("      at the instant: {}", numbers(&shown.now)));
        }
        self.paragraph(&lines)
    }

    pub(super) fn undecided(&mut self, cast: &Cast, told: &Undecided) -> io::Result<()> {
        let who = participants(cast, told.agent, told.other);
        let what = match &told.transition {
            Some(label) => format!("`{label}`"),
            None => "a claim".into(),
        };
        let why = match told.why {
            WhyUndecided::Touch => {
                "it comes within rounding of its boundary and goes no further; it counts as touched there"
                    .into()
            }
            WhyUndecided::TooManyPieces { limit } => format!(
                "the search for a root was given up after {limit} pieces (`--limit max_pieces=N`); \
                 the comparison counts as unchanged"
            ),
        };
        let [from, to] = &told.ends;
        let (start, end) = (number_text(told.from), number_text(told.to));
        let when =
            if told.from < told.to { format!("from t = {start} to {end}") } else { format!("at t = {end}") };
        let mut lines = vec![
            format!("undecided {when} s: {what} of {who}"),
            format!("  {}: {}", self.place(told.span), self.first_line(told.span)),
            format!("  {why}"),
            format!("    {}", self.comparison(from)),
        ];
        if told.from < told.to {
            lines.push(format!("      at the begin: {}", numbers(from)));
        }
        lines.push(format!("      at the end: {}", numbers(to)));
        self.paragraph(&lines)
    }

    pub(super) fn flush(&mut self) -> io::Result<()> {
        self.writer.flush().map_err(|error| self.named(&error))
    }

    fn paragraph(&mut self, lines: &[String]) -> io::Result<()> {
        let text = lines.join("\n") + "\n\n";
        self.writer.write_all(text.as_bytes()).map_err(|error| self.named(&error))
    }

    fn named(&self, error: &io::Error) -> io::Error {
        unwritten(&self.name, error)
    }

    /// `ball.hy:7`
    fn place(&self, span: Span) -> String {
        format!("{}:{}", self.sources.file(span.file).name, self.sources.line_column(span).0)
    }

    fn first_line(&self, span: Span) -> &str {
        self.sources.text(span).lines().next().unwrap_or("").trim_end()
    }

    /// The comparison as the model has it, with the agents that it is about.
    fn comparison(&self, compared: &Compared) -> String {
        let text = self.sources.text(whole(self.sources, compared.span));
        let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
        if compared.bound.is_empty() { text } else { format!("{text}   for {}", compared.bound) }
    }
}

/// `ball`, `cars[3] and cars[5]`
fn participants(cast: &Cast, agent: Who, other: Option<Who>) -> String {
    let other = other.map(|other| format!(" and {}", cast.agent(other)));
    format!("{}{}", cast.agent(agent), other.unwrap_or_default())
}

fn because(cast: &Cast, cause: &Cause) -> String {
    match cause {
        Cause::Flow => "the flow reached its guard:".into(),
        Cause::Entry => "its guard was true on entry:".into(),
        Cause::After { delay } => format!("its delay of {} s was over", number_text(*delay)),
        Cause::Every { period } => format!("its period of {} s had passed", number_text(*period)),
        Cause::Chance => "the time drawn for the two had come:".into(),
        Cause::Message { sender } => format!("a message from {} came", cast.agent(*sender)),
        Cause::Write { by } => {
            let by = by.iter().map(|label| format!("`{label}`")).collect::<Vec<_>>().join(", ");
            format!("its guard became true by what {by} wrote:")
        }
    }
}

/// `2.5 and 3, 0.5 short of it`
fn numbers(compared: &Compared) -> String {
    let sides = format!("{} and {}", rounded(compared.left, 8), rounded(compared.right, 8));
    if compared.margin.is_nan() {
        return sides;
    }
    let side = if compared.margin >= 0.0 { "on its true side" } else { "short of it" };
    format!("{sides}, {} {side}", rounded(compared.margin.abs(), 1))
}

/// A number with so many digits after the first.
fn rounded(value: f64, digits: usize) -> String {
    let near = format!("{value:.digits$e}");
    number_text(near.parse().unwrap_or(value))
}

/// The span with the brackets that its text opens or closes alone: a place begins and ends with an operand, not with the
/// brackets around it.
fn whole(sources: &SourceMap, span: Span) -> Span {
    let text = &sources.file(span.file).text;
    let (mut open, mut missing) = (0_i32, 0_i32);
    for byte in sources.text(span).bytes() {
        open += i32::from(byte == b'(') - i32::from(byte == b')');
        missing = missing.max(-open);
    }
    let lacking = open + missing;
    let (mut start, mut end) = (span.start as usize, span.end as usize);
    for _ in 0..missing {
        let before = text[..start].trim_end();
        if !before.ends_with('(') {
            break;
        }
        start = before.len() - 1;
    }
    for _ in 0..lacking {
        let after = text[end..].trim_start();
        if !after.starts_with(')') {
            break;
        }
        end = text.len() - after.len() + 1;
    }
    Span::new(span.file, start, end)
}
