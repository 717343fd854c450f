//! Rule 4: what happens in one instant, and in which order.

use crate::harness::{
    Case, all_near, near, refused, simulate, simulate_by_both_forms, simulate_error, simulate_to_the_end,
    words,
};
use hyc::model::ir::Integrator;
use hyc::runtime::limits::Limits;

#[test]
fn rule_04_higher_priority_first() {
    let run = simulate(
        "agent A {
           initial mode Start { low: when time >= 1 -> Left  high: when time >= 1 priority 1 -> Right
                                lower: when time >= 1 priority -1 -> Left }
           mode Left { }
           mode Right { } }
         system { a = A() }  run { until 2 }",
    );
    assert_eq!(run.log(), ["0 A.high a Start->Right"]);
    assert_eq!(run.mode("a"), "Right");
}

#[test]
fn rule_04_priority_is_an_expression_of_the_state_before() {
    let run = simulate(
        "agent A(p: real, q: real) { discrete first = 0, second = 0, n = 0
           one: when time >= 1 priority p { n := n + 1  first := n }
           two: when time >= 1 priority q - n { n := n + 1  second := n } }
         system { a = A(p = 1, q = 2)  b = A(p = 2, q = 1) }  run { until 2 }",
    );
    assert_eq!([run.value("a.first"), run.value("a.second")], [1.0, 0.0]);
    assert_eq!([run.value("b.first"), run.value("b.second")], [0.0, 1.0]);
}

#[test]
fn rule_04_the_agent_before_its_modes_then_in_order_of_declaration() {
    let run = simulate(
        "agent A { discrete n = 0
           initial mode M { inner1: when time >= 1 { n := n + 1 }
                            inner2: when time >= 1 { n := n + 1 } }
           outer1: when time >= 1 { n := n + 1 }
           outer2: when time >= 1 { n := n + 1 } }
         system { a = A() }  run { until 2 }",
    );
    assert_eq!(run.log(), ["0 A.outer1 a", "1 A.outer2 a", "2 A.inner1 a", "3 A.inner2 a"]);
    assert_eq!(run.value("a.n"), 4.0);
}

#[test]
fn rule_04_interactions_before_modes() {
    let run = simulate(
        "agent A(id: int) { discrete n = 0
           initial mode M { inner: when time >= 1 and id == 0 { n := 10*n + 1 } } }
         interaction Meet(a: A, b: A) { pair: when time >= 1 and a.id < b.id { a.n := 10*a.n + 2 } }
         system { a = A(id = 0)  b = A(id = 1) }  run { until 2 }",
    );
    assert_eq!(run.value("a.n"), 21.0);
    assert_eq!(run.log(), ["0 Meet.pair a b", "1 A.inner a"]);
}

#[test]
fn rule_04_agents_by_number() {
    let run = simulate(
        "agent A { discrete n = 0  go: when time >= 1 { n := 1 } }
         system { a = A()  b = A()  c = A() }  run { until 2 }",
    );
    let agents: Vec<&str> = run.events.iter().map(|event| event.agent.as_str()).collect();
    assert_eq!(agents, ["a", "b", "c"]);
    assert!(run.events.iter().all(|event| event.micro == 0));
    all_near(&run.times("A.go"), &[1.0; 3], 1e-12);
}

#[test]
fn rule_04_one_transition_of_an_agent_in_a_micro_step() {
    let run = simulate(
        "agent A { discrete p = 0, q = 0
           one: when time >= 1 { p := 1 }
           two: when time >= 1 { q := 1 } }
         system { a = A() }  run { until 2 }",
    );
    assert_eq!(run.log(), ["0 A.one a", "1 A.two a"]);
}

#[test]
fn rule_04_what_was_passed_over_is_tested_again_on_the_new_state() {
    let run = simulate(
        "agent A { discrete open: bool = true
           one: when time >= 1 { open := false }
           two: when time >= 1 and open { } }
         system { a = A() }  run { until 2 }",
    );
    assert_eq!(run.log(), ["0 A.one a"]);
    // and what has become true joins the instant
    let run = simulate(
        "agent A { discrete open: bool = false
           two: when time >= 1 and open { }
           one: when time >= 1 { open := true } }
         system { a = A() }  run { until 2 }",
    );
    assert_eq!(run.log(), ["0 A.one a", "1 A.two a"]);
}

