//! Reads nodes of one frame as forms: what leaves mean is given by bounds, or stated beforehand.

use rustc_hash::FxHashMap;

use crate::calculus::bounds::Bounds;
use crate::calculus::form::{FormId, Forms};
use crate::calculus::graph::{Node, NodeId};
use crate::calculus::system::{Frame, FunctionId, Layout, ModeSystem, Slot, System};
use crate::math::Interval;

/// The forms of one question, and what the leaves are in it.
pub struct Reader<'s> {
    /// The system.
    pub system: &'s System,
    /// The agents.
    pub frame: &'s Frame,
    /// What leaves can hold.
    bounds: &'s Bounds,
    /// The forms so far.
    pub forms: Forms,
    /// What leaves stand for; the others stand for themselves.
    given: FxHashMap<Node, FormId>,
    /// A slot that is read as another one.
    renamed: Option<(usize, usize)>,
    memo: FxHashMap<NodeId, FormId>,
    /// How many aggregates have been met; each is a leaf of its own.
    n_aggregates: u32,
}

impl<'s> Reader<'s> {
    /// Every leaf stands for itself.
    pub fn new(system: &'s System, bounds: &'s Bounds, frame: &'s Frame) -> Self {
        let (given, memo) = (FxHashMap::default(), FxHashMap::default());
        Self { system, frame, bounds, forms: Forms::default(), given, renamed: None, memo, n_aggregates: 0 }
    }

    /// From now on `node` stands for numbers in an interval.
    pub fn bound(&mut self, node: Node, interval: Interval) {
        let form = if interval.is_point() {
            self.forms.constant(interval.lo)
        } else {
            self.forms.leaf(node, interval)
        };
        self.given.insert(node, form);
        self.memo.clear();
    }

    /// From now on the agent itself is in a mode, or inside it.
    pub fn stay_in(&mut self, modes: &[ModeSystem], mode: usize) {
        let leaves = (0..modes.len()).filter(|&leaf| modes[leaf].active.contains(&mode));
        let hull = leaves.map(|leaf| Interval::point(leaf as f64)).reduce(Interval::hull);
        if let Some(hull) = hull {
            self.bound(Node::Aux { slot: 0, column: Layout::MODE as u32 }, hull);
        }
    }

    /// From now on, in this frame, with leaves for which other forms stand and a slot that is read as another one.
    pub fn read_as(
        &mut self,
        frame: &'s Frame,
        given: FxHashMap<Node, FormId>,
        renamed: Option<(usize, usize)>,
    ) {
        (self.frame, self.given, self.renamed) = (frame, given, renamed);
        self.memo.clear();
    }

    /// The form of a function's first output.
    pub fn function(&mut self, function: FunctionId) -> FormId {
        self.node(self.system.functions[function].outputs[0])
    }

    /// The form of a node.
    pub fn node(&mut self, root: NodeId) -> FormId {
        for id in self.system.graph.reach(&[root]) {
            if !self.memo.contains_key(&id) {
                let node = self.system.graph.node(id);
                let form = match node.op() {
                    Some(op) => {
                        let operands: Vec<FormId> =
                            node.operands().map(|operand| self.memo[&operand]).collect();
                        self.forms.apply(op, &operands)
                    }
                    None => self.leaf(node),
                };
                self.memo.insert(id, form);
            }
        }
        self.memo[&root]
    }

    fn leaf(&mut self, node: Node) -> FormId {
        if let Node::Constant(bits) = node {
            return self.forms.constant(f64::from_bits(bits));
        }
        if node.slot().is_some_and(|slot| matches!(self.frame.slots[slot], Slot::Fold { .. })) {
            // What one frame calls its aggregate is not what another one does, and an action may change it.
            self.n_aggregates += 1;
            let slot = u32::MAX - self.n_aggregates;
            return self.forms.leaf(Node::Aux { slot, column: 0 }, Interval::WHOLE);
        }
        let node = match self.renamed {
            Some((from, to)) => renamed(node, from, to),
            None => node,
        };
        if let Some(&given) = self.given.get(&node) {
            return given;
        }
        let interval = self.bounds.leaf(self.frame, node);
        self.forms.leaf(node, interval)
    }

    /// Whether a node reads an agent that a link may lead to, and that may be absent, or an aggregate of such agents.
    pub fn reads_links(&self, root: NodeId) -> bool {
        let graph = &self.system.graph;
        let is_link =
            |slot: usize| matches!(self.frame.slots.get(slot), Some(Slot::Link { .. } | Slot::Fold { .. }));
        graph.reach(&[root]).into_iter().any(|id| graph.node(id).slot().is_some_and(is_link))
    }
}

fn renamed(node: Node, from: usize, to: usize) -> Node {
    let other = |slot: u32| if slot as usize == from { to as u32 } else { slot };
    match node {
        Node::State { slot, column } => Node::State { slot: other(slot), column },
        Node::Rate { slot, column } => Node::Rate { slot: other(slot), column },
        Node::Acceleration { slot, column } => Node::Acceleration { slot: other(slot), column },
        Node::Aux { slot, column } => Node::Aux { slot: other(slot), column },
        Node::Constant(_) | Node::Time => node,
        Node::Unary(..) | Node::Binary(..) | Node::Select(..) => node,
    }
}
