//! What `record` names: agents, types of agents, variables of either; and the columns that come of it.
//!
//! Without a variable an item stands for all states and discrete variables.

use std::collections::BTreeSet;

use rustc_hash::FxHashMap;

use super::columns::{Measure, column_name, divided_names, is_kept, measure};
use super::context::{Context, Global, GlobalKind, Home, Scope};
use super::error::{LimitError, RunError, SystemError};
use super::ir::{Pace, Record, TypeId};
use super::suggest::closest;
use super::types::Ty;
use crate::base::Span;
use crate::syntax::ast;

/// What is recorded, item by item.
pub(super) struct Choice {
    /// For each type, whether all of its agents are wanted, those created later included.
    types: Vec<bool>,
    /// For each block, whether all of it is wanted.
    blocks: Vec<bool>,
    /// Numbers of single agents, in any order.
    agents: Vec<usize>,
    /// For each type, for each recordable name in declared order, the item that wants it.
    variables: Vec<Vec<Option<Span>>>,
    /// The blocks by their names.
    by_name: FxHashMap<String, usize>,
    /// For each type, the places of its recordable names; none until somebody asks.
    places: Vec<Option<FxHashMap<String, usize>>>,
}

impl<'a> Context<'a> {
    /// A choice of nothing.
    pub fn nothing_chosen(&self) -> Choice {
        let variables = self.model.types.iter().map(|ty| vec![None; ty.declared.len()]).collect();
        let names = self.model.population.blocks.iter().enumerate().map(|(k, block)| (block.name.clone(), k));
        Choice {
            types: vec![false; self.model.types.len()],
            blocks: vec![false; self.model.population.blocks.len()],
            agents: Vec::new(),
            variables,
            by_name: names.rev().collect(),
            places: vec![None; self.model.types.len()],
        }
    }

    /// The place of a recordable name among those of its type.
    fn place_of(&self, ty: TypeId, name: &str, choice: &mut Choice) -> Option<usize> {
        let places = choice.places[ty.index()].get_or_insert_with(|| {
            let names = self.model.types[ty].declared.iter().enumerate();
            names.rev().map(|(place, (name, _))| (name.clone(), place)).collect()
        });
        places.get(name).copied()
    }

    /// Adds an item of `record`.
    pub fn choose(&mut self, item: &'a ast::Expr, choice: &mut Choice) {
        let (owner, variable) = match &item.kind {
            ast::ExprKind::Field(owner, variable) => (owner.as_ref(), Some(variable)),
            _ => (item, None),
        };
        let ty = match &owner.kind {
            ast::ExprKind::Name(name) => self.choose_name(name, owner.span, choice),
            ast::ExprKind::Index(array, index) => match &array.kind {
                ast::ExprKind::Name(name) => self.choose_element(name, array.span, index, choice),
                _ => self.not_recordable("an element of this".to_string(), owner.span),
            },
            _ => self.not_recordable("an expression".to_string(), owner.span),
        };
        let Some(ty) = ty else { return };
        match variable {
            None => self.choose_variables(ty, item.span, choice),
            Some(variable) => match self.place_of(ty, &variable.text, choice) {
                Some(place) => choice.variables[ty.index()][place] = Some(item.span),
                // A `let` that is wrong is not there, and has been reported.
                None if self.agents[ty.index()].members.contains_key(variable.text.as_str()) => {}
                None => self.no_member(ty, variable),
            },
        }
    }

    fn not_recordable(&mut self, found: String, span: Span) -> Option<TypeId> {
        self.report(RunError::NotRecordable { found, span, similar: None });
        None
    }

    fn choose_name(&mut self, name: &str, span: Span, choice: &mut Choice) -> Option<TypeId> {
        if let Some(&block) = choice.by_name.get(name) {
            choice.blocks[block] = true;
            return Some(self.model.population.blocks[block].ty);
        }
        match self.globals.get(name) {
            Some(&Global { kind: GlobalKind::Agent(ty), .. }) => {
                self.choose_agents(ty, choice);
                Some(ty)
            }
            // A block that is wrong has been reported.
            Some(Global { kind: GlobalKind::Instance, .. }) => None,
            Some(_) => self.not_recordable(format!("`{name}`"), span),
            None => {
                let types = self.model.types.iter().map(|ty| ty.name.as_str());
                let blocks = self.model.population.blocks.iter().map(|block| block.name.as_str());
                let similar = closest(name, types.chain(blocks));
                self.report(RunError::NotRecordable { found: format!("`{name}`"), span, similar });
                None
            }
        }
    }

    fn choose_element(
        &mut self,
        name: &str,
        span: Span,
        index: &'a ast::Expr,
        choice: &mut Choice,
    ) -> Option<TypeId> {
        let Some(&block) = choice.by_name.get(name) else {
            return match self.globals.get(name) {
                Some(Global { kind: GlobalKind::Instance, .. }) => None,
                _ => self.not_recordable(format!("an element of `{name}`"), span),
            };
        };
        let value = self.lower(&mut Scope::of(Home::File), index);
        let value = self.fit(value, Ty::Int, index.span, "an index");
        let place = self.constant(value, index, "an index")?;
        let block = &self.model.population.blocks[block];
        if !block.array {
            return self.not_recordable(format!("an element of `{name}`, which is a single agent,"), span);
        }
        let (array, count, first, ty) = (block.name.clone(), block.count, block.first, block.ty);
        if place >= 0.0 && place < count as f64 {
            choice.agents.push(first + place as usize);
        } else if !self.has_errors() {
            let instance = "record".to_string();
            let help = match count {
                0 => format!("create agents in `{array}`, or record a type: all its agents"),
                _ => format!("the last one is `{array}[{}]`; `{array}` alone is all of them", count - 1),
            };
            let (index, span) = (place, index.span);
            self.report(SystemError::OutOfRange { array, count, index, instance, help, span });
        }
        Some(ty)
    }

