//! Do `count`, `sum`, `min` and `max` over agents change guards, lets and actions at the instants that can be worked out by hand?

use crate::harness::{Case, Ended, all_near, near, refused, simulate, simulate_error, simulate_to_the_end};

/// Four cars that start together and drive off at 1, 2, 3 and 4 m/s, with a transition `t`.
#[track_caller]
fn cars(transition: &str) -> crate::harness::Run {
    simulate(&format!(
        "agent Car(v: real) {{
           state x = 0
           discrete n = 0
           flow {{ x' = v }}
           t: {transition}
         }}
         system {{ car = Car[4](v = index + 1) }}
         run {{ until 3 }}"
    ))
}

/// When `t` of each car fires.
#[track_caller]
fn firings(guard: &str) -> [Vec<f64>; 4] {
    let run = cars(&format!("when {guard} {{ n := n + 1 }}"));
    [0, 1, 2, 3].map(|k| run.times_of("Car.t", &format!("car[{k}]")))
}

#[track_caller]
fn fire_at(guard: &str, expected: [&[f64]; 4]) {
    for (k, (found, expected)) in firings(guard).iter().zip(expected).enumerate() {
        assert_eq!(found.len(), expected.len(), "car {k}: {found:?} instead of {expected:?}");
        all_near(found, expected, 1e-9);
    }
}

/// Watches cars whose states are x = a + b t; `watch.t` is the transition.
#[track_caller]
fn watched(cars: &[(f64, f64)], transition: &str) -> Vec<f64> {
    let mut system = String::new();
    for (k, (a, b)) in cars.iter().enumerate() {
        system += &format!("car{k} = Car(x = {a}, v = {b})  ");
    }
    let run = simulate(&format!(
        "agent Car(v: real) {{ state x  flow {{ x' = v }} }}
         agent Watch {{ discrete n = 0  t: {transition} }}
         system {{ {system} watch = Watch() }}
         run {{ until 10 }}"
    ));
    run.times("Watch.t")
}

const THIRD: f64 = 1.0 / 3.0;

#[test]
fn a_count_changes_at_the_instant_of_its_condition() {
    fire_at("(count o in Car where o.x >= 1) >= 3", [&[0.5]; 4]);
    fire_at("(count o in other Car where o.x >= 1) >= 2", [&[THIRD], &[THIRD], &[0.5], &[0.5]]);
    fire_at("(count o in Car where o.x <= 1) <= 2", [&[THIRD]; 4]);
    fire_at("(count o in Car: o.x <= 1) == 3", [&[0.25]; 4]);
    fire_at("(count o in Car where o.x >= 1) != 0", [&[0.25]; 4]);
    fire_at("(count o in Car where o.x >= 1) >= 5", [&[]; 4]);
    // 6 - 1 from 1/2 on, 6 - 2 from 2/3 on, 8 - 3 from 1 on
    fire_at("2*(count o in Car where o.x >= 1) - (count o in Car where o.x >= 2) > 4", [&[0.5, 1.0]; 4]);
}

#[test]
fn a_count_by_what_self_and_another_have_in_common() {
    // car k is passed by none and has left k behind by 1 m at t = 1/(v - v_o)
    fire_at("(count o in other Car where x - o.x >= 1) >= 2", [&[], &[], &[1.0], &[0.5]]);
    let meeting = |transition: &str| {
        simulate(&format!(
            "fn dist2(a: Car, b: Car) = (a.x - b.x)^2 + (a.y - b.y)^2
             agent Car(v: real) {{
               state x, y = 0
               discrete n = 0
               flow {{ x' = v  y' = 0 }}
               t: {transition}
             }}
             system {{ rock = Car(x = 0, v = 0)  a = Car(x = -9, v = 2)  b = Car(x = 8, v = -3)  c = Car(x = 12, v = -2) }}
             run {{ until 6 }}"
        ))
    };
    // within 1 m of the rock: a in [4, 5], b in [7/3, 3], c in [5.5, 6.5]
    let near_rock = "(count o in other Car where dist2(self, o) <= 1)";
    let run = meeting(&format!("when {near_rock} >= 1 {{ n := n + 1 }}"));
    all_near(&run.times_of("Car.t", "rock"), &[7.0 / 3.0, 4.0, 5.5], 1e-9);
}

