//! Definitions of guards: each transition and each claim as the program says it once, with its comparisons laid out.
//!
//! A comparison has an instance for each binding of the quantifiers around it whose agents it reads. The filter of an
//! aggregate is a condition too: its comparisons stand before those of the guard, those of inner aggregates first.

use crate::codegen::program::{
    Atom, ClaimKind, ClaimSystem, Condition, Frame, Guard, LinkUpdate, Near, PairTransition, Program,
    Quantified, Range, Relation, Slot, TransitionSystem, Trigger, Whither,
};
use crate::runtime::fold::{self, Shared};
use crate::runtime::population::Agents;

/// Which pairs of an interaction have instances, and which agents a quantifier looks at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Listing {
    /// All.
    All,
    /// Those that are near enough for their condition to change soon, where the compiler has found a range.
    Near,
}

/// What a definition comes from.
#[derive(Clone, Copy, Debug)]
pub enum Origin<'p> {
    /// A transition of an agent type.
    Transition(&'p TransitionSystem),
    /// The guard of a `rate` transition, which opens the gate of its hazard.
    Gate(&'p TransitionSystem),
    /// A transition of an interaction.
    Pair(&'p PairTransition),
    /// An invariant or an assert.
    Claim(&'p ClaimSystem),
    /// A case of a link that follows from an expression.
    Link(&'p LinkUpdate),
}

impl<'p> Origin<'p> {
    /// The transition that may fire, of an agent type or of an interaction; none for a gate or a claim.
    pub fn transition(self) -> Option<&'p TransitionSystem> {
        match self {
            Origin::Transition(transition) => Some(transition),
            Origin::Pair(pair) => Some(&pair.transition),
            Origin::Gate(_) | Origin::Claim(_) | Origin::Link(_) => None,
        }
    }
}

/// A guard as the program says it.
#[derive(Clone, Debug)]
pub struct Definition<'p> {
    /// Where it comes from.
    pub origin: Origin<'p>,
    /// The type of the first agent.
    pub ty: usize,
    /// The mode in which it is active; 0: in all.
    pub mode: usize,
    /// Its slots.
    pub frame: &'p Frame,
    /// Its condition; none: true.
    pub guard: Option<&'p Guard>,
    /// The aggregates that the condition reads, by number, each with the place of its filter's first comparison; rising.
    pub folds: Vec<(usize, usize)>,
    /// The values of those of them that are the same for all instances.
    pub shared: Shared,
    /// The comparisons: those of filters, then those of the guard.
    pub comparisons: Vec<&'p Atom>,
    /// The place of the guard's first comparison.
    pub base: usize,
    /// Per comparison.
    pub atoms: Vec<AtomShape>,
    /// How many atom instances an instance has.
    pub n_atoms: usize,
    /// Per `rising`: where its flags begin, the binders around it.
    pub rising: Vec<AtomShape>,
    /// How many `rising` flags an instance has.
    pub n_rising: usize,
    /// The types that quantifiers and aggregates range over, and those reached from bound agents by links.
    pub quantified: Vec<usize>,
    /// Its quantifiers, if these look at candidates only that are near enough; none: they look at everybody.
    pub nearby: Vec<Nearby<'p>>,
    /// Of an interaction whose pairs are listed when they are near: how near they are where the condition holds.
    pub near: &'p [Near],
}

impl Definition<'_> {
    /// The types all of whose agents it looks at.
    pub fn looked_over(&self) -> &[usize] {
        if self.nearby.is_empty() { &self.quantified } else { &[] }
    }

    /// What makes it fire; none for a claim.
    pub fn trigger(&self) -> Option<&Trigger> {
        self.origin.transition().map(|transition| &transition.trigger)
    }

    /// The place of the first comparison of an aggregate's filter.
    pub fn base_of(&self, number: usize) -> usize {
        let found = self.folds.binary_search_by_key(&number, |&(number, _)| number);
        self.folds[found.expect("all aggregates that a guard reads are laid out")].1
    }
}

/// A quantifier that looks at candidates only that are near enough for its body to matter.
#[derive(Clone, Debug)]
pub struct Nearby<'p> {
    /// What it binds.
    pub range: Range,
    /// How near they are.
    pub near: &'p [Near],
    /// If its body is one comparison: what that is for those that are not candidates.
    pub beyond: Option<bool>,
    /// The comparisons below it, rising.
    pub atoms: Vec<usize>,
}

/// Where the instances of an atom lie, and what binds them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct AtomShape {
    /// The first, counted from the instance's first.
    pub first: usize,
    /// The quantifiers and aggregates around it, outermost first.
    pub binders: Vec<Range>,
    /// The number of the quantifier by whose candidates it has instances, and its place among those of a candidate; none:
    /// by the seats of what binds it.
    pub nearby: Option<(usize, usize)>,
}

