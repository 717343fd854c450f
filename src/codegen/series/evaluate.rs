//! The evaluator: runs a series over numbers, which are one agent's or those of many in lanes.
//!
//! Every sum goes up in the first factor's index, from its first product on; nothing is contracted or reassociated, so that a
//! lane has the bits that the agent has alone. Everything here is inlined into the callers, which are compiled for what the
//! processor has ([`crate::codegen::series::cpu`]).

use crate::codegen::series::{
    Fixed, FixedId, Instruction, Pair, Recurrence, RowId, SeriesTape, Source, Start,
};
use crate::math::{Numbers, Op};

/// The highest order.
pub const ORDER_MAX: usize = 23;

/// 1 / k.
const INVERSES: [f64; ORDER_MAX + 1] = {
    let mut inverses = [f64::INFINITY; ORDER_MAX + 1];
    let mut k = 1;
    while k <= ORDER_MAX {
        inverses[k] = 1.0 / k as f64;
        k += 1;
    }
    inverses
};

impl SeriesTape {
    /// Works out what does not move into `values`, which has room for it; `load` gives column of slot.
    #[inline(always)]
    pub fn fix_numbers<T: Numbers>(&self, load: impl Fn(u32, u32) -> T, values: &mut [T]) {
        for (k, fixed) in self.fixed.iter().enumerate() {
            values[k] = match *fixed {
                Fixed::Constant(value) => T::all(value),
                Fixed::Load { slot, column } => load(slot, column),
                Fixed::Apply(op, operands) => T::apply(op, operands.map(|id| values[id as usize])),
            };
        }
    }

    /// Works out the coefficients of all states up to `order` >= 1, in 1/s^k, from the states at `time`.
    ///
    /// `rows` holds [`SeriesTape::n_coefficients`], row after row; the states' are the first. What it held is not looked at.
    #[inline(always)]
    pub fn expand_numbers<T: Numbers>(
        &self,
        time: T,
        states: &[T],
        fixed: &[T],
        order: usize,
        rows: &mut [T],
    ) {
        assert!((1..=ORDER_MAX).contains(&order), "an order that no series has");
        let stride = order + 1;
        let mut work = Work { tape: self, time, states, fixed, stride, rows };
        let (before, rest) = self.instructions.split_at(self.cycle.start);
        let (cycle, behind) = rest.split_at(self.cycle.len());
        for (by_rounds, part) in [(false, before), (true, cycle), (false, behind)] {
            // One loop for both orders, so that what it inlines is there once.
            let (outer, inner) = if by_rounds { (stride, part.len()) } else { (part.len(), stride) };
            for i in 0..outer {
                for j in 0..inner {
                    let (round, instruction) = if by_rounds { (i, &part[j]) } else { (j, &part[i]) };
                    let m = round.wrapping_sub(instruction.lag as usize);
                    if m < self.count(instruction, order) {
                        work.run(instruction, m);
                    }
                }
            }
        }
        for state in 0..self.n_states {
            let row = &mut work.rows[state * stride..(state + 1) * stride];
            row.iter_mut().skip(self.lengths[state] as usize).for_each(|c| *c = T::all(0.0));
        }
    }
}

struct Work<'a, T> {
    tape: &'a SeriesTape,
    time: T,
    states: &'a [T],
    fixed: &'a [T],
    stride: usize,
    rows: &'a mut [T],
}

