//! Groups: agents whose flows read each other's states step together, on one clock (rule 13).
//!
//! With "the active flow of i reads states of j" as the edges of a graph, the groups are its strongly connected components: a
//! follower whose leader does not read it has a clock of its own, and integrates from the leader's dense output. In the
//! algorithms of 2004 they are its connected components. An agent that is not coupled is a group of its own.

use rustc_hash::{FxHashMap, FxHashSet};

use crate::runtime::population::Agents;
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
    /// The agents outside that the flows of its members read, rising.
    pub leaders: Vec<usize>,
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
    coupling: Coupling,
}

/// Who shares a clock.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Coupling {
    /// Who read each other, be it by way of others.
    #[default]
    Mutual,
    /// Who read each other, or the same, or are read by the same: the paper calls them one agent.
    Connected,
    /// All.
    Together,
}

impl Groups {
    /// No groups yet.
    pub fn new(coupling: Coupling) -> Self {
        Self { coupling, ..Self::default() }
    }

    /// Divides `members`, with whom those share a clock ([`Groups::closed`]), into groups that begin at time `clock`; each
    /// agent is told its group. Returns the groups made.
    pub fn divide(
        &mut self,
        agents: &mut Agents<'_>,
        members: &[usize],
        clock: f64,
        h: &dyn Fn(usize) -> Option<f64>,
    ) -> Vec<usize> {
        let components = self.components(agents, members);
        let mut made = Vec::with_capacity(components.len());
        self.groups.reserve(components.len().saturating_sub(self.free.len()));
        for component in components {
            let number = self.free.pop().unwrap_or_else(|| {
                self.groups.push(Group::default());
                self.groups.len() - 1
            });
            let has_states = component.iter().any(|&agent| !agents.agents[agent].states.is_empty());
            let version = self.groups[number].version + 1;
            let step = component.iter().filter_map(|&agent| h(agent)).min_by(f64::total_cmp);
            let read = component.iter().flat_map(|&agent| agents.couples(agent));
            let mut leaders: Vec<usize> =
                read.filter(|agent| component.binary_search(agent).is_err()).collect();
            leaders.sort_unstable();
            leaders.dedup();
            let alone = component.len() == 1 && leaders.is_empty();
            for &agent in &component {
                agents.agents[agent].group = number;
                agents.courses[agent].alone = alone;
                agents.divert(agent);
            }
            self.groups[number] = Group {
                members: component,
                clock: if has_states { clock } else { f64::INFINITY },
                integration: Integration::new(step),
                version,
                leaders,
                ..Group::default()
            };
            made.push(number);
        }
        made
    }

    /// The agents that share a clock, each set rising, in order of their first members among `members`.
    fn components(&self, agents: &Agents<'_>, members: &[usize]) -> Vec<Vec<usize>> {
        match self.coupling {
            Coupling::Mutual => mutual(agents, members),
            Coupling::Connected => connected(agents, members),
            Coupling::Together => vec![members.to_vec()],
        }
    }

    /// Some agents with all who share, or are to share, a clock with any of them.
    pub fn closed(&self, agents: &Agents<'_>, mut members: Vec<usize>) -> Vec<usize> {
        if self.coupling == Coupling::Connected {
            let read: Vec<usize> = members.iter().flat_map(|&agent| agents.couples(agent)).collect();
            members.extend(read);
        }
        loop {
            let with = self.components(agents, &members).into_iter().flatten();
            let mut groups: Vec<usize> = with.map(|agent| agents.agents[agent].group).collect();
            groups.sort_unstable();
            groups.dedup();
            let mut closed: Vec<usize> =
                groups.iter().flat_map(|&group| self.groups[group].members.iter().copied()).collect();
            closed.sort_unstable();
            closed.dedup();
            if closed.len() == members.len() {
                return closed;
            }
            members = closed;
        }
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

/// The strongly connected components that hold any of `members` (R. Tarjan, Depth-first search and linear graph algorithms,
/// SIAM J. Comput. 1, 1972), each rising, in order of their first members.
fn mutual(agents: &Agents<'_>, members: &[usize]) -> Vec<Vec<usize>> {
    struct Visit {
        agent: usize,
        couples: Vec<usize>,
        next: usize,
    }
    // By agent: when it was found, and the earliest found that it leads to; no more once its component is complete.
    let mut found: FxHashMap<usize, (usize, usize)> = FxHashMap::default();
    let mut complete: FxHashSet<usize> = FxHashSet::default();
    let (mut open, mut components): (Vec<usize>, Vec<Vec<usize>>) = (Vec::new(), Vec::new());
    // Who reads nobody is a component by itself.
    let (coupled, apart): (Vec<usize>, Vec<usize>) =
        members.iter().partition(|&&agent| !agents.couples(agent).is_empty());
    for &member in &coupled {
        let mut visits = Vec::new();
        let mut discovered = (!found.contains_key(&member)).then_some(member);
        loop {
            if let Some(agent) = discovered.take() {
                found.insert(agent, (found.len(), found.len()));
                open.push(agent);
                visits.push(Visit { agent, couples: agents.couples(agent), next: 0 });
            }
            let Some(Visit { agent, couples, next }) = visits.last_mut() else { break };
            let agent = *agent;
            if let Some(&other) = couples.get(*next) {
                *next += 1;
                match found.get(&other) {
                    None => discovered = Some(other),
                    Some(&(when, _)) if !complete.contains(&other) => lower(&mut found, agent, when),
                    Some(_) => {}
                }
                continue;
            }
            visits.pop();
            let (when, lowest) = found[&agent];
            if let Some(before) = visits.last() {
                lower(&mut found, before.agent, lowest);
            }
            if when == lowest {
                let first = open.iter().rposition(|&other| other == agent).unwrap_or(0);
                let mut component = open.split_off(first);
                complete.extend(&component);
                component.sort_unstable();
                components.push(component);
            }
        }
    }
    let wanted: FxHashSet<usize> = coupled.into_iter().collect();
    components.retain(|component| component.iter().any(|agent| wanted.contains(agent)));
    components.extend(apart.into_iter().map(|agent| vec![agent]));
    components.sort_unstable();
    components.dedup();
    components
}

/// Notes that an agent leads to one that was found at `when`.
fn lower(found: &mut FxHashMap<usize, (usize, usize)>, agent: usize, when: usize) {
    found.entry(agent).and_modify(|(_, lowest)| *lowest = when.min(*lowest));
}

/// The connected components of `members`, each rising, in order of their first members.
fn connected(agents: &Agents<'_>, members: &[usize]) -> Vec<Vec<usize>> {
    let mut sorted = members.to_vec();
    sorted.sort_unstable();
    sorted.dedup();
    let place = |agent: usize| sorted.binary_search(&agent).ok();
    let mut root: Vec<usize> = (0..sorted.len()).collect();
    for (k, &agent) in sorted.iter().enumerate() {
        for other in agents.couples(agent) {
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
