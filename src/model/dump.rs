//! The model as text, for `hyc show --stage model`: everything that later floors get, names resolved, values in SI.
//!
//! Of the agents of a block the first three are written.

use std::fmt::Write;

use super::formula::{Formulas, Names, number_text};
use super::ir::{
    Action, AgentType, Claim, Create, ExprId, Given, Instance, Integrator, Interaction, LinkCase, LinkTarget,
    Machinery, Mode, ModeId, Model, Pace, ParamValue, Population, Record, Run, Transition, Trigger, Type,
    TypeId, VarRef, Variable,
};
use super::machinery::Named;

/// How many agents of a block are written.
const AGENTS_SHOWN: usize = 3;

/// The whole model as text.
pub fn dump(model: &Model) -> String {
    let mut writer = Writer { model, formulas: Formulas::new(model), out: String::new() };
    writer.params();
    for function in &model.functions {
        let params = function.params.iter().map(|(name, ty)| format!("{name}: {}", writer.ty(*ty)));
        let params = params.collect::<Vec<_>>().join(", ");
        let names = Names { locals: &function.params, pair: None };
        let body = writer.formulas.text(function.body, names);
        let ty = writer.ty(model.exprs[function.body].ty);
        writer.line(0, &format!("fn {}({params}): {ty} = {body}", function.name));
    }
    for ty in &model.types {
        writer.agent(ty);
    }
    for interaction in &model.interactions {
        writer.interaction(interaction);
    }
    let shared = writer.formulas.shared(Names::default());
    for (id, text) in shared {
        writer.line(0, &format!("#{} = {text}", id.index()));
    }
    writer.population(&model.population);
    writer.run(&model.run);
    writer.out
}

struct Writer<'m> {
    model: &'m Model,
    formulas: Formulas<'m>,
    out: String,
}

impl<'m> Writer<'m> {
    fn line(&mut self, depth: usize, text: &str) {
        let _ = writeln!(self.out, "{:width$}{text}", "", width = 2 * depth);
    }

    fn ty(&self, ty: Type) -> String {
        match ty {
            Type::Real => "real".to_string(),
            Type::Int => "int".to_string(),
            Type::Bool => "bool".to_string(),
            Type::Agent(ty) => self.model.types[ty].name.clone(),
            Type::Link(ty) => format!("{} or none", self.model.types[ty].name),
        }
    }

    fn params(&mut self) {
        for param in &self.model.params {
            let unit = unit_text(param.unit.as_deref(), None);
            let (ty, value) = match &param.value {
                ParamValue::Text(text) => ("string".to_string(), format!("\"{text}\"")),
                ParamValue::Number(value) => (self.ty(param.ty), number(*value, param.ty)),
            };
            self.line(0, &format!("param {}: {ty}{unit} = {value}", param.name));
        }
    }

    fn agent(&mut self, ty: &'m AgentType) {
        self.line(0, &format!("agent {}", ty.name));
        for (word, variables) in [("param", &ty.params), ("state", &ty.states), ("discrete", &ty.discretes)] {
            for Variable { name, ty, unit, scale, .. } in variables {
                let text = format!(
                    "{word} {name}: {}{}",
                    self.ty(*ty),
                    unit_text(unit.as_deref(), Some(scale.factor()))
                );
                self.line(1, &text);
            }
        }
        for link in ty.declared_links() {
            let none = if link.required { "" } else { " or none" };
            let target = &self.model.types[link.ty].name;
            self.line(1, &format!("link {}: {target}{none}", link.name));
            for case in &link.cases {
                self.link_case(case);
            }
        }
        for event in &ty.events {
            let params = event.params.iter().map(|Variable { name, ty, unit, scale, .. }| {
                format!("{name}: {}{}", self.ty(*ty), unit_text(unit.as_deref(), Some(scale.factor())))
            });
            let params = params.collect::<Vec<_>>().join(", ");
            self.line(1, &format!("event {}({params})", event.name));
        }
        for item in &ty.lets {
            let of = self.ty(self.model.exprs[item.value].ty);
            let unit = unit_text(item.unit.as_deref(), Some(item.scale.factor()));
            let path = &ty.modes[item.mode].path;
            let place = if path.is_empty() { String::new() } else { format!("{path}: ") };
            let value = self.formulas.text(item.value, Names::default());
            self.line(1, &format!("let {place}{}: {of}{unit} = {value}", item.name));
        }
        let declared = ty.declared.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>().join(", ");
        self.line(1, &format!("declared {declared}"));
        self.mode(ty, ModeId::new(0), 1);
        for transition in &ty.transitions {
            self.transition(transition, Some(ty), Names::default());
        }
    }

