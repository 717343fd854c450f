//! Aggregates: who belongs to them, and what comes of their terms.
//!
//! An aggregate is gathered first: its members, in the order of the agents, by whatever says who belongs to it. Then it can be
//! evaluated on any rows, as a number with its rates or over boxes, and stands in its slot as if it were an agent with one
//! column. Members do not change while rows do: where a condition of a filter changes, it is gathered again.

use std::cell::Cell;

use smallvec::SmallVec;

use crate::codegen::kernel::{AgentBox, AgentView, Kernel};
use crate::codegen::program::{Aggregate, Condition, Fold, Frame, FunctionId, Program, Term};
use crate::math::Interval;
use crate::runtime::population::{ABSENT, Agents, Slots};
use crate::runtime::present::{Boxes, Depth, Views, depth_read};

/// An aggregate with its members.
#[derive(Clone, Debug)]
pub struct Folded<'f> {
    fold: &'f Fold,
    members: Vec<Member<'f>>,
    /// Its value, if no term of it moves.
    still: Option<f64>,
}

/// An agent that belongs to an aggregate, bound in its slot.
#[derive(Clone, Debug)]
struct Member<'f> {
    slots: Slots,
    inner: Vec<Folded<'f>>,
}

/// The value of an aggregate and its rates, in its slot.
#[derive(Clone, Copy, Debug)]
pub struct Leaf<T> {
    slot: usize,
    jet: [T; 3],
    aux: f64,
}

/// The values of the aggregates that a kernel reads.
pub type Leaves<T> = SmallVec<[Leaf<T>; 1]>;

/// The values of a frame's aggregates that read nothing of who asks and change at events only: they are worked out once
/// between two changes of the agents, whoever asks.
#[derive(Clone, Debug, Default)]
pub struct Shared {
    /// By number of the aggregate; none for one that is not shared.
    known: Vec<Option<Cell<Known>>>,
}

/// A value, and after how many changes of the agents it was so.
#[derive(Clone, Copy, Debug, Default)]
struct Known {
    changes: Option<u64>,
    value: f64,
}

impl Shared {
    /// Nothing is known yet.
    pub fn new(program: &Program, frame: &Frame) -> Self {
        let known = |fold: &Fold| is_shared(program, frame, fold).then(Cell::default);
        Self { known: frame.folds.iter().map(known).collect() }
    }

    fn of(&self, number: usize) -> Option<&Cell<Known>> {
        self.known.get(number).and_then(Option::as_ref)
    }
}

/// Whether all who ask for an aggregate at one time are told the same, and so are those who ask before the next event.
fn is_shared(program: &Program, frame: &Frame, fold: &Fold) -> bool {
    let reads_no_fold = |function| read_by(frame, program.kernel(function)).next().is_none();
    let filter = &fold.filter;
    fold.reads.is_empty()
        && !fold.range.other
        && !fold.moves
        && filter.atoms.is_empty()
        && filter.n_rising == 0
        && is_for_all(&filter.condition, &reads_no_fold)
        && fold.term.as_ref().is_none_or(|term| reads_no_fold(term.value))
}

/// Whether a condition has no `other`, and its tests pass.
fn is_for_all(condition: &Condition, test: &dyn Fn(FunctionId) -> bool) -> bool {
    match condition {
        Condition::Constant(_) => true,
        Condition::Discrete(function) => test(*function),
        Condition::And(all) | Condition::Or(all) => all.iter().all(|condition| is_for_all(condition, test)),
        Condition::Exists(quantified) | Condition::Forall(quantified) => {
            !quantified.other && is_for_all(&quantified.body, test)
        }
        Condition::Atom(_) | Condition::Rising(_, _) => false,
    }
}

/// Says whether the agent bound in the slots belongs to the aggregate of this number.
pub type Belongs<'b> = dyn FnMut(usize, &mut Slots) -> bool + 'b;

