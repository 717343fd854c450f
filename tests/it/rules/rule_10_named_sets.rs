//! Rules 10 and 13: quantifiers over a name of `system` range over those whom it names, and nobody else.

use crate::harness::{Case, all_near, near, simulate, simulate_to_the_end};

/// Two kinds of posts of one type; a walker counts and measures.
const POSTS: &str = "\
agent Post(k: real) { state x = k  flow { x' = 0 } }
";

#[test]
fn rule_10_every_quantifier_ranges_over_a_name_of_the_system() {
    let run = simulate_to_the_end(&format!(
        "{POSTS}agent Walker {{
           state x = 0
           discrete met: int = 0, n: int = 0, s = 0, least = 0, most = 0, ahead = 0
           flow {{ x' = 1 }}
           link lead = nearest p in poles where p.x > x by p.x - x
           pass: when exists p in poles: x >= p.x {{ met := met + 1  s := p.x }}
           far: when forall p in poles: x >= p.x {{
             n := count p in poles where p.x < 6
             s := sum p in poles: p.x
             least := min p in poles: p.x
             most := max p in poles: p.x
           }}
           see: after 3.5 {{ ahead := lead.x }}
           last: when not (exists p in only: x < p.x) {{ ahead := ahead + 100 }}
         }}
         system {{
           before = Post[3](k = 0.5*index)
           poles = Post[2](k = 5 + index)
           only = Post(k = 8)
           walker = Walker()
         }}
         run {{ until 10 }}"
    ));
    assert_eq!(
        run.log(),
        ["0 Walker.see walker", "0 Walker.pass walker", "0 Walker.far walker", "0 Walker.last walker"]
    );
    all_near(&run.event_times(), &[3.5, 5.0, 6.0, 8.0], 1e-12);
    let values = ["met", "n", "s", "least", "most", "ahead"].map(|name| run.value(&format!("walker.{name}")));
    all_near(&values, &[1.0, 1.0, 11.0, 5.0, 6.0, 105.0], 1e-12);
}

#[test]
fn rule_10_other_leaves_out_the_agent_that_asks_and_those_who_are_created_belong_to_no_name() {
    let run = simulate_to_the_end(
        "agent A {
           state x = 0
           discrete n: int = 0, m: int = 0, all: int = 0
           flow { x' = 1 }
           count_: when x >= 1 { n := count o in other ones  m := count o in ones  all := count o in A }
         }
         agent Maker { at: after 0.5 { create A() } }
         system { ones = A[2]()  more = A[3]()  maker = Maker() }
         run { until 3 }",
    );
    for (agent, n) in [("ones[0]", 1.0), ("more[2]", 2.0), ("A#6", 2.0)] {
        near(run.value(&format!("{agent}.n")), n, 0.0);
        near(run.value(&format!("{agent}.m")), 2.0, 0.0);
        near(run.value(&format!("{agent}.all")), 6.0, 0.0);
    }
}

#[test]
fn rule_10_near_pairs_of_a_named_set_are_found_and_no_others() {
    // many cars, of which few are looked for: candidate lists hold others, too
    let run = simulate_to_the_end(
        "agent Car(v: real) {
           state x = 0, y = 0
           discrete met: int = 0
           flow { x' = v  y' = 0 }
           near_: when exists o in police: (o.x - x)^2 + (o.y - y)^2 <= 0.25 { met := met + 1 }
         }
         system {
           cars = Car[40](v = 1, x = -2*index)
           police = Car[2](v = -1, x = 30 + 10*index)
         }
         run { until 30 }",
    );
    // police 0 meets car k when 30 + 2 k - 2 t = 0.5; each of the police meets every car once, and sees itself at once
    let times = run.times_of("Car.near_", "cars[3]");
    all_near(&times, &[(36.0 - 0.5) / 2.0, (46.0 - 0.5) / 2.0], 1e-9);
    near(run.value("cars[0].met"), 2.0, 0.0);
    near(run.value("police[1].met"), 1.0, 0.0);
}

#[test]
fn rule_13_a_named_set_in_a_flow_couples_those_whom_it_names() {
    let text = "agent Post { state x = 1  flow { x' = 0.5*x } }
         agent Car {
           state x = 0
           flow { x' = sum p in poles: p.x }
         }
         system { others = Post[300](x = 7)  poles = Post[2](x = 1 + index)  car = Car() }
         run { until 1 }";
    let run = simulate_to_the_end(text);
    near(run.value("car.x"), 6.0 * (0.5_f64.exp() - 1.0), 1e-5);
    let sets = &Case::new(text).system().1.types[1].sets;
    let sets: Vec<(usize, usize)> = sets.iter().map(|set| (set.ty, set.links.len())).collect();
    assert_eq!(sets, [(0, 2)], "300 others are too many, and are not read");
}

#[test]
fn rule_13_a_named_set_may_be_read_though_others_of_its_type_are_created() {
    let run = simulate_to_the_end(
        "agent Post { state x = 1  flow { x' = 1 } }
         agent Car { state x = 0  flow { x' = sum p in poles: p.x } }
         agent Maker { every 0.25 { create Post() } }
         system { poles = Post[2]()  car = Car()  maker = Maker() }
         run { until 1 }",
    );
    near(run.value("car.x"), 3.0, 1e-9);
}

#[test]
fn rule_10_properties_and_interactions_range_over_names_too() {
    let run = simulate(
        "agent A { state x = 0  discrete hits: int = 0  flow { x' = 1 } }
         interaction Touch(a: A, b: A) {
           touch: when a.x >= 1 and b.x >= 1 and exists o in judges: o.x >= 12 { a.hits := 1  b.hits := 1 }
         }
         system { ones = A[2]()  judges = A(x = 10) }
         property low = always forall o in ones: o.x <= 4
         property late = eventually exists o in judges: o.x >= 13
         run { until 3.5 }",
    );
    all_near(&run.times("Touch.touch"), &[2.0, 2.0, 2.0], 1e-12);
    assert!(run.verdicts.iter().all(|verdict| verdict.holds));
    near(run.verdicts[0].margin, 0.5, 1e-9);
    near(run.verdicts[1].margin, 0.5, 1e-9);
}
