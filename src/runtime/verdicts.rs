//! What is known of the properties of a run so far, and what they come to.

use crate::base::Span;
use crate::codegen::program::{ClaimKind, ClaimSystem, Condition, Formula, Program, Property};
use crate::runtime::guards::{Guards, Origin};
use crate::runtime::lookout::Lookout;
use crate::runtime::margins::{Margins, Spot, When};
use crate::runtime::observe::Verdict;
use crate::runtime::robustness::{Extreme, Robustness};
use crate::runtime::signal::{Piece, greatest, greatest_ahead, turned, until_ahead};
use crate::runtime::solve::time_resolution;

/// A margin at the time at which it is an extreme.
#[derive(Clone, Debug)]
pub struct Found {
    /// The margin.
    pub margin: Robustness,
    /// When, s.
    pub time: f64,
    /// Who decides it.
    agents: Vec<(String, String)>,
}

impl Found {
    /// The margin of a spot.
    pub fn new(margins: &mut Margins<'_, '_>, spot: &Spot, time: f64, when: When) -> Self {
        Self { margin: margins.robustness(spot, when), time, agents: margins.bound_agents(spot) }
    }
}

/// What is watched of one property.
#[derive(Clone, Debug)]
pub enum Watched {
    /// The extreme of a condition over a window.
    Extreme {
        /// Which.
        extreme: Extreme,
        /// The number of the condition.
        condition: usize,
        /// From when to when, s.
        window: [f64; 2],
        /// The extreme so far.
        found: Option<Found>,
        /// Who may come to decide it, if the condition is a quantifier that has this extreme.
        lookout: Option<Lookout>,
    },
    /// A goal within a window, and a condition before.
    Until {
        /// The number of the condition before.
        before: usize,
        /// The number of the goal.
        goal: usize,
        /// From when to when, s.
        window: [f64; 2],
        /// The least margin of the condition before so far.
        least: Option<Found>,
        /// The greatest margin so far.
        found: Option<Found>,
    },
    /// Windows within windows.
    Nested {
        /// What each looks for, and over which window, outermost first.
        operators: Vec<(Extreme, [f64; 2])>,
        /// What they are over.
        inner: Inner,
    },
}

/// What stands inside windows within windows: conditions by number, with their margins so far.
#[derive(Clone, Debug)]
pub enum Inner {
    /// A condition.
    Holds(usize, Trace),
    /// A condition until another one.
    Until {
        /// What holds before, and the goal.
        pair: [(usize, Trace); 2],
        /// From when to when, s from now.
        window: [f64; 2],
    },
}

impl Inner {
    /// Its conditions, with what has been seen of them.
    pub fn traces(&mut self) -> Vec<(usize, &mut Trace)> {
        match self {
            Inner::Holds(condition, trace) => vec![(*condition, trace)],
            Inner::Until { pair, .. } => {
                pair.iter_mut().map(|(condition, trace)| (*condition, trace)).collect()
            }
        }
    }

    /// The end of its window, s from now.
    pub fn ahead(&self) -> f64 {
        match self {
            Inner::Holds(..) => 0.0,
            Inner::Until { window, .. } => window[1],
        }
    }

    /// The margin at every time.
    fn signal(&self) -> Vec<Piece> {
        match self {
            Inner::Holds(_, trace) => trace.pieces.clone(),
            Inner::Until { pair: [before, goal], window } => {
                until_ahead(&before.1.pieces, &goal.1.pieces, *window)
            }
        }
    }

    /// Who decides the margin, which at a time of one of its conditions is this.
    fn decider(&self, time: f64, margin: Robustness) -> Option<&Decider> {
        match self {
            Inner::Holds(_, trace) => trace.decider(time, margin),
            Inner::Until { pair: [(_, before), (_, goal)], .. } => {
                let decides = if before.miss(time, margin) < goal.miss(time, margin) { before } else { goal };
                decides.decider(time, margin)
            }
        }
    }
}

