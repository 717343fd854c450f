//! Is what the documents show true? Every sample is checked, every file that they quote is quoted as it is.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use hyc::base::render::{Colours, render};
use hyc::base::{Diagnostic, SourceMap};
use hyc::model::{Files, Settings};
use hyc::{calculus, model, syntax};

use hyc::runtime::{Algorithm, Form};

use crate::harness::{Case, simulate};

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

fn document(name: &str) -> String {
    fs::read_to_string(root().join(name)).unwrap()
}

/// The fenced texts that have this mark.
fn fenced(text: &str, mark: &str) -> Vec<String> {
    let open = format!("```{mark}\n");
    let after = text.split(open.as_str()).skip(1);
    after.map(|rest| rest.split("```").next().unwrap().to_string()).collect()
}

/// Samples name no files but those that the reference shows, by their first comments.
struct Shown;

impl Files for Shown {
    fn read(&mut self, path: &str) -> io::Result<Vec<u8>> {
        let files = fenced(&document("docs/LANGUAGE.md"), "hy imported");
        let file = files.into_iter().find(|text| text.starts_with(&format!("// {path}\n")));
        file.map(String::into_bytes).ok_or_else(|| io::ErrorKind::NotFound.into())
    }
}

/// What is wrong with a text.
fn diagnose(text: &str) -> (SourceMap, Vec<Diagnostic>) {
    let mut sources = SourceMap::default();
    let file = sources.add("sample.hy", text);
    let tree = match syntax::parse(file, text) {
        Ok(tree) => tree,
        Err(diagnostics) => return (sources, diagnostics),
    };
    let checked = model::check(&tree, &mut sources, &mut Shown, &Settings::default());
    let mut diagnostics = checked.diagnostics;
    diagnostics.extend(checked.warnings);
    match checked.model.as_ref().map(calculus::derive) {
        Some(Ok(system)) => diagnostics.extend(calculus::lint(&system)),
        Some(Err(found)) => diagnostics.extend(found),
        None => {}
    }
    (sources, diagnostics)
}

#[test]
fn every_sample_of_the_reference_is_sound() {
    let mut samples = fenced(&document("docs/LANGUAGE.md"), "hy");
    assert!(samples.len() >= 7);
    samples.extend(fenced(&document("docs/PAPER.md"), "hy"));
    let told = samples.iter().map(|sample| {
        let (sources, diagnostics) = diagnose(sample);
        render(&sources, &diagnostics, Colours::None)
    });
    assert_eq!(told.collect::<String>(), "");
}

/// Each as far as it says, but no longer than a minute, by both forms of the engine. One is stopped by an action of its own.
#[test]
fn every_sample_of_the_reference_runs() {
    let text = document("docs/LANGUAGE.md");
    let imported = fenced(&text, "hy imported");
    let samples: Vec<String> =
        fenced(&text, "hy").into_iter().filter(|sample| sample.contains("run {")).collect();
    assert!(samples.len() >= 20, "{}", samples.len());
    for sample in &samples {
        let run = |form: Form| {
            let mut case = Case::new(sample).algorithm(Algorithm::Masim(form));
            for file in &imported {
                let name = file.trim_start_matches("// ").lines().next().unwrap_or_default();
                case = case.file(name, file);
            }
            let long = sample.contains("until 600");
            let case = if long { case.until(60.0) } else { case };
            case.run_any()
        };
        let [fast, plain] = [Form::Fast, Form::Plain].map(run);
        assert_eq!(fast.log(), plain.log(), "{sample}");
    }
}

#[test]
fn the_machine_of_the_paper_page_goes_on_with_what_it_did() {
    // written flat, and with modes in modes
    for sample in &fenced(&document("docs/PAPER.md"), "hy")[..2] {
        let run = simulate(sample);
        let steps: Vec<(f64, &str)> = (run.events.iter().filter(|event| event.agent == "machine"))
            .map(|event| (event.time, event.to.rsplit('.').next().unwrap()))
            .collect();
        // the power fails at 6.5, 15, ..., each time for 2 s; a mode that is entered again begins anew
        let first = [
            (4.0, "Rest"),
            (6.5, "Stopped"),
            (8.5, "Rest"),
            (11.5, "Turn"),
            (15.0, "Stopped"),
            (17.0, "Turn"),
        ];
        assert_eq!(steps[..6], first);
    }
}

