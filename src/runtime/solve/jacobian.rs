//! The Jacobian of a right-hand side by its entries, and how fast the flow is that it belongs to.
//!
//! In: the entries of df/dx that are not always zero, in any order; those at one place add up. The spectral radius comes
//! from the power method: for a vector v that favours no direction, |J^2m v| / |J^m v| is about rho^m. A pair of complex
//! eigenvalues turns v, so that the quotient wavers, but only by a factor that is bounded and has no part in m: the m-th
//! root takes it away. A Jacobian without cycles has the radius 0, and J^n v = 0 says so.

use crate::math::elementary::{exp, log};

/// df/dx at one time and state.
#[derive(Clone, Debug, Default)]
pub struct Jacobian {
    /// How many equations.
    pub n: usize,
    /// The entries; all others are zero.
    pub entries: Vec<Entry>,
}

/// d(rate of `row`)/d(state `column`), 1/s for states of one unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Entry {
    /// Which rate.
    pub row: usize,
    /// By which state.
    pub column: usize,
    /// Its value.
    pub value: f64,
}

/// Steps of the power method before its growth is measured, besides one for each equation; as many follow.
const POWER_STEPS: usize = 64;
/// The vector is scaled anew where it leaves this range or its inverse.
const FAR: f64 = 1e100;

impl Jacobian {
    /// Forgets all entries; room for `n` equations.
    pub fn reset(&mut self, n: usize) {
        self.n = n;
        self.entries.clear();
    }

    /// Adds an entry.
    pub fn push(&mut self, row: usize, column: usize, value: f64) {
        self.entries.push(Entry { row, column, value });
    }

    /// An upper bound of the spectral radius: the largest sum of magnitudes in a row; NaN if any entry is.
    pub fn norm(&self) -> f64 {
        let mut sums = vec![0.0; self.n];
        for entry in &self.entries {
            sums[entry.row] += entry.value.abs();
        }
        sums.into_iter().fold(0.0, |norm, sum| if sum > norm || sum.is_nan() { sum } else { norm })
    }

    /// About the largest magnitude of an eigenvalue; NaN if an entry is not finite.
    pub fn spectral_radius(&self) -> f64 {
        if !self.norm().is_finite() {
            return f64::NAN;
        }
        let half = POWER_STEPS + self.n;
        // Unequal components of both signs: no symmetry of a model has them in common.
        let mut v: Vec<f64> = (0..self.n).map(|i| 1.0 - 1.6 * ((i as f64 + 1.0) * GOLDEN).fract()).collect();
        let mut product = vec![0.0; self.n];
        let (mut scale, mut log_begin) = (0.0, 0.0);
        for step in 0..=2 * half {
            let size = v.iter().fold(0.0_f64, |size, v| size.max(v.abs()));
            if size == 0.0 {
                return 0.0;
            }
            if step == half || step == 2 * half || !(FAR.recip()..FAR).contains(&size) {
                scale += log(size);
                v.iter_mut().for_each(|v| *v /= size);
            }
            if step == half {
                log_begin = scale;
            }
            product.fill(0.0);
            for entry in &self.entries {
                product[entry.row] += entry.value * v[entry.column];
            }
            std::mem::swap(&mut v, &mut product);
        }
        exp((scale - log_begin) / half as f64)
    }
}

/// The golden section: its multiples lie evenly in [0, 1).
const GOLDEN: f64 = 0.618_033_988_749_894_9;

#[cfg(test)]
mod tests {
    use super::*;

    fn jacobian(n: usize, entries: &[(usize, usize, f64)]) -> Jacobian {
        let mut jacobian = Jacobian::default();
        jacobian.reset(n);
        entries.iter().for_each(|&(row, column, value)| jacobian.push(row, column, value));
        jacobian
    }

    #[track_caller]
    fn near(found: f64, expected: f64, part: f64) {
        assert!((found / expected - 1.0).abs() <= part, "{found} is not {expected}");
    }

    #[test]
    fn of_one_equation_it_is_the_entry() {
        near(jacobian(1, &[(0, 0, -7.5)]).spectral_radius(), 7.5, 1e-14);
        near(jacobian(1, &[(0, 0, 1e200)]).spectral_radius(), 1e200, 1e-12);
        near(jacobian(1, &[(0, 0, 1e-200)]).spectral_radius(), 1e-200, 1e-12);
        assert_eq!(jacobian(1, &[]).spectral_radius(), 0.0);
    }

    #[test]
    fn entries_at_one_place_add_up() {
        near(jacobian(1, &[(0, 0, -3.0), (0, 0, -4.0)]).spectral_radius(), 7.0, 1e-14);
    }

    #[test]
    fn of_an_oscillator_it_is_the_frequency_though_the_norm_is_its_square() {
        for omega in [0.01, 1.0, 100.0] {
            for damping in [0.0, 0.1, 0.9] {
                let oscillator =
                    jacobian(2, &[(0, 1, 1.0), (1, 0, -omega * omega), (1, 1, -2.0 * damping * omega)]);
                // the quotient wavers by a factor of about omega, of which the 66th root is taken
                near(oscillator.spectral_radius(), omega, 0.15);
                assert!(oscillator.norm() >= omega);
            }
        }
    }

    #[test]
    fn of_a_chain_of_integrators_it_is_zero() {
        let chain: Vec<(usize, usize, f64)> = (0..99).map(|i| (i, i + 1, 1e3)).collect();
        assert_eq!(jacobian(100, &chain).spectral_radius(), 0.0);
    }

    #[test]
    fn of_a_chain_of_followers_it_is_not_far_above_that_of_one() {
        let mut chain: Vec<(usize, usize, f64)> = (0..30).map(|i| (i, i, -2.0)).collect();
        chain.extend((1..30).map(|i| (i, i - 1, 2.0)));
        let found = jacobian(30, &chain).spectral_radius();
        assert!((2.0..3.0).contains(&found), "{found}");
    }

    #[test]
    fn of_diffusion_on_a_line_it_is_known() {
        let n = 50;
        let mut entries: Vec<(usize, usize, f64)> = (0..n).map(|i| (i, i, -2.0)).collect();
        entries.extend((1..n).flat_map(|i| [(i, i - 1, 1.0), (i - 1, i, 1.0)]));
        let exact = 2.0 + 2.0 * (std::f64::consts::PI / (n as f64 + 1.0)).cos();
        near(jacobian(n, &entries).spectral_radius(), exact, 0.03);
    }

    #[test]
    fn it_is_not_a_number_where_an_entry_is_not_finite() {
        for value in [f64::NAN, f64::INFINITY] {
            assert!(jacobian(2, &[(0, 0, 1.0), (1, 1, value)]).spectral_radius().is_nan());
        }
    }
}
