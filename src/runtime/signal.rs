//! Signals: a number at every time, by cubic pieces; and the greatest value of one over a window that moves along.
//!
//! The greatest value over [t + c, t + d] is a signal of pieces again: at each t it is the value at an end of the window, or a peak
//! inside it. So formulas nest, and nothing is sampled: only the pieces of the innermost signal approximate.
//! (A. Donzé, T. Ferrère, O. Maler, Efficient Robust Monitoring for STL, CAV 2013, with cubics in place of lines.)

use smallvec::SmallVec;

use crate::runtime::robustness::Robustness;

/// How well the pieces of a margin hit it, as a share of it (of 1, if it is less); so near to zero it counts as zero.
pub const ACCURACY: f64 = 1e-10;

/// Where a value of a signal comes from in the innermost one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Origin {
    /// From so much later, s.
    Later(f64),
    /// From this time, s.
    At(f64),
}

impl Origin {
    /// The time in the innermost signal of the value at `t`.
    pub fn time(self, t: f64) -> f64 {
        match self {
            Origin::Later(shift) => t + shift,
            Origin::At(time) => time,
        }
    }
}

/// A stretch of a signal: c0 + c1 h + c2 h^2 + c3 h^3, h seconds after its start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece {
    /// Its start, s.
    pub start: f64,
    /// Its end, s.
    pub end: f64,
    /// Its coefficients; an infinite c0 stands alone.
    pub cubic: [f64; 4],
    /// Whether it is closed where it is zero.
    pub closed: bool,
    /// Where its values come from.
    pub origin: Origin,
}

/// A value of a signal, when it is, and where it comes from.
#[derive(Clone, Copy, Debug)]
pub struct Top {
    /// When, s.
    pub time: f64,
    /// The value.
    pub margin: Robustness,
    /// Where it comes from.
    pub origin: Origin,
}

impl Top {
    /// The greater one, of two equal ones the first.
    fn or_greater(self, other: Self) -> Self {
        if other.margin.exceeds(self.margin) { other } else { self }
    }

    /// The same value all along.
    fn along(self, start: f64, end: f64) -> Piece {
        Piece::constant(start, end, self.margin, Origin::At(self.origin.time(self.time)))
    }
}

impl Piece {
    /// The cubic with these values and slopes at its ends.
    pub fn through(start: f64, end: f64, values: [f64; 2], slopes: [f64; 2], closed: bool) -> Self {
        let h = end - start;
        let rise = (values[1] - values[0]) / h;
        let square = (3.0 * rise - 2.0 * slopes[0] - slopes[1]) / h;
        let third = (slopes[0] + slopes[1] - 2.0 * rise) / (h * h);
        let cubic = [values[0], slopes[0], square, third];
        Self { start, end, cubic, closed, origin: Origin::Later(0.0) }
    }

    /// The same value all along.
    pub fn constant(start: f64, end: f64, margin: Robustness, origin: Origin) -> Self {
        Self { start, end, cubic: [margin.value, 0.0, 0.0, 0.0], closed: margin.closed, origin }
    }

    /// Its value at a time.
    pub fn at(&self, t: f64) -> f64 {
        let [c0, c1, c2, c3] = self.cubic;
        if c0.is_infinite() {
            return c0;
        }
        let h = t - self.start;
        c0 + h * (c1 + h * (c2 + h * c3))
    }

    /// Whether it is zero somewhere.
    pub fn reaches_zero(&self) -> bool {
        let mut parts = self.monotone();
        parts
            .any(|part| part.top().margin.value >= -ACCURACY && part.turned().top().margin.value >= -ACCURACY)
    }

    /// Its margin at a time.
    fn margin(&self, t: f64) -> Robustness {
        let value = self.at(t);
        let slack = if value.is_finite() { ACCURACY * value.abs().max(1.0) } else { 0.0 };
        Robustness { value, closed: self.closed, slack }
    }

    /// Its value at a time, with where that comes from.
    fn value(&self, time: f64) -> Top {
        Top { time, margin: self.margin(time), origin: self.origin }
    }

    /// The same values so much earlier.
    fn earlier(&self, shift: f64) -> Self {
        let origin = match self.origin {
            Origin::Later(later) => Origin::Later(later + shift),
            at @ Origin::At(_) => at,
        };
        Self { start: self.start - shift, end: self.end - shift, origin, ..*self }
    }

    /// A part of it.
    fn part(&self, start: f64, end: f64) -> Self {
        let [c0, c1, c2, c3] = self.cubic;
        let h = start - self.start;
        let cubic = if c0.is_infinite() {
            self.cubic
        } else {
            [self.at(start), c1 + h * (2.0 * c2 + 3.0 * h * c3), c2 + 3.0 * h * c3, c3]
        };
        Self { start, end, cubic, ..*self }
    }

