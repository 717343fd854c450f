//! Are properties judged exactly: their margins, when they are worst, and for whom? And does `stop when` end a run where it should?

use hyc::runtime::Algorithm;
use hyc::runtime::observe::Verdict;
use hyc::runtime::paper::Form;

use crate::harness::{Case, Ended, Run, near, refused};

/// The runs of a model by both forms, whose verdicts must be the same; that of the fast one.
#[track_caller]
pub fn run(text: &str) -> Run {
    let [fast, plain] =
        [Form::Fast, Form::Plain].map(|form| Case::new(text).algorithm(Algorithm::Masim(form)).run());
    assert_eq!(fast.verdicts.len(), plain.verdicts.len());
    for (ours, theirs) in fast.verdicts.iter().zip(&plain.verdicts) {
        let key = |verdict: &Verdict| (verdict.name.clone(), verdict.holds, verdict.agents.clone());
        assert_eq!(key(ours), key(theirs));
        if ours.margin.is_finite() {
            near(ours.margin, theirs.margin, 1e-8);
        }
    }
    fast
}

#[track_caller]
pub fn verdict<'r>(run: &'r Run, name: &str) -> &'r Verdict {
    run.verdicts.iter().find(|verdict| verdict.name == name).unwrap()
}

/// Checks whether a property holds, by which margin, when, and for whom (`c = cars[2]`).
#[track_caller]
fn check(run: &Run, name: &str, holds: bool, margin: f64, time: f64, agents: &str) {
    let found = verdict(run, name);
    let bound: Vec<String> = found.agents.iter().map(|(name, agent)| format!("{name} = {agent}")).collect();
    assert_eq!((found.holds, bound.join(", ").as_str()), (holds, agents), "{found:?}");
    near(found.margin, margin, 1e-8);
    near(found.time.unwrap(), time, 2e-7);
}

/// Oscillators x = cos(t + p), v = -sin(t + p), with p = 0, 0.3 and 0.6, and some properties.
fn oscillators(properties: &str, until: f64) -> Run {
    run(&format!(
        "agent Osc(p: real) {{ state x = cos(p), v = -sin(p)  flow {{ x' = v  v' = -x }} }}
         system {{ o = Osc[3](p = 0.3*index) }}
         {properties}
         run {{ until {until}  tolerance 1e-11 }}"
    ))
}

const PI: f64 = std::f64::consts::PI;

#[test]
fn extremes_over_the_whole_run_lie_between_steps() {
    let run = oscillators(
        "property low = always forall c in Osc: c.x >= -0.5 + 0.01*c.p
         property high = eventually exists c in Osc: c.x >= 0.5 + 0.01*c.p and c.v >= 0.5 + 0.01*c.p
         property never = eventually forall c in Osc: c.x >= 1.5",
        7.0,
    );
    // What is asked differs a little, so that it is one of them that decides.
    check(&run, "low", false, -0.5 - 0.006, PI - 0.6, "c = o[2]");
    check(&run, "high", true, 0.5f64.sqrt() - 0.5, 1.75 * PI, "c = o[0]");
    // cos is highest for all where the outer ones are as high: at t = 2 pi - 0.3, of the first and the last.
    let never = verdict(&run, "never");
    near(never.margin, 0.3f64.cos() - 1.5, 1e-8);
    near(never.time.unwrap(), 2.0 * PI - 0.3, 1e-7);
}

#[test]
fn windows_end_in_the_middle_of_steps() {
    let run = oscillators(
        "property early = always [0, 2] forall c in Osc: c.x >= -0.5
         property late = always [1, 2.5] forall c in Osc: c.v <= 0
         property some = eventually [3.5, 4] exists c in Osc: c.x >= 0
         property beyond = always [50, 60] forall c in Osc: c.x >= 3
         property unreached = eventually [50, 60] forall c in Osc: c.x >= -3",
        10.0,
    );
    check(&run, "early", false, 2.6f64.cos() + 0.5, 2.0, "c = o[2]");
    check(&run, "late", true, 3.1f64.sin(), 2.5, "c = o[2]");
    check(&run, "some", false, 4.6f64.cos(), 4.0, "c = o[2]");
    for (name, holds) in [("beyond", true), ("unreached", false)] {
        let found = verdict(&run, name);
        assert_eq!((found.holds, found.time, found.margin.is_infinite()), (holds, None, true));
    }
}

