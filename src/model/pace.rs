//! When a record has rows.

/// When a record has rows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Pace {
    /// At every accepted step, and on both sides of every event.
    EveryStep,
    /// At k d, for this d, s.
    Every(f64),
    /// At k d, where d doubles as the run goes on, and at its end.
    Thinning(Thinning),
}

/// Samples of a run that may end at any time: whenever there are too many, every second one is given up and the others are twice as
/// far apart from then on. So a run has between half as many as it may have and as many, wherever it ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Thinning {
    /// The first distance of samples, s.
    pub first: f64,
    /// So many samples there are at most, beside that at t = 0.
    pub samples_most: usize,
    /// Where there are more rows than these, samples are given up down to `samples_least`.
    pub rows_enough: usize,
    /// See `rows_enough`.
    pub samples_least: usize,
    /// So many rows there are at most, however few samples that makes.
    pub rows_most: usize,
    /// So many agents have a row in one sample, those with the lowest numbers.
    pub agents_most: usize,
    /// Before this time an eighth of all these is enough, s.
    pub coarse_until: f64,
}
