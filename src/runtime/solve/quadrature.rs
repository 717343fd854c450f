//! Integrals of what is known by its values alone: Gauss and Kronrod's pair of 7 and 15 points, adaptive.
//!
//! Source: R. Piessens, E. de Doncker-Kapenga, C. W. Überhuber, D. K. Kahaner, QUADPACK (1983), `QK15`.

/// What became of a number from which an integral is taken away.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Spent {
    /// This is left.
    Left(f64),
    /// Nothing was left at this time.
    At(f64),
    /// From a time on the integrand is negative or not finite.
    Undefined {
        /// From when.
        time: f64,
        /// What it is there.
        value: f64,
        /// What is left then.
        left: f64,
    },
}

/// The nodes in [0, 1] of the rule of 15 points over [-1, 1]; every other one, from the second on, is of that of 7.
const NODES: [f64; 8] = [
    0.991_455_371_120_812_6,
    0.949_107_912_342_758_5,
    0.864_864_423_359_769_1,
    0.741_531_185_599_394_4,
    0.586_087_235_467_691_1,
    0.405_845_151_377_397_2,
    0.207_784_955_007_898_47,
    0.0,
];
/// The weights of the rule of 15 points.
const WEIGHTS: [f64; 8] = [
    0.022_935_322_010_529_224,
    0.063_092_092_629_978_56,
    0.104_790_010_322_250_18,
    0.140_653_259_715_525_92,
    0.169_004_726_639_267_9,
    0.190_350_578_064_785_4,
    0.204_432_940_075_298_9,
    0.209_482_141_084_727_82,
];
/// The weights of the rule of 7 points.
const WEIGHTS_OF_7: [f64; 4] =
    [0.129_484_966_168_869_7, 0.279_705_391_489_276_64, 0.381_830_050_505_118_9, 0.417_959_183_673_469_4];

/// The value at 1 of each Lagrange polynomial of the 15 nodes, from the greatest node down to the least.
const AT_END: [f64; 15] = [
    1.453_983_731_103_312_4,
    -0.706_673_993_404_573_8,
    0.420_047_199_720_882_9,
    -0.291_418_695_919_990_6,
    0.221_175_970_224_892_72,
    -0.174_570_351_562_241_32,
    0.139_783_431_782_908_36,
    -0.112_929_172_918_981_48,
    0.091_687_296_848_570_96,
    -0.073_778_979_644_262_46,
    0.057_719_118_618_911_436,
    -0.043_250_815_978_173_98,
    0.030_438_309_530_367_934,
    -0.018_451_577_046_963_43,
    0.006_238_528_645_340_283,
];

/// So many parts are looked at; then the rest is taken as it is.
const PARTS_MAX: usize = 10_000;
/// Steps towards the time at which nothing is left; a bisection ends in fewer.
const STEPS_MAX: usize = 64;

/// The least share of the accuracy that a part has.
const SHARE_LEAST: f64 = 1e-3;

/// Takes the integral over [s, e] of a rate that is not negative away from `left`, to within `accuracy`. Parts no wider than `resolution`
/// are not divided.
pub fn spend(
    rate: &mut dyn FnMut(f64) -> f64,
    (s, e): (f64, f64),
    mut left: f64,
    accuracy: f64,
    resolution: f64,
) -> Spent {
    let mut parts = vec![(s, e)];
    let mut n_parts = 0;
    while let Some((from, to)) = parts.pop() {
        n_parts += 1;
        let part = integral(rate, from, to);
        let middle = 0.5 * (from + to);
        // Few parts are so hard that their share would be too small to reach.
        let share = ((to - from) / (e - s)).max(SHARE_LEAST);
        let is_fine = part.wrong.is_none() && part.error <= accuracy * share;
        if !is_fine && to - from > resolution && from < middle && middle < to && n_parts < PARTS_MAX {
            parts.extend([(middle, to), (from, middle)]);
            continue;
        }
        if let Some(value) = part.wrong {
            return Spent::Undefined { time: from, value, left };
        }
        if part.value > 0.0 && part.value >= left {
            return Spent::At(end(rate, (from, to), left, part.value));
        }
        left -= part.value;
    }
    Spent::Left(left)
}

/// When the integral from s on is `left`; over all of [s, e] it is `whole`, which is no less.
fn end(rate: &mut dyn FnMut(f64) -> f64, (s, e): (f64, f64), left: f64, whole: f64) -> f64 {
    let (mut low, mut high) = (s, e);
    let mut t = s + left / whole * (e - s);
    for _ in 0..STEPS_MAX {
        if !(low < t && t < high) {
            t = 0.5 * (low + high);
            if !(low < t && t < high) {
                return high;
            }
        }
        let excess = integral(rate, s, t).value - left;
        if excess < 0.0 {
            low = t;
        } else {
            high = t;
        }
        let next = t - excess / rate(t);
        if (next - t).abs() <= f64::EPSILON * t.abs() {
            return t;
        }
        t = next;
    }
    t
}

