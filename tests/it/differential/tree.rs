//! Modes in modes at random, as text, beside each other in regions or not.

use std::fmt::Write as _;

use super::dice::Dice;
use super::generate::{Shape, View, flow, transition, writes};

/// A mode with the modes inside it; the first of them is the initial one.
pub struct Node {
    name: String,
    is_region: bool,
    children: Vec<Node>,
}

/// The modes of an agent type: in two regions, or in none.
pub fn tree(dice: &mut Dice) -> Vec<Node> {
    if dice.percent(25) {
        let region = |name: &str, dice: &mut Dice| Node {
            name: name.to_string(),
            is_region: true,
            children: some(dice, "M", 0),
        };
        return vec![region("Left", dice), region("Right", dice)];
    }
    some(dice, "M", 0)
}

fn some(dice: &mut Dice, letter: &str, depth: usize) -> Vec<Node> {
    let node = |k: usize, dice: &mut Dice| Node {
        name: format!("{letter}{k}"),
        is_region: false,
        children: if depth < 2 && dice.percent(45) {
            some(dice, ["N", "P"][depth], depth + 1)
        } else {
            Vec::new()
        },
    };
    (0..2 + dice.below(2)).map(|k| node(k, dice)).collect()
}

/// The paths of all modes but regions, and `path.history` of those that have modes inside.
pub fn targets(nodes: &[Node], around: &str) -> (Vec<String>, Vec<String>) {
    let (mut modes, mut histories) = (Vec::new(), Vec::new());
    for node in nodes {
        let path = format!("{around}{}", node.name);
        let inside = targets(&node.children, &format!("{path}."));
        modes.extend((!node.is_region).then(|| path.clone()));
        histories.extend((!node.children.is_empty()).then(|| format!("{path}.history")));
        modes.extend(inside.0);
        histories.extend(inside.1);
    }
    (modes, histories)
}

/// What the text of modes needs to know.
pub struct Inside<'a> {
    /// All agent types.
    pub shapes: &'a [Shape],
    /// The one at hand.
    pub shape: &'a Shape,
    /// What transitions may lead to.
    pub targets: Vec<String>,
    /// Before names of modes.
    pub around: String,
    /// The states that still need a flow.
    pub states: Vec<&'static str>,
}

impl Inside<'_> {
    /// Writes modes with all that is in them.
    pub fn write(&self, dice: &mut Dice, nodes: &[Node], depth: usize, text: &mut String) {
        // Each state flows in one of the regions.
        let is_left: Vec<bool> = self.states.iter().map(|_| dice.percent(50)).collect();
        let indent = "  ".repeat(depth);
        for (k, node) in nodes.iter().enumerate() {
            let path = format!("{}{}", self.around, node.name);
            let own: Vec<&'static str> = match node.is_region {
                false => self.states.clone(),
                true => {
                    let states = self.states.iter().zip(&is_left);
                    states.filter(|(_, is_left)| **is_left == (k == 0)).map(|(state, _)| *state).collect()
                }
            };
            let is_within = |target: &&String| !node.is_region || target.starts_with(&format!("{path}."));
            let targets: Vec<String> = self.targets.iter().filter(is_within).cloned().collect();
            let kind = match (node.is_region, k) {
                (true, _) => "region",
                (false, 0) => "initial mode",
                (false, _) => "mode",
            };
            let _ = writeln!(text, "{indent}{kind} {} {{", node.name);
            let (here, deeper): (Vec<_>, Vec<_>) =
                own.into_iter().partition(|_| node.children.is_empty() || dice.percent(40));
            let more = format!("{indent}  ");
            flow(dice, self.shapes, self.shape, &here, &more, text);
            for list in ["entry", "exit"] {
                if dice.percent(20) && !(node.is_region && list == "exit") {
                    let views = [View { prefix: "", shape: self.shape }];
                    let _ = writeln!(text, "{more}{list} {{ {} }}", writes(dice, self.shape, "", &views, 1));
                }
            }
            for number in 0..1 + dice.below(2) {
                let label = format!("{}{number}", path.replace('.', "_").to_lowercase());
                transition(dice, self.shapes, self.shape, &label, Some(&targets), &more, text);
            }
            let inside = Inside {
                shapes: self.shapes,
                shape: self.shape,
                targets,
                around: format!("{path}."),
                states: deeper,
            };
            inside.write(dice, &node.children, depth + 1, text);
            let _ = writeln!(text, "{indent}}}");
        }
    }
}

/// An agent's transition that creates another agent, if there is one that it can, and one that destroys the agent itself.
pub fn lives(dice: &mut Dice, shapes: &[Shape], shape: &Shape, text: &mut String) {
    let can_make = |other: &&Shape| match other.mate {
        None => true,
        Some(mate) => shapes[mate].name == shape.name || shape.mate == Some(mate),
    };
    let makeable: Vec<&Shape> = shapes.iter().filter(can_make).collect();
    if !makeable.is_empty() && dice.percent(70) {
        let other = *dice.pick(&makeable);
        let room = format!("(count o in {}) <= {}", other.name, other.agents + dice.below(3));
        let views = [View { prefix: "", shape }];
        let trigger = match dice.below(4) {
            0 => format!("every {} [s] when {room}", dice.number(0.3, 1.5)),
            1 => format!("after {} [s] when {room}", dice.number(0.2, 1.5)),
            _ => format!("when {} and {room}", super::generate::comparison(dice, &views)),
        };
        let mut given: Vec<String> = Vec::new();
        for state in &other.states {
            let own = super::generate::real(dice, &views[0]);
            given.push(format!("{state} = 0.5*{own} + {}", dice.number(-1.0, 1.0)));
        }
        if other.tuned {
            given.push(format!("p = {}", dice.signed(0.3, 1.5)));
        }
        if let Some(mate) = other.mate {
            given.push(format!("mate = {}", if shapes[mate].name == shape.name { "self" } else { "mate" }));
        }
        let into = match other.modes.is_empty() || dice.percent(60) {
            true => String::new(),
            false => format!(" in {}", dice.pick(&other.modes)),
        };
        let also = if dice.percent(50) {
            format!("  {}", writes(dice, shape, "", &views, 1))
        } else {
            String::new()
        };
        let made = format!("create {}({}){into}", other.name, given.join(", "));
        let _ = writeln!(text, "  bear: {trigger} {{ {made}{also} }}");
    }
    if shape.mortal && dice.percent(70) {
        let views = [View { prefix: "", shape }];
        let trigger = match dice.below(3) {
            0 => format!("after {} [s]", dice.number(0.5, 3.0)),
            _ => format!("when {}", super::generate::comparison(dice, &views)),
        };
        let _ = writeln!(text, "  die: {trigger} {{ destroy self }}");
    }
}
