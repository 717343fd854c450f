//! The system as readable mathematics, for `hyc show --stage system`.
//!
//! A block for every flow, claim, list of actions, transition and let. What a block names `@1`, `@2`, ... stands at its end.

use std::fmt::Write;

use crate::calculus::graph::NodeId;
use crate::calculus::print::{self, Names, Sheet};
use crate::calculus::system::{
    ActionStep, AgentSystem, Atom, Birth, ClaimKind, Column, Condition, Destination, Entry, Flow, Fold,
    Frame, FunctionId, Guard, KinkKind, LetValue, ModeSystem, Near, PairTransition, Quantified, Sender,
    Source, System, TransitionSystem, Trigger, VarRef,
};

/// The whole system as text; the same for the same system.
pub fn dump(system: &System) -> String {
    let mut out = String::new();
    for ty in &system.types {
        agent(system, ty, &mut out);
    }
    for interaction in &system.interactions {
        let types = interaction.types.map(|ty| system.types[ty].name.as_str());
        let _ = writeln!(out, "interaction {} of {} and {}", interaction.name, types[0], types[1]);
        for pair in &interaction.transitions {
            pair_transition(system, pair, &mut out);
        }
        out.push('\n');
    }
    let nodes = system.graph.nodes().len();
    let _ = writeln!(out, "{} functions over {nodes} nodes", system.functions.len());
    out
}

fn agent(system: &System, ty: &AgentSystem, out: &mut String) {
    let _ = writeln!(out, "agent {}", ty.name);
    let columns = |columns: &[Column]| columns.iter().map(|column| column.name.clone()).collect::<Vec<_>>();
    for (word, names) in [
        ("states", columns(&ty.states)),
        ("parameters", columns(&ty.params)),
        ("discretes", columns(&ty.discretes)),
        ("links", ty.links.iter().map(|link| link.name.clone()).collect()),
        ("hazards", ty.hazards.clone()),
    ] {
        if !names.is_empty() {
            let _ = writeln!(out, "  {word} {}", names.join(", "));
        }
    }
    if ty.layout.n_locks > 0 {
        let _ = writeln!(out, "  {} locks", ty.layout.n_locks);
    }
    for item in &ty.lets {
        let mut block = Block::new(system, &item.frame);
        let place = if item.mode == 0 { String::new() } else { format!(" in {}", ty.modes[item.mode].path) };
        match &item.value {
            LetValue::Number(value) => {
                block.functions.push(*value);
                let sheet = block.sheet();
                block.line(2, format!("let {}{place} = {}", item.column.name, block.value(&sheet, *value)));
                block.close(&sheet, out);
            }
            LetValue::Condition(guard) => {
                block.add_guard(guard);
                let sheet = block.sheet();
                let text = block.condition(&sheet, guard, &guard.condition, 0);
                block.line(2, format!("let {}{place} = {text}", item.column.name));
                block.atoms(&sheet, &guard.atoms, 4);
                block.close(&sheet, out);
            }
        }
    }
    for mode in &ty.modes {
        self::mode(system, ty, mode, out);
    }
    for transition in &ty.transitions {
        let mut head = format!("transition {}", transition.label);
        if transition.source != 0 {
            let _ = write!(head, " of {}", ty.modes[transition.source].path);
        }
        self::transition(system, transition, ty, head, None, out);
    }
    out.push('\n');
}

fn destination(ty: &AgentSystem, target: Destination) -> String {
    format!("{}{}", ty.modes[target.mode.index()].path, target.suffix())
}

fn mode(system: &System, ty: &AgentSystem, mode: &ModeSystem, out: &mut String) {
    let name = if mode.path.is_empty() { ty.name.as_str() } else { mode.path.as_str() };
    let _ = writeln!(out, "  mode {name}");
    if let Some(flow) = &mode.flow {
        self::flow(system, ty, flow, out);
    }
    for claim in &mode.claims {
        let mut block = Block::new(system, &claim.frame);
        block.add_guard(&claim.violation);
        let sheet = block.sheet();
        let word = match claim.kind {
            ClaimKind::Invariant => "invariant",
            ClaimKind::Assert => "assert",
            ClaimKind::Rate => "rate not negative",
            ClaimKind::Property => "property",
        };
        let text = block.condition(&sheet, &claim.violation, &claim.violation.condition, 0);
        let whose = if claim.kind == ClaimKind::Property { "of" } else { "violated by" };
        block.line(4, format!("{word} {whose} {text}"));
        block.ranges(&sheet, &claim.violation.condition, 6);
        block.atoms(&sheet, &claim.violation.atoms, 6);
        block.close(&sheet, out);
    }
    for (word, list) in [("entry", &mode.entry), ("exit", &mode.exit)] {
        if !list.steps.is_empty() {
            let mut block = Block::new(system, &list.frame);
            block.add_steps(&list.steps);
            let sheet = block.sheet();
            block.line(4, word.to_owned());
            block.steps(&sheet, &list.steps, 6);
            block.close(&sheet, out);
        }
    }
}

