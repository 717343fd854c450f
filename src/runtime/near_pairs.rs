//! Listing of near pairs: which instances an interaction needs for the time to come.
//!
//! A pair that is not listed cannot make its condition true: its flag is armed, and nothing else is remembered of it. An
//! agent that is written, or whose flow changes, so that it may leave its box, is listed anew at once (rule 14).

use smallvec::SmallVec;

use crate::codegen::program::Near;
use crate::math::Interval;
use crate::runtime::act::Written;
use crate::runtime::arm::Rule;
use crate::runtime::engine::Engine;
use crate::runtime::failure::{Failure, Reason};
use crate::runtime::grid::Grid;
use crate::runtime::guards::Origin;
use crate::runtime::neighbours::{Field, Listed, NOWHERE};
use crate::runtime::population::ABSENT;

impl Engine<'_, '_> {
    /// Makes the fields of the interactions that have a range; nothing is listed yet.
    pub fn make_fields(&mut self) {
        let mut fields = Vec::new();
        for (number, definition) in self.guards.definitions.iter().enumerate() {
            let Origin::Pair(pair) = definition.origin else { continue };
            if definition.near.is_empty() {
                continue;
            }
            let types = [definition.ty, definition.frame.slots[1].ty()];
            let alike = types[0] == types[1] && definition.near.iter().all(|near| near.own == near.other);
            let (symmetric, seats, grid, listed) = (pair.symmetric, [0; 2], Grid::default(), Vec::new());
            fields.push(Field { definition: number, types, alike, symmetric, seats, grid, listed });
        }
        self.neighbours.fields = fields;
    }

    /// Whether there are interactions that have a range.
    pub fn has_fields(&self) -> bool {
        !self.neighbours.fields.is_empty()
    }

    /// Lists the pairs that can come within range from the present instant up to `until`; returns the new instances.
    pub fn list_pairs(&mut self, until: f64) -> Result<Vec<u32>, Failure> {
        let mut fields = std::mem::take(&mut self.neighbours.fields);
        let mut new = Vec::new();
        let mut done = Ok(());
        for field in &mut fields {
            done = self.list_field(field, until, &mut new);
            if done.is_err() {
                break;
            }
        }
        (self.neighbours.until, self.neighbours.fields) = (until, fields);
        self.guards.free_retired();
        done.map(|()| new)
    }

    fn list_field(&mut self, field: &mut Field, until: f64, new: &mut Vec<u32>) -> Result<(), Failure> {
        let near = self.guards.definitions[field.definition].near;
        let mut boxes = Vec::new();
        field.seats = field.seats_of(&self.agents);
        for side in field.sides() {
            for seat in 0..field.seats[side] {
                match self.agents.seats[field.types[side]][seat] {
                    ABSENT => boxes.extend(near.iter().map(|_| NOWHERE)),
                    agent => boxes.extend(self.reach(agent, near, side, until)),
                }
            }
        }
        field.grid = Grid::new(near.len(), boxes);
        let mut wanted: Vec<[u32; 2]> = Vec::new();
        field.grid.for_each_pair(&mut |a, b| wanted.extend(field.pairs(&self.agents, a, b)));
        wanted.sort_unstable();
        let before = std::mem::take(&mut field.listed);
        let mut before = before.into_iter().peekable();
        for agents in wanted {
            while let Some(old) = before.next_if(|old| old.agents < agents) {
                self.let_go(old, &mut field.listed);
            }
            match before.next_if(|old| old.agents == agents) {
                Some(old) => field.listed.push(old),
                None => {
                    let instance = self.new_pair(field.definition, agents)?;
                    field.listed.push(Listed { agents, instance });
                    new.push(instance);
                }
            }
        }
        for old in before {
            self.let_go(old, &mut field.listed);
        }
        field.listed.sort_unstable();
        Ok(())
    }