#[test]
fn members_that_come_and_go_together_are_both_there_at_the_instant_if_it_is_closed() {
    let pair = [(0.0, 1.0), (2.0, -1.0)];
    all_near(&watched(&pair, "when (count o in Car where o.x <= 1) >= 2 { n := n + 1 }"), &[1.0], 1e-9);
    all_near(&watched(&pair, "when (count o in Car where o.x < 1) >= 2 { n := n + 1 }"), &[], 1e-9);
    all_near(&watched(&pair, "when (count o in Car where o.x < 1) <= 0 { n := n + 1 }"), &[1.0], 1e-9);
    all_near(&watched(&pair, "when (count o in Car where o.x <= 1) <= 0 { n := n + 1 }"), &[], 1e-9);
}

#[test]
fn a_sum_has_its_roots_where_its_terms_add_up() {
    fire_at("(sum o in Car: o.x) >= 12", [&[1.2]; 4]);
    fire_at("(sum o in other Car: o.x - x) <= -2", [&[], &[], &[1.0], &[THIRD]]);
    fire_at("(sum o in Car: o.x^2) >= 30 + (sum o in Car: 0*o.x)", [&[1.0]; 4]);
    fire_at("crossing((sum o in Car: o.x) - 5)", [&[0.5]; 4]);
    fire_at("(sum o in Car: o.v) >= 10 and x >= 1", [&[1.0], &[0.5], &[THIRD], &[0.25]]);
}

#[test]
fn a_sum_with_a_filter_jumps_and_goes_on() {
    // 4t from 1/4 on, 7t from 1/3 on, 9t from 1/2 on
    fire_at("(sum o in Car where o.x >= 1: o.x) >= 3", [&[3.0 / 7.0]; 4]);
    fire_at("(sum o in Car where o.x >= 1: o.x) >= 4", [&[0.5]; 4]);
    fire_at("(sum o in Car where o.x >= 1: 1) >= 3", [&[0.5]; 4]);
    // 1 + 2 + 3 + 4 less those that have passed 1
    fire_at("(sum o in Car where o.x <= 1: o.v) <= 3", [&[THIRD]; 4]);
    // what leaves takes the sum down: 10t, 6t from 1/4 on, 3t from 1/3 on
    fire_at("(sum o in Car where o.x <= 1: o.x) >= 1.8", [&[0.18, 0.3]; 4]);
    let run = cars("when (sum o in Car where o.x <= 1: o.x) <= 1.2 and time >= 0.2 { n := n + 1 }");
    all_near(&run.times_of("Car.t", "car[0]"), &[THIRD, 0.5], 1e-9);
}

#[test]
fn min_and_max_follow_whoever_is_least_and_greatest() {
    fire_at("(max o in Car: o.x) >= 3", [&[0.75]; 4]);
    fire_at("(min o in Car: o.x) >= 2", [&[2.0]; 4]);
    fire_at("(min o in other Car: o.x) >= 2", [&[1.0], &[2.0], &[2.0], &[2.0]]);
    fire_at("x - (max o in other Car: o.x) >= 0.5", [&[], &[], &[], &[0.5]]);
    fire_at("(max o in Car: o.x) - (min o in Car: o.x) > 1.5", [&[0.5]; 4]);
    // each is the least when it comes, at 1 exactly
    fire_at("(min o in Car where o.x >= 1: o.x) <= 1", [&[0.25, THIRD, 0.5, 1.0]; 4]);
    // the least distance: c is nearer to a than b until both are 7/3 away
    let cars = [(0.0, 1.0), (5.0, -1.0), (3.0, 0.5)];
    all_near(
        &watched(&cars, "when (min o in Car: abs(o.x - time)) <= 1 and time >= 1 { n := n + 1 }"),
        &[1.0],
        1e-9,
    );
    let least = "(min o in Car where o.x > 0: abs(o.x - 10))";
    all_near(
        &watched(&[(0.0, 1.0), (40.0, -10.0)], &format!("when {least} <= 1 {{ n := n + 1 }}")),
        &[2.9, 9.0],
        1e-9,
    );
}

