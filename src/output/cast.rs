//! The names that tables print: of agents, by number, and of the columns of their types.

use super::columns::Kind;

/// All names of a run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cast {
    /// The path of every agent, by number: `fast`, `cars[3]`.
    pub agents: Vec<String>,
    /// The columns of every agent type, by number.
    pub types: Vec<TypeColumns>,
}

/// The variables of an agent type, each list in order of declaration.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TypeColumns {
    /// Names of the states.
    pub states: Vec<String>,
    /// Names of the discrete variables.
    pub discretes: Vec<String>,
    /// What the discrete variables hold.
    pub discrete_kinds: Vec<Kind>,
}

impl Cast {
    /// The path of an agent; one that the list does not know is named by its number.
    pub fn agent(&self, number: usize) -> std::borrow::Cow<'_, str> {
        match self.agents.get(number) {
            Some(path) => path.as_str().into(),
            None => format!("#{number}").into(),
        }
    }
}
