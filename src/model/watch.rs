//! What watches a run: the conditions of properties, and of `stop when`, as those of an agent that nobody sees.
//!
//! Such a condition is a condition of an agent that has no variables: it reads others by quantifiers and by name, and the time. So it is checked
//! and compiled like any other, and the agent, [`ir::Watch::ty`](super::ir::Watch), is there from t = 0 on, outside of `system`.

use super::context::{Context, GlobalKind, Home, Scope, Value};
use super::dimension::Dimension;
use super::error::{NameError, PropertyError};
use super::ir::{ExprKind, Formula, Link, Property, TypeId, Watch};
use super::types::{Slot, Ty};
use crate::base::Span;
use crate::syntax::ast::{self, AgentItem, BodyItem, FormulaKind, Item, RunSettingKind};

/// The name of the type; no other can have it.
const NAME: &str = "run";

/// The agent that watches, if there is anything to watch: an assert for each condition of the properties, in order, and a
/// transition that stops the run.
pub(super) fn watcher<'a>(items: impl Iterator<Item = &'a Item>) -> Option<Item> {
    let mut body = Vec::new();
    let mut first = None;
    for item in items {
        match item {
            Item::Property(property) => {
                first = first.or(Some(property.span));
                conditions(&property.formula, &mut |condition| body.push(claim(condition)));
            }
            Item::Run(run) => {
                let settings = run.settings.iter().filter_map(|setting| match &setting.kind {
                    RunSettingKind::StopWhen(condition) => Some(stop(condition, setting.span)),
                    _ => None,
                });
                let before = body.len();
                body.extend(settings);
                first = first.or((body.len() > before).then_some(run.span));
            }
            _ => {}
        }
    }
    let span = first?;
    let name = ast::Name { text: NAME.into(), span };
    let items = body.into_iter().map(AgentItem::Body).collect();
    Some(Item::Agent(Box::new(ast::Agent { name, formals: Vec::new(), items, span })))
}

/// Calls `visit` with every condition of a formula, in the order of the text.
fn conditions<'a>(formula: &'a ast::Formula, visit: &mut dyn FnMut(&'a ast::Expr)) {
    match &formula.kind {
        FormulaKind::Always(_, inner) | FormulaKind::Eventually(_, inner) => conditions(inner, visit),
        FormulaKind::Until { before, goal, .. } => {
            visit(before);
            visit(goal);
        }
        FormulaKind::Holds(condition) => visit(condition),
    }
}

fn claim(condition: &ast::Expr) -> BodyItem {
    let claim = ast::Claim { condition: condition.clone(), message: None, span: condition.span };
    BodyItem::Assert(Box::new(claim))
}

fn stop(condition: &ast::Expr, span: Span) -> BodyItem {
    let stop = ast::Action { kind: ast::ActionKind::Stop(None), span };
    BodyItem::Transition(Box::new(ast::Transition {
        label: None,
        trigger: ast::Trigger { kind: ast::TriggerKind::When, guard: Some(condition.clone()), span },
        priority: None,
        target: None,
        actions: Some(ast::Actions { actions: vec![stop], span }),
        span,
    }))
}

/// Fills in what the model watches; the agent is among the types.
pub(super) fn fill<'a>(context: &mut Context<'a>, items: &[&'a Item]) {
    let Some(ty) = context.model.types.indices().find(|&ty| context.is_watcher(ty)) else { return };
    let mut properties: Vec<Property> = Vec::new();
    let mut n_conditions = 0;
    for item in items {
        let Item::Property(property) = item else { continue };
        let name = property.name.text.clone();
        if let Some(first) = properties.iter().find(|known| known.name == name) {
            let (first, span) = (first.span, property.name.span);
            context.report(NameError::Taken { name: name.clone(), span, first });
        }
        let formula = context.formula(&property.formula, &mut n_conditions);
        properties.push(Property { name, formula, span: property.name.span });
    }
    let named = context.named_agents(ty);
    context.model.watch = Some(Watch { ty, named, properties });
}

impl<'a> Context<'a> {
    /// Whether a type is that of the agent that nobody sees.
    pub fn is_watcher(&self, ty: TypeId) -> bool {
        self.model.types[ty].name == NAME
    }

    /// The agent that a name of `system` stands for in the condition of a property: a link of whoever watches leads to it, for as long
    /// as it lives. None if that is no agent, or there may be several.
    pub fn lower_single(&mut self, home: Home, kind: GlobalKind, name: &str, span: Span) -> Option<Value> {
        let Home::Agent(watcher, _) = home else { return None };
        if !(self.is_watcher(watcher) && matches!(kind, GlobalKind::Instance)) {
            return None;
        }
        let instance = *self.instances.iter().find(|instance| instance.name.text == name)?;
        if instance.constructor.count.is_some() {
            return None;
        }
        let ty = self.agent_named(&instance.constructor.agent)?;
        let links = &mut self.model.types[watcher].links;
        let known = links.iter().position(|link| link.name == name);
        let link = known.unwrap_or_else(|| {
            links.push(Link { name: name.to_string(), ty, required: false, cases: Vec::new(), span });
            links.len() - 1
        });
        let itself = self.push(ExprKind::SelfAgent, Ty::Agent(watcher), span);
        Some(self.push(ExprKind::Link(itself.id, link), Ty::Link(ty), span))
    }

    /// The links of whoever watches to agents that are named, each with the number of the name in `system`.
    fn named_agents(&self, watcher: TypeId) -> Vec<(usize, usize)> {
        let links =
            self.model.types[watcher].links.iter().enumerate().filter(|(_, link)| link.cases.is_empty());
        let block = |link: &Link| self.instances.iter().position(|instance| instance.name.text == link.name);
        links.filter_map(|(number, link)| Some((number, block(link)?))).collect()
    }

    /// A formula whose first condition has this number.
    fn formula(&mut self, formula: &'a ast::Formula, next: &mut usize) -> Formula {
        let number = *next;
        match &formula.kind {
            FormulaKind::Holds(_) => {
                *next += 1;
                Formula::Holds(number)
            }
            FormulaKind::Until { window, .. } => {
                let [before, goal] = [number, number + 1];
                *next += 2;
                Formula::Until { before, window: self.window(window.as_ref()), goal }
            }
            FormulaKind::Always(window, inner) => {
                let window = self.window(window.as_ref());
                Formula::Always(window, Box::new(self.formula(inner, next)))
            }
            FormulaKind::Eventually(window, inner) => {
                let window = self.window(window.as_ref());
                Formula::Eventually(window, Box::new(self.formula(inner, next)))
            }
        }
    }

    /// From when to when, s from now; all of what is to come without a window.
    fn window(&mut self, window: Option<&'a ast::Window>) -> [f64; 2] {
        let Some(window) = window else { return [0.0, f64::INFINITY] };
        let [from, to] = [&window.from, &window.to].map(|expr| {
            let what = "the window of a property";
            let value = self.lower_into(&mut Scope::of(Home::File), expr, Slot::of(Dimension::TIME), what);
            self.constant(value, expr, what)
        });
        let (Some(from), Some(to)) = (from, to) else { return [0.0, f64::INFINITY] };
        if !(0.0 <= from && from <= to && from < f64::INFINITY) {
            self.report(PropertyError::Window { from, to, span: window.span });
        }
        [from, to]
    }
}
