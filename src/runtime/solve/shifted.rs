//! The linear systems of a stiff step: (s I - J) u = r for one shift s > 0 and several right-hand sides.
//!
//! In: the Jacobian by its entries. Entries that are not finite (the slope of a square root at zero) count as zero: the step
//! is then explicit in that direction, and its error estimate says what it is worth. A Jacobian whose entries can be brought
//! near its diagonal is decomposed within its band, where that takes less than half of the operations; any other by a dense
//! LU decomposition. Both exchange rows.

use nalgebra::{DMatrix, DMatrixViewMut, Dyn, LU};

use crate::runtime::solve::banded::Banded;
use crate::runtime::solve::cuthill_mckee;
use crate::runtime::solve::jacobian::Jacobian;

/// s I - J, decomposed.
#[derive(Clone, Debug)]
pub enum Shifted {
    /// As it is.
    Dense(LU<f64, Dyn, Dyn>),
    /// In another order of the equations.
    Banded(Vec<usize>, Banded),
}

/// Up to so many equations no other order is looked for: a dense decomposition takes no longer than that.
const FEW: usize = 32;

/// How systems of one pattern of entries are decomposed; made once for all that come one after the other.
#[derive(Clone, Debug, Default)]
pub struct Plan {
    n: usize,
    /// Rows and columns of the entries.
    pattern: Vec<(usize, usize)>,
    /// The order of the equations, and how far below and above the diagonal entries lie; none: dense.
    band: Option<(Vec<usize>, (usize, usize))>,
}

impl Plan {
    /// Makes it one for this Jacobian.
    pub fn suit(&mut self, jacobian: &Jacobian) {
        let pattern = jacobian.entries.iter().map(|entry| (entry.row, entry.column));
        if self.n == jacobian.n && pattern.clone().eq(self.pattern.iter().copied()) {
            return;
        }
        self.n = jacobian.n;
        self.pattern.clear();
        self.pattern.extend(pattern);
        self.band = None;
        if self.n > FEW {
            let order = cuthill_mckee::order(jacobian);
            let widths = cuthill_mckee::widths(jacobian, &order);
            if 2 * Banded::operations(self.n, widths, 1) < dense_operations(self.n, 1) {
                self.band = Some((order, widths));
            }
        }
    }

    /// How many operations it takes to decompose, and to solve for so many right-hand sides.
    pub fn operations(&self, n_rhs: u64) -> u64 {
        match &self.band {
            Some((_, widths)) => Banded::operations(self.n, *widths, n_rhs),
            None => dense_operations(self.n, n_rhs),
        }
    }
}

fn dense_operations(n: usize, n_rhs: u64) -> u64 {
    let n = n as u64;
    2 * n * n * n / 3 + n_rhs * 2 * n * n
}

impl Shifted {
    /// Decomposes s I - J by a plan that suits J; none if it is singular.
    pub fn new(jacobian: &Jacobian, plan: &Plan, shift: f64) -> Option<Self> {
        let n = jacobian.n;
        let finite = jacobian.entries.iter().filter(|entry| entry.value.is_finite());
        let Some((order, (below, above))) = &plan.band else {
            let mut matrix = DMatrix::from_diagonal_element(n, n, shift);
            finite.for_each(|entry| matrix[(entry.row, entry.column)] -= entry.value);
            let lu = LU::new(matrix);
            return lu.is_invertible().then_some(Shifted::Dense(lu));
        };
        let mut place = vec![0; n];
        order.iter().enumerate().for_each(|(new, &old)| place[old] = new);
        let mut matrix = Banded::zeros(n, *below, *above);
        (0..n).for_each(|k| *matrix.entry(k, k) = shift);
        finite.for_each(|entry| *matrix.entry(place[entry.row], place[entry.column]) -= entry.value);
        matrix.decompose().then_some(Shifted::Banded(order.clone(), matrix))
    }

