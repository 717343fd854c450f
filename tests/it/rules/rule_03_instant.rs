//! Rule 3: the first instant at which a condition is true, and conditions that are on their boundary.

use std::f64::consts::PI;

use hyc::model::ir::Integrator;

use crate::harness::{Case, all_near, near, refused, simulate, simulate_by_both_forms, simulate_error};

/// An agent with x' = v (discrete), a guard that counts, and nothing else.
fn counting(x: &str, v: &str, guard: &str, more: &str, until: f64) -> Vec<f64> {
    simulate(&format!(
        "agent A {{ state x = {x}  discrete v = {v}
                    flow {{ x' = v }}
                    hit: when {guard} {{ }}
                    {more} }}
         system {{ a = A() }}  run {{ until {until} }}"
    ))
    .times("A.hit")
}

#[test]
fn rule_03_equality_of_reals_is_an_error() {
    let words = refused(
        "agent A { state x = 0  flow { x' = 1 }  go: when x == 1 { } }  system { a = A() }  run { until 1 }",
    );
    assert!(words.contains("crossing"), "{words}");
    refused(
        "agent A { state x = 0  flow { x' = 1 }  go: when x != 1 { } }  system { a = A() }  run { until 1 }",
    );
}

#[test]
fn rule_03_equality_is_exact_on_what_is_discrete() {
    let run = simulate(
        "agent A { discrete n: int = 0, up: bool = false
                   tick: every 1 { n := n + 1  up := not up }
                   three: when n == 3 { }
                   notup: when up == false { }
                   unequal: when n != 0 { } }
         system { a = A() }  run { until 5 }",
    );
    assert_eq!(run.times("A.three"), [3.0]);
    assert_eq!(run.times("A.notup"), [0.0, 2.0, 4.0]);
    assert_eq!(run.times("A.unequal"), [1.0]);
}

#[test]
fn rule_03_the_first_instant_is_the_infimum() {
    all_near(&counting("0", "1", "x >= 1", "", 2.0), &[1.0], 1e-11);
    all_near(&counting("0", "1", "x > 1", "", 2.0), &[1.0], 1e-11);
    all_near(&counting("0", "1", "time > 1", "", 2.0), &[1.0], 1e-11);
    assert_eq!(counting("0", "1", "time > 0", "", 2.0), [0.0]);
    assert_eq!(counting("0", "1", "x > 0", "", 2.0), [0.0]);
    assert_eq!(counting("0", "1", "time >= 2", "", 2.0), [2.0]);
    all_near(&counting("0", "1", "x >= 2", "", 2.0), &[2.0], 1e-11);
    assert_eq!(counting("0", "1", "time >= 2.001", "", 2.0), [0.0; 0]);
}

#[test]
fn rule_03_strict_and_not_differ_only_where_a_guard_stays_on_its_boundary() {
    assert_eq!(counting("0", "0", "x <= 0", "", 2.0), [0.0]);
    assert_eq!(counting("0", "0", "x >= 0", "", 2.0), [0.0]);
    assert_eq!(counting("0", "0", "x < 0", "", 2.0), [0.0; 0]);
    assert_eq!(counting("0", "0", "x > 0", "", 2.0), [0.0; 0]);
}

#[test]
fn rule_03_at_the_start_nothing_is_held() {
    // on the boundary, moving out: true at t = 0, so it fires there; the strict one is never true
    assert_eq!(counting("0", "1", "x <= 0", "", 2.0), [0.0]);
    assert_eq!(counting("0", "-1", "x >= 0", "", 2.0), [0.0]);
    assert_eq!(counting("0", "1", "x < 0", "", 2.0), [0.0; 0]);
}

#[test]
fn rule_03_two_modes_that_share_a_boundary_neither_loop_nor_miss() {
    // x = -cos t goes through zero at pi/2, 3 pi/2, 5 pi/2
    for (up, down) in [(">=", "<="), (">", "<"), (">=", "<"), (">", "<=")] {
        let run = simulate(&format!(
            "agent A {{ state x = -1  flow {{ x' = sin(time) }}
               initial mode Below {{ up: when x {up} 0 -> Above }}
               mode Above {{ down: when x {down} 0 -> Below }} }}
             system {{ a = A() }}  run {{ until 9  tolerance 1e-11 }}"
        ));
        assert_eq!(run.log(), ["0 A.up a Below->Above", "0 A.down a Above->Below", "0 A.up a Below->Above"]);
        let times: Vec<f64> = run.events.iter().map(|event| event.time).collect();
        all_near(&times, &[PI / 2.0, 3.0 * PI / 2.0, 5.0 * PI / 2.0], 1e-9);
    }
}

