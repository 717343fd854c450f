//! A reference for stiff systems that shares nothing with hyc: the linearly implicit Euler method, extrapolated.
//!
//! n substeps of (I - h/n J) (x_new - x) = h/n f(x), for n = 1, 2, .. 8, have an error with an expansion in powers of 1/n;
//! the polynomial through the results, at 1/n = 0, is of order 8 (Deuflhard; Hairer & Wanner, Solving ODEs II, IV.9).

/// x' = f(x) of N equations.
pub struct System<const N: usize> {
    /// f.
    pub rates: fn(&[f64; N]) -> [f64; N],
    /// df/dx, row by row.
    pub jacobian: fn(&[f64; N]) -> [[f64; N]; N],
}

/// How many results are extrapolated.
const ROWS: usize = 8;

impl<const N: usize> System<N> {
    /// Goes from `x` at t = 0 to `until`, with an error a step of at most `tolerance` (|x| + `floor`); tells each step by its
    /// begin, length, and the states at both ends. The states at the end.
    pub fn follow(
        &self,
        mut x: [f64; N],
        until: f64,
        (tolerance, floor): (f64, [f64; N]),
        mut told: impl FnMut(f64, f64, &[f64; N], &[f64; N]),
    ) -> [f64; N] {
        let (mut t, mut h) = (0.0, 1e-6);
        while t < until {
            let last = h >= until - t;
            let step = if last { until - t } else { h };
            let (x_new, error) = self.step(&x, step);
            let worst = (0..N).map(|i| error[i].abs() / (tolerance * (x_new[i].abs() + floor[i])));
            let worst =
                worst.fold(0.0, |worst: f64, part| if part > worst || part.is_nan() { part } else { worst });
            let factor = (0.8 * worst.powf(-1.0 / ROWS as f64)).clamp(0.2, 3.0);
            h = step * if factor.is_nan() { 0.2 } else { factor };
            if worst <= 1.0 {
                told(t, step, &x, &x_new);
                x = x_new;
                t = if last { until } else { t + step };
            }
        }
        x
    }

    /// The times at which each of some states passes its threshold.
    pub fn crossings(
        &self,
        x: [f64; N],
        until: f64,
        accuracy: (f64, [f64; N]),
        thresholds: &[(usize, f64)],
    ) -> Vec<Vec<f64>> {
        let mut found = vec![Vec::new(); thresholds.len()];
        self.follow(x, until, accuracy, |t, h, x, x_new| {
            for (times, &(i, threshold)) in found.iter_mut().zip(thresholds) {
                let above = x[i] > threshold;
                if above == (x_new[i] > threshold) {
                    continue;
                }
                let (mut lo, mut hi) = (0.0, h);
                for _ in 0..60 {
                    let middle = 0.5 * (lo + hi);
                    if (self.step(x, middle).0[i] > threshold) == above { lo = middle } else { hi = middle }
                }
                times.push(t + hi);
            }
        });
        found
    }

    /// The states after `h`, and how much the last extrapolation has changed them.
    fn step(&self, x: &[f64; N], h: f64) -> ([f64; N], [f64; N]) {
        let mut row: Vec<[f64; N]> = Vec::new();
        let mut change = [f64::NAN; N];
        for n in 1..=ROWS {
            let mut next = vec![self.euler(x, h, n)];
            for j in 1..n {
                let quotient = n as f64 / (n - j) as f64 - 1.0;
                change = std::array::from_fn(|i| (next[j - 1][i] - row[j - 1][i]) / quotient);
                next.push(std::array::from_fn(|i| next[j - 1][i] + change[i]));
            }
            row = next;
        }
        (row[ROWS - 1], change)
    }

    /// `n` steps of the linearly implicit Euler method.
    fn euler(&self, x: &[f64; N], h: f64, n: usize) -> [f64; N] {
        let (mut x, h) = (*x, h / n as f64);
        for _ in 0..n {
            let (rates, jacobian) = ((self.rates)(&x), (self.jacobian)(&x));
            let matrix = std::array::from_fn(|i| {
                std::array::from_fn(|j| if i == j { 1.0 - h * jacobian[i][j] } else { -h * jacobian[i][j] })
            });
            let moved = solve(matrix, rates.map(|rate| h * rate));
            x = std::array::from_fn(|i| x[i] + moved[i]);
        }
        x
    }
}

/// Gaussian elimination with partial pivoting.
fn solve<const N: usize>(mut a: [[f64; N]; N], mut b: [f64; N]) -> [f64; N] {
    for k in 0..N {
        let pivot = (k..N).max_by(|&i, &j| a[i][k].abs().total_cmp(&a[j][k].abs())).unwrap();
        a.swap(k, pivot);
        b.swap(k, pivot);
        for i in k + 1..N {
            let factor = a[i][k] / a[k][k];
            let above = a[k];
            a[i].iter_mut().zip(above).skip(k).for_each(|(entry, above)| *entry -= factor * above);
            b[i] -= factor * b[k];
        }
    }
    for k in (0..N).rev() {
        let known: f64 = (k + 1..N).map(|j| a[k][j] * b[j]).sum();
        b[k] = (b[k] - known) / a[k][k];
    }
    b
}
