//! The parser that pest makes of `grammar/hy.pest`.

// The derive makes public items without docstrings.
#![allow(missing_docs)]

use pest::Parser;
use pest::iterators::Pairs;

/// The generated parser.
#[derive(pest_derive::Parser)]
#[grammar = "../grammar/hy.pest"]
struct HyParser;

/// What a rule finds at the beginning of a text; brackets must be balanced and nesting bounded.
pub fn read(rule: Rule, text: &str) -> Result<Pairs<'_, Rule>, Box<pest::error::Error<Rule>>> {
    HyParser::parse(rule, text).map_err(Box::new)
}

/// Whether a word can be no name.
pub fn is_reserved(word: &str) -> bool {
    HyParser::parse(Rule::name, word).is_err()
}
