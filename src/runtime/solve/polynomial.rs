//! Cubic polynomials in a step: moved, evaluated, and their smallest positive root.
//!
//! The paper takes the roots of polynomial (18) from a companion matrix and keeps those whose imaginary part is zero
//! (Algorithm 2). A root that the guard only just reaches is a pair of close ones there, whose imaginary parts rounding
//! decides. Here the polynomial is divided at its extrema: on each piece it is monotone, and the signs at the ends tell
//! whether there is a root. A test compares the two.

/// c[0] + c[1] s + c[2] s^2 + c[3] s^3.
pub type Cubic = [f64; 4];

/// Its value at `s`.
pub fn value(c: &Cubic, s: f64) -> f64 {
    ((c[3] * s + c[2]) * s + c[1]) * s + c[0]
}

/// The same polynomial of s - `by`: value(moved(c, by), s) = value(c, by + s).
pub fn moved(c: &Cubic, by: f64) -> Cubic {
    [value(c, by), (3.0 * c[3] * by + 2.0 * c[2]) * by + c[1], 3.0 * c[3] * by + c[2], c[3]]
}

/// The smallest real root in [0, within]; none if there is none there, or if a coefficient is not finite.
pub fn smallest_root(c: &Cubic, within: f64) -> Option<f64> {
    if !c.iter().all(|c| c.is_finite()) {
        return None;
    }
    if c[0] == 0.0 {
        return Some(0.0);
    }
    let c = if c[0] < 0.0 { c.map(|c| -c) } else { *c };
    if c[1..].iter().all(|&c| c >= 0.0) {
        return None;
    }
    let mut from = 0.0;
    for to in extrema(&c).into_iter().filter(|&s| s > 0.0 && s < within).chain([within]) {
        if value(&c, to) <= 0.0 {
            return Some(bracketed(&c, from, to));
        }
        from = to;
    }
    None
}

/// Where the slope is zero, rising; NaN where it is not.
fn extrema(c: &Cubic) -> [f64; 2] {
    let (a, b, d) = (3.0 * c[3], c[2], c[1]);
    let root = (b * b - a * d).sqrt();
    let q = -(b + root.copysign(b));
    let (first, second) = (q / a, d / q);
    if second < first { [second, first] } else { [first, second] }
}

/// The root between `low`, where the polynomial is positive, and `high`, where it is not: Newton's steps, halved where
/// they lead out.
fn bracketed(c: &Cubic, mut low: f64, mut high: f64) -> f64 {
    let mut s = low;
    for _ in 0..200 {
        let slope = (3.0 * c[3] * s + 2.0 * c[2]) * s + c[1];
        let newton = s - value(c, s) / slope;
        s = if newton > low && newton < high { newton } else { low + 0.5 * (high - low) };
        if s <= low || s >= high {
            break;
        }
        let p = value(c, s);
        if p == 0.0 {
            return s;
        }
        let width = high - low;
        if p > 0.0 {
            low = s
        } else {
            high = s
        }
        if high - low > 0.5 * width {
            // Newton's step from one side only: the other end is moved too.
            let middle = low + 0.5 * (high - low);
            if value(c, middle) > 0.0 { low = middle } else { high = middle }
        }
        if high - low <= 2.0 * f64::EPSILON * high {
            break;
        }
    }
    high
}

#[cfg(test)]
mod tests {
    use nalgebra::Matrix3;

    use super::*;

    /// Numbers in [-1, 1), the same in every run.
    fn dice() -> impl FnMut() -> f64 {
        let mut state: u64 = 0x2545_F491_4F6C_DD1D;
        move || {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
        }
    }

    /// As Algorithm 2 says: the eigenvalues of the companion matrix that are real and positive, the smallest.
    fn by_companion_matrix(c: &Cubic) -> Option<f64> {
        let monic = [c[0] / c[3], c[1] / c[3], c[2] / c[3]];
        let companion = Matrix3::new(0.0, 0.0, -monic[0], 1.0, 0.0, -monic[1], 0.0, 1.0, -monic[2]);
        let roots = companion.complex_eigenvalues();
        let real = roots.iter().filter(|root| root.im.abs() < 1e-9 && root.re >= 0.0).map(|root| root.re);
        real.min_by(f64::total_cmp)
    }

    #[test]
    fn the_root_is_that_of_the_companion_matrix() {
        let mut die = dice();
        let mut with_root = 0;
        for _ in 0..20_000 {
            let c = [die(), die(), die(), die()];
            let expected = by_companion_matrix(&c).filter(|&s| s <= 100.0);
            match (smallest_root(&c, 100.0), expected) {
                (Some(found), Some(expected)) => {
                    with_root += 1;
                    assert!((found - expected).abs() <= 1e-6 * (1.0 + expected), "{c:?}: {found} {expected}");
                    assert!(value(&c, found).abs() <= 1e-12 * (1.0 + found.powi(3)), "{c:?}: {found}");
                }
                (None, None) => {}
                other => panic!("{c:?}: {other:?}"),
            }
        }
        assert!(with_root > 5_000, "{with_root}");
    }

    #[test]
    fn lower_degrees_and_zeros_are_polynomials_too() {
        assert_eq!(smallest_root(&[1.0, -2.0, 0.0, 0.0], 10.0), Some(0.5));
        assert_eq!(smallest_root(&[-1.0, 2.0, 0.0, 0.0], 10.0), Some(0.5));
        assert_eq!(smallest_root(&[1.0, -2.0, 0.0, 0.0], 0.4), None);
        assert_eq!(smallest_root(&[0.0, 1.0, 1.0, 1.0], 10.0), Some(0.0));
        assert_eq!(smallest_root(&[1.0, 0.0, 0.0, 0.0], 10.0), None);
        assert_eq!(smallest_root(&[2.0, -3.0, 1.0, 0.0], 10.0), Some(1.0));
        assert_eq!(smallest_root(&[1.0, f64::NAN, 0.0, 0.0], 10.0), None);
    }

    #[test]
    fn a_graze_is_a_root_or_none_by_its_sign() {
        let touching = |gap: f64| [1.0 + gap, -2.0, 1.0, 0.0];
        assert_eq!(smallest_root(&touching(1e-15), 10.0), None);
        let root = smallest_root(&touching(-1e-12), 10.0).unwrap();
        assert!((root - (1.0 - 1e-6)).abs() < 1e-9, "{root}");
    }

    #[test]
    fn a_moved_polynomial_has_the_values_of_the_place_it_is_moved_to() {
        let c = [0.3, -1.1, 0.7, 2.0];
        for s in [-1.0, 0.0, 0.25, 3.0] {
            assert!((value(&moved(&c, 0.6), s) - value(&c, 0.6 + s)).abs() < 1e-12);
        }
    }
}