/// Who may belong to an aggregate: its number; none if that may be anybody of its type.
pub type Among<'b> = dyn Fn(usize) -> Option<Vec<usize>> + 'b;

/// The aggregates of a frame that a kernel reads, with their members. `own` are the agents that `other` leaves out; `shared`
/// knows values, and is told new ones.
pub fn gather<'f>(
    agents: &Agents<'_>,
    (frame, shared): (&'f Frame, Option<&Shared>),
    kernel: &Kernel,
    slots: &Slots,
    own: &[usize],
    (among, belongs): (&Among<'_>, &mut Belongs<'_>),
) -> Vec<Folded<'f>> {
    let mut all = Vec::new();
    for number in read_by(frame, kernel) {
        let fold = &frame.folds[number];
        let known = shared.and_then(|shared| shared.of(number));
        if let Some(Known { value, .. }) =
            known.map(Cell::get).filter(|known| known.changes == Some(agents.changes))
        {
            all.push(Folded { fold, members: Vec::new(), still: Some(value) });
            continue;
        }
        let mut folded = Folded { fold, members: Vec::new(), still: None };
        let mut bound = slots.clone();
        let near = among(number);
        for &agent in near.as_ref().unwrap_or(&agents.of_type[fold.range.ty]) {
            if fold.range.other && own.contains(&agent) {
                continue;
            }
            bound[fold.range.slot] = agent;
            agents.follow_links(frame, &mut bound);
            if belongs(number, &mut bound) {
                let inner = fold.term.as_ref().map_or_else(Vec::new, |term| {
                    let kernel = agents.program.kernel(term.value);
                    gather(agents, (frame, shared), kernel, &bound, own, (among, belongs))
                });
                folded.members.push(Member { slots: bound.clone(), inner });
            }
        }
        if !fold.moves {
            let row = |agent: usize| aux_only(agents, agent);
            let value = folded.jet(agents.program, Depth::States, f64::NAN, &row)[0];
            folded.still = Some(value);
            if let Some(known) = known {
                // Nothing that flows is read of them.
                folded.members = Vec::new();
                known.set(Known { changes: Some(agents.changes), value });
            }
        }
        all.push(folded);
    }
    all
}

/// The numbers of the aggregates of a frame that a kernel reads.
pub fn read_by<'f>(frame: &'f Frame, kernel: &'f Kernel) -> impl Iterator<Item = usize> + 'f {
    (0..frame.folds.len()).filter(|&number| reads(kernel, frame.folds[number].slot))
}

fn reads(kernel: &Kernel, slot: usize) -> bool {
    let reads = kernel.reads().slots.get(slot);
    reads.is_some_and(|reads| reads.states + reads.rates + reads.accelerations + reads.aux > 0)
}

/// What a term that does not move reads of an agent.
fn aux_only<'a>(agents: &'a Agents<'_>, agent: usize) -> AgentView<'a> {
    let aux = if agent == ABSENT { agents.absent_row() } else { &agents.agents[agent].aux };
    AgentView { states: &[], rates: &[], accelerations: &[], aux }
}

