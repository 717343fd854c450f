//! Turns the place where the grammar gave up into an error that a person can act on.
//!
//! In: the text with its tokens, pest's error (a position and the rules that would have fitted there). Out: one [`SyntaxError`]. Common
//! mistakes are recognised one after the other; what is left is "expected ..., found ...".

use pest::error::{Error, ErrorVariant, InputLocation};

use super::error::SyntaxError;
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
        .or_else(|| failure.misspelt_keyword())
        .or_else(|| failure.reserved_word())
        .unwrap_or_else(|| failure.unexpected())
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
            ("`=` does not compare".to_string(), "write `==`".to_string())
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
            let (title, help) = ("the arguments of a constructor have names", "write `Car(v = 4)`");
            return Some(SyntaxError::ArgumentStyle { span: self.span_of(self.found - 1), title, help });
        }
        if only(&[Rule::named_arg, Rule::close_paren, Rule::name])
            && self.is_constructor(open)
            && !self.is_word(self.found)
        {
            let (title, help) = ("the arguments of a constructor have names", "write `Car(v = 4)`");
            return Some(SyntaxError::ArgumentStyle { span: self.span(), title, help });
        }
        if matches!(self.found(), "=" | "~") && self.fits(Rule::comma) && self.fits(Rule::close_paren) {
            let (title, help) =
                ("the arguments of a call have no names", "give them by their position: `f(1, 2)`");
            return Some(SyntaxError::ArgumentStyle { span: self.span(), title, help });
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

    /// `sate x, y`: a word that begins no statement but looks like a keyword that does.
    fn misspelt_keyword(&self) -> Option<SyntaxError> {
        let fitting: Vec<String> = self.fitting.iter().flat_map(|rule| words_that_begin(*rule)).collect();
        let known: Vec<String> = STATEMENTS.iter().map(|word| word.to_string()).collect();
        let (k, keyword) = self
            .looks_like(Some(self.found), &fitting)
            .or_else(|| self.looks_like(self.statement_start(), &known))?;
        Some(SyntaxError::MisspeltKeyword {
            span: self.span_of(k),
            word: self.token(Some(k)).to_string(),
            keyword,
        })
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
        let named = matches!(self.token(Some(first + 1)), "=" | ":=" | ":" | "~" | "'" | "." | "->");
        (first < self.found && !named).then_some(first)
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
            "=" if self.fits(Rule::kw_to) => "a setting has no sign: `tolerance 1e-6`",
            "," if self.fits(Rule::close_brace) => "statements need no separator",
            "not" => "put the condition in parentheses: `(not p)`",
            ":=" => "actions stand in braces: `{ x := 3 }`",
            _ if self.token(Some(self.found + 1)) == ":=" => "actions stand in braces: `{ x := 3 }`",
            _ => return None,
        };
        Some(help.to_string())
    }
}
