//! Listing of near pairs: which instances an interaction needs for the time to come.
//!
//! A pair that is not listed cannot make its condition true: its flag is armed, and nothing else is remembered of it. An
//! agent that is written, or whose flow changes, so that it may leave its box, is listed anew at once (rule 14).

use std::ops::{ControlFlow, Range};

use smallvec::SmallVec;

use crate::codegen::program::{Entry, Near};
use crate::math::Interval;
use crate::runtime::act::Written;
use crate::runtime::arm::Rule;
use crate::runtime::definition::Nearby;
use crate::runtime::engine::Engine;
use crate::runtime::failure::{Failure, Reason};
use crate::runtime::grid::Grid;
use crate::runtime::guards::Origin;
use crate::runtime::neighbours::{Field, Listed, NOWHERE, Scopes, Way};
use crate::runtime::population::ABSENT;

/// What is new in the list of a field.
#[derive(Debug)]
pub struct New {
    /// The instance of the pair, or that of the guard that looks at a candidate.
    instance: u32,
    /// The candidate.
    candidate: Option<Nominee>,
}

/// What becomes of pairs that are not near any more.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Far {
    /// They are forgotten.
    LetGo,
    /// They stay in the list: in the middle of an instant somebody may still ask what has become of them.
    Keep,
}

/// A new candidate.
#[derive(Debug)]
struct Nominee {
    /// Who it is.
    agent: usize,
    /// The number of the quantifier that looks at it.
    number: usize,
    /// The comparisons that are bound to it.
    atoms: Range<usize>,
}

