//! Transitions and actions of a model: what fires, and what it does.

use super::{BinderId, ExprId, Given, Inside, ModeId, TypeId, VarRef};
use crate::base::Span;
use crate::math::draw::Distribution;

/// A transition of an agent or of an interaction.
#[derive(Clone, Debug)]
pub struct Transition {
    /// As logs call it: `Car.left`, `Bump.pair`, `Car.Cruise->Follow`.
    pub label: String,
    /// The mode it belongs to; the root for agent-level ones and for interactions.
    pub source: ModeId,
    /// When it fires.
    pub trigger: Trigger,
    /// Higher first; 0 if not given.
    pub priority: Option<ExprId>,
    /// Where it leads.
    pub target: Option<Destination>,
    /// What it does.
    pub actions: Vec<Action>,
    /// Agents bound by the guard's outermost `exists` that the actions may name.
    pub witnesses: Vec<BinderId>,
    /// Where it stands.
    pub span: Span,
}

/// Where a change of mode leads: a mode as it is written, and what is entered inside it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Destination {
    /// The mode.
    pub mode: ModeId,
    /// Which of its submodes.
    pub inside: Inside,
}

/// What makes a transition fire.
#[derive(Clone, Debug)]
pub enum Trigger {
    /// `when guard`.
    When(ExprId),
    /// `after delay (when guard)`.
    After(ExprId, Option<ExprId>),
    /// `every period (when guard)`.
    Every(ExprId, Option<ExprId>),
    /// `rate hazard (when guard)`.
    Rate {
        /// The hazard, 1/s.
        rate: ExprId,
        /// None: true.
        guard: Option<ExprId>,
        /// What has to hold: that the hazard is not negative where the guard is true.
        claim: ExprId,
        /// Whether it may change while nothing is written: it reads a state, a rate, the time or a set.
        flows: bool,
    },
    /// `on event (from sender) (when guard)`.
    On {
        /// The events that it hears, by type and number; in order of the types.
        events: Vec<(TypeId, usize)>,
        /// From whom; none: from anybody else.
        from: Option<ExprId>,
        /// None: true.
        guard: Option<ExprId>,
    },
}

/// A step of a list of actions. All right-hand sides of one list read the state before it.
#[derive(Clone, Debug)]
pub enum Action {
    /// `variable := value`; the agent is `SelfAgent` or a `Participant`; the variable a state or a discrete.
    Assign {
        /// Whose.
        agent: ExprId,
        /// Which.
        variable: VarRef,
        /// The new value.
        value: ExprId,
        /// Where it stands.
        span: Span,
    },
    /// `variable ~ distribution`.
    Draw {
        /// Whose.
        agent: ExprId,
        /// Which.
        variable: VarRef,
        /// From what.
        distribution: Distribution,
        /// Its parameters.
        parameters: Vec<ExprId>,
        /// Where it stands.
        span: Span,
    },
    /// `emit event(values) (after delay)`.
    Emit {
        /// Who.
        agent: ExprId,
        /// The number of the event in the agent's type.
        event: usize,
        /// What it carries.
        values: Vec<ExprId>,
        /// None: at once.
        delay: Option<ExprId>,
        /// Where it stands.
        span: Span,
    },
    /// `if condition { } else { }`; `else if` is nested in `otherwise`.
    If {
        /// The test.
        condition: ExprId,
        /// If it holds.
        then: Vec<Action>,
        /// If not.
        otherwise: Vec<Action>,
    },
    /// `a -> Mode` in an interaction.
    Goto {
        /// Which participant.
        participant: usize,
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
    Create(Box<Create>),
    /// Removes an agent, at the end of the micro-step; nothing if the expression is `none`.
    Destroy {
        /// Which.
        agent: ExprId,
        /// Where it stands.
        span: Span,
    },
}

/// `create Type(arguments) in Mode`: what the arguments do not give comes from the type's [`Initials`](super::Initials).
#[derive(Clone, Debug)]
pub struct Create {
    /// The type of the agent.
    pub ty: TypeId,
    /// The leaf mode it starts in.
    pub mode: ModeId,
    /// By parameter, what the argument gives.
    pub params: Vec<Option<Given>>,
    /// By state.
    pub states: Vec<Option<Given>>,
    /// By discrete variable.
    pub discretes: Vec<Option<Given>>,
    /// By link, the agent.
    pub links: Vec<Option<ExprId>>,
    /// Where it stands.
    pub span: Span,
}
