//! Locks: an expression in which every branch is read from an auxiliary column, so that it is smooth while no lock changes.
//!
//! A lock is a column of self that comes after its own. Comparisons of what moves become locks that hold 1 or 0, `floor` one
//! that holds a whole number; the other operators are written by these:
//! `ceil e = -floor(-e)`; `trunc e = if e >= 0 then floor e else ceil e`; `mod(a, b) = a - b floor(a/b)`;
//! `round e = if e >= 0 then floor(e + 1/2) else ceil(e - 1/2)`. `a < b` is `not b <= a`, so that both have one lock.
//!
//! For a **flow**, of which single points do not matter, every kink is locked:
//! `|e| = if e >= 0 then e else -e`; `sign e = if e >= 0 then 1 else -1` (so +1 at 0 while the lock says so);
//! `min(a, b) = if a <= b then a else b`; atan2 is continued beyond its cut by 2 pi until the lock of `y >= 0` changes.
//! For a **guard** only what jumps is locked, and with all locks that meet their surface closed (`a <= b` true, `floor e` the
//! whole number) the expression has its value on the surface itself: `sign e` is 0 where `e <= 0` and `0 <= e`.

use rustc_hash::FxHashMap;

use crate::base::Span;
use crate::calculus::atom;
use crate::calculus::condition::Written;
use crate::calculus::derive::negative;
use crate::calculus::draft::Draft;
use crate::calculus::graph::{Node, NodeId};
use crate::calculus::jumps;
use crate::calculus::system::{Frame, KinkKind, Relation};
use crate::math::Op;

/// What is locked for what.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// Every kink.
    Flow,
    /// What jumps.
    Guard,
}

/// Where the locks of some expressions are, and where these stand in the source.
#[derive(Clone, Copy)]
pub struct Place<'s> {
    /// The agents they read.
    pub frame: &'s Frame,
    /// The column of self of the first lock.
    pub first: usize,
    /// Where nodes were first met.
    pub spans: &'s FxHashMap<NodeId, Span>,
    /// Where those stand that were met nowhere.
    pub span: Span,
    /// For listings.
    pub name: &'s str,
}

/// A lock and where it changes. Its column is the first one plus its number.
pub struct Lock {
    /// Its value by the operands as they are read: for a flow as the source has them, for a guard by the locks before it.
    pub initial: NodeId,
    /// Its surfaces.
    pub kind: KinkKind,
    /// Where the operator stands.
    pub span: Span,
}

/// What every node below some roots becomes, and the locks. Not all of them are there if the draft is exhausted.
pub fn lock(
    draft: &mut Draft,
    place: Place<'_>,
    purpose: Purpose,
    roots: &[NodeId],
) -> (FxHashMap<NodeId, NodeId>, Vec<Lock>) {
    let span = place.span;
    let mut pass = Locking { draft, place, purpose, known: FxHashMap::default(), locks: Vec::new(), span };
    let mut locked: FxHashMap<NodeId, NodeId> = FxHashMap::default();
    for id in pass.draft.graph.reach(roots) {
        if pass.draft.is_exhausted() {
            return (locked, pass.locks);
        }
        let both = |id: NodeId| match purpose {
            Purpose::Flow => Both { plain: id, locked: locked[&id] },
            Purpose::Guard => Both { plain: locked[&id], locked: locked[&id] },
        };
        let new = match pass.draft.graph.node(id) {
            Node::Unary(op, a) => pass.unary(op, both(a), id),
            Node::Binary(op, a, b) => pass.binary(op, both(a), both(b), id),
            Node::Select(c, a, b) => pass.draft.graph.select(locked[&c], locked[&a], locked[&b]),
            Node::Constant(_) | Node::Time | Node::State { .. } | Node::Rate { .. } => id,
            Node::Acceleration { .. } | Node::Aux { .. } => id,
        };
        locked.insert(id, new);
    }
    (locked, pass.locks)
}

