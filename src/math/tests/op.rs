//! The meaning of the operators where IEEE 754 or taste leaves a choice, and the tables around them.

use std::collections::HashSet;

use crate::math::Op;

const AWKWARD: [f64; 16] = [
    0.0,
    -0.0,
    5e-324,
    -5e-324,
    2.225e-308,
    0.5,
    -0.5,
    1.0,
    -1.0,
    2.5,
    -3.0,
    4_503_599_627_370_497.5,
    1.7e308,
    f64::INFINITY,
    f64::NEG_INFINITY,
    f64::NAN,
];

/// Equal bits, or both NaN.
fn same(a: f64, b: f64) -> bool {
    a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan())
}

fn one(op: Op, a: f64) -> f64 {
    op.eval([a, f64::NAN, f64::NAN])
}

fn two(op: Op, a: f64, b: f64) -> f64 {
    op.eval([a, b, f64::NAN])
}

#[test]
fn the_table_is_complete_and_names_are_unique() {
    assert_eq!(Op::ALL.len(), Op::Select as usize + 1);
    assert!(Op::ALL.iter().enumerate().all(|(place, &op)| op as usize == place));
    let names: HashSet<_> = Op::ALL.iter().map(|op| op.name()).collect();
    assert_eq!(names.len(), Op::ALL.len());
}

#[test]
fn callable_functions_give_the_bits_of_eval() {
    for &op in Op::ALL {
        assert!(op.unary_fn().is_none() || op.arity() == 1);
        assert!(op.binary_fn().is_none() || op.arity() == 2);
        for a in AWKWARD {
            if let Some(call) = op.unary_fn() {
                assert!(same(call(a), one(op, a)), "{op:?} {a}");
            }
            for b in AWKWARD {
                if let Some(call) = op.binary_fn() {
                    assert!(same(call(a, b), two(op, a, b)), "{op:?} {a} {b}");
                }
            }
        }
    }
}

#[test]
fn booleans_are_zero_or_one() {
    for &op in Op::ALL.iter().filter(|op| op.is_boolean()) {
        for (a, b) in AWKWARD.iter().flat_map(|&a| AWKWARD.map(|b| (a, b))) {
            let value = two(op, a, b);
            assert!(same(value, 0.0) || same(value, 1.0), "{op:?} {a} {b}");
        }
    }
    let nan = f64::NAN;
    for (op, truth) in [(Op::Lt, 0.0), (Op::Le, 0.0), (Op::Eq, 0.0), (Op::Ne, 1.0)] {
        assert_eq!(two(op, nan, 1.0), truth);
        assert_eq!(two(op, nan, nan), truth);
    }
    assert_eq!(two(Op::Eq, 0.0, -0.0), 1.0);
    assert_eq!((one(Op::Not, -0.0), one(Op::Not, nan)), (1.0, 0.0));
    assert_eq!(Op::Select.eval([-0.0, 1.0, 2.0]), 2.0);
    assert_eq!(Op::Select.eval([nan, 1.0, 2.0]), 1.0);
}

#[test]
fn minimum_and_maximum_order_the_zeros_and_keep_nan() {
    for (a, b) in [(0.0, -0.0), (-0.0, 0.0)] {
        assert!(same(two(Op::Min, a, b), -0.0));
        assert!(same(two(Op::Max, a, b), 0.0));
    }
    for a in AWKWARD {
        for op in [Op::Min, Op::Max] {
            assert!(two(op, a, f64::NAN).is_nan() && two(op, f64::NAN, a).is_nan());
            assert!(same(two(op, a, a), a));
        }
    }
}

#[test]
fn sign_and_round_treat_zero_and_halves_as_said() {
    assert!(same(one(Op::Sign, -0.0), 0.0) && same(one(Op::Sign, 0.0), 0.0));
    assert_eq!((one(Op::Sign, -5e-324), one(Op::Sign, f64::INFINITY)), (-1.0, 1.0));
    assert!(one(Op::Sign, f64::NAN).is_nan());
    for (x, rounded) in
        [(0.5, 1.0), (-0.5, -1.0), (1.5, 2.0), (2.5, 3.0), (0.49999999999999994, 0.0), (-0.2, -0.0)]
    {
        assert!(same(one(Op::Round, x), rounded), "{x}");
    }
}

#[test]
fn remainder_has_the_sign_of_the_divisor() {
    for (a, b, rest) in [
        (7.0, 3.0, 1.0),
        (-7.0, 3.0, 2.0),
        (7.0, -3.0, -2.0),
        (-7.0, -3.0, -1.0),
        (6.0, 3.0, 0.0),
        (-6.0, 3.0, 0.0),
        (6.0, -3.0, -0.0),
        (-1e-20, 1.0, 0.9999999999999999),
        (1e-20, -1.0, -0.9999999999999999),
        (2.0, f64::INFINITY, 2.0),
        (-2.0, f64::INFINITY, f64::INFINITY),
        (1.0, 0.0, f64::NAN),
        (f64::INFINITY, 3.0, f64::NAN),
    ] {
        assert!(same(two(Op::Mod, a, b), rest), "{a} mod {b}");
    }
    for (a, b) in AWKWARD.iter().flat_map(|&a| AWKWARD.map(|b| (a, b))) {
        let rest = two(Op::Mod, a, b);
        if b.is_finite() && !rest.is_nan() {
            assert!(if b > 0.0 { (0.0..b).contains(&rest) } else { b < rest && rest <= 0.0 }, "{a} mod {b}");
        }
    }
}

#[test]
fn integer_powers_multiply_in_a_fixed_order() {
    let x = 1.1_f64;
    let (square, fourth) = (x * x, (x * x) * (x * x));
    assert!(same(two(Op::Powi, x, 2.0), square));
    assert!(same(two(Op::Powi, x, 3.0), x * square));
    assert!(same(two(Op::Powi, x, 6.0), square * fourth));
    assert!(same(two(Op::Powi, x, 7.0), (x * square) * fourth));
    assert!(same(two(Op::Powi, x, -3.0), 1.0 / (x * square)));
    assert_eq!(two(Op::Powi, f64::NAN, 0.0), 1.0);
    assert!(same(two(Op::Powi, -0.0, -1.0), f64::NEG_INFINITY));
    assert_eq!(two(Op::Powi, -1.0, f64::from(i32::MIN)), 1.0);
    assert_eq!(two(Op::Powi, -1.0, f64::from(i32::MAX)), -1.0);
    assert!(same(two(Op::Powi, 2.0, 0.5), two(Op::Pow, 2.0, 0.5)));
}
