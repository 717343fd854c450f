//! Kinks (rule 15): a flow in which every branch is read from a lock, so that it is smooth while no lock changes.
//!
//! A lock is an auxiliary column of self. Comparisons of what moves become locks that hold 1 or 0, `floor` one that
//! holds a whole number; the other operators are written by these:
//! `|e| = if e >= 0 then e else -e`; `sign e = if e >= 0 then 1 else -1` (so +1 at 0 while the lock says so);
//! `min(a, b) = if a <= b then a else b`; `ceil e = -floor(-e)`; `trunc e = if e >= 0 then floor e else ceil e`;
//! `round e = if e >= 0 then floor(e + 1/2) else ceil(e - 1/2)`; `mod(a, b) = a - b floor(a/b)`. atan2 is continued
//! beyond its cut by 2 pi until the lock of `y >= 0` changes. `a < b` is `not b <= a`, so that both have one lock.

use rustc_hash::FxHashMap;

use crate::base::Span;
use crate::calculus::condition::Written;
use crate::calculus::derive::negative;
use crate::calculus::draft::Draft;
use crate::calculus::frame::Scope;
use crate::calculus::graph::{Node, NodeId};
use crate::calculus::guard;
use crate::calculus::system::{Kink, KinkKind, Relation};
use crate::math::Op;

/// The locked forms of `flow` (the rates of self, whose type is `ty`), and the kinks. What is locked stands where it stood.
pub fn lock(
    draft: &mut Draft,
    scope: &mut Scope,
    ty: usize,
    flow: &[NodeId],
    name: &str,
) -> (Vec<NodeId>, Vec<Kink>) {
    let mut pass = Locking {
        draft,
        scope,
        ty,
        name,
        known: FxHashMap::default(),
        kinks: Vec::new(),
        span: Span::default(),
    };
    let mut locked: FxHashMap<NodeId, NodeId> = FxHashMap::default();
    for id in pass.draft.graph.reach(flow) {
        if pass.draft.is_exhausted() {
            // The flow is refused for it.
            return (flow.to_vec(), pass.kinks);
        }
        let new = match pass.draft.graph.node(id) {
            Node::Unary(op, a) => pass.unary(op, a, locked[&a], id),
            Node::Binary(op, a, b) => pass.binary(op, [a, b], [locked[&a], locked[&b]], id),
            Node::Select(c, a, b) => pass.draft.graph.select(locked[&c], locked[&a], locked[&b]),
            Node::Constant(_) | Node::Time | Node::State { .. } | Node::Rate { .. } => id,
            Node::Acceleration { .. } | Node::Aux { .. } => id,
        };
        locked.insert(id, new);
    }
    let (smooth, kinks) = (flow.iter().map(|id| locked[id]).collect(), pass.kinks);
    let moved = locked.into_iter().filter_map(|(old, new)| scope.spans.get(&old).map(|&span| (new, span)));
    for (new, span) in moved.collect::<Vec<_>>() {
        let first = scope.spans.entry(new).or_insert(span);
        *first = span.min(*first);
    }
    (smooth, kinks)
}

struct Locking<'d, 'm> {
    draft: &'d mut Draft<'m>,
    scope: &'d Scope,
    ty: usize,
    name: &'d str,
    known: FxHashMap<LockKey, NodeId>,
    kinks: Vec<Kink>,
    span: Span,
}

/// What a lock holds, by locked operands.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
enum LockKey {
    /// Whether a <= b.
    NotAbove(NodeId, NodeId),
    /// floor(e).
    Floor(NodeId),
}

/// An operand as the source has it and with its branches locked.
#[derive(Clone, Copy)]
struct Both {
    plain: NodeId,
    locked: NodeId,
}

