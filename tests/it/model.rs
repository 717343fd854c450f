//! What does a text come to as a model? Snapshots of the model stage, and of every diagnostic of that floor.

use std::path::{Path, PathBuf};

use hyc::base::SourceMap;
use hyc::base::render::{Colours, render};
use hyc::model::{Checked, Files, Settings, check, dump};
use hyc::syntax::parse;

/// Data files beside the model.
struct Beside(PathBuf);

impl Files for Beside {
    fn read(&mut self, path: &str) -> std::io::Result<String> {
        std::fs::read_to_string(self.0.join(path))
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
