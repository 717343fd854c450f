//! Mutations of model texts: what a slip of the hand, a merge gone wrong or a fuzzer makes of a model.
//!
//! In: dice, all the texts. Out: one text. Most mutations keep the tokens whole, so that many mutants get far beyond the
//! parser; some break characters.

use crate::differential::dice::Dice;

/// Numbers that something may have forgotten.
const NUMBERS: [&str; 36] = [
    "0",
    "1",
    "2",
    "3",
    "7",
    "100",
    "0.5",
    "1e-9",
    "1e-300",
    "5e-324",
    "1e9",
    "1e15",
    "9007199254740993",
    "1e18",
    "1e100",
    "1e308",
    "1.7976931348623157e308",
    "(-1)",
    "(-0.5)",
    "(-0)",
    "(-1e308)",
    "inf",
    "(-inf)",
    "(0/0)",
    "(inf-inf)",
    "1e999",
    "0.1",
    "0.3333333333333333",
    "1e-12",
    "4294967296",
    "2147483648",
    "65536",
    "1000000000000",
    "(1/0)",
    "1e-160",
    "pi",
];

/// Words that a name or an operator may turn into.
const WORDS: [&str; 78] = [
    "time",
    "self",
    "index",
    "none",
    "true",
    "false",
    "inf",
    "pi",
    "x",
    "v",
    "th",
    "cars",
    "Car",
    "lead",
    "lane",
    "o",
    "a",
    "b",
    "sin",
    "tan",
    "atan2",
    "sqrt",
    "exp",
    "log",
    "abs",
    "floor",
    "mod",
    "hypot",
    "clamp",
    "min",
    "max",
    "sign",
    "round",
    "acosh",
    "rising",
    "crossing",
    "exists",
    "forall",
    "count",
    "sum",
    "nearest",
    "if",
    "then",
    "else",
    "and",
    "or",
    "not",
    "is",
    "in",
    "other",
    "where",
    "when",
    "after",
    "every",
    "rate",
    "on",
    "mode",
    "initial",
    "state",
    "discrete",
    "let",
    "param",
    "flow",
    "entry",
    "exit",
    "stop",
    "history",
    "priority",
    "invariant",
    "assert",
    "from",
    "csv",
    "record",
    "to",
    "until",
    "tolerance",
    "system",
    "run",
];

const SYMBOLS: [&str; 28] = [
    "+", "-", "*", "/", "^", "<", "<=", ">", ">=", "==", "!=", "=", ":=", "~", "->", "(", ")", "[", "]", "{",
    "}", ",", ".", ":", "'", "\"", "//", ";",
];

const CHARACTERS: [&str; 20] = [
    "é", "−", "≤", "\u{202e}", "\u{feff}", "\0", "\r", "\t", "\u{2028}", "🚗", "´", "ß", "Ω", "\u{301}", "‘",
    "\u{7f}", "%", "#", "\u{fffd}", "日本",
];

/// A mutant of one of the texts, with pieces of the others.
pub fn mutant(dice: &mut Dice, texts: &[String]) -> String {
    let text: &String = dice.pick(texts);
    let mut tokens = cut(text);
    if dice.percent(65) {
        for _ in 0..1 + dice.below(3) {
            nudge(dice, &mut tokens);
        }
        return tokens.concat();
    }
    for _ in 0..1 + dice.below(4) {
        mutate(dice, &mut tokens, texts);
        if tokens.len() > 20_000 {
            break;
        }
    }
    let text = tokens.concat();
    match dice.below(20) {
        0 => truncated(dice, text),
        1 => with_characters(dice, text),
        2 => with_bytes(dice, &text),
        _ => text,
    }
}

/// A change after which the text is mostly still a model.
fn nudge(dice: &mut Dice, tokens: &mut [String]) {
    match dice.below(10) {
        0..=4 => change(dice, tokens, is_number, |dice, _| dice.pick(&NUMBERS).to_string()),
        5 => rename(dice, tokens),
        6 => change(
            dice,
            tokens,
            |token| ["+", "-", "*", "/", "^"].contains(&token),
            |dice, _| dice.pick(&["+", "-", "*", "/", "^", "/-"]).to_string(),
        ),
        7 => change(
            dice,
            tokens,
            |token| ["<=", ">=", "<", ">"].contains(&token),
            |dice, _| dice.pick(&["<=", ">=", "<", ">", "=="]).to_string(),
        ),
        8 => change(dice, tokens, is_number, wrapped),
        _ => change(dice, tokens, is_letter, wrapped),
    }
}

/// Another name of the text in the place of one.
fn rename(dice: &mut Dice, tokens: &mut [String]) {
    let own: Vec<String> = tokens.iter().filter(|token| is_letter(token)).cloned().collect();
    change(
        dice,
        tokens,
        is_letter,
        |dice, old| if own.is_empty() { old.to_string() } else { dice.pick(&own).clone() },
    );
}

fn mutate(dice: &mut Dice, tokens: &mut Vec<String>, texts: &[String]) {
    if tokens.is_empty() {
        return tokens.push(dice.pick(&WORDS).to_string());
    }
    let at = dice.below(tokens.len());
    match dice.below(16) {
        0 => drop(tokens.remove(at)),
        1 => tokens.insert(at, tokens[at].clone()),
        2 => {
            let other = dice.below(tokens.len());
            tokens.swap(at, other);
        }
        3..=7 => change(dice, tokens, is_number, |dice, _| dice.pick(&NUMBERS).to_string()),
        8..=9 => rename(dice, tokens),
        10 => change(dice, tokens, is_word, |dice, _| dice.pick(&WORDS).to_string()),
        11 => change(dice, tokens, is_symbol, |dice, _| dice.pick(&SYMBOLS).to_string()),
        12 => change(dice, tokens, is_operand, wrapped),
        13 => {
            let range = block(dice, tokens);
            tokens.drain(range);
        }
        14 => {
            let other: &String = dice.pick(texts);
            let other = cut(other);
            let piece = other[block(dice, &other)].to_vec();
            let place = if dice.percent(50) { block(dice, tokens) } else { at..at };
            tokens.splice(place, piece);
        }
        _ => {
            let piece = tokens[block(dice, tokens)].to_vec();
            for _ in 0..1 + dice.below(3) {
                tokens.splice(at..at, piece.clone());
            }
        }
    }
}

