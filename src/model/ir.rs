//! The product of this floor: a model in which every name is resolved, every expression typed, every constant evaluated.
//!
//! Flat data. Expressions lie in one arena, operands before their users. What follows a `param` or a top-level `let`
//! without agents in it is already a number. Values are SI. Modes form a tree whose root (number 0) is the agent itself.

use std::sync::Arc;

use crate::base::{Arena, FileId, Idx, Span};
use crate::math::draw::Distribution;
use crate::math::{Op, Scale};
pub use crate::model::applied::Operands;
pub use crate::model::collective::{Aggregate, Quantifier};
pub use crate::model::integrator::Integrator;
pub use crate::model::kinds::{Inside, ParamValue};
use crate::model::limits::Limits;
pub use crate::model::machinery::Machinery;
pub use crate::model::pace::{Pace, Thinning};

mod action;
mod compact;

pub use action::{Action, Create, Destination, Transition, Trigger};

/// Names an [`Expr`].
pub type ExprId = Idx<Expr>;
/// Names a [`Function`].
pub type FunctionId = Idx<Function>;
/// Names an [`AgentType`].
pub type TypeId = Idx<AgentType>;
/// Names a [`Mode`] of one agent type.
pub type ModeId = Idx<Mode>;
/// Names an [`Interaction`].
pub type InteractionId = Idx<Interaction>;
/// Names a [`Binder`].
pub type BinderId = Idx<Binder>;

/// A whole program, ready for calculus.
#[derive(Clone, Debug, Default)]
pub struct Model {
    /// Top-level parameters with the values they have in this run, in order of declaration.
    pub params: Vec<Param>,
    /// Functions; calls refer to them.
    pub functions: Arena<Function>,
    /// Agent types in order of declaration.
    pub types: Arena<AgentType>,
    /// Interactions in order of declaration.
    pub interactions: Arena<Interaction>,
    /// All expressions.
    pub exprs: Arena<Expr>,
    /// All agents that quantifiers bind.
    pub binders: Arena<Binder>,
    /// The agents at t = 0.
    pub population: Population,
    /// What `run { }` says.
    pub run: Run,
    /// What watches the run.
    pub watch: Option<Watch>,
    /// What it may ask for.
    pub limits: Limits,
    /// The files of the text in the order of what they declare: imported ones before those that import them.
    pub files: Vec<FileId>,
}

impl Model {
    /// The agent types that the text declares.
    pub fn visible_types(&self) -> impl Iterator<Item = TypeId> + use<> {
        let watcher = self.watch.as_ref().map(|watch| watch.ty);
        self.types.indices().filter(move |&ty| Some(ty) != watcher)
    }
}

/// What watches a run.
#[derive(Clone, Debug)]
pub struct Watch {
    /// The type of an agent that nobody sees. The asserts of its root are the conditions of the properties; a transition of its
    /// stops the run.
    pub ty: TypeId,
    /// Its links that lead to the one agent of a name of `system`, each with the number of the name.
    pub named: Vec<(usize, usize)>,
    /// The properties in order.
    pub properties: Vec<Property>,
}

/// `property name = formula`.
#[derive(Clone, Debug)]
pub struct Property {
    /// Its name.
    pub name: String,
    /// What it claims.
    pub formula: Formula,
    /// Where it is named.
    pub span: Span,
}

/// A temporal formula. Conditions by number; windows from when to when, s from now.
#[derive(Clone, Debug, PartialEq)]
pub enum Formula {
    /// At all times of a window.
    Always([f64; 2], Box<Formula>),
    /// At some time of a window.
    Eventually([f64; 2], Box<Formula>),
    /// Until a time of a window at which `goal` holds.
    Until {
        /// What holds before.
        before: usize,
        /// When the goal is to hold.
        window: [f64; 2],
        /// What comes to hold.
        goal: usize,
    },
    /// A condition.
    Holds(usize),
}

/// A top-level `param`.
#[derive(Clone, Debug)]
pub struct Param {
    /// Its name.
    pub name: String,
    /// Its type.
    pub ty: Type,
    /// The declared unit's text, if any.
    pub unit: Option<String>,
    /// Its value in this run, SI.
    pub value: ParamValue,
    /// Where it is declared.
    pub span: Span,
}

/// The type of a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Type {
    /// A real number.
    Real,
    /// A whole number, held as a real.
    Int,
    /// True or false, held as 1 or 0.
    Bool,
    /// An agent of this type that is always there.
    Agent(TypeId),
    /// An agent of this type, or `none`.
    Link(TypeId),
}

