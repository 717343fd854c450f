//! Units: from the text between the brackets to a dimension and a factor.
//!
//! `unit = factor ((*|/) factor)*`, `factor = (name | 1) (^ integer)?`. The factor is kept as a quotient of two numbers, so
//! that 10 ms is 10*1/1000 = 0.01, correctly rounded. Definitions: the SI brochure, 9th edition, with `g` as the
//! prefixed unit of mass.

use std::f64::consts::PI;

use super::suggest::closest;

/// What a unit is in SI.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unit {
    /// Exponents of m, kg, s, A, K, mol, cd.
    pub dimension: [i8; 7],
    /// One unit is `numerator / denominator` in SI.
    pub numerator: f64,
    /// See `numerator`.
    pub denominator: f64,
}

impl Unit {
    /// The number one.
    pub const ONE: Unit = Unit { dimension: [0; 7], numerator: 1.0, denominator: 1.0 };

    /// One over this unit.
    pub fn inverse(&self) -> Unit {
        let dimension = self.dimension.map(i8::saturating_neg);
        Unit { dimension, numerator: self.denominator, denominator: self.numerator }
    }

    /// A value in this unit, in SI.
    pub fn si(&self, value: f64) -> f64 {
        value * self.numerator / self.denominator
    }

    /// What one unit is in SI.
    pub fn factor(&self) -> f64 {
        self.numerator / self.denominator
    }

    fn times(self, other: Unit, exponent: i32) -> Option<Unit> {
        let mut dimension = self.dimension;
        for (sum, part) in dimension.iter_mut().zip(other.dimension) {
            *sum = i8::try_from(i32::from(*sum) + i32::from(part) * exponent).ok()?;
        }
        let numerator = other.numerator.powi(exponent.abs());
        let denominator = other.denominator.powi(exponent.abs());
        let (numerator, denominator) =
            if exponent < 0 { (denominator, numerator) } else { (numerator, denominator) };
        let unit = Unit {
            dimension,
            numerator: self.numerator * numerator,
            denominator: self.denominator * denominator,
        };
        (unit.factor().is_finite() && unit.factor() > 0.0).then_some(unit)
    }
}

/// Why a text is no unit; `at` is the range of bytes in the text.
#[derive(Clone, Debug, PartialEq)]
pub enum UnitProblem {
    /// A name that is no unit.
    Unknown { name: String, similar: Option<String>, at: (usize, usize) },
    /// A temperature whose zero is not absolute zero.
    Offset { name: String, at: (usize, usize) },
    /// Something else than names, `1`, `*`, `/`, `^` and integers.
    Malformed { expected: &'static str, at: (usize, usize) },
    /// An exponent or a factor beyond all measure.
    TooLarge { at: (usize, usize) },
}

/// Reads the text between the brackets.
pub fn parse(text: &str) -> Result<Unit, UnitProblem> {
    let mut scanner = Scanner { text, at: 0 };
    let mut unit = Unit::ONE;
    let mut sign = 1;
    loop {
        let (start, name) = scanner.name();
        let factor = named(name, (start, start + name.len()))?;
        let exponent = sign * scanner.exponent()?;
        unit = unit.times(factor, exponent).ok_or(UnitProblem::TooLarge { at: (start, scanner.at) })?;
        sign = match scanner.next_symbol() {
            None => return Ok(unit),
            Some('*') => 1,
            Some('/') => -1,
            Some(other) => {
                let end = scanner.at;
                return Err(UnitProblem::Malformed {
                    expected: "`*`, `/` or `^`",
                    at: (end - other.len_utf8(), end),
                });
            }
        };
    }
}

struct Scanner<'t> {
    text: &'t str,
    at: usize,
}