/// All definitions of a program.
pub fn definitions<'p>(agents: &Agents<'p>, listing: Listing) -> Vec<Definition<'p>> {
    let mut definitions = all_definitions(agents, listing);
    if listing == Listing::Near {
        definitions.iter_mut().for_each(|definition| definition.find_nearby(agents));
    }
    definitions
}

fn all_definitions<'p>(agents: &Agents<'p>, listing: Listing) -> Vec<Definition<'p>> {
    let program = agents.program;
    let mut definitions = Vec::new();
    for (ty, system) in program.types.iter().enumerate() {
        for transition in &system.transitions {
            let guard = guard_of(transition);
            let origin = Origin::Transition(transition);
            definitions.push(define(agents, origin, ty, transition.source, &transition.frame, guard));
            if let Some(gate) = gate_of(transition) {
                let (origin, frame) = (Origin::Gate(transition), &transition.frame);
                definitions.push(define(agents, origin, ty, transition.source, frame, Some(gate)));
            }
        }
        for update in system.links.iter().flat_map(|link| &link.updates) {
            definitions.push(define(agents, Origin::Link(update), ty, 0, &update.frame, Some(&update.stale)));
        }
        for (mode, node) in system.modes.iter().enumerate() {
            for claim in &node.claims {
                let guard = Some(&claim.violation);
                definitions.push(define(agents, Origin::Claim(claim), ty, mode, &claim.frame, guard));
            }
        }
    }
    for interaction in &program.interactions {
        for pair in &interaction.transitions {
            let (frame, guard) = (&pair.transition.frame, guard_of(&pair.transition));
            let mut definition = define(agents, Origin::Pair(pair), interaction.types[0], 0, frame, guard);
            if listing == Listing::Near && may_be_listed(&definition) {
                definition.near = &pair.near;
            }
            definitions.push(definition);
        }
    }
    definitions
}

/// Whether a pair that is not near need not be known: nothing is remembered of it but that its condition is false.
fn may_be_listed(definition: &Definition<'_>) -> bool {
    let when = |transition: &TransitionSystem| matches!(transition.trigger, Trigger::When(_));
    definition.origin.transition().is_some_and(when)
        && definition.n_rising == 0
        && definition.folds.is_empty()
        && definition.quantified.is_empty()
        && definition.comparisons.iter().all(|atom| atom.relation != Relation::Crossing)
}

/// The condition of a transition that is followed along the flow, if it has one.
pub fn guard_of(transition: &TransitionSystem) -> Option<&Guard> {
    match &transition.trigger {
        Trigger::When(guard) => Some(guard),
        Trigger::After { guard, .. } | Trigger::Every { guard, .. } | Trigger::Chance { guard, .. } => {
            guard.as_ref()
        }
        Trigger::Rate { due, .. } => Some(due),
        // Asked when a message comes, and not followed.
        Trigger::On { .. } => None,
    }
}

/// The condition of a `rate` transition, which is followed too, if it has one.
pub fn gate_of(transition: &TransitionSystem) -> Option<&Guard> {
    match &transition.trigger {
        Trigger::Rate { guard, .. } => guard.as_ref(),
        Trigger::When(_) | Trigger::After { .. } | Trigger::Every { .. } => None,
        Trigger::Chance { .. } | Trigger::On { .. } => None,
    }
}

fn define<'p>(
    agents: &Agents<'p>,
    origin: Origin<'p>,
    ty: usize,
    mode: usize,
    frame: &'p Frame,
    guard: Option<&'p Guard>,
) -> Definition<'p> {
    let mut binders =
        Binders { frame, comparisons: Vec::new(), atoms: Vec::new(), rising: Vec::new(), around: Vec::new() };
    let (mut folds, mut base, mut quantified) = (Vec::new(), 0, Vec::new());
    if let Some(guard) = guard {
        for number in folds_read(agents.program, frame, guard) {
            let fold = &frame.folds[number];
            folds.push((number, binders.comparisons.len()));
            binders.around = fold.around.clone();
            binders.around.push(fold.range);
            binders.add(&fold.filter);
        }
        base = binders.comparisons.len();
        binders.around.clear();
        binders.add(guard);
        if !folds.is_empty() || guard.condition.quantifies() {
            let own = if matches!(origin, Origin::Pair(_)) { 2 } else { 1 };
            quantified = frame.slots[own..].iter().map(|slot| slot.ty()).collect();
            quantified.sort_unstable();
            quantified.dedup();
        }
    }
    let comparisons = binders.comparisons;
    let (atoms, n_atoms) = shapes(agents, binders.atoms);
    let (rising, n_rising) = shapes(agents, binders.rising);
    Definition {
        origin,
        ty,
        mode,
        frame,
        guard,
        folds,
        shared: Shared::new(agents.program, frame),
        comparisons,
        base,
        atoms,
        n_atoms,
        rising,
        n_rising,
        quantified,
        nearby: Vec::new(),
        near: &[],
    }
}

