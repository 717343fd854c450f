//! The modes of each agent type as a diagram: boxes inside boxes, and arrows for the transitions between them.
//!
//! Texts of conditions and equations are those of the source. A transition that leads nowhere is a line in its mode's box.

use super::ir::{Action, AgentType, Destination, Inside, Mode, ModeId, Model, Transition, TypeId};
use crate::base::SourceMap;

/// The modes of one agent type.
#[derive(Clone, Debug, PartialEq)]
pub struct Diagram {
    /// The agent type's name.
    pub name: String,
    /// Its modes; number 0 is the agent itself, the box around all others.
    pub boxes: Vec<ModeBox>,
    /// What leads from one mode to another, in order of declaration.
    pub arrows: Vec<Arrow>,
}

/// A mode as a box.
#[derive(Clone, Debug, PartialEq)]
pub struct ModeBox {
    /// Its name.
    pub name: String,
    /// `Drive.Cruise`, as outputs call it; empty for the agent itself.
    pub path: String,
    /// The box that it lies in.
    pub parent: Option<usize>,
    /// The boxes directly inside, in order of declaration.
    pub children: Vec<usize>,
    /// Whether its parent is entered by it.
    pub initial: bool,
    /// Its equations, invariants and transitions without a target, a line each.
    pub lines: Vec<String>,
}

/// A transition that changes the mode.
#[derive(Clone, Debug, PartialEq)]
pub struct Arrow {
    /// The box that it leaves; one with boxes inside is left from whichever is active.
    pub from: usize,
    /// The box that it leads to.
    pub to: usize,
    /// Its name, if it has one.
    pub label: Option<String>,
    /// When it fires, as the source says it; `(history)` behind it if it leads to the submode that was active last.
    pub trigger: String,
    /// What it does besides, as the source says it; empty if nothing.
    pub actions: String,
}

/// A diagram for each agent type, in order of declaration.
pub fn diagrams(model: &Model, sources: &SourceMap) -> Vec<Diagram> {
    let of_type = |(ty, agent): (TypeId, &AgentType)| {
        let mut diagram = diagram(agent, sources);
        diagram.arrows.extend(arrows_of_interactions(model, ty, sources));
        diagram
    };
    model.visible_types().map(|ty| of_type((ty, &model.types[ty]))).collect()
}

fn diagram(agent: &AgentType, sources: &SourceMap) -> Diagram {
    let mut boxes: Vec<ModeBox> = agent.modes.iter().map(|mode| mode_box(agent, mode, sources)).collect();
    let mut arrows = Vec::new();
    for transition in &agent.transitions {
        let text = Written::read(sources.text(transition.span));
        match transition.target {
            Some(target) => arrows.push(text.arrow(transition.source, target)),
            None => boxes[transition.source.index()].lines.push(text.line()),
        }
    }
    Diagram { name: agent.name.clone(), boxes, arrows }
}

fn mode_box(agent: &AgentType, mode: &Mode, sources: &SourceMap) -> ModeBox {
    let flow = mode.flow.iter().map(|(_, _, span)| one_line(sources.text(*span)));
    let claims = mode.invariants.iter();
    let claims = claims.map(|claim| format!("invariant {}", claimed(sources.text(claim.span))));
    ModeBox {
        name: mode.name.clone(),
        path: mode.path.clone(),
        parent: mode.parent.map(ModeId::index),
        children: mode.children.iter().map(|child| child.index()).collect(),
        initial: mode.parent.is_some_and(|parent| {
            agent.modes[parent].initial.is_some_and(|initial| agent.modes[initial].path == mode.path)
        }),
        lines: flow.chain(claims).collect(),
    }
}

/// The claim without its keyword and its message.
fn claimed(text: &str) -> String {
    let text = one_line(text);
    let text = text.strip_prefix("invariant").unwrap_or(&text).trim();
    text.split('"').next().unwrap_or(text).trim().to_string()
}

/// Interactions change modes of their participants, whichever mode they are in.
fn arrows_of_interactions(model: &Model, ty: TypeId, sources: &SourceMap) -> Vec<Arrow> {
    let mut arrows: Vec<Arrow> = Vec::new();
    for interaction in &model.interactions {
        for transition in &interaction.transitions {
            let mut gotos = Vec::new();
            find_gotos(&transition.actions, &mut gotos);
            for (participant, target) in gotos {
                let arrow = of_interaction(transition, target, sources);
                if interaction.types[participant] == ty && !arrows.contains(&arrow) {
                    arrows.push(arrow);
                }
            }
        }
    }
    arrows
}

fn of_interaction(transition: &Transition, target: Destination, sources: &SourceMap) -> Arrow {
    let text = Written::read(sources.text(transition.span));
    Arrow {
        label: Some(transition.label.clone()),
        actions: String::new(),
        ..text.arrow(ModeId::new(0), target)
    }
}

fn find_gotos(actions: &[Action], found: &mut Vec<(usize, Destination)>) {
    for action in actions {
        match action {
            Action::Goto { participant, target, .. } => found.push((*participant, *target)),
            Action::If { then, otherwise, .. } => {
                find_gotos(then, found);
                find_gotos(otherwise, found);
            }
            Action::Assign { .. } | Action::Draw { .. } | Action::Emit { .. } | Action::Stop { .. } => {}
            Action::Create(_) | Action::Destroy { .. } => {}
        }
    }
}

/// A transition's text in its parts.
struct Written {
    label: Option<String>,
    trigger: String,
    actions: String,
}

impl Written {
    /// `label: trigger -> target { actions }`
    fn read(text: &str) -> Self {
        let text = one_line(text);
        let (head, actions) = match text.split_once('{') {
            Some((head, rest)) => (head, rest.trim_end().strip_suffix('}').unwrap_or(rest).trim()),
            None => (text.as_str(), ""),
        };
        let head = head.split("->").next().unwrap_or(head).trim();
        let (label, trigger) = match head.split_once(':') {
            Some((label, rest)) if label.chars().all(|c| c.is_alphanumeric() || c == '_') => {
                (Some(label.to_string()), rest.trim())
            }
            Some(_) | None => (None, head),
        };
        Self { label, trigger: trigger.to_string(), actions: actions.to_string() }
    }

    fn arrow(self, from: ModeId, to: Destination) -> Arrow {
        let Self { label, mut trigger, actions } = self;
        if to.inside == Inside::History {
            trigger.push_str(" (history)");
        }
        Arrow { from: from.index(), to: to.mode.index(), label, trigger, actions }
    }

    fn line(self) -> String {
        let label = self.label.map(|label| format!("{label}: ")).unwrap_or_default();
        let actions =
            if self.actions.is_empty() { String::new() } else { format!(" {{ {} }}", self.actions) };
        format!("{label}{}{actions}", self.trigger)
    }
}

/// The text without comments and line ends.
fn one_line(text: &str) -> String {
    let lines = text.lines().map(|line| line.split("//").next().unwrap_or(line));
    lines.flat_map(str::split_whitespace).collect::<Vec<_>>().join(" ")
}
