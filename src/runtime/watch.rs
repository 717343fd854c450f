//! The guards as the 2004 algorithms see them: every comparison is a g over some agents, each on its own clock.
//!
//! A comparison of a compound guard is a g of its own. Its agents are those that it reads and those that its transition
//! belongs to. It is *watched*, that is approached by step sizes and looked at for g = 0, while it is false; once it has
//! been found at zero it has to leave it before it is watched again, or it would fire for ever.
//!
//! An aggregate (`sum`, `min`, ..) is a function of all its members, and so is a g that reads one. Its members are fixed
//! between events, and gathered anew after each.

use smallvec::SmallVec;

use crate::codegen::kernel::{AgentView, Kernel};
use crate::codegen::program::{Atom, FunctionId, Relation};
use crate::runtime::engine::Engine;
use crate::runtime::fold::{self, Folded};
use crate::runtime::groups::Group;
use crate::runtime::population::{ABSENT, Agent, Slots};
use crate::runtime::present::{Depth, depth_read};
use crate::runtime::solve::adams;
use crate::runtime::solve::polynomial::{Cubic, moved};
use crate::runtime::solve::step_select::StepSelect;
use crate::runtime::truth::Side;

/// A comparison with its agents.
pub struct Watched<'p> {
    /// What is compared.
    pub atom: &'p Atom,
    /// The guard instance that it belongs to.
    pub instance: u32,
    /// Whether it has been found at zero and has not left it since.
    pub at_zero: bool,
    slots: Slots,
    /// Whose clocks count, rising.
    agents: SmallVec<[usize; 2]>,
    /// Those that it reads, rising.
    read: SmallVec<[usize; 2]>,
    /// Its aggregates, with their members at present.
    folds: Vec<Folded<'p>>,
}

impl Watched<'_> {
    /// Whether an agent's clock counts.
    pub fn has(&self, agent: usize) -> bool {
        self.agents.binary_search(&agent).is_ok()
    }
}

/// The predictor polynomials of one agent's states, from its clock on.
#[derive(Clone, Debug, Default)]
struct Predictor {
    cubics: Vec<Cubic>,
    rates: Vec<f64>,
    accelerations: Vec<f64>,
}

/// All guards of a run.
pub struct Watch<'p> {
    /// By number of the comparison.
    pub guards: Vec<Watched<'p>>,
    /// For each agent, the comparisons that it takes part in, or may, as a member of an aggregate.
    pub of_agent: Vec<Vec<u32>>,
    /// Those with aggregates.
    folded: Vec<usize>,
    predictors: Vec<Predictor>,
    /// Scratch: x, x', x'', x''' of each agent that a guard reads.
    rows: Vec<f64>,
    absent: Vec<f64>,
    /// Evaluations of guards and of their rates.
    pub evaluations: u64,
    /// Polynomials (18) and (28) made and solved.
    pub polynomials: u64,
    /// Arithmetic operations of both.
    pub operations: u64,
}

/// Arithmetic operations of finding the smallest root of a cubic, about: extrema 12, values at three places 18, five
/// steps of Newton's method in a bracket 70.
const ROOT_OPERATIONS: u64 = 100;
/// Of moving a cubic: value 6, rate 6, curvature 3, and three factors.
const MOVE_OPERATIONS: u64 = 18;

impl<'p> Watch<'p> {
    /// The guards of a run that has begun.
    pub fn new(engine: &Engine<'p, '_>) -> Self {
        let agents = &engine.agents;
        let mut of_agent = vec![Vec::new(); agents.len()];
        let mut guards = Vec::with_capacity(engine.guards.atoms.len());
        let mut folded = Vec::new();
        for (index, state) in engine.guards.atoms.iter().enumerate() {
            let (atom, slots) = engine.guards.atom_slots(agents, index);
            let read = sorted(atom.slots.iter().map(|&slot| slots[slot]).filter(|&agent| agent != ABSENT));
            let own = sorted(engine.guards.roots(state.instance).into_iter().chain(read.iter().copied()));
            for &agent in &own {
                of_agent[agent].push(index as u32);
            }
            if !atom.folds.is_empty() {
                folded.push(index);
                for &ty in &engine.guards.definition(state.instance).quantified {
                    let may_belong = agents.of_type[ty].iter().filter(|&agent| !own.contains(agent));
                    may_belong.for_each(|&agent| of_agent[agent].push(index as u32));
                }
            }
            let (instance, folds) = (state.instance, Vec::new());
            guards.push(Watched { atom, instance, at_zero: false, slots, agents: own, read, folds });
        }
        let width = agents.row_width();
        Self {
            guards,
            of_agent,
            folded,
            predictors: vec![Predictor::default(); agents.len()],
            rows: Vec::new(),
            absent: vec![f64::NAN; width],
            evaluations: 0,
            polynomials: 0,
            operations: 0,
        }
    }

