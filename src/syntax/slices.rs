//! Cuts what is long in a text into slices, so that the grammar never holds the tokens of more than one at a time.
//!
//! In: a text with its tokens, a rule of the grammar, the stretch of tokens that it should cover. Out: [`Slice`]s in
//! order, which together are what the rule consists of. Each is a stretch for which the grammar has a rule of its own;
//! one that is still long is cut again when its turn comes. If a slice turns out not to be what its rule says, the whole
//! text is read at once, and is either in the language in a way that is not foreseen here or gives the error to tell.

use std::ops::Range;

use super::grammar::Rule;
use super::scan::Source;
use super::statements::{TRIGGERS, beginnings, closes, opens};

/// A stretch of the text that a rule should cover.
#[derive(Clone, Debug)]
pub struct Slice {
    /// The rule.
    pub rule: Rule,
    /// The numbers of its tokens; never empty.
    pub tokens: Range<usize>,
    /// How it is read.
    pub reading: Reading,
}

/// How a slice is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reading {
    /// By the grammar.
    AtOnce,
    /// Cut again.
    InSlices,
}

/// What the rule's parts are, in slices of about `bytes` bytes.
pub fn slices(source: Source, bytes: usize, rule: Rule, tokens: Range<usize>) -> Vec<Slice> {
    let mut cutter = Cutter { source, bytes, slices: Vec::new() };
    cutter.cut(rule, tokens);
    cutter.slices
}

struct Cutter<'t> {
    source: Source<'t>,
    bytes: usize,
    slices: Vec<Slice>,
}

