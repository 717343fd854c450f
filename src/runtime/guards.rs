//! Guard instances: each transition and each claim for each agent or pair that it can bind, with flags and atoms.
//!
//! An *instance* is a definition with its agents; an *atom instance* is a comparison of an instance with, below
//! quantifiers, one binding. Atom instances lie in one list: those of an instance
//! together, and of each atom in the order of the agents its quantifiers bind.

use smallvec::SmallVec;

use crate::codegen::program::{Atom, ClaimKind, ClaimSystem, Near, Quantified, Range, Trigger};
use crate::runtime::atom_state::AtomState;
use crate::runtime::candidates::Candidates;
use crate::runtime::definition::{AtomShape, Definition, definitions};
pub use crate::runtime::definition::{Listing, Origin};
use crate::runtime::noticed::Noticed;
use crate::runtime::population::{ABSENT, Agents, Slots};
use crate::runtime::zeros::Zeros;

/// Numbers of atom instances.
pub type AtomNumbers = std::iter::Flatten<smallvec::IntoIter<[std::ops::Range<usize>; 1]>>;

/// An instance of a definition.
#[derive(Clone, Debug)]
pub struct Instance {
    /// Its definition.
    pub definition: u32,
    /// Its agents; the second only for interactions.
    pub roots: [u32; 2],
    /// Its first atom instance.
    pub atoms: u32,
    /// Its first `rising` flag.
    pub rising: u32,
    /// Its first list of candidates.
    pub lists: u32,
    /// Whether it has agents.
    pub listed: bool,
    /// Whether the mode it belongs to is active.
    pub active: bool,
    /// Rule 2.
    pub armed: bool,
    /// `after`: the delay is over.
    pub aged: bool,
    /// Changes with every arming, so that schedules of an earlier one are void.
    pub arming: u32,
    /// When it was armed, s.
    pub entry: f64,
    /// Delay or period, read at arming, s.
    pub delay: f64,
    /// `every`: how many periods have passed.
    pub periods: u64,
}

/// All guards of a run.
pub struct Guards<'p> {
    /// By number.
    pub definitions: Vec<Definition<'p>>,
    /// By number.
    pub instances: Vec<Instance>,
    /// By number.
    pub atoms: Vec<AtomState>,
    /// The atoms that may be `touched` or `rooted`, some more than once.
    pub roused: Vec<u32>,
    /// What is on its boundary at the instant at hand.
    pub zeros: Zeros,
    /// What is read of agents besides states and modes.
    pub noticed: Noticed,
    /// `rising`: whether its condition has been false since arming.
    pub rising: Vec<bool>,
    /// For each agent, the instances of which it is a root.
    pub of_agent: Vec<Vec<u32>>,
    /// For each agent, its instances that wait for messages.
    pub hearing: Vec<Vec<u32>>,
    /// For each type, the instances with a quantifier that may read any agent of it; not those that look at candidates only.
    pub over_type: Vec<Vec<u32>>,
    /// Whom quantifiers look at that have a range.
    pub candidates: Candidates,
    /// How many instances range over more than one agent (pairs, and bindings of quantifiers), those listed anew included.
    pub n_pairs: u64,
    /// For each definition, instances that nobody has any more, to be used again.
    free: Vec<Vec<u32>>,
    /// Those that had an agent that died in the instant at hand.
    retired: Vec<u32>,
    /// Types over which some of these range.
    thinned: Vec<usize>,
}

/// More instances than the limit allows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TooManyGuards {
    /// How many there would be.
    pub needed: u128,
}

