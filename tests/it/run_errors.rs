//! Does a run that ends in error say when, who, where in the source, by which numbers, and after which steps?

use hyc::base::{Diagnostic, SourceMap, Span};
use hyc::model::ir::Integrator;

use crate::harness::{Case, Run};

/// The error of a run, and the texts that its labels point at.
struct Failed {
    run: Run,
    found: Diagnostic,
    pointed_at: Vec<String>,
}

#[track_caller]
fn fails(text: &str, code: &str) -> Failed {
    let (run, found) = Case::new(text).run_error();
    assert_eq!(found.code, code, "{found:#?}");
    let pointed_at = found.labels.iter().map(|label| text_of(&run.sources, label.span)).collect();
    Failed { run, found, pointed_at }
}

fn text_of(sources: &SourceMap, span: Span) -> String {
    sources.text(span).to_string()
}

impl Failed {
    /// The notes that contain all of these words.
    fn notes(&self, words: &[&str]) -> Vec<&String> {
        self.found.notes.iter().filter(|note| words.iter().all(|word| note.contains(word))).collect()
    }

    #[track_caller]
    fn says(&self, words: &[&str]) -> &String {
        let notes = self.notes(words);
        assert_eq!(notes.len(), 1, "one note with {words:?} is expected among {:#?}", self.found.notes);
        notes[0]
    }

    /// The number after some words of a note.
    #[track_caller]
    fn number(&self, words: &[&str], before: &str) -> f64 {
        let note = self.says(words);
        let (_, rest) = note.split_once(before).unwrap_or_else(|| panic!("no {before:?} in {note:?}"));
        let word = rest.split([',', ' ', ':']).find(|word| !word.is_empty()).unwrap();
        word.parse().unwrap_or_else(|_| panic!("{word:?} in {note:?} is no number"))
    }
}

#[test]
fn a_flow_that_is_not_defined_names_the_expression_and_its_operands() {
    let failed = fails(
        "fn depth(z: real) = log(z - 1/2)
         agent A { state x = 1, y = 0  flow { x' = -1  y' = 2*depth(x) + 1 } }
         system { a = A() }  run { until 3  integrator tsit5 }",
        "HY0502",
    );
    assert_eq!(failed.pointed_at, ["y' = 2*depth(x) + 1", "log(z - 1/2)"]);
    assert_eq!(failed.found.labels[1].text, "this is NaN");
    assert!(failed.found.title.contains("`y`"));
    let argument = failed.number(&["`log(x - 0.5)` is NaN"], "`x - 0.5` = ");
    assert!(argument <= 0.0 && argument > -1e-9);
    failed.says(&["at t = 0.49999", "a: x = 0.5"]);
    failed.says(&["the last steps of a: from t = "]);
    assert_eq!(failed.notes(&["refused after", "a number in it is not finite"]).len(), 1);
    assert_eq!(failed.notes(&["accepted"]).len(), 4, "four steps before it: {:#?}", failed.found.notes);
}

#[test]
fn an_overflow_is_told_from_what_is_undefined() {
    let failed = fails(
        "agent A { state x = 0, y = 1  flow { x' = 100  y' = -1e-3*exp(x) } }
         system { a = A() }  run { until 30  tolerance 1e-2 absolute 1e300 }",
        "HY0502",
    );
    assert_eq!(failed.pointed_at[1], "exp(x)");
    assert_eq!(failed.found.labels[1].text, "this is inf");
    assert!(failed.number(&["`exp(x)` is inf"], "`x` = ") > 709.0);
}

