//! Every elementary function against exact values (`reference.py` writes them), in units in the last place.

use crate::math::Op;

/// A function, its table, and the largest error allowed.
struct Case {
    op: Op,
    table: &'static str,
    bound: f64,
}

macro_rules! case {
    ($op:ident, $file:literal, $bound:expr) => {
        Case { op: Op::$op, table: include_str!(concat!("reference/", $file, ".csv")), bound: $bound }
    };
}

/// Allows for the four decimals of a table's last column.
const NEAREST: f64 = 0.5001;

const CASES: [Case; 20] = [
    case!(Sin, "sin", 1.0),
    case!(Cos, "cos", 1.0),
    case!(Exp, "exp", 1.0),
    case!(Log, "log", 1.0),
    case!(Pow, "pow", 1.0),
    case!(Atan, "atan", 1.0),
    case!(Atan2, "atan2", 1.0),
    case!(Cbrt, "cbrt", 1.0),
    case!(Hypot, "hypot", 1.0),
    case!(Tan, "tan", NEAREST),
    case!(Asin, "asin", NEAREST),
    case!(Acos, "acos", NEAREST),
    case!(Sinh, "sinh", NEAREST),
    case!(Cosh, "cosh", NEAREST),
    case!(Tanh, "tanh", NEAREST),
    case!(Asinh, "asinh", NEAREST),
    case!(Acosh, "acosh", NEAREST),
    case!(Atanh, "atanh", NEAREST),
    case!(Log2, "log2", NEAREST),
    case!(Log10, "log10", NEAREST),
];

/// The distance from the exact value `nearest + excess ulp(nearest)`; infinite where NaN, infinity or a zero's sign differ.
fn error(got: f64, nearest: f64, excess: f64) -> f64 {
    if nearest.is_nan() || got.is_nan() {
        return if nearest.is_nan() && got.is_nan() { 0.0 } else { f64::INFINITY };
    }
    if got.is_sign_negative() != nearest.is_sign_negative() {
        return f64::INFINITY;
    }
    if nearest.is_infinite() || got.is_infinite() {
        return if got == nearest { 0.0 } else { f64::INFINITY };
    }
    let exponent = ((nearest.abs().to_bits() >> 52) as i32).max(1) - 1075;
    // Scaled by a power of two in two steps, so that the difference of denormals is not lost.
    let scaled = (got - nearest) * 2f64.powi(-exponent / 2) * 2f64.powi(-exponent - (-exponent / 2));
    (scaled - excess).abs()
}

#[test]
fn elementary_functions_are_within_their_bounds() {
    for Case { op, table, bound } in CASES {
        let mut worst = (0.0, String::new());
        for row in table.lines() {
            let cells: Vec<f64> = row.split(',').map(|cell| cell.parse().unwrap()).collect();
            let (inputs, expected) = cells.split_at(op.arity());
            let mut args = [0.0; 3];
            args[..inputs.len()].copy_from_slice(inputs);
            let got = op.eval(args);
            let off = error(got, expected[0], expected[1]);
            if off > worst.0 {
                worst = (off, format!("{inputs:?} gives {got:?}, not {:?}", expected[0]));
            }
        }
        println!("{:6} {:.4} ulp: {}", op.name(), worst.0, worst.1);
        assert!(worst.0 <= bound, "{}: {} ulp: {}", op.name(), worst.0, worst.1);
    }
}

#[test]
fn huge_angles_join_the_moderate_ones() {
    // sin^2 + cos^2 = 1 and the double angle hold on both sides of the reductions' seam.
    for step in -40..40 {
        let x = 1_600_000.0 + 0.37 * f64::from(step);
        let (sine, cosine) = (Op::Sin.eval([x, 0.0, 0.0]), Op::Cos.eval([x, 0.0, 0.0]));
        assert!((sine * sine + cosine * cosine - 1.0).abs() < 4e-16, "at {x}");
        let doubled = Op::Sin.eval([2.0 * x, 0.0, 0.0]);
        assert!((doubled - 2.0 * sine * cosine).abs() < 4e-16, "at {x}");
    }
}
