//! The syntax tree: what a `.hy` file says, item by item, each node with its place in the text.
//!
//! Pure data; its methods only name operators: no name is resolved, no type known, no unit read. Parentheses
//! and comments are gone. Chains of operators of one precedence (`a + b - c`, `p and q and r`) are flat lists, however
//! long; everything else nests at most as deep as [`MAX_NESTING`](super::MAX_NESTING) allows. A giant model has millions of nodes:
//! what few nodes have, or what makes one kind of node much larger than the others, lies in a box.

mod expr;
mod action;
mod agent;

pub use action::*;
pub use agent::*;
pub use expr::*;

use crate::base::Span;

/// A whole file.
#[derive(Clone, Debug, PartialEq)]
pub struct Ast {
    /// The items in the order of the text.
    pub items: Vec<Item>,
}

/// A name as it stands in the text.
#[derive(Clone, Debug, PartialEq)]
pub struct Name {
    /// The identifier.
    pub text: String,
    /// Its place.
    pub span: Span,
}

/// A string literal.
#[derive(Clone, Debug, PartialEq)]
pub struct Text {
    /// The characters between the quotes, taken as they are.
    pub value: String,
    /// Its place, quotes included.
    pub span: Span,
}

/// A unit as it is written: `m/s^2` of `[m/s^2]`.
#[derive(Clone, Debug, PartialEq)]
pub struct UnitText {
    /// The text between the brackets, without surrounding blanks.
    pub text: String,
    /// Its place, brackets included.
    pub span: Span,
}

/// What may stand at the outermost level of a file.
#[derive(Clone, Debug, PartialEq)]
pub enum Item {
    /// `import "other.hy"`
    Import(Import),
    /// `param R: real [m] = 1.0`
    Param(Box<Param>),
    /// `let H = 5*N`
    Let(Box<Let>),
    /// `fn f(a: real) = a^2`
    Fn(Box<Fn>),
    /// `agent Car(...) { ... }`
    Agent(Box<Agent>),
    /// `interaction Bump(a: Car, b: Car) { ... }`
    Interaction(Box<Interaction>),
    /// `system { ... }`
    System(System),
    /// `property p = always ...`
    Property(Box<Property>),
    /// `run { ... }`
    Run(Run),
}

/// `import "other.hy"`
#[derive(Clone, Debug, PartialEq)]
pub struct Import {
    /// The path, relative to the importing file.
    pub path: Text,
    /// The whole item.
    pub span: Span,
}

/// A model parameter, `param N: int = 20`.
#[derive(Clone, Debug, PartialEq)]
pub struct Param {
    /// Its name.
    pub name: Name,
    /// Its declared type.
    pub ty: Option<Box<TypeName>>,
    /// Its value, unless the command line gives one.
    pub value: Expr,
    /// The whole item.
    pub span: Span,
}

/// A definition, `let H = 5*N`: of the file, of an agent, of a mode or of an interaction.
#[derive(Clone, Debug, PartialEq)]
pub struct Let {
    /// Its name.
    pub name: Name,
    /// Its declared type.
    pub ty: Option<Box<TypeName>>,
    /// What it stands for.
    pub value: Expr,
    /// The whole definition.
    pub span: Span,
}

/// A function of the file.
#[derive(Clone, Debug, PartialEq)]
pub struct Fn {
    /// Its name.
    pub name: Name,
    /// Its formal parameters.
    pub formals: Vec<Formal>,
    /// The declared type of its value.
    pub ty: Option<Box<TypeName>>,
    /// Its value.
    pub body: Expr,
    /// The whole item.
    pub span: Span,
}

/// A formal parameter, `v: real [m/s] = 4`.
#[derive(Clone, Debug, PartialEq)]
pub struct Formal {
    /// Its name.
    pub name: Name,
    /// Its type.
    pub ty: TypeName,
    /// The value if none is given.
    pub default: Option<Box<Expr>>,
    /// The whole declaration.
    pub span: Span,
}

/// A type: `real [m/s]`, `int`, `bool`, `string`, or the name of an agent type.
#[derive(Clone, Debug, PartialEq)]
pub struct TypeName {
    /// The type's name.
    pub name: Name,
    /// Its unit.
    pub unit: Option<Box<UnitText>>,
    /// Both.
    pub span: Span,
}

