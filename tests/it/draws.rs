//! Does a random initial value belong to seed, agent and variable, and to nothing else?

use hyc::math::draw::{Distribution, Key};

use crate::harness::{Case, all_near, near, refused, simulate, simulate_error};

/// Cars whose values are all drawn.
const CARS: &str = "
agent Car(v: real) {
  state x ~ Uniform(-2, 3), y = x + 1
  discrete k ~ Exponential(0.25)
  flow { x' = 0  y' = 0 }
}";

/// The initial value of a variable of some agents.
#[track_caller]
fn drawn(text: &str, agents: &[&str], variable: &str) -> Vec<f64> {
    let run = simulate(text);
    agents.iter().map(|agent| run.value(&format!("{agent}.{variable}"))).collect()
}

const THREE: [&str; 3] = ["cars[0]", "cars[1]", "cars[2]"];

/// The numbers of another implementation, written in Python after the key schedule of docs/LANGUAGE.md.
#[test]
fn first_draws_are_pinned_to_the_bit() {
    let cars = format!("{CARS}\nsystem {{ cars = Car[3](v = 0) }}\nrun {{ until 1 }}");
    let bell = "agent A(v: real) { state w = v  flow { w' = 0 } }
        system { cars = A[3](v ~ Normal(30, 3)) }
        run { until 1 }";
    let pinned = [
        (cars.as_str(), 0, "x", [2.396694458426656, 1.2925551009115865, 0.32797341151113657]),
        (&cars, 0, "k", [4.32139780103893, 0.2955503721907234, 5.861495473408306]),
        (&cars, 1, "x", [1.8839921538979112, -1.794425419810033, 0.21485948336281946]),
        (&cars, 1, "k", [0.26579512373827635, 8.101499022416036, 5.242553138965224]),
        (bell, 0, "w", [29.30119202270012, 28.78014913350823, 25.98926859716729]),
        (bell, 1, "w", [28.699611199885446, 22.476378280381695, 28.822363450979363]),
    ];
    for (text, seed, variable, values) in pinned {
        let run = Case::new(text).seed(seed).run();
        let found = THREE.map(|agent| run.value(&format!("{agent}.{variable}")));
        assert_eq!(found.map(f64::to_bits), values.map(f64::to_bits), "seed {seed}, {variable}: {found:?}");
    }
}

#[test]
fn an_agent_more_changes_nobody_else() {
    let alone = format!("{CARS}\nsystem {{ cars = Car[3](v = 0) }}\nrun {{ until 1  seed 7 }}");
    let more = format!(
        "{CARS}\nagent Bus {{ state x ~ Normal(0, 1)  flow {{ x' = 0 }} }}
         system {{ first = Bus()  vans = Car[4](v = 2)  cars = Car[9](v = 0)  last = Car(v = 1) }}
         run {{ until 1  seed 7 }}"
    );
    for variable in ["x", "k"] {
        assert_eq!(drawn(&alone, &THREE, variable), drawn(&more, &THREE, variable), "{variable}");
    }
}

