//! "Did you mean": the known name that is closest to a mistyped one.

use std::cmp::Reverse;

/// Among more names than these nothing is suggested: it would take longer than all else.
const CANDIDATES_MAX: usize = 2_000;

/// The closest of the candidates, if it is close enough to be what was meant; of two the one that begins alike, then the one with
/// fewer other capitals, then the first in the alphabet.
pub(super) fn closest<'c>(name: &str, candidates: impl IntoIterator<Item = &'c str>) -> Option<String> {
    let candidates = candidates.into_iter();
    if candidates.size_hint().0 > CANDIDATES_MAX {
        return None;
    }
    let candidates: Vec<&str> = candidates.take(CANDIDATES_MAX + 1).collect();
    if candidates.len() > CANDIDATES_MAX {
        return None;
    }
    let length = name.chars().count();
    let allowed = (length / 3).max(1);
    candidates
        .into_iter()
        .filter(|candidate| *candidate != name && candidate.chars().count().abs_diff(length) <= allowed)
        .map(|candidate| {
            let alike = Reverse(begin_alike(name, candidate));
            (distance(name, candidate), alike, strsim::osa_distance(name, candidate), candidate)
        })
        .filter(|(distance, _, _, candidate)| {
            *distance <= allowed && *distance < candidate.chars().count().max(1)
        })
        .min()
        .map(|(_, _, _, candidate)| candidate.to_string())
}

/// How many letters two names share at their beginning.
fn begin_alike(name: &str, candidate: &str) -> usize {
    name.chars().zip(candidate.chars()).take_while(|(a, b)| a == b).count()
}

/// Edits between two names; letters that differ in case only count as equal.
fn distance(name: &str, candidate: &str) -> usize {
    strsim::osa_distance(name, candidate)
        .min(strsim::osa_distance(&name.to_lowercase(), &candidate.to_lowercase()))
}

#[cfg(test)]
mod tests {
    use super::closest;

    #[test]
    fn only_near_names_are_suggested() {
        assert_eq!(closest("raod", ["road", "len", "lanes"]), Some("road".to_string()));
        assert_eq!(closest("car", ["Car", "cars"]), Some("Car".to_string()));
        assert_eq!(closest("sinn", ["sign", "sin"]), Some("sin".to_string()));
        assert_eq!(closest("Km", ["kM", "km"]), Some("km".to_string()));
        assert_eq!(closest("z", ["x", "y"]), None);
        assert_eq!(closest("velocity", ["v", "x"]), None);
    }
}