#[test]
fn rule_04_the_conditions_that_made_the_instant_count_as_true_in_it() {
    // the instant is made by the flow at a root that rounds to either side
    for k in 1..20 {
        let run = simulate(&format!(
            "agent A {{ state x = 0  discrete n = 0  flow {{ x' = {k}/7 }}
               one: when x >= 0.3 {{ n := n + 1 }}
               two: when x >= 0.3 {{ n := n + 1 }}
               three: when x > 0.3 and n >= 2 {{ n := n + 1 }} }}
             system {{ a = A() }}  run {{ until 4 }}"
        ));
        assert_eq!(run.log(), ["0 A.one a", "1 A.two a", "2 A.three a"], "k = {k}");
        let first = run.events[0].time;
        assert!(run.events.iter().all(|event| event.time == first));
    }
}

#[test]
fn rule_04_write_sets_are_disjoint_greedily() {
    // 1 touches 0 and 2 at once; (0, 1) is taken, (1, 2) passed over and taken in the next micro-step
    let run = simulate(
        "agent A(at: real) { discrete n = 0 }
         interaction Meet(a: A, b: A) {
           pair: when time >= 1 and abs(a.at - b.at) <= 1 { a.n := a.n + 1  b.n := b.n + 1 }
         }
         system { a = A[4](at = index) }  run { until 2 }",
    );
    assert_eq!(
        run.log(),
        ["0 Meet.pair a[0] a[1]", "0 Meet.pair a[2] a[3]", "1 Meet.pair a[1] a[2]"],
        "(2, 3) shares nothing with (0, 1)"
    );
    let counts: Vec<f64> = (0..4).map(|k| run.value(&format!("a[{k}].n"))).collect();
    assert_eq!(counts, [1.0, 2.0, 2.0, 1.0]);
}

#[test]
fn rule_04_an_if_writes_both_branches() {
    // the interaction might write a and b, so their own transitions wait
    let run = simulate(
        "interaction Meet(a: A, b: A) {
           pair: when time >= 1 and abs(a.n - b.n) <= 100 { if a.n + b.n > 1000 { a.n := 0  b.n := 0 } }
         }
         agent A { discrete n = 0  own: when time >= 1 { n := n + 1 } }
         system { a = A()  b = A() }  run { until 2 }",
    );
    assert_eq!(run.log(), ["0 Meet.pair a b", "1 A.own a", "1 A.own b"]);
}

#[test]
fn rule_04_right_hand_sides_read_the_state_before() {
    let run = simulate(
        "agent A { state x = 1, y = 2  discrete p = 3, q = 4
           flow { x' = 0  y' = 0 }
           swap: when time >= 1 { x := y  y := x  p := q  q := p } }
         system { a = A() }  run { until 2 }",
    );
    assert_eq!(
        [run.value("a.x"), run.value("a.y"), run.value("a.p"), run.value("a.q")],
        [2.0, 1.0, 4.0, 3.0]
    );
}

#[test]
fn rule_04_exit_and_transition_read_before_entry_reads_after() {
    let run = simulate(
        "agent A { discrete x = 1, seen_exit = 0, seen_go = 0, seen_entry = 0, left = 0
           initial mode First {
             exit { seen_exit := x  left := 5 }
             go: when time >= 1 -> Second { seen_go := 100*left + x  x := 10 } }
           mode Second { entry { seen_entry := 100*left + x } } }
         system { a = A() }  run { until 2 }",
    );
    assert_eq!(run.value("a.seen_exit"), 1.0);
    assert_eq!(run.value("a.seen_go"), 1.0);
    assert_eq!(run.value("a.seen_entry"), 510.0);
}

#[test]
fn rule_04_conditions_of_actions_read_the_state_before() {
    let run = simulate(
        "agent A { discrete x = 1, y = 0
           go: when time >= 1 { x := 10
                                if x >= 5 { y := 1 } else if x >= 1 { y := 2 } else { y := 3 } } }
         system { a = A() }  run { until 2 }",
    );
    assert_eq!(run.value("a.y"), 2.0);
}

#[test]
fn rule_04_a_variable_is_written_once_in_a_list() {
    let words = refused(
        "agent A { discrete x = 1  go: when time >= 1 { x := 2  x := 3 } }  system { a = A() }  run { until 2 }",
    );
    assert!(words.contains('x'), "{words}");
}

