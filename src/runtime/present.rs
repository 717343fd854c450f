//! The rows of agents at one instant: states, rates by the active flow, second rates; made when first asked for.

use smallvec::SmallVec;

use crate::codegen::kernel::{AgentBox, AgentView, Kernel};
use crate::runtime::population::{ABSENT, Agents};

/// The views that a kernel takes.
pub type Views<'a> = SmallVec<[AgentView<'a>; 3]>;

/// The boxes that a kernel takes.
pub type Boxes<'a> = SmallVec<[AgentBox<'a>; 3]>;

/// How much of an agent's rows is needed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Depth {
    /// States.
    States,
    /// States and rates.
    Rates,
    /// States, rates and second rates.
    Accelerations,
}

/// The rows of all agents at one time.
pub struct Present {
    /// The time, s.
    pub time: f64,
    /// Right-hand sides evaluated here.
    pub rhs_evaluations: u64,
    /// Arithmetic operations of right-hand sides and second rates evaluated here.
    pub operations: u64,
    stamp: u64,
    rows: Vec<Rows>,
    absent: Vec<f64>,
}

#[derive(Clone, Debug, Default)]
struct Rows {
    /// The stamp at which each depth was made.
    made: [u64; 3],
    states: Vec<f64>,
    rates: Vec<f64>,
    accelerations: Vec<f64>,
}

impl Present {
    /// No rows yet.
    pub fn new(agents: &Agents<'_>) -> Self {
        let absent = vec![f64::NAN; agents.row_width()];
        Self {
            time: f64::NAN,
            rhs_evaluations: 0,
            operations: 0,
            stamp: 1,
            rows: vec![Rows::default(); agents.len()],
            absent,
        }
    }

    /// Makes room for an agent in a place that nobody has.
    pub fn admit(&mut self, place: usize) {
        if place == self.rows.len() {
            self.rows.push(Rows::default());
        }
        self.rows[place] = Rows::default();
    }

    /// Makes room for as many agents.
    pub fn make_room(&mut self, n_agents: usize) {
        self.rows.resize(n_agents, Rows::default());
    }

    /// Moves to another time.
    pub fn go(&mut self, time: f64) {
        if time != self.time {
            self.time = time;
            self.stamp += 1;
        }
    }

    /// Forgets all rows, because something was written.
    pub fn forget(&mut self) {
        self.stamp += 1;
    }

    /// Makes the rows of these agents down to a depth.
    pub fn make(&mut self, agents: &Agents<'_>, slots: &[usize], depth: Depth) {
        for &agent in slots {
            if agent != ABSENT {
                self.make_one(agents, agent, depth);
            }
        }
    }

    /// Makes the states of many agents; those that run ahead are looked up together.
    pub fn survey(&mut self, agents: &Agents<'_>, who: &[usize]) {
        let (rows, stamp, time) = (&mut self.rows, self.stamp, self.time);
        let is_ahead = |&agent: &usize| {
            rows[agent].made[0] != stamp && agents.cold.is_cold(agent) && agents.cold.knows(agent, time)
        };
        let ahead: Vec<usize> = who.iter().copied().filter(is_ahead).collect();
        agents.cold.survey(&ahead, time, &mut |agent, states| {
            let row = &mut rows[agent];
            row.states.clear();
            row.states.extend_from_slice(states);
            row.made[0] = stamp;
        });
        self.make(agents, who, Depth::States);
    }

