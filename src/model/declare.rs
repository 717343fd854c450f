//! Pass 1: every name that the file declares, with types, units and the trees of modes; no expression is read yet.

use rustc_hash::FxHashMap;

use super::context::{
    AgentNames, Body, Context, Definition, Global, GlobalKind, Member, PairNames, Progress,
};
use super::error::{ModeError, NameError, TypeError};
use super::ir::{AgentType, Interaction, Link, Mode, ModeId, Type, TypeId, Variable};
use super::suggest::closest;
use super::types::{Slot, Ty};
use super::units::{self, Unit};
use crate::base::{Arena, Span};
use crate::syntax::ast::{self, AgentItem, BodyItem, Item, VariableKind};

/// Names that have a meaning of their own and cannot be declared.
pub(super) const RESERVED: &[&str] = &[
    "pi",
    "inf",
    "true",
    "false",
    "none",
    "time",
    "self",
    "index",
    "sin",
    "cos",
    "tan",
    "asin",
    "acos",
    "atan",
    "atan2",
    "sinh",
    "cosh",
    "tanh",
    "asinh",
    "acosh",
    "atanh",
    "exp",
    "log",
    "log2",
    "log10",
    "sqrt",
    "cbrt",
    "abs",
    "sign",
    "min",
    "max",
    "floor",
    "ceil",
    "round",
    "trunc",
    "mod",
    "hypot",
    "clamp",
    "rising",
    "crossing",
    "Uniform",
    "Normal",
    "Exponential",
    "csv",
    "table",
    "real",
    "int",
    "bool",
    "string",
    "history",
];

/// Declares everything.
pub(super) fn declare<'a>(context: &mut Context<'a>, file: &'a ast::Ast) {
    context.declare_globals(file);
    for number in 0..context.agents.len() {
        context.declare_members(TypeId::new(number));
    }
    for number in 0..context.pairs.len() {
        context.declare_participants(number);
    }
}

impl<'a> Context<'a> {
    fn declare_globals(&mut self, file: &'a ast::Ast) {
        let (mut system, mut run) = (None, None);
        for item in &file.items {
            match item {
                Item::Import(import) => {
                    self.imports = true;
                    self.refuse("imports", import.span);
                }
                Item::Property(property) => self.refuse("properties", property.span),
                Item::Param(param) => self.declare_definition(&param.name, Body::Param(param)),
                Item::Let(item) => self.declare_definition(&item.name, Body::Let(item)),
                Item::Fn(item) => self.declare_definition(&item.name, Body::Function(item)),
                Item::Agent(agent) => self.declare_agent(agent),
                Item::Interaction(interaction) => self.declare_interaction(interaction),
                Item::System(block) => {
                    self.only_one("system", block.span, &mut system);
                    for instance in &block.instances {
                        self.declare_global(&instance.name, GlobalKind::Instance);
                    }
                }
                Item::Run(block) => self.only_one("run", block.span, &mut run),
            }
        }
    }

    fn only_one(&mut self, what: &'static str, span: Span, first: &mut Option<Span>) {
        match *first {
            Some(first) => self.report(NameError::Second { what, span, first }),
            None => *first = Some(span),
        }
    }

    fn check_reserved(&mut self, name: &ast::Name) {
        if RESERVED.contains(&name.text.as_str()) {
            self.report(NameError::Reserved { name: name.text.clone(), span: name.span });
        }
    }

    fn declare_global(&mut self, name: &'a ast::Name, kind: GlobalKind) {
        self.check_reserved(name);
        if let Some(first) = self.globals.get(name.text.as_str()) {
            let first = first.span;
            return self.report(NameError::Taken { name: name.text.clone(), span: name.span, first });
        }
        self.globals.insert(&name.text, Global { kind, span: name.span });
    }

    fn add_definition(&mut self, name: &'a ast::Name, body: Body<'a>) -> usize {
        self.definitions.push(Definition { name, body, progress: Progress::Waiting });
        self.definitions.len() - 1
    }