#[test]
fn a_variable_more_and_another_order_change_nobody_else() {
    let before = format!("{CARS}\nsystem {{ cars = Car[3](v = 0) }}\nrun {{ until 1  seed 7 }}");
    let after = "
        agent Car(u: real, v: real) {
          discrete a ~ Normal(0, 1), k ~ Exponential(0.25), b ~ Uniform(0, 1)
          state z ~ Exponential(1), y = x + 1, x ~ Uniform(-2, 3)
          flow { x' = 0  y' = 0  z' = 0 }
        }
        system { cars = Car[3](u ~ Normal(0, 1), v = 0) }
        run { until 1  seed 7 }";
    for variable in ["x", "y", "k"] {
        assert_eq!(drawn(&before, &THREE, variable), drawn(after, &THREE, variable), "{variable}");
    }
}

#[test]
fn agents_variables_and_seeds_have_draws_of_their_own() {
    let text = "agent A { state x ~ Uniform(0, 1), y ~ Uniform(0, 1)  flow { x' = 0  y' = 0 } }
        system { a = A[2]()  b = A() }
        run { until 1  seed 3 }";
    let run = [Case::new(text).run(), Case::new(text).seed(4).run()];
    let mut values = Vec::new();
    for run in &run {
        for agent in ["a[0]", "a[1]", "b"] {
            values.extend(["x", "y"].map(|variable| run.value(&format!("{agent}.{variable}")).to_bits()));
        }
    }
    values.sort_unstable();
    values.dedup();
    assert_eq!(values.len(), 12, "no two are the same");
}

#[test]
fn seed_is_set_by_run_and_by_the_command_line() {
    let text = |seed: &str| format!("{CARS}\nsystem {{ cars = Car[3](v = 0) }}\nrun {{ until 1 {seed} }}");
    let of = |case: Case| case.run().bits();
    assert_eq!(of(Case::new(&text("seed 5"))), of(Case::new(&text("")).seed(5)));
    assert_eq!(of(Case::new(&text("seed 5")).seed(6)), of(Case::new(&text("seed 6"))));
    assert_ne!(of(Case::new(&text("seed 5"))), of(Case::new(&text("seed 6"))));
    assert_eq!(of(Case::new(&text(""))), of(Case::new(&text("seed 0"))));
}

#[test]
fn a_distribution_reads_parameters_index_and_initial_values() {
    // Distributions without width: their value is their parameter.
    let text = "param far = 100
        fn twice(x: real) = 2*x
        agent A(p: real) {
          state x ~ Uniform(y, y), y ~ Normal(twice(p) + index + far, 0)
          discrete n: int = floor(x)
          flow { x' = 0  y' = 0 }
        }
        system { a = A[3](p ~ Normal(10*index, 0)) }
        run { until 1 }";
    let agents = ["a[0]", "a[1]", "a[2]"];
    for variable in ["x", "y", "n"] {
        assert_eq!(drawn(text, &agents, variable), [100.0, 121.0, 142.0], "{variable}");
    }
}

#[test]
fn an_argument_replaces_a_draw_and_a_draw_replaces_a_default() {
    let text = "agent A(p: real = 1) { state x ~ Uniform(0, 1)  discrete q = p  flow { x' = 0 } }
        system { a = A(x = 7)  b = A(x ~ Uniform(5, 5), p ~ Normal(3, 0)) }
        run { until 1 }";
    let run = simulate(text);
    assert_eq!(["a.x", "a.q", "b.x", "b.q"].map(|path| run.value(path)), [7.0, 1.0, 5.0, 3.0]);
}

#[test]
fn bare_parameters_are_in_the_declared_unit() {
    let kmh = "agent A { state v: real [km/h] ~ Normal(120, 3), w: real [km/h] ~ Exponential(0.1)
               flow { v' = 0  w' = 0 } }";
    let si =
        "agent A { state v: real ~ Normal(120, 3), w: real ~ Exponential(0.1)  flow { v' = 0  w' = 0 } }";
    let [kmh, si] = [kmh, si].map(|agent| {
        let run = simulate(&format!("{agent}\nsystem {{ a = A() }}\nrun {{ until 1 }}"));
        ["a.v", "a.w"].map(|path| run.value(path))
    });
    // Columns are in the declared unit.
    all_near(&kmh, &si, 1e-12);
}

#[test]
fn what_is_no_distribution_is_refused() {
    let model =
        |draw: &str| format!("agent A {{ state x ~ {draw}  flow {{ x' = 0 }} }} system {{ a = A() }}");
    for (draw, needle) in [
        ("3", "HY0278"),
        ("Cauchy(0, 1)", "HY0278"),
        ("Uniform(0)", "HY0226"),
        ("Exponential(1, 2)", "HY0226"),
        ("Normal(0, true)", "HY0220"),
        ("Uniform(time, 1)", "HY0264"),
        ("Uniform(1, 0)", "the upper bound of `Uniform` must be no less than the lower bound"),
        ("Normal(0, -1)", "this is -1 where `a.x` is drawn"),
        ("Exponential(0)", "the rate of `Exponential` must be more than 0"),
        ("Uniform(0, inf)", "the upper bound of `Uniform` must be a finite number"),
        ("Normal(x, 1)", "HY0207"),
    ] {
        let text = refused(&model(draw));
        assert!(text.contains(needle), "{draw}: {text}");
    }
    let whole = refused("agent A { discrete k: int ~ Uniform(0, 6) } system { a = A() }");
    assert!(whole.contains("HY0225") && whole.contains("k: int = floor(u)"), "{whole}");
}

