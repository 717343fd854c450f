//! What happens when several things happen at once, or one agent reaches into the past of another?

use crate::harness::{all_near, near, simulate};

#[test]
fn simultaneous_events_in_several_agents() {
    // ten balls dropped from the same height, two others between them in number from another
    let run = simulate(
        "agent Ball(h: real) { state x = h, v = 0  flow { x' = v  v' = -2 }  bounce: when x <= 0 { v := -v } }
         system { a = Ball[5](h = 1)  b = Ball[2](h = 4)  c = Ball[5](h = 1) }  run { until 4.5 }",
    );
    // from 1: at 1, 3; from 4: at 2
    let times = run.times("Ball.bounce");
    let expected: Vec<f64> = [vec![1.0; 10], vec![2.0; 2], vec![3.0; 10]].concat();
    all_near(&times, &expected, 1e-11);
    let agents: Vec<&str> = run.events[..10].iter().map(|event| event.agent.as_str()).collect();
    assert_eq!(agents, ["a[0]", "a[1]", "a[2]", "a[3]", "a[4]", "c[0]", "c[1]", "c[2]", "c[3]", "c[4]"]);
    assert!(run.events.iter().all(|event| event.micro == 0), "they share nothing");
    assert_eq!(run.value("a[0].x").to_bits(), run.value("c[4].x").to_bits());
}

#[test]
fn a_cascade_from_agent_to_agent() {
    // dominoes: each falls in the micro-step after its neighbour
    let run = simulate(
        "agent Domino { link before: Domino
           initial mode Up { push: when time >= 1 and not before -> Down
                             fall: when (if before then before is Down else false) -> Down }
           mode Down { } }
         system { d = Domino[6](before = if index >= 1 then d[index - 1] else none) }  run { until 2 }",
    );
    assert_eq!(run.events.len(), 6);
    for (k, event) in run.events.iter().enumerate() {
        assert_eq!((event.agent.as_str(), event.micro), (format!("d[{k}]").as_str(), k));
        assert_eq!(event.time, run.events[0].time);
    }
}

#[test]
fn two_agents_that_swap_through_an_interaction_at_one_instant_with_their_own_transitions() {
    // both own transitions and the interaction are true at 1; the interaction first, by depth, then the others
    // on what it wrote
    let run = simulate(
        "agent A(k: int) { discrete n = 0
           own: when time >= 1 { n := 10*n + k } }
         interaction Meet(a: A, b: A) { pair: when time >= 1 and abs(a.n - b.n) <= 1000 priority 1 { a.n := 5  b.n := 5 } }
         system { a = A(k = 1)  b = A(k = 2) }  run { until 2 }",
    );
    assert_eq!(run.log(), ["0 Meet.pair a b", "1 A.own a", "1 A.own b"]);
    assert_eq!([run.value("a.n"), run.value("b.n")], [51.0, 52.0]);
}

#[test]
fn a_supervisor_wins_the_tie() {
    // the emergency guard of the agent and the routine one of the mode become true at the same root
    let run = simulate(
        "agent A { state x = 0  flow { x' = 1 }
           emergency: when x >= 1 -> Off
           initial mode On { routine: when x >= 1 -> Next }
           mode Next { }
           mode Off { } }
         system { a = A() }  run { until 2 }",
    );
    assert_eq!(run.log(), ["0 A.emergency a On->Off"]);
}

#[test]
fn one_flag_a_pair_a_third_car_in_contact() {
    // p rests beside q (in contact since 0); r comes by at t = 2 and meets q, then p
    let run = simulate(
        "agent Car(v: real) { state x  discrete n = 0  flow { x' = v } }
         interaction Touch(a: Car, b: Car) { pair: when (a.x - b.x)^2 <= 1 { a.n := a.n + 1  b.n := b.n + 1 } }
         system { p = Car(v = 0, x = 0)  q = Car(v = 0, x = 0.5)  r = Car(v = -1, x = 3.5) }  run { until 3.25 }",
    );
    assert_eq!(run.log(), ["0 Touch.pair p q", "0 Touch.pair q r", "0 Touch.pair p r"]);
    all_near(&run.times("Touch.pair"), &[0.0, 2.0, 2.5], 1e-11);
    assert_eq!([run.value("p.n"), run.value("q.n"), run.value("r.n")], [2.0, 2.0, 2.0]);
}

#[test]
fn one_flag_a_pair_contact_again_after_parting() {
    // x = 2 cos t against a post at 0: within 1 of it from pi/3 to 2 pi/3, and from 4 pi/3 to 5 pi/3
    let run = simulate(
        "agent Car { state x = 2  flow { x' = -2*sin(time) } }
         agent Post { discrete n = 0 }
         interaction Touch(c: Car, p: Post) { pair: when c.x^2 <= 1 { p.n := p.n + 1 } }
         system { c = Car()  p = Post() }  run { until 7  tolerance 1e-11 }",
    );
    let pi = std::f64::consts::PI;
    all_near(&run.times("Touch.pair"), &[pi / 3.0, 4.0 * pi / 3.0], 1e-9);
}

#[test]
fn one_of_two_infects_the_other() {
    // sick ones move through a row of healthy ones; each is infected once, when the first sick one is near
    let run = simulate(
        "agent Person(v: real) { state x  discrete sick: bool = false, caught = -1  flow { x' = v } }
         interaction Infect(a: Person, b: Person) {
           near: when a.sick and not b.sick and abs(a.x - b.x) <= 0.5 { b.sick := true  b.caught := time }
         }
         system { healthy = Person[3](v = 0, x = 2*index)  ill = Person(v = 1, x = -2, sick = true) }
         run { until 10 }",
    );
    assert_eq!(
        run.log(),
        ["0 Infect.near ill healthy[0]", "0 Infect.near ill healthy[1]", "0 Infect.near ill healthy[2]"]
    );
    all_near(&run.times("Infect.near"), &[1.5, 3.5, 5.5], 1e-11);
    assert_eq!(run.value("healthy[2].sick"), 1.0);
    near(run.value("healthy[2].caught"), 5.5, 1e-11);
}

