//! Modes in modes: rules 1, 2, 4, 8 and 11 where a mode is inside another one. Every log is worked out by hand.

use crate::harness::{
    Case, all_near, near, refused, simulate, simulate_by_both_forms, simulate_error, words,
};

/// What an agent did to a trace of decimal digits: `note(d)` as an action.
fn with_trace(body: &str) -> String {
    format!("agent A {{ discrete trace = 0\n{body}\n}}\nsystem {{ a = A() }}  run {{ until 10 }}")
}

#[test]
fn rule_01_an_inner_mode_adds_flows() {
    let run = simulate_by_both_forms(
        "agent A { state x = 0, y = 0, z = 0
           flow { x' = 1 }
           initial mode Out {
             flow { y' = 2 }
             initial mode In { flow { z' = 3 }  when z >= 6 -> Still }
             mode Still { flow { z' = 0 } }
           }
           mode Else { flow { y' = 0  z' = 0 } } }
         system { a = A() }  run { until 5 }",
    );
    all_near(&[run.value("a.x"), run.value("a.y"), run.value("a.z")], &[5.0, 10.0, 6.0], 1e-9);
    assert_eq!(run.log(), ["0 A.In->Still a Out.In->Out.Still"]);
}

#[test]
fn rule_01_every_state_has_one_flow_in_every_leaf() {
    let text = refused(
        "agent A { state x = 0
           initial mode Out { initial mode In { flow { x' = 1 } }  mode Idle { mode B { } initial mode C { flow { x' = 0 } } } } }",
    );
    assert!(text.contains("state `x` has no flow in mode `Out.Idle.B`"), "{text}");
    let text = refused(
        "agent A { state x = 0
           initial mode Out { flow { x' = 1 }  initial mode In { flow { x' = 2 } } } }",
    );
    assert!(text.contains("HY0241") && text.contains("two flows at once"), "{text}");
}

#[test]
fn rule_01_every_level_has_an_initial_mode() {
    let text = refused("agent A { initial mode Out { mode In { } } }");
    assert!(text.contains("HY0243") && text.contains("mode `Out` has modes, but none is initial"), "{text}");
    let text = refused("agent A { initial mode Out { initial mode P { }  initial mode Q { } } }");
    assert!(text.contains("HY0244") && text.contains("mode `Out` has two initial modes"), "{text}");
}

#[test]
fn rule_01_an_instance_starts_in_a_mode_or_inside_it() {
    let run = simulate(
        "agent A { initial mode P { }  mode Q { initial mode R { }  mode S { } } }
         system { a = A()  b = A() in Q  c = A() in Q.S }  run { until 1 }",
    );
    assert_eq!([run.mode("a"), run.mode("b"), run.mode("c")], ["P", "Q.R", "Q.S"]);
}

#[test]
fn rule_01_lets_of_outer_modes_are_seen_inside() {
    let run = simulate(
        "agent A { state x = 0  flow { x' = 1 }
           initial mode Out { let twice = 2*x
             initial mode In { let more = twice + 1  go: when more >= 5 -> Other }
             mode Other { } } }
         system { a = A() }  run { until 5 }",
    );
    all_near(&run.times("A.go"), &[2.0], 1e-9);
    let text = refused(
        "agent A { state x = 0  flow { x' = 1 }
           initial mode Out { let twice = 2*x  initial mode In { } }
           mode Other { when twice > 1 -> Out } }",
    );
    assert!(text.contains("HY0201"), "{text}");
}

#[test]
fn rule_02_entering_arms_every_mode_that_is_entered() {
    // x >= 1 is true on entry: the outer mode's transition fires first, then the inner one's
    let run = simulate_by_both_forms(
        "agent A { state x = 0  discrete n = 0  flow { x' = 1 }
           initial mode P { go: when x >= 2 -> Q }
           mode Q { outer: when x >= 1 { n := n + 1 }
             initial mode R { middle: when x >= 1 { n := n + 1 }
               initial mode S { inner: when x >= 1 { n := n + 1 } } } } }
         system { a = A() }  run { until 3 }",
    );
    assert_eq!(run.log(), ["0 A.go a P->Q.R.S", "1 A.outer a", "2 A.middle a", "3 A.inner a"]);
    all_near(&run.times("A.inner"), &[2.0], 1e-9);
}

