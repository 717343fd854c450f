//! What does a text come to as a model? Snapshots of the model stage, and of every diagnostic of that floor.

use std::path::{Path, PathBuf};

use hyc::base::SourceMap;
use hyc::base::render::{Colours, render};
use hyc::model::{Checked, Files, Settings, check, dump};
use hyc::syntax::parse;

/// Data files beside the model.
struct Beside(PathBuf);

impl Files for Beside {
    fn read(&mut self, path: &str) -> std::io::Result<Vec<u8>> {
        std::fs::read(self.0.join(path))
    }
}

/// Checks a text as if it stood in a folder; a text that does not parse is an error of the test.
fn check_text(name: &str, text: &str, folder: &Path, settings: &Settings) -> (Checked, SourceMap) {
    let mut sources = SourceMap::default();
    let file = sources.add(name, text);
    let ast =
        parse(file, text).unwrap_or_else(|problems| panic!("{}", render(&sources, &problems, Colours::None)));
    let checked = check(&ast, &mut sources, &mut Beside(folder.to_path_buf()), settings);
    (checked, sources)
}

/// The dump of a text that is right.
fn dump_of(name: &str, text: &str, folder: &Path, settings: &Settings) -> String {
    let (checked, sources) = check_text(name, text, folder, settings);
    let problems = render(&sources, &checked.diagnostics, Colours::None);
    dump(&checked.model.unwrap_or_else(|| panic!("{name}: {problems}")))
}

fn models() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("models")
}

/// The `.hy` files of a folder by name, with their texts.
fn texts_in(folder: &Path) -> Vec<(String, String)> {
    let entries =
        std::fs::read_dir(folder).expect("the folder is there").map(|entry| entry.expect("readable").path());
    let mut paths =
        entries.filter(|path| path.extension().is_some_and(|end| end == "hy")).collect::<Vec<_>>();
    paths.sort();
    let read = |path: PathBuf| {
        let name = path.file_name().and_then(|name| name.to_str()).expect("a plain name").to_string();
        (name, std::fs::read_to_string(&path).expect("readable"))
    };
    paths.into_iter().map(read).collect()
}

#[test]
fn every_model_comes_to_what_its_snapshot_says() {
    for (name, text) in texts_in(&models()) {
        let model = dump_of(&name, &text, &models(), &Settings::default());
        insta::with_settings!({ snapshot_path => "model", prepend_module_to_snapshot => false, omit_expression => true }, {
            insta::assert_snapshot!(name.replace(".hy", ""), model);
        });
    }
}

#[test]
fn the_core_of_the_language_comes_to_what_its_snapshot_says() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/it/model");
    let text = std::fs::read_to_string(folder.join("core.hy")).expect("readable");
    let mut settings = settings_of("// -p n=3 -p top=36");
    settings.until = Some(5.0);
    let model = dump_of("core.hy", &text, &folder, &settings);
    insta::with_settings!({ snapshot_path => "model", prepend_module_to_snapshot => false, omit_expression => true }, {
        insta::assert_snapshot!("core", model);
    });
}

/// The model of a text that is right, and names no files.
fn model_of(text: &str) -> hyc::model::Model {
    let (checked, sources) = check_text("model.hy", text, Path::new("."), &Settings::default());
    checked.model.unwrap_or_else(|| panic!("{}", render(&sources, &checked.diagnostics, Colours::None)))
}

#[test]
fn long_chains_and_deep_nesting_are_no_problem() {
    let n = 20_000;
    let chain = |start: &str, link: &str| format!("{start}{}", link.repeat(n));
    let chains = [chain("x", " + 2*x"), chain("if lead", " and lead.x > 3") + " then lead.x else 0"];
    for rate in chains {
        let text =
            format!("agent C {{ state x = 0 link lead: C flow {{ x' = {rate} }} }} system {{ c = C() }}");
        assert!(dump(&model_of(&text)).len() > n);
    }
    let lets = (0..n).map(|k| format!("let a{k} = a{} + 1 ", k + 1)).collect::<String>();
    model_of(&format!("{lets} let a{n} = 1"));
    model_of(&format!("agent C {{ {lets} let a{n} = time }}"));
    for (open, close) in [("-", ""), ("2^", ""), ("if true then 1 + 2*", " else 1"), ("1 + sin(", ")")] {
        model_of(&format!("agent C {{ let a = {}1{} }}", open.repeat(250), close.repeat(250)));
    }
}

#[test]
fn shared_definitions_are_not_multiplied() {
    let lets = (1..100).map(|k| format!("let d{k} = d{0} + d{0} ", k - 1)).collect::<String>();
    let text = format!(
        "agent C {{ state x = 0 flow {{ x' = 1 }} }}
         interaction I(a: C, b: C) {{ let d0 = a.x {lets} when d99 > 1 {{ a.x := d99 }} }}"
    );
    assert!(dump(&model_of(&text)).len() < 10_000);
}

