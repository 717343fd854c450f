//! Configurations: the modes in which an agent can be at once, a leaf of each of its regions.
//!
//! Without regions the agent itself is the one region, and its configurations are its leaves.

use super::ir::{AgentType, ModeId};

impl AgentType {
    /// Whether its modes stand in regions.
    pub fn has_regions(&self) -> bool {
        self.modes[ModeId::new(0)].children.first().is_some_and(|&child| self.modes[child].is_region)
    }

    /// The regions; the root is the only one of an agent without regions.
    pub fn regions(&self) -> Vec<ModeId> {
        let root = ModeId::new(0);
        if self.has_regions() { self.modes[root].children.clone() } else { vec![root] }
    }

    /// The leaves of each region, in order. An agent is in one of each at once.
    pub fn leaves(&self) -> Vec<Vec<ModeId>> {
        let leaves = |region: ModeId| {
            let all = self.modes.iter_enumerated().filter(|(_, mode)| mode.children.is_empty());
            all.map(|(id, _)| id).filter(|&id| self.is_inside(id, region)).collect()
        };
        self.regions().into_iter().map(leaves).collect()
    }

    /// How many combinations of leaves of all regions there are.
    pub fn n_configurations(&self) -> usize {
        self.leaves().iter().fold(1, |n, leaves| n.saturating_mul(leaves.len()))
    }

    /// A combination by its number, the leaf of the last region changing fastest.
    pub fn configuration(leaves: &[Vec<ModeId>], mut number: usize) -> Vec<ModeId> {
        let mut chosen: Vec<ModeId> = Vec::with_capacity(leaves.len());
        for leaves in leaves.iter().rev() {
            chosen.push(leaves[number % leaves.len()]);
            number /= leaves.len();
        }
        chosen.reverse();
        chosen
    }

    /// All modes that are active with these leaves: the root first, each before those inside it, otherwise in order of declaration.
    pub fn active(&self, leaves: &[ModeId]) -> Vec<ModeId> {
        let around = |&leaf: &ModeId| std::iter::successors(Some(leaf), |&mode| self.modes[mode].parent);
        let mut active: Vec<ModeId> = leaves.iter().flat_map(around).collect();
        active.sort_unstable_by_key(|&mode| (self.modes[mode].depth, mode));
        active.dedup();
        active
    }

    /// How logs call a combination of leaves: `Drive.Cruise`, `Motion.Drive|Lamp.Off`.
    pub fn path(&self, leaves: &[ModeId]) -> String {
        leaves.iter().map(|&leaf| self.modes[leaf].path.as_str()).collect::<Vec<_>>().join("|")
    }

    /// The region that a mode is in; none for the root of an agent with regions.
    pub fn region_of(&self, mode: ModeId) -> Option<ModeId> {
        let root = (!self.has_regions()).then_some(ModeId::new(0));
        std::iter::successors(Some(mode), |&mode| self.modes[mode].parent)
            .find(|&mode| self.modes[mode].is_region)
            .or(root)
    }
}
