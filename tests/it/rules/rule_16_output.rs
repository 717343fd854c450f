//! Rule 16: what is recorded changes nothing, and what a sample shows.

use crate::harness::{Case, all_near, near, simulate};

/// Two agents with events of several sorts, and what `run` says besides.
fn model(run: &str) -> String {
    format!(
        "agent Ball {{ state x = 1, v = 0  let energy = v^2/2 + 3*x
           flow {{ x' = v  v' = -3 }}  bounce: when x <= 0 {{ v := -0.9*v }} }}
         agent Turn {{ state p = 1, q = 0  discrete n = 0  flow {{ p' = -q - p/20  q' = p - q/20 }}
           low: when p <= -0.5 {{ n := n + 1 }}  tick: every 0.7 {{ q := 0.99*q }} }}
         system {{ ball = Ball()  turn = Turn()  more = Turn[4]() }}
         run {{ until 6  tolerance 1e-7  {run} }}"
    )
}

#[test]
fn rule_16_recording_changes_no_bit() {
    let plain = simulate(&model(""));
    assert!(plain.events.len() > 10);
    for record in [
        "record ball, turn to \"a.csv\"",
        "record ball, turn every 0.01 to \"a.csv\"",
        "record ball.x every 0.7 to \"a.csv\"  record turn every 0.1 to \"b.csv\"",
        "record Ball.energy every 1 to \"a.csv\"",
    ] {
        let recorded = simulate(&model(record));
        assert_eq!(plain.bits(), recorded.bits(), "{record}");
        assert_eq!(plain.stats.steps, recorded.stats.steps, "{record}");
        assert!(!recorded.samples[0].is_empty());
    }
}

#[test]
fn rule_16_samples_lie_at_multiples() {
    let run = simulate(&model("record turn.p every 0.1 to \"a.csv\""));
    let times: Vec<f64> = run.column("turn", 0).iter().map(|sample| sample.0).collect();
    assert_eq!(times.len(), 61);
    for (k, time) in times.iter().enumerate().take(60) {
        assert_eq!(*time, k as f64 * 0.1);
    }
    assert_eq!(times[60], 6.0);
}

