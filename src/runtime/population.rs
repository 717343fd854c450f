//! The agents of a run: their rows, their links, and which agents read which.
//!
//! An agent has a *place*, by which everything in the runtime refers to it, and which another has after its death; and a
//! *number*, which nobody else ever has: it orders agents, and names those that are created. Among the agents of its type
//! it has a *seat*, by which comparisons below quantifiers are found.
//!
//! An agent's `states` are those at its clock (the end of its last step or the instant of its last event); its
//! `segment` holds the way there. Rows at the present instant are made on demand in [`crate::runtime::present`].

use smallvec::SmallVec;

use crate::codegen::program::{Flow, Frame, Layout, ModeSystem, Program, Slot};
use crate::runtime::ahead::Ahead;
use crate::runtime::cold::Cold;
use crate::runtime::inputs::{flow_inputs, is_followed, longest_chain, row_width};
use crate::runtime::observe::Who;
use crate::runtime::route::{begin_histories, first};
use crate::runtime::solve::leads_on;
use crate::runtime::solve::segment::Segment;

/// So many are looked up in the lists of their types one by one.
const FEW_DEAD: usize = 8;

/// How many seats a type gets that has had none.
const SEATS_LEAST: usize = 8;

/// No agent: what a slot holds whose link is `none`.
pub const ABSENT: usize = usize::MAX;

/// The agents in the slots of a frame; [`ABSENT`] where there is none.
pub type Slots = SmallVec<[usize; 4]>;

/// Nobody: what has a place and no number yet, or none any more.
const NOBODY: usize = usize::MAX;

/// One agent.
#[derive(Clone, Debug)]
pub struct Agent {
    /// Its number, rising in the order of births; that of a dead one is void.
    pub number: usize,
    /// Its type.
    pub ty: usize,
    /// Its seat among the agents of its type.
    pub seat: usize,
    /// What its random numbers belong to, if it was created: [`crate::math::draw::Key::word`] of its creator.
    pub word: Option<u64>,
    /// How many agents it has created.
    pub created: u64,
    /// The configuration it is in: a leaf mode, or one of each region.
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
    /// Steps beyond that, for those whose flows read it.
    pub ahead: Ahead,
}

impl Agent {
    /// The trajectory that covers `t`: its last step, or one ahead of that.
    fn way(&self, t: f64) -> &Segment {
        let beyond = if self.segment.end < t { self.ahead.covering(t) } else { None };
        beyond.map_or(&self.segment, |way| &way.segment)
    }
}

/// What bounds of where an agent gets to rest on. Many are asked for at once: they lie close together.
#[derive(Clone, Copy, Debug, Default)]
pub struct Course {
    /// Changes whenever what was derived from where the agent gets to becomes void.
    pub version: u32,
    /// Whether it has its clock for itself, and its flow reads nobody else.
    pub alone: bool,
}

/// All agents with their links.
pub struct Agents<'p> {
    /// The program they follow.
    pub program: &'p Program,
    /// By place.
    pub agents: Vec<Agent>,
    /// By place.
    pub courses: Vec<Course>,
    /// Who runs ahead.
    pub cold: Cold<'p>,
    /// The places of the living agents of each type, in the order of their numbers.
    pub of_type: Vec<Vec<usize>>,
    /// For each type, who has which seat; [`ABSENT`] if nobody has it.
    pub seats: Vec<Vec<usize>>,
    /// How many agents there have been.
    pub n_numbers: usize,
    /// How often a column that guards may read, or who is among them, has changed.
    pub changes: u64,
    /// For each type, how many have been created and destroyed.
    pub turnover: Vec<[u64; 2]>,
    /// Seats of each type that nobody has.
    free_seats: Vec<Vec<usize>>,
    /// Places that nobody has.
    free: Vec<usize>,
    /// Places of those who died in the instant at hand.
    retired: Vec<usize>,
    /// Places and numbers of those who are still in the lists of their types, though they have died.
    dismissed: Vec<(usize, usize)>,
    /// For each agent, those that have a link to it.
    linked_from: Vec<Vec<usize>>,
    /// The longest chain of links that any frame follows.
    chain_max: usize,
    /// A row of an agent that is absent.
    absent: Vec<f64>,
    /// For each type and mode, the auxiliary columns that the flow depends on, by itself or through its kinks.
    flow_inputs: Vec<Vec<Vec<(usize, usize)>>>,
    /// For each type, whether any flow reads states of another agent of it.
    is_followed: Vec<bool>,
}