#[test]
fn a_condition_alone_is_one_at_the_beginning() {
    let run = oscillators("property now = not exists c in Osc: c.x < 0.5 or c.v > 0.1", 1.0);
    check(&run, "now", true, 0.1, 0.0, "c = o[0]");
}

/// The extreme of a function by its values at many times, and at more and more near the best of them.
fn sampled(f: impl Fn(f64) -> f64, [from, to]: [f64; 2], pick: fn(f64, f64) -> f64) -> f64 {
    let (mut a, mut b) = (from, to);
    let mut best = f(a);
    for _ in 0..7 {
        let times: Vec<f64> = (0..=200).map(|k| a + (b - a) * f64::from(k) / 200.0).collect();
        let values: Vec<f64> = times.iter().map(|&t| f(t)).collect();
        best = values.iter().copied().fold(best, pick);
        let at = (0..values.len())
            .reduce(|i, j| if pick(values[i], values[j]) == values[i] { i } else { j })
            .unwrap();
        (a, b) = (times[at.saturating_sub(1)], times[(at + 1).min(200)]);
    }
    best
}

#[test]
fn until_asks_for_a_goal_and_for_what_is_before_it() {
    let run = oscillators(
        "property reach = forall c in Osc: c.x >= -0.9 until [1, 3] forall c in Osc: c.v <= -0.7
         property soon = forall c in Osc: c.x >= 0.9 until forall c in Osc: c.x <= 0
         property at_once = forall c in Osc: c.x >= 2 until [0, 3] forall c in Osc: c.v <= 0.2",
        5.0,
    );
    let phases = [0.0, 0.3, 0.6];
    let x = |t: f64| phases.iter().map(|p| (t + p).cos()).fold(f64::INFINITY, f64::min);
    let v = |t: f64| phases.iter().map(|p| -(t + p).sin()).fold(f64::NEG_INFINITY, f64::max);
    let before = |t: f64| sampled(x, [0.0, t], f64::min) + 0.9;
    let reach = sampled(|t| before(t).min(-0.7 - v(t)), [1.0, 3.0], f64::max);
    near(verdict(&run, "reach").margin, reach, 1e-8);
    assert!(verdict(&run, "reach").holds);
    // x <= 0 comes for all at pi/2, long after the first has fallen below 0.9: as soon as possible is best, and bad
    let highest = |t: f64| phases.iter().map(|p| (t + p).cos()).fold(f64::NEG_INFINITY, f64::max);
    let soon = |t: f64| (sampled(x, [0.0, t], f64::min) - 0.9).min(-highest(t));
    near(verdict(&run, "soon").margin, sampled(soon, [0.0, 5.0], f64::max), 1e-8);
    assert!(!verdict(&run, "soon").holds);
    // a goal that holds at once asks for nothing before it
    check(&run, "at_once", true, 0.2, 0.0, "c = o[0]");
}

#[test]
fn windows_within_windows() {
    let run = oscillators(
        "property response = always [0, 4] eventually [0, 2] forall c in Osc: c.x >= 0.5
         property rest = eventually [0, 6] always [0.5, 1] exists c in Osc: c.x >= 0.5
         property deep = always [1, 3] eventually [0, 1.5] always [0, 0.25] exists c in Osc: c.v >= -0.5
         property added = always [0, 1] always [1, 2] forall c in Osc: c.x >= -2 + 0.01*c.p
         property recurs = always eventually [0, 6.5] forall c in Osc: c.x >= 0.9",
        10.0,
    );
    let phases = [0.0, 0.3, 0.6];
    let least = |t: f64| phases.iter().map(|p| (t + p).cos()).fold(f64::INFINITY, f64::min) - 0.5;
    let speed = |t: f64| phases.iter().map(|p| -(t + p).sin()).fold(f64::NEG_INFINITY, f64::max) + 0.5;
    let response = sampled(|t| sampled(least, [t, t + 2.0], f64::max), [0.0, 4.0], f64::min);
    near(verdict(&run, "response").margin, response, 1e-8);
    assert!(!verdict(&run, "response").holds);
    // No half second is without a time midway between the peaks of two that follow each other.
    near(verdict(&run, "rest").margin, 0.15f64.cos() - 0.5, 1e-8);
    let rough = |f: &dyn Fn(f64) -> f64, [from, to]: [f64; 2], pick: fn(f64, f64) -> f64| {
        (0..=300).map(|k| f(from + (to - from) * f64::from(k) / 300.0)).reduce(pick).unwrap()
    };
    let inner = |t: f64| rough(&speed, [t, t + 0.25], f64::min);
    let deep = rough(&|t| rough(&inner, [t, t + 1.5], f64::max), [1.0, 3.0], f64::min);
    near(verdict(&run, "deep").margin, deep, 5e-3);
    check(&run, "added", true, 1.0 - 0.006, PI - 0.6, "c = o[2]");
    // Windows end with the run: the last is the end alone.
    near(verdict(&run, "recurs").margin, 10.0f64.cos() - 0.9, 1e-8);
    assert!(!verdict(&run, "recurs").holds);
}

