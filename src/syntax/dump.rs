//! Writes a tree as an indented outline, one statement a line: what `hyc show --stage ast` prints.
//!
//! Every fact of the tree is in it except the places, so two texts mean the same tree if and only if their outlines are
//! equal.

mod expr;

use super::ast::*;
use expr::Flat;

/// The outline of a tree.
pub fn dump(ast: &Ast) -> String {
    let mut outline = Outline { text: String::new(), depth: 0 };
    for item in &ast.items {
        outline.item(item);
    }
    outline.text
}

/// The text so far, and how far the next line is indented.
struct Outline {
    text: String,
    depth: usize,
}

impl Outline {
    fn line(&mut self, line: &str) {
        self.text.extend(std::iter::repeat_n("  ", self.depth));
        self.text.push_str(line);
        self.text.push('\n');
    }

    /// A line and, indented below it, what `inside` writes.
    fn node(&mut self, line: &str, inside: impl FnOnce(&mut Self)) {
        self.line(line);
        self.depth += 1;
        inside(self);
        self.depth -= 1;
    }

    fn item(&mut self, item: &Item) {
        match item {
            Item::Import(import) => self.line(&format!("import {:?}", import.path.value)),
            Item::Param(param) => {
                self.line(&format!(
                    "param {}{} = {}",
                    param.name.text,
                    annotation(param.ty.as_deref()),
                    Flat(&param.value)
                ));
            }
            Item::Let(definition) => self.definition(definition),
            Item::Fn(function) => {
                self.node(&format!("fn {}{}", function.name.text, annotation(function.ty.as_deref())), |o| {
                    o.formals(&function.formals);
                    o.line(&format!("= {}", Flat(&function.body)));
                })
            }
            Item::Agent(agent) => self.node(&format!("agent {}", agent.name.text), |o| {
                o.formals(&agent.formals);
                agent.items.iter().for_each(|item| o.agent_item(item));
            }),
            Item::Interaction(interaction) => {
                self.node(&format!("interaction {}", interaction.name.text), |o| {
                    o.formals(&interaction.formals);
                    interaction.items.iter().for_each(|item| o.interaction_item(item));
                })
            }
            Item::System(system) => self.node("system", |o| {
                for instance in &system.instances {
                    o.node(&format!("instance {}", instance.name.text), |o| {
                        o.constructor(&instance.constructor)
                    });
                }
            }),
            Item::Property(property) => {
                self.node(&format!("property {}", property.name.text), |o| o.formula(&property.formula));
            }
            Item::Run(run) => {
                self.node("run", |o| run.settings.iter().for_each(|setting| o.setting(setting)))
            }
        }
    }

    fn definition(&mut self, definition: &Let) {
        self.line(&format!(
            "let {}{} = {}",
            definition.name.text,
            annotation(definition.ty.as_deref()),
            Flat(&definition.value)
        ));
    }

    fn formals(&mut self, formals: &[Formal]) {
        for formal in formals {
            let default = clause(" = ", formal.default.as_deref());
            self.line(&format!("formal {}: {}{default}", formal.name.text, type_name(&formal.ty)));
        }
    }

    fn agent_item(&mut self, item: &AgentItem) {
        match item {
            AgentItem::Variables(variables) => {
                let kind = match variables.kind {
                    VariableKind::State => "state",
                    VariableKind::Discrete => "discrete",
                };
                self.node(kind, |o| variables.variables.iter().for_each(|variable| o.variable(variable)));
            }
            AgentItem::Link(link) => {
                let target =
                    link.target.iter().map(|target| format!(": {}", target.text)).collect::<String>();
                self.line(&format!("link {}{target}{}", link.name.text, clause(" = ", link.value.as_ref())));
            }
            AgentItem::Event(event) => {
                self.node(&format!("event {}", event.name.text), |o| o.formals(&event.formals))
            }
            AgentItem::Region(region) => {
                self.node(&format!("region {}", region.name.text), |o| o.body(&region.items))
            }
            AgentItem::Body(item) => self.body_item(item),
        }
    }

