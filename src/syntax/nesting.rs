//! Bounds the nesting of a text before anything recurses over it.
//!
//! In: the tokens. Out: nothing, or the first bracket without a partner, or the place where brackets, `if`s,
//! quantifiers, `^` and prefix operators together nest deeper than the limit. One linear walk with a stack: a bracket is
//! a level until it is closed; an operator that is waiting for its right operand is a level until an operator that binds
//! less, or the end of the expression, takes that operand away from it.

use super::error::{SyntaxError, partner};
use super::scan::{Source, Token, TokenKind};
use crate::base::{FileId, Span};

/// An operator whose right operand is being read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Pending {
    /// `-` or `^`: ended by any binary operator but `^`.
    Tight,
    /// `not`: ended by `and` and `or`.
    Not,
    /// `if` up to its `then`.
    Condition,
    /// `then` up to its `else`.
    Then,
    /// `else`: extends as far as it can.
    Else,
    /// A quantifier: extends as far as it can.
    Quantifier,
    /// `always`, `eventually`
    Temporal,
}

/// An open bracket and what is pending inside it; the outermost frame has no bracket.
struct Frame {
    open: Option<Token>,
    pending: Vec<Pending>,
    after_operand: bool,
    /// Whether this bracket is the window of an `always`.
    window: bool,
}

impl Frame {
    fn new(open: Option<Token>, window: bool) -> Self {
        Self { open, pending: Vec::new(), after_operand: false, window }
    }
}

/// Checks the brackets and the depth of a text.
pub fn check_nesting(source: Source, limit: usize) -> Result<(), SyntaxError> {
    let Source { file, text, tokens } = source;
    let mut walk = Walk { file, text, frames: vec![Frame::new(None, false)], depth: 0 };
    for (k, &token) in tokens.iter().enumerate() {
        walk.step(token, source.word(k + 1))?;
        if walk.depth > limit {
            return Err(SyntaxError::TooDeep { span: walk.span(token), limit });
        }
    }
    match walk.top().open {
        Some(open) => Err(walk.unclosed(
            open,
            Span::new(file, text.len(), text.len()),
            "the end of the file".to_string(),
        )),
        None => Ok(()),
    }
}

struct Walk<'t> {
    file: FileId,
    text: &'t str,
    frames: Vec<Frame>,
    depth: usize,
}

