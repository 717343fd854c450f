//! Pass 4: no flow and no hazard reads an agent that may not be there, and no rate depends on itself.
//!
//! A loop over all expressions, operands first. For each it finds which links must lead somewhere if the value is to
//! be one (`need`), which certainly do if it is true (`if_true`) and if it is false (`if_false`): a link that is tested by `if`,
//! `and` or `or` is needed only where the test leaves it open. A `let` or a function has its own list, read with the caller's
//! agents. Rule 10 of the language reference; guards may read an agent that is not there, and compare with NaN.

use rustc_hash::FxHashMap;

use super::context::Context;
use super::error::{ModeError, NameError};
use super::ir::{BinderId, ExprId, ExprKind, Model, Trigger, TypeId};
use super::operands::for_each_operand;
use super::order::find_circle;
use super::types::Ty;
use crate::base::Span;
use crate::math::Op;

/// Where a path of links begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Root {
    Own,
    Participant(usize),
    Bound(usize),
    Local(usize),
    Nobody,
}

/// An agent, reached over links by their numbers.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Path {
    root: Root,
    links: Vec<usize>,
}

/// What is known about one expression; most need nothing, and have no entry.
#[derive(Clone, Debug, Default)]
struct Needs {
    need: Vec<(Path, Span)>,
    if_true: Vec<Path>,
    if_false: Vec<Path>,
    rates: Vec<(TypeId, usize)>,
}

type Table = FxHashMap<ExprId, Needs>;

/// Checks all flows.
pub(super) fn check_presence(context: &mut Context) {
    let mut table = Table::default();
    for id in context.model.exprs.indices() {
        let needs = needs_of(&context.model, &table, id);
        if needs.is_something() {
            table.insert(id, needs);
        }
    }
    let mut errors = Vec::new();
    for (own, ty) in context.model.types.iter_enumerated() {
        for mode in &ty.modes {
            for &(state, rate, span) in &mode.flow {
                let Some((path, read)) = table.get(&rate).and_then(|needs| needs.need.first()) else {
                    continue;
                };
                let (state, path) = (ty.states[state].name.clone(), path.describe(&context.model, own));
                errors.push(ModeError::NoneInFlow { state, path, read: *read, flow: span });
            }
        }
    }
    for (own, ty) in context.model.types.iter_enumerated() {
        for transition in &ty.transitions {
            let Trigger::Rate { claim, .. } = transition.trigger else { continue };
            if let Some((path, read)) = table.get(&claim).and_then(|needs| needs.need.first()) {
                let (label, path) = (transition.label.clone(), path.describe(&context.model, own));
                errors.push(ModeError::NoneInRate { label, path, read: *read });
            }
        }
    }
    errors.into_iter().for_each(|error| context.report(error));
    check_rates(context, &table);
}

/// No rate may need itself, over `x'` in its own flow or in what the flow reads.
fn check_rates(context: &mut Context, table: &Table) {
    let model = &context.model;
    let firsts = model.types.iter().scan(0, |first, ty| {
        let own = *first;
        *first += ty.states.len();
        Some(own)
    });
    let firsts = firsts.collect::<Vec<_>>();
    let mut needs = vec![Vec::new(); model.types.iter().map(|ty| ty.states.len()).sum()];
    for (id, ty) in model.types.iter_enumerated() {
        for (state, rate, _) in ty.modes.iter().flat_map(|mode| &mode.flow) {
            let rates = table.get(rate).map(|needs| needs.rates.as_slice()).unwrap_or_default();
            needs[firsts[id.index()] + state]
                .extend(rates.iter().map(|(ty, state)| firsts[ty.index()] + state));
        }
    }
    if let Some(circle) = find_circle(&needs) {
        let states = model.types.iter().flat_map(|ty| &ty.states).collect::<Vec<_>>();
        let names = circle.iter().map(|&k| (format!("{}'", states[k].name), states[k].span)).collect();
        context.report(NameError::Circle { names, what: "rates need each other in a circle" });
    }
}

fn needs_of(model: &Model, table: &Table, id: ExprId) -> Needs {
    let expr = &model.exprs[id];
    let mut needs = Needs::default();
    match &expr.kind {
        ExprKind::Apply(Op::Not, operands) => {
            needs.join_all(table, &expr.kind);
            let of = table.get(&operands[0]).cloned().unwrap_or_default();
            (needs.if_true, needs.if_false) = (of.if_false, of.if_true);
        }
        ExprKind::Apply(Op::And, operands) => {
            let (a, b) = (get(table, operands[0]), get(table, operands[1]));
            needs.join(&a, &[]);
            needs.join(&b, &a.if_true);
            needs.if_true = union(a.if_true, b.if_true);
        }
        ExprKind::Apply(Op::Or, operands) => {
            let (a, b) = (get(table, operands[0]), get(table, operands[1]));
            needs.join(&a, &[]);
            needs.join(&b, &a.if_false);
            needs.if_false = union(a.if_false, b.if_false);
        }
        ExprKind::Apply(Op::Select, operands) => {
            let test = get(table, operands[0]);
            needs.join(&test, &[]);
            needs.join(&get(table, operands[1]), &test.if_true);
            needs.join(&get(table, operands[2]), &test.if_false);
        }
        ExprKind::Present(agent) => needs.if_true.extend(path_of(model, *agent)),
        ExprKind::Is(agent, _) => needs.if_true.extend(path_of(model, *agent)),
        ExprKind::State(agent, _) | ExprKind::Discrete(agent, _) | ExprKind::AgentParam(agent, _) => {
            needs.read(model, *agent, expr.span);
        }
        ExprKind::Rate(agent, state) => {
            needs.read(model, *agent, expr.span);
            needs.rates.extend(Ty::from(model.exprs[*agent].ty).agent_type().map(|ty| (ty, *state)));
        }
        ExprKind::Let(agent, number) => {
            needs.read(model, *agent, expr.span);
            let ty = Ty::from(model.exprs[*agent].ty).agent_type();
            let value = ty.and_then(|ty| model.types[ty].lets.get(*number)).map(|item| item.value);
            if let (Some(value), Some(path)) = (value, path_of(model, *agent)) {
                needs.inherit(
                    &get(table, value),
                    |root| (root == Root::Own).then(|| path.clone()),
                    expr.span,
                );
            }
        }
        ExprKind::Call(function, args) => {
            needs.join_all(table, &expr.kind);
            let replace = |root| match root {
                Root::Local(number) => args.get(number).and_then(|arg| path_of(model, *arg)),
                Root::Own | Root::Participant(_) | Root::Bound(_) | Root::Nobody => None,
            };
            needs.inherit(&get(table, model.functions[*function].body), replace, expr.span);
        }
        ExprKind::Apply(..)
        | ExprKind::Quantifier { .. }
        | ExprKind::Aggregate { .. }
        | ExprKind::Rising(_)
        | ExprKind::Crossing(_) => needs.join_all(table, &expr.kind),
        ExprKind::Number(_)
        | ExprKind::Time
        | ExprKind::Local(_)
        | ExprKind::Received(_)
        | ExprKind::SelfAgent
        | ExprKind::Participant(_)
        | ExprKind::Bound(_)
        | ExprKind::NoAgent
        | ExprKind::Link(..)
        | ExprKind::Same(..) => {}
    }
    needs
}

