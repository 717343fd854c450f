//! Do discs meet when they should, and lose nothing? Straight flights between hits are solved on paper, and a small
//! event-driven simulation does it here.

use std::fmt::Write as _;

use crate::crowds::Dice;
use crate::harness::{Case, Run, Sample, near, simulate};

#[derive(Clone, Copy, Debug)]
struct Disc {
    m: f64,
    x: [f64; 2],
    v: [f64; 2],
}

/// Discs of one size in a box.
#[derive(Clone, Debug)]
struct Table {
    /// How far the centres come from the middle.
    reach: f64,
    diameter: f64,
    discs: Vec<Disc>,
}

/// A hit worked out: after how long, of which disc, with which other, or with which wall.
#[derive(Clone, Copy, Debug)]
struct Hit {
    after: f64,
    disc: usize,
    other: Option<usize>,
    wall: &'static str,
}

impl Table {
    fn at_wall(&self, disc: usize) -> Hit {
        let Disc { x, v, .. } = self.discs[disc];
        let after = [0, 1].map(|i| (self.reach.copysign(v[i]) - x[i]) / v[i]);
        let i = usize::from(after[1] < after[0]);
        let wall = [["left", "right"], ["bottom", "top"]][i][usize::from(v[i] > 0.0)];
        Hit { after: after[i], disc, other: None, wall }
    }

    fn at_other(&self, disc: usize, other: usize) -> Hit {
        let (a, b) = (self.discs[disc], self.discs[other]);
        let (d, w) = ([0, 1].map(|i| a.x[i] - b.x[i]), [0, 1].map(|i| a.v[i] - b.v[i]));
        let (square, product) = (w[0] * w[0] + w[1] * w[1], d[0] * w[0] + d[1] * w[1]);
        let gap = d[0] * d[0] + d[1] * d[1] - self.diameter * self.diameter;
        let rest = product * product - square * gap;
        let after = if product >= 0.0 || rest <= 0.0 {
            f64::INFINITY
        } else {
            (gap / (-product + rest.sqrt())).max(0.0)
        };
        Hit { after, disc, other: Some(other), wall: "" }
    }

    fn next(&self) -> Hit {
        let n = self.discs.len();
        let walls = (0..n).map(|disc| self.at_wall(disc));
        let pairs = (0..n).flat_map(|a| (a + 1..n).map(move |b| (a, b))).map(|(a, b)| self.at_other(a, b));
        walls.chain(pairs).min_by(|a, b| a.after.total_cmp(&b.after)).expect("discs fly")
    }

    fn perform(&mut self, hit: Hit) {
        for disc in &mut self.discs {
            disc.x = [0, 1].map(|i| disc.x[i] + disc.v[i] * hit.after);
        }
        let Some(other) = hit.other else {
            let i = usize::from(matches!(hit.wall, "bottom" | "top"));
            self.discs[hit.disc].v[i] *= -1.0;
            return;
        };
        let (a, b) = (self.discs[hit.disc], self.discs[other]);
        let (d, w) = ([0, 1].map(|i| a.x[i] - b.x[i]), [0, 1].map(|i| a.v[i] - b.v[i]));
        let share = 2.0 * (w[0] * d[0] + w[1] * d[1]) / (d[0] * d[0] + d[1] * d[1]) / (a.m + b.m);
        self.discs[hit.disc].v = [0, 1].map(|i| a.v[i] - b.m * share * d[i]);
        self.discs[other].v = [0, 1].map(|i| b.v[i] + a.m * share * d[i]);
    }

    /// The first hits, with their times.
    fn play(&self, n_hits: usize) -> Vec<(f64, Hit)> {
        let mut table = self.clone();
        let mut time = 0.0;
        let one = |_| {
            let hit = table.next();
            table.perform(hit);
            time += hit.after;
            (time, hit)
        };
        (0..n_hits).map(one).collect()
    }
}

/// Fails unless the log begins with these hits. Chaos makes ten of an error of one with every few hits.
#[track_caller]
fn agrees(run: &Run, expected: &[(f64, Hit)], name: impl Fn(usize) -> String) {
    assert!(run.events.len() >= expected.len(), "{} events, not {}", run.events.len(), expected.len());
    for (k, (event, (time, hit))) in run.events.iter().zip(expected).enumerate() {
        let transition = if hit.other.is_some() { "Hit.pair".into() } else { format!("Disc.{}", hit.wall) };
        let same = event.transition == transition
            && event.agent == name(hit.disc)
            && event.other == hit.other.map_or(String::new(), &name)
            && (event.time - time).abs() <= 1e-8;
        assert!(same, "event {k}: {event:?}\nexpected {hit:?} at {time}");
    }
}