#[test]
fn rule_02_an_outer_mode_stays_armed_as_it_is_when_the_inner_one_changes() {
    // once: fires at t = 1 and stays disarmed while x >= 1 holds, whatever happens inside; each: armed with In
    let run = simulate_by_both_forms(
        "agent A { state x = 0  flow { x' = 1 }
           initial mode Out { once: when x >= 1 { }
             initial mode In { each: when x >= 1 { }  again: every 2 -> In } } }
         system { a = A() }  run { until 5 }",
    );
    assert_eq!(
        run.log(),
        [
            "0 A.once a",
            "1 A.each a",
            "0 A.again a Out.In->Out.In",
            "1 A.each a",
            "0 A.again a Out.In->Out.In",
            "1 A.each a"
        ]
    );
    all_near(&run.times("A.each"), &[1.0, 2.0, 4.0], 1e-9);
}

#[test]
fn rule_02_a_self_transition_on_a_composite_arms_all_of_it() {
    let run = simulate_by_both_forms(
        "agent A { state x = 0  flow { x' = 1 }
           initial mode Out { once: when x >= 1 { }  back: when x >= 3 -> Out { x := 1 }
             initial mode In { go: when x >= 1 and x < 2 -> Deep }
             mode Deep { } } }
         system { a = A() }  run { until 3.5 }",
    );
    assert_eq!(
        run.log(),
        [
            "0 A.once a",
            "1 A.go a Out.In->Out.Deep",
            "0 A.back a Out.Deep->Out.In",
            "1 A.once a",
            "2 A.go a Out.In->Out.Deep",
        ]
    );
    all_near(&run.times("A.once"), &[1.0, 3.0], 1e-9);
    // entered at x = 3: back is true again at once, armed, and fires again: without end
    let (_, found) = simulate_error(
        "agent A { state x = 0  flow { x' = 1 }
           initial mode Out { back: when x >= 3 -> Out  initial mode In { } } }
         system { a = A() }  run { until 4 }",
    );
    assert!(words(&[found]).contains("HY0505"));
}

#[test]
fn rule_04_a_group_transition_leaves_from_whichever_mode_is_active() {
    let run = simulate_by_both_forms(
        "agent A { state x = 0  flow { x' = 1 }
           initial mode Out { halt: when x >= 3 -> Off
             initial mode P { when x >= 1 -> Q }
             mode Q { when x >= 2 -> R }
             mode R { initial mode S { } } }
           mode Off { back: after 1 -> Out } }
         system { a = A()  b = A(x = 2.5) }  run { until 3.5 }",
    );
    assert_eq!(
        run.log(),
        [
            "0 A.P->Q b Out.P->Out.Q",
            "1 A.Q->R b Out.Q->Out.R.S",
            "0 A.halt b Out.R.S->Off",
            "0 A.P->Q a Out.P->Out.Q",
            "0 A.back b Off->Out.P",
            "1 A.halt b Out.P->Off",
            "0 A.Q->R a Out.Q->Out.R.S",
            "0 A.back b Off->Out.P",
            "1 A.halt b Out.P->Off",
            "0 A.halt a Out.R.S->Off",
            "0 A.back b Off->Out.P",
            "1 A.halt b Out.P->Off",
        ]
    );
    all_near(&run.times_of("A.halt", "b"), &[0.5, 1.5, 2.5, 3.5], 1e-9);
}

#[test]
fn rule_04_the_outer_mode_comes_first_unless_priority_says_otherwise() {
    let model = |priority: i32| {
        format!(
            "agent A {{ state x = 0  flow {{ x' = 1 }}
               initial mode Out {{
                 initial mode In {{ inner: when x >= 1 priority {priority} -> Left }}
                 mode Left {{ }}
                 outer: when x >= 1 -> Right }}
               mode Right {{ }} }}
             system {{ a = A() }}  run {{ until 2 }}"
        )
    };
    let run = simulate_by_both_forms(&model(0));
    assert_eq!(run.log(), ["0 A.outer a Out.In->Right"]);
    let run = simulate_by_both_forms(&model(1));
    assert_eq!(run.log(), ["0 A.inner a Out.In->Out.Left", "1 A.outer a Out.Left->Right"]);
}

