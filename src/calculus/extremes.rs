//! Comparisons of `min` and `max` over agents, member by member.
//!
//! A comparison that is monotone in a `min` needs no minimum: `min o in S where f: e <= b` is `exists o in S: f and e <= b`,
//! `min o in S where f: e >= b` is `forall o in S: not f or e >= b`; and a `max` the other way round. Each comparison of a
//! member is then an atom by itself, and who is the least need not be known.

use crate::calculus::condition::{Cond, Lowering, Sense};
use crate::calculus::error::Error;
use crate::calculus::frame::Folded;
use crate::calculus::graph::{Node, NodeId};
use crate::calculus::system::{Aggregate, Slot};
use crate::math::Op;
use crate::model::ir::Quantifier;

/// Whether a comparison grows with an aggregate or falls.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Slope {
    /// It grows.
    Rising,
    /// It falls.
    Falling,
}

impl Lowering<'_, '_> {
    /// The number of the `min` or `max` that a node is; none if it is something else.
    pub fn extreme(&self, id: NodeId) -> Option<usize> {
        let Node::State { slot, .. } = self.draft.graph.node(id) else { return None };
        match self.scope.frame.slots[slot as usize] {
            Slot::Fold { number, .. } => {
                let kind = self.scope.frame.folds[number].kind;
                matches!(kind, Aggregate::Min | Aggregate::Max).then_some(number)
            }
            Slot::Root { .. } | Slot::Link { .. } => None,
        }
    }

    /// The condition that holds for one member or for all: what `member` makes of the term of a `min` or `max`, of which
    /// the comparison with zero from below has this slope.
    pub fn by_members(
        &mut self,
        number: usize,
        slope: Slope,
        member: impl FnOnce(&mut Self, NodeId) -> Result<Cond, Error>,
    ) -> Result<Cond, Error> {
        let Folded { inner, filter, term } = self.scope.folded[number];
        let fold = &self.scope.frame.folds[number];
        let (kind, range) = (fold.kind, fold.range);
        let one = (kind == Aggregate::Min) == (slope == Slope::Rising);
        let (quantifier, sense) =
            if one { (Quantifier::Exists, Sense::Positive) } else { (Quantifier::Forall, Sense::Negative) };
        let term = term.expect("only `count` has no term");
        let mut terms = Vec::new();
        if let Some(filter) = filter {
            terms.push(self.lower(inner, filter, sense)?);
        }
        terms.push(member(self, term)?);
        Ok(self.over(quantifier, range, terms))
    }

    /// The `min` or `max` in which g is monotone, its leaf, and the slope; none if there is none, or g is more complicated
    /// than a sum of it with what does not read it.
    pub fn monotone_in(&self, g: NodeId) -> Option<(usize, NodeId, Slope)> {
        let graph = &self.draft.graph;
        let is_extreme = |&id: &NodeId| self.extreme(id).is_some();
        let leaf = graph.reach(&[g]).into_iter().find(is_extreme)?;
        let reads_leaf = |id: NodeId| graph.reach(&[id]).contains(&leaf);
        let (mut id, mut rising) = (g, true);
        while id != leaf {
            (id, rising) = match graph.node(id) {
                Node::Unary(Op::Neg, a) => (a, !rising),
                Node::Binary(Op::Add, a, b) if !reads_leaf(b) => (a, rising),
                Node::Binary(Op::Add, a, b) if !reads_leaf(a) => (b, rising),
                Node::Binary(Op::Sub, a, b) if !reads_leaf(b) => (a, rising),
                Node::Binary(Op::Sub, a, b) if !reads_leaf(a) => (b, !rising),
                _ => return None,
            };
        }
        Some((self.extreme(leaf)?, leaf, if rising { Slope::Rising } else { Slope::Falling }))
    }
}
