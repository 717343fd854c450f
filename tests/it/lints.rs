//! Do warnings point at what is odd, and at nothing else? Cases with snapshots in `errors/`, models that must be clean.

use std::fs;
use std::path::{Path, PathBuf};

use hyc::base::render::{Colours, render};
use hyc::base::{Diagnostic, SourceMap};
use hyc::model::{Files, Settings};
use hyc::{calculus, model, syntax};

/// Data files beside the model.
struct Beside(PathBuf);

impl Files for Beside {
    fn read(&mut self, path: &str) -> std::io::Result<Vec<u8>> {
        fs::read(self.0.join(path))
    }
}

/// The warnings about a model that must be right, as text.
#[track_caller]
fn warnings(name: &str, text: &str, folder: &Path, params: &[(&str, &str)]) -> String {
    let mut sources = SourceMap::default();
    let found = find(&mut sources, name, text, folder, params);
    assert!(found.iter().all(|warning| !warning.is_error()), "{found:?}");
    render(&sources, &found, Colours::None)
}

#[track_caller]
fn find(
    sources: &mut SourceMap,
    name: &str,
    text: &str,
    folder: &Path,
    params: &[(&str, &str)],
) -> Vec<Diagnostic> {
    let file = sources.add(name, text);
    let tree = syntax::parse(file, text)
        .unwrap_or_else(|problems| panic!("{}", render(sources, &problems, Colours::None)));
    let params = params.iter().map(|(name, value)| (name.to_string(), value.to_string())).collect();
    let settings = Settings { params, ..Settings::default() };
    let checked = model::check(&tree, sources, &mut Beside(folder.to_path_buf()), &settings);
    let problems = render(sources, &checked.diagnostics, Colours::None);
    let model = checked.model.unwrap_or_else(|| panic!("{name}: {problems}"));
    let _ = calculus::derive(&model).unwrap();
    checked.warnings
}

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

/// The codes of the warnings about a model, in the order of the text.
#[track_caller]
fn codes(text: &str) -> Vec<&'static str> {
    let found = find(&mut SourceMap::default(), "model.hy", text, &root(), &[]);
    found.iter().map(|warning| warning.code).collect()
}

/// The `.hy` files of a folder by name, with their texts.
fn texts_in(folder: &Path) -> Vec<(String, String)> {
    let paths = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let mut paths: Vec<_> = paths.filter(|path| path.extension().is_some_and(|end| end == "hy")).collect();
    paths.sort();
    let name = |path: &PathBuf| path.file_name().unwrap().to_str().unwrap().to_string();
    paths.into_iter().map(|path| (name(&path), fs::read_to_string(&path).unwrap())).collect()
}

#[test]
fn no_shipped_model_has_a_warning() {
    let folder = root().join("models");
    let shipped = texts_in(&folder);
    assert!(shipped.len() >= 9);
    for (name, text) in shipped {
        assert_eq!(warnings(&name, &text, &folder, &[]), "", "{name}");
    }
    let bumper = fs::read_to_string(folder.join("bumper.hy")).unwrap();
    let params = [("N", "2"), ("data", "bumper_2.csv")];
    assert_eq!(warnings("bumper.hy", &bumper, &folder, &params), "");
}

#[test]
fn every_case_is_warned_of_as_its_snapshot_says() {
    let folder = root().join("tests/it/errors");
    for (name, text) in texts_in(&folder).into_iter().filter(|(name, _)| name.starts_with("HY06")) {
        let told = warnings(&name, &text, &folder, &[]);
        assert!(told.contains(&name[..6]), "{name} shows another code:\n{told}");
        insta::with_settings!({ snapshot_path => "errors", prepend_module_to_snapshot => false, omit_expression => true }, {
            insta::assert_snapshot!(name.replace(".hy", ""), told);
        });
    }
}

#[test]
fn a_name_that_says_so_may_be_unused() {
    let text = "param _a = 1  let _b = 2  fn _f(_x: real) = 3
        agent _T { state x = 0  flow { x' = 0 } }
        agent A(_p: real) {
          state x = 0
          discrete _d = 0
          link _l: A
          let _e = x
          flow { x' = 1 }
          some: when exists _o in other A: x >= 1 { x := 0 }
          initial mode M { }
          mode _N { }
        }
        interaction I(a: A, _b: A) { hit: when a.x >= 2 { a.x := 0 } }
        system { a = A[2](_p = 1) }
        run { until 1 }";
    assert_eq!(codes(text), [""; 0]);
    let bare = ["HY0601", "HY0601", "HY0601", "HY0601", "HY0603", "HY0601", "HY0602", "HY0601", "HY0601"];
    let bare = [&bare[..], &["HY0601", "HY0604", "HY0601"]].concat();
    assert_eq!(codes(&text.replace('_', "u")), bare);
}

#[test]
fn what_is_used_in_any_way_is_used() {
    let clean = [
        // by the data, by the population, by the run, by a priority, by an initial value
        "param n: int = 2  param d = 3
         agent A(rank: int) {
           state x = d
           discrete k: int = rank, seen = 0
           link next: A
           flow { x' = if next then next.x - x else 0 }
           jump: when x >= 4 priority rank { x := 0  k := k + 1  seen := time }
         }
         system { a = A[n](rank = index, next = if index >= 1 then a[index - 1] else none) }
         run { until 1  record a every 0.5 to \"a.csv\" }",
        // a library
        "param k = 1  fn f(x: real) = k*x  agent A(m: real) { state x = 0  discrete d = 0  let e = x  flow { x' = 1 } }",
        // an `exists` that only asks whether there is one; a witness that only the actions name
        "agent A { state x = 0, y = 0  flow { x' = 1  y' = 0 }
           any: when x >= 1 and (exists o in other A) { x := 0 }
           who: when x >= 2 and (exists o in other A: o.x <= 1) { y := o.y } }
         system { a = A[2](x = index) }",
        // participants that an interaction only moves
        "agent A { state x = 0  initial mode M { flow { x' = 1 } } mode N { flow { x' = 2 } } }
         interaction I(a: A, b: A) { go: when a.x >= 1 { b -> N } }
         system { a = A[2]() }",
    ];
    for text in clean {
        assert_eq!(codes(text), [""; 0], "{text}");
    }
}

#[test]
fn switches_are_no_dead_transitions() {
    let model = |guard: &str| {
        format!(
            "param noisy: bool = false  param n: int = 3  let idle = not noisy  let far = n > 5
             agent A {{ state x = if noisy or idle or far then n else 0  flow {{ x' = 1 }}
               t: when {guard} {{ x := 0 }} }}
             system {{ a = A() }}"
        )
    };
    for guard in ["noisy and x >= 1", "not idle and x >= 1", "far and x >= 1", "x >= 1 or n > 5", "false"] {
        assert_eq!(codes(&model(guard)), [""; 0], "{guard}");
    }
    for guard in ["n > 5 and x >= 1", "x >= 1 and n == 4", "inf < n and (x >= 1 or x <= 0)"] {
        assert_eq!(codes(&model(guard)), ["HY0605"], "{guard}");
    }
}
