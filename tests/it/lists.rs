//! Does `xs[i]` stand for the element at that place, in constants, flows, guards and actions; and is a place beside the list an error?

use crate::harness::{Case, all_near, near, refused, simulate_error, simulate_to_the_end};

#[test]
fn a_known_place_is_the_element_itself() {
    let run = simulate_to_the_end(
        "param k: int = 2
         param gears: real [km/h] = [18, 36, 54]
         let halves = [0.5, k/2, 1.5 + k]
         let flags = [true, false]
         agent A(v: real [m/s]) { state x: real [m] = halves[1]  discrete ok: bool = flags[0]  flow { x' = gears[k - 1] } }
         system { a = A(v = gears[2])  b = A[2](v = gears[index]) }
         run { until 1 }",
    );
    near(run.value("a.x"), 1.0 + 10.0, 1e-12);
    near(run.value("a.ok"), 1.0, 0.0);
}

#[test]
fn a_place_that_changes_is_read_in_flows_guards_and_actions() {
    // 1, then 3, then 2 for a second each
    let run = simulate_to_the_end(
        "let speeds = [1, 3, 2]
         let waits = [1 [s], 1 [s], 1 [s]]
         agent A {
           state x = 0
           discrete gear: int = 0, seen = 0
           flow { x' = speeds[gear] }
           shift: every 1 when gear < 2 { gear := gear + 1  seen := speeds[gear + 1] }
           fast: when speeds[gear] >= 2.5 { }
           there: when x >= [4.5, 4.75, 5][gear] { }
         }
         system { a = A() }
         run { until 3 }",
    );
    near(run.value("a.x"), 6.0, 1e-9);
    near(run.value("a.seen"), 2.0, 0.0);
    all_near(&run.times("A.fast"), &[1.0], 1e-12);
    all_near(&run.times("A.there"), &[2.5], 1e-12);
}

#[test]
fn rule_15_a_place_that_flows_is_a_kink_at_every_change() {
    let run = simulate_to_the_end(
        "let heights = [0, 2, -1]
         agent A { state x = 0, y = 0  flow { x' = 0.5  y' = heights[floor(x)] } }
         system { a = A() }
         run { until 5.5  tolerance 1e-3 }",
    );
    near(run.value("a.y"), 2.0 * 2.0 - 1.5, 1e-12);
}

#[test]
fn a_list_is_given_on_the_command_line() {
    let text = "param ks: int = [1, 2]  param xs: real [cm] = [100]
        agent A(k: real) { state x = k  flow { x' = xs[0] } }
        system { a = A(k = ks[1]) }  run { until 1 }";
    let run = Case::new(text).param("ks", "[7, 8, 9]").param("xs", "250").run();
    near(run.value("a.x"), 8.0 + 2.5, 1e-12);
    for wrong in ["1.5, 2", "", "one"] {
        let told = Case::new(text).param("ks", wrong).refused().1;
        assert_eq!(told[0].code, "HY0261", "{told:?}");
    }
}

#[test]
fn beside_the_list_there_is_nothing() {
    let with = |text: &str| {
        format!(
            "let xs = [1, 2, 3]  agent A(k: int) {{ state x = 0  discrete n: int = 0  {text} }}  system {{ a = A(k = 2) }}  run {{ until 3 }}"
        )
    };
    let told = refused(&with("flow { x' = xs[3] }"));
    assert!(told.contains("HY0269") && told.contains("3 elements, numbered from 0"), "{told}");
    assert!(refused(&with("flow { x' = xs[-1] }")).contains("HY0269"));
    assert!(refused(&with("flow { x' = xs[0.5] }")).contains("HY0221"));
    assert!(refused(&with("flow { x' = xs }")).contains("HY0220"));
    assert!(refused(&with("flow { x' = k[0] }")).contains("HY0223"));
    assert!(refused("let xs = [1, true]").contains("HY0220"));
    assert!(refused("param xs = [1, time]").contains("HY0262"));
    let told = refused(&with("let ys = [1, k]  flow { x' = ys[0] }"));
    assert!(told.contains("HY0225") && told.contains("outside of agents"), "{told}");
    // what is found out while it runs ends the run, or is not true
    let (_, failed) = simulate_error(&with("flow { x' = xs[n] }  out: after 1 { n := 7 }"));
    assert_eq!(failed.code, "HY0502", "{failed:?}");
    let run = simulate_to_the_end(&with(
        "flow { x' = 1 }  out: after 1 { n := 7 }  never: when x >= 2 and xs[n] >= 0 { }  always_: when x >= 2 { }",
    ));
    assert_eq!(run.log(), ["0 A.out a", "0 A.always_ a"]);
    let told = refused(
        "let xs = [1, 2]  agent A { state x = xs[index]  flow { x' = 0 } }  system { a = A[3]() }  run { until 1 }",
    );
    assert!(told.contains("HY0263"), "{told}");
}