/// The margin of a condition so far.
#[derive(Clone, Debug, Default)]
pub struct Trace {
    /// By pieces.
    pub pieces: Vec<Piece>,
    /// Who decides it, in order of time.
    pub deciders: Vec<Decider>,
}

/// Who decides a margin.
#[derive(Clone, Debug, PartialEq)]
pub struct Decider {
    /// From when on, s.
    pub from: f64,
    /// Whether it is closed where it is zero.
    pub closed: bool,
    /// The agents.
    pub agents: Vec<(String, String)>,
}

/// All properties of a run.
#[derive(Debug, Default)]
pub struct Monitors<'p> {
    /// Each with what is watched of it.
    pub properties: Vec<(&'p Property, Watched)>,
    /// The condition of each number, with its instance.
    pub conditions: Vec<(u32, &'p ClaimSystem)>,
    /// Up to when they have been watched, s.
    pub done: f64,
}

impl<'p> Monitors<'p> {
    /// Nothing watched yet.
    pub fn new(program: &'p Program, guards: &Guards<'p>) -> Self {
        let of_property = |instance: u32| match guards.definition(instance).origin {
            Origin::Claim(claim) if claim.kind == ClaimKind::Property => Some((instance, claim)),
            _ => None,
        };
        let properties = program.properties();
        let instances = if properties.is_empty() { 0 } else { guards.instances.len() as u32 };
        let conditions: Vec<(u32, &ClaimSystem)> = (0..instances).filter_map(of_property).collect();
        let watched = |property: &'p Property| {
            let mut watched = watched(&property.formula);
            if let Watched::Extreme { extreme, condition, lookout, .. } = &mut watched {
                *lookout = lookout_for(guards, conditions[*condition], *extreme);
            }
            (property, watched)
        };
        Self { properties: properties.iter().map(watched).collect(), conditions, done: 0.0 }
    }

    /// Something that may be read of these agents was written, or they are new.
    pub fn doubt(&mut self, agents: &[usize], ty_of: impl Fn(usize) -> usize) {
        for (_, watched) in &mut self.properties {
            if let Watched::Extreme { lookout: Some(lookout), .. } = watched {
                let ty = lookout.ty;
                let members = agents.iter().filter(|&&agent| ty_of(agent) == ty);
                members.for_each(|&member| lookout.doubt(member));
            }
        }
    }

    /// What the properties came to.
    pub fn verdicts(&self) -> Vec<Verdict> {
        self.properties.iter().map(|(property, watched)| verdict(property, watched)).collect()
    }
}

/// What is to be watched of a formula.
fn watched(formula: &Formula) -> Watched {
    let mut operators: Vec<(Extreme, [f64; 2])> = Vec::new();
    let mut formula = formula;
    loop {
        let (extreme, window, inner) = match formula {
            Formula::Always(window, inner) => (Extreme::Least, window, inner),
            Formula::Eventually(window, inner) => (Extreme::Greatest, window, inner),
            Formula::Until { before, window, goal } => return until(operators, [*before, *goal], *window),
            Formula::Holds(condition) => return over(operators, *condition),
        };
        match operators.last_mut() {
            // Of the same twice the windows add up.
            Some((outer, sum)) if *outer == extreme => (0..2).for_each(|k| sum[k] += window[k]),
            _ => operators.push((extreme, *window)),
        }
        formula = inner;
    }
}

/// Operators, outermost first, over a condition.
fn over(operators: Vec<(Extreme, [f64; 2])>, condition: usize) -> Watched {
    match operators[..] {
        [] => extreme(Extreme::Least, condition, [0.0; 2]),
        [(which, window)] => extreme(which, condition, window),
        [..] => Watched::Nested { operators, inner: Inner::Holds(condition, Trace::default()) },
    }
}

fn extreme(extreme: Extreme, condition: usize, window: [f64; 2]) -> Watched {
    Watched::Extreme { extreme, condition, window, found: None, lookout: None }
}