impl Cutter<'_> {
    fn cut(&mut self, rule: Rule, tokens: Range<usize>) {
        match rule {
            Rule::file => self.statements(Rule::items, tokens),
            Rule::agent => self.braced(Rule::agent_head, Rule::agent_items, tokens),
            Rule::interaction => self.braced(Rule::interaction_head, Rule::interaction_items, tokens),
            Rule::system => self.braced(Rule::system_head, Rule::instances, tokens),
            Rule::run => self.braced(Rule::run_head, Rule::settings, tokens),
            Rule::region => self.braced(Rule::region_head, Rule::body_items, tokens),
            Rule::mode => self.braced(Rule::mode_head, Rule::body_items, tokens),
            Rule::flow => self.braced(Rule::flow_head, Rule::equations, tokens),
            Rule::actions => self.braced(Rule::open_brace, Rule::action_list, tokens),
            Rule::param => self.headed(Rule::param_head, tokens),
            Rule::definition => self.headed(Rule::definition_head, tokens),
            Rule::function => self.headed(Rule::function_head, tokens),
            Rule::equation => self.headed(Rule::equation_head, tokens),
            Rule::entry => self.keyword(Rule::kw_entry, Rule::actions, tokens),
            Rule::exit => self.keyword(Rule::kw_exit, Rule::actions, tokens),
            Rule::trigger => self.keyword(Rule::kw_when, Rule::expr, tokens),
            Rule::transition => self.transition(tokens),
            Rule::record => self.record(tokens),
            Rule::expr => self.chain(&LOGIC, tokens),
            Rule::comparison => self.comparison(tokens),
            Rule::arithmetic => self.chain(&ARITHMETIC, tokens),
            Rule::postfix => self.add(Rule::paren, tokens),
            Rule::paren => {
                let Range { start, end } = tokens;
                self.at_once(Rule::open_paren, start..start + 1);
                self.add(Rule::expr, start + 1..end - 1);
                self.at_once(Rule::close_paren, end - 1..end);
            }
            _ => self.at_once(rule, tokens),
        }
    }

    /// Whether the rule's parts are known here; those of others are left to the grammar, however long they are.
    fn can_cut(&self, rule: Rule, tokens: &Range<usize>) -> bool {
        match rule {
            Rule::agent | Rule::interaction | Rule::system | Rule::run | Rule::region | Rule::mode => true,
            Rule::flow | Rule::actions | Rule::entry | Rule::exit | Rule::transition | Rule::record => true,
            Rule::param | Rule::definition | Rule::function | Rule::equation => true,
            Rule::expr | Rule::comparison | Rule::arithmetic => true,
            Rule::trigger => self.source.word(tokens.start) == "when",
            Rule::postfix | Rule::paren => {
                let closed = |k| self.source.word(k) == ")" && k + 1 == tokens.end;
                self.source.word(tokens.start) == "("
                    && self.outermost(tokens.clone()).nth(1).is_some_and(closed)
            }
            _ => false,
        }
    }

    fn is_long(&self, tokens: &Range<usize>) -> bool {
        let all = self.source.tokens;
        !tokens.is_empty() && all[tokens.end - 1].end() - all[tokens.start].start() > self.bytes
    }

    fn at_once(&mut self, rule: Rule, tokens: Range<usize>) {
        if !tokens.is_empty() {
            self.slices.push(Slice { rule, tokens, reading: Reading::AtOnce });
        }
    }

    /// Adds what a rule covers: one slice, or, if it is long and the rule is no piece by itself, the slices of its parts.
    fn add(&mut self, rule: Rule, tokens: Range<usize>) {
        if !self.is_long(&tokens) || !self.can_cut(rule, &tokens) {
            self.at_once(rule, tokens);
        } else if matches!(rule, Rule::comparison | Rule::arithmetic | Rule::postfix) {
            self.cut(rule, tokens);
        } else {
            self.slices.push(Slice { rule, tokens, reading: Reading::InSlices });
        }
    }

    /// The tokens outside all brackets of a stretch, opening and closing ones included.
    fn outermost(&self, tokens: Range<usize>) -> impl Iterator<Item = usize> {
        let mut depth = 0_usize;
        tokens.filter(move |&k| {
            let mark = self.source.mark(k);
            if closes(mark) {
                depth = depth.saturating_sub(1);
            }
            let outermost = depth == 0;
            if opens(mark) {
                depth += 1;
            }
            outermost
        })
    }

    /// The outermost tokens of an expression before an `if` or a quantifier, whatever stands behind which belongs to it.
    fn own_tokens(&self, tokens: Range<usize>) -> impl Iterator<Item = usize> {
        let is_own = |&k: &usize| !extends_to_the_end(self.source.word(k), self.source.word(k + 1));
        self.outermost(tokens).take_while(is_own)
    }

    /// The first outermost token of a stretch that is one of these; its end, if there is none.
    fn first_of(&self, tokens: Range<usize>, words: &[&str]) -> usize {
        let end = tokens.end;
        self.outermost(tokens).find(|&k| words.iter().any(|word| self.source.is(k, word))).unwrap_or(end)
    }

    /// `head { list }`
    fn braced(&mut self, head: Rule, of: Rule, tokens: Range<usize>) {
        let Range { start, end } = tokens;
        let first = (self.first_of(start..end, &["{"]) + 1).min(end);
        self.at_once(head, start..first);
        if first < end {
            self.statements(of, first..end - 1);
            self.at_once(Rule::close_brace, end - 1..end);
        }
    }

    /// `head = expr`
    fn headed(&mut self, head: Rule, tokens: Range<usize>) {
        let Range { start, end } = tokens;
        let first = (self.first_of(start..end, &["="]) + 1).min(end);
        self.at_once(head, start..first);
        self.add(Rule::expr, first..end);
    }

    /// A keyword and one thing behind it.
    fn keyword(&mut self, word: Rule, rest: Rule, tokens: Range<usize>) {
        self.at_once(word, tokens.start..tokens.start + 1);
        self.add(rest, tokens.start + 1..tokens.end);
    }

    fn transition(&mut self, tokens: Range<usize>) {
        let Range { start, end } = tokens;
        let trigger = if self.source.word(start + 1) == ":" { start + 2 } else { start };
        let actions = self.first_of(trigger..end, &["{"]);
        let outcome = self.first_of(trigger..actions, &["priority", "->"]);
        self.at_once(Rule::label, start..trigger);
        self.add(Rule::trigger, trigger..outcome);
        self.at_once(Rule::outcome, outcome..actions);
        self.add(Rule::actions, actions..end);
    }

    fn record(&mut self, tokens: Range<usize>) {
        let Range { start, end } = tokens;
        let file_name = self.first_of(start + 1..end, &["every", "to"]);
        let columns = self.first_of(start + 1..file_name, &[","]);
        self.at_once(Rule::kw_record, start..start + 1);
        self.add(Rule::expr, start + 1..columns);
        let commas: Vec<usize> =
            self.outermost(columns..file_name).filter(|&k| self.source.mark(k) == b',').collect();
        self.groups(Rule::columns, commas, file_name, |_, _| false);
        self.at_once(Rule::file_name, file_name..end);
    }

    /// A list of statements: short ones many at a time, long ones by themselves.
    fn statements(&mut self, of: Rule, tokens: Range<usize>) {
        let beginnings: Vec<usize> = beginnings(self.source, of, tokens.clone()).collect();
        self.groups(of, beginnings, tokens.end, |cutter, statement| {
            match cutter.rule_of_statement(of, statement.start) {
                Some(rule) if cutter.can_cut(rule, &statement) => {
                    cutter.add(rule, statement);
                    true
                }
                _ => false,
            }
        });
    }

    /// The rule of the statement that begins with this token, if it is one that may be cut.
    fn rule_of_statement(&self, of: Rule, first: usize) -> Option<Rule> {
        Some(match self.source.word(first) {
            "param" => Rule::param,
            "let" => Rule::definition,
            "fn" => Rule::function,
            "agent" => Rule::agent,
            "interaction" => Rule::interaction,
            "system" => Rule::system,
            "run" => Rule::run,
            "region" => Rule::region,
            "flow" => Rule::flow,
            "initial" | "mode" => Rule::mode,
            "entry" => Rule::entry,
            "exit" => Rule::exit,
            "record" => Rule::record,
            _ if of == Rule::equations => Rule::equation,
            word if TRIGGERS.contains(&word) || self.source.word(first + 1) == ":" => Rule::transition,
            _ => return None,
        })
    }

    /// Elements that begin at these tokens, the last of which ends at `end`, in slices of one rule; a long one by itself,
    /// and by other slices, if `apart` has some for it.
    fn groups(
        &mut self,
        rule: Rule,
        beginnings: Vec<usize>,
        end: usize,
        apart: impl Fn(&mut Self, Range<usize>) -> bool,
    ) {
        let Some(&(mut group)) = beginnings.first() else { return };
        let ends = beginnings.iter().skip(1).copied().chain([end]);
        for (&start, next) in beginnings.iter().zip(ends) {
            if self.is_long(&(start..next)) {
                self.at_once(rule, group..start);
                if !apart(self, start..next) {
                    self.at_once(rule, start..next);
                }
                group = next;
            } else if self.is_long(&(group..next)) {
                self.at_once(rule, group..start);
                group = start;
            }
        }
        self.at_once(rule, group..end);
    }

    fn comparison(&mut self, tokens: Range<usize>) {
        let Range { start, end } = tokens;
        let is_sign = |k: usize| matches!(self.source.word(k), "<" | "<=" | ">" | ">=" | "==" | "!=" | "is");
        let sign = self.own_tokens(start..end).find(|&k| is_sign(k)).unwrap_or(end);
        self.add(Rule::arithmetic, start..sign);
        if sign < end && self.source.word(sign) == "is" {
            self.at_once(Rule::kw_is, sign..sign + 1);
            self.at_once(Rule::target, sign + 1..end);
        } else if sign < end {
            self.at_once(Rule::compare_op, sign..sign + 1);
            self.add(Rule::arithmetic, sign + 1..end);
        }
    }

    /// Operands that operators join: `operand (operator operand)*`, each with its prefixes.
    fn chain(&mut self, layer: &Layer, tokens: Range<usize>) {
        let Range { start, end } = tokens;
        let mut operators: Vec<usize> = Vec::new();
        let mut operand_before = false;
        for k in self.own_tokens(start..end) {
            let word = self.source.word(k);
            if operand_before && (layer.operator)(word).is_some() {
                operators.push(k);
                operand_before = false;
            } else {
                operand_before = word != layer.prefix && !opens(self.source.mark(k));
            }
        }
        let first = operators.first().copied().unwrap_or(end);
        if self.is_long(&(start..first)) {
            self.operand(layer, start..first);
        } else {
            self.at_once(layer.first, start..first);
        }
        self.groups(layer.more, operators, end, |cutter, Range { start, end }| {
            let Some(rule) = (layer.operator)(cutter.source.word(start)) else { return false };
            cutter.at_once(rule, start..start + 1);
            cutter.operand(layer, start + 1..end);
            true
        });
    }

    /// A long operand with its prefixes.
    fn operand(&mut self, layer: &Layer, tokens: Range<usize>) {
        let Range { mut start, end } = tokens;
        while start < end && self.source.word(start) == layer.prefix {
            self.at_once(layer.prefix_rule, start..start + 1);
            start += 1;
        }
        self.add(layer.operand, start..end);
    }
}

