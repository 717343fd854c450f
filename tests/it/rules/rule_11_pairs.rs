//! Rule 11: the hazard of a pair, `rate` in an interaction.

use crate::harness::{Case, Run, all_near, near, refused, simulate_error, simulate_to_the_end};

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

#[test]
fn rule_11_the_rate_of_a_pair_is_a_number_that_only_events_change() {
    let with = |rate: &str| {
        format!(
            "agent A {{ state x = 0  discrete k = 1, n: int = 0  flow {{ x' = 1 }}  when x >= 1 {{ k := -1 }} }}
             interaction Meet(a: A, b: A) {{ meet: rate {rate} {{ a.n := 1  b.n := 1 }} }}
             system {{ all = A[2]() }}
             run {{ until 2 }}"
        )
    };
    for rate in ["a.x", "if a.x > 1 then 1 else 2", "time", "1 + (count o in A where o.x > 1)"] {
        let told = refused(&with(rate));
        assert!(told.contains("HY0200"), "{rate}: {told}");
    }
    assert!(refused(&with("-1")).contains("HY0219"));
    let (run, failed) = simulate_error(&with("0.001*a.k"));
    assert_eq!((failed.code, run.time), ("HY0514", 1.0), "{failed:?}");
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