    fn turned(&self) -> Self {
        Self { cubic: self.cubic.map(|c| -c), closed: !self.closed, ..*self }
    }

    /// The times within it at which its slope is zero.
    fn stationary(&self) -> SmallVec<[f64; 2]> {
        let [c0, c1, c2, c3] = self.cubic;
        if c0.is_infinite() {
            return SmallVec::new();
        }
        let roots = quadratic_roots(c1, 2.0 * c2, 3.0 * c3);
        let times = roots.into_iter().map(|h| self.start + h);
        times.filter(|&t| self.start < t && t < self.end).collect()
    }

    /// Its parts on which it only rises or only falls.
    fn monotone(&self) -> impl Iterator<Item = Piece> {
        let mut ends: SmallVec<[f64; 4]> = SmallVec::from_slice(&[self.start]);
        ends.extend(self.stationary());
        ends.push(self.end);
        let piece = *self;
        (1..ends.len()).map(move |k| piece.part(ends[k - 1], ends[k]))
    }

    /// Its greatest value; it is monotone.
    fn top(&self) -> Top {
        self.value(self.start).or_greater(self.value(self.end))
    }
}

/// The real roots of a + b x + c x^2, rising.
fn quadratic_roots(a: f64, b: f64, c: f64) -> SmallVec<[f64; 2]> {
    let discriminant = b * b - 4.0 * a * c;
    if c == 0.0 || discriminant < 0.0 {
        return if c == 0.0 && b != 0.0 { SmallVec::from_slice(&[-a / b]) } else { SmallVec::new() };
    }
    // Without cancellation.
    let q = -0.5 * (b + discriminant.sqrt().copysign(b));
    let mut roots: SmallVec<[f64; 2]> = SmallVec::new();
    roots.push(q / c);
    if q != 0.0 {
        roots.push(a / q);
    }
    roots.sort_by(f64::total_cmp);
    roots
}

/// A signal turned upside down.
pub fn turned(signal: &[Piece]) -> Vec<Piece> {
    signal.iter().map(Piece::turned).collect()
}

/// The greatest value over [from, to]; none where the signal is not.
pub fn greatest(signal: &[Piece], [from, to]: [f64; 2]) -> Option<Top> {
    let inside = signal.iter().filter(|piece| piece.end >= from && piece.start <= to);
    let parts = inside.map(|piece| piece.part(piece.start.max(from), piece.end.min(to)));
    let tops = parts.flat_map(|part| part.monotone().collect::<Vec<_>>()).map(|part| part.top());
    tops.reduce(Top::or_greater)
}

/// The signal of the greatest values over [t + c, t + d]; windows end where the signal does, at the latest.
pub fn greatest_ahead(signal: &[Piece], [c, d]: [f64; 2]) -> Vec<Piece> {
    let pieces: Vec<Piece> = signal.iter().flat_map(|piece| piece.monotone().collect::<Vec<_>>()).collect();
    let (Some(first), Some(last)) = (pieces.first(), pieces.last()) else { return Vec::new() };
    let (begin, end) = (first.start, last.end);
    if begin > end - c {
        return Vec::new();
    }
    if begin == end - c {
        // The window is reached at one time only.
        let best = greatest(signal, [begin + c, end]);
        return best.into_iter().map(|top| top.along(begin, begin)).collect();
    }
    let peaks = Peaks::new(&pieces);
    let mut breaks: Vec<f64> = pieces
        .iter()
        .flat_map(|piece| [piece.start - c, piece.end - c, piece.start - d, piece.end - d])
        .filter(|&t| t >= begin && t <= end - c)
        .collect();
    breaks.extend([begin, end - c]);
    breaks.sort_by(f64::total_cmp);
    breaks.dedup();
    let mut ahead = Vec::new();
    for pair in breaks.windows(2) {
        let (p, q) = (pair[0], pair[1]);
        let middle = 0.5 * (p + q);
        let (left, right) = (holding(&pieces, middle + c), holding(&pieces, (middle + d).min(end)));
        let mut candidates: SmallVec<[Piece; 4]> = SmallVec::new();
        candidates.push(pieces[left].earlier(c).part(p, q));
        if middle + d < end {
            candidates.push(pieces[right].earlier(d).part(p, q));
        }
        let whole = if middle + d < end { left + 1..right } else { left + 1..right + 1 };
        let mut tops: SmallVec<[Top; 3]> = SmallVec::new();
        tops.extend(peaks.greatest(whole));
        if left != right || middle + d >= end {
            tops.push(pieces[left].value(pieces[left].end));
            let right = &pieces[right];
            tops.push(right.value(if middle + d < end { right.start } else { right.end }));
        }
        candidates.extend(tops.iter().map(|top| top.along(p, q)));
        envelope(&candidates, p, q, &mut ahead);
    }
    ahead
}

