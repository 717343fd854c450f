//! Items, statements and actions in the canonical layout.

use super::Printer;
use crate::syntax::ast::*;

impl Printer {
    pub(super) fn item(&mut self, item: &Item) {
        self.line(|p| match item {
            Item::Import(import) => {
                p.put("import ");
                p.quoted(&import.path.value);
            }
            Item::Param(param) => p.binding("param ", &param.name, &param.ty, &param.value),
            Item::Let(definition) => p.definition(definition),
            Item::Fn(function) => {
                p.put("fn ");
                p.put(&function.name.text);
                p.formals(&function.formals);
                p.annotation(&function.ty);
                p.put(" = ");
                p.expr(&function.body);
            }
            Item::Agent(agent) => {
                p.head("agent ", &agent.name);
                if !agent.formals.is_empty() {
                    p.formals(&agent.formals);
                }
                p.put(" ");
                p.block(&agent.items, |p, item| p.line(|p| p.agent_item(item)));
            }
            Item::Interaction(interaction) => {
                p.head("interaction ", &interaction.name);
                p.formals(&interaction.formals);
                p.put(" ");
                p.block(&interaction.items, |p, item| p.line(|p| p.interaction_item(item)));
            }
            Item::System(system) => {
                p.put("system ");
                p.block(&system.instances, |p, instance| p.line(|p| p.instance(instance)));
            }
            Item::Property(property) => {
                p.head("property ", &property.name);
                p.put(" = ");
                p.formula(&property.formula);
            }
            Item::Run(run) => {
                p.put("run ");
                p.block(&run.settings, |p, setting| p.line(|p| p.setting(setting)));
            }
        });
    }

    fn head(&mut self, word: &str, name: &Name) {
        self.put(word);
        self.put(&name.text);
    }

    fn binding(&mut self, word: &str, name: &Name, ty: &Option<TypeName>, value: &Expr) {
        self.head(word, name);
        self.annotation(ty);
        self.put(" = ");
        self.expr(value);
    }

    fn definition(&mut self, definition: &Let) {
        self.binding("let ", &definition.name, &definition.ty, &definition.value);
    }

    fn formals(&mut self, formals: &[Formal]) {
        self.put("(");
        self.list(formals, |p, formal| {
            p.put(&formal.name.text);
            p.put(": ");
            p.type_name(&formal.ty);
            p.clause("=", &formal.default);
        });
        self.put(")");
    }

    fn agent_item(&mut self, item: &AgentItem) {
        match item {
            AgentItem::Variables(variables) => {
                self.put(match variables.kind {
                    VariableKind::State => "state ",
                    VariableKind::Discrete => "discrete ",
                });
                self.list(&variables.variables, |p, variable| {
                    p.put(&variable.name.text);
                    p.annotation(&variable.ty);
                    variable.initial.iter().for_each(|given| p.given(" = ", given));
                });
            }
            AgentItem::Link(link) => {
                self.head("link ", &link.name);
                if let Some(target) = &link.target {
                    self.head(": ", target);
                }
                self.clause("=", &link.value);
            }
            AgentItem::Event(event) => {
                self.head("event ", &event.name);
                if !event.formals.is_empty() {
                    self.formals(&event.formals);
                }
            }
            AgentItem::Region(region) => {
                self.head("region ", &region.name);
                self.put(" ");
                self.body(&region.items);
            }
            AgentItem::Body(item) => self.body_item(item),
        }
    }

    fn body(&mut self, items: &[BodyItem]) {
        self.block(items, |p, item| p.line(|p| p.body_item(item)));
    }

    fn body_item(&mut self, item: &BodyItem) {
        match item {
            BodyItem::Let(definition) => self.definition(definition),
            BodyItem::Flow(flow) => self.flow(flow),
            BodyItem::Invariant(claim) => self.claim("invariant ", claim),
            BodyItem::Assert(claim) => self.claim("assert ", claim),
            BodyItem::Mode(mode) => {
                self.put(if mode.initial.is_some() { "initial " } else { "" });
                self.head("mode ", &mode.name);
                self.put(" ");
                self.body(&mode.items);
            }
            BodyItem::Entry(actions) => {
                self.put("entry ");
                self.actions(actions);
            }
            BodyItem::Exit(actions) => {
                self.put("exit ");
                self.actions(actions);
            }
            BodyItem::Transition(transition) => self.transition(transition),
        }
    }

    fn flow(&mut self, flow: &Flow) {
        self.put("flow ");
        let equation = |p: &mut Self, equation: &FlowEquation| {
            p.put(&equation.state.text);
            p.put("' = ");
            p.expr(&equation.rate);
        };
        match flow.equations.as_slice() {
            [single] => {
                self.put("{ ");
                equation(self, single);
                self.put(" }");
            }
            equations => self.block(equations, |p, each| p.line(|p| equation(p, each))),
        }
    }

    fn claim(&mut self, word: &str, claim: &Claim) {
        self.put(word);
        self.expr(&claim.condition);
        self.message(&claim.message);
    }

    fn transition(&mut self, transition: &Transition) {
        if let Some(label) = &transition.label {
            self.put(&label.text);
            self.put(": ");
        }
        self.trigger(&transition.trigger);
        self.clause("priority", &transition.priority);
        if let Some(target) = &transition.target {
            self.put(" -> ");
            self.target(target);
        }
        if let Some(actions) = &transition.actions {
            self.put(" ");
            self.actions(actions);
        }
    }

