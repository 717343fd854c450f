//! A cursor over what the grammar finds, read slice by slice.
//!
//! In: a text with its tokens. Out: [`Piece`]s in the order of the grammar. Whoever walks over them cannot tell whether a
//! piece has been read with those around it or is cut into slices when its parts are asked for: the grammar's tokens, of
//! which there are more bytes than a hundred times the text's, exist only for the slices that are being walked over.

use std::ops::Range;

use pest::iterators::{Pair, Pairs};

use super::grammar::{self, Rule};
use super::scan::Source;
use super::slices::{Reading, Slice, slices};

/// A slice is not what its rule says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Unread;

/// A text and the size of the slices in which it is read.
#[derive(Clone, Copy)]
pub struct Sliced<'t> {
    /// The text.
    pub source: Source<'t>,
    /// About how many bytes are read at once.
    pub bytes: usize,
}

/// A piece of the text that one rule of the grammar covers.
pub struct Piece<'t> {
    text: &'t Sliced<'t>,
    found: Found<'t>,
}

enum Found<'t> {
    /// By the grammar, in a slice that begins at this byte.
    Read(Pair<'t, Rule>, usize),
    /// By its first and last token.
    Cut(Rule, Range<usize>),
}

impl<'t> Piece<'t> {
    /// The whole text as one piece, to be read in slices.
    pub fn whole(text: &'t Sliced<'t>) -> Self {
        Self { text, found: Found::Cut(Rule::file, 0..text.source.tokens.len()) }
    }

    /// A piece that has been read.
    pub fn read(text: &'t Sliced<'t>, pair: Pair<'t, Rule>) -> Self {
        Self { text, found: Found::Read(pair, 0) }
    }

    /// The text that it is a piece of.
    pub fn source(&self) -> Source<'t> {
        self.text.source
    }

    /// Its rule.
    pub fn rule(&self) -> Rule {
        match &self.found {
            Found::Read(pair, _) => pair.as_rule(),
            Found::Cut(rule, _) => *rule,
        }
    }

    /// Its bytes; white space and comments may follow within them.
    pub fn range(&self) -> Range<usize> {
        match &self.found {
            Found::Read(pair, offset) => {
                let span = pair.as_span();
                offset + span.start()..offset + span.end()
            }
            Found::Cut(_, tokens) => bytes_of(self.text.source, tokens),
        }
    }
}

fn bytes_of(source: Source, tokens: &Range<usize>) -> Range<usize> {
    match source.tokens.get(tokens.clone()) {
        Some([first, .., last]) => first.start()..last.end(),
        Some([only]) => only.start()..only.end(),
        Some([]) | None => 0..0,
    }
}

/// The pieces inside a piece, in the order of the grammar.
pub struct Parts<'t> {
    text: &'t Sliced<'t>,
    next: Option<Piece<'t>>,
    read: Option<Pairs<'t, Rule>>,
    offset: usize,
    slices: std::vec::IntoIter<Slice>,
}

impl<'t> Parts<'t> {
    /// The parts of a piece.
    pub fn of(piece: Piece<'t>) -> Self {
        let Piece { text, found } = piece;
        match found {
            Found::Read(pair, offset) => {
                let read = Some(pair.into_inner());
                Self { text, next: None, read, offset, slices: Vec::new().into_iter() }
            }
            Found::Cut(rule, tokens) => {
                let slices = slices(text.source, text.bytes, rule, tokens).into_iter();
                Self { text, next: None, read: None, offset: 0, slices }
            }
        }
    }

    /// What one slice of a text consists of.
    pub fn of_slice(text: &'t Sliced<'t>, slice: Slice) -> Self {
        Self { text, next: None, read: None, offset: 0, slices: vec![slice].into_iter() }
    }

    /// The slices that nobody has looked at yet.
    pub fn ahead(&self) -> &[Slice] {
        self.slices.as_slice()
    }

    /// Takes these slices away; the parts before them stay.
    pub fn take_ahead(&mut self) -> (&'t Sliced<'t>, Vec<Slice>) {
        (self.text, std::mem::take(&mut self.slices).collect())
    }

    /// The next part, which stays where it is.
    fn front(&mut self) -> Result<Option<&Piece<'t>>, Unread> {
        while self.next.is_none() {
            if let Some(pair) = self.read.as_mut().and_then(Iterator::next) {
                self.next = Some(Piece { text: self.text, found: Found::Read(pair, self.offset) });
            } else if let Some(slice) = self.slices.next() {
                self.take(slice)?;
            } else {
                return Ok(None);
            }
        }
        Ok(self.next.as_ref())
    }

    fn take(&mut self, slice: Slice) -> Result<(), Unread> {
        let Slice { rule, tokens, reading } = slice;
        match reading {
            Reading::InSlices => {
                self.next = Some(Piece { text: self.text, found: Found::Cut(rule, tokens) });
            }
            Reading::AtOnce => {
                let bytes = bytes_of(self.text.source, &tokens);
                let text = &self.text.source.text[bytes.clone()];
                let pairs = grammar::read(rule, text).map_err(|_| Unread)?;
                if pairs.as_str().len() < text.len() {
                    return Err(Unread);
                }
                (self.read, self.offset) = (Some(pairs), bytes.start);
            }
        }
        Ok(())
    }

    /// The rule of the next part.
    pub fn peek(&mut self) -> Result<Option<Rule>, Unread> {
        Ok(self.front()?.map(Piece::rule))
    }

    /// The next part, if it is of this rule.
    pub fn next_if(&mut self, rule: Rule) -> Result<Option<Piece<'t>>, Unread> {
        Ok(if self.peek()? == Some(rule) { self.next.take() } else { None })
    }

    /// The next part if it is of this rule, as a yes or no.
    pub fn has(&mut self, rule: Rule) -> Result<bool, Unread> {
        Ok(self.next_if(rule)?.is_some())
    }

    /// The next part, whatever it is.
    pub fn any(&mut self) -> Result<Piece<'t>, Unread> {
        self.front()?;
        self.next.take().ok_or(Unread)
    }

    /// The next part, which the grammar says is of this rule.
    pub fn expect(&mut self, rule: Rule) -> Result<Piece<'t>, Unread> {
        self.next_if(rule)?.ok_or(Unread)
    }

    /// All parts to come that are of this rule.
    pub fn all(self, rule: Rule) -> impl Iterator<Item = Result<Piece<'t>, Unread>> {
        self.filter(move |part| part.as_ref().map_or(true, |piece| piece.rule() == rule))
    }
}

impl<'t> Iterator for Parts<'t> {
    type Item = Result<Piece<'t>, Unread>;

    fn next(&mut self) -> Option<Self::Item> {
        match self.front() {
            Ok(_) => self.next.take().map(Ok),
            Err(unread) => Some(Err(unread)),
        }
    }
}
