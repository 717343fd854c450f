//! Rule 11: the hazard of a pair, `rate` in an interaction.

use hyc::model::ir::Integrator;

use crate::harness::{Case, Run, all_near, integral, near, refused, simulate_error, simulate_to_the_end};

fn meetings(run: &Run, pair: [&str; 2]) -> Vec<f64> {
    let of_pair = |event: &&crate::harness::Fired| event.agent == pair[0] && event.other == pair[1];
    run.events.iter().filter(of_pair).map(|event| event.time).collect()
}

#[test]
fn rule_11_a_pair_fires_as_often_as_its_rate_says() {
    let count = |actions: &str| {
        let run = simulate_to_the_end(&format!(
            "agent A {{ discrete n: int = 0 }}
             interaction Meet(a: A, b: A) {{ meet: rate 0.5 [1/s] {{ {actions} }} }}
             system {{ all = A[20]() }}
             run {{ until 20  seed 3 }}"
        ));
        run.events.len() as f64
    };
    // 190 unordered and 380 ordered pairs, 10 expected of each
    near(count("a.n := a.n + 1  b.n := b.n + 1"), 1900.0, 4.0 * 1900_f64.sqrt());
    near(count("a.n := a.n + 1"), 3800.0, 4.0 * 3800_f64.sqrt());
}

#[test]
fn rule_11_a_pair_has_draws_of_its_own() {
    let run = |others: usize, rate: &str| {
        simulate_to_the_end(&format!(
            "param k = 1  agent A {{ discrete n: int = 0 }}
             interaction Meet(a: A, b: A) {{ meet: rate {rate} {{ a.n := a.n + 1  b.n := b.n + 1 }} }}
             system {{ few = A[3]()  others = A[{others}]() }}
             run {{ until 20  seed 7 }}"
        ))
    };
    let (alone, among, quicker) = (run(0, "0.5"), run(4, "0.5"), run(0, "1"));
    for pair in [["few[0]", "few[1]"], ["few[0]", "few[2]"], ["few[1]", "few[2]"]] {
        let times = meetings(&alone, pair);
        assert!(times.len() > 2);
        assert_eq!(times, meetings(&among, pair), "whoever else is there");
        // twice the rate, half the times
        let sooner = meetings(&quicker, pair);
        all_near(&sooner[..times.len()].iter().map(|time| 2.0 * time).collect::<Vec<_>>(), &times, 1e-9);
    }
    assert_ne!(meetings(&alone, ["few[0]", "few[1]"]), meetings(&alone, ["few[0]", "few[2]"]));
}

#[test]
fn rule_11_the_hazard_of_a_pair_counts_while_its_guard_is_true() {
    let run = simulate_to_the_end(
        "agent A(w: real) { state x = 0  discrete n: int = 0  flow { x' = w*cos(w*time) } }
         interaction Meet(a: A, b: A) {
           meet: rate 8 [1/s] when abs(a.x - b.x) <= 0.25 { a.n := a.n + 1  b.n := b.n + 1 }
         }
         system { a = A(w = 1)  b = A(w = 2) }
         run { until 60  seed 5 }",
    );
    let gap = |t: f64| (t.sin() - (2.0 * t).sin()).abs();
    let open = (0..600_000).filter(|k| gap(*k as f64 * 1e-4) <= 0.25).count() as f64 * 1e-4;
    assert!(run.events.iter().all(|event| gap(event.time) <= 0.25 + 1e-6));
    near(run.events.len() as f64, 8.0 * open, 4.0 * (8.0 * open).sqrt());
    // the first of each window is as late as any: so many windows have one that there are no gaps of the draw
    assert!(run.events.len() > 60, "{}", run.events.len());
}

#[test]
fn rule_11_an_epidemic_takes_its_expected_time() {
    // from one of ten to all: sum over k of 1/(k (10 - k))
    let text = "agent P { initial mode S { }  mode I { } }
        interaction Touch(a: P, b: P) { catch: rate 1 [1/s] when a is S and b is I { a -> I } }
        system { first = P() in I  others = P[9]() }
        run { until 100  stop when forall p in P: p is I }";
    let (mean, variance) = (1..10).fold((0.0, 0.0), |(mean, variance), k| {
        let time = 1.0 / f64::from(k * (10 - k));
        (mean + time, variance + time * time)
    });
    let n = 60;
    let total: f64 = (0..n)
        .map(|seed| Case::new(text).seed(seed).run())
        .map(|run| {
            assert_eq!(run.events.len(), 9);
            run.time
        })
        .sum();
    near(total / n as f64, mean, 4.0 * (variance / n as f64).sqrt());
}