/// A ball that bounces with 4/5 of its speed.
const BALL: &str = "agent Ball { state x = 1, v = 0  discrete n: int = 0
       flow { x' = v  v' = -9.81 }  bounce: when x <= 0 { v := -0.8*v  n := n + 1 } }
     system { ball = Ball() }\n";

/// A window of one time, inside another: x = 1 + t.
#[test]
fn windows_of_one_time() {
    let text = |until: f64| {
        format!(
            "agent A {{ state x = 1  flow {{ x' = 1 }} }}  system {{ a = A() }}
             property p1 = eventually [0, 0] always [0, 0] forall a in A: a.x >= 0
             property p2 = eventually [0, 0] always [0.5, 0.5] forall a in A: a.x >= 0
             property p3 = always [0.5, 0.5] eventually [0, 0] forall a in A: a.x >= 2
             property p4 = always [0, 0] eventually [0.5, 0.5] forall a in A: a.x >= 5
             property p5 = always [0, 0] forall a in A: a.x <= 0 until [0.5, 0.5] forall a in A: a.x >= 5
             property p6 = always [0, 0] eventually [0.25, 0.5] forall a in A: a.x >= 1
             run {{ until {until} }}"
        )
    };
    for until in [2.0, 0.5] {
        let run = run(&text(until));
        let margins = [("p1", 1.0), ("p2", 1.5), ("p3", -0.5), ("p4", -3.5), ("p6", 0.5)];
        for (name, margin) in margins {
            let found = verdict(&run, name);
            near(found.margin, margin, 1e-9);
            assert_eq!(found.holds, margin > 0.0, "{name}");
        }
    }
    let run = run(&text(2.0));
    let found = verdict(&run, "p5");
    assert_eq!((found.holds, found.margin < -0.9), (false, true), "{found:?}");
}

#[test]
fn both_sides_of_an_event_count_and_a_touch_is_no_crossing() {
    let run = run(&format!(
        "{BALL}
         property above = always forall b in Ball: b.x >= 0
         property strictly = always forall b in Ball: b.x > 0
         property falls = always forall b in Ball: b.v >= -4
         property rises = always forall b in Ball: b.v <= 3.6
         property few = always forall b in Ball: b.n <= 2
         property odd = always not exists b in Ball: b.n == 1
         run {{ until 2  tolerance 1e-11 }}"
    ));
    let speed = (2.0f64 * 9.81).sqrt();
    let hit = speed / 9.81;
    for (name, holds) in [("above", true), ("strictly", false)] {
        let found = verdict(&run, name);
        assert_eq!((found.holds, found.margin), (holds, 0.0), "{found:?}");
    }
    check(&run, "falls", false, 4.0 - speed, hit, "b = ball");
    check(&run, "rises", true, 3.6 - 0.8 * speed, hit, "b = ball");
    // the third bounce: after 1 + 2*0.8 + 2*0.64 falls
    check(&run, "few", false, -1.0, hit * (1.0 + 1.6 + 1.28), "b = ball");
    check(&run, "odd", false, 0.0, hit, "b = ball");
}