/// For whom to look out where a condition is a quantifier that has over its members the extreme that is looked for over time: its
/// body reads nobody but whom it binds and whom links lead to from there.
fn lookout_for(
    guards: &Guards<'_>,
    (instance, claim): (u32, &ClaimSystem),
    extreme: Extreme,
) -> Option<Lookout> {
    let (picked, quantified) = match &claim.violation.condition {
        Condition::Forall(quantified) => (Extreme::Least, quantified),
        Condition::Exists(quantified) => (Extreme::Greatest, quantified),
        _ => return None,
    };
    let is_plain = guards.definition(instance).folds.is_empty()
        && claim.violation.n_rising == 0
        && !quantified.body.quantifies();
    (picked == extreme && is_plain).then(|| Lookout::new(quantified.ty))
}

/// Operators, outermost first, over a condition until another one.
fn until(operators: Vec<(Extreme, [f64; 2])>, [before, goal]: [usize; 2], window: [f64; 2]) -> Watched {
    if operators.is_empty() {
        return Watched::Until { before, goal, window, least: None, found: None };
    }
    let pair = [before, goal].map(|condition| (condition, Trace::default()));
    Watched::Nested { operators, inner: Inner::Until { pair, window } }
}

impl Trace {
    /// Who decides at a time at which the margin is this: the last one, or one who ends there, if it is zero on the other's side.
    fn decider(&self, time: f64, margin: Robustness) -> Option<&Decider> {
        let number_at = |t: f64| self.deciders.partition_point(|decider| decider.from <= t);
        let last = number_at(time).checked_sub(1)?;
        let width = time_resolution(time);
        let near = number_at(time - width).saturating_sub(1)..number_at(time + width);
        let mut same = self.deciders[near].iter().rev().filter(|decider| decider.closed == margin.closed);
        if margin.is_zero() && self.deciders[last].closed != margin.closed {
            return same.next().or(self.deciders.get(last));
        }
        self.deciders.get(last)
    }

    /// By how much it misses a margin at a time; first of all by the side at which it is zero.
    fn miss(&self, time: f64, margin: Robustness) -> f64 {
        let here = self.pieces.iter().filter(|piece| piece.start <= time && time <= piece.end);
        let miss = |piece: &Piece| match piece.at(time) {
            _ if margin.is_zero() && piece.closed != margin.closed => f64::INFINITY,
            value if value == margin.value => 0.0,
            value => (value - margin.value).abs(),
        };
        here.map(miss).fold(f64::INFINITY, f64::min)
    }
}

/// The value of the operators over what stands inside at t = 0.
fn found_of(operators: &[(Extreme, [f64; 2])], inner: &Inner) -> Option<Found> {
    let mut signal = inner.signal();
    for (extreme, window) in operators[1..].iter().rev() {
        signal = match extreme {
            Extreme::Greatest => greatest_ahead(&signal, *window),
            Extreme::Least => turned(&greatest_ahead(&turned(&signal), *window)),
        };
    }
    let (extreme, window) = operators[0];
    if extreme == Extreme::Least {
        signal = turned(&signal);
    }
    let top = greatest(&signal, window)?;
    let time = top.origin.time(top.time);
    let margin = if extreme == Extreme::Least { top.margin.turned() } else { top.margin };
    let agents = inner.decider(time, margin)?.agents.clone();
    Some(Found { margin, time, agents })
}

fn verdict(property: &Property, watched: &Watched) -> Verdict {
    let (found, nothing) = match watched {
        // Over an empty window `always` holds, and `eventually` does not.
        Watched::Extreme { extreme, found, .. } => (found.clone(), extreme.neutral()),
        Watched::Until { found, .. } => (found.clone(), f64::NEG_INFINITY),
        Watched::Nested { operators, inner } => (found_of(operators, inner), operators[0].0.neutral()),
    };
    let (name, span): (String, Span) = (property.name.clone(), property.span);
    let Some(found) = found else {
        return Verdict { name, span, holds: nothing > 0.0, margin: nothing, time: None, agents: Vec::new() };
    };
    let margin = if found.margin.is_zero() { 0.0 } else { found.margin.value };
    let (holds, time) = (found.margin.holds(), Some(found.time));
    Verdict { name, span, holds, margin, time, agents: found.agents }
}
