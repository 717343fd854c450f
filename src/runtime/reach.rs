//! Where agents can get to: boxes of their states over a stretch of time.
//!
//! Rates that are bounded whatever the states are (a speed times a cosine, a saturated input) bound the way of a state
//! for as long as the agent follows the same flow with the same parameters; a state whose rate is bounded by those has
//! bounds too. These are kept until the agent's course changes its version. They hold from where it was at or before the
//! present ([`source`]). The way is laid from an anchor, where the agent has come to ([`anchor`]), on and back: if that is
//! beyond the present, an event may cut it away, and the box with it. Other states have a box by Picard's operator
//! ([`Enclosures`]), or none.

use smallvec::SmallVec;

use crate::codegen::kernel::AgentBox;
use crate::math::Interval;
use crate::runtime::enclose::Enclosures;
use crate::runtime::groups::Group;
use crate::runtime::population::{ABSENT, Agents};
use crate::runtime::present::Boxes;
use crate::runtime::solve::control::Accuracy;

/// Bounds of each state's rate, valid while the agent's course has the same version.
#[derive(Clone, Copy, Debug)]
struct Kept {
    version: u32,
    first: u32,
    /// For how many states there is room.
    room: u32,
    /// From here on they are valid, s.
    since: f64,
    /// Whether each rate is bounded whatever the states are.
    pure: bool,
}

/// Boxes of agents; keeps what bounds their rates.
pub struct Reaches {
    accuracy: Accuracy,
    time_end: f64,
    kept: Vec<Kept>,
    rates: Vec<Interval>,
    registers: Vec<Interval>,
    absent: Vec<Interval>,
    absent_aux: Vec<f64>,
    /// Right-hand sides evaluated over intervals.
    pub ranges: u64,
    /// Their arithmetic operations.
    pub operations: u64,
}

/// Any finite number.
const ANY: Interval = Interval { lo: f64::MIN, hi: f64::MAX };
/// A bound beyond this is none.
const BOUND_MAX: f64 = 1e150;
/// How often rates are bounded again by what the last bounds say of the states.
const PASSES: usize = 3;

impl Reaches {
    /// Nothing is known yet; no stretch of time leads beyond `time_end`, s.
    pub fn new(agents: &Agents<'_>, accuracy: Accuracy, time_end: f64) -> Self {
        let mut first = 0;
        let kept = agents.agents.iter().map(|agent| {
            let room = agent.states.len() as u32;
            let kept = Kept { version: u32::MAX, first, room, since: f64::INFINITY, pure: false };
            first += room;
            kept
        });
        let kept: Vec<Kept> = kept.collect();
        let width = agents.row_width();
        Self {
            accuracy,
            time_end: if time_end.is_finite() { time_end } else { 1e9 },
            kept,
            rates: vec![Interval::WHOLE; first as usize],
            registers: Vec::new(),
            absent: vec![Interval::WHOLE; width],
            absent_aux: vec![f64::NAN; width],
            ranges: 0,
            operations: 0,
        }
    }

    /// Makes room for an agent with so many states in a place that nobody has.
    pub fn admit(&mut self, place: usize, n_states: usize) {
        if place == self.kept.len() {
            self.kept.push(Kept { version: u32::MAX, first: 0, room: 0, since: f64::INFINITY, pure: false });
        }
        let kept = &mut self.kept[place];
        (kept.version, kept.since, kept.pure) = (u32::MAX, f64::INFINITY, false);
        if (kept.room as usize) < n_states {
            (kept.first, kept.room) = (self.rates.len() as u32, n_states as u32);
            self.rates.resize(self.rates.len() + n_states, Interval::WHOLE);
        }
    }