#[test]
fn the_branch_that_is_taken_is_to_blame() {
    let failed = fails(
        "agent A { state x = -1  discrete far: bool = false
           flow { x' = if far then log(x) else sqrt(x) } }
         system { a = A() }  run { until 3 }",
        "HY0502",
    );
    assert_eq!(failed.pointed_at[1], "sqrt(x)");
    assert_eq!(failed.run.time, 0.0);
    assert!(failed.notes(&["the last steps"]).is_empty(), "there were none");
}

#[test]
fn the_member_of_a_group_to_blame_is_named() {
    let failed = fails(
        "agent Lead { state x = 1  flow { x' = -1 } }
         agent Tail(lead: Lead) { state y = 0  flow { y' = sqrt(lead.x) } }
         system { lead = Lead()  tail = Tail(lead = lead) }  run { until 3 }",
        "HY0502",
    );
    assert_eq!(failed.pointed_at, ["y' = sqrt(lead.x)", "sqrt(lead.x)"]);
    failed.says(&["at t = ", ": tail: y = "]);
    let operand = failed.number(&["`sqrt(lead.x)` is NaN"], "`lead.x` = ");
    assert!((-1e-9..0.0).contains(&operand));
}

#[test]
fn by_the_paper_s_integrator_it_is_the_same() {
    let text = "agent A { state x = 1  flow { x' = -sqrt(x) - 1 } }  system { a = A() }  run { until 3 }";
    let (run, found) = Case::new(text).integrator(Integrator::Adams).run_error();
    assert_eq!(found.code, "HY0502");
    assert_eq!(text_of(&run.sources, found.labels[1].span), "sqrt(x)");
}

#[test]
fn an_action_names_the_expression_and_its_operands() {
    let failed = fails(
        "agent A { state x = 1  discrete n = 0  flow { x' = 1 }
           half: when x >= 1.5 { x := 3 + 1/n } }
         system { a = A() }  run { until 3  integrator tsit5 }",
        "HY0503",
    );
    assert_eq!(failed.pointed_at, ["x := 3 + 1/n", "1/n"]);
    failed.says(&["`1/n` is inf, with `n` = 0"]);
    failed.says(&["at t = 0.5", ": a: x = 1.5, n = 0"]);
    failed.says(&["the last steps of a"]);
}

#[test]
fn an_invariant_shows_both_sides() {
    let failed = fails(
        "agent A { state x = 0, v = 1  invariant x <= 0.5 and v >= 0 \"full\"
           flow { x' = v  v' = 0 }  initial mode M { } }
         system { a = A() }  run { until 3 }",
        "HY0501",
    );
    assert_eq!(failed.found.labels[0].text, "full");
    let left = failed.number(&["`x <= 0.5`: "], "`x <= 0.5`: ");
    assert!((0.5..0.5 + 1e-9).contains(&left));
    failed.says(&["`v >= 0`: 1 on the left, 0 on the right"]);
    failed.says(&["a in mode M: x = 0.5"]);
    failed.says(&["the last steps of a"]);
}

#[test]
fn an_assert_shows_both_sides_and_the_mode() {
    let run = Case::new(
        "agent A { state x = 0  assert 2*x < 1 \"too far\"  flow { x' = 1 }  initial mode M { } }
         system { a = A() }  run { until 3 }",
    )
    .run();
    let claim = &run.false_asserts[0];
    assert_eq!((claim.mode.as_str(), claim.compared.len()), ("M", 1));
    let compared = &claim.compared[0];
    assert_eq!((compared.text.as_str(), compared.right), ("2*x < 1", 1.0));
    assert!((compared.left - 1.0).abs() < 1e-9);
}

#[test]
fn a_step_that_becomes_too_small_shows_the_rate_and_the_steps() {
    let failed =
        fails("agent A { state x = 1  flow { x' = x^2 } }  system { a = A() }  run { until 3 }", "HY0504");
    assert!(failed.number(&["fastest rate of the flow's Jacobian"], "`x'` is ") > 1e10);
    assert_eq!(failed.notes(&["from t = "]).len(), 5);
}

#[test]
fn repetition_shows_what_the_guard_compares() {
    let failed = fails(
        "agent Ball { state x = 1, v = 0  flow { x' = v  v' = -10 }
           bounce: when x <= 0 { v := -0.5*v } }
         system { ball = Ball() }  run { until 3 }",
        "HY0506",
    );
    let height = failed.number(&["`x <= 0`: "], "`x <= 0`: ");
    assert!(height.abs() < 1e-9);
    failed.says(&["the last steps of ball"]);
    let failed = fails(
        "agent A { state x = 0  flow { x' = 1 }
           initial mode M { there: when x >= 0 -> N }  mode N { back: when x <= 1 -> M } }
         system { a = A() }  run { until 3 }",
        "HY0505",
    );
    failed.says(&["`x >= 0`: 0 on the left, 0 on the right"]);
    failed.says(&["the cycle: `A.there`, `A.back`"]);
}

#[test]
fn chattering_shows_the_rates_on_both_sides() {
    let failed = fails(
        "agent A { state x = 1, y = 0  flow { x' = if x > 0 then -1 else 2  y' = 3 } }
         system { a = A() }  run { until 3 }",
        "HY0507",
    );
    let sides = [failed.says(&["on one side"]), failed.says(&["on the other"])];
    assert!(sides.iter().any(|note| note.ends_with("x' = -1, y' = 3")), "{sides:?}");
    assert!(sides.iter().any(|note| note.ends_with("x' = 2, y' = 3")), "{sides:?}");
    let floor = fails(
        "agent A { state x = 0.5  flow { x' = if floor(x) >= 1 then -1 else 1 } }
         system { a = A() }  run { until 3 }",
        "HY0507",
    );
    assert_eq!(floor.notes(&["x' = "]).len(), 2);
}

#[test]
fn a_delay_that_is_no_time_names_what_made_it() {
    let failed = fails(
        "agent A { state x = 0  discrete d = -1  flow { x' = 1 }  later: after sqrt(d) { x := 0 } }
         system { a = A() }  run { until 3 }",
        "HY0510",
    );
    assert_eq!(failed.pointed_at[1], "sqrt(d)");
    failed.says(&["`sqrt(d)` is NaN, with `d` = -1"]);
}

#[test]
fn a_priority_that_is_no_number_names_what_made_it() {
    let failed = fails(
        "agent A { state x = 0  flow { x' = 1 }  go: when x >= 1 priority sqrt(0 - x) { x := 0 } }
         system { a = A() }  run { until 3 }",
        "HY0512",
    );
    assert_eq!(failed.pointed_at[1], "sqrt(0 - x)");
}

#[test]
fn too_many_steps_show_where_the_last_agent_is() {
    let limits = hyc::runtime::Limits { steps_max: 50, ..Default::default() };
    let text = "agent A { state x = 0  flow { x' = cos(100*time) } }  system { a = A() }  run { until 30 }";
    let (_, found) = Case::new(text).limits(limits).run_error();
    assert_eq!(found.code, "HY0508");
    assert!(found.notes[0].contains(": a: x = "), "{:?}", found.notes);
    assert!(found.notes[1].starts_with("the last steps of a: from t = "), "{:?}", found.notes);
}