fn flow(system: &System, ty: &AgentSystem, flow: &Flow, out: &mut String) {
    let mut block = Block::new(system, &flow.frame);
    block.functions.extend([flow.rates, flow.accelerations, flow.jacobian_values]);
    for kink in &flow.kinks {
        block.functions.push(kink.initial);
        block.functions.extend(kink_atoms(&kink.kind).iter().map(|atom| atom.rates));
    }
    let sheet = block.sheet();
    let outputs = |function: FunctionId| &system.functions[function].outputs;
    for (primes, function) in [("'", flow.rates), ("''", flow.accelerations)] {
        for (state, &rate) in outputs(function).iter().enumerate() {
            block.line(4, format!("{}{primes} = {}", ty.state_name(state), sheet.text(rate)));
        }
    }
    for (entry, &value) in flow.jacobian.iter().zip(outputs(flow.jacobian_values)) {
        let by = sheet.state(entry.slot, entry.column);
        block.line(4, format!("d({}')/d({by}) = {}", ty.state_name(entry.row), sheet.text(value)));
    }
    for kink in &flow.kinks {
        let holds = match &kink.kind {
            KinkKind::Branch(_) => "is 1 while",
            KinkKind::Integer { .. } => "is",
        };
        let lock = kink.lock - ty.layout.lock(0);
        block.line(4, format!("kink: lock{lock} {holds} {}", block.value(&sheet, kink.initial)));
        for atom in kink_atoms(&kink.kind) {
            block.atom(&sheet, atom, "surface", 6);
        }
    }
    if !flow.couples.is_empty() {
        let names: Vec<&str> = flow.couples.iter().map(|&slot| flow.frame.slots[slot].name()).collect();
        block.line(4, format!("coupled with {}", names.join(", ")));
    }
    block.close(&sheet, out);
}

fn kink_atoms(kind: &KinkKind) -> Vec<&Atom> {
    match kind {
        KinkKind::Branch(atom) => vec![atom],
        KinkKind::Integer { below, above } => vec![below, above],
    }
}

fn pair_transition(system: &System, pair: &PairTransition, out: &mut String) {
    let kind = if pair.symmetric { "symmetric" } else { "ordered" };
    let head = format!("transition {}, {kind}", pair.transition.label);
    let slot = &pair.transition.frame.slots[0];
    transition(system, &pair.transition, &system.types[slot.ty()], head, Some(&pair.near), out);
}

fn transition(
    system: &System,
    transition: &TransitionSystem,
    ty: &AgentSystem,
    head: String,
    near: Option<&[Near]>,
    out: &mut String,
) {
    let mut block = Block::new(system, &transition.frame);
    let (word, time, guard) = match &transition.trigger {
        Trigger::When(guard) => ("when", None, Some(guard)),
        Trigger::After { delay, guard } => ("after", Some(*delay), guard.as_ref()),
        Trigger::Every { period, guard } => ("every", Some(*period), guard.as_ref()),
        Trigger::On { guard, .. } => ("on", None, guard.as_ref()),
        Trigger::Rate { guard, .. } => ("rate", None, guard.as_ref()),
        Trigger::Chance { rate, guard, .. } => ("rate", Some(*rate), guard.as_ref()),
    };
    block.functions.extend(time.iter().chain(&transition.priority));
    if let Some(guard) = guard {
        block.add_guard(guard);
    }
    block.add_steps(&transition.actions.steps);
    let sheet = block.sheet();
    let target = transition.target.map_or(String::new(), |target| format!(" -> {}", destination(ty, target)));
    block.line(2, format!("{head}{target}"));
    if let Some(time) = time {
        block.line(4, format!("{word} {}", block.value(&sheet, time)));
    }
    if let Trigger::Rate { due, .. } = &transition.trigger {
        block.line(4, format!("rate: when {}", block.condition(&sheet, due, &due.condition, 0)));
    }
    if let Trigger::On { events, from, .. } = &transition.trigger {
        block.line(4, format!("on {}{}", heard(system, events), sender(&transition.frame, *from)));
    }
    if let Some(guard) = guard {
        block.line(4, format!("when {}", block.condition(&sheet, guard, &guard.condition, 0)));
        if let Some(near) = near {
            block.line(6, format!("near: {}", range(&sheet, near, 1, "pairs")));
        }
        block.ranges(&sheet, &guard.condition, 6);
        let changes = |fold: &&Fold| fold.moves || !fold.filter.atoms.is_empty();
        for fold in transition.frame.folds.iter().filter(|fold| fold.around.is_empty()).filter(changes) {
            let (name, near) = (
                transition.frame.slots[fold.slot].name(),
                range(&sheet, &fold.near, fold.range.slot, "agents"),
            );
            block.line(6, format!("near of {name}: {near}"));
        }
        block.atoms(&sheet, &guard.atoms, 6);
    }
    if let Some(priority) = transition.priority {
        block.line(4, format!("priority {}", block.value(&sheet, priority)));
    }
    block.steps(&sheet, &transition.actions.steps, 4);
    block.close(&sheet, out);
}