    fn mode(&mut self, ty: &'m AgentType, id: ModeId, depth: usize) {
        let mode: &Mode = &ty.modes[id];
        let inside = match mode.parent {
            None => depth,
            Some(parent) => {
                let initial = if ty.modes[parent].initial == Some(id) { "initial " } else { "" };
                let word = if mode.is_region { "region" } else { "mode" };
                self.line(depth, &format!("{initial}{word} {}", mode.path));
                depth + 1
            }
        };
        for (state, rate, _) in &mode.flow {
            let rate = self.formulas.text(*rate, Names::default());
            self.line(inside, &format!("flow {}' = {rate}", ty.states[*state].name));
        }
        for (word, claims) in [("invariant", &mode.invariants), ("assert", &mode.asserts)] {
            for Claim { condition, message, .. } in claims {
                let message = message.as_ref().map_or(String::new(), |text| format!(" \"{text}\""));
                let condition = self.formulas.text(*condition, Names::default());
                self.line(inside, &format!("{word} {condition}{message}"));
            }
        }
        for (word, actions) in [("entry", &mode.entry), ("exit", &mode.exit)] {
            if !actions.is_empty() {
                self.line(inside, word);
                self.actions(actions, Names::default(), inside + 1);
            }
        }
        for child in &mode.children {
            self.mode(ty, *child, inside);
        }
    }

    fn transition(&mut self, item: &Transition, ty: Option<&AgentType>, names: Names) {
        let on;
        let (word, value, guard) = match &item.trigger {
            Trigger::When(guard) => ("", None, Some(*guard)),
            Trigger::After(delay, guard) => (" after ", Some(*delay), *guard),
            Trigger::Every(period, guard) => (" every ", Some(*period), *guard),
            Trigger::Rate { rate, guard, .. } => (" rate ", Some(*rate), *guard),
            Trigger::On { events, from, guard } => {
                on = self.heard(events, *from);
                (on.as_str(), *from, *guard)
            }
        };
        let mut text = format!("{}:{word}", item.label);
        if let Some(value) = value {
            text.push_str(&self.formulas.text(value, names));
        }
        if let Some(guard) = guard {
            text.push_str(" when ");
            text.push_str(&self.formulas.text(guard, names));
        }
        if let Some(priority) = item.priority {
            text.push_str(" priority ");
            text.push_str(&self.formulas.text(priority, names));
        }
        if let Some(ty) = ty {
            let path = |mode: ModeId| if mode.index() == 0 { "*" } else { ty.modes[mode].path.as_str() };
            match item.target {
                Some(target) => {
                    let (from, to) = (path(item.source), path(target.mode));
                    text.push_str(&format!(" [{from} -> {to}{}]", target.suffix()));
                }
                None => text.push_str(&format!(" [{}]", path(item.source))),
            }
        }
        if !item.witnesses.is_empty() {
            let names = item.witnesses.iter().map(|&binder| self.model.binders[binder].name.as_str());
            text.push_str(&format!(" witness {}", names.collect::<Vec<_>>().join(", ")));
        }
        self.line(1, &text);
        self.actions(&item.actions, names, 2);
    }

    fn list(&self, values: &[ExprId], names: Names) -> String {
        values.iter().map(|&value| self.formulas.text(value, names)).collect::<Vec<_>>().join(", ")
    }

