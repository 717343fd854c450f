//! Rule 9: messages are seen in the next micro-step, one for each agent at a time, in the order of their senders.

use crate::harness::{Ended, all_near, refused, simulate_by_both_forms, simulate_error};

#[test]
fn rule_09_what_is_emitted_is_seen_in_the_next_micro_step() {
    let run = simulate_by_both_forms(
        "agent A { event ping  state x = 0  flow { x' = 1 }  go: when x >= 1 { emit ping } }
         agent B { discrete n: int = 0
           hear: on ping { n := n + 1 }
           after_that: when n >= 1 { } }
         system { a = A()  b = B()  c = B() }  run { until 3 }",
    );
    assert_eq!(
        run.log(),
        ["0 A.go a", "1 B.hear b a", "1 B.hear c a", "2 B.after_that b", "2 B.after_that c"]
    );
    all_near(&run.times("B.after_that"), &[1.0, 1.0], 1e-12);
}

#[test]
fn rule_09_messages_come_one_a_micro_step_in_the_order_of_their_senders() {
    // whatever the order in which they are emitted: the priorities turn it round
    let run = simulate_by_both_forms(
        "agent A(p: int) { event ping(n: int)  state x = 0  flow { x' = 1 }
           go: when x >= 1 priority p { emit ping(p) } }
         agent B { discrete last: int = 0, all: int = 0
           hear: on ping(n) { last := n  all := 10*all + n } }
         system { b = B()  s = A[3](p = index + 1) }  run { until 3 }",
    );
    assert_eq!(
        run.log(),
        [
            "0 A.go s[2]",
            "0 A.go s[1]",
            "0 A.go s[0]",
            "1 B.hear b s[0]",
            "2 B.hear b s[1]",
            "3 B.hear b s[2]"
        ]
    );
    assert_eq!(run.value("b.all"), 123.0);
}

#[test]
fn rule_09_two_messages_of_one_sender_come_as_they_were_emitted() {
    let run = simulate_by_both_forms(
        "agent A { event e(n: int)  event f(n: int)
           initial mode M { exit { emit e(1) }  go: after 1 -> N { emit f(2)  emit e(3) } }
           mode N { entry { emit e(4) } } }
         agent B { discrete all: int = 0
           one: on e(n) { all := 10*all + n }  two: on f(n) { all := 10*all + n } }
         system { b = B()  a = A() }  run { until 3 }",
    );
    assert_eq!(run.log(), ["0 A.go a M->N", "1 B.one b a", "2 B.two b a", "3 B.one b a", "4 B.one b a"]);
    assert_eq!(run.value("b.all"), 1234.0);
}

#[test]
fn rule_09_exit_and_transition_read_the_state_before_and_entry_what_they_wrote() {
    let run = simulate_by_both_forms(
        "agent A { event e(n: int)  discrete k: int = 1
           initial mode M { exit { emit e(k)  k := k + 10 }  go: after 1 -> N { emit e(k + 1) } }
           mode N { entry { emit e(k + 2) } } }
         agent B { discrete all: int = 0  on e(n) { all := 100*all + n } }
         system { b = B()  a = A() }  run { until 3 }",
    );
    assert_eq!(run.value("b.all"), 10213.0);
}

#[test]
fn rule_09_a_message_is_missed_only_if_nothing_is_enabled_at_its_turn() {
    // the first message takes b out of the mode that hears; the second is missed; the third is heard where it has come to
    let run = simulate_by_both_forms(
        "agent A(k: int) { event e(n: int)  go: after 1 { emit e(k) } }
         agent B { discrete heard: int = 0
           initial mode M { on e(n) -> N { heard := n } }
           mode N { on e(n) when n == 3 -> O { heard := 10*heard + n } }
           mode O { on e(n) { heard := 100*heard + n } } }
         system { s = A[4](k = index + 1)  b = B() }  run { until 3 }",
    );
    let expected = ["0 A.go s[0]", "0 A.go s[1]", "0 A.go s[2]", "0 A.go s[3]"];
    assert_eq!(run.log()[..4], expected);
    // the turn of s[1] is micro-step 2, in which nothing fires
    assert_eq!(run.log()[4..], ["1 B.M->N b s[0] M->N", "3 B.N->O b s[2] N->O", "4 B.O#1 b s[3]"]);
    assert_eq!(run.value("b.heard"), 1304.0);
}

