//! Rule 8: invariants are the domain of the flow, asserts claims about the model.

use std::f64::consts::PI;

use crate::harness::{all_near, near, simulate, simulate_error, words};

#[test]
fn rule_08_a_false_invariant_ends_the_run_and_is_named() {
    let (run, found) = simulate_error(
        "agent A { state x = 2
           initial mode Down { flow { x' = -1 }  invariant x >= 0 \"below the floor\" } }
         system { p = A(x = 5)  q = A() }  run { until 4 }",
    );
    near(run.time, 2.0, 1e-10);
    let words = words(&[found]);
    assert!(["q", "Down", "below the floor"].iter().all(|word| words.contains(word)), "{words}");
    near(run.value("p.x"), 3.0, 1e-9);
}

#[test]
fn rule_08_a_transition_that_leaves_the_mode_saves_it() {
    for guard in ["x >= 1", "x > 1"] {
        let run = simulate(&format!(
            "agent A {{ state x = 0
               initial mode Up {{ flow {{ x' = 1 }}  invariant x <= 1  go: when {guard} -> Down }}
               mode Down {{ flow {{ x' = -1 }} }} }}
             system {{ a = A() }}  run {{ until 3 }}"
        ));
        near(run.value("a.x"), -1.0, 1e-10);
    }
}

#[test]
fn rule_08_on_the_boundary_it_is_false_only_if_the_flow_leads_out() {
    let run = simulate(
        "agent Ball { state x = 0.5, v = 0  flow { x' = v  v' = -1 }
           invariant x >= 0
           bounce: when x <= 0 { v := -v } }
         system { ball = Ball() }  run { until 10 }",
    );
    all_near(&run.times("Ball.bounce"), &[1.0, 3.0, 5.0, 7.0, 9.0], 1e-10);
    let (run, _) = simulate_error(
        "agent Ball { state x = 0.5, v = 0  flow { x' = v  v' = -1 }
           invariant x >= 0
           bounce: when x <= 0 { v := 0.5*v } }
         system { ball = Ball() }  run { until 10 }",
    );
    near(run.time, 1.0, 1e-10);
    assert_eq!(run.times("Ball.bounce").len(), 1);
}

#[test]
fn rule_08_what_stops_on_the_boundary_of_an_invariant_is_on_it() {
    // The new flow has no rate; by rounding some of them are on either side.
    for (go, domain) in
        [("when x <= 0", "x >= 0"), ("when x <= 0", "x <= 0"), ("after 2", "x >= 0"), ("after 2", "x <= 0")]
    {
        let run = simulate(&format!(
            "agent A(k: real) {{ state x = 0.2*k
               initial mode Go {{ flow {{ x' = -0.1*k }}  halt: {go} -> Stand }}
               mode Stand {{ flow {{ x' = 0 }}  invariant {domain} }} }}
             system {{ a = A[12](k = 0.7 + 0.3*index) }}  run {{ until 3 }}"
        ));
        assert_eq!(run.events.len(), 12, "{go}, {domain}");
        near(run.time, 3.0, 0.0);
    }
    // Whatever else is written, at a kink of the flow, and where the root waits for a schedule.
    let more = [
        (
            "state x = 1/k, v = -k",
            "flow { x' = v  v' = 0 }",
            "-> Stand { v := 0 }",
            "flow { x' = v  v' = 0 }",
        ),
        ("state x = 1/k", "flow { x' = -k - 0.3*abs(x) }", "-> Stand", "flow { x' = 0 }"),
        (
            "state x = 1/k, y = 0",
            "flow { x' = -k  y' = 1 }",
            "-> Stand { y := 0 }",
            "flow { x' = 0  y' = x }",
        ),
    ];
    for (states, flow, go, rest) in more {
        let run = simulate(&format!(
            "agent A(k: real) {{ {states}
               initial mode Go {{ {flow}  halt: when x <= 0 {go} }}
               mode Stand {{ {rest}  invariant x >= 0 }} }}
             system {{ a = A[40](k = 0.37 + 0.013*index) }}  run {{ until 10 }}"
        ));
        assert_eq!((run.events.len(), run.time), (40, 10.0), "{states}");
    }
    let run = simulate(
        "agent A { state x = 1  discrete n: int = 0
           initial mode Go { flow { x' = -1 }  halt: when x <= 0 -> Stand { n := 1 } }
           mode Stand { flow { x' = 0 }  invariant x >= 0 } }
         agent S(a: A) { discrete m: int = 0  t: after 1 + 6e-13 { m := a.n } }
         system { a = A()  s = S(a = a) }  run { until 3 }",
    );
    assert_eq!(run.log(), ["0 S.t s", "0 A.halt a Go->Stand"]);
    // What is written there is not.
    let (run, _) = simulate_error(
        "agent A { state x = 0.2
           initial mode Go { flow { x' = -0.1 }  halt: when x <= 0 -> Stand { x := -1e-15 } }
           mode Stand { flow { x' = 0 }  invariant x >= 0 } }
         system { a = A() }  run { until 3 }",
    );
    near(run.time, 2.0, 1e-12);
}

#[test]
fn rule_08_an_invariant_is_of_its_mode() {
    let run = simulate(
        "agent A { state x = 0
           initial mode Low { flow { x' = 1 }  invariant x <= 1  go: when x >= 1 -> High }
           mode High { flow { x' = 1 }  invariant x >= 1 } }
         system { a = A() }  run { until 3 }",
    );
    near(run.value("a.x"), 3.0, 1e-11);
}

#[test]
fn rule_08_a_reset_can_break_an_invariant() {
    let (run, _) = simulate_error(
        "agent A { state x = 1  flow { x' = 0 }  invariant x >= 0  tick: after 1.5 { x := -1 } }
         system { a = A() }  run { until 4 }",
    );
    assert_eq!(run.time, 1.5);
}

#[test]
fn rule_08_an_invariant_over_another_agent() {
    let (run, _) = simulate_error(
        "agent A(v: real) { link lead: A  state x  flow { x' = v }
           invariant not lead or lead.x > x }
         system { a = A(v = 1, x = 3)  b = A(v = 2, x = 0, lead = a) }  run { until 10 }",
    );
    near(run.time, 3.0, 1e-10);
}

#[test]
fn rule_08_an_assert_never_changes_the_run() {
    // x = sin t is above 1/2 on [pi/6, 5 pi/6] and [13 pi/6, 17 pi/6]
    let text = |assert: &str| {
        format!(
            "agent A {{ state x = 0  flow {{ x' = cos(time) }}  {assert}  low: when x <= -0.5 {{ }} }}
             system {{ a = A() }}  run {{ until 10  tolerance 1e-10 }}"
        )
    };
    let run = simulate(&text("assert x <= 0.5 \"too high\""));
    let without = simulate(&text(""));
    assert_eq!(run.bits(), without.bits());
    let [found] = run.false_asserts.as_slice() else { panic!("{:?}", run.false_asserts) };
    near(found.time, PI / 6.0, 1e-8);
    assert_eq!(found.message.as_deref(), Some("too high"));
    assert_eq!(found.count, 2);
}

#[test]
fn rule_08_an_assert_of_a_moment() {
    // false for a moment between two micro-steps is not false: claims are about the end of the instant
    let run = simulate(
        "agent A { discrete n = 0
           assert n == 0
           up: after 1 { n := 1 }
           down: when n == 1 { n := 0 } }
         system { a = A() }  run { until 2 }",
    );
    assert_eq!(run.log(), ["0 A.up a", "1 A.down a"]);
    assert!(run.false_asserts.is_empty(), "{:?}", run.false_asserts);
    // a guard of flows that dips for 1e-3 is found
    let run = simulate(
        "agent A { state x = 0  flow { x' = 1 }  assert (x - 1)*(x - 1.001) >= 0 }
         system { a = A() }  run { until 2 }",
    );
    assert_eq!(run.false_asserts.len(), 1);
    near(run.false_asserts[0].time, 1.0, 1e-10);
}

#[test]
fn rule_08_a_true_assert_that_touches() {
    let run = simulate(
        "agent A { state x = 0  flow { x' = 1 }  assert (x - 1)^2 >= 0  assert x >= 0 }
         system { a = A() }  run { until 2 }",
    );
    assert!(run.false_asserts.is_empty(), "{:?}", run.false_asserts);
}

#[test]
fn rule_08_an_invariant_is_left_faster_than_time_resolves() {
    for rate in ["1e13", "1e100", "1e300"] {
        let text = format!(
            "agent A {{ state x = 0  flow {{ x' = {rate} }}  invariant x <= 0.5 }}\nsystem {{ a = A() }}\nrun {{ until 1 }}"
        );
        let (run, found) = simulate_error(&text);
        assert_eq!(found.code, "HY0501");
        near(run.time, 0.0, 1e-12);
    }
}
