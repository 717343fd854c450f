//! Does the rectifier conduct when it should? Between two switchings the voltage is known in closed form.

use std::f64::consts::PI;

use super::first_root;
use crate::harness::{Case, near};

const E: f64 = 12.0;
const W: f64 = 2.0 * PI * 50.0;
const R: f64 = 100.0;
const C: f64 = 1e-3;
const RS: f64 = 2.0;

/// From one switching to the next: `direction` is 1 or -1 while a pair of diodes conducts, 0 while none does.
struct Stretch {
    start: f64,
    voltage: f64,
    direction: f64,
}

impl Stretch {
    /// v' = -v/(R C), or v' = -a v + direction b sin(w t).
    fn voltage(&self, t: f64) -> f64 {
        let (a, b) = (1.0 / (RS * C) + 1.0 / (R * C), E / (RS * C));
        let forced = |t: f64| self.direction * b / (a * a + W * W) * (a * (W * t).sin() - W * (W * t).cos());
        let rate = if self.direction == 0.0 { 1.0 / (R * C) } else { a };
        forced(t) + (self.voltage - forced(self.start)) * (-rate * (t - self.start)).exp()
    }

    /// How far the source is above the capacitor.
    fn drive(&self, t: f64) -> f64 {
        let source = E * (W * t).sin();
        let sign = if self.direction == 0.0 { source.signum() } else { self.direction };
        sign * source - self.voltage(t)
    }

    fn next(&self) -> Stretch {
        let start = first_root(&|t| self.drive(t), self.start + 1e-6, 1e-6);
        let direction = if self.direction == 0.0 { (W * start).sin().signum() } else { 0.0 };
        Stretch { start, voltage: self.voltage(start), direction }
    }
}

#[test]
fn a_capacitor_is_charged_in_every_half_wave() {
    let run = Case::shipped("rectifier.hy").tolerance(1e-12).run();
    let mut stretches = vec![Stretch { start: 0.0, voltage: 0.0, direction: 1.0 }];
    while stretches[stretches.len() - 1].start < 0.1 {
        stretches.push(stretches[stretches.len() - 1].next());
    }
    assert_eq!(run.events.len(), 20);
    for (k, (event, stretch)) in run.events.iter().zip(&stretches).enumerate() {
        near(event.time, stretch.start, 1e-10);
        let mode = if k % 2 == 1 {
            "Blocked"
        } else if k % 4 == 0 {
            "Positive"
        } else {
            "Negative"
        };
        assert_eq!(event.to, mode);
    }
    for (time, voltage) in run.column("bridge", 0) {
        let stretch = stretches.iter().rfind(|stretch| stretch.start <= time).expect("one begins at 0");
        near(voltage, stretch.voltage(time), 1e-9);
    }
    // it settles: the same after every half wave
    let last = stretches.len() - 2;
    near(stretches[last].start - stretches[last - 2].start, 0.01, 1e-6);
}
