//! Does a clock made of a relay drift? Ten thousand events, each worked out on paper.

use crate::harness::{Case, near};

#[test]
fn ten_thousand_events_without_drift() {
    let run = Case::shipped("relay_clock.hy").run();
    let first = -0.5 * (1.0 - 1f64.tanh()).ln();
    assert_eq!(run.events.len(), 10_000);
    for (k, event) in run.events.iter().enumerate() {
        assert_eq!(event.transition, ["Relay.high", "Relay.low"][k % 2]);
        // one second from each to the next: an error of 1e-9 for each would add up to 1e-5 at the end
        let drift = (event.time - first - k as f64).abs();
        assert!(drift <= 1e-11 * (k + 1) as f64, "event {k} is off by {drift:e}");
    }
    assert_eq!(run.value("clock.ticks"), 10_000.0);
}

#[test]
fn another_relay_keeps_another_time() {
    let run = Case::shipped("relay_clock.hy").param("h", 0.2).param("tau", 3).until(100.0).run();
    let (first, period) = (-3.0 * 0.8f64.ln(), 3.0 * 1.5f64.ln());
    for (k, event) in run.events.iter().enumerate() {
        near(event.time, first + k as f64 * period, 1e-9);
    }
    assert_eq!(run.events.len(), 82);
}