/// The agents in these slots and those that belong to these aggregates, rising.
pub fn involved(slots: &Slots, folds: &[Folded<'_>]) -> Vec<usize> {
    let mut all: Vec<usize> = slots.iter().copied().filter(|&agent| agent != ABSENT).collect();
    folds.iter().for_each(|folded| folded.involve(&mut all));
    all.sort_unstable();
    all.dedup();
    all
}

/// The agents that belong to these aggregates, and whom they reach by links.
pub fn members(folds: &[Folded<'_>]) -> Vec<usize> {
    involved(&Slots::new(), folds)
}

/// How deep rows must be for a kernel that reads these aggregates.
pub fn depth(program: &Program, kernel: &Kernel, folds: &[Folded<'_>]) -> Depth {
    let own = depth_read(kernel);
    folds.iter().map(|folded| folded.depth(program, own)).fold(own, Depth::max)
}

/// The rows of the agents in some slots and of aggregates.
pub fn views<'a>(slots: &Slots, leaves: &'a [Leaf<f64>], row: &dyn Fn(usize) -> AgentView<'a>) -> Views<'a> {
    let view = |(slot, &agent): (usize, &usize)| match leaves.iter().find(|leaf| leaf.slot == slot) {
        Some(leaf) => {
            let [states, rates, accelerations] = [0, 1, 2].map(|k| std::slice::from_ref(&leaf.jet[k]));
            AgentView { states, rates, accelerations, aux: std::slice::from_ref(&leaf.aux) }
        }
        None => row(agent),
    };
    slots.iter().enumerate().map(view).collect()
}

/// The boxes of the agents in some slots and of aggregates.
pub fn boxes<'a>(
    slots: &Slots,
    leaves: &'a [Leaf<Interval>],
    row: &dyn Fn(usize) -> AgentBox<'a>,
) -> Boxes<'a> {
    let view = |(slot, &agent): (usize, &usize)| match leaves.iter().find(|leaf| leaf.slot == slot) {
        Some(leaf) => {
            let [states, rates, accelerations] = [0, 1, 2].map(|k| std::slice::from_ref(&leaf.jet[k]));
            AgentBox { states, rates, accelerations, aux: std::slice::from_ref(&leaf.aux) }
        }
        None => row(agent),
    };
    slots.iter().enumerate().map(view).collect()
}

/// The values of aggregates; with their rates if `depth` is more than states.
pub fn leaves<'a>(
    program: &Program,
    folds: &[Folded<'_>],
    depth: Depth,
    time: f64,
    row: &dyn Fn(usize) -> AgentView<'a>,
) -> Leaves<f64> {
    let leaf = |folded: &Folded<'_>| {
        let jet = match folded.still {
            Some(value) => [value, 0.0, 0.0],
            None => folded.jet(program, depth, time, row),
        };
        Leaf { slot: folded.fold.slot, jet, aux: jet[0] }
    };
    folds.iter().map(leaf).collect()
}

/// Bounds of aggregates; of their rates too if `depth` is more than states.
pub fn leaf_ranges<'a>(
    program: &Program,
    folds: &[Folded<'_>],
    depth: Depth,
    time: Interval,
    registers: &mut Vec<Interval>,
    row: &dyn Fn(usize) -> AgentBox<'a>,
) -> Leaves<Interval> {
    let leaf = |folded: &Folded<'_>| {
        let (jet, aux) = match folded.still {
            Some(value) => ([Interval::point(value), Interval::ZERO, Interval::ZERO], value),
            None => (folded.jet_range(program, depth, time, registers, row), f64::NAN),
        };
        Leaf { slot: folded.fold.slot, jet, aux }
    };
    folds.iter().map(leaf).collect()
}

