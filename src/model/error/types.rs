//! Failures of types and units.

use super::with_similar_or;
use crate::base::{Diagnostic, Span};
use crate::model::units::UnitProblem;

/// An expression whose type does not go with its place.
pub(in crate::model) enum TypeError {
    /// A value of another type is needed.
    Mismatch { what: String, expected: String, found: String, span: Span, help: Option<String> },
    /// A real number where a whole one is needed.
    RealToInt { what: String, span: Span, text: String },
    /// A condition is needed.
    NotACondition { found: String, span: Span },
    /// An operator or a function cannot take this operand.
    Operand { operator: String, needs: &'static str, found: String, span: Span },
    /// `[ ]` behind something that is neither a number nor a type, with a unit in it.
    UnitBehind { unit: String, base: Span, span: Span },
    /// `==` between numbers that change continuously.
    EqualReals { span: Span, left: String, right: String },
    /// A declaration of a type that cannot be there.
    NotAllowed { what: &'static str, found: String, span: Span, help: &'static str },
    /// A function with the wrong number of arguments.
    Arguments { function: String, least: usize, most: usize, found: usize, span: Span },
    /// A dot behind something that is no agent.
    NotAnAgent { found: String, span: Span },
    /// A text that is no unit.
    Unit { problem: UnitProblem, span: Span },
    /// A unit on something that is no real number.
    UnitOnType { ty: String, span: Span },
    /// A literal beyond the largest number, once converted.
    TooLarge { span: Span },
}

impl From<TypeError> for Diagnostic {
    fn from(error: TypeError) -> Self {
        match error {
            TypeError::Mismatch { what, expected, found, span, help } => {
                let mismatch = Diagnostic::error("HY0220", format!("{what} must be {expected}"))
                    .label(span, format!("this is {found}"));
                match help {
                    Some(help) => mismatch.help(help),
                    None => mismatch,
                }
            }
            TypeError::RealToInt { what, span, text } => {
                let text = if text.len() > 40 || text.contains('\n') { "..." } else { text.as_str() };
                Diagnostic::error("HY0221", format!("{what} must be a whole number"))
                    .label(span, "this is a real number")
                    .help(format!("say how it becomes whole: `round({text})`, `floor` or `ceil`"))
            }
            TypeError::NotACondition { found, span } => {
                Diagnostic::error("HY0222", "a condition is needed").label(span, format!("this is {found}")).help(
                    "a condition is a comparison, a bool, or a link (whether it is there); numbers are not true or false",
                )
            }
            TypeError::Operand { operator, needs, found, span } => {
                Diagnostic::error("HY0223", format!("`{operator}` needs {needs}"))
                    .label(span, format!("this is {found}"))
            }
            TypeError::UnitBehind { unit, base, span } => Diagnostic::error(
                "HY0111",
                format!("a unit cannot stand here: `[{unit}]` follows neither a number nor a type"),
            )
            .label(span, "unit")
            .label(base, "this is neither a number nor a type")
            .help("give the unit where the name is declared, or to a number: `1 [m]*x`"),
            TypeError::EqualReals { span, left, right } => {
                let short = left.len() + right.len() <= 60 && !left.contains('\n') && !right.contains('\n');
                let simple = right.chars().all(|c| c.is_alphanumeric() || matches!(c, '.' | '_'));
                let right = if simple { right } else { format!("({right})") };
                let example =
                    if short { format!("`crossing({left} - {right})`") } else { "`crossing(a - b)`".to_string() };
                Diagnostic::error("HY0224", "real numbers that change continuously are never compared by `==` or `!=`")
                    .label(span, "true at isolated instants, if at all")
                    .help(format!("for the instant at which they meet write {example} in a guard"))
            }
            TypeError::NotAllowed { what, found, span, help } => {
                Diagnostic::error("HY0225", format!("{what} cannot be {found}")).label(span, "not possible").help(help)
            }
            TypeError::Arguments { function, least, most, found, span } => {
                let count = |n: usize| if n == 1 { "1 argument".to_string() } else { format!("{n} arguments") };
                let takes = match most - least {
                    0 => count(most),
                    1 => format!("{least} or {}", count(most)),
                    _ => format!("{least} to {}", count(most)),
                };
                Diagnostic::error("HY0226", format!("`{function}` takes {takes}"))
                    .label(span, format!("{} given", count(found)))
            }
            TypeError::NotAnAgent { found, span } => {
                Diagnostic::error("HY0227", "only agents have members").label(span, format!("this is {found}"))
            }
            TypeError::Unit { problem, span } => unit(problem, span),
            TypeError::UnitOnType { ty, span } => {
                Diagnostic::error("HY0229", format!("only real numbers have a unit, not `{ty}`"))
                    .label(span, "this unit").help("leave the unit out, or declare it `real`")
            }
            TypeError::TooLarge { span } => {
                Diagnostic::error("HY0263", "this number is too large").label(span, "infinite in SI units")
            }
        }
    }
}

/// `span` covers the brackets too; the problem's range counts from the first byte after the opening one.
fn unit(problem: UnitProblem, span: Span) -> Diagnostic {
    match problem {
        UnitProblem::Unknown { name, similar, .. } => with_similar_or(
            Diagnostic::error("HY0228", format!("there is no unit `{name}`")).label(span, "not known"),
            &similar,
            "units are those of SI, with prefixes: m, mm, kg, s, N, kW, and a few others: min, h, deg",
        ),
        UnitProblem::Offset { name, .. } => {
            Diagnostic::error("HY0228", format!("`{name}` is not a unit here: its zero is not absolute zero"))
                .label(span, "cannot be converted by a factor")
                .help("use `K`: 20 degrees Celsius are 293.15 [K], and a difference of 1 degree is 1 [K]")
        }
        UnitProblem::Malformed { expected, .. } => Diagnostic::error("HY0228", "this is not a unit")
            .label(span, format!("expected {expected}"))
            .help("a unit is made of names, `1`, `*`, `/` and integer powers: m/s^2, kg*m^2, 1/s"),
        UnitProblem::TooLarge { .. } => Diagnostic::error("HY0228", "this unit is beyond all measure")
            .label(span, "its exponents or its size cannot be represented"),
    }
}
