//! Rule 13: a quantifier in a flow couples its owner with the whole set.

use hyc::base::SourceMap;

use crate::harness::{Case, near, refused, simulate, simulate_by_both_forms, simulate_error, words};

/// x_k' = sum (x_o - x_k) over all n: the mean stays, and the way to it shrinks by exp(-n t).
#[test]
fn rule_13_who_reads_the_sum_of_all_comes_to_the_mean() {
    for other in ["", "other "] {
        let run = simulate_by_both_forms(&format!(
            "agent A {{ state x  flow {{ x' = sum o in {other}A: o.x - x }} }}
             system {{ a = A[5](x = index^2) }}  run {{ until 0.7  tolerance 1e-10 }}"
        ));
        for k in 0..5 {
            let start = f64::from(k * k);
            near(run.value(&format!("a[{k}].x")), 6.0 + (start - 6.0) * (-3.5f64).exp(), 1e-8);
        }
    }
}

/// Two oscillators, coupled by the sine of their difference p: p' = w - 2 k sin(p), with w = 0 tan(p/2) = tan(p0/2) exp(-2 k t).
#[test]
fn rule_13_two_oscillators_fall_into_step() {
    let run = simulate(
        "fn pull(a: real, b: real) = 0.8*sin(b - a)
         agent Clock { state th  let all = sum o in other Clock: pull(th, o.th)  flow { th' = 3 + all } }
         system { c = Clock[2](th = 2*index) }  run { until 2  tolerance 1e-11 }",
    );
    let p = 2.0 * ((1f64).tan() * (-2.0 * 0.8 * 2.0f64).exp()).atan();
    near(run.value("c[1].th") - run.value("c[0].th"), p, 1e-9);
    near(run.value("c[1].th") + run.value("c[0].th"), 2.0 + 12.0, 1e-9);
}

/// How many are ahead is a kink of the flow where somebody is overtaken: at t = 1 for x = 0 and 1 with rates 1 and 0 more.
#[test]
fn rule_13_a_count_in_a_flow_jumps_where_its_filter_does() {
    for count in ["count o in other A where o.x > x", "sum o in other A: if o.x > x then 1 else 0"] {
        let run = simulate(&format!(
            "agent A(v: real) {{ state x, y = 0  flow {{ x' = v  y' = {count} }} }}
             system {{ slow = A(v = 0, x = 1)  fast = A(v = 1, x = 0) }}  run {{ until 3  tolerance 1e-9 }}"
        ));
        near(run.value("fast.y"), 1.0, 1e-9);
        near(run.value("slow.y"), 2.0, 1e-9);
    }
}

#[test]
fn rule_13_exists_forall_min_and_max_in_a_flow() {
    // All follow the greatest, 2 + t, and count how long somebody, or everybody, of the others is beyond 3.
    let run = simulate(
        "agent A { state x
           flow { x' = 1 } }
         agent B { state hi = 0, lo = 0, some = 0, all = 0
           flow { hi' = (max o in A: o.x) - hi  lo' = (min o in A: o.x) - lo
                  some' = if exists o in A: o.x > 3 then 1 else 0
                  all' = if forall o in A where o.x > 0: o.x > 3 then 1 else 0 } }
         system { a = A[3](x = index)  b = B() }  run { until 4  tolerance 1e-10 }",
    );
    // y' = c + t - y from 0: y = t + (c - 1)(1 - exp(-t))
    let follows = |c: f64| 4.0 + (c - 1.0) * (1.0 - (-4f64).exp());
    near(run.value("b.hi"), follows(2.0), 1e-8);
    near(run.value("b.lo"), follows(0.0), 1e-8);
    near(run.value("b.some"), 3.0, 1e-9);
    near(run.value("b.all"), 1.0, 1e-9);
}

/// Who dies leaves the set: from then on the mean is that of the others.
#[test]
fn rule_13_who_dies_pulls_no_more() {
    let run = simulate_by_both_forms(
        "agent A(mortal: bool) { state x  flow { x' = sum o in other A: o.x - x }  after 0.25 when mortal { destroy self } }
         system { a = A(mortal = false, x = 0)  b = A(mortal = false, x = 3)  c = A(mortal = true, x = 9) }
         run { until 1  tolerance 1e-10 }",
    );
    let at = |start: f64| 4.0 + (start - 4.0) * (-0.75f64).exp();
    let mean = (at(0.0) + at(3.0)) / 2.0;
    near(run.value("a.x"), mean + (at(0.0) - mean) * (-1.5f64).exp(), 1e-8);
    near(run.value("b.x"), mean + (at(3.0) - mean) * (-1.5f64).exp(), 1e-8);
}

/// A reset of one restarts those whose flow reads it.
#[test]
fn rule_13_a_jump_in_the_set_reaches_who_reads_it() {
    let run = simulate_by_both_forms(
        "agent Lead { state x = 0  flow { x' = 0 }  jump: after 1 { x := 1 } }
         agent Car { state x = 0  flow { x' = (sum o in Lead: o.x) - x } }
         system { l = Lead[2]()  c = Car() }  run { until 3  tolerance 1e-10 }",
    );
    near(run.value("c.x"), 2.0 * (1.0 - (-2f64).exp()), 1e-9);
}

/// A hazard may read a set: while two of three are on it is 0.2.
#[test]
fn rule_13_a_hazard_reads_a_set() {
    let run = |rate: &str| {
        simulate(&format!(
            "agent A {{ discrete lit: bool = index < 2 }}
             agent B {{ discrete n: int = 0  tick: rate {rate} {{ n := n + 1 }} }}
             system {{ a = A[3]()  b = B() }}  run {{ until 100  seed 3 }}"
        ))
    };
    let (by_set, by_number) = (run("0.1*(count o in A where o.lit)"), run("0.2"));
    let (a, b) = (by_set.times("B.tick"), by_number.times("B.tick"));
    assert!(a.len() > 5 && a.len() == b.len());
    a.iter().zip(&b).for_each(|(a, b)| near(*a, *b, 1e-6));
}

/// Who is born pulls and is pulled from then on; the pulls cancel, so the sum of all moves by births alone.
#[test]
fn rule_13_who_is_born_pulls_and_is_pulled() {
    let run = simulate_by_both_forms(
        "agent A(lays: bool = false) { state x = 0  flow { x' = sum o in other A: o.x - x }  split: after 0.25 when lays { create A(x = 9) } }
         agent Reader { state n = 0, top = 0
           flow { n' = count o in A  top' = if exists o in A: o.x > 8 then 1 else 0 } }
         system { a = A[2](x = 3*index, lays = index == 1)  r = Reader() }
         run { until 1  tolerance 1e-10 }",
    );
    let two = |start: f64| 1.5 + (start - 1.5) * (-0.5f64).exp();
    let three = |start: f64, d: f64| 4.0 + (start - 4.0) * (-3.0 * d).exp();
    near(run.value("a[0].x"), three(two(0.0), 0.75), 1e-8);
    near(run.value("a[1].x"), three(two(3.0), 0.75), 1e-8);
    near(run.value("A#3.x"), three(9.0, 0.75), 1e-8);
    near(run.value("r.n"), 2.0 * 0.25 + 3.0 * 0.75, 1e-9);
    near(run.value("r.top"), 0.2231435513142097 / 3.0, 1e-8); // 4 + 5 exp(-3 d) = 8
}

/// Those who are born together, and read a set that does not grow, or one that somebody else is of.
#[test]
fn rule_13_the_newborn_read_their_sets() {
    let run = simulate_by_both_forms(
        "agent Lead { state x = 0  flow { x' = 1 } }
         agent Car { state y = 0, z = 0  flow { y' = (sum o in Lead: o.x)  z' = (sum o in b: o.x) + 10*(count o in other Car) } }
         agent Maker { both: after 1 { create Car()  create Car() }  more: after 2 { create Lead(x = 5) } }
         system { a = Lead()  b = Lead(x = 1)  m = Maker() }
         run { until 3  tolerance 1e-10 }",
    );
    // at 1 s the leads are at 1 and 2; at 2 s there is a third at 5
    for car in ["Car#3", "Car#4"] {
        near(run.value(&format!("{car}.y")), 3.0 * 2.0 + 4.0 + 5.5, 1e-8);
        near(run.value(&format!("{car}.z")), 2.0 * 2.0 + 2.0 + 20.0, 1e-8);
    }
}

/// A place is free again when its agent dies.
#[test]
fn rule_13_a_set_takes_any_number_one_after_the_other() {
    let text = |life: f64| {
        format!(
            "agent A {{ state x = 1  flow {{ x' = -0*(sum o in A: o.x) }}  die: after {life} {{ destroy self }} }}
             agent Nest {{ state n = 0  flow {{ n' = sum o in A: o.x }}  lay: every 0.1 {{ create A() }} }}
             system {{ nest = Nest() }}  run {{ until 9.95 }}"
        )
    };
    near(simulate(&text(0.25)).value("nest.n"), 97.0 * 0.25 + 0.15 + 0.05, 1e-6);
    let (_, found) = simulate_error(&text(5.0));
    assert_eq!(found.code, "HY0536");
    assert!(words(&[found]).contains("more than 32 agents of `A` join"));
}

/// What has no member has no kinks: they would be searched for in vain, in thousands of pieces.
#[test]
fn rule_13_free_places_of_a_set_cost_no_search() {
    let run = simulate(
        "agent A(lays: bool = false) { state x = 0  flow { x' = 1 + 0.1*(sum o in A: abs(o.x - x)) }  one: after 1 when lays { create A() } }
         system { a = A[2](x = index, lays = index == 0) }  run { until 3 }",
    );
    let evaluations = run.stats.guard_evaluations;
    assert!(evaluations < 20_000, "{evaluations}");
}

#[test]
fn rule_13_a_set_in_a_flow_has_a_limit() {
    let many = Case::new(
        "agent A { state x = 0  flow { x' = sum o in A: o.x - x } }
         system { a = A[300]() }  run { until 1 }",
    );
    let model = many.model(&mut SourceMap::default()).unwrap();
    let found = words(&hyc::calculus::derive(&model).unwrap_err());
    assert!(found.contains("limit is 256"), "{found}");
    // ... that is asked for before there are so many links
    let very_many = refused(
        "agent A { state x = 0  flow { x' = sum o in A: o.x - x } }
         system { a = A[100000]() }  run { until 1 }",
    );
    assert!(very_many.contains("100000 of a set") && very_many.contains("limit is 256"), "{very_many}");
}
