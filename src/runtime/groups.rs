//! Groups: agents whose flows read each other's states step together, on one clock (rule 13).
//!
//! The groups are the connected components of "the active flow of i reads states of j". An agent that is not coupled
//! is a group of its own.

use crate::runtime::population::{ABSENT, Agents};
use crate::runtime::solve::integrate::Integration;

/// Agents on one clock.
#[derive(Clone, Debug, Default)]
pub struct Group {
    /// Their numbers, rising; empty for a group that has been dissolved.
    pub members: Vec<usize>,
    /// End of the last step or time of the last event, s; infinite for members without states.
    pub clock: f64,
    /// What the integration of all members, one after the other, remembers.
    pub integration: Integration,
    /// The modes of the members for which the integration has settled on a method; empty before its first step.
    pub modes: Vec<usize>,
    /// Kinks that the last step ends at: agent, kink of its flow, change of its lock.
    pub kinks: Vec<KinkHit>,
    /// Changes whenever something that was derived from the group's future becomes void.
    pub version: u32,
}

/// A kink of an agent's flow that has been reached.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KinkHit {
    /// Whose flow.
    pub agent: usize,
    /// Which kink of its flow.
    pub kink: usize,
    /// The lock's value before.
    pub before: f64,
    /// The lock's new value.
    pub lock: f64,
}

/// All groups. Slots of dissolved ones are used again.
#[derive(Clone, Debug, Default)]
pub struct Groups {
    /// By number.
    pub groups: Vec<Group>,
    free: Vec<usize>,
    together: bool,
}

impl Groups {
    /// From now on all agents are one group, coupled or not.
    pub fn step_together(&mut self) {
        self.together = true;
    }

    /// Divides `members` into groups that begin at time `clock`; each agent is told its group. Returns the groups made.
    pub fn divide(
        &mut self,
        agents: &mut Agents<'_>,
        members: &[usize],
        clock: f64,
        h: &dyn Fn(usize) -> Option<f64>,
    ) -> Vec<usize> {
        let mut made = Vec::new();
        let components = if self.together { vec![members.to_vec()] } else { components(agents, members) };
        for component in components {
            let number = self.free.pop().unwrap_or_else(|| {
                self.groups.push(Group::default());
                self.groups.len() - 1
            });
            let has_states = component.iter().any(|&agent| !agents.agents[agent].states.is_empty());
            let version = self.groups[number].version + 1;
            let step = component.iter().filter_map(|&agent| h(agent)).min_by(f64::total_cmp);
            for &agent in &component {
                agents.agents[agent].group = number;
            }
            self.groups[number] = Group {
                members: component,
                clock: if has_states { clock } else { f64::INFINITY },
                integration: Integration::new(step),
                version,
                ..Group::default()
            };
            made.push(number);
        }
        made
    }

    /// Dissolves a group.
    pub fn dissolve(&mut self, number: usize) {
        let group = &mut self.groups[number];
        group.members.clear();
        group.version += 1;
        group.clock = f64::INFINITY;
        self.free.push(number);
    }
}

/// The agents whose states the active flow of an agent reads.
pub fn couples(agents: &Agents<'_>, agent: usize) -> Vec<usize> {
    let flow = agents.flow(agent);
    if flow.couples.is_empty() {
        return Vec::new();
    }
    let slots = agents.slots(&flow.frame, &[agent]);
    flow.couples.iter().map(|&slot| slots[slot]).filter(|&other| other != ABSENT && other != agent).collect()
}

/// The connected components of `members`, each rising, in order of their first members.
fn components(agents: &Agents<'_>, members: &[usize]) -> Vec<Vec<usize>> {
    let mut sorted = members.to_vec();
    sorted.sort_unstable();
    sorted.dedup();
    let place = |agent: usize| sorted.binary_search(&agent).ok();
    let mut root: Vec<usize> = (0..sorted.len()).collect();
    for (k, &agent) in sorted.iter().enumerate() {
        for other in couples(agents, agent) {
            if let Some(other) = place(other) {
                let (a, b) = (find(&mut root, k), find(&mut root, other));
                root[a.max(b)] = a.min(b);
            }
        }
    }
    let mut components: Vec<Vec<usize>> = vec![Vec::new(); sorted.len()];
    for (k, &agent) in sorted.iter().enumerate() {
        let first = find(&mut root, k);
        components[first].push(agent);
    }
    components.retain(|component| !component.is_empty());
    components
}

fn find(root: &mut [usize], mut k: usize) -> usize {
    while root[k] != k {
        root[k] = root[root[k]];
        k = root[k];
    }
    k
}
