//! Slots: how the agents that a function reads are found.

/// How the agent in a slot is found.
#[derive(Clone, Debug, PartialEq)]
pub enum Slot {
    /// `self`, a participant, or an agent bound by a quantifier.
    Root {
        /// Its type.
        ty: usize,
        /// For listings: `self`, `a`, `o`.
        name: String,
    },
    /// The agent that link number `link` of the agent in slot `from` leads to; it may be absent.
    Link {
        /// Where the link starts.
        from: usize,
        /// The number of the link in its type.
        link: usize,
        /// The type of the agent it leads to.
        ty: usize,
        /// For listings: `lead`, `o.lead`.
        name: String,
    },
    /// The value of an aggregate.
    Fold {
        /// Its number in [`Frame::folds`].
        number: usize,
        /// The type over which it goes.
        ty: usize,
        /// For listings: `sum[o in Car]`.
        name: String,
    },
}

impl Slot {
    /// The agent type; of an aggregate that over which it goes.
    pub fn ty(&self) -> usize {
        match self {
            Slot::Root { ty, .. } | Slot::Link { ty, .. } | Slot::Fold { ty, .. } => *ty,
        }
    }

    /// The name for listings.
    pub fn name(&self) -> &str {
        match self {
            Slot::Root { name, .. } | Slot::Link { name, .. } | Slot::Fold { name, .. } => name,
        }
    }
}
