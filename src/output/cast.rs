//! The names that tables print: of agents, by number, and of the columns of their types.

use super::columns::Kind;
use crate::runtime::observe::Who;

/// All names of a run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cast {
    /// The path of every agent that is there at t = 0, by number: `fast`, `cars[3]`.
    pub agents: Vec<String>,
    /// The columns of every agent type, by number.
    pub types: Vec<TypeColumns>,
}

/// The variables of an agent type, each list in order of declaration.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TypeColumns {
    /// Name of the type.
    pub name: String,
    /// The columns of the states in tables of all agents.
    pub states: Vec<String>,
    /// Those of the discrete variables.
    pub discretes: Vec<String>,
    /// What the discrete variables hold.
    pub discrete_kinds: Vec<Kind>,
}

impl Cast {
    /// The path of an agent; one that has been created is named by its type and number, `Car#17`.
    pub fn agent(&self, who: Who) -> std::borrow::Cow<'_, str> {
        match self.agents.get(who.number) {
            Some(path) => path.as_str().into(),
            None => {
                let name = self.types.get(who.ty).map_or("", |ty| ty.name.as_str());
                format!("{name}#{}", who.number).into()
            }
        }
    }
}
