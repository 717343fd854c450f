//! Why an agent cannot be made or removed: a variant for each reason.

use crate::base::{Diagnostic, Span, number_text};
use crate::codegen::trace::Blame;
use crate::runtime::failure::{Failure, Place, with_blame};

/// Why a run stops in error at a birth or a death.
#[derive(Clone, Debug)]
pub enum Fate {
    /// `max_agents`.
    TooMany {
        /// Who creates.
        place: Place,
        /// The limit.
        limit: usize,
        /// The action.
        span: Span,
    },
    /// `max_generations`.
    Generations {
        /// Who creates.
        place: Place,
        /// The limit.
        limit: u32,
        /// The transition.
        span: Span,
    },
    /// A variable would start with what is no number.
    StartNotFinite {
        /// Who creates.
        place: Place,
        /// `Car#17.x`
        variable: String,
        /// What it would start with.
        value: f64,
        /// What made it so.
        blame: Option<Blame>,
        /// The action.
        span: Span,
    },
    /// A parameter of a distribution is out of range.
    BadDraw {
        /// Who creates.
        place: Place,
        /// `the mean of `Normal``
        parameter: String,
        /// What it has to be.
        needs: &'static str,
        /// What it is.
        value: f64,
        /// The distribution.
        span: Span,
    },
    /// A parameter of agent type is none.
    RequiredNone {
        /// Who creates.
        place: Place,
        /// `Car#17.lead`
        parameter: String,
        /// The action.
        span: Span,
    },
    /// `max_joining`.
    SetFull {
        /// Whose flow reads the set.
        place: Place,
        /// The type of its members.
        members: String,
        /// The limit.
        limit: usize,
        /// Who joins is created here.
        span: Span,
    },
    /// An agent that is to be destroyed is a parameter of one that lives on.
    Held {
        /// Who is to be destroyed.
        place: Place,
        /// Who lives on.
        holder: String,
        /// The name of the parameter.
        parameter: String,
        /// The action.
        span: Span,
    },
}

impl From<Fate> for Failure {
    fn from(fate: Fate) -> Self {
        Failure::Model(Box::new(fate.diagnostic()))
    }
}

impl Fate {
    fn diagnostic(&self) -> Diagnostic {
        match self {
            Fate::TooMany { place, limit, span } => {
                let diagnostic = Diagnostic::error("HY0530", format!("more than {limit} agents"))
                    .label(*span, "this would be one more");
                place.add_to(diagnostic).help(
                    "does each create another, in no time? destroy those that are done, or raise the limit: \
                     `--limit max_agents=N`",
                )
            }
            Fate::Generations { place, limit, span } => {
                let title = format!("agents have created agents {limit} times in a row in one instant");
                place.add_to(Diagnostic::error("HY0530", title).label(*span, "and once more here")).help(
                    "does each create another, in no time? let the newborn wait, or raise the limit: \
                     `--limit max_generations=N`",
                )
            }
            Fate::StartNotFinite { place, variable, value, blame, span } => {
                let diagnostic =
                    Diagnostic::error("HY0531", format!("`{variable}` would start with {value}"))
                        .label(*span, "created here");
                place
                    .add_to(with_blame(diagnostic, blame.as_ref()))
                    .help("check the operands: a link that is none, a division by zero, a root of a negative number?")
            }
            Fate::BadDraw { place, parameter, needs, value, span } => {
                let title = format!("{parameter} is {}", number_text(*value));
                let diagnostic =
                    Diagnostic::error("HY0532", title).label(*span, format!("needs to be {needs}"));
                place.add_to(diagnostic)
            }
            Fate::RequiredNone { place, parameter, span } => {
                let diagnostic = Diagnostic::error("HY0533", format!("`{parameter}` is none"))
                    .label(*span, "created here");
                place
                    .add_to(diagnostic)
                    .help("a parameter of agent type is never none; what may be none is declared as a `link`")
            }
            Fate::SetFull { place, members, limit, span } => {
                let reader = &place.agent;
                let title = format!(
                    "more than {limit} agents of `{members}` join the set that the flow of `{reader}` reads"
                );
                place.add_to(Diagnostic::error("HY0536", title).label(*span, "this would be one more")).help(
                    "room is free again when one is destroyed; the formula of the flow has a term for each: \
                     `--limit max_joining=N`",
                )
            }
            Fate::Held { place, holder, parameter, span } => {
                let agent = &place.agent;
                let title =
                    format!("`{agent}` is destroyed, and is `{parameter}` of `{holder}`, which is not");
                place.add_to(Diagnostic::error("HY0534", title).label(*span, "destroyed here")).help(
                    "a parameter of agent type is never none: declare a `link`, which becomes none, or destroy both at once",
                )
            }
        }
    }
}
