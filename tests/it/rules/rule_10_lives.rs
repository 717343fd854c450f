//! Rule 10: agents that are created and destroyed.

use hyc::runtime::Algorithm;
use hyc::runtime::limits::Limits;
use hyc::runtime::paper::Form;

use crate::harness::{Case, Run, all_near, near, refused, simulate_error, words};

/// A run by both forms of the engine, each with both back ends; they must tell the same.
#[track_caller]
fn simulate(text: &str) -> Run {
    let [plain, fast] =
        [Form::Plain, Form::Fast].map(|form| Case::new(text).algorithm(Algorithm::Masim(form)).run());
    assert_eq!(plain.log(), fast.log());
    let times = |run: &Run| run.events.iter().map(|event| event.time).collect::<Vec<_>>();
    all_near(&times(&fast), &times(&plain), 1e-8);
    let names = |run: &Run| run.finals.iter().map(|last| last.agent.clone()).collect::<Vec<_>>();
    assert_eq!(names(&plain), names(&fast));
    let values =
        |run: &Run| run.finals.iter().flat_map(|last| &last.values).map(|(_, x)| *x).collect::<Vec<_>>();
    all_near(&values(&fast), &values(&plain), 1e-7);
    fast
}

fn living(run: &Run) -> Vec<&str> {
    run.finals.iter().map(|last| last.agent.as_str()).collect()
}

#[test]
fn rule_10_numbers_name_agents_and_order_them() {
    let run = simulate(
        "agent Dot(k: real) { state x = k  flow { x' = 1 }  old: when x >= k + 1.5 { destroy self } }
         agent Maker { discrete n = 0  make: every 1 { create Dot(k = 10*n)  n := n + 1 } }
         system { maker = Maker()  first = Dot(k = 0) }  run { until 5 }",
    );
    // Each lives for 1.5 s: Dot#2 from 1 to 2.5, and so on.
    assert_eq!(
        run.log(),
        [
            "0 Maker.make maker",
            "0 Dot.old first",
            "0 Maker.make maker",
            "0 Dot.old Dot#2",
            "0 Maker.make maker",
            "0 Dot.old Dot#3",
            "0 Maker.make maker",
            "0 Dot.old Dot#4",
            "0 Maker.make maker",
        ]
    );
    assert_eq!(living(&run), ["maker", "Dot#5", "Dot#6"]);
    all_near(&[run.value("Dot#5.x"), run.value("Dot#6.x")], &[31.0, 40.0], 1e-9);
    let dot = run.stats.types.iter().find(|ty| ty.name == "Dot").unwrap();
    assert_eq!((dot.agents, dot.created, dot.destroyed), (2, 5, 4));
}

#[test]
fn rule_10_at_the_end_of_the_micro_step() {
    let run = simulate(
        "agent Dot(k: real) { discrete seen = k }
         agent Maker { state x = 0  discrete before = -1, later = -1  flow { x' = 1 }
           make: when x >= 2 { x := 7  create Dot(k = x)  before := count d in Dot }
           look: when (count d in Dot) >= 2 { later := x } }
         system { maker = Maker()  dot = Dot(k = 0) }  run { until 3 }",
    );
    assert_eq!(run.log(), ["0 Maker.make maker", "1 Maker.look maker"]);
    // Its argument reads the state before.
    near(run.value("Dot#2.seen"), 2.0, 1e-9);
    assert_eq!([run.value("maker.before"), run.value("maker.later")], [1.0, 7.0]);
}

#[test]
fn rule_10_what_is_declared_and_what_is_given() {
    let run = simulate(
        "agent Dot(a: real, b: real [km] = 2, big: bool = a > 1) {
           state x = y + a, y: real [m] = b
           discrete n: int = 3, w = x*y
           flow { x' = 0  y' = 0 } }
         agent Maker { make: after 1 { create Dot(a = 2)  create Dot(a = 0.5, y = 1, n = 4, big = false) } }
         system { maker = Maker() }  run { until 2 }",
    );
    let of = |agent: &str| ["x", "y", "n", "w"].map(|name| run.value(&format!("{agent}.{name}")));
    all_near(&of("Dot#1"), &[2002.0, 2000.0, 3.0, 2002.0 * 2000.0], 1e-6);
    all_near(&of("Dot#2"), &[1.5, 1.0, 4.0, 1.5], 1e-12);
}

