//! Rule 2: one flag for each guard instance; level on entry, edge afterwards; witnesses, `rising`, `crossing`.

use std::f64::consts::PI;

use crate::harness::{all_near, near, simulate};

#[test]
fn rule_02_a_guard_that_is_true_on_entry_fires_on_entry() {
    let run = simulate(
        "agent A { state x = 5  discrete n = 0  flow { x' = 1 }  go: when x >= 1 { n := n + 1 } }
         system { a = A() }  run { until 3 }",
    );
    assert_eq!(run.times("A.go"), [0.0]);
    assert_eq!(run.value("a.n"), 1.0);
}

#[test]
fn rule_02_edge_afterwards_armed_again_when_false() {
    // sin t >= 1/2 at pi/6 + 2 k pi
    let run = simulate(
        "agent A { state x = 0  flow { x' = cos(time) }  go: when x >= 0.5 { } }
         system { a = A() }  run { until 20  tolerance 1e-11 }",
    );
    let expected: Vec<f64> =
        (0..4).map(|k| PI / 6.0 + 2.0 * PI * f64::from(k)).filter(|t| *t <= 20.0).collect();
    all_near(&run.times("A.go"), &expected, 1e-9);
}

#[test]
fn rule_02_a_self_transition_that_names_the_mode_arms_again() {
    // from 2 down in quarters while x >= 1: five firings at once; then x grows from 0.75, one every quarter
    let run = simulate(
        "agent A { state x = 2  discrete n = 0
           initial mode M { flow { x' = 1 }  go: when x >= 1 -> M { n := n + 1  x := x - 0.25 } } }
         system { a = A() }  run { until 1.1 }",
    );
    all_near(&run.times("A.go"), &[0.0, 0.0, 0.0, 0.0, 0.0, 0.25, 0.5, 0.75, 1.0], 1e-11);
    assert_eq!(run.log()[4], "4 A.go a M->M");
}

#[test]
fn rule_02_a_transition_without_a_target_does_not_arm_again() {
    let run = simulate(
        "agent A { state x = 2  discrete n = 0
           initial mode M { flow { x' = 1 }  go: when x >= 1 { n := n + 1  x := x - 0.25 } } }
         system { a = A() }  run { until 1.1 }",
    );
    assert_eq!(run.log(), ["0 A.go a"]);
    near(run.value("a.x"), 2.85, 1e-12);
}

#[test]
fn rule_02_a_transition_without_a_target_neither_leaves_nor_enters() {
    let run = simulate(
        "agent A { state x = 0  discrete entered: int = 0, left: int = 0, n: int = 0
           flow { x' = 1 }
           initial mode M {
             entry { entered := entered + 1 }
             exit { left := left + 1 }
             tick: every 1 { n := n + 1 }
             late: after 2.5 { n := n + 10 }
             again: when x >= 3.25 -> M { x := -100 } } }
         system { a = A() }  run { until 5 }",
    );
    assert_eq!([run.value("a.entered"), run.value("a.left")], [2.0, 1.0]);
    // ticks at 1, 2, 3 of the first entry, at 4.25 of the second; `late` once in each would be 2.5 and 5.75
    all_near(&run.times("A.tick"), &[1.0, 2.0, 3.0, 4.25], 1e-11);
    assert_eq!(run.times("A.late"), [2.5]);
}

#[test]
fn rule_02_a_self_transition_leaves_and_enters() {
    let run = simulate(
        "agent A { state x = 0  discrete entered: int = 0, left: int = 0
           flow { x' = 1 }
           initial mode M {
             entry { entered := entered + 1 }
             exit { left := left + 1 }
             again: when x >= 1 -> M { x := 0 } } }
         system { a = A() }  run { until 3.5 }",
    );
    all_near(&run.times("A.again"), &[1.0, 2.0, 3.0], 1e-11);
    assert_eq!([run.value("a.entered"), run.value("a.left")], [4.0, 3.0]);
}

#[test]
fn rule_02_a_reset_that_makes_a_guard_true_counts() {
    let run = simulate(
        "agent A { state x = 0  discrete n = 0  flow { x' = 0 }
                   tick: every 1 { x := 5 }
                   hit: when x >= 5 { n := n + 1 } }
         system { a = A() }  run { until 3 }",
    );
    assert_eq!(run.log(), ["0 A.tick a", "1 A.hit a", "0 A.tick a", "0 A.tick a"]);
    assert_eq!(run.times("A.hit"), [1.0]);
}

#[test]
fn rule_02_a_reset_makes_a_guard_false_and_another_true_again() {
    let run = simulate(
        "agent A { state x = 0  discrete n = 0  flow { x' = 0 }
                   tick: every 1 { x := 5 - x }
                   hit: when x >= 5 { n := n + 1 } }
         system { a = A() }  run { until 4 }",
    );
    assert_eq!(run.times("A.hit"), [1.0, 3.0]);
}

#[test]
fn rule_02_false_and_true_within_one_instant_fires_again() {
    // at 1 the value goes 5 -> 0 -> 5 in three micro-steps: the guard has been false in between
    let run = simulate(
        "agent A { discrete x = 5, step: int = 0
                   down: every 1 { x := 0  step := 1 }
                   up: when step == 1 { x := 5  step := 0 }
                   hit: when x >= 5 { } }
         system { a = A() }  run { until 1.5 }",
    );
    assert_eq!(run.log(), ["0 A.hit a", "0 A.down a", "1 A.up a", "2 A.hit a"]);
}

#[test]
fn rule_02_being_false_at_a_single_point_does_not_arm() {
    for guard in ["(x - 1)^2 > 0", "x < 1 or x > 1", "abs(x - 1) > 0", "-(x - 1)^2 < 0"] {
        let run = simulate(&format!(
            "agent A {{ state x = 0  flow {{ x' = 1 }}  go: when {guard} {{ }} }}
             system {{ a = A() }}  run {{ until 3 }}"
        ));
        assert_eq!(run.times("A.go"), [0.0], "{guard}");
    }
}

#[test]
fn rule_02_being_false_for_a_while_arms() {
    let run = simulate(
        "agent A { state x = 0  flow { x' = 1 }  go: when (x - 1)^2 >= 0.25 { } }
         system { a = A() }  run { until 3 }",
    );
    all_near(&run.times("A.go"), &[0.0, 1.5], 1e-11);
}

#[test]
fn rule_02_arming_looks_at_the_state_after_the_entry_actions() {
    let run = simulate(
        "agent A { state x = 0  flow { x' = 1 }
           initial mode First { go: when x >= 1 -> Second }
           mode Second { entry { x := 0 }  back: when x >= 1 { } } }
         system { a = A() }  run { until 3 }",
    );
    all_near(&run.times("A.back"), &[2.0], 1e-11);
    // and the other way: the entry action makes it true
    let run = simulate(
        "agent A { state x = 0  flow { x' = 1 }
           initial mode First { go: when x >= 1 -> Second }
           mode Second { entry { x := 7 }  back: when x >= 5 { } } }
         system { a = A() }  run { until 3 }",
    );
    all_near(&run.times("A.back"), &[1.0], 1e-11);
    assert_eq!(run.log()[1], "1 A.back a");
}

