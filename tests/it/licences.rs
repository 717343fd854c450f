//! May everything that is linked in be used so? The licences of all dependencies against a list.

use std::collections::BTreeSet;
use std::process::Command;

/// Licences that ask for no more than their text and notice to be passed on.
const ALLOWED: [&str; 9] = [
    "MIT",
    "Apache-2.0",
    "Apache-2.0 WITH LLVM-exception",
    "BSD-2-Clause",
    "BSD-3-Clause",
    "ISC",
    "Unicode-3.0",
    "Unlicense",
    "Zlib",
];

#[test]
fn every_dependency_has_an_allowed_licence() {
    // `cargo tree` looks at this package only; what it is measured against (`benches/peers`) need not be there.
    let output = Command::new(env!("CARGO"))
        .args([
            "tree",
            "--package",
            "hyc",
            "--locked",
            "--offline",
            "--prefix",
            "none",
            "--format",
            "{p}|{l}",
            "--target",
        ])
        .arg(host())
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let listing = String::from_utf8(output.stdout).unwrap();
    let packages: BTreeSet<&str> = listing.lines().filter(|line| !line.is_empty()).collect();
    assert!(packages.len() > 20, "the list of packages is too short to be true");
    for package in packages {
        let (name, licence) = package.split_once('|').unwrap();
        let licence = licence.trim_end_matches(" (*)");
        assert!(is_allowed(licence), "{name} has the licence `{licence}`");
    }
}

/// The platform that the compiler runs on: packages of others need not be there.
fn host() -> String {
    let output = Command::new("rustc").arg("-vV").output().unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    text.lines().find_map(|line| line.strip_prefix("host: ")).unwrap().to_string()
}

/// Whether an SPDX expression can be met from the list: `or` needs one side, `and` both.
fn is_allowed(expression: &str) -> bool {
    let expression = expression.replace('/', " OR ");
    let expression = expression.trim();
    if let Some((left, right)) = split_outside(expression, " OR ") {
        return is_allowed(left) || is_allowed(right);
    }
    if let Some((left, right)) = split_outside(expression, " AND ") {
        return is_allowed(left) && is_allowed(right);
    }
    match expression.strip_prefix('(').and_then(|inner| inner.strip_suffix(')')) {
        Some(inner) => is_allowed(inner),
        None => ALLOWED.contains(&expression),
    }
}

/// Splits at the first such word outside parentheses.
fn split_outside<'a>(text: &'a str, word: &str) -> Option<(&'a str, &'a str)> {
    let mut depth = 0;
    for (k, character) in text.char_indices() {
        match character {
            '(' => depth += 1,
            ')' => depth -= 1,
            _ => {}
        }
        if depth == 0 && text[k..].starts_with(word) {
            return Some((&text[..k], &text[k + word.len()..]));
        }
    }
    None
}

#[test]
fn what_is_vendored_has_its_licence_beside_it() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("src/picture");
    let (charts, font) = (folder.join("page/vendor/uPlot.LICENSE"), folder.join("font/LICENSE"));
    assert!(std::fs::read_to_string(charts).unwrap().contains("MIT License"));
    assert!(std::fs::read_to_string(font).unwrap().contains("Permission is hereby granted, free of charge"));
}

#[test]
fn licence_expressions_are_read_as_they_mean() {
    for expression in ["MIT", "MIT OR GPL-3.0", "MIT/Apache-2.0", "(MIT OR Apache-2.0) AND Unicode-3.0"] {
        assert!(is_allowed(expression), "{expression}");
    }
    for expression in ["GPL-3.0", "MIT AND GPL-3.0", "(GPL-3.0 OR LGPL-3.0) AND MIT", "none given"] {
        assert!(!is_allowed(expression), "{expression}");
    }
}