/// An expression.
#[derive(Clone, Debug)]
pub struct Expr {
    /// What it is.
    pub kind: ExprKind,
    /// The type of its value.
    pub ty: Type,
    /// Where it stands.
    pub span: Span,
}

/// What an expression is. Agents are named by expressions too: `SelfAgent`, `Participant`, `Bound`, `Link`, `Local`.
#[derive(Clone, Debug)]
pub enum ExprKind {
    /// A number (SI), a boolean (1 or 0).
    Number(f64),
    /// The time of the run, s.
    Time,
    /// A parameter of the enclosing function, by position.
    Local(usize),
    /// What a message carries, by position: bound by the `on` of the enclosing transition.
    Received(usize),
    /// The agent whose text this is.
    SelfAgent,
    /// A participant of the enclosing interaction: 0 or 1.
    Participant(usize),
    /// The agent bound by a quantifier.
    Bound(BinderId),
    /// `none`.
    NoAgent,
    /// The agent that a link (number in its type) of an agent refers to; its type says whether it may be none.
    Link(ExprId, usize),
    /// A state of an agent.
    State(ExprId, usize),
    /// The rate of a state of an agent, `x'`.
    Rate(ExprId, usize),
    /// A discrete variable of an agent.
    Discrete(ExprId, usize),
    /// A parameter of an agent.
    AgentParam(ExprId, usize),
    /// A `let` of an agent.
    Let(ExprId, usize),
    /// An operator of arithmetic, comparison of numbers, logic; `Op::Select` is `if`.
    Apply(Op, Operands),
    /// A function of the program.
    Call(FunctionId, Box<[ExprId]>),
    /// Whether a link leads to an agent (`if lead`, `not lead`).
    Present(ExprId),
    /// Whether two references name the same agent.
    Same(ExprId, ExprId),
    /// Whether an agent is in a mode or inside it.
    Is(ExprId, ModeId),
    /// `exists` and `forall` (the filter of `forall` is an implication).
    Quantifier {
        /// Which.
        kind: Quantifier,
        /// The name it binds.
        binder: BinderId,
        /// The set it ranges over: all living agents of this type ...
        set: TypeId,
        /// ... without `self` (in an interaction: without both participants).
        other: bool,
        /// `where`.
        filter: Option<ExprId>,
        /// What follows the colon.
        body: ExprId,
    },
    /// `count`, `sum`, `min` and `max` over agents.
    Aggregate {
        /// Which.
        kind: Aggregate,
        /// The name it binds.
        binder: BinderId,
        /// The set it ranges over: all living agents of this type ...
        set: TypeId,
        /// ... without `self` (in an interaction: without both participants).
        other: bool,
        /// `where`; for `count` also what follows the colon.
        filter: Option<ExprId>,
        /// What follows the colon; none for `count`.
        term: Option<ExprId>,
    },
    /// `rising(condition)`.
    Rising(ExprId),
    /// `crossing(real)`.
    Crossing(ExprId),
}

/// A name bound by a quantifier.
#[derive(Clone, Debug)]
pub struct Binder {
    /// As written.
    pub name: String,
    /// The type of what it ranges over.
    pub ty: TypeId,
    /// The number of the name of `system` that it ranges over; none: all agents of the type. The filter says so, too.
    pub block: Option<usize>,
    /// Where it is bound.
    pub span: Span,
}

/// `fn name(params) = body`; the body refers to the parameters by `ExprKind::Local`.
#[derive(Clone, Debug)]
pub struct Function {
    /// Its name.
    pub name: String,
    /// Names and types of the parameters.
    pub params: Vec<(String, Type)>,
    /// The body.
    pub body: ExprId,
    /// Where it is declared.
    pub span: Span,
}

/// An agent type.
#[derive(Clone, Debug)]
pub struct AgentType {
    /// Its name.
    pub name: String,
    /// Where it is declared.
    pub span: Span,
    /// Numeric parameters (constant during a run).
    pub params: Vec<Variable>,
    /// Names of `system` that anything asks for, by number, and the parameter that says whether an agent belongs to it.
    pub memberships: Vec<(usize, usize)>,
    /// Continuous states.
    pub states: Vec<Variable>,
    /// Discrete variables.
    pub discretes: Vec<Variable>,
    /// Links; parameters of agent type are links that are never none. Those to members of sets come last.
    pub links: Vec<Link>,
    /// The sets that its flows read.
    pub sets: Vec<Set>,
    /// Events that its agents emit.
    pub events: Vec<Event>,
    /// Algebraic definitions, each after those that it reads (of the same agent).
    pub lets: Vec<Let>,
    /// Recordable names in order of declaration.
    pub declared: Vec<(String, VarRef)>,
    /// What it says about the values of its agents when they are made.
    pub initials: Initials,
    /// The tree of modes; number 0 is the root, the agent itself.
    pub modes: Arena<Mode>,
    /// Transitions of all modes in order of declaration in the source.
    pub transitions: Vec<Transition>,
}