/// `Car.braking, Bus.braking`
fn heard(system: &System, events: &[(usize, usize)]) -> String {
    let names = events.iter().map(|&(ty, event)| {
        let ty = &system.types[ty];
        format!("{}.{}", ty.name, ty.events[event].name)
    });
    names.collect::<Vec<_>>().join(", ")
}

fn sender(frame: &Frame, from: Sender) -> String {
    match from {
        Sender::Others => String::new(),
        Sender::Slot(slot) => format!(" from {}", frame.slots[slot].name()),
    }
}

/// `|a.x - b.x| <= 1, |a.y - b.y| <= 1`, to six digits, or all of whatever there is.
fn range(sheet: &Sheet, near: &[Near], slot: usize, what: &str) -> String {
    if near.is_empty() {
        return format!("all {what}");
    }
    let bounds = near.iter().map(|&Near { own, other, within }| {
        let within: f64 = format!("{within:.5e}").parse().expect("a number is one");
        format!("|{} - {}| <= {}", column(sheet, 0, own), column(sheet, slot, other), print::constant(within))
    });
    bounds.collect::<Vec<_>>().join(", ")
}

/// Lines that share names for their parts.
struct Block<'a> {
    system: &'a System,
    names: Names<'a>,
    functions: Vec<FunctionId>,
    lines: String,
}

impl<'a> Block<'a> {
    fn new(system: &'a System, frame: &'a Frame) -> Self {
        let names = Names { types: &system.types, frame };
        let mut block = Self { system, names, functions: Vec::new(), lines: String::new() };
        for fold in &frame.folds {
            block.add_guard(&fold.filter);
            block.functions.extend(fold.term.as_ref().map(|term| term.rates));
        }
        block
    }

    fn add_guard(&mut self, guard: &Guard) {
        self.functions.extend(guard.atoms.iter().map(|atom| atom.rates));
        self.add_tests(&guard.condition);
    }

    fn add_tests(&mut self, condition: &Condition) {
        match condition {
            Condition::Constant(_) | Condition::Atom(_) => {}
            Condition::Discrete(function) => self.functions.push(*function),
            Condition::And(terms) | Condition::Or(terms) => {
                terms.iter().for_each(|term| self.add_tests(term))
            }
            Condition::Exists(quantified) | Condition::Forall(quantified) => self.add_tests(&quantified.body),
            Condition::Rising(_, inner) => self.add_tests(inner),
        }
    }

    fn add_steps(&mut self, steps: &[ActionStep]) {
        for step in steps {
            match step {
                ActionStep::Assign { value, .. } => self.functions.push(*value),
                ActionStep::Draw { parameters, .. } => self.functions.extend(parameters),
                ActionStep::Emit { values, delay, .. } => self.functions.extend(values.iter().chain(delay)),
                ActionStep::If { condition, then, otherwise } => {
                    self.add_guard(condition);
                    self.add_steps(then);
                    self.add_steps(otherwise);
                }
                ActionStep::Create(birth) => {
                    let functions = birth.given.iter().flat_map(|(_, source)| source.functions());
                    self.functions.extend(functions);
                }
                ActionStep::Goto { .. } | ActionStep::Stop { .. } | ActionStep::Destroy { .. } => {}
            }
        }
    }

