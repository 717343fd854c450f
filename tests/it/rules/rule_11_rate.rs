//! Rule 11: `rate`, a hazard integrated with the flow against a number drawn from the exponential distribution.

use hyc::math::draw::{Distribution, Key};

use crate::harness::{Case, all_near, near, refused, simulate, simulate_by_both_forms, simulate_error};

/// The numbers that an agent draws for a transition, with seed 0.
fn drawn(agent: &str, label: &str, n: u64) -> Vec<f64> {
    let key = |draw| Key { seed: 0, agent, variable: label, draw };
    (1..=n).map(|draw| Distribution::Exponential.draw(&[1.0], key(draw))).collect()
}

/// Their sums so far.
fn sums(agent: &str, label: &str, n: u64) -> Vec<f64> {
    let add = |sum: &mut f64, x: f64| {
        *sum += x;
        Some(*sum)
    };
    drawn(agent, label, n).into_iter().scan(0.0, add).collect()
}

fn before(times: Vec<f64>, end: f64) -> Vec<f64> {
    times.into_iter().filter(|time| *time <= end).collect()
}

#[test]
fn rule_11_a_constant_rate_fires_at_the_sums_of_what_is_drawn() {
    let run = simulate_by_both_forms(
        "agent A { discrete n: int = 0  go: rate 4 [1/s] { n := n + 1 } }
         system { a = A()  b = A() }  run { until 5 }",
    );
    for agent in ["a", "b"] {
        let expected: Vec<f64> = sums(agent, "A.go", 60).into_iter().map(|sum| sum / 4.0).collect();
        all_near(&run.times_of("A.go", agent), &before(expected, 5.0), 1e-9);
    }
}

#[test]
fn rule_11_the_hazard_is_integrated_with_the_flow() {
    let run = simulate_by_both_forms(
        "agent A { state x = 0  discrete n: int = 0  flow { x' = 1 }  go: rate 2*x { n := n + 1 } }
         system { a = A() }  run { until 5  tolerance 1e-10 }",
    );
    // the integral of 2 t is t^2
    let expected: Vec<f64> = sums("a", "A.go", 60).into_iter().map(f64::sqrt).collect();
    all_near(&run.times("A.go"), &before(expected, 5.0), 1e-7);
}

#[test]
fn rule_11_the_hazard_is_zero_while_the_guard_is_false() {
    // open while the sine is positive: in the first half of each period of 2
    let run = simulate_by_both_forms(
        "agent A { discrete n: int = 0  go: rate 1.5 when sin(pi*time) > 0 { n := n + 1 } }
         system { a = A() }  run { until 40  tolerance 1e-10 }",
    );
    let opened = |open: f64| 2.0 * open.floor() + open.fract();
    let expected: Vec<f64> = sums("a", "A.go", 60).into_iter().map(|sum| opened(sum / 1.5)).collect();
    let expected = before(expected, 40.0);
    assert!(expected.len() > 15);
    all_near(&run.times("A.go"), &expected, 1e-7);
}

#[test]
fn rule_11_the_guard_may_be_over_others_who_are_not_coupled_by_it() {
    let run = simulate_by_both_forms(
        "agent Car(v: real) { state x = 0  flow { x' = v } }
         agent Ramp(lane: int) { discrete n: int = 0
           enter: rate 2 when not exists c in Car: c.x >= 1 and c.x <= 3 { n := n + 1 } }
         system { car = Car(v = 1)  ramp = Ramp(lane = 1) }  run { until 6 }",
    );
    let expected: Vec<f64> = sums("ramp", "Ramp.enter", 60).into_iter().map(|sum| sum / 2.0).collect();
    let expected = expected.into_iter().map(|t| if t >= 1.0 { t + 2.0 } else { t }).collect();
    all_near(&run.times("Ramp.enter"), &before(expected, 6.0), 1e-8);
}

