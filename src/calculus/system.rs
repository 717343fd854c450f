//! The product of this floor: systems of equations as functions over one expression graph, and the structure that
//! says what each function is for.
//!
//! A [`Function`] is a list of nodes to be computed together; code generation turns each into a kernel of the same
//! number. Everything else here is structure: agent types, modes, conditions, actions, which name functions.
//!
//! **Slots.** A function reads agents through the slots of its [`Frame`]: slot 0 is `self` (in an interaction the
//! first participant, slot 1 the second), then the agents bound by quantifiers, then those reached by links. An
//! aggregate (`sum o in Car: o.x`) has a slot too, as if it were an agent with one column: see [`Fold`].
//! **Columns.** An agent is two rows of numbers: its states, and its auxiliary columns ([`Layout`]).

use std::ops::Range as Indices;
use std::sync::Arc;

use crate::base::{Arena, Idx, Span};
use crate::calculus::graph::{Graph, NodeId};
pub use crate::calculus::layout::{Column, Entry, Layout};
pub use crate::calculus::range::{Keys, Near, Range};
pub use crate::calculus::relation::Relation;
pub use crate::calculus::slot::Slot;
pub use crate::math::draw::Distribution;
pub use crate::model::ir::{
    Aggregate, Block, Destination, Formula, Inside, Instance, Integrator, Pace, Population, Property, Record,
    Run, Thinning, VarRef, Watch,
};

mod action;

pub use action::{ActionList, ActionStep, Birth, Initials, Sender, Source, TransitionSystem, Trigger};

/// Names a [`Function`].
pub type FunctionId = Idx<Function>;

/// A whole program as equations.
#[derive(Clone, Debug)]
pub struct System {
    /// All expressions.
    pub graph: Graph,
    /// What is to be compiled.
    pub functions: Arena<Function>,
    /// Agent types, numbered as in the model.
    pub types: Vec<AgentSystem>,
    /// Interactions, numbered as in the model.
    pub interactions: Vec<InteractionSystem>,
    /// The agents at t = 0.
    pub population: Population,
    /// Settings of the run.
    pub run: Run,
    /// What watches it; its type is one of the types.
    pub watch: Option<Watch>,
}

/// Values to be computed together.
#[derive(Clone, Debug)]
pub struct Function {
    /// For listings: `Car.Follow flow`, `Bump.pair guard 1`.
    pub name: String,
    /// What it returns, in order.
    pub outputs: Vec<NodeId>,
}

/// The agents that a function can read.
#[derive(Clone, Debug, Default)]
pub struct Frame {
    /// Slot 0 first; a link's slot stands after the slot that it starts from.
    pub slots: Vec<Slot>,
    /// The aggregates among them, each after those that it reads.
    pub folds: Vec<Fold>,
    /// Where in the source the nodes of its functions stand, by node, rising; for messages.
    pub origins: Arc<[(NodeId, Span)]>,
}

impl Frame {
    /// Where a node was first met in the source.
    pub fn origin(&self, node: NodeId) -> Option<Span> {
        let found = self.origins.binary_search_by_key(&node, |&(node, _)| node);
        found.ok().map(|k| self.origins[k].1)
    }
}

/// `count`, `sum`, `min` or `max` over agents.
///
/// Its value is read as state 0 of its slot if a term moves, with rates; else as auxiliary column 0: then it changes only
/// at events and where a condition of its filter changes.
#[derive(Clone, Debug)]
pub struct Fold {
    /// Which.
    pub kind: Aggregate,
    /// Its own slot.
    pub slot: usize,
    /// The agents over which it goes.
    pub range: Range,
    /// Which of them belong to it.
    pub filter: Guard,
    /// What is added or compared; none for `count`.
    pub term: Option<Term>,
    /// Whether the term moves between events.
    pub moves: bool,
    /// The slots that filter and term read, those that are bound or reached within it left out; rising.
    pub reads: Vec<usize>,
    /// What binds those of them that are bound, outermost first.
    pub around: Vec<Range>,
    /// How near to the owner an agent must be to belong to it; empty: that does not follow.
    pub near: Vec<Near>,
}

/// What an aggregate folds.
#[derive(Clone, Debug)]
pub struct Term {
    /// One output.
    pub value: FunctionId,
    /// Three outputs, as those of [`Atom::rates`].
    pub rates: FunctionId,
    /// As [`Atom::smooth`], over all aggregates within.
    pub smooth: bool,
}