impl<'p> Agents<'p> {
    /// The population at t = 0, before entry actions.
    pub fn new(program: &'p Program) -> Self {
        let mut of_type = vec![Vec::new(); program.types.len()];
        let mut agents = Vec::with_capacity(program.population.agents.len());
        for (number, instance) in program.population.agents.iter().enumerate() {
            let ty = instance.ty.index();
            let system = &program.types[ty];
            let mode = first(system, instance.mode.index());
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
            let seat = of_type[ty].len();
            of_type[ty].push(number);
            let mut states = instance.states.clone();
            // What is left of hazards is drawn when their transitions are armed.
            states.resize(system.layout.n_states, 1.0);
            let (segment, ahead) = (Segment::at(0.0, &states), Ahead::default());
            let draws = vec![0; system.streams.len()];
            let (word, created, group) = (None, 0, 0);
            agents.push(Agent {
                number,
                ty,
                seat,
                word,
                created,
                mode,
                group,
                states,
                aux,
                draws,
                segment,
                ahead,
            });
        }
        if let Some(ty) = program.watcher() {
            agents.push(watcher(program, ty, agents.len()));
            of_type[ty].push(agents.len() - 1);
        }
        let mut linked_from = vec![Vec::new(); agents.len()];
        for (_, target) in named(program) {
            linked_from[target].push(agents.len() - 1);
        }
        for (number, instance) in program.population.agents.iter().enumerate() {
            for target in instance.links.iter().flatten() {
                linked_from[*target].push(number);
            }
        }
        Self {
            program,
            seats: of_type.clone(),
            n_numbers: program.population.agents.len(),
            changes: 0,
            turnover: vec![[0; 2]; program.types.len()],
            free_seats: vec![Vec::new(); program.types.len()],
            free: Vec::new(),
            retired: Vec::new(),
            dismissed: Vec::new(),
            courses: vec![Course::default(); agents.len()],
            agents,
            of_type,
            linked_from,
            chain_max: longest_chain(program),
            flow_inputs: flow_inputs(program),
            is_followed: is_followed(program),
            cold: Cold::default(),
            absent: vec![f64::NAN; row_width(program)],
        }
    }

    /// The states of an agent at `t`, which is not before what is kept of its way.
    pub fn states_at(&self, number: usize, t: f64, states: &mut [f64]) {
        let agent = &self.agents[number];
        if self.cold.is_cold(number) && self.cold.knows(number, t) {
            return self.cold.states_at(number, t, states);
        }
        if agent.segment.end == t {
            return states.copy_from_slice(&agent.states);
        }
        agent.way(t).states(t, states);
    }

    /// The rates of an agent that is not cold at `t`, by its dense output.
    pub fn rates_at(&self, number: usize, t: f64, rates: &mut [f64]) {
        let (mut x, mut ddx) = (rates.to_vec(), rates.to_vec());
        self.agents[number].way(t).jet(t, &mut x, rates, &mut ddx);
    }

    /// Up to when the way of an agent that is not cold is known, s.
    pub fn known_until(&self, agent: usize) -> f64 {
        let agent = &self.agents[agent];
        agent.ahead.last().map_or(agent.segment.end, |way| way.segment.end)
    }

    /// Where the step of an agent ends that leads on from `t`, s.
    pub fn way_until(&self, agent: usize, t: f64) -> f64 {
        let agent = &self.agents[agent];
        let ways = std::iter::once(agent.segment.end).chain(agent.ahead.ends());
        ways.into_iter().find(|&end| leads_on(t, end)).unwrap_or(t)
    }

    /// Which of the steps ahead of an agent leads on from `t`; none if it is its last step.
    pub fn way_from(&self, agent: usize, t: f64) -> Option<usize> {
        let agent = &self.agents[agent];
        if leads_on(t, agent.segment.end) { None } else { agent.ahead.leading_from(t) }
    }

    /// Exchanges the last segment of an agent for that of a step ahead.
    pub fn exchange(&mut self, agent: usize, way: Option<usize>) {
        let Agent { segment, ahead, .. } = &mut self.agents[agent];
        if let Some(way) = way.and_then(|way| ahead.get(way)) {
            std::mem::swap(segment, &mut way.segment);
        }
    }

