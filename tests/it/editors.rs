//! Does the TextMate grammar colour what the language has? Every keyword, every shipped model, and nothing inside comments.
//!
//! The engine fits here: of all patterns the one that matches first wins, among these the one that stands first; a match has one scope,
//! or one for each captured part. One pattern has an end: up to there its own patterns come before all others, over lines.

use std::fs;
use std::path::PathBuf;

use fancy_regex::Regex;
use hyc::model::SETTINGS;
use serde_json::Value;

struct Pattern {
    regex: Regex,
    scope: Option<String>,
    captures: Vec<(usize, String)>,
    block: Option<Block>,
}

/// What a pattern begins that has an end.
struct Block {
    end: Regex,
    /// Its own patterns; all others follow.
    inside: Vec<Pattern>,
}

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

fn patterns() -> Vec<Pattern> {
    let text = fs::read_to_string(root().join("editors/vscode/syntaxes/hyc.tmLanguage.json")).unwrap();
    let grammar: Value = serde_json::from_str(&text).unwrap();
    grammar["patterns"].as_array().unwrap().iter().map(pattern).collect()
}

fn pattern(value: &Value) -> Pattern {
    let regex = |key: &str| value[key].as_str().map(|text| Regex::new(text).unwrap());
    let keys: Vec<&str> = value.as_object().unwrap().keys().map(String::as_str).collect();
    let (known, captures) = match regex("end") {
        None => (["match", "name", "captures"].as_slice(), &value["captures"]),
        Some(_) => (["begin", "beginCaptures", "end", "patterns"].as_slice(), &value["beginCaptures"]),
    };
    assert!(keys.iter().all(|key| known.contains(key)), "{keys:?}");
    let captures = captures.as_object().into_iter().flatten();
    let block = regex("end").map(|end| {
        let (last, own) = value["patterns"].as_array().unwrap().split_last().unwrap();
        assert_eq!(last["include"], "$self");
        Block { end, inside: own.iter().map(pattern).collect() }
    });
    Pattern {
        regex: regex("match").or_else(|| regex("begin")).unwrap(),
        scope: value["name"].as_str().map(String::from),
        captures: captures
            .map(|(k, scope)| (k.parse().unwrap(), scope["name"].as_str().unwrap().to_string()))
            .collect(),
        block,
    }
}

/// A part of a line with its scope, and where it begins.
type Coloured = (usize, String, String);

/// The coloured parts of a line that stands outside everything.
fn scoped(patterns: &[Pattern], line: &str) -> Vec<Coloured> {
    scoped_within(patterns, &mut None, line)
}

/// The coloured parts of a line; `within` is the block that is open at its begin, then the one at its end.
fn scoped_within<'p>(patterns: &'p [Pattern], within: &mut Option<&'p Block>, line: &str) -> Vec<Coloured> {
    let mut found = Vec::new();
    let mut from = 0;
    while from < line.len() {
        let here: Vec<&Pattern> = within.iter().flat_map(|block| &block.inside).chain(patterns).collect();
        let matches = here.iter().enumerate().filter_map(|(k, pattern)| {
            let captures = pattern.regex.captures_from_pos(line, from).unwrap()?;
            Some((captures.get(0).unwrap().start(), k, captures))
        });
        let first = matches.min_by_key(|(start, k, _)| (*start, *k));
        let end = within.and_then(|block| block.end.find_from_pos(line, from).unwrap());
        if let Some(end) = end.filter(|end| first.as_ref().is_none_or(|(start, ..)| end.start() <= *start)) {
            *within = None;
            from = end.end();
            continue;
        }
        let Some((start, k, captures)) = first else { break };
        let whole = captures.get(0).unwrap();
        assert!(whole.end() > start, "a pattern matches nothing in {line:?}");
        if let Some(scope) = &here[k].scope {
            found.push((start, whole.as_str().to_string(), scope.clone()));
        }
        for (part, scope) in &here[k].captures {
            if let Some(part) = captures.get(*part) {
                found.push((part.start(), part.as_str().to_string(), scope.clone()));
            }
        }
        if let Some(block) = &here[k].block {
            assert!(within.is_none(), "a block in a block: {line:?}");
            *within = Some(block);
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
    let (mut seen, mut settings) = (0, 0);
    for entry in fs::read_dir(root().join("models")).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|ending| ending != "hy") {
            continue;
        }
        let mut within = None;
        for line in fs::read_to_string(&path).unwrap().lines() {
            let in_run = within.is_some() || line.starts_with("run");
            let found = scoped_within(&patterns, &mut within, line);
            let coloured = found.iter().filter(|(_, _, scope)| scope == SETTING).count();
            assert!(in_run || coloured == 0, "{}: {line}", path.display());
            settings += coloured;
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
                    let of_unit = |(start, text, scope): &&Coloured| {
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
    assert!(seen > 500 && settings > 30, "{seen}, {settings}");
}

/// The scope of a setting.
const SETTING: &str = "keyword.other.setting.hyc";

#[test]
fn settings_have_a_colour_where_they_are_settings() {
    let patterns = patterns();
    let coloured = |lines: &[&str]| -> Vec<(usize, usize, String)> {
        let mut within = None;
        let each = lines.iter().enumerate().flat_map(|(number, line)| {
            let found = scoped_within(&patterns, &mut within, line).into_iter();
            found.filter(|(_, _, scope)| scope == SETTING).map(move |(at, text, _)| (number, at, text))
        });
        each.collect()
    };
    for word in SETTINGS {
        let found = scoped(&patterns, &format!("run {{ until 2 [s]  {word} 1 }}"));
        let scope = found.iter().find(|(at, text, _)| *at == 19 && text == word).map(|(.., scope)| scope);
        assert!(scope.is_some_and(|scope| is_of_keywords(scope)), "{word}: {found:?}");
        assert_eq!(coloured(&[&format!("state {word} = 1  {word}' = {word}")]), [], "{word}");
    }
    let found = coloured(&[
        "agent seed { state seed, gamma = 1  flow { seed' = gamma } }",
        "run { // seed",
        "  seed seed*seed  tolerance (gamma)  events to \"seed\"",
        "  record engine.seed, seed every seed to \"e\"  gamma engine [s]",
        "  stop when seed >= gamma or engine.seed' < seed and exists seed in Car: seed.x > 0 // gamma",
        "  backend gamma }",
        "param gamma = seed",
    ]);
    let at = |line: usize, at: usize, text: &str| (line, at, text.to_string());
    assert_eq!(
        found,
        [
            at(2, 2, "seed"),
            at(2, 18, "tolerance"),
            at(2, 37, "events"),
            at(3, 46, "gamma"),
            at(5, 2, "backend")
        ]
    );
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
