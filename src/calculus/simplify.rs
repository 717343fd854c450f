//! Constructors of nodes that simplify, but only where no finite operand could tell: the same bits, zeros' signs too.
//!
//! Among the rules: constants are folded by `Op::eval`; operands of commutative operators stand in one order; `u*u`
//! is `u^2`; the sign of a difference is dropped under an even power, `abs` and `hypot`, because rounding is
//! symmetric. Not among them: `x + 0` (turns -0 into 0, which `atan2` sees), `x*0` and `x - x` (not 0 for infinities
//! and for the NaN that an absent agent reads as). Derivatives, which are formal, go further: see `derive`.

use crate::calculus::graph::{Graph, Node, NodeId};
use crate::math::Op;

impl Graph {
    /// A constant; all NaNs are one.
    pub fn number(&mut self, x: f64) -> NodeId {
        let x = if x.is_nan() { f64::NAN } else { x };
        self.intern(Node::Constant(x.to_bits()))
    }

    /// The value of a constant.
    pub fn constant(&self, id: NodeId) -> Option<f64> {
        match self.node(id) {
            Node::Constant(bits) => Some(f64::from_bits(bits)),
            Node::Time | Node::State { .. } | Node::Rate { .. } | Node::Acceleration { .. } => None,
            Node::Aux { .. } | Node::Unary(..) | Node::Binary(..) | Node::Select(..) => None,
        }
    }

    /// Whether it is the constant 0 of either sign.
    pub fn is_zero(&self, id: NodeId) -> bool {
        self.constant(id) == Some(0.0)
    }

    /// Whether its value is always 0 or 1.
    pub fn is_boolean(&self, id: NodeId) -> bool {
        match self.node(id) {
            Node::Constant(bits) => [0.0, 1.0].contains(&f64::from_bits(bits)),
            node => node.op().is_some_and(Op::is_boolean),
        }
    }

    /// An operator applied to as many operands as it has.
    pub fn apply(&mut self, op: Op, operands: &[NodeId]) -> NodeId {
        match *operands {
            [a] => self.unary(op, a),
            [a, b] => self.binary(op, a, b),
            [a, b, c] => self.select(a, b, c),
            _ => unreachable!("the model gives every operator its operands"),
        }
    }

    /// An operator of one operand.
    pub fn unary(&mut self, op: Op, a: NodeId) -> NodeId {
        if let Some(x) = self.constant(a) {
            return self.number(op.eval([x, 0.0, 0.0]));
        }
        match (op, self.node(a)) {
            (Op::Neg, Node::Unary(Op::Neg, x)) => x,
            (Op::Neg, Node::Binary(Op::Mul, x, y)) => match (self.constant(x), self.constant(y)) {
                (Some(c), _) => self.scaled(-c, y),
                (_, Some(c)) => self.scaled(-c, x),
                (None, None) => self.intern(Node::Unary(Op::Neg, a)),
            },
            (Op::Not, Node::Unary(Op::Not, x)) if self.is_boolean(x) => x,
            (Op::Abs, _) => {
                let a = self.without_sign(a);
                self.intern(Node::Unary(Op::Abs, a))
            }
            _ => self.intern(Node::Unary(op, a)),
        }
    }

