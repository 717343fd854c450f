//! Failures of dimensions.

use crate::base::{Diagnostic, Label, Span};
use crate::math::Op;
use crate::model::dimension::{Dimension, in_unit};

/// Something with a dimension.
#[derive(Clone, Copy, Debug)]
pub(in crate::model) struct Side {
    /// Where it stands.
    pub span: Span,
    /// Its dimension.
    pub dimension: Dimension,
}

/// Why a dimension is what it is, and what to type.
#[derive(Clone, Debug)]
pub(in crate::model) struct Evidence {
    /// The declarations and literals that gave it, and the calls around.
    pub origins: Vec<Label>,
    /// What to type.
    pub help: String,
}

/// Dimensions that do not go together.
pub(in crate::model) enum DimensionError {
    /// Two operands that must be alike.
    Unlike { op: Op, function: Option<String>, whole: Span, sides: [Side; 2], evidence: Evidence },
    /// A value that goes into something that is declared in another unit, or that the language gives another.
    Into { what: String, by_language: bool, needed: Dimension, found: Side, evidence: Evidence },
    /// A quantity where a function needs a pure number.
    NotPure { function: &'static str, found: Side, evidence: Evidence },
    /// An exponent with a dimension.
    Exponent { found: Side, evidence: Evidence },
    /// A power of a quantity whose exponent is no constant fraction.
    Power { base: Side, exponent: Span, why: String, evidence: Evidence },
    /// Exponents beyond all measure.
    TooLarge { span: Span },
}

impl From<DimensionError> for Diagnostic {
    fn from(error: DimensionError) -> Self {
        match error {
            DimensionError::Unlike { op, function, whole, sides: [a, b], evidence } => {
                let title = unlike(op, function, a.dimension, b.dimension);
                let unlike = Diagnostic::error("HY0230", title);
                let is_inside =
                    whole.file == b.span.file && whole.start <= b.span.start && b.span.end <= whole.end;
                let unlike = if is_inside { unlike } else { unlike.label(whole, "here") };
                let sides = [b, a].into_iter();
                let sides = sides.map(|side| Label { span: side.span, text: this_is(side.dimension) });
                supported(sides.fold(unlike, |all, label| all.label(label.span, label.text)), evidence)
            }
            DimensionError::Into { what, by_language, needed, found, evidence } => {
                let code = match needed {
                    Dimension::TIME if by_language => "HY0233",
                    Dimension::ONE if by_language => "HY0232",
                    _ => "HY0231",
                };
                let title = format!("{what} must be {}, not {}", in_unit(needed), in_unit(found.dimension));
                supported(
                    Diagnostic::error(code, title).label(found.span, this_is(found.dimension)),
                    evidence,
                )
            }
            DimensionError::NotPure { function, found, evidence } => {
                let title =
                    format!("`{function}` needs a pure number, not a quantity {}", in_unit(found.dimension));
                supported(
                    Diagnostic::error("HY0232", title).label(found.span, this_is(found.dimension)),
                    evidence,
                )
            }
            DimensionError::Exponent { found, evidence } => {
                let title = format!("an exponent must be a pure number, not {}", in_unit(found.dimension));
                supported(
                    Diagnostic::error("HY0234", title).label(found.span, this_is(found.dimension)),
                    evidence,
                )
            }
            DimensionError::Power { base, exponent, why, evidence } => {
                let title = format!(
                    "the exponent of a quantity {} must be a constant fraction",
                    in_unit(base.dimension)
                );
                let power = Diagnostic::error("HY0234", title)
                    .label(exponent, why)
                    .label(base.span, this_is(base.dimension));
                supported(power, evidence)
            }
            DimensionError::TooLarge { span } => {
                Diagnostic::error("HY0235", "this dimension is beyond all measure")
                    .label(span, "its exponents cannot be represented")
                    .help("leave out a unit where it is declared: what has none is not checked")
            }
        }
    }
}

fn unlike(op: Op, function: Option<String>, a: Dimension, b: Dimension) -> String {
    let word = |dimension: Dimension| match dimension {
        Dimension::ONE => "a pure number".to_string(),
        _ => dimension.to_string(),
    };
    let (a, b) = (word(a), word(b));
    match (op, function) {
        (_, Some(function)) => format!("`{function}` cannot take {a} and {b} together"),
        (Op::Add, None) => format!("{a} and {b} cannot be added"),
        (Op::Sub, None) => format!("{b} cannot be subtracted from {a}"),
        (Op::Select, None) => format!("an `if` cannot be {a} in one branch and {b} in the other"),
        _ => format!("{a} and {b} cannot be compared"),
    }
}

fn this_is(dimension: Dimension) -> String {
    format!("this is {}", in_unit(dimension))
}

fn supported(diagnostic: Diagnostic, evidence: Evidence) -> Diagnostic {
    let all = evidence.origins.into_iter().fold(diagnostic, |all, label| all.label(label.span, label.text));
    all.help(evidence.help)
}
