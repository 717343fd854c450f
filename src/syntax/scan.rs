//! Cuts a text into tokens: where words, numbers, strings and symbols begin and end.
//!
//! In: the text. Out: [`Token`]s in order, without comments and white space, or the first thing that is no token. The
//! grammar reads the text again by itself; the tokens serve what a grammar is bad at: bounding the nesting before it
//! runs, the exact end of what it found, and saying what went wrong.

use super::error::SyntaxError;
use crate::base::{FileId, Span};

/// What a token is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TokenKind {
    /// A keyword or a name.
    Word,
    /// A number.
    Number,
    /// A string.
    Text,
    /// An operator or a separator.
    Symbol,
}

/// A piece of the text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Token {
    /// What it is.
    pub kind: TokenKind,
    /// What its first byte is.
    mark: u8,
    /// Where its first byte stands.
    start: u32,
    /// One past its last byte.
    end: u32,
}

impl Token {
    /// Where its first byte stands.
    pub fn start(self) -> usize {
        self.start as usize
    }

    /// One past its last byte.
    pub fn end(self) -> usize {
        self.end as usize
    }
}

/// A text with its tokens.
#[derive(Clone, Copy)]
pub struct Source<'t> {
    /// Where it stands.
    pub file: FileId,
    /// All of it.
    pub text: &'t str,
    /// Its tokens, in order.
    pub tokens: &'t [Token],
}

impl<'t> Source<'t> {
    /// The text of a token; empty beyond the last one.
    pub fn word(&self, token: usize) -> &'t str {
        self.tokens.get(token).map_or("", |token| &self.text[token.start()..token.end()])
    }

    /// The first byte of a token, which alone says what many are; 0 beyond the last one.
    pub fn mark(&self, token: usize) -> u8 {
        self.tokens.get(token).map_or(0, |token| token.mark)
    }

    /// Whether a token is this word.
    pub fn is(&self, token: usize, word: &str) -> bool {
        word.as_bytes().first() == Some(&self.mark(token)) && self.word(token) == word
    }
}

/// Symbols of two characters; every other symbol has one.
const PAIRS: [&str; 6] = [":=", "->", "<=", ">=", "==", "!="];
const SINGLES: &str = "(){}[],.:=~<>+-*/^'";
/// Operators of other languages, with what to write here; the longest first.
const FOREIGN: [(&str, &str); 16] = [
    ("&&", "write `and`"),
    ("||", "write `or`"),
    ("**", "a power is written `^`"),
    ("/*", "a comment begins with `//` and ends with its line"),
    ("*/", "a comment begins with `//` and ends with its line"),
    ("+=", "write `x := x + ...`"),
    ("-=", "write `x := x - ...`"),
    ("*=", "write `x := x*...`"),
    ("/=", "write `x := x/...`, or `!=` for a comparison"),
    ("=>", "write `>=` for a comparison, `->` for a transition"),
    ("<>", "write `!=`"),
    ("=<", "write `<=`"),
    ("%", "a remainder is written `mod(a, b)`"),
    ("&", "write `and`"),
    ("|", "write `or`"),
    ("!", "write `not`"),
];

/// Characters beyond the language's own that units are written with.
pub const UNIT_LETTERS: [char; 6] = ['µ', 'μ', 'Ω', '\u{2126}', '°', '%'];

/// The tokens of a text.
pub fn scan(file: FileId, text: &str) -> Result<Vec<Token>, SyntaxError> {
    let mut tokens = Vec::with_capacity(text.len() / 4);
    let mut at = 0;
    let mut unit_end = 0;
    while let Some(character) = text[at..].chars().next() {
        let rest = &text[at..];
        let (kind, len) = if character.is_ascii_whitespace() || matches!(character, ';' | '\u{FEFF}') {
            at += character.len_utf8();
            continue;
        } else if rest.starts_with("//") {
            at += rest.find('\n').unwrap_or(rest.len());
            continue;
        } else if is_word_start(character) {
            (TokenKind::Word, word_len(rest))
        } else if at < unit_end && UNIT_LETTERS.contains(&character) {
            (TokenKind::Word, character.len_utf8())
        } else if character.is_ascii_digit() || (character == '.' && starts_with_digit(&rest[1..])) {
            (TokenKind::Number, scan_number(file, at, rest)?)
        } else if character == '"' {
            (TokenKind::Text, scan_text(file, at, rest)?)
        } else {
            (TokenKind::Symbol, scan_symbol(file, at, rest)?)
        };
        if character == '[' && opens_unit(text, tokens.last()) {
            unit_end = at + rest.find([']', '\n']).unwrap_or(0);
        }
        // Files are smaller than 2^32 bytes.
        tokens.push(Token { kind, mark: rest.as_bytes()[0], start: at as u32, end: (at + len) as u32 });
        at += len;
    }
    Ok(tokens)
}