    fn choose_agents(&self, ty: TypeId, choice: &mut Choice) {
        choice.types[ty.index()] = true;
        for (wanted, block) in choice.blocks.iter_mut().zip(&self.model.population.blocks) {
            *wanted |= block.ty == ty;
        }
    }

    fn choose_variables(&self, ty: TypeId, item: Span, choice: &mut Choice) {
        let declared = self.model.types[ty].declared.iter();
        for (wanted, (_, variable)) in choice.variables[ty.index()].iter_mut().zip(declared) {
            if is_kept(*variable) {
                wanted.get_or_insert(item);
            }
        }
    }

    /// The record of all agents, with their states and discrete variables: where types have one name in different units, each of them has a
    /// column of its own.
    pub fn everything(&mut self, pace: Pace) -> Option<Record> {
        let mut choice = self.nothing_chosen();
        for ty in self.model.visible_types() {
            self.choose_agents(ty, &mut choice);
            self.choose_variables(ty, Span::default(), &mut choice);
        }
        let divided = divided_names(&self.model);
        self.recorded(choice, &divided, pace, None, Span::default())
    }

    /// The record that a choice comes to; none, and a diagnostic, if one of its columns would have two units, or if it has too many cells.
    pub fn chosen(&mut self, choice: Choice, pace: Pace, file: &str, span: Span) -> Option<Record> {
        let errors = self.two_units(&choice);
        let is_sound = errors.is_empty();
        errors.into_iter().for_each(|error| self.report(error));
        let record = self.recorded(choice, &BTreeSet::new(), pace, Some(file.to_string()), span);
        record.filter(|_| is_sound)
    }

    /// Columns for which types give different units, each once.
    fn two_units(&self, choice: &Choice) -> Vec<RunError> {
        let mut first: FxHashMap<&str, Option<(Measure<'_>, &str, Span)>> = FxHashMap::default();
        let mut errors = Vec::new();
        for (ty, wanted) in self.model.types.iter().zip(&choice.variables) {
            for ((name, variable), wanted) in ty.declared.iter().zip(wanted) {
                let (Some(span), Some(measure)) = (*wanted, measure(&self.model, ty, *variable)) else {
                    continue;
                };
                let this = (measure, ty.name.as_str(), span);
                let known = first.entry(name).or_insert(Some(this));
                // what has been told is not told again
                let Some(other) = *known else { continue };
                if other.0.goes_with(&measure) {
                    // a unit says more than none
                    *known = Some(if other.0.unit.is_none() { this } else { other });
                    continue;
                }
                let sides = [other, this]
                    .map(|(measure, ty, span)| (ty.to_string(), measure.unit.map(str::to_string), span));
                let one_kind = other.0.is_of_one_kind_with(&measure);
                errors.push(RunError::TwoUnits { column: name.clone(), sides, one_kind });
                *known = None;
            }
        }
        errors
    }

    fn recorded(
        &mut self,
        choice: Choice,
        divided: &BTreeSet<String>,
        pace: Pace,
        file: Option<String>,
        span: Span,
    ) -> Option<Record> {
        let Choice { types: born, blocks, mut agents, variables: wanted, .. } = choice;
        let mut columns: Vec<String> = Vec::new();
        let mut column_of: FxHashMap<String, usize> = FxHashMap::default();
        for (id, wanted) in self.model.types.indices().zip(&wanted) {
            let declared = self.model.types[id].declared.iter().zip(wanted);
            for ((name, _), _) in declared.filter(|(_, wanted)| wanted.is_some()) {
                let name = column_name(&self.model, id, name, divided);
                column_of.entry(name).or_insert_with_key(|name| {
                    columns.push(name.clone());
                    columns.len() - 1
                });
            }
        }
        agents.sort_unstable();
        agents.dedup();
        let population = &self.model.population;
        // An agent of a block that is wanted as a whole counts once.
        let block_of = |agent: usize| population.blocks.partition_point(|block| block.first <= agent) - 1;
        agents.retain(|&agent| !blocks[block_of(agent)]);
        let whole = population.blocks.iter().zip(&blocks).filter(|(_, wanted)| **wanted);
        let whole: Vec<_> = whole.map(|(block, _)| block.first..block.first + block.count).collect();
        let inside = whole.iter().map(ExactSizeIterator::len).sum::<usize>();
        let most = self.model.limits.cells_max;
        if inside.saturating_add(agents.len()).saturating_mul(columns.len()) > most {
            self.report(LimitError::Cells { most, span });
            return None;
        }
        agents.extend(whole.into_iter().flatten());
        agents.sort_unstable();
        let of_type = |(id, wanted): (TypeId, &Vec<Option<Span>>)| {
            let mut variables = vec![None; columns.len()];
            for ((name, variable), wanted) in self.model.types[id].declared.iter().zip(wanted).rev() {
                if let Some(&column) = column_of.get(&column_name(&self.model, id, name, divided)) {
                    variables[column] = wanted.map(|_| *variable);
                }
            }
            variables
        };
        let variables = self.model.types.indices().zip(&wanted).map(of_type).collect();
        Some(Record { agents, born, columns, variables, pace, file, span })
    }
}