/// The signal of `before` until `goal`: the greatest, over the times s from t + c to t + d, of the lesser of the goal at s and the
/// least of what holds from t until s.
pub fn until_ahead(before: &[Piece], goal: &[Piece], [c, d]: [f64; 2]) -> Vec<Piece> {
    // From t + c on it is that of the time t + c, if what is to hold before does until then; and within the window the goal is reached.
    let ever = ever_reached(before, goal);
    let begin = ever.first().map_or(0.0, |piece| piece.start);
    let moved = ever.iter().map(|piece| piece.earlier(c)).filter(|piece| piece.end > begin);
    let mut signal: Vec<Piece> = moved.map(|piece| piece.part(piece.start.max(begin), piece.end)).collect();
    if c > 0.0 {
        signal = lesser(&signal, &turned(&greatest_ahead(&turned(before), [0.0, c])));
    }
    if d.is_finite() {
        signal = lesser(&signal, &greatest_ahead(goal, [c, d]));
    }
    signal
}

/// The same with all times to come for a window; from the end backwards.
fn ever_reached(before: &[Piece], goal: &[Piece]) -> Vec<Piece> {
    let mut signal: Vec<Piece> = Vec::new();
    let mut later =
        Top { time: 0.0, margin: Robustness::exact(f64::NEG_INFINITY, true), origin: Origin::At(0.0) };
    for [p, q] in beside(before, goal).into_iter().rev() {
        let (x, y) = (p.start, p.end);
        let (p_end, q_end) = (p.value(y), q.value(y));
        let is_rising = |piece: &Piece| piece.at(y) > piece.at(x);
        let (end, after) = (q_end.along(x, y), later.along(x, y));
        let mut found = Vec::new();
        if is_rising(&p) {
            // What holds is least at once: the goal now, or the best to come as far as that holds.
            let to_come = if is_rising(&q) && q_end.margin.exceeds(later.margin) { end } else { after };
            let held = lesser(&[p], &[to_come]);
            held.iter().for_each(|held| {
                envelope(&[q.part(held.start, held.end), *held], held.start, held.end, &mut found);
            });
        } else {
            let middle = 0.5 * (x + y);
            let now = if is_rising(&q) && p.margin(middle).exceeds(q.margin(middle)) { end } else { q };
            let held = if later.margin.exceeds(p_end.margin) { p_end.along(x, y) } else { after };
            envelope(&[now, held], x, y, &mut found);
        }
        if let Some(first) = found.first() {
            later = first.value(x);
        }
        signal.extend(found.into_iter().rev());
    }
    signal.reverse();
    signal
}

/// Two signals over the same stretches, on which each only rises or falls and they do not cross.
fn beside(a: &[Piece], b: &[Piece]) -> Vec<[Piece; 2]> {
    let [a, b] = [a, b].map(|signal| signal.iter().flat_map(|piece| piece.monotone()).collect::<Vec<_>>());
    let mut pairs = Vec::new();
    for [p, q] in stretches(&a, &b) {
        let mut cuts = vec![p.start, p.end];
        crossings(&p, &q, &mut cuts);
        cuts.sort_by(f64::total_cmp);
        cuts.dedup();
        pairs.extend(cuts.windows(2).map(|cut| [p.part(cut[0], cut[1]), q.part(cut[0], cut[1])]));
    }
    pairs
}

/// Two signals over the same stretches.
fn stretches(a: &[Piece], b: &[Piece]) -> Vec<[Piece; 2]> {
    let (Some(a_first), Some(a_last), Some(b_first), Some(b_last)) =
        (a.first(), a.last(), b.first(), b.last())
    else {
        return Vec::new();
    };
    let (begin, end) = (a_first.start.max(b_first.start), a_last.end.min(b_last.end));
    let ends = a.iter().chain(b).flat_map(|piece| [piece.start, piece.end]);
    let mut breaks: Vec<f64> = ends.filter(|&t| begin <= t && t <= end).collect();
    breaks.sort_by(f64::total_cmp);
    breaks.dedup();
    let pair = |cut: &[f64]| {
        let middle = 0.5 * (cut[0] + cut[1]);
        [a, b].map(|signal| signal[holding(signal, middle)].part(cut[0], cut[1]))
    };
    breaks.windows(2).map(pair).collect()
}

