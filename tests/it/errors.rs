//! Has every error a code, every code an explanation, and every explanation an example that has the error and one that
//! does not? The cases are the examples of `docs/ERRORS.md`; what is said about those that have no case of their own in `errors/`
//! lies there too.

use std::collections::BTreeSet;
use std::fs;
use std::io;
use std::path::Path;
use std::sync::atomic::AtomicBool;

use hyc::base::render::{Colours, render};
use hyc::base::{Diagnostic, SourceMap};
use hyc::cli::{Explanation, explanations};
use hyc::codegen::{self, Backend};
use hyc::model::{Files, Settings};
use hyc::output::{Cast, Tables};
use hyc::runtime::limits::Limits;
use hyc::runtime::observe::End;
use hyc::{calculus, model, runtime, syntax};

/// Codes of limits and of machines that no short example shows.
const WITHOUT_EXAMPLE: [&str; 18] = [
    "HY0102", "HY0119", "HY0120", "HY0289", "HY0292", "HY0293", "HY0294", "HY0295", "HY0296", "HY0297",
    "HY0298", "HY0299", "HY0304", "HY0305", "HY0306", "HY0307", "HY0401", "HY0402",
];

/// A model that never ends is a failure of this test, not of the reader's patience.
const STEPS_MAX: u64 = 100_000;

/// The code of a false assert: the run goes on, so no floor returns it.
const FALSE_ASSERT: &str = "HY0590";

/// That of a false property, which no floor returns either.
const FALSE_PROPERTY: &str = "HY0521";

/// The examples of an entry.
struct Example {
    bad: String,
    good: String,
    params: Vec<(String, String)>,
    limits: Limits,
    data: Vec<(String, String)>,
}

/// The fenced texts of an entry that have this mark.
fn fenced(entry: &Explanation, mark: &str) -> Vec<String> {
    let open = format!("```{mark}\n");
    let after = entry.body.split(open.as_str()).skip(1);
    after.map(|rest| rest.split("```").next().unwrap().to_string()).collect()
}

/// A bad and a good model, the values of `-p` in a command, and data files that begin with their names.
fn example(entry: &Explanation) -> Option<Example> {
    let mut models = fenced(entry, "hy").into_iter();
    let (bad, good) = (models.next()?, models.next()?);
    let command = fenced(entry, "sh").concat();
    let words: Vec<&str> = command.split_whitespace().collect();
    let mut params = Vec::new();
    let mut limits = Limits { steps_max: STEPS_MAX, ..Limits::default() };
    for pair in words.windows(2) {
        match (pair[0], pair[1].split_once('=')) {
            ("-p", Some((name, value))) => params.push((name.to_string(), value.to_string())),
            ("--limit", Some(("max_steps", value))) => limits.steps_max = value.parse().unwrap(),
            ("--limit", Some(("max_guards", value))) => limits.guards_max = value.parse().unwrap(),
            ("--limit", Some(("max_generations", value))) => limits.generations_max = value.parse().unwrap(),
            ("--limit", Some(("max_agents", value))) => limits.agents_max = value.parse().unwrap(),
            _ => {}
        }
    }
    let data = fenced(entry, "csv").into_iter().map(|text| {
        let (name, rest) = text.split_once('\n').unwrap();
        (name.to_string(), rest.to_string())
    });
    let imported = fenced(entry, "hy imported").into_iter().map(|text| {
        let name = text.lines().next().and_then(|line| line.strip_prefix("// "));
        (name.unwrap().to_string(), text)
    });
    Some(Example { bad, good, params, limits, data: data.chain(imported).collect() })
}

/// Data files in memory.
struct Shelf<'a>(&'a [(String, String)]);

impl Files for Shelf<'_> {
    fn read(&mut self, path: &str) -> io::Result<Vec<u8>> {
        let found = self.0.iter().find(|(name, _)| name == path);
        found
            .map(|(_, text)| text.clone().into_bytes())
            .ok_or_else(|| io::Error::new(io::ErrorKind::NotFound, "no such file"))
    }
}

/// A warning about a model that is right: what the model would come to is not asked.
fn is_warning(entry: &Explanation) -> bool {
    entry.code.starts_with("HY06")
}

/// What the bad example of an entry is told.
fn diagnose_bad(entry: &Explanation, example: &Example) -> (SourceMap, Vec<Diagnostic>) {
    if is_warning(entry) { warned(&example.bad, example) } else { diagnose(&example.bad, example) }
}

/// The warnings about a model that must be right.
fn warned(text: &str, example: &Example) -> (SourceMap, Vec<Diagnostic>) {
    let mut sources = SourceMap::default();
    let file = sources.add("model.hy", text);
    let tree = syntax::parse(file, text).unwrap();
    let settings = Settings { params: example.params.clone(), ..Settings::default() };
    let checked = model::check(&tree, &mut sources, &mut Shelf(&example.data), &settings);
    assert_eq!(checked.diagnostics, [], "{text}");
    let mut warnings = checked.warnings;
    warnings.extend(calculus::lint(&calculus::derive(&checked.model.unwrap()).unwrap()));
    (sources, warnings)
}