#[test]
fn rule_16_the_sample_at_the_end_is_there() {
    let run = Case::new(
        "agent A { state x = 0  flow { x' = 1 } }  system { a = A() }
         run { until 0.3  record a.x every 0.1 to \"a.csv\" }",
    )
    .run();
    let samples = run.column("a", 0);
    assert_eq!(samples.iter().map(|sample| sample.0).collect::<Vec<_>>(), [0.0, 0.1, 0.2, 0.3]);
    near(samples[3].1, 0.3, 1e-15);
}

#[test]
fn rule_16_samples_are_right_limits() {
    let run = simulate(
        "agent A { state x = 0  discrete n = 0  flow { x' = 1 }
                   tick: every 1 { x := 10*n  n := n + 1 } }
         system { a = A() }  run { until 2  record a.x, a.n every 1 to \"a.csv\" }",
    );
    assert_eq!(run.column("a", 0), [(0.0, 0.0), (1.0, 0.0), (2.0, 10.0)]);
    assert_eq!(run.column("a", 1), [(0.0, 0.0), (1.0, 1.0), (2.0, 2.0)]);
    let micros: Vec<usize> = run.samples[0].iter().map(|sample| sample.micro).collect();
    assert_eq!(micros, [0, 1, 1]);
}

#[test]
fn rule_16_a_sample_at_the_root_of_an_event() {
    // x reaches 1 at t = 1, where a sample lies: it shows what is after the event
    let run = simulate(
        "agent A { state x = 0  flow { x' = 1 }  jump: when x >= 1 { x := 5 } }
         system { a = A() }  run { until 2  record a.x every 0.5 to \"a.csv\" }",
    );
    let samples = run.column("a", 0);
    near(samples[1].1, 0.5, 1e-12);
    near(samples[3].1, 5.5, 1e-11);
    near(samples[4].1, 6.0, 1e-11);
}

#[test]
fn rule_16_every_step_and_both_sides_of_every_event() {
    let run = simulate(&model("record ball to \"a.csv\""));
    let samples = &run.samples[0];
    assert!(samples.windows(2).all(|pair| (pair[0].time, pair[0].micro) <= (pair[1].time, pair[1].micro)));
    for bounce in run.times("Ball.bounce") {
        let sides: Vec<&crate::harness::Sample> =
            samples.iter().filter(|sample| sample.time == bounce).collect();
        assert_eq!(sides.len(), 2, "at {bounce}");
        assert_eq!([sides[0].micro, sides[1].micro], [0, 1]);
        assert!(sides[0].cells[1] < 0.0 && sides[1].cells[1] > 0.0, "{sides:?}");
    }
    assert_eq!(samples[0].time, 0.0);
    assert_eq!(samples.last().map(|sample| sample.time), Some(6.0));
}

#[test]
fn rule_16_lets_modes_and_links_can_be_recorded() {
    let run = simulate(
        "agent A { link next: A  state x = 0  let double = 2*x  let big = x >= 1
           initial mode Low { flow { x' = 1 }  up: when x >= 0.9 -> High }
           mode High { flow { x' = 2 } } }
         system { a = A(next = b)  b = A() }
         run { until 2  record a.double, a.big, a.next, a.x every 1 to \"a.csv\" }",
    );
    let rows = &run.samples[0];
    assert_eq!(rows.len(), 3);
    assert_eq!(rows.iter().map(|row| row.mode.as_str()).collect::<Vec<_>>(), ["Low", "High", "High"]);
    // columns in declared order: next, x, double, big
    let flat: Vec<f64> = rows.iter().flat_map(|row| row.cells.clone()).collect();
    all_near(&flat, &[1.0, 0.0, 0.0, 0.0, 1.0, 1.1, 2.2, 1.0, 1.0, 3.1, 6.2, 1.0], 1e-10);
}

#[test]
fn rule_16_units_of_columns_are_the_declared_ones() {
    let run = simulate(
        "agent A(a: real [km/h]) { state x: real [km] = 0, v: real [km/h] = a  flow { x' = v  v' = 0 } }
         system { c = A(a = 36) }  run { until 100 [s]  record c every 50 [s] to \"a.csv\" }",
    );
    // 36 km/h for 100 s is 1 km
    near(run.value("c.x"), 1.0, 1e-12);
    near(run.value("c.v"), 36.0, 1e-12);
    let last = run.samples[0].last().expect("three samples");
    assert!(
        last.cells.iter().any(|cell| (cell - 36.0).abs() < 1e-12)
            && last.cells.iter().any(|cell| (cell - 1.0).abs() < 1e-12)
    );
}

#[test]
fn rule_16_who_runs_ahead_does_so_whether_every_step_is_recorded_or_not() {
    let model = |run: &str| {
        format!(
            "agent Car(v: real, w: real) {{ state x = 3*index, y = 0, th = 0
               flow {{ x' = v*cos(th)  y' = v*sin(th)  th' = w*cos(2*time) }} }}
             interaction Bump(a: Car, b: Car) {{
               pair: when (a.x - b.x)^2 + (a.y - b.y)^2 <= 1 {{ a.th := a.th + 2  b.th := b.th - 2 }} }}
             system {{ cars = Car[12](v = if index/2 == floor(index/2) then 1 else -1, w = 0.1 + 0.05*index) }}
             run {{ until 20 {run} }}"
        )
    };
    let plain = simulate(&model(""));
    let recorded = simulate(&model("record Car.x, Car.th to \"a.csv\""));
    assert!(plain.events.len() > 4, "{}", plain.events.len());
    assert_eq!(plain.bits(), recorded.bits());
    assert_eq!(plain.stats.steps, recorded.stats.steps);
    // Rows are in the order of time, each at the end of a step; of each agent there is one at the begin and one at the end.
    let rows = &recorded.samples[0];
    assert!(rows.is_sorted_by(|a, b| a.time <= b.time));
    assert!(rows.len() > 12 * 10, "{}", rows.len());
    for agent in (0..12).map(|k| format!("cars[{k}]")) {
        let times: Vec<f64> = rows.iter().filter(|row| row.agent == agent).map(|row| row.time).collect();
        assert_eq!((times[0], times[times.len() - 1]), (0.0, 20.0), "{agent}");
    }
}

#[test]
fn rule_16_a_row_of_a_later_micro_step_says_so() {
    let run = simulate(
        "agent A { discrete x: int = 0  t: after 1 { x := 5 } }
         agent B { link a: A  let y = a.x  discrete n: int = 0  s: when a.x >= 5 { n := 1 } }
         system { a = A()  b = B(a = a) }
         run { until 2  record A.x, B.y, B.n to \"a.csv\" }",
    );
    let of_b = run.samples[0].iter().filter(|row| row.agent == "b" && row.time == 1.0);
    let rows: Vec<(usize, f64, f64)> = of_b.map(|row| (row.micro, row.cells[1], row.cells[2])).collect();
    assert_eq!(rows, [(1, 5.0, 0.0), (2, 5.0, 1.0)]);
}
