//! Dimensions: products of rational powers of the seven SI base quantities.
//!
//! Exponents stand over one common denominator, reduced, so that equal dimensions are equal data. A result whose exponents
//! do not fit is none.

use std::fmt;

/// The base units in the order of the exponents.
const BASE: [&str; 7] = ["m", "kg", "s", "A", "K", "mol", "cd"];

/// The order in which they are written: `kg*m/s^2`.
const WRITTEN: [usize; 7] = [1, 0, 2, 3, 4, 5, 6];

/// Dimensions that are written by a name of their own.
const NAMED: [(&str, Dimension); 10] = [
    ("N", Dimension::of([1, 1, -2, 0, 0, 0, 0])),
    ("N*m", Dimension::of([2, 1, -2, 0, 0, 0, 0])),
    ("W", Dimension::of([2, 1, -3, 0, 0, 0, 0])),
    ("Pa", Dimension::of([-1, 1, -2, 0, 0, 0, 0])),
    ("V", Dimension::of([2, 1, -3, -1, 0, 0, 0])),
    ("Ohm", Dimension::of([2, 1, -3, -2, 0, 0, 0])),
    ("F", Dimension::of([-2, -1, 4, 2, 0, 0, 0])),
    ("H", Dimension::of([2, 1, -2, -2, 0, 0, 0])),
    ("T", Dimension::of([0, 1, -2, -1, 0, 0, 0])),
    ("Wb", Dimension::of([2, 1, -2, -1, 0, 0, 0])),
];

/// The largest denominator of an exponent.
const DENOMINATOR_MAX: i64 = 360;

/// A product of powers of m, kg, s, A, K, mol, cd.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct Dimension {
    /// Each over `denominator`.
    exponents: [i16; 7],
    /// Positive; no factor is common to it and all exponents.
    denominator: i16,
}

impl Dimension {
    /// That of a pure number.
    pub const ONE: Dimension = Dimension::of([0; 7]);
    /// That of a time.
    pub const TIME: Dimension = Dimension::of([0, 0, 1, 0, 0, 0, 0]);

    /// Whole exponents of m, kg, s, A, K, mol, cd.
    pub const fn of(exponents: [i8; 7]) -> Dimension {
        let mut wide = [0; 7];
        let mut k = 0;
        while k < 7 {
            wide[k] = exponents[k] as i16;
            k += 1;
        }
        Dimension { exponents: wide, denominator: 1 }
    }

    /// The dimension of a product.
    pub fn times(self, other: Dimension) -> Option<Dimension> {
        self.combined(other, 1)
    }

    /// The dimension of a quotient.
    pub fn over(self, other: Dimension) -> Option<Dimension> {
        self.combined(other, -1)
    }

    fn combined(self, other: Dimension, sign: i64) -> Option<Dimension> {
        let (own, theirs) = (i64::from(self.denominator), i64::from(other.denominator));
        let mut exponents = [0; 7];
        for (sum, (a, b)) in exponents.iter_mut().zip(self.exponents.into_iter().zip(other.exponents)) {
            *sum = i64::from(a) * theirs + sign * i64::from(b) * own;
        }
        Dimension::reduced(exponents, own * theirs)
    }

    /// The dimension of a power; the denominator is positive.
    pub fn power(self, numerator: i64, denominator: i64) -> Option<Dimension> {
        let mut exponents = [0; 7];
        for (product, exponent) in exponents.iter_mut().zip(self.exponents) {
            *product = i64::from(exponent).checked_mul(numerator)?;
        }
        Dimension::reduced(exponents, i64::from(self.denominator).checked_mul(denominator)?)
    }

    /// Whether it can be written as a unit: no exponent is a fraction.
    pub fn is_whole(self) -> bool {
        self.denominator == 1
    }

    fn reduced(exponents: [i64; 7], denominator: i64) -> Option<Dimension> {
        let divisor =
            exponents.iter().fold(denominator, |divisor, &exponent| common_divisor(divisor, exponent));
        let mut narrow = [0; 7];
        for (narrow, exponent) in narrow.iter_mut().zip(exponents) {
            *narrow = i16::try_from(exponent / divisor).ok()?;
        }
        let denominator = denominator / divisor;
        let denominator = i16::try_from(denominator).ok().filter(|_| denominator <= DENOMINATOR_MAX)?;
        Some(Dimension { exponents: narrow, denominator })
    }
}

