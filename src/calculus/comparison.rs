//! Comparisons of numbers as atoms, over nodes: distances by their squares, jumps taken out.
//!
//! `a <= b` is the atom `a - b <= 0`. A distance against what does not move is compared by its square, whose rates are
//! regular where those of the distance are not. An `if` inside becomes a choice between two comparisons: see `jumps`.

use crate::base::Span;
use crate::calculus::condition::{Cond, DEPTH_MAX, Lowering, PARTS_MAX, Reading, Sense, Written};
use crate::calculus::error::Error;
use crate::calculus::extremes::Slope;
use crate::calculus::graph::{Node, NodeId};
use crate::calculus::jumps;
use crate::calculus::system::{Relation, Slot};
use crate::math::Op;

impl Lowering<'_, '_> {
    /// `a == b` or `a != b` of numbers; the model allows reals only where both are discrete.
    pub fn equality(&mut self, same: bool, a: NodeId, b: NodeId, span: Span) -> Result<Cond, Error> {
        let moving =
            self.reading == Reading::Margin || self.draft.graph.moves(a) || self.draft.graph.moves(b);
        if same && !moving {
            let node = self.draft.graph.binary(Op::Eq, a, b);
            return self.test(node, Sense::Positive, span);
        }
        if !same && !moving && !self.reads_links(a) && !self.reads_links(b) {
            let node = self.draft.graph.binary(Op::Ne, a, b);
            return self.test(node, Sense::Positive, span);
        }
        // Two comparisons, of which an agent that is not there makes neither true.
        let relation = if same { Relation::NonPositive } else { Relation::Negative };
        let (below, above) = (self.less(relation, a, b, span)?, self.less(relation, b, a, span)?);
        Ok(self.join(if same { Op::And } else { Op::Or }, vec![below, above]))
    }

    fn reads_links(&self, id: NodeId) -> bool {
        let is_link = |slot: usize| matches!(self.scope.frame.slots[slot], Slot::Link { .. });
        self.draft
            .graph
            .reach(&[id])
            .into_iter()
            .any(|id| self.draft.graph.node(id).slot().is_some_and(is_link))
    }

    /// `a <= b` or `a < b`.
    pub fn less(&mut self, relation: Relation, a: NodeId, b: NodeId, span: Span) -> Result<Cond, Error> {
        if self.reading == Reading::Margin {
            let difference = self.draft.graph.binary(Op::Sub, a, b);
            let g = jumps::to_be_locked(&mut self.draft.graph, difference);
            return self.atom(relation, g, span);
        }
        let graph = &mut self.draft.graph;
        if !graph.moves(a) && !graph.moves(b) {
            let op = if relation == Relation::NonPositive { Op::Le } else { Op::Lt };
            let node = graph.binary(op, a, b);
            return self.test(node, Sense::Positive, span);
        }
        if let Some(number) = self.extreme(a) {
            return self.by_members(number, Slope::Rising, |this, term| this.less(relation, term, b, span));
        }
        if let Some(number) = self.extreme(b) {
            return self.by_members(number, Slope::Falling, |this, term| this.less(relation, a, term, span));
        }
        let graph = &mut self.draft.graph;
        if let Some((relation, a, b)) = jumps::whole_number(graph, relation, a, b) {
            return self.less(relation, a, b, span);
        }
        if let Some(square) = self.distance_square(a).filter(|_| !self.draft.graph.moves(b)) {
            return self.distance(relation, square, b, Side::Below, span);
        }
        if let Some(square) = self.distance_square(b).filter(|_| !self.draft.graph.moves(a)) {
            return self.distance(relation, square, a, Side::Above, span);
        }
        let graph = &mut self.draft.graph;
        let g = match (graph.is_zero(a), graph.is_zero(b)) {
            (_, true) => a,
            (true, false) => graph.unary(Op::Neg, b),
            (false, false) => graph.binary(Op::Sub, a, b),
        };
        let choices = jumps::as_choices(graph, g);
        if jumps::opens(graph, choices) {
            return self.opened(relation, choices, span);
        }
        let whole = jumps::to_be_locked(graph, g);
        self.whole(relation, whole, span)
    }

    /// The atom of g, or a choice between two comparisons if g has an `if` whose condition moves.
    fn opened(&mut self, relation: Relation, g: NodeId, span: Span) -> Result<Cond, Error> {
        let graph = &mut self.draft.graph;
        if !graph.moves(g) {
            let zero = graph.number(0.0);
            return self.less(relation, g, zero, span);
        }
        let Some(&choice) = jumps::choices(graph, g).last() else {
            return self.whole(relation, g, span);
        };
        let Node::Select(c, u, v) = graph.node(choice) else { unreachable!("a choice is a select") };
        let (then, otherwise) = (jumps::replaced(graph, g, choice, u), jumps::replaced(graph, g, choice, v));
        let (holds, fails) =
            (self.of_node(c, Sense::Positive, span)?, self.of_node(c, Sense::Negative, span)?);
        let (then, otherwise) = (self.opened(relation, then, span)?, self.opened(relation, otherwise, span)?);
        Ok(self.either(holds, fails, then, otherwise))
    }

