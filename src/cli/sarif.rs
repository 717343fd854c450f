//! Diagnostics as SARIF 2.1.0, which code hosts and editors read.
//!
//! One run for all models. Every code that is shown is a rule, whose help is the entry of `docs/ERRORS.md`. Lines and columns
//! count from 1, columns in characters; the end is one past the last character.

use serde_json::{Value, json};

use super::{Explanation, explanations};
use crate::base::{Diagnostic, Label, Severity, SourceMap, Span};

/// What `--format sarif` prints for models that have been checked.
pub(super) fn log<'d>(checked: impl Iterator<Item = (&'d SourceMap, &'d [Diagnostic])>) -> Value {
    let mut rules: Vec<Explanation> = Vec::new();
    let mut results = Vec::new();
    let known = explanations();
    for (sources, diagnostics) in checked {
        for diagnostic in diagnostics {
            let rule = known.iter().find(|rule| rule.code == diagnostic.code);
            let place = rule.map(|rule| {
                rules.iter().position(|used| used.code == rule.code).unwrap_or_else(|| {
                    rules.push(*rule);
                    rules.len() - 1
                })
            });
            results.push(result(sources, diagnostic, place));
        }
    }
    json!({
        "$schema": "https://json.schemastore.org/sarif-2.1.0.json",
        "version": "2.1.0",
        "runs": [{
            "tool": { "driver": {
                "name": "hyc",
                "version": env!("CARGO_PKG_VERSION"),
                "informationUri": env!("CARGO_PKG_REPOSITORY"),
                "rules": rules.iter().map(rule).collect::<Vec<_>>(),
            }},
            "columnKind": "unicodeCodePoints",
            "results": results,
        }],
    })
}

fn rule(entry: &Explanation) -> Value {
    json!({
        "id": entry.code,
        "shortDescription": { "text": entry.title },
        "help": { "text": entry.body, "markdown": entry.body },
        "defaultConfiguration": { "level": if entry.code.starts_with("HY06") { "warning" } else { "error" } },
    })
}

fn result(sources: &SourceMap, diagnostic: &Diagnostic, rule: Option<usize>) -> Value {
    let level = match diagnostic.severity {
        Severity::Error => "error",
        Severity::Warning => "warning",
        Severity::Note => "note",
    };
    let (first, others) = match diagnostic.labels.split_first() {
        Some((first, others)) => (vec![location(sources, first)], others),
        None => (Vec::new(), &[][..]),
    };
    let mut result = json!({
        "ruleId": diagnostic.code,
        "level": level,
        "message": { "text": message(diagnostic) },
        "locations": first,
    });
    if let Some(rule) = rule {
        result["ruleIndex"] = json!(rule);
    }
    if !others.is_empty() {
        result["relatedLocations"] = others.iter().map(|label| location(sources, label)).collect();
    }
    result
}

/// The title and all that follows it, a sentence a line.
fn message(diagnostic: &Diagnostic) -> String {
    let mut lines = vec![diagnostic.title.clone()];
    lines.extend(diagnostic.labels.first().map(|label| label.text.clone()).filter(|text| !text.is_empty()));
    lines.extend(diagnostic.notes.iter().cloned());
    lines.extend(diagnostic.help.iter().map(|help| format!("help: {help}")));
    lines.join("\n")
}

fn location(sources: &SourceMap, label: &Label) -> Value {
    let (line, column) = sources.line_column(label.span);
    let (end_line, end_column) = sources.line_column(Span { start: label.span.end, ..label.span });
    let mut location = json!({
        "physicalLocation": {
            "artifactLocation": { "uri": uri(&sources.file(label.span.file).name) },
            "region": {
                "startLine": line,
                "startColumn": column,
                "endLine": end_line,
                "endColumn": end_column,
            },
        },
    });
    if !label.text.is_empty() {
        location["message"] = json!({ "text": label.text });
    }
    location
}

/// A path as a URI (RFC 3986): what no path of a URI may hold is escaped; an absolute one is of the scheme `file`.
fn uri(path: &str) -> String {
    let scheme = if path.starts_with('/') { "file://" } else { "" };
    let plain = |byte: u8| byte.is_ascii_alphanumeric() || b"-._~/".contains(&byte);
    let escaped = path.replace('\\', "/").bytes().fold(String::new(), |mut text, byte| {
        if plain(byte) {
            text.push(char::from(byte));
        } else {
            text.push_str(&format!("%{byte:02X}"));
        }
        text
    });
    format!("{scheme}{escaped}")
}
