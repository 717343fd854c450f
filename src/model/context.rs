//! What the passes share while a model is built: the tables of names, the growing product, the diagnostics.
//!
//! Every expression that is pushed gets its [`Facts`] at once: operands stand before their users, so nothing is ever
//! walked again to find out whether it is constant or changes continuously.

use rustc_hash::{FxHashMap, FxHashSet};

use super::Files;
use super::evaluate::Evaluator;
use super::findings::Findings;
use super::ir::{
    BinderId, Expr, ExprId, ExprKind, FunctionId, InteractionId, ModeId, Model, Operands, TypeId, VarRef,
};
use super::operands::for_each_operand;
use super::quantities::Quantities;
use super::types::{Quantity, Slot, Ty};
use crate::base::{Diagnostic, FileId, SourceMap, Span};
use crate::math::Op;
use crate::syntax::ast;

/// A checked expression with its type.
#[derive(Clone, Copy, Debug)]
pub(super) struct Value {
    /// The expression in the product.
    pub id: ExprId,
    /// Its type.
    pub ty: Ty,
}

/// What is known about an expression as soon as it exists.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Facts {
    /// It can be evaluated now: numbers and operators only.
    pub closed: bool,
    /// It can be evaluated once the parameters of its function are known.
    pub pure: bool,
    /// A real number that changes continuously: by a state or by time.
    pub varies: bool,
    /// A real number that changes continuously if the function's real arguments do.
    pub varies_with_locals: bool,
    /// A quantifier stands in it, or in what it calls.
    pub quantified: bool,
    /// A number without a unit, as it stands in the text.
    pub bare: bool,
}

/// What a name of the file stands for.
#[derive(Clone, Copy, Debug)]
pub(super) struct Global {
    /// What.
    pub kind: GlobalKind,
    /// Where it is declared.
    pub span: Span,
}

impl Global {
    /// Whether it is an agent type.
    pub fn is_agent(&self) -> bool {
        matches!(self.kind, GlobalKind::Agent(_))
    }
}

/// The kinds of names of a file.
#[derive(Clone, Copy, Debug)]
pub(super) enum GlobalKind {
    /// A `param`, a `let` or a function.
    Definition(usize),
    /// An agent type.
    Agent(TypeId),
    /// An interaction.
    Interaction,
    /// A name of `system`.
    Instance,
}

/// Something that is defined by an expression, and looked up by others in any order.
pub(super) struct Definition<'a> {
    /// Its name.
    pub name: &'a ast::Name,
    /// Its text.
    pub body: Body<'a>,
    /// How far it has come.
    pub progress: Progress,
    /// Some other text mentions it.
    pub used: bool,
    /// Where the dimension of its value comes from.
    pub quantity: Quantity,
}

impl Definition<'_> {
    /// Whether it is a function.
    pub fn is_function(&self) -> bool {
        matches!(self.body, Body::Function(_))
    }
}