#[test]
fn rule_02_leaving_a_mode_drops_its_guards() {
    // First's second guard would be true at 2, but nobody is there
    let run = simulate(
        "agent A { state x = 0  flow { x' = 1 }
           initial mode First { go: when x >= 1 -> Second  late: when x >= 2 { } }
           mode Second { back: when x >= 3 -> First { x := -10 } } }
         system { a = A() }  run { until 4 }",
    );
    assert_eq!(run.log(), ["0 A.go a First->Second", "0 A.back a Second->First"]);
}

#[test]
fn rule_02_the_witness_is_the_lowest_number() {
    let run = simulate(
        "agent W { discrete seen = 0  look: when exists o in P: o.x >= 1 { seen := o.id } }
         agent P(id: real, v: real) { state x = 0  flow { x' = v } }
         system { w = W()  p = P[3](id = 100 + index, v = if index == 0 then 0.5 else 1) }
         run { until 1.5 }",
    );
    assert_eq!(run.value("w.seen"), 101.0);
    all_near(&run.times("W.look"), &[1.0], 1e-11);
}

#[test]
fn rule_02_an_exists_guard_is_one_flag() {
    // three pass 1 at t = 1, 1.25, 2 and are true from then on: the guard as a whole becomes true once
    let run = simulate(
        "agent W { discrete n = 0  look: when exists o in P: o.x >= 1 { n := n + 1 } }
         agent P(v: real) { state x = 0  flow { x' = v } }
         system { w = W()  a = P(v = 1)  b = P(v = 0.8)  c = P(v = 0.5) }
         run { until 3 }",
    );
    all_near(&run.times("W.look"), &[1.0], 1e-11);
}

#[test]
fn rule_02_the_witness_is_a_term_of_the_outermost_and() {
    let run = simulate(
        "agent W { state t = 0  discrete seen = 0
                   flow { t' = 1 }
                   look: when t >= 1 and exists o in P where o.id >= 2: o.x >= 1 { seen := o.id } }
         agent P(id: real) { state x = 5  flow { x' = 0 } }
         system { w = W()  p = P[4](id = index) }
         run { until 2 }",
    );
    assert_eq!(run.value("w.seen"), 2.0);
    all_near(&run.times("W.look"), &[1.0], 1e-11);
}

#[test]
fn rule_02_other_leaves_out_self() {
    let run = simulate(
        "agent P(id: real) { state x = id  discrete seen = -1
                             flow { x' = 0 }
                             look: when exists o in other P: o.x >= 1 { seen := o.id }
                             all: when forall o in other P: o.x < 2 { } }
         system { p = P[3](id = index) }
         run { until 1 }",
    );
    assert_eq!([run.value("p[0].seen"), run.value("p[1].seen"), run.value("p[2].seen")], [1.0, 2.0, 1.0]);
    let all: Vec<&str> =
        run.events.iter().filter(|e| e.transition == "P.all").map(|e| e.agent.as_str()).collect();
    assert_eq!(all, ["p[2]"]);
}

#[test]
fn rule_02_nobody_searches_for_self_where_other_leaves_it_out() {
    // o.x - x would be zero all the time for o = self, a root that can neither be excluded nor isolated
    let run = simulate(
        "agent Runner(v: real) { state x = 0  flow { x' = v*time }
                                 overtaken: when exists o in other Runner: o.x > x + 4 { }
                                 behind: when exists o in other Runner: o.x > x { } }
         system { slow = Runner(v = 1)  fast = Runner(v = 3) }
         run { until 3  tolerance 1e-10 }",
    );
    assert_eq!(run.stats.undecided_roots, 0);
    assert_eq!(run.log(), ["0 Runner.behind slow", "0 Runner.overtaken slow"]);
    all_near(&[0.0, 2.0], &run.events.iter().map(|event| event.time).collect::<Vec<_>>(), 1e-9);
}

#[test]
fn rule_02_rising_waits_until_the_condition_has_been_false() {
    // x = sin t; x >= -1/2 is true at once, false from 7 pi/6 to 11 pi/6
    let text = |guard: &str| {
        format!(
            "agent A {{ state x = 0  flow {{ x' = cos(time) }}  go: when {guard} {{ }} }}
             system {{ a = A() }}  run {{ until 7  tolerance 1e-11 }}"
        )
    };
    let back = 11.0 * PI / 6.0;
    all_near(&simulate(&text("x >= -0.5")).times("A.go"), &[0.0, back], 1e-9);
    all_near(&simulate(&text("rising(x >= -0.5)")).times("A.go"), &[back], 1e-9);
    all_near(&simulate(&text("rising(x >= 0.5)")).times("A.go"), &[PI / 6.0, 13.0 * PI / 6.0], 1e-9);
}

#[test]
fn rule_02_rising_does_not_take_the_end_of_its_condition_for_its_begin() {
    // x = cos t falls through 0 at pi/2, where another transition writes the agent, and rises at 3 pi/2
    let run = simulate(
        "agent A { state x = 1, v = 0  discrete n = 0  flow { x' = v  v' = -x }
           falls: when x <= 0 { n := n + 1 }  rises: when rising(x >= 0) { n := n + 1 } }
         system { a = A() }  run { until 6  tolerance 1e-10 }",
    );
    all_near(&run.times("A.falls"), &[PI / 2.0], 1e-8);
    all_near(&run.times("A.rises"), &[3.0 * PI / 2.0], 1e-8);
}

#[test]
fn rule_02_rising_counts_from_arming() {
    // in Second x >= 1 is true on entry; it is false for a while after the reset at 3
    let run = simulate(
        "agent A { state x = 0  flow { x' = 1 }
           initial mode First { go: when x >= 1 -> Second }
           mode Second { reset: after 2 { x := 0 }  up: when rising(x >= 1) { } } }
         system { a = A() }  run { until 5 }",
    );
    all_near(&run.times("A.up"), &[4.0], 1e-11);
}

#[test]
fn rule_02_crossing_both_ways_by_the_flow() {
    let run = simulate(
        "agent A { state x = 0  flow { x' = cos(time) }  go: when crossing(x - 0.5) { } }
         system { a = A() }  run { until 7  tolerance 1e-11 }",
    );
    all_near(&run.times("A.go"), &[PI / 6.0, 5.0 * PI / 6.0, 13.0 * PI / 6.0], 1e-9);
}

#[test]
fn rule_02_crossing_by_a_reset() {
    let run = simulate(
        "agent A { discrete d = 1
                   tick: every 1 { d := -d }
                   go: when crossing(d) { } }
         system { a = A() }  run { until 3 }",
    );
    assert_eq!(run.times("A.go"), [1.0, 2.0, 3.0]);
    let run = simulate(
        "agent A { state x = 1  flow { x' = 0 }
                   tick: every 1 { x := -3*x }
                   go: when crossing(x) { } }
         system { a = A() }  run { until 2 }",
    );
    assert_eq!(run.times("A.go"), [1.0, 2.0]);
}

#[test]
fn rule_02_a_crossing_that_is_zero_when_armed_takes_its_next_sign() {
    let run = simulate(
        "agent A { state x = 0  flow { x' = 1 }  go: when crossing(x) { } }
         system { a = A() }  run { until 2 }",
    );
    assert_eq!(run.log(), [""; 0]);
    let run = simulate(
        "agent A { state x = 0  flow { x' = cos(time) }  go: when crossing(x) { } }
         system { a = A() }  run { until 7  tolerance 1e-11 }",
    );
    all_near(&run.times("A.go"), &[PI, 2.0 * PI], 1e-9);
}

/// What is zero when armed has no side: neither sign that it takes first is a change. That of `c` is written, that of `x` comes
/// at a kink of its flow, that of `y` at once but by its third rate only.
#[test]
fn rule_02_a_crossing_that_stays_zero_takes_either_sign_without_an_event() {
    let run = simulate(
        "agent A(s: real) {
           discrete c = 0  state x = 0, y = 0
           flow { x' = if time < 1 then 0 else if time < 2 then s else -2*s  y' = s*(time^3 - time^2) }
           first: after 1.5 { c := s }
           back: after 3 { c := -s }
           written: when crossing(c) { }
           kinked: when crossing(x) { }
           curved: when crossing(y) { } }
         system { up = A(s = 1)  down = A(s = -1) }
         run { until 4 }",
    );
    for agent in ["up", "down"] {
        assert_eq!(run.times_of("A.written", agent), [3.0], "{agent}");
        all_near(&run.times_of("A.kinked", agent), &[2.5], 1e-12);
        all_near(&run.times_of("A.curved", agent), &[4.0 / 3.0], 1e-6);
    }
}

