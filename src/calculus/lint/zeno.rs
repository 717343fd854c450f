//! Transitions that come ever faster, infinitely many of them within a finite time (HY0627).
//!
//! Three kinds are known. A rebound: what is compared is driven to its boundary and even at rest pushed beyond it, and the transition
//! turns its rate back with a part of its size (a ball that bounces). A delay that each firing makes shorter by a factor. Two modes,
//! each of which lowers one quantity and raises another, and on the whole loses more than it gains (two tanks, one inflow). Not
//! reported if anything else may happen to the agent on the way, if an action may end the run or remove agents, or if the run ends
//! before for everybody who starts there.

use crate::calculus::bounds::{Bounds, REAL};
use crate::calculus::graph::Node;
use crate::calculus::lint::Warning;
use crate::calculus::lint::certain::{holds, is_false};
use crate::calculus::lint::effects::{effect, entered, may_end, nodes, plain_guard, reads, with_params};
use crate::calculus::lint::flowing::{Given, add_rates, derivatives, others, stand_in};
use crate::calculus::lint::starts::Starts;
use crate::calculus::reader::Reader;
use crate::calculus::system::{
    ActionStep, AgentSystem, Atom, Condition, Entry, Flow, Instance, System, TransitionSystem, Trigger,
};
use crate::math::Interval;

/// Between which rates what bounces is nearly at rest.
const SLOW: [f64; 2] = [1e-12, 1e-9];

/// What is lost must be more than what is gained by this share.
const SHARE: f64 = 1e-9;

/// When infinitely many firings are over, s; infinite if that cannot be told.
type Limit = f64;

/// Looks at every transition.
pub fn transitions(system: &System, bounds: &Bounds, starts: &Starts, found: &mut Vec<Warning>) {
    if may_end(system) {
        return;
    }
    let of_these = with_params(system, bounds);
    let until = system.run.until.unwrap_or(f64::INFINITY);
    for (number, ty) in system.types.iter().enumerate().filter(|(_, ty)| ty.regions.len() == 1) {
        for (k, transition) in ty.transitions.iter().enumerate() {
            let Some(leaf) = entered(ty, transition).filter(|&leaf| ty.modes[leaf].flow.is_some()) else {
                continue;
            };
            let begin = starts.in_mode(system, number, transition.source);
            let earliest = |limit: &dyn Fn(Agent) -> Option<Limit>| {
                let agent = |start| Agent { system, bounds: &of_these, number, start };
                if begin.is_empty() {
                    return limit(agent(None)).map(|_| f64::INFINITY);
                }
                let limits = begin.iter().filter_map(|start| limit(agent(Some(start))));
                limits.filter(|&at| at <= until || at == f64::INFINITY).reduce(f64::min)
            };
            let (label, span) = (transition.label.clone(), transition.span);
            if leaf == transition.source {
                if let Some(at) = earliest(&|agent| agent.rebounds(k)) {
                    found.push(Warning::Rebound { label, span, at });
                } else if let Some(at) = earliest(&|agent| agent.hurries(k)) {
                    found.push(Warning::Hurries { label, span, at });
                }
                continue;
            }
            let leads_back = |&back: &usize| entered(ty, &ty.transitions[back]) == Some(transition.source);
            for back in ty.modes[leaf].transitions.iter().copied().filter(leads_back) {
                // Once for the two: from where agents start.
                let from_here = !begin.is_empty() || starts.numbers(number, leaf).is_empty() && back > k;
                if from_here && let Some(at) = earliest(&|agent| agent.runs_dry([k, back])) {
                    let back = &ty.transitions[back];
                    let labels = [label.clone(), back.label.clone()];
                    found.push(Warning::RunsDry { labels, spans: [span, back.span], at });
                }
            }
        }
    }
}

/// The agents of a type, or one of them from its start on.
#[derive(Clone, Copy)]
struct Agent<'s> {
    system: &'s System,
    bounds: &'s Bounds,
    number: usize,
    start: Option<&'s Instance>,
}

