//! From the tree of the text to a model: names, types, modes, data.
//!
//! In: an `Ast`, the data files it names, the settings of this run. Out: [`ir::Model`].
//! Promised: nothing after this floor sees a node of the syntax tree, and what it hands on is valid: every name is resolved,
//! every expression typed, every constant evaluated, every state has one flow in every mode, no flow reads an agent that may
//! not be there. Many errors are reported in one run, none of them twice.

mod integrator;
pub mod limits;
mod applied;
pub mod ir;
mod suggest;
mod dimension;
mod measure;
mod units;
mod types;
mod error;
mod operands;
mod order;
mod mentions;
mod evaluate;
mod context;
mod slot;
mod modes;
mod declare;
mod expression;
mod resolve;
mod call;
mod quantifier;
mod overrides;
mod draw;
mod define;
mod events;
mod actions;
mod transition;
mod behaviour;
mod presence;
mod initial;
mod table;
mod plan;
mod reference;
mod population;
mod make;
mod record;
mod run;
mod consistency;
mod origin;
mod formula;
mod dump;
mod lint;

pub use dump::dump;
pub use ir::Model;

use crate::base::{Diagnostic, SourceMap};
use crate::syntax::Ast;

/// What the command line lays over the model.
#[derive(Clone, Debug, Default)]
pub struct Settings {
    /// `-p NAME=VALUE`; of two for one name the last counts.
    pub params: Vec<(String, String)>,
    /// `--until`, s.
    pub until: Option<f64>,
    /// `--tolerance`.
    pub tolerance: Option<f64>,
    /// `--absolute`.
    pub absolute: Option<f64>,
    /// `--seed`.
    pub seed: Option<u64>,
    /// `--integrator`.
    pub integrator: Option<ir::Integrator>,
    /// `--record`: if `run` names no trajectories, record all states and discrete variables of all agents, to a file that the
    /// command line knows.
    pub record_all: bool,
    /// `--limit`.
    pub limits: limits::Limits,
}

/// Reads the files that a model names. Only the command line touches the disk.
pub trait Files {
    /// The bytes of the file at this path, as written in the model, relative to the model file.
    fn read(&mut self, path: &str) -> std::io::Result<Vec<u8>>;
}

/// What a check comes to.
#[derive(Debug)]
pub struct Checked {
    /// The model; none if and only if a diagnostic is an error.
    pub model: Option<Model>,
    /// What there is to say, in the order of the text.
    pub diagnostics: Vec<Diagnostic>,
    /// What a careful reader would ask about a model without errors (HY06xx), in the order of the text.
    pub warnings: Vec<Diagnostic>,
}

/// The model that a text describes, with the settings of this run. Data files that it names are added to `sources`.
pub fn check(ast: &Ast, sources: &mut SourceMap, files: &mut dyn Files, settings: &Settings) -> Checked {
    let mut context = context::Context::new(sources, settings);
    declare::declare(&mut context, ast);
    define::define(&mut context);
    behaviour::fill_agents(&mut context);
    transition::fill_interactions(&mut context);
    presence::check_presence(&mut context);
    let initials = initial::initial_values(&mut context);
    run::settle(&mut context, ast, settings);
    population::populate(&mut context, ast, files, &initials);
    run::trajectories(&mut context, ast, settings);
    consistency::check_dimensions(&mut context);
    let warnings = lint::lint(&mut context);
    context.finish(warnings)
}
