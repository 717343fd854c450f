//! Is every text read as the language reference says, and every wrong one refused with a message that helps?

use hyc::base::render::{Colours, render};
use hyc::base::{FileId, SourceMap};
use hyc::syntax;
use hyc::syntax::ast::{ExprKind, Item};

use crate::formatting::assert_round_trip;

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

#[test]
fn what_the_printer_writes_is_read_as_the_same_tree() {
    for (_, text) in PROGRAMS {
        assert_round_trip(text);
    }
}

/// Statements that the three programs do not have.
const OTHER_STATEMENTS: &str = r#"
import "cars.hy"
fn f(a: real [m], b: int = 2): real = a^b
fn g() = if 1 < 2 then min(1, 2) else if true then max(3, 4) else sum c in cars where c.v > 0: c.v
param list = [1, 2, 3]
agent Empty {}
agent A(lead: A, k: real = -2^-3^2) {
  state x ~ Uniform(0, 1), y: real [km/h] = 120 ; discrete n: int
  link near: A
  event ping(how: real, why: bool)
  region Left { initial mode On { exit { stop } } mode Off {} }
  on ping(a, b) from lead.lead when a > 0 priority 2 -> On { x := x + a }
  every 2 [s] when x is On.history_ { emit ping(1, true) after 3 [s] emit ping }
  after 1 when rising(x > 0) and not crossing(x') { stop "done" }
  when x > 0 or y > 0 and (x < 0 or y < 0) {
    if x > 0 { x := 1 } else if y > 0 { destroy lead } else { create A(x = 3, y ~ Normal(0, 1)) in Left from csv("a.csv") }
    if a - (b - c)*-d/(e/f) > 0 {}
  }
  when count o in A: o.x > 0 > 2 -> B.C.history
}
interaction I(a: A, b: A) { let d = a.x - b.x when d < 0 { a -> Off b.x := 0 b.y ~ Normal(0, 1) } }
system { as = A[] from csv("a.csv") bs = A[3](lead = as[index - 1]) c = A in On }
property p = always [0, 5] eventually x > 0
property q = x > 0 until [0, 5] y > 0 and (exists o in A where (exists p in A): o.x > 0) == true
run { stop when count o in A == 0 record as every 1 [s] to "x.csv" events to "e.csv" seed -1 absolute 1e-9 }
"#;

#[test]
fn every_other_statement_is_read_and_printed() {
    insta::with_settings!({ snapshot_path => "syntax", prepend_module_to_snapshot => false }, {
        let ast = syntax::parse(FileId(0), OTHER_STATEMENTS).unwrap_or_else(|_| panic!("{}", refuse(OTHER_STATEMENTS)));
        insta::assert_snapshot!("other_statements_printed", syntax::format(FileId(0), OTHER_STATEMENTS).unwrap());
        insta::assert_snapshot!("other_statements", syntax::dump(&ast));
    });
    assert_round_trip(OTHER_STATEMENTS);
}

#[test]
fn every_mistake_is_named_by_its_code() {
    insta::glob!("syntax/errors/*.hy", |path| {
        let code = path.file_stem().and_then(|stem| stem.to_str()).unwrap();
        let text = std::fs::read_to_string(path).unwrap();
        let mut said = String::new();
        for case in text.split("// ----\n") {
            let message = refuse(case);
            assert!(message.starts_with(&format!("error[{code}]")), "{case}\n{message}");
            said.push_str(&format!("{case}\n{message}"));
        }
        insta::with_settings!({ snapshot_path => "syntax/errors", prepend_module_to_snapshot => false, snapshot_suffix => "" }, {
            insta::assert_snapshot!(code, said);
        });
    });
}

/// A text of `levels` nested things, each a `before` and an `after` around the next.
fn nested(head: &str, before: &str, inner: &str, after: &str, levels: usize) -> String {
    format!("{head}{}{inner}{}", before.repeat(levels), after.repeat(levels))
}

/// Everything that can nest: what stands before it, and its two halves around `a`.
const NESTED: [(&str, &str, &str); 20] = [
    ("let x = ", "(", ")"),
    ("let x = ", "f(", ")"),
    ("let x = ", "[", "]"),
    ("let x = ", "a[", "]"),
    ("let x = ", "(1 + ", ")"),
    ("let x = ", "(1 + 2*", ")"),
    ("let x = ", "- ", ""),
    ("let x = ", "not ", ""),
    ("let x = ", "a^", ""),
    ("let x = ", "a^-", ""),
    ("let x = ", "if b then ", " else c"),
    ("let x = ", "if ", " then b else c"),
    ("let x = ", "if b then c else ", ""),
    ("let x = ", "exists o in Car: ", ""),
    ("let x = ", "1 + min o in Car where b: ", ""),
    ("let x = ", "exists o in Car where ", ""),
    ("property p = ", "always ", ""),
    ("property p = ", "always [0, 1] eventually ", ""),
    ("let x = ", "nearest o in Car where a + (b) by ", ""),
    ("let x = ", "1 + -", ""),
];

#[test]
fn nesting_is_read_up_to_the_limit_and_refused_beyond() {
    for (head, before, after) in NESTED {
        let each = if before.contains("a^-") || before.contains("1] eventually") { 2 } else { 1 };
        let deepest = nested(head, before, "a", after, (syntax::MAX_NESTING - 1) / each);
        assert_round_trip(&deepest);
        // `1 + -` does not nest: the minus has its operand when the next plus comes.
        if before != "1 + -" {
            let message = refuse(&nested(head, before, "a", after, syntax::MAX_NESTING / each + 1));
            assert!(message.starts_with("error[HY0102]: nesting is too deep"), "{before}");
        }
    }
    let exact = nested("let x = ", "(", "a", ")", syntax::MAX_NESTING);
    assert_round_trip(&exact);
    let modes = format!("agent A {}", nested("", "{ mode M ", "{}", "}", syntax::MAX_NESTING - 1));
    assert_round_trip(&modes);
    let mixed = nested("let x = ", "(a or b and c < d + e * ", "a", ")", syntax::MAX_NESTING);
    assert!(refuse(&mixed).starts_with("error[HY0102]"));
}

#[test]
fn a_million_levels_are_refused_at_once() {
    for (head, before, after) in NESTED.into_iter().filter(|(_, before, _)| *before != "1 + -") {
        let levels = if before.len() + after.len() < 5 { 1_000_000 } else { 50_000 };
        for after in [after, ""] {
            let errors = syntax::parse(FileId(0), &nested(head, before, "a", after, levels)).unwrap_err();
            assert_eq!(errors[0].code, "HY0102", "{before}");
        }
    }
    let suffixes = format!("]{}", ".b".repeat(syntax::MAX_NESTING - 1));
    let errors =
        syntax::parse(FileId(0), &nested("let x = ", "a[", "a", &suffixes, syntax::MAX_NESTING)).unwrap_err();
    assert_eq!(errors[0].code, "HY0102");
    for suffix in [".b", "'", "[1]", "(1)"] {
        let errors = syntax::parse(FileId(0), &format!("let x = a{}", suffix.repeat(20_000))).unwrap_err();
        assert!(errors.iter().any(|error| error.code == "HY0102"), "{suffix}");
    }
}

#[test]
fn long_chains_are_flat() {
    for term in [" + a", " and a"] {
        assert_round_trip(&format!("let x = a{}", term.repeat(100_000)));
    }
    for term in [" - a", "*a", "/a", " or a", " + a^2", " + -a", " and not a", " + (a*b)"] {
        assert_round_trip(&format!("let x = a{}", term.repeat(5_000)));
    }
    for statement in
        ["let x = -a^2\n", "let x = if a then b else c\n", "property p = always exists o in Car: o.x > 0\n"]
    {
        assert_round_trip(&statement.repeat(1000));
    }
    let branches = format!("agent A {{ when a {{ if a {{}} {} }} }}", "else if a { x := -1 }".repeat(1000));
    assert_round_trip(&branches);
}

#[test]
fn a_file_beyond_the_limit_is_refused() {
    let text = " ".repeat(syntax::MAX_FILE_BYTES + 1);
    let errors = syntax::parse(FileId(0), &text).unwrap_err();
    assert_eq!(errors[0].code, "HY0119");
    insta::assert_debug_snapshot!("a_file_beyond_the_limit", errors);
}

#[test]
fn no_mutilated_program_makes_the_parser_panic() {
    let mut state = 1_u64;
    let mut below = |n: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % n.max(1)
    };
    let mut sources = SourceMap::default();
    for (_, program) in PROGRAMS.into_iter().chain([("other", OTHER_STATEMENTS)]) {
        let pieces: Vec<&str> = program.split_inclusive(|c: char| !c.is_ascii_alphanumeric()).collect();
        for _ in 0..1000 {
            let mut pieces = pieces.clone();
            for _ in 0..=below(3) {
                let (at, other) = (below(pieces.len()), below(pieces.len()));
                match below(5) {
                    0 => drop(pieces.remove(at)),
                    1 => pieces.insert(at, pieces[other]),
                    2 => pieces.swap(at, other),
                    3 => pieces.truncate(at.max(1)),
                    _ => pieces.insert(
                        at,
                        ["(", "]", "{ ", "\"", "-", "é", "'", " if ", "1e9999", ".", "\u{0}"][below(11)],
                    ),
                }
            }
            let text = pieces.concat();
            let file = sources.add("mutilated.hy", text.as_str());
            match syntax::parse(file, &text) {
                Ok(_) => assert_round_trip(&text),
                Err(errors) => assert!(!errors.is_empty()),
            }
        }
    }
}

#[test]
fn places_end_where_the_text_of_a_node_ends() {
    let text = "let x = (a + b)*(c)   // a comment\n\n let y = f(1 [m] , o . x ' ) ; run { until 3 }";
    let ast = syntax::parse(FileId(0), text).unwrap();
    let spans: Vec<&str> = ast
        .items
        .iter()
        .map(|item| match item {
            Item::Let(definition) => &text[definition.span.range()],
            Item::Run(run) => &text[run.settings[0].span.range()],
            _ => "",
        })
        .collect();
    assert_eq!(spans, ["let x = (a + b)*(c)", "let y = f(1 [m] , o . x ' )", "until 3"]);
    let (Item::Let(x), Item::Let(y)) = (&ast.items[0], &ast.items[1]) else { panic!("two definitions") };
    let ExprKind::Product(product) = &x.value.kind else { panic!("a product") };
    let ExprKind::Call { args, .. } = &y.value.kind else { panic!("a call") };
    let places = [x.value.span, product.first.span, product.rest[0].outer, args[0].span, args[1].span];
    let places: Vec<&str> = places.iter().map(|span| &text[span.range()]).collect();
    assert_eq!(places, ["(a + b)*(c)", "a + b", "(c)", "1 [m]", "o . x '"]);
}
