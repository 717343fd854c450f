//! How the expression of a comparison is compared with zero: what is true on the boundary (rule 3).

/// How an atom compares g with zero.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Relation {
    /// g <= 0: true on the boundary.
    NonPositive,
    /// g < 0: false on the boundary.
    Negative,
    /// `crossing(g)`: true at the instants at which g changes its sign.
    Crossing,
}