#[test]
fn rule_04_exit_inner_to_outer_then_actions_then_entry_outer_to_inner() {
    // each list writes its own variable from the clock of writes before it: reads tell what it saw
    let run = simulate_by_both_forms(
        "agent A { discrete n = 1, exit_in = 0, exit_out = 0, own = 0, entry_out = 0, entry_in = 0, last = 0
           initial mode P { exit { exit_out := n  last := 1 }
             initial mode Q { exit { exit_in := n  last := 2 }
               go: after 1 -> R.S { own := n  n := 10 } } }
           mode R { entry { entry_out := n  n := n + 1 }
             initial mode T { entry { n := 77 } }
             mode S { entry { entry_in := n  n := n + 1 } } } }
         system { a = A() }  run { until 2 }",
    );
    assert_eq!(run.log(), ["0 A.go a P.Q->R.S"]);
    let values = ["exit_in", "exit_out", "own", "entry_out", "entry_in", "n", "last"];
    let values = values.map(|name| run.value(&format!("a.{name}")));
    // exit and own actions read n = 1; R's entry reads 10, S's 11; of the two exits the outer one comes last
    assert_eq!(values, [1.0, 1.0, 1.0, 10.0, 11.0, 12.0, 1.0]);
}

#[test]
fn rule_04_modes_around_source_and_target_are_not_left() {
    let run = simulate_by_both_forms(&with_trace(
        "initial mode Out { entry { trace := 10*trace + 1 }  exit { trace := 10*trace + 2 }
           initial mode P { exit { trace := 10*trace + 3 }  after 1 -> Q }
           mode Q { entry { trace := 10*trace + 4 }  initial mode R { after 1 -> Out.P }  exit { trace := 10*trace + 5 } } }",
    ));
    // t = 1: 13, 134; t = 2: Q is left, 1345; then P and Q change places at 3, 4, ... 10
    assert!(run.log().iter().all(|line| !line.contains("Off")));
    assert_eq!(run.log()[..2], ["0 A.P->Q a Out.P->Out.Q.R", "0 A.R->P a Out.Q.R->Out.P"]);
    assert_eq!(run.value("a.trace"), 1_345_345_345_345_345.0);
}

#[test]
fn rule_04_a_transition_into_its_own_mode_leaves_and_enters_it() {
    let run = simulate_by_both_forms(&with_trace(
        "initial mode Out { entry { trace := 10*trace + 1 }  exit { trace := 10*trace + 2 }
           group: after 3 -> Q
           initial mode P { }
           mode Q { entry { trace := 10*trace + 3 } } }",
    ));
    assert_eq!(
        run.log(),
        ["0 A.group a Out.P->Out.Q", "0 A.group a Out.Q->Out.Q", "0 A.group a Out.Q->Out.Q"]
    );
    all_near(&run.times("A.group"), &[3.0, 6.0, 9.0], 1e-9);
    assert_eq!(run.value("a.trace"), 1_213_213_213.0);
}

#[test]
fn rule_04_targets_are_looked_up_from_the_inside_out() {
    let run = simulate(
        "agent A { initial mode Out { initial mode P { initial mode Q { after 1 -> X } }  mode X { after 1 -> Else.X } }
           mode X { }
           mode Else { initial mode Y { }  mode X { after 1 -> Out } } }
         system { a = A() }  run { until 3.5 }",
    );
    assert_eq!(
        run.log(),
        ["0 A.Q->X a Out.P.Q->Out.X", "0 A.X->X a Out.X->Else.X", "0 A.X->Out a Else.X->Out.P.Q"]
    );
    let text = refused("agent A { initial mode P { when time > 1 -> Q.R }  mode Q { initial mode S { } } }");
    assert!(text.contains("HY0204") && text.contains("mode `Q`"), "{text}");
}

