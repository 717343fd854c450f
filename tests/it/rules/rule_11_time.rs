//! Rule 11: `after` and `every`.

use crate::harness::{all_near, both_forms, simulate};

#[test]
fn rule_11_after_counts_from_entry() {
    let run = simulate(
        "agent A {
           initial mode M { go: after 1 -> N }
           mode N { back: after 0.5 -> M } }
         system { a = A() }  run { until 4 }",
    );
    all_near(&run.times("A.go"), &[1.0, 2.5, 4.0], 1e-15);
    all_near(&run.times("A.back"), &[1.5, 3.0], 1e-15);
}

#[test]
fn rule_11_the_delay_is_read_at_entry() {
    let run = simulate(
        "agent A { discrete d = 2
           initial mode M { shorten: after 1 { d := 0.1 }  go: after d -> N }
           mode N { entry { d := 0.25 }  rest: after d { } } }
         system { a = A() }  run { until 4 }",
    );
    assert_eq!(run.times("A.go"), [2.0]);
    // read at entry, after the entry actions
    all_near(&run.times("A.rest"), &[2.25], 1e-15);
}

#[test]
fn rule_11_after_when_is_a_condition_with_a_flag() {
    let text = |guard: &str| {
        format!(
            "agent A {{ state x = 0  discrete n = 0  flow {{ x' = 1 }}  go: after 2 when {guard} {{ n := n + 1 }} }}
             system {{ a = A() }}  run {{ until 6 }}"
        )
    };
    all_near(&simulate(&text("x >= 1")).times("A.go"), &[2.0], 1e-15);
    all_near(&simulate(&text("x >= 3")).times("A.go"), &[3.0], 1e-11);
    all_near(&simulate(&text("x <= 1")).times("A.go"), &[], 0.0);
    // true on [1, 3] and from 4 on: fires at 2, and again at 4
    all_near(&simulate(&text("(x - 1)*(x - 3)*(x - 4) >= 0")).times("A.go"), &[2.0, 4.0], 1e-11);
}

#[test]
fn rule_11_after_fires_once_an_entry() {
    let run = simulate(
        "agent A { discrete n = 0  go: after 1 { n := n + 1 } }
         system { a = A() }  run { until 6 }",
    );
    assert_eq!(run.times("A.go"), [1.0]);
}

#[test]
fn rule_11_every_without_drift() {
    // ten thousand periods: each at exactly k d
    let run = simulate(
        "agent A { discrete n: int = 0  tick: every 0.1 { n := n + 1 } }
         system { a = A() }  run { until 1000 }",
    );
    let times = run.times("A.tick");
    assert_eq!(times.len(), 10_000);
    for (k, time) in times.iter().enumerate() {
        assert_eq!(*time, (k + 1) as f64 * 0.1);
    }
    assert_eq!(run.value("a.n"), 10_000.0);
}

#[test]
fn rule_11_every_counts_from_entry_and_ends_with_the_mode() {
    let run = simulate(
        "agent A { state x = 0  flow { x' = 1 }
           initial mode M { go: when x >= 0.5 -> N }
           mode N { tick: every 0.25 { }  out: when x >= 1.6 -> O }
           mode O { } }
         system { a = A() }  run { until 4 }",
    );
    all_near(&run.times("A.tick"), &[0.75, 1.0, 1.25, 1.5], 1e-11);
}

#[test]
fn rule_11_every_with_a_target_starts_again() {
    let run = simulate(
        "agent A { state x = 0  flow { x' = 1 }
           initial mode M { tick: every 0.75 -> M { x := 0 } } }
         system { a = A() }  run { until 3 }",
    );
    all_near(&run.times("A.tick"), &[0.75, 1.5, 2.25, 3.0], 1e-15);
}