    /// Gathers the members of all aggregates, as they are at the present instant.
    pub fn gather(&mut self, engine: &Engine<'p, '_>) {
        for &index in &self.folded {
            let Watched { atom, instance, slots, agents, read, folds, .. } = &mut self.guards[index];
            *folds = engine.truths().gather(*instance, engine.program.kernel(atom.value), slots, Side::After);
            let own = atom.slots.iter().map(|&slot| slots[slot]).filter(|&agent| agent != ABSENT);
            *read = sorted(own.chain(fold::members(folds)));
            *agents = sorted(engine.guards.roots(*instance).into_iter().chain(read.iter().copied()));
        }
    }

    /// Takes over the predictor polynomials (11) of a group's members at its clock. While the method is being started and
    /// has not got its rates of the past, the second rates stand in, which the compiler has.
    pub fn predict(&mut self, engine: &mut Engine<'_, '_>, group: usize) {
        let Group { members, clock, integration, .. } = &engine.groups.groups[group];
        let past = integration.past();
        let mut first = 0;
        for &agent in members {
            let states = &engine.agents.agents[agent].states;
            let Predictor { cubics, rates, accelerations } = &mut self.predictors[agent];
            cubics.clear();
            cubics.extend((0..states.len()).map(|i| {
                let [linear, square, cubic] = adams::extrapolation(past, first + i);
                [states[i], linear, square, cubic]
            }));
            if past.len() < adams::POINTS {
                engine.present.go(*clock);
                engine.present.make(&engine.agents, &[agent], Depth::Accelerations);
                for (cubic, second) in cubics.iter_mut().zip(engine.present.accelerations(agent)) {
                    (cubic[2], cubic[3]) = (second / 2.0, 0.0);
                }
            }
            rates.clear();
            rates.extend(cubics.iter().map(|cubic| cubic[1]));
            accelerations.clear();
            accelerations.extend(cubics.iter().map(|cubic| 2.0 * cubic[2]));
            first += states.len();
        }
    }

    /// Whether a comparison is one whose zero would be news.
    pub fn is_watched(&self, engine: &Engine<'_, '_>, index: usize) -> bool {
        let guard = &self.guards[index];
        let is_false = guard.atom.relation == Relation::Crossing || !engine.guards.atoms[index].truth;
        engine.guards.instances[guard.instance as usize].active && is_false && !guard.at_zero
    }

    /// t^1: the largest clock of the agents of a guard.
    pub fn leader(&self, engine: &Engine<'_, '_>, index: usize) -> f64 {
        let clocks = self.guards[index].agents.iter().map(|&agent| clock(engine, agent));
        clocks.fold(f64::NEG_INFINITY, f64::max)
    }

    /// g_k: the guard with every agent at its own clock; the time is the leader's.
    pub fn value(&mut self, engine: &Engine<'_, '_>, index: usize) -> f64 {
        let function = self.guards[index].atom.value;
        let mut out = [0.0];
        self.evaluate(engine, index, function, &|agent| self.row(engine, agent), &mut out);
        self.count(engine.program.kernel(function));
        out[0]
    }

    /// dg/dx . f with every agent at its own clock, the rate of Gear & Osterby's extra state (9), and its own rate.
    pub fn rates(&mut self, engine: &Engine<'_, '_>, index: usize) -> [f64; 2] {
        let function = self.guards[index].atom.rates;
        let mut out = [0.0; 3];
        self.evaluate(engine, index, function, &|agent| self.row(engine, agent), &mut out);
        self.count(engine.program.kernel(function));
        [out[1], if out[2].is_nan() { 0.0 } else { out[2] }]
    }

    fn count(&mut self, kernel: &Kernel) {
        self.evaluations += 1;
        self.operations += kernel.operations();
    }

