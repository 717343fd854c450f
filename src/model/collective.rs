//! What is asked of, or computed over, all agents of a type.

/// The quantifiers that make conditions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Quantifier {
    /// At least one.
    Exists,
    /// All.
    Forall,
}

/// The quantifiers that make numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Aggregate {
    /// How many there are.
    Count,
    /// The sum of the terms, added in the order of the agents; 0 of none.
    Sum,
    /// The least term; infinite of none.
    Min,
    /// The greatest term; minus infinity of none.
    Max,
}

impl Aggregate {
    /// As it is written.
    pub fn name(self) -> &'static str {
        match self {
            Aggregate::Count => "count",
            Aggregate::Sum => "sum",
            Aggregate::Min => "min",
            Aggregate::Max => "max",
        }
    }
}