/// An agent type.
#[derive(Clone, Debug)]
pub struct AgentSystem {
    /// Its name.
    pub name: String,
    /// Its columns.
    pub layout: Layout,
    /// Names of the states.
    pub states: Vec<Column>,
    /// Names of the parameters.
    pub params: Vec<Column>,
    /// Names of the discrete variables.
    pub discretes: Vec<Column>,
    /// The links; those to members of sets come last.
    pub links: Vec<LinkSystem>,
    /// The sets that its flows read.
    pub sets: Vec<SetSystem>,
    /// The labels of its `rate` transitions. What is left of their hazards are states behind the others, which no output shows.
    pub hazards: Vec<String>,
    /// Its events.
    pub events: Vec<EventSystem>,
    /// What its random numbers are drawn for, each a stream of its own, by name.
    pub streams: Vec<String>,
    /// Algebraic definitions, for recording.
    pub lets: Vec<LetSystem>,
    /// Recordable names in order of declaration.
    pub declared: Vec<(String, VarRef)>,
    /// What its agents start with; empty if none of them are created during a run.
    pub initials: Initials,
    /// The tree of modes, numbered as in the model; 0 is the root. Behind it, for an agent with regions, its configurations: the
    /// combinations of a leaf of each region. In an agent without regions the leaves are the configurations.
    pub modes: Vec<ModeSystem>,
    /// The regions; the root is the only one of an agent without regions.
    pub regions: Vec<usize>,
    /// Transitions of all modes in order of declaration.
    pub transitions: Vec<TransitionSystem>,
}

/// A set that a flow reads, member by member.
#[derive(Clone, Debug)]
pub struct SetSystem {
    /// The type of its members.
    pub ty: usize,
    /// The parameter that says who of the type belongs to it; none: all do.
    pub belongs: Option<usize>,
    /// How many there are at t = 0.
    pub count: usize,
    /// The links to its members, and those that are none until somebody joins.
    pub links: Indices<usize>,
}

/// A link of an agent type.
#[derive(Clone, Debug)]
pub struct LinkSystem {
    /// Its name.
    pub name: String,
    /// A parameter of agent type: never none.
    pub required: bool,
    /// If it follows from an expression: its cases, of which the first that holds says whom it leads to.
    pub updates: Vec<LinkUpdate>,
}

/// One case of a link that follows from an expression.
#[derive(Clone, Debug)]
pub struct LinkUpdate {
    /// The number of the link in its type.
    pub link: usize,
    /// As messages call it: `Car.lead`.
    pub label: String,
    /// The agents that all of it reads.
    pub frame: Frame,
    /// When the case holds.
    pub case: Guard,
    /// When it holds and the link does not lead where it says: `And` of the case and of that, which is a tree of its own.
    pub stale: Guard,
    /// Whom the link is to lead to.
    pub target: Whither,
    /// Where it stands.
    pub span: Span,
}

/// Whom a link is to lead to.
#[derive(Clone, Debug)]
pub enum Whither {
    /// To nobody.
    Nobody,
    /// To the agent in a slot.
    Slot(usize),
    /// To whoever has the least key. The link strays if `Or(Exists(And(filter, Or(nobody, nearer))), And(somebody, lost))`.
    Nearest {
        /// Among whom.
        range: Range,
        /// Who belongs to it.
        filter: Guard,
        /// One output.
        key: FunctionId,
        /// How near an agent must be to be nearer than whom the link leads to: see `keys`. Empty: that does not follow.
        near: Vec<Near>,
        /// For each of these, how near that is: the lesser of both bounds holds.
        keys: Vec<Keys>,
    },
}

impl AgentSystem {
    /// The name of a state, or of what is left of a hazard.
    pub fn state_name(&self, k: usize) -> String {
        match self.states.get(k) {
            Some(column) => column.name.clone(),
            None => format!("hazard of {}", self.hazards[k - self.states.len()]),
        }
    }
}

/// An event of an agent type.
#[derive(Clone, Debug)]
pub struct EventSystem {
    /// Its name.
    pub name: String,
    /// The names of what it carries.
    pub params: Vec<String>,
}

/// A `let`, computed when it is recorded.
#[derive(Clone, Debug)]
pub struct LetSystem {
    /// Its name and unit.
    pub column: Column,
    /// The mode in which it exists; 0: in all.
    pub mode: usize,
    /// The agents it reads.
    pub frame: Frame,
    /// Its value.
    pub value: LetValue,
}

/// What a `let` is.
#[derive(Clone, Debug)]
pub enum LetValue {
    /// A number: a function of one output.
    Number(FunctionId),
    /// A condition.
    Condition(Guard),
}

