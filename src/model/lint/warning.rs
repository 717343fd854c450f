//! What is worth a warning, a variant per kind, each with its own code, and how each is told.

use crate::base::{Diagnostic, Span};

/// A question to whoever wrote the model.
pub(super) enum Warning {
    /// Nothing mentions a name.
    Unused { name: String, what: String, span: Span },
    /// A discrete variable that nothing reads; whether anything writes it.
    NeverRead { name: String, agent: String, span: Span, written: bool },
    /// An event that nobody emits, or nobody hears.
    IdleEvent { name: String, agent: String, span: Span, emitted: bool, heard: bool },
    /// An agent type of which `system` makes no agent.
    NoAgents { name: String, span: Span },
    /// A run of a model without agents; the name of an agent type.
    NobodyRuns { ty: Option<String>, span: Span },
    /// A transition that changes nothing and has no name.
    NoEffect { span: Span },
    /// A link that nothing sets.
    NeverSet { name: String, agent: String, span: Span },
    /// An agent that makes another one of its type as it begins.
    EndlessBirths { agent: String, span: Span },
    /// A mode in which no agent ever is.
    Unreached { path: String, agent: String, span: Span },
    /// A condition without which the transition cannot fire, and which is never true.
    NeverTrue { label: String, span: Span, transition: Span },
    /// A delay that never ends.
    Endless { label: String, span: Span },
    /// A transition with the same condition as one that comes before it and leaves the mode.
    Hidden { label: String, span: Span, by: String, first: Span },
    /// A name that is easily taken for a word of the language.
    Lookalike { name: String, word: &'static str, span: Span, same_letters: bool },
    /// A bare number in SI beside something in another unit.
    Beside { number: String, span: Span, unit: String, in_si: String, si: String, place: Span },
}

impl From<Warning> for Diagnostic {
    fn from(warning: Warning) -> Self {
        match warning {
            Warning::Unused { name, what, span } => {
                Diagnostic::warning("HY0601", format!("`{name}` is never used"))
                    .label(span, what)
                    .help(format!("leave it out, or call it `_{name}` if that is how it should be"))
            }
            Warning::NeverRead { name, agent, span, written } => {
                let label = if written {
                    format!("`{agent}` writes it, but nothing reads or records it")
                } else {
                    format!("nothing of `{agent}` reads, writes or records it")
                };
                Diagnostic::warning("HY0602", format!("the discrete variable `{name}` is never read"))
                    .label(span, label)
                    .help(format!("leave it out, `record` it, or call it `_{name}`"))
            }
            Warning::IdleEvent { name, agent, span, emitted, heard } => {
                let (title, help) = match (emitted, heard) {
                    (false, true) => ("nobody emits", format!("emit it: `emit {name}`")),
                    (true, _) => ("nobody hears", format!("hear it: `on {name}`")),
                    (false, false) => ("nobody emits or hears", "leave it out".to_string()),
                };
                Diagnostic::warning("HY0615", format!("{title} the event `{name}`"))
                    .label(span, format!("an event of `{agent}`"))
                    .help(format!("{help}, or call it `_{name}` if that is how it should be"))
            }
            Warning::NobodyRuns { ty, span } => {
                let ty = ty.unwrap_or_else(|| "Car".to_string());
                Diagnostic::warning("HY0624", "there are no agents to run")
                    .label(span, "this runs nothing")
                    .help(format!("make agents: `system {{ a = {ty}() }}`"))
            }
            Warning::NoEffect { span } => Diagnostic::warning("HY0625", "this transition changes nothing")
                .label(span, "no target, no actions, and no label to find it by in the event log")
                .help(
                    "add a target `-> B` or actions `{ ... }`; a label marks an instant: `seen: when x > 1`",
                ),
            Warning::NoAgents { name, span } => {
                Diagnostic::warning("HY0603", format!("there are no agents of type `{name}`"))
                    .label(span, "`system` makes none of these")
                    .help(format!("make one in `system`, or call the type `_{name}`"))
            }
            Warning::NeverSet { name, agent, span } => {
                Diagnostic::warning("HY0622", format!("the link `{name}` is never set, and so always none"))
                    .label(span, format!("no constructor of `{agent}` gives it, and it has no expression"))
                    .help(format!(
                        "give it one, `{agent}({name} = ...)`, or an expression: `link {name} = nearest ...`"
                    ))
            }
            Warning::EndlessBirths { agent, span } => {
                Diagnostic::warning("HY0623", format!("every `{agent}` makes another `{agent}` as it begins"))
                    .label(span, "without end, at one instant")
                    .help("make it in a transition, or say by `if` who makes one")
            }
            Warning::Unreached { path, agent, span } => {
                Diagnostic::warning("HY0604", format!("no `{agent}` is ever in mode `{path}`"))
                    .label(span, "neither entered by a transition nor started in")
                    .help(format!("add a transition `-> {path}`, or start an agent `in {path}`"))
            }
            Warning::NeverTrue { label, span, transition } => {
                let diagnostic = Diagnostic::warning("HY0605", format!("`{label}` can never fire"))
                    .label(span, "false with the parameters of this run");
                let diagnostic =
                    if transition == span { diagnostic } else { diagnostic.label(transition, "needs it") };
                diagnostic.help("leave the transition out, or correct the condition")
            }
            Warning::Endless { label, span } => {
                Diagnostic::warning("HY0605", format!("`{label}` can never fire"))
                    .label(span, "this delay is infinite")
                    .note("entering the mode would end the run (HY0510)")
                    .help("leave the transition out, or give it a finite delay")
            }
            Warning::Hidden { label, span, by, first } => {
                Diagnostic::warning("HY0606", format!("`{label}` never gets its turn: `{by}` comes first"))
                    .label(span, "never fires")
                    .label(first, "the same condition, and leaves the mode")
                    .help("correct one of the two conditions, or leave one transition out")
            }
            Warning::Beside { number, span, unit, in_si, si, place } => {
                Diagnostic::warning("HY0613", format!("this number is {in_si}, not in {unit}"))
                    .label(span, "a bare number beside a quantity is in SI")
                    .label(place, "declared here")
                    .help(format!("write `{number} [{unit}]`, or `{number} [{si}]` if that is what it is"))
            }
            Warning::Lookalike { name, word, span, same_letters } => {
                let label = if same_letters {
                    format!("only its case tells it from the word `{word}` of the language")
                } else {
                    format!("one slip away from the word `{word}` of the language")
                };
                Diagnostic::warning("HY0612", format!("`{name}` is easily taken for `{word}`"))
                    .label(span, label)
                    .help("give it a name that nobody misreads")
            }
        }
    }
}