/// Entering the mode again arms the guard anew, and what is zero then has no side again.
#[test]
fn rule_02_a_crossing_that_is_armed_again_at_zero_forgets_its_side() {
    let run = simulate(
        "agent A(s: real) {
           discrete c = -s
           initial mode M { again: after 1 -> M { c := 0 }  x: when crossing(c) { }
                            tick: every 0.5 { c := s } } }
         system { up = A(s = 1)  down = A(s = -1) }
         run { until 1.9 }",
    );
    for agent in ["up", "down"] {
        // -s to s is a change; 0 to s, after the mode has been entered again, is none
        assert_eq!(run.times_of("A.x", agent), [0.5], "{agent}");
    }
}

/// It was negative before, and becomes so again before it crosses.
#[test]
fn rule_02_a_crossing_forgets_the_sign_of_its_former_life() {
    for sign in ["-", ""] {
        let run = simulate(&format!(
            "agent P {{ state x = -1  discrete re: int = 0
               initial mode M {{
                 flow {{ x' = if time < 2 then 0 else if time < 3 then {sign}(-1) else {sign}1 }}
                 s: when crossing(x) {{ }}
                 go: when time >= 1 and re == 0 -> M {{ x := 0  re := 1 }} }} }}
             system {{ p = P() }}  run {{ until 6 }}"
        ));
        all_near(&run.times("P.s"), &[4.0], 1e-9);
    }
}