impl<'s> Agent<'s> {
    fn ty(self) -> &'s AgentSystem {
        &self.system.types[self.number]
    }

    /// A reader of a transition, in its mode; parameters are numbers where they are known.
    fn reader(self, transition: &'s TransitionSystem) -> (Reader<'s>, Given) {
        let mut reader = Reader::new(self.system, self.bounds, &transition.frame);
        let mut given = Given::default();
        let ty = self.ty();
        for k in 0..ty.params.len() {
            let column = ty.layout.param(k);
            let known = match self.start {
                Some(start) => Interval::point(start.params[k]),
                None => self.bounds.aux[self.number][column],
            };
            if known.is_point() {
                let node = Node::Aux { slot: 0, column: column as u32 };
                given.insert(node, reader.forms.constant(known.lo));
            }
        }
        stand_in(&mut reader, transition.source, &mut given);
        reader.read_as(&transition.frame, given.clone(), None);
        (reader, given)
    }

    /// What a form that is linear in one column of the agent is at the start; not a number if that is not known.
    fn at_start(self, (leaf, factor, constant): (Node, f64, f64)) -> f64 {
        let ty = self.ty();
        let value = self.start.and_then(|start| match leaf {
            Node::State { column, .. } => start.states.get(column as usize).copied(),
            Node::Aux { column, .. } => {
                let k = (column as usize).checked_sub(ty.layout.discrete(0));
                let param = (column as usize).checked_sub(ty.layout.param(0));
                let discrete = k.and_then(|k| start.discretes.get(k));
                discrete.or(param.and_then(|k| start.params.get(k))).copied()
            }
            _ => None,
        });
        let enters = self.start.is_some_and(|start| {
            ty.modes[start.mode.index()].active.iter().any(|&mode| !ty.modes[mode].entry.steps.is_empty())
        });
        if enters { f64::NAN } else { value.map_or(f64::NAN, |value| factor * value + constant) }
    }

    /// Whether nothing but a transition can happen in its mode.
    fn is_alone(self, reader: &mut Reader<'s>, given: &Given, k: usize) -> bool {
        let leaf = self.ty().transitions[k].source;
        others(self.system, self.number, leaf, Some(k)).is_some_and(|others| {
            let never = |other: &'s TransitionSystem| {
                matches!(other.trigger, Trigger::When(_)) && is_false(reader, given, other)
            };
            others.into_iter().all(never)
        })
    }

    /// When a transition has turned back, each time with a part of its rate, what is pushed on at rest.
    fn rebounds(self, k: usize) -> Option<Limit> {
        let transition = &self.ty().transitions[k];
        let guard = plain_guard(transition).filter(|_| transition.frame.slots.len() == 1)?;
        let terms = guard.condition.conjuncts();
        terms.iter().enumerate().find_map(|(number, term)| match term {
            Condition::Atom(surface) if guard.atoms[*surface].smooth => {
                let rest = terms.iter().enumerate().filter(|(other, _)| *other != number);
                self.rebounds_from(k, &guard.atoms[*surface], rest.map(|(_, term)| term).collect())
            }
            _ => None,
        })
    }

    /// The same, from where this comparison is on its boundary, if the rest of the condition is true there.
    fn rebounds_from(self, k: usize, atom: &'s Atom, rest: Vec<&'s Condition>) -> Option<Limit> {
        let ty = self.ty();
        let transition = &ty.transitions[k];
        let (guard, flow) = (plain_guard(transition)?, ty.modes[transition.source].flow.as_ref()?);
        let (mut reader, given) = self.reader(transition);
        let mut moving = given.clone();
        add_rates(&mut reader, flow, &mut moving).then_some(())?;
        let [g, rate, _] = derivatives(&mut reader, &transition.frame, atom, &moving);
        let place @ (x, factor, constant) = reader.forms.as_leaf(g)?;
        let speed @ (v, of_speed, 0.0) = reader.forms.as_leaf(rate)? else { return None };
        (matches!((x, v), (Node::State { .. }, Node::State { .. })) && x != v).then_some(())?;
        let boundary = -constant / factor;
        let part = -self.kept(&mut reader, &given, transition, v)?;
        let stays = match self.written(&mut reader, &given, transition, x) {
            None => true,
            Some(value) => value == (x, 0.0, boundary),
        };
        (0.0 < part && part < 1.0 && stays && self.keeps(transition, flow, [x, v])).then_some(())?;
        // Wherever it is on its side.
        let mut flying = given.clone();
        let beyond =
            if factor > 0.0 { Interval::new(boundary, REAL.hi) } else { Interval::new(REAL.lo, boundary) };
        flying.insert(x, reader.forms.leaf(Node::State { slot: u32::MAX, column: 0 }, beyond));
        let mut pushed = flying.clone();
        add_rates(&mut reader, flow, &mut pushed).then_some(())?;
        let [_, _, push] = derivatives(&mut reader, &transition.frame, atom, &pushed);
        let push = -reader.forms.interval(push).hi;
        (push > 0.0 && self.is_alone(&mut reader, &flying, k)).then_some(())?;
        // Nearly at rest on the boundary, coming down.
        let mut resting = given;
        let [least, most] = SLOW;
        let slow = if of_speed > 0.0 { Interval::new(-most, -least) } else { Interval::new(least, most) };
        resting.insert(x, reader.forms.constant(boundary));
        resting.insert(v, reader.forms.leaf(Node::State { slot: u32::MAX, column: 1 }, slow));
        reader.read_as(&transition.frame, resting, None);
        rest.into_iter().all(|term| holds(&mut reader, guard, term)).then_some(())?;
        // Down, and then up and down again with a part of the speed; pushed more it is sooner.
        let (start, rate) = (self.at_start(place), self.at_start(speed));
        let impact = (rate * rate + 2.0 * push * start).sqrt();
        (start > 0.0 || start.is_nan()).then_some(())?;
        Some(or_unknown((rate + impact + 2.0 * impact * part / (1.0 - part)) / push))
    }

    /// Whether a transition writes nothing but these that its condition or the flow reads, and these in any case.
    fn keeps(self, transition: &TransitionSystem, flow: &Flow, but: [Node; 2]) -> bool {
        let ty = self.ty();
        let mut roots = plain_guard(transition).map_or_else(Vec::new, |guard| nodes(self.system, guard));
        roots.extend(&self.system.functions[flow.rates].outputs);
        let read = reads(self.system, ty, &roots);
        let effect = effect(ty, transition);
        let is_own = |entry: &Entry| but.contains(&entry.leaf(0));
        let draws = transition
            .actions
            .steps
            .iter()
            .any(|step| matches!(step, ActionStep::Draw { target, .. } if read.contains(target)));
        let mut others = effect.writes.iter().filter(|entry| !is_own(entry));
        !effect.stops
            && !draws
            && effect.unclear.is_disjoint(&read)
            && others.all(|entry| !read.contains(entry))
    }

    /// What the actions of a transition leave of a column: its new value as a part of its old one.
    fn kept(
        self,
        reader: &mut Reader<'s>,
        given: &Given,
        transition: &'s TransitionSystem,
        column: Node,
    ) -> Option<f64> {
        match self.written(reader, given, transition, column)? {
            (leaf, part, 0.0) if leaf == column => Some(part),
            _ => None,
        }
    }

    /// The value that the actions of a transition give a column: leaf, factor, constant; a constant is 0 times the column.
    fn written(
        self,
        reader: &mut Reader<'s>,
        given: &Given,
        transition: &'s TransitionSystem,
        column: Node,
    ) -> Option<(Node, f64, f64)> {
        let value = transition.actions.steps.iter().find_map(|step| match step {
            ActionStep::Assign { slot: 0, target, value, .. } if target.leaf(0) == column => Some(*value),
            _ => None,
        })?;
        reader.read_as(&transition.frame, given.clone(), None);
        let form = reader.function(value);
        match reader.forms.as_constant(form) {
            Some(constant) => Some((column, 0.0, constant)),
            None => reader.forms.as_leaf(form),
        }
    }

    /// When a transition into its own mode has waited, each time for a part of the time before.
    fn hurries(self, k: usize) -> Option<Limit> {
        let transition = &self.ty().transitions[k];
        let Trigger::After { delay, guard: None } = transition.trigger else { return None };
        let again = transition.target.is_some() && !effect(self.ty(), transition).stops;
        (again && transition.frame.slots.len() == 1).then_some(())?;
        let (mut reader, given) = self.reader(transition);
        let delay = reader.function(delay);
        let delay @ (column @ Node::Aux { slot: 0, .. }, _, 0.0) = reader.forms.as_leaf(delay)? else {
            return None;
        };
        let part = self.kept(&mut reader, &given, transition, column)?;
        let shrinks = 0.0 < part && part < 1.0 && self.is_alone(&mut reader, &given, k);
        shrinks.then(|| or_unknown(self.at_start(delay) / (1.0 - part)))
    }

    /// When two transitions have led back and forth, each taken when a quantity has run dry that the other mode fills, and both
    /// modes together lose more than they gain.
    fn runs_dry(self, both: [usize; 2]) -> Option<Limit> {
        let ty = self.ty();
        let transitions = both.map(|k| &ty.transitions[k]);
        let mut atoms = Vec::new();
        for transition in transitions {
            let guard = plain_guard(transition).filter(|_| transition.frame.slots.len() == 1)?;
            let Condition::Atom(0) = guard.condition else { return None };
            atoms.push(&guard.atoms[0]);
        }
        let read: Vec<_> = atoms.iter().map(|atom| self.system.functions[atom.value].outputs[0]).collect();
        let read = reads(self.system, ty, &read);
        let (mut rates, mut first) = ([[Interval::WHOLE; 2]; 2], [f64::NAN; 2]);
        for (transition, (&k, rates)) in transitions.iter().zip(both.iter().zip(&mut rates)) {
            let effect = effect(ty, transition);
            (!effect.stops && effect.writes.is_disjoint(&read)).then_some(())?;
            let (mut reader, given) = self.reader(transition);
            self.is_alone(&mut reader, &given, k).then_some(())?;
            let mut moving = given;
            add_rates(&mut reader, ty.modes[transition.source].flow.as_ref()?, &mut moving).then_some(())?;
            for ((atom, of), (known, first)) in
                atoms.iter().zip(transitions).zip(rates.iter_mut().zip(&mut first))
            {
                let [g, rate, _] = derivatives(&mut reader, &of.frame, atom, &moving);
                *known = reader.forms.interval(rate);
                *first = reader.forms.as_leaf(g).map_or(f64::NAN, |g| self.at_start(g));
            }
            let (own, other) = if k == both[0] { (rates[0], rates[1]) } else { (rates[1], rates[0]) };
            (REAL.lo < own.lo && own.hi < 0.0 && other.lo > 0.0).then_some(())?;
        }
        let [[a_in_a, b_in_a], [a_in_b, b_in_b]] = rates;
        // With some weight w on b the sum falls in both modes: a' + w b' < 0.
        let lost = a_in_a.hi * b_in_b.hi - a_in_b.hi * b_in_a.hi;
        (lost > SHARE * a_in_b.hi * b_in_a.hi).then_some(())?;
        // The times in the two modes after which both are zero.
        let [a, b] = first;
        let times = [b * a_in_b.hi - a * b_in_b.hi, a * b_in_a.hi - b * a_in_a.hi];
        Some(or_unknown((times[0] + times[1]) / lost))
    }
}

/// A time that is known, or infinity.
fn or_unknown(time: f64) -> Limit {
    if time >= 0.0 { time } else { f64::INFINITY }
}