/// A node of the tree of modes, or a configuration.
#[derive(Clone, Debug)]
pub struct ModeSystem {
    /// Its name.
    pub name: String,
    /// `Drive.Cruise`; empty for the root; `Motion.Drive|Lamp.Off` for a configuration of regions.
    pub path: String,
    /// None for the root, and for a configuration of regions.
    pub parent: Option<usize>,
    /// 0 for the root.
    pub depth: usize,
    /// The submode that is entered by default; none for a leaf, and for the root of an agent with regions.
    pub initial: Option<usize>,
    /// For a leaf, what it adds to the number of a configuration: its own number in an agent without regions.
    pub offset: usize,
    /// The auxiliary column that remembers which submode was active last; only where a `M.history` needs it.
    pub history: Option<usize>,
    /// For a configuration, the modes that are active in it, outer first: the root, ..., its leaves.
    pub active: Vec<usize>,
    /// The equations of a configuration.
    pub flow: Option<Flow>,
    /// Invariants and asserts declared in this mode, without those of enclosing modes.
    pub claims: Vec<ClaimSystem>,
    /// Entry actions.
    pub entry: ActionList,
    /// Exit actions.
    pub exit: ActionList,
    /// The transitions declared in this mode (numbers in `AgentSystem::transitions`).
    pub transitions: Vec<usize>,
}

/// The differential equations of a configuration.
#[derive(Clone, Debug)]
pub struct Flow {
    /// The agents it reads.
    pub frame: Frame,
    /// x' for every state, in order, with kinks locked; reads states, aux, time.
    pub rates: FunctionId,
    /// x'' for every state, in order: sum over j of df/dx_j x_j' + df/dt; also reads rates (of self and of foreign slots).
    pub accelerations: FunctionId,
    /// The non-zero entries of df/dx.
    pub jacobian: Vec<JacobianEntry>,
    /// Their values, in the same order.
    pub jacobian_values: FunctionId,
    /// Where a branch of the flow changes.
    pub kinks: Vec<Kink>,
    /// Foreign slots whose *states* are read (rule 13): these agents are coupled with self while the mode is active.
    pub couples: Vec<usize>,
    /// Where the equation of each state stands.
    pub spans: Vec<Span>,
}

/// Place of an entry of the Jacobian: d(rate of `row`)/d(state `column` of the agent in `slot`).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct JacobianEntry {
    /// State of self.
    pub row: usize,
    /// Whose state.
    pub slot: usize,
    /// Which state.
    pub column: usize,
}

/// A surface at which a branch of a flow changes. Its atoms are written over the lock's present value.
///
/// `Branch`: lock = 1 while `atom` (the comparison as written) is true, else 0.
/// `Integer`: lock = floor(e); it falls by one where `below` (e < lock) and rises where `above` (e >= lock + 1) becomes true.
/// The lock's value for a state given afresh is `initial` (one output: 1/0, or floor(e)).
#[derive(Clone, Debug)]
pub struct Kink {
    /// Which auxiliary column (absolute index) of self holds the branch.
    pub lock: usize,
    /// The lock's value computed from the state.
    pub initial: FunctionId,
    /// Its surfaces.
    pub kind: KinkKind,
    /// Where the operator stands.
    pub span: Span,
}

/// The two sorts of kinks.
#[derive(Clone, Debug)]
pub enum KinkKind {
    /// A comparison.
    Branch(Atom),
    /// A whole number.
    Integer {
        /// e < lock.
        below: Atom,
        /// e >= lock + 1.
        above: Atom,
    },
}

/// Where a comparison jumps. Its branches are read from locks, auxiliary columns of self after its own; surfaces and g read
/// those of the surfaces before them.
#[derive(Clone, Debug)]
pub struct Jumps {
    /// The column of the first lock.
    pub first: usize,
    /// What each lock holds, and where it changes.
    pub surfaces: Vec<KinkKind>,
    /// The comparison while no lock changes: smooth.
    pub between: Atom,
}

/// A condition in negation normal form: monotone in its atoms.
#[derive(Clone, Debug)]
pub enum Condition {
    /// Always or never.
    Constant(bool),
    /// A boolean function of auxiliary columns: changes at events only.
    Discrete(FunctionId),
    /// A comparison that the flow or time can change; by its number in [`Guard::atoms`].
    Atom(usize),
    /// All of them.
    And(Vec<Condition>),
    /// At least one of them.
    Or(Vec<Condition>),
    /// For at least one agent: binds `slot` to each living agent of type `ty`.
    Exists(Quantified),
    /// For all agents.
    Forall(Quantified),
    /// `rising(c)`, with its number in the guard.
    Rising(usize, Box<Condition>),
}

/// The range and body of a quantifier.
#[derive(Clone, Debug)]
pub struct Quantified {
    /// The slot it binds.
    pub slot: usize,
    /// The type it ranges over.
    pub ty: usize,
    /// Without self (in an interaction: without both participants).
    pub other: bool,
    /// What is to hold (filter included).
    pub body: Box<Condition>,
    /// Which agents matter: those beyond one of these bounds from the agent in slot 0 settle nothing. The body of `exists` is
    /// false for them, now and at any instant at which it becomes true; that of `forall` is true. Empty: all matter.
    pub near: Vec<Near>,
}

