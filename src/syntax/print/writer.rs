//! Walks along the words of a text and notes where lines may end.

use super::layout::{Break, Op};
use super::words::{Word, Words};
use crate::base::Span;

/// How much deeper a statement goes on than it begins.
const CONTINUED: usize = 4;

/// How much deeper stands what is in brackets or braces.
const INSIDE: usize = 2;

/// How the braces of a list of statements may stand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Braces {
    /// On one line, or each on a line of its own.
    Block,
    /// Also with the first and the last statement on their lines, the others below the first.
    Hanging,
}

/// What is known of the layout so far: all words before `next`.
pub struct Writer<'t> {
    text: &'t str,
    words: Words<'t>,
    next: usize,
    ops: Vec<Op<'t>>,
    /// Whether the next word follows what is before it without blanks of its own.
    glued: bool,
    /// The first word of an expression behind a name.
    expression: Option<usize>,
}

impl<'t> Writer<'t> {
    pub(super) fn new(text: &'t str, words: Words<'t>) -> Self {
        Self { text, words, next: 0, ops: Vec::new(), glued: true, expression: None }
    }

    pub(super) fn finish(self) -> Vec<Op<'t>> {
        self.ops
    }

    /// The next word.
    pub(super) fn peek(&self) -> &'t str {
        self.words.text(self.next)
    }

    /// Writes the next word, behind the comments before it.
    pub(super) fn word(&mut self) {
        if !self.words.comments[self.next].is_empty() {
            self.comments(CONTINUED);
        }
        let word = self.words.words[self.next].clone();
        let blanks = if self.glued { 0 } else { usize::from(self.is_apart()) };
        self.ops.push(Op::Word { word, blanks });
        self.glued = false;
        self.next += 1;
    }

    /// Writes all words that begin before this byte.
    pub(super) fn up_to(&mut self, byte: u32) {
        while self.words.words.get(self.next).is_some_and(|word| word.start < byte as usize) {
            self.word();
        }
    }

    /// Writes the words up to a unit, and that with its brackets as one word.
    pub(super) fn unit(&mut self, span: Span) {
        self.up_to(span.start);
        if !self.words.comments[self.next].is_empty() {
            self.comments(CONTINUED);
        }
        let place = self.words.words[self.next].place;
        let word =
            Word { text: &self.text[span.range()], start: span.start as usize, place, ends_operand: true };
        self.ops.push(Op::Word { word, blanks: usize::from(!self.glued) });
        self.glued = false;
        let rest = &self.words.words[self.next..];
        self.next += rest.iter().take_while(|word| word.start < span.end as usize).count();
    }

    /// The next word begins an expression, though a name stands before it.
    pub(super) fn begin_expression(&mut self) {
        self.expression = Some(self.next);
    }

    /// Whether a word can be an operand that ends before the next one.
    fn ends_operand(&self, word: usize) -> bool {
        self.words.words[word].ends_operand && self.expression != Some(word + 1)
    }

    /// Whether there is a blank between the last word and the next.
    fn is_apart(&self) -> bool {
        let Some(last) = self.next.checked_sub(1) else { return false };
        match (self.words.text(last), self.words.text(self.next)) {
            (_, ")" | "]" | "," | ":" | "." | "'" | "^" | "*" | "/") => false,
            ("(" | "[" | "." | "^" | "*" | "/", _) => false,
            ("-", _) => last > 0 && self.ends_operand(last - 1),
            (_, "(" | "[") => !self.ends_operand(last),
            _ => true,
        }
    }

    // ---- hints

    pub(super) fn open(&mut self, fill: bool) {
        self.ops.push(Op::Open { fill });
    }

    pub(super) fn close(&mut self) {
        self.ops.push(Op::Close);
    }

    /// Writes something whose lines begin where its first word does, one blank behind the last word.
    pub(super) fn aligned(&mut self, inside: impl FnOnce(&mut Self)) {
        if self.words.comments[self.next].is_empty() {
            self.ops.push(Op::Blank);
            self.glued = true;
        } else {
            self.comments(CONTINUED);
        }
        self.ops.push(Op::Align);
        inside(self);
        self.ops.push(Op::Dedent);
    }

    /// Writes something with what it goes on with deeper.
    pub(super) fn deeper(&mut self, inside: impl FnOnce(&mut Self)) {
        self.ops.push(Op::Indent(INSIDE));
        inside(self);
        self.ops.push(Op::Dedent);
    }

    /// A break before the next word; a comment before it ends the line in any case.
    fn break_line(&mut self, how: Break, blanks: usize, deeper: usize) {
        if self.words.comments[self.next].is_empty() {
            self.ops.push(Op::Break { how, blanks, deeper });
        } else {
            self.comments(deeper);
        }
        self.glued = true;
    }

    /// Here a statement may go on in another line.
    pub(super) fn may_continue(&mut self) {
        let blanks = usize::from(self.is_apart());
        self.break_line(Break::Soft, blanks, CONTINUED);
    }

    /// Here a value may begin a line: if it then fits, or has to be broken `anyway`.
    pub(super) fn may_continue_with_value(&mut self, anyway: bool) {
        self.break_line(if anyway { Break::Soft } else { Break::Useful }, 1, CONTINUED);
    }

    /// Here the next item of a list may begin a line; it does so if it did.
    pub(super) fn may_begin_item(&mut self) {
        if self.shares_line() {
            self.break_line(Break::Soft, 1, 0);
        } else {
            self.begin_line(false);
        }
    }

    /// Whether the next word stands on the line of the last one.
    fn shares_line(&self) -> bool {
        self.words.line(self.next - 1) == self.words.line(self.next)
    }

    /// Writes brackets with these items in them.
    pub(super) fn brackets<T>(&mut self, items: &[T], mut inside: impl FnMut(&mut Self, &T)) {
        self.word();
        let close = self.words.closing(self.next - 1);
        self.open(false);
        self.ops.push(Op::Indent(INSIDE));
        for (k, item) in items.iter().enumerate() {
            self.break_line(Break::Soft, usize::from(k > 0), 0);
            inside(self, item);
            if k + 1 < items.len() {
                self.comma();
            }
        }
        while self.next < close {
            self.word();
        }
        self.ops.push(Op::Dedent);
        if !items.is_empty() {
            self.break_line(Break::Soft, 0, 0);
        }
        self.word();
        self.close();
    }

    /// Writes what closes the item before a comma, and the comma.
    pub(super) fn comma(&mut self) {
        self.close_parens();
        self.word();
    }

    /// Writes the closing parentheses that come next.
    pub(super) fn close_parens(&mut self) {
        while self.peek() == ")" {
            self.word();
        }
    }

    // ---- statements

    /// Writes all of a file.
    pub(super) fn file<T>(
        &mut self,
        items: &[T],
        span: &impl Fn(&T) -> Span,
        inside: &mut impl FnMut(&mut Self, &T),
    ) {
        if !items.is_empty() && !self.words.comments[0].is_empty() {
            self.begin_line(true);
        }
        self.statements(items, span, inside);
        self.comments_apart(true);
    }

    /// Writes braces with statements in them.
    pub(super) fn braces<T>(
        &mut self,
        braces: Braces,
        items: &[T],
        span: impl Fn(&T) -> Span,
        mut inside: impl FnMut(&mut Self, &T),
    ) {
        self.word();
        let open = self.next - 1;
        let close = self.words.closing(open);
        if close == self.next && self.words.comments[close].is_empty() {
            self.glued = true;
            return self.word();
        }
        let line = |word: usize| self.words.line(word);
        let free = |word: usize| self.words.comments[word].is_empty();
        let hanging =
            line(open) == line(self.next) && line(close - 1) == line(close) && free(self.next) && free(close);
        let together = line(open) == line(close)
            || (hanging && items.len() == 1 && (self.next..close).all(free) && braces == Braces::Hanging);
        if together && free(close) {
            self.together(items, &span, &mut inside);
        } else if hanging && items.len() > 1 && braces == Braces::Hanging {
            self.aligned(|w| w.statements(items, &span, &mut inside));
        } else {
            self.ops.push(Op::Indent(INSIDE));
            if !items.is_empty() {
                self.begin_line(false);
                self.statements(items, &span, &mut inside);
            }
            self.comments_apart(!items.is_empty());
            self.ops.push(Op::Dedent);
            self.ops.push(Op::Newline { empty: false, deeper: 0 });
            self.glued = true;
        }
        self.word();
    }

    /// Statements on the line of their braces if they fit, else each on a line of its own.
    fn together<T>(
        &mut self,
        items: &[T],
        span: &impl Fn(&T) -> Span,
        inside: &mut impl FnMut(&mut Self, &T),
    ) {
        self.open(false);
        self.ops.push(Op::Indent(INSIDE));
        for (k, item) in items.iter().enumerate() {
            self.break_line(Break::Statement, if k == 0 { 1 } else { 2 }, 0);
            self.statement(span(item), |w| inside(w, item));
        }
        self.ops.push(Op::Dedent);
        self.break_line(Break::Soft, 1, 0);
        self.close();
    }

    /// Statements, those that share a line on one line as long as they fit.
    pub(super) fn statements<T>(
        &mut self,
        items: &[T],
        span: &impl Fn(&T) -> Span,
        inside: &mut impl FnMut(&mut Self, &T),
    ) {
        self.open(true);
        for (k, item) in items.iter().enumerate() {
            if k > 0 && self.shares_line() {
                self.break_line(Break::Statement, 2, 0);
            } else if k > 0 {
                self.begin_line(true);
            }
            self.statement(span(item), |w| inside(w, item));
        }
        self.close();
    }

    fn statement(&mut self, span: Span, inside: impl FnOnce(&mut Self)) {
        self.open(false);
        inside(self);
        self.up_to(span.end);
        self.close();
    }

    /// Begins a line for the next word, with the comments before that on lines of their own.
    pub(super) fn begin_line(&mut self, may_be_empty: bool) {
        let empty = self.comments_apart(may_be_empty);
        self.ops.push(Op::Newline { empty, deeper: 0 });
        self.glued = true;
    }

    /// Writes the comments before the next word, of which the first may stand behind the last word; whether an empty line
    /// follows.
    pub(super) fn comments_apart(&mut self, mut may_be_empty: bool) -> bool {
        let last = self.next.checked_sub(1).map(|word| self.words.line(word));
        let mut line = last;
        for comment in std::mem::take(&mut self.words.comments[self.next]) {
            let at = comment.place.line;
            if line.is_some() && line != Some(at) {
                let empty = may_be_empty && line.is_some_and(|line| at > line + 1);
                self.ops.push(Op::Newline { empty, deeper: 0 });
            }
            may_be_empty |= line != Some(at) || last.is_none();
            line = Some(at);
            self.ops.push(Op::Comment(comment));
        }
        may_be_empty && line.is_some_and(|line| self.words.line(self.next) > line + 1)
    }

    /// Writes the comments before the next word, within a statement.
    fn comments(&mut self, deeper: usize) {
        let mut line = self.next.checked_sub(1).map(|word| self.words.line(word));
        for comment in std::mem::take(&mut self.words.comments[self.next]) {
            if line.is_some_and(|line| line != comment.place.line) {
                self.ops.push(Op::Newline { empty: false, deeper });
            }
            line = Some(comment.place.line);
            self.ops.push(Op::Comment(comment));
        }
        self.ops.push(Op::Newline { empty: false, deeper });
        self.glued = true;
    }
}