impl<'p> Guards<'p> {
    /// All instances, none of them active; of interactions whose pairs are listed when they are near, none yet.
    pub fn new(agents: &Agents<'p>, listing: Listing, guards_max: usize) -> Result<Self, TooManyGuards> {
        let definitions = definitions(agents, listing);
        let whole = || definitions.iter().filter(|definition| definition.near.is_empty());
        let needed = whole().map(|definition| definition.size(agents)).sum();
        if needed > guards_max as u128 {
            return Err(TooManyGuards { needed });
        }
        let mut guards = Self {
            definitions: Vec::new(),
            instances: Vec::new(),
            atoms: Vec::new(),
            rising: Vec::new(),
            roused: Vec::new(),
            zeros: Zeros::default(),
            noticed: Noticed::new(agents, &definitions),
            of_agent: vec![Vec::new(); agents.len()],
            hearing: vec![Vec::new(); agents.len()],
            over_type: vec![Vec::new(); agents.of_type.len()],
            candidates: Candidates::new(agents.len()),
            n_pairs: 0,
            free: vec![Vec::new(); definitions.len()],
            retired: Vec::new(),
            thinned: Vec::new(),
        };
        let (n_instances, n_atoms) = whole().fold((0, 0), |(instances, atoms), definition| {
            let n = definition.n_instances(agents);
            (instances + n as usize, atoms + n as usize * definition.n_atoms)
        });
        // Room for the pairs that will be near: one for each agent, to begin with.
        let near = definitions.iter().filter(|definition| !definition.near.is_empty());
        let (n_near, n_near_atoms) = near.fold((0, 0), |(instances, atoms), definition| {
            (instances + agents.len(), atoms + agents.len() * definition.n_atoms)
        });
        guards.instances.reserve_exact(n_instances + n_near);
        guards.atoms.reserve_exact(n_atoms + n_near_atoms);
        for (number, definition) in definitions.iter().enumerate() {
            if definition.near.is_empty() {
                for_each_binding(agents, definition, &mut |roots| {
                    guards.add(number, definition, roots);
                });
            }
        }
        guards.definitions = definitions;
        for index in 0..guards.atoms.len() {
            guards.atoms[index].left_out = guards.leaves_out(agents, index);
        }
        Ok(guards)
    }

    fn add(&mut self, number: usize, definition: &Definition<'p>, roots: [u32; 2]) -> u32 {
        let instance = self.instances.len() as u32;
        self.instances.push(Instance {
            definition: number as u32,
            roots,
            atoms: self.atoms.len() as u32,
            rising: self.rising.len() as u32,
            lists: self.candidates.add_lists(definition.nearby.len()),
            listed: true,
            active: false,
            armed: false,
            aged: false,
            arming: 0,
            entry: 0.0,
            delay: 0.0,
            periods: 0,
        });
        self.atoms.resize(self.atoms.len() + definition.n_atoms, AtomState::new(instance));
        self.rising.resize(self.rising.len() + definition.n_rising, false);
        self.of_agent[roots[0] as usize].push(instance);
        if let Some(Trigger::On { .. }) = definition.trigger() {
            self.hearing[roots[0] as usize].push(instance);
        }
        if matches!(definition.origin, Origin::Pair(_)) {
            self.of_agent[roots[1] as usize].push(instance);
            self.n_pairs += 1;
        } else if !definition.quantified.is_empty() {
            self.n_pairs += definition.n_atoms as u64;
        }
        for &ty in definition.looked_over() {
            self.over_type[ty].push(instance);
        }
        instance
    }

    /// An instance, not active, for agents that have come to be, or near.
    pub fn list(&mut self, agents: &Agents<'_>, number: usize, roots: [u32; 2]) -> u32 {
        let Some(instance) = self.free[number].pop() else {
            let definitions = std::mem::take(&mut self.definitions);
            let instance = self.add(number, &definitions[number], roots);
            self.definitions = definitions;
            self.leave_out(agents, instance);
            return instance;
        };
        (self.instances[instance as usize].roots, self.instances[instance as usize].listed) = (roots, true);
        for root in self.roots(instance) {
            self.of_agent[root].push(instance);
        }
        if let Some(Trigger::On { .. }) = self.definition(instance).trigger() {
            self.hearing[roots[0] as usize].push(instance);
        }
        self.n_pairs += 1;
        for index in self.atoms_of(instance) {
            let state = &mut self.atoms[index];
            *state = AtomState { version: state.version, ..AtomState::new(instance) };
        }
        for &ty in self.definitions[number].looked_over() {
            self.over_type[ty].push(instance);
        }
        self.leave_out(agents, instance);
        instance
    }

