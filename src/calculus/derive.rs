//! Derivatives: along the flow (forward) and towards all leaves (reverse), from one table of partial derivatives.
//!
//! The rate of u along given x', x'' is `u' = sum of du/dx x' + du/dt`; a second application gives u'', with x''' unknown
//! (NaN). Jacobians come from the reverse mode, a row at a time. At kinks: `abs' = sign`, `min` and `max` take the
//! branch that they take, what is constant by pieces has the derivative 0. The arithmetic is formal: `0 u = 0`, and a
//! factor moves into `if c then u else 0`, so that what the other branch of an `if` cannot compute is never multiplied.

use rustc_hash::FxHashMap;

use crate::calculus::graph::{Graph, Node, NodeId};
use crate::math::Op;

/// g' and g'' of `g` along the flow.
pub fn rates(graph: &mut Graph, g: NodeId) -> [NodeId; 2] {
    let first = along_flow(graph, g);
    let needs_third =
        graph.reach(&[first]).iter().any(|&id| matches!(graph.node(id), Node::Acceleration { .. }));
    let reads_rates = graph.reach(&[g]).iter().any(|&id| matches!(graph.node(id), Node::Rate { .. }));
    let second = if needs_third || reads_rates { graph.number(f64::NAN) } else { along_flow(graph, first) };
    [first, second]
}

/// The rate of `u` along the flow: states move by their rates, rates by their accelerations, time by 1.
pub fn along_flow(graph: &mut Graph, u: NodeId) -> NodeId {
    let mut rate: FxHashMap<NodeId, NodeId> = FxHashMap::default();
    for id in graph.reach(&[u]).into_iter().filter(|&id| graph.moves(id)).collect::<Vec<_>>() {
        let node = graph.node(id);
        let value = match node {
            Node::Time => graph.number(1.0),
            Node::State { slot, column } => graph.intern(Node::Rate { slot, column }),
            Node::Rate { slot, column } => graph.intern(Node::Acceleration { slot, column }),
            Node::Acceleration { .. } => graph.number(f64::NAN),
            Node::Constant(_) | Node::Aux { .. } => unreachable!("these do not move"),
            Node::Unary(..) | Node::Binary(..) | Node::Select(..) => {
                let mut total = graph.number(0.0);
                for (operand, partial) in partials(graph, id) {
                    let inner = rate[&operand];
                    let term = times(graph, partial, inner);
                    total = plus(graph, total, term);
                }
                total
            }
        };
        rate.insert(id, value);
    }
    rate.get(&u).copied().unwrap_or_else(|| graph.number(0.0))
}

/// The derivatives of `u` by every leaf that moves and that it depends on, leaves in the order of slot and column.
pub fn gradient(graph: &mut Graph, u: NodeId) -> Vec<(Node, NodeId)> {
    let mut adjoints: FxHashMap<NodeId, NodeId> = FxHashMap::default();
    let mut leaves = Vec::new();
    adjoints.insert(u, graph.number(1.0));
    for id in graph.reach(&[u]).into_iter().rev() {
        let Some(&adjoint) = adjoints.get(&id) else { continue };
        let node = graph.node(id);
        if node.op().is_none() {
            if graph.moves(id) && !graph.is_zero(adjoint) {
                leaves.push((node, adjoint));
            }
            continue;
        }
        for (operand, partial) in partials(graph, id) {
            let term = times(graph, adjoint, partial);
            let before = adjoints.get(&operand).copied().unwrap_or_else(|| graph.number(0.0));
            let sum = plus(graph, before, term);
            adjoints.insert(operand, sum);
        }
    }
    leaves.sort_by_key(|(leaf, _)| match *leaf {
        Node::State { slot, column } => (0, slot, column),
        Node::Rate { slot, column } => (1, slot, column),
        Node::Acceleration { slot, column } => (2, slot, column),
        Node::Time | Node::Constant(_) | Node::Aux { .. } => (3, 0, 0),
        Node::Unary(..) | Node::Binary(..) | Node::Select(..) => unreachable!("no leaf"),
    });
    leaves
}

