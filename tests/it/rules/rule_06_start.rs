//! Rule 6: what happens at t = 0, in order.

use crate::harness::{near, simulate, simulate_error};

#[test]
fn rule_06_entry_actions_then_micro_steps() {
    let run = simulate(
        "agent A(k: real) { state x = k  discrete n = 0
           flow { x' = 1 }
           initial mode M { entry { x := 2*x }  go: when x >= 4 -> N }
           mode N { entry { n := x } } }
         system { a = A(k = 2)  b = A(k = 1) }  run { until 1 }",
    );
    assert_eq!(run.log(), ["0 A.go a M->N"]);
    assert_eq!(run.value("a.n"), 4.0);
    near(run.value("b.x"), 3.0, 1e-12);
}

#[test]
fn rule_06_links_before_entry_actions() {
    let run = simulate(
        "agent A(k: real) { link next: A  discrete n = 0
           initial mode M { entry { n := if next then next.k else -1 } } }
         system { a = A(k = 1, next = b)  b = A(k = 2) }  run { until 1 }",
    );
    assert_eq!([run.value("a.n"), run.value("b.n")], [2.0, -1.0]);
}

#[test]
fn rule_06_invariants_and_asserts_after_the_micro_steps() {
    let run = simulate(
        "agent A { state x = -1  flow { x' = 1 }
           invariant x >= 0
           assert x >= 0
           mend: when x < 0 { x := 0 } }
         system { a = A() }  run { until 1 }",
    );
    near(run.value("a.x"), 1.0, 1e-12);
    assert!(run.false_asserts.is_empty());
    let (run, _) = simulate_error(
        "agent A { state x = -1  flow { x' = 1 }  invariant x >= 0 }
         system { a = A() }  run { until 1 }",
    );
    assert_eq!(run.time, 0.0);
}

#[test]
fn rule_06_agents_in_system_order() {
    let run = simulate(
        "agent A { go: when time >= 0 { } }
         agent B { go: when time >= 0 { } }
         system { z = B()  a = A[2]()  y = B() }  run { until 1 }",
    );
    // independent agents: instants of their own at the same time, in the order of transitions, then of agents
    let agents: Vec<&str> = run.events.iter().map(|event| event.agent.as_str()).collect();
    assert_eq!(agents, ["a[0]", "a[1]", "z", "y"]);
    let finals: Vec<&str> = run.finals.iter().map(|last| last.agent.as_str()).collect();
    assert_eq!(finals, ["z", "a[0]", "a[1]", "y"]);
}

#[test]
fn rule_06_a_sample_at_zero_comes_after_its_micro_steps() {
    let run = simulate(
        "agent A { state x = 1  flow { x' = 0 }  go: when x >= 1 { x := 5 } }
         system { a = A() }  run { until 1  record a.x every 1 to \"a.csv\" }",
    );
    assert_eq!(run.column("a", 0), [(0.0, 5.0), (1.0, 5.0)]);
    assert_eq!(run.samples[0][0].micro, 1);
}
