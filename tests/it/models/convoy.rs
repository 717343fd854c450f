//! Do the cars of the convoy do what flat rules in small fixed steps do? Modes are numbers here, and what a car did before it
//! braked is a number that it keeps.

use crate::harness::{Case, Fired, near};

const N: usize = 6;
const LEN: f64 = 5.0;
const S0: f64 = 4.0;
const B_MAX: f64 = 6.0;
/// Step, s. Events are found at the ends of steps.
const H: f64 = 5e-4;

/// `Drive.Cruise`, `Drive.Follow`, `Brake`, `Stopped`.
#[derive(Clone, Copy, PartialEq, Debug)]
enum Mode {
    Cruise,
    Follow,
    Brake,
    Stopped,
}

impl Mode {
    fn path(self) -> &'static str {
        match self {
            Mode::Cruise => "Drive.Cruise",
            Mode::Follow => "Drive.Follow",
            Mode::Brake => "Brake",
            Mode::Stopped => "Stopped",
        }
    }
}

#[derive(Clone, Copy)]
struct Car {
    v_des: f64,
    mode: Mode,
    before: Mode,
    since: f64,
}

/// Place and speed of the lorry.
fn lorry(brake: f64, time: f64) -> [f64; 2] {
    let (mut x, mut left) = (60.0, time);
    loop {
        let low = (20.0 - 4.0 * brake).max(0.0);
        let parts = [
            (12.0, 20.0, 0.0),
            ((20.0 - low) / 4.0, 20.0, -4.0),
            (if low > 0.0 { 0.0 } else { 8.0 }, 0.0, 0.0),
            (20.0 - low, low, 1.0),
        ];
        for (long, v, a) in parts {
            let t = left.min(long);
            x += v * t + 0.5 * a * t * t;
            left -= t;
            if t < long {
                return [x, v + a * t];
            }
        }
    }
}

struct Convoy {
    brake: f64,
    cars: [Car; N],
}

impl Convoy {
    /// Gap and difference of speeds to the one in front.
    fn ahead(&self, time: f64, y: &[[f64; 2]; N], k: usize) -> [f64; 2] {
        let front = if k == 0 { lorry(self.brake, time) } else { y[k - 1] };
        [front[0] - y[k][0] - LEN, y[k][1] - front[1]]
    }

    fn rates(&self, time: f64, y: &[[f64; 2]; N]) -> [[f64; 2]; N] {
        std::array::from_fn(|k| {
            let ([gap, dv], v) = (self.ahead(time, y, k), y[k][1]);
            let a = match self.cars[k].mode {
                Mode::Cruise => 0.3 * (self.cars[k].v_des - v),
                Mode::Follow => 0.1 * (gap - S0 - v) - 0.4 * dv,
                Mode::Brake => -B_MAX,
                Mode::Stopped => 0.0,
            };
            [v, a]
        })
    }

    /// The first transition of car `k` that is enabled: its name, and where it leads.
    fn transition(&self, time: f64, y: &[[f64; 2]; N], k: usize) -> Option<(&'static str, Mode)> {
        let ([gap, dv], v, car) = (self.ahead(time, y, k), y[k][1], &self.cars[k]);
        let s_brake = S0 + dv.max(0.0).powi(2) / (2.0 * 0.7 * B_MAX);
        let drives = matches!(car.mode, Mode::Cruise | Mode::Follow);
        match car.mode {
            _ if drives && gap <= s_brake => Some(("jam", Mode::Brake)),
            Mode::Cruise if gap <= s_brake + v => Some(("near_", Mode::Follow)),
            Mode::Follow if gap >= 1.3 * (s_brake + v) => Some(("free", Mode::Cruise)),
            Mode::Brake if time - car.since >= 1.0 && gap >= S0 + s_brake && v > 0.0 => {
                Some(("ease", car.before))
            }
            Mode::Brake if v <= 0.0 => Some(("still", Mode::Stopped)),
            Mode::Stopped if gap >= 3.0 * S0 => Some(("start", Mode::Cruise)),
            Mode::Cruise | Mode::Follow | Mode::Brake | Mode::Stopped => None,
        }
    }
}

/// Time, car, name, from and to.
type Step = (f64, usize, &'static str, Mode, Mode);

/// The events, and the places and speeds at the end.
fn small_steps(brake: f64, until: f64) -> (Vec<Step>, [[f64; 2]; N]) {
    let car = |k: usize| Car { v_des: 30.0 - k as f64, mode: Mode::Cruise, before: Mode::Cruise, since: 0.0 };
    let mut convoy = Convoy { brake, cars: std::array::from_fn(car) };
    let mut y: [[f64; 2]; N] = std::array::from_fn(|k| [-60.0 * k as f64, 30.0 - k as f64]);
    let mut events: Vec<Step> = Vec::new();
    let steps = (until / H).round() as usize;
    for n in 0..=steps {
        let time = n as f64 * H;
        for k in 0..N {
            while let Some((name, to)) = convoy.transition(time, &y, k) {
                let from = convoy.cars[k].mode;
                events.push((time, k, name, from, to));
                if to == Mode::Stopped {
                    y[k][1] = 0.0;
                }
                let before = if to == Mode::Brake { from } else { convoy.cars[k].before };
                convoy.cars[k] = Car { mode: to, before, since: time, ..convoy.cars[k] };
            }
        }
        if n < steps {
            let add = |r: &[[f64; 2]; N], h: f64| -> [[f64; 2]; N] {
                std::array::from_fn(|k| std::array::from_fn(|i| y[k][i] + h * r[k][i]))
            };
            let k1 = convoy.rates(time, &y);
            let k2 = convoy.rates(time + H / 2.0, &add(&k1, H / 2.0));
            let k3 = convoy.rates(time + H / 2.0, &add(&k2, H / 2.0));
            let k4 = convoy.rates(time + H, &add(&k3, H));
            for k in 0..N {
                for i in 0..2 {
                    y[k][i] += H / 6.0 * (k1[k][i] + 2.0 * k2[k][i] + 2.0 * k3[k][i] + k4[k][i]);
                }
            }
        }
    }
    (events, y)
}

#[test]
fn small_steps_without_hierarchy_lead_to_the_same_events() {
    for brake in [3.0, 8.0] {
        let run = Case::shipped("convoy.hy").param("brake", brake).run();
        let (events, last) = small_steps(brake, 90.0);
        for (k, last) in last.iter().enumerate() {
            let name = format!("cars[{k}]");
            let ours: Vec<&Fired> = run.events.iter().filter(|event| event.agent == name).collect();
            let theirs: Vec<_> = events.iter().filter(|event| event.1 == k).collect();
            assert_eq!(ours.len(), theirs.len(), "brake {brake}, car {k}\n{ours:#?}\n{theirs:#?}");
            for (ours, (time, _, label, from, to)) in ours.iter().zip(theirs) {
                assert_eq!(ours.transition, format!("Car.{label}"));
                assert_eq!([ours.from.as_str(), ours.to.as_str()], [from.path(), to.path()]);
                near(ours.time, *time, 0.02);
            }
            near(run.value(&format!("{name}.x")), last[0], 0.1);
            near(run.value(&format!("{name}.v")), last[1], 0.1);
        }
        // a car that looks at the difference of speeds alone comes too near to one that stops
        assert_eq!(run.false_asserts.is_empty(), brake == 3.0);
        let seen = |label: &str| !run.times(label).is_empty();
        assert!(seen("Car.jam") && if brake == 3.0 { seen("Car.ease") } else { seen("Car.still") });
    }
}
