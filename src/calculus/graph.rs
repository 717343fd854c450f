//! The expression graph: hash-consed, operands before their users.

use std::cell::{Cell, RefCell};
use std::hash::BuildHasher as _;

use hashbrown::HashTable;
use hashbrown::hash_table::Entry;
use rustc_hash::FxBuildHasher;

use crate::base::{Arena, Idx};
use crate::math::Op;

/// Names a [`Node`].
pub type NodeId = Idx<Node>;

/// A value. Booleans are 1 and 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Node {
    /// A constant, by its bits.
    Constant(u64),
    /// The time, s.
    Time,
    /// State `column` of the agent in `slot`.
    State {
        /// Whose.
        slot: u32,
        /// Which.
        column: u32,
    },
    /// Its rate, x'.
    Rate {
        /// Whose.
        slot: u32,
        /// Which.
        column: u32,
    },
    /// Its second rate, x''.
    Acceleration {
        /// Whose.
        slot: u32,
        /// Which.
        column: u32,
    },
    /// Auxiliary column `column` of the agent in `slot`.
    Aux {
        /// Whose.
        slot: u32,
        /// Which.
        column: u32,
    },
    /// An operator of one operand.
    Unary(Op, NodeId),
    /// An operator of two operands.
    Binary(Op, NodeId, NodeId),
    /// `Op::Select`: the second where the first is not 0, else the third.
    Select(NodeId, NodeId, NodeId),
}

impl Node {
    /// The nodes it is computed from, in order.
    pub fn operands(self) -> impl DoubleEndedIterator<Item = NodeId> {
        let operands = match self {
            Node::Unary(_, a) => [Some(a), None, None],
            Node::Binary(_, a, b) => [Some(a), Some(b), None],
            Node::Select(a, b, c) => [Some(a), Some(b), Some(c)],
            Node::Constant(_) | Node::Time | Node::State { .. } => [None; 3],
            Node::Rate { .. } | Node::Acceleration { .. } | Node::Aux { .. } => [None; 3],
        };
        operands.into_iter().flatten()
    }

    /// The operator, if it is no leaf.
    pub fn op(self) -> Option<Op> {
        match self {
            Node::Unary(op, _) | Node::Binary(op, _, _) => Some(op),
            Node::Select(..) => Some(Op::Select),
            Node::Constant(_) | Node::Time | Node::State { .. } => None,
            Node::Rate { .. } | Node::Acceleration { .. } | Node::Aux { .. } => None,
        }
    }

    /// The slot of the agent that a leaf reads.
    pub fn slot(self) -> Option<usize> {
        match self {
            Node::State { slot, .. } | Node::Rate { slot, .. } => Some(slot as usize),
            Node::Acceleration { slot, .. } | Node::Aux { slot, .. } => Some(slot as usize),
            Node::Constant(_) | Node::Time | Node::Unary(..) | Node::Binary(..) | Node::Select(..) => None,
        }
    }
}

/// All nodes of a system.
#[derive(Clone, Debug, Default)]
pub struct Graph {
    nodes: Arena<Node>,
    /// By what they are; the nodes themselves stand in `nodes` only.
    known: HashTable<NodeId>,
    moving: Vec<bool>,
    /// How many nodes have been looked at.
    work: Cell<u64>,
    marks: RefCell<Marks>,
}

/// Which nodes a walk has met: those that bear the number of its round. Kept, so that a short walk costs no more in a large graph.
#[derive(Clone, Debug, Default)]
struct Marks {
    round: u64,
    of_node: Vec<u64>,
}

impl Graph {
    /// The node's name, the same for the same node.
    pub fn intern(&mut self, node: Node) -> NodeId {
        let Self { nodes, known, moving, .. } = self;
        let hash = |node: &Node| FxBuildHasher.hash_one(node);
        let place = match known.entry(hash(&node), |&id| nodes[id] == node, |&id| hash(&nodes[id])) {
            Entry::Occupied(known) => return *known.get(),
            Entry::Vacant(place) => place,
        };
        let moves = match node {
            Node::Constant(_) | Node::Aux { .. } => false,
            Node::Time | Node::State { .. } | Node::Rate { .. } | Node::Acceleration { .. } => true,
            Node::Unary(..) | Node::Binary(..) | Node::Select(..) => {
                node.operands().any(|id| moving[id.index()])
            }
        };
        let id = nodes.push(node);
        place.insert(id);
        moving.push(moves);
        id
    }

    /// Whether it reads a state, a rate or the time: whether it can change between events.
    pub fn moves(&self, id: NodeId) -> bool {
        self.moving[id.index()]
    }

    /// All nodes that `roots` are computed from, themselves included, operands before users.
    pub fn reach(&self, roots: &[NodeId]) -> Vec<NodeId> {
        let mut marks = self.marks.borrow_mut();
        let Marks { round, of_node } = &mut *marks;
        of_node.resize(self.nodes.len(), 0);
        *round += 1;
        let mut found: Vec<NodeId> = Vec::new();
        let mut add = |id: NodeId, found: &mut Vec<NodeId>| {
            if std::mem::replace(&mut of_node[id.index()], *round) != *round {
                found.push(id);
            }
        };
        for &root in roots {
            add(root, &mut found);
        }
        let mut next = 0;
        while let Some(&id) = found.get(next) {
            next += 1;
            for operand in self.node(id).operands() {
                add(operand, &mut found);
            }
        }
        let (first, last) = (found.iter().min().copied(), found.iter().max().copied());
        if let (Some(first), Some(last)) = (first, last) {
            let between = first.index()..last.index() + 1;
            if between.len() / 8 > found.len() {
                found.sort_unstable();
            } else {
                found.clear();
                found.extend(between.filter(|&id| of_node[id] == *round).map(NodeId::new));
            }
        }
        self.spend(found.len() as u64);
        found
    }

    /// Counts work.
    pub fn spend(&self, nodes: u64) {
        self.work.set(self.work.get().saturating_add(nodes));
    }

    /// How much has been counted.
    pub fn work(&self) -> u64 {
        self.work.get()
    }

    /// The node of a name.
    pub fn node(&self, id: NodeId) -> Node {
        self.nodes[id]
    }

    /// All nodes, operands before users.
    pub fn nodes(&self) -> &Arena<Node> {
        &self.nodes
    }
}
