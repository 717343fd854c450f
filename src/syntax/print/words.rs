//! A text as words with their places, and the comments between them.

use crate::syntax::scan::{Token, TokenKind};
use crate::syntax::words::keywords;

/// Where something stands in the text that is laid out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place {
    /// The line, from 0.
    pub line: usize,
    /// The characters before it on its line.
    pub column: usize,
}

/// A word, number, string, symbol, or a unit with its brackets.
#[derive(Clone, Debug)]
pub struct Word<'t> {
    /// What is written for it.
    pub text: &'t str,
    /// Its first byte.
    pub start: usize,
    /// Where it begins.
    pub place: Place,
    /// Whether an operand can end with it: then `-` behind it is binary, and `(` or `[` belong to it.
    pub ends_operand: bool,
}

/// A comment, without the blanks at its end.
#[derive(Clone, Debug)]
pub struct Comment<'t> {
    /// From `//` on.
    pub text: &'t str,
    /// Where it begins.
    pub place: Place,
}

/// All words of a text in order, and what stands between them.
pub struct Words<'t> {
    /// The words.
    pub words: Vec<Word<'t>>,
    /// The comments before each word, and last those behind all of them.
    pub comments: Vec<Vec<Comment<'t>>>,
    /// Of each opening bracket or brace the one that closes it; of any other word itself.
    partners: Vec<usize>,
}

impl<'t> Words<'t> {
    /// The words and comments of a text that has these tokens.
    pub fn new(text: &'t str, tokens: &[Token]) -> Self {
        let keywords = keywords();
        // `min` and `max` are called like functions.
        let opens =
            |word: &str| keywords.iter().any(|keyword| keyword == word) && word != "min" && word != "max";
        let mut ruler = Ruler { text, byte: 0, place: Place { line: 0, column: 0 } };
        let mut words = Vec::with_capacity(tokens.len());
        let mut comments = Vec::with_capacity(tokens.len() + 1);
        for token in tokens {
            comments.push(ruler.comments_before(token.start()));
            let word = &text[token.start()..token.end()];
            let ends_operand = match token.kind {
                TokenKind::Word => !opens(word),
                TokenKind::Number | TokenKind::Text => true,
                TokenKind::Symbol => matches!(word, ")" | "]" | "'"),
            };
            words.push(Word {
                text: word,
                start: token.start(),
                place: ruler.advance(token.start()),
                ends_operand,
            });
            ruler.advance(token.end());
        }
        comments.push(ruler.comments_before(text.len()));
        let partners = partners(&words);
        Self { words, comments, partners }
    }

    /// The word that closes an opening bracket or brace.
    pub fn closing(&self, word: usize) -> usize {
        self.partners[word]
    }

    /// The text of a word; empty beyond the last.
    pub fn text(&self, word: usize) -> &'t str {
        self.words.get(word).map_or("", |word| word.text)
    }

    /// The line of a word; that of the last beyond it.
    pub fn line(&self, word: usize) -> usize {
        self.words.get(word).or(self.words.last()).map_or(0, |word| word.place.line)
    }
}

fn partners(words: &[Word<'_>]) -> Vec<usize> {
    let mut partners: Vec<usize> = (0..words.len()).collect();
    let mut open = Vec::new();
    for (k, word) in words.iter().enumerate() {
        match word.text {
            "(" | "[" | "{" => open.push(k),
            ")" | "]" | "}" => open.pop().into_iter().for_each(|first: usize| partners[first] = k),
            _ => {}
        }
    }
    partners
}

/// Counts lines and columns along a text.
struct Ruler<'t> {
    text: &'t str,
    byte: usize,
    place: Place,
}

impl<'t> Ruler<'t> {
    /// The place of a byte that is not before those asked for so far.
    fn advance(&mut self, byte: usize) -> Place {
        for character in self.text[self.byte..byte].chars() {
            match character {
                '\n' => self.place = Place { line: self.place.line + 1, column: 0 },
                _ => self.place.column += 1,
            }
        }
        self.byte = byte;
        self.place
    }

    /// The comments between the last place and a byte, with only blanks besides.
    fn comments_before(&mut self, byte: usize) -> Vec<Comment<'t>> {
        let mut comments = Vec::new();
        while let Some(blank) = self.text[self.byte..byte].find("//") {
            let start = self.byte + blank;
            let end = self.text[start..byte].find('\n').map_or(byte, |len| start + len);
            let text = self.text[start..end].trim_end();
            comments.push(Comment { text, place: self.advance(start) });
            self.advance(end);
        }
        comments
    }
}