/// The operands of a node that move, each with the derivative of the node by it.
fn partials(graph: &mut Graph, id: NodeId) -> Vec<(NodeId, NodeId)> {
    let all = match graph.node(id) {
        Node::Unary(op, a) => vec![(a, unary_partial(graph, op, a, id))],
        Node::Binary(op, a, b) => {
            let mut all = Vec::new();
            // One by one: the derivative by an operand that does not move may not exist.
            if graph.moves(a) {
                all.push((a, binary_partial(graph, op, [a, b], id, Side::Left)));
            }
            if graph.moves(b) {
                all.push((b, binary_partial(graph, op, [a, b], id, Side::Right)));
            }
            all
        }
        Node::Select(c, a, b) => {
            let (one, zero) = (graph.number(1.0), graph.number(0.0));
            vec![(a, graph.intern(Node::Select(c, one, zero))), (b, graph.intern(Node::Select(c, zero, one)))]
        }
        Node::Constant(_) | Node::Time | Node::State { .. } => Vec::new(),
        Node::Rate { .. } | Node::Acceleration { .. } | Node::Aux { .. } => Vec::new(),
    };
    all.into_iter().filter(|&(operand, partial)| graph.moves(operand) && !graph.is_zero(partial)).collect()
}

/// By which operand of two.
#[derive(Clone, Copy, PartialEq)]
enum Side {
    Left,
    Right,
}

/// dy/da for y = op(a).
fn unary_partial(graph: &mut Graph, op: Op, a: NodeId, y: NodeId) -> NodeId {
    let one = graph.number(1.0);
    match op {
        Op::Neg => graph.number(-1.0),
        Op::Sin => graph.unary(Op::Cos, a),
        Op::Cos => {
            let sine = graph.unary(Op::Sin, a);
            negative(graph, sine)
        }
        Op::Tan => {
            let square = square(graph, y);
            plus(graph, one, square)
        }
        Op::Asin => inverse_root(graph, [one, a], [one, a]),
        Op::Acos => {
            let positive = inverse_root(graph, [one, a], [one, a]);
            negative(graph, positive)
        }
        Op::Atan => {
            let square = square(graph, a);
            let below = plus(graph, one, square);
            over(graph, one, below)
        }
        Op::Sinh => graph.unary(Op::Cosh, a),
        Op::Cosh => graph.unary(Op::Sinh, a),
        Op::Tanh => {
            let square = square(graph, y);
            minus(graph, one, square)
        }
        Op::Asinh => {
            let square = square(graph, a);
            let inside = plus(graph, square, one);
            let below = graph.unary(Op::Sqrt, inside);
            over(graph, one, below)
        }
        Op::Acosh => inverse_root(graph, [a, one], [a, one]),
        Op::Atanh => {
            let (low, high) = (minus(graph, one, a), plus(graph, one, a));
            let below = times(graph, low, high);
            over(graph, one, below)
        }
        Op::Exp => y,
        Op::Log => over(graph, one, a),
        Op::Log2 => scaled_inverse(graph, std::f64::consts::LN_2, a),
        Op::Log10 => scaled_inverse(graph, std::f64::consts::LN_10, a),
        Op::Sqrt => scaled_inverse(graph, 2.0, y),
        Op::Cbrt => {
            let square = square(graph, y);
            scaled_inverse(graph, 3.0, square)
        }
        Op::Abs => graph.unary(Op::Sign, a),
        Op::Sign | Op::Floor | Op::Ceil | Op::Round | Op::Trunc | Op::Not => graph.number(0.0),
        Op::Add | Op::Sub | Op::Mul | Op::Div | Op::Powi | Op::Pow | Op::Atan2 | Op::Min | Op::Max => {
            unreachable!("{} has two operands", op.name())
        }
        Op::Mod | Op::Hypot | Op::Lt | Op::Le | Op::Eq | Op::Ne | Op::And | Op::Or | Op::Select => {
            unreachable!("{} has more than one operand", op.name())
        }
    }
}

