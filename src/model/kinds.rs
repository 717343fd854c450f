//! Kinds of things that name nothing else: of entries into a mode, of parameters.

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