    /// The box of an agent's states over [from, to], one place of `out` each; WHOLE where there is no bound.
    ///
    /// All of [from, to] lies at or after the present; where the agent's clock is does not matter.
    pub fn states(
        &mut self,
        agents: &Agents<'_>,
        groups: &[Group],
        enclosures: &mut Enclosures,
        agent: usize,
        (from, to): (f64, f64),
        out: &mut SmallVec<[Interval; 8]>,
    ) {
        out.clear();
        let n = agents.agents[agent].states.len();
        if n == 0 {
            return;
        }
        let first = self.kept[agent].first as usize;
        if agents.courses[agent].alone && to <= self.time_end {
            let (t, states) = anchor(agents, groups, agent);
            self.refresh(agents, groups, agent, from);
            let span = Interval { lo: from - t, hi: to - t };
            for (&x, &rate) in states.iter().zip(&self.rates[first..first + n]) {
                out.push(if rate.is_whole() { rate } else { self.padded(x, span.mul(rate)) });
            }
            if out.iter().all(|bound| !bound.is_whole()) {
                return;
            }
        } else {
            self.kept[agent].pure = false;
            out.resize(n, Interval::WHOLE);
        }
        let known = known(agents, groups, agent, from);
        if !known.passed.is_empty() && to <= known.since {
            known.passed.iter().enumerate().for_each(|(state, &bound)| known.fill(out, state, bound));
        } else {
            let fill = &mut |state, bound| known.fill(out, state, bound);
            enclosures.states(agents, groups, agent, (known.since, to), fill);
        }
    }

    /// The same at greater expense: where no box is found over all of [from, to], by pieces.
    pub fn way(
        &mut self,
        agents: &Agents<'_>,
        groups: &[Group],
        enclosures: &mut Enclosures,
        agent: usize,
        (from, to): (f64, f64),
        out: &mut SmallVec<[Interval; 8]>,
    ) {
        self.states(agents, groups, enclosures, agent, (from, to), out);
        let known = known(agents, groups, agent, from);
        if to > known.since && out.iter().any(|bound| bound.is_whole()) {
            let fill = &mut |state, bound| known.fill(out, state, bound);
            enclosures.states_in_pieces(agents, groups, agent, (known.since, to), fill);
        }
    }

    /// Bounds of the rate of one state of an agent from `from` on, which is not before the present, whatever its states are;
    /// none if there are none.
    pub fn rate(
        &mut self,
        agents: &Agents<'_>,
        groups: &[Group],
        agent: usize,
        state: usize,
        from: f64,
    ) -> Option<Interval> {
        if !agents.courses[agent].alone {
            return None;
        }
        self.refresh(agents, groups, agent, from);
        let rate = self.rates[self.kept[agent].first as usize + state];
        (!rate.is_whole()).then_some(rate)
    }

    /// Bounds the rates of an agent that is alone from `from` on, if what is known of them is not valid there.
    fn refresh(&mut self, agents: &Agents<'_>, groups: &[Group], agent: usize, from: f64) {
        let Kept { version, since, .. } = self.kept[agent];
        let now = agents.courses[agent].version;
        if version != now || from < since {
            let (since, states) = source(agents, groups, agent, from);
            let pure = self.bound(agents, agent, (since, &states));
            self.kept[agent] = Kept { version: now, since, pure, ..self.kept[agent] };
        }
    }

    /// Whether the box of an agent that was found last rests on rates that are bounded whatever its states are.
    pub fn is_pure(&self, agent: usize) -> bool {
        self.kept[agent].pure
    }