/// `kg*m/s^2`, `1/s`, `m^(1/2)`; `1` for a pure number.
impl fmt::Display for Dimension {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some((name, _)) = NAMED.iter().find(|(_, dimension)| dimension == self) {
            return f.write_str(name);
        }
        let power = |k: usize| {
            let exponent = i64::from(self.exponents[k]).abs();
            let divisor = common_divisor(exponent, i64::from(self.denominator));
            match (exponent / divisor, i64::from(self.denominator) / divisor) {
                (1, 1) => BASE[k].to_string(),
                (whole, 1) => format!("{}^{whole}", BASE[k]),
                (numerator, denominator) => format!("{}^({numerator}/{denominator})", BASE[k]),
            }
        };
        let above = WRITTEN.into_iter().filter(|&k| self.exponents[k] > 0).map(power).collect::<Vec<_>>();
        let below = WRITTEN.into_iter().filter(|&k| self.exponents[k] < 0).map(power).collect::<Vec<_>>();
        f.write_str(if above.is_empty() { "1" } else { "" })?;
        f.write_str(&above.join("*"))?;
        below.iter().try_for_each(|factor| write!(f, "/{factor}"))
    }
}

/// `in m/s`, `a pure number`.
pub(super) fn in_unit(dimension: Dimension) -> String {
    if dimension == Dimension::ONE { "a pure number".to_string() } else { format!("in {dimension}") }
}

/// The greatest common divisor, at least 1.
fn common_divisor(a: i64, b: i64) -> i64 {
    let (mut a, mut b) = (a.abs(), b.abs());
    while b != 0 {
        (a, b) = (b, a % b);
    }
    a.max(1)
}

/// The fraction with the smallest denominator that rounds to this number within 4 ulp, if its denominator is at most 100.
pub(super) fn simple_fraction(value: f64) -> Option<(i64, i64)> {
    (1..=100i64).find_map(|denominator| {
        let numerator = (value * denominator as f64).round();
        let near = (numerator / denominator as f64 - value).abs() <= 4.0 * f64::EPSILON * value.abs();
        (near && numerator.abs() <= 1e6).then_some((numerator as i64, denominator))
    })
}

#[cfg(test)]
mod tests {
    use super::{Dimension, simple_fraction};

    const SPEED: Dimension = Dimension::of([1, 0, -1, 0, 0, 0, 0]);

    #[test]
    fn powers_and_products_come_back() {
        let root = SPEED.power(1, 2).and_then(|root| root.power(1, 3)).expect("small");
        assert_ne!(root, SPEED);
        assert_eq!(root.power(6, 1), Some(SPEED));
        assert_eq!(root.over(root), Some(Dimension::ONE));
        assert_eq!(SPEED.times(Dimension::TIME).and_then(|length| length.over(Dimension::TIME)), Some(SPEED));
        assert_eq!(SPEED.power(0, 1), Some(Dimension::ONE));
        assert_eq!(SPEED.power(1, 400), None);
        assert_eq!(SPEED.power(40_000, 1), None);
    }

    #[test]
    fn they_are_written_as_people_write_them() {
        let texts = [
            (SPEED, "m/s"),
            (Dimension::ONE, "1"),
            (Dimension::of([0, 0, -1, 0, 0, 0, 0]), "1/s"),
            (Dimension::of([1, 1, -2, 0, 0, 0, 0]), "N"),
            (Dimension::of([0, 1, -2, 0, 0, 0, 0]), "kg/s^2"),
            (Dimension::of([-3, 0, -1, 0, 0, 1, 0]), "mol/m^3/s"),
            (Dimension::of([3, 1, 0, 1, 0, 0, 0]), "kg*m^3*A"),
        ];
        for (dimension, text) in texts {
            assert_eq!(dimension.to_string(), text);
        }
        assert_eq!(SPEED.power(-1, 2).expect("small").to_string(), "s^(1/2)/m^(1/2)");
    }

    #[test]
    fn exponents_that_people_write_are_fractions() {
        assert_eq!(simple_fraction(0.5), Some((1, 2)));
        assert_eq!(simple_fraction(-1.0 / 3.0), Some((-1, 3)));
        assert_eq!(simple_fraction(1.4), Some((7, 5)));
        assert_eq!(simple_fraction((1.4 - 1.0) / 1.4), Some((2, 7)));
        assert_eq!(simple_fraction(0.0), Some((0, 1)));
        assert_eq!(simple_fraction(std::f64::consts::PI), None);
        assert_eq!(simple_fraction(f64::NAN), None);
        assert_eq!(simple_fraction(f64::INFINITY), None);
    }
}
