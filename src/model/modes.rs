//! The tree of modes of an agent type, as it is declared: names, initial modes, `let`s.

use rustc_hash::FxHashMap;

use super::context::{Body, Context};
use super::error::{LimitError, ModeError, NameError};
use super::ir::{Mode, ModeId, TypeId};
use crate::base::Span;
use crate::syntax::ast::{self, BodyItem};

impl<'a> Context<'a> {
    /// Adds the modes among these parts of a mode's text.
    pub fn declare_modes(&mut self, ty: TypeId, parent: ModeId, items: impl Iterator<Item = &'a BodyItem>) {
        let mut initial: Option<(ModeId, Span)> = None;
        let mut names: FxHashMap<&'a str, Span> = FxHashMap::default();
        for item in items {
            let BodyItem::Mode(mode) = item else { continue };
            let id = self.declare_mode(ty, parent, mode, &names);
            names.entry(&mode.name.text).or_insert(mode.name.span);
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

    /// `twins` are the names of the modes beside it, with their places.
    fn declare_mode(
        &mut self,
        ty: TypeId,
        parent: ModeId,
        item: &'a ast::Mode,
        twins: &FxHashMap<&'a str, Span>,
    ) -> ModeId {
        let modes = &self.model.types[ty].modes;
        let depth = modes[parent].depth + 1;
        let outer = &modes[parent].path;
        let path =
            if outer.is_empty() { item.name.text.clone() } else { format!("{outer}.{}", item.name.text) };
        if let Some(&first) = twins.get(item.name.text.as_str()) {
            self.report(NameError::Taken { name: path.clone(), span: item.name.span, first });
        }
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
        // The root is no mode.
        let most = self.model.limits.modes_max;
        if id.index() == most.saturating_add(1) {
            let agent = self.model.types[ty].name.clone();
            self.report(LimitError::Modes { agent, most, span: item.name.span });
        }
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
}
