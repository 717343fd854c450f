//! Rule 14: a write wakes the guards that read it, also those of others.

use crate::harness::{all_near, near, simulate};

#[test]
fn rule_14_a_discrete_of_another() {
    let run = simulate(
        "agent A { discrete lit: bool = false  set: after 1 { lit := true }  clear: after 2 { lit := false }
                   again: after 3 { lit := true } }
         agent B(a: A) { discrete n = 0  look: when a.lit { n := n + 1 } }
         system { b = B(a = a)  a = A() }  run { until 4 }",
    );
    assert_eq!(run.times("B.look"), [1.0, 3.0]);
    assert_eq!(run.log()[..2], ["0 A.set a", "1 B.look b"]);
}

#[test]
fn rule_14_a_mode_of_another() {
    let run = simulate(
        "agent A { initial mode Off { go: after 1 -> On }  mode On { back: after 1 -> Off } }
         agent B { look: when exists o in A: o is On { }  nobody: when forall o in A: o is Off { } }
         system { b = B()  a = A() }  run { until 3.5 }",
    );
    assert_eq!(run.times("B.look"), [1.0, 3.0]);
    assert_eq!(run.times("B.nobody"), [0.0, 2.0]);
}

#[test]
fn rule_14_a_state_reset_of_another() {
    let run = simulate(
        "agent A { state x = 0  flow { x' = 0 }  jump: after 1 { x := 10 } }
         agent B { look: when exists o in A: o.x >= 5 { } }
         system { b = B()  a = A[3]() }  run { until 2 }",
    );
    // three jumps in one instant or three: one flag, once
    assert_eq!(run.times("B.look"), [1.0]);
}

#[test]
fn rule_14_a_teleport_beside_one_that_has_run_ahead() {
    // b needs one step for its whole run; a is put beside it at t = 1, ahead of it (b comes at 1.45) or behind
    let text = |to: &str| {
        format!(
            "agent A {{ state x = -100  flow {{ x' = 0 }}  jump: after 1 {{ x := {to} }}
                        met: when exists o in B: abs(o.x - x) <= 0.1 {{ }} }}
             agent B {{ state x = 0  flow {{ x' = 2 }} }}
             system {{ a = A()  b = B() }}  run {{ until 10 }}"
        )
    };
    all_near(&simulate(&text("2.05")).times("A.met"), &[1.0], 1e-12);
    all_near(&simulate(&text("3")).times("A.met"), &[1.45], 1e-11);
    all_near(&simulate(&text("1")).times("A.met"), &[], 0.0);
}

#[test]
fn rule_14_a_teleport_makes_the_other_turn_back() {
    // b has run ahead to the end; the meeting at 1.45 turns it round all the same
    let run = simulate(
        "agent Post { state x = -100  flow { x' = 0 }  jump: after 1 { x := 3 } }
         agent Car { state x = 0  discrete v = 2  flow { x' = v } }
         interaction Turn(p: Post, c: Car) { hit: when c.x >= p.x - 0.1 and p.x >= 0 { c.v := -1 } }
         system { p = Post()  c = Car() }  run { until 10 }",
    );
    all_near(&run.times("Turn.hit"), &[1.45], 1e-11);
    near(run.value("c.x"), 2.9 - 8.55, 1e-10);
}

#[test]
fn rule_14_a_flow_changed_by_an_event_wakes_guards_of_others() {
    // without the event c would never come near; its new speed brings it there
    let run = simulate(
        "agent Car { state x = 0  discrete v = 0  flow { x' = v }  go: after 2 { v := 1 } }
         agent Gate { open: when exists c in Car: c.x >= 3 { } }
         system { g = Gate()  c = Car() }  run { until 10 }",
    );
    all_near(&run.times("Gate.open"), &[5.0], 1e-11);
}

#[test]
fn rule_14_a_mode_change_that_changes_the_flow_wakes_too() {
    let run = simulate(
        "agent Car { state x = 1
           initial mode Away { flow { x' = 1 }  turn: after 2 -> Back }
           mode Back { flow { x' = -2 } } }
         agent Gate { open: when exists c in Car: c.x <= 0 { } }
         system { g = Gate()  c = Car() }  run { until 10 }",
    );
    all_near(&run.times("Gate.open"), &[3.5], 1e-11);
}

#[test]
fn rule_14_the_last_that_makes_a_forall_true() {
    let run = simulate(
        "agent Car(v: real) { state x = 0  flow { x' = v } }
         agent Gate { all_in: when forall c in Car: c.x >= 3 { }  one_in: when exists c in Car: c.x >= 3 { } }
         system { g = Gate()  c = Car[3](v = 1 + index) }  run { until 10 }",
    );
    all_near(&run.times("Gate.all_in"), &[3.0], 1e-11);
    all_near(&run.times("Gate.one_in"), &[1.0], 1e-11);
}

#[test]
fn rule_14_a_chain_of_wakes_in_one_instant() {
    let run = simulate(
        "agent A { link next: A  discrete lit: bool = false
                   start: when time >= 1 and not next { lit := true }
                   spread: when (if next then next.lit else false) { lit := true } }
         system { a = A[4](next = if index <= 2 then a[index + 1] else none) }  run { until 2 }",
    );
    assert_eq!(run.log(), ["0 A.start a[3]", "1 A.spread a[2]", "2 A.spread a[1]", "3 A.spread a[0]"]);
}

#[test]
fn rule_14_what_no_guard_reads_wakes_nobody() {
    // one of the crowd ticks, or looks at nothing but its clock
    let text = |write: &str| {
        format!(
            "agent A(i: int) {{ state x = 3*i  discrete n: int = 0, k: int = 0  flow {{ x' = 0.1 }}
               tick: every 0.01 when i == 0 {{ {write} }}
               c: when (count o in other A where (o.x - x)^2 <= 4) >= 2 {{ n := n + 1 }} }}
             system {{ a = A[40](i = index) }}  run {{ until 1 }}"
        )
    };
    let looks = |write: &str| {
        let stats = simulate(&text(write)).stats;
        stats.guard_evaluations + stats.guard_ranges
    };
    let (quiet, busy) = (looks(""), looks("k := k + 1"));
    assert!(busy <= quiet + 100, "{quiet} looks, {busy} where somebody counts for itself");
}
