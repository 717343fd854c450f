//! Turns the place where the grammar gave up into an error that a person can act on.
//!
//! In: the text with its tokens, pest's error (a position and the rules that would have fitted there). Out: one [`SyntaxError`]. Common
//! mistakes are recognised one after the other, words of other languages by a table; what is left is "expected ..., found ...".

use pest::error::{Error, ErrorVariant, InputLocation};

use super::error::SyntaxError;
use super::foreign::{self, Place};
use super::grammar::{Rule, is_reserved};
use super::scan::{Source, TokenKind};
use super::words::{NAMES, OPERATOR, STATEMENTS, in_words, words_that_begin};
use crate::base::Span;
use crate::syntax::MAX_NESTING;

/// The error of a text that is not in the language.
pub fn explain(source: Source, error: &Error<Rule>) -> SyntaxError {
    let at = match error.location {
        InputLocation::Pos(at) | InputLocation::Span((at, _)) => at,
    };
    let ErrorVariant::ParsingError { positives, .. } = &error.variant else {
        // The only other variant says that the stack is full, which the bound on nesting excludes.
        return SyntaxError::TooDeep { span: Span::new(source.file, at, at), limit: MAX_NESTING };
    };
    let found = source.tokens.partition_point(|token| token.end() <= at);
    // Behind an operator all fits that an expression can begin with, and nothing else.
    let fitting = if positives.contains(&Rule::value_name) { &[Rule::expr] } else { positives.as_slice() };
    let failure = Failure { source, found, fitting };
    failure
        .argument_style()
        .or_else(|| failure.wrong_assignment())
        .or_else(|| failure.chained_comparison())
        .or_else(|| failure.foreign_operator())
        .or_else(|| failure.foreign_statement())
        .or_else(|| failure.without_brackets())
        .or_else(|| failure.misspelt_keyword())
        .or_else(|| failure.reserved_word())
        .unwrap_or_else(|| failure.unexpected())
}

/// Words with which expressions and formulas begin.
const PREFIXES: [&str; 6] = ["always", "eventually", "exists", "forall", "count", "nearest"];

fn argument_style(span: Span, title: &'static str, help: &str) -> SyntaxError {
    SyntaxError::ArgumentStyle { span, title, help: help.to_string() }
}

fn no_statement(word: &str) -> String {
    format!("no statement begins with `{word}`")
}

/// Where the grammar gave up.
struct Failure<'t> {
    source: Source<'t>,
    /// The number of the token that did not fit; beyond the last one at the end of the file.
    found: usize,
    /// The rules that would have fitted.
    fitting: &'t [Rule],
}

