//! The agents of a run: their rows, their links, and which agents read which.
//!
//! An agent's `states` are those at its clock (the end of its last step or the instant of its last event); its
//! `segment` holds the way there. Rows at the present instant are made on demand in [`crate::runtime::present`].

use smallvec::SmallVec;

use crate::codegen::program::{Flow, Frame, Layout, ModeSystem, Program, Slot};
use crate::runtime::cold::Cold;
use crate::runtime::route::begin_histories;
use crate::runtime::solve::segment::Segment;

/// No agent: what a slot holds whose link is `none`.
pub const ABSENT: usize = usize::MAX;

/// The agents in the slots of a frame; [`ABSENT`] where there is none.
pub type Slots = SmallVec<[usize; 4]>;

/// One agent.
#[derive(Clone, Debug)]
pub struct Agent {
    /// Its type.
    pub ty: usize,
    /// Its place among the agents of its type.
    pub rank: usize,
    /// The leaf mode it is in.
    pub mode: usize,
    /// Its group.
    pub group: usize,
    /// Its states at its group's clock.
    pub states: Vec<f64>,
    /// Its auxiliary columns; they are always those of the present.
    pub aux: Vec<f64>,
    /// How many random numbers it has drawn, by stream of its type.
    pub draws: Vec<u64>,
    /// Its trajectory over its last step.
    pub segment: Segment,
}

/// All agents with their links.
pub struct Agents<'p> {
    /// The program they follow.
    pub program: &'p Program,
    /// By number.
    pub agents: Vec<Agent>,
    /// Who runs ahead.
    pub cold: Cold<'p>,
    /// The numbers of the agents of each type, rising.
    pub of_type: Vec<Vec<usize>>,
    /// For each agent, those that have a link to it.
    linked_from: Vec<Vec<usize>>,
    /// The longest chain of links that any frame follows.
    chain_max: usize,
    /// A row of an agent that is absent.
    absent: Vec<f64>,
    /// For each type and mode, the auxiliary columns that the flow depends on, by itself or through its kinks.
    flow_inputs: Vec<Vec<Vec<(usize, usize)>>>,
}

impl<'p> Agents<'p> {
    /// The population at t = 0, before entry actions.
    pub fn new(program: &'p Program) -> Self {
        let mut of_type = vec![Vec::new(); program.types.len()];
        let mut agents = Vec::with_capacity(program.population.agents.len());
        for (number, instance) in program.population.agents.iter().enumerate() {
            let ty = instance.ty.index();
            let system = &program.types[ty];
            let mode = instance.mode.index();
            let mut aux = vec![0.0; system.layout.n_aux()];
            aux[Layout::NUMBER] = number as f64;
            aux[Layout::MODE] = mode as f64;
            let first = system.layout.param(0);
            let links = instance.links.iter().map(|link| link.map_or(-1.0, |agent| agent as f64));
            let columns =
                instance.params.iter().copied().chain(instance.discretes.iter().copied()).chain(links);
            for (column, value) in aux[first..].iter_mut().zip(columns) {
                *column = value;
            }
            begin_histories(system, mode, &mut aux);
            let rank = of_type[ty].len();
            of_type[ty].push(number);
            let mut states = instance.states.clone();
            // What is left of hazards is drawn when their transitions are armed.
            states.resize(system.layout.n_states, 1.0);
            let segment = Segment::at(0.0, &states);
            let draws = vec![0; system.streams.len()];
            agents.push(Agent { ty, rank, mode, group: 0, states, aux, draws, segment });
        }
        let mut linked_from = vec![Vec::new(); agents.len()];
        for (number, instance) in program.population.agents.iter().enumerate() {
            for target in instance.links.iter().flatten() {
                linked_from[*target].push(number);
            }
        }
        Self {
            program,
            agents,
            of_type,
            linked_from,
            chain_max: longest_chain(program),
            flow_inputs: flow_inputs(program),
            cold: Cold::default(),
            absent: vec![f64::NAN; row_width(program)],
        }
    }

    /// The states of an agent at `t`, which is not before what is kept of its way.
    pub fn states_at(&self, number: usize, t: f64, states: &mut [f64]) {
        let agent = &self.agents[number];
        if self.cold.is_cold(number) && self.cold.knows(number, t) {
            let mut segment = Segment::default();
            self.cold.follow(number, t, states, &mut segment);
            if segment.end != t {
                segment.states(t, states);
            }
            return;
        }
        if agent.segment.end == t {
            states.copy_from_slice(&agent.states);
        } else {
            agent.segment.states(t, states);
        }
    }