    /// ` on Car.braking, Bus.braking from `
    fn heard(&self, events: &[(TypeId, usize)], from: Option<ExprId>) -> String {
        let names = events.iter().map(|&(ty, event)| {
            let ty = &self.model.types[ty];
            format!("{}.{}", ty.name, ty.events[event].name)
        });
        let from = if from.is_some() { " from " } else { "" };
        format!(" on {}{from}", names.collect::<Vec<_>>().join(", "))
    }

    fn actions(&mut self, actions: &[Action], names: Names, depth: usize) {
        for action in actions {
            match action {
                Action::Assign { agent, variable, value, .. } => {
                    let owner = match self.model.exprs[*agent].ty {
                        Type::Agent(owner) => &self.model.types[owner],
                        Type::Real | Type::Int | Type::Bool | Type::Link(_) => continue,
                    };
                    let agent = self.formulas.text(*agent, names);
                    let value = self.formulas.text(*value, names);
                    self.line(depth, &format!("{agent}.{} := {value}", variable_name(owner, *variable)));
                }
                Action::Draw { agent, variable, distribution, parameters, .. } => {
                    let Type::Agent(owner) = self.model.exprs[*agent].ty else { continue };
                    let variable = variable_name(&self.model.types[owner], *variable);
                    let agent = self.formulas.text(*agent, names);
                    let parameters = self.list(parameters, names);
                    let distribution = distribution.name();
                    self.line(depth, &format!("{agent}.{variable} ~ {distribution}({parameters})"));
                }
                Action::Emit { agent, event, values, delay, .. } => {
                    let Type::Agent(owner) = self.model.exprs[*agent].ty else { continue };
                    let event = &self.model.types[owner].events[*event].name;
                    let agent = self.formulas.text(*agent, names);
                    let values = self.list(values, names);
                    let delay = delay.map(|delay| format!(" after {}", self.formulas.text(delay, names)));
                    let delay = delay.unwrap_or_default();
                    self.line(depth, &format!("emit {agent}.{event}({values}){delay}"));
                }
                Action::If { condition, then, otherwise } => {
                    let condition = self.formulas.text(*condition, names);
                    self.line(depth, &format!("if {condition}"));
                    self.actions(then, names, depth + 1);
                    if !otherwise.is_empty() {
                        self.line(depth, "else");
                        self.actions(otherwise, names, depth + 1);
                    }
                }
                Action::Goto { participant, target, .. } => {
                    let Some(pair) = names.pair else { continue };
                    let path = &self.model.types[pair.types[*participant]].modes[target.mode].path;
                    let name = &pair.participants[*participant];
                    self.line(depth, &format!("{name} -> {path}{}", target.suffix()));
                }
                Action::Stop { reason, .. } => {
                    let reason = reason.as_ref().map_or(String::new(), |text| format!(" \"{text}\""));
                    self.line(depth, &format!("stop{reason}"));
                }
                Action::Create(create) => self.creation(create, names, depth),
                Action::Destroy { agent, .. } => {
                    let agent = self.formulas.text(*agent, names);
                    self.line(depth, &format!("destroy {agent}"));
                }
            }
        }
    }

    fn link_case(&mut self, case: &LinkCase) {
        let names = Names { locals: &[], pair: None };
        let text = |id: ExprId| self.formulas.text(id, names);
        let mut line = match &case.target {
            LinkTarget::Nobody => "none".to_string(),
            LinkTarget::Agent(agent) => text(*agent),
            LinkTarget::Nearest { binder, other, filter, key } => {
                let bound = &self.model.binders[*binder];
                let other = if *other { "other " } else { "" };
                let set = &self.model.types[bound.ty].name;
                let filter = filter.map_or(String::new(), |filter| format!(" where {}", text(filter)));
                format!("nearest {} in {other}{set}{filter} by {}", bound.name, text(*key))
            }
        };
        if let Some(condition) = case.condition {
            line.push_str(&format!(" if {}", text(condition)));
        }
        self.line(2, &line);
    }

