//! Is what a model asks for bounded before it takes memory or time, and does each bound say how it is raised? Nothing here looks at a clock:
//! what would not end in time ends the test by its memory, or never.

#[path = "../../benches/giant/shapes.rs"]
#[allow(dead_code, reason = "shared with the example that writes files")]
mod shapes;

use hyc::base::SourceMap;
use hyc::model::limits::Limits;
use hyc::model::{Files, Settings};

use crate::harness::{Case, Ended, refused, words};
use shapes::SHAPES;

/// There are no data files.
struct Nothing;

impl Files for Nothing {
    fn read(&mut self, _path: &str) -> std::io::Result<Vec<u8>> {
        Err(std::io::ErrorKind::NotFound.into())
    }
}

/// What a check and the equations come to under these limits: the messages, and the work on the equations.
fn checked(text: &str, limits: Limits) -> (String, u64) {
    let mut sources = SourceMap::default();
    let file = sources.add("giant.hy", text);
    let tree = match hyc::syntax::parse(file, text) {
        Ok(tree) => tree,
        Err(found) => return (words(&found), 0),
    };
    let settings = Settings { limits, ..Settings::default() };
    let checked = hyc::model::check(&tree, &mut sources, &mut Nothing, &settings);
    let Some(model) = checked.model else { return (words(&checked.diagnostics), 0) };
    match hyc::calculus::derive(&model) {
        Ok(system) => (String::new(), system.graph.work()),
        Err(found) => (words(&found), 0),
    }
}

#[track_caller]
fn says(message: &str, expected: &[&str]) {
    for part in expected {
        assert!(message.contains(part), "`{part}` is not in:\n{message}");
    }
}

#[test]
fn a_count_of_agents_is_refused_before_there_are_any() {
    for count in ["1000000000000", "1e308", "2^62", "1e18", "10000001"] {
        let message = refused(&format!("agent Car {{ }}  system {{ cars = Car[{count}]() }}"));
        says(&message, &["HY0291", "limit of 10000000", "--limit max_agents=N"]);
    }
    let together = "agent Car { }  system { a = Car[6000000]()  b = Car[6000000]() }";
    says(&refused(together), &["HY0291", "12000000 agents"]);
}

#[test]
fn a_count_that_is_none_is_refused() {
    for count in ["-1", "0.5", "inf", "-inf", "0/0", "inf - inf", "-1e308"] {
        let message = refused(&format!("agent Car {{ }}  system {{ cars = Car[{count}]() }}"));
        assert!(message.starts_with("error[HY026"), "{count}: {message}");
    }
    assert_eq!(checked("agent Car { }  system { cars = Car[-0]() }", Limits::default()).0, "");
}

#[test]
fn limits_of_the_model_are_raised_and_lowered() {
    let cars = "agent Car(v: real) { state x = 0  flow { x' = v } }  system { cars = Car[100](v = 1) }";
    assert_eq!(checked(cars, Limits::default()).0, "");
    let few = Limits { agents_max: 99, ..Limits::default() };
    says(&checked(cars, few).0, &["HY0291", "100 agents are more than the limit of 99"]);
    let small = Limits { values_max: 199, ..Limits::default() };
    says(&checked(cars, small).0, &["HY0296", "more than 199 numbers", "--limit max_values=N"]);
    let short = Limits { operations_max: 10, ..Limits::default() };
    says(&checked(cars, short).0, &["HY0307", "more than 10 operations", "--limit max_operations=N"]);
    let hasty = Limits { evaluations_max: 10, ..Limits::default() };
    let sum = "param a = 1\nfn f(x: real) = x + x + x + x + x + x + x + x + x + x\nlet b = f(a)";
    says(&checked(sum, hasty).0, &["HY0292", "--limit max_evaluations=N"]);
}