    fn make_one(&mut self, agents: &Agents<'_>, number: usize, depth: Depth) {
        if self.rows[number].made[depth as usize] == self.stamp {
            return;
        }
        if depth == Depth::States {
            let agent = &agents.agents[number];
            let rows = &mut self.rows[number];
            rows.states.resize(agent.states.len(), 0.0);
            agents.states_at(number, self.time, &mut rows.states);
            rows.made[0] = self.stamp;
            return;
        }
        if agents.agents[number].segment.has_own_rates(self.time) {
            return self.make_own_rates(agents, number);
        }
        self.make_one(agents, number, if depth == Depth::Rates { Depth::States } else { Depth::Rates });
        let flow = agents.flow(number);
        let slots = agents.slots(&flow.frame, &[number]);
        self.make(agents, &slots[1..], if depth == Depth::Rates { Depth::States } else { Depth::Rates });
        let mut out = std::mem::take(self.row_mut(number, depth));
        out.resize(agents.layout(number).n_states, 0.0);
        let function = if depth == Depth::Rates { flow.rates } else { flow.accelerations };
        let kernel = agents.program.kernel(function);
        kernel.eval(&self.views(agents, &slots), self.time, &mut out);
        self.operations += kernel.operations();
        self.rhs_evaluations += u64::from(depth == Depth::Rates);
        *self.row_mut(number, depth) = out;
        self.rows[number].made[depth as usize] = self.stamp;
    }

    /// The rates and second rates of an agent whose segment has its own.
    fn make_own_rates(&mut self, agents: &Agents<'_>, number: usize) {
        self.make_one(agents, number, Depth::States);
        let segment = &agents.agents[number].segment;
        let Rows { made, states, rates, accelerations } = &mut self.rows[number];
        let mut on_segment = states.clone();
        rates.resize(states.len(), 0.0);
        accelerations.resize(states.len(), 0.0);
        segment.jet(self.time, &mut on_segment, rates, accelerations);
        (made[1], made[2]) = (self.stamp, self.stamp);
    }

    fn row_mut(&mut self, number: usize, depth: Depth) -> &mut Vec<f64> {
        let rows = &mut self.rows[number];
        match depth {
            Depth::States => &mut rows.states,
            Depth::Rates => &mut rows.rates,
            Depth::Accelerations => &mut rows.accelerations,
        }
    }

    /// The rows of the agents in some slots, as deep as they have been made.
    pub fn views<'a>(&'a self, agents: &'a Agents<'_>, slots: &[usize]) -> Views<'a> {
        slots.iter().map(|&agent| self.view(agents, agent)).collect()
    }

    /// The rows of an agent, as deep as they have been made; NaN of one that is absent.
    pub fn view<'a>(&'a self, agents: &'a Agents<'_>, agent: usize) -> AgentView<'a> {
        if agent == ABSENT {
            return AgentView::absent(&self.absent);
        }
        let rows = &self.rows[agent];
        AgentView {
            states: &rows.states,
            rates: &rows.rates,
            accelerations: &rows.accelerations,
            aux: &agents.agents[agent].aux,
        }
    }

    /// The states of an agent, made before.
    pub fn states(&self, agent: usize) -> &[f64] {
        &self.rows[agent].states
    }

    /// The second rates of an agent, made before.
    pub fn accelerations(&self, agent: usize) -> &[f64] {
        &self.rows[agent].accelerations
    }

    /// The states of an agent a little later, by its rates and second rates, made before; none of one that is absent.
    pub fn foretold(&self, agent: usize, later: f64) -> Vec<f64> {
        if agent == ABSENT {
            return Vec::new();
        }
        let Rows { states, rates, accelerations, .. } = &self.rows[agent];
        let moved = states.iter().zip(rates).zip(accelerations);
        moved.map(|((x, rate), second)| x + later * (rate + 0.5 * later * second)).collect()
    }

    /// The rates of an agent, made before.
    pub fn rates(&self, agent: usize) -> &[f64] {
        &self.rows[agent].rates
    }
}

/// How deep the rows must be for a kernel.
pub fn depth_read(kernel: &Kernel) -> Depth {
    let slots = &kernel.reads().slots;
    if slots.iter().any(|slot| slot.accelerations > 0) {
        Depth::Accelerations
    } else if slots.iter().any(|slot| slot.rates > 0) {
        Depth::Rates
    } else {
        Depth::States
    }
}
