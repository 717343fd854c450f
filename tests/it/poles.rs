//! Guards beside poles, plateaus, jumps and arguments that are not defined: each event once, none that is not there.

use crate::harness::{all_near, simulate};

/// The times at which a guard over `x` (which is the time) and `time` becomes true.
fn times(guard: &str, until: f64) -> Vec<f64> {
    simulate(&format!(
        "agent A {{ state x = 0  discrete n = 0  flow {{ x' = 1 }}  hit: when {guard} {{ n := n + 1 }} }}
         system {{ a = A() }}  run {{ until {until} }}"
    ))
    .times("A.hit")
}

#[test]
fn beside_a_pole_a_guard_becomes_true_once() {
    all_near(&times("1/(x - 2) >= 3", 5.0), &[2.0], 1e-9);
    all_near(&times("1/(x - 2) <= -3", 5.0), &[2.0 - 1.0 / 3.0], 1e-11);
    let quarter = std::f64::consts::FRAC_PI_4;
    let every = [0.0, 1.0, 2.0, 3.0].map(|k| quarter + k * std::f64::consts::PI);
    all_near(&times("tan(x) >= 1", 12.0), &every, 1e-10);
}

#[test]
fn where_an_argument_is_not_defined_a_comparison_is_false() {
    all_near(&times("asin(x/2) >= 1", 12.0), &[2.0 * 1.0_f64.sin()], 1e-10);
    assert_eq!(times("log(sin(7*time)) >= -0.3", 5.0).len(), 6);
    let first = 0.5_f64.powf(2.0 / 3.0).acos();
    let turn = std::f64::consts::TAU;
    all_near(
        &times("cos(x)^1.5 >= 0.5", 20.0),
        &[0.0, turn - first, 2.0 * turn - first, 3.0 * turn - first],
        1e-9,
    );
}

#[test]
fn on_a_plateau_at_zero_a_strict_comparison_is_false() {
    all_near(&times("round(x) > 2", 5.0), &[2.5], 1e-11);
    all_near(&times("max(x, 2) > 2", 5.0), &[2.0], 1e-11);
}

#[test]
fn a_jump_onto_zero_and_off_it_again() {
    // floors 0, 1, 2, ...: remainders 0, 1, 0.94, 0.88, ...: below one but for x in [1, 2)
    all_near(&times("floor(mod(floor(x), 1.06)) < 0.271", 6.0), &[0.0, 2.0], 1e-11);
    all_near(&times("floor(mod(round(x), 1.06)) < 0.271", 6.0), &[0.0, 1.5], 1e-11);
}

#[test]
fn a_search_that_needs_many_pieces_misses_nothing() {
    let run = simulate(
        "agent A { state x = 0  flow { x' = 0 }
           hit: when sin(1000*time) + cos(1000*time) + time/1000 >= 1.9 { stop } }
         system { a = A() }  run { until 1000 }",
    );
    // the first time at which sqrt(2) sin(1000 t + pi/4) = 1.9 - t/1000 has a solution, by a scan in steps of 1e-6
    let value = |t: f64| (1000.0 * t).sin() + (1000.0 * t).cos() + t / 1000.0 - 1.9;
    let before = (485_780_000..485_800_000).map(|k| f64::from(k) * 1e-6).find(|&t| value(t) >= 0.0);
    let hit = run.times("A.hit");
    assert_eq!(hit.len(), 1);
    assert!((hit[0] - before.expect("it becomes true there")).abs() < 2e-6, "{hit:?}");
}

#[test]
fn a_guard_of_time_alone_is_found_without_an_end_of_the_run() {
    let run = simulate("agent A { discrete n = 0  a: when time >= 30 { stop } } system { a = A() } run { }");
    all_near(&run.times("A.a"), &[30.0], 1e-11);
    let run = simulate(
        "agent A { state x = 0  flow { x' = 1 }  a: when sin(time) >= 0.5 { }  s: when time >= 8 { stop } }
         system { a = A() } run { }",
    );
    let first = 0.5_f64.asin();
    all_near(&run.times("A.a"), &[first, first + std::f64::consts::TAU], 1e-10);
}

#[test]
fn a_reset_onto_a_boundary_leaves_the_next_event_in_place() {
    // thrown up from the ground every 3 s: it is back a second later
    let run = simulate(
        "agent B { state x = 1, v = 0  discrete n = 0  flow { x' = v  v' = -10 }
           kick: every 3 { x := 0  v := 5 }  low: when x <= 0 { n := n + 1 } }
         system { b = B() }  run { until 10.5 }",
    );
    all_near(&run.times("B.low"), &[0.2_f64.sqrt(), 4.0, 7.0, 10.0], 1e-10);
}

#[test]
fn a_branch_of_a_flow_that_reads_anothers_discrete_follows_it() {
    let run = simulate(
        "agent L { discrete lim = 3  s: after 1 { lim := 0.5 } }
         agent F(lead: L) { state x = 0  flow { x' = if x > lead.lim then 10 else 1 }  a: when x >= 4 { } }
         system { l = L()  f = F(lead = l) }  run { until 2 }",
    );
    all_near(&run.times("F.a"), &[1.3], 1e-11);
}

#[test]
fn a_touch_within_rounding_fires_once_each_time() {
    // thrown up with 5 m/s under 10 m/s^2, it turns exactly at the guard
    let run = simulate(
        "agent B { state x = 1, v = 0  flow { x' = v  v' = -10 }
           initial mode F { low: when x <= 0 -> G { x := 0  v := 5 } }
           mode G { back: when x <= 0 -> F { x := 0  v := 5 }  up: when x >= 1.25 { } } }
         system { b = B() }  run { until 5 }",
    );
    let first = 0.2_f64.sqrt();
    all_near(&run.times("B.up"), &[first + 0.5, first + 2.5, first + 4.5], 1e-7);
}
