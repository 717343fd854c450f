//! What this floor refuses, each failure with its code and its words.

use crate::base::{Diagnostic, Span};

/// Why a model has no equations.
#[derive(Clone, Debug, PartialEq)]
pub enum Error {
    /// `exists` or `forall` where a number is computed.
    QuantifierInNumber { span: Span },
    /// `not rising(..)`, `not crossing(..)`.
    EventNegated { word: &'static str, span: Span },
    /// Too many agents in one frame.
    TooManySlots { limit: usize, span: Span },
    /// A condition with too many parts.
    ConditionTooLarge { limit: usize, span: Span },
    /// A condition too deeply nested once lets and functions are inlined.
    ConditionTooDeep { limit: usize, span: Span },
    /// Equations that take too long to work out.
    TooMuchWork { limit: u64, span: Span },
}

impl Error {
    /// Whether a limit is exceeded, of which one report is enough.
    pub fn is_limit(&self) -> bool {
        match self {
            Error::TooManySlots { .. }
            | Error::ConditionTooLarge { .. }
            | Error::ConditionTooDeep { .. }
            | Error::TooMuchWork { .. } => true,
            Error::QuantifierInNumber { .. } | Error::EventNegated { .. } => false,
        }
    }

    /// The message to a person.
    pub fn diagnostic(self) -> Diagnostic {
        match self {
            Error::QuantifierInNumber { span } => {
                Diagnostic::error("HY0301", "a quantifier is no truth value that a number could be made of")
                    .label(span, "true or false for a whole set of agents")
                    .help("count: `(count o in Car where ...) >= 1`, or put it into the `if` itself")
            }
            Error::EventNegated { word, span } => {
                Diagnostic::error("HY0302", format!("`{word}` cannot be negated"))
                    .label(span, "true at an instant, so its negation holds nearly always")
                    .help("negate the condition inside it")
            }
            Error::TooManySlots { limit, span } => {
                Diagnostic::error("HY0304", "an expression that reaches too many agents")
                    .label(span, "one more than can be read together")
                    .note(format!("the limit is {limit} agents bound by quantifiers or reached by links"))
                    .help("shorten the chain of links, or test for fewer agents at once")
            }
            Error::ConditionTooLarge { limit, span } => {
                Diagnostic::error("HY0305", "a condition that becomes too large")
                    .label(span, "once lets and functions are put in")
                    .note(format!("the limit is {limit} comparisons and tests"))
                    .help("keep what is used several times in a `discrete`, or split the transition")
            }
            Error::TooMuchWork { limit, span } => {
                Diagnostic::error("HY0307", "the equations of this model become too large")
                    .label(span, "gave up here")
                    .note(format!("once lets and functions are put in, more than {limit} operations were looked at"))
                    .help("functions that call each other twice or more double the work at every level; or raise the limit: `--limit max_operations=N`")
            }
            Error::ConditionTooDeep { limit, span } => {
                Diagnostic::error("HY0306", "a condition that becomes too deeply nested")
                    .label(span, "once lets and functions are put in")
                    .note(format!("the limit is {limit} levels"))
                    .help("shorten the chain of lets or functions that it goes through")
            }
        }
    }
}
