//! Jumps inside a comparison: the surfaces at which its g jumps, taken out so that they become comparisons of their own.
//!
//! `sign e` is `if 0 < e then 1 else if e < 0 then -1 else 0`. The angle of (x, y) is smooth on each side of its cut, as
//! `atan2(y, x) = if 0 <= y then pi/2 - atan2(x, y) else atan2(x, -y) - pi/2`. An `if` whose condition moves is then a
//! choice between two comparisons. Where something else jumps as well (`mod`, a `floor` within a sum) the comparison stays whole,
//! and its branches are read from locks: see `locks`.

use rustc_hash::{FxHashMap, FxHashSet};

use crate::calculus::graph::{Graph, Node, NodeId};
use crate::calculus::system::Relation;
use crate::math::Op;

/// How many `if`s one comparison is opened at; each may double it.
pub const CHOICES_MAX: usize = 6;

/// The same value with `sign` and `atan2` of what moves as `if`s.
pub fn as_choices(graph: &mut Graph, g: NodeId) -> NodeId {
    rebuild(graph, g, |graph, node, id| match node {
        Node::Unary(Op::Sign, e) if graph.moves(id) => Some(sign(graph, e)),
        Node::Binary(Op::Atan2, y, x) if graph.moves(id) => {
            let zero = graph.number(0.0);
            let upper = graph.binary(Op::Le, zero, y);
            Some(angle(graph, upper, y, x))
        }
        _ => None,
    })
}

/// Whether nothing jumps in what is left of g when it is opened at its `if`s, and these are few enough.
pub fn opens(graph: &Graph, g: NodeId) -> bool {
    let (mut pending, mut seen) = (vec![g], FxHashSet::default());
    while let Some(id) = pending.pop() {
        if !seen.insert(id) {
            continue;
        }
        match graph.node(id) {
            Node::Select(c, a, b) if graph.moves(c) => pending.extend([a, b]),
            _ if can_jump(graph, id) => return false,
            Node::Unary(_, a) => pending.push(a),
            Node::Binary(_, a, b) => pending.extend([a, b]),
            Node::Select(c, a, b) => pending.extend([c, a, b]),
            Node::Constant(_) | Node::Time | Node::State { .. } | Node::Rate { .. } => {}
            Node::Acceleration { .. } | Node::Aux { .. } => {}
        }
    }
    let is_choice = |&id: &NodeId| matches!(graph.node(id), Node::Select(c, ..) if graph.moves(c));
    graph.reach(&[g]).iter().filter(|id| is_choice(id)).count() <= CHOICES_MAX
}

/// g in the form in which its branches are read from locks: as it is, or with the jumps of atan2 as `if`s if it has no others.
pub fn to_be_locked(graph: &mut Graph, g: NodeId) -> NodeId {
    let reach = graph.reach(&[g]);
    if reach.into_iter().any(|id| can_jump(graph, id)) { g } else { as_choices(graph, g) }
}

/// The `if`s below g whose condition moves, innermost first; none if there are too many.
pub fn choices(graph: &Graph, g: NodeId) -> Vec<NodeId> {
    let is_choice = |&id: &NodeId| matches!(graph.node(id), Node::Select(c, ..) if graph.moves(c));
    let mut found = graph.reach(&[g]);
    found.retain(is_choice);
    if found.len() > CHOICES_MAX { Vec::new() } else { found }
}

/// g with `from` replaced by `to`.
pub fn replaced(graph: &mut Graph, g: NodeId, from: NodeId, to: NodeId) -> NodeId {
    let mut known = FxHashMap::default();
    for id in graph.reach(&[g]) {
        let new = if id == from { to } else { again(graph, id, &known) };
        known.insert(id, new);
    }
    known[&g]
}

/// g with every node changed by `change`, which sees a node after its operands are changed.
fn rebuild(
    graph: &mut Graph,
    g: NodeId,
    change: impl Fn(&mut Graph, Node, NodeId) -> Option<NodeId>,
) -> NodeId {
    let mut known = FxHashMap::default();
    for id in graph.reach(&[g]) {
        let same = again(graph, id, &known);
        let node = graph.node(same);
        let new = change(graph, node, same).unwrap_or(same);
        known.insert(id, new);
    }
    known[&g]
}

/// A node over new operands.
fn again(graph: &mut Graph, id: NodeId, known: &FxHashMap<NodeId, NodeId>) -> NodeId {
    match graph.node(id) {
        Node::Unary(op, a) => graph.unary(op, known[&a]),
        Node::Binary(op, a, b) => graph.binary(op, known[&a], known[&b]),
        Node::Select(c, a, b) => graph.select(known[&c], known[&a], known[&b]),
        Node::Constant(_) | Node::Time | Node::State { .. } | Node::Rate { .. } => id,
        Node::Acceleration { .. } | Node::Aux { .. } => id,
    }
}