/// The lesser of two signals, where both are.
fn lesser(a: &[Piece], b: &[Piece]) -> Vec<Piece> {
    let mut found = Vec::new();
    for pair in stretches(a, b) {
        envelope(&pair.map(|piece| piece.turned()), pair[0].start, pair[0].end, &mut found);
    }
    turned(&found)
}

/// The number of the piece that holds a time.
fn holding(pieces: &[Piece], t: f64) -> usize {
    pieces.partition_point(|piece| piece.end < t).min(pieces.len() - 1)
}

/// The greatest of some pieces over [p, q], piece by piece.
fn envelope(candidates: &[Piece], p: f64, q: f64, found: &mut Vec<Piece>) {
    let mut cuts: Vec<f64> = vec![p, q];
    for (k, a) in candidates.iter().enumerate() {
        for b in &candidates[k + 1..] {
            crossings(a, b, &mut cuts);
        }
    }
    cuts.sort_by(f64::total_cmp);
    cuts.dedup();
    for pair in cuts.windows(2) {
        let (from, to) = (pair[0], pair[1]);
        let middle = 0.5 * (from + to);
        let greater = |a, b| if Piece::margin(a, middle).exceeds(Piece::margin(b, middle)) { a } else { b };
        let Some(best) = candidates.iter().reduce(greater) else { return };
        // Where it meets others at zero, it is closed there if one of them is.
        let [first, last] = [from, to].map(|t| {
            let is_met = |other: &Piece| other.closed && other.margin(t).is_zero();
            best.closed || best.margin(t).is_zero() && candidates.iter().any(is_met)
        });
        if first == last {
            found.push(Piece { closed: first, ..best.part(from, to) });
        } else {
            found.push(Piece { closed: first, ..best.part(from, middle) });
            found.push(Piece { closed: last, ..best.part(middle, to) });
        }
    }
}

/// The times at which two pieces over the same stretch have the same value.
fn crossings(a: &Piece, b: &Piece, times: &mut Vec<f64>) {
    let difference: [f64; 4] = std::array::from_fn(|k| a.cubic[k] - b.cubic[k]);
    if !difference[0].is_finite() {
        return;
    }
    let difference = Piece { cubic: difference, ..*a };
    for part in difference.monotone() {
        let (mut low, mut high) = (part.start, part.end);
        let sign = difference.at(low) < 0.0;
        if (difference.at(high) < 0.0) == sign {
            continue;
        }
        loop {
            let middle = 0.5 * (low + high);
            if middle <= low || middle >= high {
                break;
            }
            if (difference.at(middle) < 0.0) == sign { low = middle } else { high = middle }
        }
        times.push(high);
    }
}

/// The greatest values of pieces, for any range of them: of each power of two pieces from each one on.
struct Peaks {
    levels: Vec<Vec<Top>>,
}

impl Peaks {
    fn new(pieces: &[Piece]) -> Self {
        let mut levels = vec![pieces.iter().map(Piece::top).collect::<Vec<_>>()];
        let mut width = 1;
        while 2 * width <= pieces.len() {
            let below = &levels[levels.len() - 1];
            let level =
                (0..=pieces.len() - 2 * width).map(|k| below[k].or_greater(below[k + width])).collect();
            levels.push(level);
            width *= 2;
        }
        Self { levels }
    }

