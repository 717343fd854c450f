//! What is known of the agents of a block before they are made.

use super::ir::{ExprId, Given, ModeId, TypeId, VarRef};
use crate::base::Span;
use crate::syntax::ast;

/// Where the value of a variable comes from.
#[derive(Clone, Copy, Debug)]
pub(super) enum Source {
    /// An argument in `system`.
    Argument(Given),
    /// A column of the data, by its place among those that are read.
    Column(usize),
    /// What the agent type says.
    Declared(Given),
    /// Reported as missing or wrong.
    Missing,
}

/// How the agents of one block are made.
pub(super) struct Plan<'a> {
    /// Its number, and its line in `system`.
    pub item: &'a ast::Instance,
    /// The type of its agents.
    pub ty: TypeId,
    /// The leaf mode in which they start.
    pub mode: ModeId,
    /// By number of the parameter.
    pub params: Vec<Source>,
    /// By number of the state.
    pub states: Vec<Source>,
    /// By number of the discrete variable.
    pub discretes: Vec<Source>,
    /// By number of the link; none: it leads nowhere.
    pub links: Vec<Option<Reference>>,
    /// The columns that are read, row by row.
    pub columns: Vec<Vec<f64>>,
    /// What unknown arguments and columns were perhaps meant to be; these are not missing.
    pub misspelt: Vec<String>,
}

impl Plan<'_> {
    /// The parameters and discrete variables that are columns of the data.
    pub fn given_by_data(&self) -> impl Iterator<Item = (TypeId, VarRef)> {
        let is_column = |source: &Source| matches!(source, Source::Column(_));
        let given = move |(k, source): (usize, &Source)| is_column(source).then_some(k);
        let params = self.params.iter().enumerate().filter_map(given).map(VarRef::Param);
        let discretes = self.discretes.iter().enumerate().filter_map(given).map(VarRef::Discrete);
        params.chain(discretes).map(|variable| (self.ty, variable))
    }
}

/// An agent of `system`, depending on `index`.
#[derive(Debug)]
pub(super) enum Reference {
    /// `none`
    Nobody(Span),
    /// `cars[k]` of a block, or a single agent.
    Agent {
        /// The number of the block.
        block: usize,
        /// The number in the array.
        index: Option<ExprId>,
        /// Where it stands.
        span: Span,
    },
    /// `if condition then a else b`
    If(ExprId, Box<Reference>, Box<Reference>),
}

impl Reference {
    /// Where it stands; for a choice, its first alternative.
    pub fn span(&self) -> Span {
        let mut reference = self;
        loop {
            match reference {
                Reference::Nobody(span) | Reference::Agent { span, .. } => return *span,
                Reference::If(_, then, _) => reference = then,
            }
        }
    }
}