/// The shipped model's discs at the start.
fn shipped(n: usize) -> Table {
    let columns = (n as f64).sqrt().ceil() as usize;
    let cell = 10.0 / columns as f64;
    let disc = |k: usize| Disc {
        m: 1.0 + (k % 3) as f64,
        x: [k % columns, k / columns].map(|n| cell * (n as f64 + 0.5) - 5.0),
        v: [3.0 * (2.0 * k as f64 + 1.0).sin(), 3.0 * (3.0 * k as f64).cos()],
    };
    Table { reach: 4.5, diameter: 1.0, discs: (0..n).map(disc).collect() }
}

#[test]
fn the_shipped_discs_meet_as_worked_out() {
    for n in [5, 12, 20] {
        let expected = shipped(n).play(30);
        let run = Case::shipped("billiards.hy").param("n", n).until(expected[29].0 + 1e-3).run();
        agrees(&run, &expected, |k| format!("discs[{k}]"));
    }
}

/// Nine discs, each somewhere in a cell of its own.
fn random(seed: u64) -> Table {
    let mut dice = Dice(seed);
    let mut disc = |k: usize| {
        let mut place = |n: usize| -5.0 + (n as f64 + 0.5) * 10.0 / 3.0 + dice.between(-1.0, 1.0);
        let x = [place(k % 3), place(k / 3)];
        Disc { m: dice.between(0.5, 2.0), x, v: [dice.between(-4.0, 4.0), dice.between(-4.0, 4.0)] }
    };
    Table { reach: 4.5, diameter: 1.0, discs: (0..9).map(&mut disc).collect() }
}

/// The text of the shipped model.
fn text() -> String {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/models/billiards.hy");
    std::fs::read_to_string(path).unwrap()
}

#[test]
fn discs_that_begin_anywhere_meet_as_worked_out() {
    for seed in 1..=6 {
        let table = random(seed);
        let expected = table.play(40);
        let mut system = String::new();
        for (k, Disc { m, x: [x, y], v: [u, v] }) in table.discs.iter().enumerate() {
            let _ = writeln!(system, "p{k} = Disc(m = {m:?}, x = {x:?}, y = {y:?}, u = {u:?}, v = {v:?})");
        }
        let until = expected[39].0 + 1e-3;
        let text = text();
        let types = text.split("system {").next().expect("one is there");
        let run = simulate(&format!("{types} system {{ {system} }} run {{ until {until} }}"));
        agrees(&run, &expected, |k| format!("p{k}"));
    }
}

/// The shipped model, with the rows on both sides of each event.
fn with_both_sides() -> Run {
    let text = text().replace(" every 0.05 [s]", "");
    Case::new(&text).run()
}

/// The rows of an agent just before and just after an event.
fn sides<'r>(run: &'r Run, agent: &str, time: f64) -> [&'r Sample; 2] {
    let mut rows = run.samples[0].iter().filter(|sample| sample.time == time && sample.agent == agent);
    let first = rows.next().expect("a row before the event");
    [first, rows.next_back().expect("a row after it")]
}

#[test]
fn nothing_is_lost_at_any_hit() {
    let run = with_both_sides();
    let start: f64 =
        shipped(12).discs.iter().map(|disc| disc.m * disc.v[0].hypot(disc.v[1]).powi(2) / 2.0).sum();
    let mut energies: Vec<f64> = run.samples[0][..12].iter().map(|sample| sample.cells[4]).collect();
    assert!(run.times("Hit.pair").len() > 100);
    let number = |name: &str| name[6..name.len() - 1].parse::<usize>().unwrap();
    for event in &run.events {
        let pair = [event.agent.as_str(), event.other.as_str()];
        let taking_part = &pair[..if event.other.is_empty() { 1 } else { 2 }];
        let mut momentum = [[0.0; 2]; 2];
        for agent in taking_part {
            let m = 1.0 + (number(agent) % 3) as f64;
            let rows = sides(&run, agent, event.time);
            for (momentum, row) in momentum.iter_mut().zip(rows) {
                momentum[0] += m * row.cells[2];
                momentum[1] += m * row.cells[3];
            }
            energies[number(agent)] = rows[1].cells[4];
        }
        if taking_part.len() == 2 {
            near(momentum[1][0], momentum[0][0], 1e-13);
            near(momentum[1][1], momentum[0][1], 1e-13);
            let [a, b] = pair.map(|agent| &sides(&run, agent, event.time)[0].cells);
            near((a[0] - b[0]).hypot(a[1] - b[1]), 1.0, 1e-12);
        }
        near(energies.iter().sum(), start, 1e-12 * start);
    }
}

#[test]
fn nobody_overlaps_and_nobody_leaves() {
    let run = Case::shipped("billiards.hy").param("n", 20).until(10.0).run();
    for rows in run.samples[0].chunks(20) {
        for (k, a) in rows.iter().enumerate() {
            assert!(a.cells[..2].iter().all(|x| x.abs() <= 4.5 + 1e-12));
            for b in &rows[..k] {
                let distance = (a.cells[0] - b.cells[0]).hypot(a.cells[1] - b.cells[1]);
                assert!(distance >= 1.0 - 1e-9, "{} and {} at {}: {distance}", a.agent, b.agent, a.time);
            }
        }
    }
}