    /// Bounds the rates of an agent that is alone and has these states at `since`, from there on, as far as they are bounded
    /// whatever its states are. True if all are, and by nothing that is known of the states.
    fn bound(&mut self, agents: &Agents<'_>, number: usize, (since, states): (f64, &[f64])) -> bool {
        let first = self.kept[number].first as usize;
        let agent = &agents.agents[number];
        let n = agent.states.len();
        let flow = agents.flow(number);
        let slots = agents.slots(&flow.frame, &[number]);
        let kernel = agents.program.kernel(flow.rates);
        let time = Interval { lo: since, hi: self.time_end };
        let span = Interval { lo: 0.0, hi: self.time_end - since };
        let mut states_box: SmallVec<[Interval; 8]> = SmallVec::from_elem(ANY, n);
        self.rates[first..first + n].fill(Interval::WHOLE);
        let mut n_bounded = 0;
        for pass in 0..PASSES {
            let boxes: Boxes<'_> = slots
                .iter()
                .map(|&other| {
                    if other == ABSENT {
                        return AgentBox::absent(&self.absent, &self.absent_aux);
                    }
                    let own: &[Interval] = if other == number { &states_box } else { &[] };
                    AgentBox { states: own, rates: &[], accelerations: &[], aux: &agents.agents[other].aux }
                })
                .collect();
            let rates = &mut self.rates[first..first + n];
            kernel.range(&boxes, time, &mut self.registers, rates);
            self.ranges += 1;
            self.operations += 2 * kernel.operations();
            for rate in rates.iter_mut().filter(|rate| rate.mag() > BOUND_MAX) {
                *rate = Interval::WHOLE;
            }
            let bounded = rates.iter().filter(|rate| !rate.is_whole()).count();
            if bounded == n || bounded == n_bounded {
                return pass == 0 && bounded == n;
            }
            n_bounded = bounded;
            drop(boxes);
            for (k, bound) in states_box.iter_mut().enumerate() {
                let rate = self.rates[first + k];
                if !rate.is_whole() {
                    *bound = self.padded(states[k], span.mul(rate));
                }
            }
        }
        false
    }

    /// x + way, with room for what the integration may be off by.
    fn padded(&self, x: f64, way: Interval) -> Interval {
        self.accuracy.padded(Interval { lo: x, hi: x }.add(way))
    }
}

/// What is known of an agent's way from some time on.
struct Known<'a> {
    /// From here on it is to be bounded, s.
    since: f64,
    /// Of one that runs ahead: where it was until then.
    passed: &'a [Interval],
}

impl Known<'_> {
    /// Fills in a bound of a state from `since` on, where none is known: with where it has passed.
    fn fill(&self, out: &mut [Interval], state: usize, bound: Interval) {
        if out[state].is_whole() {
            out[state] = self.passed.get(state).map_or(bound, |passed| passed.hull(bound));
        }
    }
}

fn known<'a>(agents: &'a Agents<'_>, groups: &[Group], agent: usize, from: f64) -> Known<'a> {
    // Where it is later than it has come to is not known; of one that runs ahead it is known where it was until then.
    let clock = anchor(agents, groups, agent).0;
    if agents.cold.is_cold(agent) && from <= clock {
        Known { since: clock, passed: agents.cold.bounds(agent) }
    } else {
        Known { since: from.min(clock), passed: &[] }
    }
}

/// How far an agent has come, and its states there. If that is beyond the present, an event may yet cut it away.
#[inline]
pub fn anchor<'a>(agents: &'a Agents<'_>, groups: &[Group], agent: usize) -> (f64, &'a [f64]) {
    match agents.cold.now(agent) {
        Some(now) => now,
        None => (groups[agents.agents[agent].group].clock, &agents.agents[agent].states),
    }
}

/// Where an agent is, or was on the way that it follows, at `from` or before it, and its states there; `from` is not before the
/// present.
fn source(agents: &Agents<'_>, groups: &[Group], agent: usize, from: f64) -> (f64, SmallVec<[f64; 8]>) {
    let row = &agents.agents[agent];
    let clock = groups[row.group].clock;
    if agents.cold.is_cold(agent) {
        if agents.cold.knows(agent, from) {
            return agents.cold.known(agent);
        }
    } else if clock <= from {
        return (clock, row.states.as_slice().into());
    }
    let mut states: SmallVec<[f64; 8]> = SmallVec::from_elem(0.0, row.states.len());
    row.segment.states(row.segment.start, &mut states);
    (row.segment.start, states)
}
