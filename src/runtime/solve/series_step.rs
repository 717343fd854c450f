//! How far a Taylor series reaches: the step for which its last terms are as small as the accuracy asks.
//!
//! With s_i = absolute + tolerance |x_i| and r_k = max over i of |c_ik| / s_i, the step is the largest h such that
//! `r_p h^p <= 1` and `r_(p-1) h^(p-1) <= e^2` (Jorba & Zou, Experimental Mathematics 14, 2005, section 3.2: terms fall by
//! e^2 an order at the step that costs least), and a little less. Logarithms are within 1/100, which is enough for a step:
//! whether it was good is asked afterwards. One source serves one agent and lanes, with the same bits.

use crate::math::Numbers;
use crate::math::elementary::log;
use crate::runtime::solve::control::Accuracy;
use crate::runtime::solve::segment::N_MAX;

/// log2 of the factor by which terms fall from order to order: e^2.
const FALL: f64 = 2.0 * std::f64::consts::LOG2_E;
/// By how much terms may fall short of that: e^-2 of the term before the last is taken for an error.
const FALLEN: f64 = 0.135_335_283_236_612_7;
/// log2 of the share of the reach that is used.
const SAFETY: f64 = -0.074;

/// The step that the coefficients of `n` states allow, s: NaN where one is not finite. Each state has a row of `order` + 1.
#[inline(always)]
pub fn reach<T: Numbers>(coefficients: &[T], n: usize, order: usize, accuracy: Accuracy) -> T {
    let (mut last, mut before) = (T::all(0.0), T::all(0.0));
    let (mut defined, zero) = (T::all(0.0), T::all(0.0));
    for row in coefficients.chunks_exact(order + 1).take(n) {
        let share = row[0].map(|x| 1.0 / accuracy.allowed(x.abs()));
        last = last.zip(row[order].zip(share, |c, share| c.abs() * share), larger);
        before = before.zip(row[order - 1].zip(share, |c, share| c.abs() * share), larger);
        for c in row {
            defined = defined.plus_product(c, &zero);
        }
    }
    let (by_last, by_before) = (1.0 / order as f64, 1.0 / (order as f64 - 1.0));
    let doublings = last.zip(before, |last, before| {
        let (last, before) =
            (-binary_logarithm(last) * by_last, (FALL - binary_logarithm(before)) * by_before);
        (if last < before { last } else { before }) + SAFETY
    });
    doublings.zip(defined, |doublings, defined| power_of_two(doublings) + defined)
}

/// The terms c_k h^k of all states, a row of `order` + 1 for each, and their sums: the states at the end of the step.
#[inline(always)]
pub fn sum_up<T: Numbers>(coefficients: &[T], order: usize, h: T, terms: &mut [T], x_new: &mut [T]) {
    let n_terms = order + 1;
    for (i, x_new) in x_new.iter_mut().enumerate() {
        let row = i * n_terms..(i + 1) * n_terms;
        let mut power = T::all(1.0);
        for (term, &c) in terms[row.clone()].iter_mut().zip(&coefficients[row.clone()]) {
            *term = c.zip(power, |c, power| c * power);
            // Bounded, so that a coefficient that is 0 makes a term that is.
            power = power.zip(h, |power, h| (power * h).min(f64::MAX));
        }
        let sum = |sum: T, term: &T| sum.zip(*term, |sum, term| sum + term);
        *x_new = terms[row].iter().rev().fold(T::all(0.0), sum);
    }
}

/// The estimate of the errors, from the terms of all states and the rates at the end of the step.
#[inline(always)]
pub fn errors<T: Numbers>(terms: &[T], order: usize, h: T, rates: &[T], errors: &mut [T]) {
    let n_terms = order + 1;
    for ((error, rate), terms) in errors.iter_mut().zip(rates).zip(terms.chunks_exact(n_terms)) {
        let last =
            terms[order].zip(terms[order - 1], |last, before| larger(last.abs(), FALLEN * before.abs()));
        *error = last.zip(defect(terms, 1.0, h, *rate), larger);
    }
}

/// h / (p + 1) times what a rate differs from the slope of its series in a point of the step: at this share of it.
#[inline(always)]
fn defect<T: Numbers>(terms: &[T], share: f64, h: T, rate: T) -> T {
    let n_terms = terms.len();
    let slope = (1..n_terms)
        .rev()
        .fold(T::all(0.0), |sum, k| sum.zip(terms[k], |sum, term| sum * share + k as f64 * term));
    let change = rate.zip(h, |rate, h| h * rate);
    change.zip(slope, |change, slope| (change - slope).abs() * (1.0 / n_terms as f64))
}