#[test]
fn a_min_within_a_formula_switches_its_member() {
    // the least is t until 1, then 2 - t
    let pair = [(0.0, 1.0), (2.0, -1.0)];
    let at = |guard: &str| watched(&pair, &format!("when {guard} {{ n := n + 1 }}"));
    all_near(&at("(min o in Car: o.x)^2 >= 0.81"), &[0.9, 2.9], 1e-9);
    all_near(&at("exp(min o in Car: o.x) <= exp(0.25) and time >= 1"), &[1.75], 1e-9);
    all_near(&at("(min o in Car: o.x)^2 > 1.0000001 and time <= 1.5"), &[], 1e-9);
    all_near(&at("(max o in Car: o.x)*(min o in Car: o.x) >= 0.75"), &[0.5], 1e-9);
    all_near(&at("(max o in Car: o.x)*(max o in Car: o.x) <= 1.44"), &[0.8], 1e-9);
}

#[test]
fn of_nobody_count_and_sum_are_zero_and_min_and_max_infinite() {
    let nobody = "o in Car where o.x >= 100";
    for (guard, fires) in [
        (format!("(count {nobody}) <= 0"), true),
        (format!("(count {nobody}) >= 1"), false),
        (format!("(sum {nobody}: o.x) >= 0"), true),
        (format!("(sum {nobody}: o.x) > 0"), false),
        (format!("(min {nobody}: o.x) >= 1e300"), true),
        (format!("(min {nobody}: o.x) <= 1e300"), false),
        (format!("(max {nobody}: o.x) <= -1e300"), true),
        (format!("(max {nobody}: o.x) >= -1e300"), false),
        (format!("exp(-(min {nobody}: o.x)) <= 0"), true),
        ("(min o in Empty: 1) >= 1e300".to_string(), true),
        ("(count o in Empty) == 0".to_string(), true),
    ] {
        let run = simulate(&format!(
            "agent Car {{ state x = 0  flow {{ x' = 1 }} }}
             agent Empty {{ }}
             agent Watch {{ discrete n = 0  t: when {guard} {{ n := 1 }} }}
             system {{ car = Car[3]()  watch = Watch() }}
             run {{ until 2 }}"
        ));
        let expected: &[f64] = if fires { &[0.0] } else { &[] };
        assert_eq!(run.times("Watch.t"), expected, "{guard}");
    }
}

#[test]
fn members_that_change_their_mode_or_a_discrete_wake_the_guard() {
    let run = simulate(
        "agent Lamp(after_: real, p: real) {
           discrete level: int = 0
           initial mode Off { on_: after after_ -> On { level := 2 } }
           mode On { off: after 2 -> Off { level := 0 } }
         }
         agent Watch {
           discrete a = 0, b = 0, c = 0, d = 0
           three: when (count l in Lamp where l is On) >= 3 { a := time }
           power: when (sum l in Lamp where l is On: l.p) >= 5 { b := time }
           bright: when (sum l in Lamp: l.level) >= 4 { c := time }
           dark: when (max l in Lamp: l.level) <= 0 and time > 0.5 { d := time }
         }
         system { lamp = Lamp[4](after_ = 1 + 0.5*index, p = index)  watch = Watch() }
         run { until 6 }",
    );
    // on from 1, 1.5, 2, 2.5, each for 2 s
    all_near(&run.times("Watch.three"), &[2.0], 1e-12);
    all_near(&run.times("Watch.power"), &[2.5], 1e-12);
    // and again after as long as before; from 4.5 to 5 the first is alone
    all_near(&run.times("Watch.bright"), &[1.5, 5.0], 1e-12);
    all_near(&run.times("Watch.dark"), &[0.5], 1e-9);
}

