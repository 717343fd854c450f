//! Whom quantifiers look at that have a range (I7): for each instance and quantifier a list of agents, each with room for the
//! comparisons that are bound to it.
//!
//! Who is not a candidate cannot come within the range before the lists are made anew, and settles nothing.

/// An agent at which a quantifier looks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Candidate {
    /// What it is called by: candidates are in the order of this.
    pub number: u64,
    /// Its place.
    pub agent: u32,
    /// The first of the atom instances that are bound to it.
    pub first: u32,
}

/// All candidates.
#[derive(Default)]
pub struct Candidates {
    /// Of each instance one list a quantifier.
    lists: Vec<Vec<Candidate>>,
    /// For each agent, the instances of which it is a candidate; once for each quantifier.
    looking: Vec<Vec<u32>>,
    /// By how many there are together: the first of atom instances that nobody has.
    free: Vec<Vec<u32>>,
    /// Those of who ceased to be a candidate in the instant at hand: how many, and the first.
    retired: Vec<(usize, u32)>,
}

impl Candidates {
    /// No lists yet, for so many agents.
    pub fn new(n_agents: usize) -> Self {
        Self { looking: vec![Vec::new(); n_agents], ..Self::default() }
    }

    /// Adds empty lists; the number of the first.
    pub fn add_lists(&mut self, n: usize) -> u32 {
        let first = self.lists.len();
        self.lists.resize(first + n, Vec::new());
        first as u32
    }

    /// Makes room for one more agent.
    pub fn admit(&mut self) {
        self.looking.push(Vec::new());
    }

    /// A list, in the order of numbers.
    pub fn list(&self, list: usize) -> &[Candidate] {
        &self.lists[list]
    }

    /// A candidate of a list.
    pub fn find(&self, list: usize, number: u64) -> Option<Candidate> {
        let list = &self.lists[list];
        list.binary_search_by_key(&number, |candidate| candidate.number).ok().map(|place| list[place])
    }

    /// The instances of which an agent is a candidate.
    pub fn looking_at(&self, agent: usize) -> &[u32] {
        &self.looking[agent]
    }

    /// Enters a candidate of an instance into one of its lists.
    pub fn enter(&mut self, list: usize, instance: u32, candidate: Candidate) {
        let list = &mut self.lists[list];
        let place = list.partition_point(|other| other.number < candidate.number);
        list.insert(place, candidate);
        self.looking[candidate.agent as usize].push(instance);
    }

    /// Strikes a candidate of an instance from one of its lists; its `n` atom instances are not given to others before
    /// [`Candidates::free_retired`].
    pub fn strike(&mut self, list: usize, instance: u32, number: u64, n: usize) -> Option<Candidate> {
        let list = &mut self.lists[list];
        let place = list.binary_search_by_key(&number, |candidate| candidate.number).ok()?;
        let candidate = list.remove(place);
        let looking = &mut self.looking[candidate.agent as usize];
        if let Some(place) = looking.iter().position(|&other| other == instance) {
            looking.swap_remove(place);
        }
        self.retired.push((n, candidate.first));
        Some(candidate)
    }

    /// Room for `n` atom instances that nobody has any more.
    pub fn reuse(&mut self, n: usize) -> Option<u32> {
        self.free.get_mut(n)?.pop()
    }

    /// Nothing refers any more to those who have ceased to be candidates.
    pub fn free_retired(&mut self) {
        for (n, first) in std::mem::take(&mut self.retired) {
            if self.free.len() <= n {
                self.free.resize(n + 1, Vec::new());
            }
            self.free[n].push(first);
        }
    }

    /// Has every candidate's atom instances lie elsewhere; what nobody has is lost.
    pub fn relocate(&mut self, list: usize, elsewhere: &mut dyn FnMut(u32) -> u32) {
        self.free.clear();
        self.retired.clear();
        for candidate in &mut self.lists[list] {
            candidate.first = elsewhere(candidate.first);
        }
    }
}