impl Folded<'_> {
    fn involve(&self, all: &mut Vec<usize>) {
        for member in &self.members {
            all.extend(member.slots.iter().copied().filter(|&agent| agent != ABSENT));
            member.inner.iter().for_each(|inner| inner.involve(all));
        }
    }

    fn depth(&self, program: &Program, wanted: Depth) -> Depth {
        let Some(term) = &self.fold.term else { return Depth::States };
        let own = depth_read(kernel(program, term, wanted));
        let inner = self.members.iter().flat_map(|member| &member.inner);
        inner.map(|inner| inner.depth(program, wanted)).fold(own, Depth::max)
    }

    /// Value, rate and second rate on some rows.
    fn jet<'a>(
        &self,
        program: &Program,
        depth: Depth,
        time: f64,
        row: &dyn Fn(usize) -> AgentView<'a>,
    ) -> [f64; 3] {
        let Some(term) = &self.fold.term else { return [self.members.len() as f64, 0.0, 0.0] };
        let kernel = kernel(program, term, depth);
        let mut total = start(self.fold.kind);
        for member in &self.members {
            let leaves = leaves(program, &member.inner, depth, time, row);
            let mut jet = [0.0; 3];
            // The rows live as long as the call: leaves of inner aggregates are made for each member.
            kernel.eval(&views(&member.slots, &leaves, &|agent| row(agent)), time, &mut jet);
            add(self.fold.kind, &mut total, jet);
        }
        total
    }

    /// Bounds of value, rate and second rate over some boxes.
    fn jet_range<'a>(
        &self,
        program: &Program,
        depth: Depth,
        time: Interval,
        registers: &mut Vec<Interval>,
        row: &dyn Fn(usize) -> AgentBox<'a>,
    ) -> [Interval; 3] {
        let Some(term) = &self.fold.term else {
            return [Interval::point(self.members.len() as f64), Interval::ZERO, Interval::ZERO];
        };
        let kernel = kernel(program, term, depth);
        let mut parts = Vec::with_capacity(self.members.len());
        for member in &self.members {
            let leaves = leaf_ranges(program, &member.inner, depth, time, registers, row);
            let mut jet = [Interval::ZERO; 3];
            kernel.range(&boxes(&member.slots, &leaves, &|agent| row(agent)), time, registers, &mut jet);
            parts.push(jet);
        }
        match self.fold.kind {
            Aggregate::Count | Aggregate::Sum => {
                parts.iter().fold([Interval::ZERO; 3], |sum, part| [0, 1, 2].map(|k| sum[k].add(part[k])))
            }
            Aggregate::Min => least(&parts),
            Aggregate::Max => {
                least(&parts.iter().map(|part| part.map(negative)).collect::<Vec<_>>()).map(negative)
            }
        }
    }
}

fn kernel<'p>(program: &'p Program, term: &Term, depth: Depth) -> &'p Kernel {
    program.kernel(if depth == Depth::States { term.value } else { term.rates })
}

/// The value of an aggregate without members.
fn start(kind: Aggregate) -> [f64; 3] {
    match kind {
        Aggregate::Count | Aggregate::Sum => [0.0; 3],
        Aggregate::Min => [f64::INFINITY, 0.0, 0.0],
        Aggregate::Max => [f64::NEG_INFINITY, 0.0, 0.0],
    }
}

/// Adds a member's term; of two that are equal the one that will be the least, or the greatest, just after.
fn add(kind: Aggregate, total: &mut [f64; 3], jet: [f64; 3]) {
    let before = |a: [f64; 3], b: [f64; 3]| {
        let differs = (0..3).find(|&k| a[k] != b[k]);
        differs.is_some_and(|k| a[k] < b[k])
    };
    match kind {
        Aggregate::Count | Aggregate::Sum => {
            total.iter_mut().zip(jet).for_each(|(total, part)| *total += part);
        }
        _ if total[0].is_nan() => {}
        _ if jet[0].is_nan() => *total = jet,
        Aggregate::Min if before(jet, *total) => *total = jet,
        Aggregate::Max if before(*total, jet) => *total = jet,
        Aggregate::Min | Aggregate::Max => {}
    }
}

/// Bounds of the least of some terms. Its rate is that of one of those that may be the least; where there are several, its
/// rate may jump, and nothing bounds its second rate.
fn least(parts: &[[Interval; 3]]) -> [Interval; 3] {
    let none = Interval { lo: f64::INFINITY, hi: f64::INFINITY };
    let value = parts
        .iter()
        .fold(none, |least, part| Interval { lo: least.lo.min(part[0].lo), hi: least.hi.min(part[0].hi) });
    let mut candidates = parts.iter().filter(|part| part[0].lo <= value.hi);
    let Some(first) = candidates.next() else { return [none, Interval::ZERO, Interval::ZERO] };
    let (mut rate, mut second) = (first[1], first[2]);
    for part in candidates {
        rate = rate.hull(part[1]);
        second = Interval::WHOLE;
    }
    [value, rate, second]
}

fn negative(bound: Interval) -> Interval {
    Interval { lo: -bound.hi, hi: -bound.lo }
}
