//! Numbers as text: as few digits as read back to the same number.

use std::fmt::Write;

/// Appends `value`: positional from 1e-5 up to 1e16, else with an exponent; `inf`, `-inf`, `NaN`; `-0` keeps its sign.
///
/// The digits are the fewest from which the same `f64` is read back.
pub fn write_number(text: &mut String, value: f64) {
    let size = value.abs();
    let positional = size == 0.0 || !size.is_finite() || (1e-5..1e16).contains(&size);
    let written = if positional { write!(text, "{value}") } else { write!(text, "{value:e}") };
    written.expect("writing to memory cannot fail");
}

/// The text that [`write_number`] appends.
pub fn number_text(value: f64) -> String {
    let mut text = String::new();
    write_number(&mut text, value);
    text
}
