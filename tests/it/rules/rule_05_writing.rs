//! Rule 5: an agent writes itself, an interaction its participants; pairs with and without order.

use crate::harness::{all_near, near, refused, simulate};

#[test]
fn rule_05_an_agent_writes_only_itself() {
    let words = refused(
        "agent A { state x = 0  flow { x' = 1 }  go: when exists o in other A: o.x >= 1 { o.x := 0 } }
         system { a = A()  b = A() }  run { until 2 }",
    );
    assert!(words.contains("interaction"), "{words}");
    refused(
        "agent A { link next: A  state x = 0  flow { x' = 1 }  go: when x >= 1 { next.x := 0 } }
         system { a = A()  b = A(next = a) }  run { until 2 }",
    );
}

#[test]
fn rule_05_a_guard_that_is_the_same_both_ways_has_one_flag_a_pair() {
    let guards = [
        "(a.x - b.x)^2 + (a.y - b.y)^2 <= 1",
        "1 >= (b.x - a.x)^2 + (b.y - a.y)^2",
        "(a.y - b.y)^2 + (b.x - a.x)^2 <= 1",
        "hypot(a.x - b.x, a.y - b.y) <= 1",
        "abs(a.x - b.x) <= 1 and abs(b.y - a.y) <= 1",
        "max(a.x, b.x) - min(b.x, a.x) <= 1",
        "near(a, b) <= 1",
    ];
    for guard in guards {
        let run = simulate(&format!(
            "fn near(p: A, q: A) = (p.x - q.x)^2 + (p.y - q.y)^2
             agent A(v: real) {{ state x, y = 0  discrete n = 0  flow {{ x' = v  y' = 0 }} }}
             interaction Meet(a: A, b: A) {{ pair: when {guard} {{ b.n := b.n + 1  a.n := a.n + 1 }} }}
             system {{ p = A(v = 1, x = 0)  q = A(v = -1, x = 4) }}  run {{ until 5 }}"
        ));
        assert_eq!(run.log(), ["0 Meet.pair p q"], "{guard}");
        all_near(&run.times("Meet.pair"), &[1.5], 1e-10);
        assert_eq!([run.value("p.n"), run.value("q.n")], [1.0, 1.0], "{guard}");
    }
}

#[test]
fn rule_05_a_guard_that_is_not_the_same_has_two_flags_a_pair() {
    let run = simulate(
        "agent A(v: real) { state x  discrete n = 0  flow { x' = v } }
         interaction Pass(a: A, b: A) { pair: when a.x >= b.x + 1 { a.n := a.n + 1 } }
         system { p = A(v = 1, x = 0)  q = A(v = 0, x = 3) }  run { until 6 }",
    );
    // at t = 0 q is ahead of p by more than 1, at t = 4 p is ahead of q
    assert_eq!(run.log(), ["0 Pass.pair q p", "0 Pass.pair p q"]);
    all_near(&run.times("Pass.pair"), &[0.0, 4.0], 1e-11);
}

#[test]
fn rule_05_actions_that_are_not_the_same_make_an_order_too() {
    let run = simulate(
        "agent A { state x = 0  discrete n = 0  flow { x' = 0 } }
         interaction Meet(a: A, b: A) { pair: when abs(a.x - b.x) <= 1 { a.n := a.n + 1 } }
         system { p = A()  q = A() }  run { until 1 }",
    );
    assert_eq!(run.log(), ["0 Meet.pair p q", "0 Meet.pair q p"]);
    assert_eq!([run.value("p.n"), run.value("q.n")], [1.0, 1.0]);
}