    /// Forgets a pair that is not near any more, but for one whose guard has not been found false since it fired.
    fn let_go(&mut self, old: Listed, listed: &mut Vec<Listed>) {
        if self.guards.instances[old.instance as usize].armed {
            self.guards.retire(old.instance);
        } else {
            listed.push(old);
        }
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

    /// Where an agent can get to up to `until`, in the states that are compared of it, with half of the range around.
    fn reach(&mut self, agent: usize, near: &[Near], side: usize, until: f64) -> SmallVec<[Interval; 4]> {
        let mut states = SmallVec::new();
        let span = (self.present.time, until);
        let (agents, groups) = (&self.agents, &self.groups.groups);
        self.reaches.states(agents, groups, &mut self.enclosures, agent, span, &mut states);
        let around = |near: &Near| {
            let bound = states[if side == 0 { near.own } else { near.other }];
            let half = 0.5 * near.within * (1.0 + 1e-12);
            Interval { lo: bound.lo - half, hi: bound.hi + half }
        };
        near.iter().map(around).collect()
    }

    /// Lists anew, at the present instant, those of some agents that may leave the boxes by which they are listed, and those
    /// who have come to be; returns instances of these, which are armed.
    pub fn relist(&mut self, agents: &[usize], born: &[usize]) -> Result<Vec<u32>, Failure> {
        let mut fields = std::mem::take(&mut self.neighbours.fields);
        let mut done = Ok(());
        let mut armed = Vec::new();
        for field in &mut fields {
            done = self.relist_field(field, agents, born, &mut armed);
            if done.is_err() {
                break;
            }
        }
        self.neighbours.fields = fields;
        done.map(|()| armed)
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
            self.list_field(field, self.neighbours.until, &mut new)?;
            return new.into_iter().try_for_each(|instance| self.introduce(instance, born, armed));
        }
        let near = self.guards.definitions[field.definition].near;
        let mut moved = Vec::new();
        for &agent in agents {
            for side in field.sides() {
                let Some(number) = field.number(&self.agents, agent, side) else { continue };
                let bounds = self.reach(agent, near, side, self.neighbours.until);
                let known = field.grid.get(number);
                if bounds.iter().zip(known).any(|(new, old)| new.lo < old.lo || old.hi < new.hi) {
                    field.grid.change(number, &bounds);
                    moved.push(number);
                }
            }
        }
        for &number in &moved {
            for other in field.grid.around(number) {
                let pairs = field.pairs(&self.agents, number.min(other), number.max(other));
                for agents in pairs {
                    if self.has_pair(field.definition, agents) {
                        continue;
                    }
                    let instance = self.new_pair(field.definition, agents)?;
                    field.listed.push(Listed { agents, instance });
                    self.introduce(instance, born, armed)?;
                }
            }
        }
        if !moved.is_empty() {
            field.listed.sort_unstable();
        }
        Ok(())
    }

    /// Arms an instance of a pair that is new in a list: because one of the two is new, or because they have come near.
    fn introduce(&mut self, instance: u32, born: &[usize], armed: &mut Vec<u32>) -> Result<(), Failure> {
        let roots = self.guards.roots(instance);
        if !roots.iter().any(|root| born.contains(root)) {
            self.meet(instance);
            return Ok(());
        }
        armed.push(instance);
        self.arm(instance, Rule::Fresh)
    }

    fn has_pair(&self, definition: usize, agents: [u32; 2]) -> bool {
        self.guards.of_agent[agents[0] as usize].iter().any(|&instance| {
            let state = &self.guards.instances[instance as usize];
            state.definition as usize == definition && state.roots == agents
        })
    }

    /// Arms an instance of a pair that has just come near: its condition has been false until now.
    pub fn meet(&mut self, instance: u32) {
        self.arm_again(instance);
        for index in self.guards.atom_range(instance) {
            if !self.settle_far(index) {
                self.settle(index, Rule::Rates, &Written::default());
            }
        }
    }

    /// The same of one that may come near from now on, and is not yet: its condition is false.
    pub fn await_pair(&mut self, instance: u32) {
        if self.guards.definition(instance).comparisons.len() != 1 {
            return self.meet(instance);
        }
        self.arm_again(instance);
        let time = self.present.time;
        for index in self.guards.atom_range(instance) {
            self.recertify(index, time);
        }
    }

    fn arm_again(&mut self, instance: u32) {
        let time = self.present.time;
        let state = &mut self.guards.instances[instance as usize];
        (state.active, state.armed, state.entry) = (true, true, time);
    }
}