#[test]
fn rule_03_moving_out_is_held_until_it_has_been_false() {
    // thrown up from the floor at 1 with v = 1, it is back at 3
    let run = simulate(
        "agent A { state x = 0, v = 0
           initial mode Wait { flow { x' = 0  v' = 0 }  throw: after 1 -> Fly { v := 1 } }
           mode Fly { flow { x' = v  v' = -1 }  land: when x <= 0 -> Rest { x := 0  v := 0 } }
           mode Rest { flow { x' = 0  v' = 0 } } }
         system { a = A() }  run { until 5 }",
    );
    all_near(&run.times("A.land"), &[3.0], 1e-11);
}

#[test]
fn rule_03_the_second_rate_decides_where_the_first_is_zero() {
    // let go upwards from rest: x = t^2/2 is leaving `x <= 0`; downwards it is moving in
    let text = |acceleration: &str| {
        format!(
            "agent A {{ state x = 0, v = 0
               initial mode Wait {{ flow {{ x' = 0  v' = 0 }}  go: after 1 -> Fly }}
               mode Fly {{ flow {{ x' = v  v' = {acceleration} }}  land: when x <= 0 {{ }}  strict: when x < 0 {{ }} }} }}
             system {{ a = A() }}  run {{ until 3 }}"
        )
    };
    let up = simulate(&text("1"));
    assert_eq!(up.log(), ["0 A.go a Wait->Fly"]);
    let down = simulate(&text("-1"));
    assert_eq!(down.times("A.land"), [1.0]);
    assert_eq!(down.times("A.strict"), [1.0]);
    let stay = simulate(&text("0"));
    assert_eq!(stay.times("A.land"), [1.0]);
    assert_eq!(stay.times("A.strict"), [0.0; 0]);
}

#[test]
fn rule_03_what_is_true_at_its_boundary_when_it_is_armed_is_so_whatever_turns_its_flow() {
    let log = |guard: &str| {
        let run = simulate_by_both_forms(&format!(
            "agent A {{ state x = -1, v = 1  flow {{ x' = v  v' = 0 }}
               initial mode Low {{ up: when x >= 0 -> High }}
               mode High {{ turn: when v > 0 priority 1 {{ v := -1 }}  hit: when {guard} {{ }} }} }}
             system {{ a = A() }}  run {{ until 2 }}"
        ));
        run.log()
    };
    assert_eq!(log("x >= 0"), ["0 A.up a Low->High", "1 A.turn a", "2 A.hit a"]);
    // it never is beyond
    assert_eq!(log("x > 0"), ["0 A.up a Low->High", "1 A.turn a"]);
}

#[test]
fn rule_03_what_goes_on_from_a_root_is_known_as_well_as_its_time() {
    // In the new mode nothing moves: `<=` is true on its boundary, `<` is not, on whichever side rounding has put x.
    let run = simulate_by_both_forms(
        "agent A(k: real) { state x = 0.2*k  discrete n: int = 0
           initial mode Go { flow { x' = -0.1*k }  hit: when x <= 0 -> Stand }
           mode Stand { flow { x' = 0 }  stay: when x <= 0 { n := n + 1 }  beyond: when x < 0 { n := 100 }
                        short: when x > 0 { n := 100 } } }
         system { a = A[12](k = 0.7 + 0.3*index) }  run { until 3 }",
    );
    for k in 0..12 {
        near(run.value(&format!("a[{k}].n")), 1.0, 0.0);
    }
}

#[test]
fn rule_03_a_strict_comparison_that_moves_in_holds_beside_a_crossing() {
    let run = simulate_by_both_forms(
        "agent A { state x = -1, y = -1  discrete n: int = 0  flow { x' = 1  y' = 0 }
           initial mode Low { up: when x >= 0 -> High }
           mode High { w: when n == 0 priority 1 { n := 1  y := 2 }  both: when x > 0 and crossing(y) { } } }
         system { a = A() }  run { until 2 }",
    );
    assert_eq!(run.log(), ["0 A.up a Low->High", "1 A.w a", "2 A.both a"]);
}

#[test]
fn rule_03_what_has_fired_moving_in_is_true_until_the_instant_is_over() {
    // the flow turns back and forth at the root: x >= 0 has not been false in between
    let run = simulate_by_both_forms(
        "agent A { state x = -1, v = 1  discrete n: int = 0  flow { x' = v  v' = 0 }
           hit: when x >= 0 { n := n + 1 }
           out: when n == 1 and v > 0 { v := -1 }
           back: when v < 0 { v := 1  n := 5 } }
         system { a = A() }  run { until 2 }",
    );
    assert_eq!(run.log(), ["0 A.hit a", "1 A.out a", "2 A.back a"]);
}

