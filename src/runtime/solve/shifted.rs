//! The linear systems of a stiff step: (s I - J) u = r for one shift s > 0 and several right-hand sides.
//!
//! In: the Jacobian by its entries. Entries that are not finite (the slope of a square root at zero) count as zero: the step
//! is then explicit in that direction, and its error estimate says what it is worth. Solved by a dense LU decomposition with
//! partial pivoting.

use nalgebra::{DMatrix, DMatrixViewMut, Dyn, LU};

use crate::runtime::solve::jacobian::Jacobian;

/// s I - J, decomposed.
#[derive(Clone, Debug)]
pub struct Shifted {
    lu: LU<f64, Dyn, Dyn>,
}

impl Shifted {
    /// Decomposes s I - J; none if it is singular.
    pub fn new(jacobian: &Jacobian, shift: f64) -> Option<Self> {
        let n = jacobian.n;
        let mut matrix = DMatrix::from_diagonal_element(n, n, shift);
        for entry in jacobian.entries.iter().filter(|entry| entry.value.is_finite()) {
            matrix[(entry.row, entry.column)] -= entry.value;
        }
        let lu = LU::new(matrix);
        lu.is_invertible().then_some(Self { lu })
    }

    /// How many operations it takes to decompose, and to solve for so many right-hand sides.
    pub fn operations(jacobian: &Jacobian, n_rhs: u64) -> u64 {
        let n = jacobian.n as u64;
        n * n * n * 2 / 3 + n_rhs * 2 * n * n
    }

    /// Replaces the right-hand side by the solution.
    pub fn solve(&self, rhs: &mut [f64]) {
        let n = rhs.len();
        let solved = self.lu.solve_mut(&mut DMatrixViewMut::from_slice(rhs, n, 1));
        debug_assert!(solved, "what is singular has been refused");
    }
}
