//! What is worth a warning, a variant per kind, each with its own code, and how each is told.

use crate::base::{Diagnostic, Span, number_text};
use crate::calculus::system::Relation;

/// A question to whoever wrote the model.
pub enum Warning {
    /// A transition whose condition is never true, because of this part.
    NeverTrue { label: String, part: Span, why: String, transition: Span },
    /// A comparison that is true at single points at most.
    OnlyTouches { text: String, span: Span, relation: Relation },
    /// A transition that comes after one that always leaves the mode before it.
    Hidden { label: String, span: Span, by: String, first: Span },
    /// A transition into its own mode that would fire again at once.
    Again { label: String, span: Span, mode: String, untouched: bool },
    /// Two transitions, each back to the mode of the other, whose conditions hold together.
    BothTrue { labels: [String; 2], spans: [Span; 2] },
    /// Two transitions on one boundary, from both sides of which the flow leads back to it.
    Chattering { labels: [String; 2], spans: [Span; 2] },
    /// A quantifier that counts the asking agent in, for which its body is settled.
    Oneself { name: String, ty: String, span: Span, holds: bool },
    /// A condition over two agents that says nothing about how near they are, and many pairs of them; its label or the bound name.
    AllPairs { name: String, span: Span, n_pairs: usize },
    /// HY0614: who is nearest is found among all.
    AllAsked { name: String, span: Span, n_pairs: usize },
    /// An invariant of a mode that is false as soon as it is entered by `way`: a transition, or a line of `system`.
    Broken { mode: String, claim: Span, way: Span },
    /// A transition that takes a part of the speed away from what bounces on its boundary; over at a time, s, which is infinite if it
    /// is not known, as in the next two.
    Rebound { label: String, span: Span, at: f64 },
    /// A transition that makes its own delay shorter each time.
    Hurries { label: String, span: Span, at: f64 },
    /// Two transitions between modes that lower what the other one raises, and together lose more than they gain.
    RunsDry { labels: [String; 2], spans: [Span; 2], at: f64 },
}

