//! Does everybody fall ill when they should? Straight walks between walls are known, and so are the times at which two
//! people are near: infections follow from these alone.

use crate::harness::{Case, Ended, all_near, near};

const SIDE: f64 = 60.0;
const REACH: f64 = 3.0;
const ILL_FOR: f64 = 30.0;
const END: f64 = 300.0;
const N: usize = 60;
const SEEDS: usize = 2;

/// A walk that would go on through the walls, which are mirrors.
#[derive(Clone, Copy)]
struct Walk {
    at: [f64; 2],
    v: [f64; 2],
}

impl Walk {
    fn of(k: usize) -> Self {
        let cell = |n: usize| SIDE * (n as f64 + 0.5) / 8.0;
        let angle = 2.4 * (k * k) as f64;
        Self { at: [cell(k % 8), cell(k / 8)], v: [angle.cos(), angle.sin()] }
    }

    fn position(&self, t: f64) -> [f64; 2] {
        [0, 1].map(|i| {
            let unfolded = (self.at[i] + self.v[i] * t).rem_euclid(2.0 * SIDE);
            unfolded.min(2.0 * SIDE - unfolded)
        })
    }

    /// When it meets walls.
    fn turns(&self) -> Vec<f64> {
        let mut times = Vec::new();
        for i in 0..2 {
            let walls = (-6..=6).map(|k| (f64::from(k) * SIDE - self.at[i]) / self.v[i]);
            times.extend(walls.filter(|time| *time > 0.0 && *time < END));
        }
        times
    }
}

/// The stretches of time in which two are near each other.
fn meetings(a: &Walk, b: &Walk) -> Vec<[f64; 2]> {
    let mut times = [vec![0.0, END], a.turns(), b.turns()].concat();
    times.sort_by(f64::total_cmp);
    let mut near = Vec::new();
    for pair in times.windows(2) {
        let gap = |t: f64| {
            let (a, b) = (a.position(t), b.position(t));
            [a[0] - b[0], a[1] - b[1]]
        };
        let (from, to, length) = (gap(pair[0]), gap(pair[1]), pair[1] - pair[0]);
        let rate = [0, 1].map(|i| (to[i] - from[i]) / length);
        let square = rate[0] * rate[0] + rate[1] * rate[1];
        let product = from[0] * rate[0] + from[1] * rate[1];
        let rest = product * product - square * (from[0] * from[0] + from[1] * from[1] - REACH * REACH);
        if rest >= 0.0 {
            let [lo, hi] = [-1.0, 1.0].map(|sign| (sign * rest.sqrt() - product) / square);
            if lo <= length && hi >= 0.0 {
                near.push([pair[0] + lo.max(0.0), pair[0] + hi.min(length)]);
            }
        }
    }
    near
}

/// Who infects whom and when, in the order of time.
fn infections() -> Vec<(f64, usize, usize)> {
    let walks: Vec<Walk> = (0..N).map(Walk::of).collect();
    let mut ill_at = [f64::INFINITY; N];
    ill_at[..SEEDS].fill(0.0);
    let mut log = Vec::new();
    let meeting: Vec<Vec<Vec<[f64; 2]>>> =
        walks.iter().map(|a| walks.iter().map(|b| meetings(a, b)).collect()).collect();
    loop {
        let mut next = (f64::INFINITY, 0, 0);
        for a in (0..N).filter(|a| ill_at[*a].is_finite()) {
            for b in (0..N).filter(|b| ill_at[*b].is_infinite()) {
                let in_time = |[lo, hi]: &[f64; 2]| {
                    let time = lo.max(ill_at[a]);
                    (time <= hi.min(ill_at[a] + ILL_FOR)).then_some(time)
                };
                let time = meeting[a][b].iter().find_map(in_time).unwrap_or(f64::INFINITY);
                if time < next.0 {
                    next = (time, a, b);
                }
            }
        }
        if next.0 > END {
            return log;
        }
        ill_at[next.2] = next.0;
        log.push(next);
    }
}

fn name(k: usize) -> String {
    if k < SEEDS { format!("first[{k}]") } else { format!("others[{}]", k - SEEDS) }
}

#[test]
fn everybody_falls_ill_when_the_walks_say_so() {
    let run = Case::shipped("epidemic.hy").run();
    let expected = infections();
    assert!(expected.len() > 50, "{}", expected.len());
    let infected: Vec<_> = run.events.iter().filter(|event| event.transition == "Meet.infect").collect();
    assert_eq!(infected.len(), expected.len());
    for (event, (time, a, b)) in infected.iter().zip(&expected) {
        near(event.time, *time, 1e-8);
        assert_eq!([event.agent.as_str(), event.other.as_str()], [name(*b), name(*a)]);
        assert_eq!([event.from.as_str(), event.to.as_str()], ["Healthy", "Ill"]);
    }
    // each recovers in its time, and counts those that it infected
    let mut recoveries: Vec<f64> = expected.iter().map(|infection| infection.0 + ILL_FOR).collect();
    recoveries.splice(0..0, [ILL_FOR; SEEDS]);
    all_near(&run.times("Person.recover"), &recoveries, 1e-8);
    // the office closes with the last recovery, in the same instant
    near(run.time, recoveries[recoveries.len() - 1], 1e-8);
    assert_eq!(run.end, Ended::Stop { reason: Some("nobody is ill".into()), by: "Office.over".into() });
    for k in 0..N {
        let victims = expected.iter().filter(|infection| infection.1 == k).count();
        assert_eq!(run.value(&format!("{}.victims", name(k))), victims as f64);
        let caught = k < SEEDS || expected.iter().any(|infection| infection.2 == k);
        assert_eq!(run.mode(&name(k)), if caught { "Immune" } else { "Healthy" });
    }
}
