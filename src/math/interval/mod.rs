//! Interval arithmetic: bounds that hold for every operand in a box.
//!
//! In: an operator and one closed interval per operand, ends possibly infinite, never NaN. Out: an interval that
//! contains `op.eval` of *every* combination of members, and the exact real result as well, because ends are rounded
//! outward: one step for `+ - * / sqrt` (none where a sum is exact), two for functions that are within 1 ulp, none for
//! exact operations. It is tight for sums, products, powers, and functions that are monotone or have known extremes.
//!
//! **Undefined.** There is no flag. [`Interval::WHOLE`] stands for "anything, perhaps NaN": an operation that is
//! undefined or has a pole anywhere in its operands' box (root of a negative, logarithm of zero or less, a divisor that
//! contains zero, arc sine beyond 1, sine of infinity) gives WHOLE, and WHOLE as an operand gives WHOLE again, or "maybe"
//! from a comparison. So a result other than WHOLE says that every step on the way was defined in the whole box. Only
//! `Select` drops a WHOLE: the branch that is certainly not taken does not count. So does `x^0`, which is 1.

mod arithmetic;
mod functions;
mod truth;

use super::Op;

/// A closed interval; `lo <= hi`, the ends may be infinite but are never NaN.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// The lower end.
    pub lo: f64,
    /// The upper end.
    pub hi: f64,
}

impl Interval {
    /// Anything, perhaps NaN.
    pub const WHOLE: Interval = Interval { lo: f64::NEG_INFINITY, hi: f64::INFINITY };
    /// Zero alone; as a truth value: certainly false.
    pub const ZERO: Interval = Interval { lo: 0.0, hi: 0.0 };
    /// One alone; as a truth value: certainly true.
    pub const ONE: Interval = Interval { lo: 1.0, hi: 1.0 };
    /// From 0 to 1; as a truth value: maybe.
    pub const MAYBE: Interval = Interval { lo: 0.0, hi: 1.0 };

    /// From `lo` to `hi`; WHOLE if they are not in order or one is NaN.
    #[inline]
    pub fn new(lo: f64, hi: f64) -> Self {
        if lo <= hi { Self { lo, hi } } else { Self::WHOLE }
    }

    /// One number alone; WHOLE for NaN.
    #[inline]
    pub fn point(x: f64) -> Self {
        Self::new(x, x)
    }

    /// [`Interval::WHOLE`].
    #[inline]
    pub fn whole() -> Self {
        Self::WHOLE
    }

    /// Whether this is [`Interval::WHOLE`].
    #[inline]
    pub fn is_whole(self) -> bool {
        self.lo == f64::NEG_INFINITY && self.hi == f64::INFINITY
    }

    /// Whether it is one number.
    #[inline]
    pub fn is_point(self) -> bool {
        self.lo == self.hi
    }

    /// Whether both ends are finite.
    #[inline]
    pub fn is_finite(self) -> bool {
        self.lo.is_finite() && self.hi.is_finite()
    }

    /// `hi - lo`, rounded to nearest.
    #[inline]
    pub fn width(self) -> f64 {
        if self.is_point() { 0.0 } else { self.hi - self.lo }
    }

    /// A finite number inside, the middle if both ends are finite; 0 for WHOLE.
    #[inline]
    pub fn mid(self) -> f64 {
        if self.is_whole() {
            return 0.0;
        }
        let (lo, hi) = (self.lo.max(f64::MIN), self.hi.min(f64::MAX));
        (0.5 * lo + 0.5 * hi).clamp(lo.min(hi), hi.max(lo))
    }

    /// The two parts below and above [`Interval::mid`].
    #[inline]
    pub fn halves(self) -> (Self, Self) {
        let mid = self.mid();
        (Self { lo: self.lo, hi: mid }, Self { lo: mid, hi: self.hi })
    }

    /// Whether `x` is a member; NaN is one of WHOLE only.
    #[inline]
    pub fn contains(self, x: f64) -> bool {
        (self.lo <= x && x <= self.hi) || (x.is_nan() && self.is_whole())
    }

    /// Whether it contains another.
    #[inline]
    pub fn encloses(self, other: Self) -> bool {
        self.lo <= other.lo && other.hi <= self.hi
    }

    /// Whether zero is a member.
    #[inline]
    pub fn contains_zero(self) -> bool {
        self.lo <= 0.0 && self.hi >= 0.0
    }

    /// The largest absolute value of a member.
    #[inline]
    pub fn mag(self) -> f64 {
        self.lo.abs().max(self.hi.abs())
    }

    /// The smallest absolute value of a member.
    #[inline]
    pub fn mig(self) -> f64 {
        if self.contains_zero() { 0.0 } else { self.lo.abs().min(self.hi.abs()) }
    }

    /// The smallest interval that contains both.
    #[inline]
    pub fn hull(self, other: Self) -> Self {
        Self { lo: self.lo.min(other.lo), hi: self.hi.max(other.hi) }
    }

    /// What both contain, if anything.
    #[inline]
    pub fn intersect(self, other: Self) -> Option<Self> {
        let (lo, hi) = (self.lo.max(other.lo), self.hi.min(other.hi));
        (lo <= hi).then_some(Self { lo, hi })
    }

    /// Contains `op.eval` for every combination of members of `args`, which has at least the operator's arity.
    #[inline]
    pub fn eval(op: Op, args: &[Interval]) -> Interval {
        let a = args[0];
        let b = if args.len() > 1 { args[1] } else { a };
        match op {
            Op::Neg => a.neg(),
            Op::Add => a.add(b),
            Op::Sub => a.sub(b),
            Op::Mul => a.mul(b),
            Op::Div => a.div(b),
            Op::Powi => a.powi(b),
            Op::Pow => a.pow(b),
            Op::Sin => a.sin(),
            Op::Cos => a.cos(),
            Op::Tan => a.tan(),
            Op::Asin => a.asin(),
            Op::Acos => a.acos(),
            Op::Atan => a.atan(),
            Op::Atan2 => a.atan2(b),
            Op::Sinh => a.sinh(),
            Op::Cosh => a.cosh(),
            Op::Tanh => a.tanh(),
            Op::Asinh => a.asinh(),
            Op::Acosh => a.acosh(),
            Op::Atanh => a.atanh(),
            Op::Exp => a.exp(),
            Op::Log => a.log(),
            Op::Log2 => a.log2(),
            Op::Log10 => a.log10(),
            Op::Sqrt => a.sqrt(),
            Op::Cbrt => a.cbrt(),
            Op::Abs => a.abs(),
            Op::Sign => a.sign(),
            Op::Min => a.min(b),
            Op::Max => a.max(b),
            Op::Floor => a.floor(),
            Op::Ceil => a.ceil(),
            Op::Round => a.round(),
            Op::Trunc => a.trunc(),
            Op::Mod => a.modulo(b),
            Op::Hypot => a.hypot(b),
            Op::Lt => a.lt(b),
            Op::Le => a.le(b),
            Op::Eq => a.eq_to(b),
            Op::Ne => a.ne_to(b),
            Op::Not => a.not(),
            Op::And => a.and(b),
            Op::Or => a.or(b),
            Op::Select => a.select(b, args[2]),
        }
    }
}
