//! Words of other languages, and what is written here instead.
//!
//! They are no reserved words: a model may use them as names. They are looked at only where a text is wrong.

/// Where a statement stands: what the braces around it belong to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// Nothing: the statement is an item of the file.
    File,
    /// An agent, an interaction, a mode or a region.
    Body,
    /// A flow.
    Flow,
    /// A list of actions.
    Actions,
    /// The system.
    System,
    /// The run.
    Run,
}

/// Words that begin statements elsewhere: the places they are looked for in, the words, and what to write there.
const STATEMENTS: [(&[Place], &[&str], &str); 24] = [
    (
        &[Place::File],
        &["model", "class", "struct", "type", "object", "breed", "process", "automaton", "component"],
        "an agent type is declared by `agent`: `agent Car { ... }`",
    ),
    (
        &[Place::File],
        &["def", "function", "func", "fun"],
        "a function is declared by `fn`: `fn f(x: real) = x^2`",
    ),
    (
        &[Place::File],
        &[
            "var",
            "const",
            "constant",
            "parameter",
            "define",
            "real",
            "float",
            "double",
            "int",
            "integer",
            "bool",
        ],
        "write `param k = 3` for what can be set from outside, `let k = 3` for all else",
    ),
    (&[Place::File], &["include", "using", "use", "require", "load"], "write `import \"cars.hy\"`"),
    (&[Place::File], &["simulate", "simulation", "main", "experiment"], "write `run { until 10 }`"),
    (
        &[Place::Body],
        &["var", "real", "float", "double", "int", "integer", "bool", "boolean", "number", "variable"],
        "write `state x` for what flows, `discrete x` for what only events change, `let x` for a formula",
    ),
    (&[Place::Body], &["const", "constant"], "write `let k = 3`, or `param k = 3` outside of the agent"),
    (
        &[Place::Body],
        &["parameter", "parameters", "input"],
        "parameters of an agent stand behind its name: `agent Car(k: real) { ... }`",
    ),
    (
        &[Place::Body],
        &["init", "initialize", "initialise", "setup", "start", "constructor"],
        "a first value stands where its variable is declared, `state x = 1`; a first mode is an `initial mode`",
    ),
    (
        &[Place::Body],
        &["equation", "equations", "ode", "dynamics", "derivative", "derivatives", "der", "update"],
        "rates stand in a flow: `flow { x' = ... }`",
    ),
    (
        &[Place::Body],
        &["noise", "random", "wiener"],
        "a flow has no noise: values are drawn by `~` (`state x ~ Normal(0, 1)`), times of events by `rate`",
    ),
    (
        &[Place::Body],
        &["if", "whenever", "upon", "transition"],
        "an event is written `when x > 1 { ... }`, or `when x > 1 -> B` to enter a mode",
    ),
    (&[Place::Body], &["location", "automaton", "submode", "phase"], "write `mode B { ... }`"),
    (
        &[Place::Body],
        &["function", "func", "fun", "def"],
        "functions stand outside of agents, at the top of the file",
    ),
    (
        &[Place::Body, Place::Actions],
        &["goto", "go", "jump", "switch", "become"],
        "write `when x > 1 -> B { ... }`: the mode to enter stands behind `->`",
    ),
    (&[Place::Flow], &["der", "ddt", "diff", "derivative", "dx", "d"], "write `x' = ...`"),
    (
        &[Place::Actions],
        &["var", "let", "real", "float", "double", "int", "bool", "const"],
        "actions have no variables of their own: write the formula where it is used, or a `let` in the agent",
    ),
    (&[Place::Actions], &["elif", "elseif", "elsif", "elsewhen"], "write `else if`"),
    (
        &[Place::Actions],
        &["print", "println", "printf", "log", "display"],
        "the event log has every event (`events to \"events.csv\"` in `run`), `record` what variables are",
    ),
    (&[Place::Actions], &["spawn", "hatch", "sprout", "new"], "write `create Car(v = 3)`"),
    (&[Place::Actions], &["kill", "die", "delete", "remove"], "write `destroy self`"),
    (&[Place::Actions], &["send", "raise", "trigger", "broadcast", "signal", "fire"], "write `emit e`"),
    (&[Place::Actions], &["terminate", "exit", "quit", "halt"], "write `stop`"),
    (
        &[Place::File, Place::Body, Place::Flow, Place::Actions, Place::System],
        &["for", "foreach", "while", "repeat", "loop", "ask"],
        "there are no loops: `Car[3]` makes three agents, and `exists`, `forall`, `count`, `sum` range over agents",
    ),
];

/// What to write for a word that begins no statement of this place.
pub fn statement(word: &str, place: Place) -> Option<&'static str> {
    let is_there =
        |(places, words, _): &&(&[Place], &[&str], &str)| places.contains(&place) && words.contains(&word);
    STATEMENTS.iter().find(is_there).map(|(_, _, help)| *help)
}

/// Words that stand between operands elsewhere, and what to write.
const OPERATORS: [(&str, &str); 8] = [
    ("AND", "write `and`"),
    ("And", "write `and`"),
    ("OR", "write `or`"),
    ("Or", "write `or`"),
    ("XOR", "write `(a or b) and not (a and b)`"),
    ("xor", "write `(a or b) and not (a and b)`"),
    ("mod", "a remainder is written `mod(a, b)`"),
    ("div", "write `floor(a/b)`"),
];

/// What to write for a word between two operands.
pub fn operator(word: &str) -> Option<&'static str> {
    OPERATORS.iter().find(|(known, _)| *known == word).map(|(_, help)| *help)
}

/// Functions that are called here with parentheses, and elsewhere sometimes without.
pub const FUNCTIONS: [&str; 28] = [
    "sin",
    "cos",
    "tan",
    "asin",
    "acos",
    "atan",
    "sinh",
    "cosh",
    "tanh",
    "asinh",
    "acosh",
    "atanh",
    "exp",
    "log",
    "log2",
    "log10",
    "ln",
    "sqrt",
    "cbrt",
    "abs",
    "sign",
    "floor",
    "ceil",
    "round",
    "trunc",
    "rising",
    "crossing",
    "Exponential",
];

/// Units that are more likely than names, with the words for them.
const UNITS: [(&str, &[&str]); 8] = [
    ("s", &["second", "seconds", "sec", "secs", "s"]),
    ("ms", &["millisecond", "milliseconds", "msec", "ms"]),
    ("min", &["minute", "minutes", "mins", "min"]),
    ("h", &["hour", "hours", "hr", "hrs", "h"]),
    ("m", &["meter", "meters", "metre", "metres"]),
    ("km", &["kilometer", "kilometers", "kilometre", "kilometres", "km"]),
    ("kg", &["kilogram", "kilograms", "kg"]),
    ("deg", &["degree", "degrees", "deg"]),
];

/// The sign of such a unit.
pub fn unit(word: &str) -> Option<&'static str> {
    UNITS.iter().find(|(_, words)| words.contains(&word)).map(|(sign, _)| *sign)
}