#[test]
fn rule_11_a_written_rate_is_drawn_anew_and_those_who_are_born_take_part() {
    let run = simulate_to_the_end(
        "agent A { discrete k = 0, n: int = 0  on_: after 1 { k := 3 }  off: after 4 { k := 0 } }
         agent Maker { after 2 { create A() } }
         interaction Meet(a: A, b: A) { meet: rate a.k*b.k { a.n := a.n + 1  b.n := b.n + 1 } }
         system { pair = A[2]()  maker = Maker() }
         run { until 10  seed 2 }",
    );
    let old = meetings(&run, ["pair[0]", "pair[1]"]);
    assert!(old.len() > 9 && old.iter().all(|&time| (1.0..=4.0).contains(&time)), "{old:?}");
    let new = meetings(&run, ["pair[0]", "A#3"]);
    assert!(new.len() > 2 && new.iter().all(|&time| (3.0..=4.0).contains(&time)), "{new:?}");
}

/// A model of pairs whose rate is `rate`, and of the same pairs with rate 1: the times of those are the sums of the draws.
fn with_rate(agents: &str, rate: &str, rest: &str) -> [String; 2] {
    [rate, "1 [1/s]"].map(|rate| {
        format!(
            "{agents} interaction Meet(a: A, b: A) {{ meet: rate {rate} {{ a.n := a.n + 1  b.n := b.n + 1 }} }} {rest}"
        )
    })
}

/// Whether the integrals of a hazard up to the times at which a pair fires are the sums of its draws. It may jump at `jumps`, rising.
fn integrals_are_draws(
    times: &[f64],
    draws: &[f64],
    hazard: impl Fn(f64) -> f64,
    jumps: &[f64],
    tolerance: f64,
) {
    assert!(times.len() > 8 && times.len() <= draws.len(), "{} of {}", times.len(), draws.len());
    let (mut spent, mut last) = (0.0, 0.0);
    for (&time, &draw) in times.iter().zip(draws) {
        let inside = jumps.iter().copied().filter(|&jump| last < jump && jump < time);
        for end in inside.chain([time]).collect::<Vec<_>>() {
            // on the sides of its jumps that are its own
            let margin = 1e-9 * (end - last);
            spent += integral(&hazard, last + margin, end - margin);
            last = end;
        }
        near(spent, draw, tolerance);
    }
}

#[test]
fn rule_11_the_hazard_of_a_pair_is_integrated_with_the_flow() {
    let agents = "agent A(w: real) { state x = 0  discrete n: int = 0  flow { x' = w*cos(w*time) } }";
    let [flowing, constant] = with_rate(
        agents,
        "3*(a.x - b.x)^2",
        "system { a = A(w = 1)  b = A(w = 2)  c = A(w = 3) }  run { until 40  seed 5  tolerance 1e-10 }",
    );
    let run = simulate_to_the_end(&flowing);
    let draws = simulate_to_the_end(&constant);
    for (pair, [v, w]) in [(["a", "b"], [1.0, 2.0]), (["a", "c"], [1.0, 3.0]), (["b", "c"], [2.0, 3.0])] {
        let hazard = |t: f64| 3.0 * ((v * t).sin() - (w * t).sin()).powi(2);
        let draws = meetings(&Case::new(&constant).until(400.0).run(), pair);
        integrals_are_draws(&meetings(&run, pair), &draws, hazard, &[], 1e-6);
    }
    assert!(draws.events.len() > 60);
    for integrator in [Integrator::Tsit5, Integrator::Adams, Integrator::Stiff] {
        let other = Case::new(&flowing).integrator(integrator).run();
        // a time at which the hazard is next to nothing is known as little as it
        all_near(&other.event_times(), &run.event_times(), 1e-5);
    }
}

