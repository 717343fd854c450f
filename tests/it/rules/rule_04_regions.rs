//! Regions: rules 1, 2, 4, 8 and 11 where modes are active beside each other. Every log is worked out by hand.

use crate::harness::{
    Case, all_near, near, refused, simulate, simulate_by_both_forms, simulate_error, words,
};

#[test]
fn rule_01_flows_of_all_regions_hold_together() {
    let run = simulate_by_both_forms(
        "agent A { state x = 0, y = 0, z = 0
           flow { z' = x' + y' }
           region P { initial mode Slow { flow { x' = 1 }  when x >= 2 -> Fast }  mode Fast { flow { x' = 3 } } }
           region Q { initial mode Up { flow { y' = 1 }  after 3 -> Down }  mode Down { flow { y' = -1 } } } }
         system { a = A() }  run { until 4 }",
    );
    assert_eq!(run.log(), ["0 A.Slow->Fast a P.Slow->P.Fast", "0 A.Up->Down a Q.Up->Q.Down"]);
    all_near(&[run.value("a.x"), run.value("a.y"), run.value("a.z")], &[8.0, 2.0, 10.0], 1e-9);
    assert_eq!(run.mode("a"), "P.Fast|Q.Down");
}

#[test]
fn rule_01_a_flow_of_one_region_reads_what_the_other_does() {
    // x' is 1 while y rises, 2 while it stands
    let run = simulate_by_both_forms(
        "agent A { state x = 0, y = 0
           region P { flow { x' = 2 - y' } }
           region Q { initial mode Up { flow { y' = 1 }  when x >= 1 -> Still }  mode Still { flow { y' = 0 } } } }
         system { a = A() }  run { until 3 }",
    );
    all_near(&run.times("A.Up->Still"), &[1.0], 1e-9);
    near(run.value("a.x"), 5.0, 1e-9);
}

#[test]
fn rule_01_every_state_has_one_flow_in_every_combination() {
    let text = refused(
        "agent A { state x = 0
           region P { initial mode P1 { flow { x' = 1 } }  mode P2 { } }
           region Q { initial mode Q1 { }  mode Q2 { flow { x' = 2 } } } }",
    );
    assert!(text.contains("HY0240") && text.contains("`P.P2|Q.Q1`"), "{text}");
    assert!(text.contains("HY0241"), "{text}");
}

#[test]
fn rule_01_an_instance_starts_in_a_mode_of_one_region_and_the_initial_ones_of_the_others() {
    let run = simulate(
        "agent A { region P { initial mode P1 { }  mode P2 { initial mode In { } } }
                   region Q { initial mode Q1 { }  mode Q2 { } }
                   region Alone { } }
         system { a = A()  b = A() in Q.Q2  c = A() in P.P2 }  run { until 1 }",
    );
    assert_eq!(
        [run.mode("a"), run.mode("b"), run.mode("c")],
        ["P.P1|Q.Q1|Alone", "P.P1|Q.Q2|Alone", "P.P2.In|Q.Q1|Alone"]
    );
}

#[test]
fn rule_02_a_change_in_one_region_arms_nothing_in_another() {
    let run = simulate_by_both_forms(
        "agent A { state x = 0  discrete n = 0  flow { x' = 1 }
           region P { initial mode P1 { once: when x >= 1 { n := n + 1 }  late: after 2.5 { } } }
           region Q { initial mode Q1 { flip: every 0.4 -> Q1 } } }
         system { a = A() }  run { until 3 }",
    );
    all_near(&run.times("A.once"), &[1.0], 1e-9);
    all_near(&run.times("A.late"), &[2.5], 1e-9);
    assert_eq!(run.times("A.flip").len(), 7);
}

#[test]
fn rule_04_a_mode_that_goes_to_the_history_of_its_region_leaves_other_regions_alone() {
    let run = simulate_by_both_forms(
        "agent A { discrete n = 0
           region P { initial mode P1 { exit { n := n + 10 }  late: after 3 -> P2 }  mode P2 { } }
           region Q { initial mode Q1 { after 1 -> Q.history { n := n + 1 } }  mode Q2 { } } }
         system { a = A() }  run { until 3.5 }",
    );
    let again = "A.Q1->Q.history a Q.Q1->Q.Q1";
    // At 3 both write n: the second waits for the next micro-step.
    let log =
        [format!("0 {again}"), format!("0 {again}"), "0 A.late a P.P1->P.P2".into(), format!("1 {again}")];
    assert_eq!(run.log(), log);
    assert_eq!(run.value("a.n"), 13.0);
    assert_eq!(run.mode("a"), "P.P2|Q.Q1");
}

#[test]
fn rule_04_each_region_has_its_turn_in_one_micro_step() {
    let run = simulate_by_both_forms(
        "agent A { discrete p = 0, q = 0
           region P { initial mode P1 { after 1 -> P2 { p := q + 1 } }  mode P2 { after 1 -> P1 { p := q + 10 } } }
           region Q { initial mode Q1 { after 1 -> Q2 { q := p + 5 } }  mode Q2 { } } }
         system { a = A() }  run { until 2.5 }",
    );
    assert_eq!(run.log(), ["0 A.P1->P2 a P.P1->P.P2", "0 A.Q1->Q2 a Q.Q1->Q.Q2", "0 A.P2->P1 a P.P2->P.P1"]);
    // both read the state before: p = 0 + 1, q = 0 + 5; then p = 5 + 10
    assert_eq!([run.value("a.p"), run.value("a.q")], [15.0, 5.0]);
    assert_eq!(run.mode("a"), "P.P1|Q.Q2");
}

#[test]
fn rule_04_one_transition_of_a_region_in_a_micro_step() {
    let run = simulate_by_both_forms(
        "agent A { discrete a = 0, b = 0, c = 0
           region P { initial mode P1 { one: when time >= 1 { a := 1 }  two: when time >= 1 { b := 1 } } }
           region Q { initial mode Q1 { three: when time >= 1 { c := 1 } } } }
         system { x = A() }  run { until 2 }",
    );
    assert_eq!(run.log(), ["0 A.one x", "0 A.three x", "1 A.two x"]);
}

#[test]
fn rule_04_an_agent_level_transition_takes_all_regions() {
    let run = simulate_by_both_forms(
        "agent A { discrete n = 0
           all: when time >= 1 { }
           region P { initial mode P1 { one: when time >= 1 -> P2 }  mode P2 { } }
           region Q { initial mode Q1 { two: when time >= 1 -> Q2 }  mode Q2 { } } }
         system { a = A() }  run { until 2 }",
    );
    assert_eq!(run.log(), ["0 A.all a", "1 A.one a P.P1->P.P2", "1 A.two a Q.Q1->Q.Q2"]);
}

