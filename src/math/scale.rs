//! The size of a unit, and values into and out of it.
//!
//! A size is a quotient of two numbers, so that 10 ms is 10*1/1000, correctly rounded. A unit of size 1/1 changes no bit. On
//! the way out of several values that all come to the same number in SI the one with the fewest digits is shown: what was read
//! with up to 15 digits is written with the same digits again.

/// How far from the quotient the shortest value is looked for, in neighbours: two roundings on the way in and two on the
/// way out are four halves of a neighbour, twice as many where the leading digits are large.
const NEIGHBOURS: usize = 4;

/// One unit is `numerator / denominator` in SI.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    /// Positive and finite.
    pub numerator: f64,
    /// Positive and finite.
    pub denominator: f64,
}

impl Scale {
    /// The size of the SI units themselves.
    pub const ONE: Scale = Scale { numerator: 1.0, denominator: 1.0 };

    /// A quotient in lowest terms, if both are whole and exact; none if it is not positive and finite.
    pub fn new(numerator: f64, denominator: f64) -> Option<Scale> {
        let divisor = common_divisor(numerator, denominator);
        let scale = Scale { numerator: numerator / divisor, denominator: denominator / divisor };
        let sound = |value: f64| value.is_finite() && value > 0.0;
        [scale.numerator, scale.denominator, scale.factor()].into_iter().all(sound).then_some(scale)
    }

    /// What one unit is in SI.
    pub fn factor(self) -> f64 {
        self.numerator / self.denominator
    }

    /// A value in this unit, in SI.
    pub fn to_si(self, value: f64) -> f64 {
        value * self.numerator / self.denominator
    }

    /// A value in SI, in this unit.
    pub fn from_si(self, value: f64) -> f64 {
        if self == Scale::ONE {
            return value;
        }
        let quotient = value * self.denominator / self.numerator;
        let (mut above, mut below) = (quotient, quotient);
        let mut nearest = vec![quotient];
        for _ in 0..NEIGHBOURS {
            (above, below) = (above.next_up(), below.next_down());
            nearest.extend([above, below]);
        }
        nearest.retain(|&candidate| self.to_si(candidate) == value);
        nearest.into_iter().min_by_key(|candidate| format!("{candidate:e}").len()).unwrap_or(quotient)
    }
}

/// The greatest common divisor of whole numbers below 2^53, else 1.
fn common_divisor(a: f64, b: f64) -> f64 {
    const EXACT: f64 = 9_007_199_254_740_992.0;
    let whole = |value: f64| value.fract() == 0.0 && (1.0..EXACT).contains(&value);
    if !whole(a) || !whole(b) {
        return 1.0;
    }
    let (mut a, mut b) = (a, b);
    while b != 0.0 {
        (a, b) = (b, a % b);
    }
    a
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::Scale;

    #[test]
    fn whole_quotients_are_in_lowest_terms() {
        assert_eq!(Scale::new(1000.0, 1000.0), Some(Scale::ONE));
        assert_eq!(Scale::new(1000.0, 3600.0), Some(Scale { numerator: 5.0, denominator: 18.0 }));
        assert_eq!(Scale::new(PI, 180.0), Some(Scale { numerator: PI, denominator: 180.0 }));
        assert_eq!(Scale::new(1e308, 1e-308), None);
        assert_eq!(Scale::new(0.0, 1.0), None);
    }

    #[test]
    fn the_units_of_si_change_no_bit() {
        for bits in [0.1f64, -0.0, f64::MIN_POSITIVE / 3.0, f64::MAX, f64::INFINITY, 1.0 / 3.0] {
            assert_eq!(Scale::ONE.to_si(bits).to_bits(), bits.to_bits());
            assert_eq!(Scale::ONE.from_si(bits).to_bits(), bits.to_bits());
        }
    }

    #[test]
    fn up_to_fifteen_digits_come_back_as_they_were() {
        let sizes =
            [(5.0, 18.0), (1.0, 1000.0), (PI, 180.0), (60.0, 1.0), (1.0, 1e6), (463.0, 900.0), (PI, 30.0)];
        let mut state = 1u64;
        for (numerator, denominator) in sizes {
            let scale = Scale::new(numerator, denominator).expect("a size");
            for _ in 0..20_000 {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                let digits = 10u64.pow((state >> 40) as u32 % 15 + 1);
                let whole = (state >> 11) % digits;
                let text = format!("{whole}e-{}", (state >> 33) % 12);
                let value: f64 = text.parse().expect("a number");
                assert_eq!(scale.from_si(scale.to_si(value)), value, "{text} of {numerator}/{denominator}");
            }
        }
    }

    #[test]
    fn what_is_no_number_stays_none() {
        let kmh = Scale::new(5.0, 18.0).expect("a size");
        assert!(kmh.from_si(f64::NAN).is_nan());
        assert_eq!(kmh.from_si(f64::NEG_INFINITY), f64::NEG_INFINITY);
        assert_eq!(kmh.from_si(0.0), 0.0);
    }
}