/// What every floor has to say about a model, as far as it comes; a model with a `run` is run.
fn diagnose(text: &str, example: &Example) -> (SourceMap, Vec<Diagnostic>) {
    let mut sources = SourceMap::default();
    let file = sources.add("model.hy", text);
    let tree = match syntax::parse(file, text) {
        Ok(tree) => tree,
        Err(diagnostics) => return (sources, diagnostics),
    };
    let settings = Settings { params: example.params.clone(), ..Settings::default() };
    let checked = model::check(&tree, &mut sources, &mut Shelf(&example.data), &settings);
    let mut diagnostics = checked.diagnostics;
    let Some(model) = checked.model else { return (sources, diagnostics) };
    match calculus::derive(&model) {
        Ok(system) if model.run.span.is_some() => diagnostics.extend(simulate(system, &example.limits)),
        Ok(_) => {}
        Err(found) => diagnostics.extend(found),
    }
    (sources, diagnostics)
}

fn simulate(system: calculus::system::System, limits: &Limits) -> Vec<Diagnostic> {
    let program = codegen::compile(system, Backend::Interpreter).unwrap();
    let cast = Cast::default();
    let mut nothing = Tables::new(&cast);
    let outcome = runtime::simulate(&program, limits, &AtomicBool::new(false), &mut nothing);
    let mut found = outcome.warnings;
    let claims = outcome.false_asserts.iter();
    found.extend(
        claims.map(|claim| Diagnostic::warning(FALSE_ASSERT, "an assert was false").label(claim.span, "")),
    );
    let properties = outcome.verdicts.iter().filter(|verdict| !verdict.holds);
    found.extend(properties.map(|verdict| {
        Diagnostic::warning(FALSE_PROPERTY, "a property is false").label(verdict.span, verdict.told())
    }));
    match outcome.end {
        End::Error(diagnostic) => found.push(*diagnostic),
        End::Until | End::Stop { .. } | End::Interrupted | End::Output(_) => {}
    }
    found
}

#[test]
fn every_bad_example_has_its_error() {
    let mut wrong = Vec::new();
    for entry in explanations() {
        let Some(example) = example(&entry) else { continue };
        let (sources, diagnostics) = diagnose_bad(&entry, &example);
        if !diagnostics.iter().any(|diagnostic| diagnostic.code == entry.code) {
            wrong.push(format!("{}:\n{}", entry.code, render(&sources, &diagnostics, Colours::None)));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn every_good_example_is_sound() {
    let mut wrong = Vec::new();
    for entry in explanations() {
        let Some(example) = example(&entry) else { continue };
        let (sources, mut diagnostics) = diagnose(&example.good, &example);
        if diagnostics.is_empty() {
            diagnostics = warned(&example.good, &example).1;
        }
        if !diagnostics.is_empty() {
            wrong.push(format!("{}:\n{}", entry.code, render(&sources, &diagnostics, Colours::None)));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn every_message_is_as_it_was() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/it/errors");
    let names = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let with_case: BTreeSet<String> =
        names.filter(|name| name.ends_with(".hy")).map(|name| name[..6].to_string()).collect();
    for entry in explanations().iter().filter(|entry| !with_case.contains(entry.code)) {
        let Some(example) = example(entry) else { continue };
        let (sources, diagnostics) = diagnose_bad(entry, &example);
        insta::with_settings!({ snapshot_path => "errors", prepend_module_to_snapshot => false, omit_expression => true }, {
            insta::assert_snapshot!(entry.code, without_numbers(&render(&sources, &diagnostics, Colours::None)));
        });
    }
}

/// The text with dots for each number among the notes: no number of a trajectory belongs into a snapshot.
fn without_numbers(text: &str) -> String {
    let is_note = |line: &str| line.trim_start().starts_with("= ") && !line.contains("help:");
    let in_number = |c: char| c.is_ascii_digit() || "+-.e".contains(c);
    let mut lines = Vec::new();
    for line in text.lines() {
        let words = line.split(' ').map(|word| {
            let number = word.trim_end_matches([',', ':', ';']);
            let is_number = number.contains(|c: char| c.is_ascii_digit()) && number.chars().all(in_number);
            if is_note(line) && is_number { word.replacen(number, "...", 1) } else { word.to_string() }
        });
        lines.push(words.collect::<Vec<_>>().join(" "));
    }
    lines.join("\n")
}

#[test]
fn every_code_is_explained_and_every_explanation_has_its_code() {
    let used = codes_below(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src"));
    let explained: Vec<&str> = explanations().iter().map(|entry| entry.code).collect();
    let unique: BTreeSet<&str> = explained.iter().copied().collect();
    assert_eq!(explained, unique.iter().copied().collect::<Vec<_>>(), "in order, each once");
    let used: BTreeSet<&str> = used.iter().map(String::as_str).collect();
    let missing: Vec<_> = used.difference(&unique).collect();
    let stale: Vec<_> = unique.difference(&used).collect();
    assert!(missing.is_empty() && stale.is_empty(), "not explained: {missing:?}, never said: {stale:?}");
}

/// The codes that stand in quotes in the sources, tests aside.
fn codes_below(folder: &Path) -> BTreeSet<String> {
    let mut codes = BTreeSet::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            if !path.ends_with("tests") {
                codes.extend(codes_below(&path));
            }
        } else if path.extension().is_some_and(|kind| kind == "rs") && !path.ends_with("tests.rs") {
            let text = fs::read_to_string(&path).unwrap();
            for (k, _) in text.match_indices("\"HY") {
                codes.extend(
                    text.get(k + 1..k + 7).filter(|_| text[k + 7..].starts_with('"')).map(String::from),
                );
            }
        }
    }
    codes
}

#[test]
fn only_limits_and_machines_have_no_example() {
    let without = explanations().into_iter().filter(|entry| example(entry).is_none());
    let without: Vec<&str> = without.map(|entry| entry.code).collect();
    assert_eq!(without, WITHOUT_EXAMPLE);
}
