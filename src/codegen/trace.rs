//! What a function computes on its way, for messages: the values of its expressions, and which of them made a number that
//! is not finite.
//!
//! Slow and rarely used: the graph is walked, operator by operator, with the meaning that kernels have too.

use rustc_hash::FxHashMap;

use crate::base::{Span, number_text};
use crate::calculus::graph::{Node, NodeId};
use crate::calculus::print::{Names, short, short_side};
use crate::calculus::system::{Atom, Frame, FunctionId, Sides};
use crate::codegen::kernel::AgentView;
use crate::codegen::program::Program;
use crate::math::Op;

/// An expression and its value.
#[derive(Clone, Debug, PartialEq)]
pub struct Valued {
    /// In the words of the source, shortened.
    pub text: String,
    /// Its value.
    pub value: f64,
}

/// The expression that made a number that is not finite, out of operands that were, or could still be, right.
#[derive(Clone, Debug, PartialEq)]
pub struct Blame {
    /// Where it stands; none if it is no text of its own.
    pub span: Option<Span>,
    /// The expression.
    pub made: Valued,
    /// What it was made of; without literals.
    pub operands: Vec<Valued>,
}

/// A comparison with its numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Compared {
    /// Where it stands.
    pub span: Span,
    /// In the words of the source, shortened.
    pub text: String,
    /// The agents that quantifiers bind around it: `o = cars[3]`; empty for none.
    pub bound: String,
    /// The value on the left, SI; for `crossing(e)` that of e.
    pub left: f64,
    /// The value on the right, SI; for `crossing(e)` zero.
    pub right: f64,
    /// How far it is from its boundary: positive where it holds. NaN for `crossing(e)`, and where a side is.
    pub margin: f64,
}

/// Where a function is evaluated: the rows of the agents in its slots, and the time.
#[derive(Clone, Copy)]
pub struct Point<'a> {
    /// The agents.
    pub frame: &'a Frame,
    /// Their rows; an absent agent's are full of NaN.
    pub slots: &'a [AgentView<'a>],
    /// s.
    pub time: f64,
}

impl Compared {
    /// ``x <= 3`: 5 on the left, 3 on the right`, in SI.
    pub fn numbers(&self) -> String {
        let [left, right] = [self.left, self.right].map(number_text);
        let bound = if self.bound.is_empty() { String::new() } else { format!(" for {}", self.bound) };
        format!("`{}`{bound}: {left} on the left, {right} on the right", self.text)
    }
}

impl Program {
    /// What makes output `k` of a function not finite; none if it is finite.
    pub fn blame(&self, function: FunctionId, k: usize, point: &Point<'_>) -> Option<Blame> {
        let root = self.functions[function].outputs[k];
        let values = self.values(&[root], point);
        let (mut at, mut span) = (root, point.frame.origin(root));
        if values[&at].is_finite() {
            return None;
        }
        while let Some(operand) = self.spoilt(at, &values) {
            at = operand;
            span = point.frame.origin(at).or(span);
        }
        let node = self.graph.node(at);
        let literal = |id: &NodeId| matches!(self.graph.node(*id), Node::Constant(_));
        let operands = node.operands().filter(|id| !literal(id));
        Some(Blame {
            span,
            made: self.valued(at, &values, point),
            operands: operands.map(|id| self.valued(id, &values, point)).collect(),
        })
    }

    /// The numbers of a comparison.
    pub fn compared(&self, atom: &Atom, point: &Point<'_>) -> Compared {
        let g = self.functions[atom.value].outputs[0];
        let Some(Sides { left, sign, right }) = atom.sides else {
            let left = self.values(&[g], point)[&g];
            let (text, bound) = (atom.text.clone(), String::new());
            return Compared { span: atom.span, text, bound, left, right: 0.0, margin: f64::NAN };
        };
        let values = self.values(&[left, right], point);
        let text = |id| short_side(&self.graph, self.names(point), id);
        let difference = values[&left] - values[&right];
        let margin = match sign {
            "<=" | "<" => -difference,
            ">=" | ">" => difference,
            "==" => -difference.abs(),
            _ => difference.abs(),
        };
        Compared {
            span: atom.span,
            text: format!("{} {sign} {}", text(left), text(right)),
            bound: String::new(),
            left: values[&left],
            right: values[&right],
            margin,
        }
    }

    /// The operand from which a node has its bad number; none if it made it.
    fn spoilt(&self, id: NodeId, values: &FxHashMap<NodeId, f64>) -> Option<NodeId> {
        let is_like = |operand: &NodeId| {
            if values[&id].is_nan() { values[operand].is_nan() } else { values[operand].is_infinite() }
        };
        match self.graph.node(id) {
            Node::Select(condition, then, otherwise) => {
                let taken = if values[&condition] != 0.0 { then } else { otherwise };
                Some(taken).filter(is_like)
            }
            node => node.operands().find(is_like),
        }
    }

    fn valued(&self, id: NodeId, values: &FxHashMap<NodeId, f64>, point: &Point<'_>) -> Valued {
        Valued { text: short(&self.graph, self.names(point), id), value: values[&id] }
    }

    fn names<'a>(&'a self, point: &Point<'a>) -> Names<'a> {
        Names { types: &self.types, frame: point.frame }
    }

    /// The values of all nodes that some are computed from.
    fn values(&self, roots: &[NodeId], point: &Point<'_>) -> FxHashMap<NodeId, f64> {
        let mut values: FxHashMap<NodeId, f64> = FxHashMap::default();
        let read = |row: &[f64], column: u32| row.get(column as usize).copied().unwrap_or(f64::NAN);
        for id in self.graph.reach(roots) {
            let value = match self.graph.node(id) {
                Node::Constant(bits) => f64::from_bits(bits),
                Node::Time => point.time,
                Node::State { slot, column } => read(point.slots[slot as usize].states, column),
                Node::Rate { slot, column } => read(point.slots[slot as usize].rates, column),
                Node::Acceleration { slot, column } => read(point.slots[slot as usize].accelerations, column),
                Node::Aux { slot, column } => read(point.slots[slot as usize].aux, column),
                Node::Unary(op, a) => op.eval([values[&a]; 3]),
                Node::Binary(op, a, b) => op.eval([values[&a], values[&b], values[&b]]),
                Node::Select(a, b, c) => Op::Select.eval([values[&a], values[&b], values[&c]]),
            };
            values.insert(id, value);
        }
        values
    }
}