#[test]
fn what_is_no_number_has_no_margin() {
    let run = run("agent Car { state x = 0  discrete lit: bool = false  flow { x' = 1 }
           initial mode Go { there: when x >= 2 -> Stay { lit := true } } mode Stay { } }
         system { car = Car() }
         property goes = always forall c in Car: c is Go
         property lit = eventually exists c in Car: c.lit
         run { until 3 }");
    for (name, holds) in [("goes", false), ("lit", true)] {
        let found = verdict(&run, name);
        assert_eq!((found.holds, found.margin.is_infinite()), (holds, true), "{found:?}");
        near(found.time.unwrap(), 2.0, 1e-9);
    }
}

#[test]
fn agents_come_and_go() {
    let run = run("agent Car(v: real) { state x = 0  flow { x' = v }  leave: when x >= 4.05 { destroy self } }
         agent Gate { discrete n: int = 0  enter: every 1 when n < 5 { n := n + 1  create Car(v = 1 + 0.1*n) } }
         system { gate = Gate() }
         property slow = always forall c in Car: c.v <= 1.35
         property near_ = always forall c in Car: c.x <= 3 + 0.5*c.v
         property few = always (count c in Car) <= 5
         property empty = eventually [2, 20] not exists c in Car: c.x >= 0
         run { until 12  tolerance 1e-10 }");
    // numbers go on from the gate's, 0: the fifth car has v = 1.4
    check(&run, "slow", false, 1.35 - 1.4, 5.0, "c = Car#5");
    check(&run, "near_", false, 3.5 - 4.05, 5.05, "c = Car#1");
    check(&run, "few", true, 0.0, 5.0, "");
    // nobody is there from the time at which the last has left
    let empty = verdict(&run, "empty");
    assert!(empty.holds && empty.margin == f64::INFINITY, "{empty:?}");
    near(empty.time.unwrap(), 5.0 + 4.05 / 1.4, 1e-8);
}

#[test]
fn links_and_aggregates_in_conditions() {
    let run = run("agent Car(v: real, x0: real) { state x = x0  flow { x' = v }
           link lead = nearest o in other Car where o.x > x by o.x - x
           let gap = if lead then lead.x - x else inf }
         system { cars = Car[3](v = 3 - index, x0 = 4*index) }
         property apart = always forall c in Car: c.gap >= 1
         property spread = always (max c in Car: c.x) - (min c in Car: c.x) <= 7.5
         run { until 3  tolerance 1e-10 }");
    // x = 3 t, 4 + 2 t, 8 + t: gaps of 4 - t
    let apart = verdict(&run, "apart");
    assert!(apart.holds, "{apart:?}");
    near(apart.margin, 0.0, 1e-12);
    near(apart.time.unwrap(), 3.0, 1e-12);
    check(&run, "spread", false, -0.5, 0.0, "");
}

#[test]
fn properties_change_nothing() {
    let property = "property p = always forall b in Ball: b.x >= 0.1 and b.v <= 2
        property q = always [0, 1] eventually [0, 0.5] exists b in Ball: b.x >= 0.5";
    let settings = "run { until 2  record Ball.x every 0.125 to \"x.csv\" }";
    let with = run(&format!("{BALL}{property} {settings}"));
    let without = run(&format!("{BALL}{settings}"));
    assert_eq!((with.events, with.samples, with.finals), (without.events, without.samples, without.finals));
    let counts = |run: &hyc::runtime::observe::Stats| {
        (run.events, run.steps, run.rejected, run.cuts, run.types.clone())
    };
    assert_eq!(counts(&with.stats), counts(&without.stats));
}

// ---- stop when

#[test]
fn stop_when_ends_the_run_at_the_located_instant() {
    let run = run(&format!(
        "{BALL} run {{ until 9  tolerance 1e-11  stop when exists b in Ball: b.x <= 0.25
           record ball every 0.125 to \"x.csv\" }}"
    ));
    let time = (1.5f64 / 9.81).sqrt();
    near(run.time, time, 1e-10);
    assert_eq!(run.end, Ended::Stop { reason: None, by: "stop when".into() });
    assert_eq!(run.events, []);
    // every sample up to then, and the last state of every agent
    assert_eq!(run.samples[0].iter().map(|row| row.time).collect::<Vec<_>>(), [0.0, 0.125, 0.25, 0.375]);
    let [last] = run.finals.as_slice() else { panic!("{:?}", run.finals) };
    assert_eq!((last.agent.as_str(), last.time), ("ball", run.time));
    near(last.values[0].1, 0.25, 1e-9);
}

#[test]
fn stop_when_a_reset_makes_it_true() {
    let run = run(&format!("{BALL} run {{ stop when (sum b in Ball: b.n) >= 2  until 9 }}"));
    assert_eq!(run.events.len(), 2);
    assert_eq!(run.time, run.events[1].time);
    assert_eq!(run.finals[0].values[2].1, 2.0);
}

#[test]
fn stop_when_it_is_true_at_once_or_by_the_time_or_by_any_of_several() {
    let cases =
        [("time >= 3", 3.0), ("exists b in Ball: b.x >= 1", 0.0), ("time > 0.25  stop when time >= 4", 0.25)];
    for (condition, time) in cases {
        let run = run(&format!("{BALL} run {{ stop when {condition} }}"));
        near(run.time, time, 1e-12);
        assert!(matches!(run.end, Ended::Stop { .. }));
    }
}

#[test]
fn a_stopped_run_judges_what_it_has_come_to() {
    let run = run(&format!(
        "{BALL} property never = eventually exists b in Ball: b.n >= 1
         property so_far = always forall b in Ball: b.x >= 0.25
         run {{ until 9  stop when exists b in Ball: b.x <= 0.25 }}"
    ));
    assert_eq!(
        [false, true],
        ["never", "so_far"].map(|name| verdict(&run, name).holds),
        "{:?}",
        run.verdicts
    );
}

// ---- until within windows

#[test]
fn until_may_stand_inside_always_and_eventually() {
    // at t the best is to reach the goal at 4, where both have the margin 1, or as late as the window lets
    let run = run("agent A { state x = 0  flow { x' = 1 } }
         system { a = A() }
         property worst = always [0, 2] forall a in A: a.x <= 5 until [0, 3.5] exists b in A: b.x >= 3
         property best = eventually [0, 2] forall a in A: a.x <= 5 until [0, 3.5] exists b in A: b.x >= 3
         property late = always [0, 2] forall a in A: a.x <= 5 until [4.5, 6] exists b in A: b.x >= 3
         property deep = always [0, 1] eventually [0, 0.25] forall a in A: a.x <= 5 until [0, 3.5] exists b in A: b.x >= 3
         run { until 10 }");
    check(&run, "worst", true, 0.5, 3.5, "b = a");
    near(verdict(&run, "best").margin, 1.0, 1e-8);
    near(verdict(&run, "best").time.unwrap(), 4.0, 2e-7);
    // at 2 the goal may be taken from 6.5 on, where what has to hold before has failed by 1.5
    check(&run, "late", false, -1.5, 6.5, "a = a");
    check(&run, "deep", true, 0.75, 3.75, "b = a");
}

#[test]
fn until_inside_always_is_the_same_as_outside_over_a_window_of_no_length() {
    let text = format!(
        "{BALL} property outside = forall b in Ball: b.v >= -1.5 until [0.05, 0.4] exists b in Ball: b.x <= 0.8
         property inside = always [0, 0] forall b in Ball: b.v >= -1.5 until [0.05, 0.4] exists b in Ball: b.x <= 0.8
         run {{ until 1 }}"
    );
    let run = run(&text);
    let [outside, inside] = ["outside", "inside"].map(|name| verdict(&run, name));
    near(inside.margin, outside.margin, 1e-9);
    near(inside.time.unwrap(), outside.time.unwrap(), 1e-6);
    assert_eq!((inside.holds, &inside.agents), (outside.holds, &outside.agents));
}

#[test]
fn what_a_jump_ends_and_what_it_begins_are_met_by_until() {
    let run = run("agent Clerk { initial mode Wait { done: after 1 -> Done } mode Done { again: after 1 -> Wait } }
         system { clerk = Clerk() }
         property turns = always [0, 3] forall c in Clerk: c is Wait until exists c in Clerk: c is Done
         property brief = always [0, 3] forall c in Clerk: c is Wait until [0, 0.5] exists c in Clerk: c is Done
         run { until 6 }");
    let found = ["turns", "brief"].map(|name| (verdict(&run, name).holds, verdict(&run, name).margin));
    assert_eq!(found, [(true, f64::INFINITY), (false, f64::NEG_INFINITY)]);
}

// ---- refused

#[test]
fn what_is_no_property_is_refused() {
    let with = |property: &str| refused(&format!("{BALL}{property}"));
    assert!(with("property p = always [3, 2] 1 < 2").contains("HY0216"));
    assert!(with("property p = always [-1, 2] 1 < 2").contains("HY0216"));
    assert!(with("property p = always forall b in Ball: self is Ball").contains("HY0217"));
    assert!(with("property p = always 3").contains("HY0222"));
    assert!(with("property p = 1 < 2 property p = 1 < 3").contains("HY0205"));
    assert!(with("property p = forall b in Ball: b.x until 2 < 3").contains("HY0222"));
    assert!(with("run { stop when 3 }").contains("HY0222"));
    assert!(with("property p = always rising(time > 2)").contains("HY0246"));
}

#[test]
fn agents_of_the_system_may_be_named() {
    let run = run("agent Plant(v0: real) {
           state v = v0
           initial mode Fast { flow { v' = 1 - v }  late: when v >= 0.9 -> Slow }
           mode Slow { flow { v' = 0 } }
         }
         agent Gone { state y = 1  flow { y' = -1 }  die: when y <= 0 { destroy self } }
         system { plant = Plant(v0 = 0)  helper = Plant(v0 = 0.5)  gone = Gone()  more = Plant[3](v0 = 0.2*index) }
         property below = always plant.v < 1
         property apart = always abs(plant.v - helper.v) <= 0.4
         property among = always [1, 2] forall m in more: m == plant or m.v >= plant.v - 0.5
         property slows = eventually plant is Slow
         property early = always [0, 0.5] gone.y > 0
         property later = always gone.y >= -1
         property ended = eventually [2, 2.2] not gone
         run { until 5  tolerance 1e-10  stop when plant is Slow and helper.v >= 0.9 }");
    let end = 10.0_f64.ln();
    check(&run, "below", true, 0.1, end, "");
    check(&run, "apart", false, -0.1, 0.0, "");
    check(&run, "early", true, 0.5, 0.5, "");
    assert!(verdict(&run, "among").holds && verdict(&run, "slows").holds && verdict(&run, "ended").holds);
    let later = verdict(&run, "later");
    assert!(!later.holds, "who is no more is compared with nothing");
    near(later.time.unwrap(), 1.0, 1e-9);
    near(run.time, end, 1e-9);
    assert!(matches!(run.end, Ended::Stop { .. }), "{:?}", run.end);
}

#[test]
fn a_name_of_several_agents_is_a_set_and_no_agent() {
    let text = |condition: &str| {
        format!(
            "agent A {{ state x = 0  flow {{ x' = 1 }} }}
             system {{ one = A()  many = A[2]() }}
             property p = always {condition}
             run {{ until 1 }}"
        )
    };
    assert!(refused(&text("many.x < 5")).contains("forall o in many"));
    assert!(refused(&text("one < 5")).contains("HY02"), "an agent is no number");
    assert!(refused(&text("one.z < 5")).contains("`z`"));
    for condition in
        ["forall o in many: o.x < one.x + 5", "exists one in many: one.x < 5", "one.x < 5 and one.x > -5"]
    {
        let run = run(&text(condition));
        assert!(verdict(&run, "p").holds, "{condition}");
    }
}

#[test]
fn a_margin_that_stays_the_same_takes_no_search() {
    for (margin, most) in [("a.x - b.x + 4", 1_000), ("hypot(a.x - b.x, 1)", 400_000)] {
        let text = format!(
            "agent P(x0: real) {{ state x = x0, v = 0  flow {{ x' = v  v' = 1 - v }} }}
             system {{ a = P(x0 = 0)  b = P(x0 = 3) }}
             property p = always {margin} >= 0.5
             run {{ until 20 }}"
        );
        let run = run(&text);
        let expected = if most == 1_000 { 0.5 } else { 10.0_f64.sqrt() - 0.5 };
        near(verdict(&run, "p").margin, expected, 1e-6);
        assert!(run.stats.guard_evaluations < most, "{margin}: {}", run.stats.guard_evaluations);
    }
    // what is flat first, and then has an extreme
    let run = run("agent P { state x = 0  flow { x' = if time < 1 then 0 else cos(3*(time - 1)) } }
         system { p = P() }
         property least = always p.x >= -1
         run { until 4 }");
    near(verdict(&run, "least").margin, 1.0 - 1.0 / 3.0, 1e-6);
}
