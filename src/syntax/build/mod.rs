//! Makes the syntax tree of what the grammar found.
//!
//! In: a text with its tokens. Out: the [`Ast`], of the pieces that the grammar finds. Each method is the mirror of one rule of
//! `grammar/hy.pest`. What a grammar cannot say, or can say only with a poor message, is checked here: units behind
//! names, calls of numbers, too large literals. Several such errors may come out of one text.

mod fold;
mod shared;
mod items;
mod agents;
mod actions;
mod expr;

use std::cell::Cell;

use pest::iterators::Pairs;

use super::ast::{Ast, Expr, ExprKind, Name, Target, Text, TypeName, UnitText};
use super::error::SyntaxError;
use super::grammar::Rule;
use super::pieces::{Parts, Piece, Sliced, Unread};
use super::scan::{Source, UNIT_LETTERS};
use crate::base::Span;

/// A tree, or what is wrong with the text.
type Outcome = Result<Ast, Vec<SyntaxError>>;

/// The syntax tree of a text that the grammar reads in slices of about so many bytes.
pub fn build(source: Source, bytes: usize) -> Result<Outcome, Unread> {
    let text = Sliced { source, bytes };
    outcome(Piece::whole(&text))
}

/// The syntax tree of a text that the grammar has read as one.
pub fn build_read(source: Source, mut pairs: Pairs<Rule>) -> Result<Outcome, Unread> {
    let text = Sliced { source, bytes: usize::MAX };
    outcome(Piece::read(&text, pairs.next().ok_or(Unread)?))
}

fn outcome(piece: Piece) -> Result<Outcome, Unread> {
    let mut builder =
        Builder { source: piece.source(), ended: Cell::new(0), errors: Vec::new(), is_helper: false };
    let tree = builder.file(piece)?;
    Ok(if builder.errors.is_empty() { Ok(tree) } else { Err(builder.errors) })
}

struct Builder<'t> {
    source: Source<'t>,
    /// How many tokens had ended where the last piece did.
    ended: Cell<usize>,
    errors: Vec<SyntaxError>,
    /// Whether it builds a part for another one, which waits.
    is_helper: bool,
}

