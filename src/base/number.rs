//! Numbers as text: as few digits as read back to the same number.

/// Appends `value`: positional from 1e-5 up to 1e16, else with an exponent; `inf`, `-inf`, `NaN`; `-0` keeps its sign.
///
/// The digits are the fewest from which the same `f64` is read back.
pub fn write_number(text: &mut String, value: f64) {
    let mut buffer = zmij::Buffer::new();
    parts(buffer.format(value)).iter().for_each(|part| text.push_str(part));
}

/// The same, to bytes.
pub fn append_number(bytes: &mut Vec<u8>, value: f64) {
    let mut buffer = zmij::Buffer::new();
    parts(buffer.format(value)).iter().for_each(|part| bytes.extend_from_slice(part.as_bytes()));
}

/// The text that [`write_number`] appends.
pub fn number_text(value: f64) -> String {
    let mut text = String::new();
    write_number(&mut text, value);
    text
}

/// The library writes a fraction behind every number without an exponent, `1.0`, and the sign of every exponent, `1e+16`.
fn parts(text: &str) -> [&str; 3] {
    match text.split_once("e+") {
        Some((digits, exponent)) => [digits, "e", exponent],
        None => [text.strip_suffix(".0").unwrap_or(text), "", ""],
    }
}

#[cfg(test)]
mod tests {
    use std::fmt::Write;

    use super::*;

    /// By the standard library, which is slower.
    fn slowly(value: f64) -> String {
        let mut text = String::new();
        let size = value.abs();
        let positional = size == 0.0 || !size.is_finite() || (1e-5..1e16).contains(&size);
        let written = if positional { write!(text, "{value}") } else { write!(text, "{value:e}") };
        written.unwrap();
        text
    }

    #[test]
    fn numbers_look_as_the_standard_library_writes_them() {
        let mut awkward =
            vec![0.0, -0.0, 1.0, -1.0, 0.1, 1e-5, 9.999e-6, 1e15, 1e16, 1e17, 123456.0, f64::NAN];
        awkward.extend([
            f64::INFINITY,
            f64::NEG_INFINITY,
            f64::MAX,
            f64::MIN_POSITIVE,
            5e-324,
            1e21,
            1e22,
            1e23,
        ]);
        awkward.extend((-330..310).map(|k| format!("1e{k}").parse::<f64>().unwrap()));
        // a linear congruence over all bit patterns, and over numbers of everyday size
        let mut bits: u64 = 1;
        for _ in 0..20_000 {
            bits = bits.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            awkward.extend([f64::from_bits(bits), (bits >> 11) as f64 / 1e12, (bits >> 40) as f64 / 1000.0]);
        }
        for value in awkward {
            let (quick, slow) = (number_text(value), slowly(value));
            // of two texts with as few digits, equally near, the libraries may choose differently
            let is_tie = quick.len() == slow.len() && quick.parse() == Ok(value);
            assert!(quick == slow || is_tie, "{quick} is not {slow}: {:x}", value.to_bits());
            let (mut bytes, mut text) = (vec![b'='], String::from("="));
            append_number(&mut bytes, value);
            write_number(&mut text, value);
            assert_eq!(bytes, text.as_bytes());
        }
    }
}