/// dy/da (left) or dy/db (right) for y = op(a, b).
fn binary_partial(graph: &mut Graph, op: Op, [a, b]: [NodeId; 2], y: NodeId, side: Side) -> NodeId {
    let (zero, one) = (graph.number(0.0), graph.number(1.0));
    match (op, side) {
        (Op::Add, _) | (Op::Sub, Side::Left) | (Op::Mod, Side::Left) => one,
        (Op::Sub, Side::Right) => graph.number(-1.0),
        (Op::Mul, Side::Left) => b,
        (Op::Mul, Side::Right) => a,
        (Op::Div, Side::Left) => over(graph, one, b),
        (Op::Div, Side::Right) => {
            let ratio = over(graph, y, b);
            negative(graph, ratio)
        }
        (Op::Powi, Side::Left) => power_partial(graph, op, a, b),
        (Op::Pow, Side::Left) => power_partial(graph, op, a, b),
        (Op::Pow | Op::Powi, Side::Right) => {
            // y log a, whose limit is 0 where y is.
            let log = graph.unary(Op::Log, a);
            let product = times(graph, y, log);
            let vanishes = graph.binary(Op::Eq, y, zero);
            graph.select(vanishes, zero, product)
        }
        (Op::Atan2, _) => {
            let (squares_a, squares_b) = (square(graph, a), square(graph, b));
            let below = plus(graph, squares_a, squares_b);
            match side {
                Side::Left => over(graph, b, below),
                Side::Right => {
                    let ratio = over(graph, a, below);
                    negative(graph, ratio)
                }
            }
        }
        (Op::Min, side) => {
            let first = graph.binary(Op::Le, a, b);
            if side == Side::Left { graph.select(first, one, zero) } else { graph.select(first, zero, one) }
        }
        (Op::Max, side) => {
            let first = graph.binary(Op::Le, b, a);
            if side == Side::Left { graph.select(first, one, zero) } else { graph.select(first, zero, one) }
        }
        (Op::Mod, Side::Right) => {
            let ratio = graph.binary(Op::Div, a, b);
            let whole = graph.unary(Op::Floor, ratio);
            negative(graph, whole)
        }
        (Op::Hypot, Side::Left) => over(graph, a, y),
        (Op::Hypot, Side::Right) => over(graph, b, y),
        (Op::Lt | Op::Le | Op::Eq | Op::Ne | Op::And | Op::Or, _) => zero,
        (Op::Neg | Op::Sin | Op::Cos | Op::Tan | Op::Asin | Op::Acos | Op::Atan | Op::Sinh | Op::Cosh, _) => {
            unreachable!("{} has one operand", op.name())
        }
        (
            Op::Tanh
            | Op::Asinh
            | Op::Acosh
            | Op::Atanh
            | Op::Exp
            | Op::Log
            | Op::Log2
            | Op::Log10
            | Op::Sqrt,
            _,
        ) => {
            unreachable!("{} has one operand", op.name())
        }
        (Op::Cbrt | Op::Abs | Op::Sign | Op::Floor | Op::Ceil | Op::Round | Op::Trunc | Op::Not, _) => {
            unreachable!("{} has one operand", op.name())
        }
        (Op::Select, _) => unreachable!("select has three operands"),
    }
}

/// n a^(n-1), which is finite at a = 0 for n >= 1.
fn power_partial(graph: &mut Graph, op: Op, a: NodeId, n: NodeId) -> NodeId {
    let one = graph.number(1.0);
    let less = graph.binary(Op::Sub, n, one);
    let power = graph.binary(op, a, less);
    times(graph, n, power)
}

/// 1/sqrt((p - q)(r + s)).
fn inverse_root(graph: &mut Graph, [p, q]: [NodeId; 2], [r, s]: [NodeId; 2]) -> NodeId {
    let one = graph.number(1.0);
    let (low, high) = (minus(graph, p, q), plus(graph, r, s));
    let inside = times(graph, low, high);
    let below = graph.unary(Op::Sqrt, inside);
    over(graph, one, below)
}

/// 1/(k a).
fn scaled_inverse(graph: &mut Graph, k: f64, a: NodeId) -> NodeId {
    let (one, k) = (graph.number(1.0), graph.number(k));
    let below = times(graph, k, a);
    over(graph, one, below)
}

fn square(graph: &mut Graph, a: NodeId) -> NodeId {
    let two = graph.number(2.0);
    graph.binary(Op::Powi, a, two)
}

/// `a + b`, formally.
pub fn plus(graph: &mut Graph, a: NodeId, b: NodeId) -> NodeId {
    if graph.is_zero(a) {
        return b;
    }
    if graph.is_zero(b) {
        return a;
    }
    if let (Some([c, u, v]), Some([d, w, z])) = (as_choice(graph, a), as_choice(graph, b)) {
        let apart = (graph.is_zero(v) && graph.is_zero(w)) || (graph.is_zero(u) && graph.is_zero(z));
        let together = (graph.is_zero(v) && graph.is_zero(z)) || (graph.is_zero(u) && graph.is_zero(w));
        if c == d && (apart || together) {
            let (then, otherwise) = (plus(graph, u, w), plus(graph, v, z));
            return graph.select(c, then, otherwise);
        }
    }
    graph.binary(Op::Add, a, b)
}