/// A rule between pairs of agents.
#[derive(Clone, Debug, PartialEq)]
pub struct Interaction {
    /// Its name.
    pub name: Name,
    /// Its participants.
    pub formals: Vec<Formal>,
    /// What its braces hold, in order.
    pub items: Vec<InteractionItem>,
    /// The whole item.
    pub span: Span,
}

/// What an interaction's braces hold.
#[derive(Clone, Debug, PartialEq)]
pub enum InteractionItem {
    /// `let d = ...`
    Let(Box<Let>),
    /// `pair: when ... { ... }`
    Transition(Box<Transition>),
}

/// `system { ... }`
#[derive(Clone, Debug, PartialEq)]
pub struct System {
    /// The instances, in order.
    pub instances: Vec<Instance>,
    /// The whole item.
    pub span: Span,
}

/// `cars = Car[N](v = 3)`
#[derive(Clone, Debug, PartialEq)]
pub struct Instance {
    /// Its name.
    pub name: Name,
    /// What it is.
    pub constructor: Constructor,
    /// The whole line.
    pub span: Span,
}

/// `Car[N](v = 3) in Drive from csv(data)`
#[derive(Clone, Debug, PartialEq)]
pub struct Constructor {
    /// The agent type.
    pub agent: Name,
    /// How many; without it, one agent and no array.
    pub count: Option<Count>,
    /// Values of parameters, variables and links.
    pub args: Vec<NamedArg>,
    /// The mode in which it starts.
    pub start: Option<Box<Target>>,
    /// Where the values that are not arguments come from.
    pub source: Option<Box<Expr>>,
    /// The whole constructor.
    pub span: Span,
}

/// The brackets of a constructor.
#[derive(Clone, Debug, PartialEq)]
pub enum Count {
    /// `Car[N]`
    Exactly(Expr),
    /// `Car[]`: as many as there are rows
    AllRows(Span),
}

/// `v = 3` or `v ~ Normal(3, 1)`
#[derive(Clone, Debug, PartialEq)]
pub struct NamedArg {
    /// The parameter, variable or link.
    pub name: Name,
    /// Its value.
    pub given: Given,
    /// The whole argument.
    pub span: Span,
}

/// `property p = always ...`
#[derive(Clone, Debug, PartialEq)]
pub struct Property {
    /// Its name.
    pub name: Name,
    /// What it claims.
    pub formula: Formula,
    /// The whole item.
    pub span: Span,
}

/// A temporal formula.
#[derive(Clone, Debug, PartialEq)]
pub struct Formula {
    /// Which kind.
    pub kind: FormulaKind,
    /// Its place.
    pub span: Span,
}

/// The kinds of temporal formulas.
#[derive(Clone, Debug, PartialEq)]
pub enum FormulaKind {
    /// `always [0, 5] formula`
    Always(Option<Window>, Box<Formula>),
    /// `eventually [0, 5] formula`
    Eventually(Option<Window>, Box<Formula>),
    /// `p until [0, 5] q`
    Until {
        /// What holds before.
        before: Expr,
        /// Within which time.
        window: Option<Window>,
        /// What comes to hold.
        goal: Expr,
    },
    /// A condition now.
    Holds(Expr),
}

/// `[0, 5]`: seconds from now.
#[derive(Clone, Debug, PartialEq)]
pub struct Window {
    /// Its first instant.
    pub from: Expr,
    /// Its last instant.
    pub to: Expr,
    /// The brackets and what they hold.
    pub span: Span,
}

/// `run { ... }`
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    /// Its settings, in order.
    pub settings: Vec<RunSetting>,
    /// The whole item.
    pub span: Span,
}

/// One line of `run { }`.
#[derive(Clone, Debug, PartialEq)]
pub struct RunSetting {
    /// What it sets.
    pub kind: RunSettingKind,
    /// The whole line.
    pub span: Span,
}

/// The kinds of run settings.
#[derive(Clone, Debug, PartialEq)]
pub enum RunSettingKind {
    /// `until 30 [s]`
    Until(Expr),
    /// `stop when c`
    StopWhen(Expr),
    /// `record fast, Car.x every 0.05 [s] to "two_cars.csv"`
    Record {
        /// What is recorded.
        columns: Vec<Expr>,
        /// How often; without it, at every step and event.
        period: Option<Expr>,
        /// Where to.
        file: Text,
    },
    /// `events to "events.csv"`
    Output {
        /// What is written.
        name: Name,
        /// Where to.
        file: Text,
    },
    /// `tolerance 1e-8`
    Set {
        /// The setting.
        name: Name,
        /// Its value.
        value: Expr,
    },
}
