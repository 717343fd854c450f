//! The units by name, and the prefixes: SI brochure, 9th edition; constants of nature by CODATA 2022; `docs/LANGUAGE.md` shows
//! the same table.

use std::f64::consts::PI;

use crate::model::dimension::Dimension;

/// A named unit.
pub(super) struct Entry {
    /// As it is written.
    pub name: &'static str,
    /// Its dimension.
    pub dimension: Dimension,
    /// It is `numerator / denominator` in SI.
    pub numerator: f64,
    /// See `numerator`.
    pub denominator: f64,
    /// Whether prefixes may stand before it.
    pub prefixed: bool,
}

const fn coherent(name: &'static str, exponents: [i8; 7]) -> Entry {
    prefixed(name, exponents, 1.0, 1.0)
}

const fn prefixed(name: &'static str, exponents: [i8; 7], numerator: f64, denominator: f64) -> Entry {
    Entry { name, dimension: Dimension::of(exponents), numerator, denominator, prefixed: true }
}

const fn plain(name: &'static str, exponents: [i8; 7], numerator: f64, denominator: f64) -> Entry {
    Entry { name, dimension: Dimension::of(exponents), numerator, denominator, prefixed: false }
}

//                         m kg  s  A  K mol cd
const NUMBER: [i8; 7] = [0, 0, 0, 0, 0, 0, 0];
const LENGTH: [i8; 7] = [1, 0, 0, 0, 0, 0, 0];
const AREA: [i8; 7] = [2, 0, 0, 0, 0, 0, 0];
const VOLUME: [i8; 7] = [3, 0, 0, 0, 0, 0, 0];
const MASS: [i8; 7] = [0, 1, 0, 0, 0, 0, 0];
const TIME: [i8; 7] = [0, 0, 1, 0, 0, 0, 0];
const PER_TIME: [i8; 7] = [0, 0, -1, 0, 0, 0, 0];
const SPEED: [i8; 7] = [1, 0, -1, 0, 0, 0, 0];
const ACCELERATION: [i8; 7] = [1, 0, -2, 0, 0, 0, 0];
const FORCE: [i8; 7] = [1, 1, -2, 0, 0, 0, 0];
const PRESSURE: [i8; 7] = [-1, 1, -2, 0, 0, 0, 0];
const ENERGY: [i8; 7] = [2, 1, -2, 0, 0, 0, 0];
const CHARGE: [i8; 7] = [0, 0, 1, 1, 0, 0, 0];

/// Every unit once, without prefixes.
#[rustfmt::skip]
pub(super) const UNITS: &[Entry] = &[
    // SI base units; the prefixes of mass stand before the gram
    coherent("m",   LENGTH),
    prefixed("g",   MASS, 1.0, 1e3),
    coherent("s",   TIME),
    coherent("A",   [0, 0, 0, 1, 0, 0, 0]),
    coherent("K",   [0, 0, 0, 0, 1, 0, 0]),
    coherent("mol", [0, 0, 0, 0, 0, 1, 0]),
    coherent("cd",  [0, 0, 0, 0, 0, 0, 1]),
    // SI units with names of their own
    coherent("rad", NUMBER),
    coherent("sr",  NUMBER),
    coherent("Hz",  PER_TIME),
    coherent("N",   FORCE),
    coherent("Pa",  PRESSURE),
    coherent("J",   ENERGY),
    coherent("W",   [2, 1, -3, 0, 0, 0, 0]),
    coherent("C",   CHARGE),
    coherent("V",   [2, 1, -3, -1, 0, 0, 0]),
    coherent("F",   [-2, -1, 4, 2, 0, 0, 0]),
    coherent("Ohm", [2, 1, -3, -2, 0, 0, 0]),
    coherent("ohm", [2, 1, -3, -2, 0, 0, 0]),
    coherent("Ω",   [2, 1, -3, -2, 0, 0, 0]),
    coherent("\u{2126}", [2, 1, -3, -2, 0, 0, 0]),
    coherent("S",   [-2, -1, 3, 2, 0, 0, 0]),
    coherent("Wb",  [2, 1, -2, -1, 0, 0, 0]),
    coherent("T",   [0, 1, -2, -1, 0, 0, 0]),
    coherent("H",   [2, 1, -2, -2, 0, 0, 0]),
    coherent("lm",  [0, 0, 0, 0, 0, 0, 1]),
    coherent("lx",  [-2, 0, 0, 0, 0, 0, 1]),
    coherent("Bq",  PER_TIME),
    coherent("Gy",  [2, 0, -2, 0, 0, 0, 0]),
    coherent("Sv",  [2, 0, -2, 0, 0, 0, 0]),
    coherent("kat", [0, 0, -1, 0, 0, 1, 0]),
    // time
    plain("min",  TIME, 60.0, 1.0),
    plain("h",    TIME, 3600.0, 1.0),
    plain("d",    TIME, 86_400.0, 1.0),
    plain("week", TIME, 604_800.0, 1.0),
    plain("yr",   TIME, 31_557_600.0, 1.0),
    // angles and turns
    plain("deg",    NUMBER, PI, 180.0),
    plain("°",      NUMBER, PI, 180.0),
    plain("arcmin", NUMBER, PI, 10_800.0),
    plain("arcsec", NUMBER, PI, 648_000.0),
    plain("rev",    NUMBER, 2.0 * PI, 1.0),
    plain("rpm",    PER_TIME, PI, 30.0),
    // lengths, areas, volumes
    plain("inch", LENGTH, 254.0, 1e4),
    plain("ft",   LENGTH, 3048.0, 1e4),
    plain("yd",   LENGTH, 9144.0, 1e4),
    plain("mi",   LENGTH, 1_609_344.0, 1e3),
    plain("nmi",  LENGTH, 1852.0, 1.0),
    plain("NM",   LENGTH, 1852.0, 1.0),
    plain("ha",   AREA, 1e4, 1.0),
    prefixed("L", VOLUME, 1.0, 1e3),
    prefixed("l", VOLUME, 1.0, 1e3),
    // speeds and accelerations
    plain("kn",  SPEED, 1852.0, 3600.0),
    plain("mph", SPEED, 1_609_344.0, 3.6e6),
    plain("g0",  ACCELERATION, 980_665.0, 1e5),
    // masses and forces
    plain("t",     MASS, 1e3, 1.0),
    plain("lb",    MASS, 45_359_237.0, 1e8),
    plain("lbf",   FORCE, 44_482_216_152_605.0, 1e13),
    prefixed("Da", MASS, 1.660_539_068_92, 1e27),
    // pressures
    prefixed("bar", PRESSURE, 1e5, 1.0),
    plain("atm",    PRESSURE, 101_325.0, 1.0),
    plain("Torr",   PRESSURE, 101_325.0, 760.0),
    plain("mmHg",   PRESSURE, 133_322_387_415.0, 1e9),
    plain("psi",    PRESSURE, 44_482_216_152_605.0, 6_451_600_000.0),
    // energies and charges
    prefixed("eV",  ENERGY, 1.602_176_634, 1e19),
    prefixed("Wh",  ENERGY, 3600.0, 1.0),
    prefixed("cal", ENERGY, 4184.0, 1e3),
    prefixed("Ah",  CHARGE, 3600.0, 1.0),
    // concentration
    prefixed("M", [-3, 0, 0, 0, 0, 1, 0], 1e3, 1.0),
    // numbers
    plain("%",         NUMBER, 1.0, 100.0),
    plain("percent",   NUMBER, 1.0, 100.0),
    plain("ppm",       NUMBER, 1.0, 1e6),
    plain("molecule",  NUMBER, 1.0, 1.0),
    plain("molecules", NUMBER, 1.0, 1.0),
    plain("cell",      NUMBER, 1.0, 1.0),
    plain("cells",     NUMBER, 1.0, 1.0),
    plain("veh",       NUMBER, 1.0, 1.0),
];