#[test]
fn rule_05_an_interaction_changes_modes() {
    let run = simulate(
        "agent A(v: real) { state x
           initial mode Go { flow { x' = v } }
           mode Wait { flow { x' = 0 }  entry { x := x + 100 }  resume: after 1 -> Go { x := x - 100 } } }
         interaction Meet(a: A, b: A) { pair: when abs(a.x - b.x) <= 1 { a -> Wait  b -> Wait } }
         system { p = A(v = 1, x = 0)  q = A(v = -1, x = 4) }  run { until 2 }",
    );
    assert_eq!(run.log(), ["0 Meet.pair p q Go->Wait", "0 Meet.pair q p Go->Wait"]);
    assert_eq!([run.mode("p"), run.mode("q")], ["Wait", "Wait"]);
    near(run.value("p.x"), 101.5, 1e-11);
}

#[test]
fn rule_05_an_interaction_moves_one_participant() {
    let run = simulate(
        "agent Ball { state x = 0  initial mode Roll { flow { x' = 1 } }  mode Stuck { flow { x' = 0 } } }
         agent Wall(at: real) { discrete hits = 0 }
         interaction Hit(b: Ball, w: Wall) { touch: when b.x >= w.at { b -> Stuck  b.x := w.at - 1  w.hits := w.hits + 1 } }
         system { w = Wall[2](at = 5 + index)  b = Ball[2]() }  run { until 8 }",
    );
    // both at 5, both write the same wall: one after the other
    assert_eq!(run.log(), ["0 Hit.touch b[0] w[0] Roll->Stuck", "1 Hit.touch b[1] w[0] Roll->Stuck"]);
    assert_eq!([run.value("w[0].hits"), run.value("w[1].hits")], [2.0, 0.0]);
    assert_eq!([run.value("b[0].x"), run.value("b[1].x")], [4.0, 4.0]);
}

#[test]
fn rule_05_a_symmetric_interaction_calls_the_lower_number_a() {
    let run = simulate(
        "agent A(at: real) { discrete n = 0 }
         interaction Meet(a: A, b: A) { pair: when time >= 1 and abs(a.at - b.at) <= 10 { } }
         system { p = A[3](at = -index) }  run { until 2 }",
    );
    let pairs: Vec<(String, String)> =
        run.events.iter().map(|e| (e.agent.clone(), e.other.clone())).collect();
    let expected = [("p[0]", "p[1]"), ("p[0]", "p[2]"), ("p[1]", "p[2]")];
    assert_eq!(pairs, expected.map(|(a, b)| (a.to_string(), b.to_string())));
}

#[test]
fn rule_05_two_interactions_on_one_agent_go_in_order_and_are_reported_once() {
    // three meet at one point: q takes part twice; the second pair is tested again on the new state
    let run = simulate(
        "agent A(v: real) { state x  discrete free: bool = true  flow { x' = v } }
         interaction Take(a: A, b: A) {
           pair: when abs(a.x - b.x) <= 1 and a.free and b.free { a.free := false  b.free := false }
         }
         system { p = A(v = 1, x = -3)  q = A(v = 0, x = 0)  r = A(v = -1, x = 3) }  run { until 2.25 }",
    );
    assert_eq!(run.log(), ["0 Take.pair p q"]);
    assert_eq!(run.value("r.free"), 1.0);
    assert!(!run.warnings.is_empty(), "two interactions on one agent in one instant are worth a word");
}

#[test]
fn rule_05_both_right_hand_sides_of_an_interaction_read_the_state_before() {
    let run = simulate(
        "agent A { state x  flow { x' = 0 } }
         interaction Swap(a: A, b: A) { pair: when time >= 1 and abs(a.x - b.x) <= 10 { a.x := b.x  b.x := a.x } }
         system { p = A(x = 1)  q = A(x = 2) }  run { until 2 }",
    );
    assert_eq!([run.value("p.x"), run.value("q.x")], [2.0, 1.0]);
    assert_eq!(run.log(), ["0 Swap.pair p q"]);
}

#[test]
fn rule_05_an_interaction_is_between_two_and_hears_nothing() {
    let of = |pars: &str| {
        let text = format!(
            "agent A {{ event e  state x = 0  flow {{ x' = 1 }} }}
             interaction Touch({pars}) {{ touch: when time >= 1 {{ a.x := 0 }} }}"
        );
        refused(&text)
    };
    assert!(of("a: A").contains("HY0206"), "{}", of("a: A"));
    assert!(of("a: A, b: A, c: A").contains("two participants, not 3"), "{}", of("a: A, b: A, c: A"));
    let told = refused(
        "agent A { event e  state x = 0  flow { x' = 1 }  every 1 { emit e } }
         interaction Touch(a: A, b: A) { on e { a.x := 0 } }",
    );
    assert!(told.contains("HY0218") && told.contains("`on` belongs to an agent"), "{told}");
}
