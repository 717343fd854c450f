//! What is asked of a system in more than one place: its lists of actions, and who is made and removed by them.

use crate::calculus::system::{
    ActionList, ActionStep, AgentSystem, Birth, Condition, FunctionId, InteractionSystem, Source, System,
};

impl System {
    /// All lists of actions: those of agents, by their types, then those of interactions.
    pub fn action_lists(&self) -> impl Iterator<Item = &ActionList> {
        action_lists(&self.types, &self.interactions)
    }

    /// Whether any action makes agents.
    pub fn creates(&self) -> bool {
        self.action_lists().any(ActionList::creates)
    }
}

/// All lists of actions: those of agents, by their types, then those of interactions.
pub fn action_lists<'s>(
    types: &'s [AgentSystem],
    interactions: &'s [InteractionSystem],
) -> impl Iterator<Item = &'s ActionList> {
    let of_types = types.iter().flat_map(|ty| {
        let modes = ty.modes.iter().flat_map(|mode| [&mode.entry, &mode.exit]);
        modes.chain(ty.transitions.iter().map(|transition| &transition.actions))
    });
    let pairs = interactions.iter().flat_map(|interaction| &interaction.transitions);
    of_types.chain(pairs.map(|pair| &pair.transition.actions))
}

impl Condition {
    /// The terms of its outermost `and`; itself, if it is none.
    pub fn conjuncts(&self) -> &[Condition] {
        match self {
            Condition::And(terms) => terms,
            condition => std::slice::from_ref(condition),
        }
    }

    /// Whether a quantifier stands in it.
    pub fn quantifies(&self) -> bool {
        match self {
            Condition::Constant(_) | Condition::Discrete(_) | Condition::Atom(_) => false,
            Condition::And(all) | Condition::Or(all) => all.iter().any(Condition::quantifies),
            Condition::Exists(_) | Condition::Forall(_) => true,
            Condition::Rising(_, condition) => condition.quantifies(),
        }
    }
}

impl ActionList {
    fn any(&self, is_one: fn(&ActionStep) -> bool) -> bool {
        any_step(&self.steps, is_one)
    }

    /// Whether it makes agents.
    pub fn creates(&self) -> bool {
        self.any(|step| matches!(step, ActionStep::Create(_)))
    }

    /// Whether it removes agents.
    pub fn destroys(&self) -> bool {
        self.any(|step| matches!(step, ActionStep::Destroy { .. }))
    }

    /// Whether it may end the run.
    pub fn stops(&self) -> bool {
        self.any(|step| matches!(step, ActionStep::Stop { .. }))
    }

    /// All that makes agents.
    pub fn births(&self) -> Vec<&Birth> {
        let mut found = Vec::new();
        add_births(&self.steps, &mut found);
        found
    }
}

/// Whether a step is such a one, those in branches included.
fn any_step(steps: &[ActionStep], is_one: fn(&ActionStep) -> bool) -> bool {
    steps.iter().any(|step| match step {
        ActionStep::If { then, otherwise, .. } => any_step(then, is_one) || any_step(otherwise, is_one),
        step => is_one(step),
    })
}

fn add_births<'s>(steps: &'s [ActionStep], found: &mut Vec<&'s Birth>) {
    for step in steps {
        match step {
            ActionStep::Create(birth) => found.push(birth),
            ActionStep::If { then, otherwise, .. } => {
                add_births(then, found);
                add_births(otherwise, found);
            }
            ActionStep::Assign { .. }
            | ActionStep::Draw { .. }
            | ActionStep::Emit { .. }
            | ActionStep::Goto { .. }
            | ActionStep::Stop { .. }
            | ActionStep::Destroy { .. } => {}
        }
    }
}

impl Source {
    /// The functions that say what it is.
    pub fn functions(&self) -> &[FunctionId] {
        match self {
            Source::Number(function) => std::slice::from_ref(function),
            Source::Draw { parameters, .. } => parameters,
        }
    }
}

impl AgentSystem {
    /// A mode and those around it, inner first.
    pub fn around(&self, mode: usize) -> impl Iterator<Item = usize> + '_ {
        std::iter::successors(Some(mode), |&mode| self.modes[mode].parent)
    }

    /// The region that a mode is in; none for the root of an agent with regions.
    pub fn region_of(&self, mode: usize) -> Option<usize> {
        self.around(mode).find(|around| self.regions.contains(around))
    }

    /// Whether a mode is another one, or inside it.
    pub fn is_inside(&self, mode: usize, other: usize) -> bool {
        self.around(mode).any(|around| around == other)
    }
}