#[test]
fn rule_09_one_message_does_not_run_through_the_modes() {
    let run = simulate_by_both_forms(
        "agent Hand { event press  every 1 { emit press } }
         agent Lamp { initial mode Off { on press -> On }  mode On { on press -> Off } }
         system { hand = Hand()  lamp = Lamp() }  run { until 3.5 }",
    );
    let log: Vec<String> = run.log().into_iter().filter(|line| line.contains("Lamp")).collect();
    let pressed = ["1 Lamp.Off->On lamp hand Off->On", "1 Lamp.On->Off lamp hand On->Off"];
    assert_eq!(log, [pressed[0], pressed[1], pressed[0]]);
}

#[test]
fn rule_09_what_is_passed_over_is_not_missed() {
    // at the turn of the message a transition of higher priority takes the region; the message is heard after it
    let run = simulate_by_both_forms(
        "agent A { event e  go: after 1 { emit e } }
         agent B { discrete n: int = 0, k: int = 0
           hear: on e { n := n + 1 }
           first: after 1 priority 5 { k := 1 }
           urgent: when k == 1 priority 9 { k := 2 } }
         system { a = A()  b = B() }  run { until 3 }",
    );
    assert_eq!(run.log(), ["0 B.first b", "0 A.go a", "1 B.urgent b", "2 B.hear b a"]);
}

#[test]
fn rule_09_a_message_waits_while_it_is_passed_over() {
    // the higher one takes b to N in which nothing is enabled but another `on`: that hears it
    let run = simulate_by_both_forms(
        "agent A { event e  go: after 1 { emit e } }
         agent B { discrete k: int = 0
           initial mode M { hear: on e { k := k + 1 }  first: after 1 { k := 10 }  urgent: when k == 10 priority 1 -> N }
           mode N { too: on e { k := k + 100 } } }
         system { b = B()  a = A() }  run { until 3 }",
    );
    assert_eq!(run.log(), ["0 A.go a", "0 B.first b", "1 B.urgent b M->N", "2 B.too b a"]);
}

#[test]
fn rule_09_every_on_that_is_enabled_fires_by_one_message_before_the_next_comes() {
    let run = simulate_by_both_forms(
        "agent A(k: int) { event e(n: int)  go: after 1 { emit e(k) } }
         agent B { discrete a: int = 0, b: int = 0
           first: on e(n) when n <= 2 { a := 10*a + n }
           second: on e(n) when n >= 2 priority 1 { b := 10*b + n } }
         system { s = A[3](k = index + 1)  b = B() }  run { until 3 }",
    );
    let heard = ["1 B.first b s[0]", "2 B.second b s[1]", "3 B.first b s[1]", "4 B.second b s[2]"];
    assert_eq!(run.log()[3..], heard);
    assert_eq!([run.value("b.a"), run.value("b.b")], [12.0, 23.0]);
}

#[test]
fn rule_09_an_agent_does_not_hear_itself_unless_it_says_so() {
    let text = |from: &str| {
        format!(
            "agent A {{ event e  link next: A  discrete n: int = 0  go: after 1 {{ emit e }}  hear: on e {from} {{ n := n + 1 }} }}
             system {{ a = A(next = a)  b = A(next = a) }}  run {{ until 2 }}"
        )
    };
    // each hears the other
    let run = simulate_by_both_forms(&text(""));
    assert_eq!(run.log()[2..], ["1 A.hear a b", "1 A.hear b a"]);
    // each hears itself
    let run = simulate_by_both_forms(&text("from self"));
    assert_eq!(run.log()[2..], ["1 A.hear a a", "1 A.hear b b"]);
    // a link to oneself is not `self`
    let run = simulate_by_both_forms(&text("from next"));
    assert_eq!(run.log()[2..], ["1 A.hear b a"]);
}