#[test]
fn rule_03_held_until_the_rate_points_in() {
    // B is entered at x = 0 with v = -1: `again` is held; in the same instant v becomes 1 and it fires
    let run = simulate(
        "agent A { state x = -1  discrete v = 1, flipped: bool = false
           flow { x' = v }
           initial mode First { up: when x >= 0 -> Second { v := -1 } }
           mode Second { flip: when not flipped { v := 1  flipped := true }
                         again: when x >= 0 { } } }
         system { a = A() }  run { until 3 }",
    );
    assert_eq!(run.log(), ["0 A.up a First->Second", "1 A.flip a", "2 A.again a"]);
    all_near(&run.times("A.again"), &[1.0], 1e-11);
}

#[test]
fn rule_03_what_has_just_fired_on_its_boundary_is_held() {
    // an elastic ball: the guard is on its boundary after each bounce
    let run = simulate(
        "agent Ball { state x = 0.5, v = 0  flow { x' = v  v' = -1 }  bounce: when x <= 0 { v := -v } }
         system { ball = Ball() }  run { until 10 }",
    );
    all_near(&run.times("Ball.bounce"), &[1.0, 3.0, 5.0, 7.0, 9.0], 1e-10);
}

#[test]
fn rule_03_a_guard_that_stays_true_after_firing_does_not_fire_again() {
    // stopped on the wall, then on through it: never false
    let run = simulate(
        "agent A { state x = 1  discrete v = -1
                   flow { x' = v }
                   stay: when x <= 0 { v := 0 }
                   drop: after 2 { v := -1 } }
         system { a = A() }  run { until 4 }",
    );
    all_near(&run.times("A.stay"), &[1.0], 1e-11);
    near(run.value("a.x"), -2.0, 1e-10);
}

