//! The right-hand side of a group: the flows of all its members at one time, the states of all in one row. The states of
//! leaders, who are not of the group, are those of their dense output at that time.

use crate::codegen::kernel::AgentView;
use crate::codegen::trace::{Blame, Point};
use crate::runtime::population::{ABSENT, Agents, Slots};
use crate::runtime::present::Views;
use crate::runtime::solve::jacobian::Jacobian;
use crate::runtime::solve::method::{Flow, SeriesRows, Tsit5Rows};

/// Right-hand sides that a whole step of Tsitouras' pair evaluates.
const WHOLE_STEP: u64 = 6;

/// The flow of a group at its clock.
pub struct GroupFlow<'a, 'p> {
    agents: &'a Agents<'p>,
    members: &'a [usize],
    /// The agents that each member's flow reads.
    slots: Vec<Slots>,
    /// Who is read and is not of the group.
    leaders: &'a [usize],
    /// The states of the leaders, one after the other, and their rates, at the time that was looked at last.
    led: Vec<f64>,
    led_rates: Vec<f64>,
    /// The row of an agent that is not there.
    absent: &'a [f64],
    /// Right-hand sides evaluated, one for each member.
    pub evaluations: u64,
    /// Jacobians evaluated, one for each member.
    pub jacobians: u64,
    /// Arithmetic operations, as their tapes have them.
    pub operations: u64,
}

impl<'a, 'p> GroupFlow<'a, 'p> {
    /// The flow of some agents that step together, and who is led by others; `absent` is a row for those that are not there.
    pub fn new(
        agents: &'a Agents<'p>,
        members: &'a [usize],
        leaders: &'a [usize],
        absent: &'a [f64],
    ) -> Self {
        let slots = members.iter().map(|&agent| agents.slots(&agents.flow(agent).frame, &[agent])).collect();
        let n_led = leaders.iter().map(|&leader| agents.agents[leader].states.len()).sum();
        let (led, led_rates) = (vec![0.0; n_led], vec![0.0; n_led]);
        Self {
            agents,
            members,
            slots,
            leaders,
            led,
            led_rates,
            absent,
            evaluations: 0,
            jacobians: 0,
            operations: 0,
        }
    }

    /// Finds the states of the leaders at `t`.
    fn look_at(&mut self, t: f64) {
        let Self { agents, leaders, led, .. } = self;
        of_each(agents, leaders, led, &|leader, states| agents.states_at(leader, t, states));
    }

    /// Finds states and rates of the leaders at `t`.
    fn look_at_rates(&mut self, t: f64) {
        self.look_at(t);
        let Self { agents, leaders, led_rates, .. } = self;
        of_each(agents, leaders, led_rates, &|leader, rates| agents.rates_at(leader, t, rates));
    }
}

impl GroupFlow<'_, '_> {
    /// Where the states of each member begin in the row of all.
    fn firsts(&self) -> Vec<usize> {
        let sizes = self.members.iter().map(|&agent| self.agents.agents[agent].states.len());
        let begin = |first: &mut usize, n: usize| Some(std::mem::replace(first, *first + n));
        sizes.scan(0, begin).collect()
    }

    /// What the flow of member `k` reads.
    fn views<'b>(&'b self, k: usize, x: &'b [f64]) -> Views<'b> {
        if let ([_], []) = (self.members, self.leaders) {
            views(self.agents, &self.slots[k], self.absent, x)
        } else {
            self.group_views(&self.slots[k], x)
        }
    }

