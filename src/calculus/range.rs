//! Over which agents a quantifier or an aggregate goes, and how near two agents must be to matter to each other.

/// Agents that a quantifier binds one after the other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Range {
    /// The slot it binds.
    pub slot: usize,
    /// The type.
    pub ty: usize,
    /// Without self (in an interaction: without both participants).
    pub other: bool,
}

/// `|a.x - b.y| <= within`, for x a state of the agent in slot 0 and y one of the agent in slot 1 or in that of a quantifier.
///
/// Bounds of differences of real numbers: where states are so large that their own rounding counts, so it does here.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Near {
    /// Which state of the agent in slot 0.
    pub own: usize,
    /// Which state of the other one.
    pub other: usize,
    /// At least 0, finite.
    pub within: f64,
}
