//! Invariants that the flow breaks as soon as it begins (HY0626): at the start, or behind a transition.
//!
//! Certain if a comparison of the invariant is on its boundary or beyond when the mode is entered, as far as the start, the condition
//! of the transition and its actions say; if the flow of the mode makes it more false; and if nothing else may happen to the agent
//! at that instant.

use rustc_hash::FxHashSet;

use crate::base::Span;
use crate::calculus::bounds::Bounds;
use crate::calculus::form::FormId;
use crate::calculus::graph::Node;
use crate::calculus::layout::Layout;
use crate::calculus::lint::Warning;
use crate::calculus::lint::certain::{holds, is_false, restrictions};
use crate::calculus::lint::effects::{effect, entered, guard, may_end, nodes, read_by, reads, with_params};
use crate::calculus::lint::flowing::{Given, add_rates, derivatives, others, stand_in};
use crate::calculus::lint::starts::Starts;
use crate::calculus::reader::Reader;
use crate::calculus::system::{
    ActionStep, AgentSystem, Atom, ClaimKind, ClaimSystem, Condition, Entry, FunctionId, Guard, Instance,
    Relation, System, TransitionSystem, Trigger,
};

/// Looks at every way into every mode that has an invariant.
pub fn invariants(system: &System, bounds: &Bounds, starts: &Starts, found: &mut Vec<Warning>) {
    if may_end(system) {
        return;
    }
    let of_these = with_params(system, bounds);
    let is_simple =
        |ty: &AgentSystem| ty.regions.len() == 1 && ty.modes.iter().any(|mode| has_invariant(&mode.claims));
    let simple: Vec<bool> = system.types.iter().map(is_simple).collect();
    for (number, ty) in system.types.iter().enumerate().filter(|(number, _)| simple[*number]) {
        for (k, transition) in ty.transitions.iter().enumerate() {
            let Some(leaf) = entered(ty, transition) else { continue };
            let Some(mut arrival) = Arrival::by(system, &of_these, number, k, leaf) else { continue };
            found.extend(arrival.warning(transition.span));
        }
    }
    let blocks = &system.population.blocks;
    for (number, ty) in system.types.iter().enumerate().filter(|(number, _)| simple[*number]) {
        for leaf in 0..ty.modes.len() {
            found.extend(starts.numbers(number, leaf).iter().find_map(|&agent| {
                let block =
                    blocks.iter().find(|block| (block.first..block.first + block.count).contains(&agent))?;
                Arrival::at_start(system, &of_these, &system.population.agents[agent])?.warning(block.span)
            }));
        }
    }
}

fn has_invariant(claims: &[ClaimSystem]) -> bool {
    claims.iter().any(|claim| claim.kind == ClaimKind::Invariant)
}

/// An agent at the instant at which it begins to flow in a mode.
struct Arrival<'s> {
    system: &'s System,
    number: usize,
    leaf: usize,
    reader: Reader<'s>,
    given: Given,
    /// What is not above zero.
    premises: Vec<FormId>,
    /// Columns of which nothing is known.
    unclear: FxHashSet<Entry>,
    /// The transition that it has just taken without entering its mode anew.
    fired: Option<usize>,
    /// The mode that it has just entered, with all inside.
    entered: Option<usize>,
}

impl<'s> Arrival<'s> {
    fn new(system: &'s System, bounds: &'s Bounds, number: usize, leaf: usize) -> Option<Self> {
        let mode = &system.types[number].modes[leaf];
        let flow = mode.flow.as_ref()?;
        let reader = Reader::new(system, bounds, &flow.frame);
        let (given, premises, unclear) = (Given::default(), Vec::new(), FxHashSet::default());
        Some(Self { system, number, leaf, reader, given, premises, unclear, fired: None, entered: None })
    }

