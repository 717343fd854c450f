//! What is known of the dimension of a number, and how operators combine it: the rules of gradual units.
//!
//! A name without a unit is unchecked, and so is what is computed from it by a product. A bare number is dimensionless in a
//! product and takes the other side's dimension elsewhere; what is worked out from bare numbers alone is one again. What the
//! language gives a dimension (`time`, the value of `sin`) is at odds with written units only, not with itself: where nobody has
//! written a unit nothing is wrong.

use super::dimension::{Dimension, simple_fraction};

/// What is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Measure {
    /// Nothing: it goes with everything.
    Unchecked,
    /// It is a number without a unit.
    Bare,
    /// Its dimension, from the language alone.
    Given(Dimension),
    /// Its dimension, from units that are written.
    Known(Dimension),
}

/// Why a power has no dimension.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum PowerProblem {
    /// The exponent has a dimension.
    Exponent(Dimension),
    /// The exponent of a quantity changes during a run.
    Changes,
    /// The exponent of a quantity is no fraction that people write.
    Odd(f64),
    /// The result is beyond all measure.
    TooLarge,
}

/// What is known of an exponent besides its dimension.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Exponent {
    /// Its value.
    Constant(f64),
    /// It does not change during a run, or nobody knows.
    Fixed,
    /// It changes continuously.
    Changes,
}

impl Measure {
    /// That of a pure number, by the language.
    pub const NUMBER: Measure = Measure::Given(Dimension::ONE);

    /// The dimension, if there is one.
    pub fn dimension(self) -> Option<Dimension> {
        match self {
            Measure::Known(dimension) | Measure::Given(dimension) => Some(dimension),
            Measure::Unchecked | Measure::Bare => None,
        }
    }

    /// The dimension, if it comes from units that are written.
    pub fn written(self) -> Option<Dimension> {
        match self {
            Measure::Known(dimension) => Some(dimension),
            Measure::Unchecked | Measure::Bare | Measure::Given(_) => None,
        }
    }

    /// That of what must be alike: `+ -`, comparisons, `min max mod hypot`, branches of `if`. The two dimensions, if they
    /// differ.
    pub fn join(self, other: Measure) -> Result<Measure, [Dimension; 2]> {
        match (self, other) {
            (Measure::Unchecked | Measure::Bare, Measure::Known(_) | Measure::Given(_)) => Ok(other),
            (Measure::Known(_) | Measure::Given(_), Measure::Unchecked | Measure::Bare) => Ok(self),
            (Measure::Bare, Measure::Bare) => Ok(Measure::Bare),
            (Measure::Unchecked | Measure::Bare, Measure::Unchecked | Measure::Bare) => {
                Ok(Measure::Unchecked)
            }
            (Measure::Known(a) | Measure::Given(a), Measure::Known(b) | Measure::Given(b)) if a == b => {
                Ok(if self.written().is_some() { self } else { other })
            }
            (Measure::Given(_), Measure::Given(_)) => Ok(Measure::Unchecked),
            (Measure::Known(a) | Measure::Given(a), Measure::Known(b) | Measure::Given(b)) => Err([a, b]),
        }
    }

    /// That of a product; none if it is beyond all measure.
    pub fn times(self, other: Measure) -> Option<Measure> {
        self.combined(other, Dimension::times)
    }

    /// That of a quotient; none if it is beyond all measure.
    pub fn over(self, other: Measure) -> Option<Measure> {
        self.combined(other, Dimension::over)
    }

    fn combined(
        self,
        other: Measure,
        combine: fn(Dimension, Dimension) -> Option<Dimension>,
    ) -> Option<Measure> {
        if self == Measure::Unchecked || other == Measure::Unchecked {
            return Some(Measure::Unchecked);
        }
        if self == Measure::Bare && other == Measure::Bare {
            return Some(Measure::Bare);
        }
        let or_one = |measure: Measure| measure.dimension().unwrap_or(Dimension::ONE);
        let dimension = combine(or_one(self), or_one(other))?;
        let written = self.written().or(other.written()).is_some();
        Some(if written { Measure::Known(dimension) } else { Measure::Given(dimension) })
    }

    /// That of a root or another power with a known exponent; none if it is beyond all measure.
    pub fn power(self, numerator: i64, denominator: i64) -> Option<Measure> {
        match self {
            Measure::Unchecked | Measure::Bare => Some(self),
            Measure::Known(dimension) => dimension.power(numerator, denominator).map(Measure::Known),
            Measure::Given(dimension) => dimension.power(numerator, denominator).map(Measure::Given),
        }
    }

    /// That of `self ^ exponent`.
    pub fn to_the(self, exponent: Measure, value: Exponent) -> Result<Measure, PowerProblem> {
        if let Some(dimension) = exponent.written().filter(|&dimension| dimension != Dimension::ONE) {
            return Err(PowerProblem::Exponent(dimension));
        }
        match (self, value) {
            (Measure::Unchecked, _) => Ok(Measure::Unchecked),
            (Measure::Bare, _) if exponent == Measure::Bare => Ok(Measure::Bare),
            (Measure::Bare, _) => Ok(exponent.pure_number()),
            (Measure::Known(Dimension::ONE) | Measure::Given(Dimension::ONE), _) => Ok(self),
            (Measure::Known(_) | Measure::Given(_), Exponent::Fixed)
            | (Measure::Given(_), Exponent::Changes) => Ok(Measure::Unchecked),
            (Measure::Known(_), Exponent::Changes) => Err(PowerProblem::Changes),
            (Measure::Known(_) | Measure::Given(_), Exponent::Constant(value)) => {
                match simple_fraction(value) {
                    Some((numerator, denominator)) => {
                        self.power(numerator, denominator).ok_or(PowerProblem::TooLarge)
                    }
                    None if self.written().is_none() => Ok(Measure::Unchecked),
                    None => Err(PowerProblem::Odd(value)),
                }
            }
        }
    }

