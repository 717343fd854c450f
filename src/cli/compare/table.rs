//! What a comparison prints: a table for people, a row for each run for programs.

use std::fmt::Write;

use super::measure::Measured;

/// One run of a comparison.
pub(super) struct Entry {
    /// The parameters that have several values.
    pub(super) label: String,
    pub(super) seed: u64,
    pub(super) tolerance: f64,
    /// By number in the list of algorithms.
    pub(super) algorithm: usize,
    pub(super) measured: Measured,
    /// Events that are those of the tight run, from the first on.
    pub(super) agreed: usize,
    /// Events of the tight run.
    pub(super) expected: usize,
}

/// A line of the table: all seeds of one setting under one algorithm.
struct Line<'a> {
    entries: Vec<&'a Entry>,
    /// The same seeds under the algorithm compared against.
    against: Vec<&'a Entry>,
}

const HEADER: [&str; 13] = [
    "",
    "tolerance",
    "algorithm",
    "events",
    "as tight",
    "missed",
    "late",
    "steps",
    "rhs",
    "guards",
    "operations",
    "CPU ms",
    "S rhs/ops/CPU",
];

/// The table; S is the cost in terms of that of the last algorithm, as a geometric mean over the seeds.
pub(super) fn table(entries: &[Entry], algorithms: &[&str]) -> String {
    let mut rows: Vec<Vec<String>> = vec![HEADER.map(String::from).to_vec()];
    for (label, tolerance) in settings(entries) {
        for (number, name) in algorithms.iter().enumerate() {
            let of = |algorithm: usize| {
                let same = |entry: &&Entry| {
                    entry.label == label && entry.tolerance == tolerance && entry.algorithm == algorithm
                };
                entries.iter().filter(same).collect::<Vec<_>>()
            };
            let line = Line { entries: of(number), against: of(algorithms.len() - 1) };
            rows.push(cells(&label, tolerance, name, &line));
        }
    }
    aligned(&rows)
}

/// The settings in the order of their first runs.
fn settings(entries: &[Entry]) -> Vec<(String, f64)> {
    let mut settings: Vec<(String, f64)> = Vec::new();
    for entry in entries {
        let setting = (entry.label.clone(), entry.tolerance);
        if !settings.contains(&setting) {
            settings.push(setting);
        }
    }
    settings
}

fn cells(label: &str, tolerance: f64, name: &str, line: &Line<'_>) -> Vec<String> {
    let n = line.entries.len().max(1) as f64;
    let sum = |of: &dyn Fn(&Entry) -> f64| line.entries.iter().map(|entry| of(entry)).sum::<f64>();
    let mean = |of: &dyn Fn(&Entry) -> f64| sum(of) / n;
    let misses = |of: &dyn Fn(&crate::runtime::observe::Misses) -> u64| {
        let found: Option<Vec<u64>> =
            line.entries.iter().map(|entry| entry.measured.stats.misses.as_ref().map(of)).collect();
        found.map_or("-".to_string(), |found| found.iter().sum::<u64>().to_string())
    };
    let guards =
        |entry: &Entry| (entry.measured.stats.guard_evaluations + entry.measured.stats.guard_ranges) as f64;
    vec![
        label.to_string(),
        format!("{tolerance:e}"),
        name.to_string(),
        format!("{}", sum(&|entry| entry.measured.events.len() as f64)),
        format!("{}/{}", sum(&|entry| entry.agreed as f64), sum(&|entry| entry.expected as f64)),
        misses(&|misses| misses.missed),
        misses(&|misses| misses.late),
        format!("{:.0}", mean(&|entry| entry.measured.stats.steps as f64)),
        format!("{:.0}", mean(&|entry| entry.measured.stats.rhs_evaluations as f64)),
        format!("{:.0}", mean(&guards)),
        format!("{:.3e}", mean(&|entry| entry.measured.stats.operations as f64)),
        format!("{:.3}", 1e3 * mean(&|entry| entry.measured.seconds)),
        [
            speed_up(line, &|entry| entry.measured.stats.rhs_evaluations as f64),
            speed_up(line, &|entry| entry.measured.stats.operations as f64),
            speed_up(line, &|entry| entry.measured.seconds),
        ]
        .map(|s| format!("{s:.3}"))
        .join(" / "),
    ]
}

/// S (29), the geometric mean over the seeds.
fn speed_up(line: &Line<'_>, cost: &dyn Fn(&Entry) -> f64) -> f64 {
    geometric_mean(line.entries.iter().zip(&line.against).map(|(entry, against)| cost(entry) / cost(against)))
}

/// The geometric mean; NaN of nothing.
pub fn geometric_mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, n) = values.fold((0.0, 0.0), |(sum, n), value: f64| (sum + value.ln(), n + 1.0));
    f64::exp(sum / n)
}

/// Columns as wide as they must be, numbers to the right.
fn aligned(rows: &[Vec<String>]) -> String {
    let n = rows.first().map_or(0, Vec::len);
    let widths: Vec<usize> =
        (0..n).map(|k| rows.iter().map(|row| row[k].chars().count()).max().unwrap_or(0)).collect();
    let mut text = String::new();
    for row in rows {
        let cells = row.iter().zip(&widths).enumerate().map(|(k, (cell, &width))| match k {
            0 | 2 => format!("{cell:<width$}"),
            _ => format!("{cell:>width$}"),
        });
        let _ = writeln!(text, "{}", cells.collect::<Vec<_>>().join("  ").trim_end());
    }
    text
}

/// The names of the columns of rows.
pub(super) const COLUMNS: &str = "setting,seed,tolerance,algorithm,events,agreed,expected,missed,late,latest,steps,rejected,\
    rhs_evaluations,guard_evaluations,guard_ranges,guard_polynomials,operations,cpu_seconds\n";

/// The row of a run.
pub(super) fn row(entry: &Entry, algorithms: &[&str]) -> String {
    let stats = &entry.measured.stats;
    let misses = stats
        .misses
        .map_or(",,".to_string(), |misses| format!("{},{},{:?}", misses.missed, misses.late, misses.latest));
    format!(
        "{},{},{:?},{},{},{},{},{misses},{},{},{},{},{},{},{},{:?}\n",
        entry.label,
        entry.seed,
        entry.tolerance,
        algorithms[entry.algorithm],
        entry.measured.events.len(),
        entry.agreed,
        entry.expected,
        stats.steps,
        stats.rejected,
        stats.rhs_evaluations,
        stats.guard_evaluations,
        stats.guard_ranges,
        stats.guard_polynomials,
        stats.operations,
        entry.measured.seconds,
    )
}