#[test]
fn every_table_of_the_paper_has_its_place_and_its_experiment() {
    let page = document("docs/PAPER.md");
    let folder = root().join("benches/paper");
    let files = fs::read_dir(folder).unwrap().map(|entry| fs::read_to_string(entry.unwrap().path()).unwrap());
    let bench: String = files.collect();
    let places: Vec<&str> =
        page.split("<!-- table ").skip(1).map(|rest| rest.split(" -->").next().unwrap()).collect();
    for (k, name) in places.iter().enumerate() {
        assert!(!places[..k].contains(name), "two places for the table `{name}`");
        assert!(bench.contains(&format!("\"{name}\"")), "nothing writes the table `{name}`");
        let begin = format!("<!-- table {name} -->\n");
        let table = page.split(begin.as_str()).nth(1).unwrap().split("<!-- end -->").next().unwrap();
        assert!(table.contains("|---") && !table.contains("<!--"), "`{name}` has no table, or no end");
    }
    let written = bench.split(".table(\"").skip(1).map(|rest| rest.split('"').next().unwrap());
    for name in written.chain(["figure_3", "figure_5"]) {
        assert!(places.contains(&name), "no place for the table `{name}`");
    }
    let drawn = bench.split("figure(").filter_map(|rest| rest.trim_start().strip_prefix('"'));
    for name in drawn.map(|rest| rest.split('"').next().unwrap()) {
        assert!(page.contains(&format!("](paper/{name}.svg)")), "the figure `{name}` is not shown");
    }
}

#[test]
fn the_experiments_that_the_paper_page_lists_are_those_there_are() {
    let page = document("docs/PAPER.md");
    let line = page.lines().find(|line| line.contains("some of them:")).unwrap();
    let mut listed: Vec<&str> = line.split("some of them:").nth(1).unwrap().split_whitespace().collect();
    let main = document("benches/paper/main.rs");
    let mut known: Vec<&str> =
        main.split("is_wanted(\"").skip(1).map(|rest| rest.split('"').next().unwrap()).collect();
    listed.sort_unstable();
    known.sort_unstable();
    assert_eq!(listed, known);
}

#[test]
fn the_model_of_the_readme_is_a_file() {
    let samples = fenced(&document("README.md"), "hy");
    assert_eq!(samples.len(), 1);
    assert_eq!(samples[0], document("models/ball.hy"));
    assert!(samples[0].lines().count() <= 16);
}

#[test]
fn the_readme_shows_what_the_program_prints() {
    let readme = document("README.md");
    let shown = fenced(&readme, "text").remove(0);
    let folder = tempfile::tempdir().unwrap();
    let output = std::process::Command::new(env!("CARGO_BIN_EXE_hyc"))
        .args(["run", "models/ball.hy", "--events", "-", "-q", "-o"])
        .arg(folder.path())
        .current_dir(root())
        .output()
        .unwrap();
    assert!(output.status.success());
    let printed = String::from_utf8(output.stdout).unwrap();
    assert!(readme.contains("hyc run models/ball.hy --events - -q"));
    assert_eq!(
        shown,
        printed.lines().take(shown.lines().count()).map(|line| format!("{line}\n")).collect::<String>()
    );
}

#[test]
fn the_two_commands_of_the_readme_are_what_ci_runs() {
    let readme = document("README.md");
    assert!(
        readme.contains("\ncargo test\n")
            && readme.contains("\ncargo run --release -- run models/highway.hy\n")
    );
    let ci = document(".ci/run");
    assert!(ci.contains("from_readme 'cargo test'") && ci.contains("from_readme 'cargo run'"));
}

#[test]
fn every_model_is_in_the_list_of_models() {
    let list = document("docs/MODELS.md");
    let rows = list.lines().filter_map(|line| line.strip_prefix("| [")?.split(']').next());
    let mut listed: Vec<String> = rows.map(|name| format!("{name}.hy")).collect();
    listed.sort();
    let files = fs::read_dir(root().join("models")).unwrap();
    let names = files.map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let mut models: Vec<String> = names.filter(|name| name.ends_with(".hy")).collect();
    models.sort();
    assert_eq!(listed, models);
}

#[test]
fn every_model_says_in_its_first_comment_what_it_shows() {
    for entry in fs::read_dir(root().join("models")).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|ending| ending == "hy") {
            let text = fs::read_to_string(&path).unwrap();
            let name = Path::new(path.file_name().unwrap()).display().to_string();
            assert!(text.starts_with(&format!("// {name}: ")), "{name}");
        }
    }
}

#[test]
fn the_architecture_fits_on_a_few_pages_and_names_every_floor() {
    let text = document("docs/ARCHITECTURE.md");
    assert!(text.lines().count() < 150);
    for floor in
        ["base", "math", "syntax", "model", "calculus", "codegen", "runtime", "output", "picture", "cli"]
    {
        assert!(text.contains(&format!("| `{floor}` |")), "{floor}");
    }
}
