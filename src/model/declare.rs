//! Pass 1: every name that the files declare, with types, units and the trees of modes; no expression is read yet.

use rustc_hash::FxHashMap;

use super::context::{
    AgentNames, Body, Context, Definition, Global, GlobalKind, Member, PairNames, Progress,
};
use super::error::{InteractionError, LimitError, NameError, TypeError};
use super::ir::{AgentType, Event, Initials, Interaction, Link, Mode, ModeId, Type, TypeId, Variable};
use super::types::{Quantity, Slot, Ty};
use crate::base::{Arena, Span};
use crate::syntax::ast::{self, AgentItem, BodyItem, Item, VariableKind};

/// Declares everything.
pub(super) fn declare<'a>(context: &mut Context<'a>, items: &[&'a Item]) {
    context.declare_globals(items);
    for number in 0..context.agents.len() {
        context.declare_members(TypeId::new(number));
    }
    for number in 0..context.pairs.len() {
        context.declare_participants(number);
    }
}

impl<'a> Context<'a> {
    fn declare_globals(&mut self, items: &[&'a Item]) {
        let (mut system, mut run) = (None, None);
        self.globals.reserve(items.len());
        self.definitions.reserve(items.len());
        for item in items {
            match item {
                Item::Import(_) | Item::Property(_) => {}
                Item::Param(param) => self.declare_definition(&param.name, Body::Param(param)),
                Item::Let(item) => self.declare_definition(&item.name, Body::Let(item)),
                Item::Fn(item) => self.declare_definition(&item.name, Body::Function(item)),
                Item::Agent(agent) => self.declare_agent(agent),
                Item::Interaction(interaction) => self.declare_interaction(interaction),
                Item::System(block) => {
                    self.only_one("system", block.span, &mut system);
                    for instance in &block.instances {
                        self.declare_global(&instance.name, GlobalKind::Instance);
                        self.instances.push(instance);
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

    fn declare_global(&mut self, name: &'a ast::Name, kind: GlobalKind) {
        if let Some(first) = self.globals.get(name.text.as_str()) {
            let first = first.span;
            return self.report(NameError::Taken { name: name.text.clone(), span: name.span, first });
        }
        self.globals.insert(&name.text, Global { kind, span: name.span });
    }

    /// Adds a definition to be worked out later.
    pub fn add_definition(&mut self, name: &'a ast::Name, body: Body<'a>) -> usize {
        self.definitions.push(Definition {
            name,
            body,
            progress: Progress::Waiting,
            used: false,
            quantity: Quantity::Unchecked,
        });
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
            is_region: false,
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
            sets: Vec::new(),
            events: Vec::new(),
            lets: Vec::new(),
            declared: Vec::new(),
            memberships: Vec::new(),
            initials: Initials::default(),
            modes: Arena::from_iter([root]),
            transitions: Vec::new(),
        });
        self.agents.push(AgentNames {
            item,
            members: FxHashMap::default(),
            params: Vec::new(),
            states: Vec::new(),
            discretes: Vec::new(),
            events: Vec::new(),
            lets: Vec::new(),
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
                AgentItem::Event(event) => self.declare_event(ty, event),
                AgentItem::Region(_) => {}
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
        let regions = item.items.iter().filter_map(|part| match part {
            AgentItem::Region(region) => Some(&**region),
            AgentItem::Variables(_) | AgentItem::Link(_) | AgentItem::Event(_) | AgentItem::Body(_) => None,
        });
        self.declare_regions(ty, regions);
        self.declare_modes(ty, ModeId::new(0), body);
        self.check_regions(ty);
        self.model.types[ty].shrink_to_fit();
        let AgentNames { params, states, discretes, .. } = &mut self.agents[ty.index()];
        [params, states, discretes].into_iter().for_each(Vec::shrink_to_fit);
    }

    fn declare_member(&mut self, ty: TypeId, name: &'a ast::Name, member: Member) {
        let members = &mut self.agents[ty.index()].members;
        if let Some((earlier, first)) = members.get_mut(name.text.as_str()) {
            *earlier = Member::Twice;
            let first = *first;
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
                let name = formal.name.text.clone();
                links.push(Link { name, ty: target, required: true, cases: Vec::new(), span });
                let number = links.len() - 1;
                self.declare_member(ty, &formal.name, Member::Link(number));
            }
            Ty::Real | Ty::Int | Ty::Bool | Ty::Wrong | Ty::Text | Ty::Link(_) | Ty::Nobody | Ty::List(_) => {
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
        let most = self.model.limits.states_max;
        let (names, model) = (&mut self.agents[ty.index()], &mut self.model.types[ty]);
        let variable = variable(&item.name, item.ty.as_deref(), slot);
        let member = match kind {
            VariableKind::State => {
                names.states.push(slot);
                model.states.push(variable);
                if model.states.len() == most.saturating_add(1) {
                    let (agent, span) = (model.name.clone(), item.name.span);
                    self.findings.push(LimitError::States { agent, most, span }.into());
                }
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

    fn declare_event(&mut self, ty: TypeId, item: &'a ast::Event) {
        let mut params: Vec<Variable> = Vec::new();
        let mut slots = Vec::new();
        for formal in &item.formals {
            let slot = self.slot(&formal.ty);
            let slot = self.no_text(slot, "what an event carries", formal.ty.span);
            if slot.ty.is_reference() {
                let found = self.describe(slot.ty);
                let help = "an event carries numbers and truth values; the receiver may link to its sender";
                let (what, span) = ("what an event carries", formal.ty.span);
                self.report(TypeError::NotAllowed { what, found, span, help });
            }
            if let Some(default) = &formal.default {
                let (what, found) = ("what an event carries", "given by default".to_string());
                let help = "leave the default out; whoever emits the event says all that it carries";
                self.report(TypeError::NotAllowed { what, found, span: default.span, help });
            }
            if let Some(first) = params.iter().find(|param| param.name == formal.name.text) {
                let (name, span, first) = (formal.name.text.clone(), formal.name.span, first.span);
                self.report(NameError::Taken { name, span, first });
            }
            params.push(variable(&formal.name, Some(&formal.ty), slot));
            slots.push(slot);
        }
        self.agents[ty.index()].events.push(slots);
        let events = &mut self.model.types[ty].events;
        events.push(Event { name: item.name.text.clone(), params, span: item.name.span });
        let number = events.len() - 1;
        self.declare_member(ty, &item.name, Member::Event(number));
    }

    fn declare_link(&mut self, ty: TypeId, item: &'a ast::Link) {
        let of_value = item.value.as_ref().and_then(|value| self.link_type(value));
        let target = match item.target.as_ref().or(of_value) {
            Some(name) => self.agent_named(name),
            None => {
                self.report(TypeError::NotAllowed {
                    what: "a link",
                    found: "without a type".to_string(),
                    span: item.span,
                    help: "say what it leads to: `link lead: Car`",
                });
                None
            }
        };
        // Without a known type the link leads to agents of its own kind: some member must exist, and the model is refused anyway.
        let links = &mut self.model.types[ty].links;
        let span = item.name.span;
        let (name, cases) = (item.name.text.clone(), Vec::new());
        links.push(Link { name, ty: target.unwrap_or(ty), required: false, cases, span });
        let number = links.len() - 1;
        self.declare_member(ty, &item.name, Member::Link(number));
    }

    fn declare_participants(&mut self, number: usize) {
        let item = self.pairs[number].item;
        for part in &item.items {
            let ast::InteractionItem::Let(item) = part else { continue };
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
        for default in item.formals.iter().filter_map(|formal| formal.default.as_ref()) {
            let (what, found) = ("who takes part in an interaction", "given by default".to_string());
            let help = "leave the default out; an interaction is of every two agents of these types";
            self.report(TypeError::NotAllowed { what, found, span: default.span, help });
        }
        let [a, b] = item.formals.as_slice() else {
            let (count, span) = (item.formals.len(), item.name.span);
            return self.report(InteractionError::Participants { count, span });
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
        if let Some(&number) = self.pairs[number].lets.get(formal.name.text.as_str()) {
            let span = self.definitions[number].name.span;
            self.report(NameError::Taken { name: formal.name.text.clone(), span, first: formal.name.span });
        }
        let slot = self.slot(&formal.ty);
        match slot.ty {
            Ty::Agent(ty) => return Some(ty),
            Ty::Wrong => {}
            Ty::Real | Ty::Int | Ty::Bool | Ty::Text | Ty::Link(_) | Ty::Nobody | Ty::List(_) => {
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
}

fn variable(name: &ast::Name, ty: Option<&ast::TypeName>, slot: Slot) -> Variable {
    let ty_ir = match slot.ty {
        Ty::Int => Type::Int,
        Ty::Bool => Type::Bool,
        Ty::Real | Ty::Text | Ty::Agent(_) | Ty::Link(_) | Ty::Nobody | Ty::List(_) | Ty::Wrong => Type::Real,
    };
    Variable {
        name: name.text.clone(),
        ty: ty_ir,
        unit: ty.and_then(|ty| ty.unit.as_ref()).map(|unit| unit.text.clone()),
        scale: slot.scale(),
        span: name.span,
    }
}
