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
