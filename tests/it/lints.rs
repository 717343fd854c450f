//! Do warnings point at what is odd, and at nothing else? Cases with snapshots in `errors/`, models that must be clean.

use std::fs;
use std::path::{Path, PathBuf};

use hyc::base::render::{Colours, render};
use hyc::base::{Diagnostic, SourceMap};
use hyc::model::{Files, Settings};
use hyc::{calculus, model, syntax};

use crate::harness::{Case, Ended, simulate_error};

/// Data files beside the model.
struct Beside(PathBuf);

impl Files for Beside {
    fn read(&mut self, path: &str) -> std::io::Result<Vec<u8>> {
        fs::read(self.0.join(path))
    }
}

/// The warnings about a model that must be right, as text.
#[track_caller]
fn warnings(name: &str, text: &str, folder: &Path, params: &[(&str, &str)]) -> String {
    let mut sources = SourceMap::default();
    let found = find(&mut sources, name, text, folder, params);
    assert!(found.iter().all(|warning| !warning.is_error()), "{found:?}");
    render(&sources, &found, Colours::None)
}

#[track_caller]
fn find(
    sources: &mut SourceMap,
    name: &str,
    text: &str,
    folder: &Path,
    params: &[(&str, &str)],
) -> Vec<Diagnostic> {
    let file = sources.add(name, text);
    let tree = syntax::parse(file, text)
        .unwrap_or_else(|problems| panic!("{}", render(sources, &problems, Colours::None)));
    let params = params.iter().map(|(name, value)| (name.to_string(), value.to_string())).collect();
    let settings = Settings { params, ..Settings::default() };
    let checked = model::check(&tree, sources, &mut Beside(folder.to_path_buf()), &settings);
    let problems = render(sources, &checked.diagnostics, Colours::None);
    let model = checked.model.unwrap_or_else(|| panic!("{name}: {problems}"));
    let mut found = checked.warnings;
    found.extend(calculus::lint(&calculus::derive(&model).unwrap()));
    found.sort_by_key(|warning| warning.labels.first().map(|label| label.span));
    found
}

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

/// The codes of the warnings about a model, in the order of the text.
#[track_caller]
fn codes(text: &str) -> Vec<&'static str> {
    let found = find(&mut SourceMap::default(), "model.hy", text, &root(), &[]);
    found.iter().map(|warning| warning.code).collect()
}

/// The `.hy` files of a folder by name, with their texts.
fn texts_in(folder: &Path) -> Vec<(String, String)> {
    let paths = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let mut paths: Vec<_> = paths.filter(|path| path.extension().is_some_and(|end| end == "hy")).collect();
    paths.sort();
    let name = |path: &PathBuf| path.file_name().unwrap().to_str().unwrap().to_string();
    paths.into_iter().map(|path| (name(&path), fs::read_to_string(&path).unwrap())).collect()
}

#[test]
fn no_shipped_model_has_a_warning() {
    let folder = root().join("models");
    let shipped = texts_in(&folder);
    assert!(shipped.len() >= 9);
    for (name, text) in shipped {
        assert_eq!(warnings(&name, &text, &folder, &[]), "", "{name}");
    }
    let bumper = fs::read_to_string(folder.join("bumper.hy")).unwrap();
    let params = [("N", "2"), ("data", "bumper_2.csv")];
    assert_eq!(warnings("bumper.hy", &bumper, &folder, &params), "");
}

#[test]
fn every_case_is_warned_of_as_its_snapshot_says() {
    let folder = root().join("tests/it/errors");
    for (name, text) in texts_in(&folder).into_iter().filter(|(name, _)| name.starts_with("HY06")) {
        let told = warnings(&name, &text, &folder, &[]);
        assert!(told.contains(&name[..6]), "{name} shows another code:\n{told}");
        insta::with_settings!({ snapshot_path => "errors", prepend_module_to_snapshot => false, omit_expression => true }, {
            insta::assert_snapshot!(name.replace(".hy", ""), told);
        });
    }
}

