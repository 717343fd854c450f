//! Everything that can be wrong with a text, and how each is said: codes `HY0101` to `HY0119`.

use crate::base::{Diagnostic, Span};

/// One failure of the syntax floor.
#[derive(Clone, Debug, PartialEq)]
pub enum SyntaxError {
    /// Something else should stand here.
    Unexpected {
        /// Where.
        span: Span,
        /// What may stand there, in words.
        expected: Vec<String>,
        /// What stands there, in words.
        found: String,
        /// What to type, where that can be guessed.
        help: Option<String>,
    },
    /// Brackets or prefixes nest deeper than the limit.
    TooDeep {
        /// Where the limit is passed.
        span: Span,
        /// The limit.
        limit: usize,
    },
    /// An opening bracket without its partner.
    Unclosed {
        /// The opening bracket.
        open: Span,
        /// Which.
        bracket: char,
        /// Where the closing one is missed.
        missed: Span,
        /// What stands there, in words.
        before: String,
    },
    /// A closing bracket without its partner.
    Unopened {
        /// The closing bracket.
        span: Span,
        /// Which.
        bracket: char,
    },
    /// A character that is in no word of the language.
    UnknownCharacter {
        /// The character.
        span: Span,
        /// Which.
        character: char,
    },
    /// A string that does not end on its line.
    UnterminatedString {
        /// From the quote to the end of the line.
        span: Span,
    },
    /// `1.`, `.5`, `3x`, `1e`
    MalformedNumber {
        /// The literal.
        span: Span,
        /// The literal.
        text: String,
        /// What was probably meant.
        help: String,
    },
    /// A literal beyond the greatest real.
    NumberTooLarge {
        /// The literal.
        span: Span,
    },
    /// An operator of other languages.
    ForeignOperator {
        /// The operator.
        span: Span,
        /// The operator.
        text: String,
        /// Its name here.
        help: &'static str,
    },
    /// A reserved word where a name should stand.
    ReservedWord {
        /// The word.
        span: Span,
        /// The word.
        word: String,
    },
    /// A unit behind something that is neither a number nor a type.
    MisplacedUnit {
        /// The unit.
        span: Span,
        /// The unit.
        unit: String,
        /// What stands before it.
        base: Span,
    },
    /// Brackets behind a number or a type that hold no unit.
    NotAUnit {
        /// The brackets.
        span: Span,
        /// What they hold.
        text: String,
    },
    /// `=`, `:=`, `==` or a missing `'` where another of them belongs.
    WrongAssignment {
        /// The sign.
        span: Span,
        /// What is wrong.
        title: String,
        /// What to type.
        help: String,
    },
    /// `a < b < c`
    ChainedComparison {
        /// The second comparison.
        span: Span,
    },
    /// A named argument in a call, or one without a name in a constructor.
    ArgumentStyle {
        /// Where.
        span: Span,
        /// What is wrong.
        title: &'static str,
        /// What to type.
        help: String,
    },
    /// Parentheses behind something that is not a name.
    NotAFunction {
        /// The parentheses.
        span: Span,
        /// What stands before them.
        callee: Span,
    },
    /// A word that is nearly a keyword, or stands for one in other languages.
    UnknownWord {
        /// The word.
        span: Span,
        /// What is wrong.
        title: String,
        /// What to type.
        help: String,
    },
    /// `history` as a mode's name, or where no mode is entered.
    MisplacedHistory {
        /// The word.
        span: Span,
    },
    /// A text longer than the limit.
    FileTooLarge {
        /// The start of the text.
        span: Span,
        /// The limit, in bytes.
        limit: usize,
    },
}

