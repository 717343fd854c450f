//! Lists without spare room: a giant model has very many short ones.

use super::{AgentType, Mode};

impl AgentType {
    /// Gives back the room of its lists that nothing is in.
    pub fn shrink_to_fit(&mut self) {
        let Self { params, states, discretes, links, lets, modes, transitions, .. } = self;
        [params, states, discretes].into_iter().for_each(Vec::shrink_to_fit);
        links.shrink_to_fit();
        lets.shrink_to_fit();
        transitions.shrink_to_fit();
        modes.shrink_to_fit();
        for mode in modes.iter_mut() {
            let Mode { children, flow, invariants, asserts, .. } = mode;
            children.shrink_to_fit();
            flow.shrink_to_fit();
            [invariants, asserts].into_iter().for_each(Vec::shrink_to_fit);
        }
    }
}