/// A comparison of reals, `g <= 0` or `g < 0`.
#[derive(Clone, Debug)]
pub struct Atom {
    /// What it is.
    pub relation: Relation,
    /// One output: g; reads states, aux, time (and rates, if the source says `x'`).
    pub value: FunctionId,
    /// Three outputs: g, dg/dt, d2g/dt2 along given x' and x'' (Gear & Osterby's extra state and its rate);
    /// reads states, rates, accelerations, aux, time. A d2g/dt2 that is not known (g reads x') is NaN.
    pub rates: FunctionId,
    /// Whether g is continuous between events. If not (it has a floor, a sign, an `if`, an atan2, ... of something that
    /// moves), the rates hold only between its jumps: an interval of dg/dt then bounds nothing, an interval of g does.
    pub smooth: bool,
    /// If it is not: where it jumps, and what it is between. None if that is not known (a term of an aggregate jumps).
    pub jumps: Option<Box<Jumps>>,
    /// What is zero where dg/dt can jump (the argument of `abs`, the difference of those of `min` and `max`): where an
    /// interval of it contains zero, an interval of d2g/dt2 bounds nothing.
    pub turns: Option<FunctionId>,
    /// Whether g is, between its turns, a weighted sum of more than one state, with weights that do not move: along
    /// polynomials it is one.
    pub affine: bool,
    /// The slots of agents that g reads (states or aux), by itself or through an aggregate, rising.
    pub slots: Vec<usize>,
    /// The slots of the aggregates that g reads, rising.
    pub folds: Vec<usize>,
    /// The comparison in the words of the source.
    pub text: String,
    /// What the source compares with what; none where it does not compare (`crossing(e)`, a kink).
    pub sides: Option<Sides>,
    /// Where it stands.
    pub span: Span,
}

/// A comparison as it is written; an atom may be of its negation, of the squares, or of a branch of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Sides {
    /// What stands on the left.
    pub left: NodeId,
    /// `<=`, `>`, ...
    pub sign: &'static str,
    /// What stands on the right.
    pub right: NodeId,
}

/// A condition with its atoms.
#[derive(Clone, Debug)]
pub struct Guard {
    /// The tree.
    pub condition: Condition,
    /// Its comparisons. An atom below a quantifier has an instance for each binding.
    pub atoms: Vec<Atom>,
    /// How many `rising` there are.
    pub n_rising: usize,
}

impl Guard {
    /// What it is computed by: its comparisons, then its discrete tests.
    pub fn functions(&self) -> Vec<FunctionId> {
        let mut found: Vec<FunctionId> = self.atoms.iter().map(|atom| atom.value).collect();
        let mut pending = vec![&self.condition];
        while let Some(condition) = pending.pop() {
            match condition {
                Condition::Discrete(function) => found.push(*function),
                Condition::And(terms) | Condition::Or(terms) => pending.extend(terms),
                Condition::Exists(quantified) | Condition::Forall(quantified) => {
                    pending.push(&quantified.body);
                }
                Condition::Rising(_, inner) => pending.push(inner),
                Condition::Constant(_) | Condition::Atom(_) => {}
            }
        }
        found
    }
}

/// An invariant or an assert, whose guard is of its *negation*; or a condition of a property.
#[derive(Clone, Debug)]
pub struct ClaimSystem {
    /// Which.
    pub kind: ClaimKind,
    /// The agents it reads.
    pub frame: Frame,
    /// True where the claim is false.
    pub violation: Guard,
    /// The text given with it.
    pub message: Option<String>,
    /// Where it stands.
    pub span: Span,
}

/// The two sorts of claims.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ClaimKind {
    /// Domain of the flow: a violation ends the run.
    Invariant,
    /// A claim about the model: a violation is reported.
    Assert,
    /// That a hazard is not negative: a violation ends the run.
    Rate,
    /// A condition of a property: its guard is of the condition itself, and each g is minus the margin of what is written.
    Property,
}

/// An interaction of two agents.
#[derive(Clone, Debug)]
pub struct InteractionSystem {
    /// Its name.
    pub name: String,
    /// The types of slot 0 and slot 1.
    pub types: [usize; 2],
    /// Its transitions.
    pub transitions: Vec<PairTransition>,
}

/// A transition of an interaction.
#[derive(Clone, Debug)]
pub struct PairTransition {
    /// The transition; slots 0 and 1 are the participants.
    pub transition: TransitionSystem,
    /// The same when the two change places (rule 5): one flag per unordered pair, slot 0 the lower number.
    pub symmetric: bool,
    /// How near the two have to be for the guard to be true, or to become so. All bounds hold; empty: none is known.
    pub near: Vec<Near>,
}