    /// That of a function whose value is a pure number; unchecked, if its argument is used as if nothing had a unit.
    pub fn pure_number(self) -> Measure {
        match self {
            Measure::Unchecked | Measure::Bare => self,
            Measure::Given(dimension) if dimension != Dimension::ONE => Measure::Unchecked,
            Measure::Given(_) | Measure::Known(_) => Measure::NUMBER,
        }
    }

    /// That of a name that stands for it: a name without a unit is unchecked.
    pub fn named(self) -> Measure {
        if self == Measure::Bare { Measure::Unchecked } else { self }
    }
}

#[cfg(test)]
mod tests {
    use super::Measure::{Bare, Given, Known, Unchecked};
    use super::{Dimension, Exponent, Measure, PowerProblem};

    const M: Dimension = Dimension::of([1, 0, 0, 0, 0, 0, 0]);
    const S: Dimension = Dimension::TIME;
    const ONE: Dimension = Dimension::ONE;

    #[test]
    fn a_name_without_a_unit_is_unchecked() {
        assert_eq!(Unchecked.join(Known(M)), Ok(Known(M)));
        assert_eq!(Unchecked.times(Known(M)), Some(Unchecked));
        assert_eq!(Unchecked.to_the(Known(ONE), Exponent::Changes), Ok(Unchecked));
        assert_eq!(Unchecked.pure_number(), Unchecked);
        assert_eq!(Bare.named(), Unchecked);
        assert_eq!(Known(M).named(), Known(M));
    }

    #[test]
    fn a_bare_literal_is_dimensionless_in_a_product() {
        assert_eq!(Bare.times(Known(M)), Some(Known(M)));
        assert_eq!(Bare.over(Known(S)).and_then(|rate| rate.times(Known(S))), Some(Known(ONE)));
        assert_eq!(Bare.times(Bare), Some(Bare));
    }

    #[test]
    fn a_bare_literal_takes_the_other_sides_dimension_elsewhere() {
        assert_eq!(Bare.join(Known(M)), Ok(Known(M)));
        assert_eq!(Known(M).join(Bare), Ok(Known(M)));
        assert_eq!(Bare.join(Bare), Ok(Bare));
        assert_eq!(Known(M).join(Known(S)), Err([M, S]));
        assert_eq!(Known(M).join(Known(ONE)), Err([M, ONE]));
    }

    #[test]
    fn what_the_language_gives_is_at_odds_with_written_units_only() {
        assert_eq!(Given(S).join(Known(M)), Err([S, M]));
        assert_eq!(Known(M).join(Measure::NUMBER), Err([M, ONE]));
        assert_eq!(Given(S).join(Known(S)), Ok(Known(S)));
        assert_eq!(Given(S).join(Measure::NUMBER), Ok(Unchecked));
        assert_eq!(Given(S).join(Unchecked), Ok(Given(S)));
        assert_eq!(Given(S).times(Bare), Some(Given(S)));
        assert_eq!(Given(S).times(Known(M)).and_then(|product| product.over(Given(S))), Some(Known(M)));
        assert_eq!(Bare.to_the(Given(S), Exponent::Changes), Ok(Unchecked));
        assert_eq!(Given(S).to_the(Unchecked, Exponent::Changes), Ok(Unchecked));
        assert_eq!(Given(S).pure_number(), Unchecked);
        assert_eq!(Known(S).pure_number(), Measure::NUMBER);
    }

    #[test]
    fn powers_with_constant_exponents_scale_dimensions() {
        let area = M.power(2, 1).expect("small");
        assert_eq!(Known(M).to_the(Bare, Exponent::Constant(2.0)), Ok(Known(area)));
        assert_eq!(Known(area).to_the(Bare, Exponent::Constant(0.5)), Ok(Known(M)));
        assert_eq!(Known(area).power(1, 2), Some(Known(M)));
        assert_eq!(Known(M).to_the(Bare, Exponent::Constant(0.0)), Ok(Known(ONE)));
        assert_eq!(Known(M).to_the(Unchecked, Exponent::Fixed), Ok(Unchecked));
        assert_eq!(Bare.to_the(Unchecked, Exponent::Changes), Ok(Unchecked));
        assert_eq!(Bare.to_the(Known(ONE), Exponent::Changes), Ok(Measure::NUMBER));
        assert_eq!(Known(M).to_the(Unchecked, Exponent::Changes), Err(PowerProblem::Changes));
        assert_eq!(Bare.to_the(Known(S), Exponent::Changes), Err(PowerProblem::Exponent(S)));
        assert_eq!(Known(M).to_the(Bare, Exponent::Constant(0.123_456)), Err(PowerProblem::Odd(0.123_456)));
        assert_eq!(Known(M).to_the(Bare, Exponent::Constant(1e6)), Err(PowerProblem::TooLarge));
    }
}
