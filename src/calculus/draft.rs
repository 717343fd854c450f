//! A system under construction: what the passes of this floor share.

use std::hash::BuildHasher as _;

use hashbrown::HashTable;
use hashbrown::hash_table::Entry;
use rustc_hash::FxBuildHasher;

use crate::base::{Arena, Diagnostic, Span};
use crate::calculus::error::Error;
use crate::calculus::graph::{Graph, NodeId};
use crate::calculus::system::{
    AgentSystem, Column, EventSystem, Function, FunctionId, Initials, InteractionSystem, Layout, LinkSystem,
    SetSystem, System,
};
use crate::model::ir::{AgentType, Event, Link, Model, Set, Trigger, Type, Variable};

/// See the head of this file.
pub struct Draft<'m> {
    /// What is lowered.
    pub model: &'m Model,
    /// All expressions so far.
    pub graph: Graph,
    /// All functions so far.
    pub functions: Arena<Function>,
    /// By their outputs.
    known: HashTable<FunctionId>,
    /// The agent types; columns first, then the rest.
    pub types: Vec<AgentSystem>,
    /// What was wrong.
    pub diagnostics: Vec<Diagnostic>,
}

impl<'m> Draft<'m> {
    /// The columns of all types, and nothing else yet.
    pub fn new(model: &'m Model) -> Self {
        let types = model.types.iter().map(|ty| columns(model, ty)).collect();
        let (graph, functions) = (Graph::default(), Arena::new());
        Self { model, graph, functions, known: HashTable::new(), types, diagnostics: Vec::new() }
    }

    /// The function with these outputs; the first name it was given stays.
    pub fn function(&mut self, name: impl FnOnce() -> String, outputs: Vec<NodeId>) -> FunctionId {
        let Self { functions, known, graph, .. } = self;
        let hash = |outputs: &[NodeId]| FxBuildHasher.hash_one(outputs);
        let is_same = |&id: &FunctionId| functions[id].outputs == outputs;
        match known.entry(hash(&outputs), is_same, |&id| hash(&functions[id].outputs)) {
            Entry::Occupied(known) => *known.get(),
            Entry::Vacant(place) => {
                // Its tape will be as long.
                graph.reach(&outputs);
                let id = functions.push(Function { name: name(), outputs });
                place.insert(id);
                id
            }
        }
    }

    /// Whether the equations take more work than the limit.
    pub fn is_exhausted(&self) -> bool {
        self.graph.work() > self.model.limits.operations_max
    }

    /// Refuses equations that take more work than the limit; `span` is where that shows.
    pub fn check_work(&self, span: Span) -> Result<(), Error> {
        let limit = self.model.limits.operations_max;
        if self.is_exhausted() { Err(Error::TooMuchWork { limit, span }) } else { Ok(()) }
    }

    /// Notes a failure and goes on with what comes next.
    pub fn keep<T>(&mut self, result: Result<T, Error>) -> Option<T> {
        result
            .map_err(|error| {
                let is_limit = error.is_limit();
                let diagnostic = error.diagnostic();
                let said =
                    |other: &Diagnostic| *other == diagnostic || (is_limit && other.code == diagnostic.code);
                if !self.diagnostics.iter().any(said) {
                    self.diagnostics.push(diagnostic);
                }
            })
            .ok()
    }

    /// The system, if nothing was wrong.
    pub fn finish(self, interactions: Vec<InteractionSystem>) -> Result<System, Vec<Diagnostic>> {
        if !self.diagnostics.is_empty() {
            return Err(self.diagnostics);
        }
        Ok(System {
            graph: self.graph,
            functions: self.functions,
            types: self.types,
            interactions,
            population: self.model.population.clone(),
            run: self.model.run.clone(),
            watch: self.model.watch.clone(),
        })
    }

    /// The stream of an agent's random numbers that has this name, which is made if there is none yet.
    pub fn stream(&mut self, ty: usize, name: &str) -> usize {
        let streams = &mut self.types[ty].streams;
        streams.iter().position(|known| known == name).unwrap_or_else(|| {
            streams.push(name.to_owned());
            streams.len() - 1
        })
    }

    /// The columns of an agent type.
    pub fn layout(&self, ty: usize) -> &Layout {
        &self.types[ty].layout
    }
}

/// How many values the event with the most carries of those that a type hears.
fn n_received(model: &Model, ty: &AgentType) -> usize {
    let heard = ty.transitions.iter().flat_map(|transition| match &transition.trigger {
        Trigger::On { events, .. } => events.as_slice(),
        Trigger::When(_) | Trigger::After(..) | Trigger::Every(..) | Trigger::Rate { .. } => &[],
    });
    heard.map(|&(ty, event)| model.types[ty].events[event].params.len()).max().unwrap_or(0)
}

fn link(link: &Link) -> LinkSystem {
    LinkSystem { name: link.name.clone(), required: link.required, updates: Vec::new() }
}

fn set(model: &Model, set: &Set) -> SetSystem {
    let memberships = &model.types[set.ty].memberships;
    let belongs = memberships.iter().find(|(block, _)| Some(*block) == set.block).map(|&(_, param)| param);
    SetSystem { ty: set.ty.index(), belongs, count: set.count, links: set.links() }
}

fn columns(model: &Model, ty: &AgentType) -> AgentSystem {
    let column = |v: &Variable| Column { name: v.name.clone(), scale: v.scale, boolean: v.ty == Type::Bool };
    AgentSystem {
        name: ty.name.clone(),
        layout: Layout {
            n_states: ty.states.len() + ty.rates().count(),
            n_hazards: ty.rates().count(),
            n_params: ty.params.len(),
            n_discretes: ty.discretes.len(),
            n_links: ty.links.len(),
            n_received: n_received(model, ty),
            n_histories: 0,
            n_locks: 0,
        },
        states: ty.states.iter().map(column).collect(),
        params: ty.params.iter().map(column).collect(),
        discretes: ty.discretes.iter().map(column).collect(),
        links: ty.links.iter().map(link).collect(),
        sets: ty.sets.iter().map(|found| set(model, found)).collect(),
        hazards: ty.rates().map(|transition| transition.label.clone()).collect(),
        events: ty.events.iter().map(event).collect(),
        streams: Vec::new(),
        lets: Vec::new(),
        declared: ty.declared.clone(),
        initials: Initials::default(),
        modes: Vec::new(),
        regions: Vec::new(),
        transitions: Vec::new(),
    }
}

fn event(event: &Event) -> EventSystem {
    let params = event.params.iter().map(|param| param.name.clone()).collect();
    EventSystem { name: event.name.clone(), params }
}