    /// At t = 0.
    fn at_start(system: &'s System, bounds: &'s Bounds, agent: &Instance) -> Option<Self> {
        let (number, leaf) = (agent.ty.index(), agent.mode.index());
        let mut arrival = Self::new(system, bounds, number, leaf)?;
        let ty = &system.types[number];
        let state = |k: usize| Node::State { slot: 0, column: k as u32 };
        let aux = |column: usize| Node::Aux { slot: 0, column: column as u32 };
        let states = agent.states.iter().enumerate().map(|(k, value)| (state(k), *value));
        let params = agent.params.iter().enumerate().map(|(k, value)| (aux(ty.layout.param(k)), *value));
        let discretes =
            agent.discretes.iter().enumerate().map(|(k, value)| (aux(ty.layout.discrete(k)), *value));
        let times = [(Node::Time, 0.0), (aux(Layout::ENTRY), 0.0)];
        for (node, value) in states.chain(params).chain(discretes).chain(times) {
            let value = arrival.reader.forms.constant(value);
            arrival.given.insert(node, value);
        }
        let entries = ty.modes[leaf].active.iter().flat_map(|&mode| &ty.modes[mode].entry.writes);
        arrival.unclear.extend(entries.map(|(_, target)| *target));
        arrival.entered = Some(0);
        Some(arrival)
    }

    /// By transition number k of a type, into this configuration.
    fn by(system: &'s System, bounds: &'s Bounds, number: usize, k: usize, leaf: usize) -> Option<Self> {
        let mut arrival = Self::new(system, bounds, number, leaf)?;
        let ty = &system.types[number];
        if !ty.modes[leaf].active.iter().any(|&mode| has_invariant(&ty.modes[mode].claims)) {
            return None;
        }
        let transition = &ty.transitions[k];
        let effect = effect(ty, transition);
        if effect.stops {
            return None;
        }
        let reader = &mut arrival.reader;
        reader.read_as(&transition.frame, Given::default(), None);
        reader.stay_in(&ty.modes, transition.source);
        if let Some(guard) = guard(transition) {
            for (leaf, interval) in restrictions(&mut Reader::new(system, bounds, &transition.frame), guard) {
                reader.bound(leaf, interval);
            }
            for term in guard.condition.conjuncts() {
                if let Condition::Atom(k) = term
                    && guard.atoms[*k].relation != Relation::Crossing
                {
                    arrival.premises.push(reader.function(guard.atoms[*k].value));
                }
            }
        }
        for step in &effect.own.steps {
            if let ActionStep::Assign { slot: 0, target, value, .. } = step {
                arrival.given.insert(target.leaf(0), reader.function(*value));
            }
        }
        arrival.unclear = effect.unclear;
        arrival.unclear.extend(effect.own.steps.iter().filter_map(|step| match step {
            ActionStep::Draw { slot: 0, target, .. } => Some(*target),
            _ => None,
        }));
        arrival.fired = transition.target.is_none().then_some(k);
        arrival.entered = transition.target.map(|target| target.mode.index());
        Some(arrival)
    }

    /// The warning about an invariant that is broken, having come `way`.
    fn warning(&mut self, way: Span) -> Option<Warning> {
        stand_in(&mut self.reader, self.leaf, &mut self.given);
        let ty = &self.system.types[self.number];
        let mode = &ty.modes[self.leaf];
        let flow = mode.flow.as_ref()?;
        let mut moving = self.given.clone();
        add_rates(&mut self.reader, flow, &mut moving).then_some(())?;
        let claims = mode.active.iter().flat_map(|&mode| &ty.modes[mode].claims);
        let claims = claims.filter(|claim| claim.kind == ClaimKind::Invariant);
        let broken = claims
            .filter(|claim| claim.frame.slots.len() == 1)
            .find(|claim| self.breaks(claim, flow.rates, &moving))?;
        let name = if mode.path.is_empty() { ty.name.clone() } else { format!("{}.{}", ty.name, mode.path) };
        let nothing_else = others(self.system, self.number, self.leaf, self.fired)?
            .into_iter()
            .all(|other| self.waits(other) || self.is_false(other));
        nothing_else.then_some(Warning::Broken { mode: name, claim: broken.span, way })
    }