#[test]
fn states_modes_and_cells_have_limits_of_their_own() {
    let limits = Limits { states_max: 2, modes_max: 2, cells_max: 6, ..Limits::default() };
    let more_than = |text: &str, code: &str, most: &str, limit: &str| {
        let raise = format!("--limit {limit}=N");
        let message = checked(text, limits).0;
        says(&message, &[code, most, &raise]);
        assert_eq!(message.matches("error[HY").count(), 1, "{message}");
    };
    let states = |n: usize| {
        let parts = (0..n).map(|k| format!("state x{k} = 0  flow {{ x{k}' = 1 }}  "));
        format!("agent A {{ {}}}  system {{ a = A() }}", parts.collect::<String>())
    };
    assert_eq!(checked(&states(2), limits).0, "");
    more_than(&states(3), "HY0297", "`A` has more than 2 states", "max_states");
    more_than(&states(9), "HY0297", "`A` has more than 2 states", "max_states");
    let modes = |n: usize| {
        let parts = (1..n).map(|k| format!("mode M{k} {{ }}  "));
        format!("agent A {{ initial mode M0 {{ }}  {}}}  system {{ a = A() }}", parts.collect::<String>())
    };
    assert_eq!(checked(&modes(2), limits).0, "");
    more_than(&modes(3), "HY0298", "`A` has more than 2 modes", "max_modes");
    let cells = |n: usize, columns: &str| {
        format!(
            "{} system {{ a = A[{n}]()  b = A() }} run {{ until 1 record {columns} to \"a.csv\" }}",
            "agent A { state x = 0, y = 0  flow { x' = 1  y' = 1 } }"
        )
    };
    for (n, columns) in [(3, "a"), (6, "a.x, a[2].x, a[2].x"), (5, "A.x"), (2, "A"), (100, "a[3], a[4], b")] {
        assert_eq!(checked(&cells(n, columns), limits).0, "", "{n} {columns}");
    }
    for (n, columns) in [(4, "a"), (7, "a.x"), (6, "A.x"), (3, "a, b"), (100, "a[3], a[4], a[5], b.x")] {
        more_than(&cells(n, columns), "HY0299", "a sample of more than 6 cells", "max_cells");
    }
}

#[test]
fn long_chains_and_many_names_are_looked_at_once() {
    // Each is what one pass went over again for every part; with so many parts that would not end.
    let sum: String = (0..100_000).map(|k| format!("+ {k}*x\n")).collect();
    let names: String = (0..30_000).map(|k| format!("b{k} = A(v = {k})\n")).collect();
    let columns: Vec<String> = (0..30_000).map(|k| format!("b{k}.x")).collect();
    let agent = "agent A(v: real) { state x = 0  flow { x' = v }  }";
    for text in [
        format!(
            "agent A {{ state x: real [km] = 0  flow {{ x' = 1 }}  let y = 1\n{sum} when y > 0 {{ x := 0 }} }}"
        ),
        format!("{agent} system {{ {names} }} run {{ until 1 record {} to \"a.csv\" }}", columns.join(", ")),
    ] {
        assert_eq!(checked(&text, Limits::default()).0, "");
    }
}

#[test]
fn functions_that_double_sixty_times_are_refused() {
    let mut same = "fn f0(x: real) = x\n".to_string();
    let mut moved = same.clone();
    for k in 0..60 {
        same += &format!("fn f{}(x: real) = f{k}(x) + f{k}(x)\n", k + 1);
        moved += &format!("fn f{}(x: real) = f{k}(x + {k}) + f{k}(x - {k})\n", k + 1);
    }
    let agent = "agent A { state x = 0  flow { x' = f60(x) } }";
    // What is the same is worked out once.
    assert_eq!(checked(&format!("{same}{agent}"), Limits::default()).0, "");
    let limits = Limits { operations_max: 1_000_000, ..Limits::default() };
    says(&checked(&format!("{moved}{agent}"), limits).0, &["HY0307"]);
    says(
        &checked(&format!("{moved}let a = f60(1)"), Limits { evaluations_max: 100_000, ..limits }).0,
        &["HY0292"],
    );
}

#[test]
fn large_models_take_work_in_proportion() {
    for shape in SHAPES.iter().filter(|shape| !shape.name.starts_with("wrong")) {
        let limits = Limits { operations_max: 20_000_000, ..Limits::default() };
        let work = [200, 400].map(|parts| {
            let (message, work) = checked(&shape.with_parts(parts), limits);
            let refused_for_good = shape.name == "functions_doubling";
            assert!(message.is_empty() || refused_for_good, "{}: {message}", shape.name);
            work
        });
        // In these each part holds all before it, so the text that is worked out is larger than the one that is written.
        let nested = ["agent_lets", "kinks_nested", "product"].contains(&shape.name);
        let share = if nested { 4.4 } else { 2.2 };
        assert!(work[1] as f64 <= share * work[0] as f64 + 100.0, "{}: {work:?}", shape.name);
    }
}