    /// Takes an instance from its agents; whatever is in a queue for it is void. It is not used again before
    /// [`Guards::free_retired`]: the instant at hand may still refer to it. It is among those that range over a type before
    /// [`Guards::thin`].
    pub fn retire(&mut self, instance: u32) {
        let state = &mut self.instances[instance as usize];
        state.active = false;
        state.armed = false;
        state.listed = false;
        state.arming += 1;
        for index in self.atoms_of(instance) {
            self.atoms[index].version += 1;
        }
        for root in self.roots(instance) {
            self.of_agent[root].retain(|&other| other != instance);
            self.hearing[root].retain(|&other| other != instance);
        }
        let number = self.instances[instance as usize].definition as usize;
        self.thinned.extend_from_slice(self.definitions[number].looked_over());
        self.dismiss_all(instance);
        self.retired.push(instance);
    }

    /// Retires all instances of an agent that dies.
    pub fn retire_all(&mut self, agent: usize) {
        self.hearing[agent] = Vec::new();
        for instance in std::mem::take(&mut self.of_agent[agent]) {
            self.retire(instance);
        }
    }

    /// Takes instances that have been retired from among those that range over a type.
    pub fn thin(&mut self) {
        self.thinned.sort_unstable();
        self.thinned.dedup();
        for ty in std::mem::take(&mut self.thinned) {
            self.over_type[ty].retain(|&instance| self.instances[instance as usize].listed);
        }
    }

    /// Nothing refers any more to the instances that have been retired.
    pub fn free_retired(&mut self) {
        self.candidates.free_retired();
        for instance in std::mem::take(&mut self.retired) {
            self.free[self.instances[instance as usize].definition as usize].push(instance);
        }
    }

    /// Forgets of the atoms of some instances, rising, what was so at the instant only.
    pub fn calm(&mut self, instances: &[u32]) {
        let Self { atoms, roused, .. } = self;
        roused.retain(|&index| {
            let state = &mut atoms[index as usize];
            if instances.binary_search(&state.instance).is_ok() {
                (state.touched, state.rooted) = (false, false);
            }
            state.touched || state.rooted
        });
    }

    /// The instances of a link of an agent, in the order of its cases.
    pub fn of_link(&self, agent: usize, link: usize) -> Vec<u32> {
        let is_of_link = |&instance: &u32| matches!(self.definition(instance).origin, Origin::Link(update) if update.link == link);
        let mut found: Vec<u32> = self.of_agent[agent].iter().copied().filter(is_of_link).collect();
        found.sort_unstable_by_key(|&instance| self.instances[instance as usize].definition);
        found
    }

    /// A link of an agent leads to somebody else: finds out which of its atoms nobody reads now. Returns those that somebody
    /// reads who did not before.
    pub fn spare(&mut self, agents: &Agents<'_>, agent: usize, link: usize) -> Vec<usize> {
        let mut read = Vec::new();
        for instance in self.of_link(agent, link) {
            for index in self.atoms_of(instance) {
                let left_out = self.leaves_out(agents, index);
                if left_out != self.atoms[index].left_out {
                    let AtomState { version, candidate, .. } = self.atoms[index];
                    let new = AtomState { candidate, left_out, ..AtomState::new(instance) };
                    self.atoms[index] = AtomState { version: version + 1, ..new };
                    if !left_out {
                        read.push(index);
                    }
                }
            }
        }
        read
    }

    /// The instance of a definition for an agent; of interactions one of several.
    pub fn instance_of(&self, number: usize, agent: usize) -> Option<u32> {
        let instances = self.of_agent[agent].iter().copied();
        instances
            .into_iter()
            .find(|&instance| self.instances[instance as usize].definition as usize == number)
    }

    /// Whether an instance has agents.
    pub fn is_listed(&self, instance: u32) -> bool {
        self.instances[instance as usize].listed
    }

    /// Whether a definition has an instance that nobody has any more.
    pub fn has_free(&self, number: usize) -> bool {
        !self.free[number].is_empty()
    }

    /// Makes room for an agent in a place that nobody has.
    pub fn admit(&mut self, place: usize) {
        if place == self.of_agent.len() {
            self.of_agent.push(Vec::new());
            self.hearing.push(Vec::new());
            self.candidates.admit();
        }
    }