/// What an agent type says about the values of its agents when they are made. They may read `index` ([`ExprKind::Local`] 0),
/// parameters before them, and, but for parameters, variables of the same agent.
#[derive(Clone, Debug, Default)]
pub struct Initials {
    /// Defaults of the numeric parameters.
    pub params: Vec<Option<Given>>,
    /// Initial values of the states.
    pub states: Vec<Option<Given>>,
    /// Initial values of the discrete variables.
    pub discretes: Vec<Option<Given>>,
    /// States and discretes, each after those that its initial value reads.
    pub order: Vec<VarRef>,
}

/// What a text gives a variable.
#[derive(Clone, Copy, Debug)]
pub enum Given {
    /// `= value`
    Value(ExprId),
    /// `~ distribution`
    Draw(Draw),
}

/// A distribution with its parameters.
#[derive(Clone, Copy, Debug)]
pub struct Draw {
    /// Which.
    pub distribution: Distribution,
    /// As many as the distribution has; the last is repeated.
    pub all: [ExprId; 2],
}

/// A variable of an agent type.
#[derive(Clone, Debug)]
pub struct Variable {
    /// Its name.
    pub name: String,
    /// Its type.
    pub ty: Type,
    /// The declared unit's text, if any.
    pub unit: Option<String>,
    /// What one declared unit is in SI.
    pub scale: Scale,
    /// Where it is declared.
    pub span: Span,
}

/// A link of an agent type.
#[derive(Clone, Debug)]
pub struct Link {
    /// Its name.
    pub name: String,
    /// What it leads to.
    pub ty: TypeId,
    /// A parameter of agent type: never none.
    pub required: bool,
    /// What it follows from, if it has an expression of its own: the first case that holds says whom it leads to.
    pub cases: Vec<LinkCase>,
    /// Where it is declared.
    pub span: Span,
}

/// All agents of a type, as a flow reads them: by a link to each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Set {
    /// The type.
    pub ty: TypeId,
    /// The number of the name of `system` that they belong to; none: all of the type.
    pub block: Option<usize>,
    /// The link to the first.
    pub first: usize,
    /// How many there are at t = 0.
    pub count: usize,
    /// How many more there may come to be: links behind the others, none at t = 0.
    pub room: usize,
}

impl Set {
    /// The links to its members.
    pub fn links(&self) -> std::ops::Range<usize> {
        self.first..self.first + self.count + self.room
    }
}

/// `event name(params)`.
#[derive(Clone, Debug)]
pub struct Event {
    /// Its name.
    pub name: String,
    /// What its messages carry.
    pub params: Vec<Variable>,
    /// Where it is declared.
    pub span: Span,
}

/// One case of the expression of a link.
#[derive(Clone, Debug)]
pub struct LinkCase {
    /// When it holds; none: always.
    pub condition: Option<ExprId>,
    /// Whom the link leads to.
    pub target: LinkTarget,
    /// Where it stands.
    pub span: Span,
}

/// Whom a link leads to.
#[derive(Clone, Debug)]
pub enum LinkTarget {
    /// `none`.
    Nobody,
    /// An agent, which may be none.
    Agent(ExprId),
    /// `nearest o in other Car where filter by key`: whoever has the least key; none if nobody belongs to the range.
    Nearest {
        /// The name it binds, and the set.
        binder: BinderId,
        /// Without the agent itself.
        other: bool,
        /// `where`.
        filter: Option<ExprId>,
        /// `by`.
        key: ExprId,
    },
}

/// `let name = value`.
#[derive(Clone, Debug)]
pub struct Let {
    /// Its name.
    pub name: String,
    /// The mode it is declared in (the root for agent-level ones).
    pub mode: ModeId,
    /// Its definition, read with the agent as `self`.
    pub value: ExprId,
    /// Unit and its size for recording, as in [`Variable`].
    pub unit: Option<String>,
    /// See [`Variable::scale`].
    pub scale: Scale,
    /// Where it is declared.
    pub span: Span,
}

/// A variable of an agent by kind and number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum VarRef {
    /// A state.
    State(usize),
    /// A discrete variable.
    Discrete(usize),
    /// A parameter.
    Param(usize),
    /// A link (recorded as the agent's name).
    Link(usize),
    /// A let.
    Let(usize),
}