#[test]
fn rule_04_with_priority_a_region_comes_before_the_agent() {
    let run = simulate_by_both_forms(
        "agent A { all: when time >= 1 { }
           region P { initial mode P1 { one: when time >= 1 priority 1 -> P2 }  mode P2 { } }
           region Q { initial mode Q1 { two: when time >= 1 -> Q2 }  mode Q2 { } } }
         system { a = A() }  run { until 2 }",
    );
    // one takes P, so all has to wait; two is taken beside one
    assert_eq!(run.log(), ["0 A.one a P.P1->P.P2", "0 A.two a Q.Q1->Q.Q2", "1 A.all a"]);
}

#[test]
fn rule_04_regions_that_write_the_same_take_turns() {
    let run = simulate_by_both_forms(
        "agent A { discrete n = 1
           region P { initial mode P1 { after 1 -> P2 { n := 10*n } }  mode P2 { } }
           region Q { initial mode Q1 { after 1 -> Q2 { n := n + 1 } }  mode Q2 { } } }
         system { a = A() }  run { until 2 }",
    );
    assert_eq!(run.log(), ["0 A.P1->P2 a P.P1->P.P2", "1 A.Q1->Q2 a Q.Q1->Q.Q2"]);
    assert_eq!(run.value("a.n"), 11.0);
    // what was passed over is tested again: it may be true no more
    let run = simulate_by_both_forms(
        "agent A { discrete n = 1
           region P { initial mode P1 { when time >= 1 and n == 1 -> P2 }  mode P2 { entry { n := 2 } } }
           region Q { initial mode Q1 { exit { n := 3 }  when time >= 1 and n == 1 -> Q2 }  mode Q2 { } } }
         system { a = A() }  run { until 2 }",
    );
    assert_eq!(run.log(), ["0 A.P1->P2 a P.P1->P.P2"]);
}

