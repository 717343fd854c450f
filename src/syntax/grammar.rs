//! The parser that pest makes of `grammar/hy.pest`, and a cursor over what it finds.

// The derive makes public items without docstrings.
#![allow(missing_docs)]

use pest::Parser;
use pest::iterators::{Pair, Pairs};

/// The generated parser.
#[derive(pest_derive::Parser)]
#[grammar = "../grammar/hy.pest"]
struct HyParser;

/// A piece of the text that one rule of the grammar covers.
pub type Piece<'t> = Pair<'t, Rule>;

/// The whole text as one [`Rule::file`]; brackets must be balanced and nesting bounded.
pub fn read(text: &str) -> Result<Piece<'_>, Box<pest::error::Error<Rule>>> {
    let mut pieces = HyParser::parse(Rule::file, text).map_err(Box::new)?;
    Ok(pieces.next().expect("a parse of `file` is one piece"))
}

/// Whether a word can be no name.
pub fn is_reserved(word: &str) -> bool {
    HyParser::parse(Rule::name, word).is_err()
}

/// The pieces inside a piece, in the order of the grammar.
pub struct Parts<'t> {
    pieces: Pairs<'t, Rule>,
}

impl<'t> Parts<'t> {
    /// The parts of a piece.
    pub fn of(piece: Piece<'t>) -> Self {
        Self { pieces: piece.into_inner() }
    }

    /// The rule of the next part.
    pub fn peek(&self) -> Option<Rule> {
        self.pieces.peek().map(|piece| piece.as_rule())
    }

    /// The next part, if it is of this rule.
    pub fn next_if(&mut self, rule: Rule) -> Option<Piece<'t>> {
        if self.peek() == Some(rule) { self.pieces.next() } else { None }
    }

    /// The next part if it is of this rule, as a yes or no.
    pub fn skip(&mut self, rule: Rule) -> bool {
        self.next_if(rule).is_some()
    }

    /// The next part, whatever it is.
    pub fn next(&mut self) -> Piece<'t> {
        self.pieces.next().expect("the grammar has another part here")
    }

    /// The next part, which the grammar says is of this rule.
    pub fn expect(&mut self, rule: Rule) -> Piece<'t> {
        let piece = self.next();
        assert_eq!(piece.as_rule(), rule, "the grammar and the tree builder must agree");
        piece
    }

    /// All parts to come that are of this rule.
    pub fn all(self, rule: Rule) -> impl Iterator<Item = Piece<'t>> {
        self.pieces.filter(move |piece| piece.as_rule() == rule)
    }

    /// All parts to come.
    pub fn rest(self) -> Pairs<'t, Rule> {
        self.pieces
    }
}
