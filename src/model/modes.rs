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
            let id = self.declare_node(ty, parent, &mode.name, &mode.items, &names);
            self.declare_inside(ty, id, &mode.items);
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
        let is_no_region = |&&child: &&ModeId| !self.model.types[ty].modes[child].is_region;
        let first = self.model.types[ty].modes[parent].children.iter().find(is_no_region).copied();
        if let (Some(first), None) = (first, initial) {
            let modes = &self.model.types[ty].modes;
            let (span, example) = (modes[parent].span, modes[first].name.clone());
            let owner = self.owner_of_modes(ty, parent);
            self.report(ModeError::NoInitial { owner, span, example });
        }
        self.model.types[ty].modes[parent].initial = initial.map(|(id, _)| id).or(first);
    }

    /// Adds the regions of an agent.
    pub fn declare_regions(&mut self, ty: TypeId, regions: impl Iterator<Item = &'a ast::Region>) {
        let mut names: FxHashMap<&'a str, Span> = FxHashMap::default();
        for region in regions {
            let id = self.declare_node(ty, ModeId::new(0), &region.name, &region.items, &names);
            self.model.types[ty].modes[id].is_region = true;
            names.entry(&region.name.text).or_insert(region.name.span);
            self.declare_inside(ty, id, &region.items);
        }
    }

    /// Modes stand in regions or beside none; and how many combinations there are.
    pub fn check_regions(&mut self, ty: TypeId) {
        let model = &self.model.types[ty];
        let children = || model.modes[ModeId::new(0)].children.iter().map(|&child| &model.modes[child]);
        let region = children().find(|child| child.is_region);
        let mode = children().find(|child| !child.is_region);
        if let (Some(region), Some(mode)) = (region, mode) {
            let (span, name, first) = (mode.span, mode.name.clone(), region.span);
            self.agents[ty.index()].incomplete = true;
            return self.report(ModeError::BesideRegion { name, span, first });
        }
        let (count, most) = (model.n_configurations(), self.model.limits.configurations_max);
        if region.is_some() && count > most {
            let (agent, span) = (model.name.clone(), model.span);
            self.agents[ty.index()].incomplete = true;
            self.report(LimitError::Configurations { agent, count, most, span });
        }
    }

    fn owner_of_modes(&self, ty: TypeId, parent: ModeId) -> String {
        let mode = &self.model.types[ty].modes[parent];
        match mode.parent {
            None => format!("agent `{}`", mode.name),
            Some(_) if mode.is_region => format!("region `{}`", mode.name),
            Some(_) => format!("mode `{}`", mode.path),
        }
    }

    /// `twins` are the names of the modes beside it, with their places.
    fn declare_node(
        &mut self,
        ty: TypeId,
        parent: ModeId,
        name: &'a ast::Name,
        items: &'a [BodyItem],
        twins: &FxHashMap<&'a str, Span>,
    ) -> ModeId {
        let modes = &self.model.types[ty].modes;
        let depth = modes[parent].depth + 1;
        let outer = &modes[parent].path;
        let path = if outer.is_empty() { name.text.clone() } else { format!("{outer}.{}", name.text) };
        if let Some(&first) = twins.get(name.text.as_str()) {
            self.report(NameError::Taken { name: path.clone(), span: name.span, first });
        }
        let id = self.model.types[ty].modes.push(Mode {
            name: name.text.clone(),
            path,
            parent: Some(parent),
            depth,
            children: Vec::new(),
            initial: None,
            is_region: false,
            flow: Vec::new(),
            invariants: Vec::new(),
            asserts: Vec::new(),
            entry: Vec::new(),
            exit: Vec::new(),
            span: name.span,
        });
        self.model.types[ty].modes[parent].children.push(id);
        // The root is no mode.
        let most = self.model.limits.modes_max;
        if id.index() == most.saturating_add(1) {
            let agent = self.model.types[ty].name.clone();
            self.report(LimitError::Modes { agent, most, span: name.span });
        }
        self.agents[ty.index()].modes.push(Some(items));
        self.agents[ty.index()].mode_lets.push(FxHashMap::default());
        id
    }

    /// The `let`s and modes of a mode or a region.
    fn declare_inside(&mut self, ty: TypeId, id: ModeId, items: &'a [BodyItem]) {
        for part in items {
            if let BodyItem::Let(item) = part {
                self.declare_mode_let(ty, id, item);
            }
        }
        self.declare_modes(ty, id, items.iter());
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
