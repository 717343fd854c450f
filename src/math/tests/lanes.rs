//! Every operator over lanes gives the bits of `Op::eval`, at every level that this CPU has, whatever stands in the other lanes.
//!
//! Unoptimised loops go lane by lane even where AVX is allowed: `cargo test --release --lib lanes` compares vectors.

use crate::math::Op;
use crate::math::elementary;
use crate::math::lanes::{self, Level, Term};

/// A generator of Marsaglia's kind, for inputs only.
struct Random(u64);

impl Random {
    fn bits(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0.wrapping_mul(0x2545_f491_4f6c_dd1d)
    }

    fn below(&mut self, n: usize) -> usize {
        (self.bits() >> 33) as usize % n
    }

    /// In [-1, 1).
    fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / 2f64.powi(52) - 1.0
    }

    /// Of every kind of number one, now and then.
    fn number(&mut self, awkward: &[f64]) -> f64 {
        match self.below(8) {
            0 => f64::from_bits(self.bits()),
            1 => awkward[self.below(awkward.len())],
            2 => (self.unit() * 40.0).round(),
            3 => self.unit() * 800.0,
            4 => 1.0 + self.unit() * 1e-3,
            5 => (self.bits() >> 40) as f64 * std::f64::consts::FRAC_PI_2,
            _ => self.unit() * 10.0,
        }
    }
}

/// Zeros, infinities, NaN, denormals, the limits of every reduction, and the neighbours of each.
fn awkward() -> Vec<f64> {
    let mut centres = vec![
        0.0,
        5e-324,
        f64::MIN_POSITIVE,
        1.0 / 134_217_728.0,
        std::f64::consts::FRAC_1_SQRT_2,
        std::f64::consts::SQRT_2 - 1.0,
        std::f64::consts::SQRT_2,
        1.0,
        0.5,
        1.5,
        2.5,
        3.0,
        709.782712893384,
        710.0,
        745.1332191019412,
        746.0,
        1_600_000.0,
        1e20,
        1e22,
        3.273390607896142e150,
        1.0 / 3.273390607896142e150,
        2f64.powi(31),
        2f64.powi(52),
        2f64.powi(53),
        f64::MAX,
        f64::INFINITY,
    ];
    centres.extend((1..60).map(|k| f64::from(k * k) * std::f64::consts::FRAC_PI_4));
    centres.extend((0..60).map(|k| f64::from(k * 17_003) * std::f64::consts::FRAC_PI_2));
    centres.extend((-1074..1024).step_by(97).map(|exponent| 2f64.powi(exponent)));
    let mut numbers = vec![f64::NAN, -f64::NAN];
    for centre in centres {
        for near in [centre.next_down(), centre, centre.next_up()] {
            numbers.extend([near, -near]);
        }
    }
    numbers
}

/// Equal bits, or both NaN.
fn same(a: f64, b: f64) -> bool {
    a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan())
}

/// Two columns' results against the operator.
fn hold(level: Level, op: Op, a: &[f64], b: &[f64]) {
    let mut out = vec![f64::NAN; a.len()];
    if op.arity() == 1 {
        level.unary(op, a, &mut out);
    } else {
        level.binary(op, a, b, &mut out);
    }
    for ((&a, &b), &got) in a.iter().zip(b).zip(&out) {
        let expected = op.eval([a, b, 0.0]);
        assert!(
            same(got, expected),
            "{}: {} of {a:?}, {b:?} is {got:?}, not {expected:?}",
            level.name(),
            op.name()
        );
    }
}

/// The operators of one and of two operands.
fn operators() -> impl Iterator<Item = Op> {
    Op::ALL.iter().copied().filter(|op| op.arity() < 3)
}

#[test]
fn awkward_numbers_give_the_bits_of_eval() {
    let numbers = awkward();
    for &level in Level::available() {
        for op in operators() {
            // Every number with itself, and with others at several distances.
            for shift in [0, 1, 5, 31, 64, 200] {
                let mut others = numbers.clone();
                others.rotate_left(shift);
                hold(level, op, &numbers, &others);
                if op.arity() == 1 {
                    break;
                }
            }
        }
    }
}

#[test]
fn random_numbers_give_the_bits_of_eval() {
    let awkward = awkward();
    let mut random = Random(0x9e37_79b9_7f4a_7c15);
    for _ in 0..200 {
        let a: [f64; 32] = std::array::from_fn(|_| random.number(&awkward));
        let b: [f64; 32] = std::array::from_fn(|_| random.number(&awkward));
        for &level in Level::available() {
            operators().for_each(|op| hold(level, op, &a, &b));
        }
    }
}

