//! Names that are easily taken for words of the language (HY0612).
//!
//! Two kinds of words: values and functions, which may stand wherever the name may, so that a slip gives another model without an
//! error; and keywords. A name is too close if only its case tells it apart (`Time`, `PI`), if two neighbouring letters have changed
//! places (`form`, `tiem`), or if a letter inside is missing (of keywords: a vowel, as in `whn`). Words that are made longer
//! (`times`, `on1`, `mode_`) are nobody's slip. Labels, modes and types stand where no value does, and are not looked at.

use super::Warning;
use crate::base::Span;
use crate::model::context::{Body, Context};

/// What a name that stands for a value can be confused with.
const VALUES: [&str; 8] = ["pi", "inf", "true", "false", "none", "time", "self", "index"];

/// Keywords of four letters or more; in shorter ones a slip gives any other short name.
const KEYWORDS: [&str; 47] = [
    "after",
    "agent",
    "always",
    "assert",
    "count",
    "create",
    "destroy",
    "discrete",
    "else",
    "emit",
    "entry",
    "event",
    "eventually",
    "every",
    "exists",
    "exit",
    "flow",
    "forall",
    "from",
    "import",
    "initial",
    "interaction",
    "invariant",
    "link",
    "mode",
    "nearest",
    "other",
    "param",
    "priority",
    "property",
    "rate",
    "record",
    "region",
    "state",
    "stop",
    "system",
    "then",
    "until",
    "when",
    "where",
    "rising",
    "crossing",
    "table",
    "spline",
    "clamp",
    "hypot",
    "floor",
];

/// Looks at every name that can stand for a value.
pub(super) fn names(context: &Context, found: &mut Vec<Warning>) {
    for definition in &context.definitions {
        check(&definition.name.text, definition.name.span, found);
        if let Body::Function(item) = definition.body {
            item.formals.iter().for_each(|formal| check(&formal.name.text, formal.name.span, found));
        }
    }
    for ty in context.model.types.iter() {
        let variables = ty.params.iter().chain(&ty.states).chain(&ty.discretes);
        variables.for_each(|variable| check(&variable.name, variable.span, found));
        ty.links.iter().for_each(|link| check(&link.name, link.span, found));
    }
    context.model.binders.iter().for_each(|binder| check(&binder.name, binder.span, found));
    for names in &context.pairs {
        names.item.formals.iter().for_each(|formal| check(&formal.name.text, formal.name.span, found));
    }
}

fn check(name: &str, span: Span, found: &mut Vec<Warning>) {
    if name.len() < 2 || name.starts_with('_') {
        return;
    }
    if let Some((word, same_letters)) = taken_for(name) {
        found.push(Warning::Lookalike { name: name.to_string(), word, span, same_letters });
    }
}

/// The word that a name is easily taken for, and whether it differs in case only.
fn taken_for(name: &str) -> Option<(&'static str, bool)> {
    if let Some(word) = VALUES.into_iter().find(|word| word.eq_ignore_ascii_case(name)) {
        return Some((word, true));
    }
    let slip = |word: &&str| word.len() >= 4 && (swapped(name, word) || lacks_inside(name, word, |_| true));
    let keyword_slip = |word: &&str| swapped(name, word) || lacks_inside(name, word, is_vowel);
    let word = VALUES.into_iter().find(slip).or_else(|| KEYWORDS.into_iter().find(keyword_slip))?;
    Some((word, false))
}

/// Whether the name is the word with two neighbouring letters in each other's place.
fn swapped(name: &str, word: &str) -> bool {
    let (name, word) = (name.as_bytes(), word.as_bytes());
    name.len() == word.len()
        && (1..word.len()).any(|k| {
            name[k] == word[k - 1]
                && name[k - 1] == word[k]
                && name[k] != word[k]
                && name[..k - 1] == word[..k - 1]
                && name[k + 1..] == word[k + 1..]
        })
}

/// Whether the name is the word without one such letter that is neither its first nor its last.
fn lacks_inside(name: &str, word: &str, letter: impl Fn(u8) -> bool) -> bool {
    let (name, word) = (name.as_bytes(), word.as_bytes());
    name.len() + 1 == word.len()
        && (1..word.len() - 1)
            .any(|k| letter(word[k]) && name[..k] == word[..k] && name[k..] == word[k + 1..])
}

fn is_vowel(letter: u8) -> bool {
    b"aeiou".contains(&letter)
}

#[cfg(test)]
mod tests {
    use super::taken_for;

    #[test]
    fn slips_are_found_and_other_names_are_not() {
        let slips = [
            ("form", "from"),
            ("whn", "when"),
            ("tiem", "time"),
            ("tme", "time"),
            ("slef", "self"),
            ("flw", "flow"),
        ];
        for (name, word) in slips {
            assert_eq!(taken_for(name), Some((word, false)), "{name}");
        }
        for (name, word) in [("Time", "time"), ("PI", "pi"), ("True", "true"), ("Inf", "inf")] {
            assert_eq!(taken_for(name), Some((word, true)), "{name}");
        }
        let innocent = "on1 times time0 modes mode_ stat node slow low gate date sink stage lane line one ten phi p1 info \
             shelf rates events states links sum_ max1 top stp_ cat tau trunk lead tail fall form_ far T t x v";
        for name in innocent.split_whitespace() {
            assert_eq!(taken_for(name), None, "{name}");
        }
    }
}
