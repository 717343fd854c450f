//! Candidates come and go: the comparisons that are bound to them (see [`crate::runtime::candidates`]).

use std::ops::Range;

use crate::runtime::atom_state::AtomState;
use crate::runtime::candidates::Candidate;
use crate::runtime::guards::{Guards, Origin};
use crate::runtime::population::Agents;

impl Guards<'_> {
    fn list_of(&self, instance: u32, number: usize) -> usize {
        self.instances[instance as usize].lists as usize + number
    }

    /// The candidates of the quantifier of an instance that binds `slot`, in the order of their numbers; none if it looks at
    /// everybody.
    pub fn candidates_at(&self, instance: u32, slot: usize) -> Option<&[Candidate]> {
        let nearby = &self.definition(instance).nearby;
        let number = nearby.iter().position(|nearby| nearby.range.slot == slot)?;
        Some(self.candidates.list(self.list_of(instance, number)))
    }

    /// The first atom instance that is bound to an agent as a candidate of a quantifier; none if it is not one.
    pub fn candidate(
        &self,
        agents: &Agents<'_>,
        instance: u32,
        number: usize,
        agent: usize,
    ) -> Option<usize> {
        let found = self.candidates.find(self.list_of(instance, number), agents.number(agent) as u64)?;
        Some(found.first as usize)
    }

    /// The atom instances of an instance that are bound to candidates.
    pub fn candidate_ranges(&self, instance: u32) -> impl Iterator<Item = Range<usize>> {
        self.definition(instance).nearby.iter().enumerate().flat_map(move |(number, nearby)| {
            let list = self.candidates.list(self.list_of(instance, number));
            list.iter().map(|candidate| {
                let first = candidate.first as usize;
                first..first + nearby.atoms.len()
            })
        })
    }

    /// Those that are bound to one agent.
    pub fn atoms_of_candidate(&self, agents: &Agents<'_>, instance: u32, agent: usize) -> Vec<usize> {
        let mut found = Vec::new();
        for (number, nearby) in self.definition(instance).nearby.iter().enumerate() {
            if let Some(first) = self.candidate(agents, instance, number, agent) {
                found.extend(first..first + nearby.atoms.len());
            }
        }
        found
    }

    /// How many atom instances a new candidate of a quantifier may need room for.
    pub fn n_for_candidate(&self, instance: u32, number: usize) -> usize {
        self.definition(instance).nearby[number].atoms.len()
    }

    /// Makes an agent a candidate of a quantifier; nothing is known yet of its comparisons but what [`Nearby::beyond`] says.
    /// Returns its atom instances.
    ///
    /// [`Nearby::beyond`]: crate::runtime::definition::Nearby::beyond
    pub fn nominate(
        &mut self,
        agents: &Agents<'_>,
        instance: u32,
        number: usize,
        agent: usize,
    ) -> Range<usize> {
        let nearby = &self.definition(instance).nearby[number];
        let (n, truth, atoms) = (nearby.atoms.len(), nearby.beyond.unwrap_or(false), nearby.atoms.clone());
        let first = self.candidates.reuse(n).map_or(self.atoms.len(), |first| first as usize);
        if first == self.atoms.len() {
            self.atoms.resize(first + n, AtomState::new(instance));
        }
        for (index, atom) in (first..first + n).zip(atoms) {
            let (version, candidate) = (self.atoms[index].version + 1, Some((atom as u32, agent as u32)));
            self.atoms[index] = AtomState { version, candidate, truth, ..AtomState::new(instance) };
        }
        let candidate =
            Candidate { number: agents.number(agent) as u64, agent: agent as u32, first: first as u32 };
        self.candidates.enter(self.list_of(instance, number), instance, candidate);
        if let Origin::Link(_) = self.definition(instance).origin {
            for index in first..first + n {
                self.atoms[index].left_out = self.leaves_out(agents, index);
            }
        }
        self.n_pairs += n as u64;
        first..first + n
    }

    /// An agent is a candidate of a quantifier no more.
    pub fn dismiss(&mut self, agents: &Agents<'_>, instance: u32, number: usize, agent: usize) {
        self.strike(instance, number, agents.number(agent) as u64);
    }

    /// An instance has no candidates any more.
    pub fn dismiss_all(&mut self, instance: u32) {
        for number in 0..self.definition(instance).nearby.len() {
            for candidate in self.candidates.list(self.list_of(instance, number)).to_vec() {
                self.strike(instance, number, candidate.number);
            }
        }
    }

    /// An agent is nobody's candidate any more. Returns the instances of which it was one.
    pub fn dismiss_everywhere(&mut self, agents: &Agents<'_>, agent: usize) -> Vec<u32> {
        let looking = self.candidates.looking_at(agent).to_vec();
        for &instance in &looking {
            for number in 0..self.definition(instance).nearby.len() {
                self.dismiss(agents, instance, number, agent);
            }
        }
        looking
    }

    /// Takes whoever has this number, if anybody, from a list; whatever is in a queue for its comparisons is void.
    fn strike(&mut self, instance: u32, number: usize, name: u64) {
        let (list, n) = (self.list_of(instance, number), self.n_for_candidate(instance, number));
        let Some(candidate) = self.candidates.strike(list, instance, name, n) else { return };
        for state in &mut self.atoms[candidate.first as usize..][..n] {
            state.version += 1;
            state.left_out = true;
        }
    }
}
