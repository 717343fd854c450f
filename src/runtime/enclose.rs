//! How long a comparison cannot change: it sleeps until then (I6).
//!
//! Over [t, t + H] the states of a group stay in a box B if x(t) + [0, H] f(B) lies in B (Picard's operator maps B into
//! itself). Then f(B) bounds their rates, and x(s) + [0, h] f(B) their states over any [s, s + h] within [t, t + H]. This
//! is valid until an event or a kink in the group; whoever writes an agent wakes what reads it. If g keeps its sign on
//! the boxes of the agents it reads, it cannot change before s + h.

use smallvec::SmallVec;

use crate::codegen::kernel::AgentBox;
use crate::codegen::program::Atom;
use crate::math::Interval;
use crate::runtime::fold::{self, Folded};
use crate::runtime::groups::Group;
use crate::runtime::population::{ABSENT, Agents, Slots};
use crate::runtime::present::{Boxes, Depth};
use crate::runtime::solve::control::Accuracy;

/// Bounds of rates of groups, kept for those who ask again.
pub struct Enclosures {
    accuracy: Accuracy,
    kept: Vec<Vec<Kept>>,
    /// For each group, the last horizon for which no box was found: version, when asked, length.
    failed: Vec<(u32, f64, f64)>,
    registers: Vec<Interval>,
    /// Scratch: the boxes of the slots one after the other, and a state.
    boxes: Vec<Interval>,
    state: Vec<f64>,
    absent: Vec<Interval>,
    absent_aux: Vec<f64>,
    /// Right-hand sides and guards evaluated over intervals.
    pub ranges: u64,
    /// Their arithmetic operations.
    pub operations: u64,
}

/// Bounds of the rates of one group over a stretch of time.
#[derive(Clone, Debug)]
struct Kept {
    version: u32,
    start: f64,
    end: f64,
    rates: Vec<Interval>,
}

/// The boxes of the states of agents whom others follow.
pub type Leader<'a> = dyn Fn(usize) -> Option<&'a [Interval]> + 'a;

/// Bounds over a stretch this many times longer than what is asked for are good enough.
const LOOSE: f64 = 16.0;
/// How many bounds are kept for a group.
const KEPT_MAX: usize = 6;
/// Into how many pieces a stretch is divided before it is given up.
const PIECES_MAX: f64 = 64.0;
/// How often a box is made larger before its horizon is given up.
const TRIES: usize = 9;
/// From then on it is made twice as much larger each time: beside a point of rest the first boxes say nothing of how far things get.
const GENTLE: usize = 4;

impl Enclosures {
    /// No boxes yet.
    pub fn new(agents: &Agents<'_>, accuracy: Accuracy) -> Self {
        let width = agents.row_width();
        Self {
            accuracy,
            kept: Vec::new(),
            failed: Vec::new(),
            registers: Vec::new(),
            boxes: Vec::new(),
            state: Vec::new(),
            absent: vec![Interval::WHOLE; width],
            absent_aux: vec![f64::NAN; width],
            ranges: 0,
            operations: 0,
        }
    }

