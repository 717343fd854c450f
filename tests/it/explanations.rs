//! Does the run say why each transition fired, rightly, and without changing a bit of itself?

use hyc::runtime::observe::{Cause, ShownComparison, WhyUndecided};

use crate::harness::{Case, Explained, Run};

#[track_caller]
fn explained(text: &str) -> Run {
    let case = Case::new(text);
    let told = case.run_explained();
    let untold = case.run();
    assert_eq!(told.bits(), untold.bits(), "explanations change nothing");
    assert_eq!(told.stats, untold.stats, "nor what is counted");
    let events: Vec<(f64, &str)> = told.events.iter().map(|e| (e.time, e.transition.as_str())).collect();
    let reasons: Vec<(f64, &str)> =
        told.explanations.iter().map(|e| (e.time, e.transition.as_str())).collect();
    assert_eq!(events, reasons, "one for each event, in order");
    told
}

#[track_caller]
fn of<'r>(run: &'r Run, transition: &str) -> &'r Explained {
    run.explanations.iter().find(|told| told.transition == transition).expect("it fires")
}

/// Text, then left, right and margin just before and at the instant.
fn numbers(run: &Run, shown: &ShownComparison) -> (String, Option<[f64; 3]>, [f64; 3]) {
    let sides = |c: &hyc::runtime::observe::Compared| [c.left, c.right, c.margin];
    let text = run.sources.text(shown.now.span).to_string();
    (text, shown.before.as_ref().map(sides), sides(&shown.now))
}

#[test]
fn a_root_has_its_numbers_on_both_sides() {
    let run = explained(
        "agent A { state x = 0, y = 5  flow { x' = 2  y' = -1 }
           hit: when 3 <= x and y > 2 { x := 0 } }
         system { a = A() }  run { until 2 }",
    );
    let told = of(&run, "A.hit");
    assert_eq!((told.cause.clone(), told.agent.as_str()), (Cause::Flow, "a"));
    let (text, before, now) = numbers(&run, &told.shown[0]);
    assert_eq!(text, "3 <= x");
    let [left, right, margin] = before.expect("a root has a near side");
    assert!(left == 3.0 && right <= 3.0 && margin <= 0.0 && margin > -1e-9);
    assert!(now[0] == 3.0 && now[2] >= 0.0 && now[2] < 1e-9);
    let (text, before, now) = numbers(&run, &told.shown[1]);
    assert_eq!(text, "y > 2");
    assert!((now[0] - 3.5).abs() < 1e-9 && (now[2] - 1.5).abs() < 1e-9);
    assert!((before.expect("it is shown too")[2] - 1.5).abs() < 1e-9);
}

#[test]
fn scheduled_ones_say_so() {
    let run = explained(
        "agent A { state x = 0  discrete n = 0  flow { x' = 1 }
           tick: every 0.5 when x >= 0.7 { n := n + 1 }  late: after 1.2 when x < 9 { n := 0 }
           slow: after 0.1 when x >= 0.3 { } }
         system { a = A() }  run { until 1.3 }",
    );
    assert_eq!(of(&run, "A.tick").cause, Cause::Every { period: 0.5 });
    assert_eq!(of(&run, "A.late").cause, Cause::After { delay: 1.2 });
    assert_eq!(of(&run, "A.slow").cause, Cause::Flow);
    let (_, before, now) = numbers(&run, &of(&run, "A.tick").shown[0]);
    assert!(before.is_none() && (now[0] - 1.0).abs() < 1e-12 && (now[2] - 0.3).abs() < 1e-12);
}

#[test]
fn true_on_entry_says_so() {
    let run = explained(
        "agent A { state x = 1  flow { x' = 1 }
           initial mode M { first: when x >= 1 -> N }
           mode N { second: when x >= 0.5 -> P }
           mode P { third: when x >= 2 -> Q }  mode Q { } }
         system { a = A() }  run { until 3 }",
    );
    assert_eq!(of(&run, "A.first").cause, Cause::Entry);
    assert_eq!((of(&run, "A.second").cause.clone(), of(&run, "A.second").micro), (Cause::Entry, 1));
    assert_eq!(of(&run, "A.third").cause, Cause::Flow);
}