#[test]
fn rule_09_from_whom() {
    let run = simulate_by_both_forms(
        "agent Car { event brake(v: real)  link lead: Car  discrete heard: real = 0
           initial mode Drive {
             panic: after 1 when not lead -> Brake
             light: on brake(v) from lead when v > 0.5 -> Brake { heard := v } }
           mode Brake { entry { emit brake(heard + 1) } } }
         system { c = Car[4](lead = if index >= 1 then c[index - 1] else none) }  run { until 3 }",
    );
    let log = [
        "0 Car.panic c[0] Drive->Brake",
        "1 Car.light c[1] c[0] Drive->Brake",
        "2 Car.light c[2] c[1] Drive->Brake",
        "3 Car.light c[3] c[2] Drive->Brake",
    ];
    assert_eq!(run.log(), log);
    assert_eq!(run.value("c[3].heard"), 3.0);
}

#[test]
fn rule_09_a_message_from_someone_else_takes_no_turn() {
    // b listens to s[2] only: it hears it in the next micro-step, whoever else emits
    let run = simulate_by_both_forms(
        "agent A { event e  go: after 1 { emit e } }
         agent B(whom: A) { on e from whom { } }
         system { s = A[3]()  b = B(whom = s[2]) }  run { until 3 }",
    );
    assert_eq!(run.log()[3..], ["1 B.*#1 b s[2]"]);
}

#[test]
fn rule_09_without_from_all_types_with_the_event_are_heard() {
    let run = simulate_by_both_forms(
        "agent A { event e(n: int)  after 1 { emit e(1) } }
         agent B { event e(n: int)  after 2 { emit e(2) } }
         agent C { discrete all: int = 0  hear: on e(n) { all := 10*all + n } }
         system { a = A()  b = B()  c = C() }  run { until 3 }",
    );
    assert_eq!(run.times("C.hear"), [1.0, 2.0]);
    assert_eq!(run.value("c.all"), 12.0);
    let words = refused(
        "agent A { event e(n: int)  after 1 { emit e(1) } }
         agent B { event e(n: bool)  after 2 { emit e(true) } }
         agent C { discrete k = 0  hear: on e { k := 1 } }
         system { a = A()  b = B()  c = C() }  run { until 3 }",
    );
    assert!(words.contains("HY0237"), "{words}");
}

#[test]
fn rule_09_a_delayed_message_is_seen_first_thing_then() {
    let run = simulate_by_both_forms(
        "agent A { event e(n: int)  discrete k: int = 0
           tick: every 1 when k < 3 { k := k + 1  emit e(k + 1) after 2.5  emit e(10*(k + 1)) after 0 [s] } }
         agent B { discrete all: int = 0  hear: on e(n) { all := all + n } }
         system { a = A()  b = B() }  run { until 6 }",
    );
    assert_eq!(run.times("B.hear"), [1.0, 2.0, 3.0, 3.5, 4.5, 5.5]);
    let micro: Vec<usize> =
        run.events.iter().filter(|event| event.transition == "B.hear").map(|event| event.micro).collect();
    assert_eq!(micro, [1, 1, 1, 0, 0, 0]);
    assert_eq!(run.value("b.all"), 66.0);
}

#[test]
fn rule_09_any_number_of_messages_is_under_way_and_those_due_together_come_in_order() {
    // sent one after the other, later ones with shorter delays: all arrive at 2
    let run = simulate_by_both_forms(
        "agent A(k: int) { event e(n: int)  go: after 0.25*k { emit e(k) after 2 - 0.25*k } }
         agent B { discrete all: int = 0  hear: on e(n) { all := 10*all + n } }
         system { b = B()  s = A[4](k = 4 - index) }  run { until 3 }",
    );
    all_near(&run.times("B.hear"), &[2.0; 4], 0.0);
    // by senders: s[0] has k = 4
    assert_eq!(run.value("b.all"), 4321.0);
}

