//! Rule 15: a step never spans a kink of the flow. The flows are linear or quadratic in time between their kinks, so
//! that a run is exact to rounding at any tolerance, if and only if each kink is met.

use std::f64::consts::PI;

use hyc::model::ir::Integrator;

use crate::harness::{Case, all_near, near, simulate, simulate_by_both_forms, simulate_error};

/// y(3.5) for y' = f(x), x = t, at a tolerance that by itself promises nothing.
fn primitive(f: &str) -> f64 {
    let run = simulate(&format!(
        "agent A {{ state x = 0, y = 0  flow {{ x' = 1  y' = {f} }} }}
         system {{ a = A() }}  run {{ until 3.5  tolerance 1e-2 }}"
    ));
    assert!(run.events.is_empty(), "a kink is no event");
    run.value("a.y")
}

#[test]
fn rule_15_abs_min_max_clamp_sign() {
    near(primitive("abs(x - 1)"), 0.5 + 3.125, 1e-10);
    near(primitive("max(x, 1)"), 6.625, 1e-10);
    near(primitive("min(x, 1)"), 3.0, 1e-10);
    near(primitive("clamp(x, 1, 2)"), 5.5, 1e-10);
    near(primitive("sign(x - 1)"), 1.5, 1e-10);
    near(primitive("max(x - 1, 0)*2 + min(x, 2)"), 6.25 + 5.0, 1e-10);
}

#[test]
fn rule_15_floor_ceil_round_trunc_mod() {
    near(primitive("floor(x)"), 4.5, 1e-10);
    near(primitive("ceil(x)"), 8.0, 1e-10);
    near(primitive("round(x)"), 6.0, 1e-10);
    near(primitive("trunc(x)"), 4.5, 1e-10);
    near(primitive("trunc(x - 2)"), -1.0 + 0.5, 1e-10);
    near(primitive("mod(x, 1)"), 1.625, 1e-10);
    near(primitive("mod(x, 0.7)"), 5.0 * 0.245, 1e-10);
}

#[test]
fn rule_15_floor_of_a_falling_argument() {
    near(primitive("floor(2 - x)"), 1.0 - 1.0 - 2.0 * 0.5, 1e-10);
    near(primitive("mod(-x, 1)"), 3.0 * 0.5 + 0.375, 1e-10);
}

#[test]
fn rule_15_if_of_time_and_of_state() {
    near(primitive("if x >= 2 then 5 else x"), 2.0 + 7.5, 1e-10);
    near(primitive("if time >= 2 then 5 else x"), 2.0 + 7.5, 1e-10);
    near(primitive("if x >= 1 and x <= 2 or time > 3 then 1 else 0"), 1.5, 1e-10);
    near(primitive("if not x < 1 then if x < 2 then 1 else 2 else 0"), 1.0 + 3.0, 1e-10);
}

#[test]
fn rule_15_the_cut_of_atan2() {
    // th runs through pi, where atan2 jumps to -pi
    let run = simulate(
        "agent A { state th = 0, y = 0  flow { th' = 1  y' = atan2(sin(th), cos(th)) } }
         system { a = A() }  run { until 4  tolerance 1e-10 }",
    );
    near(run.value("a.y"), 8.0 - 2.0 * PI * (4.0 - PI), 1e-8);
}

#[test]
fn rule_15_a_kink_that_the_state_itself_meets() {
    // x' = 2 - |x|... from -1: x' = 2 + x until 0 (t = ln 2), then x' = 2 - x
    let run = simulate(
        "agent A { state x = -1  flow { x' = 2 - abs(x) } }
         system { a = A() }  run { until 2  tolerance 1e-11 }",
    );
    near(run.value("a.x"), 2.0 - 2.0 * (-(2.0 - 2f64.ln())).exp(), 1e-9);
}

