//! Are units what the reference says: gradual, checked everywhere, and the unit of what goes in and comes out?

mod evaluator;
mod random;

use std::fs;
use std::process::Command;

use hyc::base::{Diagnostic, SourceMap};

use crate::harness::Case;

/// What is wrong with the dimensions of a model that is right otherwise.
#[track_caller]
fn mistakes(text: &str) -> Vec<Diagnostic> {
    let found = Case::new(text).model(&mut SourceMap::default()).err().unwrap_or_default();
    let errors: Vec<_> = found.into_iter().filter(Diagnostic::is_error).collect();
    for error in &errors {
        assert!(error.code.starts_with("HY023"), "{text}\n{error:#?}");
        assert!(error.help.is_some(), "what to type? {error:#?}");
    }
    errors
}

/// A car that is read by conditions and lets: `x` in m, `v` in km/h, `free` without a unit.
fn car(item: &str) -> String {
    format!(
        "param L: real [km] = 2   param n = 2   param T: real [min] = 1
         fn area(a: real, b: real) = a*b
         fn speed(way: real [m], t: real [s]): real [m/s] = way/t
         agent Car(m: real [kg] = 1000) {{
           state x: real [m] = 0, v: real [km/h] = 36, free = 0
           discrete top: real [m/s] = 0, seen: int = 0
           link lead: Car
           flow {{ x' = v  v' = 0  free' = 1 }}
           {item}
         }}"
    )
}

/// Fails unless each item is right.
#[track_caller]
fn fine(items: &[&str]) {
    for item in items {
        let found = mistakes(&car(item));
        assert!(found.is_empty(), "{item}\n{found:#?}");
    }
}

/// Fails unless each item has exactly one mistake.
#[track_caller]
fn wrong(items: &[&str]) {
    for item in items {
        let found = mistakes(&car(item));
        assert_eq!(found.len(), 1, "{item}\n{found:#?}");
    }
}

#[test]
fn a_name_without_one_is_unchecked() {
    fine(&[
        "let e = free + x  let f = free + v",
        "let e = free*x + v",
        "let e = sin(free) + x  let f = 2^free + x  let g = n*x + v",
        "let e = seen*x + v  let f = if free > x then free else v",
        "let any: real = x  let e = any + v",
        "when free > x and free > v { free := x + free  seen := round(x*free) }",
    ]);
    wrong(&["let e = (free + x) + v", "let e = max(free, x, ) + v".replace(", )", ")").as_str()]);
}

#[test]
fn a_bare_literal_is_dimensionless_in_a_product() {
    fine(&["let e = 2*x + x/3", "let e = 1/x < 3*2/x", "let two = 2  let e = two*x + v"]);
    wrong(&["let e = 1/x + x", "let e = 2*x < 3*v"]);
}

#[test]
fn a_bare_literal_takes_the_other_sides_dimension_in_sums_and_comparisons() {
    fine(&[
        "let e = x + 5 - 3*2",
        "let e = 5 - x + 1",
        "when x > 3 and 4 <= v and x + 1 >= -2 { x := 5  top := -2  v := 1 }",
        "assert x >= -1e-6",
        "let e = x + pi  let gap = if lead then lead.x - x else inf",
    ]);
    wrong(&["let e = (x + 5) - v", "when x + 1 > v { }", "let e = (5 + x)*1 - (5 - v)"]);
}

#[test]
fn a_bare_literal_takes_the_other_sides_dimension_in_min_max_clamp_mod_hypot_atan2() {
    for f in ["min(x, 3)", "max(0, x)", "clamp(x, 0, 3)", "mod(x, 2)", "hypot(x, 1)"] {
        fine(&[&format!("let e = {f} + x")]);
        wrong(&[
            &format!("let e = {f} + v"),
            &format!("let e = {}", f.replace('3', "v").replace(['0', '1', '2'], "v")),
        ]);
    }
    fine(&["let e = atan2(x, 3) + sin(2*x/L)", "let e = atan2(x, L) + 1 [rad] - 90 [deg] + 5 [%]"]);
    wrong(&["let e = atan2(x, v)", "let e = atan2(x, 3) + x"]);
}

#[test]
fn a_bare_literal_takes_the_other_sides_dimension_in_branches_of_if_and_arguments() {
    fine(&[
        "let e = if lead then x else 0  let f = e + x",
        "let e = speed(3, 2) + v",
        "let e = area(2, x) + x",
        "let e = area(v, T) + x",
    ]);
    wrong(&["let e = (if lead then x else 0) + v", "let e = speed(v, 2)", "let e = area(v, T) + v"]);
}

#[test]
fn time_is_in_s_and_rad_is_1() {
    fine(&[
        "let e = x + v*time",
        "let e = sin(2 [rad/s]*time) + sin(2 [1/s]*time) + cos(time/T)",
        "when time >= T and time > 3 { }",
        "let e = sin(3*time) + free",
    ]);
    wrong(&["let e = x + time", "let e = sin(v*time)", "when time > x { }", "let e = time*v + time*v*v"]);
}

#[test]
fn where_nobody_has_written_a_unit_nothing_is_wrong() {
    let text = "agent A { state x = 0, y = 1
                  flow { x' = sin(3*time) + time  y' = exp(-time)*x^time }
                  when time > sin(time) and crossing(cos(time) - time^2) { x := time } }";
    assert_eq!(mistakes(text), []);
}

#[test]
fn a_rate_has_the_dimension_of_its_state_per_second() {
    fine(&["let e = x' + v + lead.x'*0  when x' > v { }", "let e = x'/x*T + 1 [1]"]);
    wrong(&["when x' > x { }", "let e = v' + v"]);
    let flow =
        |rate: &str| mistakes(&format!("agent A {{ state x: real [km] = 0 flow {{ x' = {rate} }} }}")).len();
    assert_eq!(["0", "3 [m/s]", "x/(2 [min])", "-1"].map(flow), [0; 4]);
    assert_eq!(["x", "2*x", "3 [m]", "x*time", "x/(2 [m])"].map(flow), [1; 5]);
}

#[test]
fn what_goes_into_a_name_has_its_dimension() {
    fine(&[
        "let e: real [ft] = x  let w: real [mph] = v",
        "entry { x := L  v := top  top := v }",
        "when x > L { if x > 3 { x := 2*L } else { x := v*T } }",
    ]);
    wrong(&[
        "let e: real [s] = x",
        "entry { x := v }",
        "exit { if x > 3 { x := 2 } else { top := x } }",
        "entry { top := v*T }",
    ]);
    let system = |args: &str| mistakes(&(car("") + &format!("system {{ c = Car({args}) }}"))).len();
    assert_eq!(["x = 3", "x = L", "v = 3 [m/s], m = 1 [t]", "m = 2*1000"].map(system), [0; 4]);
    assert_eq!(["x = T", "x = 1 [s]", "v = L/(3 [m])", "m = 2*L"].map(system), [1; 4]);
    let param = |value: &str| mistakes(&format!("param p: real [N] = {value}")).len();
    assert_eq!(["3", "3 [kg]*9.81 [m/s^2]", "2*3 [J]/(1 [m])"].map(param), [0; 3]);
    assert_eq!(["3 [kg]", "3 [kg]*9.81"].map(param), [1; 2]);
}

#[test]
fn drawn_values_take_parameters_in_the_unit_of_the_variable() {
    let draw = |given: &str| {
        mistakes(&format!("agent A {{ state v: real [km/h] ~ {given} flow {{ v' = 0 }} }}")).len()
    };
    assert_eq!(
        ["Normal(30, 3)", "Uniform(1 [m/s], 50)", "Exponential(0.1)", "Exponential(2 [s/m])"].map(draw),
        [0; 4]
    );
    assert_eq!(["Normal(30 [m], 3)", "Uniform(0, 3 [s])", "Exponential(2 [m/s])"].map(draw), [1; 3]);
}

#[test]
fn triggers_take_times_and_priorities_take_numbers() {
    fine(&[
        "after 3 { }  after T { }  every 10 [ms] { }  after x/v when x > 3 { }",
        "when x > 3 priority 2 { }  when x > 4 priority seen + free { }  when x > 5 priority x/L { }",
    ]);
    wrong(&["after x { }", "every 10 [Hz] { }", "when x > 3 priority x { }"]);
    let run = |run: &str| mistakes(&(car("") + &format!("system {{ c = Car() }} run {{ {run} }}"))).len();
    assert_eq!(
        ["until 3", "until T", "until 3 [h] record c every 2 [min] to \"a.csv\"", "tolerance 1e-8 seed 3"]
            .map(run),
        [0; 4]
    );
    assert_eq!(
        ["until L", "until 3 [m]", "until 1 record c every L to \"a.csv\"", "tolerance 3 [m]"].map(run),
        [1; 4]
    );
}

#[test]
fn links_participants_and_bound_agents_have_the_units_of_their_members() {
    fine(&[
        "let e = if lead then lead.x + x else 0",
        "when exists o in other Car where o.x > x: o.v <= top { top := o.v }",
        "when forall o in Car: abs(o.x - x) < L { }",
    ]);
    wrong(&[
        "let e = if lead then lead.v + x else 0",
        "when exists o in other Car where o.x > v: o.v <= top { }",
        "when exists o in other Car: o.v <= top { top := o.x }",
        "when lead and lead.lead and lead.lead.x > v { }",
    ]);
    let pair =
        |body: &str| mistakes(&(car("") + &format!("interaction I(a: Car, b: Car) {{ {body} }}"))).len();
    assert_eq!(pair("let d = a.x - b.x  when d^2 <= L^2 { a.v := b.v  b.top := a.v }"), 0);
    assert_eq!(pair("let d = a.x - b.x  when d^2 <= L { a.v := 3 }"), 1);
    assert_eq!(pair("let d = a.x - b.v  when d > 3 { a.x := d }"), 1);
    assert_eq!(pair("when a.x > b.x { a.v := b.x }"), 1);
}

#[test]
fn sums_and_extremes_over_agents_have_the_dimension_of_their_terms() {
    fine(&[
        "let e = (sum o in other Car: o.x) + x  let f = (max o in Car: o.v) - v  let g = x*(count o in Car) + x",
        "when (min o in other Car where o.v > v: abs(o.x - x)) < L { top := max o in Car: o.v }",
    ]);
    wrong(&[
        "let e = (sum o in other Car: o.x) + v",
        "let e = (min o in Car: o.x + o.v) + v",
        "when (count o in Car where o.x > v: true) > 3 { }",
        "entry { top := sum o in Car: o.x }",
    ]);
}

#[test]
fn powers_and_roots_scale_dimensions() {
    fine(
        &[
            "let e = sqrt(x*L) + x  let f = cbrt(x^3) - x  let g = x^n + x*L  let h = (x^2)^0.5 + x",
            "let e = x^-1*x + 2 [1]  let f = x^(1/3)*x^(2/3) + x  let g = x^(n - 1) + x",
            "let e = (x/L)^free + 1 [1]  let f = 2^(x/L)  let g = x^m",
        ]
        .map(|item| item.replace("x^m", "x^seen"))
        .each_ref()
        .map(String::as_str),
    );
    wrong(&[
        "let e = sqrt(x) + x",
        "let e = x^2 + x",
        "let e = x^x",
        "let e = 2^x",
        "let e = x^time",
        "let e = x^pi",
    ]);
}

#[test]
fn functions_without_units_are_checked_at_each_call() {
    let text = |use_: &str| {
        format!(
            "fn total(a: real, b: real = 1) = a + b
             fn twice(a: real, b: real) = 2*total(a, b)
             fn hill(c: real, k: real, p: real = 2): real = c^p/(k^p + c^p)
             {}",
            car(use_)
        )
    };
    for right in [
        "total(x, L)",
        "total(v, top) + v",
        "twice(x, x) + x",
        "total(x) - L",
        "hill(x, L, 4)",
        "twice(free, v) + v",
    ] {
        assert_eq!(mistakes(&text(&format!("let e = {right}"))), [], "{right}");
    }
    let found = mistakes(&text("let e = twice(x, v)  let f = twice(x, v)  let g = total(x, v)"));
    assert_eq!(found.len(), 1, "the place in the function is told once: {found:#?}");
    let told: Vec<&str> = found[0].labels.iter().map(|label| label.text.as_str()).collect();
    assert_eq!(found[0].title, "m and m/s cannot be added");
    assert_eq!(told.iter().filter(|text| **text == "called here").count(), 2, "{told:?}");
    assert!(told.contains(&"`a` is in m in this call"), "{told:?}");
    for bad in ["total(x, L) + v", "hill(x, v)", "total(total(x, L), v)", "twice(x, 3) + v"] {
        assert_eq!(mistakes(&text(&format!("let e = {bad}"))).len(), 1, "{bad}");
    }
}

#[test]
fn one_mistake_gives_one_error() {
    let text = car(
        "let bad = x + v  let e = bad + x  let f = bad + v*bad  when e > v { x := bad  v := bad  top := e }",
    );
    // `e` is in m, because `x` is: comparing it with `v`, and keeping it in `top`, are mistakes of their own
    assert_eq!(mistakes(&text).len(), 3);
    assert_eq!(
        mistakes(&car("let bad = x + v  let e = bad*x + v  when bad > v and bad > x { x := bad  v := bad }"))
            .len(),
        1
    );
}

#[test]
fn both_dimensions_and_their_origins_are_told() {
    let found = mistakes(&car("when x + 10 [ft] > L/(3 [s]) { }"));
    let [error] = found.as_slice() else { panic!("{found:#?}") };
    assert_eq!(error.title, "m and m/s cannot be compared");
    let told: Vec<&str> = error.labels.iter().map(|label| label.text.as_str()).collect();
    let all =
        ["this is in m/s", "this is in m", "`x` is declared in m", "in m", "`L` is declared in km", "in s"];
    assert_eq!(told, all);
}

#[test]
fn calls_that_double_at_every_level_end() {
    let mut text = String::from("fn f0(a: real, b: real) = a + b\n");
    for k in 1..40 {
        text += &format!("fn f{k}(a: real, b: real) = f{0}(a*b, b) + f{0}(a, b*a*a)\n", k - 1);
    }
    text += "param p: real [m] = 1  param q: real [s] = 1  agent A { let e = f39(p, q) }";
    // far more products of m and s than there is time for: what is found, is found
    let found = Case::new(&text).model(&mut SourceMap::default());
    assert!(found.is_err_and(|found| found.iter().all(|error| error.code.starts_with("HY023"))));
}

#[test]
fn the_units_of_si_change_no_bit_of_a_run() {
    let model = |length: &str, mass: &str| {
        format!(
            "agent A(k: real = 0.1) {{
               state x: real {length} = 1/3, v: real = 0.7  discrete m: real {mass} = 0.3
               flow {{ x' = v  v' = -k*x/m }}
               up: when x <= 0 {{ m := m + 0.1 }}
             }}
             system {{ a = A() }} run {{ until 9  record a every 0.1 to \"a.csv\" }}"
        )
    };
    let bits = |text: &str| {
        let run = Case::new(text).run();
        let cells = run.samples[0].iter().flat_map(|sample| sample.cells.clone());
        cells.map(f64::to_bits).collect::<Vec<_>>()
    };
    let plain = bits(&model("", ""));
    assert_eq!(plain, bits(&model("[m]", "[kg]")));
    assert_eq!(plain, bits(&model("[N*m/N]", "[g*1/1*kg/g]")));
}

/// A fleet that reads a data file, parameters and literals in units that are not SI, and writes them again.
const FLEET: &str = "\
param v_max: real [km/h] = 100
param lamp: real [deg] = 30
agent Car(v: real [km/h], len: real [ft] = 15) {
  state x: real [km] = if index == 0 then 0.5 else 1, a: real [deg] = lamp
  discrete top: real [km/h] = v_max, age: real [min] = if v > 50 [km/h] then 7.3 else if v > 40 [km/h] then 3 else 0.1
  let rest: real [mph] = if v > 0 then 60.2 else 0
  let si = v
  flow { x' = v  a' = 0 }
  early: when time >= 0 { top := if v > 100 [km/h] then top else 119.7 }
}
system { cars = Car[] from csv(\"fleet.csv\") }
run { until 36 [s]  record cars, cars.v, cars.len, cars.rest, cars.si every 18 [s] to \"fleet_out.csv\" }
";

#[test]
fn a_bare_literal_a_csv_cell_a_p_value_and_an_output_column_are_in_the_declared_unit() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("fleet.hy"), FLEET).unwrap();
    fs::write(folder.path().join("fleet.csv"), "v,len\n50,14.9\n120.3,15.2\n").unwrap();
    let words = [
        "run",
        "fleet.hy",
        "--tolerance",
        "1e-12",
        "--final",
        "final.csv",
        "-p",
        "v_max=87.6",
        "-p",
        "lamp=33.3",
    ];
    let done =
        Command::new(env!("CARGO_BIN_EXE_hyc")).args(words).current_dir(folder.path()).output().unwrap();
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    let rows = |name: &str| -> Vec<Vec<String>> {
        let text = fs::read_to_string(folder.path().join(name)).unwrap();
        text.lines().map(|line| line.split(',').map(String::from).collect()).collect()
    };
    let out = rows("fleet_out.csv");
    // names only; their units are in the model
    assert_eq!(out[0], ["time", "micro", "agent", "mode", "v", "len", "x", "a", "top", "age", "rest", "si"]);
    let start = |row: usize| out[row][4..11].join(",");
    assert_eq!(start(1), "50,14.9,0.5,33.3,119.7,3,60.2");
    assert_eq!(start(2), "120.3,15.2,1,33.3,87.6,7.3,60.2");
    assert_eq!(out[1][11].parse::<f64>().unwrap(), 50.0 / 3.6, "a `let` without a unit is in SI");
    let last = rows("final.csv");
    assert_eq!(last[0], ["time", "agent", "mode", "x", "a", "top", "age"]);
    let x: Vec<f64> = last[1..].iter().map(|row| row[3].parse().unwrap()).collect();
    assert!((x[0] - 1.0).abs() < 1e-9 && (x[1] - 2.203).abs() < 1e-9, "{x:?}");
    assert_eq!(last[2][4..].join(","), "33.3,87.6,7.3");
}

/// A name that two types declare in different units; others that go together.
const TWO_UNITS: &str = "\
agent Plane { state x: real [km] = 1, v: real [m/s] = 200  discrete n = 1  flow { x' = v  v' = 0 } }
agent Truck { state x: real [m] = 5, v = 20  discrete n = 2  flow { x' = v  v' = 0 } }
system { plane = Plane()  truck = Truck() }
";

#[test]
fn a_column_has_one_unit() {
    let folder = tempfile::tempdir().unwrap();
    let hyc = |words: &[&str]| {
        let done = Command::new(env!("CARGO_BIN_EXE_hyc")).args(words).current_dir(folder.path()).output();
        let done = done.unwrap();
        (done.status.code(), String::from_utf8_lossy(&done.stderr).into_owned())
    };
    let model = |run: &str| fs::write(folder.path().join("way.hy"), format!("{TWO_UNITS}{run}")).unwrap();
    let read = |name: &str| fs::read_to_string(folder.path().join(name)).unwrap();
    // in one file they are refused, whatever does not belong there is
    for items in ["Plane.x, Truck.x", "plane, truck", "truck.v, Plane.v, truck.x, Plane"] {
        model(&format!("run {{ until 1  record {items} every 1 to \"way.csv\" }}"));
        for command in ["check", "run"] {
            let (code, told) = hyc(&[command, "way.hy"]);
            assert!(code == Some(1) && told.matches("error[HY0290]").count() == 1, "{items}: {told}");
            assert!(told.contains("two files") && !folder.path().join("way.csv").exists(), "{items}: {told}");
        }
    }
    // in two files each is in its own
    model(
        "run { until 1  record plane every 1 to \"plane.csv\"  record truck, Plane.n, plane.v every 1 to \"truck.csv\" }",
    );
    assert_eq!(hyc(&["run", "way.hy", "-q"]), (Some(0), String::new()));
    assert!(
        read("plane.csv").starts_with("time,micro,agent,mode,x,v,n\n0,0,plane,,1,200,1\n1,0,plane,,1.2,")
    );
    let truck = read("truck.csv");
    assert!(
        truck.starts_with("time,micro,agent,mode,v,n,x\n0,0,plane,,200,1,\n0,0,truck,,20,2,5\n"),
        "{truck}"
    );
    // where all is recorded each has a column
    model("run { until 1 }");
    let words = ["run", "way.hy", "-q", "--record", "all.csv", "--final", "last.csv", "--report", "way.html"];
    assert_eq!(hyc(&words), (Some(0), String::new()));
    let all = read("all.csv");
    let begin = "time,micro,agent,mode,Plane.x,v,n,Truck.x\n0,0,plane,,1,200,1,\n0,0,truck,,,20,2,5\n";
    assert!(all.starts_with(begin), "{all}");
    let last = read("last.csv");
    let [head, plane, truck] = last.lines().collect::<Vec<_>>()[..] else { panic!("{last}") };
    assert_eq!(head, "time,agent,mode,Plane.x,v,n,Truck.x");
    assert!(plane.starts_with("1,plane,,1.2") && plane.ends_with(",200,1,"), "{plane}");
    assert_eq!(truck, "1,truck,,,20,2,25");
    assert!(read("way.html").contains("\"x, km\"") && read("way.html").contains("\"x, m\""));
    assert_eq!(hyc(&["plot", "way.hy"]), (Some(0), String::new()));
    assert!(read("way.svg").contains("x, km") && read("way.svg").contains("x, m\n"));
}

#[test]
fn what_is_worked_out_from_bare_literals_alone_is_in_the_declared_unit() {
    let run = Case::new(
        "fn six(): real [km] = 5 + 1
         agent A(a: real [km] = 12/2, b: real [km] = if 1 < 2 then 2*3 else 0) {
           state p: real [km] = 2*3, q: real [km] = sqrt(36), r: real [km] = min(6, 7), s: real [km] = -(2 - 8)
           discrete t: real [km] = 2^2 + 2, u: real [km] = 2 [km] * 3, v: real [km] = six()
           flow { p' = 0  q' = 0  r' = 0  s' = 0 }
           set: when time >= 1 [s] { t := 3 + 4  r := 7*1 [km] } }
         system { a = A()  b = A(a = 3 + 3) }  run { until 2 [s] }",
    )
    .run();
    for name in ["p", "q", "s", "u", "v"] {
        assert_eq!(run.value(&format!("a.{name}")), 6.0, "{name}");
    }
    assert_eq!([run.value("a.t"), run.value("a.r")], [7.0, 7.0]);
}