    /// The agents whose states the active flow of an agent reads, without itself.
    pub fn couples(&self, agent: usize) -> Vec<usize> {
        let flow = self.flow(agent);
        if flow.couples.is_empty() {
            return Vec::new();
        }
        let slots = self.slots(&flow.frame, &[agent]);
        flow.couples
            .iter()
            .map(|&slot| slots[slot])
            .filter(|&other| other != ABSENT && other != agent)
            .collect()
    }

    /// Whether any flow reads states of another agent of its type.
    pub fn may_be_followed(&self, agent: usize) -> bool {
        self.is_followed[self.agents[agent].ty]
    }

    /// The agents whose active flows read states of an agent, without itself.
    pub fn followers(&self, agent: usize) -> Vec<usize> {
        if !self.may_be_followed(agent) {
            return Vec::new();
        }
        let mut followers = self.readers(agent);
        followers.retain(|&reader| reader != agent && self.couples(reader).contains(&agent));
        followers
    }

    /// What is read of an agent that is absent.
    pub fn absent_row(&self) -> &[f64] {
        &self.absent
    }

    /// How many places there are, those of dead agents included.
    pub fn len(&self) -> usize {
        self.agents.len()
    }

    /// How many are alive.
    pub fn n_living(&self) -> usize {
        self.of_type.iter().map(Vec::len).sum()
    }

    /// Whether somebody who is alive has this place.
    pub fn is_alive(&self, agent: usize) -> bool {
        self.agents.get(agent).is_some_and(|agent| agent.number != NOBODY)
    }

    /// The places of all who are alive, in the order of their numbers.
    pub fn living(&self) -> Vec<usize> {
        let mut all: Vec<usize> = self.of_type.iter().flatten().copied().collect();
        all.sort_unstable_by_key(|&agent| self.agents[agent].number);
        all
    }

    /// The same without the one that only watches.
    pub fn visible(&self) -> Vec<usize> {
        let mut all = self.living();
        all.retain(|&agent| self.who(agent).is_visible());
        all
    }

    /// The number of who has a place; greater than all for [`ABSENT`].
    pub fn number(&self, agent: usize) -> usize {
        if agent == ABSENT { usize::MAX } else { self.agents[agent].number }
    }

    /// An agent as outputs know it.
    pub fn who(&self, agent: usize) -> Who {
        let agent = &self.agents[agent];
        Who { number: agent.number, ty: agent.ty }
    }

    /// Takes a new agent in, with the next number and no links; returns its place. Whether the type has a free seat has been
    /// seen to: [`Agents::has_seat`].
    pub fn admit(&mut self, mut agent: Agent) -> usize {
        let ty = agent.ty;
        agent.number = self.n_numbers;
        self.n_numbers += 1;
        self.changes += 1;
        self.turnover[ty][0] += 1;
        let place = self.free.pop().unwrap_or(self.agents.len());
        agent.seat = self.free_seats[ty].pop().expect("a seat has been made");
        agent.aux[Layout::NUMBER] = place as f64;
        self.seats[ty][agent.seat] = place;
        self.of_type[ty].push(place);
        if place == self.agents.len() {
            self.agents.push(agent);
            self.courses.push(Course::default());
            self.linked_from.push(Vec::new());
        } else {
            self.agents[place] = agent;
        }
        self.divert(place);
        place
    }

    /// What was derived from where an agent gets to is void.
    pub fn divert(&mut self, agent: usize) {
        self.courses[agent].version += 1;
    }

    /// Whether a type has a seat that nobody has.
    pub fn has_seat(&self, ty: usize) -> bool {
        !self.free_seats[ty].is_empty()
    }

    /// Gives a type more seats; they are behind those that there are.
    pub fn add_seats(&mut self, ty: usize) {
        let before = self.seats[ty].len();
        let after = (2 * before).max(SEATS_LEAST);
        self.seats[ty].resize(after, ABSENT);
        self.free_seats[ty].extend((before..after).rev());
    }

    /// Takes a dead agent's seat, and its links from those whom they led to. Its place is free after the instant; it is among
    /// those of its type before [`Agents::close_ranks`].
    pub fn dismiss(&mut self, place: usize) {
        let layout = self.layout(place);
        for link in 0..layout.n_links {
            self.link(place, link, ABSENT);
        }
        let Agent { ty, seat, number, .. } = self.agents[place];
        self.dismissed.push((place, number));
        self.seats[ty][seat] = ABSENT;
        self.free_seats[ty].push(seat);
        self.turnover[ty][1] += 1;
        self.agents[place].number = NOBODY;
        self.retired.push(place);
        self.changes += 1;
    }

