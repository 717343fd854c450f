//! The right-hand side of a group: the flows of all its members at one time, the states of all in one row.

use crate::codegen::kernel::AgentView;
use crate::runtime::population::{ABSENT, Agents, Slots};
use crate::runtime::present::Views;
use crate::runtime::solve::method::{Flow, Tsit5Rows};

/// Right-hand sides that a whole step of Tsitouras' pair evaluates.
const WHOLE_STEP: u64 = 6;

/// The flow of a group at its clock.
pub struct GroupFlow<'a, 'p> {
    agents: &'a Agents<'p>,
    members: &'a [usize],
    /// The agents that each member's flow reads.
    slots: Vec<Slots>,
    /// The row of an agent that is not there.
    absent: &'a [f64],
    /// Right-hand sides evaluated, one for each member.
    pub evaluations: u64,
}

impl<'a, 'p> GroupFlow<'a, 'p> {
    /// The flow of some agents that step together; `absent` is a row for those that are not there.
    pub fn new(agents: &'a Agents<'p>, members: &'a [usize], absent: &'a [f64]) -> Self {
        let slots = members.iter().map(|&agent| agents.slots(&agents.flow(agent).frame, &[agent])).collect();
        Self { agents, members, slots, absent, evaluations: 0 }
    }
}

impl Flow for GroupFlow<'_, '_> {
    fn rates(&mut self, t: f64, x: &[f64], dx: &mut [f64]) {
        self.evaluations += self.members.len() as u64;
        let mut first = 0;
        for (&agent, slots) in self.members.iter().zip(&self.slots) {
            let n = self.agents.agents[agent].states.len();
            let views = if let [_] = self.members {
                views(self.agents, slots, self.absent, x)
            } else {
                group_views(self.agents, self.members, slots, self.absent, x)
            };
            let kernel = self.agents.program.kernel(self.agents.flow(agent).rates);
            kernel.eval(&views, t, &mut dx[first..first + n]);
            first += n;
        }
    }

    fn tsit5(&mut self, t: f64, h: f64, rows: Tsit5Rows<'_>) -> bool {
        let [agent] = *self.members else { return false };
        let agent = &self.agents.agents[agent];
        let Some(kernel) = &self.agents.program.steps[agent.ty][agent.mode] else { return false };
        self.evaluations += WHOLE_STEP;
        let views = views(self.agents, &self.slots[0], self.absent, rows.x);
        kernel.step(&views, t, h, rows.k, rows.x_new, rows.error);
        true
    }
}

/// Views for an agent whose flow reads no foreign states: `x` is its own.
fn views<'a>(agents: &'a Agents<'_>, slots: &Slots, absent: &'a [f64], x: &'a [f64]) -> Views<'a> {
    slots
        .iter()
        .enumerate()
        .map(|(slot, &agent)| {
            if agent == ABSENT {
                return AgentView { states: absent, rates: absent, accelerations: absent, aux: absent };
            }
            let other = &agents.agents[agent];
            let states = if slot == 0 || agent == slots[0] { x } else { &other.states };
            AgentView { states, rates: &[], accelerations: &[], aux: &other.aux }
        })
        .collect()
}

/// Views for a member of a group; `x` holds the states of all members one after the other.
fn group_views<'a>(
    agents: &'a Agents<'_>,
    members: &[usize],
    slots: &Slots,
    absent: &'a [f64],
    x: &'a [f64],
) -> Views<'a> {
    slots
        .iter()
        .map(|&agent| {
            if agent == ABSENT {
                return AgentView { states: absent, rates: absent, accelerations: absent, aux: absent };
            }
            let mut first = 0;
            let mut states: &[f64] = &agents.agents[agent].states;
            for &member in members {
                let n = agents.agents[member].states.len();
                if member == agent {
                    states = &x[first..first + n];
                    break;
                }
                first += n;
            }
            AgentView { states, rates: &[], accelerations: &[], aux: &agents.agents[agent].aux }
        })
        .collect()
}