    fn variable(&mut self, variable: &Variable) {
        let initial = variable.initial.iter().map(given).collect::<String>();
        self.line(&format!("variable {}{}{initial}", variable.name.text, annotation(variable.ty.as_deref())));
    }

    fn body(&mut self, items: &[BodyItem]) {
        items.iter().for_each(|item| self.body_item(item));
    }

    fn body_item(&mut self, item: &BodyItem) {
        match item {
            BodyItem::Let(definition) => self.definition(definition),
            BodyItem::Flow(flow) => self.node("flow", |o| {
                for equation in &flow.equations {
                    o.line(&format!("{}' = {}", equation.state.text, Flat(&equation.rate)));
                }
            }),
            BodyItem::Invariant(claim) => self.claim("invariant", claim),
            BodyItem::Assert(claim) => self.claim("assert", claim),
            BodyItem::Mode(mode) => {
                let initial = if mode.initial.is_some() { "initial " } else { "" };
                self.node(&format!("{initial}mode {}", mode.name.text), |o| o.body(&mode.items));
            }
            BodyItem::Entry(actions) => self.actions("entry", actions),
            BodyItem::Exit(actions) => self.actions("exit", actions),
            BodyItem::Transition(transition) => self.transition(transition),
        }
    }

    fn claim(&mut self, word: &str, claim: &Claim) {
        self.line(&format!("{word} {}{}", Flat(&claim.condition), text_after(&claim.message)));
    }

    fn transition(&mut self, transition: &Transition) {
        let label = transition.label.iter().map(|label| format!(" {}", label.text)).collect::<String>();
        let target = transition.target.iter().map(|to| format!(" -> {}", target(to))).collect::<String>();
        self.node(&format!("transition{label}{target}"), |o| {
            o.trigger(&transition.trigger);
            o.labelled("priority ", transition.priority.as_deref());
            transition.actions.iter().for_each(|actions| o.actions("actions", actions));
        });
    }

    fn trigger(&mut self, trigger: &Trigger) {
        match &trigger.kind {
            TriggerKind::When => {}
            TriggerKind::After(delay) => self.line(&format!("after {}", Flat(delay))),
            TriggerKind::Every(period) => self.line(&format!("every {}", Flat(period))),
            TriggerKind::Rate(hazard) => self.line(&format!("rate {}", Flat(hazard))),
            TriggerKind::On { event, binders, sender } => {
                let binders = binders.iter().map(|binder| format!(" {}", binder.text)).collect::<String>();
                self.line(&format!("on {}{binders}{}", event.text, clause(" from ", sender.as_deref())));
            }
        }
        self.labelled("when ", trigger.guard.as_ref());
    }

    fn actions(&mut self, word: &str, actions: &Actions) {
        self.node(word, |o| actions.actions.iter().for_each(|action| o.action(action)));
    }

    fn action(&mut self, action: &Action) {
        match &action.kind {
            ActionKind::Assign { place, given: value } => {
                self.line(&format!("assign {}{}", place_text(place), given(value)));
            }
            ActionKind::Create(constructor) => self.node("create", |o| o.constructor(constructor)),
            ActionKind::Destroy(agent) => self.line(&format!("destroy {}", Flat(agent))),
            ActionKind::Emit { event, args, delay } => {
                let args = args.iter().map(|arg| format!(" {}", Flat(arg))).collect::<String>();
                self.line(&format!(
                    "emit {}{args}{}",
                    place_text(event),
                    clause(" after ", delay.as_deref())
                ));
            }
            ActionKind::ChangeMode { participant, target: to } => {
                self.line(&format!("{} -> {}", participant.text, target(to)));
            }
            ActionKind::Stop(reason) => self.line(&format!("stop{}", text_after(reason))),
            ActionKind::If { branches, otherwise } => {
                for (k, branch) in branches.iter().enumerate() {
                    self.line(&format!(
                        "{} {}",
                        if k > 0 { "else if" } else { "if" },
                        Flat(&branch.condition)
                    ));
                    self.actions("then", &branch.actions);
                }
                otherwise.iter().for_each(|actions| self.actions("else", actions));
            }
        }
    }