#[test]
fn a_hundred_thousand_agents_refer_to_each_other() {
    let model = model_of(
        "agent C(v: real) { state x = 2*v + index link lead: C flow { x' = 1 } }
         system { c = C[100000](v = index^2, lead = c[mod(index + 1, 100000)]) }",
    );
    assert_eq!(model.population.agents.len(), 100_000);
    let last = &model.population.agents[99_999];
    assert_eq!((last.states[0], last.links[0]), (2.0 * 99_999.0 * 99_999.0 + 99_999.0, Some(0)));
}

/// One text under every name.
struct Only(String);

impl Files for Only {
    fn read(&mut self, _path: &str) -> std::io::Result<Vec<u8>> {
        Ok(self.0.clone().into_bytes())
    }
}

#[test]
fn a_data_file_of_a_hundred_thousand_rows_makes_as_many_agents() {
    let rows = (0..100_000).map(|k| format!("{k},0.5,true\r\n")).collect::<String>();
    let text = "agent C(lit: bool) { state x: real [km], y flow { x' = y y' = 1 } } system { c = C[] from csv(\"c.csv\") }";
    let mut sources = SourceMap::default();
    let file = sources.add("model.hy", text);
    let ast = parse(file, text).expect("right");
    let mut files = Only(format!("\u{feff}x,y,lit\r\n{rows}"));
    let model = check(&ast, &mut sources, &mut files, &Settings::default()).model.expect("right");
    assert_eq!(model.population.agents.len(), 100_000);
    let last = &model.population.agents[99_999];
    assert_eq!(
        (last.states.as_slice(), last.params.as_slice()),
        ([99_999_000.0, 0.5].as_slice(), [1.0].as_slice())
    );
}

#[test]
fn every_code_of_this_floor_has_a_case_and_every_case_a_code() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut codes = std::collections::BTreeSet::new();
    for entry in std::fs::read_dir(root.join("src/model/error")).expect("the folder is there") {
        let text = std::fs::read_to_string(entry.expect("readable").path()).expect("readable");
        let quoted = text.split('"').filter(|part| part.len() == 6 && part.starts_with("HY02"));
        codes.extend(quoted.map(str::to_string));
    }
    let cases = texts_in(&errors()).into_iter().map(|(name, _)| name[..6].to_string());
    let cases = cases.filter(|code| code.starts_with("HY02")).collect::<std::collections::BTreeSet<_>>();
    assert_eq!(codes, cases);
}

/// The settings that the first line of a case names: `// -p N=3 --tolerance 0`.
fn settings_of(text: &str) -> Settings {
    let mut settings = Settings::default();
    let line = text.lines().next().and_then(|line| line.strip_prefix("// -")).unwrap_or("");
    let line = format!("-{line}");
    let mut words = line.split_whitespace();
    while let (Some(flag), Some(value)) = (words.next(), words.next()) {
        match flag {
            "-p" => {
                let (name, value) = value.split_once('=').expect("NAME=VALUE");
                settings.params.push((name.to_string(), value.to_string()));
            }
            "--limit" => match value.split_once('=').expect("NAME=N") {
                ("max_states", n) => settings.limits.states_max = n.parse().expect("a number"),
                ("max_modes", n) => settings.limits.modes_max = n.parse().expect("a number"),
                ("max_configurations", n) => {
                    settings.limits.configurations_max = n.parse().expect("a number");
                }
                ("max_table_rows", n) => settings.limits.table_rows_max = n.parse().expect("a number"),
                ("max_cells", n) => settings.limits.cells_max = n.parse().expect("a number"),
                (other, _) => panic!("the limit {other} is not known to this test"),
            },
            "--tolerance" => settings.tolerance = Some(value.parse().expect("a number")),
            other => panic!("{other} is not known to this test"),
        }
    }
    settings
}

fn errors() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/it/errors")
}

#[test]
fn every_wrong_model_is_told_what_its_snapshot_says() {
    for (name, text) in texts_in(&errors()).into_iter().filter(|(name, _)| name.starts_with("HY02")) {
        let (checked, sources) = check_text(&name, &text, &errors(), &settings_of(&text));
        assert!(checked.model.is_none(), "{name} is wrong");
        let told = render(&sources, &checked.diagnostics, Colours::None);
        assert!(told.contains(&name[..6]), "{name} shows another code:\n{told}");
        insta::with_settings!({ snapshot_path => "errors", prepend_module_to_snapshot => false, omit_expression => true }, {
            insta::assert_snapshot!(name.replace(".hy", ""), told);
        });
    }
}