impl<T: Numbers> Work<'_, T> {
    /// The coefficients of a row that can differ from 0; those not made yet hold anything.
    #[inline(always)]
    fn row(&self, row: RowId) -> &[T] {
        let first = row as usize * self.stride;
        let length = self.stride.min(self.tape.lengths[row as usize] as usize);
        &self.rows[first..first + length]
    }

    /// Coefficient m, 0 beyond the row's end.
    #[inline(always)]
    fn at(&self, row: RowId, m: usize) -> T {
        self.row(row).get(m).copied().unwrap_or(T::all(0.0))
    }

    #[inline(always)]
    fn fixed(&self, id: FixedId) -> T {
        self.fixed[id as usize]
    }

    #[inline(always)]
    fn start(&self, start: &Start) -> T {
        let value = |source| match source {
            Source::Fixed(id) => self.fixed(id),
            Source::Row(row) => self.row(row)[0],
        };
        T::apply(start.op, start.operands.map(value))
    }

    #[inline(always)]
    fn write(&mut self, row: RowId, m: usize, value: T) {
        self.rows[row as usize * self.stride + m] = value;
    }

    /// Makes coefficient m of an instruction's row.
    #[inline(always)]
    fn run(&mut self, instruction: &Instruction, m: usize) {
        let to = instruction.to;
        let value = match &instruction.recurrence {
            Recurrence::State { column, rate } => match m {
                0 => self.states[*column as usize],
                _ => scaled(self.row(*rate)[m - 1], INVERSES[m]),
            },
            Recurrence::Time if m == 0 => self.time,
            Recurrence::Time => T::all(1.0),
            Recurrence::Lift(fixed) => self.fixed(*fixed),
            Recurrence::Neg(a) => self.row(*a)[m].map(|a| -a),
            Recurrence::Add(a, b) => match (self.row(*a).get(m), self.row(*b).get(m)) {
                (Some(a), Some(b)) => a.zip(*b, |a, b| a + b),
                (Some(one), None) | (None, Some(one)) => *one,
                (None, None) => T::all(0.0),
            },
            Recurrence::Sub(a, b) => match (self.row(*a).get(m), self.row(*b).get(m)) {
                (Some(a), Some(b)) => a.zip(*b, |a, b| a - b),
                (Some(a), None) => *a,
                (None, Some(b)) => b.map(|b| -b),
                (None, None) => T::all(0.0),
            },
            Recurrence::Shift(a, c) if m == 0 => self.at(*a, 0).zip(self.fixed(*c), |a, c| a + c),
            Recurrence::Shift(a, _) => self.row(*a)[m],
            Recurrence::From(c, a) if m == 0 => self.fixed(*c).zip(self.at(*a, 0), |c, a| c - a),
            Recurrence::From(_, a) => self.row(*a)[m].map(|a| -a),
            Recurrence::Scale(a, c) => self.row(*a)[m].zip(self.fixed(*c), |a, c| a * c),
            Recurrence::Over { a, c, .. } if m == 0 => self.row(*a)[0].zip(self.fixed(*c), |a, c| a / c),
            Recurrence::Over { a, inverse, .. } => {
                self.row(*a)[m].zip(self.fixed(*inverse), |a, inverse| a * inverse)
            }
            Recurrence::Mul(a, b) => product(self.row(*a), self.row(*b), m),
            Recurrence::Square(a) => square(self.row(*a), m),
            Recurrence::Div { a, b, inverse } => {
                let (numerator, b) = (self.at(*a, m), self.row(*b));
                if m == 0 {
                    let (quotient, one_over) = (numerator.zip(b[0], |a, b| a / b), b[0].map(|b| 1.0 / b));
                    self.write(*inverse, 0, one_over);
                    quotient
                } else {
                    let rest = if b.len() == 1 {
                        numerator
                    } else {
                        let sum = product(&b[1..], &self.row(to)[..m], m - 1);
                        numerator.zip(sum, |a, sum| a - sum)
                    };
                    rest.zip(self.row(*inverse)[0], |rest, inverse| rest * inverse)
                }
            }
            Recurrence::Root { a, inverse, start } => {
                if m == 0 {
                    let root = self.start(start);
                    self.write(*inverse, 0, root.map(|root| 0.5 / root));
                    root
                } else {
                    let a = self.at(*a, m);
                    let rest =
                        if m == 1 { a } else { a.zip(square(&self.row(to)[1..m], m - 2), |a, sum| a - sum) };
                    rest.zip(self.row(*inverse)[0], |rest, inverse| rest * inverse)
                }
            }
            Recurrence::Derive(a) => scaled(self.row(*a)[m + 1], (m + 1) as f64),
            Recurrence::Integrate { a, start } => match m {
                0 => self.start(start),
                _ => scaled(self.row(*a)[m - 1], INVERSES[m]),
            },
            Recurrence::Exp { a, start } => match m {
                0 => self.start(start),
                _ => scaled(product(self.row(*a), &self.row(to)[..m], m - 1), INVERSES[m]),
            },
            Recurrence::SinCos { pair, u, a, cosine } => {
                let (s, c) = if m == 0 {
                    let u = self.row(*u)[0];
                    match pair {
                        Pair::Circular => u.sin_cos(),
                        Pair::Hyperbolic => (T::apply(Op::Sinh, [u; 3]), T::apply(Op::Cosh, [u; 3])),
                    }
                } else {
                    let (s, c) = (&self.row(to)[..m], &self.row(*cosine)[..m]);
                    let (s, c) = products(self.row(*a), c, s, m - 1);
                    let sign = match pair {
                        Pair::Circular => -INVERSES[m],
                        Pair::Hyperbolic => INVERSES[m],
                    };
                    (scaled(s, INVERSES[m]), scaled(c, sign))
                };
                self.write(*cosine, m, c);
                s
            }
            Recurrence::Choose(condition, a, b) => {
                self.fixed(*condition).choose(self.at(*a, m), self.at(*b, m))
            }
            Recurrence::Truth(start) => self.start(start),
            Recurrence::Turn { truth, turned, plain } => match m {
                0 => self.row(*truth)[0].choose(self.row(*turned)[0], self.row(*plain)[0]),
                _ => self.at(*plain, m),
            },
        };
        self.write(to, m, value);
    }
}