#[test]
fn ordinary_numbers_give_the_bits_of_eval() {
    let mut random = Random(7);
    for round in 0..200 {
        let size = [1.0, 30.0, 700.0, 1e6][round % 4];
        let a: [f64; 32] = std::array::from_fn(|_| random.unit().abs() * size);
        let b: [f64; 32] = std::array::from_fn(|_| random.unit() * size);
        for &level in Level::available() {
            operators().for_each(|op| hold(level, op, &a, &b));
            operators().filter(|op| op.arity() == 1).for_each(|op| hold(level, op, &b, &a));
        }
    }
}

#[test]
fn columns_of_any_length_give_the_bits_of_eval() {
    let awkward = awkward();
    let mut random = Random(11);
    for n in 0..70 {
        let a: Vec<f64> = (0..n).map(|_| random.number(&awkward)).collect();
        let b: Vec<f64> = (0..n).map(|_| random.number(&awkward)).collect();
        for &level in Level::available() {
            operators().for_each(|op| hold(level, op, &a, &b));
        }
    }
}

#[test]
fn one_integer_exponent_for_all_lanes_keeps_the_order_of_roundings() {
    let mut random = Random(13);
    let a: [f64; 37] = std::array::from_fn(|_| random.unit() * 2.0);
    for n in [
        0.0,
        -0.0,
        1.0,
        2.0,
        3.0,
        7.0,
        100.0,
        -1.0,
        -6.0,
        2_147_483_647.0,
        -2_147_483_648.0,
        2_147_483_648.0,
        0.5,
    ] {
        for &level in Level::available() {
            hold(level, Op::Powi, &a, &[n; 37]);
        }
    }
}

#[test]
fn sine_and_cosine_together_are_those_apart_and_a_choice_is_that_of_eval() {
    let numbers = awkward();
    let n = numbers.len();
    for &level in Level::available() {
        let (mut sin, mut cos, mut chosen) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
        level.sin_cos(&numbers, &mut sin, &mut cos);
        let swapped: Vec<f64> = numbers.iter().rev().copied().collect();
        level.select(&numbers, &sin, &swapped, &mut chosen);
        for (k, &x) in numbers.iter().enumerate() {
            let (sine, cosine) = elementary::sin_cos(x);
            assert!(same(sin[k], sine) && same(cos[k], cosine), "{}: at {x:?}", level.name());
            assert!(same(sine, Op::Sin.eval([x; 3])) && same(cosine, Op::Cos.eval([x; 3])), "at {x:?}");
            let choice = Op::Select.eval([x, sine, swapped[k]]);
            assert!(same(chosen[k], choice), "{}: select at {x:?}", level.name());
        }
    }
}

#[test]
fn without_a_level_the_best_one_works() {
    assert_eq!(Level::available().first(), Some(&Level::BASELINE));
    assert_eq!(Level::available().last(), Some(&Level::best()));
    let (a, b) = ([0.25, -3.0, 2e9], [1.0, 0.0, -2.0]);
    let (mut one, mut two, mut three) = ([0.0; 3], [0.0; 3], [0.0; 3]);
    lanes::unary(Op::Exp, &a, &mut one);
    lanes::binary(Op::Atan2, &a, &b, &mut two);
    lanes::select(&b, &a, &one, &mut three);
    for k in 0..3 {
        assert!(same(one[k], Op::Exp.eval([a[k]; 3])) && same(two[k], Op::Atan2.eval([a[k], b[k], 0.0])));
        assert!(same(three[k], Op::Select.eval([b[k], a[k], one[k]])));
    }
    lanes::sin_cos(&a, &mut one, &mut two);
    for k in 0..3 {
        assert!(same(one[k], Op::Sin.eval([a[k]; 3])) && same(two[k], Op::Cos.eval([a[k]; 3])));
    }
}

#[test]
fn combinations_are_added_from_left_to_right() {
    let mut random = Random(17);
    for n in [1, 7, 8, 32, 45] {
        let mut column = || (0..n).map(|_| random.unit()).collect::<Vec<f64>>();
        let (x, h) = (column(), column());
        let columns: Vec<(f64, Vec<f64>)> = (0..7).map(|k| (0.1 * f64::from(k) - 0.35, column())).collect();
        for n_terms in 0..=7 {
            let terms: Vec<Term<'_>> =
                columns[..n_terms].iter().map(|(weight, column)| Term { weight: *weight, column }).collect();
            for &level in Level::available() {
                let (mut change, mut end) = (vec![0.0; n], vec![0.0; n]);
                level.combination(&h, &terms, &mut change);
                level.advance(&x, &h, &terms, &mut end);
                for lane in 0..n {
                    let mut products =
                        columns[..n_terms].iter().map(|(weight, column)| weight * column[lane]);
                    let first = products.next().unwrap_or(0.0);
                    let expected = h[lane] * products.fold(first, |sum, product| sum + product);
                    assert!(same(change[lane], expected), "{}: {n_terms} terms", level.name());
                    assert!(same(end[lane], x[lane] + expected), "{}: {n_terms} terms", level.name());
                }
            }
        }
    }
}