    /// Views for a member of a group; `x` holds the states of all members one after the other.
    fn group_views<'b>(&'b self, slots: &Slots, x: &'b [f64]) -> Views<'b> {
        slots
            .iter()
            .map(|&agent| {
                if agent == ABSENT {
                    return AgentView::absent(self.absent);
                }
                let row = &self.agents.agents[agent];
                let place = |among: &[usize]| {
                    let first = among.iter().take_while(|&&other| other != agent);
                    let first: usize = first.map(|&other| self.agents.agents[other].states.len()).sum();
                    first..first + row.states.len()
                };
                let (states, rates): (&[f64], &[f64]) = if self.members.binary_search(&agent).is_ok() {
                    (&x[place(self.members)], &[])
                } else if self.leaders.binary_search(&agent).is_ok() {
                    (&self.led[place(self.leaders)], &self.led_rates[place(self.leaders)])
                } else {
                    (&row.states, &[])
                };
                AgentView { states, rates, accelerations: &[], aux: &row.aux }
            })
            .collect()
    }

    /// Whose rate was not finite, and why.
    pub fn blame(&mut self, undefined: &Undefined) -> Option<Blame> {
        self.look_at(undefined.time);
        let mut state = undefined.index;
        for (k, &agent) in self.members.iter().enumerate() {
            let n = self.agents.agents[agent].states.len();
            if state < n {
                let flow = self.agents.flow(agent);
                let slots = &self.views(k, &undefined.states);
                let point = Point { frame: &flow.frame, slots, time: undefined.time };
                return self.agents.program.blame(flow.rates, state, &point);
            }
            state -= n;
        }
        None
    }
}

/// Where a flow first was not finite.
#[derive(Clone, Debug, PartialEq)]
pub struct Undefined {
    /// s.
    pub time: f64,
    /// The states of all members.
    pub states: Vec<f64>,
    /// Which rate.
    pub index: usize,
}

/// A flow that remembers where it first was not finite.
pub struct Witness<'f, 'a, 'p> {
    /// The flow.
    pub flow: &'f mut GroupFlow<'a, 'p>,
    /// Where it was not finite.
    pub found: Option<Undefined>,
}

impl Flow for Witness<'_, '_, '_> {
    fn rates(&mut self, t: f64, x: &[f64], dx: &mut [f64]) {
        self.flow.rates(t, x, dx);
        if self.found.is_none() && x.iter().all(|state| state.is_finite()) {
            let bad = dx.iter().position(|rate| !rate.is_finite());
            self.found = bad.map(|index| Undefined { time: t, states: x.to_vec(), index });
        }
    }

    fn tsit5(&mut self, _t: f64, _h: f64, _rows: Tsit5Rows<'_>) -> bool {
        false
    }

    fn jacobian(&mut self, t: f64, x: &[f64], jacobian: &mut Jacobian) {
        self.flow.jacobian(t, x, jacobian);
    }

    fn time_rates(&mut self, t: f64, x: &[f64], rates: &mut [f64]) {
        self.flow.time_rates(t, x, rates);
    }
}

impl Flow for GroupFlow<'_, '_> {
    fn rates(&mut self, t: f64, x: &[f64], dx: &mut [f64]) {
        self.look_at(t);
        self.evaluations += self.members.len() as u64;
        let (mut first, mut operations) = (0, 0);
        for (k, &agent) in self.members.iter().enumerate() {
            let n = self.agents.agents[agent].states.len();
            let kernel = self.agents.program.kernel(self.agents.flow(agent).rates);
            let own = &x[first..first + n];
            let views = match self.slots[k][..] {
                [_] => views(self.agents, &self.slots[k], self.absent, own),
                _ => self.views(k, x),
            };
            kernel.eval(&views, t, &mut dx[first..first + n]);
            operations += kernel.operations();
            first += n;
        }
        self.operations += operations;
    }

    fn tsit5(&mut self, t: f64, h: f64, rows: Tsit5Rows<'_>) -> bool {
        let [agent] = *self.members else { return false };
        let agent = &self.agents.agents[agent];
        let Some(kernel) = &self.agents.program.steps[agent.ty][agent.mode] else { return false };
        let views = views(self.agents, &self.slots[0], self.absent, rows.x);
        if !kernel.step(&views, t, h, rows.k, rows.x_new, rows.error) {
            return false;
        }
        self.evaluations += WHOLE_STEP;
        self.operations +=
            WHOLE_STEP * self.agents.program.kernel(self.agents.flow(self.members[0]).rates).operations();
        true
    }