#[inline(always)]
fn scaled<T: Numbers>(value: T, by: f64) -> T {
    value.map(|value| value * by)
}

/// Coefficient m of a b; there is at least one product.
#[inline(always)]
fn product<T: Numbers>(a: &[T], b: &[T], m: usize) -> T {
    let (first, end) = ((m + 1).saturating_sub(b.len()), a.len().min(m + 1));
    let (a, b) = (&a[first..end], &b[m + 1 - end..m + 1 - first]);
    let last = b.len() - 1;
    let mut sum = a[0].zip(b[last], |a, b| a * b);
    for (a, b) in a[1..].iter().zip(b[..last].iter().rev()) {
        sum = sum.plus_product(a, b);
    }
    sum
}

/// Coefficients m of a b and a c; b and c are equally long.
#[inline(always)]
fn products<T: Numbers>(a: &[T], b: &[T], c: &[T], m: usize) -> (T, T) {
    let (first, end) = ((m + 1).saturating_sub(b.len()), a.len().min(m + 1));
    let others = m + 1 - end..m + 1 - first;
    let (a, b, c) = (&a[first..end], &b[others.clone()], &c[others]);
    let last = b.len() - 1;
    let mut sums = (a[0].zip(b[last], |a, b| a * b), a[0].zip(c[last], |a, c| a * c));
    for (a, (b, c)) in a[1..].iter().zip(b[..last].iter().zip(&c[..last]).rev()) {
        sums = (sums.0.plus_product(a, b), sums.1.plus_product(a, c));
    }
    sums
}

/// Coefficient m of a a: twice the products of what differs, and the square in the middle.
#[inline(always)]
fn square<T: Numbers>(a: &[T], m: usize) -> T {
    let middle = m / 2;
    if m == 0 {
        return a[0].map(|a| a * a);
    }
    let first = (m + 1).saturating_sub(a.len());
    let end = middle + m % 2;
    let own = |sum: Option<T>| {
        let twice = sum.map(|sum| sum.map(|sum| sum + sum));
        match (twice, m % 2) {
            (Some(twice), 1) => twice,
            (Some(twice), _) => twice.plus_product(&a[middle], &a[middle]),
            (None, _) => a[middle].map(|a| a * a),
        }
    };
    if first >= end {
        return own(None);
    }
    let mut sum = a[first].zip(a[m - first], |a, b| a * b);
    for j in first + 1..end {
        sum = sum.plus_product(&a[j], &a[m - j]);
    }
    own(Some(sum))
}