impl<'p> Definition<'p> {
    /// Has its quantifiers look at candidates only, if each of them has a range, and nothing is remembered of an agent that is
    /// not one.
    fn find_nearby(&mut self, agents: &Agents<'_>) {
        let Some(guard) = self.guard else { return };
        let mut found = Vec::new();
        if matches!(self.origin, Origin::Pair(_))
            || self.n_rising > 0
            || !ranged(&guard.condition, &mut found)
            || !self.folds.is_empty() && !self.are_ranged()
        {
            return;
        }
        if let Origin::Link(LinkUpdate { target, .. }) = self.origin
            && !matches!(target, Whither::Nearest { range, .. }
                if self.folds.is_empty() && found.iter().all(|(found, _)| found.slot == range.slot))
        {
            return;
        }
        let quantified = found.into_iter().map(|(quantified, beyond)| {
            let Quantified { slot, ty, other, .. } = *quantified;
            (Range { slot, ty, other }, quantified.near.as_slice(), &*quantified.body, beyond)
        });
        let folded = self.folds.iter().map(|&(number, _)| {
            let fold = &self.frame.folds[number];
            (fold.range, fold.near.as_slice(), &fold.filter.condition, false)
        });
        for (range, near, body, beyond) in quantified.chain(folded).collect::<Vec<_>>() {
            let slot = range.slot;
            let beyond = matches!(body, Condition::Atom(_)).then_some(beyond);
            let is_bound = |shape: &AtomShape| shape.binders.iter().any(|binder| binder.slot == slot);
            let atoms: Vec<usize> = (0..self.atoms.len()).filter(|&k| is_bound(&self.atoms[k])).collect();
            if atoms.iter().any(|&atom| self.comparisons[atom].relation == Relation::Crossing) {
                self.nearby.clear();
                return;
            }
            self.nearby.push(Nearby { range, near, beyond, atoms });
        }
        for (number, nearby) in self.nearby.iter().enumerate() {
            for (place, &atom) in nearby.atoms.iter().enumerate() {
                self.atoms[atom].nearby = Some((number, place));
            }
        }
        self.lay_out(agents);
    }
}

impl Definition<'_> {
    /// Whether all its aggregates have a range, and none stands in another. Those of properties are looked at along the way.
    fn are_ranged(&self) -> bool {
        let is_ranged = |&(number, _): &(usize, usize)| {
            let fold = &self.frame.folds[number];
            let reads_another = |&slot: &usize| matches!(self.frame.slots[slot], Slot::Fold { .. });
            !fold.near.is_empty()
                && !fold.reads.iter().any(reads_another)
                && fold.filter.n_rising == 0
                && !fold.filter.condition.quantifies()
        };
        let is_property = matches!(self.origin, Origin::Claim(ClaimSystem { kind: ClaimKind::Property, .. }));
        !is_property && self.folds.iter().all(is_ranged)
    }
}

/// Finds the quantifiers of a condition, each with what its body is out of its range. False if one has none, or if they
/// stand in one another.
fn ranged<'p>(condition: &'p Condition, found: &mut Vec<(&'p Quantified, bool)>) -> bool {
    match condition {
        Condition::Constant(_) | Condition::Discrete(_) | Condition::Atom(_) => true,
        Condition::And(all) | Condition::Or(all) => all.iter().all(|condition| ranged(condition, found)),
        Condition::Exists(quantified) | Condition::Forall(quantified) => {
            found.push((quantified, matches!(condition, Condition::Forall(_))));
            !quantified.near.is_empty() && !quantified.body.quantifies()
        }
        Condition::Rising(..) => false,
    }
}

/// Shapes of lists of binders, laid out, and how many places they take.
fn shapes(agents: &Agents<'_>, lists: Vec<Vec<Range>>) -> (Vec<AtomShape>, usize) {
    let mut shapes: Vec<AtomShape> =
        lists.into_iter().map(|binders| AtomShape { first: 0, binders, nearby: None }).collect();
    let n = lay_out(agents, &mut shapes);
    (shapes, n)
}

/// Lays out shapes for the seats that there are; returns how many places they take.
fn lay_out(agents: &Agents<'_>, shapes: &mut [AtomShape]) -> usize {
    let mut next = 0;
    for shape in shapes {
        shape.first = next;
        next += shape.n_seats(|ty| agents.seats[ty].len());
    }
    next
}

