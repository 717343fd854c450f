//! Comparisons and logic over intervals: certainly false [0, 0], certainly true [1, 1], or maybe [0, 1].

use super::Interval;

/// What is known of a condition as an interval.
#[inline(always)]
fn verdict(surely_true: bool, surely_false: bool) -> Interval {
    if surely_true {
        Interval::ONE
    } else if surely_false {
        Interval::ZERO
    } else {
        Interval::MAYBE
    }
}

#[expect(
    clippy::should_implement_trait,
    reason = "the names of the operators, without their operators' traits"
)]
impl Interval {
    /// Whether no member counts as false; a NaN would count as true, but WHOLE contains zero.
    #[inline]
    pub fn is_true(self) -> bool {
        !self.contains_zero()
    }

    /// Whether it is zero alone.
    #[inline]
    pub fn is_false(self) -> bool {
        self.lo == 0.0 && self.hi == 0.0
    }

    /// Whether NaN may be among the operands.
    #[inline(always)]
    fn either_whole(self, other: Self) -> bool {
        self.is_whole() || other.is_whole()
    }

    /// `self < other`.
    #[inline]
    pub fn lt(self, other: Self) -> Self {
        verdict(self.hi < other.lo, self.lo >= other.hi)
    }

    /// `self <= other`.
    #[inline]
    pub fn le(self, other: Self) -> Self {
        verdict(self.hi <= other.lo && !self.either_whole(other), self.lo > other.hi)
    }

    /// `self == other`.
    #[inline]
    pub fn eq_to(self, other: Self) -> Self {
        let same = self.is_point() && other.is_point() && self.lo == other.lo;
        verdict(same, self.hi < other.lo || self.lo > other.hi)
    }

    /// `self != other`.
    #[inline]
    pub fn ne_to(self, other: Self) -> Self {
        self.eq_to(other).not()
    }

    /// Not.
    #[inline]
    pub fn not(self) -> Self {
        verdict(self.is_false(), self.is_true())
    }

    /// Both.
    #[inline]
    pub fn and(self, other: Self) -> Self {
        verdict(self.is_true() && other.is_true(), self.is_false() || other.is_false())
    }

    /// One or both.
    #[inline]
    pub fn or(self, other: Self) -> Self {
        verdict(self.is_true() || other.is_true(), self.is_false() && other.is_false())
    }

    /// `then` where this is true, `otherwise` where it is false.
    #[inline]
    pub fn select(self, then: Self, otherwise: Self) -> Self {
        if self.is_true() {
            then
        } else if self.is_false() {
            otherwise
        } else {
            then.hull(otherwise)
        }
    }
}
