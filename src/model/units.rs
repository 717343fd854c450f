//! Units: from the text between the brackets to a dimension and a factor.
//!
//! `unit = factor ((*|/) factor)*`, `factor = (name | 1) (^ integer)?`.

mod table;

use super::dimension::Dimension;
use super::suggest::closest;
use crate::math::Scale;
use table::{Entry, PREFIXES, SPELT, UNITS};

/// What a unit is in SI.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unit {
    /// Its dimension.
    pub dimension: Dimension,
    /// What one unit is in SI.
    pub scale: Scale,
}

impl Unit {
    /// The number one.
    pub const ONE: Unit = Unit { dimension: Dimension::ONE, scale: Scale::ONE };

    /// One over this unit; none if it is beyond all measure.
    pub fn inverse(self) -> Option<Unit> {
        Unit::ONE.times(self, -1)
    }

    fn times(self, other: Unit, exponent: i32) -> Option<Unit> {
        let power = other.dimension.power(i64::from(exponent), 1)?;
        let dimension = self.dimension.times(power)?;
        let above = other.scale.numerator.powi(exponent.abs());
        let below = other.scale.denominator.powi(exponent.abs());
        let (above, below) = if exponent < 0 { (below, above) } else { (above, below) };
        let scale = Scale::new(self.scale.numerator * above, self.scale.denominator * below)?;
        Some(Unit { dimension, scale })
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
    if let Some(unit) = find(name) {
        return Ok(unit);
    }
    if name.is_empty() || name.starts_with(|c: char| c.is_ascii_digit()) {
        return Err(UnitProblem::Malformed { expected: "the name of a unit or `1`", at });
    }
    let lower = name.to_lowercase();
    if matches!(lower.as_str(), "degc" | "degf" | "°c" | "°f" | "celsius" | "fahrenheit") {
        return Err(UnitProblem::Offset { name: name.to_string(), at });
    }
    Err(UnitProblem::Unknown { name: name.to_string(), similar: similar(name), at })
}

/// `1`, a unit of the table, or one with a prefix. A name of the table comes first: `min` is no milli-inch.
fn find(name: &str) -> Option<Unit> {
    if name == "1" {
        return Some(Unit::ONE);
    }
    let unit = |entry: &Entry, above: f64, below: f64| {
        let scale = Scale::new(entry.numerator * above, entry.denominator * below)?;
        Some(Unit { dimension: entry.dimension, scale })
    };
    if let Some(entry) = UNITS.iter().find(|entry| entry.name == name) {
        return unit(entry, 1.0, 1.0);
    }
    PREFIXES.iter().find_map(|(prefix, ten_to_the)| {
        let rest = name.strip_prefix(prefix)?;
        let entry = UNITS.iter().find(|entry| entry.name == rest && entry.prefixed)?;
        let power = 10f64.powi(ten_to_the.abs());
        if *ten_to_the < 0 { unit(entry, 1.0, power) } else { unit(entry, power, 1.0) }
    })
}

/// What was probably meant: a name that is spelt out, a power without its sign, or a unit that is spelt alike.
fn similar(name: &str) -> Option<String> {
    let base = name.trim_end_matches(|c: char| c.is_ascii_digit());
    let spelt = |name: &str| SPELT.iter().find(|(word, _)| *word == name).map(|(_, unit)| unit.to_string());
    if let Some(unit) = spelt(name).or_else(|| spelt(&name.to_lowercase())) {
        return Some(unit);
    }
    if base.len() < name.len() && find(base).is_some() {
        return Some(format!("{base}^{}", &name[base.len()..]));
    }
    let prefixed = UNITS.iter().filter(|entry| entry.prefixed);
    let common = prefixed
        .flat_map(|entry| ["k", "m", "c", "u", "M", "n"].map(|prefix| format!("{prefix}{}", entry.name)));
    let common = common.collect::<Vec<_>>();
    closest(name, UNITS.iter().map(|entry| entry.name).chain(common.iter().map(String::as_str)))
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

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
            assert_eq!(unit.scale.to_si(value), si, "{text}");
            assert_eq!(unit.dimension, Dimension::of(dimension), "{text}");
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
        assert!(matches!(parse("Ym^99*m^99"), Err(UnitProblem::TooLarge { .. })));
        assert!(matches!(parse("kmin"), Err(UnitProblem::Unknown { .. })));
    }

