//! Failures of modes, flows, transitions and actions.

use crate::base::{Diagnostic, Span};

/// What is wrong with a mode, a flow or a trigger.
pub(in crate::model) enum ModeError {
    /// A state without an equation in some modes.
    NoFlow { state: String, declared: Span, modes: Vec<(String, Span)>, implicit: bool },
    /// Two equations for one state.
    TwoFlows { state: String, span: Span, first: Span },
    /// An equation for something that is not a state.
    NotAState { name: String, what: &'static str, span: Span, help: &'static str },
    /// Modes, none of which is the initial one.
    NoInitial { owner: String, span: Span, example: String },
    /// Two initial modes.
    TwoInitial { owner: String, span: Span, first: Span },
    /// A mode beside regions.
    BesideRegion { name: String, span: Span, first: Span },
    /// A transition from one region into another.
    AcrossRegions { from: String, to: String, span: Span },
    /// The history of a mode without submodes.
    NoHistory { path: String, declared: Span, span: Span },
    /// A flow reads an agent that may not be there.
    NoneInFlow { state: String, path: String, read: Span, flow: Span },
    /// `rising` or `crossing` outside of a guard.
    EdgeOutsideGuard { name: String, span: Span },
    /// The rate of a transition reads an agent that may not be there.
    NoneInRate { label: String, path: String, read: Span },
    /// A hazard that is none.
    BadRate { span: Span, value: f64 },
    /// A period that is not positive, or a negative delay.
    BadPeriod { what: &'static str, needs: &'static str, span: Span, value: f64 },
}

impl From<ModeError> for Diagnostic {
    fn from(error: ModeError) -> Self {
        match error {
            ModeError::NoFlow { state, declared, modes, implicit } => {
                let title = match modes.as_slice() {
                    _ if implicit => format!("state `{state}` has no flow"),
                    [(mode, _)] => format!("state `{state}` has no flow in mode `{mode}`"),
                    _ => format!("state `{state}` has no flow in {} modes", modes.len()),
                };
                let diagnostic = Diagnostic::error("HY0240", title).label(declared, "declared here");
                let diagnostic = if implicit {
                    diagnostic
                } else {
                    modes.into_iter().take(4).fold(diagnostic, |diagnostic, (mode, span)| {
                        diagnostic.label(span, format!("no `{state}' = ...` in `{mode}` or around it"))
                    })
                };
                diagnostic.help(format!(
                    "write `flow {{ {state}' = 0 }}` if it stands still, or declare it `discrete` if it only jumps"
                ))
            }
            ModeError::TwoFlows { state, span, first } => Diagnostic::error(
                "HY0241",
                format!("state `{state}` has two flows at once"),
            )
            .label(span, "the second one")
            .label(first, "the first one")
            .help("an inner mode adds flows, it does not override: move the outer one into the other modes"),
            ModeError::NotAState { name, what, span, help } => {
                Diagnostic::error("HY0242", format!("only states flow, and `{name}` is {what}"))
                    .label(span, what)
                    .help(help)
            }
            ModeError::NoInitial { owner, span, example } => {
                Diagnostic::error("HY0243", format!("{owner} has modes, but none is initial"))
                    .label(span, "in which of its modes does it start?")
                    .help(format!("write `initial mode {example}`"))
            }
            ModeError::TwoInitial { owner, span, first } => {
                Diagnostic::error("HY0244", format!("{owner} has two initial modes"))
                    .label(span, "the second one")
                    .label(first, "the first one")
                    .help("leave out one `initial`")
            }
            ModeError::BesideRegion { name, span, first } => Diagnostic::error(
                "HY0249",
                format!("mode `{name}` stands beside a region"),
            )
            .label(span, "in no region")
            .label(first, "a region: its modes are active beside those of other regions")
            .help("put it and the modes beside it into a region of their own"),
            ModeError::AcrossRegions { from, to, span } => Diagnostic::error(
                "HY0255",
                format!("a transition of region `{from}` leads into region `{to}`"),
            )
            .label(span, format!("in region `{to}`"))
            .help("a region changes its own mode only: let the other one wait for it (`when self is ...`), or write the transition outside of the regions, which leaves them all"),
            ModeError::NoHistory { path, declared, span } => {
                Diagnostic::error("HY0248", format!("`{path}` has no modes inside, and so no history"))
                    .label(span, "which submode was active last?")
                    .label(declared, "declared here")
                    .help(format!("write `-> {path}`"))
            }
            ModeError::NoneInFlow { state, path, read, flow } => {
                let diagnostic = Diagnostic::error(
                    "HY0245",
                    format!("the flow of `{state}` may read `{path}` while it is none"),
                )
                .label(read, format!("`{path}` may be none here"));
                let diagnostic =
                    if flow == read { diagnostic } else { diagnostic.label(flow, "in this flow") };
                diagnostic.help(format!("say what holds without it: `if {path} then ... else ...`"))
            }
            ModeError::NoneInRate { label, path, read } => Diagnostic::error(
                "HY0245",
                format!("the rate of `{label}` may read `{path}` while it is none"),
            )
            .label(read, format!("`{path}` may be none here"))
            .help(format!("say when it counts: `rate ... when {path}`, or `if {path} then ... else 0`")),
            ModeError::BadRate { span, value } => {
                Diagnostic::error("HY0219", "a rate must be finite, and 0 1/s or more")
                    .label(span, format!("this is {value} 1/s"))
            }
            ModeError::EdgeOutsideGuard { name, span } => {
                Diagnostic::error("HY0246", format!("`{name}` has a meaning only in a guard"))
                    .label(span, "not a guard, or inside something else than `and`, `or`, `not`")
                    .help("write it behind `when`, but not of an `on` or a `rate`, joined to other conditions by `and`, `or` and `not` only")
            }
            ModeError::BadPeriod { what, needs, span, value } => {
                Diagnostic::error("HY0247", format!("{what} must be {needs}"))
                    .label(span, format!("this is {value} s"))
            }
        }
    }
}