impl Builder<'_> {
    /// The place of a piece, without the white space and comments that the grammar puts at its end.
    fn span(&self, piece: &Piece<'_>) -> Span {
        let bytes = piece.range();
        let end = match self.ended(bytes.end) {
            0 => bytes.end,
            ended => self.source.tokens[ended - 1].end(),
        };
        Span::new(self.source.file, bytes.start, end.max(bytes.start))
    }

    /// How many tokens end at this byte or before it. Pieces come nearly in the order of the text, so the search begins
    /// where the last one ended.
    fn ended(&self, at: usize) -> usize {
        let tokens = self.source.tokens;
        let (mut least, mut most) = (self.ended.get(), self.ended.get());
        let mut step = 1;
        while least > 0 && tokens[least - 1].end() > at {
            most = least - 1;
            least = least.saturating_sub(step);
            step *= 2;
        }
        while most < tokens.len() && tokens[most].end() <= at {
            least = most + 1;
            most = (most + step).min(tokens.len());
            step *= 2;
        }
        let ended = least + tokens[least..most].partition_point(|token| token.end() <= at);
        self.ended.set(ended);
        ended
    }

    /// All of these pieces, each made into something.
    fn list<'t, T>(
        &mut self,
        pieces: impl Iterator<Item = Result<Piece<'t>, Unread>>,
        mut make: impl FnMut(&mut Self, Piece<'t>) -> Result<T, Unread>,
    ) -> Result<Vec<T>, Unread> {
        self.some_of(pieces, |this, piece| make(this, piece).map(Some))
    }

    /// Those of these pieces that become something.
    fn some_of<'t, T>(
        &mut self,
        pieces: impl Iterator<Item = Result<Piece<'t>, Unread>>,
        mut make: impl FnMut(&mut Self, Piece<'t>) -> Result<Option<T>, Unread>,
    ) -> Result<Vec<T>, Unread> {
        let mut made = Vec::new();
        for piece in pieces {
            made.extend(make(self, piece?)?);
        }
        made.shrink_to_fit();
        Ok(made)
    }

    fn file(&mut self, piece: Piece<'_>) -> Result<Ast, Unread> {
        let items = self.many_of(Parts::of(piece), |this, part| match part.rule() {
            Rule::EOI => Ok(None),
            _ => this.item(part).map(Some),
        })?;
        Ok(Ast { items })
    }

    /// The text of a piece, without what follows its last token.
    fn words(&self, piece: &Piece<'_>) -> &str {
        &self.source.text[self.span(piece).range()]
    }

    fn name(&self, piece: Piece<'_>) -> Name {
        let span = self.span(&piece);
        Name { text: self.source.text[span.range()].to_string(), span }
    }

    fn text(&self, piece: Piece<'_>) -> Text {
        let span = self.span(&piece);
        let quoted = &self.source.text[span.range()];
        Text { value: quoted[1..quoted.len() - 1].to_string(), span }
    }

    fn unit(&mut self, piece: Piece<'_>) -> UnitText {
        let span = self.span(&piece);
        let bracketed = &self.source.text[span.range()];
        let text = bracketed[1..bracketed.len() - 1].trim().to_string();
        let belongs =
            |c: char| c.is_ascii_alphanumeric() || " _*/^.-()".contains(c) || UNIT_LETTERS.contains(&c);
        if text.is_empty() || !text.chars().all(belongs) {
            self.errors.push(SyntaxError::NotAUnit { span, text: text.clone() });
        }
        UnitText { text, span }
    }

    fn type_name(&mut self, piece: Piece<'_>) -> Result<TypeName, Unread> {
        let span = self.span(&piece);
        let mut parts = Parts::of(piece);
        let name = self.name(parts.expect(Rule::name)?);
        let unit = parts.next_if(Rule::unit)?.map(|unit| Box::new(self.unit(unit)));
        Ok(TypeName { name, unit, span })
    }

    /// `(colon ~ type_name)?`
    fn type_annotation(&mut self, parts: &mut Parts<'_>) -> Result<Option<Box<TypeName>>, Unread> {
        if !parts.has(Rule::colon)? {
            return Ok(None);
        }
        Ok(Some(Box::new(self.type_name(parts.expect(Rule::type_name)?)?)))
    }

    /// `(word ~ expr)?`
    fn expr_after(&mut self, parts: &mut Parts<'_>, word: Rule) -> Result<Option<Expr>, Unread> {
        if parts.has(word)? { self.expr(parts.expect(Rule::expr)?).map(Some) } else { Ok(None) }
    }

    /// A path of modes that is entered: `history` may stand at its end.
    fn target(&mut self, piece: Piece<'_>) -> Result<Target, Unread> {
        let span = self.span(&piece);
        let mut path = self.list(Parts::of(piece).all(Rule::name), |this, name| Ok(this.name(name)))?;
        let history = match path.last() {
            Some(last) if path.len() > 1 && last.text == "history" => path.pop().map(|name| name.span),
            _ => None,
        };
        for name in path.iter().filter(|name| name.text == "history") {
            self.errors.push(SyntaxError::MisplacedHistory { span: name.span });
        }
        Ok(Target { path, history, span })
    }

    /// A path of modes that is not entered by a transition: `history` has no meaning in it.
    fn plain_target(&mut self, piece: Piece<'_>) -> Result<Target, Unread> {
        let target = self.target(piece)?;
        if let Some(span) = target.history {
            self.errors.push(SyntaxError::MisplacedHistory { span });
        }
        Ok(target)
    }

    /// Refuses `T [s]` where a time or a rate stands: there `s` is a unit, not an index.
    fn refuse_unit_index(&mut self, mut expr: &Expr) {
        loop {
            expr = match &expr.kind {
                ExprKind::Sum(chain) => chain.rest.last().map_or(&chain.first, |link| &link.operand),
                ExprKind::Product(chain) => chain.rest.last().map_or(&chain.first, |link| &link.operand),
                ExprKind::Unary(_, operand) | ExprKind::Power(_, operand) => operand,
                _ => break,
            };
        }
        if let ExprKind::Index(base, index) = &expr.kind
            && let ExprKind::Name(name) = &index.kind
            && matches!(name.as_str(), "s" | "ms" | "us" | "ns" | "min" | "h" | "d" | "Hz")
        {
            self.misplaced_unit(base.span, index.span);
        }
    }

    /// Reports the brackets around `index` as a unit behind `base`.
    fn misplaced_unit(&mut self, base: Span, index: Span) {
        let unit = self.source.text.get(index.range()).unwrap_or_default().to_string();
        let brackets = self.source.text[..index.start as usize].rfind('[').unwrap_or(index.start as usize);
        let end = self.source.text[index.range().end..]
            .find(']')
            .map_or(index.range().end, |k| index.range().end + k + 1);
        self.errors.push(SyntaxError::MisplacedUnit {
            span: Span::new(self.source.file, brackets, end),
            unit,
            base,
        });
    }
}