struct Locking<'d, 'm> {
    draft: &'d mut Draft<'m>,
    place: Place<'d>,
    purpose: Purpose,
    known: FxHashMap<LockKey, NodeId>,
    locks: Vec<Lock>,
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
    fn unary(&mut self, op: Op, e: Both, id: NodeId) -> NodeId {
        let locked = e.locked;
        if !self.draft.graph.moves(locked) {
            return self.draft.graph.unary(op, locked);
        }
        self.at(id);
        match op {
            Op::Abs if self.purpose == Purpose::Guard => self.draft.graph.unary(op, locked),
            Op::Abs => {
                let positive = self.positive(e);
                let minus = negative(&mut self.draft.graph, locked);
                self.draft.graph.select(positive, locked, minus)
            }
            Op::Sign => self.sign(e),
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

    fn binary(&mut self, op: Op, a: Both, b: Both, id: NodeId) -> NodeId {
        if !self.draft.graph.moves(a.locked) && !self.draft.graph.moves(b.locked) {
            return self.draft.graph.binary(op, a.locked, b.locked);
        }
        self.at(id);
        match op {
            Op::Min | Op::Max if self.purpose == Purpose::Guard => {
                self.draft.graph.binary(op, a.locked, b.locked)
            }
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
            Op::Atan2 if self.purpose == Purpose::Guard => self.regular_angle(a, b),
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
        if let Some(&span) = self.place.spans.get(&id) {
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

    fn sign(&mut self, e: Both) -> NodeId {
        let positive = self.positive(e);
        let (one, minus) = (self.number(1.0), self.number(-1.0));
        let sign = self.draft.graph.select(positive, one, minus);
        if self.purpose == Purpose::Flow {
            return sign;
        }
        let zero = self.number(0.0);
        let at_zero = self.equal(e, Both { plain: zero, locked: zero });
        self.draft.graph.select(at_zero, zero, sign)
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

    /// atan2(y, x) as it is regular on each side of its cut; 0 at the origin where one operand does not move.
    fn regular_angle(&mut self, y: Both, x: Both) -> NodeId {
        let graph = &mut self.draft.graph;
        let (moves_y, moves_x) = (graph.moves(y.locked), graph.moves(x.locked));
        if !moves_x && graph.constant(x.locked).is_some_and(|x| x > 0.0) {
            return graph.binary(Op::Atan2, y.locked, x.locked);
        }
        let upper = self.positive(y);
        let graph = &mut self.draft.graph;
        let angle = jumps::angle(graph, upper, y.locked, x.locked);
        let zero = graph.number(0.0);
        let nothing = Both { plain: zero, locked: zero };
        if !moves_x && graph.constant(x.locked).is_none_or(|x| x == 0.0) {
            let (at_zero, on_axis) =
                (self.equal(y, nothing), self.draft.graph.binary(Op::Eq, x.locked, zero));
            let origin = self.draft.graph.binary(Op::And, at_zero, on_axis);
            return self.draft.graph.select(origin, zero, angle);
        }
        if !moves_y && graph.constant(y.locked).is_none_or(|y| y == 0.0) {
            let right = self.positive(x);
            let graph = &mut self.draft.graph;
            let half_turn = graph.number(std::f64::consts::PI);
            let along = graph.select(right, zero, half_turn);
            let on_axis = graph.binary(Op::Eq, y.locked, zero);
            return graph.select(on_axis, along, angle);
        }
        angle
    }

    /// The column of the lock that comes next.
    fn next_lock(&mut self) -> NodeId {
        let column = self.place.first + self.locks.len();
        self.draft.graph.intern(Node::Aux { slot: 0, column: column as u32 })
    }

    fn atom(&mut self, relation: Relation, g: NodeId) -> crate::calculus::system::Atom {
        let name = format!("{} {}", self.place.name, self.locks.len() + 1);
        let written = Written { span: self.span, sides: None };
        atom::atom(self.draft, self.place.frame, relation, g, written, &name)
    }

    fn add(&mut self, key: LockKey, kind: KinkKind, initial: NodeId) -> NodeId {
        let node = self.next_lock();
        self.locks.push(Lock { initial, kind, span: self.span });
        self.known.insert(key, node);
        node
    }
}