/// `a - b`, formally.
pub fn minus(graph: &mut Graph, a: NodeId, b: NodeId) -> NodeId {
    let b = negative(graph, b);
    plus(graph, a, b)
}

/// `-a`, formally.
pub fn negative(graph: &mut Graph, a: NodeId) -> NodeId {
    match graph.node(a) {
        Node::Binary(Op::Sub, u, v) => graph.binary(Op::Sub, v, u),
        Node::Select(c, u, v) if graph.is_zero(u) || graph.is_zero(v) => {
            let (u, v) = (negative(graph, u), negative(graph, v));
            graph.select(c, u, v)
        }
        Node::Constant(bits) if f64::from_bits(bits) == 0.0 => graph.number(0.0),
        _ => graph.unary(Op::Neg, a),
    }
}

/// `a b`, formally.
pub fn times(graph: &mut Graph, a: NodeId, b: NodeId) -> NodeId {
    if graph.is_zero(a) || graph.is_zero(b) {
        return graph.number(0.0);
    }
    for (x, y) in [(a, b), (b, a)] {
        if let Some(guarded) = inside_branch(graph, x, y, times) {
            return guarded;
        }
        if let Node::Binary(Op::Div, n, d) = graph.node(x)
            && graph.constant(n) == Some(1.0)
        {
            return over(graph, y, d);
        }
    }
    match (factored(graph, a), factored(graph, b)) {
        ((k, None), (l, None)) => graph.number(k * l),
        ((k, Some(u)), (l, None)) | ((k, None), (l, Some(u))) => scaled(graph, k * l, u),
        ((1.0, Some(_)), (1.0, Some(_))) => graph.binary(Op::Mul, a, b),
        ((k, Some(u)), (l, Some(v))) => {
            let product = times(graph, u, v);
            scaled(graph, k * l, product)
        }
    }
}

/// A constant factor and the rest; no rest if it is constant.
fn factored(graph: &Graph, a: NodeId) -> (f64, Option<NodeId>) {
    if let Some(k) = graph.constant(a) {
        return (k, None);
    }
    match graph.node(a) {
        Node::Unary(Op::Neg, u) => (-1.0, Some(u)),
        Node::Binary(Op::Mul, u, v) => match (graph.constant(u), graph.constant(v)) {
            (Some(k), _) => (k, Some(v)),
            (None, Some(k)) => (k, Some(u)),
            (None, None) => (1.0, Some(a)),
        },
        _ => (1.0, Some(a)),
    }
}

/// `k u`, formally.
fn scaled(graph: &mut Graph, k: f64, u: NodeId) -> NodeId {
    if k == -1.0 {
        return negative(graph, u);
    }
    let k = graph.number(k);
    graph.binary(Op::Mul, k, u)
}

/// `a / b`, formally.
pub fn over(graph: &mut Graph, a: NodeId, b: NodeId) -> NodeId {
    if graph.is_zero(a) {
        return graph.number(0.0);
    }
    inside_branch(graph, a, b, over).unwrap_or_else(|| graph.binary(Op::Div, a, b))
}

/// Condition and branches of an `if`; a truth value is `if c then 1 else 0`.
fn as_choice(graph: &mut Graph, id: NodeId) -> Option<[NodeId; 3]> {
    match graph.node(id) {
        Node::Select(c, u, v) => Some([c, u, v]),
        node if node.op().is_some_and(Op::is_boolean) => Some([id, graph.number(1.0), graph.number(0.0)]),
        _ => None,
    }
}

/// `(if c then u else 0) * y` as `if c then u * y else 0`, flattened where u or the product is of that form again.
fn inside_branch(
    graph: &mut Graph,
    x: NodeId,
    y: NodeId,
    combine: fn(&mut Graph, NodeId, NodeId) -> NodeId,
) -> Option<NodeId> {
    let [c, u, v] = as_choice(graph, x)?;
    let zero = graph.number(0.0);
    let (condition, inner) = if graph.is_zero(v) {
        (c, u)
    } else if graph.is_zero(u) {
        (graph.unary(Op::Not, c), v)
    } else {
        return None;
    };
    let product = combine(graph, inner, y);
    let (condition, product) = match as_choice(graph, product) {
        Some([d, w, z]) if graph.is_zero(z) => (graph.binary(Op::And, condition, d), w),
        Some([d, w, z]) if graph.is_zero(w) => {
            let opposite = graph.unary(Op::Not, d);
            (graph.binary(Op::And, condition, opposite), z)
        }
        _ => (condition, product),
    };
    Some(graph.select(condition, product, zero))
}
