//! Kinds of things that name nothing else: of quantifiers, of entries into a mode, of parameters.

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

/// Which submode of a mode is entered.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Inside {
    /// The initial one.
    Initial,
    /// `M.history`: the one that was active last, at *its* initial one; the initial one if the mode was never active.
    History,
}

/// The value of a parameter.
#[derive(Clone, Debug, PartialEq)]
pub enum ParamValue {
    /// A number, SI; booleans are 1 and 0.
    Number(f64),
    /// A text.
    Text(String),
}
