//! Is every text read as the language reference says, and every wrong one refused with a message that helps?

use hyc::base::render::{Colours, render};
use hyc::base::{FileId, SourceMap};
use hyc::syntax;

/// The three programs of the language reference.
const PROGRAMS: [(&str, &str); 3] = [
    ("two_cars", include_str!("syntax/two_cars.hy")),
    ("bumper", include_str!("syntax/bumper.hy")),
    ("highway", include_str!("syntax/highway.hy")),
];

/// The rendered diagnostics of a text, or its outline.
fn read(text: &str) -> Result<String, String> {
    let mut sources = SourceMap::default();
    let file = sources.add("model.hy", text);
    match syntax::parse(file, text) {
        Ok(ast) => Ok(syntax::dump(&ast)),
        Err(diagnostics) => Err(render(&sources, &diagnostics, Colours::None)),
    }
}

#[allow(dead_code)]
fn refuse(text: &str) -> String {
    read(text).expect_err("this text is wrong")
}

#[test]
fn the_three_programs_of_the_reference_are_read_unchanged() {
    for (name, text) in PROGRAMS {
        insta::with_settings!({ snapshot_path => "syntax", prepend_module_to_snapshot => false }, {
            insta::assert_snapshot!(name, read(text).unwrap());
        });
    }
}

#[test]
fn what_the_printer_writes_is_read_as_the_same_tree() {
    for (_, text) in PROGRAMS {
        assert_round_trip(text);
    }
}

/// Parsing what is printed gives the same tree, and printing that the same text.
fn assert_round_trip(text: &str) {
    let ast = syntax::parse(FileId(0), text).unwrap_or_else(|errors| panic!("{text}\n{errors:?}"));
    let printed = syntax::print(&ast);
    let again = syntax::parse(FileId(0), &printed).unwrap_or_else(|errors| panic!("{printed}\n{errors:?}"));
    assert_eq!(syntax::dump(&ast), syntax::dump(&again), "{printed}");
    assert_eq!(printed, syntax::print(&again));
}