#[test]
fn rule_09_values_are_those_of_the_sender_when_it_emits() {
    let run = simulate_by_both_forms(
        "agent A { event e(x: real)  state x = 0  flow { x' = 1 }  go: when x >= 1 { emit e(x) after 2 } }
         agent B { link whom: A  discrete was = 0, now = 0  hear: on e(x) from whom { was := x  now := whom.x } }
         system { a = A()  b = B(whom = a) }  run { until 4 }",
    );
    all_near(&[run.value("b.was"), run.value("b.now")], &[1.0, 3.0], 1e-11);
}

#[test]
fn rule_09_a_condition_on_its_boundary_when_a_message_comes_is_true() {
    // x is 1, and falls below or rises above it, exactly when the message comes
    for (guard, rate, fires) in [
        ("x >= 1", 1.0, true),
        ("x > 1", 1.0, true),
        ("x <= 1", 1.0, true),
        ("x < 1", 1.0, false),
        ("x < 1", -1.0, true),
        ("x - 1 >= 1e-9", 1.0, false),
        ("x >= 1 and x <= 1", 1.0, true),
        ("x > 1 and x < 1", 1.0, false),
    ] {
        let start = 1.0 - 0.3 * rate;
        let run = simulate_by_both_forms(&format!(
            "agent A {{ event e  go: after 0.1 {{ emit e after 0.2 }} }}
             agent B {{ state x = {start}  flow {{ x' = {rate} }}  hear: on e when {guard} {{ }} }}
             system {{ a = A()  b = B() }}  run {{ until 1 }}"
        ));
        assert_eq!(run.times("B.hear").len(), usize::from(fires), "{guard} {rate}");
    }
}

#[test]
fn rule_09_whom_an_exists_binds_is_known_to_the_actions() {
    let run = simulate_by_both_forms(
        "agent A { event e(w: real)  state x = 0  flow { x' = 1 }  go: when x >= 2 { emit e(0.5) } }
         agent C(x0: real) { state x = x0  flow { x' = 0.25 } }
         agent B { discrete seen = 0
           hear: on e(w) when exists c in C: c.x >= w { seen := c.x } }
         system { cs = C[3](x0 = 0.25*(index - 2))  a = A()  b = B() }  run { until 3 }",
    );
    // at 2 they are at 0, 0.25, 0.5
    assert_eq!(run.times("B.hear").len(), 1);
    all_near(&[run.value("b.seen")], &[0.5], 1e-11);
}

#[test]
fn rule_09_interactions_let_their_participants_emit() {
    let run = simulate_by_both_forms(
        "agent A(v: real) { event bump(speed: real [m/s])  state x = 0  discrete felt: real = 0
           flow { x' = v }
           mine: on bump(s) from self { felt := s }
           theirs: on bump(s) { felt := felt + 10*s } }
         interaction Meet(a: A, b: A) { pair: when abs(a.x - b.x) <= 1 { emit a.bump(2 [m/s])  emit b.bump(3 [m/s]) } }
         system { p = A(v = 1)  q = A(v = 0, x = 5) }  run { until 10 }",
    );
    // one flag a pair would need both to emit the same
    let log = run.log();
    assert!(log.iter().all(|line| !line.contains("Meet.pair q p") || log.len() > 3), "{log:?}");
    assert_eq!(run.times("Meet.pair").len(), 2, "ordered pairs: what they emit differs");
}

#[test]
fn rule_09_a_symmetric_interaction_may_let_both_emit() {
    let run = simulate_by_both_forms(
        "agent A(v: real) { event bump(x: real)  state x = 0  discrete felt: real = 0
           flow { x' = v }  feel: on bump(x) from self { felt := x } }
         interaction Meet(a: A, b: A) { pair: when abs(a.x - b.x) <= 1 { emit b.bump(a.x)  emit a.bump(b.x) } }
         system { p = A(v = 1)  q = A(v = 0, x = 5) }  run { until 6 }",
    );
    assert_eq!(run.log(), ["0 Meet.pair p q", "1 A.feel p p", "1 A.feel q q"]);
    all_near(&[run.value("p.felt"), run.value("q.felt")], &[5.0, 4.0], 1e-11);
}

#[test]
fn rule_09_entry_actions_at_the_start_emit() {
    let run = simulate_by_both_forms(
        "agent A { event e  initial mode M { entry { emit e } } }
         agent B { hear: on e { } }
         system { a = A()  b = B() }  run { until 1 }",
    );
    assert_eq!(run.log(), ["0 B.hear b a"]);
    assert_eq!(run.times("B.hear"), [0.0]);
}

#[test]
fn rule_09_messages_at_the_end_are_heard_and_later_ones_are_not() {
    let run = simulate_by_both_forms(
        "agent A { event e(n: int)  after 0 [s] { emit e(1) after 0.1 + 0.2  emit e(2) after 0.31 } }
         agent B { discrete k: int = 0  hear: on e(n) { k := n } }
         system { a = A()  b = B() }  run { until 0.3 }",
    );
    assert_eq!(run.times("B.hear"), [0.3]);
    assert_eq!(run.value("b.k"), 1.0);
}

#[test]
fn rule_09_messages_without_end_are_an_error() {
    let (run, found) = simulate_error(
        "agent A { event e  link whom: A  start: after 1 { emit e }  hear: on e from whom { emit e } }
         system { a = A(whom = b)  b = A(whom = a) }  run { until 2 }",
    );
    assert_eq!(found.code, "HY0505");
    assert_eq!(run.time, 1.0);
    assert!(matches!(run.end, Ended::Error(_)));
}

#[test]
fn rule_09_many_senders_at_once_are_nothing_to_complain_of() {
    let run = simulate_by_both_forms(
        "agent A { event e  state x = 0  flow { x' = 1 }  go: when x >= 1 { emit e } }
         agent B { discrete n: int = 0  hear: on e { n := n + 1 } }
         system { s = A[300](x = 1e-13*index)  b = B() }  run { until 2 }",
    );
    assert_eq!(run.value("b.n"), 300.0);
}

#[test]
fn rule_09_a_message_wakes_an_agent_that_runs_ahead() {
    // thousands who oscillate alone; a message sends some of them back in time to where they were
    let run = simulate_by_both_forms(
        "agent A(k: int) { event kick(whom: int)  discrete n: int = 0
           go: every 0.37 { n := n + 1  emit kick(mod(7*n, 60)) after 0.05 } }
         agent B(k: int) { state x = 1, v = 0  discrete hits: int = 0
           flow { x' = v  v' = -x }
           hear: on kick(whom) when whom == k { v := v + 0.5*x  hits := hits + 1 }
           far: when x >= 1.05 { hits := hits + 100 } }
         system { a = A(k = 0)  bs = B[60](k = index) }  run { until 20 }",
    );
    assert_eq!(run.times("B.hear").len(), 53);
    assert!(run.times("B.far").len() > 10);
}

#[test]
fn rule_09_a_message_passed_over_keeps_its_turn_though_nothing_hears_it_there() {
    // the first message is passed over for `go`; its turn goes on where nothing hears it, and the others come after
    let run = simulate_by_both_forms(
        "agent S { event q(v: int)
           t: after 1 { emit q(1) after 1  emit q(2) after 1  emit q(3) after 1 } }
         agent A { discrete c: int = 0
           go: after 2 priority 1 -> M1
           initial mode M0 { h0: on q(v) { c := 10*c + v } }
           mode M1 { back: when true -> M0 } }
         system { a = A()  s = S() }
         run { until 3 }",
    );
    assert_eq!(run.log(), ["0 S.t s", "0 A.go a M0->M1", "1 A.back a M1->M0", "2 A.h0 a s", "3 A.h0 a s"]);
    assert_eq!(run.value("a.c"), 23.0);
}
