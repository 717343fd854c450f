//! Do the cars of the platoon that opens and closes do what small fixed steps do, with who is ahead looked for at every step?

use crate::harness::{Case, all_near, near};

const N: usize = 6;
const GUEST: usize = 5;
const HOST: usize = 2;
const V0: f64 = 25.0;
const LEN: f64 = 4.5;
const S0: f64 = 5.0;
const KP: f64 = 0.3;
const KV: f64 = 0.9;
/// Step, s. Events are found at the ends of steps.
const H: f64 = 2e-4;

#[derive(Clone, Copy, PartialEq, Debug)]
enum Mode {
    Drive,
    Yield,
    Beside,
    Align,
    Leave,
}

struct Platoon {
    modes: [Mode; N],
    lanes: [i32; N],
}

impl Platoon {
    fn lead(&self, y: &[[f64; 2]; N], k: usize) -> Option<usize> {
        let ahead = (0..N).filter(|&o| o != k && self.lanes[o] == self.lanes[k] && y[o][0] > y[k][0]);
        ahead.min_by(|&a, &b| y[a][0].total_cmp(&y[b][0]))
    }

    fn rates(&self, leads: &[Option<usize>; N], y: &[[f64; 2]; N]) -> [[f64; 2]; N] {
        std::array::from_fn(|k| {
            let ([x, v], lead) = (y[k], leads[k].map(|lead| y[lead]));
            let cruise = 0.5 * (V0 - v);
            let a = match self.modes[k] {
                Mode::Drive => lead.map_or(cruise, |l| KP * (l[0] - x - LEN - S0 - v) + KV * (l[1] - v)),
                Mode::Yield => {
                    lead.map_or(cruise, |l| KP * (l[0] - x - 2.0 * (LEN + S0 + v)) + KV * (l[1] - v))
                }
                Mode::Beside => cruise,
                Mode::Align => {
                    let before = leads[HOST].expect("there is a gap");
                    KP * (0.5 * (y[HOST][0] + y[before][0]) - x) + KV * (y[HOST][1] - v)
                }
                Mode::Leave => -0.1 * (v - 0.5 * V0),
            };
            [v, a]
        })
    }
}

/// When each event was, and the places and speeds at the end.
fn small_steps(until: f64, exit: f64) -> (Vec<(f64, &'static str)>, [[f64; 2]; N]) {
    let mut platoon = Platoon { modes: [Mode::Drive; N], lanes: [1; N] };
    (platoon.modes[GUEST], platoon.lanes[GUEST]) = (Mode::Beside, 2);
    let place = |k: usize| if k == GUEST { 3 } else { k };
    let mut y: [[f64; 2]; N] = std::array::from_fn(|k| [-(place(k) as f64) * (LEN + S0 + V0), V0]);
    let mut events = Vec::new();
    let mut is_open = false;
    for n in 0..=(until / H).round() as usize {
        let time = n as f64 * H;
        let leads: [Option<usize>; N] = std::array::from_fn(|k| platoon.lead(&y, k));
        if n == (5.0 / H).round() as usize {
            events.extend([(time, "Car.ask"), (time, "Car.yield")]);
            platoon.modes[HOST] = Mode::Yield;
        }
        let before = leads[HOST].expect("the host is not the first");
        let gap = y[before][0] - y[HOST][0] - LEN;
        if platoon.modes[HOST] == Mode::Yield && !is_open && gap >= LEN + 2.0 * (S0 + y[HOST][1]) - 1.0 {
            is_open = true;
            events.extend([(time, "Car.open"), (time, "Car.go")]);
            platoon.modes[GUEST] = Mode::Align;
        }
        let away = 0.5 * (y[HOST][0] + y[before][0]) - y[GUEST][0];
        if platoon.modes[GUEST] == Mode::Align && away.abs() <= 0.5 {
            events.extend([(time, "Car.in_"), (time, "Car.closed")]);
            (platoon.modes[GUEST], platoon.lanes[GUEST]) = (Mode::Drive, 1);
            platoon.modes[HOST] = Mode::Drive;
        }
        if platoon.modes[3] == Mode::Drive && y[3][0] >= exit {
            events.push((time, "Car.leave"));
            (platoon.modes[3], platoon.lanes[3]) = (Mode::Leave, 0);
        }
        let leads: [Option<usize>; N] = std::array::from_fn(|k| platoon.lead(&y, k));
        let add = |y: &[[f64; 2]; N], k: &[[f64; 2]; N], h: f64| -> [[f64; 2]; N] {
            std::array::from_fn(|i| [y[i][0] + h * k[i][0], y[i][1] + h * k[i][1]])
        };
        let k1 = platoon.rates(&leads, &y);
        let k2 = platoon.rates(&leads, &add(&y, &k1, 0.5 * H));
        if time < until - 0.5 * H {
            y = add(&y, &k2, H);
        }
    }
    (events, y)
}

#[test]
fn a_platoon_opens_and_closes_as_in_small_steps() {
    let run = Case::shipped("join_split.hy").run();
    assert!(run.false_asserts.is_empty(), "{:?}", run.false_asserts);
    let (events, y) = small_steps(60.0, 1000.0);
    let names: Vec<&str> = run.events.iter().map(|event| event.transition.as_str()).collect();
    assert_eq!(names, events.iter().map(|event| event.1).collect::<Vec<_>>(), "{:?}", run.log());
    let times: Vec<f64> = events.iter().map(|event| event.0).collect();
    all_near(&run.event_times(), &times, 3e-3);
    for (k, [x, v]) in y.into_iter().enumerate() {
        let name = if k == GUEST { "guest".to_string() } else { format!("cars[{k}]") };
        near(run.value(&format!("{name}.x")), x, 1e-2);
        near(run.value(&format!("{name}.v")) / 3.6, v, 1e-2);
    }
}

#[test]
fn a_platoon_closes_up_after_whoever_comes_and_goes() {
    let run = Case::shipped("join_split.hy").until(150.0).run();
    // in the order 0, 1, guest, 2, 4, each a headway behind the one before
    let order = ["cars[0]", "cars[1]", "guest", "cars[2]", "cars[4]"];
    for pair in order.windows(2) {
        let [ahead, behind] = [pair[0], pair[1]].map(|name| run.value(&format!("{name}.x")));
        near(ahead - behind, LEN + S0 + V0, 1e-2);
    }
    assert_eq!(run.value("cars[3].lane"), 0.0);
}
