//! Where the lines of items, statements and actions may end.

use super::writer::{Braces, Writer};
use crate::base::Span;
use crate::syntax::ast::*;

/// The place of an item.
pub fn item_span(item: &Item) -> Span {
    match item {
        Item::Import(item) => item.span,
        Item::Param(item) => item.span,
        Item::Let(item) => item.span,
        Item::Fn(item) => item.span,
        Item::Agent(item) => item.span,
        Item::Interaction(item) => item.span,
        Item::System(item) => item.span,
        Item::Property(item) => item.span,
        Item::Run(item) => item.span,
    }
}

fn agent_item_span(item: &AgentItem) -> Span {
    match item {
        AgentItem::Variables(item) => item.span,
        AgentItem::Link(item) => item.span,
        AgentItem::Event(item) => item.span,
        AgentItem::Region(item) => item.span,
        AgentItem::Body(item) => body_item_span(item),
    }
}

fn body_item_span(item: &BodyItem) -> Span {
    match item {
        BodyItem::Let(item) => item.span,
        BodyItem::Flow(item) => item.span,
        BodyItem::Invariant(item) | BodyItem::Assert(item) => item.span,
        BodyItem::Mode(item) => item.span,
        BodyItem::Entry(item) | BodyItem::Exit(item) => item.span,
        BodyItem::Transition(item) => item.span,
    }
}

fn interaction_item_span(item: &InteractionItem) -> Span {
    match item {
        InteractionItem::Let(item) => item.span,
        InteractionItem::Transition(item) => item.span,
    }
}