/// One of the flat lists that expressions are made of.
struct Layer {
    /// The first operand with its prefixes.
    first: Rule,
    /// Operators, each with the operand to its right.
    more: Rule,
    operand: Rule,
    prefix: &'static str,
    prefix_rule: Rule,
    operator: fn(&str) -> Option<Rule>,
}

const LOGIC: Layer = Layer {
    first: Rule::term,
    more: Rule::terms,
    operand: Rule::comparison,
    prefix: "not",
    prefix_rule: Rule::kw_not,
    operator: |word| match word {
        "and" => Some(Rule::kw_and),
        "or" => Some(Rule::kw_or),
        _ => None,
    },
};

const ARITHMETIC: Layer = Layer {
    first: Rule::operand,
    more: Rule::operands,
    operand: Rule::postfix,
    prefix: "-",
    prefix_rule: Rule::negate,
    operator: |word| match word {
        "+" | "-" | "*" | "/" | "^" => Some(Rule::operator),
        _ => None,
    },
};

/// Whether what begins with this word extends as far as the expression around it.
fn extends_to_the_end(word: &str, next: &str) -> bool {
    let begins_word = |token: &str| token.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_');
    match word {
        "if" | "exists" | "forall" | "count" | "sum" | "nearest" => true,
        "min" | "max" => begins_word(next),
        _ => false,
    }
}
