//! Functions by the differential equations that they solve, composed of few recurrences.
//!
//! In: rows and fixed numbers, while a series is recorded. Out: the row of the function. `y = u^r` is y' = r y u' / u,
//! `y = tan u` is y' = u' (1 + y^2), `y = atan2(v, u)` is y' = (u v' - v u') / (u^2 + v^2).

use crate::codegen::series::record::Recorder;
use crate::codegen::series::{FixedId, Pair, Recurrence, RowId, Source, Start};
use crate::math::Op;

impl Recorder<'_> {
    pub(super) fn over(&mut self, a: RowId, c: FixedId, lag: u32) -> RowId {
        let one = self.constant(1.0);
        let inverse = self.apply_fixed(Op::Div, [one, c, one]);
        let to = self.new_row();
        self.push_to(to, lag, Recurrence::Over { a, c, inverse })
    }

    pub(super) fn quotient(&mut self, a: RowId, b: RowId, lag: u32) -> RowId {
        let (to, inverse) = (self.new_row(), self.new_row());
        self.push_to(to, lag, Recurrence::Div { a, b, inverse })
    }

    /// u' / b.
    pub(super) fn rate_over(&mut self, u: RowId, b: RowId) -> RowId {
        let rate = self.derivative(u);
        self.quotient(rate, b, 1)
    }

    pub(super) fn root(&mut self, a: RowId, start: Start) -> RowId {
        let (to, inverse) = (self.new_row(), self.new_row());
        self.push_to(to, 0, Recurrence::Root { a, inverse, start })
    }

    pub(super) fn square_root(&mut self, a: RowId) -> RowId {
        self.root(a, Start { op: Op::Sqrt, operands: [Source::Row(a); 3] })
    }

    /// 1 - u^2 = (1 - u)(1 + u), which is exact to the last bit near its zeros.
    pub(super) fn one_less_square(&mut self, u: RowId) -> RowId {
        let one = self.constant(1.0);
        let (low, high) = (self.push(Recurrence::From(one, u)), self.push(Recurrence::Shift(u, one)));
        self.push(Recurrence::Mul(low, high))
    }

    pub(super) fn pair(&mut self, pair: Pair, u: RowId) -> (RowId, RowId) {
        if let Some(&known) = self.pairs.get(&(u, pair)) {
            return known;
        }
        let a = self.derivative(u);
        let (sine, cosine) = (self.new_row(), self.new_row());
        self.push_to(sine, 0, Recurrence::SinCos { pair, u, a, cosine });
        self.pairs.insert((u, pair), (sine, cosine));
        (sine, cosine)
    }

    /// y' = u' (1 + y^2), or u' (1 - y^2).
    pub(super) fn tangent(&mut self, op: Op, u: RowId, start: Start) -> RowId {
        let (rate, one) = (self.derivative(u), self.constant(1.0));
        let (y, square, slope) = (self.new_row(), self.new_row(), self.new_row());
        let a = self.push_late(Recurrence::Mul(rate, slope));
        self.push_to(y, 0, Recurrence::Integrate { a, start });
        self.push_to(square, 0, Recurrence::Square(y));
        let slope_of =
            if op == Op::Tan { Recurrence::Shift(square, one) } else { Recurrence::From(one, square) };
        self.push_to(slope, 0, slope_of);
        y
    }

    /// y' = r y u' / u.
    pub(super) fn power_with(&mut self, start: Start, u: RowId, r: FixedId) -> RowId {
        let rate = self.derivative(u);
        let y = self.new_row();
        let product = self.push_late(Recurrence::Mul(rate, y));
        let quotient = self.quotient(product, u, 1);
        let a = self.push_late(Recurrence::Scale(quotient, r));
        self.push_to(y, 0, Recurrence::Integrate { a, start })
    }

    pub(super) fn real_power(&mut self, op: Op, u: RowId, r: FixedId) -> RowId {
        let start = Start { op, operands: [Source::Row(u), Source::Fixed(r), Source::Row(u)] };
        self.power_with(start, u, r)
    }

    /// a^b = exp(b log a).
    pub(super) fn general_power(&mut self, op: Op, a: Source, b: RowId) -> RowId {
        let start = Start { op, operands: [a, Source::Row(b), a] };
        let rate = match a {
            Source::Fixed(a) => {
                let (rate, log) = (self.derivative(b), self.apply_fixed(Op::Log, [a; 3]));
                self.push_late(Recurrence::Scale(rate, log))
            }
            Source::Row(a) => {
                let rate = self.rate_over(a, a);
                let start = Start { op: Op::Log, operands: [Source::Row(a); 3] };
                let log = self.push(Recurrence::Integrate { a: rate, start });
                let exponent = self.push(Recurrence::Mul(b, log));
                self.derivative(exponent)
            }
        };
        self.push(Recurrence::Exp { a: rate, start })
    }

    /// In the order of [`crate::math::elementary::powi`].
    pub(super) fn integer_power(&mut self, u: RowId, n: i32) -> RowId {
        let mut bits = n.unsigned_abs();
        let (mut square, mut product) = (u, None);
        while bits != 0 {
            if bits & 1 != 0 {
                product = Some(match product {
                    None => square,
                    Some(product) => self.push(Recurrence::Mul(product, square)),
                });
            }
            bits >>= 1;
            if bits != 0 {
                square = self.push(Recurrence::Square(square));
            }
        }
        let one = self.constant(1.0);
        match product {
            None => self.lift(one),
            Some(product) if n > 0 => product,
            Some(product) => {
                let one = self.lift(one);
                self.quotient(one, product, 0)
            }
        }
    }

    pub(super) fn sum_of_squares(&mut self, a: Source, b: Source) -> RowId {
        match (a, b) {
            (Source::Row(a), Source::Row(b)) => {
                let (a, b) = (self.push(Recurrence::Square(a)), self.push(Recurrence::Square(b)));
                self.push(Recurrence::Add(a, b))
            }
            (Source::Row(a), Source::Fixed(c)) | (Source::Fixed(c), Source::Row(a)) => {
                let (a, c) = (self.push(Recurrence::Square(a)), self.apply_fixed(Op::Mul, [c; 3]));
                self.push(Recurrence::Shift(a, c))
            }
            (Source::Fixed(_), Source::Fixed(_)) => unreachable!("one of the operands moves"),
        }
    }

    /// The angle of (x, y): its rate is (x y' - y x') / (x^2 + y^2).
    pub(super) fn angle(&mut self, y: Source, x: Source) -> RowId {
        let start = Start { op: Op::Atan2, operands: [y, x, y] };
        let below = self.sum_of_squares(y, x);
        let part = |recorder: &mut Self, of: Source, by: Source| match (of, by) {
            (Source::Fixed(_), _) => None,
            (Source::Row(of), Source::Fixed(by)) => {
                let rate = recorder.derivative(of);
                Some(recorder.push_late(Recurrence::Scale(rate, by)))
            }
            (Source::Row(of), Source::Row(by)) => {
                let rate = recorder.derivative(of);
                Some(recorder.push_late(Recurrence::Mul(rate, by)))
            }
        };
        let (up, across) = (part(self, y, x), part(self, x, y));
        let moment = match (up, across) {
            (Some(up), Some(across)) => self.push_late(Recurrence::Sub(up, across)),
            (Some(up), None) => up,
            (None, Some(across)) => self.push_late(Recurrence::Neg(across)),
            (None, None) => unreachable!("one of the operands moves"),
        };
        let a = self.quotient(moment, below, 1);
        self.push(Recurrence::Integrate { a, start })
    }
}