#[test]
fn rule_04_is_holds_in_a_mode_and_inside_it() {
    let run = simulate_by_both_forms(
        "agent A { initial mode Out { initial mode P { after 1 -> Q }  mode Q { initial mode R { after 1 -> Off } } }
           mode Off { } }
         agent B { link a: A  discrete n = 0
           out: when a is Out { n := n + 1 }
           q: when a is Out.Q { n := n + 10 }
           r: when a is Out.Q.R { n := n + 100 }
           off: when not (a is Out) { n := n + 1000 } }
         system { a = A()  b = B(a = a) }  run { until 3 }",
    );
    assert_eq!(run.times("B.out"), [0.0]);
    all_near(&[run.times("B.q")[0], run.times("B.r")[0], run.times("B.off")[0]], &[1.0, 1.0, 2.0], 1e-9);
    assert_eq!(run.value("b.n"), 1111.0);
}

#[test]
fn rule_04_is_of_the_agent_itself_is_looked_up_in_its_mode() {
    let run = simulate(
        "agent A { discrete n = 0
           initial mode Out { see: when self is In { n := n + 1 }
             initial mode Before { after 1 -> In }  mode In { after 1 -> Before } } }
         system { a = A() }  run { until 3.5 }",
    );
    all_near(&run.times("A.see"), &[1.0, 3.0], 1e-9);
}

#[test]
fn rule_04_history_is_the_submode_that_was_active_last() {
    let run = simulate_by_both_forms(
        "agent A { state x = 0  flow { x' = 1 }
           initial mode Off { wake: after 1 -> M.history }
           mode M { off: after 2.5 -> Off
             initial mode P { after 2 -> Q }
             mode Q { initial mode R { after 1 -> S }  mode S { after 2 -> P } } } }
         system { a = A() }  run { until 9 }",
    );
    assert_eq!(
        run.log(),
        [
            // never active: the initial one
            "0 A.wake a Off->M.P",
            "0 A.P->Q a M.P->M.Q.R",
            "0 A.off a M.Q.R->Off",
            // shallow: Q, but at its own initial mode
            "0 A.wake a Off->M.Q.R",
            "0 A.R->S a M.Q.R->M.Q.S",
            "0 A.off a M.Q.S->Off",
            "0 A.wake a Off->M.Q.R",
            "0 A.R->S a M.Q.R->M.Q.S",
        ]
    );
    all_near(
        &[run.times("A.wake")[0], run.times("A.wake")[1], run.times("A.wake")[2]],
        &[1.0, 4.5, 8.0],
        1e-9,
    );
}

#[test]
fn rule_04_history_follows_a_start_inside_and_every_entry() {
    let run = simulate_by_both_forms(
        "agent A { initial mode Off { wake: after 1 -> M.history }
           mode M { off: after 1 -> Off
             initial mode P { }
             mode Q { }
             mode R { } }
           go: when time >= 2.5 -> M.R }
         system { a = A() in M.Q  b = A() }  run { until 4 }",
    );
    let of = |agent: &str| -> Vec<String> {
        run.log().into_iter().filter(|line| line.contains(&format!(" {agent} "))).collect()
    };
    assert_eq!(
        of("a"),
        ["0 A.off a M.Q->Off", "0 A.wake a Off->M.Q", "0 A.go a M.Q->M.R", "0 A.off a M.R->Off"]
    );
    assert_eq!(
        of("b"),
        ["0 A.wake b Off->M.P", "0 A.off b M.P->Off", "0 A.go b Off->M.R", "0 A.off b M.R->Off"]
    );
}

#[test]
fn rule_04_history_inside_the_mode_itself_names_the_present_submode() {
    let run = simulate_by_both_forms(
        "agent A { initial mode M { again: every 1.5 when time < 4 -> M.history
             initial mode P { go: after 1 -> Q }
             mode Q { } } }
         system { a = A() }  run { until 4 }",
    );
    assert_eq!(run.log(), ["0 A.go a M.P->M.Q", "0 A.again a M.Q->M.Q", "0 A.again a M.Q->M.Q"]);
    all_near(&run.times("A.again"), &[1.5, 3.0], 1e-9);
}