    /// Finds out which atoms of an instance nobody reads.
    fn leave_out(&mut self, agents: &Agents<'_>, instance: u32) {
        if self.definition(instance).quantified.is_empty() {
            return;
        }
        for index in self.atoms_of(instance) {
            self.atoms[index].left_out = self.leaves_out(agents, index);
        }
    }

    /// The definition of an instance.
    pub fn definition(&self, instance: u32) -> &Definition<'p> {
        &self.definitions[self.instances[instance as usize].definition as usize]
    }

    /// The slots of an instance; quantified ones are absent.
    pub fn slots(&self, agents: &Agents<'_>, instance: u32) -> Slots {
        let definition = self.definition(instance);
        let [first, second] = self.instances[instance as usize].roots.map(|agent| agent as usize);
        match definition.origin {
            Origin::Pair(_) => agents.slots(definition.frame, &[first, second]),
            _ => agents.slots(definition.frame, &[first]),
        }
    }

    /// The agents of an instance: one, or two for an interaction.
    pub fn roots(&self, instance: u32) -> SmallVec<[usize; 2]> {
        let roots = self.instances[instance as usize].roots;
        let n = if matches!(self.definition(instance).origin, Origin::Pair(_)) { 2 } else { 1 };
        roots[..n].iter().map(|&agent| agent as usize).collect()
    }

    /// The number of the atom instance of atom `atom` under the bindings in `slots`.
    pub fn atom_index(&self, agents: &Agents<'_>, instance: u32, atom: usize, slots: &Slots) -> usize {
        let shape = &self.definition(instance).atoms[atom];
        match shape.nearby {
            Some((number, place)) => {
                let agent = slots[shape.binders[0].slot];
                let first = self.candidate(agents, instance, number, agent);
                first.expect("who is asked is a candidate") + place
            }
            None => {
                self.instances[instance as usize].atoms as usize + shape.first + place(agents, shape, slots)
            }
        }
    }

    /// The number of a `rising` flag under the bindings in `slots`.
    pub fn rising_index(&self, agents: &Agents<'_>, instance: u32, rising: usize, slots: &Slots) -> usize {
        let shape = &self.definition(instance).rising[rising];
        self.instances[instance as usize].rising as usize + shape.first + place(agents, shape, slots)
    }

    /// The atom and the slots, bindings filled in, of an atom instance.
    pub fn atom_slots(&self, agents: &Agents<'_>, index: usize) -> (&'p Atom, Slots) {
        let instance = self.atoms[index].instance;
        let definition = self.definition(instance);
        let mut slots = self.slots(agents, instance);
        if definition.quantified.is_empty() {
            let atom = index - self.instances[instance as usize].atoms as usize;
            return (definition.comparisons[atom], slots);
        }
        let (atom, bound) = self.bindings(agents, index);
        for &(binder, agent) in &bound {
            slots[binder.slot] = agent;
        }
        if !bound.is_empty() {
            agents.follow_links(definition.frame, &mut slots);
        }
        (definition.comparisons[atom], slots)
    }

    /// The atom of an atom instance, and the agents that the quantifiers around it bind, innermost first.
    pub fn bindings(&self, agents: &Agents<'_>, index: usize) -> (usize, SmallVec<[(Range, usize); 2]>) {
        let AtomState { instance, candidate, .. } = self.atoms[index];
        let shapes = &self.definition(instance).atoms;
        if let Some((atom, agent)) = candidate {
            let bound = (shapes[atom as usize].binders[0], agent as usize);
            return (atom as usize, SmallVec::from_slice(&[bound]));
        }
        let offset = index - self.instances[instance as usize].atoms as usize;
        let atom = shapes.partition_point(|shape| shape.first <= offset) - 1;
        let mut rest = offset - shapes[atom].first;
        let agent = |&binder: &Range| {
            let seats = &agents.seats[binder.ty];
            let agent = seats[rest % seats.len()];
            rest /= seats.len();
            (binder, agent)
        };
        (atom, shapes[atom].binders.iter().rev().map(agent).collect())
    }

    /// The ranges out of which a comparison cannot change, if there are any of states: it is the only one of a pair, and false.
    pub fn far_where_apart(&self, index: usize) -> Option<&'p [Near]> {
        let state = &self.atoms[index];
        let definition = self.definition(state.instance);
        let is_whole = definition.comparisons.len() == 1 && !state.truth;
        let is_of_states = |near: &Near| near.states().is_some();
        (is_whole && definition.near.iter().any(is_of_states)).then_some(definition.near)
    }

    /// Whether nobody reads the truth of an atom instance: `other` leaves out an agent that it binds, nobody has its seat, or a
    /// property reads its margin.
    pub fn leaves_out(&self, agents: &Agents<'_>, index: usize) -> bool {
        let roots = self.roots(self.atoms[index].instance);
        let (_, bound) = self.bindings(agents, index);
        let origin = self.definition(self.atoms[index].instance).origin;
        if let Origin::Claim(ClaimSystem { kind: ClaimKind::Property, .. }) = origin
            && !self.is_of_filter(index)
        {
            return true;
        }
        // Whom a link leads to is not nearer than itself.
        let led_to =
            if let Origin::Link(update) = origin { agents.linked(roots[0], update.link) } else { ABSENT };
        bound.iter().any(|&(binder, agent)| {
            agent == ABSENT || agent == led_to || binder.other && roots.contains(&agent)
        })
    }

    /// Whether an atom instance belongs to the filter of an aggregate.
    pub fn is_of_filter(&self, index: usize) -> bool {
        let instance = self.atoms[index].instance;
        let definition = self.definition(instance);
        if let Some((atom, _)) = self.atoms[index].candidate {
            return (atom as usize) < definition.base;
        }
        let offset = index - self.instances[instance as usize].atoms as usize;
        definition.atoms.get(definition.base).map_or(definition.base > 0, |first| offset < first.first)
    }

    /// The numbers of an instance's atom instances, those of the filters of aggregates before those that read these.
    pub fn atoms_of(&self, instance: u32) -> AtomNumbers {
        let first = self.instances[instance as usize].atoms as usize;
        let definition = self.definition(instance);
        let own = first..first + definition.n_atoms;
        let mut ranges: SmallVec<[std::ops::Range<usize>; 1]> = SmallVec::new();
        if definition.folds.is_empty() {
            ranges.push(own);
            ranges.extend(self.candidate_ranges(instance));
        } else {
            ranges.extend(self.candidate_ranges(instance));
            ranges.push(own);
        }
        ranges.into_iter().flatten()
    }
}