    fn declare_definition(&mut self, name: &'a ast::Name, body: Body<'a>) {
        let number = self.add_definition(name, body);
        self.declare_global(name, GlobalKind::Definition(number));
    }

    fn declare_agent(&mut self, item: &'a ast::Agent) {
        let root = Mode {
            name: item.name.text.clone(),
            path: String::new(),
            parent: None,
            depth: 0,
            children: Vec::new(),
            initial: None,
            flow: Vec::new(),
            invariants: Vec::new(),
            asserts: Vec::new(),
            entry: Vec::new(),
            exit: Vec::new(),
            span: item.name.span,
        };
        let ty = self.model.types.push(AgentType {
            name: item.name.text.clone(),
            span: item.name.span,
            params: Vec::new(),
            states: Vec::new(),
            discretes: Vec::new(),
            links: Vec::new(),
            lets: Vec::new(),
            declared: Vec::new(),
            modes: Arena::from_iter([root]),
            transitions: Vec::new(),
        });
        self.agents.push(AgentNames {
            item,
            members: FxHashMap::default(),
            params: Vec::new(),
            states: Vec::new(),
            discretes: Vec::new(),
            modes: vec![None],
            mode_lets: vec![FxHashMap::default()],
            incomplete: false,
        });
        self.declare_global(&item.name, GlobalKind::Agent(ty));
    }

    fn declare_interaction(&mut self, item: &'a ast::Interaction) {
        self.pairs.push(PairNames { item, id: None, participants: None, lets: FxHashMap::default() });
        self.declare_global(&item.name, GlobalKind::Interaction);
    }

    fn declare_members(&mut self, ty: TypeId) {
        let item = self.agents[ty.index()].item;
        for formal in &item.formals {
            self.declare_agent_formal(ty, formal);
        }
        for part in &item.items {
            match part {
                AgentItem::Variables(line) => {
                    for variable in &line.variables {
                        self.declare_variable(ty, line.kind, variable);
                    }
                }
                AgentItem::Link(link) => self.declare_link(ty, link),
                AgentItem::Event(event) => {
                    self.refuse("events", event.span);
                    self.declare_member(ty, &event.name, Member::Event);
                }
                AgentItem::Region(region) => {
                    self.agents[ty.index()].incomplete = true;
                    self.refuse("regions", region.span);
                }
                AgentItem::Body(BodyItem::Let(item)) => {
                    let number = self.add_definition(&item.name, Body::AgentLet(ty, ModeId::new(0), item));
                    self.declare_member(ty, &item.name, Member::Let(number));
                }
                AgentItem::Body(_) => {}
            }
        }
        let body = item.items.iter().filter_map(|part| match part {
            AgentItem::Body(item) => Some(item),
            AgentItem::Variables(_) | AgentItem::Link(_) | AgentItem::Event(_) | AgentItem::Region(_) => None,
        });
        self.declare_modes(ty, ModeId::new(0), body);
    }

    fn declare_member(&mut self, ty: TypeId, name: &'a ast::Name, member: Member) {
        self.check_reserved(name);
        let members = &mut self.agents[ty.index()].members;
        if let Some(&(_, first)) = members.get(name.text.as_str()) {
            return self.report(NameError::Taken { name: name.text.clone(), span: name.span, first });
        }
        members.insert(&name.text, (member, name.span));
    }

    fn declare_agent_formal(&mut self, ty: TypeId, formal: &'a ast::Formal) {
        let slot = self.slot(&formal.ty);
        match slot.ty {
            Ty::Agent(target) => {
                if let Some(default) = &formal.default {
                    self.report(TypeError::NotAllowed {
                        what: "a parameter of agent type",
                        found: "given by default".to_string(),
                        span: default.span,
                        help: "leave the default out; agents are linked in `system`",
                    });
                }
                let links = &mut self.model.types[ty].links;
                let span = formal.name.span;
                links.push(Link { name: formal.name.text.clone(), ty: target, required: true, span });
                let number = links.len() - 1;
                self.declare_member(ty, &formal.name, Member::Link(number));
            }
            Ty::Real | Ty::Int | Ty::Bool | Ty::Wrong | Ty::Text | Ty::Link(_) | Ty::Nobody => {
                let slot = self.no_text(slot, "a parameter of an agent", formal.ty.span);
                let variable = variable(&formal.name, Some(&formal.ty), slot);
                self.agents[ty.index()].params.push(slot);
                self.model.types[ty].params.push(variable);
                let number = self.model.types[ty].params.len() - 1;
                self.declare_member(ty, &formal.name, Member::Param(number));
            }
        }
    }

