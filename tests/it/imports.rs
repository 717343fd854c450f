//! Do imported files say what they would say in one file, and are circles, clashes and missing files told in their places?

use hyc::base::render::{Colours, render};

use crate::harness::{Case, Ended, all_near};

const WALKER: &str = "param pace = 2
fn twice(a: real) = 2*a
agent Walker(goal: real) {
  state x = 0
  initial mode Go { flow { x' = pace }  there: when x >= twice(goal) -> Rest }
  mode Rest { flow { x' = 0 } }
}
";

/// The rendered messages of a model that must be wrong.
#[track_caller]
fn told(case: &Case) -> String {
    let (sources, diagnostics) = case.refused();
    render(&sources, &diagnostics, Colours::None)
}

#[test]
fn all_names_of_a_file_are_brought() {
    let case = Case::new(
        "import \"walker.hy\"
         let far = twice(3)
         system { a = Walker(goal = far/2) }  run { until 5 }",
    );
    let run = case.file("walker.hy", WALKER).run();
    all_near(&run.times("Walker.there"), &[3.0], 1e-9);
}

#[test]
fn the_command_line_sets_imported_params() {
    let case = Case::new("import \"walker.hy\"  system { a = Walker(goal = 3) }  run { until 5 }");
    let run = case.file("walker.hy", WALKER).param("pace", 4).run();
    all_near(&run.times("Walker.there"), &[1.5], 1e-9);
}

#[test]
fn a_file_may_have_the_system_and_the_run_of_another() {
    let case = Case::new("import \"walker.hy\"  import \"cast.hy\"  run { until 5 }")
        .file("walker.hy", WALKER)
        .file("cast.hy", "system { a = Walker(goal = 3) }");
    assert_eq!(case.run().times("Walker.there").len(), 1);
}

#[test]
fn paths_are_relative_to_the_importing_file_and_twice_is_once() {
    let case = Case::new(
        "import \"lib/walker.hy\"  import \"./lib/../lib/pace.hy\"  import \"lib/walker.hy\"
         system { a = Walker(goal = 3) }  run { until 5 }",
    );
    let run = case
        .file("lib/walker.hy", &WALKER.replace("param pace = 2", "import \"pace.hy\" import \"../fast.hy\""))
        .file("lib/pace.hy", "param pace = 2*fast  import \"../fast.hy\"")
        .file("fast.hy", "param fast = 3")
        .run();
    all_near(&run.times("Walker.there"), &[1.0], 1e-9);
}

#[test]
fn what_is_imported_is_declared_before() {
    // of two interactions that write the same, the one declared first has its turn first
    let case = Case::new(
        "import \"first.hy\"
         interaction Second(a: A, b: A) { go: when time >= 1 and a.id < b.id { a.n := 10*a.n + 2 } }
         system { a = A(id = 0)  b = A(id = 1) }  run { until 2 }",
    );
    let run = case
        .file(
            "first.hy",
            "agent A(id: int) { discrete n = 0 }
             interaction First(a: A, b: A) { go: when time >= 1 and a.id < b.id { a.n := 10*a.n + 1 } }",
        )
        .run();
    assert_eq!(run.end, Ended::Until);
    assert_eq!(run.value("a.n"), 12.0);
    assert_eq!(run.log(), ["0 First.go a b", "1 Second.go a b"]);
}

#[test]
fn circles_name_every_file() {
    let text = told(&Case::new("import \"test.hy\""));
    assert!(text.contains("HY0214") && text.contains("`test.hy` imports itself"), "{text}");
    let case = Case::new("import \"a.hy\"")
        .file("a.hy", "import \"lib/b.hy\"")
        .file("lib/b.hy", "// comes back\nimport \"../a.hy\"");
    let text = told(&case);
    assert!(text.contains("imports go in a circle: a.hy -> lib/b.hy -> a.hy"), "{text}");
    assert!(text.contains("lib/b.hy:2:8") && text.contains("a.hy:1:8"), "{text}");
    // a circle through the model itself
    let case = Case::new("import \"a.hy\"").file("a.hy", "import \"test.hy\"");
    let text = told(&case);
    assert!(text.contains("imports go in a circle: test.hy -> a.hy -> test.hy"), "{text}");
}

#[test]
fn a_missing_file_is_told_where_it_is_imported() {
    let case =
        Case::new("import \"lib/a.hy\"  system { a = Other() }").file("lib/a.hy", "import \"none.hy\"");
    let text = told(&case);
    assert!(
        text.contains("HY0215") && text.contains("cannot import `lib/none.hy`: there is no such file"),
        "{text}"
    );
    assert!(text.contains("lib/a.hy:1:8"), "{text}");
    // what may be in the missing file is not said to be missing
    assert!(!text.contains("HY0202") && !text.contains("HY0201"), "{text}");
}

#[test]
fn a_clash_shows_both_places() {
    let case = Case::new("import \"walker.hy\"\nparam pace = 3").file("walker.hy", WALKER);
    let text = told(&case);
    assert!(
        text.contains("HY0205") && text.contains("walker.hy:1:7") && text.contains("test.hy:2:7"),
        "{text}"
    );
    let case = Case::new("import \"a.hy\"  run { until 1 }").file("a.hy", "run { until 2 }");
    let text = told(&case);
    assert!(text.contains("HY0211") && text.contains("a.hy:1:1"), "{text}");
}

#[test]
fn errors_of_an_imported_file_stand_in_it() {
    let case = Case::new("import \"a.hy\"").file("a.hy", "param a = \nparam b = 1");
    let text = told(&case);
    assert!(text.contains("HY01") && text.contains("a.hy:2:1"), "{text}");
    let case = Case::new("import \"a.hy\"").file("a.hy", "\n\nagent A { state x = y  flow { x' = 1 } }");
    let text = told(&case);
    assert!(text.contains("HY0201") && text.contains("a.hy:3:"), "{text}");
}

#[test]
fn what_is_not_used_of_an_imported_file_is_no_warning() {
    let warnings = |text: &str| {
        let case =
            Case::new(text).file("walker.hy", &format!("{WALKER}\nfn unused(a: real) = a\nparam idle = 3"));
        let mut sources = hyc::base::SourceMap::default();
        let ast = case.ast(&mut sources).unwrap();
        let checked = case.check(&ast, &mut sources);
        checked.warnings.iter().map(|warning| warning.code).collect::<Vec<_>>()
    };
    let rest = "system { a = Walker(goal = 3) }  run { until 5 }";
    assert_eq!(warnings(&format!("import \"walker.hy\"  {rest}")), [""; 0]);
    assert_eq!(warnings(&format!("import \"walker.hy\"  param idle2 = 3  {rest}")), ["HY0601"]);
}