/// The rank of the bindings in `slots` among all bindings.
fn place(agents: &Agents<'_>, shape: &AtomShape, slots: &Slots) -> usize {
    shape.binders.iter().fold(0, |place, &Range { slot, ty, .. }| {
        place * agents.seats[ty].len() + agents.agents[slots[slot]].seat
    })
}

/// Whether `slots` may bind `agent` under `other`: not one of the instance's own agents.
pub fn allowed(quantified: &Quantified, roots: &[usize], agent: usize) -> bool {
    !(quantified.other && roots.contains(&agent))
}

/// Whether an agent is in a mode, or inside it.
pub fn inside(agents: &Agents<'_>, agent: usize, mode: usize) -> bool {
    agents.mode(agent).active.contains(&mode)
}

/// Calls `visit` with the agents of every instance of a definition, in order: every agent of the type; every ordered
/// pair of different agents, or every unordered one with the lower number first.
fn for_each_binding(agents: &Agents<'_>, definition: &Definition<'_>, visit: &mut dyn FnMut([u32; 2])) {
    for &first in &agents.of_type[definition.ty] {
        match definition.origin {
            Origin::Transition(_) | Origin::Gate(_) | Origin::Claim(_) | Origin::Link(_) => {
                visit([first as u32, u32::MAX]);
            }
            Origin::Pair(pair) => {
                for &second in &agents.of_type[definition.frame.slots[1].ty()] {
                    if first != second && (!pair.symmetric || first < second) {
                        visit([first as u32, second as u32]);
                    }
                }
            }
        }
    }
}