#[test]
fn rule_15_a_kink_shared_with_another() {
    // the follower's flow has a kink where the leader passes 1
    let run = simulate(
        "agent Lead { state x = 0  flow { x' = 1 } }
         agent Car { link lead: Lead  state y = 0  flow { y' = if lead then abs(lead.x - 1) else 0 } }
         system { c = Car(lead = l)  l = Lead() }  run { until 3  tolerance 1e-2 }",
    );
    near(run.value("c.y"), 0.5 + 2.0, 1e-10);
}

#[test]
fn rule_15_two_kinks_within_what_would_be_one_step() {
    near(
        primitive("abs(x - 1) + abs(x - 1.001) + max(x - 3.4999, 0)"),
        3.625
            + {
                let (low, high) = (1.001f64, 3.5 - 1.001);
                (low * low + high * high) / 2.0
            }
            + 0.5e-8,
        1e-10,
    );
}

#[test]
fn rule_15_a_kink_at_which_an_event_lies() {
    let run = simulate(
        "agent A { state x = 0, y = 0  flow { x' = 1  y' = abs(x - 1) }
                   hit: when x >= 1 { }
                   tick: every 0.5 { } }
         system { a = A() }  run { until 2  tolerance 1e-2 }",
    );
    near(run.value("a.y"), 1.0, 1e-10);
    crate::harness::all_near(&run.times("A.hit"), &[1.0], 1e-11);
}

#[test]
fn rule_15_a_touched_kink_changes_nothing() {
    // x = (t - 1)^2 touches the kink of |x| at t = 1
    let run = simulate(
        "agent A { state x = 1, v = -2, y = 0  flow { x' = v  v' = 2  y' = abs(x) } }
         system { a = A() }  run { until 2  tolerance 1e-10 }",
    );
    near(run.value("a.y"), 2.0 / 3.0, 1e-9);
}

#[test]
fn rule_15_a_flow_that_pushes_back_at_its_kink_is_chattering() {
    let (run, found) = simulate_error(
        "agent A { state x = 1  flow { x' = if x > 0 then -1 else 2 } }
         system { a = A() }  run { until 3 }",
    );
    near(run.time, 1.0, 1e-6);
    let places: Vec<&str> = found.labels.iter().map(|label| run.sources.text(label.span)).collect();
    assert!(places.iter().any(|place| place.contains("x > 0")), "{places:?}");
}

#[test]
fn rule_15_a_continuous_flow_may_rest_on_its_kink() {
    // both sides agree at the kink and the state comes to rest on it: no chattering
    let run = simulate(
        "agent A { state x = 1  flow { x' = -max(x, 0) } }
         agent B { state x = 0  flow { x' = abs(x) } }
         system { a = A()  b = B() }  run { until 5  tolerance 1e-10 }",
    );
    near(run.value("a.x"), (-5f64).exp(), 1e-9);
    near(run.value("b.x"), 0.0, 1e-12);
}

#[test]
fn rule_15_a_reset_across_a_kink_takes_the_other_branch() {
    let run = simulate(
        "agent A { state x = 0, y = 0  flow { x' = 0  y' = if x >= 5 then 10 else 1 }
                   up: after 1 { x := 7 }  down: after 2 { x := 0 } }
         system { a = A() }  run { until 3  tolerance 1e-2 }",
    );
    near(run.value("a.y"), 12.0, 1e-10);
}

#[test]
fn rule_15_a_flow_that_is_not_defined_beyond_its_branch_goes_on_at_the_kink() {
    let run = simulate(
        "agent A { state y = 0  flow { y' = sqrt(abs(time - 1)) } }
         system { a = A() }  run { until 4  tolerance 1e-9 }",
    );
    near(run.value("a.y"), 2.0 / 3.0 * (1.0 + 3.0_f64.powf(1.5)), 1e-7);
    // The leader's steps end where they end, not an ulp before.
    for flow in ["if v > -40 then -2 else o.x", "min(0.5*v, k*o.x - 2)"] {
        let run = simulate_by_both_forms(&format!(
            "agent A {{ state x = 2, v = 1  flow {{ x' = v  v' = -2*x + 2*v + 2 }} }}
             agent B(o: A) {{ state x = 1, v = 1  discrete k = 0  flow {{ x' = v  v' = {flow} }} }}
             system {{ a = A()  b = B(o = a) }}  run {{ until 2 }}"
        ));
        // v falls from 1 to -3: both flows are -2 all along.
        near(run.value("b.x"), -1.0, 1e-6);
    }
}

/// What the flow reaches at its kink it has reached, though it would turn back there: the transition leaves in time.
#[test]
fn rule_15_a_guard_on_a_kink_that_pushes_back_fires_there() {
    let flows = ["if v < 1 then 1 else -1", "if v <= 1 then 1 else -1", "sign(1 - v)", "1 - 2*floor(v)"];
    let guards = ["v >= 1", "not (v < 1)", "rising(v >= 1)", "v >= 1 and time > 0.5"];
    for (flow, guard) in flows.iter().flat_map(|flow| guards.map(|guard| (flow, guard))) {
        let text = format!(
            "agent B {{ state v = 0
               initial mode Slip {{ flow {{ v' = {flow} }}  stick: when {guard} -> Stick }}
               mode Stick {{ flow {{ v' = 0 }} }} }}
             agent Watch(b: B) {{ discrete n: int = 0  seen: when b.v >= 1 {{ n := n + 1 }} }}
             system {{ b = B()  watch = Watch(b = b) }}  run {{ until 3 }}"
        );
        let run = simulate_by_both_forms(&text);
        all_near(&run.times("B.stick"), &[1.0], 1e-12);
        all_near(&run.times("Watch.seen"), &[1.0], 1e-12);
        near(run.value("b.v"), 1.0, 1e-12);
        for integrator in [Integrator::Tsit5, Integrator::Adams, Integrator::Stiff] {
            let run = Case::new(&text).integrator(integrator).run();
            all_near(&run.times("B.stick"), &[1.0], 1e-9);
        }
    }
    let run = simulate(
        "agent B { state v = 0  flow { v' = sign(1 - v) } }
         system { b = B() }  run { until 3  stop when forall b in B: b.v >= 1 }",
    );
    near(run.time, 1.0, 1e-12);
    // never above it
    let (_, failed) = simulate_error(
        "agent B { state v = 0  flow { v' = sign(1 - v) }  when v > 1 { v := 0 } }
         system { b = B() }  run { until 3 }",
    );
    assert_eq!(failed.code, "HY0507", "{failed:?}");
}

/// What begins to grow at a kink is above zero from there on, once: not also a little before, by rounding.
#[test]
fn rule_15_what_grows_from_a_kink_on_makes_a_guard_true_once() {
    let kinks = ["max(x - C, 0)", "if x > C then x - C else 0", "if x >= C then 1 else 0", "max(x - C, 0)^2"];
    let guards = ["y > 0", "x >= C and y > 0", "y > 0 and x > C", "y' > 0 and x >= C", "rising(y > 0)"];
    for (kink, guard) in kinks.iter().flat_map(|kink| guards.map(|guard| (kink, guard))) {
        for (c, speed) in [(1.0, 1.0), (0.3, 1.0), (1.7, 0.7), (2.0, 2.0)] {
            let text = format!(
                "agent A {{ state x = 0, y = 0  discrete n: int = 0
                   flow {{ x' = {speed}  y' = {kink} }}  t: when {guard} {{ n := n + 1 }} }}
                 system {{ a = A() }}  run {{ until 4 }}"
            );
            let text = text.replace('C', &c.to_string());
            let run = simulate_by_both_forms(&text);
            // (x - c)^3 leaves zero later than its rounding
            all_near(&run.times("A.t"), &[c / speed], 2e-2);
        }
    }
}
