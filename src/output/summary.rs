//! The few lines that a person reads when a run is over.

use crate::base::write_number;
use std::fmt::Write;

use super::report::Report;
use crate::runtime::observe::End;

/// How many transitions are listed, those that fired most often first.
const TRANSITIONS_SHOWN: usize = 8;

/// The summary, a few lines with line ends.
pub fn summary(report: &Report<'_>) -> String {
    let stats = &report.outcome.stats;
    let mut text = String::new();
    line(&mut text, format_args!("{}: {}", report.model, ending(report)));
    line(
        &mut text,
        format_args!(
            "  {}{}, {}, {} ({} rejected), {}",
            counted(report.cast.agents.len() as u64, "agent"),
            turnover(report),
            counted(stats.events, "event"),
            counted(stats.steps, "step"),
            stats.rejected,
            counted(stats.rhs_evaluations, "right-hand side"),
        ),
    );
    if let [_, (_, 1..)] = stats.methods[..] {
        let by = stats.methods.iter().map(|(name, steps)| format!("{steps} by {name}"));
        line(&mut text, format_args!("  steps: {}", by.collect::<Vec<_>>().join(", ")));
    }
    fired(&mut text, report);
    if stats.undecided_roots > 0 {
        let roots = counted(stats.undecided_roots, "root");
        line(&mut text, format_args!("  {roots} of guards could be neither excluded nor isolated"));
    }
    line(
        &mut text,
        format_args!(
            "  compiled in {}, ran in {}",
            duration(report.compile_seconds),
            duration(report.run_seconds)
        ),
    );
    if !report.files.is_empty() {
        line(&mut text, format_args!("  wrote {}", report.files.join(", ")));
    }
    text
}

/// How many agents have come and gone, if any.
fn turnover(report: &Report<'_>) -> String {
    let types = &report.outcome.stats.types;
    let (created, destroyed): (u64, u64) =
        types.iter().fold((0, 0), |sum, ty| (sum.0 + ty.created, sum.1 + ty.destroyed));
    match (created, destroyed) {
        (0, 0) => String::new(),
        _ => format!(" ({created} created, {destroyed} destroyed)"),
    }
}

/// `ended at t = 30 s`, and why.
fn ending(report: &Report<'_>) -> String {
    let time = number(report.outcome.time);
    match &report.outcome.end {
        End::Until => format!("ended at t = {time} s"),
        End::Stop { reason, agent, by } => {
            let agent = report.cast.agent(*agent);
            let why = reason.as_ref().map(|reason| format!(": {reason}")).unwrap_or_default();
            format!("stopped at t = {time} s by {by} of {agent}{why}")
        }
        End::Interrupted => format!("interrupted at t = {time} s"),
        End::Error(diagnostic) => format!("stopped in error at t = {time} s ({})", diagnostic.code),
        End::Output(_) => format!("stopped at t = {time} s, its output could not be written"),
    }
}

/// The transitions that fired most often; among equals, in order of declaration.
fn fired(text: &mut String, report: &Report<'_>) {
    let mut transitions: Vec<_> =
        report.outcome.stats.transitions.iter().filter(|(_, count)| *count > 0).collect();
    transitions.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
    let shown = &transitions[..transitions.len().min(TRANSITIONS_SHOWN)];
    let width = shown.iter().map(|(label, _)| label.chars().count()).max().unwrap_or(0);
    for (label, count) in shown {
        line(text, format_args!("    {label:width$}  {count}"));
    }
    let more = transitions.len() - shown.len();
    if more > 0 {
        line(text, format_args!("    and {} more", counted(more as u64, "transition")));
    }
}

fn counted(count: u64, noun: &str) -> String {
    let plural = if count == 1 { "" } else { "s" };
    format!("{count} {noun}{plural}")
}

fn number(value: f64) -> String {
    let mut text = String::new();
    write_number(&mut text, value);
    text
}

/// Three digits with a unit that suits.
fn duration(seconds: f64) -> String {
    if seconds < 1e-3 {
        format!("{:.0} us", seconds * 1e6)
    } else if seconds < 1.0 {
        format!("{:.1} ms", seconds * 1e3)
    } else {
        format!("{seconds:.2} s")
    }
}

fn line(text: &mut String, content: std::fmt::Arguments<'_>) {
    writeln!(text, "{content}").expect("writing to memory cannot fail");
}
