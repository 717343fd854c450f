//! Chains of followers (rule 13): one whose leader does not read it integrates from the leader's dense output, on its own
//! clock. What comes out is what one system of equations would say, and the cost of a car does not grow with the chain.

use hyc::model::ir::Integrator;

use crate::harness::{Case, Run, all_near, both_forms, near};

/// Cars 0 to n - 1, each of which approaches the one before it: x_k' = x_(k-1) - x_k.
fn filters(n: usize, rest: &str, until: f64) -> String {
    format!(
        "agent Low(k: int) {{ state x = if k == 0 then 1 else 0  discrete up = 0
           link lead: Low
           let input = if lead then lead.x else up
           flow {{ x' = if k == 0 then 0 else input - x }}
           {rest} }}
         system {{ a = Low[{n}](k = index, lead = if index > 0 then a[index - 1] else none) }}
         run {{ until {until}  tolerance 1e-10  record a every 0.5 to \"a.csv\" }}"
    )
}

/// By both forms, which must tell the same.
fn run(text: &str) -> Run {
    let [fast, plain] = both_forms(text);
    all_near(&fast.event_times(), &plain.event_times(), 1e-9);
    plain
}

/// x_k at t, if x_0 is 1 from the beginning: the probability of k or more events of a Poisson process.
fn poisson(k: usize, t: f64) -> f64 {
    let mut term = (-t).exp();
    let mut below = 0.0;
    for j in 0..k {
        below += term;
        term *= t / (j + 1) as f64;
    }
    1.0 - below
}

/// Where `poisson(k, t)` is `level`.
fn crossing(k: usize, level: f64) -> f64 {
    let (mut low, mut high) = (0.0, 10.0 * (k + 1) as f64);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if poisson(k, middle) < level { low = middle } else { high = middle }
    }
    low
}

/// With kinks that nobody meets: the steps of a follower end where those of its leader do, but for rounding.
#[test]
fn rule_13_followers_whose_flow_has_kinks_step_beside_their_leaders() {
    let n = 8;
    for kinked in ["min(input - x, 100)", "input - x + 0*max(time, -1)", "clamp(input - x, -8, 3)"] {
        let text = filters(n, "half: when x >= 0.5 { up := 1 }", 20.0)
            .replace("else input - x", &format!("else {kinked}"));
        let expected: Vec<f64> = (1..n).map(|k| crossing(k, 0.5)).collect();
        for integrator in [Integrator::Auto, Integrator::Tsit5, Integrator::Adams, Integrator::Stiff] {
            for tolerance in [1e-4, 1e-6, 1e-9] {
                let run = Case::new(&text).integrator(integrator).tolerance(tolerance).run();
                let times: Vec<f64> = run.times("Low.half").split_off(1);
                all_near(&times, &expected, 100.0 * tolerance);
            }
        }
    }
    // all from rest at the same time, behind links that the runtime finds
    for start in ["-index", "-0.001*index", "-30*index"] {
        let run = run(&format!(
            "agent Car {{ link lead = nearest o in other Car where o.x > x by o.x - x
               state x = {start}, v = 0
               flow {{ x' = v  v' = if lead then clamp(0.3*(lead.x - x - 10 - v), -8, 3) else 1 }} }}
             system {{ c = Car[5]() }}  run {{ until 10 }}"
        ));
        near(run.value("c[0].x"), 50.0, 1e-5);
    }
}

#[test]
fn rule_13_a_chain_of_followers_is_the_solution_of_all_equations() {
    let n = 25;
    let run = run(&filters(n, "half: when x >= 0.5 { up := 1 }", 40.0));
    for sample in &run.samples[0] {
        let k: usize = sample.agent[2..sample.agent.len() - 1].parse().unwrap();
        let expected = if k == 0 { 1.0 } else { poisson(k, sample.time) };
        near(sample.cells[0], expected, 1e-7);
    }
    for k in 1..n {
        let times: Vec<f64> = run
            .events
            .iter()
            .filter(|event| event.agent == format!("a[{k}]"))
            .map(|event| event.time)
            .collect();
        assert_eq!(times.len(), 1, "agent {k}");
        near(times[0], crossing(k, 0.5), 1e-7);
    }
}

#[test]
fn rule_13_an_event_of_a_leader_cuts_what_its_followers_have_computed() {
    // The head jumps by 1 at 3.3 and 7.7: the answer of a linear chain is the sum of shifted answers.
    let kick = "kick: when (time >= 3.3 and up == 0 or time >= 7.7 and up == 1) and k == 0 { x := x + 1  up := up + 1 }";
    let run = run(&filters(12, kick, 20.0));
    assert!(run.events.len() >= 2, "{:?}", run.events);
    for sample in &run.samples[0] {
        let k: usize = sample.agent[2..sample.agent.len() - 1].parse().unwrap();
        let shifted = |start: f64| {
            let since = sample.time - start;
            if since < 0.0 {
                0.0
            } else if k == 0 {
                1.0
            } else {
                poisson(k, since)
            }
        };
        near(sample.cells[0], shifted(0.0) + shifted(3.3) + shifted(7.7), 1e-7);
    }
}