impl<'t> Scanner<'t> {
    fn rest(&self) -> &'t str {
        &self.text[self.at..]
    }

    fn skip_blanks(&mut self) {
        self.at += self.rest().len() - self.rest().trim_start().len();
    }

    fn next_symbol(&mut self) -> Option<char> {
        self.skip_blanks();
        let symbol = self.rest().chars().next()?;
        self.at += symbol.len_utf8();
        Some(symbol)
    }

    fn take(&mut self, belongs: impl Fn(char) -> bool) -> (usize, &'t str) {
        self.skip_blanks();
        let start = self.at;
        let length = self.rest().find(|c: char| !belongs(c)).unwrap_or(self.rest().len());
        self.at += length;
        (start, &self.text[start..self.at])
    }

    fn name(&mut self) -> (usize, &'t str) {
        self.take(|c| c.is_alphanumeric() || matches!(c, '_' | '%' | '°'))
    }

    fn exponent(&mut self) -> Result<i32, UnitProblem> {
        self.skip_blanks();
        if !self.rest().starts_with('^') {
            return Ok(1);
        }
        self.at += 1;
        self.skip_blanks();
        let start = self.at;
        let negative = self.rest().starts_with('-');
        self.at += usize::from(negative);
        let (_, digits) = self.take(|c| c.is_ascii_digit());
        let at = (start, self.at);
        match digits.parse::<i32>() {
            Ok(n) if n <= 99 => Ok(if negative { -n } else { n }),
            Ok(_) => Err(UnitProblem::TooLarge { at }),
            Err(_) if digits.is_empty() => {
                Err(UnitProblem::Malformed { expected: "an integer after `^`", at })
            }
            Err(_) => Err(UnitProblem::TooLarge { at }),
        }
    }
}

fn named(name: &str, at: (usize, usize)) -> Result<Unit, UnitProblem> {
    if name == "1" {
        return Ok(Unit::ONE);
    }
    if let Some(unit) = UNITS.iter().find(|unit| unit.name == name) {
        return Ok(unit.unit());
    }
    for (prefix, ten_to_the) in PREFIXES {
        let Some(rest) = name.strip_prefix(prefix) else { continue };
        if let Some(entry) = UNITS.iter().find(|unit| unit.name == rest && unit.prefixed) {
            let mut unit = entry.unit();
            let power = 10f64.powi(ten_to_the.abs());
            if *ten_to_the < 0 {
                unit.denominator *= power
            } else {
                unit.numerator *= power
            }
            return Ok(unit);
        }
    }
    if name.is_empty() || name.starts_with(|c: char| c.is_ascii_digit()) {
        return Err(UnitProblem::Malformed { expected: "the name of a unit or `1`", at });
    }
    let lower = name.to_lowercase();
    if matches!(lower.as_str(), "degc" | "degf" | "°c" | "°f" | "celsius" | "fahrenheit") {
        return Err(UnitProblem::Offset { name: name.to_string(), at });
    }
    let common =
        ["km", "cm", "mm", "um", "nm", "kg", "mg", "ms", "us", "ns", "kHz", "MHz", "kN", "kW", "kPa", "mV"];
    let similar = closest(name, UNITS.iter().map(|unit| unit.name).chain(common));
    Err(UnitProblem::Unknown { name: name.to_string(), similar, at })
}

struct Entry {
    name: &'static str,
    dimension: [i8; 7],
    numerator: f64,
    denominator: f64,
    prefixed: bool,
}

impl Entry {
    fn unit(&self) -> Unit {
        Unit { dimension: self.dimension, numerator: self.numerator, denominator: self.denominator }
    }
}

const fn si(name: &'static str, dimension: [i8; 7]) -> Entry {
    Entry { name, dimension, numerator: 1.0, denominator: 1.0, prefixed: true }
}

const fn other(name: &'static str, dimension: [i8; 7], numerator: f64, denominator: f64) -> Entry {
    Entry { name, dimension, numerator, denominator, prefixed: false }
}