#[test]
fn rule_04_a_cascade_at_one_instant() {
    let run = simulate(
        "agent A { discrete n = 0
           initial mode M0 { go0: when time >= 1 -> M1 }
           mode M1 { entry { n := n + 1 }  go1: when n >= 1 -> M2 }
           mode M2 { entry { n := n + 1 }  go2: when n >= 2 -> M3 }
           mode M3 { entry { n := n + 1 }  go3: when n >= 4 -> M0 } }
         system { a = A() }  run { until 2 }",
    );
    assert_eq!(run.log(), ["0 A.go0 a M0->M1", "1 A.go1 a M1->M2", "2 A.go2 a M2->M3"]);
    assert!(run.events.iter().all(|event| event.time == run.events[0].time));
}

#[test]
fn rule_04_a_cycle_ends_at_the_limit_and_is_named() {
    let (run, found) = simulate_error(
        "agent A {
           initial mode M { ping: when time >= 1 -> N }
           mode N { pong: when time >= 1 -> M } }
         system { a = A() }  run { until 2 }",
    );
    near(run.time, 1.0, 1e-11);
    let words = words(&[found]);
    assert!(words.contains("A.ping") && words.contains("A.pong"), "{words}");
    assert!(words.contains("max_microsteps"), "{words}");
    let firings = run.times("A.ping").len();
    assert!((1000..=1001).contains(&firings), "{firings}");
}

#[test]
fn rule_04_the_limit_is_of_one_transition_instance() {
    // n counts to 1000 at one instant by one transition: allowed; 1001 is not
    let text = |n: u32| {
        format!(
            "agent A {{ discrete n: int = 0
               initial mode M {{ add: when time >= 1 and n < {n} -> M {{ n := n + 1 }} }} }}
             system {{ a = A() }}  run {{ until 2 }}"
        )
    };
    assert_eq!(simulate(&text(1000)).value("a.n"), 1000.0);
    simulate_error(&text(1001));
    let limits = Limits { microsteps_max: 10, ..Limits::default() };
    Case::new(&text(11)).limits(limits.clone()).run_error();
    assert_eq!(Case::new(&text(10)).limits(limits).run().value("a.n"), 10.0);
}

#[test]
fn rule_04_a_chain_of_instances_that_each_fire_once_is_no_cycle() {
    // a chain of 1500 births in one instant: each Dot fires once
    let text = "agent Dot(n: int) { more: when time >= 1 and n > 0 { create Dot(n = n - 1) } }
         system { dot = Dot(n = 1500) }  run { until 2 }";
    assert_eq!(simulate(text).log().len(), 1500);
    let limits = Limits { generations_max: 1499, ..Limits::default() };
    let (_, found) = Case::new(text).limits(limits).run_error();
    assert_eq!(found.code, "HY0530");
    assert!(words(&[found]).contains("max_generations"));
}

#[test]
fn rule_04_roots_as_near_as_the_event_tolerance_are_one_instant() {
    let run = simulate(
        "agent A { discrete n = 0
           late: when time >= 1.0000000000001 { n := n + 1 }
           early: when time >= 1 { n := n + 1 } }
         system { a = A() }  run { until 2 }",
    );
    assert_eq!(run.log(), ["0 A.late a", "1 A.early a"], "in the order of declaration");
    assert_eq!(run.events[0].time, run.events[1].time);
    // a root that is further away is an instant of its own
    let run = simulate(
        "agent A { discrete n = 0
           late: when time >= 1.00000000001 { n := n + 1 }
           early: when time >= 1 { n := n + 1 } }
         system { a = A() }  run { until 2 }",
    );
    assert_eq!(run.log(), ["0 A.early a", "0 A.late a"]);
}

#[test]
fn rule_04_a_root_near_a_scheduled_time_joins_it() {
    let run = simulate(
        "agent A { state x = 0  discrete n = 0
           flow { x' = 1 }
           tick: every 0.1 { n := n + 1 }
           root: when x >= 0.7 { n := n + 1 } }
         system { a = A() }  run { until 1 }",
    );
    let ticks = run.times("A.tick");
    assert_eq!(ticks.len(), 10);
    for (k, time) in ticks.iter().enumerate() {
        assert_eq!(*time, (k + 1) as f64 * 0.1, "never moved");
    }
    assert_eq!(run.times("A.root"), [7.0 * 0.1]);
}