impl Locking<'_, '_> {
    fn unary(&mut self, op: Op, plain: NodeId, locked: NodeId, id: NodeId) -> NodeId {
        let e = Both { plain, locked };
        if !self.draft.graph.moves(locked) {
            return self.draft.graph.unary(op, locked);
        }
        self.at(id);
        match op {
            Op::Abs => {
                let positive = self.positive(e);
                let minus = negative(&mut self.draft.graph, locked);
                self.draft.graph.select(positive, locked, minus)
            }
            Op::Sign => {
                let positive = self.positive(e);
                let (one, minus) = (self.number(1.0), self.number(-1.0));
                self.draft.graph.select(positive, one, minus)
            }
            Op::Floor => self.floor(e),
            Op::Ceil => self.ceil(e),
            Op::Trunc => {
                let positive = self.positive(e);
                let (down, up) = (self.floor(e), self.ceil(e));
                self.draft.graph.select(positive, down, up)
            }
            Op::Round => {
                let positive = self.positive(e);
                let half = self.number(0.5);
                let (above, below) = (self.both(Op::Add, e, half), self.both(Op::Sub, e, half));
                let (down, up) = (self.floor(above), self.ceil(below));
                self.draft.graph.select(positive, down, up)
            }
            Op::Neg | Op::Sin | Op::Cos | Op::Tan | Op::Asin | Op::Acos | Op::Atan | Op::Sinh | Op::Cosh => {
                self.draft.graph.unary(op, locked)
            }
            Op::Tanh | Op::Asinh | Op::Acosh | Op::Atanh | Op::Exp | Op::Log | Op::Log2 | Op::Log10 => {
                self.draft.graph.unary(op, locked)
            }
            Op::Sqrt | Op::Cbrt | Op::Not => self.draft.graph.unary(op, locked),
            Op::Add | Op::Sub | Op::Mul | Op::Div | Op::Powi | Op::Pow | Op::Atan2 | Op::Min | Op::Max => {
                unreachable!("{} has two operands", op.name())
            }
            Op::Mod | Op::Hypot | Op::Lt | Op::Le | Op::Eq | Op::Ne | Op::And | Op::Or | Op::Select => {
                unreachable!("{} has more than one operand", op.name())
            }
        }
    }

    fn binary(&mut self, op: Op, plain: [NodeId; 2], locked: [NodeId; 2], id: NodeId) -> NodeId {
        let [a, b] = [0, 1].map(|k| Both { plain: plain[k], locked: locked[k] });
        if !self.draft.graph.moves(a.locked) && !self.draft.graph.moves(b.locked) {
            return self.draft.graph.binary(op, a.locked, b.locked);
        }
        self.at(id);
        match op {
            Op::Min => {
                let first = self.not_above(a, b);
                self.draft.graph.select(first, a.locked, b.locked)
            }
            Op::Max => {
                let second = self.not_above(a, b);
                self.draft.graph.select(second, b.locked, a.locked)
            }
            Op::Le => self.not_above(a, b),
            Op::Lt => {
                let opposite = self.not_above(b, a);
                self.draft.graph.unary(Op::Not, opposite)
            }
            Op::Eq => self.equal(a, b),
            Op::Ne => {
                let equal = self.equal(a, b);
                self.draft.graph.unary(Op::Not, equal)
            }
            Op::Mod => {
                let ratio = Both {
                    plain: self.draft.graph.binary(Op::Div, a.plain, b.plain),
                    locked: self.draft.graph.binary(Op::Div, a.locked, b.locked),
                };
                let whole = self.floor(ratio);
                let whole = self.draft.graph.binary(Op::Mul, b.locked, whole);
                self.draft.graph.binary(Op::Sub, a.locked, whole)
            }
            Op::Atan2 => self.angle(a, b),
            Op::Add | Op::Sub | Op::Mul | Op::Div | Op::Powi | Op::Pow | Op::Hypot | Op::And | Op::Or => {
                self.draft.graph.binary(op, a.locked, b.locked)
            }
            Op::Neg | Op::Sin | Op::Cos | Op::Tan | Op::Asin | Op::Acos | Op::Atan | Op::Sinh | Op::Cosh => {
                unreachable!("{} has one operand", op.name())
            }
            Op::Tanh | Op::Asinh | Op::Acosh | Op::Atanh | Op::Exp | Op::Log | Op::Log2 | Op::Log10 => {
                unreachable!("{} has one operand", op.name())
            }
            Op::Sqrt
            | Op::Cbrt
            | Op::Abs
            | Op::Sign
            | Op::Floor
            | Op::Ceil
            | Op::Round
            | Op::Trunc
            | Op::Not => {
                unreachable!("{} has one operand", op.name())
            }
            Op::Select => unreachable!("select has three operands"),
        }
    }

    /// Kinks found from now on stand where this node does.
    fn at(&mut self, id: NodeId) {
        if let Some(&span) = self.scope.spans.get(&id) {
            self.span = span;
        }
    }

    fn number(&mut self, x: f64) -> NodeId {
        self.draft.graph.number(x)
    }

    fn both(&mut self, op: Op, e: Both, constant: NodeId) -> Both {
        let graph = &mut self.draft.graph;
        Both { plain: graph.binary(op, e.plain, constant), locked: graph.binary(op, e.locked, constant) }
    }

