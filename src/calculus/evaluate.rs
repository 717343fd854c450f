//! Values of nodes in any arithmetic: a loop over what is needed, operands before users.
//!
//! Code generation has its own, faster way; this one serves tests and bounds that are wanted before there is code.

use rustc_hash::FxHashMap;

use crate::calculus::graph::{Graph, Node, NodeId};
use crate::math::{Interval, Op};

/// The values of `roots` in an arithmetic given by its leaves and its operators.
fn fold<T: Copy>(
    graph: &Graph,
    roots: &[NodeId],
    leaf: &mut dyn FnMut(Node) -> T,
    apply: impl Fn(Op, [T; 3]) -> T,
) -> Vec<T> {
    let mut values: FxHashMap<NodeId, T> = FxHashMap::default();
    for id in graph.reach(roots) {
        let node = graph.node(id);
        let value = match node {
            Node::Unary(op, a) => apply(op, [values[&a]; 3]),
            Node::Binary(op, a, b) => apply(op, [values[&a], values[&b], values[&b]]),
            Node::Select(a, b, c) => apply(Op::Select, [values[&a], values[&b], values[&c]]),
            Node::Constant(_) | Node::Time | Node::State { .. } => leaf(node),
            Node::Rate { .. } | Node::Acceleration { .. } | Node::Aux { .. } => leaf(node),
        };
        values.insert(id, value);
    }
    roots.iter().map(|root| values[root]).collect()
}

/// The values of `roots`; `leaf` gives those of leaves that are not constants.
pub fn values(graph: &Graph, roots: &[NodeId], leaf: &mut dyn FnMut(Node) -> f64) -> Vec<f64> {
    let mut constant_or_leaf = |node| match node {
        Node::Constant(bits) => f64::from_bits(bits),
        _ => leaf(node),
    };
    fold(graph, roots, &mut constant_or_leaf, Op::eval)
}

/// Intervals that contain the values of `roots` for all values of leaves in the intervals that `leaf` gives.
pub fn intervals(graph: &Graph, roots: &[NodeId], leaf: &mut dyn FnMut(Node) -> Interval) -> Vec<Interval> {
    let mut constant_or_leaf = |node| match node {
        Node::Constant(bits) => Interval::point(f64::from_bits(bits)),
        _ => leaf(node),
    };
    fold(graph, roots, &mut constant_or_leaf, |op, operands| Interval::eval(op, &operands[..op.arity()]))
}