    /// The rows of the table of units in the reference: names, size in SI, dimension, whether prefixes go with it.
    fn documented() -> Vec<(Vec<String>, f64, Dimension, bool)> {
        let text = include_str!("../../docs/LANGUAGE.md");
        let table =
            text.split("| unit | in SI | prefixes | |\n").nth(1).expect("the reference has the table");
        let rows = table.lines().skip(1).take_while(|line| line.starts_with('|'));
        rows.map(|row| {
            let cells = row.split('|').map(str::trim).collect::<Vec<_>>();
            let names = cells[1].split('`').skip(1).step_by(2).map(String::from).collect();
            let (size, unit) = cells[2].split_once(' ').expect("a number and a unit");
            let dimension = parse(unit).expect("a unit").dimension;
            (names, size.parse().expect("a number"), dimension, cells[3] == "yes")
        })
        .collect()
    }

    #[test]
    fn the_reference_shows_the_table_as_it_is() {
        let mut shown = Vec::new();
        for (names, size, dimension, prefixed) in documented() {
            for name in names {
                let unit = parse(&name).expect("the reference names units");
                assert!((unit.scale.factor() / size - 1.0).abs() < 1e-15, "{name}: {}", unit.scale.factor());
                assert_eq!(unit.dimension, dimension, "{name}");
                assert_eq!(
                    UNITS.iter().find(|entry| entry.name == name).map(|entry| entry.prefixed),
                    Some(prefixed)
                );
                shown.push(name);
            }
        }
        let here =
            UNITS.iter().map(|entry| entry.name).filter(|name| *name != "\u{2126}").collect::<Vec<_>>();
        shown.sort_unstable_by_key(|name| here.iter().position(|other| other == name));
        assert_eq!(shown, here);
    }

    #[test]
    fn no_name_has_two_meanings() {
        let mut clashes = Vec::new();
        for entry in UNITS.iter().filter(|entry| entry.prefixed) {
            for (prefix, _) in PREFIXES {
                let name = format!("{prefix}{}", entry.name);
                if UNITS.iter().any(|other| other.name == name) {
                    clashes.push(name);
                }
            }
        }
        clashes.sort_unstable();
        assert_eq!(clashes, [""; 0]);
        let mut names = UNITS.iter().map(|entry| entry.name).collect::<Vec<_>>();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), UNITS.len());
        for (spelt, unit) in SPELT {
            assert!(find(spelt).is_none(), "{spelt} is a unit");
            assert!(parse(unit).is_ok(), "{unit} is none");
        }
    }

    #[test]
    fn what_was_meant_is_suggested() {
        let suggestion = |text| match parse(text) {
            Err(UnitProblem::Unknown { similar, .. }) => similar,
            _ => None,
        };
        for (text, unit) in [
            ("sec", "s"),
            ("Hour", "h"),
            ("kph", "km/h"),
            ("Nm", "N*m"),
            ("m2", "m^2"),
            ("KM", "kM"),
            ("kOhms", "kOhm"),
            ("knots", "kn"),
        ] {
            assert_eq!(suggestion(text).as_deref(), Some(unit), "{text}");
        }
        assert_eq!(suggestion("qwertz"), None);
    }

    #[test]
    fn the_units_of_si_have_the_size_one() {
        for text in [
            "m", "kg", "s", "N", "V", "Ohm", "rad", "kg*m/s^2", "g*km", "mm*km", "1/s", "J/kg/K", "mM",
            "mg/mL",
        ] {
            assert_eq!(parse(text).map(|unit| unit.scale), Ok(Scale::ONE), "{text}");
        }
    }
}
