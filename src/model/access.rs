//! What is asked of a model in more than one place: its lists of actions, the names of its agents and variables.

use super::ir::{
    Action, AgentType, Create, Destination, Draw, ExprId, Given, Inside, Integrator, Link, LinkCase,
    LinkTarget, Machinery, ModeId, Model, Population, Run, Transition, Trigger, VarRef,
};

impl Model {
    /// All lists of actions of agents: those of modes, then those of transitions; then those of interactions.
    pub fn action_lists(&self) -> impl Iterator<Item = &[Action]> {
        let of_types = self.types.iter().flat_map(|ty| {
            let modes = ty.modes.iter().flat_map(|mode| [&mode.entry[..], &mode.exit[..]]);
            modes.chain(ty.transitions.iter().map(|transition| &transition.actions[..]))
        });
        let pairs = self.interactions.iter().flat_map(|interaction| &interaction.transitions);
        of_types.chain(pairs.map(|transition| &transition.actions[..]))
    }

    /// All that creates agents, in the order of [`Model::action_lists`].
    pub fn creations(&self) -> Vec<&Create> {
        let mut found = Vec::new();
        self.action_lists().for_each(|list| add_creations(list, &mut found));
        found
    }
}

fn add_creations<'m>(list: &'m [Action], found: &mut Vec<&'m Create>) {
    for action in list {
        match action {
            Action::Create(create) => found.push(create),
            Action::If { then, otherwise, .. } => {
                add_creations(then, found);
                add_creations(otherwise, found);
            }
            Action::Assign { .. } | Action::Draw { .. } | Action::Emit { .. } | Action::Goto { .. } => {}
            Action::Stop { .. } | Action::Destroy { .. } => {}
        }
    }
}

impl AgentType {
    /// The links that its text declares.
    pub fn declared_links(&self) -> &[Link] {
        &self.links[..self.sets.first().map_or(self.links.len(), |set| set.first)]
    }

    /// The `rate` transitions, in order.
    pub fn rates(&self) -> impl Iterator<Item = &Transition> {
        self.transitions.iter().filter(|transition| matches!(transition.trigger, Trigger::Rate { .. }))
    }

    /// Whether a mode is another one, or inside it.
    pub fn is_inside(&self, mode: ModeId, other: ModeId) -> bool {
        std::iter::successors(Some(mode), |&mode| self.modes[mode].parent).any(|around| around == other)
    }

    /// The name of a variable.
    pub fn variable_name(&self, variable: VarRef) -> &str {
        match variable {
            VarRef::State(number) => &self.states[number].name,
            VarRef::Discrete(number) => &self.discretes[number].name,
            VarRef::Param(number) => &self.params[number].name,
            VarRef::Link(number) => &self.links[number].name,
            VarRef::Let(number) => &self.lets[number].name,
        }
    }
}

impl Given {
    /// The expressions that must be known first.
    pub fn exprs(&self) -> Vec<ExprId> {
        match self {
            Given::Value(id) => vec![*id],
            Given::Draw(draw) => draw.parameters().to_vec(),
        }
    }
}

impl Draw {
    /// As many as the distribution has.
    pub fn parameters(&self) -> &[ExprId] {
        &self.all[..self.distribution.parameters().len()]
    }
}

impl Population {
    /// The path of an agent: `fast`, `cars[3]`.
    pub fn agent_name(&self, agent: usize) -> String {
        let after = self.blocks.partition_point(|block| block.first <= agent);
        match self.blocks[..after].last() {
            Some(block) if block.array => format!("{}[{}]", block.name, agent - block.first),
            Some(block) => block.name.clone(),
            None => format!("#{agent}"),
        }
    }
}

impl Default for Run {
    fn default() -> Self {
        Self {
            until: None,
            tolerance: 1e-6,
            absolute: None,
            seed: 0,
            integrator: Integrator::Auto,
            machinery: Machinery::default(),
            records: Vec::new(),
            events: None,
            span: None,
        }
    }
}

impl LinkCase {
    /// All that it says.
    pub fn exprs(&self) -> Vec<ExprId> {
        let mut all: Vec<ExprId> = self.condition.into_iter().collect();
        match &self.target {
            LinkTarget::Nobody => {}
            LinkTarget::Agent(agent) => all.push(*agent),
            LinkTarget::Nearest { filter, key, .. } => {
                all.extend(*filter);
                all.push(*key);
            }
        }
        all
    }
}

impl Destination {
    /// What stands behind the mode's path: nothing, or `.history`.
    pub fn suffix(self) -> &'static str {
        match self.inside {
            Inside::Initial => "",
            Inside::History => ".history",
        }
    }
}