#[test]
fn rule_04_a_transition_of_the_region_itself_is_outside_of_its_modes_alone() {
    let run = simulate_by_both_forms(
        "agent A {
           region P { group: when time >= 1 -> P3
             initial mode P1 { one: when time >= 1 -> P2 }  mode P2 { }  mode P3 { } }
           region Q { initial mode Q1 { two: when time >= 1 -> Q2 }  mode Q2 { } } }
         system { a = A() }  run { until 2 }",
    );
    assert_eq!(run.log(), ["0 A.group a P.P1->P.P3", "0 A.two a Q.Q1->Q.Q2"]);
}

#[test]
fn rule_04_a_transition_of_the_agent_leaves_the_modes_of_all_regions() {
    let run = simulate_by_both_forms(
        "agent A { discrete left = 0, entered = 0
           reset: after 3 -> P.P3
           region P { initial mode P1 { after 1 -> P2 }  mode P2 { exit { left := 10*left + 2 } }
                      mode P3 { entry { entered := 10*entered + 3 } } }
           region Q { entry { entered := 9 }  exit { left := 9 }
                      initial mode Q1 { entry { entered := 10*entered + 1 }  after 1 -> Q2 }
                      mode Q2 { exit { left := 10*left + 4 } } } }
         system { a = A() }  run { until 3.5 }",
    );
    assert_eq!(
        run.log(),
        ["0 A.P1->P2 a P.P1->P.P2", "0 A.Q1->Q2 a Q.Q1->Q.Q2", "0 A.reset a P.P2|Q.Q2->P.P3|Q.Q1"]
    );
    assert_eq!(run.mode("a"), "P.P3|Q.Q1");
    // modes beside each other read nothing of each other, the region declared last is the last to write; regions are never left
    assert_eq!([run.value("a.left"), run.value("a.entered")], [4.0, 911.0]);
}

#[test]
fn rule_04_an_interaction_that_changes_a_mode_takes_all_regions_of_that_agent() {
    let run = simulate_by_both_forms(
        "agent A(id: int) { discrete n = 0
           region P { initial mode P1 { }  mode P2 { } }
           region Q { initial mode Q1 { own: when time >= 1 -> Q2 }  mode Q2 { } } }
         interaction Meet(a: A, b: A) { meet: when time >= 1 and a.id < b.id { a -> P.P2  b.n := 1 } }
         system { a = A(id = 0)  b = A(id = 1) }  run { until 2 }",
    );
    // b only has n written: its region Q has its turn beside the interaction
    assert_eq!(
        run.log(),
        ["0 Meet.meet a b P.P1|Q.Q1->P.P2|Q.Q1", "0 A.own b Q.Q1->Q.Q2", "1 A.own a Q.Q1->Q.Q2"]
    );
    assert_eq!([run.mode("a"), run.mode("b")], ["P.P2|Q.Q2", "P.P1|Q.Q2"]);
}

#[test]
fn rule_04_each_region_has_its_history() {
    let run = simulate_by_both_forms(
        "agent A {
           fail: every 2.5 -> P.Off
           region P {
             initial mode Run { initial mode R1 { after 1 -> R2 }  mode R2 { after 1 -> R3 }  mode R3 { } }
             mode Off { after 1 -> Run.history } }
           region Q { initial mode Q1 { after 0.7 -> Q2 }  mode Q2 { } } }
         system { a = A() }  run { until 4 }",
    );
    assert_eq!(
        run.log(),
        [
            "0 A.Q1->Q2 a Q.Q1->Q.Q2",
            "0 A.R1->R2 a P.Run.R1->P.Run.R2",
            "0 A.R2->R3 a P.Run.R2->P.Run.R3",
            "0 A.fail a P.Run.R3|Q.Q2->P.Off|Q.Q1",
            "0 A.Q1->Q2 a Q.Q1->Q.Q2",
            "0 A.Off->Run.history a P.Off->P.Run.R3",
        ]
    );
    // the history of a region itself
    let run = simulate_by_both_forms(
        "agent A {
           again: after 1.5 -> P.history
           region P { initial mode P1 { after 1 -> P2 }  mode P2 { } } }
         system { a = A() }  run { until 4 }",
    );
    assert_eq!(run.log(), ["0 A.P1->P2 a P.P1->P.P2", "0 A.again a P.P2->P.P2"]);
}

