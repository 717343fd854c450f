//! The syntax tree: what a `.hy` file says, item by item, each node with its place in the text.
//!
//! Pure data; its methods only name operators: no name is resolved, no type known, no unit read. Parentheses
//! and comments are gone. Chains of operators of one precedence (`a + b - c`, `p and q and r`) are flat lists, however
//! long; everything else nests at most as deep as [`MAX_NESTING`](super::MAX_NESTING) allows.

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
    Param(Param),
    /// `let H = 5*N`
    Let(Let),
    /// `fn f(a: real) = a^2`
    Fn(Fn),
    /// `agent Car(...) { ... }`
    Agent(Agent),
    /// `interaction Bump(a: Car, b: Car) { ... }`
    Interaction(Interaction),
    /// `system { ... }`
    System(System),
    /// `property p = always ...`
    Property(Property),
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
    pub ty: Option<TypeName>,
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
    pub ty: Option<TypeName>,
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
    pub ty: Option<TypeName>,
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
    pub default: Option<Expr>,
    /// The whole declaration.
    pub span: Span,
}

/// A type: `real [m/s]`, `int`, `bool`, `string`, or the name of an agent type.
#[derive(Clone, Debug, PartialEq)]
pub struct TypeName {
    /// The type's name.
    pub name: Name,
    /// Its unit.
    pub unit: Option<UnitText>,
    /// Both.
    pub span: Span,
}

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
    Link(Link),
    /// `event braking`
    Event(Event),
    /// A set of modes in parallel to others.
    Region(Region),
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
    pub ty: Option<TypeName>,
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
    Let(Let),
    /// `flow { x' = v }`
    Flow(Flow),
    /// `invariant v >= 0 "why"`
    Invariant(Claim),
    /// `assert gap > 0 "why"`
    Assert(Claim),
    /// `mode Brake { ... }`
    Mode(Mode),
    /// `entry { ... }`
    Entry(Actions),
    /// `exit { ... }`
    Exit(Actions),
    /// `leave: when ... -> ... { ... }`
    Transition(Transition),
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
    pub priority: Option<Expr>,
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
        sender: Option<Expr>,
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

/// A list of actions in braces.
#[derive(Clone, Debug, PartialEq)]
pub struct Actions {
    /// The actions, in order.
    pub actions: Vec<Action>,
    /// The braces and what they hold.
    pub span: Span,
}

/// One action.
#[derive(Clone, Debug, PartialEq)]
pub struct Action {
    /// What it does.
    pub kind: ActionKind,
    /// Its place.
    pub span: Span,
}

/// The kinds of actions.
#[derive(Clone, Debug, PartialEq)]
pub enum ActionKind {
    /// `x := e`, `a.x ~ Normal(0, 1)`
    Assign {
        /// What is written.
        place: Place,
        /// The new value.
        given: Given,
    },
    /// `create Car(v = 3)`
    Create(Constructor),
    /// `destroy self`
    Destroy(Expr),
    /// `emit braking(3) after 1 [s]`
    Emit {
        /// The event.
        event: Name,
        /// What it carries.
        args: Vec<Expr>,
        /// When it is delivered.
        delay: Option<Expr>,
    },
    /// `a -> Avoid`, in an interaction
    ChangeMode {
        /// The participant.
        participant: Name,
        /// Its new mode.
        target: Target,
    },
    /// `stop "why"`
    Stop(Option<Text>),
    /// `if c { ... } else if d { ... } else { ... }`
    If {
        /// Conditions and what each leads to, in order; never empty.
        branches: Vec<Branch>,
        /// What happens if none holds.
        otherwise: Option<Actions>,
    },
}

/// One branch of an `if` among actions.
#[derive(Clone, Debug, PartialEq)]
pub struct Branch {
    /// Its condition.
    pub condition: Expr,
    /// What happens if it is the first that holds.
    pub actions: Actions,
}