/// What one agent draws in actions, in order.
fn in_actions(text: &str, agent: &str) -> Vec<f64> {
    let run = Case::new(text).run();
    run.column(agent, 0).into_iter().map(|(_, value)| value).collect()
}

#[test]
fn draws_in_actions_are_numbers_one_two_three_of_the_variable() {
    // the initial value is draw 0; draw n has the words 2 n and 2 n + 1
    let text = |other: &str| {
        format!(
            "agent A {{ discrete x ~ Exponential(1), y = 0  every 1 {{ x ~ Exponential(1) }} {other} }}
             agent B {{ discrete z = 0  every 0.3 {{ z ~ Normal(0, 1) }} }}
             system {{ as = A[2]()  b = B() }}
             run {{ until 3.5  seed 5  record as.x every 1 to \"x.csv\" }}"
        )
    };
    let alone = in_actions(&text(""), "as[1]");
    assert_eq!(alone.len(), 4);
    let key = |draw| Key { seed: 5, agent: "as[1]", variable: "x", draw };
    let expected: Vec<f64> = (0..4).map(|n| Distribution::Exponential.draw(&[1.0], key(n))).collect();
    assert_eq!(alone, expected);
    // whatever else is drawn, and when
    assert_eq!(in_actions(&text("every 0.7 { y ~ Uniform(0, 1) }"), "as[1]"), alone);
}

#[test]
fn draws_in_actions_read_parameters_and_units() {
    let run = simulate(
        "agent A(sd: real [ms]) { discrete t: real [ms] = 0, u: real [1/s] = 0  state x = 3  flow { x' = 0 }
           when time >= 1 [s] { t ~ Normal(5, sd)  u ~ Exponential(2 [ms])  x ~ Uniform(x, x + 1e-9) } }
         system { a = A(sd = 1e-9) }  run { until 2 }",
    );
    near(run.value("a.t"), 5.0, 1e-7);
    assert!(run.value("a.u") > 0.0);
    near(run.value("a.x"), 3.0, 1e-9);
    let text = refused("agent A { discrete t: real [ms] = 0  when time >= 1 [s] { t ~ Normal(5 [m], 1) } }");
    assert!(text.contains("HY0231"), "{text}");
    let text = refused("agent A { discrete n: int = 0  when time >= 1 [s] { n ~ Uniform(0, 6) } }");
    assert!(text.contains("HY0225"), "{text}");
    let text = refused("agent A { discrete x = 0  when time >= 1 [s] { x ~ Uniform(0) } }");
    assert!(text.contains("HY0226"), "{text}");
}

#[test]
fn parameters_of_draws_in_actions_are_in_range() {
    let (run, found) = simulate_error(
        "agent A { state sd = 1  discrete x = 0  flow { sd' = -1 }  every 0.75 { x ~ Normal(0, sd) } }
         system { a = A() }  run { until 4 }",
    );
    assert_eq!((found.code, run.time), ("HY0513", 1.5));
}

#[test]
fn an_interaction_draws_for_each_of_its_agents() {
    let text = |more: &str| {
        format!(
            "agent A(v: real) {{ state x = 0  discrete k = 0  flow {{ x' = v }} }}
             interaction Meet(a: A, b: A) {{ pair: when abs(a.x - b.x) <= 1 {{ a.k ~ Uniform(0, 1)  b.k ~ Uniform(0, 1) }} }}
             system {{ {more} p = A(v = 1)  q = A(v = 0, x = 5) }}  run {{ until 10  seed 3 }}"
        )
    };
    let [alone, more] = [text(""), text("far = A(v = 0, x = 100)")].map(|text| simulate(&text));
    for (agent, name) in [("p.k", "p"), ("q.k", "q")] {
        let key = Key { seed: 3, agent: name, variable: "k", draw: 1 };
        assert_eq!(alone.value(agent), Distribution::Uniform.draw(&[0.0, 1.0], key));
        assert_eq!(more.value(agent), alone.value(agent));
    }
    // one flag a pair: the actions are the same when the two change places
    assert_eq!(alone.events.len(), 1);
}