#[test]
fn rule_03_chattering_is_reported() {
    let (run, found) = simulate_error(
        "agent A { state x = -1
           initial mode Up { flow { x' = 1 }  stop1: when x >= 0 -> Down }
           mode Down { flow { x' = -1 }  stop2: when x <= 0 -> Up } }
         system { a = A() }  run { until 3 }",
    );
    near(run.time, 1.0, 1e-6);
    let words = crate::harness::words(&[found]);
    assert!(words.contains("A.stop1") && words.contains("A.stop2"), "{words}");
}

#[test]
fn rule_03_each_comparison_of_a_compound_guard_by_itself() {
    // entered on the boundary of the first comparison (moving out) with the second true
    let run = simulate(
        "agent A { state x = -1, y = 0  flow { x' = if time < 3 then 1 else -1  y' = 1 }
           initial mode First { up: when x >= 0 -> Second }
           mode Second { down: when x <= 0 and y >= 0.5 -> First } }
         system { a = A() }  run { until 6 }",
    );
    // up at 1; x = 2 at 3, then back: 0 at 5
    assert_eq!(run.log(), ["0 A.up a First->Second", "0 A.down a Second->First"]);
    all_near(&run.times("A.down"), &[5.0], 1e-11);
    // moving out of one, into the other: `or` is true at once
    let run = simulate(
        "agent A { state x = -1, y = 1  flow { x' = 1  y' = -1 }
           initial mode First { up: when x >= 0 -> Second }
           mode Second { down: when x <= 0 or y <= 0 { } } }
         system { a = A() }  run { until 3 }",
    );
    all_near(&run.times("A.down"), &[1.0], 1e-11);
}

#[test]
fn rule_03_actions_read_the_state_at_the_root() {
    let run = simulate(
        "agent A { state x = 0  discrete at = 0, beyond: bool = false
                   flow { x' = 1 }
                   go: when x >= 1 { at := x  beyond := x >= 1 } }
         system { a = A() }  run { until 2 }",
    );
    near(run.value("a.at"), 1.0, 1e-11);
    assert_eq!(run.value("a.beyond"), 1.0, "on the true side");
}

#[test]
fn rule_03_on_the_near_side_where_the_true_side_is_undefined() {
    let run = simulate(
        "agent A { state x = 0, y = 0  discrete at = 7
           initial mode Go { flow { x' = 1  y' = sqrt(1 - x) }  end: when x >= 1 -> Done { at := sqrt(1 - x) } }
           mode Done { flow { x' = 0  y' = 0 } } }
         system { a = A() }  run { until 2  tolerance 1e-10 }",
    );
    all_near(&run.times("A.end"), &[1.0], 1e-9);
    near(run.value("a.at"), 0.0, 1e-4);
    near(run.value("a.y"), 2.0 / 3.0, 1e-7);
}

#[test]
fn rule_03_the_tolerance_never_enters() {
    // 1e-9 from the boundary is not on it, however loose the run
    for tolerance in ["1e-2", "1e-10"] {
        let run = simulate(&format!(
            "agent A {{ state x = 0  flow {{ x' = 1 }}
               initial mode First {{ go: when x >= 1 -> Second {{ x := 1e-9 }} }}
               mode Second {{ low: when x <= 0 {{ }}  high: when x >= 1e-9 {{ }} }} }}
             system {{ a = A() }}  run {{ until 3  tolerance {tolerance}  absolute 1 }}"
        ));
        assert_eq!(run.times("A.low"), [0.0; 0]);
        all_near(&run.times("A.high"), &[1.0], 1e-11);
    }
}

#[test]
fn rule_03_a_guard_that_jumps_fires_where_it_becomes_true_and_nowhere_else() {
    // the remainder reaches a half once a second, and falls back at the whole seconds; the floor jumps to 3 at x = 1.5
    let run = simulate(
        "agent A { state x = 0  discrete n = 0  flow { x' = 1 }
           half: when mod(x, 1) >= 0.5 { n := n + 1 }
           clock: when mod(time, 1) >= 0.5 { n := n + 1 }
           step: when floor(2*x) + 0.001*sin(x) >= 3 { n := n + 1 }
           never: when mod(x, 1) >= 2 { n := n + 1 } }
         system { a = A() }  run { until 4 }",
    );
    all_near(&run.times("A.half"), &[0.5, 1.5, 2.5, 3.5], 1e-12);
    all_near(&run.times("A.clock"), &[0.5, 1.5, 2.5, 3.5], 1e-15);
    all_near(&run.times("A.step"), &[1.5], 1e-12);
    assert_eq!(run.times("A.never"), [0.0; 0]);
}

#[test]
fn rule_03_a_condition_that_is_never_true_as_a_whole_does_not_fire() {
    // each comparison is true at the zero of x or just after it, but not both at any time
    assert_eq!(counting("-1", "1", "x <= 0 and x > 0", "", 3.0), [0.0; 0]);
    assert_eq!(counting("-1", "1", "2*x <= 0 and 3*x > 0", "", 3.0), [0.0; 0]);
    assert_eq!(counting("-1", "1", "mod(x + 1, 2) >= 1 and x > 1", "", 1.5), [0.0; 0]);
    // at a single point, and not at all there
    all_near(&counting("-1", "1", "x <= 0 and x >= 0", "", 3.0), &[1.0], 1e-11);
    all_near(&counting("-1", "1", "2*x <= 0 and 3*x >= 0", "", 3.0), &[1.0], 1e-11);
    assert_eq!(counting("-1", "1", "x < 0 and x > 0", "", 3.0), [0.0; 0]);
    // the other way round it is true all along
    assert_eq!(counting("-1", "1", "x <= 0 or x > 0", "", 3.0), [0.0]);
}