    /// Replaces the right-hand side by the solution.
    pub fn solve(&self, rhs: &mut [f64]) {
        match self {
            Shifted::Dense(lu) => {
                let n = rhs.len();
                let solved = lu.solve_mut(&mut DMatrixViewMut::from_slice(rhs, n, 1));
                debug_assert!(solved, "what is singular has been refused");
            }
            Shifted::Banded(order, matrix) => {
                let mut ordered: Vec<f64> = order.iter().map(|&old| rhs[old]).collect();
                matrix.solve(&mut ordered);
                order.iter().zip(ordered).for_each(|(&old, value)| rhs[old] = value);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Entries of no regularity at all in [-1, 1].
    fn value(row: usize, column: usize) -> f64 {
        ((row * 37 + column * 101 + 11) as f64 * 0.618_033_988_749_894_9).fract() * 2.0 - 1.0
    }

    fn jacobian(n: usize, has: impl Fn(usize, usize) -> bool) -> Jacobian {
        let mut jacobian = Jacobian::default();
        jacobian.reset(n);
        for row in 0..n {
            for column in (0..n).filter(|&column| has(row, column)) {
                jacobian.push(row, column, 10.0 * value(row, column));
            }
        }
        jacobian
    }

    fn shifted(jacobian: &Jacobian, shift: f64) -> Option<Shifted> {
        Shifted::new(jacobian, &plan(jacobian), shift)
    }

    fn plan(jacobian: &Jacobian) -> Plan {
        let mut plan = Plan::default();
        plan.suit(jacobian);
        plan
    }

    /// The largest part of (s I - J) u - r, beside those of the matrix and of u.
    #[track_caller]
    fn residual(jacobian: &Jacobian, shift: f64) -> f64 {
        let rhs: Vec<f64> = (0..jacobian.n).map(|k| value(k, k + 3)).collect();
        let mut u = rhs.clone();
        shifted(jacobian, shift).expect("regular").solve(&mut u);
        let mut left: Vec<f64> = u.iter().map(|u| shift * u).collect();
        jacobian.entries.iter().for_each(|entry| left[entry.row] -= entry.value * u[entry.column]);
        let largest = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, |a: f64, b| a.max(b.abs()));
        let size = (shift + jacobian.norm()) * largest(&mut u.iter().copied());
        largest(&mut left.iter().zip(&rhs).map(|(left, rhs)| left - rhs)) / size
    }

    #[test]
    fn dense_systems_are_solved() {
        for n in [1, 2, 3, 8, 50] {
            let jacobian = jacobian(n, |_, _| true);
            assert!(matches!(shifted(&jacobian, 0.3), Some(Shifted::Dense(_))));
            assert!(residual(&jacobian, 0.3) < 1e-14);
        }
    }

    #[test]
    fn systems_with_a_band_are_solved_within_it_with_exchanges() {
        // a small shift: the diagonal is no pivot by itself
        for (below, above) in [(1, 1), (3, 0), (0, 2), (2, 3)] {
            let jacobian =
                jacobian(60, |row, column| row + above >= column && row <= column + below && row != column);
            assert!(matches!(shifted(&jacobian, 0.3), Some(Shifted::Banded(..))), "{below} {above}");
            assert!(residual(&jacobian, 0.3) < 1e-14, "{below} {above}");
        }
    }

    #[test]
    fn a_plan_serves_all_of_its_pattern_and_is_made_anew_for_another() {
        let mut kept = Plan::default();
        for (below, above) in [(1, 1), (1, 1), (3, 0), (60, 60), (1, 1)] {
            let jacobian = jacobian(60, |row, column| row + above >= column && row <= column + below);
            kept.suit(&jacobian);
            let afresh = plan(&jacobian);
            assert_eq!((kept.n, &kept.pattern, &kept.band), (afresh.n, &afresh.pattern, &afresh.band));
        }
    }

    #[test]
    fn a_singular_system_is_refused() {
        for n in [2, 60] {
            let one = jacobian(n, |row, column| row == column);
            let mut singular = Jacobian::default();
            singular.reset(n);
            one.entries.iter().for_each(|entry| singular.push(entry.row, entry.column, 1.0));
            assert!(shifted(&singular, 1.0).is_none());
            assert!(shifted(&singular, 2.0).is_some());
        }
    }

    #[test]
    fn what_is_not_finite_counts_as_zero() {
        let mut jacobian = Jacobian::default();
        jacobian.reset(1);
        jacobian.push(0, 0, f64::NEG_INFINITY);
        let mut u = [6.0];
        shifted(&jacobian, 2.0).expect("regular").solve(&mut u);
        assert_eq!(u, [3.0]);
    }

    #[test]
    fn a_band_takes_operations_in_proportion_to_its_length() {
        let chain = |n| jacobian(n, |row, column| row.abs_diff(column) <= 1);
        let (short, long) = (plan(&chain(100)).operations(8), plan(&chain(1000)).operations(8));
        assert_eq!(long, 10 * short);
        assert!(100 * long < dense_operations(1000, 8));
    }
}