    /// Bounds of g over [t, t + horizon], or none if no boxes were found.
    pub fn value_range(
        &mut self,
        agents: &Agents<'_>,
        groups: &[Group],
        (atom, slots, folds): (&Atom, &Slots, &[Folded<'_>]),
        t: f64,
        horizon: f64,
    ) -> Option<Interval> {
        let mut places: SmallVec<[(usize, usize, usize); 3]> = SmallVec::new();
        self.boxes.clear();
        let mut read: SmallVec<[usize; 3]> = atom.slots.iter().map(|&slot| slots[slot]).collect();
        read.extend(fold::members(folds));
        read.sort_unstable();
        read.dedup();
        for agent in read {
            if agent == ABSENT || agents.agents[agent].states.is_empty() {
                continue;
            }
            let group = agents.agents[agent].group;
            let kept = self.enclose(agents, group, &groups[group], t, horizon)?;
            let before = groups[group].members.iter().take_while(|&&member| member != agent);
            let first: usize = before.map(|&member| agents.agents[member].states.len()).sum();
            let n = agents.agents[agent].states.len();
            let rates: SmallVec<[Interval; 8]> = self.kept[group][kept].rates[first..first + n].into();
            places.push((agent, self.boxes.len(), n));
            self.add_box(agents, agent, &rates, t, horizon);
        }
        self.ranges += 1;
        let Self { registers, boxes, absent, absent_aux, .. } = self;
        let row = |agent: usize| {
            if agent == ABSENT {
                return AgentBox::absent(absent, absent_aux);
            }
            let states = match places.binary_search_by_key(&agent, |place| place.0) {
                Ok(k) => &boxes[places[k].1..places[k].1 + places[k].2],
                Err(_) => &[],
            };
            AgentBox { states, rates: &[], accelerations: &[], aux: &agents.agents[agent].aux }
        };
        let time = Interval { lo: t, hi: t + horizon };
        let leaves = fold::leaf_ranges(agents.program, folds, Depth::States, time, registers, &row);
        let mut out = [Interval::WHOLE];
        let kernel = agents.program.kernel(atom.value);
        self.operations += 2 * kernel.operations();
        kernel.range(&fold::boxes(slots, &leaves, &row), time, registers, &mut out);
        Some(out[0])
    }

    /// Tells the bounds of an agent's states over [from, to], if there are any: number of the state, and bound.
    pub fn states(
        &mut self,
        agents: &Agents<'_>,
        groups: &[Group],
        agent: usize,
        (from, to): (f64, f64),
        tell: &mut dyn FnMut(usize, Interval),
    ) {
        let number = agents.agents[agent].group;
        let group = &groups[number];
        let Some(kept) = self.enclose(agents, number, group, from, to - from) else { return };
        let before = group.members.iter().take_while(|&&member| member != agent);
        let first: usize = before.map(|&member| agents.agents[member].states.len()).sum();
        let n = agents.agents[agent].states.len();
        let rates: SmallVec<[Interval; 8]> = self.kept[number][kept].rates[first..first + n].into();
        self.boxes.clear();
        self.add_box(agents, agent, &rates, from, to - from);
        self.boxes.iter().enumerate().for_each(|(state, &bound)| tell(state, bound));
    }

    /// The same of an agent that is a group of its own, by pieces of the stretch: longer ones have bounds so.
    pub fn states_in_pieces(
        &mut self,
        agents: &Agents<'_>,
        groups: &[Group],
        agent: usize,
        span: (f64, f64),
        tell: &mut dyn FnMut(usize, Interval),
    ) {
        let group = &groups[agents.agents[agent].group];
        if group.members.len() > 1 || !group.leaders.is_empty() {
            return;
        }
        let boxes = self.led(agents, group, &|_| None, span);
        boxes.iter().flatten().enumerate().for_each(|(state, &bound)| tell(state, bound));
    }

    /// Appends the box of an agent's states over [t, t + horizon], from bounds of their rates.
    fn add_box(&mut self, agents: &Agents<'_>, agent: usize, rates: &[Interval], t: f64, horizon: f64) {
        self.state.resize(agents.agents[agent].states.len(), 0.0);
        agents.states_at(agent, t, &mut self.state);
        let span = Interval { lo: 0.0, hi: horizon };
        for (&x, &rate) in self.state.iter().zip(rates) {
            let bound = Interval { lo: x, hi: x }.add(span.mul(rate));
            let bound = self.accuracy.padded(bound);
            self.boxes.push(bound);
        }
    }

    /// Bounds of a group's rates over [t, t + horizon]: their place among those kept.
    fn enclose(
        &mut self,
        agents: &Agents<'_>,
        number: usize,
        group: &Group,
        t: f64,
        horizon: f64,
    ) -> Option<usize> {
        if !group.leaders.is_empty() {
            // Where its leaders get to is known as far as they have come only.
            return None;
        }
        if self.kept.len() <= number {
            self.kept.resize(number + 1, Vec::new());
            self.failed.resize(number + 1, (u32::MAX, 0.0, f64::INFINITY));
        }
        let kept = &mut self.kept[number];
        kept.retain(|kept| kept.version == group.version && kept.end > t);
        let fits = |kept: &Kept| {
            kept.start <= t && kept.end >= t + horizon && kept.end - kept.start <= LOOSE * horizon
        };
        if let Some(found) = kept.iter().position(fits) {
            return Some(found);
        }
        let (version, asked, length) = self.failed[number];
        if version == group.version && horizon >= length && t <= asked + 0.25 * length {
            return None;
        }
        let start = start(agents, group, t);
        let Some(rates) = self.picard(agents, group, &start, t, 1.5 * horizon, &|_| None) else {
            self.failed[number] = (group.version, t, horizon);
            return None;
        };
        let kept = &mut self.kept[number];
        let new = Kept { version: group.version, start: t, end: t + 1.5 * horizon, rates };
        if kept.len() < KEPT_MAX {
            kept.push(new);
            return Some(kept.len() - 1);
        }
        let oldest = (0..kept.len()).min_by(|&a, &b| kept[a].end.total_cmp(&kept[b].end)).unwrap_or(0);
        kept[oldest] = new;
        Some(oldest)
    }

    /// Boxes of the states of a group's members over [t, end], one after the other, by those of the agents whom they follow;
    /// none if none are found.
    pub fn led(
        &mut self,
        agents: &Agents<'_>,
        group: &Group,
        leader: &Leader<'_>,
        (t, end): (f64, f64),
    ) -> Option<Vec<Interval>> {
        let mut start = start(agents, group, t);
        let mut boxes = start.clone();
        let (mut from, mut length) = (t, end - t);
        let least = (end - t) / PIECES_MAX;
        while from < end {
            length = length.min(end - from);
            let Some(rates) = self.picard(agents, group, &start, from, length, leader) else {
                length *= 0.5;
                if length < least {
                    return None;
                }
                continue;
            };
            let (all, last) = (Interval { lo: 0.0, hi: length }, Interval { lo: length, hi: length });
            for ((start, bound), &rate) in start.iter_mut().zip(&mut boxes).zip(&rates) {
                *bound = bound.hull(self.accuracy.padded(start.add(all.mul(rate))));
                *start = self.accuracy.padded(start.add(last.mul(rate)));
            }
            from = if from + length > from { from + length } else { end };
        }
        Some(boxes)
    }

    /// Bounds of the rates over a box that Picard's operator maps into itself, from a box at `t` on; none if none is found.
    fn picard(
        &mut self,
        agents: &Agents<'_>,
        group: &Group,
        start: &[Interval],
        t: f64,
        horizon: f64,
        leader: &Leader<'_>,
    ) -> Option<Vec<Interval>> {
        let time = Interval { lo: t, hi: t + horizon };
        let span = Interval { lo: 0.0, hi: horizon };
        let mut guess: Vec<Interval> = start.iter().map(|&bound| self.accuracy.padded(bound)).collect();
        for tries in 0..TRIES {
            let share = 0.25 * f64::powi(2.0, tries.saturating_sub(GENTLE) as i32);
            let rates = self.rates(agents, group, &guess, time, leader);
            let image: Vec<Interval> =
                start.iter().zip(&rates).map(|(start, &rate)| start.add(span.mul(rate))).collect();
            if !image.iter().all(|bound| bound.is_finite()) {
                return None;
            }
            let inside = guess.iter().zip(&image).all(|(guess, &image)| guess.encloses(image));
            if inside {
                return Some(rates);
            }
            guess = image
                .iter()
                .zip(&guess)
                .map(|(&image, &guess)| self.accuracy.padded(grown(image.hull(guess), share)))
                .collect();
        }
        None
    }

    /// f(box).
    fn rates(
        &mut self,
        agents: &Agents<'_>,
        group: &Group,
        guess: &[Interval],
        time: Interval,
        leader: &Leader<'_>,
    ) -> Vec<Interval> {
        let mut all = Vec::with_capacity(guess.len());
        for &member in &group.members {
            let flow = agents.flow(member);
            let slots = agents.slots(&flow.frame, &[member]);
            let mut rates = vec![Interval::WHOLE; agents.agents[member].states.len()];
            let boxes: Boxes<'_> = slots
                .iter()
                .map(|&agent| {
                    if agent == ABSENT {
                        return AgentBox::absent(&self.absent, &self.absent_aux);
                    }
                    let mut first = 0;
                    let mut states: &[Interval] = leader(agent).unwrap_or(&[]);
                    for &other in &group.members {
                        let n = agents.agents[other].states.len();
                        if other == agent {
                            states = &guess[first..first + n];
                        }
                        first += n;
                    }
                    AgentBox { states, rates: &[], accelerations: &[], aux: &agents.agents[agent].aux }
                })
                .collect();
            let kernel = agents.program.kernel(flow.rates);
            self.ranges += 1;
            self.operations += 2 * kernel.operations();
            kernel.range(&boxes, time, &mut self.registers, &mut rates);
            all.extend_from_slice(&rates);
        }
        all
    }
}

/// The states of a group's members at `t`, one after the other.
fn start(agents: &Agents<'_>, group: &Group, t: f64) -> Vec<Interval> {
    let mut start = Vec::new();
    for &member in &group.members {
        let first = start.len();
        start.resize(first + agents.agents[member].states.len(), 0.0);
        agents.states_at(member, t, &mut start[first..]);
    }
    start.into_iter().map(Interval::point).collect()
}

/// Wider by this share on either side.
fn grown(bound: Interval, share: f64) -> Interval {
    let room = share * (bound.hi - bound.lo);
    Interval { lo: bound.lo - room, hi: bound.hi + room }
}