/// Whether a bracket behind this token holds a unit: behind a number or the word `real`.
fn opens_unit(text: &str, before: Option<&Token>) -> bool {
    before.is_some_and(|token| match token.kind {
        TokenKind::Number => true,
        TokenKind::Word => text[token.start()..token.end()] == *"real",
        TokenKind::Text | TokenKind::Symbol => false,
    })
}

fn is_word_start(character: char) -> bool {
    character.is_ascii_alphabetic() || character == '_'
}

fn word_len(rest: &str) -> usize {
    rest.bytes().position(|c| !c.is_ascii_alphanumeric() && c != b'_').unwrap_or(rest.len())
}

fn starts_with_digit(rest: &str) -> bool {
    rest.starts_with(|c: char| c.is_ascii_digit())
}

fn digits_len(rest: &str) -> usize {
    rest.bytes().position(|c| !c.is_ascii_digit()).unwrap_or(rest.len())
}

/// The length of the number at the start of `rest`, which begins with a digit or with `.` and a digit.
fn scan_number(file: FileId, at: usize, rest: &str) -> Result<usize, SyntaxError> {
    let mut len = digits_len(rest);
    if rest[len..].starts_with('.') && starts_with_digit(&rest[len + 1..]) {
        len += 1 + digits_len(&rest[len + 1..]);
    }
    if rest[len..].starts_with(['e', 'E']) {
        let sign = usize::from(rest[len + 1..].starts_with(['+', '-']));
        let digits = digits_len(&rest[len + 1 + sign..]);
        len += if digits > 0 { 1 + sign + digits } else { 0 };
    }
    let tail = rest[len..]
        .find(|c: char| !c.is_ascii_alphanumeric() && c != '_' && c != '.')
        .unwrap_or(rest.len() - len);
    if tail == 0 && !rest.starts_with('.') {
        return Ok(len);
    }
    let text = &rest[..len + tail];
    let span = Span::new(file, at, at + text.len());
    Err(SyntaxError::MalformedNumber { span, text: text.to_string(), help: number_help(text, len) })
}

/// What was probably meant by a malformed number of which the first `len` bytes are a number.
fn number_help(text: &str, len: usize) -> String {
    let (good, bad) = text.split_at(len);
    if text.starts_with('.') && bad.is_empty() {
        format!("write `0{text}`")
    } else if bad == "." {
        format!("write `{good}` or `{good}.0`")
    } else if text.contains('_') && text.replace('_', "").parse::<f64>().is_ok() {
        format!("write `{}`", text.replace('_', ""))
    } else if bad.starts_with(['e', 'E']) && bad.len() == 1 {
        format!("an exponent needs digits: `{good}e3`")
    } else if bad.starts_with(is_word_start) && good != "0" {
        format!("a product needs its sign, `{good}*{bad}`, and a unit its brackets, `{good} [{bad}]`")
    } else {
        "numbers look like `1`, `1.5` or `1.5e-3`".to_string()
    }
}

/// The length of the string at the start of `rest`, quotes included.
fn scan_text(file: FileId, at: usize, rest: &str) -> Result<usize, SyntaxError> {
    let line = rest.find(['\n', '\r']).unwrap_or(rest.len());
    match rest[1..line].find('"') {
        Some(inner) => Ok(inner + 2),
        None => Err(SyntaxError::UnterminatedString { span: Span::new(file, at, at + line) }),
    }
}

fn scan_symbol(file: FileId, at: usize, rest: &str) -> Result<usize, SyntaxError> {
    let first = rest.chars().next().expect("the caller has seen a character");
    let may_be_pair = matches!(rest.as_bytes().get(1), Some(b'=' | b'>' | b'<' | b'*' | b'/' | b'&' | b'|'));
    if !may_be_pair && SINGLES.contains(first) {
        return Ok(1);
    }
    if PAIRS.iter().any(|pair| rest.starts_with(pair)) {
        return Ok(2);
    }
    if let Some((text, help)) = FOREIGN.into_iter().find(|(text, _)| rest.starts_with(text)) {
        let span = Span::new(file, at, at + text.len());
        return Err(SyntaxError::ForeignOperator { span, text: text.to_string(), help });
    }
    if SINGLES.contains(first) {
        return Ok(1);
    }
    let span = Span::new(file, at, at + first.len_utf8());
    Err(SyntaxError::UnknownCharacter { span, character: first })
}