#[test]
fn a_name_that_says_so_may_be_unused() {
    let text = "param _a = 1  let _b = 2  fn _f(_x: real) = 3
        agent _T { state x = 0  flow { x' = 0 } }
        agent A(_p: real) {
          state x = 0
          discrete _d = 0
          link _l: A
          let _e = x
          flow { x' = 1 }
          some: when exists _o in other A: x >= 1 { x := 0 }
          initial mode M { }
          mode _N { }
        }
        interaction I(a: A, _b: A) { hit: when a.x >= 2 { a.x := 0 } }
        system { a = A[2](_p = 1) }
        run { until 1 }";
    assert_eq!(codes(text), [""; 0]);
    let bare = ["HY0601", "HY0601", "HY0601", "HY0601", "HY0603", "HY0601", "HY0602", "HY0601", "HY0601"];
    let bare = [&bare[..], &["HY0601", "HY0604", "HY0601"]].concat();
    assert_eq!(codes(&text.replace('_', "u")), bare);
}

#[test]
fn what_is_used_in_any_way_is_used() {
    let clean = [
        // by the data, by the population, by the run, by a priority, by an initial value
        "param n: int = 2  param d = 3
         agent A(rank: int) {
           state x = d
           discrete k: int = rank, seen = 0
           link next: A
           flow { x' = if next then next.x - x else 0 }
           jump: when x >= 4 priority rank { x := 0  k := k + 1  seen := time }
         }
         system { a = A[n](rank = index, next = if index >= 1 then a[index - 1] else none) }
         run { until 1  record a every 0.5 to \"a.csv\" }",
        // a library
        "param k = 1  fn f(x: real) = k*x  agent A(m: real) { state x = 0  discrete d = 0  let e = x  flow { x' = 1 } }",
        // an `exists` that only asks whether there is one; a witness that only the actions name
        "agent A { state x = 0, y = 0  flow { x' = 1  y' = 0 }
           any: when x >= 1 and (exists o in other A) { x := 0 }
           who: when x >= 2 and (exists o in other A: o.x <= 1) { y := o.y } }
         system { a = A[2](x = index) }",
        // participants that an interaction only moves
        "agent A { state x = 0  initial mode M { flow { x' = 1 } } mode N { flow { x' = 2 } } }
         interaction I(a: A, b: A) { go: when a.x >= 1 { b -> N } }
         system { a = A[2]() }",
    ];
    for text in clean {
        assert_eq!(codes(text), [""; 0], "{text}");
    }
}

#[test]
fn switches_are_no_dead_transitions() {
    let model = |guard: &str| {
        format!(
            "param noisy: bool = false  param n: int = 3  let idle = not noisy  let far = n > 5
             agent A {{ state x = if noisy or idle or far then n else 0  flow {{ x' = 1 }}
               t: when {guard} {{ x := 0 }} }}
             system {{ a = A() }}"
        )
    };
    for guard in ["noisy and x >= 1", "not idle and x >= 1", "far and x >= 1", "x >= 1 or n > 5", "false"] {
        assert_eq!(codes(&model(guard)), [""; 0], "{guard}");
    }
    for guard in ["n > 5 and x >= 1", "x >= 1 and n == 4", "inf < n and (x >= 1 or x <= 0)"] {
        assert_eq!(codes(&model(guard)), ["HY0605"], "{guard}");
    }
}

/// The warnings about one agent with these parts, with a car beside it.
#[track_caller]
fn of_agent(parts: &str) -> Vec<&'static str> {
    codes(&format!("agent A(p: real) {{ {parts} }}  system {{ a = A[2](p = index) }}"))
}

/// The same, with parameters of the file that are used elsewhere.
#[track_caller]
fn of_agent_with_params(parts: &str) -> Vec<&'static str> {
    codes(&format!(
        "param sure: bool = true  param cap = 2
         agent A(p: real) {{ {parts} }}  system {{ a = A[2](p = if sure then cap else index) }}"
    ))
}

/// The code with which a run of the agent with these parts ends, which must be in error.
#[track_caller]
fn end_of(parts: &str) -> &'static str {
    let text =
        format!("agent A(p: real) {{ {parts} }}  system {{ a = A[2](p = index) }}  run {{ until 10 }}");
    simulate_error(&text).1.code
}

#[test]
fn conditions_that_the_states_can_make_true_are_no_dead_ones() {
    let alive = [
        // an unknown state, an unknown parameter, time, an infinite constant as a switch
        "x >= 1",
        "p >= 5 and x >= 1",
        "p > 1",
        "time > 3",
        "x >= inf",
        "x^2 >= 4",
        "x*x - 2*x < 0",
        "x^3 < 0",
        // discrete variables that are given such a value, by whatever way
        "k >= 7",
        "lit",
        "not lit",
        "odd == 3",
        "odd != 0 and lit",
        // in a mode, or not
        "self is M",
        "exists o in other A: o is N",
        "exists o in A: o.k == 2 and o.x >= x + 1",
        // squares that are compared with something, regions that only look like points
        "(x - 1)^2 <= 0.01",
        "abs(x) > 0",
        "max(x, 0) <= 0",
        "x^2 <= p",
        "clamp(x, 0, 1) <= 0",
        "floor(x)^2 <= 0",
        "hypot(x, y) <= 1",
        "crossing(x)",
        "crossing(x^2 - 1)",
        "time <= 0",
        "rising(x >= 1)",
    ];
    for guard in alive {
        let parts = "state x = 0, y = 0
            discrete k: int = 0, lit: bool = false, odd: int = 0
            flow { x' = p  y' = 0 }
            step: every 1 { k := k + 2  odd := if lit then 3 else odd }
            light: when x >= 100 { lit := true }
            initial mode M { go: when y >= 1 -> N } mode N { }";
        assert_eq!(of_agent(&format!("{parts} t: when {guard} {{ x := 0 }}")), [""; 0], "{guard}");
    }
}

#[test]
fn a_discrete_variable_that_data_or_chance_starts_may_have_any_value() {
    let model = |start: &str, made: &str| {
        format!(
            "agent A {{ state x = 0  discrete k = {start}  flow {{ x' = 1 }}
               t: when k >= 2 and x >= 1 {{ x := 0 }} }}
             system {{ {made} }}"
        )
    };
    assert_eq!(codes(&model("1", "a = A()")), ["HY0605"]);
    assert_eq!(codes(&model("1", "a = A()  b = A(k = 1)")), [""; 0]);
    assert_eq!(codes(&model("index", "a = A[2]()")), [""; 0]);
    assert_eq!(codes(&model("1", "a = A(k ~ Uniform(0, 1))")), [""; 0]);
}

#[test]
fn transitions_that_get_their_turn_are_not_hidden() {
    let modes = |first: &str, second: &str| {
        format!(
            "state x = 0, y = 0  flow {{ x' = 1  y' = p }}
             initial mode M {{ {first} {second} }} mode N {{ back: when y >= 9 -> M }} mode O {{ }}
             out: when y >= 20 -> O  in_: when y >= 30 -> N"
        )
    };
    let hidden = [
        ("a: when x >= 1 -> N", "b: when x >= 1 -> O"),
        ("a: when x >= 1 -> N", "b: when x >= 1 { x := 0 }"),
        ("b: when x >= 1 -> O", "a: when x >= 1 priority 1 -> N"),
        ("a: when x^2 >= 0 -> N", "b: when y >= 1 -> O"),
        ("a: when true -> N", "b: after 3 -> O"),
        ("a: when exists o in other A: o.x >= 1 -> N", "b: when exists o in other A:  o.x >= 1 -> O"),
    ];
    for (first, second) in hidden {
        assert_eq!(of_agent_with_params(&modes(first, second)), ["HY0606"], "{first} {second}");
    }
    let seen = [
        ("a: when x >= 1 -> N", "b: when x > 1 -> O"),
        ("a: when x >= 1 -> N", "b: when x >= 1 and y >= 1 priority 1 -> O"),
        ("a: when x >= 1 { y := 0 }", "b: when x >= 1 -> O"),
        ("a: when x >= 1 and y >= 1 -> N", "b: when x >= 1 -> O"),
        ("a: after 1 when x >= 1 -> N", "b: when x >= 1 -> O"),
        ("a: when x >= 1 priority y -> N", "b: when x >= 1 priority 1 -> O"),
        ("b: when y >= 1 -> O", "a: when true -> N"),
        ("a: when x >= 1 and sure -> N", "b: when x >= 1 -> O"),
        ("a: when x >= cap -> N", "b: when x >= 2 -> O"),
    ];
    for (first, second) in seen {
        assert_eq!(of_agent_with_params(&modes(first, second)), [""; 0], "{first} {second}");
    }
}

#[test]
fn transitions_into_their_own_mode_fire_again_only_if_their_condition_is_still_true() {
    let modes = |transition: &str| {
        format!(
            "state x = 0, y = 0  discrete n: int = 0, next = 1  flow {{ x' = 1  y' = p }}
             initial mode M {{ {transition} }}  mode N {{ entry {{ x := 0 }}  go: when y >= 1 + next + n -> M }}
             out: when y >= 20 -> N"
        )
    };
    let again = [
        "t: when x >= 1 -> M",
        "t: when x >= 1 -> M { n := n + 1 }",
        "t: when x >= 1 -> M { x := x + 1 }",
        "t: when x >= 1 -> M { x := 2*x }",
        "t: when x >= 1 and x <= 5 -> M { x := 3 }",
        "t: when x >= 1 or x <= -1 -> M { n := 1 }",
        "t: when x >= 1 -> M { n := n + 1 }  later: when n >= 5 -> N",
        "far: when x >= 5 -> N  t: when x <= 1 -> M { x := x - 1 }",
        "t: when time >= 3 -> M { x := 0 }",
    ];
    for transition in again {
        assert_eq!(of_agent(&modes(transition)), ["HY0607"], "{transition}");
        assert_eq!(end_of(&modes(transition)), "HY0505", "{transition}");
    }
    let once = [
        "t: when x >= 1 -> M { x := 0 }",
        "t: when x >= 1 -> M { x := x - 1 }",
        "t: when x >= 1 -> M { x := y }",
        "t: when x >= 1 -> M { if y >= 1 { x := 0 } }",
        "t: when x >= 1 -> M { stop }",
        "t: when x >= 1 -> N",
        "t: when x >= 1 { n := n + 1 }",
        "t: when rising(x >= 1) -> M",
        "t: when crossing(x - 1) -> M",
        "t: when exists o in other A: o.x >= 2 -> M",
        "t: after 1 when x >= 1 -> M",
        "t: every 1 when x >= 1 -> M",
        "t: when time >= next -> M { next := next + 1 }",
        "first: when n >= 5 -> N  t: when x >= 1 -> M { n := n + 1 }",
        "t: when x >= 1 -> M { n := n + 1 }  first: when n >= 5 priority 1 -> N",
        "t: when x >= 1 and n <= 3 -> M { n := n + 1 }",
        "t: when x >= 1 -> M { x := -x }",
        "exit { x := 0 }  t: when x >= 1 -> M",
    ];
    for transition in once {
        assert_eq!(of_agent(&modes(transition)), [""; 0], "{transition}");
    }
}

#[test]
fn opposite_conditions_are_told_from_those_that_only_look_so() {
    let modes = |[rate, there]: [&str; 2], [rate_back, back]: [&str; 2]| {
        format!(
            "state x = 0, y = 0  discrete n: int = 0
             initial mode M {{ flow {{ x' = {rate}  y' = p }}  a: when {there} -> N }}
             mode N {{ flow {{ x' = {rate_back}  y' = p }}  b: when {back} -> M }}
             mark: every 5 {{ n := n + 1 }}"
        )
    };
    let both = [
        (["1", "x >= 1"], ["-1", "x <= 2"]),
        (["1", "x > 1"], ["1", "2*x < 3"]),
        (["1", "x - y >= 1"], ["1", "y - x >= -2"]),
        (["1", "x >= 1 or y >= 3"], ["1", "x <= 1.5"]),
        (["1", "exists o in other A: (o.x - x)^2 <= 4"], ["1", "forall o in other A: (x - o.x)^2 >= 1"]),
        (["1", "hypot(x, y) <= 4"], ["1", "hypot(x, y) >= 3"]),
    ];
    for (there, back) in both {
        assert_eq!(of_agent(&modes(there, back)), ["HY0609"], "{there:?} {back:?}");
    }
    for (there, back) in &both[..4] {
        assert_eq!(end_of(&modes(*there, *back)), "HY0505", "{there:?} {back:?}");
    }
    let chattering = [
        (["1", "x >= 1"], ["-1", "x <= 1"]),
        (["2 - x", "x >= 1"], ["-x", "1 >= x"]),
        (["p + 1", "x > 1"], ["-1 - p", "x < 1"]),
        (["3", "2*x - 2 >= 0 or y >= 3"], ["-1 - exp(y)", "x <= 1"]),
        (["cos(y) + 3", "x - time >= 1"], ["-2", "x - time <= 1"]),
    ];
    for (there, back) in chattering {
        assert_eq!(of_agent(&modes(there, back)), ["HY0610"], "{there:?} {back:?}");
        assert_eq!(end_of(&modes(there, back)), "HY0505", "{there:?} {back:?}");
    }
    let fine = [
        // a gap
        (["1", "x >= 2"], ["-1", "x <= 1"]),
        // the flow goes on through the boundary, or may
        (["1", "x >= 1"], ["1", "x <= 1"]),
        (["1", "x >= 1"], ["y", "x <= 1"]),
        (["-y", "x >= 1"], ["-1", "x <= 1"]),
        (["p", "x >= 1"], ["-p", "x <= 1"]),
        (["0", "x >= 1"], ["-1", "x <= 1"]),
        // not of one quantity, or not alone
        (["1", "x >= 1"], ["-1", "y <= 1"]),
        (["1", "x >= 1"], ["-1", "x <= 2 and y >= 1"]),
        (["1", "x >= 1 + y"], ["-1", "x <= 1 - y"]),
        (["1", "forall o in other A: o.x >= 1"], ["1", "forall o in other A: o.x <= 2"]),
        (["1", "exists o in other A: o.x >= 1"], ["-1", "x <= 2"]),
        // one of them changes what is asked, or waits
        (["1", "x >= 1 -> N { x := 5 } t: when y >= 30"], ["-1", "x <= 2"]),
        (["1", "x >= 1"], ["-1", "rising(x <= 2)"]),
    ];
    for (there, back) in fine {
        assert_eq!(of_agent(&modes(there, back)), [""; 0], "{there:?} {back:?}");
    }
    let counted = modes(["1", "x >= 1"], ["-1", "x <= 2 -> M { n := n + 1 }  c: when y >= 9"]);
    assert_eq!(of_agent(&counted), ["HY0609"]);
    let led_out = counted.replace("initial mode M {", "out: when n >= 3 { x := 9 } initial mode M {");
    assert_eq!(of_agent(&led_out), [""; 0]);
}

#[test]
fn a_quantifier_without_other_is_fine_where_oneself_does_not_settle_it() {
    let asked = [
        ("exists o in A: abs(o.x - x) <= 1", true),
        ("exists o in A where o.p == p: o.x >= x", true),
        ("forall o in A: (o.x - x)^2 + (o.y - y)^2 >= 1", true),
        ("not (exists o in A: hypot(o.x - x, o.y - y) <= 1)", true),
        ("x >= 1 and (exists o in A: o.x <= x + 1)", true),
        ("exists o in other A: abs(o.x - x) <= 1", false),
        ("exists o in A: o.x >= x + 1", false),
        ("exists o in A where o.x > x: o.x - x <= 1", false),
        ("exists o in A: o.x >= 3", false),
        ("forall o in A: o.x <= x", false),
        ("exists o in A: o.x - x <= p", false),
        ("exists o in B: abs(o.z - x) <= 1", false),
    ];
    for (guard, settled) in asked {
        let text = format!(
            "agent B {{ state z = 0  flow {{ z' = 1 }} }}
             agent A(p: real) {{ state x = 0, y = 0  flow {{ x' = p  y' = 1 }}  t: when {guard} {{ x := 0 }} }}
             system {{ a = A[2](p = index)  b = B() }}"
        );
        let expected: &[&str] = if settled { &["HY0611"] } else { &[] };
        assert_eq!(codes(&text), expected, "{guard}");
    }
    assert_eq!(of_agent("state x = p  flow { x' = 1 }  assert forall o in A: abs(o.x - x) >= 1"), ["HY0611"]);
}

#[test]
fn many_pairs_that_no_distance_prunes_are_told() {
    let text = |n: usize, own: &str, guard: &str| {
        format!(
            "agent A(p: real) {{ state x = index, v = p  flow {{ x' = v  v' = 0 }} {own} }}
             agent B {{ state z = 0  flow {{ z' = 1 }} }}
             interaction I(a: A, b: A) {{ t: when {guard} {{ a.v := b.v }} }}
             system {{ a = A[{n}](p = index)  b = B() }}"
        )
    };
    let (near, far) = ("abs(a.x - b.x) <= 1 and a.v > b.v", "a.v > b.v");
    assert_eq!(codes(&text(320, "", far)), ["HY0614"], "102 080 pairs");
    assert_eq!(codes(&text(310, "", far)), [""; 0], "95 790 pairs");
    let once = "interaction I(a: A, b: A) { t: when a.x + b.x < 1 { a.v := 0  b.v := 0 } }";
    let once = |n: usize| text(n, "", near).replace("interaction I", &format!("{once} interaction J"));
    assert_eq!(codes(&once(440)), [""; 0], "96 580 pairs in either order");
    assert_eq!(codes(&once(460)), ["HY0614"], "105 570 pairs in either order");
    let cases = [
        ("", near, false),
        ("", "a.x < b.x and a.x + 1 > b.x", false),
        ("", "abs(a.x - b.x) <= 1 or a.v > 3", true),
        // never true, which is told as such
        ("", "a.x*a.x + b.x*b.x < -1 - a.p^2", false),
        ("u: when exists o in other A: o.v > v { v := 0 }", near, true),
        ("u: when exists o in other A: o.v > v and abs(o.x - x) < 2 { v := 0 }", near, false),
        ("u: when forall o in other A: abs(o.x - x) > 2 { v := 0 }", near, false),
        ("u: when exists o in B: o.z > x { v := 0 }", near, false),
        ("assert forall o in other A: o.v + v >= 0", near, true),
        ("assert forall o in other A: abs(o.x - x) >= 0.5", near, false),
        ("link l = nearest o in other A by abs(o.x - x)", near, false),
        ("link l = nearest o in other A where o.p == p and o.x > x by o.x - x", near, false),
        ("link l = nearest o in other A by o.v", near, true),
    ];
    for (own, guard, warned) in cases {
        assert_eq!(codes(&text(400, own, guard)).contains(&"HY0614"), warned, "{own} {guard}");
    }
}

#[test]
fn what_an_outer_mode_does_first_its_inner_modes_never_do() {
    let model = |outer: &str, inner: &str| {
        format!(
            "agent A {{ state x = 0  flow {{ x' = 1 }}
               initial mode Out {{ {outer} -> Off
                 initial mode In {{ {inner} -> Else }}
                 mode Else {{ after 1 -> In }} }}
               mode Off {{ after 1 -> Out }} }}
             system {{ a = A() }}  run {{ until 5 }}"
        )
    };
    assert_eq!(codes(&model("when x >= 1", "when x >= 1")), ["HY0606"]);
    assert_eq!(codes(&model("when x >= 1", "when x >= 1 priority 1")), [""; 0]);
    assert_eq!(codes(&model("when x >= 1", "when x >= 2")), [""; 0]);
    assert_eq!(codes(&model("when x^2 >= -1", "when x >= 2")), ["HY0606"; 2]);
    assert_eq!(codes(&model("after 1 when x >= 1", "when x >= 1")), [""; 0]);
}

#[test]
fn a_transition_into_a_mode_inside_does_not_lead_out() {
    let text = "agent A { state x = 0  flow { x' = 1 }
           initial mode Out { down: when x >= 1 -> Deep { x := 0 }
             initial mode In { also: when x >= 1 priority 1 { x := x - 0.5 } }
             mode Deep { later: when x >= 1 { x := 0.25 } } } }
         system { a = A() }  run { until 5 }";
    assert_eq!(codes(text), [""; 0]);
}

#[test]
fn a_composite_mode_that_leads_back_into_itself_is_seen_through_its_inner_modes() {
    let model = |inner: &str| {
        format!(
            "agent A {{ state x = 0  flow {{ x' = 1 }}
               initial mode Out {{ again: when x >= 1 -> Out  initial mode In {{ {inner} }} }} }}
             system {{ a = A() }}  run {{ until 5 }}"
        )
    };
    assert_eq!(codes(&model("")), ["HY0607"]);
    assert_eq!(codes(&model("entry { x := 0 }")), [""; 0]);
    assert_eq!(codes(&model("exit { if x >= 1 { x := 0 } }")), [""; 0]);
}