    /// Names for the parts of all that has been added.
    fn sheet(&self) -> Sheet<'a> {
        let outputs = self.functions.iter().flat_map(|&function| &self.system.functions[function].outputs);
        let roots: Vec<NodeId> = outputs.copied().collect();
        Sheet::new(&self.system.graph, self.names, &roots)
    }

    fn line(&mut self, indent: usize, text: String) {
        let _ = writeln!(self.lines, "{:indent$}{text}", "");
    }

    /// The aggregates of the frame, each with its filter and the rates of its term.
    fn folds(&mut self, sheet: &Sheet) {
        for fold in &self.names.frame.folds {
            let mut text = self.names.frame.slots[fold.slot].name().to_owned();
            if !matches!(fold.filter.condition, Condition::Constant(true)) {
                let _ =
                    write!(text, " where {}", self.condition(sheet, &fold.filter, &fold.filter.condition, 0));
            }
            if let Some(term) = &fold.term {
                let _ = write!(text, ": {}", self.value(sheet, term.value));
            }
            self.line(6, text);
            self.atoms(sheet, &fold.filter.atoms, 8);
            if let Some(term) = &fold.term {
                let outputs = self.system.functions[term.rates].outputs.iter().skip(1);
                for (primes, &output) in ["' ", "''"].iter().zip(outputs) {
                    self.line(8, format!("{primes} = {}", sheet.text(output)));
                }
            }
        }
    }

    fn close(mut self, sheet: &Sheet, out: &mut String) {
        self.folds(sheet);
        for explanation in sheet.explanations() {
            self.line(6, format!("where {explanation}"));
        }
        out.push_str(&self.lines);
    }

    fn value(&self, sheet: &Sheet, function: FunctionId) -> String {
        sheet.text(self.system.functions[function].outputs[0])
    }

    fn values(&self, sheet: &Sheet, functions: &[FunctionId]) -> String {
        functions.iter().map(|&function| self.value(sheet, function)).collect::<Vec<_>>().join(", ")
    }

    fn atoms(&mut self, sheet: &Sheet, atoms: &[Atom], indent: usize) {
        for (k, atom) in atoms.iter().enumerate() {
            self.atom(sheet, atom, &format!("[{}]", k + 1), indent);
        }
    }

    fn atom(&mut self, sheet: &Sheet, atom: &Atom, head: &str, indent: usize) {
        let jumps = if atom.smooth { "" } else { ", jumps" };
        self.line(indent, format!("{head} {}{jumps}", atom.text));
        for (name, &output) in ["g  ", "g' ", "g''"].iter().zip(&self.system.functions[atom.rates].outputs) {
            self.line(indent + 2, format!("{name} = {}", sheet.text(output)));
        }
    }

    /// `level`: 0 outside, 1 inside `or`, 2 inside `and`.
    fn condition(&self, sheet: &Sheet, guard: &Guard, condition: &Condition, level: usize) -> String {
        let (text, own) = match condition {
            Condition::Constant(value) => (value.to_string(), 3),
            Condition::Discrete(function) => match self.value(sheet, *function) {
                text if text.contains(" or ") => (text, 1),
                text => (text, 2),
            },
            Condition::Atom(k) => (format!("[{}] {}", k + 1, guard.atoms[*k].text), 3),
            Condition::And(terms) => (self.joined(sheet, guard, terms, " and ", 2), 2),
            Condition::Or(terms) => (self.joined(sheet, guard, terms, " or ", 1), 1),
            Condition::Exists(quantified) => (self.quantified(sheet, guard, "exists", quantified), 0),
            Condition::Forall(quantified) => (self.quantified(sheet, guard, "forall", quantified), 0),
            Condition::Rising(_, inner) => (format!("rising({})", self.condition(sheet, guard, inner, 0)), 3),
        };
        if own < level { format!("({text})") } else { text }
    }

    fn joined(&self, sheet: &Sheet, guard: &Guard, terms: &[Condition], word: &str, level: usize) -> String {
        let texts: Vec<String> = terms.iter().map(|term| self.condition(sheet, guard, term, level)).collect();
        texts.join(word)
    }

    fn quantified(&self, sheet: &Sheet, guard: &Guard, word: &str, quantified: &Quantified) -> String {
        let name = self.names.frame.slots[quantified.slot].name();
        let other = if quantified.other { "other " } else { "" };
        let body = self.condition(sheet, guard, &quantified.body, 0);
        format!("{word} {name} in {other}{}: {body}", self.names.types[quantified.ty].name)
    }

    /// A line for every quantifier.
    fn ranges(&mut self, sheet: &Sheet, condition: &Condition, indent: usize) {
        match condition {
            Condition::And(terms) | Condition::Or(terms) => {
                terms.iter().for_each(|term| self.ranges(sheet, term, indent));
            }
            Condition::Exists(quantified) | Condition::Forall(quantified) => {
                let Quantified { slot, near, body, .. } = quantified;
                let name = self.names.frame.slots[*slot].name();
                self.line(indent, format!("near {name}: {}", range(sheet, near, *slot, "agents")));
                self.ranges(sheet, body, indent);
            }
            Condition::Rising(_, inner) => self.ranges(sheet, inner, indent),
            Condition::Constant(_) | Condition::Discrete(_) | Condition::Atom(_) => {}
        }
    }

    fn birth(&mut self, sheet: &Sheet, birth: &Birth, indent: usize) {
        let ty = &self.names.types[birth.ty];
        let path = &ty.modes[birth.mode].path;
        let mode = if path.is_empty() { String::new() } else { format!(" in {path}") };
        self.line(indent, format!("create {}{mode}", ty.name));
        for (variable, source) in &birth.given {
            let values = source.functions().iter().map(|&function| self.value(sheet, function));
            let values = values.collect::<Vec<_>>().join(", ");
            let name = match variable {
                VarRef::State(k) => &ty.states[*k].name,
                VarRef::Discrete(k) => &ty.discretes[*k].name,
                VarRef::Param(k) => &ty.params[*k].name,
                VarRef::Link(k) => &ty.links[*k].name,
                VarRef::Let(k) => &ty.lets[*k].column.name,
            };
            let given = match source {
                Source::Number(_) => format!("{name} = {values}"),
                Source::Draw { distribution, .. } => format!("{name} ~ {}({values})", distribution.name()),
            };
            self.line(indent + 2, given);
        }
        for &(link, slot) in &birth.links {
            let agent = slot.map_or("none", |slot| self.names.frame.slots[slot].name());
            self.line(indent + 2, format!("{} = {agent}", ty.links[link].name));
        }
    }

    fn steps(&mut self, sheet: &Sheet, steps: &[ActionStep], indent: usize) {
        for step in steps {
            match step {
                ActionStep::Assign { slot, target, value, .. } => {
                    let column = column(sheet, *slot, *target);
                    self.line(indent, format!("{column} := {}", self.value(sheet, *value)));
                }
                ActionStep::Draw { slot, target, distribution, parameters, .. } => {
                    let column = column(sheet, *slot, *target);
                    let parameters = self.values(sheet, parameters);
                    self.line(indent, format!("{column} ~ {}({parameters})", distribution.name()));
                }
                ActionStep::Emit { slot, event, values, delay, .. } => {
                    let slot = &self.names.frame.slots[*slot];
                    let event = &self.names.types[slot.ty()].events[*event].name;
                    let (slot, values) = (slot.name(), self.values(sheet, values));
                    let delay = delay.map(|delay| format!(" after {}", self.value(sheet, delay)));
                    let delay = delay.unwrap_or_default();
                    self.line(indent, format!("emit {slot}.{event}({values}){delay}"));
                }
                ActionStep::If { condition, then, otherwise } => {
                    let test = self.condition(sheet, condition, &condition.condition, 0);
                    self.line(indent, format!("if {test}"));
                    self.steps(sheet, then, indent + 2);
                    if !otherwise.is_empty() {
                        self.line(indent, "else".to_owned());
                        self.steps(sheet, otherwise, indent + 2);
                    }
                }
                ActionStep::Goto { slot, target, .. } => {
                    let slot = &self.names.frame.slots[*slot];
                    let mode = destination(&self.names.types[slot.ty()], *target);
                    self.line(indent, format!("{} -> {mode}", slot.name()));
                }
                ActionStep::Stop { reason, .. } => {
                    let reason = reason.as_ref().map_or(String::new(), |reason| format!(" {reason:?}"));
                    self.line(indent, format!("stop{reason}"));
                }
                ActionStep::Create(birth) => self.birth(sheet, birth, indent),
                ActionStep::Destroy { slot, .. } => {
                    self.line(indent, format!("destroy {}", self.names.frame.slots[*slot].name()));
                }
            }
        }
    }
}

/// The name of a variable of the agent in a slot.
fn column(sheet: &Sheet, slot: usize, entry: Entry) -> String {
    match entry {
        Entry::State(k) => sheet.state(slot, k),
        Entry::Aux(k) => sheet.aux(slot, k),
    }
}
