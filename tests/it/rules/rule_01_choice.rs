//! Rule 1: agents that are chosen by `if`, wherever an agent may stand.

use crate::harness::{all_near, near, refused, simulate_to_the_end};

/// Two posts that move at different speeds.
const POSTS: &str = "agent Post(k: real) { state x = k  flow { x' = k } }\n";

#[test]
fn rule_01_a_chosen_agent_is_read_in_flows_guards_and_actions() {
    // the posts are at 1 + t and at 2 + 2 t
    let run = simulate_to_the_end(&format!(
        "{POSTS}agent Car(a: Post, b: Post) {{
           state x = 0, d = 0
           discrete first: bool = true, seen = 0
           flow {{ x' = (if first then a else b).k  d' = (if time < 1 then a else b).x }}
           swap: when time >= 1 {{ first := false }}
           near_: when (if first then a else b).x >= 3 {{ seen := (if first then a else b).x + 10*(if first then a else b).x' }}
         }}
         system {{ a = Post(k = 1)  b = Post(k = 2)  car = Car(a = a, b = b) }}
         run {{ until 2 }}"
    ));
    // by its second post the guard is true as soon as that is the chosen one
    assert_eq!(run.log(), ["0 Car.swap car", "1 Car.near_ car"]);
    all_near(&run.event_times(), &[1.0, 1.0], 1e-12);
    near(run.value("car.x"), 1.0 + 2.0, 1e-9);
    near(run.value("car.d"), 1.5 + 5.0, 1e-6);
    near(run.value("car.seen"), 4.0 + 10.0 * 2.0, 1e-9);
}

#[test]
fn rule_01_a_chosen_agent_is_an_argument_a_side_of_an_equality_and_a_condition() {
    let run = simulate_to_the_end(&format!(
        "{POSTS}fn gap(p: Post, q: Post) = q.x - p.x
         agent Car(a: Post, b: Post) {{
           link spare: Post
           discrete first: bool = true, g = 0, h = 0, same: bool = false, other_: bool = true, there: bool = true, half: int = 0
           when time >= 0.5 {{ g := gap(if first then a else b, if first then b else a)  first := false }}
           when time >= 1.5 {{
             h := gap(if first then a else b, if first then b else a)
             same := (if first then a else b) == b
             other_ := (if first then a else none) == a
             there := if (if first then a else none) then true else false
             if if first then spare else a {{ half := 1 }}
           }}
         }}
         system {{ a = Post(k = 1)  b = Post(k = 2)  car = Car(a = a, b = b) }}
         run {{ until 2 }}"
    ));
    near(run.value("car.g"), 1.5, 1e-9);
    near(run.value("car.h"), -2.5, 1e-9);
    let truths = ["same", "other_", "there", "half"].map(|name| run.value(&format!("car.{name}")));
    assert_eq!(truths, [1.0, 0.0, 0.0, 1.0]);
}

#[test]
fn rule_01_a_link_leads_to_a_member_of_a_chosen_agent() {
    let run = simulate_to_the_end(
        "agent Car(k: int) {
           link next: Car
           link beyond: Car = (if time < 1 then self else next).next
           state x = 0
           flow { x' = if beyond then beyond.k else 0 }
         }
         system { cars = Car[3](k = index, next = if index < 2 then cars[index + 1] else none) }
         run { until 3 }",
    );
    // car 0 follows 1, then 2; car 1 follows 2, then nobody
    all_near(&[0, 1, 2].map(|k| run.value(&format!("cars[{k}].x"))), &[1.0 + 2.0 * 2.0, 2.0, 0.0], 1e-9);
}

#[test]
fn rule_01_a_chosen_agent_is_created_with_destroyed_and_heard() {
    let run = simulate_to_the_end(
        "agent Horn(k: int) {
           event toot(n: int)
           state x = 0
           flow { x' = 1 }
           every 1 { emit toot(k) }
         }
         agent Ear { link a: Horn  discrete n: int = 0  on toot(k) from a { n := n + k } }
         agent Boss {
           link a: Horn
           link b: Horn
           discrete first: bool = true, heard: int = 0
           hear: on toot(k) from if first then a else b { heard := heard + k }
           swap: when time >= 1.5 { first := false  create Ear(a = if first then a else b) }
           more: when time >= 1.6 { create Ear(a = if first then a else b) }
           end: when time >= 3.5 { destroy if heard > 100 then none else if first then a else b  stop }
         }
         system { a = Horn(k = 1)  b = Horn(k = 10)  boss = Boss(a = a, b = b) }
         run { until 4 }",
    );
    // at t = 1 the first, at t = 2 and 3 the second
    near(run.value("boss.heard"), 21.0, 0.0);
    near(run.value("Ear#3.n"), 2.0, 0.0);
    near(run.value("Ear#4.n"), 20.0, 0.0);
}

#[test]
fn rule_01_whoever_is_chosen_is_of_one_type() {
    let told = refused(
        "agent A { state x = 0  flow { x' = 1 } }
         agent B { state x = 0  flow { x' = 1 } }
         agent C(a: A, b: B) { state x = 0  flow { x' = (if time < 1 then a else b).x } }",
    );
    assert!(told.contains("HY0220") && told.contains("an agent `A`, as what follows `then`"), "{told}");
}

#[test]
fn rule_10_a_flow_does_not_read_a_chosen_agent_that_may_be_none() {
    let flow = |rate: &str| {
        format!(
            "agent A {{ link next: A  state x = 0  flow {{ x' = {rate} }} }}
             system {{ a = A() }}
             run {{ until 1 }}"
        )
    };
    assert!(refused(&flow("(if time < 1 then self else next).x")).contains("HY0245"));
    assert!(refused(&flow("(if time < 1 then self else none).x")).contains("HY0245"));
    simulate_to_the_end(&flow("(if next then next else self).x"));
}

#[test]
fn rule_01_a_chosen_agent_is_no_value_that_is_kept() {
    let told = refused(
        "agent A { link next: A  let who = if time < 1 then self else next  state x = 0  flow { x' = 1 } }",
    );
    assert!(told.contains("HY0225"), "{told}");
}