#[test]
fn of_modes_inside_one_that_is_entered_each_is_looked_at() {
    let text = "agent A { initial mode Out { initial mode In { after 1 -> Off }  mode Never { mode Deep { } initial mode Too { } } }
           mode Off { after 1 -> Out.history } }
         system { a = A() }  run { until 5 }";
    assert_eq!(codes(text), ["HY0604"]);
}

/// Rule 3: on its boundary a guard is held by rates that lead out.
#[test]
fn a_reset_onto_the_boundary_does_not_fire_again() {
    let text = "agent A { state x = 6  initial mode M { flow { x' = -1 }  a: when x >= 5 -> M { x := 5 } } }
                system { a = A() }  run { until 2 }";
    assert!(codes(text).is_empty());
    assert_eq!(crate::harness::simulate(text).times("A.a"), [0.0]);
}

/// The warnings about one agent with these parts, and the error with which its run ends, if it does.
#[track_caller]
fn told_and_met(parts: &str) -> (Vec<&'static str>, Option<&'static str>) {
    let text = format!("agent A(p: real) {{ {parts} }}  system {{ a = A(p = 0.5) }}  run {{ until 10 }}");
    let met = match Case::new(&text).run_any().end {
        Ended::Error(error) => Some(error.code),
        _ => None,
    };
    let told = codes(&text).into_iter().filter(|code| ["HY0626", "HY0627"].contains(code)).collect();
    (told, met)
}