    fn declare_variable(&mut self, ty: TypeId, kind: VariableKind, item: &'a ast::Variable) {
        let slot = item.ty.as_ref().map_or(Slot::plain(Ty::Real), |ty| self.slot(ty));
        let span = item.ty.as_ref().map_or(item.name.span, |ty| ty.span);
        let (names, model) = (&mut self.agents[ty.index()], &mut self.model.types[ty]);
        let variable = variable(&item.name, item.ty.as_ref(), slot);
        let member = match kind {
            VariableKind::State => {
                names.states.push(slot);
                model.states.push(variable);
                Member::State(model.states.len() - 1)
            }
            VariableKind::Discrete => {
                names.discretes.push(slot);
                model.discretes.push(variable);
                Member::Discrete(model.discretes.len() - 1)
            }
        };
        self.declare_member(ty, &item.name, member);
        let (what, help, allowed) = match kind {
            VariableKind::State => {
                let allowed = matches!(slot.ty, Ty::Real | Ty::Wrong);
                ("a state", "a state flows, so it is real; what only jumps is declared `discrete`", allowed)
            }
            VariableKind::Discrete => {
                let allowed = matches!(slot.ty, Ty::Real | Ty::Int | Ty::Bool | Ty::Wrong);
                (
                    "a discrete variable",
                    "it holds a real, an int or a bool; a reference to an agent is a `link`",
                    allowed,
                )
            }
        };
        if !allowed {
            let found = self.describe(slot.ty);
            self.report(TypeError::NotAllowed { what, found, span, help });
        }
    }

    fn declare_link(&mut self, ty: TypeId, item: &'a ast::Link) {
        if let Some(value) = &item.value {
            self.refuse("links with an expression of their own", value.span);
        }
        let target = match &item.target {
            Some(name) => self.agent_named(name),
            None => {
                if item.value.is_none() {
                    self.report(TypeError::NotAllowed {
                        what: "a link",
                        found: "without a type".to_string(),
                        span: item.span,
                        help: "say what it leads to: `link lead: Car`",
                    });
                }
                None
            }
        };
        // Without a known type the link leads to agents of its own kind: some member must exist, and the model is refused anyway.
        let links = &mut self.model.types[ty].links;
        let span = item.name.span;
        links.push(Link { name: item.name.text.clone(), ty: target.unwrap_or(ty), required: false, span });
        let number = links.len() - 1;
        self.declare_member(ty, &item.name, Member::Link(number));
    }

    fn declare_modes(&mut self, ty: TypeId, parent: ModeId, items: impl Iterator<Item = &'a BodyItem>) {
        let mut initial: Option<(ModeId, Span)> = None;
        for item in items {
            let BodyItem::Mode(mode) = item else { continue };
            let id = self.declare_mode(ty, parent, mode);
            if let Some(span) = mode.initial {
                match initial {
                    Some((_, first)) => {
                        let owner = self.owner_of_modes(ty, parent);
                        self.report(ModeError::TwoInitial { owner, span, first });
                    }
                    None => initial = Some((id, span)),
                }
            }
        }
        let first = self.model.types[ty].modes[parent].children.first().copied();
        if let (Some(first), None) = (first, initial) {
            let modes = &self.model.types[ty].modes;
            let (span, example) = (modes[parent].span, modes[first].name.clone());
            let owner = self.owner_of_modes(ty, parent);
            self.report(ModeError::NoInitial { owner, span, example });
        }
        self.model.types[ty].modes[parent].initial = initial.map(|(id, _)| id).or(first);
    }

