//! Is a table what its file says: in constants, in flows with every row located, in guards; and are its errors told in the file?

use hyc::base::render::{Colours, render};
use hyc::calculus::system::KinkKind;
use hyc::model::ir::Integrator;

use crate::harness::{Case, all_near, near};

const HAT: &str = "t,v,w\n0,0,1\n1,2,1\n3,0,5\n";

fn with_hat(text: &str) -> Case {
    Case::new(text).file("hat.csv", HAT)
}

#[test]
fn rows_are_exact_between_them_it_is_linear_outside_constant() {
    let model = "param at = 0  agent A(v: real) { state x = v  flow { x' = 0 } }
        let v = table(\"hat.csv\", \"v\", at)  let w = table(\"hat.csv\", \"w\", at)
        system { a = A(v = v)  b = A(v = w) }  run { until 0 }";
    let expected = [
        ("-1", 0.0, 1.0),
        ("0", 0.0, 1.0),
        ("0.25", 0.5, 1.0),
        ("1", 2.0, 1.0),
        ("2.5", 0.5, 4.0),
        ("3", 0.0, 5.0),
        ("1e9", 0.0, 5.0),
    ];
    for (at, v, w) in expected {
        let run = with_hat(model).param("at", at).run();
        assert_eq!([run.value("a.x"), run.value("b.x")], [v, w], "at {at}");
    }
}

#[test]
fn rule_15_a_flow_of_a_table_of_time_is_exact_at_any_tolerance() {
    let case = with_hat(
        "agent A { state x = 0  flow { x' = table(\"hat.csv\", \"v\", time) } }
         system { a = A() }  run { until 5  tolerance 1e-2  record a every 0.5 to \"a.csv\" }",
    );
    let (_, system, _) = case.system();
    let kinks = &system.types[0].modes[0].flow.as_ref().unwrap().kinks;
    assert_eq!(kinks.len(), 3);
    assert!(kinks.iter().all(|kink| matches!(kink.kind, KinkKind::Branch(_))));
    let run = case.run();
    let area = |t: f64| match t {
        t if t <= 1.0 => t * t,
        t if t <= 3.0 => 3.0 - (3.0 - t) * (3.0 - t) / 2.0,
        _ => 3.0,
    };
    for (time, x) in run.column("a", 0) {
        near(x, area(time), 1e-13);
    }
}

#[test]
fn rule_15_a_table_of_a_state_bends_the_flow_where_the_state_passes_a_row() {
    // x' = 1 - x/2 beyond x = 1, so the row is passed at log 2 / ... in closed form: x' = 2x + 1 before, then a decay
    let run = Case::new(
        "agent A { state x = 0  flow { x' = 1 + table(\"hat.csv\", \"v\", x) } }
         system { a = A() }  run { until 1  tolerance 1e-10 }",
    )
    .file("hat.csv", HAT)
    .run();
    // x = (e^(2t) - 1)/2 up to 1 at t1 = ln(3)/2; then x' = 4 - x: x = 4 - 3 e^(t1 - t)
    let t1 = 3f64.ln() / 2.0;
    near(run.value("a.x"), 4.0 - 3.0 * (t1 - 1.0).exp(), 1e-9);
}

#[test]
fn a_guard_reads_a_table() {
    let run = with_hat(
        "agent A { discrete n = 0
           high: when table(\"hat.csv\", \"v\", time) >= 1 { n := n + 1 }
           falls: when rising(table(\"hat.csv\", \"v\", time) <= 0.5) { n := n + 10 }
           level: when crossing(table(\"hat.csv\", \"w\", time) - 3) { n := n + 100 } }
         system { a = A() }  run { until 5 }",
    )
    .run();
    all_near(&run.times("A.high"), &[0.5], 1e-9);
    all_near(&run.times("A.falls"), &[2.5], 1e-9);
    all_near(&run.times("A.level"), &[2.0], 1e-9);
}

#[test]
fn a_table_of_one_row_is_a_constant() {
    let run = Case::new(
        "agent A { state x = 0  flow { x' = table(\"one.csv\", \"v\", x) } }  system { a = A() }  run { until 2 }",
    )
    .file("one.csv", "t,v\n7,3\n")
    .run();
    near(run.value("a.x"), 6.0, 1e-12);
}

#[test]
fn a_long_table_is_a_broken_line() {
    let rows: Vec<String> =
        (0..400).map(|k| format!("{},{}", 0.05 * f64::from(k), (k * 7919) % 13)).collect();
    let file = format!("t,v\n{}\n", rows.join("\n"));
    let run = Case::new(
        "agent A { state x = 0  flow { x' = table(\"long.csv\", \"v\", time) } }
         system { a = A() }  run { until 19.95  tolerance 1e-3 }",
    )
    .file("long.csv", &file)
    .run();
    let value = |k: i32| f64::from((k * 7919) % 13);
    let area: f64 = (0..399).map(|k| 0.05 * 0.5 * (value(k) + value(k + 1))).sum();
    near(run.value("a.x"), area, 1e-10);
}

#[test]
fn units_of_columns_are_not_checked() {
    let case = with_hat(
        "agent A { state x: real [m] = 0  let wind: real [m/s] = table(\"hat.csv\", \"v\", time)
           flow { x' = wind } }
         system { a = A() }  run { until 3 }",
    );
    near(case.run().value("a.x"), 3.0, 1e-12);
}

#[test]
fn errors_stand_in_the_file() {
    let model = "agent A { state x = 0  flow { x' = table(\"t.csv\", \"v\", time) } }";
    let told = |file: &str| {
        let (sources, found) = Case::new(model).file("t.csv", file).refused();
        render(&sources, &found, Colours::None)
    };
    let text = told("t,v\n0,1\n2,2\n1,3\n");
    assert!(text.contains("HY0288") && text.contains("t.csv:4:1"), "{text}");
    let text = told("t,v\n0,1\n2,many\n");
    assert!(text.contains("HY0276") && text.contains("t.csv:3:3") && text.contains("`many`"), "{text}");
    let text = told("t,w\n0,1\n");
    assert!(text.contains("HY0286") && text.contains("test.hy:1:51"), "{text}");
    let text = told("t,v\n");
    assert!(text.contains("HY0287"), "{text}");
    let text = told("t,v\n0,1,2\n");
    assert!(text.contains("HY0285") && text.contains("t.csv:2"), "{text}");
    let rows: Vec<String> = (0..1001).map(|k| format!("{k},{k}")).collect();
    let text = told(&format!("t,v\n{}", rows.join("\n")));
    assert!(text.contains("HY0289") && text.contains("max_table_rows"), "{text}");
    let (_, found) = Case::new(model).refused();
    assert_eq!(found[0].code, "HY0272");
    let (_, found) = Case::new("param a = table(3, \"v\", 1)").refused();
    assert_eq!(found[0].code, "HY0220");
    let (_, found) = Case::new("param a = table(\"t.csv\", \"v\")").refused();
    assert_eq!(found[0].code, "HY0226");
}

/// Rows of a rise that ends, at distances that differ in the second column.
const RISE: &str = "t,v\n0,0\n1,1\n2,4\n3,4\n";

#[test]
fn a_spline_keeps_rows_and_shape() {
    // slopes at the rows by hand: 0, the harmonic mean 1.5 of 1 and 3, 0 and 0
    let model = "param at = 0  agent A(v: real) { state x = v  flow { x' = 0 } }
        system { a = A(v = spline(\"rise.csv\", \"v\", at)) }  run { until 0 }";
    let expected = [
        ("-1", 0.0),
        ("0", 0.0),
        ("0.5", 0.3125),
        ("1", 1.0),
        ("1.5", 2.6875),
        ("2", 4.0),
        ("2.5", 4.0),
        ("9", 4.0),
    ];
    for (at, v) in expected {
        let run = Case::new(model).file("rise.csv", RISE).param("at", at).run();
        near(run.value("a.x"), v, 1e-15);
    }
}

#[test]
fn rule_15_a_flow_of_a_spline_of_time_is_exact_at_any_tolerance() {
    let run = Case::new(
        "agent A { state x = 0  flow { x' = spline(\"rise.csv\", \"v\", time) }  half: when spline(\"rise.csv\", \"v\", time) >= 2.6875 { } }
         system { a = A() }  run { until 3  tolerance 1e-2 }",
    )
    .file("rise.csv", RISE)
    .run();
    // a cubic over h is (first + last)/2 h + (slope at first - slope at last)/12 h^2
    near(run.value("a.x"), (0.5 - 0.125) + (2.5 + 0.125) + 4.0, 1e-12);
    all_near(&run.event_times(), &[1.5], 1e-12);
}

#[test]
fn a_spline_of_two_rows_is_their_line() {
    let run = Case::new(
        "agent A { state x = 0  flow { x' = spline(\"two.csv\", \"v\", time) } }
         system { a = A() }  run { until 2 }",
    )
    .file("two.csv", "t,v\n0,1\n2,5\n")
    .run();
    near(run.value("a.x"), 6.0, 1e-12);
}

#[test]
fn rounding_leads_no_spline_beyond_its_rows() {
    // The rows at 0 are the least: a bound, a hazard and a strict guard all look at them.
    for rows in
        ["0,0.8\n1.9,0\n2.6,2.1\n", "0,0.2\n1,0\n1.8,2.1\n", "0,0.8\n2,0\n2.8,2\n", "0,1.7\n0.3,0\n0.9,0.4\n"]
    {
        let run = Case::new(
            "agent A { state x = 0  let u = spline(\"rows.csv\", \"v\", time)
               flow { x' = u }  invariant u >= 0  below: when u < 0 { }  hit: rate u { } }
             system { a = A() }  run { until 3 }",
        )
        .file("rows.csv", &format!("t,v\n{rows}"))
        .run();
        assert_eq!(run.times("A.below"), Vec::<f64>::new(), "{rows}");
    }
}

#[test]
fn a_bound_that_is_touched_within_rounding_before_a_kink_ends() {
    // 0.2 (1 - t)^3, written so that rounding takes it below zero just before 1
    let run = Case::new(
        "agent A { state x = 0  flow { x' = 1 }
           assert (if time < 1 then time*(time*(0.6000000000000001 - 0.20000000000000007*time) - 0.6000000000000001) + 0.2
                   else time - 1) >= -0.1
           assert (if time < 1 then time*(time*(0.6000000000000001 - 0.20000000000000007*time) - 0.6000000000000001) + 0.2
                   else time - 1) >= 0 }
         system { a = A() }  run { until 3 }",
    )
    .run();
    near(run.value("a.x"), 3.0, 1e-12);
}

#[test]
fn rule_15_a_stiff_step_is_not_judged_by_where_a_cubic_leads_beyond_its_row() {
    let rows = [(1.0, 0.0), (2.0, 1.0), (2.01, 5.0), (12.0, 0.0)];
    let text = rows.iter().fold("z,v\n".to_string(), |text, (z, v)| format!("{text}{z},{v}\n"));
    let model = |z: &str| {
        let text = format!(
            "agent A {{ state z = 1, d = 0  flow {{ z' = 2  d' = spline(\"steep.csv\", \"v\", {z}) }} }}
             system {{ a = A() }}  run {{ until 10 }}"
        );
        Case::new(&text)
    };
    // the integral by the argument that is exact
    let exact = model("1 + 2*time").file("steep.csv", &text).tolerance(1e-12).run().value("a.d");
    for integrator in [Integrator::Stiff, Integrator::Auto, Integrator::Tsit5, Integrator::Adams] {
        let run = model("z").file("steep.csv", &text).integrator(integrator).tolerance(1e-9).run();
        near(run.value("a.d"), exact, 1e-6);
    }
}