    fn series(&mut self, t: f64, x: &[f64], order: usize, rows: &mut SeriesRows) -> bool {
        let [agent] = *self.members else { return false };
        let agent = &self.agents.agents[agent];
        let Some(tape) = &self.agents.program.series[agent.ty][agent.mode] else { return false };
        self.evaluations += order as u64;
        self.operations += tape.operations(order);
        let views = views(self.agents, &self.slots[0], self.absent, x);
        rows.fixed.resize(tape.fixed.len(), 0.0);
        rows.coefficients.resize(tape.n_coefficients(order), 0.0);
        rows.is_polynomial = tape.is_polynomial();
        tape.fix(|slot, column| views[slot as usize].aux[column as usize], &mut rows.fixed);
        tape.expand(t, x, &rows.fixed, order, &mut rows.coefficients);
        true
    }

    /// The blocks of the members' own Jacobians, each at the places of the agents in its slots.
    fn jacobian(&mut self, t: f64, x: &[f64], jacobian: &mut Jacobian) {
        jacobian.reset(x.len());
        self.look_at(t);
        self.jacobians += self.members.len() as u64;
        let firsts = self.firsts();
        let mut values = Vec::new();
        let mut operations = 0;
        for (k, &agent) in self.members.iter().enumerate() {
            let flow = self.agents.flow(agent);
            let kernel = self.agents.program.kernel(flow.jacobian_values);
            values.resize(flow.jacobian.len(), 0.0);
            kernel.eval(&self.views(k, x), t, &mut values);
            operations += kernel.operations();
            for (entry, &value) in flow.jacobian.iter().zip(&values) {
                // What is read of an agent that is absent, or of one that does not move with these, is no state here.
                if let Ok(other) = self.members.binary_search(&self.slots[k][entry.slot]) {
                    jacobian.push(firsts[k] + entry.row, firsts[other] + entry.column, value);
                }
            }
        }
        self.operations += operations;
    }

    /// The second rates of states that stand still; leaders do not.
    fn time_rates(&mut self, t: f64, x: &[f64], rates: &mut [f64]) {
        self.look_at_rates(t);
        let still = vec![0.0; self.absent.len()];
        let (mut first, mut operations) = (0, 0);
        for (k, &agent) in self.members.iter().enumerate() {
            let n = self.agents.agents[agent].states.len();
            let flow = self.agents.flow(agent);
            let own = &mut rates[first..first + n];
            if self.agents.program.kernel(flow.rates).reads().time || !self.leaders.is_empty() {
                let kernel = self.agents.program.kernel(flow.accelerations);
                let mut views = self.views(k, x);
                views.iter_mut().filter(|view| view.rates.is_empty()).for_each(|view| view.rates = &still);
                kernel.eval(&views, t, own);
                operations += kernel.operations();
            } else {
                own.fill(0.0);
            }
            first += n;
        }
        self.operations += operations;
    }
}

/// Views for an agent whose flow reads no foreign states: `x` is its own.
fn views<'a>(agents: &'a Agents<'_>, slots: &Slots, absent: &'a [f64], x: &'a [f64]) -> Views<'a> {
    slots
        .iter()
        .enumerate()
        .map(|(slot, &agent)| {
            if agent == ABSENT {
                return AgentView::absent(absent);
            }
            let other = &agents.agents[agent];
            let states = if slot == 0 || agent == slots[0] { x } else { &other.states };
            AgentView { states, rates: &[], accelerations: &[], aux: &other.aux }
        })
        .collect()
}

/// Fills in the row of some agents' states or rates, one agent after the other.
fn of_each(agents: &Agents<'_>, numbers: &[usize], row: &mut [f64], fill: &dyn Fn(usize, &mut [f64])) {
    let mut rest = row;
    for &number in numbers {
        let (own, others) = rest.split_at_mut(agents.agents[number].states.len());
        fill(number, own);
        rest = others;
    }
}
