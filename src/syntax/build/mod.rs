//! Makes the syntax tree of what the grammar found.
//!
//! In: the text, its tokens, the grammar's pieces. Out: the [`Ast`]. Each method is the mirror of one rule of
//! `grammar/hy.pest`. What a grammar cannot say, or can say only with a poor message, is checked here: units behind
//! names, calls of numbers, too large literals. Several such errors may come out of one text.

mod items;
mod agents;
mod actions;
mod expr;

use super::ast::{Ast, Expr, ExprKind, Name, Target, Text, TypeName, UnitText};
use super::error::SyntaxError;
use super::grammar::{Parts, Piece, Rule};
use super::scan::{Token, UNIT_LETTERS};
use crate::base::{FileId, Span};

/// The syntax tree of a file's piece.
pub fn build(file: FileId, text: &str, tokens: &[Token], piece: Piece<'_>) -> Result<Ast, Vec<SyntaxError>> {
    let mut builder = Builder { file, text, tokens, errors: Vec::new() };
    let ast = builder.file(piece);
    if builder.errors.is_empty() { Ok(ast) } else { Err(builder.errors) }
}

struct Builder<'t> {
    file: FileId,
    text: &'t str,
    tokens: &'t [Token],
    errors: Vec<SyntaxError>,
}

impl Builder<'_> {
    /// The place of a piece, without the white space and comments that the grammar puts at its end.
    fn span(&self, piece: &Piece<'_>) -> Span {
        let span = piece.as_span();
        let ended = self.tokens.partition_point(|token| token.end <= span.end());
        let end = ended.checked_sub(1).map_or(span.end(), |last| self.tokens[last].end);
        Span::new(self.file, span.start(), end.max(span.start()))
    }

    fn file(&mut self, piece: Piece<'_>) -> Ast {
        let parts = Parts::of(piece).rest();
        Ast { items: parts.filter(|part| part.as_rule() != Rule::EOI).map(|part| self.item(part)).collect() }
    }

    fn name(&self, piece: Piece<'_>) -> Name {
        Name { text: piece.as_str().to_string(), span: self.span(&piece) }
    }

    fn text(&self, piece: Piece<'_>) -> Text {
        let quoted = piece.as_str();
        Text { value: quoted[1..quoted.len() - 1].to_string(), span: self.span(&piece) }
    }

    fn unit(&mut self, piece: Piece<'_>) -> UnitText {
        let span = self.span(&piece);
        let bracketed = piece.as_str();
        let text = bracketed[1..bracketed.len() - 1].trim().to_string();
        let belongs =
            |c: char| c.is_ascii_alphanumeric() || " _*/^.-()".contains(c) || UNIT_LETTERS.contains(&c);
        if text.is_empty() || !text.chars().all(belongs) {
            self.errors.push(SyntaxError::NotAUnit { span, text: text.clone() });
        }
        UnitText { text, span }
    }

    fn type_name(&mut self, piece: Piece<'_>) -> TypeName {
        let span = self.span(&piece);
        let mut parts = Parts::of(piece);
        let name = self.name(parts.expect(Rule::name));
        let unit = parts.next_if(Rule::unit).map(|unit| self.unit(unit));
        TypeName { name, unit, span }
    }

    /// `(colon ~ type_name)?`
    fn type_annotation(&mut self, parts: &mut Parts<'_>) -> Option<TypeName> {
        parts.skip(Rule::colon).then(|| self.type_name(parts.expect(Rule::type_name)))
    }

    /// `(word ~ expr)?`
    fn expr_after(&mut self, parts: &mut Parts<'_>, word: Rule) -> Option<Expr> {
        parts.skip(word).then(|| self.expr(parts.expect(Rule::expr)))
    }

    /// A path of modes that is entered: `history` may stand at its end.
    fn target(&mut self, piece: Piece<'_>) -> Target {
        let span = self.span(&piece);
        let mut path: Vec<Name> = Parts::of(piece).all(Rule::name).map(|name| self.name(name)).collect();
        let history = match path.last() {
            Some(last) if path.len() > 1 && last.text == "history" => path.pop().map(|name| name.span),
            _ => None,
        };
        for name in path.iter().filter(|name| name.text == "history") {
            self.errors.push(SyntaxError::MisplacedHistory { span: name.span });
        }
        Target { path, history, span }
    }

    /// A path of modes that is not entered by a transition: `history` has no meaning in it.
    fn plain_target(&mut self, piece: Piece<'_>) -> Target {
        let target = self.target(piece);
        if let Some(span) = target.history {
            self.errors.push(SyntaxError::MisplacedHistory { span });
        }
        target
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
        let unit = self.text.get(index.range()).unwrap_or_default().to_string();
        let brackets = self.text[..index.start as usize].rfind('[').unwrap_or(index.start as usize);
        let end =
            self.text[index.range().end..].find(']').map_or(index.range().end, |k| index.range().end + k + 1);
        self.errors.push(SyntaxError::MisplacedUnit {
            span: Span::new(self.file, brackets, end),
            unit,
            base,
        });
    }
}