#[test]
fn rule_04_independent_agents_have_instants_of_their_own() {
    // a's second event at the instant waits for nobody: both agents have micro-steps 0 and 1
    let run = simulate(
        "agent A { discrete n = 0
           one: when time >= 1 { n := n + 1 }
           two: when time >= 1 { n := n + 1 } }
         system { a = A()  b = A() }  run { until 2 }",
    );
    for agent in ["a", "b"] {
        let micros: Vec<usize> = run.events.iter().filter(|e| e.agent == agent).map(|e| e.micro).collect();
        assert_eq!(micros, [0, 1]);
    }
    all_near(&run.times("A.one"), &[1.0; 2], 1e-12);
}

#[test]
fn rule_04_exit_actions_before_those_of_an_interaction() {
    // the interaction has the last word on what the exit of the mode that it ends writes too
    let run = simulate(
        "agent A { discrete n = 0, m = 0
           initial mode Calm { exit { n := n + 1  m := 7 } }
           mode Hit { entry { m := m + 1 } } }
         interaction Meet(a: A, b: A) { pair: when time >= 1 { a.n := a.n + 10  b.n := b.n + 10  a -> Hit  b -> Hit } }
         system { a = A()  b = A() }  run { until 2 }",
    );
    assert_eq!([run.value("a.n"), run.value("b.n")], [10.0, 10.0]);
    assert_eq!([run.value("a.m"), run.value("b.m")], [8.0, 8.0]);
}

/// Two roots half a millisecond apart; the later one has priority.
const TWO_ROOTS: &str = "\
agent A {
  state x = 0
  discrete n: int = 0, m: int = 0
  flow { x' = 1 }
  one: when x >= 1 { n := n + 1 }
  two: when x >= 1.0005 priority 1 { m := n + 1 }
}
system { a = A() }
";

#[test]
fn rule_04_roots_within_the_tolerance_of_events_are_one_instant() {
    let run = simulate_to_the_end(&format!("{TWO_ROOTS}run {{ until 2  event_tolerance 1 [ms] }}"));
    let fired: Vec<(f64, usize, &str)> =
        run.events.iter().map(|event| (event.time, event.micro, event.transition.as_str())).collect();
    assert_eq!(fired, [(1.0, 0, "A.two"), (1.0, 1, "A.one")], "the later root counts as there, once");
    assert_eq!(run.finals[0].values[1..], [("n".into(), 1.0), ("m".into(), 1.0)]);
}

#[test]
fn rule_04_without_a_tolerance_of_events_they_are_two() {
    let run = simulate_to_the_end(&format!("{TWO_ROOTS}run {{ until 2 }}"));
    all_near(&run.event_times(), &[1.0, 1.0005], 1e-12);
    assert_eq!(run.finals[0].values[1..], [("n".into(), 1.0), ("m".into(), 2.0)]);
}

#[test]
fn rule_04_agents_that_share_nothing_keep_their_instants_whatever_the_tolerance() {
    let run = simulate_to_the_end(
        "agent A(k: real) { state x = 0  flow { x' = k }  one: when x >= 1 { } }
         system { a = A(k = 1)  b = A(k = 1.0005) }
         run { until 2  event_tolerance 0.1 }",
    );
    all_near(&run.event_times(), &[1.0 / 1.0005, 1.0], 1e-12);
}

#[test]
fn rule_04_of_two_who_watch_one_agent_neither_misses_what_the_other_answers() {
    // their roots are found some ulps apart; what the answer of the first writes turns the flow of the one who is watched
    let run = simulate_by_both_forms(
        "agent Bee(mate: Cat) { state x, y
           flow { x' = -1.177*sin(3.979*time - 0.378)  y' = 1.033*(mate.x - y) }
           dive: after 0.271 { y := -0.649 } }
         agent Cat(mate: Bee) { state x  discrete k: int = 2, c = 0.428
           flow { x' = 1.13*(mate.x - x) }
           see: when mate.y > -0.611*mate.x { k := 0  c := 0.5*mate.y + 0.791 }
           near: when mate.x^2 + mate.x^2 <= 1.565 { k := 1 }
           leap: when (c + 0.208)^2 < 0.678 { c := -0.879*c  x := -1.151 } }
         system {
           bees = Bee[1](x = 1.042, y = 1.255, mate = cats[1])
           cats = Cat[2](x = if index == 0 then 0.311 else -0.143, mate = bees[0])
         }
         run { until 0.5  tolerance 1e-11 }",
    );
    let late: Vec<String> = run.log().into_iter().skip(5).collect();
    assert_eq!(late, ["0 Cat.see cats[0]", "0 Cat.see cats[1]", "1 Cat.leap cats[0]", "1 Cat.leap cats[1]"]);
    assert!(run.events[5..].iter().all(|event| event.time == run.events[5].time));
}