/// What is wrong with an action.
pub(in crate::model) enum ActionError {
    /// An agent writes another one.
    WritesOther { place: String, span: Span },
    /// Something that no action changes.
    NotAssignable { name: String, what: &'static str, span: Span, help: &'static str },
    /// One variable twice in one list.
    WrittenTwice { name: String, span: Span, first: Span },
    /// `a -> Mode` in an agent, or `-> Mode` behind a guard of an interaction.
    ModeChange { span: Span, why: &'static str, help: String },
    /// In an interaction, a variable without its owner.
    WhoseVariable { name: String, span: Span, participants: Option<[String; 2]> },
    /// `else if` without end.
    TooManyBranches { span: Span, most: usize },
    /// `create` of an array, or of the rows of a file.
    CreatesMany { span: Span, what: &'static str },
    /// `destroy` of something else.
    DestroysNoAgent { span: Span, found: String },
}

impl From<ActionError> for Diagnostic {
    fn from(error: ActionError) -> Self {
        match error {
            ActionError::WritesOther { place, span } => {
                Diagnostic::error("HY0250", format!("an agent writes only itself, not `{place}`"))
                    .label(span, "belongs to another agent")
                    .help("only an `interaction` may write the agents that take part in it")
            }
            ActionError::NotAssignable { name, what, span, help } => {
                Diagnostic::error("HY0251", format!("`{name}` is {what} and cannot be assigned"))
                    .label(span, what)
                    .help(help)
            }
            ActionError::WrittenTwice { name, span, first } => Diagnostic::error(
                "HY0252",
                format!("`{name}` is written twice in one list of actions"),
            )
            .label(span, "the second time")
            .label(first, "the first time")
            .help(
                "all actions of a list happen at once; write one of the two only, or choose by `if ... else`",
            ),
            ActionError::ModeChange { span, why, help } => {
                Diagnostic::error("HY0253", why).label(span, "not here").help(help)
            }
            ActionError::WhoseVariable { name, span, participants } => {
                let help = match participants {
                    Some([a, b]) => format!("write `{a}.{name}` or `{b}.{name}`"),
                    None => format!("write whose `{name}` it is, before a dot"),
                };
                Diagnostic::error("HY0254", format!("whose `{name}`? An interaction has two participants"))
                    .label(span, "of neither")
                    .help(help)
            }
            ActionError::TooManyBranches { span, most } => {
                Diagnostic::error("HY0295", format!("an `if` has at most {most} branches"))
                    .label(span, "more than that")
                    .help("split it into several")
            }
            ActionError::CreatesMany { span, what } => {
                Diagnostic::error("HY0256", "an action creates one agent at a time")
                    .label(span, format!("{what} here"))
                    .help("write one `create` for each, or let a transition fire as often as it is needed")
            }
            ActionError::DestroysNoAgent { span, found } => {
                Diagnostic::error("HY0257", "only an agent can be destroyed")
                    .label(span, format!("this is {found}"))
                    .help("write `destroy self`, or the name of a link or of an agent that is bound here")
            }
        }
    }
}