    /// A function of a guard on some rows, at the time of the leader.
    fn evaluate<'a>(
        &'a self,
        engine: &'a Engine<'_, '_>,
        index: usize,
        function: FunctionId,
        row: &dyn Fn(usize) -> AgentView<'a>,
        out: &mut [f64],
    ) {
        let Watched { slots, folds, .. } = &self.guards[index];
        let (kernel, t1) = (engine.program.kernel(function), self.leader(engine, index));
        let leaves = fold::leaves(engine.program, folds, depth_read(kernel), t1, row);
        kernel.eval(&fold::views(slots, &leaves, &|agent| row(agent)), t1, out);
    }

    /// The rows of an agent at its own clock.
    fn row<'a>(&'a self, engine: &'a Engine<'_, '_>, agent: usize) -> AgentView<'a> {
        if agent == ABSENT {
            return AgentView::absent(&self.absent);
        }
        let Agent { states, aux, .. } = &engine.agents.agents[agent];
        let Predictor { rates, accelerations, .. } = &self.predictors[agent];
        AgentView { states, rates, accelerations, aux }
    }

    /// The guard with every agent along its predictor polynomial, moved by (17): a polynomial of h^1.
    ///
    /// Of a linear guard it is exact. Of any other it has the first two derivatives dg/dx . x' and its rate (Gear &
    /// Osterby's, from the compiler), and of the third the part that is linear in the states'.
    pub fn along(&mut self, engine: &Engine<'_, '_>, index: usize, select: &StepSelect) -> Cubic {
        let t1 = self.leader(engine, index);
        let guard = &self.guards[index];
        let width = self.absent.len();
        self.rows.resize(4 * width * guard.read.len(), 0.0);
        for (rows, &agent) in self.rows.chunks_exact_mut(4 * width).zip(&guard.read) {
            let ahead = select.ahead(clock(engine, agent) - t1);
            for (i, cubic) in self.predictors[agent].cubics.iter().enumerate() {
                let [x, linear, square, cubic] = moved(cubic, ahead);
                (rows[i], rows[width + i]) = (x, linear);
                (rows[2 * width + i], rows[3 * width + i]) = (2.0 * square, 6.0 * cubic);
                self.operations += MOVE_OPERATIONS;
            }
        }
        let kernel = engine.program.kernel(guard.atom.rates);
        let jet = self.jet(engine, index);
        for rows in self.rows.chunks_exact_mut(4 * width) {
            let (known, third) = rows.split_at_mut(3 * width);
            known[2 * width..].iter_mut().zip(third).for_each(|(second, third)| *second += *third);
        }
        let further = self.jet(engine, index);
        self.count(kernel);
        self.count(kernel);
        self.count_polynomial();
        let known = |value: f64| if value.is_nan() { 0.0 } else { value };
        [jet[0], jet[1], known(jet[2] / 2.0), known((further[2] - jet[2]) / 6.0)]
    }

    /// g, g', g'' on the scratch rows.
    fn jet(&self, engine: &Engine<'_, '_>, index: usize) -> [f64; 3] {
        let (guard, width) = (&self.guards[index], self.absent.len());
        let row = |agent: usize| {
            let Ok(k) = guard.read.binary_search(&agent) else { return AgentView::absent(&self.absent) };
            let rows = &self.rows[4 * width * k..4 * width * (k + 1)];
            AgentView {
                states: &rows[..width],
                rates: &rows[width..2 * width],
                accelerations: &rows[2 * width..3 * width],
                aux: &engine.agents.agents[agent].aux,
            }
        };
        let mut out = [0.0; 3];
        self.evaluate(engine, index, guard.atom.rates, &row, &mut out);
        out
    }

    /// Counts a polynomial that is made and solved.
    pub fn count_polynomial(&mut self) {
        self.polynomials += 1;
        self.operations += ROOT_OPERATIONS;
    }

    /// The agents of a guard.
    pub fn agents(&self, index: usize) -> &[usize] {
        &self.guards[index].agents
    }

    /// The slots of a guard.
    pub fn slots(&self, index: usize) -> &Slots {
        &self.guards[index].slots
    }

    /// The aggregates of a guard.
    pub fn folds(&self, index: usize) -> &[Folded<'p>] {
        &self.guards[index].folds
    }
}

fn sorted(agents: impl Iterator<Item = usize>) -> SmallVec<[usize; 2]> {
    let mut all: SmallVec<[usize; 2]> = agents.collect();
    all.sort_unstable();
    all.dedup();
    all
}

/// t^i, s.
pub fn clock(engine: &Engine<'_, '_>, agent: usize) -> f64 {
    engine.groups.groups[engine.agents.agents[agent].group].clock
}