    fn positive(&mut self, e: Both) -> NodeId {
        let zero = self.number(0.0);
        self.not_above(Both { plain: zero, locked: zero }, e)
    }

    /// `a == b` of what moves: both `a <= b` and `b <= a`.
    fn equal(&mut self, a: Both, b: Both) -> NodeId {
        let (below, above) = (self.not_above(a, b), self.not_above(b, a));
        self.draft.graph.binary(Op::And, below, above)
    }

    fn ceil(&mut self, e: Both) -> NodeId {
        let graph = &mut self.draft.graph;
        let minus = Both { plain: negative(graph, e.plain), locked: negative(graph, e.locked) };
        let floor = self.floor(minus);
        self.draft.graph.unary(Op::Neg, floor)
    }

    /// The lock of `a <= b`.
    fn not_above(&mut self, a: Both, b: Both) -> NodeId {
        let graph = &mut self.draft.graph;
        if !graph.moves(a.locked) && !graph.moves(b.locked) {
            return graph.binary(Op::Le, a.locked, b.locked);
        }
        let key = LockKey::NotAbove(a.locked, b.locked);
        if let Some(&lock) = self.known.get(&key) {
            return lock;
        }
        let g = match (graph.is_zero(a.locked), graph.is_zero(b.locked)) {
            (_, true) => a.locked,
            (true, false) => graph.unary(Op::Neg, b.locked),
            (false, false) => graph.binary(Op::Sub, a.locked, b.locked),
        };
        let initial = graph.binary(Op::Le, a.plain, b.plain);
        let kind = KinkKind::Branch(self.atom(Relation::NonPositive, g));
        self.add(key, kind, initial)
    }

    /// The lock of floor(e).
    fn floor(&mut self, e: Both) -> NodeId {
        if !self.draft.graph.moves(e.locked) {
            return self.draft.graph.unary(Op::Floor, e.locked);
        }
        let key = LockKey::Floor(e.locked);
        if let Some(&lock) = self.known.get(&key) {
            return lock;
        }
        let lock = self.next_lock();
        let one = self.number(1.0);
        let graph = &mut self.draft.graph;
        let below = graph.binary(Op::Sub, e.locked, lock);
        let next = graph.binary(Op::Add, lock, one);
        let above = graph.binary(Op::Sub, next, e.locked);
        let initial = graph.unary(Op::Floor, e.plain);
        let below = self.atom(Relation::Negative, below);
        let above = self.atom(Relation::NonPositive, above);
        self.add(key, KinkKind::Integer { below, above }, initial)
    }

    /// atan2(y, x), continued beyond the negative x-axis by 2 pi while the lock of y >= 0 is not that of y.
    fn angle(&mut self, y: Both, x: Both) -> NodeId {
        let upper = self.positive(y);
        let (zero, turn, back) =
            (self.number(0.0), self.number(std::f64::consts::TAU), self.number(-std::f64::consts::TAU));
        let graph = &mut self.draft.graph;
        let base = graph.binary(Op::Atan2, y.locked, x.locked);
        let left = graph.binary(Op::Lt, x.locked, zero);
        let is_upper = graph.binary(Op::Le, zero, y.locked);
        let beyond = graph.binary(Op::Ne, upper, is_upper);
        let beyond = graph.binary(Op::And, left, beyond);
        let turn = graph.select(upper, turn, back);
        let turned = graph.binary(Op::Add, base, turn);
        graph.select(beyond, turned, base)
    }

    /// The column of the lock that comes next.
    fn next_lock(&mut self) -> NodeId {
        let column = self.draft.layout(self.ty).lock(self.kinks.len());
        self.draft.graph.intern(Node::Aux { slot: 0, column: column as u32 })
    }

    fn atom(&mut self, relation: Relation, g: NodeId) -> crate::calculus::system::Atom {
        let name = format!("{} kink {}", self.name, self.kinks.len() + 1);
        let written = Written { span: self.span, sides: None };
        guard::atom(self.draft, &self.scope.frame, relation, g, written, &name)
    }

    fn add(&mut self, key: LockKey, kind: KinkKind, initial: NodeId) -> NodeId {
        let node = self.next_lock();
        let (name, number) = (self.name, self.kinks.len());
        let initial = self.draft.function(|| format!("{name} kink {} initial", number + 1), vec![initial]);
        let lock = self.draft.layout(self.ty).lock(number);
        self.kinks.push(Kink { lock, initial, kind, span: self.span });
        self.known.insert(key, node);
        node
    }
}