#[test]
fn rule_11_the_guard_may_be_discrete() {
    let run = simulate_by_both_forms(
        "agent A { discrete open: bool = false, n: int = 0
           turn: every 1 { open := not open }  go: rate 3 when open { n := n + 1 } }
         system { a = A() }  run { until 9.5 }",
    );
    let opened = |open: f64| 1.0 + 2.0 * open.floor() + open.fract();
    let expected: Vec<f64> = sums("a", "A.go", 60).into_iter().map(|sum| opened(sum / 3.0)).collect();
    all_near(&run.times("A.go"), &before(expected, 9.5), 1e-9);
}

#[test]
fn rule_11_a_new_number_is_drawn_on_entry() {
    // M is left after 0.1 in any case; the hazard begins anew each time
    let run = simulate_by_both_forms(
        "agent A { discrete n: int = 0
           initial mode M { go: rate 5 -> N  over: after 0.1 -> N }
           mode N { back: after 0.2 -> M } }
         system { a = A() }  run { until 12 }",
    );
    let (mut time, mut go, mut over) = (0.0, Vec::new(), Vec::new());
    for left in drawn("a", "A.go", 60) {
        if left / 5.0 < 0.1 {
            time += left / 5.0;
            go.push(time);
        } else {
            time += 0.1;
            over.push(time);
        }
        time += 0.2;
    }
    assert!(before(go.clone(), 12.0).len() > 8 && before(over.clone(), 12.0).len() > 8);
    all_near(&run.times("A.go"), &before(go, 12.0), 1e-8);
    all_near(&run.times("A.over"), &before(over, 12.0), 1e-8);
}

#[test]
fn rule_11_a_firing_that_enters_its_mode_again_draws_once() {
    let run = simulate_by_both_forms(
        "agent A { state x = 0  flow { x' = 1 }  initial mode M { go: rate 2 -> M { x := 0 } } }
         system { a = A() }  run { until 8 }",
    );
    let expected: Vec<f64> = sums("a", "A.go", 60).into_iter().map(|sum| sum / 2.0).collect();
    all_near(&run.times("A.go"), &before(expected, 8.0), 1e-8);
}

#[test]
fn rule_11_a_rate_that_reads_another_s_state_couples_the_two() {
    let run = simulate_by_both_forms(
        "agent B { state x = 0  flow { x' = 2 }  jump: when x >= 3 { x := 0 } }
         agent A { link b: B  discrete n: int = 0  go: rate b.x when b { n := n + 1 } }
         system { b = B()  a = A(b = b) }  run { until 12  tolerance 1e-10 }",
    );
    // the integral of b.x over a period of 1.5 is 2.25, and t^2 within it
    let when = |sum: f64| 1.5 * (sum / 2.25).floor() + (sum % 2.25).sqrt();
    let expected: Vec<f64> = sums("a", "A.go", 60).into_iter().map(when).collect();
    all_near(&run.times("A.go"), &before(expected, 12.0), 1e-6);
    let words = refused(
        "agent B { state x = 0  flow { x' = 2 } }
         agent A { link b: B  discrete n: int = 0  go: rate b.x { n := n + 1 } }
         system { b = B()  a = A(b = b) }  run { until 12 }",
    );
    assert!(words.contains("HY0245") && words.contains("`b`"), "{words}");
}

#[test]
fn rule_11_rates_compete() {
    let run = simulate_by_both_forms(
        "agent A { initial mode M { one: rate 1 -> N  two: rate 3 -> N }  mode N { back: after 1 -> M } }
         system { a = A() }  run { until 60 }",
    );
    let (one, two) = (drawn("a", "A.one", 80), drawn("a", "A.two", 80));
    let firsts = one.iter().zip(&two).map(|(one, two)| *one < two / 3.0);
    let log: Vec<bool> = run.events.iter().filter(|e| e.to == "N").map(|e| e.transition == "A.one").collect();
    assert!(log.len() > 40);
    assert_eq!(log, firsts.take(log.len()).collect::<Vec<_>>());
}

