//! The expression graph: hash-consed, operands before their users.

use rustc_hash::FxHashMap;

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

/// All nodes of a system.
#[derive(Clone, Debug, Default)]
pub struct Graph {
    nodes: Arena<Node>,
    known: FxHashMap<Node, NodeId>,
}

impl Graph {
    /// The node's name, the same for the same node.
    pub fn intern(&mut self, node: Node) -> NodeId {
        if let Some(&id) = self.known.get(&node) {
            return id;
        }
        let id = self.nodes.push(node);
        self.known.insert(node, id);
        id
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