/// Puts something else in the place of one token of a kind, if there is one.
fn change(
    dice: &mut Dice,
    tokens: &mut [String],
    kind: fn(&str) -> bool,
    new: impl FnOnce(&mut Dice, &str) -> String,
) {
    let places: Vec<usize> = (0..tokens.len()).filter(|&k| kind(&tokens[k])).collect();
    if !places.is_empty() {
        let place = *dice.pick(&places);
        tokens[place] = new(dice, &tokens[place]);
    }
}

/// An operand inside something bigger.
fn wrapped(dice: &mut Dice, old: &str) -> String {
    let number = *dice.pick(&NUMBERS);
    match dice.below(12) {
        0 => format!("({old} + {number})"),
        1 => format!("({old}*{number})"),
        2 => format!("({number}/{old})"),
        3 => format!("{old}^{number}"),
        4 => format!("sqrt({old})"),
        5 => format!("exp({old})"),
        6 => format!("floor({old}*{number})"),
        7 => format!("mod({old}, {number})"),
        8 => format!("(if {old} <= {number} then {old} else {number})"),
        9 => format!("abs({old} - {number})"),
        10 => {
            let depth = [3, 40, 300, 5000][dice.below(4)];
            format!("{}{old}{}", "(".repeat(depth), ")".repeat(depth))
        }
        _ => format!("{}{old}", ["-", "not ", "-(-"][dice.below(3)].repeat(1 + dice.below(300))),
    }
}

/// A statement, a block in braces, or a few tokens.
fn block(dice: &mut Dice, tokens: &[String]) -> std::ops::Range<usize> {
    if tokens.is_empty() {
        return 0..0;
    }
    let from = dice.below(tokens.len());
    let mut depth = 0usize;
    let braces = dice.percent(60);
    for (k, token) in tokens.iter().enumerate().skip(from) {
        match token.as_str() {
            "{" => depth += 1,
            "}" if depth <= 1 && braces => return from..k + 1,
            "}" => depth = depth.saturating_sub(1),
            _ if !braces && k > from + 10 => return from..k,
            _ => {}
        }
    }
    from..tokens.len()
}

fn truncated(dice: &mut Dice, mut text: String) -> String {
    let mut at = dice.below(text.len() + 1);
    while !text.is_char_boundary(at) {
        at -= 1;
    }
    text.truncate(at);
    text
}

fn with_characters(dice: &mut Dice, mut text: String) -> String {
    for _ in 0..1 + dice.below(3) {
        let mut at = dice.below(text.len() + 1);
        while !text.is_char_boundary(at) {
            at -= 1;
        }
        let new: &&str = dice.pick(&CHARACTERS);
        text.insert_str(at, new);
    }
    text
}

fn with_bytes(dice: &mut Dice, text: &str) -> String {
    let mut bytes = text.as_bytes().to_vec();
    for _ in 0..1 + dice.below(8) {
        let at = dice.below(bytes.len() + 1);
        bytes.insert(at, dice.below(256) as u8);
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

/// The text in tokens, white space and comments among them; together they are the text.
pub fn cut(text: &str) -> Vec<String> {
    let mut tokens = Vec::new();
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        let len = if rest.starts_with("//") {
            rest.find('\n').unwrap_or(rest.len())
        } else if first == '"' {
            rest[1..].find(['"', '\n']).map_or(rest.len(), |end| end + 2).min(rest.len())
        } else if first.is_ascii_digit() {
            number_len(rest)
        } else if first.is_alphabetic() || first == '_' {
            rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len())
        } else if first.is_whitespace() {
            rest.find(|c: char| !c.is_whitespace()).unwrap_or(rest.len())
        } else if [":=", "->", "<=", ">=", "==", "!="].iter().any(|pair| rest.starts_with(pair)) {
            2
        } else {
            first.len_utf8()
        };
        tokens.push(rest[..len].to_string());
        rest = &rest[len..];
    }
    tokens
}

fn number_len(rest: &str) -> usize {
    let digits = |text: &str| text.find(|c: char| !c.is_ascii_digit() && c != '.').unwrap_or(text.len());
    let len = digits(rest);
    let exponent = rest[len..].strip_prefix(['e', 'E']);
    let Some(exponent) = exponent else { return len };
    let sign = usize::from(exponent.starts_with(['+', '-']));
    len + 1 + sign + digits(&exponent[sign..])
}

fn is_number(token: &str) -> bool {
    token.starts_with(|c: char| c.is_ascii_digit())
}

fn is_word(token: &str) -> bool {
    token.starts_with(|c: char| c.is_ascii_alphabetic())
}

/// Most names of variables are short.
fn is_letter(token: &str) -> bool {
    token.len() <= 3
        && is_word(token)
        && !["if", "in", "is", "on", "to", "or", "and", "not", "let", "run", "fn"].contains(&token)
}

fn is_operand(token: &str) -> bool {
    is_number(token) || is_word(token)
}

fn is_symbol(token: &str) -> bool {
    token.starts_with(|c: char| c.is_ascii_punctuation() && c != '"') && !token.starts_with("//")
}
