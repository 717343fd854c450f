//! Is a text the same tree in whatever slices it is read, and are slices short where a text is long?

#[path = "../../benches/giant/shapes.rs"]
#[allow(dead_code, reason = "shared with the example that writes files")]
mod shapes;

use std::path::Path;

use super::ast::Ast;
use super::error::SyntaxError;
use super::grammar::Rule;
use super::scan::{Source, scan};
use super::slices::{Reading, slices};
use super::{SLICE_BYTES, build, grammar};
use crate::base::FileId;
use shapes::SHAPES;

type Outcome = Result<Ast, Vec<SyntaxError>>;

fn in_slices(text: &str, bytes: usize) -> Outcome {
    let tokens = scan(FileId(0), text).expect("tokens");
    let source = Source { file: FileId(0), text, tokens: &tokens };
    build::build(source, bytes).unwrap_or_else(|_| panic!("in slices of {bytes} bytes: unread\n{text}"))
}

fn at_once(text: &str) -> Outcome {
    let tokens = scan(FileId(0), text).expect("tokens");
    let source = Source { file: FileId(0), text, tokens: &tokens };
    let pairs = grammar::read(Rule::file, text).expect("in the language");
    build::build_read(source, pairs).expect("the grammar and the tree builder agree")
}

#[track_caller]
fn assert_same_in_slices(text: &str) {
    let whole = at_once(text);
    for bytes in [0, 1, 10, 40, 200, 1000] {
        assert!(in_slices(text, bytes) == whole, "in slices of {bytes} bytes:\n{text}");
    }
}

fn texts_below(folder: &str) -> Vec<String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
    let paths = std::fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path());
    let models = paths.filter(|path| path.extension().is_some_and(|ending| ending == "hy"));
    models.map(|path| std::fs::read_to_string(path).expect("a text")).collect()
}

#[test]
fn a_text_is_the_same_tree_in_whatever_slices_it_is_read() {
    let texts = [texts_below("models"), texts_below("tests/it/syntax")].concat();
    assert!(texts.len() > 20);
    texts.iter().for_each(|text| assert_same_in_slices(text));
    SHAPES.iter().for_each(|shape| assert_same_in_slices(&shape.with_parts(30)));
}

#[test]
fn what_is_hard_to_cut_is_the_same_tree_in_slices() {
    for text in [
        "",
        "// nothing\n",
        "let a = -(b + c)^-2*d/(e - (f + g)*h) let b = (1) let c = ((a + b))",
        "let a = not b and not (c or d and not e) or f is M.N and not not g",
        "let a = b + if c and d then e + f else g + h or i let b = 1 + sum o in A where p or q: o.x + 1",
        "let a = min(b, c) + min o in A: o.x + 2 or 3 < max p in B: p.y",
        "let a = b^-c^d - -e [m/s] + f' - g.h[2].i(j, k)' <= -1e-3*l",
        "agent A { when a -> B after 1 when b priority 2 -> C x: every 2 when c when d { a := b } when e }",
        "agent A { x: on e(a, b) from c when d { if a { b := c } else if d { e.f ~ g } else { } h -> I.history } }",
        "agent A { region R { initial mode M { mode N { } } mode O { entry { } exit { stop \"x\" } } } }",
        "agent A { flow { x' = y' + z' y' = a == b z' = 1 } let a = 1 state x = 2, y ~ U(1, 2) discrete n: int }",
        "interaction I(a: A, b: A) { let d = a.x when d > 0 { a.x := d b.x ~ N(1, 2) a -> M } y: when 1 > 0 }",
        "system { a = A() b = A[3](x = 1, y ~ U(0, 1)) in M from csv(\"a\") c = B }",
        "run { until 1 stop when a and b record a, b.c[1], d + e every 1 to \"a\" record f to \"b\" seed 3 events to \"e\" }",
        "property p = always [0, 1] a until b property q = eventually c import \"x\" fn f(x: real = 1): int = x",
    ] {
        assert_same_in_slices(text);
    }
}

/// The bytes of the longest slice that the grammar reads at once.
fn longest(source: Source, rule: Rule, tokens: std::ops::Range<usize>) -> usize {
    let longest = slices(source, SLICE_BYTES, rule, tokens).into_iter().map(|slice| match slice.reading {
        Reading::InSlices => longest(source, slice.rule, slice.tokens),
        Reading::AtOnce => {
            source.tokens[slice.tokens.end - 1].end() - source.tokens[slice.tokens.start].start()
        }
    });
    longest.max().unwrap_or(0)
}

#[test]
fn no_slice_of_a_giant_model_is_long() {
    for shape in SHAPES {
        let text = shape.with_bytes(20 * SLICE_BYTES);
        let tokens = scan(FileId(0), &text).expect("tokens");
        let source = Source { file: FileId(0), text: &text, tokens: &tokens };
        let longest = longest(source, Rule::file, 0..tokens.len());
        assert!(longest <= SLICE_BYTES, "{}: {longest}", shape.name);
    }
}