    fn creation(&mut self, create: &Create, names: Names, depth: usize) {
        let ty = &self.model.types[create.ty];
        let mut parts = Vec::new();
        let given = [(&ty.params, &create.params), (&ty.states, &create.states)];
        for (variables, given) in given.into_iter().chain([(&ty.discretes, &create.discretes)]) {
            for (variable, given) in variables.iter().zip(given) {
                let Some(given) = given else { continue };
                let texts = given.exprs().into_iter().map(|id| self.formulas.text(id, names));
                let texts = texts.collect::<Vec<_>>().join(", ");
                parts.push(match given {
                    Given::Value(_) => format!("{} = {texts}", variable.name),
                    Given::Draw(draw) => format!("{} ~ {}({texts})", variable.name, draw.distribution.name()),
                });
            }
        }
        for (link, agent) in ty.links.iter().zip(&create.links) {
            if let Some(agent) = agent {
                parts.push(format!("{} = {}", link.name, self.formulas.text(*agent, names)));
            }
        }
        let path = &ty.modes[create.mode].path;
        let mode = if path.is_empty() { String::new() } else { format!(" in {path}") };
        self.line(depth, &format!("create {}({}){mode}", ty.name, parts.join(", ")));
    }

    fn interaction(&mut self, item: &'m Interaction) {
        let [a, b] = &item.participants;
        let [first, second] = item.types.map(|ty| self.model.types[ty].name.clone());
        self.line(0, &format!("interaction {}({a}: {first}, {b}: {second})", item.name));
        for transition in &item.transitions {
            let names = Names { locals: &[], pair: Some(item) };
            self.transition(transition, None, names);
        }
    }

    fn population(&mut self, population: &Population) {
        self.line(0, &format!("population of {}", population.agents.len()));
        for block in &population.blocks {
            let ty = &self.model.types[block.ty].name;
            let size = if block.array { format!("[{}]", block.count) } else { String::new() };
            self.line(1, &format!("{} = {ty}{size}, from number {}", block.name, block.first));
            for index in 0..block.count.min(AGENTS_SHOWN) {
                let place = if block.array { format!("[{index}]") } else { String::new() };
                let text = format!(
                    "{}{place}{}",
                    block.name,
                    self.instance(&population.agents[block.first + index])
                );
                self.line(2, &text);
            }
            if block.count > AGENTS_SHOWN {
                self.line(2, &format!("... and {} more", block.count - AGENTS_SHOWN));
            }
        }
    }

    fn instance(&self, agent: &Instance) -> String {
        let ty = &self.model.types[agent.ty];
        let mut text = String::new();
        let parts =
            [(&ty.params, &agent.params), (&ty.states, &agent.states), (&ty.discretes, &agent.discretes)];
        for (variables, values) in parts {
            for (variable, value) in variables.iter().zip(values) {
                text.push_str(&format!(" {}={}", variable.name, number(*value, variable.ty)));
            }
        }
        for (link, target) in ty.declared_links().iter().zip(&agent.links) {
            let target = target.map_or("none".to_string(), |number| self.agent_name(number));
            text.push_str(&format!(" {}={target}", link.name));
        }
        let mode = &ty.modes[agent.mode];
        let mode = if mode.path.is_empty() { String::new() } else { format!(" in {}", mode.path) };
        if text.is_empty() { mode } else { format!(":{text}{mode}") }
    }

    fn agent_name(&self, agent: usize) -> String {
        let blocks = &self.model.population.blocks;
        let block = blocks.iter().find(|block| (block.first..block.first + block.count).contains(&agent));
        block.map_or(String::new(), |block| super::make::instance_name(block, agent - block.first))
    }

