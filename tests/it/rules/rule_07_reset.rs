//! Rule 7: after a reset everything is fresh, and nobody else is disturbed.

use crate::harness::{near, simulate};

#[test]
fn rule_07_lets_are_fresh_at_once() {
    let run = simulate(
        "agent A { state x = 0  discrete seen = 0
           let double = 2*x   let more = double + 1
           flow { x' = 0 }
           tick: after 1 { x := 3 }
           react: when more >= 7 { seen := more } }
         system { a = A() }  run { until 2 }",
    );
    assert_eq!(run.log(), ["0 A.tick a", "1 A.react a"]);
    assert_eq!(run.value("a.seen"), 7.0);
}

#[test]
fn rule_07_lets_of_others_are_fresh_at_once() {
    let run = simulate(
        "agent A { state x = 0  let double = 2*x  flow { x' = 0 }  tick: after 1 { x := 3 } }
         agent B { link a: A  discrete seen = 0  let four = if a then 2*a.double else 0
                   react: when four >= 12 { seen := four } }
         system { b = B(a = a)  a = A() }  run { until 2 }",
    );
    assert_eq!(run.log(), ["0 A.tick a", "1 B.react b"]);
    assert_eq!(run.value("b.seen"), 12.0);
}

#[test]
fn rule_07_an_event_of_one_leaves_every_step_of_another() {
    let spiral = "agent Spiral { state x = 1, y = 0  flow { x' = -y - x/10  y' = x - y/10 } }";
    let alone = simulate(&format!("{spiral} system {{ s = Spiral() }} run {{ until 10 }}"));
    let beside = simulate(&format!(
        "{spiral}
         agent Ball {{ state h = 1, v = 0  flow {{ h' = v  v' = -3 }}  bounce: when h <= 0 {{ v := -0.9*v }} }}
         agent Watch {{ near: when exists o in Spiral: o.x <= -0.5 {{ }} }}
         system {{ s = Spiral()  b = Ball()  w = Watch() }} run {{ until 10 }}"
    ));
    assert!(beside.times("Ball.bounce").len() > 5);
    assert_eq!(alone.value("s.x").to_bits(), beside.value("s.x").to_bits());
    assert_eq!(alone.value("s.y").to_bits(), beside.value("s.y").to_bits());
    let steps = |run: &crate::harness::Run| {
        run.stats.types.iter().find(|ty| ty.name == "Spiral").map(|ty| ty.steps).expect("Spiral is counted")
    };
    assert_eq!(steps(&alone), steps(&beside));
}

#[test]
fn rule_07_only_who_was_written_restarts() {
    // an event that writes a discrete which no flow reads changes no step of the agent itself
    let text = |every: &str| {
        format!(
            "agent A {{ state x = 1, y = 0  discrete n = 0  flow {{ x' = -y  y' = x }}  tick: every {every} {{ n := n + 1 }} }}
             system {{ a = A() }}  run {{ until 10 }}"
        )
    };
    let (few, many) = (simulate(&text("3")), simulate(&text("0.01")));
    near(few.value("a.x"), 10f64.cos(), 1e-4);
    near(many.value("a.x"), 10f64.cos(), 1e-4);
    assert_eq!(few.value("a.x").to_bits(), many.value("a.x").to_bits());
}