impl SyntaxError {
    /// As a message to a person.
    pub fn diagnostic(&self) -> Diagnostic {
        match self {
            Self::Unexpected { span, expected, found, help } => {
                let found = format!("found {found}");
                let title = if expected.is_empty() {
                    found
                } else {
                    format!("expected {}, {found}", any_of(expected))
                };
                let here = if expected.len() > 1 {
                    "not possible here".to_string()
                } else {
                    expected_here(expected)
                };
                with_help(Diagnostic::error("HY0101", title).label(*span, here), help.clone())
            }
            Self::TooDeep { span, limit } => Diagnostic::error("HY0102", "nesting is too deep")
                .label(*span, format!("the limit of {limit} levels is passed here"))
                .help("give names to inner parts with `let`"),
            Self::Unclosed { open, bracket, missed, before } => {
                Diagnostic::error("HY0103", format!("this `{bracket}` is never closed"))
                    .label(*open, "opened here")
                    .label(*missed, format!("`{}` is missing before {before}", partner(*bracket)))
                    .help(format!("write `{}` where what it opens ends", partner(*bracket)))
            }
            Self::Unopened { span, bracket } => {
                Diagnostic::error("HY0104", format!("this `{bracket}` closes nothing"))
                    .label(*span, format!("no `{}` is open here", partner(*bracket)))
                    .help(format!("leave it out, or write `{}` where it should open", partner(*bracket)))
            }
            Self::UnknownCharacter { span, character } => {
                let shown = character.escape_debug();
                let found = Diagnostic::error("HY0105", format!("unknown character `{shown}`"))
                    .label(*span, "not part of the language");
                with_help(found, character_help(*character).map(String::from))
            }
            Self::UnterminatedString { span } => Diagnostic::error("HY0106", "this string has no end")
                .label(*span, "a string ends on the line on which it begins")
                .help("add the closing `\"`"),
            Self::MalformedNumber { span, text, help } => {
                Diagnostic::error("HY0107", format!("`{text}` is not a number"))
                    .label(*span, "malformed number")
                    .help(help.as_str())
            }
            Self::NumberTooLarge { span } => Diagnostic::error("HY0108", "this number is too large")
                .label(*span, "the greatest real is about 1.8e308")
                .help("for infinity write `inf`"),
            Self::ForeignOperator { span, text, help } => {
                Diagnostic::error("HY0109", format!("there is no operator `{text}`"))
                    .label(*span, "unknown operator")
                    .help(*help)
            }
            Self::ReservedWord { span, word } => {
                Diagnostic::error("HY0110", format!("`{word}` is a reserved word"))
                    .label(*span, "cannot be used as a name")
                    .help(format!("choose another name, for example `{word}_`"))
            }
            Self::MisplacedUnit { span, unit, base } => Diagnostic::error(
                "HY0111",
                format!("a unit cannot stand here: `[{unit}]` follows neither a number nor a type"),
            )
            .label(*span, "unit")
            .label(*base, "this is neither a number nor a type")
            .help("give the unit where the name is declared, or to a number: `1 [m]*x`"),
            Self::NotAUnit { span, text } => {
                let title = if text.is_empty() {
                    "this unit is empty".to_string()
                } else {
                    format!("`{text}` is not a unit")
                };
                Diagnostic::error("HY0112", title)
                    .label(*span, "brackets behind a number or a type hold a unit")
                    .help("units look like `m`, `m/s^2`, `kg*m^2` or `1/s`")
            }
            Self::WrongAssignment { span, title, help } => {
                Diagnostic::error("HY0113", title.as_str()).label(*span, "not this sign").help(help.as_str())
            }
            Self::ChainedComparison { span } => Diagnostic::error("HY0114", "comparisons do not chain")
                .label(*span, "a second comparison")
                .help("write `a < b and b < c`"),
            Self::ArgumentStyle { span, title, help } => {
                Diagnostic::error("HY0115", *title).label(*span, "in this argument").help(help.as_str())
            }
            Self::NotAFunction { span, callee } => {
                Diagnostic::error("HY0116", "only a function's name can be called")
                    .label(*span, "arguments of a call")
                    .label(*callee, "not the name of a function")
                    .help("a product needs its sign: `2*(a + b)`")
            }
            Self::UnknownWord { span, title, help } => Diagnostic::error("HY0117", title.as_str())
                .label(*span, "unknown keyword")
                .help(help.as_str()),
            Self::MisplacedHistory { span } => {
                Diagnostic::error("HY0118", "`history` stands only at the end of a target after `->`")
                    .label(*span, "not possible here")
                    .help("write `-> M.history` to enter the submode of M that was active last")
            }
            Self::FileTooLarge { span, limit } => {
                Diagnostic::error("HY0119", format!("the file is larger than {} MiB", limit >> 20))
                    .label(*span, "this file")
                    .help("read large tables from CSV files")
            }
        }
    }
}

fn with_help(diagnostic: Diagnostic, help: Option<String>) -> Diagnostic {
    match help {
        Some(help) => diagnostic.help(help),
        None => diagnostic,
    }
}

fn expected_here(expected: &[String]) -> String {
    expected.first().map_or("not possible here".to_string(), |what| format!("{what} should stand here"))
}

/// `a`, `a or b`, `a, b or c`.
fn any_of(words: &[String]) -> String {
    match words {
        [] => String::new(),
        [one] => one.clone(),
        [most @ .., last] => format!("{} or {last}", most.join(", ")),
    }
}

/// The other bracket of a pair.
pub fn partner(bracket: char) -> char {
    match bracket {
        '(' => ')',
        '[' => ']',
        '{' => '}',
        ')' => '(',
        ']' => '[',
        '}' => '{',
        other => other,
    }
}

fn character_help(character: char) -> Option<&'static str> {
    match character {
        '#' => Some("a comment begins with `//`"),
        '`' | '\u{2018}' | '\u{201c}' | '\u{201d}' => {
            Some("strings stand between straight double quotes: \"text\"")
        }
        '\u{2019}' | '\u{2032}' => Some("a rate is written with a straight quote: `x'`"),
        '\u{2212}' | '\u{2013}' => Some("write the minus sign of the keyboard: `-`"),
        '\u{00d7}' | '\u{22c5}' | '\u{00b7}' => Some("a product is written `*`"),
        '\u{2264}' => Some("write `<=`"),
        '\u{2265}' => Some("write `>=`"),
        '\u{2260}' => Some("write `!=`"),
        '\u{2192}' => Some("write `->`"),
        '?' => Some("in an expression write `if c then a else b`"),
        '\u{00b0}' => Some("degrees are the unit `[deg]`"),
        other if other.is_alphabetic() => Some("names are made of the letters a to z, digits and `_`"),
        _ => None,
    }
}
