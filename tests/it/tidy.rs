//! Does the house still stand? Floors, headers, names: the rules that a compiler does not hold.

use std::fs;
use std::path::{Path, PathBuf};

/// The floors in reading order, as `src/lib.rs` lists them.
fn floors() -> Vec<String> {
    let lib = fs::read_to_string(root().join("src/lib.rs")).unwrap();
    let names = lib.lines().filter_map(|line| line.strip_prefix("pub mod ")?.strip_suffix(';'));
    names.map(String::from).collect()
}

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

/// All files below a folder that end so, sorted.
fn files_below(folder: &Path, ending: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut folders = vec![folder.to_path_buf()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(&folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.to_string_lossy().ends_with(ending) {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}

/// A file of the crate: its path from `src/`, its text, and the text of what is no test.
struct Source {
    path: String,
    text: String,
    code: String,
}

impl Source {
    fn floor(&self) -> &str {
        self.path.split(['/', '.']).next().unwrap()
    }

    /// Whether the file holds nothing but tests.
    fn is_test(&self) -> bool {
        self.path.split('/').any(|part| part == "tests" || part == "tests.rs")
    }
}

fn sources() -> Vec<Source> {
    let folder = root().join("src");
    let read = |path: PathBuf| {
        let text = fs::read_to_string(&path).unwrap();
        let path = path.strip_prefix(&folder).unwrap().to_string_lossy().replace('\\', "/");
        let code = text.split("#[cfg(test)]\nmod tests {").next().unwrap();
        let code = code.lines().filter(|line| !line.trim_start().starts_with("//")).collect::<Vec<_>>();
        Source { path, code: code.join("\n"), text }
    };
    files_below(&folder, ".rs").into_iter().map(read).collect()
}

/// Fails with all lines that break a rule.
fn hold(rule: &str, broken: Vec<String>) {
    assert!(broken.is_empty(), "{rule}:\n  {}", broken.join("\n  "));
}

#[test]
fn floors_are_listed_in_reading_order() {
    let order =
        ["base", "math", "syntax", "model", "calculus", "codegen", "runtime", "output", "picture", "cli"];
    assert_eq!(floors(), order);
}

#[test]
fn a_floor_uses_only_floors_below_it() {
    let floors = floors();
    let rank = |name: &str| floors.iter().position(|floor| floor == name);
    let mut broken = Vec::new();
    for source in sources() {
        let Some(own) = rank(source.floor()) else { continue };
        for (k, rest) in source.code.match_indices("crate::") {
            let name: String = source.code[k + rest.len()..]
                .chars()
                .take_while(|c| c.is_alphanumeric() || *c == '_')
                .collect();
            if rank(&name).is_some_and(|used| used > own) {
                broken.push(format!("{} uses `{name}`", source.path));
            }
        }
    }
    hold("a floor uses only what stands before it in src/lib.rs", broken);
}

#[test]
fn what_a_floor_must_not_know_it_does_not_name() {
    let only_in = [
        ("codespan_reporting", "base/render.rs"),
        ("pest", "syntax/"),
        ("cranelift", "codegen/"),
        ("syntax::ast", "model/"),
        ("model::ir", "calculus/"),
        ("std::fs", "cli/"),
        ("println!", "cli/"),
        ("clap", "cli/"),
        ("ctrlc", "cli/"),
        ("process::exit", "cli/"),
    ];
    let mut broken = Vec::new();
    for source in sources().iter().filter(|source| !source.is_test()) {
        for (word, place) in only_in {
            let own_floor = matches!(
                (word, source.floor()),
                ("syntax::ast", "syntax" | "cli") | ("model::ir", "model" | "cli")
            );
            if !source.path.starts_with(place) && !own_floor && contains_word(&source.code, word) {
                broken.push(format!("{} names `{word}`, which belongs to {place}", source.path));
            }
        }
    }
    hold("what belongs to one place is named in no other", broken);
}

#[test]
fn output_knows_only_what_the_runtime_tells_and_numerics_know_no_agent() {
    let may_use: [(&str, &[&str]); 2] = [
        ("output/", &["crate::base", "crate::runtime::observe"]),
        ("runtime/solve/", &["crate::math", "crate::runtime::solve"]),
    ];
    let mut broken = Vec::new();
    for source in sources().iter().filter(|source| !source.is_test()) {
        let Some((_, allowed)) = may_use.iter().find(|(place, _)| source.path.starts_with(place)) else {
            continue;
        };
        for (k, _) in source.code.match_indices("crate::") {
            if !allowed.iter().any(|path| source.code[k..].starts_with(path)) {
                broken.push(format!("{} uses {}", source.path, source.code[k..].lines().next().unwrap()));
            }
        }
    }
    hold("these places use nothing else", broken);
}

/// Whether the text has the word, not as part of a longer one to the left.
fn contains_word(text: &str, word: &str) -> bool {
    text.match_indices(word).any(|(k, _)| {
        !text[..k].chars().next_back().is_some_and(|before| before.is_alphanumeric() || before == '_')
    })
}

#[test]
fn every_file_begins_with_its_purpose() {
    let mut files = files_below(&root().join("src"), ".rs");
    files.extend(files_below(&root().join("tests"), ".rs"));
    let broken = files.iter().filter(|path| !fs::read_to_string(path).unwrap().starts_with("//! "));
    hold("a file begins with `//! `", broken.map(|path| path.display().to_string()).collect());
}

#[test]
fn nothing_is_left_to_do_and_nothing_unwraps() {
    let mut broken = Vec::new();
    for source in sources() {
        for word in [["TO", "DO"].concat(), ["FIX", "ME"].concat(), ["X", "XX"].concat()] {
            if source.text.contains(&word) {
                broken.push(format!("{} says {word}", source.path));
            }
        }
        let forbidden = [".unwrap()", "dbg!(", "todo!(", "unimplemented!("];
        for word in forbidden.iter().filter(|word| !source.is_test() && source.code.contains(**word)) {
            broken.push(format!("{} has `{word}`", source.path));
        }
    }
    hold("no loose ends outside tests", broken);
}

#[test]
fn every_test_runs_and_can_fail() {
    let mut files = files_below(&root().join("src"), ".rs");
    files.extend(files_below(&root().join("tests"), ".rs"));
    let forbidden = [["#[ig", "nore"].concat(), ["#[should", "_panic"].concat()];
    let mut broken = Vec::new();
    for path in files {
        let text = fs::read_to_string(&path).unwrap();
        for word in forbidden.iter().filter(|word| text.contains(word.as_str())) {
            broken.push(format!("{} has {word}", path.display()));
        }
    }
    hold("no test is skipped, none is content with a panic", broken);
}

#[test]
fn file_names_say_what_is_inside() {
    let vague = ["utils", "util", "helpers", "helper", "misc", "common", "stuff"];
    let mut broken = Vec::new();
    for source in sources() {
        let stem = source.path.rsplit('/').next().unwrap().trim_end_matches(".rs").to_string();
        let numbered = stem.ends_with(|c: char| c.is_ascii_digit()) && stem.contains("part");
        if vague.contains(&stem.as_str()) || stem.ends_with("_more") || numbered {
            broken.push(source.path);
        }
    }
    hold("a file has the name of what it holds", broken);
}

#[test]
fn files_stay_readable_in_one_sitting() {
    let long = sources().into_iter().filter(|source| !source.is_test());
    let long = long.map(|source| (source.text.lines().count(), source.path)).filter(|(n, _)| *n > 600);
    hold(
        "a file of more than 600 lines holds more than one thing",
        long.map(|(n, path)| format!("{path}: {n} lines")).collect(),
    );
}

#[test]
fn unsafe_code_says_why_it_is_sound() {
    let mut broken = Vec::new();
    for source in sources() {
        let lines: Vec<&str> = source.text.lines().collect();
        for (k, line) in lines.iter().enumerate() {
            let code = line.split("//").next().unwrap();
            if contains_word(code, "unsafe {") || contains_word(code, "unsafe impl") {
                let said = lines[k.saturating_sub(6)..=k].iter().any(|line| line.contains("SAFETY:"));
                if !said {
                    broken.push(format!("{}:{}", source.path, k + 1));
                }
            }
        }
    }
    hold("`unsafe` has a SAFETY comment", broken);
}

#[test]
fn unsafe_code_stands_only_where_compiled_code_is_called() {
    let places = ["codegen/jit.rs", "codegen/kernel.rs", "math/lanes/level.rs"];
    let found: Vec<String> = sources()
        .into_iter()
        .filter(|source| {
            source.text.lines().any(|line| contains_word(line.split("//").next().unwrap(), "unsafe {"))
        })
        .map(|source| source.path)
        .collect();
    assert_eq!(
        found, places,
        "machine code and functions for a CPU's features are called from these files alone"
    );
}

#[test]
fn every_link_in_the_documents_leads_somewhere() {
    let mut documents = files_below(&root().join("docs"), ".md");
    documents.extend(["README.md", "CHANGELOG.md"].map(|name| root().join(name)));
    let mut broken = Vec::new();
    for document in documents {
        let text = fs::read_to_string(&document).unwrap();
        let prose: String = text.split("```").step_by(2).collect();
        for target in prose.split("](").skip(1).filter_map(|rest| rest.split(')').next()) {
            let file = target.split('#').next().unwrap();
            let outside = target.contains("://");
            if !outside && !file.is_empty() && !document.parent().unwrap().join(file).exists() {
                broken.push(format!("{}: {target}", document.display()));
            }
        }
    }
    hold("links between documents lead to files", broken);
}