    fn trigger(&mut self, trigger: &Trigger) {
        let start = self.text.len();
        match &trigger.kind {
            TriggerKind::When => {}
            TriggerKind::After(delay) => self.word_and("after ", delay),
            TriggerKind::Every(period) => self.word_and("every ", period),
            TriggerKind::Rate(hazard) => self.word_and("rate ", hazard),
            TriggerKind::On { event, binders, sender } => {
                self.head("on ", event);
                if !binders.is_empty() {
                    self.put("(");
                    self.list(binders, |p, binder| p.put(&binder.text));
                    self.put(")");
                }
                self.clause("from", sender);
            }
        }
        if let Some(guard) = &trigger.guard {
            self.word_and(if self.text.len() > start { " when " } else { "when " }, guard);
        }
    }

    fn word_and(&mut self, word: &str, expr: &Expr) {
        self.put(word);
        self.expr(expr);
    }

    fn actions(&mut self, actions: &Actions) {
        match actions.actions.as_slice() {
            [Action { kind: ActionKind::If { .. }, .. }] => self.lines(actions),
            [single] => {
                self.put("{ ");
                self.action(single);
                self.put(" }");
            }
            several => self.block(several, |p, each| p.line(|p| p.action(each))),
        }
    }

    fn action(&mut self, action: &Action) {
        match &action.kind {
            ActionKind::Assign { place, given } => {
                self.place(place);
                self.given(" := ", given);
            }
            ActionKind::Create(constructor) => {
                self.put("create ");
                self.constructor(constructor);
            }
            ActionKind::Destroy(agent) => self.word_and("destroy ", agent),
            ActionKind::Emit { event, args, delay } => {
                self.put("emit ");
                self.place(event);
                if !args.is_empty() {
                    self.put("(");
                    self.list(args, |p, arg| p.expr(arg));
                    self.put(")");
                }
                self.clause("after", delay);
            }
            ActionKind::ChangeMode { participant, target } => {
                self.put(&participant.text);
                self.put(" -> ");
                self.target(target);
            }
            ActionKind::Stop(reason) => {
                self.put("stop");
                self.message(reason);
            }
            ActionKind::If { branches, otherwise } => self.branches(branches, otherwise),
        }
    }

    fn place(&mut self, place: &Place) {
        if let Some(owner) = &place.owner {
            self.put(&owner.text);
            self.put(".");
        }
        self.put(&place.variable.text);
    }

    fn branches(&mut self, branches: &[Branch], otherwise: &Option<Actions>) {
        for (k, branch) in branches.iter().enumerate() {
            self.word_and(if k > 0 { " else if " } else { "if " }, &branch.condition);
            self.put(" ");
            self.lines(&branch.actions);
        }
        if let Some(actions) = otherwise {
            self.put(" else ");
            self.lines(actions);
        }
    }

    /// Actions with a line for each.
    fn lines(&mut self, actions: &Actions) {
        self.block(&actions.actions, |p, each| p.line(|p| p.action(each)));
    }

    fn interaction_item(&mut self, item: &InteractionItem) {
        match item {
            InteractionItem::Let(definition) => self.definition(definition),
            InteractionItem::Transition(transition) => self.transition(transition),
        }
    }

    fn instance(&mut self, instance: &Instance) {
        self.put(&instance.name.text);
        self.put(" = ");
        self.constructor(&instance.constructor);
    }

    fn constructor(&mut self, constructor: &Constructor) {
        self.put(&constructor.agent.text);
        match &constructor.count {
            None => {}
            Some(Count::AllRows(_)) => self.put("[]"),
            Some(Count::Exactly(count)) => {
                self.put("[");
                self.expr(count);
                self.put("]");
            }
        }
        if !constructor.args.is_empty() {
            self.put("(");
            self.list(&constructor.args, |p, arg| {
                p.put(&arg.name.text);
                p.given(" = ", &arg.given);
            });
            self.put(")");
        }
        if let Some(mode) = &constructor.start {
            self.put(" in ");
            self.target(mode);
        }
        self.clause("from", &constructor.source);
    }

    fn formula(&mut self, formula: &Formula) {
        match &formula.kind {
            FormulaKind::Always(window, inner) => {
                self.put("always");
                self.window(window);
                self.formula(inner);
            }
            FormulaKind::Eventually(window, inner) => {
                self.put("eventually");
                self.window(window);
                self.formula(inner);
            }
            FormulaKind::Until { before, window, goal } => {
                self.expr(before);
                self.put(" until");
                self.window(window);
                self.expr(goal);
            }
            FormulaKind::Holds(condition) => self.expr(condition),
        }
    }

    fn window(&mut self, window: &Option<Window>) {
        if let Some(window) = window {
            self.put(" [");
            self.expr(&window.from);
            self.put(", ");
            self.expr(&window.to);
            self.put("]");
        }
        self.put(" ");
    }

    fn setting(&mut self, setting: &RunSetting) {
        match &setting.kind {
            RunSettingKind::Until(end) => self.word_and("until ", end),
            RunSettingKind::StopWhen(condition) => self.word_and("stop when ", condition),
            RunSettingKind::Record { columns, period, file } => {
                self.put("record ");
                self.list(columns, |p, column| p.expr(column));
                self.clause("every", period);
                self.put(" to ");
                self.quoted(&file.value);
            }
            RunSettingKind::Output { name, file } => {
                self.put(&name.text);
                self.put(" to ");
                self.quoted(&file.value);
            }
            RunSettingKind::Set { name, value } => {
                self.put(&name.text);
                self.put(" ");
                self.expr(value);
            }
        }
    }
}