/// At so many points between its ends a step is looked at that is quiet.
pub const LOOKS: usize = 15;

/// The share of a step at which the point lies with this number, from 0: at no regular distance.
#[inline(always)]
pub fn look(number: usize) -> f64 {
    ((number + 1) as f64 * 0.618_033_988_749_894_9) % 1.0
}

/// 1 where the third and the fourth terms of all states are within the accuracy, else 0. The step is *quiet*: its series says
/// next to nothing, and cannot see what the flow may do before the step ends (a pulse that is still to come).
#[inline(always)]
pub fn is_quiet<T: Numbers>(terms: &[T], order: usize, accuracy: Accuracy) -> T {
    terms.chunks_exact(order + 1).fold(T::all(1.0), |quiet, terms| {
        let size = terms[3].zip(terms[4], |third, fourth| larger(third.abs(), fourth.abs()));
        let allowed = terms[0].map(|x| accuracy.allowed(x.abs()));
        quiet.zip(size.zip(allowed, |size, allowed| if size <= allowed { 1.0 } else { 0.0 }), |a, b| a * b)
    })
}

/// The states at this share of a step.
#[inline(always)]
pub fn inside<T: Numbers>(terms: &[T], order: usize, share: f64, x: &mut [T]) {
    for (x, terms) in x.iter_mut().zip(terms.chunks_exact(order + 1)) {
        let sum = |sum: T, term: &T| sum.zip(*term, |sum, term| sum * share + term);
        *x = terms.iter().rev().fold(T::all(0.0), sum);
    }
}

/// Widens the errors of a quiet step by the rates at this share of it.
#[inline(always)]
pub fn look_inside<T: Numbers>(
    terms: &[T],
    (order, share): (usize, f64),
    (h, quiet): (T, T),
    rates: &[T],
    errors: &mut [T],
) {
    for ((error, rate), terms) in errors.iter_mut().zip(rates).zip(terms.chunks_exact(order + 1)) {
        let seen = error.zip(defect(terms, share, h, *rate), larger);
        *error = quiet.choose(seen, *error);
    }
}

/// Bounds of all states over a step from `x` to `x_new` by their terms: between its ends a polynomial leaves their hull by at
/// most an eighth of a bound of its second derivative.
#[inline(always)]
pub fn bounds<T: Numbers>(
    terms: &[T],
    order: usize,
    (x, x_new): (&[T], &[T]),
    (lows, highs): (&mut [T], &mut [T]),
) {
    for (i, terms) in terms.chunks_exact(order + 1).enumerate() {
        let (mut bend, mut size) = (T::all(0.0), terms[0].zip(terms[1], |a, b| a.abs() + b.abs()));
        for (k, &term) in terms.iter().enumerate().skip(2) {
            let share = 0.125 * (k * (k - 1)) as f64 * (1.0 + 1e-12);
            bend = bend.zip(term, |bend, term| bend + share * term.abs());
            size = size.zip(term, |size, term| size + term.abs());
        }
        let room = bend.zip(size, |bend, size| bend + ROUNDING * size);
        lows[i] = x[i].zip(x_new[i], |a, b| if a < b { a } else { b }).zip(room, |end, room| end - room);
        highs[i] = x[i].zip(x_new[i], |a, b| if a > b { a } else { b }).zip(room, |end, room| end + room);
    }
}

/// Up to what, in units of the sum of the sizes of its terms, the value of a polynomial may be rounded.
const ROUNDING: f64 = 8.0 * N_MAX as f64 * f64::EPSILON;

/// Order of the series for a tolerance: Jorba & Zou's 1 - ln(tolerance) / 2, and two more.
pub fn order(tolerance: f64, highest: usize) -> usize {
    let fitting = (1.0 - 0.5 * log(tolerance)).ceil() + EXTRA;
    (fitting.max(4.0) as usize).min(highest)
}

/// A step costs more than its series: what goes by the step is cheaper with fewer of them.
const EXTRA: f64 = 2.0;

#[inline(always)]
fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// 2^52 + 2^51: a number of middle size added to it leaves its nearest integer in the lowest bits.
const ROUNDER: f64 = 6_755_399_441_055_744.0;