#[test]
fn rule_04_who_shares_nothing_keeps_his_time_and_no_claim_moves_an_event() {
    // Somebody else is some ulps later at each turn; an assert of its own, 5e-13 s.
    let run = simulate_by_both_forms(
        "agent B(e: real) { state x = 0  flow { x' = 1 }  assert x <= 1 + 5e-13
           go: when x >= 1 + e { x := 0 } }
         system { b = B(e = 0)  c = B(e = 2e-15) }  run { until 5 }",
    );
    let times: Vec<f64> =
        run.events.iter().filter(|event| event.agent == "b").map(|event| event.time).collect();
    assert_eq!(times, [1.0, 2.0, 3.0, 4.0, 5.0]);
}

/// How late after 1 s a clock meets three thresholds there that are as far apart, s: whoever is met too early takes the root of a
/// negative number.
fn met_late(apart: f64) -> Vec<f64> {
    let run = simulate_by_both_forms(&format!(
        "agent T {{ state s = 0  flow {{ s' = 1 }} }}
         agent B(d: real) {{ discrete k: real = 1 + d, r: real = 0 }}
         interaction I(a: T, b: B) {{ hit: when a.s >= b.k {{ b.r := sqrt(a.s - b.k) }} }}
         system {{ t = T()  b = B[3](d = {apart}*index) }}  run {{ until 2 }}"
    ));
    assert_eq!(run.log(), ["0 I.hit t b[0]", "0 I.hit t b[1]", "0 I.hit t b[2]"]);
    run.event_times().iter().map(|time| time - 1.0).collect()
}

#[test]
fn rule_04_roots_that_share_an_agent_are_one_instant_at_the_last_of_them() {
    all_near(&met_late(4e-13), &[8e-13, 8e-13, 8e-13], 1e-15);
}

#[test]
fn rule_04_what_waits_is_put_off_no_farther_than_the_tolerance() {
    all_near(&met_late(9e-13), &[9e-13, 9e-13, 18e-13], 1e-15);
}