    /// The atom of g, or the condition of the members of the aggregate in which it is monotone.
    fn whole(&mut self, relation: Relation, g: NodeId, span: Span) -> Result<Cond, Error> {
        match self.monotone_in(g) {
            Some((number, leaf, slope)) => self.by_members(number, slope, |this, term| {
                let graph = &mut this.draft.graph;
                let (g, zero) = (jumps::replaced(graph, g, leaf, term), graph.number(0.0));
                this.less(relation, g, zero, span)
            }),
            None => self.atom(relation, g, span),
        }
    }

    /// The condition that a boolean node stands for.
    fn of_node(&mut self, node: NodeId, sense: Sense, span: Span) -> Result<Cond, Error> {
        self.depth += 1;
        if self.depth > DEPTH_MAX {
            return Err(Error::ConditionTooDeep { limit: DEPTH_MAX, span: self.span });
        }
        let positive = sense == Sense::Positive;
        let condition = match self.draft.graph.node(node) {
            Node::Unary(Op::Not, a) => self.of_node(a, sense.opposite(), span)?,
            Node::Binary(op @ (Op::And | Op::Or), a, b) => {
                let terms = vec![self.of_node(a, sense, span)?, self.of_node(b, sense, span)?];
                self.join(if (op == Op::And) == positive { Op::And } else { Op::Or }, terms)
            }
            Node::Binary(Op::Le, a, b) if positive => self.less(Relation::NonPositive, a, b, span)?,
            Node::Binary(Op::Le, a, b) => self.less(Relation::Negative, b, a, span)?,
            Node::Binary(Op::Lt, a, b) if positive => self.less(Relation::Negative, a, b, span)?,
            Node::Binary(Op::Lt, a, b) => self.less(Relation::NonPositive, b, a, span)?,
            Node::Binary(op @ (Op::Eq | Op::Ne), a, b) => {
                self.equality((op == Op::Eq) == positive, a, b, span)?
            }
            _ => self.test(node, sense, span)?,
        };
        self.depth -= 1;
        Ok(condition)
    }

    /// e for `sqrt(e)`, u^2 + v^2 for `hypot(u, v)`.
    fn distance_square(&mut self, id: NodeId) -> Option<NodeId> {
        match self.draft.graph.node(id) {
            Node::Unary(Op::Sqrt, e) => Some(e),
            Node::Binary(Op::Hypot, u, v) => {
                let squares = [u, v].map(|w| self.square(w));
                Some(self.draft.graph.binary(Op::Add, squares[0], squares[1]))
            }
            _ => None,
        }
    }

    fn square(&mut self, id: NodeId) -> NodeId {
        let two = self.draft.graph.number(2.0);
        self.draft.graph.binary(Op::Powi, id, two)
    }

    /// A distance, given by its square, below or above a `bound` that does not move.
    fn distance(
        &mut self,
        relation: Relation,
        square: NodeId,
        bound: NodeId,
        side: Side,
        span: Span,
    ) -> Result<Cond, Error> {
        let (zero, limit) = (self.draft.graph.number(0.0), self.square(bound));
        let (u, v) = if side == Side::Below { (square, limit) } else { (limit, square) };
        let squares = self.less(relation, u, v, span)?;
        // For a bound of unknown sign: below a negative one is nothing, above it everything.
        let (op, sign_op, test) = match side {
            Side::Below => (Op::And, Op::Le, [zero, bound]),
            Side::Above => (Op::Or, Op::Lt, [bound, zero]),
        };
        let test = self.draft.graph.binary(sign_op, test[0], test[1]);
        let sign = self.test(test, Sense::Positive, span)?;
        Ok(self.join(op, vec![sign, squares]))
    }

    /// A boolean node.
    pub fn test(&mut self, node: NodeId, sense: Sense, span: Span) -> Result<Cond, Error> {
        self.count()?;
        let graph = &mut self.draft.graph;
        if graph.moves(node) {
            // Only a boolean that went through a number: 1 where true.
            let half = graph.number(0.5);
            return match sense {
                Sense::Positive => self.less(Relation::NonPositive, half, node, span),
                Sense::Negative => self.less(Relation::NonPositive, node, half, span),
            };
        }
        let node = if sense == Sense::Positive { node } else { graph.unary(Op::Not, node) };
        Ok(graph.constant(node).map_or(Cond::Discrete(node), |value| Cond::Constant(value != 0.0)))
    }

    pub fn atom(&mut self, relation: Relation, g: NodeId, span: Span) -> Result<Cond, Error> {
        self.count()?;
        Ok(Cond::Atom(relation, g, Written { span, sides: self.sides }))
    }

    fn count(&mut self) -> Result<(), Error> {
        self.parts += 1;
        if self.parts > PARTS_MAX {
            Err(Error::ConditionTooLarge { limit: PARTS_MAX, span: self.span })
        } else {
            Ok(())
        }
    }
}

/// On which side of its bound a distance is to be.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Side {
    Below,
    Above,
}
