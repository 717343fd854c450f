//! Transitions and actions as equations: what fires, and what it does.

use std::sync::Arc;

use super::{Destination, Distribution, Entry, Frame, FunctionId, Guard, VarRef};
use crate::base::Span;

/// A transition of an agent type or an interaction.
#[derive(Clone, Debug)]
pub struct TransitionSystem {
    /// As logs call it.
    pub label: String,
    /// The mode it belongs to; 0 for interactions.
    pub source: usize,
    /// 0 for interactions, 0 for agent-level transitions, then the depth of the mode.
    pub depth: usize,
    /// Place in the order of declaration over the whole program.
    pub declaration: usize,
    /// One output; none: 0.
    pub priority: Option<FunctionId>,
    /// When it fires.
    pub trigger: Trigger,
    /// Where it leads.
    pub target: Option<Destination>,
    /// What it does; shares the transition's frame.
    pub actions: ActionList,
    /// The agents that guard, priority and actions read.
    pub frame: Frame,
    /// Slots of the guard's outermost `exists` binders that actions may read.
    pub witnesses: Vec<usize>,
    /// Where it stands.
    pub span: Span,
}

/// What makes a transition fire.
#[derive(Clone, Debug)]
pub enum Trigger {
    /// The guard alone.
    When(Guard),
    /// Age at least `delay` (one output, s, read at entry), and the guard.
    After {
        /// s.
        delay: FunctionId,
        /// None: true.
        guard: Option<Guard>,
    },
    /// At entry + k period (one output, s, read at entry) if the guard holds then.
    Every {
        /// s.
        period: FunctionId,
        /// None: true.
        guard: Option<Guard>,
    },
    /// When nothing is left of a hazard: of a number drawn on entry and after each firing, from which the hazard is taken
    /// away while the guard is true.
    Rate {
        /// Which hazard of its type.
        hazard: usize,
        /// Which stream of random numbers.
        stream: usize,
        /// That nothing is left.
        due: Guard,
        /// Written to the gate of the hazard. None: true.
        guard: Option<Guard>,
    },
    /// Of an interaction, of this hazard (one output, 1/s). Where it is constant between writes: after a time drawn from the exponential
    /// distribution of this rate, drawn anew whenever the guard becomes true, the rate changes, or it has fired. Where it flows: as a
    /// `Rate`, but what is left is a state of nobody.
    Chance {
        /// 1/s.
        rate: FunctionId,
        /// Whether it may change while nothing is written.
        flows: bool,
        /// None: true.
        guard: Option<Guard>,
    },
    /// By a message, if the guard holds at its turn.
    On {
        /// The events that it hears, by type and number.
        events: Vec<(usize, usize)>,
        /// From whom.
        from: Sender,
        /// None: true.
        guard: Option<Guard>,
    },
}

/// Whose messages are heard.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sender {
    /// Those of everybody else.
    Others,
    /// Those of the agent in a slot; only if that is slot 0 also one's own.
    Slot(usize),
}

/// Actions; all right-hand sides read the state before the list.
#[derive(Clone, Debug, Default)]
pub struct ActionList {
    /// The agents they read (that of the transition, or for entry and exit their own).
    pub frame: Frame,
    /// The steps.
    pub steps: Vec<ActionStep>,
    /// Every (slot, variable) that some branch writes, sorted, without duplicates.
    pub writes: Vec<(usize, Entry)>,
}

/// A step of a list of actions.
#[derive(Clone, Debug)]
pub enum ActionStep {
    /// Writes one output.
    Assign {
        /// Whose column.
        slot: usize,
        /// Which column.
        target: Entry,
        /// One output.
        value: FunctionId,
        /// Where it stands.
        span: Span,
    },
    /// Writes a number drawn at random.
    Draw {
        /// Whose column.
        slot: usize,
        /// Which column.
        target: Entry,
        /// From what.
        distribution: Distribution,
        /// Its parameters, one output each.
        parameters: Vec<FunctionId>,
        /// Which of the streams of the agent's type.
        stream: usize,
        /// Where it stands.
        span: Span,
    },
    /// Sends a message.
    Emit {
        /// Who.
        slot: usize,
        /// The number of the event in the sender's type.
        event: usize,
        /// What it carries, one output each.
        values: Vec<FunctionId>,
        /// One output, s; none: at once.
        delay: Option<FunctionId>,
        /// Where it stands.
        span: Span,
    },
    /// A choice.
    If {
        /// The test.
        condition: Guard,
        /// If it holds.
        then: Vec<ActionStep>,
        /// If not.
        otherwise: Vec<ActionStep>,
    },
    /// The agent in the slot changes mode.
    Goto {
        /// Who.
        slot: usize,
        /// Into which mode.
        target: Destination,
        /// Where it stands.
        span: Span,
    },
    /// Ends the run.
    Stop {
        /// Why.
        reason: Option<String>,
        /// Where it stands.
        span: Span,
    },
    /// Makes an agent, at the end of the micro-step.
    Create(Arc<Birth>),
    /// Removes the agent in the slot, if there is one, at the end of the micro-step.
    Destroy {
        /// Who.
        slot: usize,
        /// Where it stands.
        span: Span,
    },
}

/// What the agents of a type start with, where they are not given anything else: what is declared, in an order in which each
/// finds what it reads; parameters first.
#[derive(Clone, Debug, Default)]
pub struct Initials {
    /// Reads the agent that is made, as far as it is.
    pub frame: Frame,
    /// What each variable starts with.
    pub values: Vec<(VarRef, Source)>,
}

/// Where the value of a variable comes from when its agent is made.
#[derive(Clone, Debug)]
pub enum Source {
    /// One output.
    Number(FunctionId),
    /// A random number.
    Draw {
        /// How it is distributed.
        distribution: Distribution,
        /// One output each.
        parameters: Vec<FunctionId>,
        /// Where it stands.
        span: Span,
    },
}

/// How an agent is made by an action.
#[derive(Clone, Debug)]
pub struct Birth {
    /// Its type.
    pub ty: usize,
    /// The leaf mode it starts in.
    pub mode: usize,
    /// What it is given, by functions of the list's frame.
    pub given: Vec<(VarRef, Source)>,
    /// The links that it is given: number of the link, slot of the agent that it leads to; none: to nobody.
    pub links: Vec<(usize, Option<usize>)>,
    /// Where it stands.
    pub span: Span,
}