fn get(table: &Table, id: ExprId) -> Needs {
    table.get(&id).cloned().unwrap_or_default()
}

fn union(mut a: Vec<Path>, b: Vec<Path>) -> Vec<Path> {
    a.extend(b);
    a.sort_unstable();
    a.dedup();
    a
}

/// The path that an expression for an agent stands for.
fn path_of(model: &Model, agent: ExprId) -> Option<Path> {
    let mut links = Vec::new();
    let mut agent = agent;
    let root = loop {
        match &model.exprs[agent].kind {
            ExprKind::Link(of, number) => {
                links.push(*number);
                agent = *of;
            }
            ExprKind::SelfAgent => break Root::Own,
            ExprKind::Participant(number) => break Root::Participant(*number),
            ExprKind::Bound(binder) => break Root::Bound(binder.index()),
            ExprKind::Local(number) => break Root::Local(*number),
            ExprKind::NoAgent => break Root::Nobody,
            _ => return None,
        }
    };
    links.reverse();
    Some(Path { root, links })
}

impl Needs {
    fn is_something(&self) -> bool {
        !(self.need.is_empty()
            && self.if_true.is_empty()
            && self.if_false.is_empty()
            && self.rates.is_empty())
    }

    /// Adds what an operand needs, but for what is certainly there.
    fn join(&mut self, operand: &Needs, there: &[Path]) {
        let open = operand.need.iter().filter(|(path, _)| !there.contains(path));
        for (path, span) in open {
            self.add(path.clone(), *span);
        }
        self.add_rates(operand);
    }

    fn join_all(&mut self, table: &Table, kind: &ExprKind) {
        for_each_operand(kind, |operand| {
            if let Some(needs) = table.get(&operand) {
                self.join(needs, &[]);
            }
        });
    }

    fn add_rates(&mut self, operand: &Needs) {
        self.rates.extend(&operand.rates);
        self.rates.sort_unstable();
        self.rates.dedup();
    }

    fn add(&mut self, path: Path, span: Span) {
        if !self.need.iter().any(|(other, _)| *other == path) {
            self.need.push((path, span));
        }
    }

    /// A member of an agent is read: every link on the way there that may be none must not be.
    fn read(&mut self, model: &Model, agent: ExprId, span: Span) {
        let mut at = agent;
        loop {
            let expr = &model.exprs[at];
            let open = matches!(Ty::from(expr.ty), Ty::Link(_)) || matches!(expr.kind, ExprKind::NoAgent);
            if let (true, Some(path)) = (open, path_of(model, at)) {
                self.add(path, span);
            }
            let ExprKind::Link(of, _) = expr.kind else { return };
            at = of;
        }
    }

    /// Adds what a definition needs, its agents replaced by those of the place where it is used.
    fn inherit(&mut self, definition: &Needs, replace: impl Fn(Root) -> Option<Path>, span: Span) {
        let moved = |path: &Path| {
            let Some(mut base) = replace(path.root) else { return path.clone() };
            base.links.extend(&path.links);
            base
        };
        for (path, _) in &definition.need {
            let path = moved(path);
            // An agent that cannot be none satisfies a function that would take none as well.
            let certain = path.links.is_empty() && !matches!(path.root, Root::Local(_) | Root::Nobody);
            if !certain {
                self.add(path, span);
            }
        }
        self.if_true.extend(definition.if_true.iter().map(moved));
        self.if_false.extend(definition.if_false.iter().map(moved));
        self.add_rates(definition);
    }
}

impl Path {
    /// As a user of this agent type would write it.
    fn describe(&self, model: &Model, own: TypeId) -> String {
        let (mut names, mut ty) = match self.root {
            Root::Own => (Vec::new(), Some(own)),
            Root::Bound(number) => {
                let binder = &model.binders[BinderId::new(number)];
                (vec![binder.name.as_str()], Some(binder.ty))
            }
            Root::Participant(_) | Root::Local(_) | Root::Nobody => (vec!["none"], None),
        };
        for &number in &self.links {
            let Some(link) = ty.and_then(|ty| model.types[ty].links.get(number)) else { break };
            names.push(&link.name);
            ty = Some(link.ty);
        }
        names.join(".")
    }
}