#[test]
fn rule_04_is_names_the_mode_of_a_region() {
    let run = simulate_by_both_forms(
        "agent A { discrete n = 0
           region P { initial mode P1 { after 1 -> P2 }  mode P2 { initial mode In { after 1 -> Out }  mode Out { } } }
           region Q { initial mode Wait { go: when self is P.P2 -> Next }
                      mode Next { deep: when self is P.P2.Out { n := 1 } } } }
         agent B { link a: A  discrete n = 0
           both: when a is P.P2 and a is Q.Next { n := n + 1 }
           gone: when not (a is P.P1) { n := n + 10 }
           ever: when a is P { n := n + 100 } }
         system { a = A()  b = B(a = a) }  run { until 3 }",
    );
    assert_eq!(
        run.log(),
        [
            "0 B.ever b",
            "0 A.P1->P2 a P.P1->P.P2.In",
            "1 B.gone b",
            "1 A.go a Q.Wait->Q.Next",
            "2 B.both b",
            "0 A.In->Out a P.P2.In->P.P2.Out",
            "1 A.deep a",
        ]
    );
}

#[test]
fn rule_08_claims_of_a_region_hold_while_their_mode_is_active() {
    let (run, found) = simulate_error(
        "agent A { state x = 0  flow { x' = 1 }
           region P { initial mode P1 { after 1 -> P2 }  mode P2 { invariant x <= 2 } }
           region Q { initial mode Q1 { } } }
         system { a = A() }  run { until 5 }",
    );
    near(run.time, 2.0, 1e-9);
    let told = words(&[found]);
    assert!(told.contains("HY0501") && told.contains("P.P2|Q.Q1"), "{told}");
}

#[test]
fn rule_16_the_mode_of_an_agent_with_regions_is_recorded_as_a_combination() {
    let run = simulate_by_both_forms(
        "agent A { state x = 0  flow { x' = 1 }
           region P { let twice = 2*x  initial mode P1 { after 1 -> P2 }  mode P2 { } }
           region Q { initial mode Q1 { } } }
         system { a = A() }  run { until 2  record a every 1 to \"a.csv\" }",
    );
    let modes: Vec<&str> = run.samples[0].iter().map(|sample| sample.mode.as_str()).collect();
    assert_eq!(modes, ["P.P1|Q.Q1", "P.P2|Q.Q1", "P.P2|Q.Q1"]);
}

#[test]
fn rule_01_modes_stand_in_regions_or_there_are_none() {
    let text = refused("agent A { region P { initial mode P1 { } }  initial mode M { } }");
    assert!(text.contains("HY0249") && text.contains("`M` stands beside a region"), "{text}");
    let text = refused("agent A { region P { mode P1 { } } }");
    assert!(text.contains("HY0243") && text.contains("region `P` has modes"), "{text}");
    let text = refused("agent A { region P { initial mode P1 { } }  region P { initial mode P1 { } } }");
    assert!(text.contains("HY0205"), "{text}");
}

#[test]
fn rule_04_a_region_changes_its_own_mode_only() {
    let text = refused(
        "agent A { region P { initial mode P1 { when time >= 1 -> Q.Q1 } }  region Q { initial mode Q1 { } } }",
    );
    assert!(text.contains("HY0255") && text.contains("of region `P` leads into region `Q`"), "{text}");
}

#[test]
fn rule_01_how_many_combinations_there_are_is_limited() {
    let region = |name: &str| {
        let modes: Vec<String> = (1..11).map(|k| format!("mode {name}{k} {{ }}")).collect();
        format!("region {name} {{ initial {} }}", modes.join(" "))
    };
    let text = refused(&format!("agent A {{ {} }}", ["P", "Q", "R", "S"].map(region).join(" ")));
    assert!(
        text.contains("HY0293") && text.contains("10000 combinations of modes, more than 1000"),
        "{text}"
    );
    assert!(text.contains("--limit max_configurations=N"), "{text}");
}

#[test]
fn rule_04_listings_tell_regions_and_their_combinations() {
    let case = Case::new(
        "agent A { state x = 0
           region P { initial mode P1 { flow { x' = 1 }  after 1 -> P2 }  mode P2 { flow { x' = 2 } } }
           region Q { initial mode Q1 { } } }
         system { a = A() }  run { until 1 }",
    );
    let (model, system, _) = case.system();
    let text = hyc::model::dump(&model);
    assert!(text.contains("region P\n") && text.contains("initial mode P.P1\n"), "{text}");
    let text = hyc::calculus::dump(&system);
    assert!(text.contains("mode P.P2|Q.Q1\n    x' = 2"), "{text}");
}
