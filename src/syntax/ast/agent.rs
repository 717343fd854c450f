//! Agent types: variables, links, events, regions, modes, flows and transitions.

use super::{Actions, Expr, Formal, Let, Name, Text, TypeName};
use crate::base::Span;

/// An agent type.
#[derive(Clone, Debug, PartialEq)]
pub struct Agent {
    /// Its name.
    pub name: Name,
    /// Its formal parameters.
    pub formals: Vec<Formal>,
    /// What its braces hold, in order.
    pub items: Vec<AgentItem>,
    /// The whole item.
    pub span: Span,
}

/// What an agent's braces hold.
#[derive(Clone, Debug, PartialEq)]
pub enum AgentItem {
    /// `state x, y` or `discrete lane: int`
    Variables(Variables),
    /// `link lead = nearest ...`
    Link(Box<Link>),
    /// `event braking`
    Event(Box<Event>),
    /// A set of modes in parallel to others.
    Region(Box<Region>),
    /// What modes may hold too.
    Body(BodyItem),
}

/// One `state` or `discrete` line.
#[derive(Clone, Debug, PartialEq)]
pub struct Variables {
    /// How the variables behave in time.
    pub kind: VariableKind,
    /// The variables.
    pub variables: Vec<Variable>,
    /// The whole line.
    pub span: Span,
}

/// How a variable behaves in time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VariableKind {
    /// `state`: continuous, moved by a flow.
    State,
    /// `discrete`: constant between events.
    Discrete,
}

/// One variable, `x: real [m] = 0`.
#[derive(Clone, Debug, PartialEq)]
pub struct Variable {
    /// Its name.
    pub name: Name,
    /// Its declared type.
    pub ty: Option<Box<TypeName>>,
    /// Its initial value.
    pub initial: Option<Given>,
    /// The whole declaration.
    pub span: Span,
}

/// A value given by `=` or drawn by `~`.
#[derive(Clone, Debug, PartialEq)]
pub struct Given {
    /// Which of the two.
    pub kind: GivenKind,
    /// The value, or the distribution.
    pub value: Expr,
}

/// How a value is given.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GivenKind {
    /// `= value`, in actions `:= value`
    Value,
    /// `~ distribution`
    Draw,
}

/// A reference to an agent, `link lead: Car = expr`.
#[derive(Clone, Debug, PartialEq)]
pub struct Link {
    /// Its name.
    pub name: Name,
    /// The agent type that it refers to.
    pub target: Option<Name>,
    /// The expression that the runtime keeps up to date.
    pub value: Option<Expr>,
    /// The whole declaration.
    pub span: Span,
}

/// `event braking(how: real)`
#[derive(Clone, Debug, PartialEq)]
pub struct Event {
    /// Its name.
    pub name: Name,
    /// What it carries.
    pub formals: Vec<Formal>,
    /// The whole declaration.
    pub span: Span,
}

/// A region: modes that are active in parallel to those of other regions.
#[derive(Clone, Debug, PartialEq)]
pub struct Region {
    /// Its name.
    pub name: Name,
    /// What its braces hold.
    pub items: Vec<BodyItem>,
    /// The whole region.
    pub span: Span,
}

/// What the braces of an agent, a mode and a region may hold.
#[derive(Clone, Debug, PartialEq)]
pub enum BodyItem {
    /// `let gap = ...`
    Let(Box<Let>),
    /// `flow { x' = v }`
    Flow(Flow),
    /// `invariant v >= 0 "why"`
    Invariant(Box<Claim>),
    /// `assert gap > 0 "why"`
    Assert(Box<Claim>),
    /// `mode Brake { ... }`
    Mode(Box<Mode>),
    /// `entry { ... }`
    Entry(Actions),
    /// `exit { ... }`
    Exit(Actions),
    /// `leave: when ... -> ... { ... }`
    Transition(Box<Transition>),
}

/// `flow { x' = v }`
#[derive(Clone, Debug, PartialEq)]
pub struct Flow {
    /// Its equations, in order.
    pub equations: Vec<FlowEquation>,
    /// The whole flow.
    pub span: Span,
}

/// One differential equation, `x' = v`.
#[derive(Clone, Debug, PartialEq)]
pub struct FlowEquation {
    /// The state whose rate it gives.
    pub state: Name,
    /// The rate.
    pub rate: Expr,
    /// The whole equation.
    pub span: Span,
}

/// The condition of an `invariant` or an `assert`.
#[derive(Clone, Debug, PartialEq)]
pub struct Claim {
    /// What should hold.
    pub condition: Expr,
    /// What to say when it does not.
    pub message: Option<Text>,
    /// The whole claim.
    pub span: Span,
}

/// A mode, with what holds in it and the modes inside it.
#[derive(Clone, Debug, PartialEq)]
pub struct Mode {
    /// Its name.
    pub name: Name,
    /// The word `initial`, if it stands there.
    pub initial: Option<Span>,
    /// What its braces hold.
    pub items: Vec<BodyItem>,
    /// The whole mode.
    pub span: Span,
}

/// `jam: when gap <= s priority 2 -> Brake { v := 0 }`
#[derive(Clone, Debug, PartialEq)]
pub struct Transition {
    /// The name that logs call it by.
    pub label: Option<Name>,
    /// When it fires.
    pub trigger: Trigger,
    /// Its rank among those that fire at once.
    pub priority: Option<Box<Expr>>,
    /// The mode that it leads to.
    pub target: Option<Target>,
    /// What it does.
    pub actions: Option<Actions>,
    /// The whole transition.
    pub span: Span,
}

/// When a transition fires.
#[derive(Clone, Debug, PartialEq)]
pub struct Trigger {
    /// Which kind.
    pub kind: TriggerKind,
    /// The condition after `when`; a [`TriggerKind::When`] always has one.
    pub guard: Option<Expr>,
    /// From the first keyword to the end of the guard.
    pub span: Span,
}

/// The kinds of triggers.
#[derive(Clone, Debug, PartialEq)]
pub enum TriggerKind {
    /// `when guard`
    When,
    /// `after delay`, counted from the entry into the mode
    After(Expr),
    /// `every period`
    Every(Expr),
    /// `rate hazard`
    Rate(Expr),
    /// `on event(values) from sender`
    On {
        /// The event.
        event: Name,
        /// The names that the event's values get.
        binders: Vec<Name>,
        /// Whose event.
        sender: Option<Box<Expr>>,
    },
}

/// A path of modes, `Drive.Follow` or `Drive.history`.
#[derive(Clone, Debug, PartialEq)]
pub struct Target {
    /// The modes, outermost first; never empty; `history` is not among them.
    pub path: Vec<Name>,
    /// The word `history` at the end, if it stands there.
    pub history: Option<Span>,
    /// The whole path.
    pub span: Span,
}
