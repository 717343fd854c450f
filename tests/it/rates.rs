//! `x'` in an expression is the rate of x by the flow that is active: not the slope of what the integrator took for x.

use crate::harness::{Ended, all_near, near, simulate_by_both_forms};

#[test]
fn a_guard_on_rates_fires_once_where_it_becomes_true() {
    // y - x = cos t - sin t falls to -1 at pi/2, and is there again at pi
    let text = |guard: &str| {
        format!(
            "agent A {{ state x = 0, y = 1  discrete n: int = 0  flow {{ x' = y  y' = -x }}
               t: when {guard} {{ n := n + 1 }} }}
             system {{ a = A() }}  run {{ until 3.1 }}"
        )
    };
    for guard in ["x' + y' <= -1", "x' + y' < -1", "y - x <= -1"] {
        let times = simulate_by_both_forms(&text(guard)).times("A.t");
        all_near(&times, &[std::f64::consts::FRAC_PI_2], 1e-5);
    }
}

#[test]
fn a_speed_that_settles_passes_a_threshold_of_its_rate_once() {
    let run = simulate_by_both_forms(
        "agent Car { state v = 0  discrete n: int = 0  flow { v' = 2*(30 - v) }
           done: when v' <= 1 { n := n + 1 } }
         system { car = Car() }  run { until 10 }",
    );
    all_near(&run.times("Car.done"), &[0.5 * 60.0_f64.ln()], 1e-6);
}

#[test]
fn what_a_rate_is_never_above_is_never_false() {
    // the slope of dense output of sin is above 1 somewhere
    for rate in ["2*cos(time)", "2*cos(y)"] {
        let run = simulate_by_both_forms(&format!(
            "agent A {{ state x = 0, y = 0  discrete n: int = 0  flow {{ x' = {rate}  y' = 1 }}
               assert x' <= 2  over: when x' > 2 {{ n := n + 1 }} }}
             system {{ a = A() }}  property slow = always forall a in A: a.x' <= 2
             run {{ until 20 }}"
        ));
        assert_eq!((run.end, run.events.len(), run.false_asserts.len()), (Ended::Until, 0, 0));
    }
    let run = simulate_by_both_forms(
        "agent Car { state x = 0, v = 0  flow { x' = v  v' = 2*(30 - v) }  assert v' >= 0  assert x' <= 30 }
         system { car = Car() }  run { until 60 }",
    );
    assert_eq!((run.end, run.false_asserts.len()), (Ended::Until, 0));
}

#[test]
fn the_rate_of_a_follower_is_that_of_its_flow_along_its_leader() {
    // y' = sin t - y along x = sin t: y = (sin t - cos t + e^-t)/2, y' = (cos t + sin t - e^-t)/2 falls to zero near 2.28
    let run = simulate_by_both_forms(
        "agent Lead { state x = 0, c = 1  flow { x' = c  c' = -x } }
         agent Tail { link lead: Lead  state y = 0  discrete n: int = 0
           flow { y' = if lead then lead.x - y else 0 }  turn: when y' < 0 { n := n + 1 } }
         system { lead = Lead()  tail = Tail(lead = lead) }  run { until 4 }",
    );
    let turn = run.times("Tail.turn");
    assert_eq!(turn.len(), 1);
    near(turn[0].cos() + turn[0].sin() - (-turn[0]).exp(), 0.0, 1e-5);
}

#[test]
fn the_largest_of_rates() {
    let run = simulate_by_both_forms(
        "agent A(w: real) { state x = 0  flow { x' = cos(w*time) } }
         agent B { discrete n: int = 0  low: when (max a in A: a.x') <= 0.5 { n := n + 1 } }
         system { a = A[3](w = 1 + 0.1*index)  b = B() }  run { until 3 }",
    );
    all_near(&run.times("B.low"), &[std::f64::consts::FRAC_PI_3], 1e-9);
}

#[test]
fn rule_14_a_write_to_what_a_flow_reads_wakes_a_guard_on_its_rate() {
    let text = |back: &str| {
        format!(
            "agent L {{ discrete s = 1  t: after 1 {{ s := -1 }}  {back} }}
             agent A {{ link l: L  state x = 0  flow {{ x' = if l then l.s else 0 }} }}
             agent B {{
               discrete seen: int = 0, m: int = 0
               t: when exists a in A: a.x' < 0 {{ seen := 10*seen + 1 }}
               u: when exists l in L: l.s < 0 {{ seen := 10*seen + 2  m := 1 }} }}
             system {{ l = L()  a = A(l = l)  b = B() }}  run {{ until 2 }}"
        )
    };
    near(simulate_by_both_forms(&text("")).value("b.seen"), 12.0, 0.0);
    let back = "back: when s < 0 and exists b in B: b.m > 0 { s := 1 }";
    near(simulate_by_both_forms(&text(back)).value("b.seen"), 12.0, 0.0);
}

#[test]
fn rule_15_a_rate_that_jumps_where_something_else_fires() {
    let run = simulate_by_both_forms(
        "agent A { state x = 0  discrete n: int = 0, m: int = 0
           flow { x' = if x > 1 then 2 else 1 }
           t: when x >= 1 { n := n + 1 }
           u: when crossing(x' - 1.5) { m := m + 1 } }
         system { a = A() }  run { until 3 }",
    );
    assert_eq!((run.value("a.n"), run.value("a.m")), (1.0, 1.0));
}

#[test]
fn rule_15_where_a_branch_changes_a_rate_goes_on_by_the_other() {
    let run = simulate_by_both_forms(
        "agent A { state x = 0.5, y = 1.5, z = 0, w = 0
           flow { x' = min(x, 1)  y' = -1  z' = abs(y)  w' = y - floor(y) }
           over: when x' > 1 { }  below: when z' < 0 { }  under: when w' < 0 { }
           full: when x' >= 1 { }  turned: when z' <= 0 { } }
         system { a = A() }  run { until 3 }",
    );
    // x = e^t/2 is 1 at ln 2
    all_near(&run.times("A.full"), &[2.0_f64.ln()], 1e-6);
    all_near(&run.times("A.turned"), &[1.5], 1e-9);
    assert_eq!(run.events.len(), 2, "{:?}", run.log());
}