fn sign(graph: &mut Graph, e: NodeId) -> NodeId {
    let [zero, one, minus] = [0.0, 1.0, -1.0].map(|x| graph.number(x));
    let (above, below) = (graph.binary(Op::Lt, zero, e), graph.binary(Op::Lt, e, zero));
    let otherwise = graph.select(below, minus, zero);
    graph.select(above, one, otherwise)
}

/// atan2(y, x), which is regular on each side of its cut: `upper` says on which it is.
pub fn angle(graph: &mut Graph, upper: NodeId, y: NodeId, x: NodeId) -> NodeId {
    let quarter = graph.number(std::f64::consts::FRAC_PI_2);
    let from_axis = graph.binary(Op::Atan2, x, y);
    let above = graph.binary(Op::Sub, quarter, from_axis);
    let down = graph.unary(Op::Neg, y);
    let from_axis = graph.binary(Op::Atan2, x, down);
    let below = graph.binary(Op::Sub, from_axis, quarter);
    graph.select(upper, above, below)
}

/// `floor(e)` or `ceil(e)` against a bound that does not move, without the operator: exactly the same truth.
///
/// Gives `a <= b` (non-positive) or `a < b` (negative) in the same form as it takes it: `floor(e) <= c` is `e < floor(c) + 1`, and so on.
pub fn whole_number(
    graph: &mut Graph,
    relation: Relation,
    a: NodeId,
    b: NodeId,
) -> Option<(Relation, NodeId, NodeId)> {
    let one = graph.number(1.0);
    match (graph.node(a), graph.node(b), relation) {
        (Node::Unary(Op::Floor, e), _, Relation::NonPositive) if !graph.moves(b) => {
            let below = graph.unary(Op::Floor, b);
            Some((Relation::Negative, e, graph.binary(Op::Add, below, one)))
        }
        (Node::Unary(Op::Floor, e), _, Relation::Negative) if !graph.moves(b) => {
            Some((Relation::Negative, e, graph.unary(Op::Ceil, b)))
        }
        (Node::Unary(Op::Ceil, e), _, Relation::NonPositive) if !graph.moves(b) => {
            Some((Relation::NonPositive, e, graph.unary(Op::Floor, b)))
        }
        (Node::Unary(Op::Ceil, e), _, Relation::Negative) if !graph.moves(b) => {
            let above = graph.unary(Op::Ceil, b);
            Some((Relation::NonPositive, e, graph.binary(Op::Sub, above, one)))
        }
        (_, Node::Unary(Op::Floor, e), Relation::NonPositive) if !graph.moves(a) => {
            Some((Relation::NonPositive, graph.unary(Op::Ceil, a), e))
        }
        (_, Node::Unary(Op::Floor, e), Relation::Negative) if !graph.moves(a) => {
            let below = graph.unary(Op::Floor, a);
            Some((Relation::NonPositive, graph.binary(Op::Add, below, one), e))
        }
        (_, Node::Unary(Op::Ceil, e), Relation::NonPositive) if !graph.moves(a) => {
            let above = graph.unary(Op::Ceil, a);
            Some((Relation::Negative, graph.binary(Op::Sub, above, one), e))
        }
        (_, Node::Unary(Op::Ceil, e), Relation::Negative) if !graph.moves(a) => {
            Some((Relation::Negative, graph.unary(Op::Floor, a), e))
        }
        _ => None,
    }
}

/// Whether the value of a node can jump while its operands move continuously.
pub fn can_jump(graph: &Graph, id: NodeId) -> bool {
    let node = graph.node(id);
    let moving = |id| graph.moves(id);
    match node {
        Node::Select(condition, ..) => moving(condition),
        Node::Unary(op, a) | Node::Binary(op, a, _) => match op {
            Op::Sign | Op::Floor | Op::Ceil | Op::Round | Op::Trunc | Op::Not => moving(a),
            Op::Mod | Op::Lt | Op::Le | Op::Eq | Op::Ne | Op::And | Op::Or => moving(id),
            Op::Neg | Op::Add | Op::Sub | Op::Mul | Op::Div | Op::Powi | Op::Pow | Op::Sin | Op::Cos => false,
            Op::Tan | Op::Asin | Op::Acos | Op::Atan | Op::Sinh | Op::Cosh | Op::Tanh | Op::Asinh => false,
            Op::Acosh | Op::Atanh | Op::Exp | Op::Log | Op::Log2 | Op::Log10 | Op::Sqrt | Op::Cbrt => false,
            // The cut of atan2 has been taken out by an `if`, or by a lock.
            Op::Atan2 | Op::Abs | Op::Min | Op::Max | Op::Hypot | Op::Select => false,
        },
        Node::Constant(_) | Node::Time | Node::State { .. } | Node::Rate { .. } => false,
        Node::Acceleration { .. } | Node::Aux { .. } => false,
    }
}