    /// How far an agent has come, and its states there; `clock` is that of its group.
    pub fn at_clock(&self, agent: usize, clock: f64) -> (f64, SmallVec<[f64; 8]>) {
        if self.cold.is_cold(agent) {
            return self.cold.now(agent);
        }
        (clock, self.agents[agent].states.as_slice().into())
    }

    /// What is read of an agent that is absent.
    pub fn absent_row(&self) -> &[f64] {
        &self.absent
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.agents.len()
    }

    /// The mode an agent is in.
    pub fn mode(&self, agent: usize) -> &'p ModeSystem {
        let agent = &self.agents[agent];
        &self.program.types[agent.ty].modes[agent.mode]
    }

    /// The equations an agent follows.
    pub fn flow(&self, agent: usize) -> &'p Flow {
        self.mode(agent).flow.as_ref().expect("an agent is in a leaf mode, and leaves have flows")
    }

    /// The auxiliary columns, by slot, that the active flow of an agent depends on.
    pub fn flow_inputs(&self, agent: usize) -> &[(usize, usize)] {
        let agent = &self.agents[agent];
        &self.flow_inputs[agent.ty][agent.mode]
    }

    /// The columns of the longest row of any agent type.
    pub fn row_width(&self) -> usize {
        row_width(self.program)
    }

    /// The columns of an agent's type.
    pub fn layout(&self, agent: usize) -> &'p Layout {
        &self.program.types[self.agents[agent].ty].layout
    }

    /// The slots of a frame with the given roots; binders are still absent.
    pub fn slots(&self, frame: &Frame, roots: &[usize]) -> Slots {
        let mut slots: Slots = SmallVec::from_elem(ABSENT, frame.slots.len());
        slots[..roots.len()].copy_from_slice(roots);
        self.follow_links(frame, &mut slots);
        slots
    }

    /// Fills the slots that are reached by links.
    pub fn follow_links(&self, frame: &Frame, slots: &mut Slots) {
        for (k, slot) in frame.slots.iter().enumerate() {
            if let Slot::Link { from, link, .. } = slot {
                slots[k] = self.linked(slots[*from], *link);
            }
        }
    }

    fn linked(&self, from: usize, link: usize) -> usize {
        if from == ABSENT {
            return ABSENT;
        }
        let target = self.agents[from].aux[self.layout(from).link(link)];
        if target >= 0.0 { target as usize } else { ABSENT }
    }

    /// All agents that can reach `agent` by following links, with itself, without duplicates.
    pub fn readers(&self, agent: usize) -> Vec<usize> {
        let mut readers = vec![agent];
        let mut first = 0;
        for _ in 0..self.chain_max {
            let last = readers.len();
            for k in first..last {
                for &reader in &self.linked_from[readers[k]] {
                    if !readers.contains(&reader) {
                        readers.push(reader);
                    }
                }
            }
            first = last;
        }
        readers
    }

    /// The agent's name: `fast`, `cars[3]`.
    pub fn name(&self, agent: usize) -> String {
        self.program.population.agent_name(agent)
    }
}

fn row_width(program: &Program) -> usize {
    program.types.iter().map(|ty| ty.layout.n_aux().max(ty.layout.n_states)).max().unwrap_or(0)
}

/// The auxiliary columns that each flow depends on. Locks are not among those of its kinks: events do not write them.
fn flow_inputs(program: &Program) -> Vec<Vec<Vec<(usize, usize)>>> {
    let of_flow = |flow: &Flow| {
        let mut columns = program.kernel(flow.rates).reads().columns.clone();
        for kink in &flow.kinks {
            columns.extend_from_slice(&program.kernel(kink.initial).reads().columns);
        }
        columns.sort_unstable();
        columns.dedup();
        columns
    };
    let of_mode = |mode: &ModeSystem| mode.flow.as_ref().map_or_else(Vec::new, of_flow);
    program.types.iter().map(|ty| ty.modes.iter().map(of_mode).collect()).collect()
}

/// The longest chain of links in any frame of the program.
fn longest_chain(program: &Program) -> usize {
    let mut longest = 0;
    let mut visit = |frame: &Frame| {
        let mut depths = vec![0; frame.slots.len()];
        for (k, slot) in frame.slots.iter().enumerate() {
            if let Slot::Link { from, .. } = slot {
                depths[k] = depths[*from] + 1;
                longest = longest.max(depths[k]);
            }
        }
    };
    for ty in &program.types {
        for mode in &ty.modes {
            mode.flow.iter().for_each(|flow| visit(&flow.frame));
            mode.claims.iter().for_each(|claim| visit(&claim.frame));
        }
        ty.transitions.iter().for_each(|transition| visit(&transition.frame));
    }
    let pairs = program.interactions.iter().flat_map(|interaction| &interaction.transitions);
    pairs.for_each(|pair| visit(&pair.transition.frame));
    longest
}
