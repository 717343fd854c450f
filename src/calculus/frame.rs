//! Scopes: which agents the expressions of one frame read, and what their expressions have become.
//!
//! A scope belongs to one transition, one list of actions, one claim, one flow or one let. Participants come first, the
//! agents of quantifiers and links follow in the order in which they are met. An *environment* says what `self`, the
//! parameters of a function and the bound names are; within one environment an expression has one meaning.

use rustc_hash::FxHashMap;

use crate::base::Span;
use crate::calculus::error::Error;
use crate::calculus::graph::NodeId;
use crate::calculus::system::{Frame, Range, Slot};
use crate::model::ir::{BinderId, ExprId, Model, TypeId};
use crate::model::limits::REACHED_MAX;

/// What an expression has become.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Value {
    /// A number or a boolean.
    Number(NodeId),
    /// An agent.
    Agent(AgentRef),
    /// A boolean argument of a function, to be lowered where it is used.
    Delayed(EnvId, ExprId),
}

/// An agent as an expression names it; a link gets a slot only if something is read through it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum AgentRef {
    /// The agent in a slot.
    Slot(usize),
    /// Where link `link` of the agent in slot `from` leads.
    Link {
        /// Where it starts.
        from: u32,
        /// Its number.
        link: u32,
    },
    /// `none`.
    Absent,
}

impl AgentRef {
    /// Where a link of the agent in a slot leads.
    pub fn link(from: usize, link: usize) -> Self {
        Self::Link { from: from as u32, link: link as u32 }
    }
}

/// Names an [`Env`] of a scope.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct EnvId(u32);

/// What the free names of an expression mean.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct Env {
    /// The slot of `self`.
    pub this: usize,
    /// The arguments of the function.
    pub locals: Vec<Value>,
    /// The slots of bound agents.
    pub bound: Vec<(BinderId, usize)>,
}

/// The inside of an aggregate.
#[derive(Clone, Copy, Debug)]
pub struct Folded {
    /// The environment in which its agent is bound.
    pub inner: EnvId,
    /// Which agents belong to it; none: all.
    pub filter: Option<ExprId>,
    /// What is folded; none for `count`.
    pub term: Option<NodeId>,
}

/// See the head of this file.
#[derive(Debug, Default)]
pub struct Scope {
    /// The agents read.
    pub frame: Frame,
    envs: Vec<Env>,
    env_ids: FxHashMap<Env, EnvId>,
    links: FxHashMap<(usize, usize), usize>,
    /// What has been lowered.
    pub memo: FxHashMap<(EnvId, ExprId), Value>,
    /// Slots of the quantifiers outside any function and let: what actions may name.
    pub witnesses: FxHashMap<BinderId, usize>,
    /// In a flow: the equations of the leaf, by state.
    pub equations: Option<Vec<ExprId>>,
    /// What the agents in slots of quantifiers range over.
    pub bound: FxHashMap<usize, Range>,
    /// For each aggregate what it folds and where.
    pub folded: Vec<Folded>,
    /// Where a node was first met.
    pub spans: FxHashMap<NodeId, Span>,
}

impl Scope {
    /// The environment of text outside functions and lets.
    pub const TOP: EnvId = EnvId(0);

    /// A scope with these participants, the first of which is `self`.
    pub fn new(participants: Vec<(String, TypeId)>) -> Self {
        let mut scope = Self::default();
        let slots = participants.into_iter().map(|(name, ty)| Slot::Root { ty: ty.index(), name });
        scope.frame.slots = slots.collect();
        scope.env(Env::default());
        scope
    }

    /// The frame, when all that reads it has been lowered.
    pub fn into_frame(self) -> Frame {
        let mut origins: Vec<(NodeId, Span)> = self.spans.into_iter().collect();
        origins.sort_unstable();
        Frame { origins: origins.into(), ..self.frame }
    }

    /// The scope of an agent's own text.
    pub fn of_self(ty: TypeId) -> Self {
        Self::new(vec![("self".to_owned(), ty)])
    }

    /// The name of an environment.
    pub fn env(&mut self, env: Env) -> EnvId {
        let next = EnvId(self.envs.len() as u32);
        *self.env_ids.entry(env).or_insert_with_key(|env| {
            self.envs.push(env.clone());
            next
        })
    }

    /// What an environment says.
    pub fn env_of(&self, id: EnvId) -> &Env {
        &self.envs[id.0 as usize]
    }

    /// A slot for an agent that a quantifier binds.
    pub fn bind(&mut self, name: String, ty: TypeId, other: bool, span: Span) -> Result<usize, Error> {
        let slot = self.add(Slot::Root { ty: ty.index(), name }, span)?;
        self.bound.insert(slot, Range { slot, ty: ty.index(), other });
        Ok(slot)
    }

    /// The environment `env` with a name more, bound to a slot.
    pub fn bound_env(&mut self, env: EnvId, binder: BinderId, slot: usize) -> EnvId {
        let mut inner = self.env_of(env).clone();
        inner.bound.push((binder, slot));
        self.env(inner)
    }

    /// The slot of an agent; none for `none`.
    pub fn slot(&mut self, model: &Model, agent: AgentRef, span: Span) -> Result<Option<usize>, Error> {
        let (from, link) = match agent {
            AgentRef::Slot(slot) => return Ok(Some(slot)),
            AgentRef::Absent => return Ok(None),
            AgentRef::Link { from, link } => (from as usize, link as usize),
        };
        if let Some(&slot) = self.links.get(&(from, link)) {
            return Ok(Some(slot));
        }
        let declared = &model.types[TypeId::new(self.frame.slots[from].ty())].links[link];
        let name = match (self.frame.slots[from].name(), from) {
            ("self", 0) => declared.name.clone(),
            (outer, _) => format!("{outer}.{}", declared.name),
        };
        let slot = self.add(Slot::Link { from, link, ty: declared.ty.index(), name }, span)?;
        self.links.insert((from, link), slot);
        Ok(Some(slot))
    }

    /// Adds a slot.
    pub fn add(&mut self, slot: Slot, span: Span) -> Result<usize, Error> {
        if self.frame.slots.len() >= REACHED_MAX {
            return Err(Error::TooManySlots { limit: REACHED_MAX, span });
        }
        self.frame.slots.push(slot);
        Ok(self.frame.slots.len() - 1)
    }
}