/// log2 of a number that is not negative, within 1/100; -1023 of zero, 1024 of infinity.
#[inline(always)]
fn binary_logarithm(x: f64) -> f64 {
    let bits = x.to_bits();
    let exponent = f64::from_bits((bits >> 52) | 0x4330_0000_0000_0000) - 4_503_599_627_370_496.0 - 1023.0;
    let mantissa = f64::from_bits((bits & 0x000f_ffff_ffff_ffff) | 0x3ff0_0000_0000_0000);
    exponent + ((-1.0 / 3.0 * mantissa + 2.0) * mantissa - 5.0 / 3.0)
}

/// 2^x within 1/1000, for |x| below 1000.
#[inline(always)]
fn power_of_two(x: f64) -> f64 {
    let rounded = x + ROUNDER;
    let whole = f64::from_bits((rounded.to_bits() << 52).wrapping_add(0x3ff0_0000_0000_0000));
    let rest = x - (rounded - ROUNDER);
    whole * (((0.0558 * rest + 0.2402) * rest + std::f64::consts::LN_2) * rest + 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cheap_logarithm_and_power_are_near() {
        for k in -2000..2000 {
            let x = 1.37_f64.powi(k / 2) * (1.0 + f64::from(k.rem_euclid(7)) / 7.0);
            if x.is_normal() {
                assert!((binary_logarithm(x) - x.log2()).abs() < 0.01, "log2 {x}");
            }
            let y = f64::from(k) / 13.0;
            assert!((power_of_two(y) / y.exp2() - 1.0).abs() < 1e-3, "2^{y}");
        }
        assert_eq!(binary_logarithm(0.0), -1023.0 - (5.0 / 3.0 - 2.0 + 1.0 / 3.0));
        assert!(power_of_two(binary_logarithm(0.0) / -4.0).is_finite());
    }

    #[test]
    fn bounds_contain_the_way_between_the_ends() {
        let mut state = 0x9E37_79B9_u64;
        let mut die = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
        };
        let (order, mut widest) = (10, 0.0_f64);
        for round in 0..2000 {
            let fall = [0.1, 0.3, 0.7, 1.5][round % 4];
            let mut terms: Vec<f64> = (0..=order).map(|k| die() * f64::powi(fall, k)).collect();
            if fall < 0.2 {
                terms[1] = 1.0;
            }
            let value = |theta: f64| terms.iter().rev().fold(0.0, |sum, c| sum * theta + c);
            let (x, x_new) = ([terms[0]], [value(1.0)]);
            let (mut low, mut high) = ([0.0], [0.0]);
            bounds(&terms, order as usize, (&x, &x_new), (&mut low, &mut high));
            let (mut least, mut most) = (x[0].min(x_new[0]), x[0].max(x_new[0]));
            for k in 0..=200 {
                let at = value(f64::from(k) / 200.0);
                (least, most) = (least.min(at), most.max(at));
                assert!(low[0] <= at && at <= high[0], "{terms:?}: {at} is not in [{}, {}]", low[0], high[0]);
            }
            if fall < 0.2 {
                widest = widest.max((high[0] - low[0]) / (most - least));
            }
        }
        assert!(widest < 1.1, "of a smooth way the bounds are close: {widest}");
    }

    #[test]
    fn a_step_leaves_the_last_terms_within_the_accuracy_and_not_far_below_it() {
        let accuracy = Accuracy { tolerance: 1e-8, absolute: 1e-6 };
        for order in [6, 9, 12, 20] {
            for rate in [1e-9_f64, 0.3, 7.0, 1e12] {
                // e^(rate s) times 3: c_k = 3 rate^k / k!.
                let mut c = vec![3.0];
                for k in 1..=order {
                    c.push(c[k - 1] * rate / k as f64);
                }
                let h = reach(&c, 1, order, accuracy);
                let scale = accuracy.absolute + accuracy.tolerance * 3.0;
                let share = |k: usize, allowed: f64| c[k] * h.powi(k as i32) / (scale * allowed);
                let worst = share(order, 1.0).max(share(order - 1, 1.0 / FALLEN));
                assert!(worst <= 1.0 && worst > 0.2, "order {order}, rate {rate}: {worst}");
            }
        }
        let h = reach(&[1.0, 2.0, f64::NAN, 0.0, 0.0], 1, 4, accuracy);
        assert!(h.is_nan());
    }
}
