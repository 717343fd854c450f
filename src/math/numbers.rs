//! A number for each of some agents: one, or as many as lanes.
//!
//! Recurrences are written once over [`Numbers`]; the operations are lane by lane, so that a lane has the bits that the
//! agent has alone.

use super::elementary;
use super::op::Op;

/// How many agents are advanced at once.
pub const N_LANES: usize = 32;

/// A number for each of some agents.
pub trait Numbers: Copy {
    /// The same for all.
    fn all(value: f64) -> Self;
    /// A function of each.
    fn map(self, f: impl Fn(f64) -> f64) -> Self;
    /// A function of each and its like.
    fn zip(self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self;
    /// `self + a b`, in two roundings.
    fn plus_product(self, a: &Self, b: &Self) -> Self;
    /// Where it is not 0, `a`, else `b`.
    fn choose(self, a: Self, b: Self) -> Self;
    /// An operator; operands beyond its arity are not looked at.
    fn apply(op: Op, operands: [Self; 3]) -> Self;
    /// Sine and cosine.
    fn sin_cos(self) -> (Self, Self);
}

impl Numbers for f64 {
    #[inline(always)]
    fn all(value: f64) -> Self {
        value
    }
    #[inline(always)]
    fn map(self, f: impl Fn(f64) -> f64) -> Self {
        f(self)
    }
    #[inline(always)]
    fn zip(self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        f(self, other)
    }
    #[inline(always)]
    fn plus_product(self, a: &Self, b: &Self) -> Self {
        self + a * b
    }
    #[inline(always)]
    fn choose(self, a: Self, b: Self) -> Self {
        if self != 0.0 { a } else { b }
    }
    #[inline]
    fn apply(op: Op, operands: [Self; 3]) -> Self {
        op.eval(operands)
    }
    #[inline]
    fn sin_cos(self) -> (Self, Self) {
        elementary::sin_cos(self)
    }
}

/// A number for each lane.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(64))]
pub struct Wide(pub [f64; N_LANES]);

impl Numbers for Wide {
    #[inline(always)]
    fn all(value: f64) -> Self {
        Wide([value; N_LANES])
    }
    #[inline(always)]
    fn map(mut self, f: impl Fn(f64) -> f64) -> Self {
        for lane in 0..N_LANES {
            self.0[lane] = f(self.0[lane]);
        }
        self
    }
    #[inline(always)]
    fn zip(mut self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        for lane in 0..N_LANES {
            self.0[lane] = f(self.0[lane], other.0[lane]);
        }
        self
    }
    #[inline(always)]
    fn plus_product(mut self, a: &Self, b: &Self) -> Self {
        for lane in 0..N_LANES {
            self.0[lane] += a.0[lane] * b.0[lane];
        }
        self
    }
    #[inline(always)]
    fn choose(mut self, a: Self, b: Self) -> Self {
        for lane in 0..N_LANES {
            self.0[lane] = if self.0[lane] != 0.0 { a.0[lane] } else { b.0[lane] };
        }
        self
    }
    fn apply(op: Op, [a, b, c]: [Self; 3]) -> Self {
        let mut result = a;
        for lane in 0..N_LANES {
            result.0[lane] = op.eval([a.0[lane], b.0[lane], c.0[lane]]);
        }
        result
    }
    fn sin_cos(self) -> (Self, Self) {
        let (mut sine, mut cosine) = (self, self);
        for lane in 0..N_LANES {
            (sine.0[lane], cosine.0[lane]) = elementary::sin_cos(self.0[lane]);
        }
        (sine, cosine)
    }
}
