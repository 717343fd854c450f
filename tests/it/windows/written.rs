//! What may happen in the middle of a window, one thing a test, among agents most of which are cold.

use hyc::runtime::paper::Form;

use super::forms::{TOLERANCE, by, difference, same};
use crate::harness::{Ended, near};

/// Numbers that look random, of an agent's index, between 0 and 1.
const HASH: &str = "fn hash(i: real, k: real) = mod(sin(12.9898*(i + 1) + 78.233*k)*43758.5453, 1)";

/// The forms tell the same of a model that may use `hash`.
#[track_caller]
fn alike(text: &str, n_events: usize) -> super::forms::Both {
    same(&format!("{HASH}\n{text}"), n_events)
}

/// Who looks around has comparisons with those only who are near: their number per agent does not grow with the crowd.
#[test]
fn who_looks_around_looks_at_who_is_near() {
    let run = |side: u32| {
        let text = format!(
            "{HASH}
             agent Pod(i: int) {{
               state x = 4*(mod(i, {side}) + hash(i, 0)), y = 4*(floor(i/{side}) + hash(i, 1)), th = 6.28*hash(i, 2)
               discrete met: int = 0, free: int = 0
               flow {{ x' = 2*cos(th)  y' = 2*sin(th)  th' = 0.3 }}
               initial mode Go {{
                 close: when exists o in other Pod: (o.x - x)^2 + (o.y - y)^2 <= 1 -> Shy {{ met := met + 1 }} }}
               mode Shy {{
                 clear: when forall o in other Pod: hypot(o.x - x, o.y - y) >= 1.5 -> Go {{ free := free + 1 }} }} }}
             system {{ pods = Pod[{}](i = index) }}  run {{ until 3 }}",
            side * side
        );
        by(&text, Form::Fast, 1e-6)
    };
    let (few, many) = (run(6), run(18));
    assert!(many.times("Pod.close").len() > 100 && many.times("Pod.clear").len() > 50);
    let per_agent = |run: &crate::harness::Run, n: f64| {
        [run.stats.guard_evaluations as f64 / n, run.stats.pairs_listed as f64 / n]
    };
    for (few, many) in per_agent(&few, 36.0).into_iter().zip(per_agent(&many, 324.0)) {
        assert!(many < 2.0 * few, "{few} an agent of 36, {many} an agent of 324");
    }
}

/// The same of who counts, or adds up, those who are near: where they come and go, are born and die, and are put elsewhere.
#[test]
fn who_counts_those_who_are_near_looks_at_who_is_near() {
    let text = |side: u32, more: &str, end: f64| {
        format!(
            "{HASH}
             agent Pod(i: int) {{
               state x = 4*(mod(i, {side}) + hash(i, 0)), y = 4*(floor(i/{side}) + hash(i, 1)), th = 6.28*hash(i, 2)
               discrete crowded: int = 0, drawn: int = 0, close: int = 0, w = 1 + hash(i, 3)
               flow {{ x' = 2*cos(th)  y' = 2*sin(th)  th' = 0.3 }}
               many: when (count o in other Pod where (o.x - x)^2 + (o.y - y)^2 <= 4) >= 2 {{ crowded := crowded + 1 }}
               pull: when (sum o in other Pod where hypot(o.x - x, o.y - y) <= 3: o.w*(o.x - x)) >= 1.5 {{ drawn := drawn + 1 }}
               tight: when (min o in other Pod where abs(o.x - x) <= 1 and abs(o.y - y) <= 1: o.w) <= 1.4 {{ close := close + 1 }}
               {more} }}
             system {{ pods = Pod[{}](i = index) }}  run {{ until {end} }}",
            side * side
        )
    };
    let run = |side: u32| by(&text(side, "", 2.0), Form::Fast, 1e-6);
    let (few, many) = (run(6), run(18));
    for transition in ["Pod.many", "Pod.pull", "Pod.tight"] {
        assert!(many.times(transition).len() > 50, "{transition}");
    }
    let per_agent = |run: &crate::harness::Run, n: f64| {
        [run.stats.guard_evaluations as f64 / n, run.stats.pairs_listed as f64 / n]
    };
    for (few, many) in per_agent(&few, 36.0).into_iter().zip(per_agent(&many, 324.0)) {
        assert!(many < 2.0 * few, "{few} an agent of 36, {many} an agent of 324");
    }
    let more = "jump: every 0.3 + 0.1*hash(i, 4) { x := 28*hash(i, time)  w := 1 + hash(i, 5*time) }
                bud: every 0.7 when mod(i, 9) == 0 { create Pod(i = i + 50, x = x + 0.3, y = y) }
                die: after 0.5 + hash(i, 6) when mod(i, 5) == 0 { destroy self }";
    same(&text(7, more, 1.5), 200);
}

#[test]
fn a_ring_road_whose_end_is_its_begin() {
    let both = alike(
        "agent Car(i: int) { state x = 10*i + 3*hash(i, 0)  discrete v = 1 + 2*hash(i, 1), met: int = 0
           flow { x' = v }
           turn: when x >= 1000 { x := x - 1000 } }
         interaction Near(a: Car, b: Car) { pair: when abs(a.x - b.x) <= 0.75 { a.met := a.met + 1  b.met := b.met + 1 } }
         system { cars = Car[100](i = index) }  run { until 120 }",
        300,
    );
    assert!(both.plain.times("Car.turn").len() > 5);
}

/// What a car has run ahead beyond the instant at which it is turned says nothing of where it gets to.
#[test]
fn cars_that_are_turned_while_they_have_run_ahead_are_met_in_time() {
    for k in [1, 2] {
        let text = format!(
            "{HASH}
             agent Car(i: int) {{
               state x = 4*mod(i, 10) - 18, y = 4*floor(i/10) - 18, th = 6.28*hash(i, {k})
               discrete v = 0.2 + 0.8*hash(i, 1), w = 2 + 4*hash(i, 2)
               flow {{ x' = v*cos(th)  y' = v*sin(th)  th' = 0.5*w*sin(w*time + i) }}
               when abs(x) >= 20 or abs(y) >= 20 {{ th := atan2(-y, -x) }} }}
             interaction Bump(a: Car, b: Car) {{
               pair: when (a.x - b.x)^2 + (a.y - b.y)^2 <= 1 {{
                 a.th := atan2(a.y - b.y, a.x - b.x)  b.th := atan2(b.y - a.y, b.x - a.x) }} }}
             system {{ cars = Car[100](i = index) }}  run {{ until 40 }}"
        );
        let [fast, plain] = [Form::Fast, Form::Plain].map(|form| by(&text, form, 1e-6));
        assert!(plain.events.len() > 200);
        assert_eq!(difference(&fast, &plain, f64::INFINITY), None);
    }
}

/// Cars of very different speeds, some of which jump or change their speed while others run ahead beside them.
#[test]
fn cars_that_jump_and_change_their_speed_in_a_dense_arena() {
    for (k, own) in [
        "kick: every 0.7 + 0.3*hash(i, 9) { v := 0.2 + mod(3.7*v + 0.31, 1.3) }",
        "jump: every 2.1 + hash(i, 5) { x := -x + 0.7 }",
        "rest: every 1.3 + hash(i, 6) { w := 0.3 + mod(1.7*w, 5) }",
    ]
    .iter()
    .enumerate()
    {
        let text = format!(
            "{HASH}
             agent Car(i: int) {{
               state x = 4*mod(i, 8) - 14, y = 4*floor(i/8) - 14, th = 6.28*hash(i, {k})
               discrete v = 0.2*10^hash(i, 1), w = 0.5*40^hash(i, 2)
               flow {{ x' = v*cos(th)  y' = v*sin(th)  th' = 0.5*w*sin(w*time + i) }}
               {own}
               when abs(x) >= 16 or abs(y) >= 16 {{ th := atan2(-y, -x) }} }}
             interaction Bump(a: Car, b: Car) {{
               pair: when (a.x - b.x)^2 + (a.y - b.y)^2 <= 1 {{
                 a.th := atan2(a.y - b.y, a.x - b.x)  b.th := atan2(b.y - a.y, b.x - a.x) }} }}
             system {{ cars = Car[64](i = index) }}  run {{ until 15 }}"
        );
        let [fast, plain] = [Form::Fast, Form::Plain].map(|form| by(&text, form, 1e-10));
        assert!(plain.events.len() > 100, "{}", plain.events.len());
        assert_eq!(difference(&fast, &plain, f64::INFINITY), None);
    }
}

#[test]
fn a_jump_beside_a_cold_agent_fires_at_once() {
    let both = alike(
        "agent Rock(i: int) { state x = 5*i + hash(i, 2), y = 0  flow { x' = 0.01*hash(i, 0)  y' = 0.01 } }
         agent Flea(i: int) { state x = -50 - i, y = 0  discrete n: int = 0
           flow { x' = 0.1  y' = 0.01 }
           jump: every 0.37 + 0.01*i { x := 5*floor(60*hash(i + n, 3)) + 0.4 + hash(n, 4)  n := n + 1 } }
         interaction Sits(a: Flea, b: Rock) {
           pair: when (a.x - b.x)^2 + (a.y - b.y)^2 <= 0.5^2 { a.n := a.n + 1 } }
         interaction Two(a: Flea, b: Flea) { pair: when (a.x - b.x)^2 + (a.y - b.y)^2 <= 0.7^2 { a.y := a.y + 0.01 } }
         system { rocks = Rock[60](i = index)  fleas = Flea[8](i = index) }  run { until 12 }",
        200,
    );
    let sits = both.plain.events.iter().filter(|event| event.transition == "Sits.pair");
    assert!(sits.filter(|event| event.micro >= 1).count() > 20, "at once");
}

#[test]
fn a_jump_into_the_midst_of_several() {
    alike(
        "agent Dot(i: int) { state x = 3*hash(i, 0), y = 3*hash(i, 1)  discrete met: int = 0
           flow { x' = 0.02*sin(i)  y' = 0.02*cos(3*i) } }
         agent Guest { state x = 500, y = 1.5  flow { x' = -1  y' = 0 }
           visit: when x <= 490 { x := 1.5 }
           back: when x <= -2 { x := 495 } }
         interaction Meets(g: Guest, d: Dot) {
           pair: when (g.x - d.x)^2 + (g.y - d.y)^2 <= 0.8^2 { d.met := d.met + 1 } }
         system { dots = Dot[60](i = index)  guest = Guest() }  run { until 40 }",
        60,
    );
}

#[test]
fn participants_are_written_in_mid_window() {
    // states, discretes, and both, of one or of both
    for actions in [
        "a.u := -a.u  b.u := -b.u",
        "a.x := a.x - 3  b.x := b.x + 3",
        "a.u := 1.1*b.v  b.x := b.x + 0.5*a.v",
        "b.u := 0.3*b.u + 0.1",
    ] {
        alike(
            &format!(
                "agent Disc(i: int) {{ state x = 40*hash(i, 0), y = 40*hash(i, 1)
                   discrete u = 4*hash(i, 2) - 2, v = 4*hash(i, 3) - 2
                   flow {{ x' = u  y' = v }} }}
                 interaction Hit(a: Disc, b: Disc) {{
                   pair: when (a.x - b.x)^2 + (a.y - b.y)^2 <= 1 {{ {actions} }} }}
                 system {{ discs = Disc[60](i = index) }}  run {{ until 8 }}"
            ),
            30,
        );
    }
}

#[test]
fn a_discrete_write_wakes_guards_of_cold_agents() {
    alike(
        "agent Lamp(i: int) { state x = i  discrete k: int = 0  flow { x' = 0.1*hash(i, 0) }
           turn: every 2 + 7*hash(i, 1) { k := mod(k + 1, 3) } }
         agent Eye(i: int, lamp: Lamp, dim: Lamp) { state y = hash(i, 3)  discrete seen: int = 0, n: int = 0
           flow { y' = -0.2*y }
           see: when lamp.k == 2 { seen := seen + 1 }
           both: when lamp.k == 1 and dim.k == 2 and y < 0.7 { seen := seen + 100 } }
         agent Chief { state z = 0  discrete twos: int = 0
           flow { z' = cos(z) }
           some: when exists o in Lamp where o.k == 2: o.x >= 20 { twos := twos + 1 }
           many: when (count o in Lamp where o.k == 2) >= 20 { twos := twos + 100 }
           no: when forall o in Lamp where o.k == 2: o.x < 25 { twos := twos + 10000 } }
         system { lamps = Lamp[40](i = index)
                  eyes = Eye[80](i = index, lamp = lamps[mod(index, 40)], dim = lamps[mod(7*index + 3, 40)])
                  chief = Chief() }
         run { until 20 }",
        200,
    );
}

#[test]
fn others_of_the_same_type_are_woken() {
    alike(
        "agent A(i: int) { state x = 3*i, y = 0  discrete k: int = 0, n: int = 0
           flow { x' = sin(i)  y' = -0.1*y + 1 }
           tick: every 1 + 5*hash(i, 0) { k := mod(k + 1, 3) }
           near: when exists o in other A where o.k == 2: abs(o.x - x) <= 2.5 { n := n + 1 }
           crowd: when (count o in other A where o.k == 2) >= 12 { n := n + 100 } }
         system { a = A[40](i = index) }  run { until 9 }",
        100,
    );
}

#[test]
fn a_mode_change_that_makes_a_cold_agent_fast() {
    alike(
        "agent Snail(i: int) { state x = 20*i, y = 0
           flow { y' = 0.1 }
           initial mode Slow { flow { x' = 0.01 }  wake: after 1 + 9*hash(i, 0) -> Fast }
           mode Fast { flow { x' = 100 }  rest: after 0.05 + 0.9*hash(i, 1) -> Slow } }
         interaction Meet(a: Snail, b: Snail) { pair: when abs(a.x - b.x) <= 0.3 { a.y := a.y + 1  b.y := b.y + 1 } }
         system { snails = Snail[60](i = index) }  run { until 10 }",
        150,
    );
    // by a parameter of the flow that another agent's event writes
    alike(
        "agent Snail(i: int) { state x = 20*i  discrete v = 0.01  flow { x' = v } }
         agent Whip { state y = -1  discrete n: int = 0  flow { y' = 7 }
           crack: when y >= 20*n { n := n + 1 } }
         interaction Hit(w: Whip, s: Snail) { pair: when abs(w.y - s.x) <= 0.2 { s.v := 50 } }
         interaction Meet(a: Snail, b: Snail) { pair: when abs(a.x - b.x) <= 0.3 { a.v := 0.02 } }
         system { snails = Snail[50](i = index)  whip = Whip() }  run { until 10 }",
        40,
    );
}

#[test]
fn entry_and_exit_actions() {
    alike(
        "agent A(i: int) { state x = hash(i, 0), y = 0  discrete n: int = 0, v = 0.5
           flow { y' = v }
           initial mode Up { entry { n := n + 1  v := v + 0.1 }  exit { y := y - 0.5 }
             flow { x' = 1 - 0.2*x }  go: when x >= 1 + hash(i, 1) -> Down { x := x + 0.2 } }
           mode Down { entry { v := -v }  exit { n := n + 10 }
             flow { x' = -x }  back: when x <= 0.3 -> Up } }
         interaction Meet(a: A, b: A) { pair: when abs(a.y - b.y) <= 0.01 and a.n != b.n { a.v := a.v + 0.05 } }
         system { a = A[50](i = index) }  run { until 8 }",
        200,
    );
}

#[test]
fn timers_of_cold_agents() {
    alike(
        "agent A(i: int) { state x = hash(i, 0), y = 1  discrete n: int = 0
           flow { y' = -0.3*y }
           beat: every 0.5 + 3*hash(i, 1) { n := n + 1 }
           high: every 0.4 + hash(i, 2) when x > 2 { n := n + 10 }
           initial mode Up { flow { x' = 0.7 }  go: after 1 + 3*hash(i, 3) -> Down }
           mode Down { flow { x' = -0.2*x }
             back: after 0.2 + hash(i, 4) when x <= 1.1 -> Up { x := x - 0.5 } } }
         system { a = A[60](i = index) }  run { until 12 }",
        300,
    );
}

#[test]
fn groups_that_a_mode_makes_and_leaves() {
    let both = alike(
        "agent A(i: int, lead: A) { state x = 2*i, y = 0
           initial mode Alone { flow { x' = 1 + 0.3*sin(i)  y' = 1 }
             join: when y >= 1 + 3*hash(i, 0) -> Follow }
           mode Follow { flow { x' = 0.8*(lead.x - x) + 1  y' = -1 }
             part: when y <= hash(i, 1) -> Alone } }
         interaction Meet(a: A, b: A) { pair: when abs(a.x - b.x) <= 0.1 { a.y := a.y + 0.01 } }
         system { a = A[40](i = index, lead = a[mod(index + 1, 40)]) }  run { until 15 }",
        200,
    );
    assert!(both.plain.times("A.part").len() > 40);
}

#[test]
fn a_stop_in_mid_window() {
    for when in ["0.003", "1.2345", "7.77"] {
        let both = alike(
            &format!(
                "agent A(i: int) {{ state x = i, y = 1  flow {{ x' = sin(time + i)  y' = -y*x/(1 + x^2) }} }}
                 agent End {{ state s = 0  flow {{ s' = 1 }}  done: when s >= {when} {{ stop \"enough\" }} }}
                 interaction Meet(a: A, b: A) {{ pair: when abs(a.x - b.x) <= 0.3 {{ a.y := a.y + 1 }} }}
                 system {{ a = A[50](i = index)  last = End() }}  run {{ until 10 }}"
            ),
            1,
        );
        assert!(matches!(both.fast.end, Ended::Stop { .. }));
        assert!(both.fast.finals.iter().all(|last| last.time == both.fast.time));
        // x' = sin(t + i)
        let time = both.fast.time;
        near(both.fast.value("a[7].x"), 7.0 + 7f64.cos() - (time + 7.0).cos(), 1e-9);
    }
    // by an interaction, with what it writes
    alike(
        "agent A(i: int) { state x = i, y = 1  flow { x' = 2*hash(i, 0)  y' = -0.3*y } }
         interaction Meet(a: A, b: A) { pair: when abs(a.x - b.x) <= 0.02 { a.y := 5  stop \"met\" } }
         system { a = A[50](i = index) }  run { until 10 }",
        1,
    );
}

/// Agents on circles of their own, most of them alone, with meetings and jumps.
fn circles(run: &str) -> String {
    format!(
        "{HASH}
         agent A(i: int) {{ state x = 30*hash(i, 0), y = 30*hash(i, 1), th = 6*hash(i, 2)
           discrete v = 1 + hash(i, 3), n: int = 0
           flow {{ x' = v*cos(th)  y' = v*sin(th)  th' = 0.5 + hash(i, 4) }}
           hop: every 3 + 5*hash(i, 5) {{ x := 30*hash(i + n, 6)  n := n + 1 }} }}
         interaction Meet(a: A, b: A) {{
           pair: when (a.x - b.x)^2 + (a.y - b.y)^2 <= 0.8^2 {{ a.n := a.n + 1  b.n := b.n + 1 }} }}
         system {{ a = A[60](i = index) }}
         run {{ until 10  {run} }}"
    )
}

#[test]
fn records_have_the_same_samples_and_change_no_bit() {
    let without = by(&circles(""), Form::Fast, TOLERANCE);
    assert!(without.events.len() > 60);
    for every in ["0.013", "0.5", "3.3"] {
        let both = same(&circles(&format!("record A, A.n every {every} to \"a.csv\"")), 60);
        assert!(both.fast.samples[0].len() >= 60 * 4);
        assert_eq!(both.fast.bits(), without.bits(), "a record every {every} changes the run");
    }
}

#[test]
fn a_record_of_every_step_is_one_of_the_plain_form() {
    let both = same(&circles("record A to \"a.csv\""), 60);
    let once = by(&circles("record A to \"a.csv\""), Form::Fast, TOLERANCE);
    assert_eq!(both.fast.samples, once.samples);
}

#[test]
fn a_run_twice_gives_the_same_bits() {
    // each run is one by the interpreter and one by machine code already
    let runs = [(); 2].map(|()| by(&circles("record A every 0.5 to \"a.csv\""), Form::Fast, TOLERANCE));
    assert_eq!(runs[0].bits(), runs[1].bits());
    assert_eq!(runs[0].samples, runs[1].samples);
    assert_eq!(runs[0].stats, runs[1].stats);
}

#[test]
fn asserts_and_invariants_of_cold_agents() {
    let model = |bound: f64| {
        format!(
            "{HASH}
             agent A(i: int) {{ state x = hash(i, 0), y = 0  flow {{ x' = 0.3*x  y' = cos(time + i) }}
               assert x <= 5 \"small\"
               initial mode M {{ invariant y >= -{bound} \"above\" }} }}
             system {{ a = A[60](i = index) }}  run {{ until 8 }}"
        )
    };
    let both = same(&model(5.0), 0);
    assert!(!both.fast.false_asserts.is_empty());
    let [fast, plain] = [Form::Fast, Form::Plain].map(|form| by(&model(1.5), form, TOLERANCE));
    let (Ended::Error(one), Ended::Error(other)) = (&fast.end, &plain.end) else { panic!("{:?}", plain.end) };
    assert_eq!(one.code, other.code);
    near(fast.time, plain.time, 1e-9);
    assert_eq!(one.title, other.title);
}

#[test]
fn no_pairs_at_all() {
    alike(
        "agent A(i: int) { state x = 0.5 + hash(i, 0), v = 0  flow { x' = v  v' = -9.81 }
           bounce: when x <= 0 { v := -0.9*v } }
         system { a = A[80](i = index) }  run { until 1.5 }",
        100,
    );
}

#[test]
fn agents_without_states() {
    alike(
        "agent Clock(i: int) { discrete n: int = 0  tick: every 0.5 + hash(i, 0) { n := n + 1 } }
         agent A(i: int, clock: Clock) { state x = 0  discrete k: int = 0  flow { x' = 0.5 + hash(i, 1) }
           five: when clock.n >= 5 and x >= 2 { k := k + 1  x := 0 } }
         interaction Pair(c: Clock, a: A) { pair: when c.n >= 6 and a.x >= 4 { c.n := 0 } }
         system { clocks = Clock[30](i = index)  a = A[60](i = index, clock = clocks[mod(index, 30)]) }  run { until 10 }",
        300,
    );
}

#[test]
fn agents_at_the_very_same_place() {
    alike(
        "agent A(i: int) { state x = 3*floor(i/3), y = 0  discrete v = 0.3*hash(i, 0), n: int = 0
           flow { x' = v  y' = 0.1*sin(x) } }
         interaction Meet(a: A, b: A) { pair: when (a.x - b.x)^2 + (a.y - b.y)^2 <= 0.5^2 { a.n := a.n + 1  b.n := b.n + 1 } }
         interaction Part(a: A, b: A) { pair: when abs(a.x - b.x) >= 1 and abs(a.x - b.x) <= 1.1 { a.n := a.n + 100 } }
         system { a = A[45](i = index) }  run { until 20 }",
        80,
    );
}

#[test]
fn compound_conditions_and_asymmetric_pairs() {
    alike(
        "agent Fox(i: int) { state x = 50*hash(i, 0), y = 50*hash(i, 1), th = 6*hash(i, 2)
           discrete v = 2, ate: int = 0
           flow { x' = v*cos(th)  y' = v*sin(th)  th' = 0.7*sin(time + i) } }
         agent Hen(i: int) { state x = 50*hash(i, 3), y = 50*hash(i, 4), e = 1
           discrete v = hash(i, 5), fled: int = 0
           flow { x' = v*cos(0.3*i)  y' = v*sin(0.3*i)  e' = -0.05*e } }
         interaction Hunt(f: Fox, h: Hen) {
           eat: when (f.x - h.x)^2 + (f.y - h.y)^2 <= 0.6^2 and h.e <= 0.9 { f.ate := f.ate + 1  h.x := h.x + 7 }
           scare: when hypot(f.x - h.x, f.y - h.y) <= 3 and f.v > h.v { h.fled := h.fled + 1  h.v := h.v + 0.3 } }
         interaction Flock(a: Hen, b: Hen) { pair: when abs(a.x - b.x) <= 1 and abs(a.y - b.y) <= 0.5 and a.v > b.v { b.v := a.v } }
         interaction Foxes(a: Fox, b: Fox) { pair: when (a.x - b.x)^2 + (a.y - b.y)^2 <= 1.5 { a.v := 1.9  b.v := 2.1 } }
         system { foxes = Fox[15](i = index)  hens = Hen[60](i = index) }  run { until 25 }",
        80,
    );
}

#[test]
fn distances_in_one_two_and_three_dimensions() {
    for (states, side) in [(&["x"][..], 800), (&["x", "y"], 40), (&["x", "y", "z"], 14)] {
        let each = |what: &dyn Fn(usize, &str) -> String| -> Vec<String> {
            states.iter().enumerate().map(|(k, name)| what(k, name)).collect()
        };
        let start = each(&|k, name| format!("{name} = {side}*hash(i, {k})")).join(", ");
        let rates = each(&|k, name| format!("{name}' = 3*hash(i, {}) - 1.5", k + 5)).join("  ");
        let walls = each(&|_, name| {
            format!(
                "hi_{name}: when {name} >= {side} {{ {name} := {name} - {side} }}
                     lo_{name}: when {name} <= -0.1 {{ {name} := {name} + {side} }}"
            )
        });
        let distance = each(&|_, name| format!("(a.{name} - b.{name})^2")).join(" + ");
        alike(
            &format!(
                "agent A(i: int) {{ state {start}  discrete n: int = 0  flow {{ {rates} }}  {} }}
                 interaction Meet(a: A, b: A) {{ pair: when {distance} <= 1 {{ a.n := a.n + 1  b.n := b.n + 1 }} }}
                 interaction Wide(a: A, b: A) {{ pair: when {distance} <= 2.5^2 and a.n >= b.n + 2 {{ b.n := b.n + 1 }} }}
                 system {{ a = A[100](i = index) }}  run {{ until 8 }}",
                walls.join("\n")
            ),
            60,
        );
    }
}

/// Bounds of rates hold from where they were found on; a list of near pairs is made between two steps of agents that have come
/// further.
#[test]
fn who_comes_near_while_others_are_ahead_is_listed() {
    let run = alike(
        "agent A { state x, y = 0, th, z = 0
           flow { x' = 5*cos(th)  y' = 5*sin(th)  th' = 0.4  z' = abs(x) } }
         interaction I(a: A, b: A) { i: when (a.x - b.x)^2 + (a.y - b.y)^2 <= 0.64 { } }
         system { a = A(x = -0.5, th = 0)  b = A(x = 3, th = 3.14) }
         run { until 2 }",
        1,
    );
    near(run.fast.times("I.i")[0], 0.271_858_295_52, 1e-6);
    let run = alike(
        "agent B { state x = 0  flow { x' = 1 } }
         agent A(x0: real) { state x = x0, y = 0.5  discrete seen = 0
           flow { x' = 0.15*y  y' = 0.3 + 0.05*floor(x) }
           g: when x >= 1.7 { seen := x  y := 0 } }
         system { ramp = B()  a = A[2](x0 = 1.6 + 0.01*index) }
         run { until 5 }",
        2,
    );
    // 1.6 + 0.075 t + 0.02625 t^2 = 1.7
    let reached = |rest: f64| (-0.075 + (0.075_f64.powi(2) + 4.0 * 0.02625 * rest).sqrt()) / (2.0 * 0.02625);
    near(run.fast.times_of("A.g", "a[0]")[0], reached(0.1), 1e-6);
    near(run.fast.times_of("A.g", "a[1]")[0], reached(0.09), 1e-6);
}

/// Cars on arcs, whose ways another state integrates: their rates are bounded by what is known of their states.
#[test]
fn a_dense_arena_with_integrals_of_the_ways() {
    alike(
        "agent Car(i: int) {
           state x = 3*(mod(i, 8) + hash(i, 0)), y = 3*(floor(i/8) + hash(i, 1)), th = 6.28*hash(i, 2), z = 0
           discrete met: int = 0
           flow { x' = 2*cos(th)  y' = 2*sin(th)  th' = 0.8*cos(time + 3*hash(i, 3))  z' = abs(x - 12) + 0.1*y } }
         interaction I(a: Car, b: Car) {
           i: when (a.x - b.x)^2 + (a.y - b.y)^2 <= 0.64 { a.met := a.met + 1  b.met := b.met + 1 } }
         system { cars = Car[64](i = index) }  run { until 4 }",
        30,
    );
}

#[test]
fn a_stiff_crowd_is_found_to_be_stiff() {
    let text = "agent A { state a = 1, b = 0, c = 0
           flow { a' = -0.04*a + 1e4*b*c  b' = 0.04*a - 1e4*b*c - 3e7*b^2  c' = 3e7*b^2 } }
         system { a = A[20]() }  run { until 10 }";
    let [fast, plain] = [Form::Fast, Form::Plain].map(|form| by(text, form, TOLERANCE).stats);
    let stiff =
        |stats: &hyc::runtime::observe::Stats| stats.methods.iter().find(|m| m.0 == "stiff").unwrap().1;
    assert!(stiff(&fast) > 100);
    assert!(fast.steps < 8 * plain.steps, "{} steps, {} in the plain form", fast.steps, plain.steps);
}

/// Who is born in an instant has the lists made anew: who was near in it, and is not any more, is not forgotten before its end.
#[test]
fn a_birth_in_the_instant_in_which_somebody_comes_and_goes() {
    let both = alike(
        "agent A { state x = 0  discrete k: int = 0  flow { x' = 0 }
           j1: when k == 0 { x := 10  k := 1 }
           j2: when k == 1 { x := 20  k := 2 } }
         agent B { state x = 10  flow { x' = 0 }
           far: when forall o in A: (o.x - x)^2 >= 1 { }
           near: when exists o in A: (o.x - x)^2 <= 0.1 { create B(x = -100) } }
         system { a = A()  b = B() }  run { until 2 }",
        6,
    );
    assert_eq!(both.fast.times_of("B.far", "b"), [0.0, 0.0]);
}

/// Who belongs to a sum is known before what the sum comes to: when it is armed, and in the micro-step of a write.
#[test]
fn a_sum_of_those_who_are_near_from_the_first_instant_on() {
    let run = alike(
        "agent A { state x = 0.5*index + 0.5  flow { x' = 0 }
           g: when (sum o in other A where abs(o.x - x) <= 2: o.x) <= 0.4 { } }
         system { a = A[2]() }  run { until 0.5 }",
        0,
    );
    assert!(run.fast.events.is_empty());
    let run = alike(
        "agent A(p: real) { state x = 2, y = 4  discrete n: int = 0  flow { x' = 0  y' = 0 }
           undo: when y <= -3 and time >= 1.5 and p == 0.5 { y := -y }
           near: when (sum o in other A where abs(o.y - y) <= 1: o.x) >= 1 { n := n + 1 }
           tk: every p { y := -y } }
         system { a = A(p = 0.5)  b = A(p = 1.25) }  run { until 1.6 }",
        4,
    );
    let near = run.fast.events.iter().filter(|event| event.transition == "A.near" && event.time == 1.5);
    assert_eq!(near.map(|event| event.micro).collect::<Vec<_>>(), [1]);
}

/// Those of the first type are slow when the pairs are listed, and fast from a kink of their flow on.
#[test]
fn who_becomes_fast_at_a_kink_is_listed_there() {
    let both = alike(
        "agent A(x0: real) { state x: real = x0  discrete n: int = 0  flow { x' = if x > 0 then 300 else 1 } }
         agent B(x0: real) { state x: real = x0  discrete n: int = 0  flow { x' = 0 } }
         interaction hit(a: A, b: B) { near: when abs(a.x - b.x) <= 1 { a.n := a.n + 1  b.n := b.n + 1 } }
         system { a = A[3](x0 = -1.01 - 0.3*index)  b = B[5](x0 = 100*(index + 1)) }
         run { until 100 }",
        15,
    );
    assert_eq!(both.fast.value("a[0].n"), 5.0);
}