//                                            m kg  s  A  K mol cd
#[rustfmt::skip]
const UNITS: &[Entry] = &[
    si("m",   [1, 0, 0, 0, 0, 0, 0]),
    Entry { name: "g", dimension: [0, 1, 0, 0, 0, 0, 0], numerator: 1.0, denominator: 1000.0, prefixed: true },
    si("s",   [0, 0, 1, 0, 0, 0, 0]),
    si("A",   [0, 0, 0, 1, 0, 0, 0]),
    si("K",   [0, 0, 0, 0, 1, 0, 0]),
    si("mol", [0, 0, 0, 0, 0, 1, 0]),
    si("cd",  [0, 0, 0, 0, 0, 0, 1]),
    si("Hz",  [0, 0, -1, 0, 0, 0, 0]),
    si("N",   [1, 1, -2, 0, 0, 0, 0]),
    si("J",   [2, 1, -2, 0, 0, 0, 0]),
    si("W",   [2, 1, -3, 0, 0, 0, 0]),
    si("Pa",  [-1, 1, -2, 0, 0, 0, 0]),
    si("C",   [0, 0, 1, 1, 0, 0, 0]),
    si("V",   [2, 1, -3, -1, 0, 0, 0]),
    si("Ohm", [2, 1, -3, -2, 0, 0, 0]),
    si("S",   [-2, -1, 3, 2, 0, 0, 0]),
    si("F",   [-2, -1, 4, 2, 0, 0, 0]),
    si("H",   [2, 1, -2, -2, 0, 0, 0]),
    si("T",   [0, 1, -2, -1, 0, 0, 0]),
    si("Wb",  [2, 1, -2, -1, 0, 0, 0]),
    si("rad", [0, 0, 0, 0, 0, 0, 0]),
    Entry { name: "L", dimension: [3, 0, 0, 0, 0, 0, 0], numerator: 1.0, denominator: 1000.0, prefixed: true },
    Entry { name: "bar", dimension: [-1, 1, -2, 0, 0, 0, 0], numerator: 1e5, denominator: 1.0, prefixed: true },
    other("t",       [0, 1, 0, 0, 0, 0, 0], 1000.0, 1.0),
    other("min",     [0, 0, 1, 0, 0, 0, 0], 60.0, 1.0),
    other("h",       [0, 0, 1, 0, 0, 0, 0], 3600.0, 1.0),
    other("d",       [0, 0, 1, 0, 0, 0, 0], 86400.0, 1.0),
    other("deg",     [0, 0, 0, 0, 0, 0, 0], PI, 180.0),
    other("percent", [0, 0, 0, 0, 0, 0, 0], 1.0, 100.0),
    other("%",       [0, 0, 0, 0, 0, 0, 0], 1.0, 100.0),
];

#[rustfmt::skip]
const PREFIXES: &[(&str, i32)] = &[
    ("Y", 24), ("Z", 21), ("E", 18), ("P", 15), ("T", 12), ("G", 9), ("M", 6), ("k", 3), ("h", 2), ("da", 1),
    ("d", -1), ("c", -2), ("m", -3), ("u", -6), ("µ", -6), ("n", -9), ("p", -12), ("f", -15), ("a", -18),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_have_their_factor_and_dimension() {
        for (text, value, si, dimension) in [
            ("m/s^2", 3.0, 3.0, [1, 0, -2, 0, 0, 0, 0]),
            ("kg*m^2", 2.0, 2.0, [2, 1, 0, 0, 0, 0, 0]),
            ("1/s", 5.0, 5.0, [0, 0, -1, 0, 0, 0, 0]),
            ("ms", 10.0, 0.01, [0, 0, 1, 0, 0, 0, 0]),
            ("km/h", 36.0, 10.0, [1, 0, -1, 0, 0, 0, 0]),
            ("deg", 180.0, PI, [0; 7]),
            ("min", 2.0, 120.0, [0, 0, 1, 0, 0, 0, 0]),
            ("cd", 1.0, 1.0, [0, 0, 0, 0, 0, 0, 1]),
            ("kPa * s", 1.0, 1000.0, [-1, 1, -1, 0, 0, 0, 0]),
            ("mm^-2", 1.0, 1e6, [-2, 0, 0, 0, 0, 0, 0]),
            ("L", 1.0, 1e-3, [3, 0, 0, 0, 0, 0, 0]),
            ("%", 5.0, 0.05, [0; 7]),
            ("1", 5.0, 5.0, [0; 7]),
        ] {
            let unit = parse(text).unwrap_or_else(|problem| panic!("{text}: {problem:?}"));
            assert_eq!(unit.si(value), si, "{text}");
            assert_eq!(unit.dimension, dimension, "{text}");
        }
    }

    #[test]
    fn what_is_no_unit_is_said() {
        assert!(matches!(parse("sec"), Err(UnitProblem::Unknown { at: (0, 3), .. })));
        assert!(matches!(parse("m/degC"), Err(UnitProblem::Offset { at: (2, 6), .. })));
        assert!(matches!(parse(""), Err(UnitProblem::Malformed { .. })));
        assert!(matches!(parse("m//s"), Err(UnitProblem::Malformed { at: (2, 2), .. })));
        assert!(matches!(parse("m^"), Err(UnitProblem::Malformed { .. })));
        assert!(matches!(parse("m s"), Err(UnitProblem::Malformed { at: (2, 3), .. })));
        assert!(matches!(parse("m^999"), Err(UnitProblem::TooLarge { .. })));
        assert!(matches!(parse("m^99*m^99"), Err(UnitProblem::TooLarge { .. })));
        assert!(matches!(parse("kmin"), Err(UnitProblem::Unknown { .. })));
    }
}