/// A node of the tree of modes.
#[derive(Clone, Debug)]
pub struct Mode {
    /// Its name; the root has the agent type's.
    pub name: String,
    /// `Drive.Cruise`; empty for the root.
    pub path: String,
    /// The mode that it is inside; none for the root.
    pub parent: Option<ModeId>,
    /// 0 for the root.
    pub depth: usize,
    /// Its submodes in order; empty for a leaf.
    pub children: Vec<ModeId>,
    /// The child entered by default; none for a leaf, and where the children are regions.
    pub initial: Option<ModeId>,
    /// Whether it is a region: active as long as the agent is, beside the other regions.
    pub is_region: bool,
    /// State number, its rate, where the equation stands; without those of enclosing modes.
    pub flow: Vec<(usize, ExprId, Span)>,
    /// Domain of the flow.
    pub invariants: Vec<Claim>,
    /// Claims about the model.
    pub asserts: Vec<Claim>,
    /// Actions on entry.
    pub entry: Vec<Action>,
    /// Actions on exit.
    pub exit: Vec<Action>,
    /// Where it is declared.
    pub span: Span,
}

/// An `invariant` or an `assert`.
#[derive(Clone, Debug)]
pub struct Claim {
    /// What is claimed.
    pub condition: ExprId,
    /// The text after it.
    pub message: Option<String>,
    /// Where it stands.
    pub span: Span,
}

/// `interaction name(a: A, b: B) { }`.
#[derive(Clone, Debug)]
pub struct Interaction {
    /// Its name.
    pub name: String,
    /// The names of the two participants.
    pub participants: [String; 2],
    /// Their types.
    pub types: [TypeId; 2],
    /// Its transitions; lets are inlined by reference to shared expressions.
    pub transitions: Vec<Transition>,
    /// Where it is declared.
    pub span: Span,
}

/// The agents at t = 0, numbered in `system` order.
#[derive(Clone, Debug, Default)]
pub struct Population {
    /// The names of `system { }`.
    pub blocks: Vec<Block>,
    /// All agents in order. There may be very many: every floor has the same ones.
    pub agents: Arc<Vec<Instance>>,
    /// Discrete variables that every agent of their type starts with a value that the text declares as a constant.
    pub fixed: Vec<(TypeId, usize)>,
}

/// `name = Type[count](...)`.
#[derive(Clone, Debug)]
pub struct Block {
    /// Its name.
    pub name: String,
    /// The type of its agents.
    pub ty: TypeId,
    /// The number of its first agent.
    pub first: usize,
    /// How many there are.
    pub count: usize,
    /// Written with brackets: its agents are called `name[k]`.
    pub array: bool,
    /// Where it is declared.
    pub span: Span,
}

/// One agent at t = 0, before entry actions.
#[derive(Clone, Debug)]
pub struct Instance {
    /// Its type.
    pub ty: TypeId,
    /// The mode it starts in: a leaf; of an agent with regions one of one region, or the root where the text names none.
    pub mode: ModeId,
    /// Values of the parameters, SI.
    pub params: Vec<f64>,
    /// Values of the states, SI.
    pub states: Vec<f64>,
    /// Values of the discrete variables, SI; booleans 1 and 0.
    pub discretes: Vec<f64>,
    /// Numbers of the linked agents.
    pub links: Vec<Option<usize>>,
}

/// What `run { }` says; the command line has already been laid over it.
#[derive(Clone, Debug)]
pub struct Run {
    /// End of the run, s; none: only a `stop` ends it.
    pub until: Option<f64>,
    /// Relative tolerance.
    pub tolerance: f64,
    /// Absolute tolerance; none: as the relative one.
    pub absolute: Option<f64>,
    /// Seed of all randomness.
    pub seed: u64,
    /// The method of integration.
    pub integrator: Integrator,
    /// How it is computed.
    pub machinery: Machinery,
    /// Trajectories to write.
    pub records: Vec<Record>,
    /// The file of the event log.
    pub events: Option<String>,
    /// Where `run` stands; none if there is none.
    pub span: Option<Span>,
}

/// `record ... every d to "file"`.
#[derive(Clone, Debug)]
pub struct Record {
    /// The numbers of the agents that are there at t = 0, rising.
    pub agents: Vec<usize>,
    /// For each agent type (by number), whether agents that are created later are recorded, too.
    pub born: Vec<bool>,
    /// The names of the columns in declared order.
    pub columns: Vec<String>,
    /// For each agent type (by number), for each column, the variable; none: an empty cell.
    pub variables: Vec<Vec<Option<VarRef>>>,
    /// When it has rows.
    pub pace: Pace,
    /// The file; none: the command line's.
    pub file: Option<String>,
    /// Where it stands.
    pub span: Span,
}