#[test]
fn large_models_that_are_wrong_are_told_in_short() {
    for shape in SHAPES.iter().filter(|shape| shape.name.starts_with("wrong")) {
        let text = shape.with_parts(50_000);
        let message = checked(&text, Limits::default()).0;
        assert_eq!(message.matches("error[HY").count(), 200, "{}", shape.name);
        says(&message, &["more like these are not shown"]);
    }
}

#[test]
fn numbers_that_no_setting_can_be_are_refused() {
    let run = |setting: &str| {
        refused(&format!(
            "agent A {{ state x = 0  flow {{ x' = 1 }} }}  system {{ a = A() }}  run {{ until 1 {setting} }}"
        ))
    };
    for value in ["-1", "inf", "-inf", "0/0", "inf - inf"] {
        let until = format!(
            "agent A {{ state x = 0  flow {{ x' = 1 }} }}  system {{ a = A() }}  run {{ until {value} }}"
        );
        assert!(refused(&until).starts_with("error[HY0"), "until {value}");
        for setting in ["tolerance", "absolute", "seed"] {
            assert!(run(&format!("{setting} {value}")).starts_with("error[HY0"), "{setting} {value}");
        }
        assert!(
            run(&format!("record a every {value} to \"a.csv\"")).starts_with("error[HY0"),
            "every {value}"
        );
    }
    assert!(run("tolerance 0").starts_with("error[HY0"));
    assert!(run("record a every -0 to \"a.csv\"").starts_with("error[HY0"));
}

#[test]
fn delays_and_periods_that_no_time_can_be_end_in_words() {
    let model = |trigger: &str| {
        format!(
            "agent A {{ state x = 0  flow {{ x' = 1 }}  t: {trigger} {{ x := 0 }} }}  system {{ a = A() }}  run {{ until 1 }}"
        )
    };
    for period in ["0", "-0", "-1", "inf - inf", "1e-300", "5e-324", "x - 1", "log(x - 1)"] {
        let text = model(&format!("every {period}"));
        let (message, _) = checked(&text, Limits::default());
        if message.is_empty() {
            let run = Case::new(&text).run_any();
            assert!(matches!(run.end, Ended::Error(_)), "every {period}: {:?}", run.end);
        }
    }
    for delay in ["0", "-0", "-1", "-1e308", "1e308", "inf", "inf - inf", "log(x - 1)"] {
        let text = model(&format!("after {delay}"));
        let (message, _) = checked(&text, Limits::default());
        if message.is_empty() {
            // It fires, waits for ever, or ends in words: which of them is for others to say.
            Case::new(&text).run_any();
        }
    }
}

#[test]
fn circles_are_named() {
    for text in [
        "param a = b  param b = a",
        "let a = a",
        "fn f(x: real) = f(x)",
        "fn f(x: real) = g(x)  fn g(x: real) = f(x)",
        "agent A { let a = b  let b = a }",
        "agent A { state x = y, y = x  flow { x' = 1  y' = 1 } }  system { a = A() }",
        "agent A { state x = 0, y = 0  flow { x' = y'  y' = x' } }  system { a = A() }",
        "agent A { let a = f(1) }  fn f(x: real) = g(x)  fn g(x: real) = f(x)",
    ] {
        let message = refused(text);
        assert!(message.contains("HY0207") || message.contains("HY0208"), "{text}: {message}");
    }
}

#[test]
fn samples_of_a_record_are_limited() {
    let recorded = |every: &str| {
        format!(
            "agent A {{ state x = 0  flow {{ x' = 1 }} }}  system {{ a = A() }}  run {{ until 1  record a every {every} to \"a.csv\" }}"
        )
    };
    for every in ["1e-300", "5e-324", "1e-13"] {
        says(
            &refused(&recorded(every)),
            &["HY0535", "more than 1000000000000 samples", "--limit max_samples=N"],
        );
    }
    let few = Limits { samples_max: 10, ..Limits::default() };
    says(&checked(&recorded("0.09"), few).0, &["HY0535", "more than 10 samples"]);
    assert_eq!(checked(&recorded("0.1"), few).0, "");
    assert_eq!(checked(&recorded("1e-8"), Limits::default()).0, "");
}