impl Failure<'_> {
    fn fits(&self, rule: Rule) -> bool {
        self.fitting.contains(&rule)
    }

    /// The text of a token, empty beyond the ends.
    fn token(&self, k: Option<usize>) -> &str {
        k.map_or("", |k| self.source.word(k))
    }

    fn found(&self) -> &str {
        self.token(Some(self.found))
    }

    fn before(&self, steps: usize) -> &str {
        self.token(self.found.checked_sub(steps))
    }

    fn span_of(&self, k: usize) -> Span {
        let Source { file, tokens, .. } = self.source;
        match tokens.get(k) {
            Some(token) => Span::new(file, token.start(), token.end()),
            None => {
                let end = tokens.last().map_or(0, |last| last.end());
                Span::new(file, end, end)
            }
        }
    }

    fn span(&self) -> Span {
        self.span_of(self.found)
    }

    fn is_word(&self, k: usize) -> bool {
        self.source.tokens.get(k).is_some_and(|token| token.kind == TokenKind::Word)
    }

    fn wrong_assignment(&self) -> Option<SyntaxError> {
        let (sign, name) = (self.found(), self.before(1));
        if !matches!(sign, "=" | ":=" | "==" | "~") {
            return None;
        }
        let (title, help) = if self.fits(Rule::assign) {
            (format!("an action does not assign with `{sign}`"), "write `:=`".to_string())
        } else if self.fits(Rule::prime) && self.in_flow() {
            ("a flow gives rates, not values".to_string(), format!("write `{name}' = ...`, with a quote"))
        } else if self.fits(Rule::equals) && name == "'" {
            (format!("a rate is not given with `{sign}`"), "write `x' = ...`".to_string())
        } else if self.fits(Rule::equals) {
            (
                format!("a value is not given with `{sign}` here"),
                "write `=`; only actions assign with `:=`".to_string(),
            )
        } else if sign == "=" && self.fits(Rule::compare_op) {
            let help = if self.in_condition() {
                "write `==`; what flows is never equal but for an instant: `x >= 3`, or `crossing(x - 3)`"
            } else {
                "write `==`"
            };
            ("`=` does not compare".to_string(), help.to_string())
        } else {
            return None;
        };
        Some(SyntaxError::WrongAssignment { span: self.span(), title, help })
    }

    /// The tokens before the failure's innermost open bracket: its own number, if there is one.
    fn opener(&self) -> Option<usize> {
        let mut closed = 0_usize;
        for k in (0..self.found.min(self.source.tokens.len())).rev() {
            match self.token(Some(k)) {
                ")" | "]" | "}" => closed += 1,
                "(" | "[" | "{" if closed == 0 => return Some(k),
                "(" | "[" | "{" => closed -= 1,
                _ => {}
            }
        }
        None
    }

    fn in_parentheses(&self) -> bool {
        self.opener().is_some_and(|open| self.token(Some(open)) == "(")
    }

    fn in_flow(&self) -> bool {
        self.token(self.opener().and_then(|open| open.checked_sub(1))) == "flow"
    }

    fn chained_comparison(&self) -> Option<SyntaxError> {
        let second = matches!(self.found(), "<" | "<=" | ">" | ">=" | "==" | "!=" | "is");
        let after_first = self.fits(Rule::operator) && !self.fits(Rule::compare_op);
        (second && after_first).then(|| SyntaxError::ChainedComparison { span: self.span() })
    }

    fn argument_style(&self) -> Option<SyntaxError> {
        let open = self.opener()?;
        if self.token(Some(open)) != "(" || open == 0 {
            return None;
        }
        let called = self.is_word(open - 1) || self.token(Some(open - 1)) == "]";
        if !called {
            return None;
        }
        let only =
            |rules: &[Rule]| !self.fitting.is_empty() && self.fitting.iter().all(|rule| rules.contains(rule));
        if only(&[Rule::equals, Rule::tilde]) && !matches!(self.found(), ":=" | "==") {
            let span = self.span_of(self.found - 1);
            return Some(argument_style(
                span,
                "the arguments of a constructor have names",
                "write `Car(v = 4)`",
            ));
        }
        if only(&[Rule::named_arg, Rule::close_paren, Rule::name])
            && self.is_constructor(open)
            && !self.is_word(self.found)
        {
            let title = "the arguments of a constructor have names";
            return Some(argument_style(self.span(), title, "write `Car(v = 4)`"));
        }
        if matches!(self.found(), "=" | "~") && self.fits(Rule::comma) && self.fits(Rule::close_paren) {
            let title = "the arguments of a call have no names";
            return Some(argument_style(self.span(), title, "give them by their position: `f(1, 2)`"));
        }
        None
    }

    /// Whether the parenthesis with this number is that of a constructor: behind `name =` or `create`.
    fn is_constructor(&self, open: usize) -> bool {
        let mut k = open - 1;
        while k > 0 && !matches!(self.token(Some(k)), "=" | "create" | "{" | "}" | "(") {
            k -= 1;
        }
        matches!(self.token(Some(k)), "=" | "create") && self.found() != ")"
    }

    /// What the braces around the failure belong to.
    fn place(&self) -> Place {
        let Some(open) = self.innermost_brace() else { return Place::File };
        let before = |steps: usize| self.token(open.checked_sub(steps));
        match (before(2), before(1)) {
            (_, "flow") => Place::Flow,
            (_, "system") => Place::System,
            (_, "run") => Place::Run,
            (_, "entry" | "exit" | "else") => Place::Actions,
            ("agent" | "mode" | "region", _) => Place::Body,
            (_, ")") => {
                let closed = (0..open).rev().find(|&k| self.token(Some(k)) == "(");
                let head = closed.and_then(|k| k.checked_sub(2)).map_or("", |k| self.token(Some(k)));
                if matches!(head, "agent" | "interaction") { Place::Body } else { Place::Actions }
            }
            _ => Place::Actions,
        }
    }

    /// The brace that is open where the failure is.
    fn innermost_brace(&self) -> Option<usize> {
        let mut closed = 0_usize;
        (0..self.found.min(self.source.tokens.len())).rev().find(|&k| match self.token(Some(k)) {
            "}" => {
                closed += 1;
                false
            }
            "{" if closed > 0 => {
                closed -= 1;
                false
            }
            token => token == "{",
        })
    }

    /// Whether the failure is in the condition of a transition.
    fn in_condition(&self) -> bool {
        let ends =
            |token: &str| matches!(token, "{" | "}" | "->" | "let" | "invariant" | "assert" | "by" | "flow");
        let before = (0..self.found).rev().map(|k| self.token(Some(k)));
        before.take_while(|token| !ends(token)).any(|token| token == "when")
    }

    /// Whether a token stands on the line of the one before it, with only blanks between them.
    fn continues(&self, k: usize) -> bool {
        let between = k.checked_sub(1).and_then(|before| {
            let (before, this) = (self.source.tokens.get(before)?, self.source.tokens.get(k)?);
            self.source.text.get(before.end()..this.start())
        });
        between.is_some_and(|between| between.chars().all(|c| matches!(c, ' ' | '\t')))
    }

    /// Whether a statement goes on with this token behind its first name.
    fn is_named(&self, k: usize) -> bool {
        matches!(self.token(Some(k + 1)), "=" | ":=" | ":" | "~" | "'" | "." | "->")
    }

    /// Whether a statement may begin with this token: the one before it does not ask for more.
    fn may_begin(&self, k: usize) -> bool {
        let Some(before) = k.checked_sub(1) else { return true };
        let word = self.token(Some(before));
        match self.source.tokens.get(before).map(|token| token.kind) {
            Some(TokenKind::Symbol) => matches!(word, "{" | "}" | ")" | "]" | "'"),
            Some(TokenKind::Word) => !is_reserved(word),
            Some(TokenKind::Number | TokenKind::Text) | None => true,
        }
    }

    /// The tokens that can be what is wrong: the one that did not fit, and the one before it, which fitted as a name.
    fn suspects(&self) -> impl Iterator<Item = usize> {
        [Some(self.found), self.found.checked_sub(1)].into_iter().flatten()
    }

    /// `a AND b`, `a mod b`
    fn foreign_operator(&self) -> Option<SyntaxError> {
        let is_operand = |k: usize| match self.source.tokens.get(k).map(|token| token.kind) {
            Some(TokenKind::Word) => !is_reserved(self.token(Some(k))) || self.fits(Rule::operator),
            Some(TokenKind::Number) => true,
            _ => matches!(self.token(Some(k)), ")" | "]"),
        };
        let between = |&k: &usize| self.continues(k) && is_operand(k - 1);
        self.suspects().filter(between).find_map(|k| {
            let (span, text) = (self.span_of(k), self.token(Some(k)).to_string());
            foreign::operator(&text).map(|help| SyntaxError::ForeignOperator { span, text, help })
        })
    }

    /// `sin x`: an argument without parentheses; `1 s`: a unit without brackets.
    fn without_brackets(&self) -> Option<SyntaxError> {
        let begins = |k: usize| self.is_named(k) && self.token(Some(k + 1)) != "->";
        self.suspects().filter(|&k| self.continues(k) && !begins(k)).find_map(|k| {
            let (before, this) = (self.token(Some(k - 1)), self.token(Some(k)));
            let is_value = self.source.tokens.get(k).is_some_and(|token| {
                token.kind == TokenKind::Number || token.kind == TokenKind::Word && !is_reserved(this)
            });
            if is_value && foreign::FUNCTIONS.contains(&before) {
                let (title, help) =
                    ("an argument stands in parentheses", format!("write `{before}({this})`"));
                return Some(SyntaxError::ArgumentStyle { span: self.span_of(k), title, help });
            }
            let is_number = self.source.tokens[k - 1].kind == TokenKind::Number;
            let may_be_unit = self.is_word(k) && (!is_reserved(this) || this == "min");
            (is_number && may_be_unit).then(|| self.bare_unit(k))
        })
    }

    /// The number before this token, and the unit that begins with it.
    fn bare_unit(&self, k: usize) -> SyntaxError {
        let is_sign = |k: usize| matches!(self.token(Some(k)), "/" | "*" | "^");
        let is_part =
            |k: usize| self.source.tokens.get(k).is_some_and(|token| token.kind != TokenKind::Symbol);
        let mut last = k;
        while is_sign(last + 1) && is_part(last + 2) && self.continues(last + 1) && self.continues(last + 2) {
            last += 2;
        }
        let (number, spelt) = (self.span_of(k - 1), self.span_of(k).to(self.span_of(last)));
        let text = |span: Span| &self.source.text[span.range()];
        let (count, word) = (text(number), text(spelt));
        let help = match foreign::unit(word) {
            Some(unit) => format!("a unit stands in brackets: `{count} [{unit}]`"),
            None => format!(
                "a unit stands in brackets, `{count} [{word}]`; a product has its sign, `{count}*{word}`"
            ),
        };
        let span = number.to(spelt);
        SyntaxError::MalformedNumber { span, text: text(span).to_string(), help }
    }

    /// `var x = 0`: a word that begins statements in other languages.
    fn foreign_statement(&self) -> Option<SyntaxError> {
        let place = self.place();
        if self.before(2) == "new" && matches!(self.before(3), "=" | "create") {
            let (expected, found) = (vec!["an agent type".to_string()], "the name `new`".to_string());
            let head = if self.before(3) == "=" { format!("{} =", self.before(4)) } else { "create".into() };
            let help = Some(format!("leave out `new`: `{head} {}()`", self.before(1)));
            return Some(SyntaxError::Unexpected {
                span: self.span_of(self.found - 2),
                expected,
                found,
                help,
            });
        }
        let heads = self.suspects().chain(self.statement_start());
        heads.filter(|&k| self.is_word(k) && !self.is_named(k) && self.may_begin(k)).find_map(|k| {
            let word = self.token(Some(k));
            let help = foreign::statement(word, place)?.to_string();
            let title = if is_reserved(word) {
                format!("no statement begins with `{word}` here")
            } else {
                no_statement(word)
            };
            Some(SyntaxError::UnknownWord { span: self.span_of(k), title, help })
        })
    }

    /// `sate x, y`: a word that begins no statement but looks like a keyword that does; `alwasy x > 0`.
    fn misspelt_keyword(&self) -> Option<SyntaxError> {
        let fitting: Vec<String> = self.fitting.iter().flat_map(|rule| words_that_begin(*rule)).collect();
        let known: Vec<String> = STATEMENTS.iter().map(|word| word.to_string()).collect();
        let (k, keyword) = self
            .looks_like(Some(self.found), &fitting)
            .or_else(|| self.looks_like(self.statement_start(), &known))
            .or_else(|| self.misspelt_prefix())?;
        let word = self.token(Some(k));
        let title = if PREFIXES.contains(&keyword.as_str()) {
            format!("unknown word `{word}`")
        } else {
            no_statement(word)
        };
        let help = format!("did you mean `{keyword}`?");
        Some(SyntaxError::UnknownWord { span: self.span_of(k), title, help })
    }

    /// A word that looks like one with which an expression begins, before something that cannot follow a name.
    fn misspelt_prefix(&self) -> Option<(usize, String)> {
        let before = self.found.checked_sub(1).filter(|_| self.continues(self.found))?;
        let is_value =
            self.source.tokens.get(self.found).is_some_and(|token| token.kind != TokenKind::Symbol);
        let prefixes = PREFIXES.map(String::from);
        is_value.then(|| self.looks_like(Some(before), &prefixes)).flatten()
    }

    /// The number of a token that is a name but nearly one of these words, and that word.
    fn looks_like(&self, k: Option<usize>, words: &[String]) -> Option<(usize, String)> {
        let k = k.filter(|&k| self.is_word(k) && !is_reserved(self.token(Some(k))))?;
        let name = self.token(Some(k));
        if name.len() < 3 {
            return None;
        }
        let distance = |word: &String| (strsim::osa_distance(name, word), !word.starts_with(&name[..1]));
        let nearest = words.iter().min_by_key(|word| distance(word))?;
        let near = if name.len() > 4 { 2 } else { 1 };
        (distance(nearest).0 <= near).then(|| (k, nearest.clone()))
    }

    /// The first token of the line on which the grammar gave up, if it can be meant as the keyword of a statement.
    fn statement_start(&self) -> Option<usize> {
        let end = self.source.tokens.get(self.found)?.start();
        let line = self.source.text[..end].rfind(['\n', ';', '{', '}']).map_or(0, |at| at + 1);
        let first = self.source.tokens.partition_point(|token| token.start() < line);
        (first < self.found && !self.is_named(first)).then_some(first)
    }

    fn reserved_word(&self) -> Option<SyntaxError> {
        let word = self.found();
        if !self.is_word(self.found) || !is_reserved(word) {
            return None;
        }
        let names = |rule: &Rule| NAMES.contains(rule);
        let only_names = self
            .fitting
            .iter()
            .all(|rule| names(rule) || *rule == Rule::close_paren || *rule == Rule::kw_other);
        let named = self.fitting.iter().any(names);
        let like_a_name = matches!(self.token(Some(self.found + 1)), "=" | ":=" | ":" | "~" | "'");
        let statement = self.fitting.iter().flat_map(|rule| words_that_begin(*rule)).count() > 3;
        (named && only_names || like_a_name && (named || statement))
            .then(|| SyntaxError::ReservedWord { span: self.span(), word: word.to_string() })
    }

    fn unexpected(&self) -> SyntaxError {
        let found = match self.source.tokens.get(self.found) {
            None => "the end of the file".to_string(),
            Some(token) => match token.kind {
                TokenKind::Word if is_reserved(self.found()) => {
                    format!("the reserved word `{}`", self.found())
                }
                TokenKind::Word => format!("the name `{}`", self.found()),
                TokenKind::Number => format!("the number `{}`", self.found()),
                TokenKind::Text => "a string".to_string(),
                TokenKind::Symbol => format!("`{}`", self.found()),
            },
        };
        SyntaxError::Unexpected { span: self.span(), expected: self.expected(), found, help: self.help() }
    }

    /// What would have fitted, in words, each once; operators only if there is nothing else.
    fn expected(&self) -> Vec<String> {
        let mut words = Vec::new();
        for rule in self.fitting {
            for word in in_words(*rule) {
                if !words.contains(&word) {
                    words.push(word);
                }
            }
        }
        if self.fits(Rule::operator) {
            let suffixes = ["a unit", "`(`", "`[`", "`'`"];
            words.retain(|word| !suffixes.contains(&word.as_str()));
        }
        if words.len() > 1 {
            words.retain(|word| word != OPERATOR && word != "a unit");
        }
        let begins = |word: &String| STATEMENTS.iter().any(|keyword| *word == format!("`{keyword}`"));
        if words.iter().filter(|word| begins(word)).count() > 3 {
            words.retain(|word| !begins(word) && (word != "`:`" || self.fits(Rule::kw_by)));
            words.insert(0, "a statement".to_string());
        }
        words
    }

    /// What to type, for mistakes that come from other languages or from elsewhere in this one.
    fn help(&self) -> Option<String> {
        let help = match self.found() {
            "{" if self.fits(Rule::kw_then) => "in an expression write `if c then a else b`",
            "then" if self.fits(Rule::arrow) => {
                "actions stand in braces behind the condition: `when c { ... }`"
            }
            "then" => "among actions write `if c { ... } else { ... }`",
            "'" if self.before(1) == "'" => "a flow gives first rates: write `x' = v` and `v' = ...`",
            "'" => "rates stand in a flow: `flow { x' = ... }`",
            "(" if matches!(self.before(1), "sum" | "count") => {
                "this ranges over agents: `sum o in Car: o.x`"
            }
            "(" if self.opener().is_some_and(|open| open > 0 && self.token(Some(open - 1)) == "system") => {
                "an instance has a name: `car = Car(...)`"
            }
            "=" | ":" | ":=" if self.place() == Place::Run && self.is_word(self.found - 1) => {
                let value = self.token(Some(self.found + 1));
                return Some(format!("a setting has no sign: `{} {value}`", self.before(1)));
            }
            "[" if self.fits(Rule::colon) && (self.fits(Rule::equals) || self.in_parentheses()) => {
                let rest = &self.source.text[self.span().range().start..];
                let unit = rest.find(']').map_or("[m]", |end| &rest[..=end]);
                return Some(format!("a unit follows a type: `{}: real {unit}`", self.before(1)));
            }
            ")" | "," | "=" if self.fitting == [Rule::colon] => {
                let head = self.opener().and_then(|open| open.checked_sub(2));
                let ty = if self.token(head) == "interaction" { "Car" } else { "real" };
                return Some(format!("a parameter has a type: `{}: {ty}`", self.before(1)));
            }
            "if" if self.fits(Rule::operator) => "in an expression write `if c then a else b`",
            "else" if self.fits(Rule::open_brace) || self.fits(Rule::actions) => {
                "in an expression write `if c then a else b`"
            }
            "," if self.fits(Rule::close_brace) => "statements need no separator",
            "not" => "put the condition in parentheses: `(not p)`",
            ":=" => "actions stand in braces: `{ x := 3 }`",
            _ if self.token(Some(self.found + 1)) == ":=" => "actions stand in braces: `{ x := 3 }`",
            _ => return None,
        };
        Some(help.to_string())
    }
}
