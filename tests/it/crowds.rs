//! Do crowds do what can be worked out exactly, event by event? Straight flights between events are solved on paper, a
//! small event-driven simulation does it here, and every event of the engine has to be one of its.

use std::fmt::Write as _;

use crate::harness::{Run, simulate};

/// An event worked out: time, transition, agents.
#[derive(Clone, Debug, PartialEq)]
struct Worked {
    time: f64,
    transition: &'static str,
    agent: usize,
    other: Option<usize>,
}

/// Numbers that look random, the same every time.
pub struct Dice(pub u64);

impl Dice {
    /// The next of them, between `low` and `high`.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        low + (high - low) * ((self.0 >> 11) as f64 / (1u64 << 53) as f64)
    }
}

/// Fails unless the log begins with these events (`p3` is agent 3), times within 1e-8.
#[track_caller]
fn agrees(run: &Run, expected: &[Worked]) {
    assert!(run.events.len() >= expected.len(), "{} events, not {}", run.events.len(), expected.len());
    let name = |agent: usize| format!("p{agent}");
    for (k, (event, worked)) in run.events.iter().zip(expected).enumerate() {
        let same = event.transition == worked.transition
            && event.agent == name(worked.agent)
            && event.other == worked.other.map_or(String::new(), name)
            && (event.time - worked.time).abs() <= 1e-8;
        assert!(same, "event {k}: {event:?}\nexpected {worked:?}");
    }
}

/// Agents that fly straight and are put elsewhere every `period`, each in its own rhythm.
#[derive(Clone, Copy, Debug)]
struct Flyer {
    x: f64,
    v: f64,
    period: f64,
    stride: f64,
    spin: f64,
}

/// Where a flyer is put the k-th time.
fn landing(flyer: &Flyer, k: f64) -> f64 {
    (flyer.stride * k).rem_euclid(10.0) - 5.0
}

/// All instants at which a flyer comes within 1/2 of another, and all jumps.
fn near_misses(flyers: &[Flyer], end: f64) -> Vec<Worked> {
    let jumps_of = |agent: usize| {
        let period = flyers[agent].period;
        (1..).map(move |k| (f64::from(k) * period, agent, f64::from(k))).take_while(move |jump| jump.0 <= end)
    };
    let mut jumps: Vec<(f64, usize, f64)> = (0..flyers.len()).flat_map(jumps_of).collect();
    jumps.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut from: Vec<(f64, f64)> = flyers.iter().map(|flyer| (0.0, flyer.x)).collect();
    let mut near = vec![false; flyers.len()];
    let mut events = Vec::new();
    let mut start = 0.0;
    for jump in jumps.iter().copied().map(Some).chain([None]) {
        let stop = jump.map_or(end, |jump| jump.0);
        let gap = |a: usize, b: usize, t: f64| {
            let at = |k: usize| from[k].1 + flyers[k].v * (t - from[k].0);
            at(a) - at(b)
        };
        for agent in 0..flyers.len() {
            let others = (0..flyers.len()).filter(|&other| other != agent);
            let close = |t: f64| others.clone().any(|other| gap(agent, other, t).abs() <= 0.5);
            let roots = others.clone().flat_map(|other| {
                let (gap, speed) = (gap(agent, other, start), flyers[agent].v - flyers[other].v);
                [start + (0.5 - gap) / speed, start + (-0.5 - gap) / speed]
            });
            let mut times: Vec<f64> =
                roots.filter(|t| *t > start && *t < stop).chain([start, stop]).collect();
            times.sort_by(f64::total_cmp);
            for pair in times.windows(2) {
                let now = close(0.5 * (pair[0] + pair[1]));
                if now && !near[agent] {
                    events.push(Worked { time: pair[0], transition: "Flyer.near", agent, other: None });
                }
                near[agent] = now;
            }
        }
        if let Some((time, agent, k)) = jump {
            events.push(Worked { time, transition: "Flyer.jump", agent, other: None });
            from[agent] = (time, landing(&flyers[agent], k));
        }
        start = stop;
    }
    // those of one time: the jump that caused the others first
    events.sort_by(|a, b| {
        a.time.total_cmp(&b.time).then(a.transition.cmp(b.transition)).then(a.agent.cmp(&b.agent))
    });
    events
}

#[test]
fn teleports_among_agents_with_steps_of_their_own() {
    for seed in 1..=6 {
        let mut dice = Dice(seed);
        let mut flyer = |_| Flyer {
            x: dice.between(-5.0, 5.0),
            v: dice.between(-2.0, 2.0),
            period: dice.between(0.4, 4.0),
            stride: dice.between(1.0, 9.0),
            spin: dice.between(0.1, 20.0),
        };
        let flyers: Vec<Flyer> = (0..6).map(&mut flyer).collect();
        let expected = near_misses(&flyers, 10.0);
        let mut system = String::new();
        for (k, Flyer { x, v, period, stride, spin }) in flyers.iter().enumerate() {
            let _ = writeln!(
                system,
                "p{k} = Flyer(x = {x:?}, v = {v:?}, period = {period:?}, stride = {stride:?}, spin = {spin:?})"
            );
        }
        // y and z turn at rates that differ by a hundred: so do the steps of the agents
        let mut run = simulate(&format!(
            "agent Flyer(v: real, period: real, stride: real, spin: real) {{
               state x, y = 1, z = 0  discrete k: int = 0
               flow {{ x' = v  y' = spin*z  z' = -spin*y }}
               jump: every period {{ x := mod(stride*(k + 1), 10) - 5  k := k + 1 }}
               near: when exists o in other Flyer: abs(o.x - x) <= 0.5 {{ }} }}
             system {{ {system} }}
             run {{ until 10 }}"
        ));
        assert_eq!(run.events.len(), expected.len());
        // both of a pair are near at the same time, but for rounding
        run.events.sort_by(|a, b| {
            (a.time * 1e7)
                .round()
                .total_cmp(&(b.time * 1e7).round())
                .then(a.transition.cmp(&b.transition))
                .then(a.agent.cmp(&b.agent))
        });
        agrees(&run, &expected);
        assert!(expected.iter().filter(|event| event.transition == "Flyer.near").count() >= 15);
    }
}
