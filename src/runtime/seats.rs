//! Seats of those who come and go: which comparisons below quantifiers are theirs, and room for more.

use crate::runtime::atom_state::AtomState;
use crate::runtime::definition::AtomShape;
use crate::runtime::engine::Queues;
use crate::runtime::guards::Guards;
use crate::runtime::population::Agents;

impl Guards<'_> {
    /// The atom instances of an instance that are bound to the seat of an agent.
    pub fn atoms_at(&self, agents: &Agents<'_>, instance: u32, agent: usize) -> Vec<usize> {
        if !self.definition(instance).nearby.is_empty() {
            return self.atoms_of_candidate(agents, instance, agent);
        }
        let first = self.instances[instance as usize].atoms as usize;
        at_seat(agents, &self.definition(instance).atoms, agent).into_iter().map(|k| first + k).collect()
    }

    /// Forgets what is known of the comparisons that are bound to the seat of an agent who has come or gone.
    pub fn reseat(&mut self, agents: &Agents<'_>, agent: usize) {
        for instance in self.over_type[agents.agents[agent].ty].clone() {
            for index in self.atoms_at(agents, instance, agent) {
                let version = self.atoms[index].version + 1;
                self.atoms[index] = AtomState { version, ..AtomState::new(instance) };
                self.atoms[index].left_out = self.leaves_out(agents, index);
            }
            let first = self.instances[instance as usize].rising as usize;
            for k in at_seat(agents, &self.definition(instance).rising, agent) {
                self.rising[first + k] = false;
            }
        }
    }

    /// How many atom instances there are when there is room for all seats.
    pub fn size(&self, agents: &Agents<'_>) -> usize {
        let seats = |shape: &AtomShape| shape.n_seats(|ty| agents.seats[ty].len());
        let sizes: Vec<usize> =
            self.definitions.iter().map(|definition| definition.atoms.iter().map(seats).sum()).collect();
        let own = |number: u32| {
            let candidates: usize = self.candidate_ranges(number).map(|range| range.len()).sum();
            sizes[self.instances[number as usize].definition as usize] + candidates
        };
        (0..self.instances.len() as u32).map(own).sum()
    }

    /// Makes room for seats that have been added behind the `before` ones that a type had.
    pub fn make_room(&mut self, agents: &Agents<'_>, ty: usize, before: usize, queues: &mut Queues) {
        let old: Vec<(Vec<AtomShape>, Vec<AtomShape>)> = self
            .definitions
            .iter()
            .map(|definition| (definition.atoms.clone(), definition.rising.clone()))
            .collect();
        if !self.definitions.iter().any(|definition| definition.binds_all(ty)) {
            return;
        }
        let old_sizes: Vec<usize> = self.definitions.iter().map(|definition| definition.n_atoms).collect();
        self.definitions.iter_mut().for_each(|definition| definition.lay_out(agents));
        let mut moved = vec![u32::MAX; self.atoms.len()];
        let (old_atoms, old_rising) = (std::mem::take(&mut self.atoms), std::mem::take(&mut self.rising));
        for (number, instance) in self.instances.iter_mut().enumerate() {
            let definition = &self.definitions[instance.definition as usize];
            let (atoms, rising) = &old[instance.definition as usize];
            let (first, new) = (instance.atoms as usize, self.atoms.len());
            self.atoms.resize(new + definition.n_atoms, AtomState::unread(number as u32));
            for k in 0..old_sizes[instance.definition as usize] {
                let to = new + relocated(agents, (atoms, &definition.atoms), k, (ty, before));
                self.atoms[to] = old_atoms[first + k];
                moved[first + k] = to as u32;
            }
            instance.atoms = new as u32;
            let (first, new) = (instance.rising as usize, self.rising.len());
            self.rising.resize(new + definition.n_rising, false);
            for k in 0..size(agents, rising, (ty, before)) {
                let to = new + relocated(agents, (rising, &definition.rising), k, (ty, before));
                self.rising[to] = old_rising[first + k];
            }
            instance.rising = new as u32;
            for (number, nearby) in definition.nearby.iter().enumerate() {
                let list = instance.lists as usize + number;
                self.candidates.relocate(list, &mut |first| {
                    let (first, to) = (first as usize, self.atoms.len() as u32);
                    for k in 0..nearby.atoms.len() {
                        moved[first + k] = to + k as u32;
                        self.atoms.push(old_atoms[first + k]);
                    }
                    to
                });
            }
        }
        self.roused.iter_mut().for_each(|index| *index = moved[*index as usize]);
        self.roused.retain(|&index| index != u32::MAX);
        self.zeros.forget();
        queues.renumber_atoms(&moved);
    }
}

/// The offsets of what is bound to the seat of an agent.
fn at_seat(agents: &Agents<'_>, shapes: &[AtomShape], agent: usize) -> Vec<usize> {
    let (ty, seat) = (agents.agents[agent].ty, agents.agents[agent].seat);
    let mut found = Vec::new();
    for shape in shapes {
        let places = shape.binders.iter().map(|binder| (binder.ty, agents.seats[binder.ty].len()));
        let places: Vec<(usize, usize)> = places.collect();
        match places[..] {
            [] => {}
            [(only, _)] if only == ty => found.push(shape.first + seat),
            [_] => {}
            _ => {
                let n: usize = places.iter().map(|place| place.1).product();
                for k in 0..n {
                    let mut rest = k;
                    let sits = places.iter().rev().any(|&(other, n)| {
                        let here = rest % n;
                        rest /= n;
                        other == ty && here == seat
                    });
                    if sits {
                        found.push(shape.first + k);
                    }
                }
            }
        }
    }
    found
}

/// How many places some shapes took when a type had `before` seats.
fn size(agents: &Agents<'_>, shapes: &[AtomShape], (ty, before): (usize, usize)) -> usize {
    let seats = |other: usize| if other == ty { before } else { agents.seats[other].len() };
    shapes.iter().map(|shape| shape.n_seats(seats)).sum()
}

/// Where offset `k` lies now that a type has more than `before` seats.
fn relocated(
    agents: &Agents<'_>,
    (old, new): (&[AtomShape], &[AtomShape]),
    k: usize,
    (ty, before): (usize, usize),
) -> usize {
    // Of shapes that take no place the last begins where the next does.
    let shape = old.partition_point(|shape| shape.first <= k) - 1;
    let mut rest = k - old[shape].first;
    let (mut place, mut stride) = (new[shape].first, 1);
    for binder in old[shape].binders.iter().rev() {
        let now = agents.seats[binder.ty].len();
        let n = if binder.ty == ty { before } else { now };
        place += stride * (rest % n);
        rest /= n;
        stride *= now;
    }
    place
}