#[test]
fn what_somebody_wrote_is_named_and_shown_before_and_after() {
    let run = explained(
        "agent Lamp { discrete lit = 0  switch: every 1 { lit := lit + 2 } }
         agent Eye(lamp: Lamp) { state x = 0  discrete n = 0  flow { x' = 0*x }
           sees: when lamp.lit - x > 1 { x := 10 }  done: when x >= 9 { n := 1 } }
         system { lamp = Lamp()  eye = Eye(lamp = lamp) }  run { until 1.5 }",
    );
    let told = of(&run, "Eye.sees");
    assert_eq!(told.cause, Cause::Write { by: vec!["Lamp.switch".into()] });
    let (text, before, now) = numbers(&run, &told.shown[0]);
    assert_eq!(text, "lamp.lit - x > 1");
    assert_eq!((before, now), (Some([0.0, 1.0, -1.0]), [2.0, 1.0, 1.0]));
    let told = of(&run, "Eye.done");
    assert_eq!(told.cause, Cause::Write { by: vec!["Eye.sees".into()] });
    let (_, before, now) = numbers(&run, &told.shown[0]);
    assert_eq!((before, now), (Some([0.0, 9.0, -9.0]), [10.0, 9.0, 1.0]));
}

#[test]
fn pairs_and_those_that_quantifiers_bind_are_named() {
    let run = explained(
        "agent Car(v: real) { state x = 0  discrete n = 0  flow { x' = v }
           near: when exists o in other Car: o.x - x >= 1 { n := n + 1 } }
         interaction Meet(a: Car, b: Car) { far: when abs(a.x - b.x) >= 2 { a.n := 0  b.n := 0 } }
         system { slow = Car(v = 0)  fast = Car(v = 1) }  run { until 3 }",
    );
    let told = of(&run, "Car.near");
    assert_eq!((told.agent.as_str(), told.other.as_str()), ("slow", ""));
    assert_eq!(told.shown.len(), 1);
    assert_eq!(told.shown[0].now.bound, "o = fast");
    let told = of(&run, "Meet.far");
    assert_eq!((told.agent.as_str(), told.other.as_str()), ("slow", "fast"));
    let (text, _, now) = numbers(&run, &told.shown[0]);
    assert_eq!(text, "abs(a.x - b.x) >= 2");
    assert!((now[0] - 2.0).abs() < 1e-9, "the distance, not its square: {now:?}");
}

#[test]
fn a_touch_has_its_guard_its_time_and_why() {
    // thrown up, the ball turns within rounding of the height that is asked for
    let run = explained(
        "agent B { state x = 1, v = 0  flow { x' = v  v' = -10 }
           initial mode F { low: when x <= 0 -> G { x := 0  v := 5 } }
           mode G { up: when x >= 1.25 { } } }
         system { b = B() }  run { until 1.2 }",
    );
    assert_eq!((run.undecided.len(), run.stats.undecided_roots), (1, 1));
    let told = &run.undecided[0];
    assert_eq!((told.transition.as_deref(), told.why), (Some("B.up"), WhyUndecided::Touch));
    let turn = 0.2_f64.sqrt() + 0.5;
    assert!((told.from - turn).abs() < 1e-6 && (told.to - turn).abs() < 1e-6 && told.from <= told.to);
    assert!(told.ends.iter().all(|end| end.right == 1.25 && (end.left - 1.25).abs() < 1e-12));
}

#[test]
fn a_search_given_up_has_its_stretch_and_the_limit() {
    let limits = hyc::runtime::Limits { pieces_max: 100, ..Default::default() };
    let text = "agent A { state x = 0  flow { x' = 0 }
           hit: when sin(1000*time) + cos(1000*time) + time/1000 >= 1.9 { stop } }
         system { a = A() }  run { until 1000 }";
    let run = Case::new(text).limits(limits).run_explained();
    assert_eq!(run.undecided.len() as u64, run.stats.undecided_roots);
    let told = &run.undecided[0];
    assert_eq!((told.from, told.to), (0.0, 1000.0));
    assert_eq!(told.why, WhyUndecided::TooManyPieces { limit: 100 });
    assert_eq!(told.ends[0].left, 1.0);
}

#[test]
fn shipped_models_are_explained_without_a_change() {
    for model in ["bouncing_ball.hy", "thermostat.hy", "two_cars.hy", "two_tanks.hy"] {
        let case = Case::shipped(model);
        let (told, untold) = (case.run_explained(), case.run());
        assert_eq!((told.bits(), &told.stats), (untold.bits(), &untold.stats), "{model}");
        assert_eq!(told.explanations.len(), told.events.len(), "{model}");
    }
}