    fn run(&mut self, run: &Run) {
        let or_none = |value: Option<f64>| value.map_or("none".to_string(), number_text);
        let (until, absolute) = (or_none(run.until), or_none(run.absolute));
        let line = format!(
            "run until {until} tolerance {} absolute {absolute} seed {}",
            number_text(run.tolerance),
            run.seed
        );
        let integrator = match run.integrator {
            Integrator::Auto => String::new(),
            other => format!(" integrator {}", other.name()),
        };
        self.line(0, &(line + &integrator));
        if run.machinery != Machinery::default() {
            self.machinery(&run.machinery);
        }
        for record in &run.records {
            self.record(record);
        }
        if let Some(events) = &run.events {
            self.line(1, &format!("events to \"{events}\""));
        }
    }

    fn machinery(&mut self, machinery: &Machinery) {
        let names = [
            ("algorithm", machinery.algorithm.map(Named::name)),
            ("engine", machinery.engine.map(Named::name)),
            ("backend", machinery.backend.map(Named::name)),
        ];
        let numbers = [
            ("threads", machinery.threads.map(f64::from)),
            ("event_tolerance", machinery.event_tolerance),
            ("max_microsteps", machinery.microsteps_max.map(f64::from)),
            ("zeno_events", machinery.zeno_events.map(f64::from)),
            ("gamma", machinery.gamma),
            ("h_min", machinery.h_min),
            ("h_max", machinery.h_max),
            ("synchronisation", machinery.synchronisation),
        ];
        let names = names.into_iter().filter_map(|(name, value)| Some(format!("{name} {}", value?)));
        let numbers =
            numbers.into_iter().filter_map(|(name, value)| Some(format!("{name} {}", number_text(value?))));
        self.line(1, &names.chain(numbers).collect::<Vec<_>>().join(" "));
    }

    fn record(&mut self, record: &Record) {
        let every = match record.pace {
            Pace::EveryStep => "step and event".to_string(),
            Pace::Every(every) => format!("{every} s"),
            Pace::Thinning(thinning) => format!("{} s, thinned", thinning.first),
        };
        let file =
            record.file.as_ref().map_or("the command line's file".to_string(), |file| format!("\"{file}\""));
        let shown = record.agents.iter().take(2 * AGENTS_SHOWN).map(|&agent| self.agent_name(agent));
        let mut agents = shown.collect::<Vec<_>>().join(", ");
        if record.agents.len() > 2 * AGENTS_SHOWN {
            agents.push_str(&format!(" and {} more", record.agents.len() - 2 * AGENTS_SHOWN));
        }
        let columns = record.columns.join(", ");
        self.line(1, &format!("record {columns} of {agents} every {every} to {file}"));
        for (ty, variables) in self.model.types.iter().zip(&record.variables) {
            if variables.iter().any(|variable| variable.is_none()) && variables.iter().any(Option::is_some) {
                let names = variables
                    .iter()
                    .map(|variable| variable.map_or("-", |variable| variable_name(ty, variable)));
                let names = names.collect::<Vec<_>>().join(", ");
                self.line(2, &format!("{}: {names}", ty.name));
            }
        }
    }
}

fn variable_name(ty: &AgentType, variable: VarRef) -> &str {
    match variable {
        VarRef::State(number) => &ty.states[number].name,
        VarRef::Discrete(number) => &ty.discretes[number].name,
        VarRef::Param(number) => &ty.params[number].name,
        VarRef::Link(number) => &ty.links[number].name,
        VarRef::Let(number) => &ty.lets[number].name,
    }
}

fn number(value: f64, ty: Type) -> String {
    match ty {
        Type::Bool => (value != 0.0).to_string(),
        Type::Real | Type::Int | Type::Agent(_) | Type::Link(_) => number_text(value),
    }
}

/// ` [km/h = 0.2777777777777778]`: the declared unit and what it is in SI.
fn unit_text(unit: Option<&str>, factor: Option<f64>) -> String {
    match (unit, factor) {
        (None, _) => String::new(),
        (Some(unit), Some(factor)) if factor != 1.0 => format!(" [{unit} = {factor} in SI]"),
        (Some(unit), _) => format!(" [{unit}]"),
    }
}
