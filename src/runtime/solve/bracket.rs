//! Narrowing a change of sign to neighbouring numbers.

use crate::runtime::solve::ulp;

/// Narrows [lo, hi] with f(lo) > 0 >= f(hi) to neighbouring numbers: regula falsi with halved end values (the Illinois
/// rule), aimed a little past the root so that both ends close in, and a bisection whenever three steps have not halved
/// the bracket.
pub fn bracket(s: f64, e: f64, f: &mut dyn FnMut(f64) -> f64) -> (f64, f64) {
    let (mut lo, mut hi) = (s, e);
    let (mut f_lo, mut f_hi) = (f(s), f(e));
    if f_lo.is_nan() || f_lo <= 0.0 {
        return (lo, lo);
    }
    let mut last_side = 0;
    let mut width = hi - lo;
    for round in 0_u32.. {
        let middle = 0.5 * (lo + hi);
        if middle <= lo || middle >= hi {
            break;
        }
        let aim = lo + (hi - lo) * (f_lo / (f_lo - f_hi));
        let past = 2.0 * ulp(aim) * f64::from(last_side);
        let mut t = if aim.is_finite() && f_hi < 0.0 { aim + past } else { middle };
        if round % 3 == 2 {
            if hi - lo > 0.5 * width {
                t = middle;
            }
            width = hi - lo;
        }
        t = t.clamp(lo.next_up(), hi.next_down());
        let value = f(t);
        if value == 0.0 {
            // The first of the zeros, should there be more of them.
            let before = t.next_down();
            if before <= lo || f(before) > 0.0 {
                return (before.max(lo), t);
            }
        }
        let side = if value > 0.0 { 1 } else { -1 };
        if side > 0 {
            (lo, f_lo) = (t, value);
            f_hi *= if last_side == side { 0.5 } else { 1.0 };
        } else {
            (hi, f_hi) = (t, value);
            f_lo *= if last_side == side { 0.5 } else { 1.0 };
        }
        last_side = side;
    }
    (lo, hi)
}