/// The prefixes with their powers of ten; `µ` in both of its characters, and as `u`.
#[rustfmt::skip]
pub(super) const PREFIXES: &[(&str, i32)] = &[
    ("Q", 30), ("R", 27), ("Y", 24), ("Z", 21), ("E", 18), ("P", 15), ("T", 12), ("G", 9), ("M", 6), ("k", 3), ("h", 2),
    ("da", 1), ("d", -1), ("c", -2), ("m", -3), ("u", -6), ("µ", -6), ("μ", -6), ("n", -9), ("p", -12), ("f", -15),
    ("a", -18), ("z", -21), ("y", -24), ("r", -27), ("q", -30),
];

/// What people write, and its unit.
#[rustfmt::skip]
pub(super) const SPELT: &[(&str, &str)] = &[
    ("sec", "s"), ("ss", "s^2"), ("secs", "s"), ("second", "s"), ("seconds", "s"),
    ("minute", "min"), ("minutes", "min"), ("mins", "min"), ("hr", "h"), ("hrs", "h"), ("hour", "h"), ("hours", "h"),
    ("day", "d"), ("days", "d"), ("weeks", "week"), ("wk", "week"), ("year", "yr"), ("years", "yr"),
    ("meter", "m"), ("meters", "m"), ("metre", "m"), ("metres", "m"), ("kilometer", "km"), ("kilometers", "km"),
    ("kilometre", "km"), ("kilometres", "km"), ("micron", "um"), ("in", "inch"), ("inches", "inch"), ("foot", "ft"),
    ("feet", "ft"), ("mile", "mi"), ("miles", "mi"), ("yard", "yd"), ("knot", "kn"), ("knots", "kn"), ("kt", "kn"),
    ("kts", "kn"), ("kph", "km/h"), ("kmh", "km/h"), ("kmph", "km/h"), ("mps", "m/s"), ("fps", "ft/s"),
    ("gram", "g"), ("grams", "g"), ("kilogram", "kg"), ("kilograms", "kg"), ("tonne", "t"), ("ton", "t"), ("lbs", "lb"),
    ("newton", "N"), ("Nm", "N*m"), ("joule", "J"), ("joules", "J"), ("watt", "W"), ("watts", "W"), ("volt", "V"),
    ("volts", "V"), ("ampere", "A"), ("amp", "A"), ("amps", "A"), ("farad", "F"), ("henry", "H"), ("tesla", "T"),
    ("pascal", "Pa"), ("kelvin", "K"), ("hertz", "Hz"), ("liter", "L"), ("litre", "L"), ("liters", "L"), ("litres", "L"),
    ("cc", "cm^3"), ("sqm", "m^2"), ("degree", "deg"), ("degrees", "deg"), ("radian", "rad"), ("radians", "rad"),
    ("rps", "rev/s"), ("molar", "M"), ("mole", "mol"), ("moles", "mol"), ("dalton", "Da"), ("pct", "percent"),
];