    fn greatest(&self, range: std::ops::Range<usize>) -> Option<Top> {
        if range.is_empty() {
            return None;
        }
        let level = range.len().ilog2() as usize;
        let of_level = &self.levels[level];
        Some(of_level[range.start].or_greater(of_level[range.end - (1 << level)]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// sin(t) over [0, 20] by pieces of a hundredth.
    fn sine() -> Vec<Piece> {
        let piece = |k: usize| {
            let [a, b] = [k, k + 1].map(|k| k as f64 / 100.0);
            Piece::through(a, b, [a.sin(), b.sin()], [a.cos(), b.cos()], true)
        };
        (0..2000).map(piece).collect()
    }

    fn value(signal: &[Piece], t: f64) -> f64 {
        signal.iter().find(|piece| piece.start <= t && t <= piece.end).unwrap().at(t)
    }

    #[test]
    fn the_greatest_value_ahead_is_that_of_an_end_or_a_peak() {
        let signal = sine();
        for window in [[0.0, 1.0], [0.5, 0.75], [0.0, 3.0], [1.0, 9.0], [0.0, 0.0], [2.0, f64::INFINITY]] {
            let ahead = greatest_ahead(&signal, window);
            for k in 0..500 {
                let t = k as f64 * 0.0173;
                let to = (t + window[1]).min(20.0);
                let (from, steps) = (t + window[0], 2000);
                let samples = (0..=steps).map(|j| (from + (to - from) * j as f64 / steps as f64).sin());
                let expected = samples.fold(f64::NEG_INFINITY, f64::max);
                let actual = value(&ahead, t);
                assert!((actual - expected).abs() < 2e-5, "{window:?} at {t}: {actual} is not {expected}");
                assert!(actual > expected - 1e-9);
            }
        }
    }

    #[test]
    fn extremes_know_when_they_are() {
        let Top { time, margin: Robustness { value, .. }, origin } = greatest(&sine(), [0.5, 4.0]).unwrap();
        assert!((time - std::f64::consts::FRAC_PI_2).abs() < 1e-5 && (value - 1.0).abs() < 1e-9);
        assert_eq!(origin.time(time), time);
        // the least of the greatest over one second: at pi + 1, where both ends are as high
        let ahead = turned(&greatest_ahead(&sine(), [0.0, 1.0]));
        let Top { time, margin: Robustness { value, .. }, origin } = greatest(&ahead, [0.0, 6.0]).unwrap();
        let expected = 1.5 * std::f64::consts::PI - 0.5;
        assert!((time - expected).abs() < 1e-8, "{time}");
        assert!((value + expected.sin()).abs() < 1e-9, "{value}");
        let base = origin.time(time);
        assert!((base - expected).abs() < 1e-6 || (base - expected - 1.0).abs() < 1e-6);
    }

    #[test]
    fn until_is_the_best_of_the_goal_while_the_other_holds() {
        let wave = |f: fn(f64) -> f64, rate: fn(f64) -> f64| -> Vec<Piece> {
            let piece = |k: usize| {
                let [a, b] = [k, k + 1].map(|k| k as f64 / 100.0);
                Piece::through(a, b, [f(a), f(b)], [rate(a), rate(b)], true)
            };
            (0..2000).map(piece).collect()
        };
        let p = |t: f64| 0.4 + (0.7 * t).cos();
        let q = |t: f64| (1.3 * t).sin();
        let before = wave(|t| 0.4 + (0.7 * t).cos(), |t| -0.7 * (0.7 * t).sin());
        let goal = wave(|t| (1.3 * t).sin(), |t| 1.3 * (1.3 * t).cos());
        for window in [[0.0, f64::INFINITY], [0.0, 2.0], [1.5, 4.0], [2.5, f64::INFINITY], [0.0, 0.0]] {
            let signal = until_ahead(&before, &goal, window);
            for k in 0..300 {
                let t = k as f64 * 0.0517;
                let (mut least, mut expected) = (f64::INFINITY, f64::NEG_INFINITY);
                for j in 0..=20_000 {
                    let s = t + j as f64 * 0.001;
                    if s > 20.0 || s > t + window[1] + 1e-9 {
                        break;
                    }
                    if s >= t + window[0] - 1e-9 {
                        expected = expected.max(q(s).min(least));
                    }
                    least = least.min(p(s));
                }
                let actual = value(&signal, t);
                assert!((actual - expected).abs() < 3e-3, "{window:?} at {t}: {actual} is not {expected}");
            }
        }
    }

    #[test]
    fn until_is_reached_by_the_jump_that_ends_what_holds() {
        let step = |first: f64, last: f64| {
            let later = Origin::Later(0.0);
            let [first, last] = [first, last].map(|value| Robustness::exact(value, true));
            [Piece::constant(0.0, 1.0, first, later), Piece::constant(1.0, 3.0, last, later)]
        };
        let (holds, fails) = (f64::INFINITY, f64::NEG_INFINITY);
        let signal = until_ahead(&step(holds, fails), &step(fails, holds), [0.0, f64::INFINITY]);
        assert_eq!([0.2, 1.5, 2.5].map(|t| value(&signal, t)), [holds; 3]);
        let signal = until_ahead(&step(holds, fails), &step(fails, holds), [0.0, 0.5]);
        assert_eq!([0.2, 0.7].map(|t| value(&signal, t)), [fails, holds]);
    }

    #[test]
    fn a_jump_is_no_value_between() {
        let signal = [
            Piece::constant(0.0, 1.0, Robustness::exact(2.0, true), Origin::Later(0.0)),
            Piece::constant(1.0, 3.0, Robustness::exact(-1.0, true), Origin::Later(0.0)),
        ];
        let ahead = greatest_ahead(&signal, [0.5, 1.0]);
        assert_eq!([0.2, 0.6, 1.4].map(|t| value(&ahead, t)), [2.0, -1.0, -1.0]);
    }
}
