//! Agents that come and go, against a simulation that looks at all of them: they move on straight lines, so that every time is
//! known in closed form.

use hyc::runtime::Algorithm;
use hyc::runtime::paper::Form;

use crate::harness::{Case, near};

const END: f64 = 40.0;
const RANGE: f64 = 0.25;
const LEAVE: f64 = 100.0;

/// As `hash` of the model.
fn hash(i: f64, k: f64) -> f64 {
    let x = (12.9898 * (i + 1.0) + 78.233 * k).sin() * 43758.5453;
    x - x.floor()
}

fn model(seed: usize, n_gates: usize) -> String {
    format!(
        "fn hash(i: real, k: real) = mod(sin(12.9898*(i + 1) + 78.233*k)*43758.5453, 1)
         agent Dot(v: real) {{ state x = 0  discrete hits: int = 0  flow {{ x' = v }}
           leave: when x >= {LEAVE} {{ destroy self }} }}
         agent Gate(k: int, p: real) {{ discrete n: int = 0
           enter: every p {{ n := n + 1  create Dot(v = 4 + 8*hash(k + {seed}, n)) }} }}
         interaction Hit(a: Dot, b: Dot) {{
           hit: when abs(a.x - b.x) <= {RANGE} {{
             a.hits := a.hits + 1
             if a.hits + b.hits >= 4 {{ destroy b }} else {{ b.hits := b.hits + 1 }} }} }}
         system {{ gates = Gate[{n_gates}](k = index, p = 1.0 + 0.3137*index) }}
         run {{ until {END}  tolerance 1e-11 }}"
    )
}

#[derive(Clone, Debug)]
struct Dot {
    number: usize,
    born: f64,
    v: f64,
    hits: u32,
}

impl Dot {
    fn x(&self, t: f64) -> f64 {
        self.v * (t - self.born)
    }
}

/// An event: when, what, who.
type Happening = (f64, String);

/// Everything that happens, found by looking at all dots and all pairs of them for what comes next.
fn reference(seed: usize, n_gates: usize) -> (Vec<Happening>, Vec<Dot>) {
    let mut sent = vec![0u32; n_gates];
    let mut dots: Vec<Dot> = Vec::new();
    let mut met: Vec<(usize, usize)> = Vec::new();
    let (mut log, mut next_number, mut now) = (Vec::new(), n_gates, 0.0);
    loop {
        let gate = (0..n_gates).map(|k| (f64::from(sent[k] + 1) * (1.0 + 0.3137 * k as f64), k));
        let gate = gate.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap();
        let leaves = dots.iter().map(|dot| (dot.born + LEAVE / dot.v, dot.number));
        let leave = leaves.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((f64::INFINITY, 0));
        let mut hit = (f64::INFINITY, (0, 0));
        for (k, a) in dots.iter().enumerate() {
            for b in &dots[k + 1..] {
                let (apart, closing) = (a.x(now) - b.x(now), b.v - a.v);
                let time = now + (apart - RANGE * apart.signum()) / closing;
                let is_ahead = apart.abs() > RANGE && time >= now;
                if is_ahead && !met.contains(&(a.number, b.number)) && time < hit.0 {
                    hit = (time, (a.number, b.number));
                }
            }
        }
        now = gate.0.min(leave.0).min(hit.0);
        if now > END {
            return (log, dots);
        }
        if now == gate.0 {
            let k = gate.1;
            log.push((now, format!("Gate.enter gates[{k}]")));
            sent[k] += 1;
            let v = 4.0 + 8.0 * hash((k + seed) as f64, f64::from(sent[k] - 1));
            let number = next_number;
            next_number += 1;
            let inside = dots.iter().filter(|dot| dot.x(now) <= RANGE).map(|dot| dot.number);
            let inside: Vec<usize> = inside.collect();
            dots.push(Dot { number, born: now, v, hits: 0 });
            // each of the two is once the first: the actions are not the same when they change places
            let pairs = inside.iter().map(|&other| (other, number));
            for pair in pairs.clone().chain(pairs.map(|(other, number)| (number, other))) {
                meet(pair, now, &mut dots, &mut met, &mut log);
            }
        } else if now == leave.0 {
            log.push((now, format!("Dot.leave Dot#{}", leave.1)));
            dots.retain(|dot| dot.number != leave.1);
        } else {
            let (a, b) = hit.1;
            meet((a, b), now, &mut dots, &mut met, &mut log);
            meet((b, a), now, &mut dots, &mut met, &mut log);
        }
    }
}

fn meet(
    pair: (usize, usize),
    now: f64,
    dots: &mut Vec<Dot>,
    met: &mut Vec<(usize, usize)>,
    log: &mut Vec<Happening>,
) {
    let place = |number: usize| dots.iter().position(|dot| dot.number == number);
    let (Some(a), Some(b)) = (place(pair.0), place(pair.1)) else { return };
    log.push((now, format!("Hit.hit Dot#{} Dot#{}", pair.0, pair.1)));
    met.push(pair);
    let together = dots[a].hits + dots[b].hits;
    dots[a].hits += 1;
    if together >= 4 {
        dots.remove(b);
    } else {
        dots[b].hits += 1;
    }
}

#[test]
fn who_comes_meets_and_goes_is_found_as_by_looking_at_all() {
    let mut n_events = 0;
    for (seed, n_gates) in [(0, 2), (7, 3), (20, 4), (33, 5), (51, 6), (60, 3)] {
        let (expected, dots) = reference(seed, n_gates);
        for form in [Form::Plain, Form::Fast] {
            let run = Case::new(&model(seed, n_gates)).algorithm(Algorithm::Masim(form)).run();
            let found = run.events.iter().map(|event| {
                let other = if event.other.is_empty() { String::new() } else { format!(" {}", event.other) };
                (event.time, format!("{} {}{other}", event.transition, event.agent))
            });
            let found: Vec<Happening> = found.collect();
            for (k, (found, expected)) in found.iter().zip(&expected).enumerate() {
                assert_eq!(
                    found.1, expected.1,
                    "event {k} of seed {seed}, {form:?}: {found:?}, {expected:?}"
                );
                near(found.0, expected.0, 1e-7);
            }
            assert_eq!(found.len(), expected.len(), "seed {seed}");
            let living: Vec<String> = dots.iter().map(|dot| format!("Dot#{}", dot.number)).collect();
            let finals: Vec<&str> = run.finals[n_gates..].iter().map(|last| last.agent.as_str()).collect();
            assert_eq!(finals, living);
            for dot in &dots {
                let name = format!("Dot#{}", dot.number);
                assert_eq!(run.value(&format!("{name}.hits")), f64::from(dot.hits), "{name} of seed {seed}");
                near(run.value(&format!("{name}.x")), dot.x(END), 1e-6);
            }
        }
        n_events += expected.len();
    }
    assert!(n_events > 1000, "{n_events}");
}