impl<'p> Engine<'p, '_> {
    /// Makes the fields of the interactions that have a range; nothing is listed yet.
    pub fn make_fields(&mut self) {
        let mut fields = Vec::new();
        for (number, definition) in self.guards.definitions.iter().enumerate() {
            let is_link = matches!(definition.origin, Origin::Link(_));
            let mut add = |quantifier: Option<usize>, ty: usize, near: &[Near], symmetric, with_self| {
                let types = [definition.ty, ty];
                let is_same = |near: &Near| near.own == near.other;
                let alike = types[0] == types[1] && near.iter().all(is_same) && !is_link;
                let scopes = Scopes::default();
                let (seats, grid, listed) = ([0; 2], Grid::default(), Vec::new());
                let definition = number;
                fields.push(Field {
                    definition,
                    quantifier,
                    types,
                    alike,
                    symmetric,
                    with_self,
                    seats,
                    grid,
                    listed,
                    is_link,
                    scopes,
                });
            };
            match definition.origin {
                Origin::Pair(pair) if !definition.near.is_empty() => {
                    add(None, definition.frame.slots[1].ty(), definition.near, pair.symmetric, false);
                }
                _ => {}
            }
            for (quantifier, Nearby { range, near, .. }) in definition.nearby.iter().enumerate() {
                add(Some(quantifier), range.ty, near, false, range.ty == definition.ty && !range.other);
            }
        }
        self.neighbours.fields = fields;
    }

    /// Whether there are interactions that have a range.
    pub fn has_fields(&self) -> bool {
        !self.neighbours.fields.is_empty()
    }

    /// Lists the pairs that can come within range from the present instant up to `until`; returns what is new.
    pub fn list_pairs(&mut self, until: f64) -> Result<Vec<New>, Failure> {
        let mut fields = std::mem::take(&mut self.neighbours.fields);
        self.neighbours.until = until;
        self.neighbours.ways.clear();
        let mut new = Vec::new();
        let mut done = Ok(());
        for field in &mut fields {
            done = self.list_field(field, Far::LetGo, &mut new);
            if done.is_err() {
                break;
            }
        }
        self.neighbours.fields = fields;
        self.guards.free_retired();
        done.map(|()| new)
    }

    fn list_field(&mut self, field: &mut Field, far: Far, new: &mut Vec<New>) -> Result<(), Failure> {
        let near = self.ranges_of(field);
        let mut boxes = field.grid.take_boxes();
        field.seats = field.seats_of(&self.agents);
        field.scopes.changed.clear();
        for side in field.sides() {
            for seat in 0..field.seats[side] {
                match self.agents.seats[field.types[side]][seat] {
                    ABSENT => boxes.extend(near.iter().map(|_| NOWHERE)),
                    agent => boxes.extend(self.reach(field, agent, side)),
                }
            }
        }
        field.grid.renew(near.len(), boxes);
        let mut wanted: Vec<[u32; 2]> = Vec::new();
        let most = self.limits.guards_max;
        let found = field.grid.for_each_pair(&mut |a, b| {
            wanted.extend(field.pairs(&self.agents, a, b));
            if wanted.len() > most || self.interrupted() {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        });
        if found.is_break() {
            self.mind_guards(wanted.len() as u128)?;
            // The run ends here: nobody asks for the rest.
            wanted.clear();
        }
        wanted.extend(field.selves(&self.agents).iter().map(|&agent| [agent as u32; 2]));
        wanted.sort_unstable();
        let mut before = std::mem::take(&mut field.listed);
        before.retain(|listed| self.is_listed(field, listed));
        before.sort_unstable();
        before.dedup();
        let mut before = before.into_iter().peekable();
        for agents in wanted {
            while let Some(old) = before.next_if(|old| old.agents < agents) {
                self.see_off(old, far, field);
            }
            match before.next_if(|old| old.agents == agents) {
                Some(old) => field.listed.push(old),
                None => new.push(self.enter(field, agents)?),
            }
        }
        for old in before {
            self.see_off(old, far, field);
        }
        self.guards.thin();
        Ok(())
    }

    /// How near the agents of a field's pairs are where its condition is not settled.
    pub fn ranges_of(&self, field: &Field) -> &'p [Near] {
        let definition = &self.guards.definitions[field.definition];
        field.quantifier.map_or(definition.near, |number| definition.nearby[number].near)
    }

    /// Whether nobody of a listed pair has died.
    fn is_listed(&self, field: &Field, &Listed { agents, instance }: &Listed) -> bool {
        let state = &self.guards.instances[instance as usize];
        match field.quantifier {
            Some(number) => {
                let candidate = self.guards.candidate(&self.agents, instance, number, agents[1] as usize);
                state.listed && state.roots[0] == agents[0] && candidate.is_some()
            }
            None => state.listed && state.roots == agents,
        }
    }

    fn see_off(&mut self, old: Listed, far: Far, field: &mut Field) {
        match far {
            Far::LetGo => self.let_go(old, field),
            Far::Keep => field.listed.push(old),
        }
    }

    /// Forgets a pair that is not near any more, but for one whose guard has not been found false since it fired.
    fn let_go(&mut self, old: Listed, field: &mut Field) {
        if let Some(number) = field.quantifier {
            self.guards.dismiss(&self.agents, old.instance, number, old.agents[1] as usize);
        } else if self.guards.instances[old.instance as usize].armed {
            self.guards.retire(old.instance);
        } else {
            field.listed.push(old);
        }
    }

    /// Lists a pair of a field.
    fn enter(&mut self, field: &mut Field, agents: [u32; 2]) -> Result<New, Failure> {
        let Some(number) = field.quantifier else {
            let instance = self.new_pair(field.definition, agents)?;
            field.listed.push(Listed { agents, instance });
            return Ok(New { instance, candidate: None });
        };
        let instance = self.guards.instance_of(field.definition, agents[0] as usize);
        let instance = instance.expect("a guard that is not of a pair has an instance for each agent");
        let n = self.guards.n_for_candidate(instance, number);
        self.mind_guards((self.guards.instances.len() + self.guards.atoms.len() + n) as u128)?;
        field.listed.push(Listed { agents, instance });
        let agent = agents[1] as usize;
        let atoms = self.guards.nominate(&self.agents, instance, number, agent);
        Ok(New { instance, candidate: Some(Nominee { agent, number, atoms }) })
    }

    fn new_pair(&mut self, definition: usize, agents: [u32; 2]) -> Result<u32, Failure> {
        self.mind_guards(self.guards.instances.len() as u128 + 1)?;
        let instance = self.guards.list(&self.agents, definition, agents);
        self.repetitions.forget(instance);
        Ok(instance)
    }

    /// Fails if there would be more guard instances than the limit allows.
    pub fn mind_guards(&self, needed: u128) -> Result<(), Failure> {
        let limit = self.limits.guards_max;
        if needed > limit as u128 { Err(Reason::GuardLimit { needed, limit }.into()) } else { Ok(()) }
    }

    /// Where an agent can get to before the lists are made anew, in what is compared of it, with half of the range around; of a
    /// link the owner with all of it.
    fn reach(&mut self, field: &mut Field, agent: usize, side: usize) -> Way {
        let near = self.ranges_of(field);
        let rooms: SmallVec<[f64; 4]> = if field.is_link {
            self.rooms(field, agent, side)
        } else {
            near.iter().map(|near| 0.5 * near.within * (1.0 + 1e-12)).collect()
        };
        self.box_of(field, agent, side, &rooms)
    }

    /// Where an agent can get to before the lists are made anew, in what is compared of it, with so much room around.
    pub fn box_of(&mut self, field: &Field, agent: usize, side: usize, rooms: &[f64]) -> Way {
        let near = self.ranges_of(field);
        let (way, aux) = (self.way(agent), &self.agents.agents[agent].aux);
        let around = |(near, room): (&Near, &f64)| {
            let bound = match near.entry(side) {
                Entry::State(k) => way[k],
                Entry::Aux(column) => Interval::point(aux[column]),
            };
            Interval { lo: bound.lo - room, hi: bound.hi + room }
        };
        near.iter().zip(rooms).map(around).collect()
    }

    /// Lists anew, at the present instant, those of some agents that may leave the boxes by which they are listed, and those
    /// who have come to be; returns instances of these, which are armed.
    pub fn relist(&mut self, agents: &[usize], born: &[usize]) -> Result<Vec<u32>, Failure> {
        if !self.has_fields() {
            return Ok(Vec::new());
        }
        let agents = self.go_other_ways(agents);
        let mut fields = std::mem::take(&mut self.neighbours.fields);
        let mut done = Ok(());
        let mut armed = Vec::new();
        for field in &mut fields {
            done = self.relist_field(field, &agents, born, &mut armed);
            if done.is_err() {
                break;
            }
        }
        self.neighbours.fields = fields;
        done.map(|()| armed)
    }

    /// The same of agents that have come to a kink of their flows at `time`, from which on they may leave their boxes.
    pub fn relist_turned(&mut self, agents: &[usize], time: f64) -> Result<(), Failure> {
        if !self.has_fields() {
            return Ok(());
        }
        let present = self.present.time;
        self.present.go(time);
        let done = self.relist(agents, &[]);
        self.present.go(present);
        done.map(|_| ())
    }

    fn relist_field(
        &mut self,
        field: &mut Field,
        agents: &[usize],
        born: &[usize],
        armed: &mut Vec<u32>,
    ) -> Result<(), Failure> {
        if field.seats != field.seats_of(&self.agents) {
            let mut new = Vec::new();
            self.list_field(field, Far::Keep, &mut new)?;
            return new.into_iter().try_for_each(|new| self.introduce(new, born, armed));
        }
        let mut moved = Vec::new();
        for side in field.sides() {
            let by_link = if side == 0 { self.owners_led_to(field, agents) } else { Vec::new() };
            for &agent in agents.iter().chain(&by_link) {
                moved.extend(self.box_anew(field, agent, side));
            }
        }
        moved.append(&mut field.scopes.changed);
        let mut wanted = self.pairs_around(field, &moved);
        let selves =
            born.iter().filter(|&&agent| field.with_self && self.agents.agents[agent].ty == field.types[0]);
        wanted.extend(selves.map(|&agent| [agent as u32; 2]));
        self.enter_new(field, wanted, born, armed)
    }

    /// The pairs for which the boxes of these numbers stand, with those that they overlap.
    pub fn pairs_around(&self, field: &Field, numbers: &[u32]) -> Vec<[u32; 2]> {
        let mut pairs = Vec::new();
        for &number in numbers {
            for other in field.grid.around(number) {
                pairs.extend(field.pairs(&self.agents, number.min(other), number.max(other)));
            }
        }
        pairs
    }

    /// Lists those of some pairs that are not listed yet.
    pub fn enter_new(
        &mut self,
        field: &mut Field,
        pairs: Vec<[u32; 2]>,
        born: &[usize],
        armed: &mut Vec<u32>,
    ) -> Result<(), Failure> {
        for agents in pairs {
            if !self.has_pair(field, agents) {
                let new = self.enter(field, agents)?;
                self.introduce(new, born, armed)?;
            }
        }
        Ok(())
    }

    /// Gives an agent a box anew; its number, if the agent may leave the one that it had.
    fn box_anew(&mut self, field: &mut Field, agent: usize, side: usize) -> Option<u32> {
        let number = field.number(&self.agents, agent, side)?;
        let bounds = self.reach(field, agent, side);
        let known = field.grid.get(number);
        let stays = known.iter().zip(&bounds).all(|(known, &new)| known.encloses(new));
        (!stays).then(|| {
            field.grid.change(number, &bounds);
            number
        })
    }

    /// Arms an instance of a pair that is new in a list, because one of the two is new, or because they have come near; or
    /// settles the comparisons with a new candidate.
    fn introduce(&mut self, new: New, born: &[usize], armed: &mut Vec<u32>) -> Result<(), Failure> {
        let New { instance, candidate } = new;
        if let Some(nominee) = candidate {
            let rule = if born.contains(&nominee.agent) { Rule::Fresh } else { Rule::Rates };
            self.settle_candidate(instance, nominee, rule);
            return Ok(());
        }
        let roots = self.guards.roots(instance);
        if !roots.iter().any(|root| born.contains(root)) {
            self.meet(instance);
            return Ok(());
        }
        armed.push(instance);
        self.arm(instance, Rule::Fresh)
    }

    fn has_pair(&self, field: &Field, [first, second]: [u32; 2]) -> bool {
        if let Some(number) = field.quantifier {
            let instance = self.guards.instance_of(field.definition, first as usize);
            return instance.is_some_and(|instance| {
                self.guards.candidate(&self.agents, instance, number, second as usize).is_some()
            });
        }
        self.guards.of_agent[first as usize].iter().any(|&instance| {
            let state = &self.guards.instances[instance as usize];
            state.definition as usize == field.definition && state.roots == [first, second]
        })
    }

    /// Arms an instance of a pair that has just come near: its condition has been false until now.
    fn meet(&mut self, instance: u32) {
        self.arm_again(instance);
        for index in self.guards.atoms_of(instance) {
            if !self.settle_far(index) {
                self.settle(index, Rule::Rates, &Written::default());
            }
        }
    }

    fn settle_candidate(&mut self, instance: u32, nominee: Nominee, rule: Rule) {
        // A guard that is not active is settled when it is armed.
        if !self.guards.instances[instance as usize].active {
            return;
        }
        for index in nominee.atoms {
            if !self.guards.atoms[index].left_out && !self.settle_far(index) {
                self.settle(index, rule, &Written::default());
            }
        }
    }

    /// Arms an instance of a pair that may come near from now on, and is not yet: its condition is false. Likewise the
    /// comparisons with a candidate.
    pub fn await_pair(&mut self, new: New) {
        let New { instance, candidate } = new;
        let time = self.present.time;
        match candidate {
            Some(nominee) if self.guards.definition(instance).nearby[nominee.number].beyond.is_none() => {
                self.settle_candidate(instance, nominee, Rule::Rates);
            }
            Some(nominee) if self.guards.instances[instance as usize].active => {
                nominee.atoms.for_each(|index| self.recertify(index, time));
            }
            Some(_) => {}
            None if self.guards.definition(instance).comparisons.len() != 1 => self.meet(instance),
            None => {
                self.arm_again(instance);
                for index in self.guards.atoms_of(instance) {
                    self.recertify(index, time);
                }
            }
        }
    }

    fn arm_again(&mut self, instance: u32) {
        let time = self.present.time;
        let state = &mut self.guards.instances[instance as usize];
        (state.active, state.armed, state.entry) = (true, true, time);
    }
}