#[test]
fn rule_13_a_follower_does_not_step_over_a_kink_of_its_leader_nor_of_its_own() {
    // The head is |t - 2|, known only by its state; the second follows where that is above 1, the third the second.
    let run = run("agent Head { state x = 2  flow { x' = if time < 2 then -1 else 1 } }
         agent Mid(lead: Head) { state y = 0  flow { y' = max(lead.x - 1, 0) } }
         agent Tail(lead: Mid) { state z = 0  flow { z' = lead.y }  over: when z >= 1 { } }
         system { h = Head()  m = Mid(lead = h)  t = Tail(lead = m) }
         run { until 6  tolerance 1e-9  record m, t every 0.25 to \"a.csv\" }");
    // y is t - t^2/2 up to 1, 1/2 up to 3, 1/2 + (t - 3)^2/2 from there on.
    let y = |t: f64| match t {
        t if t < 1.0 => t - t * t / 2.0,
        t if t < 3.0 => 0.5,
        t => 0.5 + (t - 3.0).powi(2) / 2.0,
    };
    let z = |t: f64| match t {
        t if t < 1.0 => t * t / 2.0 - t.powi(3) / 6.0,
        t if t < 3.0 => 1.0 / 3.0 + (t - 1.0) / 2.0,
        t => 4.0 / 3.0 + (t - 3.0) / 2.0 + (t - 3.0).powi(3) / 6.0,
    };
    assert!(run.samples[0].len() > 40);
    for sample in &run.samples[0] {
        let [value, expected] = if sample.agent == "m" {
            [sample.cells[0], y(sample.time)]
        } else {
            [sample.cells[1], z(sample.time)]
        };
        near(value, expected, 1e-8);
    }
    near(run.events[0].time, 1.0 + 4.0 / 3.0, 1e-8);
}

#[test]
fn rule_13_who_follows_in_a_circle_steps_together_only_as_long_as_it_does() {
    // Two that approach each other while they are close in time, then the first goes its own way; a third follows always.
    let run = run("agent Car(i: int, lead: Car) { state x = i
           initial mode Both { flow { x' = lead.x - x }  after 1 -> Alone }
           mode Alone { flow { x' = if i == 0 then 1 else lead.x - x } } }
         agent Tail(lead: Car) { state z = 0  flow { z' = lead.x - z } }
         system { a = Car(i = 0, lead = b)  b = Car(i = 1, lead = a)  t = Tail(lead = b) }
         run { until 3  tolerance 1e-10  record a, b every 0.25 to \"a.csv\" }");
    let gap = (-2.0_f64).exp();
    let half = 0.5;
    for sample in &run.samples[0] {
        let t = sample.time;
        let [a, b] = if t <= 1.0 {
            let gap = (-2.0 * t).exp();
            [half - gap / 2.0, half + gap / 2.0]
        } else {
            let s = t - 1.0;
            let (a0, b0) = (half - gap / 2.0, half + gap / 2.0);
            // b' = a0 + s - b
            [a0 + s, a0 + s - 1.0 + (b0 - a0 + 1.0) * (-s).exp()]
        };
        near(sample.cells[0], if sample.agent == "a" { a } else { b }, 1e-8);
    }
}

#[test]
fn rule_13_a_long_chain_costs_a_car_no_more_than_twice_what_a_short_one_does() {
    let platoon = |n: usize| {
        format!(
            "agent Car(k: int) {{ state x = -10*k, v = 20
               link lead: Car
               let gap = if lead then lead.x - x else 10
               let dv = if lead then lead.v - v else 0
               flow {{ x' = v
                      v' = if k == 0 then 0.5*sin(0.3*time) else 0.5*(gap - 10) + 0.8*dv }}
               event_of_one: every 1 when k == 0 {{ v := v + 0.1*sin(17*time) }} }}
             system {{ a = Car[{n}](k = index, lead = if index > 0 then a[index - 1] else none) }}
             run {{ until 5 }}"
        )
    };
    let cost = |n: usize| run(&platoon(n)).stats.rhs_evaluations as f64 / n as f64;
    let (short, long) = (cost(10), cost(600));
    assert!(long < 2.0 * short, "{long} right-hand sides a car, {short} in a short chain");
}
