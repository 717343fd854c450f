//! What an operator costs over 32 lanes, in ns per lane, beside the scalar function called for each.

use std::hint::black_box;

use hyc::math::elementary;
use hyc::math::lanes::Level;
use hyc::math::{Binary, Op, Unary};

use super::median;

/// As many as the callers have.
const N: usize = 32;

/// How many columns are timed together.
const REPEATS: usize = 2_000;

/// The operators worth a line: the elementary functions, and some arithmetic beside them.
const OPERATORS: [Op; 19] = [
    Op::Add,
    Op::Div,
    Op::Sqrt,
    Op::Min,
    Op::Round,
    Op::Powi,
    Op::Sin,
    Op::Cos,
    Op::Exp,
    Op::Log,
    Op::Pow,
    Op::Atan,
    Op::Atan2,
    Op::Cbrt,
    Op::Hypot,
    Op::Mod,
    Op::Tan,
    Op::Tanh,
    Op::Asin,
];

/// Nanoseconds per lane of work over a column.
fn per_lane(mut work: impl FnMut()) -> f64 {
    let all = median(31, || (0..REPEATS).for_each(|_| work()));
    all * 1e9 / (REPEATS * N) as f64
}

/// The operator lane by lane, as machine code calls it or as the compiler writes it.
fn scalar(op: Op, a: &[f64; N], b: &[f64; N]) -> f64 {
    let mut out = [0.0; N];
    let unary: Option<Unary> = op.unary_fn();
    let binary: Option<Binary> = op.binary_fn();
    per_lane(|| {
        for k in 0..N {
            out[k] = match (unary, binary) {
                (Some(call), _) => call(black_box(a[k])),
                (_, Some(call)) => call(black_box(a[k]), b[k]),
                (None, None) => black_box(op).eval([black_box(a[k]), b[k], 0.0]),
            };
        }
        black_box(&mut out);
    })
}

/// The operator over lanes.
fn lanes(level: Level, op: Op, a: &[f64; N], b: &[f64; N]) -> f64 {
    let mut out = [0.0; N];
    per_lane(|| {
        if op.arity() == 1 {
            level.unary(op, black_box(a), &mut out);
        } else {
            level.binary(op, black_box(a), b, &mut out);
        }
        black_box(&mut out);
    })
}

/// A line of the table.
fn row(name: &str, scalar: f64, lanes: impl Iterator<Item = f64>) {
    let lanes: Vec<String> = lanes.map(|time| format!(" {time:.1} |")).collect();
    println!("| {name} | {scalar:.1} |{}", lanes.concat());
}

/// The elementary functions over lanes, at each level that this CPU has.
pub fn table() {
    let levels = Level::available();
    let names: Vec<String> = levels.iter().map(|level| format!(" {} |", level.name())).collect();
    println!("\n| elementary functions over lanes (ns per lane) | scalar |{}", names.concat());
    println!("|---|---|{}", "---|".repeat(levels.len()));
    let a: [f64; N] = std::array::from_fn(|k| 0.02 + 0.03 * k as f64);
    let b: [f64; N] = std::array::from_fn(|k| 2.0 - 0.11 * k as f64);
    for op in OPERATORS {
        let b = if op == Op::Powi { [3.0; N] } else { b };
        row(op.name(), scalar(op, &a, &b), levels.iter().map(|&level| lanes(level, op, &a, &b)));
    }
    let (mut sin, mut cos) = ([0.0; N], [0.0; N]);
    let alone = per_lane(|| {
        for k in 0..N {
            (sin[k], cos[k]) = elementary::sin_cos(black_box(a[k]));
        }
        black_box((&mut sin, &mut cos));
    });
    let together = |level: &Level| {
        let (mut sin, mut cos) = ([0.0; N], [0.0; N]);
        per_lane(|| {
            level.sin_cos(black_box(&a), &mut sin, &mut cos);
            black_box((&mut sin, &mut cos));
        })
    };
    row("sin and cos", alone, levels.iter().map(together));
}