    /// Whether an invariant is false as soon as time goes on.
    fn breaks(&mut self, claim: &'s ClaimSystem, rates: FunctionId, moving: &Given) -> bool {
        let guard = &claim.violation;
        let mut read = nodes(self.system, guard);
        read.extend(&self.system.functions[rates].outputs);
        let ty = &self.system.types[self.number];
        if !self.unclear.is_disjoint(&reads(self.system, ty, &read)) {
            return false;
        }
        self.reader.read_as(&claim.frame, self.given.clone(), None);
        let alone = alone(guard, &guard.condition);
        holds(&mut self.reader, guard, &guard.condition)
            || alone.into_iter().any(|atom| self.falls(claim, atom, moving))
    }

    /// Whether a comparison of a violation is true as soon as time goes on: it is on its boundary or beyond, and goes further.
    fn falls(&mut self, claim: &'s ClaimSystem, atom: &Atom, moving: &Given) -> bool {
        let [g, rate, _] = derivatives(&mut self.reader, &claim.frame, atom, moving);
        let is_there = self.reader.forms.interval(g).hi <= 0.0
            || self.premises.clone().into_iter().any(|premise| self.follows(g, premise));
        atom.smooth && is_there && self.reader.forms.interval(rate).hi < 0.0
    }

    /// Whether one form is not above zero where another one is not.
    fn follows(&mut self, form: FormId, premise: FormId) -> bool {
        let forms = &mut self.reader.forms;
        let factor = |id: FormId| forms.get(id).terms.first().copied();
        let (Some((a, x)), Some((b, y))) = (factor(form), factor(premise)) else { return false };
        let k = x / y;
        let rest = (a == b && k > 0.0).then(|| forms.plus(form, -k, premise)).flatten();
        rest.is_some_and(|rest| forms.interval(rest).hi <= 0.0)
    }

    /// Whether the condition of a transition is certainly false.
    fn is_false(&mut self, transition: &'s TransitionSystem) -> bool {
        let ty = &self.system.types[self.number];
        self.unclear.is_disjoint(&read_by(self.system, ty, &[transition]))
            && is_false(&mut self.reader, &self.given, transition)
    }

    /// Whether a transition waits for a time that is not this one: since its mode has just been entered.
    fn waits(&mut self, transition: &'s TransitionSystem) -> bool {
        let ty = &self.system.types[self.number];
        let begins = self.entered.is_some_and(|entered| ty.is_inside(transition.source, entered));
        match &transition.trigger {
            Trigger::After { delay, .. } => {
                let read = reads(self.system, ty, &self.system.functions[*delay].outputs);
                self.reader.read_as(&transition.frame, self.given.clone(), None);
                let delay = self.reader.function(*delay);
                let is_later =
                    transition.frame.slots.len() == 1 && self.reader.forms.interval(delay).lo > 0.0;
                begins && is_later && self.unclear.is_disjoint(&read)
            }
            Trigger::Every { .. } => begins,
            Trigger::Rate { .. } => true,
            Trigger::When(_) | Trigger::On { .. } | Trigger::Chance { .. } => false,
        }
    }
}

/// The comparisons that alone make a condition true.
fn alone<'s>(guard: &'s Guard, condition: &'s Condition) -> Vec<&'s Atom> {
    match condition {
        Condition::Atom(k) if guard.atoms[*k].relation != Relation::Crossing => vec![&guard.atoms[*k]],
        Condition::Or(terms) => terms.iter().flat_map(|term| alone(guard, term)).collect(),
        Condition::Atom(_) | Condition::Constant(_) | Condition::Discrete(_) | Condition::And(_) => {
            Vec::new()
        }
        Condition::Exists(_) | Condition::Forall(_) | Condition::Rising(..) => Vec::new(),
    }
}
