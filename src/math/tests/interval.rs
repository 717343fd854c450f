//! Intervals: every operator contains its value at every sampled member, WHOLE where it is undefined, tight where promised.

use std::f64::consts::{FRAC_PI_2, PI};

use crate::math::{Interval, Op};

/// Ends and members that sit on branch points, at the edges of domains, or at the limits of the format.
const AWKWARD: [f64; 35] = [
    f64::NEG_INFINITY,
    f64::MIN,
    -1e200,
    -1e10,
    -710.0,
    -7.0,
    -PI,
    -3.0,
    -2.0,
    -FRAC_PI_2,
    -1.0000000000000002,
    -1.0,
    -0.5,
    -1e-20,
    -1e-200,
    -2.2250738585072014e-308,
    -5e-324,
    -0.0,
    0.0,
    5e-324,
    1e-310,
    1e-200,
    1e-20,
    0.41421356237309503,
    0.9999999999999999,
    1.0,
    FRAC_PI_2,
    2.0,
    2.5,
    3.0,
    PI,
    1e5,
    1e200,
    f64::MAX,
    f64::INFINITY,
];

/// A deterministic stream of numbers (xorshift).
struct Stream(u64);

impl Stream {
    fn bits(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }

    fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1u64 << 53) as f64
    }

    fn number(&mut self) -> f64 {
        match self.bits() % 5 {
            0 => AWKWARD[self.bits() as usize % AWKWARD.len()],
            1 => 20.0 * self.unit() - 10.0,
            2 => (self.bits() % 9) as f64 - 4.0,
            3 => 2.0 * self.unit() - 1.0,
            _ => {
                let x = f64::from_bits(self.bits());
                if x.is_nan() { 0.5 } else { x }
            }
        }
    }

    fn interval(&mut self) -> Interval {
        let a = self.number();
        match self.bits() % 4 {
            0 => Interval::point(a),
            1 => {
                let width = self.unit() * 0.1;
                Interval::new(a, a + width)
            }
            _ => {
                let b = self.number();
                Interval::new(a.min(b), a.max(b))
            }
        }
    }

    /// Ends, neighbours of ends, awkward numbers inside, and others; NaN if the interval admits it.
    fn members(&mut self, of: Interval) -> Vec<f64> {
        let mut members = vec![of.lo, of.hi, of.mid()];
        let inner = [of.lo.next_up(), of.hi.next_down(), of.lo + self.unit() * of.width()];
        let awkward = [(); 4].map(|()| AWKWARD[self.bits() as usize % AWKWARD.len()]);
        members.extend(inner.into_iter().chain(awkward).filter(|&x| of.contains(x) && !x.is_nan()));
        if of.is_whole() {
            members.push(f64::NAN);
        }
        members
    }
}

/// Fails unless the image of `args` contains the operator's value at sampled members.
fn check(op: Op, args: &[Interval], stream: &mut Stream) {
    let image = Interval::eval(op, args);
    assert!(image.lo <= image.hi, "{op:?} {args:?} gives {image:?}");
    let members: Vec<Vec<f64>> = args.iter().map(|&arg| stream.members(arg)).collect();
    for &a in &members[0] {
        for &b in members.get(1).unwrap_or(&vec![0.0]) {
            for &c in members.get(2).unwrap_or(&vec![0.0]) {
                let value = op.eval([a, b, c]);
                assert!(
                    image.contains(value),
                    "{op:?} {args:?} gives {image:?} without {value:e} at {a:e}, {b:e}, {c:e}"
                );
            }
        }
    }
}

#[test]
fn images_contain_the_values_of_members_between_awkward_ends() {
    let mut stream = Stream(0x9e37_79b9_7f4a_7c15);
    let ends = |i: usize, j: usize| Interval::new(AWKWARD[i].min(AWKWARD[j]), AWKWARD[i].max(AWKWARD[j]));
    for &op in Op::ALL.iter().filter(|op| op.arity() == 1) {
        for i in 0..AWKWARD.len() {
            (i..AWKWARD.len()).for_each(|j| check(op, &[ends(i, j)], &mut stream));
        }
    }
}

#[test]
fn images_contain_the_values_of_members_at_random() {
    let mut stream = Stream(0x2545_f491_4f6c_dd1d);
    for &op in Op::ALL {
        for _ in 0..6000 {
            let args = [(); 3].map(|()| stream.interval());
            check(op, &args[..op.arity()], &mut stream);
        }
    }
}

#[test]
fn integer_powers_contain_the_values_of_members() {
    let mut stream = Stream(0x1234_5678_9abc_def1);
    for n in [-1023, -65, -4, -3, -2, -1, 0, 1, 2, 3, 4, 5, 6, 7, 8, 31, 64, 1001, i32::MAX, i32::MIN] {
        for _ in 0..400 {
            let (base, exponent) = (stream.interval(), Interval::point(f64::from(n)));
            check(Op::Powi, &[base, exponent], &mut stream);
            check(Op::Pow, &[base, exponent], &mut stream);
        }
    }
}

#[test]
fn rounded_ends_enclose_the_exact_result() {
    let mut stream = Stream(0xfeed_beef_dead_cafe);
    for _ in 0..20_000 {
        let (a, b) = (stream.number(), stream.number());
        let (sum, product) = (a + b, a * b);
        if sum.is_finite() && product.is_finite() {
            let of_b = sum - a;
            let lost = (a - (sum - of_b)) + (b - of_b);
            let image = Interval::point(a).add(Interval::point(b));
            assert!((lost >= 0.0 || image.lo < sum) && (lost <= 0.0 || image.hi > sum), "{a:e} + {b:e}");
            let lost = a.mul_add(b, -product);
            let image = Interval::point(a).mul(Interval::point(b));
            assert!(
                (lost >= 0.0 || image.lo < product) && (lost <= 0.0 || image.hi > product),
                "{a:e} * {b:e}"
            );
        }
    }
}

