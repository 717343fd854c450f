//! The few lines that a person reads when a run is over.

use crate::base::write_number;
use std::fmt::Write;

use super::report::Report;
use crate::runtime::observe::End;

/// How many transitions are listed, those that fired most often first.
const TRANSITIONS_SHOWN: usize = 8;
/// How many agents are listed, those with most events or steps first.
const AGENTS_SHOWN: usize = 3;
/// An agent that takes so many times as many steps as the mean is slow.
const SLOW: u64 = 2;
/// The longest bar, in characters.
const BAR: u64 = 24;

/// The summary, a few lines with line ends.
pub fn summary(report: &Report<'_>) -> String {
    let stats = &report.outcome.stats;
    let mut text = String::new();
    line(&mut text, format_args!("{}: {}", report.model, ending(report)));
    let agents = counted(report.cast.agents.len() as u64, "agent");
    let (events, steps) = (counted(stats.events, "event"), counted(stats.steps, "step"));
    let (turnover, rejected) = (turnover(report), grouped(stats.rejected));
    line(&mut text, format_args!("  {agents}{turnover}, {events}, {steps} ({rejected} rejected)"));
    if let [_, (_, 1..)] = stats.methods[..] {
        let by = stats.methods.iter().map(|(name, steps)| format!("{} by {name}", grouped(*steps)));
        line(&mut text, format_args!("  steps      {}", by.collect::<Vec<_>>().join(", ")));
    }
    fired(&mut text, report);
    busiest(&mut text, report);
    guards(&mut text, report);
    claims(&mut text, report);
    properties(&mut text, report);
    time(&mut text, report);
    if !report.files.is_empty() {
        line(&mut text, format_args!("  wrote      {}", report.files.join(", ")));
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
        End::Stop { reason, by } => {
            let by = by.as_ref().map(|(agent, by)| format!("{by} of {}", report.cast.agent(*agent)));
            let why = reason.as_ref().map(|reason| format!(": {reason}")).unwrap_or_default();
            format!("stopped at t = {time} s by {}{why}", by.unwrap_or_else(|| "`stop when`".into()))
        }
        End::Interrupted => format!("interrupted at t = {time} s"),
        End::Error(diagnostic) => format!("stopped in error at t = {time} s ({})", diagnostic.code),
        End::Output(_) => format!("stopped at t = {time} s, its output could not be written"),
    }
}

/// The transitions that fired most often, with bars; among equals, in order of declaration.
fn fired(text: &mut String, report: &Report<'_>) {
    let mut transitions: Vec<_> =
        report.outcome.stats.transitions.iter().filter(|(_, count)| *count > 0).collect();
    transitions.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
    let shown = &transitions[..transitions.len().min(TRANSITIONS_SHOWN)];
    let width = shown.iter().map(|(label, _)| label.chars().count()).max().unwrap_or(0);
    let digits = shown.iter().map(|(_, count)| grouped(*count).len()).max().unwrap_or(0);
    let most = shown.first().map_or(1, |(_, count)| *count);
    for (label, count) in shown {
        let bar = "#".repeat((BAR * count).div_ceil(most).clamp(1, BAR) as usize);
        line(text, format_args!("    {label:width$}  {:>digits$}  {bar}", grouped(*count)));
    }
    let more = transitions.len() - shown.len();
    if more > 0 {
        line(text, format_args!("    and {} more", counted(more as u64, "transition")));
    }
}

/// Who has most events and who took most steps, where there are several agents.
fn busiest(text: &mut String, report: &Report<'_>) {
    if report.cast.agents.len() < 2 {
        return;
    }
    // Where all take about as many steps, nobody is slow.
    let types = &report.outcome.stats.types;
    let n_ever: u64 = types.iter().map(|ty| ty.agents + ty.destroyed).sum();
    let is_slow = |&(_, steps): &(String, u64)| steps * n_ever >= SLOW * report.outcome.stats.steps;
    let slowest = if report.slowest.first().is_some_and(is_slow) { report.slowest } else { &[] };
    for (head, most, noun) in [("busiest", report.busiest, "event"), ("slowest", slowest, "step")] {
        let shown = most.iter().take(AGENTS_SHOWN);
        let shown = shown.map(|(name, count)| format!("{name} ({})", counted(*count, noun)));
        let shown = shown.collect::<Vec<_>>().join(", ");
        if !shown.is_empty() {
            line(text, format_args!("  {head}    {shown}"));
        }
    }
}

fn guards(text: &mut String, report: &Report<'_>) {
    let stats = &report.outcome.stats;
    let (points, ranges) = (grouped(stats.guard_evaluations), grouped(stats.guard_ranges));
    let roots = match stats.undecided_roots {
        0 => String::new(),
        n => format!("; {} could be neither excluded nor isolated: --explain-events", counted(n, "root")),
    };
    line(
        text,
        format_args!("  guards     evaluated {points} times at a point, {ranges} over an interval{roots}"),
    );
}

fn claims(text: &mut String, report: &Report<'_>) {
    let n = report.outcome.false_asserts.len() as u64;
    if n > 0 {
        let times: u64 = report.outcome.false_asserts.iter().map(|claim| claim.count).sum();
        line(text, format_args!("  asserts    {} false, {}", grouped(n), counted(times, "time")));
    }
}

/// A line for each property: whether it holds, by how much, when and for whom.
fn properties(text: &mut String, report: &Report<'_>) {
    let verdicts = &report.outcome.verdicts;
    let width = verdicts.iter().map(|verdict| verdict.name.chars().count()).max().unwrap_or(0);
    for (k, verdict) in verdicts.iter().enumerate() {
        let head = if k == 0 { "properties" } else { "" };
        let (word, name) = (if verdict.holds { "holds" } else { "FALSE" }, &verdict.name);
        line(text, format_args!("  {head:10} {name:width$}  {word}  {}", verdict.told()));
    }
}

/// Where the time went.
fn time(text: &mut String, report: &Report<'_>) {
    let parts = report.compile_parts.iter().map(|(name, seconds)| format!("{name} {}", duration(*seconds)));
    let parts = parts.collect::<Vec<_>>().join(", ");
    let parts = if parts.is_empty() { parts } else { format!(" ({parts})") };
    let writing = match report.writing_seconds {
        seconds if seconds >= 0.01 * report.run_seconds => format!(" ({} of it writing)", duration(seconds)),
        _ => String::new(),
    };
    let (compiled, ran) = (duration(report.compile_seconds), duration(report.run_seconds));
    let page =
        report.page_seconds.map(|seconds| format!(", page in {}", duration(seconds))).unwrap_or_default();
    line(text, format_args!("  time       compiled in {compiled}{parts}, ran in {ran}{writing}{page}"));
}

fn counted(count: u64, noun: &str) -> String {
    let plural = if count == 1 { "" } else { "s" };
    format!("{} {noun}{plural}", grouped(count))
}

/// With a space between each three digits, from five digits on.
fn grouped(count: u64) -> String {
    let digits = count.to_string();
    if digits.len() < 5 {
        return digits;
    }
    let mut text = String::new();
    for (k, digit) in digits.chars().enumerate() {
        if k > 0 && (digits.len() - k).is_multiple_of(3) {
            text.push(' ');
        }
        text.push(digit);
    }
    text
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