#[test]
fn rule_02_a_touch_is_no_crossing() {
    let run = simulate(
        "agent A { state x = 0  flow { x' = 1 }
                   touch: when crossing((x - 1)^2) { }
                   through: when crossing((x - 1)^3) { } }
         system { a = A() }  run { until 2 }",
    );
    assert_eq!(run.log(), ["0 A.through a"]);
    // a triple root: |x - 1|^3 within rounding of zero is |x - 1| < 1e-5
    all_near(&run.times("A.through"), &[1.0], 1e-5);
}

/// Without the wake that has nothing to do with it, the flag is set after the instant, and nothing fires.
#[test]
fn rule_02_a_guard_that_ends_its_truth_does_not_fire_again_because_somebody_else_acts_in_that_instant() {
    let run = simulate(
        "agent Car(v: real) { state x  discrete n = 0  flow { x' = v }  tick: every 2 { n := n + 1 } }
         agent Watch { discrete n = 0  near: when exists c in Car: c.x^2 <= 1 { n := n + 1 } }
         system { car = Car(x = -3, v = 2)  far = Car(x = 9, v = 0)  watch = Watch() }
         run { until 3 }",
    );
    // within 1 m of the origin from 1 to 2, when both cars tick
    all_near(&run.times("Watch.near"), &[1.0], 1e-9);
}