    /// Takes those who have been dismissed out of the lists of their types.
    pub fn close_ranks(&mut self) {
        self.changes += 1;
        let dismissed = std::mem::take(&mut self.dismissed);
        if dismissed.len() > FEW_DEAD {
            for places in &mut self.of_type {
                places.retain(|&place| self.agents[place].number != NOBODY);
            }
            return;
        }
        for &(dead, last) in &dismissed {
            let number = |place: usize| match self.agents[place].number {
                NOBODY => dismissed.iter().find(|dead| dead.0 == place).map_or(NOBODY, |dead| dead.1),
                number => number,
            };
            let places = &mut self.of_type[self.agents[dead].ty];
            let place = places.partition_point(|&place| number(place) < last);
            places.remove(place);
        }
    }

    /// The instant is over: nothing refers to those who died in it.
    pub fn free_retired(&mut self) {
        self.free.append(&mut self.retired);
    }

    /// How many places cannot be had, by the living or by those who died in the instant at hand.
    pub fn n_occupied(&self) -> usize {
        self.n_living() + self.retired.len()
    }

    /// Leads a link of an agent to another, or to [`ABSENT`].
    pub fn link(&mut self, from: usize, link: usize, to: usize) {
        let column = self.layout(from).link(link);
        let before = self.linked(from, link);
        if before == to {
            return;
        }
        if before != ABSENT {
            let readers = &mut self.linked_from[before];
            let found = readers.iter().position(|&reader| reader == from);
            readers.swap_remove(found.expect("whom a link leads to knows where it comes from"));
        }
        if to != ABSENT {
            self.linked_from[to].push(from);
        }
        self.agents[from].aux[column] = if to == ABSENT { -1.0 } else { to as f64 };
        self.changes += 1;
    }

    /// Who has a link to an agent; once for each link.
    pub fn linked_from(&self, agent: usize) -> &[usize] {
        &self.linked_from[agent]
    }

    /// The mode an agent is in.
    pub fn mode(&self, agent: usize) -> &'p ModeSystem {
        let agent = &self.agents[agent];
        &self.program.types[agent.ty].modes[agent.mode]
    }

    /// The equations an agent follows.
    pub fn flow(&self, agent: usize) -> &'p Flow {
        self.mode(agent).flow.as_ref().expect("an agent is in a configuration, and these have flows")
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

    /// Whom a link of an agent leads to.
    pub fn linked(&self, from: usize, link: usize) -> usize {
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

    /// The agent's name: `fast`, `cars[3]`, `Car#17`.
    pub fn name(&self, agent: usize) -> String {
        let Agent { number, ty, .. } = self.agents[agent];
        if number < self.program.population.agents.len() {
            return self.program.population.agent_name(number);
        }
        format!("{}#{number}", self.program.types[ty].name)
    }

    /// What the random numbers of an agent belong to: its name, if it was there at t = 0.
    pub fn draw_path(&self, agent: usize) -> String {
        match self.agents[agent].word {
            Some(word) => format!("#{word:016x}"),
            None => self.name(agent),
        }
    }
}

/// The agent that watches, and has nothing.
fn watcher(program: &Program, ty: usize, place: usize) -> Agent {
    let system = &program.types[ty];
    let mode = first(system, 0);
    let mut aux = vec![0.0; system.layout.n_aux()];
    (aux[Layout::NUMBER], aux[Layout::MODE]) = (place as f64, mode as f64);
    (0..system.layout.n_links).for_each(|link| aux[system.layout.link(link)] = -1.0);
    named(program).for_each(|(link, target)| aux[system.layout.link(link)] = target as f64);
    Agent {
        number: Who::HIDDEN,
        ty,
        seat: 0,
        word: None,
        created: 0,
        mode,
        group: 0,
        states: Vec::new(),
        aux,
        draws: Vec::new(),
        segment: Segment::at(0.0, &[]),
        ahead: Ahead::default(),
    }
}

/// The links of whoever watches to agents that are named, and these.
fn named(program: &Program) -> impl Iterator<Item = (usize, usize)> + '_ {
    let named = program.watch.iter().flat_map(|watch| &watch.named);
    named.map(|&(link, block)| (link, program.population.blocks[block].first))
}