/// What an assignment writes: `x`, or `a.x` of a participant.
#[derive(Clone, Debug, PartialEq)]
pub struct Place {
    /// The agent before the dot.
    pub owner: Option<Name>,
    /// The variable.
    pub variable: Name,
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
    Let(Let),
    /// `pair: when ... { ... }`
    Transition(Transition),
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
    pub start: Option<Target>,
    /// Where the values that are not arguments come from.
    pub source: Option<Expr>,
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

/// An expression.
#[derive(Clone, Debug, PartialEq)]
pub struct Expr {
    /// Which kind.
    pub kind: ExprKind,
    /// Its place; parentheses around it do not count.
    pub span: Span,
}

/// The kinds of expressions.
#[derive(Clone, Debug, PartialEq)]
pub enum ExprKind {
    /// `10 [ms]`
    Number {
        /// The literal's value, in the unit written; finite.
        value: f64,
        /// The literal as written, without the unit.
        text: String,
        /// The unit behind it.
        unit: Option<UnitText>,
    },
    /// `"cars.csv"`
    Text(String),
    /// A variable, function, constant, agent type, instance: any name.
    Name(String),
    /// `[a, b, c]`, never empty
    List(Vec<Expr>),
    /// `o.x`
    Field(Box<Expr>, Name),
    /// `f(a, b)`
    Call {
        /// What is called.
        callee: Box<Expr>,
        /// The arguments, by position.
        args: Vec<Expr>,
    },
    /// `cars[3]`
    Index(Box<Expr>, Box<Expr>),
    /// `x'`
    Prime(Box<Expr>),
    /// `-x`, `not p`
    Unary(UnaryOp, Box<Expr>),
    /// `base ^ exponent`
    Power(Box<Expr>, Box<Expr>),
    /// `a + b - c`
    Sum(Chain<SumOp>),
    /// `a * b / c`
    Product(Chain<ProductOp>),
    /// `a <= b`
    Compare(CompareOp, Box<Expr>, Box<Expr>),
    /// `o is Drive.Brake`
    Is(Box<Expr>, Target),
    /// `p and q and r`: two operands or more
    And(Vec<Expr>),
    /// `p or q or r`: two operands or more
    Or(Vec<Expr>),
    /// `if c then a else b`
    If {
        /// The condition.
        condition: Box<Expr>,
        /// The value where it holds.
        then: Box<Expr>,
        /// The value elsewhere.
        otherwise: Box<Expr>,
    },
    /// `exists o in other Car: o.x > x`
    Quantifier(Box<Quantifier>),
}

/// Operands joined from left to right by operators of one precedence.
#[derive(Clone, Debug, PartialEq)]
pub struct Chain<Op> {
    /// The first operand.
    pub first: Box<Expr>,
    /// Operators, each with the operand to its right; never empty.
    pub rest: Vec<ChainLink<Op>>,
}

/// One operator of a [`Chain`] and the operand to its right.
#[derive(Clone, Debug, PartialEq)]
pub struct ChainLink<Op> {
    /// The operator.
    pub op: Op,
    /// Its place.
    pub op_span: Span,
    /// The operand to its right.
    pub operand: Expr,
}

/// `-` and `not` before an operand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UnaryOp {
    /// `-`
    Neg,
    /// `not`
    Not,
}

/// `+` and `-` between operands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SumOp {
    /// `+`
    Add,
    /// `-`
    Sub,
}

/// `*` and `/`
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ProductOp {
    /// `*`
    Mul,
    /// `/`
    Div,
}

/// The comparisons.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CompareOp {
    /// `<`
    Less,
    /// `<=`
    LessEqual,
    /// `>`
    Greater,
    /// `>=`
    GreaterEqual,
    /// `==`
    Equal,
    /// `!=`
    NotEqual,
}

/// An expression over a set of agents.
#[derive(Clone, Debug, PartialEq)]
pub struct Quantifier {
    /// What is asked of the set.
    pub kind: QuantifierKind,
    /// The name of an agent of the set within `filter` and `body`.
    pub binder: Name,
    /// The word `other`, if it stands there: without the agent that asks.
    pub other: Option<Span>,
    /// An agent type or an instance.
    pub set: Name,
    /// The condition after `where`.
    pub filter: Option<Expr>,
    /// The expression after `:` or `by`.
    pub body: Option<Expr>,
}

/// What is asked of a set of agents.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum QuantifierKind {
    /// Whether the body holds for one.
    Exists,
    /// Whether the body holds for all.
    Forall,
    /// For how many the body holds.
    Count,
    /// The sum of the body.
    Sum,
    /// The least value of the body.
    Min,
    /// The greatest value of the body.
    Max,
    /// The agent with the least value of the body.
    Nearest,
}

impl SumOp {
    /// As it is written.
    pub fn sign(self) -> &'static str {
        match self {
            SumOp::Add => "+",
            SumOp::Sub => "-",
        }
    }
}

impl ProductOp {
    /// As it is written.
    pub fn sign(self) -> &'static str {
        match self {
            ProductOp::Mul => "*",
            ProductOp::Div => "/",
        }
    }
}

impl CompareOp {
    /// As it is written.
    pub fn sign(self) -> &'static str {
        match self {
            CompareOp::Less => "<",
            CompareOp::LessEqual => "<=",
            CompareOp::Greater => ">",
            CompareOp::GreaterEqual => ">=",
            CompareOp::Equal => "==",
            CompareOp::NotEqual => "!=",
        }
    }
}

impl QuantifierKind {
    /// As it is written.
    pub fn word(self) -> &'static str {
        match self {
            QuantifierKind::Exists => "exists",
            QuantifierKind::Forall => "forall",
            QuantifierKind::Count => "count",
            QuantifierKind::Sum => "sum",
            QuantifierKind::Min => "min",
            QuantifierKind::Max => "max",
            QuantifierKind::Nearest => "nearest",
        }
    }
}