    fn owner_of_modes(&self, ty: TypeId, parent: ModeId) -> String {
        let mode = &self.model.types[ty].modes[parent];
        if mode.parent.is_none() { format!("agent `{}`", mode.name) } else { format!("mode `{}`", mode.path) }
    }

    fn declare_mode(&mut self, ty: TypeId, parent: ModeId, item: &'a ast::Mode) -> ModeId {
        let modes = &self.model.types[ty].modes;
        let depth = modes[parent].depth + 1;
        let outer = &modes[parent].path;
        let path =
            if outer.is_empty() { item.name.text.clone() } else { format!("{outer}.{}", item.name.text) };
        let twin = modes[parent].children.iter().copied().find(|&child| modes[child].name == item.name.text);
        if let Some(twin) = twin {
            let first = modes[twin].span;
            self.report(NameError::Taken { name: path.clone(), span: item.name.span, first });
        }
        if depth == 2 {
            self.refuse("modes inside modes", item.span);
        }
        self.check_reserved(&item.name);
        let id = self.model.types[ty].modes.push(Mode {
            name: item.name.text.clone(),
            path,
            parent: Some(parent),
            depth,
            children: Vec::new(),
            initial: None,
            flow: Vec::new(),
            invariants: Vec::new(),
            asserts: Vec::new(),
            entry: Vec::new(),
            exit: Vec::new(),
            span: item.name.span,
        });
        self.model.types[ty].modes[parent].children.push(id);
        self.agents[ty.index()].modes.push(Some(item));
        self.agents[ty.index()].mode_lets.push(FxHashMap::default());
        for part in &item.items {
            if let BodyItem::Let(item) = part {
                self.declare_mode_let(ty, id, item);
            }
        }
        self.declare_modes(ty, id, item.items.iter());
        id
    }

    fn declare_mode_let(&mut self, ty: TypeId, mode: ModeId, item: &'a ast::Let) {
        self.check_reserved(&item.name);
        let name = item.name.text.as_str();
        let number = self.add_definition(&item.name, Body::AgentLet(ty, mode, item));
        let names = &self.agents[ty.index()];
        let mut first = names.members.get(name).map(|(_, span)| *span);
        let mut around = Some(mode);
        while let Some(id) = around {
            let earlier = names.mode_lets[id.index()].get(name);
            first = earlier.map(|&number| self.definitions[number].name.span).or(first);
            around = self.model.types[ty].modes[id].parent;
        }
        match first {
            Some(first) => {
                self.report(NameError::Taken { name: name.to_string(), span: item.name.span, first })
            }
            None => {
                self.agents[ty.index()].mode_lets[mode.index()].insert(name, number);
            }
        }
    }

    fn declare_participants(&mut self, number: usize) {
        let item = self.pairs[number].item;
        for part in &item.items {
            let ast::InteractionItem::Let(item) = part else { continue };
            self.check_reserved(&item.name);
            let definition = self.add_definition(&item.name, Body::PairLet(number, item));
            let lets = &mut self.pairs[number].lets;
            match lets.get(item.name.text.as_str()) {
                Some(&first) => {
                    let first = self.definitions[first].name.span;
                    self.report(NameError::Taken {
                        name: item.name.text.clone(),
                        span: item.name.span,
                        first,
                    });
                }
                None => {
                    lets.insert(&item.name.text, definition);
                }
            }
        }
        let [a, b] = item.formals.as_slice() else {
            let count = item.formals.len();
            let what = if count == 1 { "participant" } else { "participants" };
            return self.refuse(format!("interactions with {count} {what}"), item.name.span);
        };
        if a.name.text == b.name.text {
            let name = b.name.text.clone();
            self.report(NameError::Taken { name, span: b.name.span, first: a.name.span });
        }
        let types = [a, b].map(|formal| self.participant_type(number, formal));
        if let [Some(first), Some(second)] = types {
            self.pairs[number].participants = Some([(&a.name.text, first), (&b.name.text, second)]);
            let id = self.model.interactions.push(Interaction {
                name: item.name.text.clone(),
                participants: [a.name.text.clone(), b.name.text.clone()],
                types: [first, second],
                transitions: Vec::new(),
                span: item.name.span,
            });
            self.pairs[number].id = Some(id);
        }
    }