#[test]
fn invariants_that_break_at_once_are_told_where_runs_meet_them() {
    let broken = [
        // at the start: on the boundary, beyond it, one of two, by a parameter of the agent
        "state x = 1  invariant x <= 1  flow { x' = 1 }",
        "state x = 2  invariant x <= 1  flow { x' = 1 }",
        "state x = 0, y = 1  invariant x >= 0 and y > 0  flow { x' = -2  y' = 1 }",
        "state x = p  invariant 2*x <= 1  flow { x' = p }",
        "state x = 0  invariant x <= 0  flow { x' = 1 }  later: when x >= 1 { x := 0 }",
        // behind a transition, by what it asks, or by what it writes
        "state x = 0  initial mode M { flow { x' = 1 }  out: when x >= 1 -> N }
         mode N { invariant x <= 1  flow { x' = x } }",
        "state x = 0, y = 0  initial mode M { flow { x' = 1  y' = 1 }  out: when x + y >= 1 -> N }
         mode N { invariant x + y <= 1  flow { x' = 1  y' = 0 } }",
        "state x = 0, v = 0  initial mode M { flow { x' = 1  v' = 0 }  out: when x >= 1 -> N { v := 2  x := 1 } }
         mode N { invariant v <= 2  flow { x' = 0  v' = x^2 } }",
        "state x = 0  invariant x <= 1  flow { x' = 1 }  full: when x >= 1",
        "state x = 0  invariant x <= 1  initial mode M { flow { x' = 1 }  mode K { }  initial mode L { go: after 1 when x >= 1 -> N } }
         mode N { flow { x' = 2 }  back: after 5 -> M }",
    ];
    for parts in broken {
        let (told, met) = told_and_met(parts);
        assert!(told.contains(&"HY0626"), "{parts}: {told:?}");
        assert_eq!(met, Some("HY0501"), "{parts}");
    }
    let fine = [
        // the flow leads in, or along, or is not known; the way out is open
        "state x = 1  invariant x <= 1  flow { x' = -1 }",
        "state x = 1  invariant x <= 1  flow { x' = 0 }",
        "state x = 1  invariant x <= 1  flow { x' = sin(time) - 1 }",
        "state x = 1  invariant x <= 1  initial mode M { flow { x' = 1 }  out: when x >= 1 -> N }  mode N { flow { x' = -1 } }",
        "state x = 0  initial mode M { flow { x' = 1 }  out: when x >= 1 -> N { x := 0 } }
         mode N { invariant x <= 1  flow { x' = -x } }",
        // set right on entry
        "state x = 2  invariant x <= 1  entry { x := 0 }  flow { x' = -1 }",
    ];
    for parts in fine {
        let (told, met) = told_and_met(parts);
        assert!(!told.contains(&"HY0626"), "{parts}: {told:?}");
        assert_eq!(met, None, "{parts}");
    }
}

#[test]
fn zeno_behaviour_is_told_where_runs_meet_it() {
    let tanks = |inflow: f64| {
        format!(
            "state a = 1, b = 1  initial mode M {{ flow {{ a' = {inflow} - 1  b' = -1 }}  to_b: when b <= 0 -> N }}
             mode N {{ flow {{ a' = -1  b' = {inflow} - 1 }}  to_a: when a <= 0 -> M }}"
        )
    };
    let met_by_a_run = [
        "state x = 1, v = 0  flow { x' = v  v' = -9.81 }  bounce: when x <= 0 { v := -0.5*v }".to_string(),
        "state x = 1, v = 0  flow { x' = v  v' = -9.81 }  bounce: when x <= 0 { v := -p*v }".to_string(),
        "state x = 0, v = 1  flow { x' = v  v' = 3 }  bounce: when 1 <= x and v > 0 { v := -0.3*v  x := 1 }"
            .to_string(),
        "discrete d: real = 2  initial mode M { again: after d/2 -> M { d := p*d } }".to_string(),
        tanks(1.5),
    ];
    for parts in &met_by_a_run {
        let (told, met) = told_and_met(parts);
        assert_eq!(told, ["HY0627"], "{parts}");
        // The tanks are both empty at an instant that rounding decides.
        assert!(met == Some("HY0506") || parts.contains("to_a") && met == Some("HY0505"), "{parts}: {met:?}");
    }
    let not_met = [
        // over before, elastic, let go, kicked, not pushed, slow ones do not bounce
        "state x = 100, v = 0  flow { x' = v  v' = -2 }  bounce: when x <= 0 { v := -0.5*v }".to_string(),
        "state x = 1, v = 0  flow { x' = v  v' = -1 }  bounce: when x <= 0 { v := -v }".to_string(),
        "state x = 1, v = 0  initial mode M { flow { x' = v  v' = -9.81 }
         rest: when x <= 0 and v >= -0.1 -> N { x := 0  v := 0 }  bounce: when x <= 0 { v := -0.5*v } }
         mode N { flow { x' = 0  v' = 0 } }".to_string(),
        "state x = 1, v = 0  flow { x' = v  v' = -9.81 }  bounce: when x <= 0 { v := -0.5*v }  kick: every 1 { v := v + 9 }".to_string(),
        "state x = 1, v = -1  flow { x' = v  v' = 0 }  bounce: when x <= 0 { v := -0.5*v }".to_string(),
        "discrete d: real = 1  initial mode M { again: after d -> M { d := max(0.5*d, 0.1) } }".to_string(),
        tanks(1.9),
    ];
    for parts in &not_met {
        let (told, met) = told_and_met(parts);
        assert!(!told.contains(&"HY0627"), "{parts}: {told:?}");
        assert_eq!(met, None, "{parts}");
    }
}

/// Checks that runs of these models end well, and that neither of the two warnings is given.
#[track_caller]
fn are_fine(texts: &[&str]) {
    for text in texts {
        let end = Case::new(text).run_any().end;
        assert!(!matches!(end, Ended::Error(_)), "{text}: {end:?}");
        let told: Vec<_> =
            codes(text).into_iter().filter(|code| ["HY0626", "HY0627"].contains(code)).collect();
        assert_eq!(told, [""; 0], "{text}");
    }
}

#[test]
fn invariants_that_something_saves_at_the_last_instant_are_not_told() {
    are_fine(&[
        // what is due, what an entry, an exit or an `if` may write, what a write makes rise or cross, what is on its boundary and
        // moves in, whom others destroy, where a reset may have led, who is born otherwise
        "agent A { state x = 0 discrete n: int = 0 invariant x <= 1 flow { x' = 1 } full: when x >= 1 { n := n + 1 } tick: every 1 { x := 0 } } system { a = A() } run { until 5.5 }",
        "agent A { state x = 0 discrete n: int = 0 initial mode M { invariant x <= 1 flow { x' = 1 } full: when x >= 1 { n := 1 } out: after 1 -> N } mode N { flow { x' = -1 } } } system { a = A() } run { until 5 }",
        "agent A { state x = 0, y = -1 initial mode M { invariant x <= 1 flow { x' = 1 y' = 0 } full: when x >= 1 { y := 1 } out: when crossing(y) -> N } mode N { flow { x' = -1 y' = 0 } } } system { a = A() } run { until 5 }",
        "agent A { state x = 0, y = -1 initial mode M { invariant x <= 1 flow { x' = 1 y' = 0 } full: when x >= 1 { y := 1 } out: when rising(y > 0) -> N } mode N { flow { x' = -1 y' = 0 } } } system { a = A() } run { until 5 }",
        "agent A { state x = 0 discrete y: int = 0 initial mode M { invariant x <= 0 entry { y := 1 } flow { x' = 1 } out: when y == 1 -> N } mode N { flow { x' = -1 } } } system { a = A() } run { until 5 }",
        "agent A { state x = 0, y = 0 initial mode M { flow { x' = 1 y' = 0 } out: when x >= 1 and y <= 0 -> N } mode N { invariant x <= 1 entry { y := 1 } flow { x' = 1 y' = 0 } skip: when y >= 1 -> P } mode P { flow { x' = -1 y' = 0 } } } system { a = A() } run { until 5 }",
        "agent A(p: real) { state x = 0, y = 0 initial mode M { flow { x' = 1 y' = 0 } out: when x >= 1 and y <= 0 -> N { if p > 0 { y := 1 } } } mode N { invariant x <= 1 flow { x' = 1 y' = 0 } skip: when y >= 1 -> P } mode P { flow { x' = -1 y' = 0 } } } system { a = A(p = 1) } run { until 5 }",
        "agent Tank { state level = 0 initial mode Filling { flow { level' = 1 } full: when level >= 5 -> Full } mode Full { invariant level <= 5 flow { level' = 1 } } } agent Guard { sell: when exists t in Tank: t.level >= 5 { destroy t } } system { tank = Tank() g = Guard() } run { until 20 }",
        "agent A(p: real) { state x = 0 initial mode M { flow { x' = 1 } out: when x >= 1 and p < 0 -> N } mode N { invariant x <= 1 flow { x' = p } } } agent S { make: after 1 { create A(p = -1) } } system { a = A(p = 1) s = S() } run { until 5 }",
        "agent A { state x = 0 discrete d: real = 1 initial mode M { invariant x <= 0 entry { d := 0 } flow { x' = 1 } out: after d -> N } mode N { flow { x' = -1 } } } system { a = A() } run { until 5 }",
        "agent A { state x = 0 initial mode M { invariant x <= 1 flow { x' = 1 } out: when x >= 1 -> N { x := 1 } } mode N { invariant x <= 1 flow { x' = 1 } skip: when x > 1 -> P } mode P { flow { x' = -1 } } } system { a = A() } run { until 5 }",
        "agent A { state x = 0 initial mode M { flow { x' = 1 } out: when x >= 1 -> N } mode N { invariant x < 1 flow { x' = -1 } back: when x <= 0.5 -> M } } system { a = A() } run { until 5 }",
        "agent A { state x = 0, y = 0 initial mode M { flow { x' = 0 y' = 0 } jump: after 1 { x := 5 } out: when crossing(x - 1) -> N { y := x } } mode N { invariant y >= 1 flow { x' = 0 y' = -1 } back: after 2 -> P } mode P { flow { x' = 0 y' = 0 } } } system { a = A() } run { until 10 }",
    ]);
}

#[test]
fn zeno_behaviour_that_something_may_prevent_is_not_told() {
    are_fine(&[
        // a start on the floor, ways out on the way, conditions that end, pushes that fade or turn, draws, who ends the run
        "agent B { state x = 1, v = 0 initial mode F { flow { x' = v v' = -9.81 } bounce: when x <= 0 { v := -0.8*v } rest: when v > 0 and v < 0.1 and x <= 0.001 -> R } mode R { flow { x' = 0 v' = 0 } } } system { b = B() } run { until 10 }",
        "agent B { state x = 1, v = 0, s = 0 flow { x' = v v' = -9.81 s' = 1 } bounce: when x <= 0 and s <= 1 { v := -0.8*v } } system { b = B() } run { until 10 }",
        "agent B { state x = 1, v = 10 flow { x' = v v' = -1/(1 + x)^2 } bounce: when x <= 0 { v := -0.5*v } } system { b = B() } run { until 100 }",
        "agent B { state x = 1, v = 10 initial mode F { flow { x' = v v' = -9.81 } bounce: when x <= 0 { v := -0.8*v } away: when x >= 3 -> R } mode R { flow { x' = 0 v' = 0 } } } system { b = B() } run { until 100 }",
        "agent B { state x = 1, v = 0 flow { x' = v v' = -9.81 } bounce: when x <= 0 { v := -0.8*v x ~ Uniform(1, 2) } } system { b = B() } run { until 10 }",
        "agent B { state x = 1, v = 0 flow { x' = v v' = -9.81 } bounce: when x <= 0 and time < 1 { v := -0.8*v } } system { b = B() } run { until 10 }",
        "agent B { state x = 0, v = 0 flow { x' = v v' = -9.81 } bounce: when x <= 0 { v := -0.8*v } } system { b = B() } run { until 10 }",
        "agent B { state x = 0, v = 3 flow { x' = v v' = -9.81 } bounce: when x <= 0 { v := -0.8*v } } system { b = B() } run { until 10 }",
        "agent B { state x = 1, v = 0 flow { x' = v v' = -9.81 } bounce: when x <= 0 { v := -0.8*v } } agent K { done: when time >= 1 { stop } } system { b = B() k = K() } run { until 10 }",
        "agent B { state x = 1, v = 0 flow { x' = v v' = -9.81 } bounce: when x <= 0 { v := -0.8*v } } agent K { done: when exists b in B: time >= 1 and b.x < 10 { destroy b } } system { b = B() k = K() } run { until 10 }",
        "agent B { state x = 1, v = 1 flow { x' = v v' = -1 + 0.9*x } bounce: when x <= 0 { v := -0.5*v } } system { b = B() } run { until 12 }",
    ]);
}