#[test]
fn rule_04_a_root_that_waits_for_another_waits_for_its_scheduled_time_with_it() {
    let run = simulate_by_both_forms(
        "agent S { discrete seen: int = -1  link c: C  due: after 1 { seen := if c then c.n else -5 } }
         agent C { state x = 0  discrete n: int = 0  link s: S  flow { x' = 1 }
           hit: when x >= 1 and (if s then s.seen else 0) < 5 { n := n + 1 } }
         agent A { state y = 0  discrete k: int = 0  link c: C  flow { y' = 1 }
           hit: when y >= 1 - 5e-13 { k := k + 1 + (if c then c.n else 0) } }
         system { a = A(c = c)  c = C(s = s)  s = S(c = c) }  run { until 2 }",
    );
    assert_eq!(run.log(), ["0 S.due s", "0 C.hit c", "0 A.hit a"]);
    assert!(run.events.iter().all(|event| event.time == 1.0));
    assert_eq!([run.value("s.seen"), run.value("a.k")], [0.0, 1.0]);
}

#[test]
fn rule_04_a_root_waits_for_its_scheduled_time_though_somebody_else_has_one_before() {
    let run = simulate_by_both_forms(
        "agent U { state x = -1 + 3e-13  flow { x' = 1 }  hit: when x >= 0 { } }
         agent C { discrete k: int = 0  t: after 1 { k := 1 } }
         agent B(c: C) { state x = -1 - 1e-13  discrete n: int = 0  flow { x' = 1 }
           hit: when x >= 0 { n := 1 }
           bad: when n == 1 and c.k == 0 { n := 2 } }
         system { c = C()  b = B(c = c)  u = U() }  run { until 2 }",
    );
    assert_eq!(run.log(), ["0 U.hit u", "0 C.t c", "0 B.hit b"]);
    assert_eq!([run.events[1].time, run.events[2].time], [1.0, 1.0]);
}

#[test]
fn rule_04_destroying_whom_a_link_does_not_lead_to_is_no_write() {
    let run = simulate_by_both_forms(
        "agent A { link l: A  discrete n: int = 0
           t: after 1 { destroy l  n := 1 } }
         system { a = A[3]() }
         run { until 2 }",
    );
    assert_eq!(run.log(), ["0 A.t a[0]", "0 A.t a[1]", "0 A.t a[2]"]);
}

#[test]
fn rule_04_destroying_whom_two_links_lead_to_is_a_write_of_both() {
    let run = simulate_by_both_forms(
        "agent B { }
         agent A { link l: B  discrete n: int = 0
           t: after 1 { destroy l  n := 1 } }
         system { b = B()  a = A[2](l = b) }
         run { until 2 }",
    );
    assert_eq!(run.log(), ["0 A.t a[0]", "1 A.t a[1]"]);
}

#[test]
fn rule_04_a_priority_of_minus_zero_is_none() {
    let run = simulate(
        "agent A { discrete m: int = 0, who: int = 0
           first: after 1 priority -m { who := 10*who + 1 }
           second: after 1 { who := 10*who + 2 } }
         system { a = A() }  run { until 2 }",
    );
    assert_eq!(run.value("a.who"), 12.0);
}

#[test]
fn rule_04_links_lead_where_they_should_before_modes_are_armed() {
    // both leave their modes at 1 s: when r is armed there is nobody on any more, so nothing rises after that
    for guard in
        ["rising(not l)", "crossing(if l then 1 else -1)", "rising((count o in O where o is On) < 1)"]
    {
        let run = simulate(&format!(
            "agent O {{ initial mode On {{ off: after 1 -> Off }}  mode Off {{ }} }}
             agent W {{ link l = nearest o in O where o is On by 1
               initial mode Start {{ go: after 1 -> Wait }}
               mode Wait {{ r: when {guard} {{ }} }} }}
             system {{ o = O()  w = W() }}  run {{ until 2 }}"
        ));
        assert_eq!(run.log(), ["0 O.off o On->Off", "0 W.go w Start->Wait"], "{guard}");
    }
    // a delay is read where the link leads then
    let run = simulate(
        "agent O(d: real) { discrete lit = 1  off: after 1 { lit := 0 } }
         agent W { link l = nearest o in O where o.lit > 0 or o.d > 5 by o.d
           initial mode Start { go: after 1 -> Wait }
           mode Wait { r: after (if l then l.d else 0) { } } }
         system { a = O(d = 1)  b = O(d = 7)  w = W() }  run { until 20 }",
    );
    near(run.times("W.r")[0], 8.0, 1e-12);
}

#[test]
fn rule_04_a_crossing_that_was_passed_over_is_tested_again() {
    // by a reset, whatever the one that went first writes, and whoever reads that
    for (write, watcher) in [
        ("s := s + 1", ""),
        ("s := s + 1", "assert s <= 1000"),
        ("n := 6  s := s + 1", ""),
        ("n := 6  s := s + 1", "assert s <= 1000"),
    ] {
        let run = simulate(&format!(
            "agent A {{ discrete n: int = 0, s: int = 0
               go: after 1 {{ n := 5 }}
               a: when n >= 2 {{ {write} }}
               b: when crossing(n - 1.5) {{ s := s + 10 }}
               {watcher} }}
             system {{ a = A() }}  run {{ until 3 }}"
        ));
        assert_eq!(run.log(), ["0 A.go a", "1 A.a a", "2 A.b a"], "{write} {watcher}");
    }
    // by the flow
    let run = simulate(
        "agent A { state x = 0, y = 0  discrete k: int = 0
           flow { x' = 1  y' = 1 }
           a: when crossing(x - 1) { x := 2 }
           b: when crossing(x + y - 2) { k := 1 } }
         system { a = A() }  run { until 3 }",
    );
    assert_eq!(run.log(), ["0 A.a a", "1 A.b a"]);
}

#[test]
fn rule_04_what_was_passed_over_at_zero_is_tested_again_on_another_zero() {
    for integrator in [Integrator::Taylor, Integrator::Tsit5, Integrator::Adams] {
        let case = Case::new(
            "agent A(z0: real) {
               state z = z0, v = 1
               flow { z' = v*(1 + 0.1*z)  v' = 0 }
               first: when z >= 0 priority 1 { z := -0.5*z  v := -1 }
               second: when z >= 0 { z := -1  v := -1 } }
             system { a = A[20](z0 = -1 + 0.0371*index) }  run { until 3  tolerance 1e-11 }",
        );
        let run = case.integrator(integrator).run();
        assert_eq!([run.times("A.first").len(), run.times("A.second").len()], [20, 20], "{integrator:?}");
    }
}
