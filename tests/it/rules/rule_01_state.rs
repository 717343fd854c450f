//! Rule 1: states, discretes, lets, links; one flow for every state; where an instance starts.

use crate::harness::{all_near, near, refused, simulate};

#[test]
fn rule_01_a_let_follows_the_state() {
    let run = simulate(
        "agent A {
           state x = 0   discrete n = 0
           let double = 2*x   let more = double + 1
           flow { x' = 1 }
           when double >= 3 { n := more }
         }
         system { a = A() }
         run { until 2  record a.more every 0.5 to \"a.csv\" }",
    );
    all_near(&run.events.iter().map(|event| event.time).collect::<Vec<_>>(), &[1.5], 1e-11);
    near(run.value("a.n"), 4.0, 1e-10);
    let values: Vec<f64> = run.column("a", 0).iter().map(|sample| sample.1).collect();
    all_near(&values, &[1.0, 2.0, 3.0, 4.0, 5.0], 1e-11);
}

#[test]
fn rule_01_a_circle_of_lets_is_named() {
    let words = refused(
        "agent A { state x = 0  let first = second + 1  let second = 2*third  let third = first
                   flow { x' = first } }
         system { a = A() }  run { until 1 }",
    );
    assert!(["first", "second", "third"].iter().all(|name| words.contains(name)), "{words}");
}

#[test]
fn rule_01_links_refer_forward_and_in_circles() {
    // a.x' = b.x, b.x' = -a.x: a turns, a.x = sin t, b.x = cos t
    let run = simulate(
        "agent A(s: real) { link next: A  state x  flow { x' = if next then s*next.x else 0 } }
         system { a = A(s = 1, x = 0, next = b)  b = A(s = -1, x = 1, next = a) }
         run { until 2  tolerance 1e-10 }",
    );
    near(run.value("a.x"), 2f64.sin(), 1e-9);
    near(run.value("b.x"), 2f64.cos(), 1e-9);
}

#[test]
fn rule_01_a_parameter_of_agent_type_is_a_link_that_is_never_none() {
    let run = simulate(
        "agent A(s: real, next: A) { state x  flow { x' = s*next.x } }
         system { a = A(s = 1, x = 0, next = b)  b = A(s = -1, x = 1, next = a) }
         run { until 2  tolerance 1e-10 }",
    );
    near(run.value("a.x"), 2f64.sin(), 1e-9);
    near(run.value("b.x"), 2f64.cos(), 1e-9);
    refused(
        "agent A(next: A) { state x = 0  flow { x' = next.x } }
         system { a = A() }  run { until 1 }",
    );
}

#[test]
fn rule_01_a_link_that_nothing_sets_stays_none() {
    let run = simulate(
        "agent A { link friend: A  state x = 0  discrete alone = 0
                   flow { x' = if friend then 1 else 2 }
                   lonely: when not friend { alone := 1 } }
         system { a = A()  b = A(friend = a) }
         run { until 1 }",
    );
    assert_eq!(run.log(), ["0 A.lonely a"]);
    near(run.value("a.x"), 2.0, 1e-12);
    near(run.value("b.x"), 1.0, 1e-12);
}

#[test]
fn rule_01_links_of_an_array_by_index() {
    let run = simulate(
        "agent A { link lead: A  state x = 0  flow { x' = if lead then 1 + lead.x else 1 } }
         system { cars = A[3](lead = if index >= 1 then cars[index - 1] else none) }
         run { until 1  tolerance 1e-10 }",
    );
    // x0 = t, x1 = t + t^2/2, x2 = t + t^2/2 + t^3/6
    near(run.value("cars[0].x"), 1.0, 1e-11);
    near(run.value("cars[1].x"), 1.5, 1e-11);
    near(run.value("cars[2].x"), 1.5 + 1.0 / 6.0, 1e-11);
    refused(
        "agent A { link lead: A  state x = 0  flow { x' = 1 } }
         system { cars = A[3](lead = cars[index + 1]) }
         run { until 1 }",
    );
}

#[test]
fn rule_01_no_flow_and_two_flows_are_errors() {
    let none =
        refused("agent A { state x = 0, y = 0  flow { x' = 1 } }  system { a = A() }  run { until 1 }");
    assert!(none.contains('y'), "{none}");
    let in_one_mode = refused(
        "agent A { state x = 0
           initial mode Slow { flow { x' = 1 } when x >= 1 -> Lost }
           mode Lost { } }
         system { a = A() }  run { until 1 }",
    );
    assert!(in_one_mode.contains("Lost"), "{in_one_mode}");
    let two = refused(
        "agent A { state x = 0  flow { x' = 1 }
           initial mode Slow { flow { x' = 2 } } }
         system { a = A() }  run { until 1 }",
    );
    assert!(two.contains('x'), "{two}");
    refused("agent A { state x = 0  flow { x' = 1  x' = 2 } }  system { a = A() }  run { until 1 }");
}

#[test]
fn rule_01_in_starts_an_instance_in_a_mode() {
    let run = simulate(
        "agent A { state x = 0
           initial mode Slow { flow { x' = 1 } }
           mode Fast { flow { x' = 3 } } }
         system { a = A()  b = A() in Fast  c = A[2] in Fast }
         run { until 1 }",
    );
    near(run.value("a.x"), 1.0, 1e-12);
    near(run.value("b.x"), 3.0, 1e-12);
    near(run.value("c[1].x"), 3.0, 1e-12);
    assert_eq!([run.mode("a"), run.mode("b"), run.mode("c[0]")], ["Slow", "Fast", "Fast"]);
}

#[test]
fn rule_01_initial_values_in_the_order_of_their_dependences() {
    let run = simulate(
        "agent A(k: real) { state x = y + 1, y = 2*z  discrete z = k + index
                            flow { x' = 0  y' = 0 } }
         system { a = A[2](k = 10) }
         run { until 1 }",
    );
    assert_eq!([run.value("a[0].x"), run.value("a[0].y"), run.value("a[0].z")], [21.0, 20.0, 10.0]);
    assert_eq!([run.value("a[1].x"), run.value("a[1].y"), run.value("a[1].z")], [23.0, 22.0, 11.0]);
    let circle = refused(
        "agent A { state x = y + 1, y = x - 1  flow { x' = 0  y' = 0 } }  system { a = A() }  run { until 1 }",
    );
    assert!(circle.contains('x') && circle.contains('y'), "{circle}");
}

#[test]
fn rule_01_a_value_given_to_an_instance_goes_before_the_declared_one() {
    let run = simulate(
        "agent A(k: real = 1) { state x = 2*k  discrete n: int = 7  flow { x' = 0 } }
         system { a = A()  b = A(k = 3)  c = A(x = 5, n = 8) }
         run { until 1 }",
    );
    assert_eq!([run.value("a.x"), run.value("b.x"), run.value("c.x")], [2.0, 6.0, 5.0]);
    assert_eq!([run.value("a.n"), run.value("b.n"), run.value("c.n")], [7.0, 7.0, 8.0]);
}

#[test]
fn rule_01_discretes_are_constant_between_events() {
    let run = simulate(
        "agent A { state x = 0  discrete v = 1, up: bool = true, n: int = 0
                   flow { x' = v }
                   turn: every 1 { v := -v  up := not up  n := n + 1 } }
         system { a = A() }
         run { until 2.5  record a.v, a.up, a.n every 0.5 to \"a.csv\" }",
    );
    near(run.value("a.x"), 0.5, 1e-12);
    let column = |k: usize| run.column("a", k).iter().map(|sample| sample.1).collect::<Vec<_>>();
    assert_eq!(column(0), [1.0, 1.0, -1.0, -1.0, 1.0, 1.0]);
    assert_eq!(column(1), [1.0, 1.0, 0.0, 0.0, 1.0, 1.0]);
    assert_eq!(column(2), [0.0, 0.0, 1.0, 1.0, 2.0, 2.0]);
}
