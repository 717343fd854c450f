//! What is never negative by its form alone: a square, a distance, a sum of such. Where it is not a number it is not negative either.

use rustc_hash::FxHashMap;

use crate::calculus::graph::{Graph, Node, NodeId};
use crate::math::Op;

/// Whether a node is never below zero, whatever the states are.
pub fn is_never_negative(graph: &Graph, root: NodeId) -> bool {
    let mut known: FxHashMap<NodeId, bool> = FxHashMap::default();
    for id in graph.reach(&[root]) {
        let is_so = by_operands(graph, id, &|operand| known.get(&operand).copied().unwrap_or(false));
        known.insert(id, is_so);
    }
    known.get(&root).copied().unwrap_or(false)
}

fn by_operands(graph: &Graph, id: NodeId, is_so: &dyn Fn(NodeId) -> bool) -> bool {
    match graph.node(id) {
        Node::Constant(bits) => f64::from_bits(bits) >= 0.0,
        Node::Time => true,
        Node::State { .. } | Node::Rate { .. } | Node::Acceleration { .. } | Node::Aux { .. } => false,
        Node::Select(_, a, b) => is_so(a) && is_so(b),
        Node::Unary(op, a) => unary(op, is_so(a)),
        Node::Binary(op, a, b) => binary(op, (a, b), graph.constant(b), is_so),
    }
}

fn unary(op: Op, of_such: bool) -> bool {
    match op {
        Op::Abs | Op::Sqrt | Op::Exp | Op::Cosh | Op::Acosh | Op::Acos => true,
        Op::Cbrt | Op::Sign | Op::Floor | Op::Ceil | Op::Round | Op::Trunc => of_such,
        Op::Asin | Op::Atan | Op::Sinh | Op::Tanh | Op::Asinh | Op::Atanh => of_such,
        Op::Lt | Op::Le | Op::Eq | Op::Ne | Op::Not | Op::And | Op::Or => true,
        Op::Neg | Op::Add | Op::Sub | Op::Mul | Op::Div | Op::Powi | Op::Pow | Op::Sin | Op::Cos => false,
        Op::Tan | Op::Atan2 | Op::Log | Op::Log2 | Op::Log10 => false,
        Op::Min | Op::Max | Op::Mod | Op::Hypot | Op::Select => false,
    }
}

/// `second` is the second operand, if it is a constant. A zero may have either sign: nothing is divided by one.
fn binary(op: Op, (a, b): (NodeId, NodeId), second: Option<f64>, is_so: &dyn Fn(NodeId) -> bool) -> bool {
    match op {
        Op::Add | Op::Min => is_so(a) && is_so(b),
        Op::Mul => a == b || is_so(a) && is_so(b),
        Op::Max => is_so(a) || is_so(b),
        Op::Div => is_so(a) && second.is_some_and(|b| b > 0.0),
        Op::Powi => second.is_some_and(|n| n % 2.0 == 0.0 || n > 0.0 && is_so(a)),
        Op::Mod => second.is_some_and(|b| b > 0.0),
        Op::Hypot => true,
        Op::Lt | Op::Le | Op::Eq | Op::Ne | Op::Not | Op::And | Op::Or => true,
        Op::Neg | Op::Sub | Op::Pow | Op::Sin | Op::Cos | Op::Tan | Op::Asin | Op::Acos | Op::Atan => false,
        Op::Atan2 | Op::Sinh | Op::Cosh | Op::Tanh | Op::Asinh | Op::Acosh | Op::Atanh | Op::Exp => false,
        Op::Log | Op::Log2 | Op::Log10 | Op::Sqrt | Op::Cbrt | Op::Abs | Op::Sign => false,
        Op::Floor | Op::Ceil | Op::Round | Op::Trunc | Op::Select => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn squares_and_distances_are_never_negative_and_states_may_be() {
        let mut graph = Graph::default();
        let x = graph.intern(Node::State { slot: 0, column: 0 });
        let two = graph.intern(Node::Constant(2.0f64.to_bits()));
        let three = graph.intern(Node::Constant(3.0f64.to_bits()));
        let square = graph.intern(Node::Binary(Op::Powi, x, two));
        let cube = graph.intern(Node::Binary(Op::Powi, x, three));
        let product = graph.intern(Node::Binary(Op::Mul, x, x));
        let distance = graph.intern(Node::Unary(Op::Abs, x));
        let sum = graph.intern(Node::Binary(Op::Add, square, distance));
        let difference = graph.intern(Node::Binary(Op::Sub, square, distance));
        let quotient = graph.intern(Node::Binary(Op::Div, square, distance));
        for (node, expected) in [
            (x, false),
            (square, true),
            (cube, false),
            (product, true),
            (sum, true),
            (difference, false),
            (quotient, false),
        ] {
            assert_eq!(is_never_negative(&graph, node), expected, "{:?}", graph.node(node));
        }
    }
}
