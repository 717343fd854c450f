//! Transitions of agents and interactions: triggers, guards with their witnesses, targets, labels.
//!
//! Logs call a transition `Type.label`. One without a label is called by the names of its source and target,
//! `Car.Cruise->Follow`, or without a target by its place among the transitions of its mode, from 1: `Car.Cruise#2`. The
//! source of one that stands outside the modes is written `*`: `Car.*->Avoid`, `Car.*#1`; that of an interaction too.
//! A second one of the same name gets `#2` behind it.

use rustc_hash::{FxHashMap, FxHashSet};

use super::actions::Written;
use super::context::{Context, Home, Scope, Value};
use super::dimension::Dimension;
use super::error::{ActionError, InteractionError, ModeError, NameError, TypeError};
use super::events::Heard;
use super::ir::{BinderId, ExprId, ExprKind, ModeId, Transition, Trigger, TypeId};
use super::operands::for_each_operand;
use super::types::{Slot, Ty};
use crate::base::Span;
use crate::math::Op;
use crate::syntax::ast::{self, BodyItem, InteractionItem, TriggerKind};

/// A guard with the agents that its actions may name.
struct Guard<'a> {
    condition: Value,
    witnesses: Vec<(&'a str, BinderId)>,
}

/// Whether `rising` and `crossing` may stand in a guard.
#[derive(Clone, Copy)]
enum Edges {
    Allowed,
    Refused,
}

/// The names that transitions of one owner have so far.
#[derive(Default)]
struct Labels {
    owner: String,
    taken: FxHashMap<String, Span>,
    /// How many transitions without a label have each name.
    counts: FxHashMap<String, usize>,
}

/// Fills in every interaction.
pub(super) fn fill_interactions(context: &mut Context) {
    for number in 0..context.pairs.len() {
        context.fill_interaction(number);
    }
}

