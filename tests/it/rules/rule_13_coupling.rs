//! Rule 13: flows that read other agents' states.

use crate::harness::{near, refused, simulate, simulate_by_both_forms};

#[test]
fn rule_13_a_follower_reads_its_leader() {
    // lead.x = t, x' = lead.x - x: x = t - 1 + exp(-t)
    let run = simulate(
        "agent Lead { state x = 0  flow { x' = 1 } }
         agent Car { link lead: Lead  state x = 0  flow { x' = if lead then lead.x - x else 0 } }
         system { c = Car(lead = l)  l = Lead() }  run { until 3  tolerance 1e-10 }",
    );
    near(run.value("c.x"), 2.0 + (-3f64).exp(), 1e-9);
}

#[test]
fn rule_13_a_jump_of_the_leader_reaches_its_follower() {
    // lead.x jumps from 0 to 1 at 1: x = 1 - exp(1 - t)
    let run = simulate(
        "agent Lead { state x = 0  flow { x' = 0 }  jump: after 1 { x := 1 } }
         agent Car { link lead: Lead  state x = 0  flow { x' = if lead then lead.x - x else 0 } }
         system { c = Car(lead = l)  l = Lead() }  run { until 3  tolerance 1e-10 }",
    );
    near(run.value("c.x"), 1.0 - (-2f64).exp(), 1e-9);
}

#[test]
fn rule_13_a_chain_in_either_order_of_numbers() {
    // x0 = 1; x_k' = x_(k-1) - x_k from 0: x1 = 1 - e^-t, x2 = 1 - (1 + t) e^-t, x3 = 1 - (1 + t + t^2/2) e^-t
    let car = "agent Car { link lead: Car  state x = 0  flow { x' = if lead then lead.x - x else 0 } }";
    let forward = simulate(&format!(
        "{car} system {{ c = Car[4](x = if index == 0 then 1 else 0, lead = if index >= 1 then c[index - 1] else none) }}
         run {{ until 2  tolerance 1e-10 }}"
    ));
    let backward = simulate(&format!(
        "{car} system {{ c = Car[4](x = if index == 3 then 1 else 0, lead = if index <= 2 then c[index + 1] else none) }}
         run {{ until 2  tolerance 1e-10 }}"
    ));
    let e = (-2f64).exp();
    for (k, expected) in [1.0, 1.0 - e, 1.0 - 3.0 * e, 1.0 - 5.0 * e].into_iter().enumerate() {
        near(forward.value(&format!("c[{k}].x")), expected, 1e-9);
        near(backward.value(&format!("c[{}].x", 3 - k)), expected, 1e-9);
    }
}

#[test]
fn rule_13_a_circle_of_three() {
    // x_k' = x_(k+1) - x_k: the mean stays, compared with one agent that holds all three
    let three = simulate(
        "agent A { link next: A  state x  flow { x' = if next then next.x - x else 0 } }
         system { a = A(x = 1, next = b)  b = A(x = 2, next = c)  c = A(x = 6, next = a) }
         run { until 1.5  tolerance 1e-11 }",
    );
    let one = simulate(
        "agent A { state a = 1, b = 2, c = 6  flow { a' = b - a  b' = c - b  c' = a - c } }
         system { one = A() }  run { until 1.5  tolerance 1e-11 }",
    );
    for name in ["a", "b", "c"] {
        near(three.value(&format!("{name}.x")), one.value(&format!("one.{name}")), 1e-9);
    }
    near(three.value("a.x") + three.value("b.x") + three.value("c.x"), 9.0, 1e-9);
}

#[test]
fn rule_13_coupled_only_while_the_mode_is_active() {
    // coupled on [0, 1] and [2, 3]: y = y0 + ... with the leader's x = cos t, read only while coupled
    let run = simulate(
        "agent Lead { state x = 1, v = 0  flow { x' = v  v' = -x } }
         agent Car { link lead: Lead  state y = 0
           initial mode Bound { flow { y' = if lead then lead.x else 0 }  off: after 1 -> Free }
           mode Free { flow { y' = 0.5 }  tie: after 1 -> Bound } }
         system { c = Car(lead = l)  l = Lead() }  run { until 3  tolerance 1e-10 }",
    );
    assert_eq!(run.times("Car.off"), [1.0, 3.0]);
    let expected = 1f64.sin() + 0.5 + (3f64.sin() - 2f64.sin());
    near(run.value("c.y"), expected, 1e-9);
}

#[test]
fn rule_13_groups_at_mode_switches_agree_with_one_agent() {
    // two followers, each coupled above a threshold of its own lag; the same as one agent with all states
    let many = simulate(
        "agent Lead { state x = 0, v = 1  flow { x' = v  v' = -x } }
         agent Car(k: real) { link lead: Lead  state y = 0
           let lag = if lead then lead.x - y else 0
           initial mode Rest { flow { y' = 0 }  go: when lag >= 0.5 or lag <= -0.5 -> Chase }
           mode Chase { flow { y' = k*lag }  end: when lag <= 0.1 and lag >= -0.1 -> Rest } }
         system { l = Lead()  c = Car[2](lead = l, k = 1 + index) }  run { until 12  tolerance 1e-11 }",
    );
    let one = |k: f64| {
        simulate(&format!(
            "agent All {{ state x = 0, v = 1, y = 0
               let lag = x - y
               flow {{ x' = v  v' = -x }}
               initial mode Rest {{ flow {{ y' = 0 }}  go: when lag >= 0.5 or lag <= -0.5 -> Chase }}
               mode Chase {{ flow {{ y' = {k}*lag }}  end: when lag <= 0.1 and lag >= -0.1 -> Rest }} }}
             system {{ all = All() }}  run {{ until 12  tolerance 1e-11 }}"
        ))
    };
    for (k, agent) in [(1.0, "c[0]"), (2.0, "c[1]")] {
        let single = one(k);
        assert!(single.events.len() >= 6, "{:?}", single.log());
        for label in ["go", "end"] {
            let (ours, theirs) =
                (many.times_of(&format!("Car.{label}"), agent), single.times(&format!("All.{label}")));
            crate::harness::all_near(&ours, &theirs, 1e-8);
        }
        near(many.value(&format!("{agent}.y")), single.value("all.y"), 1e-8);
    }
}

#[test]
fn rule_13_two_that_read_each_other() {
    // springs: x1'' = x2 - x1, x2'' = x1 - x2, from 1 and -1 at rest: x1 = cos(sqrt(2) t)
    let run = simulate(
        "agent Mass { link other_end: Mass  state x, v = 0
                      flow { x' = v  v' = if other_end then other_end.x - x else 0 } }
         system { a = Mass(x = 1, other_end = b)  b = Mass(x = -1, other_end = a) }
         run { until 5  tolerance 1e-10 }",
    );
    near(run.value("a.x"), (2f64.sqrt() * 5.0).cos(), 1e-8);
    near(run.value("b.x"), -(2f64.sqrt() * 5.0).cos(), 1e-8);
}

#[test]
fn rule_13_a_stop_of_a_coupled_leader() {
    // the leader stops at its root x = 1; the follower then relaxes to it
    let run = simulate(
        "agent Lead { state x = 0
           initial mode Go { flow { x' = 1 }  end: when x >= 1 -> Halt }
           mode Halt { flow { x' = 0 } } }
         agent Car { link lead: Lead  state y = 0  flow { y' = if lead then lead.x - y else 0 } }
         system { l = Lead()  c = Car(lead = l) }  run { until 3  tolerance 1e-10 }",
    );
    // y(1) = exp(-1); afterwards 1 - (1 - y(1)) exp(-(t - 1))
    let expected = 1.0 - (1.0 - (-1f64).exp()) * (-2f64).exp();
    near(run.value("c.y"), expected, 1e-9);
}

#[test]
fn rule_13_a_flow_reads_the_rate_of_another() {
    // lead.v' = -lead.v, then 2: the follower moves by its own distance and the rate of the leader
    let run = simulate_by_both_forms(
        "agent Lead {
           state v = 1
           let pull = -v
           initial mode Coast { flow { v' = pull }  after 1 -> Drive }
           mode Drive { flow { v' = 2 } } }
         agent Car(lead: Lead) { state y = 0, z = 0  flow { y' = 3*lead.v'  z' = y' + lead.v' } }
         agent Loose { link lead: Lead  state y = 0  flow { y' = if lead then lead.v' else 1 } }
         system { lead = Lead()  car = Car(lead = lead)  a = Loose(lead = lead)  b = Loose() }
         run { until 3  tolerance 1e-10 }",
    );
    let gain = (-1f64).exp() - 1.0 + 4.0;
    near(run.value("car.y"), 3.0 * gain, 1e-8);
    near(run.value("car.z"), 4.0 * gain, 1e-8);
    near(run.value("a.y"), gain, 1e-8);
    near(run.value("b.y"), 3.0, 1e-8);
}

#[test]
fn rule_13_rates_through_a_chain_and_over_a_set() {
    // c' = b' + 1 = a' + 2 = t + 2; all = sum of the rates of the three
    let run = simulate_by_both_forms(
        "agent A { state x = 0  flow { x' = time } }
         agent B(up: A) { state x = 0  flow { x' = up.x' + 1 } }
         agent C(up: B) { state x = 0  flow { x' = up.x' + 1 } }
         agent All { state x = 0  flow { x' = (sum o in A: o.x') + (sum o in B: o.x') + (sum o in C: o.x') } }
         system { a = A()  b = B(up = a)  c = C(up = b)  all = All() }
         run { until 2  tolerance 1e-10 }",
    );
    near(run.value("c.x"), 2.0 + 4.0, 1e-9);
    near(run.value("all.x"), 3.0 * 2.0 + 6.0, 1e-9);
}

#[test]
fn rule_13_rates_without_an_end_are_refused() {
    let told = refused(
        "agent Car { link lead: Car  state v = 0  flow { v' = if lead then lead.v' + lead.v - v else 1 } }
         system { a = Car()  b = Car(lead = a) }  run { until 1 }",
    );
    assert!(told.contains("HY0207") && told.contains("in a circle"), "{told}");
}

/// `other` in a `let` is other than whose `let` it is, whoever reads it.
#[test]
fn rule_13_a_let_of_another_ranges_over_its_others() {
    let run = simulate_by_both_forms(
        "agent Lead { state x = 0  let others = sum o in other Lead: o.x  flow { x' = 1 } }
         agent Car(lead: Lead) { state y = 0  flow { y' = lead.others } }
         system { leads = Lead[3](x = index)  car = Car(lead = leads[1]) }
         run { until 1  tolerance 1e-10 }",
    );
    near(run.value("car.y"), 2.0 + 2.0 * 0.5, 1e-9);
}