#[test]
fn rule_04_an_interaction_changes_modes_by_path_and_history() {
    let run = simulate_by_both_forms(
        "agent A(id: int) { state x = 0  flow { x' = 1 }
           initial mode M { exit { x := x + 100 }
             initial mode P { after 1 -> Q }
             mode Q { entry { x := x + 10 } } }
           mode Off { initial mode Cold { } } }
         interaction Switch(a: A, b: A) {
           out: when time >= 2 and a.id < b.id { a -> Off  b -> M.P }
           back: when time >= 3 and a.id < b.id { a -> M.history } }
         system { a = A(id = 0)  b = A(id = 1) }  run { until 3.5 }",
    );
    assert_eq!(
        run.log(),
        [
            "0 A.P->Q a M.P->M.Q",
            "0 A.P->Q b M.P->M.Q",
            "0 Switch.out a b M.Q->Off.Cold",
            "0 Switch.out b a M.Q->M.P",
            "0 Switch.back a b Off.Cold->M.Q",
            "0 A.P->Q b M.P->M.Q",
        ]
    );
    near(run.value("a.x"), 123.5, 1e-9);
}

#[test]
fn rule_04_write_sets_have_the_exits_and_entries_of_all_levels() {
    // Out's exit writes n: the pair's write of n has to wait although the transition itself writes nothing
    let run = simulate(
        "agent A(id: int) { discrete n = 0
           initial mode Out { exit { n := n + 1 }  initial mode In { go: when time >= 1 -> Off } }
           mode Off { } }
         interaction Add(a: A, b: A) { add: when time >= 1 and a.id < b.id { a.n := a.n + 10  b.n := b.n + 10 } }
         system { a = A(id = 0)  b = A(id = 1) }  run { until 2 }",
    );
    assert_eq!(run.log(), ["0 Add.add a b", "1 A.go a Out.In->Off", "1 A.go b Out.In->Off"]);
    assert_eq!([run.value("a.n"), run.value("b.n")], [11.0, 11.0]);
}

#[test]
fn rule_08_an_invariant_of_an_outer_mode_holds_inside() {
    let (run, found) = simulate_error(
        "agent A { state x = 0  flow { x' = 1 }
           initial mode Out { invariant x <= 2 \"too far\"
             initial mode P { after 1 -> Q }
             mode Q { } } }
         system { a = A() }  run { until 5 }",
    );
    assert!(words(&[found]).contains("HY0501"));
    near(run.time, 2.0, 1e-9);
    // outside of the mode it is no claim
    let run = simulate(
        "agent A { state x = 0  flow { x' = 1 }
           initial mode Out { invariant x <= 2  assert x <= 1  initial mode P { when x >= 1.5 -> Off } }
           mode Off { } }
         system { a = A() }  run { until 5 }",
    );
    assert_eq!(run.false_asserts.len(), 1);
    near(run.false_asserts[0].time, 1.0, 1e-9);
    assert_eq!(run.false_asserts[0].mode, "Out.P");
}

#[test]
fn rule_11_after_and_every_of_an_outer_mode_count_from_its_own_entry() {
    let run = simulate_by_both_forms(
        "agent A { initial mode Off { after 0.5 -> Out }
           mode Out { late: after 3 -> Off  tick: every 1 { }
             initial mode P { flip: after 0.7 -> Q }
             mode Q { flop: after 0.7 -> P } } }
         system { a = A() }  run { until 6 }",
    );
    all_near(&run.times("A.late"), &[3.5], 1e-9);
    all_near(&run.times("A.tick"), &[1.5, 2.5, 5.0, 6.0], 1e-9);
    all_near(&run.times("A.flip"), &[1.2, 2.6, 4.7], 1e-9);
    all_near(&run.times("A.flop"), &[1.9, 3.3, 5.4], 1e-9);
}

#[test]
fn rule_04_what_has_no_modes_inside_has_no_history() {
    let text = refused("agent A { initial mode P { when time > 1 -> Q.history }  mode Q { } }");
    assert!(text.contains("HY0248") && text.contains("`Q` has no modes inside"), "{text}");
    let text = refused("agent A { initial mode history { } }");
    assert!(text.contains("HY0118"), "{text}");
}

#[test]
fn rule_04_listings_tell_the_tree() {
    let case = Case::new(
        "agent A { initial mode Off { wake: after 1 -> M.history }  mode M { initial mode P { } mode Q { } } }
         system { a = A() }  run { until 1 }",
    );
    let (model, system, _) = case.system();
    let text = hyc::model::dump(&model);
    assert!(text.contains("A.wake: after 1 [Off -> M.history]"), "{text}");
    let text = hyc::calculus::dump(&system);
    assert!(text.contains("transition A.wake of Off -> M.history"), "{text}");
}
