//! What do the floors make of the shipped models? The same text that `hyc show` prints.
//!
//! The stages `model` and `system` of every model are snapshotted by the tests of those floors.

use crate::harness::Case;
use hyc::base::SourceMap;

fn check(name: &str, stage: &str, text: &str) {
    let mut settings = insta::Settings::clone_current();
    settings.set_snapshot_path("stages");
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    settings.bind(|| insta::assert_snapshot!(format!("{name}.{stage}"), text));
}

fn case(name: &str) -> Case {
    Case::shipped(&format!("{name}.hy"))
}

#[test]
fn ast() {
    for name in ["bouncing_ball", "bumper", "highway_static"] {
        let ast = case(name).ast(&mut SourceMap::default()).expect("a model without syntax errors");
        check(name, "ast", &hyc::syntax::dump(&ast));
    }
}

#[test]
fn tape_and_machine_code() {
    for name in ["bouncing_ball", "bumper", "highway_static"] {
        let (_, system, _) = case(name).system();
        check(name, "tape", &hyc::codegen::dump_tape(&system));
        check(name, "clif", &hyc::codegen::dump_clif(&system));
    }
}