impl From<Warning> for Diagnostic {
    fn from(warning: Warning) -> Self {
        match warning {
            Warning::NeverTrue { label, part, why, transition } => {
                let diagnostic =
                    Diagnostic::warning("HY0605", format!("`{label}` can never fire")).label(part, why);
                let diagnostic =
                    if part == transition { diagnostic } else { diagnostic.label(transition, "needs it") };
                diagnostic.help("leave the transition out, or correct the condition")
            }
            Warning::OnlyTouches { text, span, relation } => only_touches(text, span, relation),
            Warning::Hidden { label, span, by, first } => {
                Diagnostic::warning("HY0606", format!("`{label}` never gets its turn: `{by}` comes first"))
                    .label(span, "never fires")
                    .label(first, "always true, and leaves the mode")
                    .help("put it before the other one, give it a higher `priority`, or correct the condition of the other")
            }
            Warning::Again { label, span, mode, untouched } => {
                let why = if untouched {
                    "leads back into its mode and changes nothing that its condition reads"
                } else {
                    "leads back into its mode, where its condition is still true"
                };
                Diagnostic::warning("HY0607", format!("`{label}` fires again at once, without end"))
                    .label(span, why)
                    .note(format!("entering `{mode}` arms its transitions afresh; the run would stop with HY0505"))
                    .help("leave the target out (without `->` it fires once, until the condition has been false), or make the condition false")
            }
            Warning::BothTrue { labels: [first, second], spans } => Diagnostic::warning(
                "HY0609",
                format!("`{first}` and `{second}` lead back and forth at one instant"),
            )
            .label(spans[0], "where this becomes true ...")
            .label(spans[1], "... this is true as well, and leads back")
            .note("the run would stop with HY0505")
            .help("leave a gap between the two conditions, so that one is false where the other becomes true"),
            Warning::Chattering { labels: [first, second], spans } => {
                Diagnostic::warning("HY0610", format!("`{first}` and `{second}` chatter"))
                    .label(spans[0], "beyond this boundary the flow leads back to it ...")
                    .label(spans[1], "... and beyond this one, which is the same")
                    .note("the mode would change without end on the boundary, and the run stop with HY0505")
                    .help("leave a gap between the two conditions (hysteresis), or add a mode that stays on the boundary")
            }
            Warning::Oneself { name, ty, span, holds } => {
                let why = if holds { "true" } else { "false" };
                Diagnostic::warning("HY0611", format!("`{name}` ranges over the agent itself, too"))
                    .label(span, format!("always {why} if `{name}` is `self`"))
                    .help(format!("write `{name} in other {ty}`"))
            }
            Warning::AllPairs { name, span, n_pairs } => {
                Diagnostic::warning("HY0614", format!("`{name}` is looked at for all {n_pairs} pairs of agents"))
                    .label(span, "may be true for two that are far apart")
                    .note("near pairs alone are looked at where a condition bounds a difference of states")
                    .help("say how near they have to be: `... and abs(a.x - b.x) <= 10`")
            }
            Warning::AllAsked { name, span, n_pairs } => {
                Diagnostic::warning("HY0614", format!("`{name}` is looked at for all {n_pairs} pairs of agents"))
                    .label(span, "the nearest is looked for among all: its key bounds no difference between the two")
                    .note("by a key that grows with a difference, as a distance does, nobody is looked at who is farther than the nearest")
                    .help("ask for somebody in a range, if that will do: `exists o in other Car: abs(o.x - x) <= 10`")
            }
            Warning::Broken { mode, claim, way } => {
                Diagnostic::warning("HY0626", format!("`{mode}` breaks its invariant as soon as it is entered"))
                    .label(claim, "on its boundary or beyond then, and the flow leads further out")
                    .label(way, "on this way in")
                    .note("the run would stop with HY0501")
                    .help("correct the invariant or the flow, or leave by a transition whose condition is true there")
            }
            Warning::Rebound { label, span, at } => zeno(&format!("`{label}` fires"), at)
                .label(span, "each time a part of the speed is lost, and at rest the flow pushes on")
                .help("let it come to rest: a transition into a mode without this motion, taken where it is slow (`and v > -0.01 -> Rest`)"),
            Warning::Hurries { label, span, at } => zeno(&format!("`{label}` fires"), at)
                .label(span, "each time the delay is shorter by a factor")
                .help("keep the delay above a least one: `max(0.5*d, 0.01)`"),
            Warning::RunsDry { labels: [first, second], spans, at } => {
                zeno(&format!("`{first}` and `{second}` take turns"), at)
                    .label(spans[0], "its mode lowers what is compared here, and raises that of the other ...")
                    .label(spans[1], "... this one the other way round; together they lose more than they gain")
                    .help("add a transition for the time when both have run dry, or stay in a mode for a least time: `after 0.1 when ...`")
            }
        }
    }
}

fn zeno(what: &str, at: f64) -> Diagnostic {
    let (title, end) = if at.is_finite() {
        let four_digits: f64 = format!("{at:.3e}").parse().expect("it is a number");
        let at = format!("t = {}", number_text(four_digits));
        (
            format!("{what} infinitely often until about {at} (Zeno)"),
            format!("the run would stop in error (HY0505 or HY0506) at about {at}"),
        )
    } else {
        let title = format!("{what} ever faster, infinitely often within a finite time (Zeno)");
        (title, "a run that goes on for so long stops in error (HY0505 or HY0506)".to_string())
    };
    Diagnostic::warning("HY0627", title).note(end)
}

fn only_touches(text: String, span: Span, relation: Relation) -> Diagnostic {
    let (title, label) = match relation {
        Relation::Crossing => (format!("`{text}` never happens"), "what stands here never changes its sign"),
        Relation::NonPositive | Relation::Negative => {
            (format!("`{text}` is true at single points only"), "never beyond the boundary, at most on it")
        }
    };
    Diagnostic::warning("HY0608", title)
        .label(span, label)
        .note("at such a point rounding decides whether it is true")
        .help("ask for a crossing, `crossing(x - 1)`, or for a region, `abs(x - 1) <= 0.01`")
}