#[test]
fn infection_spreads_at_once_through_those_in_contact() {
    let run = simulate(
        "agent Person { state x  discrete sick: bool = false  flow { x' = 0 }
                        start: when time >= 1 and x >= 3 { sick := true } }
         interaction Infect(a: Person, b: Person) { near: when a.sick and not b.sick and abs(a.x - b.x) <= 1 { b.sick := true } }
         system { p = Person[4](x = index) }  run { until 2 }",
    );
    assert_eq!(
        run.log(),
        [
            "0 Person.start p[3]",
            "1 Infect.near p[3] p[2]",
            "2 Infect.near p[2] p[1]",
            "3 Infect.near p[1] p[0]"
        ]
    );
}

#[test]
fn two_who_would_infect_the_same_one_do_it_once() {
    let run = simulate(
        "agent Person(v: real) { state x  discrete sick: bool = false, n = 0  flow { x' = v } }
         interaction Infect(a: Person, b: Person) {
           near: when a.sick and not b.sick and abs(a.x - b.x) <= 1 { b.sick := true  b.n := b.n + 1 }
         }
         system { l = Person(v = 1, x = -3, sick = true)  m = Person(v = 0, x = 0)  r = Person(v = -1, x = 3, sick = true) }
         run { until 5 }",
    );
    assert_eq!(run.log(), ["0 Infect.near l m"]);
    assert_eq!(run.value("m.n"), 1.0);
}

#[test]
fn a_teleport_in_front_of_one_that_has_run_ahead() {
    // straight flows: both may be computed to the end before anything happens. The jump at 1 puts a in b's way.
    let run = simulate(
        "agent A { state x = -100, y = 0  discrete hit = 0
                   flow { x' = 0  y' = 1 }
                   jump: when y >= 1 { x := 9 } }
         agent B { state x = 0  discrete v = 3  flow { x' = v } }
         interaction Crash(a: A, b: B) { pair: when abs(a.x - b.x) <= 1 { b.v := -1  a.hit := b.x } }
         agent C { link b: B  state z = 0  flow { z' = if b then b.x else 0 } }
         system { a = A()  b = B()  c = C(b = b) }  run { until 6 }",
    );
    // b reaches 8 at 8/3, then goes back
    all_near(&run.times("Crash.pair"), &[8.0 / 3.0], 1e-11);
    near(run.value("a.hit"), 8.0, 1e-10);
    near(run.value("b.x"), 8.0 - (6.0 - 8.0 / 3.0), 1e-10);
    // what was computed from b's old future is computed again: z = 3 T^2/2 + 8 (t - T) - (t - T)^2/2
    let (first, rest) = (8.0 / 3.0, 6.0 - 8.0 / 3.0);
    near(run.value("c.z"), 1.5 * first * first + 8.0 * rest - rest * rest / 2.0, 1e-9);
}

#[test]
fn an_event_of_a_fast_one_in_the_middle_of_a_slow_ones_step() {
    // the slow one's guard reads the fast one; the fast one is reset often
    let run = simulate(
        "agent Fast { state x = 0  flow { x' = 10 }  wrap: when x >= 1 { x := 0 } }
         agent Slow { state y = 0  discrete n: int = 0  flow { y' = 1 }
                      see: when exists f in Fast: f.x >= 0.5 { n := n + 1 } }
         system { s = Slow()  f = Fast() }  run { until 2.04 }",
    );
    let expected: Vec<f64> = (0..20).map(|k| 0.1 * f64::from(k) + 0.05).collect();
    all_near(&run.times("Slow.see"), &expected, 1e-10);
    assert_eq!(run.times("Fast.wrap").len(), 20);
}

#[test]
fn cycles_of_events_that_follow_each_other_closely() {
    // three cars on a line, elastic collisions of equal masses: velocities change hands
    let run = simulate(
        "agent Car { state x  discrete v = 0  flow { x' = v } }
         interaction Hit(a: Car, b: Car) { pair: when abs(a.x - b.x) <= 1 { a.v := b.v  b.v := a.v } }
         system { a = Car(x = -4, v = 1)  b = Car(x = 0)  c = Car(x = 1.0001) }  run { until 10 }",
    );
    // a hits b at 3, b hits c 1e-4 later; in the end only c moves
    all_near(&run.times("Hit.pair"), &[3.0, 3.0001], 1e-10);
    assert_eq!([run.value("a.v"), run.value("b.v"), run.value("c.v")], [0.0, 0.0, 1.0]);
    near(run.value("c.x"), 1.0001 + 10.0 - 3.0001, 1e-10);
}

#[test]
fn agents_that_share_an_instant_through_a_third() {
    // both write what m reads at the same time: m's guard sees both at once
    let run = simulate(
        "agent A { discrete n = 0  go: when time >= 1 { n := 1 } }
         agent M { link a: A  link b: A  discrete seen = 0
                   both: when (if a then a.n else 0) + (if b then b.n else 0) >= 2 { seen := 1 } }
         system { m = M(a = a, b = b)  a = A()  b = A() }  run { until 2 }",
    );
    assert_eq!(run.value("m.seen"), 1.0);
    assert_eq!(run.times("M.both").len(), 1);
    near(run.times("M.both")[0], 1.0, 1e-11);
}
