//! Rule 12: how a run ends, and where everybody is then.

use crate::harness::{Case, Ended, all_near, near, simulate, simulate_by_both_forms, simulate_error, words};
use hyc::runtime::limits::Limits;

#[test]
fn rule_12_events_at_exactly_the_end_are_included() {
    let run = simulate(
        "agent A { state x = 0  discrete n = 0  flow { x' = 1 }
                   tick: every 0.5 { n := n + 1 }
                   root: when x >= 2 { n := n + 100 }
                   after_it: when n >= 104 { n := n + 1000 } }
         system { a = A() }  run { until 2 }",
    );
    assert_eq!(run.end, Ended::Until);
    assert_eq!(run.time, 2.0);
    assert_eq!(run.value("a.n"), 1104.0);
    near(run.value("a.x"), 2.0, 1e-12);
    assert_eq!(run.agent("a").time, 2.0);
}

#[test]
fn rule_12_a_stop_action_with_its_reason() {
    let run = simulate(
        "agent A { state x = 0  flow { x' = 1 }  done: when x >= 2 { stop \"arrived\" } }
         agent B { state y = 0, z = 1  flow { y' = 3  z' = -z } }
         system { b = B()  a = A() }  run { until 10  tolerance 1e-10 }",
    );
    let Ended::Stop { reason, by } = &run.end else { panic!("{:?}", run.end) };
    assert_eq!(reason.as_deref(), Some("arrived"));
    assert!(by.contains("A.done"), "{by}");
    near(run.time, 2.0, 1e-11);
    // who had run ahead is at the end, too
    near(run.value("b.y"), 6.0, 1e-10);
    near(run.value("b.z"), (-2f64).exp(), 1e-9);
    assert!(run.finals.iter().all(|last| last.time == run.time));
    assert_eq!(run.log(), ["0 A.done a"]);
}

#[test]
fn rule_12_without_until_a_stop_is_enough() {
    let run = simulate(
        "agent A { state x = 0  flow { x' = 1 }  done: when x >= 2 { stop } }
         system { a = A() }  run { }",
    );
    near(run.time, 2.0, 1e-11);
}

#[test]
fn rule_12_a_state_that_grows_beyond_all_bounds_is_an_error() {
    // x = 1/(1 - t)
    let (run, _) =
        simulate_error("agent A { state x = 1  flow { x' = x^2 } }  system { a = A() }  run { until 2 }");
    near(run.time, 1.0, 1e-3);
}

#[test]
fn rule_12_a_flow_that_is_not_a_number_is_an_error() {
    // log x at x = 0, reached at t = 1
    let (run, found) = simulate_error(
        "agent A { state x = 1, y = 0  initial mode Deep { flow { x' = -1  y' = log(x) } } }
         system { a = A() }  run { until 2 }",
    );
    near(run.time, 1.0, 1e-3);
    let words = words(&[found]);
    assert!(words.contains('a') && words.contains("Deep"), "{words}");
}

#[test]
fn rule_12_a_reset_to_what_is_not_a_number_is_an_error() {
    let (run, _) = simulate_error(
        "agent A { state x = 1  flow { x' = -1 }  go: after 1.5 { x := sqrt(x) } }
         system { a = A() }  run { until 2 }",
    );
    assert_eq!(run.time, 1.5);
}

#[test]
fn rule_12_a_zeno_ball_ends_with_a_diagnostic() {
    let (run, found) = Case::shipped("bouncing_ball.hy").until(10.0).run_error();
    let limit = 9.0 * (2.0f64 / 9.81).sqrt();
    near(run.time, limit, 1e-5);
    let words = words(&[found]);
    assert!(words.contains("Ball.bounce") && words.contains("zeno_events"), "{words}");
    // the estimate of the limit
    assert!(words.contains("4.06"), "{limit} in\n{words}");
    assert!(run.value("ball.x") >= -1e-9);
}

#[test]
fn rule_12_every_never_counts_as_zeno() {
    let run = simulate(
        "agent A { discrete n = 0  tick: every 1e-11 { n := n + 1 } }
         system { a = A() }  run { until 3e-9 }",
    );
    near(run.value("a.n"), 300.0, 1.0);
}

#[test]
fn rule_12_many_quick_firings_at_a_steady_rate_are_not_zeno() {
    let run = simulate(
        "agent A { state x = 0  discrete n = 0  flow { x' = 1 }
                   go: when x >= 0.001 { x := 0  n := n + 1 } }
         system { a = A() }  run { until 2 }",
    );
    near(run.value("a.n"), 2000.0, 1.0);
}

#[test]
fn rule_12_the_limit_of_steps_has_a_name() {
    let case = Case::new(
        "agent A { state x = 0  flow { x' = sin(100*time) } }  system { a = A() }  run { until 100 }",
    );
    let (_, found) = case.limits(Limits { steps_max: 100, ..Limits::default() }).run_error();
    let words = words(&[found]);
    assert!(words.contains("max_steps"), "{words}");
}

#[test]
fn rule_12_a_stop_ends_at_its_instant() {
    // events of others at later times have not happened, however far they had been computed
    let run = simulate(
        "agent A { state x = 0  flow { x' = 1 }  done: when x >= 1.9 { stop } }
         agent B(k: real) { state y = 0  flow { y' = k }  go: when y >= 4 { y := 0 } }
         system { b = B[4](k = 1 + index)  a = A() }  run { until 10 }",
    );
    all_near(&run.times_of("B.go", "b[0]"), &[], 0.0);
    all_near(&run.times_of("B.go", "b[2]"), &[4.0 / 3.0], 1e-11);
    all_near(&run.times_of("B.go", "b[3]"), &[1.0], 1e-11);
    assert!(run.events.iter().all(|event| event.time <= run.time));
    near(run.value("b[0].y"), 1.9, 1e-11);
    near(run.value("b[2].y"), 1.7, 1e-10);
}

#[test]
fn rule_12_an_end_beyond_what_can_be_followed_says_so() {
    let (_, found) =
        simulate_error("agent A { state x = 0  flow { x' = 1 } }  system { a = A() }  run { until 1e300 }");
    assert_eq!(found.code, "HY0511");
    let told = words(&[found]);
    assert!(told.contains("longer than it can be followed") && told.contains("smaller `until`"), "{told}");
}

#[test]
fn rule_12_an_instant_in_which_births_never_end_is_an_error() {
    let (_, error) = simulate_error(
        "agent P(v: real) { state x = 0  discrete n: int = 0  flow { x' = v } }
         interaction I(a: P, b: P) {
           hit: when a.x >= b.x + 1 { destroy a  b.n := b.n + 1  create P(v = 10*a.v, x = a.x) } }
         system { p = P[3](v = index) }  run { until 2.05 }",
    );
    assert_eq!(error.code, "HY0530");
}

#[test]
fn rule_12_a_root_does_not_wait_for_what_comes_after_the_end() {
    let run = simulate_by_both_forms(
        "agent A { state x = 0  discrete n: int = 0  flow { x' = 1 }
           go: when x >= 1 - 2e-13 { n := n + 1 }  late: after 1 + 3e-13 { n := n + 10 } }
         system { a = A() }  run { until 1 }",
    );
    assert_eq!(run.log(), ["0 A.go a"]);
}
