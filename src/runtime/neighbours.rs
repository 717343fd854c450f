//! Near pairs (I7): which pairs of an interaction have instances, and the boxes by which they are found.
//!
//! An interaction whose condition has a range ([`crate::codegen::program::Near`]) has instances for pairs only that can
//! come within it before the list is made anew. Each agent has a box: where it can get to until then, in the states that
//! are compared, with half of the range around it. Pairs whose boxes do not overlap cannot make the condition true.

use smallvec::SmallVec;

use crate::runtime::grid::Grid;
use crate::runtime::population::Agents;

/// The pairs of all interactions that have a range.
#[derive(Default)]
pub struct Neighbours {
    /// The lists hold up to here, s.
    pub until: f64,
    /// For how long they were made, s.
    pub span: f64,
    /// One for each transition of an interaction that has a range.
    pub fields: Vec<Field>,
}

/// The pairs of one transition of an interaction.
pub struct Field {
    /// Its definition.
    pub definition: usize,
    /// The types of the two.
    pub types: [usize; 2],
    /// Whether each of the two is found by the same states of the same type: then an agent has one box.
    pub alike: bool,
    /// Whether a pair counts once, the lower number first.
    pub symmetric: bool,
    /// The boxes of the first type, then, if they are not alike, those of the second, each by rank.
    pub grid: Grid,
    /// Pairs that have instances, with those.
    pub listed: Vec<Listed>,
}

/// A pair with its instance.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Listed {
    /// The two, in the order of the interaction's participants.
    pub agents: [u32; 2],
    /// Their instance.
    pub instance: u32,
}

impl Field {
    /// The sides that have boxes of their own.
    pub fn sides(&self) -> std::ops::Range<usize> {
        0..if self.alike { 1 } else { 2 }
    }

    /// The number of an agent's box on one side; none if it is of another type.
    pub fn number(&self, agents: &Agents<'_>, agent: usize, side: usize) -> Option<u32> {
        let agent = &agents.agents[agent];
        let before = if side == 0 { 0 } else { agents.of_type[self.types[0]].len() };
        (agent.ty == self.types[side]).then(|| (before + agent.rank) as u32)
    }

    /// The pairs of agents that two boxes, a < b, stand for.
    pub fn pairs(&self, of_type: &[Vec<usize>], a: u32, b: u32) -> SmallVec<[[u32; 2]; 2]> {
        let first = &of_type[self.types[0]];
        if self.alike {
            let (a, b) = (first[a as usize] as u32, first[b as usize] as u32);
            return if self.symmetric {
                SmallVec::from_slice(&[[a, b]])
            } else {
                SmallVec::from_slice(&[[a, b], [b, a]])
            };
        }
        // Boxes of the two sides only, and not of an agent with itself.
        let (a, b) = (a as usize, b as usize);
        if a >= first.len() || b < first.len() {
            return SmallVec::new();
        }
        let (a, b) = (first[a] as u32, of_type[self.types[1]][b - first.len()] as u32);
        if a == b || self.symmetric && a > b { SmallVec::new() } else { SmallVec::from_slice(&[[a, b]]) }
    }
}
