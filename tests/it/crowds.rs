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
struct Dice(u64);

impl Dice {
    fn between(&mut self, low: f64, high: f64) -> f64 {
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

/// Discs of diameter `D` in a box of half side `L`: position and velocity of each.
type Discs = Vec<[f64; 4]>;

const L: f64 = 2.0;
const D: f64 = 0.4;

fn discs(seed: u64) -> Discs {
    let mut dice = Dice(seed);
    let mut disc = |k: usize| {
        let (row, column) = (k / 3, k % 3);
        let cell = 2.0 * L / 3.0;
        let mut place = |n: usize| -L + (n as f64 + 0.5) * cell + dice.between(-0.3, 0.3);
        let (x, y) = (place(column), place(row));
        [x, y, dice.between(-2.0, 2.0), dice.between(-2.0, 2.0)]
    };
    (0..9).map(&mut disc).collect()
}

/// When a disc meets a wall.
fn wall(disc: &[f64; 4]) -> (f64, &'static str) {
    let hit = |x: f64, v: f64| if v > 0.0 { (L - x) / v } else { (-L - x) / v };
    let (across, along) = (hit(disc[0], disc[2]), hit(disc[1], disc[3]));
    match across < along {
        true => (across, if disc[2] > 0.0 { "Disc.right" } else { "Disc.left" }),
        false => (along, if disc[3] > 0.0 { "Disc.top" } else { "Disc.bottom" }),
    }
}

/// When two discs meet.
fn meeting(a: &[f64; 4], b: &[f64; 4]) -> f64 {
    let [dx, dy, du, dv] = [0, 1, 2, 3].map(|k| a[k] - b[k]);
    let (square, product) = (du * du + dv * dv, dx * du + dy * dv);
    let rest = product * product - square * (dx * dx + dy * dy - D * D);
    if product >= 0.0 || rest <= 0.0 {
        return f64::INFINITY;
    }
    ((dx * dx + dy * dy - D * D) / (-product + rest.sqrt())).max(0.0)
}

fn collide(discs: &mut Discs, a: usize, b: usize) {
    let [dx, dy, du, dv] = [0, 1, 2, 3].map(|k| discs[a][k] - discs[b][k]);
    let share = (du * dx + dv * dy) / (dx * dx + dy * dy);
    for (disc, sign) in [(a, -1.0), (b, 1.0)] {
        discs[disc][2] += sign * share * dx;
        discs[disc][3] += sign * share * dy;
    }
}

fn billiards(mut discs: Discs, n_events: usize) -> Vec<Worked> {
    let mut events: Vec<Worked> = Vec::new();
    let mut time = 0.0;
    while events.len() < n_events {
        let mut next = Worked { time: f64::INFINITY, transition: "", agent: 0, other: None };
        for a in 0..discs.len() {
            let (after, transition) = wall(&discs[a]);
            if after < next.time {
                next = Worked { time: after, transition, agent: a, other: None };
            }
            for b in a + 1..discs.len() {
                let after = meeting(&discs[a], &discs[b]);
                if after < next.time {
                    next = Worked { time: after, transition: "Hit.pair", agent: a, other: Some(b) };
                }
            }
        }
        time += next.time;
        for disc in &mut discs {
            disc[0] += disc[2] * next.time;
            disc[1] += disc[3] * next.time;
        }
        match (next.other, next.transition) {
            (Some(other), _) => collide(&mut discs, next.agent, other),
            (None, "Disc.left" | "Disc.right") => discs[next.agent][2] *= -1.0,
            (None, _) => discs[next.agent][3] *= -1.0,
        }
        events.push(Worked { time, ..next });
    }
    events
}

#[test]
fn billiards_with_nine_discs() {
    for seed in 1..=6 {
        let discs = discs(seed);
        // chaos makes ten of an error of one with every few collisions: forty events are enough
        let expected = billiards(discs.clone(), 40);
        let mut system = String::new();
        for (k, [x, y, u, v]) in discs.iter().enumerate() {
            let _ = writeln!(system, "p{k} = Disc(x = {x:?}, y = {y:?}, u = {u:?}, v = {v:?})");
        }
        let until = expected.last().expect("forty").time + 1e-3;
        let run = simulate(&format!(
            "fn k(a: Disc, b: Disc) = ((a.u - b.u)*(a.x - b.x) + (a.v - b.v)*(a.y - b.y))/((a.x - b.x)^2 + (a.y - b.y)^2)
             agent Disc {{ state x, y  discrete u, v  flow {{ x' = u  y' = v }}
               left: when x <= -{L} {{ u := -u }}    right: when x >= {L} {{ u := -u }}
               bottom: when y <= -{L} {{ v := -v }}  top: when y >= {L} {{ v := -v }} }}
             interaction Hit(a: Disc, b: Disc) {{
               pair: when (a.x - b.x)^2 + (a.y - b.y)^2 <= {D}^2 {{
                 a.u := a.u - k(a, b)*(a.x - b.x)  a.v := a.v - k(a, b)*(a.y - b.y)
                 b.u := b.u - k(b, a)*(b.x - a.x)  b.v := b.v - k(b, a)*(b.y - a.y) }} }}
             system {{ {system} }}
             run {{ until {until} }}"
        ));
        agrees(&run, &expected);
        let speed = |k: usize| run.value(&format!("p{k}.u")).hypot(run.value(&format!("p{k}.v")));
        let energy: f64 = (0..9).map(|k| speed(k) * speed(k)).sum();
        let before: f64 = discs.iter().map(|disc| disc[2] * disc[2] + disc[3] * disc[3]).sum();
        assert!((energy - before).abs() <= 1e-9 * before);
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
