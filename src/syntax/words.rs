//! The grammar's rules in words for people.

use super::grammar::Rule;

/// What operators and suffixes are called together.
pub const OPERATOR: &str = "an operator";

/// Keywords with which a statement or an item begins.
pub const STATEMENTS: [&str; 38] = [
    "import",
    "param",
    "let",
    "fn",
    "agent",
    "interaction",
    "system",
    "property",
    "run",
    "state",
    "discrete",
    "link",
    "event",
    "region",
    "flow",
    "invariant",
    "assert",
    "initial",
    "mode",
    "entry",
    "exit",
    "when",
    "after",
    "every",
    "rate",
    "on",
    "create",
    "destroy",
    "emit",
    "stop",
    "if",
    "until",
    "record",
    "always",
    "eventually",
    "priority",
    "to",
    "from",
];

/// Rules that a name fits.
pub const NAMES: [Rule; 4] = [Rule::name, Rule::formal, Rule::variable, Rule::type_name];

/// The keywords with which a rule begins, if it does.
pub fn words_that_begin(rule: Rule) -> Vec<String> {
    let words: &[&str] = match rule {
        Rule::file => &["import", "param", "let", "fn", "agent", "interaction", "system", "property", "run"],
        Rule::import => &["import"],
        Rule::param => &["param"],
        Rule::definition => &["let"],
        Rule::function => &["fn"],
        Rule::agent => &["agent"],
        Rule::interaction => &["interaction"],
        Rule::system => &["system"],
        Rule::property => &["property"],
        Rule::run => &["run"],
        Rule::variables => &["state", "discrete"],
        Rule::link => &["link"],
        Rule::event => &["event"],
        Rule::region => &["region"],
        Rule::flow => &["flow"],
        Rule::invariant => &["invariant"],
        Rule::assertion => &["assert"],
        Rule::mode => &["initial", "mode"],
        Rule::entry => &["entry"],
        Rule::exit => &["exit"],
        Rule::trigger | Rule::transition => &["when", "after", "every", "rate", "on"],
        Rule::create => &["create"],
        Rule::destroy => &["destroy"],
        Rule::emit => &["emit"],
        Rule::stop => &["stop"],
        Rule::branches => &["if"],
        Rule::until => &["until"],
        Rule::stop_when => &["stop"],
        Rule::record => &["record"],
        _ => return keyword(rule).into_iter().collect(),
    };
    words.iter().map(|word| word.to_string()).collect()
}

/// All words of the language.
pub fn keywords() -> Vec<String> {
    Rule::all_rules().iter().filter_map(|&rule| keyword(rule)).collect()
}

/// The keyword of a keyword's rule.
fn keyword(rule: Rule) -> Option<String> {
    format!("{rule:?}").strip_prefix("kw_").map(String::from)
}

/// What fits a rule, in words; none for what is not worth saying.
pub fn in_words(rule: Rule) -> Vec<String> {
    let words = match rule {
        Rule::file => "an item such as `param`, `agent`, `system` or `run`",
        Rule::EOI => "the end of the file",
        Rule::name | Rule::value_name | Rule::formal | Rule::variable | Rule::equation | Rule::instance => {
            "a name"
        }
        Rule::set | Rule::output | Rule::place | Rule::named_arg | Rule::assignment | Rule::change_mode => {
            "a name"
        }
        Rule::target => "a mode",
        Rule::type_name => "a type",
        Rule::constructor => "an agent type",
        Rule::string => "a string",
        Rule::unit => "a unit",
        Rule::actions => "`{`",
        Rule::formals | Rule::binders | Rule::named_args => "`(`",
        Rule::count | Rule::window => "`[`",
        Rule::formula | Rule::expr => "an expression",
        Rule::literal | Rule::paren | Rule::list | Rule::conditional | Rule::quantifier | Rule::negate => {
            "an expression"
        }
        Rule::kw_not | Rule::kw_exists | Rule::kw_forall | Rule::kw_count | Rule::kw_sum => "an expression",
        Rule::kw_min | Rule::kw_max | Rule::kw_nearest => "an expression",
        Rule::field | Rule::call_args | Rule::subscript | Rule::dot => OPERATOR,
        Rule::operator | Rule::compare_op | Rule::kw_and | Rule::kw_or | Rule::kw_is => OPERATOR,
        Rule::open_paren => "`(`",
        Rule::close_paren => "`)`",
        Rule::open_bracket => "`[`",
        Rule::close_bracket => "`]`",
        Rule::open_brace => "`{`",
        Rule::close_brace => "`}`",
        Rule::comma => "`,`",
        Rule::prime => "`'`",
        Rule::colon => "`:`",
        Rule::assign => "`:=`",
        Rule::equals => "`=`",
        Rule::tilde => "`~`",
        Rule::arrow => "`->`",
        _ => return words_that_begin(rule).iter().map(|word| format!("`{word}`")).collect(),
    };
    vec![words.to_string()]
}