    fn participant_type(&mut self, number: usize, formal: &'a ast::Formal) -> Option<TypeId> {
        self.check_reserved(&formal.name);
        if let Some(&number) = self.pairs[number].lets.get(formal.name.text.as_str()) {
            let span = self.definitions[number].name.span;
            self.report(NameError::Taken { name: formal.name.text.clone(), span, first: formal.name.span });
        }
        let slot = self.slot(&formal.ty);
        match slot.ty {
            Ty::Agent(ty) => return Some(ty),
            Ty::Wrong => {}
            Ty::Real | Ty::Int | Ty::Bool | Ty::Text | Ty::Link(_) | Ty::Nobody => {
                let found = self.describe(slot.ty);
                self.report(TypeError::NotAllowed {
                    what: "a participant of an interaction",
                    found,
                    span: formal.ty.span,
                    help: "an interaction is between agents: `interaction Bump(a: Car, b: Car)`",
                });
            }
        }
        None
    }

    /// The agent type of this name; none, and a diagnostic, if there is none.
    pub fn agent_named(&mut self, name: &ast::Name) -> Option<TypeId> {
        if let Some(Global { kind: GlobalKind::Agent(ty), .. }) = self.globals.get(name.text.as_str()) {
            return Some(*ty);
        }
        if !self.imports {
            let similar = closest(&name.text, self.model.types.iter().map(|ty| ty.name.as_str()));
            self.report(NameError::UnknownType { name: name.text.clone(), span: name.span, similar });
        }
        None
    }

    /// A declared type with its unit.
    pub fn slot(&mut self, item: &ast::TypeName) -> Slot {
        let ty = match item.name.text.as_str() {
            "real" => Ty::Real,
            "int" => Ty::Int,
            "bool" => Ty::Bool,
            "string" => Ty::Text,
            name => match self.globals.get(name) {
                Some(Global { kind: GlobalKind::Agent(ty), .. }) => Ty::Agent(*ty),
                _ => {
                    if !self.imports {
                        let types = self.model.types.iter().map(|ty| ty.name.as_str());
                        let similar = closest(name, types.chain(["real", "int", "bool", "string"]));
                        let (name, span) = (name.to_string(), item.name.span);
                        self.report(NameError::UnknownType { name, span, similar });
                    }
                    Ty::Wrong
                }
            },
        };
        let Some(text) = &item.unit else { return Slot::plain(ty) };
        if !matches!(ty, Ty::Real | Ty::Wrong) {
            self.report(TypeError::UnitOnType { ty: item.name.text.clone(), span: text.span });
        }
        Slot { ty, unit: self.unit(text) }
    }

    /// A unit; one, and a diagnostic, if the text is none.
    pub fn unit(&mut self, item: &ast::UnitText) -> Unit {
        units::parse(&item.text).unwrap_or_else(|problem| {
            self.report(TypeError::Unit { problem, span: item.span });
            Unit::ONE
        })
    }

    /// Refuses a text where only parameters of the file may be one.
    pub fn no_text(&mut self, slot: Slot, what: &'static str, span: Span) -> Slot {
        if slot.ty != Ty::Text {
            return slot;
        }
        let help = "only a `param` of the file can be a `string`";
        self.report(TypeError::NotAllowed { what, found: "a text".to_string(), span, help });
        Slot::plain(Ty::Wrong)
    }
}

fn variable(name: &ast::Name, ty: Option<&ast::TypeName>, slot: Slot) -> Variable {
    let ty_ir = match slot.ty {
        Ty::Int => Type::Int,
        Ty::Bool => Type::Bool,
        Ty::Real | Ty::Text | Ty::Agent(_) | Ty::Link(_) | Ty::Nobody | Ty::Wrong => Type::Real,
    };
    Variable {
        name: name.text.clone(),
        ty: ty_ir,
        unit: ty.and_then(|ty| ty.unit.as_ref()).map(|unit| unit.text.clone()),
        factor: slot.unit.factor(),
        span: name.span,
    }
}