/// An integral over a part.
struct Part {
    value: f64,
    /// How far from a polynomial the integrand is: by how much the two rules differ for it, and for it times the place in the part (jumps on
    /// both sides of the middle may cancel in one, not in both); and how far, beyond the last nodes, its ends are from where those lead.
    error: f64,
    /// A value that is negative or not finite.
    wrong: Option<f64>,
}

fn integral(rate: &mut dyn FnMut(f64) -> f64, s: f64, e: f64) -> Part {
    let (middle, half) = (0.5 * (s + e), 0.5 * (e - s));
    let mut wrong = None;
    let mut value_at = |t: f64| {
        let value = rate(t);
        if !(value >= 0.0 && value.is_finite()) {
            wrong = Some(value);
        }
        value
    };
    let ends = [value_at(e), value_at(s)];
    let (mut sum, mut differences, mut led_to) = (0.0, [0.0; 2], [0.0; 2]);
    for k in 0..15 {
        // down from the greatest
        let place = if k < 8 { NODES[k] } else { -NODES[14 - k] };
        let pair = k.min(14 - k);
        let value = value_at(middle + half * place);
        let by_7 = if pair % 2 == 1 { WEIGHTS_OF_7[pair / 2] } else { 0.0 };
        sum += WEIGHTS[pair] * value;
        differences[0] += (WEIGHTS[pair] - by_7) * value;
        differences[1] += (WEIGHTS[pair] - by_7) * place * value;
        led_to[0] += AT_END[k] * value;
        led_to[1] += AT_END[14 - k] * value;
    }
    let beyond = (1.0 - NODES[0]) * f64::max((ends[0] - led_to[0]).abs(), (ends[1] - led_to[1]).abs());
    let error = half * differences.iter().fold(beyond, |error, difference| error.max(difference.abs()));
    Part { value: half * sum, error, wrong }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_of_degree_22_are_exact_and_those_of_12_without_an_error() {
        for degree in 0..=22 {
            let part = integral(&mut |t| t.powi(degree), 0.0, 1.0);
            let exact = 1.0 / f64::from(degree + 1);
            assert!((part.value - exact).abs() <= 16.0 * f64::EPSILON * exact, "{degree}: {}", part.value);
            // the place in the part is one degree more
            assert_eq!(part.error <= 1e-14, degree <= 12, "{degree}: {:e}", part.error);
        }
    }

    #[test]
    fn what_is_left_and_when_nothing_is() {
        let spend_of = |rate: &mut dyn FnMut(f64) -> f64, left| spend(rate, (0.0, 3.0), left, 1e-13, 1e-15);
        assert_eq!(spend_of(&mut |t| 2.0 * t, 10.0), Spent::Left(1.0));
        for (rate, left, time) in [
            (Box::new(|t: f64| 2.0 * t) as Box<dyn Fn(f64) -> f64>, 2.0, 2f64.sqrt()),
            (Box::new(|t: f64| (-t).exp()), 0.75, 4f64.ln()),
            // a jump, and nothing at all for a while
            (Box::new(|t: f64| if t < 1.0 { 1.0 } else { 3.0 }), 2.5, 1.5),
            // jumps on both sides of the middle, where the rules agree, and beyond the last node
            (Box::new(|t: f64| if (0.4..2.6).contains(&t) { 2.0 } else { 1.0 }), 0.4 + 4.4 + 0.1, 2.7),
            (Box::new(|t: f64| if t < 2.99 { 1.0 } else { 5.0 }), 2.99 + 0.02, 2.994),
            (Box::new(|t: f64| if (0.3..2.7).contains(&t) { 0.0 } else { 1.0 }), 0.4, 2.8),
        ] {
            let Spent::At(found) = spend_of(&mut |t| rate(t), left) else { panic!("{left}") };
            assert!((found - time).abs() < 1e-12, "{found} for {time}");
        }
    }

    #[test]
    fn where_a_rate_becomes_negative_is_told() {
        let spent = spend(&mut |t| 1.0 - t, (0.0, 3.0), 10.0, 1e-12, 1e-14);
        let Spent::Undefined { time, value, left } = spent else { panic!("{spent:?}") };
        assert!(
            (time - 1.0).abs() < 1e-12 && value < 0.0 && (left - 9.5).abs() < 1e-12,
            "{time} {value} {left}"
        );
    }
}