/// What is left of a hazard is kept over writes of the two, and while the guard is false.
#[test]
fn rule_11_what_is_left_of_the_hazard_of_a_pair_survives_writes_and_closed_guards() {
    let agents = "agent A {
        state x = 0  discrete n: int = 0, k = 1  flow { x' = 1 }
        back: when x >= 1 { x := 0 }
        turn: every 0.3 { k := 3 - k } }";
    let [flowing, constant] = with_rate(
        agents,
        "4*a.k*a.x*(1 + b.x) when a.x <= 0.5 or a.x >= 0.75",
        "system { all = A[2]() }  run { until 60  seed 8 }",
    );
    let run = simulate_to_the_end(&flowing);
    let draws = Case::new(&constant).until(1000.0).run();
    let hazard = |t: f64| {
        let (x, k) = (t.fract(), if (t / 0.3).floor() % 2.0 == 0.0 { 1.0 } else { 2.0 });
        if x <= 0.5 || x >= 0.75 { 4.0 * k * x * (1.0 + x) } else { 0.0 }
    };
    let pair = ["all[0]", "all[1]"];
    let mut jumps: Vec<f64> = (0..200).map(|k| 0.3 * f64::from(k)).collect();
    jumps.extend((0..60).flat_map(|k| [0.5, 0.75, 1.0].map(|part| f64::from(k) + part)));
    jumps.sort_by(f64::total_cmp);
    integrals_are_draws(&meetings(&run, pair), &meetings(&draws, pair), hazard, &jumps, 1e-4);
    let inside =
        meetings(&run, pair).iter().filter(|t| (0.5 + 1e-9..0.75 - 1e-9).contains(&t.fract())).count();
    assert_eq!(inside, 0);
}