#[test]
fn rule_11_whom_the_guard_binds_is_known_to_the_actions() {
    let run = simulate_by_both_forms(
        "agent C(x0: real) { state x = x0  flow { x' = 1 } }
         agent A { discrete seen = 0  go: rate 2 when exists c in C: c.x >= 1 { seen := c.x } }
         system { cs = C[2](x0 = -index)  a = A() }  run { until 4 }",
    );
    let last = *run.times("A.go").last().expect("it fires");
    assert!(run.times("A.go")[0] > 1.0);
    near(run.value("a.seen"), last, 1e-9);
}

#[test]
fn rule_11_draws_are_an_agent_s_own() {
    let text = |others: &str| {
        format!(
            "agent A {{ discrete n: int = 0, k: int = 0  go: rate 4 {{ n := n + 1 }} {others} }}
             system {{ as = A[3]() }}  run {{ until 5  seed 9 }}"
        )
    };
    let [alone, more] = ["", "other_: rate 2 { k := k + 1 }"].map(|others| simulate(&text(others)));
    all_near(&alone.times_of("A.go", "as[2]"), &more.times_of("A.go", "as[2]"), 1e-9);
    let other_seed = Case::new(&text("")).seed(10).run();
    assert_ne!(alone.times("A.go"), other_seed.times("A.go"));
}

#[test]
fn rule_11_a_rate_is_never_negative() {
    let (run, found) = simulate_error(
        "agent A { state x = 1  discrete n: int = 0  flow { x' = -1 }  go: rate 0.001*x { n := n + 1 } }
         system { a = A() }  run { until 3 }",
    );
    assert_eq!(found.code, "HY0514");
    near(run.time, 1.0, 1e-9);
    // where it does not count it may be anything
    simulate("agent A { state x = 1  discrete n: int = 0  flow { x' = -1 }  go: rate 0.001*x when x > 0 { n := n + 1 } }
              system { a = A() }  run { until 3 }");
    let words = refused("agent A { discrete n: int = 0  go: rate 2 - 3 { n := n + 1 } }");
    assert!(words.contains("HY0219"), "{words}");
    let words = refused("agent A { discrete n: int = 0  go: rate 2 [s] { n := n + 1 } }");
    assert!(words.contains("HY0231"), "{words}");
}

#[test]
fn rule_11_nothing_of_a_hazard_shows() {
    let run = simulate(
        "agent A { state x = 0  discrete n: int = 0  flow { x' = 1 }  go: rate 3 { n := n + 1 } }
         system { a = A() }  run { until 3  record a every 1 to \"a.csv\" }",
    );
    assert_eq!(run.samples[0][0].cells.len(), 2);
    let names: Vec<&str> = run.agent("a").values.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["x", "n"]);
}

#[test]
fn rule_11_rates_of_many_who_run_ahead() {
    // thousands of events of agents that oscillate alone: the fast form has them cold between their firings
    let run = simulate_by_both_forms(
        "agent A(w: real) { state x = 1, v = 0  discrete n: int = 0
           flow { x' = v  v' = -w^2*x }
           kick: rate 0.3 + 0.2*x^2 { n := n + 1  v := 0.5*v + 0.1 }
           far: when x >= 1.2 { v := -0.2 } }
         system { as = A[80](w = 1 + 0.01*index) }  run { until 20  tolerance 1e-11 }",
    );
    assert!(run.times("A.kick").len() > 500);
}

#[test]
fn rule_11_a_hazard_that_fires_twice_within_the_resolution_of_time_fires_on() {
    let run = simulate(
        "agent A { discrete n: int = 0  h: rate 1e9 { n := n + 1 } }
         system { a = A() }  run { until 1e-5  seed 3 }",
    );
    let n = run.value("a.n");
    // Poisson of mean 10 000: six times its deviation.
    assert!((n - 10_000.0).abs() < 600.0, "{n}");
}
