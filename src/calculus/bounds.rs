//! What the columns of agents can hold.
//!
//! States are unbounded, and so are parameters, which come with the data, unless they are asked for. What discrete variables are
//! given by actions is found by `growth`.

use crate::calculus::graph::Node;
use crate::calculus::system::{AgentSystem, Column, Frame, Instance, Layout, Slot, System};
use crate::math::Interval;

/// Any number of a size that computing with it does not end at infinity at once.
pub const REAL: Interval = Interval { lo: -1e300, hi: 1e300 };
/// Of instants, s.
pub const TIME: Interval = Interval { lo: 0.0, hi: 1e300 };

/// What auxiliary columns can hold.
#[derive(Clone, Debug)]
pub struct Bounds {
    /// By type, by column.
    pub aux: Vec<Vec<Interval>>,
}

impl Bounds {
    /// At t = 0, with whatever parameters and data. Only what the text declares is certain then.
    pub fn at_start(system: &System) -> Self {
        // The place of an agent that is created may be any.
        let n_agents = if system.creates() { REAL.hi } else { system.population.agents.len() as f64 };
        let aux = system.types.iter().map(|ty| columns(ty, n_agents)).collect();
        let mut bounds = Self { aux };
        let starts = hulls(system, |agent| &agent.discretes);
        for &(ty, k) in &system.population.fixed {
            if let Some(start) = starts[ty.index()].get(k) {
                bounds.aux[ty.index()][system.types[ty.index()].layout.discrete(k)] = *start;
            }
        }
        bounds
    }

    /// At t = 0, with the parameters and the data of the agents that there are.
    pub fn of_population(system: &System) -> Self {
        let mut bounds = Self::at_start(system).with_params(system);
        for (number, discretes) in hulls(system, |agent| &agent.discretes).into_iter().enumerate() {
            for (k, hull) in discretes.into_iter().enumerate() {
                bounds.aux[number][system.types[number].layout.discrete(k)] = hull;
            }
        }
        bounds
    }

    /// The bounds with the parameters of the agents that there are.
    pub fn with_params(&self, system: &System) -> Self {
        let mut bounds = self.clone();
        for (number, params) in hulls(system, |agent| &agent.params).into_iter().enumerate() {
            for (k, hull) in params.into_iter().enumerate() {
                bounds.aux[number][system.types[number].layout.param(k)] = hull;
            }
        }
        bounds
    }

    /// What a leaf can hold; a column of an agent that may be absent can be anything.
    pub fn leaf(&self, frame: &Frame, node: Node) -> Interval {
        match node {
            Node::State { .. } | Node::Rate { .. } | Node::Acceleration { .. } => REAL,
            Node::Time => TIME,
            Node::Aux { slot, column } => match frame.slots.get(slot as usize) {
                Some(Slot::Root { ty, .. }) => self.aux[*ty][column as usize],
                Some(Slot::Link { .. } | Slot::Fold { .. }) | None => Interval::WHOLE,
            },
            Node::Constant(bits) => Interval::point(f64::from_bits(bits)),
            Node::Unary(..) | Node::Binary(..) | Node::Select(..) => Interval::WHOLE,
        }
    }
}

/// What columns can hold as such, among so many agents.
fn columns(ty: &AgentSystem, n_agents: f64) -> Vec<Interval> {
    let layout = &ty.layout;
    let mut columns = vec![REAL; layout.n_aux()];
    columns[Layout::NUMBER] = Interval::new(0.0, (n_agents - 1.0).max(0.0));
    columns[Layout::MODE] = Interval::new(0.0, (ty.modes.len() - 1) as f64);
    columns[Layout::ENTRY] = TIME;
    for (k, column) in ty.params.iter().enumerate() {
        columns[layout.param(k)] = unknown(column);
    }
    for (k, column) in ty.discretes.iter().enumerate() {
        columns[layout.discrete(k)] = unknown(column);
    }
    for k in 0..layout.n_links {
        columns[layout.link(k)] = Interval::new(-1.0, n_agents);
    }
    columns
}

fn unknown(column: &Column) -> Interval {
    if column.boolean { Interval::MAYBE } else { REAL }
}

/// By type: the hulls of numbers of its agents; nothing if there are none.
fn hulls(system: &System, numbers: impl Fn(&Instance) -> &[f64]) -> Vec<Vec<Interval>> {
    let mut hulls: Vec<Vec<Interval>> = vec![Vec::new(); system.types.len()];
    for agent in system.population.agents.iter() {
        let known = &mut hulls[agent.ty.index()];
        let numbers = numbers(agent).iter().map(|&number| Interval::point(number));
        if known.is_empty() {
            known.extend(numbers);
        } else {
            known.iter_mut().zip(numbers).for_each(|(known, number)| *known = known.hull(number));
        }
    }
    hulls
}