#[test]
fn rule_11_the_hazard_of_a_pair_may_read_the_time_links_and_sets() {
    let agents = "agent L { state y = 0  flow { y' = 1 }  when y >= 2 { y := 1 } }
        agent A(w: real) { state x = 0  discrete n: int = 0  link leader: L  flow { x' = w } }";
    let rest =
        "system { l = L()  a = A(w = 1, leader = l)  b = A(w = 2, leader = l) }  run { until 5  seed 1 }";
    let y = |t: f64| if t < 2.0 { t } else { 1.0 + t.fract() };
    let cases: [(&str, &dyn Fn(f64) -> f64); 4] = [
        ("10*time", &|t| 10.0 * t),
        ("if time < 1 then 20 else 5", &|t| if t < 1.0 { 20.0 } else { 5.0 }),
        ("8*(if a.leader then a.leader.y else 0)", &|t| 8.0 * y(t)),
        ("4*(count o in A where o.x > 3) + 4*(sum o in L: o.y)", &|t| {
            4.0 * (f64::from(u8::from(t > 3.0)) + f64::from(u8::from(2.0 * t > 3.0))) + 4.0 * y(t)
        }),
    ];
    for (rate, hazard) in cases {
        let [flowing, constant] = with_rate(agents, rate, rest);
        let run = simulate_to_the_end(&flowing);
        let draws = Case::new(&constant).until(400.0).run();
        integrals_are_draws(
            &meetings(&run, ["a", "b"]),
            &meetings(&draws, ["a", "b"]),
            hazard,
            &[1.0, 1.5, 2.0, 3.0, 4.0],
            1e-4,
        );
    }
}

#[test]
fn rule_11_hazards_of_pairs_that_flow_follow_those_who_come_and_go() {
    let run = simulate_to_the_end(
        "agent A { state x = 0  discrete n: int = 0  flow { x' = 1 }  after 6 { destroy self } }
         agent Maker { every 1 { create A() } }
         interaction Meet(a: A, b: A) { meet: rate 0.3*abs(a.x - b.x) { a.n := a.n + 1  b.n := b.n + 1 } }
         system { maker = Maker() }
         run { until 30  seed 2 }",
    );
    // at most six are there: the sum over pairs of 0.3 |i - j| is 10.5 in full strength, from 6 s on
    near(run.times("Meet.meet").len() as f64, 10.5 * 25.0, 70.0);
}

/// Its guard, or an event of who is read, ends a hazard where it is zero or not defined beyond; nothing of it is lost.
#[test]
fn rule_11_the_hazard_of_a_pair_may_end_where_it_is_no_hazard() {
    let agents = |event: &str| {
        format!(
            "agent A {{ state x = 0  discrete n: int = 0  flow {{ x' = 1 }}  back: when x >= {event} {{ x := 0 }} }}"
        )
    };
    let rest = "system { all = A[2]() }  run { until 40  seed 3 }";
    type Hazard<'a> = &'a dyn Fn(f64) -> f64;
    let cases: [(&str, &str, Hazard<'_>, f64); 4] = [
        ("1", "2*sqrt(1 - a.x^2)", &|x| 2.0 * (1.0 - x * x).max(0.0).sqrt(), 1.0),
        ("1", "3*(1 - a.x)", &|x| 3.0 * (1.0 - x), 1.0),
        ("2", "3*(1 - a.x) when a.x < 1", &|x| 3.0 * (1.0 - x).max(0.0), 2.0),
        ("2", "3*sqrt(1 - b.x) when a.x <= 1", &|x| 3.0 * (1.0 - x).max(0.0).sqrt(), 2.0),
    ];
    for (end, rate, hazard, period) in cases {
        let [flowing, constant] = with_rate(&agents(end), rate, rest);
        let run = simulate_to_the_end(&flowing);
        let draws = Case::new(&constant).until(400.0).run();
        let pair = ["all[0]", "all[1]"];
        let jumps: Vec<f64> = (1..40).map(f64::from).collect();
        let hazard = |t: f64| hazard(t % period);
        // Simpson's rule is slow at the end of a square root
        integrals_are_draws(&meetings(&run, pair), &meetings(&draws, pair), hazard, &jumps, 2e-4);
    }
}

/// Who is read beyond the two may have run ahead when the guard opens.
#[test]
fn rule_11_the_hazard_of_a_pair_may_range_over_those_who_had_run_ahead() {
    let rate = "0.002*(sum c in C: (c.y + 1)^4) when (a.x - b.x)^2 < 1";
    for seed in 1..5 {
        let run = simulate_to_the_end(&format!(
            "agent A(v: real) {{ state x = 0  discrete n: int = 0  flow {{ x' = v }} }}
             agent C(k: int) {{ state y = 1, w = 0  flow {{ y' = w  w' = -(1 + 0.1*k)*y }} }}
             interaction Meet(a: A, b: A) {{ meet: rate {rate} {{ a.n := a.n + 1  b.n := b.n + 1 }} }}
             system {{ a = A(v = 1)  b = A(x = 22, v = 0)  c = C[20](k = index) }}
             run {{ until 40  seed {seed} }}"
        ));
        assert!(run.events.iter().all(|event| (21.0..=23.0 + 1e-9).contains(&event.time)));
    }
}

/// A peak of a tenth of a second within one step of a thousand.
#[test]
fn rule_11_a_peak_of_the_hazard_of_a_pair_is_not_passed_over() {
    let agents = "agent A(v: real) { state x = 0  discrete n: int = 0  flow { x' = v } }";
    let rest = "system { a = A(v = 1)  b = A(x = 700, v = 0) }  run { until 1000  seed 4 }";
    let [flowing, constant] = with_rate(agents, "100*exp(-((a.x - b.x)/0.1)^2)", rest);
    let run = simulate_to_the_end(&flowing);
    let draws = Case::new(&constant).until(400.0).run();
    let hazard = |t: f64| 100.0 * (-((t - 700.0) / 0.1).powi(2)).exp();
    integrals_are_draws(&meetings(&run, ["a", "b"]), &meetings(&draws, ["a", "b"]), hazard, &[699.0], 1e-6);
}

/// The hazard would be negative from 2 s on; an event before that ends it.
#[test]
fn rule_11_the_hazard_of_a_pair_is_not_negative() {
    let text = |event: &str| {
        format!(
            "agent A {{ state x = 0  discrete n: int = 0  flow {{ x' = 1 }}  {event} }}
             interaction Meet(a: A, b: A) {{ meet: rate 0.001*(2 - a.x) {{ a.n := 1 }} }}
             system {{ all = A[2]() }}  run {{ until 3 }}"
        )
    };
    let (run, failed) = simulate_error(&text(""));
    assert_eq!(failed.code, "HY0514", "{failed:?}");
    near(run.time, 2.0, 1e-9);
    simulate_to_the_end(&text("when x >= 1.99999 { x := 0 }"));
    let (run, failed) = simulate_error(
        "agent A { state x = 0  discrete k = 1, n: int = 0  flow { x' = 1 }  when x >= 1 { k := -1 } }
         interaction Meet(a: A, b: A) { meet: rate 0.001*a.k { a.n := 1  b.n := 1 } }
         system { all = A[2]() }  run { until 2 }",
    );
    assert_eq!((failed.code, run.time), ("HY0514", 1.0), "{failed:?}");
    assert!(
        refused(
            "agent A { } interaction M(a: A, b: A) { m: rate -1 { } } system { all = A[2]() } run { until 2 }"
        )
        .contains("HY0219")
    );
}

#[test]
fn who_takes_part_has_no_default() {
    let told = refused(
        "agent A { state x = 0  flow { x' = 1 } }
         interaction I(a: A, b: A = nonsense) { when a.x >= b.x + 1 { a.x := 0 } }
         system { a = A[2]() }  run { until 1 }",
    );
    assert!(told.contains("HY0225") && told.contains("takes part in an interaction"), "{told}");
}
