//! Gaussian elimination with partial pivoting within a band: n equations in time proportional to n.
//!
//! Entry (i, j) of the matrix is kept at column j - i + `below` of row i. Exchanges of rows fill up to `below` more columns
//! above the band.

/// A matrix whose entries lie in a band about its diagonal, to be decomposed.
#[derive(Clone, Debug)]
pub struct Banded {
    n: usize,
    /// How far below the diagonal entries lie, and above it, room for exchanges included.
    below: usize,
    above: usize,
    entries: Vec<f64>,
    /// For each step of the elimination the row that came to the diagonal, and the factors of the rows below.
    pivots: Vec<usize>,
    factors: Vec<f64>,
}

impl Banded {
    /// All zeros, with room for entries so far below and above the diagonal.
    pub fn zeros(n: usize, below: usize, above: usize) -> Self {
        let above = above + below;
        let entries = vec![0.0; n * (below + 1 + above)];
        Self { n, below, above, entries, pivots: vec![0; n], factors: vec![0.0; n * below] }
    }

    /// An entry.
    pub fn entry(&mut self, row: usize, column: usize) -> &mut f64 {
        let place = self.place(row, column);
        &mut self.entries[place]
    }

    /// Operations of a decomposition, and of the solution for so many right-hand sides.
    pub fn operations(n: usize, (below, above): (usize, usize), n_rhs: u64) -> u64 {
        let (n, below, above) = (n as u64, below as u64, (above + below) as u64);
        2 * n * below * (above + 1) + n_rhs * 2 * n * (below + above + 1)
    }

    /// Decomposes; false if the matrix is singular.
    pub fn decompose(&mut self) -> bool {
        for k in 0..self.n {
            let last = (k + self.below).min(self.n - 1);
            let right = (k + self.above).min(self.n - 1);
            let size = |i: usize| self.entries[self.place(i, k)].abs();
            let pivot = (k + 1..=last).fold(k, |best, i| if size(i) > size(best) { i } else { best });
            let head = self.entries[self.place(pivot, k)];
            if head == 0.0 || head.is_nan() {
                return false;
            }
            self.pivots[k] = pivot;
            if pivot != k {
                for j in k..=right {
                    let (a, b) = (self.place(k, j), self.place(pivot, j));
                    self.entries.swap(a, b);
                }
            }
            for i in k + 1..=last {
                let factor = self.entries[self.place(i, k)] / head;
                self.factors[k * self.below + i - k - 1] = factor;
                if factor != 0.0 {
                    let (from, to) = (self.place(k, k + 1), self.place(i, k + 1));
                    for j in 0..right - k {
                        self.entries[to + j] -= factor * self.entries[from + j];
                    }
                }
            }
        }
        true
    }

    /// Replaces the right-hand side by the solution; after [`Banded::decompose`].
    pub fn solve(&self, rhs: &mut [f64]) {
        for k in 0..self.n {
            rhs.swap(k, self.pivots[k]);
            let last = (k + self.below).min(self.n - 1);
            for i in k + 1..=last {
                rhs[i] -= self.factors[k * self.below + i - k - 1] * rhs[k];
            }
        }
        for k in (0..self.n).rev() {
            let right = (k + self.above).min(self.n - 1);
            let known = (k + 1..=right).fold(0.0, |sum, j| sum + self.entries[self.place(k, j)] * rhs[j]);
            rhs[k] = (rhs[k] - known) / self.entries[self.place(k, k)];
        }
    }

    fn place(&self, row: usize, column: usize) -> usize {
        row * (self.below + 1 + self.above) + column + self.below - row
    }
}
