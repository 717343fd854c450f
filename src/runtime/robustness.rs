//! By how much something holds: a number, and what is so where it is zero.
//!
//! At zero `a <= b` holds and `a < b` does not. So a margin is a number with an infinitesimal behind it: of two that are zero the
//! closed one, which holds there, is the greater. The least and the greatest, of conditions, of agents and over time, are meant in
//! this order; then a margin tells the truth also where it is zero. To turn a margin upside down turns its infinitesimal, too.

/// Which extreme is looked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extreme {
    /// The least.
    Least,
    /// The greatest.
    Greatest,
}

impl Extreme {
    /// 1, or -1 to turn the greatest into the least.
    pub fn sign(self) -> f64 {
        match self {
            Extreme::Least => 1.0,
            Extreme::Greatest => -1.0,
        }
    }

    /// Whether a value is preferred to another one.
    pub fn prefers(self, value: f64, to: f64) -> bool {
        match self {
            Extreme::Least => value < to,
            Extreme::Greatest => value > to,
        }
    }

    /// Which of two margins that are zero is preferred, if one is closed and one is not: the closed one or the other.
    pub fn prefers_closed(self) -> bool {
        self == Extreme::Greatest
    }

    /// Of two margins the one that is preferred.
    pub fn of(self, a: Robustness, b: Robustness) -> Robustness {
        let b_is_preferred = match self {
            Extreme::Least => a.exceeds(b),
            Extreme::Greatest => b.exceeds(a),
        };
        if b_is_preferred { b } else { a }
    }

    /// The extreme of nothing.
    pub fn neutral(self) -> f64 {
        f64::INFINITY * self.sign()
    }
}

/// A margin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Robustness {
    /// The number.
    pub value: f64,
    /// Whether zero is enough.
    pub closed: bool,
    /// It counts as zero within this.
    pub slack: f64,
}

impl Robustness {
    /// What counts as zero at zero alone.
    pub fn exact(value: f64, closed: bool) -> Self {
        Self { value, closed, slack: 0.0 }
    }

    /// Whether it counts as zero.
    pub fn is_zero(self) -> bool {
        self.value.abs() <= self.slack
    }

    /// Whether what has this margin holds.
    pub fn holds(self) -> bool {
        if self.is_zero() { self.closed } else { self.value > 0.0 }
    }

    /// Whether it is greater than another one.
    pub fn exceeds(self, other: Self) -> bool {
        if self.closed != other.closed && self.is_zero() && other.is_zero() {
            return self.closed;
        }
        self.value > other.value
    }

    /// The same upside down.
    pub fn turned(self) -> Self {
        Self { value: -self.value, closed: !self.closed, slack: self.slack }
    }
}

#[cfg(test)]
mod tests {
    use super::{Extreme, Robustness};

    #[test]
    fn at_zero_the_closed_one_is_greater() {
        let [open, closed] = [false, true].map(|closed| Robustness::exact(0.0, closed));
        assert_eq!(
            [closed.exceeds(open), open.exceeds(closed), closed.exceeds(closed)],
            [true, false, false]
        );
        assert_eq!(Extreme::Least.of(closed, open), open);
        assert_eq!(Extreme::Greatest.of(open, closed), closed);
        assert!(open.turned().exceeds(closed.turned()));
        assert_eq!([open.holds(), closed.holds()], [false, true]);
        // Away from zero the number alone counts.
        let [less, more] = [Robustness::exact(1.0, true), Robustness::exact(2.0, false)];
        assert!(more.exceeds(less) && less.holds() && more.holds());
        assert!(Robustness::exact(f64::INFINITY, true).exceeds(more));
    }

    #[test]
    fn two_that_are_zero_within_their_slack_are_equal_but_for_the_side() {
        let flowing = Robustness { value: -1e-17, closed: true, slack: 1e-16 };
        let written = Robustness::exact(0.0, false);
        assert!(flowing.exceeds(written) && !written.exceeds(flowing));
        let negative = Robustness::exact(-1e-17, true);
        assert!(written.exceeds(negative) && !negative.exceeds(written));
    }
}