#[test]
fn rule_10_entry_actions_and_guards_at_creation_as_at_the_start() {
    // On its boundary and moving out: at creation nothing is held, so it fires; so does what is true on entry.
    let run = simulate(
        "agent Dot { state x = 0  discrete n = 0
           edge: when x <= 0 { n := n + 1 }
           initial mode A { flow { x' = 1 } }
           mode B { entry { n := 10 }  flow { x' = 2 }  go: when n >= 10 -> A } }
         agent Maker { make: after 1 { create Dot()  create Dot() in B } }
         system { maker = Maker() }  run { until 2 }",
    );
    assert_eq!(
        run.log(),
        ["0 Maker.make maker", "1 Dot.edge Dot#1", "1 Dot.edge Dot#2", "2 Dot.go Dot#2 B->A"]
    );
    assert_eq!([run.value("Dot#1.n"), run.value("Dot#2.n")], [1.0, 11.0]);
    all_near(&[run.value("Dot#1.x"), run.value("Dot#2.x")], &[1.0, 1.0], 1e-9);
}

#[test]
fn rule_10_an_invariant_of_an_agent_that_is_created() {
    let (run, found) = simulate_error(
        "agent Dot { state x = -1  flow { x' = 1 }  invariant x >= 0 }
         agent Maker { make: after 1 { create Dot() } }
         system { maker = Maker() }  run { until 2 }",
    );
    assert_eq!((found.code, run.time), ("HY0501", 1.0));
    assert!(words(&[found]).contains("Dot#1"));
    let run = simulate(
        "agent Dot { state x = -1  flow { x' = 1 }  invariant x >= 0  mend: when x < 0 { x := 0 } }
         agent Maker { make: after 1 { create Dot() } }
         system { maker = Maker() }  run { until 2 }",
    );
    near(run.value("Dot#1.x"), 1.0, 1e-9);
}

#[test]
fn rule_10_timers_count_from_birth() {
    let run = simulate(
        "agent Dot { beat: every 0.5 { }  late: after 1.25 { destroy self } }
         agent Maker { make: after 1 { create Dot() } }
         system { maker = Maker() }  run { until 4 }",
    );
    all_near(&run.times("Dot.beat"), &[1.5, 2.0], 1e-12);
    all_near(&run.times("Dot.late"), &[2.25], 1e-12);
}

#[test]
fn rule_10_entry_actions_create_in_their_turn() {
    let run = simulate(
        "agent Leaf { }
         agent Twig(n: int) { discrete left: int = n
           entry { if n >= 2 { create Twig(n = n - 1) } else { create Leaf() } } }
         system { root = Twig(n = 3) }  run { until 1 }",
    );
    assert_eq!(living(&run), ["root", "Twig#1", "Twig#2", "Leaf#3"]);
    assert_eq!(run.value("Twig#2.left"), 1.0);
    assert!(run.log().is_empty());
}

#[test]
fn rule_10_who_is_destroyed_leaves_all_sets() {
    let run = simulate(
        "agent Dot(v: real) { state x = 0  flow { x' = v }  far: when x >= 3 { destroy self } }
         agent Watch { discrete n = 0, least = 0
           few: when (count d in Dot) <= 2 { n := count d in Dot }
           none_left: when not exists d in Dot { n := -1 }
           all_slow: when forall d in Dot: d.v <= 1 { least := min d in Dot: d.x } }
         system { dots = Dot[3](v = 3 - index)  watch = Watch() }  run { until 4 }",
    );
    // dots[0] is at 3 at t = 1, dots[1] at 1.5, dots[2] at 3.
    assert_eq!(
        run.log(),
        [
            "0 Dot.far dots[0]",
            "1 Watch.few watch",
            "0 Dot.far dots[1]",
            "1 Watch.all_slow watch",
            "0 Dot.far dots[2]",
            "1 Watch.none_left watch",
        ]
    );
    all_near(&run.times("Dot.far"), &[1.0, 1.5, 3.0], 1e-9);
    assert_eq!(run.value("watch.n"), -1.0);
    near(run.value("watch.least"), 1.5, 1e-9);
    assert_eq!(living(&run), ["watch"]);
}

#[test]
fn rule_10_a_seat_that_is_used_again_is_nobody_else_s() {
    // One flag for the `exists`: each newcomer that gets to 1 fires it, because the one before is gone by then.
    let run = simulate(
        "agent Dot { state x = 0  flow { x' = 1 }  old: when x >= 2 { destroy self } }
         agent Maker { discrete n: int = 0
           make: every 3 { create Dot() }
           see: when exists d in Dot: d.x >= 1 { n := n + 1 } }
         interaction Meets(a: Dot, m: Maker) { meets: when a.x >= 1.5 { m.n := m.n + 10 } }
         system { maker = Maker()  dot = Dot() }  run { until 11 }",
    );
    all_near(&run.times("Maker.see"), &[1.0, 4.0, 7.0, 10.0], 1e-9);
    all_near(&run.times("Meets.meets"), &[1.5, 4.5, 7.5, 10.5], 1e-9);
    let who: Vec<&str> = run
        .events
        .iter()
        .filter(|event| event.transition == "Meets.meets")
        .map(|event| event.agent.as_str())
        .collect();
    assert_eq!(who, ["dot", "Dot#2", "Dot#3", "Dot#4"]);
    assert_eq!(run.value("maker.n"), 44.0);
}

#[test]
fn rule_10_quantifiers_within_quantifiers_over_those_who_come_and_go() {
    let run = simulate(
        "agent Dot(x0: real, v: real) { state x = x0  flow { x' = v }  far: when x >= 12 { destroy self } }
         agent Watch { discrete n: int = 0
           pair: when exists a in Dot: exists b in Dot where b.v > a.v: a.x - b.x <= 0.5 and b.x <= a.x { n := n + 1 } }
         agent Maker { discrete k: int = 0
           make: every 2 { create Dot(x0 = 0, v = if k == 0 then 1 else 2)  k := 1 - k } }
         system { maker = Maker()  watch = Watch() }  run { until 13 }",
    );
    // Dots of 1 m/s at 2, 6, 10; of 2 m/s at 4, 8, 12. Born at 4, one is 0.5 behind that of 2 when 2(t - 4) = t - 2.5, and
    // passes it at 6; with those of 6 and 8 at 9.5 and 10.
    all_near(&run.times("Watch.pair"), &[5.5, 9.5], 1e-8);
    assert_eq!(run.value("watch.n"), 2.0);
}

#[test]
fn rule_10_links_to_the_dead_are_none() {
    let run = simulate(
        "agent Lead { state x = 0  flow { x' = 1 }  far: when x >= 1.9 { destroy self } }
         agent Tail { link lead: Lead  state y = 0  discrete alone: bool = false
           flow { y' = if lead then lead.x else 0 }
           lost: when not lead { alone := true } }
         system { lead = Lead()  tail = Tail(lead = lead) }
         run { until 3  record tail.lead, tail.y every 1 to \"tail.csv\" }",
    );
    assert_eq!(run.log(), ["0 Lead.far lead", "1 Tail.lost tail"]);
    near(run.value("tail.y"), 1.9 * 1.9 / 2.0, 1e-8);
    assert_eq!(run.column("tail", 0), [(0.0, 0.0), (1.0, 0.0), (2.0, -1.0), (3.0, -1.0)]);
}

#[test]
fn rule_10_a_link_given_at_birth_couples() {
    let run = simulate(
        "agent Lead { state x = 0  flow { x' = 1 }
           first: after 1 { create Tail(lead = self) }
           second: after 2 { create Tail(lead = self, y = 5) } }
         agent Tail(lead: Lead) { state y = 0  flow { y' = lead.x } }
         system { lead = Lead() }  run { until 3 }",
    );
    // x = t, so y grows by t^2/2.
    all_near(&[run.value("Tail#1.y"), run.value("Tail#2.y")], &[4.0, 7.5], 1e-8);
}

#[test]
fn rule_10_destroying_what_a_living_agent_holds_is_an_error() {
    let (run, found) = simulate_error(
        "agent Lead { state x = 0  flow { x' = 1 }  far: when x >= 2 { destroy self } }
         agent Tail(lead: Lead) { discrete n = 0  look: when lead.x >= 1 { n := 1 } }
         system { lead = Lead()  tail = Tail(lead = lead) }  run { until 3 }",
    );
    assert_eq!(found.code, "HY0534");
    near(run.time, 2.0, 1e-9);
    let told = words(&[found]);
    assert!(told.contains("`lead` is destroyed, and is `lead` of `tail`"), "{told}");
    // Both at once is none.
    let run = simulate(
        "agent Lead { state x = 0  flow { x' = 1 }  far: when x >= 2 { destroy self } }
         agent Tail(lead: Lead) { discrete n = 0  end: when lead.x >= 2 { destroy self } }
         system { lead = Lead()  tail = Tail(lead = lead) }  run { until 3 }",
    );
    assert!(living(&run).is_empty());
}

#[test]
fn rule_10_an_interaction_destroys_and_creates() {
    let run = simulate(
        "agent Drop(m0: real, v0: real) { state x = 0  discrete m = m0, v = v0  flow { x' = v }
           split: when m >= 4 { create Drop(m0 = m/2, v0 = v - 1, x = x)  m := m/2  v := v + 1 } }
         interaction Merge(a: Drop, b: Drop) {
           merge: when abs(a.x - b.x) <= 0.5 and a.v > b.v {
             a.v := (a.m*a.v + b.m*b.v)/(a.m + b.m)  a.m := a.m + b.m  destroy b } }
         system { slow = Drop(m0 = 1, v0 = 1, x = 2.5)  fast = Drop(m0 = 2, v0 = 2) }  run { until 3 }",
    );
    // fast is 0.5 behind slow at 2: 3 of mass at 5/3 m/s, from 4.
    assert_eq!(run.log(), ["0 Merge.merge fast slow"]);
    assert_eq!(living(&run), ["fast"]);
    near(run.value("fast.m"), 3.0, 1e-12);
    near(run.value("fast.x"), 4.0 + 5.0 / 3.0, 1e-8);
}

#[test]
fn rule_10_who_is_destroyed_twice_is_destroyed_once() {
    let run = simulate(
        "agent Dot { state x = 0  flow { x' = 1 }  end: when x >= 1 { destroy self } }
         agent Hand { link dot: Dot  take: when dot.x >= 1 { destroy dot } }
         system { dot = Dot()  hand = Hand(dot = dot) }  run { until 2 }",
    );
    assert_eq!(living(&run), ["hand"]);
    assert_eq!(run.log().len(), 1, "who destroys an agent writes all of it: {:?}", run.log());
}

#[test]
fn rule_10_draws_belong_to_the_creator_and_its_count() {
    let model = |others: &str| {
        format!(
            "agent Car(v: real) {{ state x = 0  discrete w = 0  flow {{ x' = v }} }}
             agent Ramp(p: real) {{ enter: every p {{ create Car(v ~ Normal(30, 3), w ~ Exponential(2)) }} }}
             system {{ {others} ramp = Ramp(p = 1) }}  run {{ until 3.5  seed 7 }}"
        )
    };
    let (alone, among) = (simulate(&model("")), simulate(&model("second = Ramp(p = 0.7)")));
    let of = |run: &Run, numbers: &[usize]| -> Vec<f64> {
        numbers.iter().flat_map(|n| [run.value(&format!("Car#{n}.w"))]).collect()
    };
    // Those of the other at 0.7, 1.4, 2.1, 2.8, 3.5 are 2, 4, 6, 7, 9.
    let (a, b) = (of(&alone, &[1, 2, 3]), of(&among, &[3, 5, 8]));
    assert_eq!(a, b);
    let mut all = of(&among, &[2, 3, 4, 5, 6, 7, 8, 9]);
    all.sort_by(f64::total_cmp);
    assert!(all.windows(2).all(|two| two[0] < two[1]), "each its own: {all:?}");
}

#[test]
fn rule_10_records_have_rows_while_an_agent_lives() {
    let run = simulate(
        "agent Dot { state x = 0  flow { x' = 1 }  old: when x >= 1.9 { destroy self } }
         agent Maker { make: every 1.5 { create Dot() } }
         system { maker = Maker()  dot = Dot() }
         run { until 4  record Dot.x every 1 to \"a.csv\"  record dot.x every 1 to \"b.csv\"  record Dot.x to \"c.csv\" }",
    );
    let rows = |k: usize| run.samples[k].iter().map(|row| (row.time, row.agent.as_str())).collect::<Vec<_>>();
    assert_eq!(
        rows(0),
        [(0.0, "dot"), (1.0, "dot"), (2.0, "Dot#2"), (3.0, "Dot#2"), (3.0, "Dot#3"), (4.0, "Dot#3")]
    );
    assert_eq!(rows(1), [(0.0, "dot"), (1.0, "dot")]);
    // Both sides of every event: the last row of an agent is just before it is destroyed, the first just after its birth.
    let of = |agent: &str| run.samples[2].iter().filter(|row| row.agent == agent).collect::<Vec<_>>();
    let (born, old) = (of("Dot#2"), of("dot"));
    assert_eq!((born[0].time, born[0].cells[0]), (1.5, 0.0));
    near(old.last().unwrap().time, 1.9, 1e-9);
    near(old.last().unwrap().cells[0], 1.9, 1e-9);
}

#[test]
fn rule_10_places_are_used_again() {
    let text = |until: f64| {
        format!(
            "agent Dot(k: real) {{ state x = 0  flow {{ x' = k }}  old: when x >= 2 {{ destroy self }} }}
             agent Maker {{ discrete n: int = 0, near: int = 0
               make: every 0.001 {{ create Dot(k = 1000 + mod(n, 7))  n := n + 1 }}
               see: when (count d in Dot where d.x >= 1) >= 2 {{ near := near + 1 }} }}
             interaction Meets(a: Dot, b: Dot) {{ meets: when abs(a.x - b.x) <= 0.001 {{ }} }}
             system {{ maker = Maker() }}  run {{ until {until} }}"
        )
    };
    for form in [Form::Plain, Form::Fast] {
        let of = |until: f64| {
            let run = Case::new(&text(until)).algorithm(Algorithm::Masim(form)).run();
            let dot = run.stats.types.iter().find(|ty| ty.name == "Dot").unwrap();
            (dot.created, run.stats.places, run.stats.guard_places)
        };
        let (short, long) = (of(0.05), of(2.0));
        assert_eq!((short.0, long.0), (50, 2000));
        assert!(long.1 <= 8, "{long:?}");
        assert!(long.2 <= 2 * short.2, "no more for 40 times as many births: {short:?}, {long:?}");
    }
}

#[test]
fn rule_10_creation_without_end_is_an_error() {
    let limits = Limits { agents_max: 100, ..Limits::default() };
    for text in [
        // Each creates another at once.
        "agent Dot { more: when time >= 1 { create Dot() } }
         system { dot = Dot() }  run { until 2 }",
        // And dies: in one instant that is no way out.
        "agent Dot { more: when time >= 1 { create Dot()  destroy self } }
         system { dot = Dot() }  run { until 2 }",
        "agent Dot { entry { create Dot() } }  system { dot = Dot() }  run { until 2 }",
    ] {
        let (_, found) = Case::new(text).limits(limits.clone()).run_error();
        assert_eq!(found.code, "HY0530", "{found:?}");
        assert!(words(&[found]).contains("max_agents"));
    }
}

#[test]
fn rule_10_values_at_birth_must_be_numbers() {
    let (_, found) = simulate_error(
        "agent Dot(k: real) { state x = log(k)  flow { x' = 1 } }
         agent Maker { make: after 1 { create Dot(k = -1) } }
         system { maker = Maker() }  run { until 2 }",
    );
    assert_eq!(found.code, "HY0531");
    assert!(words(&[found]).contains("`Dot#1.x`"));
    let (_, found) = simulate_error(
        "agent Dot(k: real) { state x = 0  flow { x' = k } }
         agent Maker { make: after 1 { create Dot(k ~ Normal(1, -time)) } }
         system { maker = Maker() }  run { until 2 }",
    );
    assert_eq!(found.code, "HY0532");
}

#[test]
fn rule_10_arguments_are_checked() {
    let told = |action: &str| {
        refused(&format!(
            "agent Car(v: real, boss: Boss) {{ state x = 0  flow {{ x' = v }} }}
             agent Boss {{ link friend: Boss  state y = 0  flow {{ y' = 1 }}  go: when y >= 1 {{ {action} }} }}
             system {{ boss = Boss() }}  run {{ until 2 }}"
        ))
    };
    assert!(told("create Car(boss = self)").contains("HY0266"));
    assert!(told("create Car(v = 1)").contains("`Car` needs a value for its parameter `boss`"));
    assert!(told("create Car(v = 1, boss = friend)").contains("declare a `link` instead"));
    assert!(told("create Car(v = 1, boss = none)").contains("HY0220"));
    assert!(told("create Car(v = 1, boss = self, z = 3)").contains("HY0267"));
    assert!(told("create Car(v = 1, v = 2, boss = self)").contains("HY0268"));
    assert!(told("create Car[3](v = 1, boss = self)").contains("HY0256"));
    assert!(told("create Cat()").contains("HY0202"));
    assert!(told("destroy y").contains("HY0257"));
    assert!(told("destroy none").contains("HY0257"));
}