impl<'a> Context<'a> {
    /// Fills in the transitions of all modes, in order of declaration.
    pub fn fill_transitions(&mut self, ty: TypeId) {
        let mut items: Vec<(ModeId, usize, &'a ast::Transition)> = Vec::new();
        for number in 0..self.model.types[ty].modes.len() {
            let mode = ModeId::new(number);
            let transitions = self.mode_items(ty, mode).into_iter().filter_map(|item| match item {
                BodyItem::Transition(item) => Some(&**item),
                _ => None,
            });
            items.extend(transitions.enumerate().map(|(k, item)| (mode, k + 1, item)));
        }
        items.sort_by_key(|(_, _, item)| item.span);
        let mut labels = Labels { owner: self.model.types[ty].name.clone(), ..Labels::default() };
        for (mode, ordinal, item) in items {
            let target = match &item.target {
                Some(path) => match self.resolve_destination(ty, mode, path) {
                    Some(target) => Some(target),
                    None => {
                        self.transition(Home::Agent(ty, mode), mode, item);
                        continue;
                    }
                },
                None => None,
            };
            let Some(transition) = self.transition(Home::Agent(ty, mode), mode, item) else { continue };
            let modes = &self.model.types[ty].modes;
            let source = if mode.index() == 0 { "*" } else { &modes[mode].name };
            let target_name = target.map(|target| format!("{}{}", modes[target.mode].name, target.suffix()));
            let label = labels.name(item, source, target_name.as_deref(), ordinal);
            let label = self.take_label(label);
            self.model.types[ty].transitions.push(Transition { label, target, ..transition });
        }
    }

    fn take_label(&mut self, label: Result<String, NameError>) -> String {
        label.unwrap_or_else(|error| {
            self.report(error);
            String::new()
        })
    }

    fn fill_interaction(&mut self, number: usize) {
        let item = self.pairs[number].item;
        let mut labels = Labels { owner: item.name.text.clone(), ..Labels::default() };
        let transitions = item.items.iter().filter_map(|part| match part {
            InteractionItem::Transition(item) => Some(item),
            InteractionItem::Let(_) => None,
        });
        for (k, item) in transitions.enumerate() {
            if let Some(target) = &item.target {
                let names = &self.pairs[number].participants;
                let name = names.map_or("a", |participants| participants[0].0);
                let help = format!(
                    "say whose mode, as an action: `{{ {name} -> {} }}`",
                    self.sources.text(target.span)
                );
                let why = "an interaction has two participants, so `->` behind its guard names neither";
                self.report(ActionError::ModeChange { span: target.span, why, help });
            }
            match item.trigger.kind {
                TriggerKind::When | TriggerKind::After(_) | TriggerKind::Every(_) | TriggerKind::Rate(_) => {}
                TriggerKind::On { .. } => {
                    self.report(InteractionError::Hears { span: item.trigger.span });
                    continue;
                }
            }
            let Some(transition) = self.transition(Home::Pair(number), ModeId::new(0), item) else {
                continue;
            };
            let label = labels.name(item, "*", None, k + 1);
            let label = self.take_label(label);
            if let Some(id) = self.pairs[number].id {
                self.model.interactions[id].transitions.push(Transition { label, ..transition });
            }
        }
    }

    /// Everything but label and target; none if the trigger is not supported.
    fn transition(&mut self, home: Home, source: ModeId, item: &'a ast::Transition) -> Option<Transition> {
        let mut scope = Scope::of(home);
        let heard = match &item.trigger.kind {
            TriggerKind::On { event, binders, sender } => {
                Some(self.hearing(&mut scope, event, binders, sender.as_deref()))
            }
            TriggerKind::When | TriggerKind::After(_) | TriggerKind::Every(_) | TriggerKind::Rate(_) => None,
        };
        // What an `on` waits for is asked when its message comes, a hazard is there while its guard is true: nothing rises or crosses.
        let edges = match item.trigger.kind {
            TriggerKind::On { .. } | TriggerKind::Rate(_) => Edges::Refused,
            TriggerKind::When | TriggerKind::After(_) | TriggerKind::Every(_) => Edges::Allowed,
        };
        scope.received = heard.as_ref().map_or(Vec::new(), |heard| heard.received.clone());
        let guard = item.trigger.guard.as_ref().map(|guard| self.guard(&mut scope, guard, edges));
        let condition = guard.as_ref().map(|guard| guard.condition.id);
        let trigger = match &item.trigger.kind {
            TriggerKind::When => Trigger::When(condition.unwrap_or_else(|| self.wrong(item.trigger.span).id)),
            TriggerKind::After(delay) => {
                let delay = self.duration(&mut scope, delay, "a delay", "0 s or more", |delay| delay >= 0.0);
                Trigger::After(delay.id, condition)
            }
            TriggerKind::Every(period) => {
                let period =
                    self.duration(&mut scope, period, "a period", "more than 0 s", |period| period > 0.0);
                Trigger::Every(period.id, condition)
            }
            TriggerKind::Rate(rate) => self.hazard(&mut scope, rate, condition),
            TriggerKind::On { .. } => {
                let Heard { events, from, .. } = heard?;
                Trigger::On { events, from, guard: condition }
            }
        };
        let witnesses = guard.map(|guard| guard.witnesses).unwrap_or_default();
        scope.bound.extend(&witnesses);
        let priority = item.priority.as_ref().map(|priority| {
            let slot = Slot::of(Dimension::ONE);
            self.lower_into(&mut scope, priority, slot, "a priority").id
        });
        let mut written = Written::default();
        let actions = item.actions.as_ref().map(|list| self.actions(&mut scope, list, &mut written));
        Some(Transition {
            label: String::new(),
            source,
            trigger,
            priority,
            target: None,
            actions: actions.unwrap_or_default(),
            witnesses: witnesses.into_iter().map(|(_, binder)| binder).collect(),
            span: item.span,
        })
    }

    /// A delay or a period; a diagnostic if it is a constant that is not allowed.
    pub fn duration(
        &mut self,
        scope: &mut Scope<'a>,
        expr: &'a ast::Expr,
        what: &'static str,
        needs: &'static str,
        allowed: fn(f64) -> bool,
    ) -> Value {
        let value = self.lower_into(scope, expr, Slot::of(Dimension::TIME), what);
        if value.ty != Ty::Wrong
            && self.facts[value.id.index()].closed
            && let Some(seconds) = self.evaluate_closed(value.id)
            && !allowed(seconds)
        {
            self.report(ModeError::BadPeriod { what, needs, span: expr.span, value: seconds });
        }
        value
    }

    /// A hazard, which is not negative where the guard is true.
    fn hazard(&mut self, scope: &mut Scope<'a>, expr: &'a ast::Expr, guard: Option<ExprId>) -> Trigger {
        let per_time = Slot::of(Dimension::ONE).per_time();
        let rate = self.lower_into(scope, expr, per_time, "a rate");
        let facts = self.facts[rate.id.index()];
        if rate.ty != Ty::Wrong
            && facts.closed
            && let Some(value) = self.evaluate_closed(rate.id)
            && !(value >= 0.0 && value.is_finite())
        {
            self.report(ModeError::BadRate { span: expr.span, value });
        }
        let zero = self.number(0.0, Ty::Real, expr.span);
        let mut claim = self.apply(Op::Le, [zero.id, rate.id], Ty::Bool, expr.span).id;
        if let Some(guard) = guard {
            let not = self.apply(Op::Not, [guard], Ty::Bool, expr.span).id;
            claim = self.apply(Op::Or, [not, claim], Ty::Bool, expr.span).id;
        }
        Trigger::Rate { rate: rate.id, guard, claim, flows: self.flows(rate.id) }
    }

    /// Whether an expression may change while nothing is written: whether it reads a state, a rate, the time or a set.
    fn flows(&self, root: ExprId) -> bool {
        let (mut pending, mut seen) = (vec![root], FxHashSet::default());
        while let Some(id) = pending.pop() {
            if !seen.insert(id) {
                continue;
            }
            let expr = &self.model.exprs[id];
            match expr.kind {
                ExprKind::State(..) | ExprKind::Rate(..) | ExprKind::Time => return true,
                ExprKind::Quantifier { .. } | ExprKind::Aggregate { .. } => return true,
                ExprKind::Let(agent, number) => pending.extend(self.let_value(agent, number)),
                ExprKind::Call(function, _) => pending.push(self.model.functions[function].body),
                _ => {}
            }
            for_each_operand(&expr.kind, |operand| pending.push(operand));
        }
        false
    }

    /// A guard. An `exists` that is all of it, or a term of its outermost `and`, gives its agent to the actions.
    fn guard(&mut self, scope: &mut Scope<'a>, expr: &'a ast::Expr, edges: Edges) -> Guard<'a> {
        let terms = match &expr.kind {
            ast::ExprKind::And(terms) => terms.as_slice(),
            _ => std::slice::from_ref(expr),
        };
        let lower = match edges {
            Edges::Allowed => Self::lower_guard,
            Edges::Refused => Self::lower_condition,
        };
        let values = terms.iter().map(|term| lower(self, scope, term)).collect::<Vec<_>>();
        let mut witnesses: Vec<(&'a str, BinderId)> = Vec::new();
        for (term, value) in terms.iter().zip(&values) {
            let ast::ExprKind::Quantifier(item) = &term.kind else { continue };
            if let (ast::QuantifierKind::Nearest, ExprKind::Present(link)) =
                (item.kind, &self.model.exprs[value.id].kind)
            {
                let (link, ty) = (*link, self.model.exprs[*link].ty);
                scope.nearest.push((&item.binder.text, Value { id: link, ty: Ty::from(ty) }));
                continue;
            }
            let ExprKind::Quantifier { kind: super::ir::Quantifier::Exists, binder, .. } =
                self.model.exprs[value.id].kind
            else {
                continue;
            };
            let name = item.binder.text.as_str();
            match terms.iter().find(|other| binds(other, name) && other.span != term.span) {
                Some(first) if witnesses.iter().any(|(other, _)| *other == name) => {
                    let (name, span) = (name.to_string(), item.binder.span);
                    self.report(NameError::Taken { name, span, first: first.span });
                }
                _ => witnesses.push((name, binder)),
            }
        }
        Guard { condition: self.join_terms(Op::And, terms, values, expr.span), witnesses }
    }

    /// A condition in which `rising` and `crossing` may stand.
    fn lower_guard(&mut self, scope: &mut Scope<'a>, expr: &'a ast::Expr) -> Value {
        let span = expr.span;
        match &expr.kind {
            ast::ExprKind::And(terms) | ast::ExprKind::Or(terms) => {
                let op = if matches!(expr.kind, ast::ExprKind::And(_)) { Op::And } else { Op::Or };
                let values = terms.iter().map(|term| self.lower_guard(scope, term)).collect();
                self.join_terms(op, terms, values, span)
            }
            ast::ExprKind::Unary(ast::UnaryOp::Not, operand) => {
                let value = self.lower_guard(scope, operand);
                self.apply(Op::Not, [value.id], value.ty, span)
            }
            ast::ExprKind::Call { callee, args } => match &callee.kind {
                ast::ExprKind::Name(name) if name == "rising" || name == "crossing" => {
                    self.lower_edge(scope, name, args, span)
                }
                _ => self.lower_condition(scope, expr),
            },
            _ => self.lower_condition(scope, expr),
        }
    }

    fn lower_edge(&mut self, scope: &mut Scope<'a>, name: &str, args: &'a [ast::Expr], span: Span) -> Value {
        let [arg] = args else {
            let (function, found) = (name.to_string(), args.len());
            self.report(TypeError::Arguments { function, least: 1, most: 1, found, span });
            return self.wrong(span);
        };
        let (value, kind): (Value, fn(ExprId) -> ExprKind) = if name == "rising" {
            (self.lower_condition(scope, arg), ExprKind::Rising)
        } else {
            (self.lower_number(scope, arg, name), ExprKind::Crossing)
        };
        if value.ty == Ty::Wrong {
            return self.wrong(span);
        }
        self.push(kind(value.id), Ty::Bool, span)
    }
}

/// Whether a term of a guard is a quantifier that binds this name.
fn binds(term: &ast::Expr, name: &str) -> bool {
    matches!(&term.kind, ast::ExprKind::Quantifier(item) if item.binder.text == name)
}

impl Labels {
    /// The name of the next transition.
    fn name(
        &mut self,
        item: &ast::Transition,
        source: &str,
        target: Option<&str>,
        ordinal: usize,
    ) -> Result<String, NameError> {
        let owner = &self.owner;
        if let Some(label) = &item.label {
            let full = format!("{owner}.{}", label.text);
            return match self.taken.insert(full.clone(), label.span) {
                Some(first) => Err(NameError::Taken { name: label.text.clone(), span: label.span, first }),
                None => Ok(full),
            };
        }
        let plain = match target {
            Some(target) => format!("{owner}.{source}->{target}"),
            None => format!("{owner}.{source}#{ordinal}"),
        };
        let mut full = plain.clone();
        let count = self.counts.entry(plain.clone()).or_insert(1);
        while self.taken.contains_key(&full) {
            *count += 1;
            full = format!("{plain}#{count}");
        }
        self.taken.insert(full.clone(), item.span);
        Ok(full)
    }
}
