//! Finds where a list of statements can be cut: places at which one statement has certainly ended and the next begins.
//!
//! In: a text with its tokens, a stretch of them that is a list of statements. Out: the numbers of tokens. Not every
//! beginning of a statement is found, but what is found is one: behind a closing brace only `else` goes on, a setting of a run ends
//! with its first string, no other statement has these keywords inside, and no expression has `=`, `:=` or braces outside its brackets.

use std::ops::Range;

use super::grammar::Rule;
use super::scan::{Source, TokenKind};

/// The keywords with which triggers begin.
pub const TRIGGERS: [&str; 5] = ["when", "after", "every", "rate", "on"];

/// The statements' beginnings that are certain, the first token of the list included.
pub fn beginnings(source: Source, statements: Rule, tokens: Range<usize>) -> impl Iterator<Item = usize> {
    let mut walk = Walk { source, statements, first: tokens.start, depth: 0_usize, timed: false };
    tokens.filter(move |&k| walk.step(k))
}

/// Whether a token with this mark opens a bracket.
pub fn opens(mark: u8) -> bool {
    matches!(mark, b'(' | b'[' | b'{')
}

/// Whether a token with this mark closes a bracket.
pub fn closes(mark: u8) -> bool {
    matches!(mark, b')' | b']' | b'}')
}

struct Walk<'t> {
    source: Source<'t>,
    statements: Rule,
    first: usize,
    depth: usize,
    /// Within the trigger of an `after`, `every`, `rate` or `on`, which may go on with `when`.
    timed: bool,
}

impl Walk<'_> {
    /// Takes note of a token; whether it certainly begins a statement of the list.
    fn step(&mut self, k: usize) -> bool {
        let mark = self.source.mark(k);
        let outermost = self.depth == 0;
        if opens(mark) {
            self.depth += 1;
        } else if closes(mark) {
            self.depth = self.depth.saturating_sub(1);
        }
        if !outermost {
            return false;
        }
        let word = self.source.word(k);
        let begins = k == self.first || self.begins(k, word);
        if begins {
            let trigger = if self.is_label(k) { self.source.word(k + 2) } else { word };
            self.timed = TRIGGERS.contains(&trigger) && trigger != "when";
        } else if matches!(word, "when" | "priority" | "->" | "{") {
            self.timed = false;
        }
        begins
    }

    fn begins(&self, k: usize, word: &str) -> bool {
        if self.source.mark(k - 1) == b'}' && word != "else" {
            return true;
        }
        let behind_text = self.source.tokens[k - 1].kind == TokenKind::Text;
        if behind_text && self.statements == Rule::settings {
            return true;
        }
        if self.source.tokens[k].kind != TokenKind::Word {
            return false;
        }
        let before = self.source.word(k - 1);
        let has_transitions =
            matches!(self.statements, Rule::agent_items | Rule::body_items | Rule::interaction_items);
        match word {
            "import" | "param" | "let" | "fn" | "agent" | "interaction" | "system" | "property" | "run" => {
                true
            }
            "state" | "discrete" | "link" | "event" | "region" | "flow" | "invariant" | "assert" => true,
            "initial" | "entry" | "exit" | "create" | "destroy" | "emit" | "stop" | "record" => true,
            "mode" => before != "initial",
            "when" => has_transitions && before != ":" && !self.timed,
            "after" | "every" | "rate" | "on" => has_transitions && before != ":",
            _ => self.begins_with_name(k, before, has_transitions),
        }
    }

    /// Whether a statement begins with the name that stands here.
    fn begins_with_name(&self, k: usize, before: &str, has_transitions: bool) -> bool {
        let [second, third, fourth] = [1, 2, 3].map(|after| self.source.word(k + after));
        match self.statements {
            Rule::equations => second == "'" && third == "=",
            Rule::instances => second == "=",
            Rule::action_list => {
                let writes = |sign| matches!(sign, ":=" | "~");
                before != "." && (writes(second) || second == "->" || second == "." && writes(fourth))
            }
            _ => has_transitions && self.is_label(k),
        }
    }

    /// Whether the name that stands here is the label of a transition.
    fn is_label(&self, k: usize) -> bool {
        self.source.is(k + 1, ":") && TRIGGERS.contains(&self.source.word(k + 2))
    }
}