impl Writer<'_> {
    pub(super) fn item(&mut self, item: &Item) {
        match item {
            Item::Import(import) => self.up_to(import.span.end),
            Item::Param(param) => self.binding(param.ty.as_deref(), &param.value),
            Item::Let(definition) => self.binding(definition.ty.as_deref(), &definition.value),
            Item::Fn(function) => {
                self.up_to(function.name.span.end);
                self.formals(&function.formals);
                self.binding(function.ty.as_deref(), &function.body);
            }
            Item::Agent(agent) => {
                self.up_to(agent.name.span.end);
                self.formals(&agent.formals);
                self.braces(Braces::Block, &agent.items, agent_item_span, |w, item| w.agent_item(item));
            }
            Item::Interaction(interaction) => {
                self.up_to(interaction.name.span.end);
                self.formals(&interaction.formals);
                self.braces(Braces::Block, &interaction.items, interaction_item_span, |w, item| match item {
                    InteractionItem::Let(definition) => {
                        w.binding(definition.ty.as_deref(), &definition.value)
                    }
                    InteractionItem::Transition(transition) => w.transition(transition),
                });
            }
            Item::System(system) => {
                self.word();
                self.braces(
                    Braces::Hanging,
                    &system.instances,
                    |item| item.span,
                    |w, item| {
                        w.constructor(&item.constructor);
                    },
                );
            }
            Item::Property(property) => {
                self.up_to(property.formula.span.start);
                self.formula(&property.formula);
            }
            Item::Run(run) => {
                self.word();
                self.braces(Braces::Hanging, &run.settings, |item| item.span, |w, item| w.setting(item));
            }
        }
    }

    /// A type, `=` and a value.
    fn binding(&mut self, ty: Option<&TypeName>, value: &Expr) {
        self.annotation(ty);
        self.value(value);
    }

    fn annotation(&mut self, ty: Option<&TypeName>) {
        if let Some(unit) = ty.and_then(|ty| ty.unit.as_ref()) {
            self.unit(unit.span);
        }
    }

    /// The words up to `=` or another sign, and a value, which may begin a line.
    fn value(&mut self, value: &Expr) {
        while !matches!(self.peek(), "=" | ":=" | "~") {
            self.word();
        }
        self.word();
        let of_lines = matches!(value.kind, ExprKind::And(_) | ExprKind::Or(_) | ExprKind::If { .. });
        self.open(true);
        self.may_continue_with_value(of_lines);
        self.whole(value);
        self.close();
    }

    /// An expression, if there is one, before which a line may end.
    fn clause(&mut self, expr: Option<&Expr>) {
        if let Some(expr) = expr {
            self.close_parens();
            self.may_continue();
            self.whole(expr);
        }
    }

    fn formals(&mut self, formals: &[Formal]) {
        if self.peek() != "(" {
            return;
        }
        self.brackets(formals, |w, formal| {
            if let Some(unit) = &formal.ty.unit {
                w.unit(unit.span);
            }
            formal.default.iter().for_each(|default| w.whole(default));
            w.up_to(formal.span.end);
        });
    }

    fn agent_item(&mut self, item: &AgentItem) {
        match item {
            AgentItem::Variables(variables) => {
                self.word();
                self.aligned(|w| w.variables(&variables.variables));
            }
            AgentItem::Link(link) => link.value.iter().for_each(|value| self.value(value)),
            AgentItem::Event(event) => {
                self.up_to(event.name.span.end);
                self.formals(&event.formals);
            }
            AgentItem::Region(region) => {
                self.up_to(region.name.span.end);
                self.body(&region.items);
            }
            AgentItem::Body(item) => self.body_item(item),
        }
    }

    fn variables(&mut self, variables: &[Variable]) {
        self.open(true);
        for (k, variable) in variables.iter().enumerate() {
            if k > 0 {
                self.comma();
                self.may_begin_item();
            }
            self.annotation(variable.ty.as_deref());
            variable.initial.iter().for_each(|given| self.whole(&given.value));
            self.up_to(variable.span.end);
        }
        self.close();
    }

    fn body(&mut self, items: &[BodyItem]) {
        self.braces(Braces::Block, items, body_item_span, |w, item| w.body_item(item));
    }

    fn body_item(&mut self, item: &BodyItem) {
        match item {
            BodyItem::Let(definition) => self.binding(definition.ty.as_deref(), &definition.value),
            BodyItem::Flow(flow) => {
                self.word();
                self.braces(
                    Braces::Hanging,
                    &flow.equations,
                    |item| item.span,
                    |w, item| w.value(&item.rate),
                );
            }
            BodyItem::Invariant(claim) | BodyItem::Assert(claim) => {
                self.open(true);
                self.whole(&claim.condition);
                if claim.message.is_some() {
                    self.close_parens();
                    self.may_continue();
                }
                self.up_to(claim.span.end);
                self.close();
            }
            BodyItem::Mode(mode) => {
                self.up_to(mode.name.span.end);
                self.body(&mode.items);
            }
            BodyItem::Entry(actions) | BodyItem::Exit(actions) => {
                self.word();
                self.actions(actions);
            }
            BodyItem::Transition(transition) => self.transition(transition),
        }
    }

    fn transition(&mut self, transition: &Transition) {
        self.open(true);
        self.up_to(transition.trigger.span.start);
        self.trigger(&transition.trigger);
        self.clause(transition.priority.as_deref());
        if let Some(target) = &transition.target {
            self.close_parens();
            self.may_continue();
            self.up_to(target.span.end);
        }
        self.close_parens();
        self.close();
        if let Some(actions) = &transition.actions {
            self.actions(actions);
        }
    }

    fn trigger(&mut self, trigger: &Trigger) {
        match &trigger.kind {
            TriggerKind::When => {
                if let Some(guard) = &trigger.guard {
                    self.whole(guard);
                }
                return;
            }
            TriggerKind::After(time) | TriggerKind::Every(time) | TriggerKind::Rate(time) => self.whole(time),
            TriggerKind::On { event, binders, sender } => {
                self.up_to(binders.last().map_or(event.span, |binder| binder.span).end);
                self.clause(sender.as_deref());
            }
        }
        self.clause(trigger.guard.as_ref());
    }

    fn actions(&mut self, actions: &Actions) {
        self.braces(Braces::Hanging, &actions.actions, |item| item.span, |w, item| w.action(item));
    }

    fn action(&mut self, action: &Action) {
        match &action.kind {
            ActionKind::Assign { given, .. } => self.value(&given.value),
            ActionKind::Create(constructor) => self.constructor(constructor),
            ActionKind::Destroy(agent) => self.whole(agent),
            ActionKind::Emit { event, args, delay } => {
                self.up_to(event.span.end);
                if self.peek() == "(" {
                    self.exprs(args);
                }
                self.clause(delay.as_deref());
            }
            ActionKind::If { branches, otherwise } => {
                for branch in branches {
                    self.whole(&branch.condition);
                    self.close_parens();
                    self.actions(&branch.actions);
                }
                if let Some(actions) = otherwise {
                    self.word();
                    self.actions(actions);
                }
            }
            ActionKind::ChangeMode { .. } | ActionKind::Stop(_) => {}
        }
    }

    /// `Type[n](a = 1) in Mode from csv("file.csv")`
    fn constructor(&mut self, constructor: &Constructor) {
        self.open(true);
        self.up_to(constructor.agent.span.end);
        match &constructor.count {
            Some(Count::Exactly(count)) => self.exprs(std::slice::from_ref(count)),
            Some(Count::AllRows(span)) => self.up_to(span.end),
            None => {}
        }
        if self.peek() == "(" {
            self.brackets(&constructor.args, |w, arg| w.value(&arg.given.value));
        }
        if let Some(mode) = &constructor.start {
            self.may_continue();
            self.up_to(mode.span.end);
        }
        self.clause(constructor.source.as_deref());
        self.up_to(constructor.span.end);
        self.close();
    }

    fn formula(&mut self, formula: &Formula) {
        self.open(true);
        match &formula.kind {
            FormulaKind::Always(window, inner) | FormulaKind::Eventually(window, inner) => {
                self.word();
                self.window(window);
                self.may_continue();
                self.up_to(inner.span.start);
                self.formula(inner);
            }
            FormulaKind::Until { before, window, goal } => {
                self.whole(before);
                self.close_parens();
                self.may_continue();
                self.word();
                self.window(window);
                self.whole(goal);
            }
            FormulaKind::Holds(condition) => self.whole(condition),
        }
        self.up_to(formula.span.end);
        self.close();
    }

    fn window(&mut self, window: &Option<Window>) {
        if let Some(window) = window {
            self.whole(&window.from);
            self.whole(&window.to);
            self.up_to(window.span.end);
        }
    }

    fn setting(&mut self, setting: &RunSetting) {
        match &setting.kind {
            RunSettingKind::Until(value) | RunSettingKind::StopWhen(value) => self.whole(value),
            RunSettingKind::Record { columns, period, .. } => {
                self.word();
                self.open(true);
                for (k, column) in columns.iter().enumerate() {
                    if k > 0 {
                        self.comma();
                    }
                    self.may_continue();
                    self.whole(column);
                }
                self.clause(period.as_ref());
                self.close_parens();
                self.may_continue();
                self.up_to(setting.span.end);
                self.close();
            }
            RunSettingKind::Output { .. } => {}
            RunSettingKind::Set { value, .. } => {
                self.word();
                self.begin_expression();
                self.whole(value);
            }
        }
    }
}