#[test]
fn rule_03_what_is_true_just_after_an_instant_belongs_to_it() {
    let run = simulate(
        "agent A { discrete n: int = 0
           lo: when time >= 0 { n := n + 1 }  hi: when time > 0 priority 5 { n := 10*n + 7 } }
         system { a = A() }  run { until 1 }",
    );
    assert_eq!(run.value("a.n"), 8.0);
    let run = simulate(
        "agent A { state x = 0  discrete n: int = 0  out: when x > 0 { n := 1 }
           initial mode P { flow { x' = 1 }  in_: when x >= 0 -> Q }  mode Q { flow { x' = -1 } } }
         system { a = A() }  run { until 3 }",
    );
    assert_eq!((run.times("A.out").len(), run.times("A.in_").len()), (1, 1));
    assert_eq!(run.value("a.n"), 1.0);
}

#[test]
fn rule_03_a_guard_that_is_held_stays_held_when_its_flow_stops_on_the_boundary() {
    let run = simulate(
        "agent A { state x = 0  discrete n: int = 0
           cnt: when x >= 0 { n := n + 1 }  back: when n == 1 -> Z { n := n + 1 }
           initial mode P { flow { x' = -1 } }  mode Z { flow { x' = 0 } } }
         system { a = A() }  run { until 3 }",
    );
    assert_eq!(run.value("a.n"), 2.0);
    // Stopped by its own firing, on its boundary: `>` is false there, whatever else happens later.
    let run = simulate(
        "agent Pump { state level = 0  discrete on_: bool = true, shown: int = 0, alarms: int = 0
           flow { level' = if on_ then 0.3 else 0 }
           full: when level > 1 { on_ := false  alarms := alarms + 1 }
           see: every 2 { shown := shown + 1 } }
         system { a = Pump() }  run { until 9 }",
    );
    assert_eq!(run.value("a.alarms"), 1.0);
    let run = simulate(
        "agent A { state x = 0  discrete n: int = 2, c: int = 0
           initial mode P { flow { x' = n }  g: when x > 1 -> P { n := n - 1  c := c + 1 } } }
         system { a = A() }  run { until 5 }",
    );
    assert_eq!(run.value("a.c"), 2.0);
}

#[test]
fn rule_03_the_second_rate_decides_between_agents_that_are_coupled() {
    let run = simulate_by_both_forms(
        "agent Leader { state x = 0  flow { x' = 25 } }
         agent Car(lead: Leader) { state x = 0, v = 25  discrete n: int = 0
           flow { x' = v  v' = -1 - x + lead.x }  hit: when x >= lead.x { n := n + 1 } }
         system { first = Leader()  car = Car(lead = first) }  run { until 2 }",
    );
    assert_eq!(run.times("Car.hit"), [0.0]);
    // A claim that is on its boundary and leaves it into what it says holds.
    let run = simulate_by_both_forms(
        "agent Leader { state x = 0  flow { x' = 25 } }
         agent Car(lead: Leader) { state x = 0, v = 25
           flow { x' = v  v' = -3 - 0.3*v + 0.3*(lead.x - x) }  assert lead.x > x }
         system { first = Leader()  c = Car(lead = first) }  run { until 2 }",
    );
    assert!(run.false_asserts.is_empty());
}

#[test]
fn rule_03_where_a_rate_turns_the_way_to_the_right_decides() {
    // Each is armed on its boundary at t = 1 and moves out of what its guard says.
    let armed = |guard: &str, x: &str, rate: &str| {
        let text = format!(
            "agent A {{ state x = {x}
               initial mode Up {{ flow {{ x' = 2 }}  turn: after 1 -> Down }}
               mode Down {{ flow {{ x' = {rate} }}  back: when {guard} -> End }}
               mode End {{ flow {{ x' = 0 }} }} }}
             system {{ a = A() }}  run {{ until 3 }}"
        );
        simulate(&text).times("A.back").len()
    };
    for (guard, x, rate) in [
        ("min(2, x) >= 2", "0", "-2"),
        ("max(x, 2) <= 2", "0", "1"),
        ("abs(x) <= 0", "-2", "1"),
        ("clamp(x, 0, 2) >= 2", "0", "-2"),
        ("x >= 2", "0", "-2"),
    ] {
        assert_eq!(armed(guard, x, rate), 0, "{guard}");
    }
    assert_eq!(armed("min(2, x) >= 2", "0", "2"), 1);
    assert_eq!(armed("abs(x) >= 0", "-2", "1"), 1);
    assert_eq!(counting("0", "1", "abs(x) > 0", "", 2.0), [0.0]);
    let run = simulate(
        "agent A { state v = 0  flow { v' = 1 }  assert abs(v) > 0 }  system { a = A() }  run { until 3 }",
    );
    assert_eq!(run.value("a.v"), 3.0);
    let run = simulate_by_both_forms(
        "agent A { state x = 1  discrete k: int = 0, n: int = 0  flow { x' = 1/2 }
           w: when k == 1 { n := n + 1 } }
         agent B(o: A) { state y = 1  discrete m: int = 0  flow { y' = -1 }  h: when o.x >= 1 { m := m + 1 } }
         interaction I(a: A, b: B) { g: when min(a.x, b.y) >= 1 { a.k := a.k + 1 } }
         system { p = A()  q = B(o = p) }  run { until 3 }",
    );
    assert_eq!(run.times("I.g"), [0.0]);
}

/// How often two transitions fire, whatever the method by which 20 agents, each from its own start, come to their boundary.
#[track_caller]
fn counts_of_twenty(agent: &str, labels: [&str; 2]) -> [usize; 2] {
    let text = format!(
        "agent A(z0: real) {{ {agent} }}
         system {{ a = A[20](z0 = -1 + 0.0371*index) }}  run {{ until 3  tolerance 1e-11 }}"
    );
    let counts = [Integrator::Taylor, Integrator::Tsit5, Integrator::Adams].map(|integrator| {
        let run = Case::new(&text).integrator(integrator).run();
        labels.map(|label| run.times(label).len())
    });
    assert!(counts.iter().all(|count| *count == counts[0]), "{counts:?}");
    counts[0]
}

#[test]
fn rule_03_a_zero_that_is_written_from_a_zero_is_the_boundary_still() {
    // it fires, moves in, and half of zero, or minus half of it, leaves it where it is: true, and not armed again
    for part in ["-0.5*z", "0.5*z", "0"] {
        let moving_in = format!(
            "state z = z0  discrete n: int = 0  flow {{ z' = 1 + 0.1*z }}
             reach: when z >= 0 {{ n := n + 1 }}  flip: when n >= 1 {{ z := {part} }}"
        );
        assert_eq!(counts_of_twenty(&moving_in, ["A.reach", "A.flip"]), [20, 20], "{part}");
        // armed by a transition into its mode, moving out: held
        let held = format!(
            "state z = z0  discrete n: int = 0
             initial mode P {{ flow {{ z' = 1 + 0.1*z }}  up: when z >= 0 -> Q {{ n := 1 }} }}
             mode Q {{ flow {{ z' = -1 }}  back: when z >= 0 -> R }}  mode R {{ flow {{ z' = 0 }} }}
             half: when n == 1 {{ z := {part}  n := 2 }}"
        );
        assert_eq!(counts_of_twenty(&held, ["A.half", "A.back"]), [20, 0], "{part}");
        // fired, and turned back: held
        let turned = format!(
            "state z = z0, v = 1  discrete n: int = 0  flow {{ z' = v*(1 + 0.1*z)  v' = 0 }}
             up: when z >= 0 {{ v := -v  n := n + 1 }}  half: when n == 1 {{ z := {part}  n := 2 }}"
        );
        assert_eq!(counts_of_twenty(&turned, ["A.up", "A.half"]), [20, 20], "{part}");
    }
}

#[test]
fn rule_03_really_false_and_back_on_the_boundary_it_fires_again() {
    let run = simulate(
        "agent A { state z = -1  discrete n: int = 0  flow { z' = if n <= 1 then 1 else -1 }
                   reach: when z >= 0 { n := n + 1  z := -2 }
                   put: when n == 1 { n := 2  z := 0 } }
         system { a = A() }  run { until 3 }",
    );
    assert_eq!(run.log(), ["0 A.reach a", "1 A.put a", "2 A.reach a"]);
    all_near(&run.event_times(), &[1.0, 1.0, 1.0], 1e-11);
}

#[test]
fn rule_03_held_it_fires_at_zero_once_the_rate_points_in() {
    let agent = "state z = z0, x = 1  discrete n: int = 0  flow { x' = 0  z' = x*(1 + 0.1*z) }
                 cross: when z > 0 { x := -1  z := -0.887*z  n := n + 1 }
                 turn: when n == 1 and x < 0 { x := 1 }";
    assert_eq!(counts_of_twenty(agent, ["A.cross", "A.turn"]), [40, 20]);
}

/// The times at which `label` fires, the same by all methods and both forms.
#[track_caller]
fn times_by_all(text: &str, label: &str) -> Vec<f64> {
    let of = |integrator| {
        let run = Case::new(text).integrator(integrator).run();
        run.times(label)
    };
    let [first, others @ ..] = [Integrator::Taylor, Integrator::Tsit5, Integrator::Adams].map(of);
    others.iter().for_each(|other| all_near(other, &first, 1e-9));
    first
}

#[test]
fn rule_03_what_is_written_beside_zero_is_really_off_it() {
    // at a root with a large rate, and with a small one afterwards
    let put = "agent A { state z = -1e6, v = 1e6  discrete n: int = 0
                 flow { z' = v  v' = 0 }
                 reach: when z >= 0 { n := n + 1 }
                 put: when n == 1 { z := -1e-7  v := 1e-3  n := 2 } }
               system { a = A() }  run { until 3 }";
    all_near(&times_by_all(put, "A.reach"), &[1.0, 1.0001], 1e-9);
    // by its own write
    let own = "agent A { state z = -1e6, v = 1e6  discrete n: int = 0
                 flow { z' = v  v' = 0 }
                 reach: when z >= 0 { n := n + 1  z := if n == 0 then -1e-7 else -1e9  v := 1e-3 } }
               system { a = A() }  run { until 3 }";
    all_near(&times_by_all(own, "A.reach"), &[1.0, 1.0001], 1e-9);
    // long after the root, where it has stayed since; whatever the tolerance of events is
    for settings in ["", "event_tolerance 1e-6"] {
        let later = format!(
            "agent A {{ state z = -1000, v = 1000  discrete n: int = 0, go: int = 0
                 flow {{ z' = v  v' = 0 }}
                 reach: when z >= 0 {{ v := 0  n := n + 1 }}
                 alike: when z >= 0 and go == 1 {{ n := n + 1 }}
                 off: when time >= 2 {{ z := -1e-10  go := 1 }}
                 put: when time >= 3 {{ z := 0 }} }}
             system {{ a = A() }}  run {{ until 5  {settings} }}"
        );
        all_near(&times_by_all(&later, "A.reach"), &[1.0, 3.0], 1e-9);
        all_near(&times_by_all(&later, "A.alike"), &[3.0], 1e-9);
    }
}

#[test]
fn rule_03_a_flow_that_turns_at_a_root_leaves_what_was_true_true() {
    // z falls to zero and rises again: z >= 0 is never false, z > 0 at a single point only
    for (condition, actions) in
        [("z >= 0", ""), ("z > 0", ""), ("z >= 0", "z := 0"), ("z >= 0", "z := 0.5*z")]
    {
        let turned = format!(
            "agent A {{ state z = 1, v = -1  discrete n: int = 0
               flow {{ z' = v*(1 + 0.1*z)  v' = 0 }}
               up: when {condition} {{ n := n + 1 }}
               turn: when z <= 0 {{ v := 1  {actions} }} }}
             system {{ a = A() }}  run {{ until 3  tolerance 1e-11 }}"
        );
        all_near(&times_by_all(&turned, "A.up"), &[0.0], 1e-9);
        assert_eq!(times_by_all(&turned, "A.turn").len(), 1, "{condition} {actions}");
    }
    // ... and what goes on has been false
    let on = "agent A { state z = 1, v = -1  discrete n: int = 0
                flow { z' = v  v' = 0 }
                up: when z >= 0 { n := n + 1 }
                mark: when z <= 0 { n := n + 10 }
                back: when z <= -1 { v := 1 } }
              system { a = A() }  run { until 4 }";
    all_near(&times_by_all(on, "A.up"), &[0.0, 3.0], 1e-9);
}