#[test]
fn a_reset_of_a_member_counts_in_the_same_instant() {
    let run = simulate(
        "agent Ball { state x = 0  flow { x' = 1 }  jump: when x >= 1 { x := 10 } }
         agent Watch {
           discrete n = 0
           heap: when (sum b in Ball: b.x) >= 15 { n := n + 1 }
           far: when (count b in Ball where b.x >= 5) >= 2 { n := n + 10 }
         }
         system { ball = Ball[2](x = -0.5*index)  watch = Watch() }
         run { until 3 }",
    );
    // the first jumps at 1, the second at 1.5, when the first is at 10.5
    assert_eq!(run.times("Watch.heap"), run.times_of("Ball.jump", "ball[1]"));
    assert_eq!(run.times("Watch.far"), run.times_of("Ball.jump", "ball[1]"));
    near(run.times("Watch.far")[0], 1.5, 1e-9);
    near(run.value("watch.n"), 11.0, 0.0);
}

#[test]
fn lets_are_aggregates_wherever_they_are_read() {
    let run = simulate(
        "agent Car(v: real) {
           state x = 0
           discrete n = 0
           flow { x' = v }
           let ahead = count o in other Car where o.x > x
           let total = sum o in Car: o.x
           let least = min o in other Car: o.x
           let most = max o in other Car where o.x >= 1: o.x
           let crowded = (count o in Car where o.x >= 1) >= 2
           t: when total >= 5 { n := ahead + 100*least }
           u: when crowded { n := total }
         }
         agent Watch { discrete n = 0  t: when (max o in Car: o.total) >= 12 { n := sum o in Car: o.ahead } }
         system { car = Car[4](v = index + 1)  watch = Watch() }
         run { until 3  record Car.ahead, Car.total, Car.least, Car.most, Car.crowded every 0.375 to \"c.csv\" }",
    );
    all_near(&run.times("Car.u"), &[THIRD; 4], 1e-9);
    all_near(&run.times("Car.t"), &[0.5; 4], 1e-9);
    all_near(&run.times("Watch.t"), &[1.2], 1e-9);
    near(run.value("watch.n"), 6.0, 0.0);
    all_near(&[0, 1, 2, 3].map(|k| run.value(&format!("car[{k}].n"))), &[103.0, 52.0, 51.0, 50.0], 1e-6);
    for sample in &run.samples[0] {
        let (t, k) = (sample.time, sample.agent.as_bytes()[4] - b'0');
        if t == 0.0 {
            continue;
        }
        let others = (0..4).filter(|o| *o != k).map(|o| f64::from(o + 1) * t);
        let least = others.clone().fold(f64::INFINITY, f64::min);
        let most = others.filter(|x| *x >= 1.0).fold(f64::NEG_INFINITY, f64::max);
        let crowded = f64::from(u8::from(t >= THIRD));
        all_near(&sample.cells[..3], &[f64::from(3 - k), 10.0 * t, least], 1e-9);
        near(sample.cells[3], most, 1e-9);
        assert_eq!(sample.cells[4], crowded);
    }
}

#[test]
fn actions_read_the_state_before_them() {
    let run = simulate(
        "agent Car(v: real) {
           state x = 0
           discrete n = 0, s = 0, least = 0, most = 0, few: bool = false
           flow { x' = v }
           t: after 0.4 {
             n := count o in other Car where o.x >= 1
             s := sum o in other Car where o.x >= 1: o.x
             least := min o in Car: o.x - x
             most := max o in Car: o.x - x
             few := (count o in Car where o.x >= 1) <= 1
             x := sum o in Car: o.x
             if (count o in Car where o.x > x) >= 2 { v_ := 1 } else { v_ := 2 }
           }
           discrete v_ = 0
         }
         system { car = Car[4](v = index + 1) }
         run { until 0.4 }",
    );
    let all = |name: &str| [0, 1, 2, 3].map(|k| run.value(&format!("car[{k}].{name}")));
    // x = 0.4, 0.8, 1.2, 1.6
    all_near(&all("n"), &[2.0, 2.0, 1.0, 1.0], 0.0);
    all_near(&all("s"), &[2.8, 2.8, 1.6, 1.2], 1e-9);
    all_near(&all("least"), &[0.0, -0.4, -0.8, -1.2], 1e-9);
    all_near(&all("most"), &[1.2, 0.8, 0.4, 0.0], 1e-9);
    all_near(&all("few"), &[0.0; 4], 0.0);
    all_near(&all("x"), &[4.0; 4], 1e-9);
    all_near(&all("v_"), &[1.0, 1.0, 2.0, 2.0], 0.0);
}

#[test]
fn entry_actions_priorities_and_delays_take_aggregates() {
    let run = simulate(
        "agent Car {
           state x = 0
           discrete n: int = 0
           flow { x' = 1 }
           initial mode A {
             entry { n := count o in other Car }
             low: when x >= 1 priority (count o in Car) - 10 -> B
             high: when x >= 1 priority (sum o in Car: 1) -> C
           }
           mode B { }
           mode C { back: after 0.5*(count o in Car) -> A }
         }
         system { car = Car[3]() }
         run { until 3 }",
    );
    assert_eq!(run.value("car[1].n"), 2.0);
    all_near(&run.times_of("Car.high", "car[1]"), &[1.0, 2.5], 1e-9);
    all_near(&run.times_of("Car.back", "car[1]"), &[2.5], 1e-9);
}

#[test]
fn claims_are_judged_by_aggregates() {
    let car = |claim: &str| {
        format!(
            "agent Car(v: real) {{ state x = 0  flow {{ x' = v }} {claim} }}
             system {{ car = Car[4](v = index + 1) }}
             run {{ until 3 }}"
        )
    };
    let run = Case::new(&car("assert (count o in Car where o.x >= 1) <= 2")).run();
    near(run.false_asserts[0].time, 0.5, 1e-9);
    let (run, _) = simulate_error(&car("invariant (sum o in Car: o.x) <= 12"));
    near(run.time, 1.2, 1e-9);
    assert!(matches!(run.end, Ended::Error(_)));
}

#[test]
fn aggregates_stand_inside_quantifiers_and_each_other() {
    // groups of cars within 1 m of each other, by the one in the middle
    fire_at(
        "exists o in other Car: (count p in Car where p.x >= o.x + 1) >= 2",
        // o = car[0]: cars 2 and 3 ahead by 1 from t = 1/2 on; o = car[1]: from t = 1 on
        [&[1.0], &[0.5], &[0.5], &[0.5]],
    );
    // how many cars have two others more than 1 m ahead: car[0] from 1/2 on, car[1] from 1 on
    fire_at("(count o in Car where (count p in Car where p.x >= o.x + 1) >= 2) >= 2", [&[1.0]; 4]);
    // the sum over all of how far the first is ahead: 4*4t - 10t
    fire_at("(sum o in Car: (max p in Car: p.x) - o.x) >= 3", [&[0.5]; 4]);
    fire_at("(sum o in Car where exists p in Car: p.x >= o.x + 3: o.x) >= 1", [&[1.0]; 4]);
    fire_at(
        "forall o in Car: (sum p in Car where p.v <= o.v: p.x) >= o.x and x >= 2",
        [&[2.0], &[1.0], &[2.0 / 3.0], &[0.5]],
    );
}

#[test]
fn an_interaction_leaves_out_both_participants() {
    let run = simulate(
        "agent Car(v: real) { state x = 0  discrete n = 0  flow { x' = v } }
         interaction Meet(a: Car, b: Car) {
           both: when (count o in other Car where o.x >= 1) >= 2 { a.n := a.n + 1  b.n := b.n + 1 }
         }
         interaction Pass(a: Car, b: Car) {
           lead: when a.x >= b.x + 1 and (sum o in other Car: o.x) >= 3 { a.n := a.n + 10 }
         }
         system { car = Car[4](v = index + 1) }
         run { until 3 }",
    );
    let of = |a: &str, b: &str| {
        let pair = run.events.iter().find(|event| {
            event.transition == "Meet.both"
                && event.agent == format!("car[{a}]")
                && event.other == format!("car[{b}]")
        });
        pair.map(|event| event.time)
    };
    // both others beyond 1: the slower of them decides; one flag for each unordered pair
    near(of("0", "1").unwrap(), THIRD, 1e-9);
    near(of("2", "3").unwrap(), 1.0, 1e-9);
    assert_eq!(of("1", "0"), None);
    let lead = run
        .events
        .iter()
        .find(|event| event.transition == "Pass.lead" && event.agent == "car[3]" && event.other == "car[0]");
    // car[3] leads car[0] by 1 m at 1/3; the others have 5t = 3 at 0.6
    near(lead.unwrap().time, 0.6, 1e-9);
}

#[test]
fn sums_are_added_in_the_order_of_the_agents_by_both_back_ends() {
    // The harness compares both back ends to the bit; numbers whose sum depends on the order.
    let run = simulate(
        "agent A(p: real) { state x = 0  flow { x' = 0 } }
         agent Watch { discrete s = 0  t: after 1 { s := sum a in A: a.p + a.x } }
         system { a = A(p = 1e16)  b = A(p = 1)  c = A(p = 1)  d = A(p = -1e16)  watch = Watch() }
         run { until 2 }",
    );
    assert_eq!(run.value("watch.s"), ((1e16 + 1.0) + 1.0) - 1e16);
}

#[test]
fn a_count_of_two_hundred_is_quick_and_right() {
    let run = simulate(
        "agent Car(v: real) { state x = 0  flow { x' = v } }
         agent Watch { discrete n = 0  t: when (count c in Car where c.x >= 1) >= 100 { n := 1 } }
         system { car = Car[200](v = 1 + index)  watch = Watch() }
         run { until 1 }",
    );
    // the hundredth to pass 1 m drives at 101 m/s
    all_near(&run.times("Watch.t"), &[1.0 / 101.0], 1e-10);
}

#[test]
fn what_is_wrong_with_an_aggregate_is_said() {
    let with = |guard: &str| {
        refused(&format!("agent Car {{ state x = 0  flow {{ x' = 1 }}  t: when {guard} {{ x := 0 }} }}"))
    };
    let text = with("sum o in Car: o.x >= 3");
    assert!(text.contains("HY0220") && text.contains("`(sum ... : ...) >= 1`"), "{text}");
    assert!(with("(min o in Car) >= 3").contains("needs a number behind `:`"));
    assert!(with("(count o in Car where o.x) >= 3").contains("HY0222"));
    assert!(with("(count o in Car where o.x >= 1)").contains("HY0222"));
    assert!(with("(sum o in Car: o.y) >= 1").contains("HY0203"));
}

#[test]
fn a_sum_that_is_entered_on_its_boundary_moving_out_is_held() {
    // The sum is at 1 at 1 s, when the mode is entered again with a flow that takes it down.
    let run = simulate(
        "agent Car {
           state x = 0
           discrete n: int = 0
           initial mode Up {
             flow { x' = 1 }
             t: when (sum o in Car: o.x) > 1 -> Down { n := n + 1 }
           }
           mode Down {
             flow { x' = -1 }
             u: when (sum o in Car: o.x) >= 1 -> Rest { n := n + 10 }
           }
           mode Rest { flow { x' = 0 } }
         }
         system { car = Car() }
         run { until 3 }",
    );
    assert_eq!((run.mode("car"), run.value("car.n")), ("Down", 1.0));
}

#[test]
fn rule_10_a_quantifier_chooses_between_numbers() {
    let run = simulate_to_the_end(
        "agent A(k: real) {
           state x = k
           discrete v = 0
           flow { x' = 1 }
           let near_ = if exists o in other A: o.x >= 4 then 1 else 0
           let far = if not (forall o in other A where o.k < 5: o.x >= 2) or x < 0 then 0 else 10
           both: when near_ + far >= 11 { v := if exists o in other A where o.x < x: o.x >= 2.5 then 2 else 1 }
         }
         system { a = A[3](k = index) }
         run { until 5 }",
    );
    all_near(&[0, 1, 2].map(|k| run.times_of("A.both", &format!("a[{k}]"))[0]), &[2.0, 2.0, 3.0], 1e-12);
    assert_eq!([0, 1, 2].map(|k| run.value(&format!("a[{k}].v"))), [1.0, 1.0, 2.0]);
}
