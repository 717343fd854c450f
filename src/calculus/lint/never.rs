//! Transitions whose condition no state makes true (HY0605), and comparisons that only touch their boundary (HY0608).
//!
//! What the constants of the file alone decide is the model's to tell, and an infinite constant is a switch thrown on
//! purpose. A comparison only touches if what it compares with zero never gets below (a square, a distance), and is
//! not constant anywhere: `max(x, 0) <= 0` holds in a whole region.

use crate::base::Span;
use crate::calculus::bounds::{Bounds, REAL};
use crate::calculus::graph::{Graph, Node, NodeId};
use crate::calculus::lint::Warning;
use crate::calculus::lint::effects::{guard, nodes};
use crate::calculus::lint::truth::{Truth, truth};
use crate::calculus::reader::Reader;
use crate::calculus::system::{
    AgentSystem, Atom, Condition, Guard, Layout, ModeSystem, Relation, Slot, System, TransitionSystem,
};
use crate::math::Op;

/// Looks at every guard.
pub fn transitions(system: &System, bounds: &Bounds, found: &mut Vec<Warning>) {
    for ty in &system.types {
        for transition in &ty.transitions {
            look_at(system, bounds, transition, &ty.modes, found);
        }
    }
    for pair in system.interactions.iter().flat_map(|interaction| &interaction.transitions) {
        look_at(system, bounds, &pair.transition, &[], found);
    }
}

fn look_at(
    system: &System,
    bounds: &Bounds,
    transition: &TransitionSystem,
    modes: &[ModeSystem],
    found: &mut Vec<Warning>,
) {
    let Some(guard) = guard(transition) else { return };
    let is_switched = nodes(system, guard).into_iter().any(|node| has_infinity(&system.graph, node));
    if matches!(guard.condition, Condition::Constant(_)) || is_switched {
        return;
    }
    let mut reader = Reader::new(system, bounds, &transition.frame);
    if transition.source != 0 {
        reader.stay_in(modes, transition.source);
    }
    if let Some((part, why)) = impossible(&mut reader, guard, &guard.condition, transition) {
        let (label, transition) = (transition.label.clone(), transition.span);
        return found.push(Warning::NeverTrue { label, part, why, transition });
    }
    // What only the beginning of time bounds is a condition like any other.
    let mut reader = Reader::new(system, bounds, &transition.frame);
    reader.bound(Node::Time, REAL);
    for atom in guard.atoms.iter().filter(|atom| touches(&mut reader, atom)) {
        let (text, span, relation) = (atom.text.clone(), atom.span, atom.relation);
        found.push(Warning::OnlyTouches { text, span, relation });
    }
}

fn has_infinity(graph: &Graph, root: NodeId) -> bool {
    graph.reach(&[root]).into_iter().any(|id| graph.constant(id).is_some_and(|value| !value.is_finite()))
}

/// The part of a condition that is never true, and so keeps all of it from being true; with what to say there.
fn impossible(
    reader: &mut Reader,
    guard: &Guard,
    condition: &Condition,
    transition: &TransitionSystem,
) -> Option<(Span, String)> {
    if let Condition::And(terms) = condition {
        return terms.iter().find_map(|term| impossible(reader, guard, term, transition));
    }
    if truth(reader, guard, condition) != Truth::Never {
        return None;
    }
    Some(match condition {
        Condition::Atom(k) => (guard.atoms[*k].span, "false for all values of the states".to_string()),
        Condition::Discrete(function) => {
            let names = discretes(reader, reader.system.functions[*function].outputs[0]);
            let why = match names.as_slice() {
                [] => "its condition is false in this mode".to_string(),
                names => {
                    format!("its condition is false for every value that {} is ever given", names.join(", "))
                }
            };
            (transition.span, why)
        }
        Condition::Constant(_) | Condition::And(_) | Condition::Or(_) => {
            (transition.span, "its condition is false for all values of the states".to_string())
        }
        Condition::Exists(_) | Condition::Forall(_) | Condition::Rising(..) => {
            (transition.span, "its condition never becomes true".to_string())
        }
    })
}

/// The discrete variables that a test reads, as a message names them.
fn discretes(reader: &Reader, root: NodeId) -> Vec<String> {
    let (system, mut names) = (reader.system, Vec::new());
    for id in system.graph.reach(&[root]) {
        let Node::Aux { slot, column } = system.graph.node(id) else { continue };
        let Some(slot) = reader.frame.slots.get(slot as usize) else { continue };
        if let Some(name) = discrete_name(&system.types[slot.ty()], slot, column as usize)
            && !names.contains(&name)
        {
            names.push(name);
        }
    }
    names
}

fn discrete_name(ty: &AgentSystem, slot: &Slot, column: usize) -> Option<String> {
    let first = Layout::discrete(&ty.layout, 0);
    let name = &ty.discretes.get(column.checked_sub(first)?)?.name;
    let owner = slot.name();
    Some(if owner == "self" { format!("`{name}`") } else { format!("`{owner}.{name}`") })
}

/// Whether a comparison is true at single points at most.
fn touches(reader: &mut Reader, atom: &Atom) -> bool {
    let node = reader.system.functions[atom.value].outputs[0];
    let form = reader.node(node);
    let value = reader.forms.interval(form);
    let one_sided = match atom.relation {
        Relation::NonPositive => value.lo == 0.0,
        Relation::Negative => false,
        Relation::Crossing => value.lo >= 0.0 || value.hi <= 0.0,
    };
    one_sided && !value.is_point() && !is_level(&reader.system.graph, node)
}

/// Whether a value may be constant in a region of states: an operator below it cuts off, rounds or chooses.
fn is_level(graph: &Graph, root: NodeId) -> bool {
    let moving = |id: NodeId| graph.moves(id);
    graph.reach(&[root]).into_iter().any(|id| match graph.node(id) {
        Node::Select(..) => moving(id),
        Node::Unary(op, _) | Node::Binary(op, ..) => match op {
            Op::Sign | Op::Min | Op::Max | Op::Floor | Op::Ceil | Op::Round | Op::Trunc => moving(id),
            Op::Lt | Op::Le | Op::Eq | Op::Ne | Op::Not | Op::And | Op::Or | Op::Select => moving(id),
            Op::Neg | Op::Add | Op::Sub | Op::Mul | Op::Div | Op::Powi | Op::Pow | Op::Sin | Op::Cos => false,
            Op::Tan | Op::Asin | Op::Acos | Op::Atan | Op::Atan2 | Op::Sinh | Op::Cosh | Op::Tanh => false,
            Op::Asinh | Op::Acosh | Op::Atanh | Op::Exp | Op::Log | Op::Log2 | Op::Log10 => false,
            Op::Sqrt | Op::Cbrt | Op::Abs | Op::Mod | Op::Hypot => false,
        },
        Node::Constant(_) | Node::Time | Node::State { .. } | Node::Rate { .. } => false,
        Node::Acceleration { .. } | Node::Aux { .. } => false,
    })
}