impl AtomShape {
    /// How many places it takes in an instance, if types have so many seats.
    pub fn n_seats(&self, seats: impl Fn(usize) -> usize) -> usize {
        match self.nearby {
            Some(_) => 0,
            None => self.binders.iter().map(|binder| seats(binder.ty)).product(),
        }
    }
}

impl Definition<'_> {
    /// Lays its comparisons out anew, for the seats that there are now.
    pub fn lay_out(&mut self, agents: &Agents<'_>) {
        self.n_atoms = lay_out(agents, &mut self.atoms);
        self.n_rising = lay_out(agents, &mut self.rising);
    }

    /// How many entries its instances take: themselves and their comparisons.
    pub fn size(&self, agents: &Agents<'_>) -> u128 {
        self.n_instances(agents) * (1 + self.n_atoms as u128)
    }

    /// How many instances there are if all pairs are listed.
    pub fn n_instances(&self, agents: &Agents<'_>) -> u128 {
        let n = agents.of_type[self.ty].len() as u128;
        match self.origin {
            Origin::Pair(pair) => {
                let other = agents.of_type[self.frame.slots[1].ty()].len() as u128;
                let pairs = n * other;
                if pair.symmetric { pairs / 2 } else { pairs }
            }
            Origin::Transition(_) | Origin::Gate(_) | Origin::Claim(_) | Origin::Link(_) => n,
        }
    }

    /// Whether comparisons of it are bound to agents of a type.
    pub fn binds(&self, ty: usize) -> bool {
        self.atoms.iter().chain(&self.rising).any(|shape| shape.binders.iter().any(|binder| binder.ty == ty))
    }

    /// Whether its quantifiers look at everybody of a type.
    pub fn binds_all(&self, ty: usize) -> bool {
        self.nearby.is_empty() && self.binds(ty)
    }
}

/// The aggregates that a guard reads, and those that these read; rising.
pub fn folds_read(program: &Program, frame: &Frame, guard: &Guard) -> Vec<usize> {
    let mut read = vec![false; frame.folds.len()];
    mark(program, frame, guard, &mut read);
    for number in (0..read.len()).rev() {
        if read[number] {
            let fold = &frame.folds[number];
            mark(program, frame, &fold.filter, &mut read);
            if let Some(term) = &fold.term {
                fold::read_by(frame, program.kernel(term.value)).for_each(|number| read[number] = true);
            }
        }
    }
    (0..read.len()).filter(|&number| read[number]).collect()
}

fn mark(program: &Program, frame: &Frame, guard: &Guard, read: &mut [bool]) {
    for function in guard.functions() {
        fold::read_by(frame, program.kernel(function)).for_each(|number| read[number] = true);
    }
}

/// Finds what binds the agents that each comparison reads.
struct Binders<'p> {
    frame: &'p Frame,
    comparisons: Vec<&'p Atom>,
    atoms: Vec<Vec<Range>>,
    rising: Vec<Vec<Range>>,
    around: Vec<Range>,
}

impl<'p> Binders<'p> {
    /// Adds the comparisons of a guard below what is around it.
    fn add(&mut self, guard: &'p Guard) {
        let base = self.comparisons.len();
        self.comparisons.extend(&guard.atoms);
        self.atoms.resize(base + guard.atoms.len(), Vec::new());
        self.rising.resize(self.rising.len() + guard.n_rising, Vec::new());
        self.walk(&guard.condition, base);
    }

    fn walk(&mut self, condition: &Condition, base: usize) {
        match condition {
            Condition::Constant(_) | Condition::Discrete(_) => {}
            Condition::Atom(atom) => self.atoms[base + atom] = self.binding(self.comparisons[base + atom]),
            Condition::And(all) | Condition::Or(all) => {
                all.iter().for_each(|condition| self.walk(condition, base));
            }
            Condition::Exists(quantified) | Condition::Forall(quantified) => {
                let Quantified { slot, ty, other, .. } = *quantified;
                self.around.push(Range { slot, ty, other });
                self.walk(&quantified.body, base);
                self.around.pop();
            }
            Condition::Rising(number, condition) => {
                self.rising[*number] = self.around.clone();
                self.walk(condition, base);
            }
        }
    }

    /// Those around a comparison that bind an agent which it reads, or from which it follows links.
    fn binding(&self, atom: &Atom) -> Vec<Range> {
        let root = |mut slot: usize| {
            while let Slot::Link { from, .. } = self.frame.slots[slot] {
                slot = from;
            }
            slot
        };
        let reads = |range: &&Range| atom.slots.iter().any(|&slot| root(slot) == range.slot);
        self.around.iter().filter(reads).copied().collect()
    }
}
