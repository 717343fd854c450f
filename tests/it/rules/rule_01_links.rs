//! Rules 1, 4, 13 and 14: links that follow from an expression.

use hyc::runtime::Algorithm;
use hyc::runtime::paper::Form;

use crate::harness::{Case, Run, all_near, near, refused};

/// A run by both forms of the engine, each with both back ends; they must tell the same.
#[track_caller]
fn simulate(text: &str) -> Run {
    let [plain, fast] =
        [Form::Plain, Form::Fast].map(|form| Case::new(text).algorithm(Algorithm::Masim(form)).run());
    assert_eq!(plain.log(), fast.log());
    let times = |run: &Run| run.events.iter().map(|event| event.time).collect::<Vec<_>>();
    all_near(&times(&fast), &times(&plain), 1e-8);
    let values =
        |run: &Run| run.finals.iter().flat_map(|last| &last.values).map(|(_, x)| *x).collect::<Vec<_>>();
    all_near(&values(&fast), &values(&plain), 1e-7);
    fast
}

#[test]
fn rule_01_a_link_follows_the_nearest() {
    let run = simulate(
        "agent Car(v: real) { state x = 0
           link lead = nearest o in other Car where o.x > x by o.x - x
           flow { x' = v }
           free: when not lead { }
           near: when lead.x - x <= 1 { } }
         system { a = Car(v = 3)  b = Car(v = 1, x = 4.2)  c = Car(v = 1.5, x = 11) }
         run { until 8  record Car.lead every 1 to \"lead.csv\" }",
    );
    // a passes b at 2.1 and c at 22/3.
    assert_eq!(
        run.log(),
        ["0 Car.free c", "0 Car.near a", "0 Car.near b", "0 Car.near a", "0 Car.free a", "0 Car.near c"]
    );
    let times: Vec<f64> = run.events.iter().map(|event| event.time).collect();
    all_near(&times, &[0.0, 1.6, 2.1, 20.0 / 3.0, 22.0 / 3.0, 22.0 / 3.0], 1e-8);
    let lead = |agent: &str| run.column(agent, 0).iter().map(|row| row.1).collect::<Vec<_>>();
    assert_eq!(lead("a"), [1.0, 1.0, 1.0, 2.0, 2.0, 2.0, 2.0, 2.0, -1.0]);
    assert_eq!(lead("b"), [2.0, 2.0, 2.0, 0.0, 0.0, 0.0, 0.0, 0.0, 2.0]);
    assert_eq!(lead("c"), [-1.0, -1.0, -1.0, -1.0, -1.0, -1.0, -1.0, -1.0, 0.0]);
}

#[test]
fn rule_01_of_several_that_are_equally_near_the_lowest_and_it_stays() {
    let run = simulate(
        "agent Dot { state x = 0  flow { x' = 0 } }
         agent Eye { state y = 3  flow { y' = -1 }  link it = nearest o in Dot by abs(o.x - y)  discrete seen = -1
           look: after 3 { seen := if it then it.x else -2 } }
         system { eye = Eye()  dots = Dot[3](x = 2*index) }
         run { until 4  record eye.it every 0.6 to \"eye.csv\" }",
    );
    // At y = 3 dots[1] and dots[2] are equally near; at y = 1, when t = 2, dots[0] becomes nearer than dots[1].
    let it: Vec<f64> = run.column("eye", 0).iter().map(|row| row.1).collect();
    assert_eq!(it, [2.0, 2.0, 2.0, 2.0, 1.0, 1.0, 1.0]);
    assert_eq!(run.value("eye.seen"), 0.0);
}

#[test]
fn rule_01_a_link_by_if() {
    let run = simulate(
        "agent Boss(pay: real) { }
         agent Hand(one: Boss, two: Boss) { state x = 0, y = 0
           link boss: Boss = if x < 2 then one else if x < 3 then none else two
           flow { x' = 1  y' = if boss then boss.pay else 0 } }
         system { bosses = Boss[2](pay = 1 + 4*index)  hand = Hand(one = bosses[0], two = bosses[1]) }
         run { until 4 }",
    );
    near(run.value("hand.y"), 2.0 + 5.0, 1e-9);
    let run = simulate(
        "agent Car(k: int) { state x = 0
           link lead: Car = if index >= 1 then cars[index - 1] else none
           flow { x' = if lead then lead.k else -1 } }
         system { cars = Car[3](k = index + 10) }  run { until 1 }",
    );
    all_near(&["cars[0].x", "cars[1].x", "cars[2].x"].map(|x| run.value(x)), &[-1.0, 10.0, 11.0], 1e-9);
}

#[test]
fn rule_04_links_that_the_flow_changed_are_updated_first() {
    // At 2 the link goes from a to b: `go` reads the new one, though the flow makes both true at once.
    let run = simulate(
        "agent Mark(k: real) { state x = 0  flow { x' = 0 } }
         agent Car { state x = 0  flow { x' = 1 }  discrete seen = 0
           link next = nearest o in Mark where o.x > x by o.x - x
           go: when x >= 2 { seen := if next then next.k else -1 } }
         system { car = Car()  a = Mark(k = 1, x = 2)  b = Mark(k = 2, x = 5) }  run { until 3 }",
    );
    assert_eq!(run.value("car.seen"), 2.0);
}

#[test]
fn rule_07_a_write_moves_links_at_once() {
    let run = simulate(
        "agent Car(x0: real) { state x = x0  discrete lane: int = 1, gap = 0
           link lead = nearest o in other Car where o.lane == lane and o.x > x by o.x - x
           flow { x' = 1 }
           change: after x0 + 1 when lead { lane := 2 }
           close: when lead.x - x <= 5 { gap := lead.x - x } }
         system { cars = Car[3](x0 = 10*index)  slow = Car(x0 = 4, lane = 2) }  run { until 2 }",
    );
    // cars[0] changes to lane 2 at 1, and finds `slow` 4 ahead.
    assert_eq!(run.log(), ["0 Car.change cars[0]", "1 Car.close cars[0]"]);
    near(run.value("cars[0].gap"), 4.0, 1e-9);
}

#[test]
fn rule_13_coupled_flows_regroup_by_link() {
    let run = simulate(
        "agent Lead(x0: real, v: real) { state x = x0  flow { x' = v } }
         agent Tail { state y = 0
           link lead = nearest o in Lead by abs(o.x - 2)
           flow { y' = if lead then lead.x else 0 } }
         system { tail = Tail()  a = Lead(x0 = 0, v = 1)  b = Lead(x0 = 10, v = -1) }  run { until 7 }",
    );
    // x = t of a until 5, then 10 - t of b.
    near(run.value("tail.y"), 12.5 + 8.0, 1e-8);
}

#[test]
fn rule_13_a_chain_of_followers_whose_order_changes() {
    let run = simulate(
        "agent Car(v: real) { state x = 0, u = v
           link lead = nearest o in other Car where o.x > x by o.x - x
           flow { x' = u  u' = if lead then 0.1*(lead.u - u) else 0.1*(v - u) }
           mark: when rising(x >= 30) { } }
         system { cars = Car[6](v = 4 + 2*mod(3*index, 5), x = 5*index) }  run { until 12  tolerance 1e-10 }",
    );
    assert!(run.times("Car.mark").len() >= 4);
    assert!(run.stats.cuts > 0);
}

#[test]
fn rule_14_who_comes_and_goes_wakes_links() {
    let run = simulate(
        "agent Dot(k: real) { state x = 0  flow { x' = 0 }  old: after k { destroy self } }
         agent Maker { make: after 1 { create Dot(k = 1, x = 1) } }
         agent Eye { discrete n = 0
           link it = nearest o in Dot where o.x >= 0 by o.x
           first: when it.k == 1 { n := n + 1 }
           second: when it.k == 5 { n := n + 10 }
           nobody: when not it { n := n + 100 } }
         system { eye = Eye()  maker = Maker()  dot = Dot(k = 5, x = 3) }  run { until 6 }",
    );
    assert_eq!(
        run.log(),
        [
            "0 Eye.second eye",
            "0 Maker.make maker",
            "1 Eye.first eye",
            "0 Dot.old Dot#3",
            "1 Eye.second eye",
            "0 Dot.old dot",
            "1 Eye.nobody eye",
        ]
    );
    all_near(
        &run.events.iter().map(|event| event.time).collect::<Vec<_>>(),
        &[0.0, 1.0, 1.0, 2.0, 2.0, 5.0, 5.0],
        1e-9,
    );
}

#[test]
fn rule_02_a_nearest_of_a_guard_names_its_agent() {
    let run = simulate(
        "agent Dot(v: real) { state x = 10  flow { x' = -v } }
         agent Eye { state y = 0  flow { y' = 0 }  discrete who = 0, d = 0
           let first = (nearest o in Dot by o.x).x
           see: when nearest o in Dot where o.x <= 4 by o.x { who := o.v  d := o.x }
           end: when (nearest o in Dot by o.x).x <= 1 { who := -who } }
         system { eye = Eye()  dots = Dot[3](v = 1 + index) }  run { until 4  record eye.first every 1 to \"eye.csv\" }",
    );
    // dots[2] of 3 m/s is at 4 at t = 2 and at 1 at 3.
    all_near(&run.times("Eye.see"), &[2.0], 1e-9);
    all_near(&run.times("Eye.end"), &[3.0], 1e-9);
    assert_eq!(run.value("eye.who"), -3.0);
    near(run.value("eye.d"), 4.0, 1e-9);
    all_near(
        &run.column("eye", 0).iter().map(|row| row.1).collect::<Vec<_>>(),
        &[10.0, 7.0, 4.0, 1.0, -2.0],
        1e-9,
    );
}

#[test]
fn rule_01_what_links_must_not_be() {
    let told = |link: &str| {
        refused(&format!(
            "agent Car {{ state x = 0  discrete n = 0  {link}  flow {{ x' = 1 }} }}
             system {{ cars = Car[2]() }}  run {{ until 1 }}"
        ))
    };
    assert!(
        told("link a: Car = if b then none else self  link b: Car = if a then self else none")
            .contains("links need each other")
    );
    assert!(told("link a = if n > 0 then none else none").contains("without a type"));
    assert!(told("link a: Car = 3").contains("HY0220"));
    assert!(told("link a = nearest o in other Car by o.x > 1").contains("HY0223"));
    assert!(told("link a = nearest o in other Car").contains("a number behind `by`"));
    let none = refused(
        "agent Car { state x = 0  link a = nearest o in other Car by o.x  flow { x' = a.x } }  system { cars = Car[2]() }",
    );
    assert!(none.contains("HY0245"), "{none}");
}

/// Numbers that look random, between 0 and 1.
const HASH: &str = "fn hash(i: real, k: real) = mod(sin(12.9898*(i + 1) + 78.233*k)*43758.5453, 1)";

/// Cars that come, change lanes and speeds, and go; whoever is recorded must be led to by the one who is nearest, by looking at all.
#[test]
fn rule_01_generated_links_are_those_found_by_looking_at_all() {
    let mut n_led = 0;
    for seed in 0..3 {
        let text = format!(
            "{HASH}
             agent Car(k: real) {{ state x = 60*hash(k, 1)  discrete lane: int = floor(2*hash(k, 2)), v = 2 + 8*hash(k, 3), n = 0
               link lead = nearest o in other Car where o.lane == lane and o.x > x by o.x - x
               link pal = nearest o in other Car where o.v <= 8 by (o.x - x)^2
               flow {{ x' = v }}
               turn: every 0.3 + hash(k, 4) {{ n := n + 1  v := 2 + 8*hash(k, n)
                 lane := if hash(k + n, 5) <= 0.3 then 1 - lane else lane }}
               slow: when lead.x - x <= 0.5 {{ v := 0.5*v }}
               leave: when x >= 100 {{ destroy self }} }}
             agent Ramp {{ discrete n = 0  enter: every 0.7 {{ create Car(k = 100 + n + 10*{seed}, x = 0)  n := n + 1 }} }}
             system {{ cars = Car[8](k = index + 50*{seed})  ramp = Ramp() }}
             run {{ until 12  record Car.x, Car.lane, Car.v, Car.lead, Car.pal every 0.37 to \"cars.csv\" }}"
        );
        let run = simulate(&text);
        let rows = &run.samples[0];
        let number = |name: &str| -> f64 {
            let digits: String = name.chars().filter(char::is_ascii_digit).collect();
            digits.parse().unwrap()
        };
        for row in rows {
            let [x, lane, _, lead, pal] = row.cells[..] else { panic!() };
            let others: Vec<_> = rows.iter().filter(|o| o.time == row.time && o.agent != row.agent).collect();
            let found = |to: f64| others.iter().find(|o| number(&o.agent) == to);
            // Where two are as near as the integration is good, either will do.
            let ahead = others.iter().filter(|o| o.cells[1] == lane && o.cells[0] > x + 1e-7);
            let least = ahead.map(|o| o.cells[0] - x).fold(f64::INFINITY, f64::min);
            let is = found(lead).map_or(f64::INFINITY, |o| o.cells[0] - x);
            let beside = others.iter().any(|o| (o.cells[0] - x).abs() <= 1e-6);
            assert!(is == least || (is - least).abs() <= 1e-6 || beside, "{row:?}: {is} is not {least}");
            let slow = others.iter().filter(|o| o.cells[2] <= 8.0);
            let least = slow.map(|o| (o.cells[0] - x).abs()).fold(f64::INFINITY, f64::min);
            let is = found(pal).map_or(f64::INFINITY, |o| (o.cells[0] - x).abs());
            assert!(is == least || (is - least).abs() <= 1e-6, "{row:?}: pal {is} is not {least}");
            n_led += usize::from(lead >= 0.0);
        }
    }
    assert!(n_led > 200, "{n_led}");
}