impl Walk<'_> {
    fn span(&self, token: Token) -> Span {
        Span::new(self.file, token.start(), token.end())
    }

    fn top(&mut self) -> &mut Frame {
        self.frames.last_mut().expect("the outermost frame is never closed")
    }

    fn step(&mut self, token: Token, next: &str) -> Result<(), SyntaxError> {
        match token.kind {
            TokenKind::Number | TokenKind::Text => self.operand(),
            TokenKind::Word => return self.word(token, next),
            TokenKind::Symbol => return self.symbol(token),
        }
        Ok(())
    }

    fn operand(&mut self) {
        if self.top().after_operand {
            self.end_expression();
        }
        self.top().after_operand = true;
    }

    fn push(&mut self, pending: Pending) {
        self.depth += 1;
        let top = self.top();
        top.pending.push(pending);
        top.after_operand = false;
    }

    /// Ends what is pending from the top as long as `ends` says so.
    fn pop_while(&mut self, ends: impl Fn(Pending) -> bool) {
        let top = self.top();
        let before = top.pending.len();
        while top.pending.last().is_some_and(|&pending| ends(pending)) {
            top.pending.pop();
        }
        let ended = before - top.pending.len();
        top.after_operand = false;
        self.depth -= ended;
    }

    fn end_expression(&mut self) {
        self.pop_while(|_| true);
    }

    /// Ends everything above the innermost `from` and puts `to` in its place; everything, if there is none.
    fn turn(&mut self, from: Pending, to: Pending) {
        self.pop_while(|pending| pending != from);
        if let Some(last) = self.top().pending.last_mut() {
            *last = to;
        }
    }

    fn word(&mut self, token: Token, next: &str) -> Result<(), SyntaxError> {
        let word = &self.text[token.start()..token.end()];
        // Most names are told from keywords by their first two letters.
        if !matches!(word.as_bytes(), [b'a'..=b'w', b'a'..=b'z', ..]) {
            self.operand();
            return Ok(());
        }
        match word {
            "if" => self.prefix(Pending::Condition),
            "then" => self.turn(Pending::Condition, Pending::Then),
            "else" => self.turn(Pending::Then, Pending::Else),
            "exists" | "forall" | "count" | "sum" | "nearest" => self.prefix(Pending::Quantifier),
            "min" | "max" if begins_word(next) => self.prefix(Pending::Quantifier),
            "where" | "by" => self.turn(Pending::Quantifier, Pending::Quantifier),
            "not" => self.prefix(Pending::Not),
            "always" | "eventually" => self.prefix(Pending::Temporal),
            "and" | "or" => self.pop_while(|pending| matches!(pending, Pending::Tight | Pending::Not)),
            "is" => self.pop_while(|pending| pending == Pending::Tight),
            "in" | "other" => self.top().after_operand = false,
            "import" | "param" | "fn" | "agent" | "interaction" | "system" | "property" | "run" => {
                let begins_item = begins_word(next) || next.starts_with(['{', '"']);
                if let Some(open) = self.top().open.filter(|_| begins_item) {
                    let before = format!("`{}`", &self.text[token.start()..token.end()]);
                    return Err(self.unclosed(open, self.span(token), before));
                }
                self.end_expression();
            }
            "let" | "state" | "discrete" | "link" | "event" | "region" | "flow" | "invariant" | "assert"
            | "initial" | "mode" | "entry" | "exit" | "when" | "after" | "every" | "rate" | "on" | "from"
            | "priority" | "create" | "destroy" | "emit" | "stop" | "until" | "record" | "to" => {
                self.end_expression()
            }
            _ => self.operand(),
        }
        Ok(())
    }

    fn prefix(&mut self, pending: Pending) {
        if self.top().after_operand {
            self.end_expression();
        }
        self.push(pending);
    }

    fn symbol(&mut self, token: Token) -> Result<(), SyntaxError> {
        let binary_ends = |pending| pending == Pending::Tight;
        match &self.text[token.start()..token.end()] {
            "-" if !self.top().after_operand => self.push(Pending::Tight),
            "^" => self.push(Pending::Tight),
            "+" | "-" | "*" | "/" | "<" | "<=" | ">" | ">=" | "==" | "!=" => self.pop_while(binary_ends),
            ":" => self.turn(Pending::Quantifier, Pending::Quantifier),
            "," | "=" | ":=" | "~" | "->" => self.end_expression(),
            "." => self.top().after_operand = false,
            "{" => {
                self.end_expression();
                self.open(token);
            }
            "(" | "[" => self.open(token),
            ")" | "]" | "}" => return self.close(token),
            _ => {}
        }
        Ok(())
    }

    fn open(&mut self, token: Token) {
        let top = self.top();
        let window = !top.after_operand && top.pending.last() == Some(&Pending::Temporal);
        self.depth += 1;
        self.frames.push(Frame::new(Some(token), window));
    }

    fn close(&mut self, token: Token) -> Result<(), SyntaxError> {
        let bracket = char::from(self.text.as_bytes()[token.start()]);
        let Some(open) = self.top().open else {
            return Err(SyntaxError::Unopened { span: self.span(token), bracket });
        };
        if partner(bracket) != char::from(self.text.as_bytes()[open.start()]) {
            return Err(self.unclosed(open, self.span(token), format!("`{bracket}`")));
        }
        let frame = self.frames.pop().expect("the frame was just looked at");
        self.depth -= 1 + frame.pending.len();
        self.top().after_operand = bracket != '}' && !frame.window;
        Ok(())
    }

    fn unclosed(&self, open: Token, missed: Span, before: String) -> SyntaxError {
        let bracket = char::from(self.text.as_bytes()[open.start()]);
        SyntaxError::Unclosed { open: self.span(open), bracket, missed, before }
    }
}

fn begins_word(token: &str) -> bool {
    token.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_')
}