#[test]
fn rule_11_every_when_fires_at_those_instants_without_a_flag() {
    let run = simulate(
        "agent A { state x = 0  flow { x' = 1 }  tick: every 1 when x >= 2.5 { } }
         system { a = A() }  run { until 5 }",
    );
    assert_eq!(run.times("A.tick"), [3.0, 4.0, 5.0]);
    let run = simulate(
        "agent A { state x = 0  flow { x' = 1 }  tick: every 1 when x >= 2.5 or x <= 1.5 { } }
         system { a = A() }  run { until 5 }",
    );
    assert_eq!(run.times("A.tick"), [1.0, 3.0, 4.0, 5.0]);
}

#[test]
fn rule_11_every_when_the_guard_has_its_root_at_the_tick() {
    // x reaches 3 at the third tick: a root that near a scheduled time joins it
    let run = simulate(
        "agent A { state x = 0  flow { x' = 1 }  tick: every 1 when x >= 3 { } }
         system { a = A() }  run { until 5 }",
    );
    assert_eq!(run.times("A.tick"), [3.0, 4.0, 5.0]);
}

#[test]
fn rule_11_two_clocks_meet_exactly() {
    // every second tick of the one is a tick of the other: one instant, in the order of declaration
    let run = simulate(
        "agent A { discrete n = 0  fast: every 0.25 { n := n + 1 }  slow: every 0.5 { n := 10*n } }
         system { a = A() }  run { until 1 }",
    );
    assert_eq!(
        run.log(),
        ["0 A.fast a", "0 A.fast a", "1 A.slow a", "0 A.fast a", "0 A.fast a", "1 A.slow a"]
    );
    assert_eq!(run.value("a.n"), 220.0);
}

#[test]
fn rule_11_a_scheduled_time_within_rounding_of_the_end_is_the_end() {
    let run = simulate(
        "agent A { discrete n: int = 0  tick: every 0.1 { n := n + 1 } }
         system { a = A() }  run { until 0.3 }",
    );
    // 3*0.1 is 0.30000000000000004
    assert_eq!(run.value("a.n"), 3.0);
    assert_eq!(run.times("A.tick"), [0.1, 0.2, 0.3]);
    assert_eq!(run.time, 0.3);
}

#[test]
fn rule_11_zero_delay() {
    let run = simulate(
        "agent A {
           initial mode M { go: after 0 -> N }
           mode N { } }
         system { a = A() }  run { until 1 }",
    );
    assert_eq!(run.times("A.go"), [0.0]);
}

/// The pairs of an interaction have clocks of their own: from t = 0, or from when the younger has come to be.
#[test]
fn rule_11_timers_of_interactions() {
    let text = "agent A(late: bool) { state x = 3*index  discrete n: int = 0, met: int = 0
                   flow { x' = 0 }  after 0.5 when late { create A(late = false, x = 1) } }
                 interaction Pair(a: A, b: A) {
                   tick: every 1 when abs(a.x - b.x) <= 2 { a.n := a.n + 1  b.n := b.n + 1 }
                   done: after 2 { a.met := a.met + 1  b.met := b.met + 1 } }
                 system { a = A[2](late = index == 0) }  run { until 3 }";
    for run in both_forms(text) {
        // Only the third is near both; it came at 0.5.
        assert_eq!(run.times("Pair.tick"), [1.5, 1.5, 2.5, 2.5]);
        assert_eq!(run.times("Pair.done"), [2.0, 2.5, 2.5]);
        assert_eq!((run.value("a[0].n"), run.value("a[1].n"), run.value("A#2.n")), (2.0, 2.0, 4.0));
        assert_eq!(run.value("A#2.met"), 2.0);
    }
}

/// A delay that is not the same when the two change places makes a flag for each ordered pair.
#[test]
fn rule_11_a_delay_of_one_participant() {
    let run = simulate(
        "agent A(d: real) { discrete n: int = 0 }
         interaction Pair(a: A, b: A) { late: after a.d when b.n < 5 { a.n := a.n + 1 } }
         system { a = A[3](d = index + 1) }  run { until 5 }",
    );
    assert_eq!(run.times("Pair.late"), [1.0, 1.0, 2.0, 2.0, 3.0, 3.0]);
    assert_eq!(run.times_of("Pair.late", "a[2]"), [3.0, 3.0]);
}