#[test]
fn undefined_operations_give_whole_and_whole_stays() {
    let i = Interval::new;
    for (op, args) in [
        (Op::Sqrt, [i(-1.0, 2.0), Interval::ONE]),
        (Op::Log, [i(0.0, 2.0), Interval::ONE]),
        (Op::Asin, [i(0.0, 1.0000000000000002), Interval::ONE]),
        (Op::Acosh, [i(0.5, 2.0), Interval::ONE]),
        (Op::Atanh, [i(0.5, 1.0), Interval::ONE]),
        (Op::Tan, [i(1.5, 1.6), Interval::ONE]),
        (Op::Sin, [i(0.0, f64::INFINITY), Interval::ONE]),
        (Op::Div, [Interval::ONE, i(0.0, 1.0)]),
        (Op::Mod, [Interval::ONE, i(-1.0, 1.0)]),
        (Op::Pow, [i(-1.0, 1.0), Interval::point(0.5)]),
        (Op::Pow, [i(0.0, 1.0), i(-1.0, 1.0)]),
        (Op::Powi, [i(-1.0, 1.0), Interval::point(-1.0)]),
    ] {
        assert!(Interval::eval(op, &args[..op.arity()]).is_whole(), "{op:?}");
    }
    for &op in Op::ALL.iter().filter(|&&op| op != Op::Select) {
        let image = Interval::eval(op, &[Interval::WHOLE; 3][..op.arity()]);
        assert_eq!(image, if op.is_boolean() { Interval::MAYBE } else { Interval::WHOLE }, "{op:?}");
    }
    assert_eq!(Interval::point(f64::NAN), Interval::WHOLE);
    assert_eq!(Interval::ONE.select(Interval::ONE, Interval::WHOLE), Interval::ONE);
}

#[test]
fn images_are_tight_where_promised() {
    let i = Interval::new;
    assert_eq!(i(1.0, 2.0).add(i(3.0, 4.0)), i(4.0, 6.0));
    assert_eq!(i(1.0, 1.0).sub(i(1.0, 1.0)), Interval::ZERO);
    assert_eq!(i(0.0, 1.0).mul(i(0.0, 2.0)).lo, 0.0);
    assert_eq!(i(-1.0, 0.0).mul(i(0.0, 2.0)).hi, 0.0);
    assert_eq!(i(-3.0, 2.0).powi(Interval::point(2.0)), i(0.0, 9.0_f64.next_up()));
    assert_eq!(i(-3.0, 2.0).min(i(-1.0, 5.0)), i(-3.0, 2.0));
    assert_eq!(i(-3.0, 2.0).abs(), i(0.0, 3.0));
    assert_eq!(i(0.3, 2.5).floor(), i(0.0, 2.0));
    assert_eq!(i(0.0, 3.0).sin().hi, 1.0);
    assert!(i(0.0, 3.0).sin().lo <= 0.0 && i(0.0, 3.0).sin().lo > -1e-300);
    assert_eq!(i(3.0, 3.3).cos().lo, -1.0);
    assert!(i(3.0, 3.3).cos().hi < -0.98);
    assert_eq!(i(100.0, 107.0).sin(), i(-1.0, 1.0));
    assert!(i(4.2, 4.7).modulo(Interval::point(1.0)).width() < 0.5 + 1e-15);
    assert_eq!(i(4.2, 5.7).modulo(Interval::point(1.0)), i(0.0, 1.0));
    assert!(i(1.0, 2.0).atan2(i(-1.0, 1.0)).width() < PI / 2.0 + 1.0);
    assert_eq!(i(1.0, 2.0).lt(i(2.5, 3.0)), Interval::ONE);
    assert_eq!(i(1.0, 2.0).lt(i(2.0, 3.0)), Interval::MAYBE);
    assert_eq!(i(2.0, 3.0).lt(i(1.0, 2.0)), Interval::ZERO);
}

#[test]
fn helpers_do_what_they_say() {
    let i = Interval::new;
    assert_eq!(i(1.0, 3.0).mid(), 2.0);
    assert_eq!(Interval::WHOLE.mid(), 0.0);
    assert!(i(1.0, f64::INFINITY).mid().is_finite() && i(f64::MAX, f64::INFINITY).mid() == f64::MAX);
    assert_eq!(i(f64::MIN, f64::MAX).mid(), 0.0);
    assert_eq!(i(1.0, 3.0).halves(), (i(1.0, 2.0), i(2.0, 3.0)));
    assert_eq!(i(1.0, 3.0).hull(i(5.0, 6.0)), i(1.0, 6.0));
    assert_eq!(i(1.0, 3.0).intersect(i(2.0, 6.0)), Some(i(2.0, 3.0)));
    assert_eq!(i(1.0, 3.0).intersect(i(4.0, 6.0)), None);
    assert_eq!((i(-4.0, 3.0).mag(), i(-4.0, 3.0).mig(), i(-4.0, -3.0).mig()), (4.0, 0.0, 3.0));
    assert!(!i(1.0, 2.0).contains(f64::NAN) && Interval::WHOLE.contains(f64::NAN));
}
