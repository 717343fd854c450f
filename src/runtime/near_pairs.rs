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
use crate::runtime::neighbours::{Field, Listed};

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
            let grid = Grid::default();
            let (symmetric, listed) = (pair.symmetric, Vec::new());
            fields.push(Field { definition: number, types, alike, symmetric, grid, listed });
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
        done.map(|()| new)
    }

    fn list_field(&mut self, field: &mut Field, until: f64, new: &mut Vec<u32>) -> Result<(), Failure> {
        let near = self.guards.definitions[field.definition].near;
        let mut boxes = Vec::new();
        for side in field.sides() {
            for rank in 0..self.agents.of_type[field.types[side]].len() {
                let agent = self.agents.of_type[field.types[side]][rank];
                boxes.extend(self.reach(agent, near, side, until));
            }
        }
        field.grid = Grid::new(near.len(), boxes);
        let mut wanted: Vec<[u32; 2]> = Vec::new();
        field.grid.for_each_pair(&mut |a, b| wanted.extend(field.pairs(&self.agents.of_type, a, b)));
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
            self.guards.unlist(old.instance);
        } else {
            listed.push(old);
        }
    }

    fn new_pair(&mut self, definition: usize, agents: [u32; 2]) -> Result<u32, Failure> {
        let limit = self.limits.guards_max;
        if self.guards.instances.len() >= limit {
            let needed = self.guards.instances.len() as u128 + 1;
            return Err(Reason::GuardLimit { needed, limit }.into());
        }
        let instance = self.guards.list(definition, agents);
        self.repetitions.forget(instance);
        Ok(instance)
    }

    /// Where an agent can get to up to `until`, in the states that are compared of it, with half of the range around.
    fn reach(&mut self, agent: usize, near: &[Near], side: usize, until: f64) -> SmallVec<[Interval; 4]> {
        let mut states = SmallVec::new();
        let now = self.present.time;
        let (agents, groups) = (&self.agents, &self.groups.groups);
        self.reaches.states(agents, groups, &mut self.enclosures, agent, (now, now, until), &mut states);
        let around = |near: &Near| {
            let bound = states[if side == 0 { near.own } else { near.other }];
            let half = 0.5 * near.within * (1.0 + 1e-12);
            Interval { lo: bound.lo - half, hi: bound.hi + half }
        };
        near.iter().map(around).collect()
    }

    /// Lists anew, at the present instant, those of some agents that may leave the boxes by which they are listed.
    pub fn relist(&mut self, agents: &[usize]) -> Result<(), Failure> {
        let mut fields = std::mem::take(&mut self.neighbours.fields);
        let mut done = Ok(());
        for field in &mut fields {
            done = self.relist_field(field, agents);
            if done.is_err() {
                break;
            }
        }
        self.neighbours.fields = fields;
        done
    }

    fn relist_field(&mut self, field: &mut Field, agents: &[usize]) -> Result<(), Failure> {
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
                let pairs = field.pairs(&self.agents.of_type, number.min(other), number.max(other));
                for agents in pairs {
                    if self.has_pair(field.definition, agents) {
                        continue;
                    }
                    let instance = self.new_pair(field.definition, agents)?;
                    field.listed.push(Listed { agents, instance });
                    self.meet(instance);
                }
            }
        }
        if !moved.is_empty() {
            field.listed.sort_unstable();
        }
        Ok(())
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
