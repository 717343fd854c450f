//! Does the TextMate grammar colour what the language has? Every keyword, every shipped model, and nothing inside comments.
//!
//! The grammar has patterns of one line only, so the engine fits here: of all patterns the one that matches first wins, among
//! these the one that stands first; a match has one scope, or one for each captured part.

use std::fs;
use std::path::PathBuf;

use fancy_regex::Regex;
use serde_json::Value;

struct Pattern {
    regex: Regex,
    scope: Option<String>,
    captures: Vec<(usize, String)>,
}

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

fn patterns() -> Vec<Pattern> {
    let text = fs::read_to_string(root().join("editors/vscode/syntaxes/hyc.tmLanguage.json")).unwrap();
    let grammar: Value = serde_json::from_str(&text).unwrap();
    let pattern = |value: &Value| {
        let keys: Vec<&String> = value.as_object().unwrap().keys().collect();
        assert!(keys.iter().all(|key| ["match", "name", "captures"].contains(&key.as_str())), "{keys:?}");
        let scopes = value["captures"].as_object();
        let captures = scopes.into_iter().flatten();
        Pattern {
            regex: Regex::new(value["match"].as_str().unwrap()).unwrap(),
            scope: value["name"].as_str().map(String::from),
            captures: captures
                .map(|(k, scope)| (k.parse().unwrap(), scope["name"].as_str().unwrap().to_string()))
                .collect(),
        }
    };
    grammar["patterns"].as_array().unwrap().iter().map(pattern).collect()
}

/// The coloured parts of a line with their scopes.
fn scoped(patterns: &[Pattern], line: &str) -> Vec<(usize, String, String)> {
    let mut found = Vec::new();
    let mut from = 0;
    while from < line.len() {
        let matches = patterns.iter().enumerate().filter_map(|(k, pattern)| {
            let captures = pattern.regex.captures_from_pos(line, from).unwrap()?;
            Some((captures.get(0).unwrap().start(), k, captures))
        });
        let Some((start, k, captures)) = matches.min_by_key(|(start, k, _)| (*start, *k)) else { break };
        let whole = captures.get(0).unwrap();
        assert!(whole.end() > start, "a pattern matches nothing in {line:?}");
        if let Some(scope) = &patterns[k].scope {
            found.push((start, whole.as_str().to_string(), scope.clone()));
        }
        for (part, scope) in &patterns[k].captures {
            if let Some(part) = captures.get(*part) {
                found.push((part.start(), part.as_str().to_string(), scope.clone()));
            }
        }
        from = whole.end();
    }
    found
}

/// The keywords of the language, from its grammar.
fn keywords() -> Vec<String> {
    let grammar = fs::read_to_string(root().join("grammar/hy.pest")).unwrap();
    let rules = grammar.lines().filter_map(|line| line.strip_prefix("kw_")?.split('"').nth(1));
    let words: Vec<String> = rules.map(String::from).collect();
    assert!(words.len() > 50);
    words
}

fn is_of_keywords(scope: &str) -> bool {
    scope.starts_with("keyword.") || scope.starts_with("storage.")
}

#[test]
fn every_keyword_has_a_colour() {
    let patterns = patterns();
    for word in keywords() {
        for line in [word.clone(), format!("  {word} {{"), format!("x {word} y")] {
            let found = scoped(&patterns, &line);
            let scope = found.iter().find(|(_, text, _)| *text == word);
            assert!(scope.is_some_and(|(_, _, scope)| is_of_keywords(scope)), "{line:?}: {found:?}");
        }
        let longer = scoped(&patterns, &format!("{word}_x my{word}"));
        assert!(longer.is_empty(), "{longer:?}");
    }
}

#[test]
fn every_word_of_every_model_has_the_colour_of_what_it_is() {
    let (patterns, keywords) = (patterns(), keywords());
    let mut seen = 0;
    for entry in fs::read_dir(root().join("models")).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|ending| ending != "hy") {
            continue;
        }
        for line in fs::read_to_string(&path).unwrap().lines() {
            let found = scoped(&patterns, line);
            let outside = line.split("//").next().unwrap();
            if let Some(at) = line.find("//").filter(|at| line[..*at].matches('"').count() % 2 == 0) {
                let comment = (at, line[at..].to_string(), "comment.line.double-slash.hyc".to_string());
                assert_eq!(found.last(), Some(&comment), "{line}");
            }
            let mut at = 0;
            for part in outside.split_inclusive('"') {
                let quoted = outside[..at].matches('"').count() % 2 == 1;
                let words = part
                    .split(|c: char| !c.is_alphanumeric() && c != '_')
                    .filter(|word| !quoted && !word.is_empty());
                for word in words.filter(|word| keywords.iter().any(|keyword| keyword == word)) {
                    let place = at
                        + part
                            .match_indices(word)
                            .map(|(k, _)| k)
                            .find(|k| is_whole(part, *k, word))
                            .unwrap();
                    let of_unit = |(start, text, scope): &&(usize, String, String)| {
                        scope == "constant.other.unit.hyc" && (*start..start + text.len()).contains(&place)
                    };
                    if found.iter().find(of_unit).is_some() {
                        continue;
                    }
                    let scope = found.iter().find(|(start, text, _)| *start == place && text == word);
                    let scope = scope.map(|(_, _, scope)| scope.as_str());
                    let right =
                        scope.is_some_and(|scope| is_of_keywords(scope) || scope == "support.function.hyc");
                    assert!(right, "{}: `{word}` is {scope:?} in {line}", path.display());
                    seen += 1;
                }
                at += part.len();
            }
        }
    }
    assert!(seen > 500, "{seen}");
}

fn is_whole(text: &str, at: usize, word: &str) -> bool {
    let part = |c: char| c.is_alphanumeric() || c == '_';
    !text[..at].chars().next_back().is_some_and(part)
        && !text[at + word.len()..].chars().next().is_some_and(part)
}

#[test]
fn parts_of_a_line_are_told_apart() {
    let patterns = patterns();
    let scopes = |line: &str| -> Vec<(String, String)> {
        scoped(&patterns, line)
            .into_iter()
            .map(|(_, text, scope)| (text, scope.replace(".hyc", "")))
            .collect()
    };
    let pair = |text: &str, scope: &str| (text.to_string(), scope.to_string());
    assert_eq!(
        scopes("  close: when min(a, 2 [m]) <= R -> Avoid // near"),
        [
            pair("close", "entity.name.tag"),
            pair(":", "punctuation.separator"),
            pair("when", "keyword.control"),
            pair("min", "support.function"),
            pair("2", "constant.numeric"),
            pair("[m]", "constant.other.unit"),
            pair("<=", "keyword.operator"),
            pair("->", "keyword.operator"),
            pair("// near", "comment.line.double-slash"),
        ]
    );
    assert_eq!(scopes("mode Brake {")[1], pair("Brake", "entity.name.section"));
    assert_eq!(
        scopes("x: real [m/s^2] = 1.5e-3")[..2],
        [pair("real", "support.type"), pair("[m/s^2]", "constant.other.unit")]
    );
    assert_eq!(scopes("cars[3]"), [pair("3", "constant.numeric")]);
}