/// The text of a definition.
#[derive(Clone, Copy)]
pub(super) enum Body<'a> {
    /// A `param`.
    Param(&'a ast::Param),
    /// A `let` of the file.
    Let(&'a ast::Let),
    /// A function.
    Function(&'a ast::Fn),
    /// A `let` of an agent type or of one of its modes.
    AgentLet(TypeId, ModeId, &'a ast::Let),
    /// A `let` of an interaction, by its number.
    PairLet(usize, &'a ast::Let),
}

impl<'a> Body<'a> {
    /// The expression.
    pub fn value(&self) -> &'a ast::Expr {
        match self {
            Body::Param(item) => &item.value,
            Body::Let(item) | Body::AgentLet(_, _, item) | Body::PairLet(_, item) => &item.value,
            Body::Function(item) => &item.body,
        }
    }
}

/// How far a definition has come.
#[derive(Clone, Copy, Debug)]
pub(super) enum Progress {
    /// Not looked at yet.
    Waiting,
    /// Being worked on: whoever needs it now is part of a circle.
    Running,
    /// Known.
    Done(Meaning),
}

/// What a definition turned out to be.
#[derive(Clone, Copy, Debug)]
pub(super) enum Meaning {
    /// A constant, SI.
    Number(f64, Ty),
    /// A text, by its number in [`Context::texts`].
    Text(usize),
    /// An expression that its users share.
    Shared(Value),
    /// A function.
    Function(FunctionId),
    /// A `let` of an agent type, by its number there.
    Let(usize, Ty),
    /// Something wrong that has been reported.
    Failed,
}

/// What the callers of a function must know.
#[derive(Clone)]
pub(super) struct Signature {
    /// What its parameters take.
    pub formals: Vec<(Slot, Option<Value>)>,
    /// What its value is.
    pub result: Slot,
}

/// The names of an agent type.
pub(super) struct AgentNames<'a> {
    /// Its text.
    pub item: &'a ast::Agent,
    /// Everything declared outside the modes.
    pub members: FxHashMap<&'a str, (Member, Span)>,
    /// Types and units of parameters, states and discretes, by their numbers.
    pub params: Vec<Slot>,
    /// See `params`.
    pub states: Vec<Slot>,
    /// See `params`.
    pub discretes: Vec<Slot>,
    /// Of what each event carries.
    pub events: Vec<Vec<Slot>>,
    /// Where the dimensions of the `let`s come from, by their numbers in the product.
    pub lets: Vec<Quantity>,
    /// The parts of the texts of modes and regions, by number; none for the root.
    pub modes: Vec<Option<&'a [ast::BodyItem]>>,
    /// The `let`s of each mode; those of the root are members.
    pub mode_lets: Vec<FxHashMap<&'a str, usize>>,
    /// Parts of it are not supported, so what seems to be missing may be there.
    pub incomplete: bool,
}

/// What a member of an agent type is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Member {
    /// A numeric parameter.
    Param(usize),
    /// A state.
    State(usize),
    /// A discrete variable.
    Discrete(usize),
    /// A link.
    Link(usize),
    /// A `let`, by the number of its definition.
    Let(usize),
    /// An event.
    Event(usize),
    /// Declared twice, which has been reported.
    Twice,
}

/// The names of an interaction.
pub(super) struct PairNames<'a> {
    /// Its text.
    pub item: &'a ast::Interaction,
    /// Its number in the product.
    pub id: Option<InteractionId>,
    /// Names and types of the participants; none if they are not as they must be.
    pub participants: Option<[(&'a str, TypeId); 2]>,
    /// Its `let`s.
    pub lets: FxHashMap<&'a str, usize>,
}

/// Whose text is being read, and what its names may mean.
pub(super) struct Scope<'a> {
    /// Whose.
    pub home: Home,
    /// The parameters of the enclosing function.
    pub locals: Vec<(&'a str, Slot)>,
    /// Names bound by quantifiers, the innermost last.
    pub bound: Vec<(&'a str, BinderId)>,
    /// Names bound by `on`: what the message carries.
    pub received: Vec<(&'a str, Slot)>,
    /// Names bound by a `nearest` of the guard, with its link.
    pub nearest: Vec<(&'a str, Value)>,
}

/// Whose text an expression belongs to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Home {
    /// The file: `param`, `let`, defaults of functions, `run`.
    File,
    /// A function.
    Function,
    /// A mode of an agent type; the root for the agent itself.
    Agent(TypeId, ModeId),
    /// The initial value of an agent's variable: `index` is known.
    Initial(TypeId),
    /// An interaction, by its number.
    Pair(usize),
    /// An argument in `system`: `index` is known.
    Construction,
}

impl Scope<'_> {
    /// A scope without names of its own.
    pub fn of(home: Home) -> Self {
        Scope { home, locals: Vec::new(), bound: Vec::new(), received: Vec::new(), nearest: Vec::new() }
    }
}

/// A place where a dimension is asked for.
pub(super) struct Goal {
    /// What stands there.
    pub value: ExprId,
    /// What must be there.
    pub slot: Slot,
    /// At the beginning of a sentence: "the value of `x`".
    pub what: String,
}

/// The state of the whole check.
pub(super) struct Context<'a> {
    /// The texts; the command line's values are added when they are wrong.
    pub sources: &'a mut SourceMap,
    /// Where data files come from.
    pub files: &'a mut dyn Files,
    /// Data files by their names, once they are opened.
    pub opened: FxHashMap<String, FileId>,
    /// The product as far as it is there.
    pub model: Model,
    /// By expression.
    pub facts: Vec<Facts>,
    /// Where the dimensions of numbers, arguments and named expressions come from.
    pub quantities: Quantities,
    /// What must have a certain dimension.
    pub goals: Vec<Goal>,
    /// The names of the file.
    pub globals: FxHashMap<&'a str, Global>,
    /// The names of `system`.
    pub instances: Vec<&'a ast::Instance>,
    /// All definitions.
    pub definitions: Vec<Definition<'a>>,
    /// Those that are being worked on, outermost first.
    pub running: Vec<usize>,
    /// How deep the expression that is being lowered lies, over the definitions around it.
    pub depth: usize,
    /// By agent type.
    pub agents: Vec<AgentNames<'a>>,
    /// By interaction.
    pub pairs: Vec<PairNames<'a>>,
    /// By function.
    pub signatures: Vec<Signature>,
    /// Lists, by the numbers in their types.
    pub lists: Vec<super::types::List>,
    /// Values of parameters that are texts.
    pub texts: Vec<String>,
    /// `-p NAME=VALUE`, and whether a parameter has taken it.
    pub overrides: Vec<(String, String)>,
    /// Parameters and discrete variables whose values some block takes from a data file.
    pub from_data: FxHashSet<(TypeId, VarRef)>,
    /// Something imported could not be read, so what seems to be missing may be there.
    pub imports: bool,
    /// What has been found wrong.
    pub findings: Findings,
    /// Evaluates constants, within a budget.
    pub evaluator: Evaluator,
}

impl<'a> Context<'a> {
    /// A context without names.
    pub fn new(sources: &'a mut SourceMap, files: &'a mut dyn Files, settings: &super::Settings) -> Self {
        Self {
            sources,
            files,
            opened: FxHashMap::default(),
            model: Model { limits: settings.limits, ..Model::default() },
            facts: Vec::new(),
            quantities: Quantities::default(),
            goals: Vec::new(),
            globals: FxHashMap::default(),
            instances: Vec::new(),
            definitions: Vec::new(),
            running: Vec::new(),
            depth: 0,
            agents: Vec::new(),
            pairs: Vec::new(),
            signatures: Vec::new(),
            lists: Vec::new(),
            texts: Vec::new(),
            overrides: settings.params.clone(),
            from_data: FxHashSet::default(),
            imports: false,
            findings: Findings::default(),
            evaluator: Evaluator::new(settings.limits.evaluations_max),
        }
    }

    /// Adds a diagnostic.
    pub fn report(&mut self, error: impl Into<Diagnostic>) {
        self.findings.push(error.into());
    }

    /// Whether anything is wrong so far.
    pub fn has_errors(&self) -> bool {
        self.findings.has_errors()
    }

    /// The outcome, its diagnostics in the order of the text.
    pub fn finish(self, warnings: Vec<Diagnostic>) -> super::Checked {
        let model = if self.has_errors() { None } else { Some(self.model) };
        let (diagnostics, warnings) = (self.findings.told(), Findings::from(warnings).told());
        if model.is_some() {
            let labels = || diagnostics.iter().chain(&warnings).flat_map(|diagnostic| &diagnostic.labels);
            for &data in self.opened.values() {
                if labels().all(|label| label.span.file != data) {
                    self.sources.forget(data);
                }
            }
        }
        super::Checked { model, diagnostics, warnings }
    }

    /// A type in words.
    pub fn describe(&self, ty: Ty) -> String {
        ty.describe(&self.model.types)
    }

    /// Adds an expression.
    pub fn push(&mut self, kind: ExprKind, ty: Ty, span: Span) -> Value {
        let facts = self.facts_of(&kind, ty);
        self.facts.push(facts);
        Value { id: self.model.exprs.push(Expr { kind, ty: ty.ir(), span }), ty }
    }

    /// Adds an operator.
    pub fn apply(&mut self, op: Op, operands: impl Into<Operands>, ty: Ty, span: Span) -> Value {
        self.push(ExprKind::Apply(op, operands.into()), ty, span)
    }

    /// Adds a number.
    pub fn number(&mut self, value: f64, ty: Ty, span: Span) -> Value {
        self.push(ExprKind::Number(value), ty, span)
    }

    /// Adds a number without a unit.
    pub fn bare_number(&mut self, value: f64, ty: Ty, span: Span) -> Value {
        let number = self.number(value, ty, span);
        self.facts[number.id.index()].bare = true;
        number
    }

    /// Asks for the dimension of what a value goes into; nothing if that has none.
    pub fn expect(&mut self, value: Value, slot: Slot, what: &str) {
        if slot.unit.is_some() && value.ty != Ty::Wrong {
            self.goals.push(Goal { value: value.id, slot, what: what.to_string() });
        }
    }

    /// Stands for something that has been reported.
    pub fn wrong(&mut self, span: Span) -> Value {
        self.push(ExprKind::Number(0.0), Ty::Wrong, span)
    }

    /// The facts of an expression whose operands have theirs.
    fn facts_of(&self, kind: &ExprKind, ty: Ty) -> Facts {
        let mut facts = Facts { closed: true, pure: true, ..Facts::default() };
        for_each_operand(kind, |id| {
            let operand = self.facts[id.index()];
            facts.closed &= operand.closed;
            facts.pure &= operand.pure;
            facts.varies |= operand.varies;
            facts.varies_with_locals |= operand.varies_with_locals;
            facts.quantified |= operand.quantified;
        });
        let real = ty == Ty::Real;
        match kind {
            ExprKind::Number(_) => {}
            ExprKind::Local(_) => {
                facts.closed = false;
                facts.varies_with_locals = real;
            }
            ExprKind::Apply(Op::Select, operands) => {
                let (then, otherwise) = (self.facts[operands[1].index()], self.facts[operands[2].index()]);
                facts.varies = then.varies || otherwise.varies;
                facts.varies_with_locals = then.varies_with_locals || otherwise.varies_with_locals;
            }
            ExprKind::Apply(..) => {}
            ExprKind::Call(function, args) => {
                let body = self.facts[self.model.functions[*function].body.index()];
                let any =
                    |property: fn(&Facts) -> bool| args.iter().any(|arg| property(&self.facts[arg.index()]));
                facts.closed &= body.pure;
                facts.pure &= body.pure;
                facts.varies = body.varies || (body.varies_with_locals && any(|arg| arg.varies));
                facts.varies_with_locals = body.varies_with_locals && any(|arg| arg.varies_with_locals);
                facts.quantified |= body.quantified;
            }
            ExprKind::State(..) | ExprKind::Rate(..) | ExprKind::Time | ExprKind::Crossing(_) => {
                facts = Facts { varies: true, ..Facts::default() };
            }
            ExprKind::Let(agent, number) => {
                let value =
                    self.let_value(*agent, *number).map_or(Facts::default(), |id| self.facts[id.index()]);
                facts = Facts { varies: value.varies, quantified: value.quantified, ..Facts::default() };
            }
            ExprKind::Aggregate { term, .. } => {
                let term = term.map_or(Facts::default(), |term| self.facts[term.index()]);
                facts = Facts {
                    varies: term.varies,
                    varies_with_locals: term.varies_with_locals,
                    quantified: true,
                    ..Facts::default()
                };
            }
            ExprKind::Quantifier { .. } => {
                facts.closed = false;
                facts.pure = false;
                facts.quantified = true;
            }
            ExprKind::Received(_)
            | ExprKind::SelfAgent
            | ExprKind::Participant(_)
            | ExprKind::Bound(_)
            | ExprKind::NoAgent
            | ExprKind::Link(..)
            | ExprKind::Discrete(..)
            | ExprKind::AgentParam(..)
            | ExprKind::Present(_)
            | ExprKind::Same(..)
            | ExprKind::Is(..)
            | ExprKind::Rising(_) => {
                facts.closed = false;
                facts.pure = false;
            }
        }
        facts.varies &= real;
        facts.varies_with_locals &= real;
        facts
    }

    /// The definition behind a `let` of an agent.
    pub fn let_value(&self, agent: ExprId, number: usize) -> Option<ExprId> {
        let ty = Ty::from(self.model.exprs[agent].ty).agent_type()?;
        self.model.types[ty].lets.get(number).map(|item| item.value)
    }

    /// The value of a closed expression.
    pub fn evaluate_closed(&mut self, id: ExprId) -> Option<f64> {
        let result = self.evaluator.evaluate(&self.model, id, &super::evaluate::Known::default());
        if result.is_none() {
            let span = self.model.exprs[id].span;
            self.report(super::error::LimitError::Steps { span });
        }
        result
    }
}