    fn interaction_item(&mut self, item: &InteractionItem) {
        match item {
            InteractionItem::Let(definition) => self.definition(definition),
            InteractionItem::Transition(transition) => self.transition(transition),
        }
    }

    fn constructor(&mut self, constructor: &Constructor) {
        let start = constructor.start.iter().map(|mode| format!(" in {}", target(mode))).collect::<String>();
        self.node(&format!("new {}{start}", constructor.agent.text), |o| {
            match &constructor.count {
                None => {}
                Some(Count::Exactly(count)) => o.line(&format!("count {}", Flat(count))),
                Some(Count::AllRows(_)) => o.line("count of rows"),
            }
            for arg in &constructor.args {
                o.line(&format!("argument {}{}", arg.name.text, given(&arg.given)));
            }
            o.labelled("from ", constructor.source.as_deref());
        });
    }

    fn formula(&mut self, formula: &Formula) {
        match &formula.kind {
            FormulaKind::Always(window, inner) => self.node("always", |o| {
                o.window(window);
                o.formula(inner);
            }),
            FormulaKind::Eventually(window, inner) => self.node("eventually", |o| {
                o.window(window);
                o.formula(inner);
            }),
            FormulaKind::Until { before, window, goal } => self.node("until", |o| {
                o.window(window);
                o.line(&format!("before {}", Flat(before)));
                o.line(&format!("goal {}", Flat(goal)));
            }),
            FormulaKind::Holds(condition) => self.line(&format!("holds {}", Flat(condition))),
        }
    }

    fn window(&mut self, window: &Option<Window>) {
        if let Some(window) = window {
            self.line(&format!("window {} to {}", Flat(&window.from), Flat(&window.to)));
        }
    }

    fn setting(&mut self, setting: &RunSetting) {
        match &setting.kind {
            RunSettingKind::Until(end) => self.line(&format!("until {}", Flat(end))),
            RunSettingKind::StopWhen(condition) => self.line(&format!("stop when {}", Flat(condition))),
            RunSettingKind::Record { columns, period, file } => {
                self.node(&format!("record to {:?}", file.value), |o| {
                    columns.iter().for_each(|column| o.line(&format!("column {}", Flat(column))));
                    o.labelled("every ", period.as_ref());
                })
            }
            RunSettingKind::Output { name, file } => self.line(&format!("{} to {:?}", name.text, file.value)),
            RunSettingKind::Set { name, value } => self.line(&format!("set {} {}", name.text, Flat(value))),
        }
    }

    /// A line of a word and an expression, if there is one.
    fn labelled(&mut self, word: &str, expr: Option<&Expr>) {
        if let Some(expr) = expr {
            self.line(&format!("{word}{}", Flat(expr)));
        }
    }
}

fn clause(word: &str, expr: Option<&Expr>) -> String {
    expr.iter().map(|expr| format!("{word}{}", Flat(expr))).collect()
}

fn place_text(place: &Place) -> String {
    let owner = place.owner.iter().map(|owner| format!("{}.", owner.text)).collect::<String>();
    format!("{owner}{}", place.variable.text)
}

fn given(given: &Given) -> String {
    let sign = match given.kind {
        GivenKind::Value => '=',
        GivenKind::Draw => '~',
    };
    format!(" {sign} {}", Flat(&given.value))
}

fn text_after(text: &Option<Text>) -> String {
    text.iter().map(|text| format!(" {:?}", text.value)).collect()
}

fn annotation(ty: Option<&TypeName>) -> String {
    ty.iter().map(|ty| format!(": {}", type_name(ty))).collect()
}

fn type_name(ty: &TypeName) -> String {
    format!("{}{}", ty.name.text, unit_after(ty.unit.as_deref()))
}

fn unit_after(unit: Option<&UnitText>) -> String {
    unit.iter().map(|unit| format!(" [{}]", unit.text)).collect()
}

fn target(target: &Target) -> String {
    let history = if target.history.is_some() { ".history" } else { "" };
    let path: Vec<&str> = target.path.iter().map(|name| name.text.as_str()).collect();
    format!("{}{history}", path.join("."))
}
