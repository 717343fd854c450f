//! The product of this floor: a program that runs. The structure of the system with a kernel for every function of it.

use std::sync::Arc;

use crate::base::Arena;
use crate::calculus::access::action_lists;
use crate::calculus::graph::Graph;
use crate::calculus::system::Function;
pub use crate::calculus::system::FunctionId;
pub use crate::calculus::system::{
    ActionList, ActionStep, AgentSystem, Aggregate, Atom, Birth, ClaimKind, ClaimSystem, Column, Condition,
    Destination, Distribution, Entry, Flow, Fold, Formula, Frame, Guard, Initials, Inside, Integrator,
    InteractionSystem, Jumps, Keys, Kink, KinkKind, Layout, LetSystem, LetValue, LinkUpdate, ModeSystem,
    Near, Pace, PairTransition, Population, Property, Quantified, Range, Record, Relation, Run, Sender,
    SetSystem, Slot, Source, Term, Thinning, TransitionSystem, Trigger, VarRef, Watch, Whither,
};
use crate::codegen::kernel::{Kernel, StepKernel};
use crate::codegen::later::Later;
use crate::codegen::series::SeriesTape;

/// A model, compiled.
#[derive(Debug)]
pub struct Program {
    /// The expressions that kernels compute, for messages.
    pub graph: Graph,
    /// What each kernel computes: same number.
    pub functions: Arena<Function>,
    /// Agent types, numbered as in the model.
    pub types: Vec<AgentSystem>,
    /// Interactions, numbered as in the model.
    pub interactions: Vec<InteractionSystem>,
    /// The agents at t = 0.
    pub population: Population,
    /// Settings of the run.
    pub run: Run,
    /// What watches it; its type is one of the types.
    pub watch: Option<Watch>,
    /// One kernel for each function of the system, same number.
    pub kernels: Vec<Kernel>,
    /// Whole Runge-Kutta steps: for each type, for each mode, where the flow reads no foreign state (and is compiled).
    pub steps: Vec<Vec<Option<StepKernel>>>,
    /// Taylor series: for each type, for each mode, where the flow has one.
    pub series: Vec<Vec<Option<SeriesTape>>>,
    /// What compilation took.
    pub cost: Cost,
    /// The machine code that is made when it pays.
    pub(super) later: Option<Arc<Later>>,
}

/// The size and time of a compilation; the same for any number of agents, but for the time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Cost {
    /// How many functions of machine code.
    pub functions: usize,
    /// How many functions are interpreted: all of them, or those too long to be compiled.
    pub interpreted: usize,
    /// How many instructions of all tapes.
    pub instructions: usize,
    /// Bytes of machine code.
    pub code_bytes: usize,
    /// s.
    pub seconds: f64,
}

impl Program {
    /// What there is of machine code by now: how many functions, and bytes.
    pub fn machine_code(&self) -> (usize, usize) {
        let Some(code) = self.later.as_ref().and_then(|later| later.made()) else {
            return (self.cost.functions, self.cost.code_bytes);
        };
        (code.kernels.iter().flatten().count() + code.steps.len(), code.bytes)
    }

    /// All lists of actions.
    pub fn action_lists(&self) -> impl Iterator<Item = &ActionList> {
        action_lists(&self.types, &self.interactions)
    }

    /// The type of the agent that watches and that nobody sees.
    pub fn watcher(&self) -> Option<usize> {
        self.watch.as_ref().map(|watch| watch.ty.index())
    }

    /// The properties that are watched.
    pub fn properties(&self) -> &[Property] {
        self.watch.as_ref().map_or(&[], |watch| &watch.properties)
    }

    /// The kernel of a function.
    pub fn kernel(&self, function: FunctionId) -> &Kernel {
        &self.kernels[function.index()]
    }
}
