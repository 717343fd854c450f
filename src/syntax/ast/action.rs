//! Actions: what transitions, entries and exits do.

use super::{Constructor, Expr, Given, Name, Target, Text};
use crate::base::Span;

/// A list of actions in braces.
#[derive(Clone, Debug, PartialEq)]
pub struct Actions {
    /// The actions, in order.
    pub actions: Vec<Action>,
    /// The braces and what they hold.
    pub span: Span,
}

/// One action.
#[derive(Clone, Debug, PartialEq)]
pub struct Action {
    /// What it does.
    pub kind: ActionKind,
    /// Its place.
    pub span: Span,
}

/// The kinds of actions.
#[derive(Clone, Debug, PartialEq)]
pub enum ActionKind {
    /// `x := e`, `a.x ~ Normal(0, 1)`
    Assign {
        /// What is written.
        place: Place,
        /// The new value.
        given: Given,
    },
    /// `create Car(v = 3)`
    Create(Box<Constructor>),
    /// `destroy self`
    Destroy(Expr),
    /// `emit braking(3) after 1 [s]`
    Emit {
        /// The event, in an interaction behind its sender and a dot.
        event: Place,
        /// What it carries.
        args: Vec<Expr>,
        /// When it is delivered.
        delay: Option<Box<Expr>>,
    },
    /// `a -> Avoid`, in an interaction
    ChangeMode {
        /// The participant.
        participant: Name,
        /// Its new mode.
        target: Target,
    },
    /// `stop "why"`
    Stop(Option<Text>),
    /// `if c { ... } else if d { ... } else { ... }`
    If {
        /// Conditions and what each leads to, in order; never empty.
        branches: Vec<Branch>,
        /// What happens if none holds.
        otherwise: Option<Actions>,
    },
}

/// One branch of an `if` among actions.
#[derive(Clone, Debug, PartialEq)]
pub struct Branch {
    /// Its condition.
    pub condition: Expr,
    /// What happens if it is the first that holds.
    pub actions: Actions,
}

/// What an action names: `x`, or `a.x` of a participant.
#[derive(Clone, Debug, PartialEq)]
pub struct Place {
    /// The agent before the dot.
    pub owner: Option<Box<Name>>,
    /// The variable, or the event.
    pub variable: Name,
    /// Both.
    pub span: Span,
}
