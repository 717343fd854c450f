//! What kinds of values the columns of a table have.

/// A column of a table.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// As the header has it.
    pub name: String,
    /// What its cells hold.
    pub kind: Kind,
}

/// What the cells of a column hold, unless they are empty.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Numbers.
    Number,
    /// Whole numbers from 0.
    Count,
    /// True or false.
    Bool,
    /// Texts; names of agents are texts.
    Text,
}

impl Kind {
    /// The kind that has room for both: text holds everything.
    pub fn with(self, other: Kind) -> Kind {
        if self == other { self } else { Kind::Text }
    }
}

impl Column {
    /// A column of this name and kind.
    pub fn new(name: impl Into<String>, kind: Kind) -> Self {
        Self { name: name.into(), kind }
    }
}