    /// An operator of two operands.
    pub fn binary(&mut self, op: Op, a: NodeId, b: NodeId) -> NodeId {
        if let (Some(x), Some(y)) = (self.constant(a), self.constant(b)) {
            return self.number(op.eval([x, y, 0.0]));
        }
        match op {
            Op::Add => self.sum(a, b),
            Op::Sub => self.difference(a, b),
            Op::Mul => self.product(a, b),
            Op::Div => match self.constant(b) {
                Some(1.0) => a,
                Some(-1.0) => self.unary(Op::Neg, a),
                Some(_) | None => self.intern(Node::Binary(op, a, b)),
            },
            Op::Powi => self.integer_power(a, b),
            Op::Min | Op::Max if a == b => a,
            Op::Min | Op::Max | Op::Eq | Op::Ne => self.sorted(op, a, b),
            Op::And | Op::Or => self.junction(op, a, b),
            Op::Hypot => {
                let (a, b) = (self.without_sign(a), self.without_sign(b));
                self.intern(Node::Binary(op, a, b))
            }
            Op::Pow | Op::Atan2 | Op::Mod | Op::Lt | Op::Le => self.intern(Node::Binary(op, a, b)),
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

    /// `a` where `condition` is not 0, else `b`.
    pub fn select(&mut self, condition: NodeId, a: NodeId, b: NodeId) -> NodeId {
        if a == b {
            return a;
        }
        if let Some(c) = self.constant(condition) {
            return if c != 0.0 { a } else { b };
        }
        if let Node::Unary(Op::Not, positive) = self.node(condition) {
            return self.select(positive, b, a);
        }
        if self.is_boolean(condition) && self.constant(a) == Some(1.0) && self.constant(b) == Some(0.0) {
            return condition;
        }
        self.intern(Node::Select(condition, a, b))
    }

    fn sorted(&mut self, op: Op, a: NodeId, b: NodeId) -> NodeId {
        self.intern(Node::Binary(op, a.min(b), a.max(b)))
    }

    fn sum(&mut self, a: NodeId, b: NodeId) -> NodeId {
        for (x, y) in [(a, b), (b, a)] {
            match (self.constant(y), self.node(y)) {
                (Some(c), _) if c == 0.0 && c.is_sign_negative() => return x,
                (Some(c), _) if c < 0.0 => {
                    let c = self.number(-c);
                    return self.intern(Node::Binary(Op::Sub, x, c));
                }
                (None, Node::Unary(Op::Neg, z)) => return self.difference(x, z),
                (None, node) => {
                    if let Some(opposite) = self.opposite_product(node) {
                        return self.difference(x, opposite);
                    }
                }
                (Some(_), _) => {}
            }
        }
        self.sorted(Op::Add, a, b)
    }

    fn difference(&mut self, a: NodeId, b: NodeId) -> NodeId {
        match (self.constant(b), self.node(b)) {
            (Some(c), _) if c == 0.0 && c.is_sign_positive() => a,
            (Some(c), _) if c < 0.0 => {
                let c = self.number(-c);
                self.sorted(Op::Add, a, c)
            }
            (None, Node::Unary(Op::Neg, z)) => self.sum(a, z),
            (None, node) => match self.opposite_product(node) {
                Some(opposite) => self.sum(a, opposite),
                None => self.intern(Node::Binary(Op::Sub, a, b)),
            },
            (Some(_), _) => self.intern(Node::Binary(Op::Sub, a, b)),
        }
    }

    /// `k x` for `(-k) x` with a positive k.
    fn opposite_product(&mut self, node: Node) -> Option<NodeId> {
        let Node::Binary(Op::Mul, x, y) = node else { return None };
        [(x, y), (y, x)].into_iter().find_map(|(factor, rest)| {
            let k = self.constant(factor).filter(|&k| k < 0.0)?;
            Some(self.scaled(-k, rest))
        })
    }

    /// A constant times something that is none.
    fn scaled(&mut self, factor: f64, x: NodeId) -> NodeId {
        if factor == 1.0 {
            return x;
        }
        if let Node::Unary(Op::Neg, inner) = self.node(x) {
            return self.scaled(-factor, inner);
        }
        if factor == -1.0 {
            return self.unary(Op::Neg, x);
        }
        let factor = self.number(factor);
        self.sorted(Op::Mul, factor, x)
    }

    fn product(&mut self, a: NodeId, b: NodeId) -> NodeId {
        if let Some(c) = self.constant(a) {
            return self.scaled(c, b);
        }
        if let Some(c) = self.constant(b) {
            return self.scaled(c, a);
        }
        match (self.node(a), self.node(b)) {
            (Node::Unary(Op::Neg, x), Node::Unary(Op::Neg, y)) => self.product(x, y),
            (Node::Unary(Op::Neg, x), _) => {
                let positive = self.product(x, b);
                self.unary(Op::Neg, positive)
            }
            (_, Node::Unary(Op::Neg, y)) => {
                let positive = self.product(a, y);
                self.unary(Op::Neg, positive)
            }
            _ if a == b => {
                let two = self.number(2.0);
                self.integer_power(a, two)
            }
            _ => self.sorted(Op::Mul, a, b),
        }
    }

    fn integer_power(&mut self, a: NodeId, n: NodeId) -> NodeId {
        match self.constant(n) {
            Some(0.0) => self.number(1.0),
            Some(1.0) => a,
            Some(-1.0) => {
                let one = self.number(1.0);
                self.intern(Node::Binary(Op::Div, one, a))
            }
            Some(k) if k % 2.0 == 0.0 => {
                let a = self.without_sign(a);
                self.intern(Node::Binary(Op::Powi, a, n))
            }
            Some(_) | None => self.intern(Node::Binary(Op::Powi, a, n)),
        }
    }

    /// A node with the same absolute value, the same for `u - v` and `v - u`.
    fn without_sign(&mut self, a: NodeId) -> NodeId {
        match self.node(a) {
            Node::Unary(Op::Neg | Op::Abs, x) => self.without_sign(x),
            Node::Binary(Op::Sub, u, v) if u > v => self.intern(Node::Binary(Op::Sub, v, u)),
            _ => a,
        }
    }

    fn junction(&mut self, op: Op, a: NodeId, b: NodeId) -> NodeId {
        if a == b && self.is_boolean(a) {
            return a;
        }
        for (x, y) in [(a, b), (b, a)] {
            match (self.constant(y).map(|c| c != 0.0), op) {
                (Some(true), Op::And) | (Some(false), Op::Or) if self.is_boolean(x) => return x,
                (Some(false), Op::And) => return self.number(0.0),
                (Some(true), Op::Or) => return self.number(1.0),
                _ => {}
            }
        }
        self.sorted(op, a, b)
    }
}
