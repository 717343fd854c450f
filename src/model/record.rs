//! What `record` names: agents, types of agents, variables of either; and the columns that come of it.
//!
//! Without a variable an item stands for all states and discrete variables.

use super::context::{Context, Global, GlobalKind, Home, Scope};
use super::error::{RunError, SystemError};
use super::ir::{Record, TypeId, VarRef};
use super::suggest::closest;
use super::types::Ty;
use crate::base::Span;
use crate::syntax::ast;

/// What is recorded, item by item.
pub(super) struct Choice {
    /// Numbers of agents, in any order.
    agents: Vec<usize>,
    /// For each type, for each recordable name in declared order, whether it is wanted.
    variables: Vec<Vec<bool>>,
}

impl<'a> Context<'a> {
    /// A choice of nothing.
    pub fn nothing_chosen(&self) -> Choice {
        let variables = self.model.types.iter().map(|ty| vec![false; ty.declared.len()]).collect();
        Choice { agents: Vec::new(), variables }
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
        let declared = &self.model.types[ty].declared;
        match variable {
            None => self.choose_variables(ty, choice),
            Some(variable) => match declared.iter().position(|(name, _)| *name == variable.text) {
                Some(place) => choice.variables[ty.index()][place] = true,
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
        if let Some(block) = self.model.population.blocks.iter().find(|block| block.name == name) {
            choice.agents.extend(block.first..block.first + block.count);
            return Some(block.ty);
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
        let Some(block) = self.model.population.blocks.iter().position(|block| block.name == name) else {
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
            self.report(SystemError::OutOfRange { array, count, index: place, instance, span: index.span });
        }
        Some(ty)
    }

    fn choose_agents(&self, ty: TypeId, choice: &mut Choice) {
        let blocks = self.model.population.blocks.iter().filter(|block| block.ty == ty);
        choice.agents.extend(blocks.flat_map(|block| block.first..block.first + block.count));
    }

    fn choose_variables(&self, ty: TypeId, choice: &mut Choice) {
        let declared = self.model.types[ty].declared.iter();
        for (wanted, (_, variable)) in choice.variables[ty.index()].iter_mut().zip(declared) {
            *wanted |= matches!(variable, VarRef::State(_) | VarRef::Discrete(_));
        }
    }

    /// Adds all agents of a type, with their states and discrete variables.
    pub fn choose_type(&self, ty: TypeId, choice: &mut Choice) {
        self.choose_agents(ty, choice);
        self.choose_variables(ty, choice);
    }

    /// The record that a choice comes to.
    pub fn chosen(&self, choice: Choice, every: Option<f64>, file: Option<String>, span: Span) -> Record {
        let Choice { mut agents, variables: wanted } = choice;
        agents.sort_unstable();
        agents.dedup();
        let mut columns: Vec<String> = Vec::new();
        for (ty, wanted) in self.model.types.iter().zip(&wanted) {
            for ((name, _), _) in ty.declared.iter().zip(wanted).filter(|(_, wanted)| **wanted) {
                if !columns.contains(name) {
                    columns.push(name.clone());
                }
            }
        }
        let of_type = |(ty, wanted): (&super::ir::AgentType, &Vec<bool>)| {
            let find = |column: &String| {
                let place = ty.declared.iter().position(|(name, _)| name == column)?;
                wanted[place].then(|| ty.declared[place].1)
            };
            columns.iter().map(find).collect()
        };
        let variables = self.model.types.iter().zip(&wanted).map(of_type).collect();
        Record { agents, columns, variables, every, file, span }
    }
}
