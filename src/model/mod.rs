//! From the tree of the text to a model: names, types, modes, data.
//!
//! In: an `Ast`, the data files it names, the settings of this run. Out: [`ir::Model`].
//! Promised: nothing after this floor sees a node of the syntax tree, and what it hands on is valid: every name is resolved,
//! every expression typed, every constant evaluated, every state has one flow in every mode, no flow reads an agent that may
//! not be there. Many errors are reported in one run, none of them twice.

mod integrator;
pub mod machinery;
pub mod limits;
mod applied;
mod kinds;
mod pace;
mod collective;
pub mod ir;
mod access;
mod configuration;
mod suggest;
mod foreign;
mod dimension;
mod measure;
mod units;
mod types;
mod error;
mod quantities;
mod operands;
mod order;
mod mentions;
mod evaluate;
mod findings;
mod context;
mod slot;
mod modes;
mod declare;
mod choice;
mod expression;
mod lists;
mod resolve;
mod call;
mod membership;
mod quantifier;
mod overrides;
mod draw;
mod links;
mod define;
mod create;
mod events;
mod actions;
mod transition;
mod behaviour;
mod presence;
mod initial;
mod table;
mod lookup;
mod imports;
mod plan;
mod reference;
mod population;
mod make;
mod columns;
mod record;
mod run;
mod watch;
mod sets;
mod consistency;
mod origin;
mod formula;
mod dump;
mod diagram;
mod shared;
mod lint;

pub use columns::{column_name, divided_names};
pub use diagram::{Arrow, Diagram, ModeBox, diagrams};
pub use dump::dump;
pub use ir::Model;
pub use run::SETTINGS;
pub use shared::shared_places;

use crate::base::{Diagnostic, FileId, SourceMap};
use crate::syntax::Ast;
use crate::syntax::ast::Item;

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
    /// The bytes of the file at this path, relative to the model file: a data file, or an imported one.
    fn read(&mut self, path: &str) -> std::io::Result<Vec<u8>>;

    /// What tells this file from others, however its path is written; none where that is not known, and the path alone tells.
    fn identity(&self, _path: &str) -> Option<std::path::PathBuf> {
        None
    }
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

/// The model that a text and the files that it imports describe, with the settings of this run. Files that are named are added to
/// `sources`; the texts of data files are forgotten again where there is nothing to say about them.
pub fn check(ast: &Ast, sources: &mut SourceMap, files: &mut dyn Files, settings: &Settings) -> Checked {
    let imports::Imports { trees, diagnostics } = imports::gather(ast, sources, files);
    let written = || trees.iter().chain([ast]).flat_map(|tree| &tree.items);
    let watcher = watch::watcher(written());
    let items: Vec<&Item> = written().chain(&watcher).collect();
    let mut context = context::Context::new(sources, files, settings);
    context.imports = !diagnostics.is_empty();
    context.findings = diagnostics.into();
    context.model.files = trees.iter().chain([ast]).filter_map(file_of).collect();
    declare::declare(&mut context, &items);
    define::define(&mut context);
    links::fill_links(&mut context);
    behaviour::fill_agents(&mut context);
    transition::fill_interactions(&mut context);
    links::check_circles(&mut context);
    presence::check_presence(&mut context);
    initial::initial_values(&mut context);
    watch::fill(&mut context, &items);
    run::settle(&mut context, &items, settings);
    membership::settle(&mut context);
    population::populate(&mut context, &items);
    run::trajectories(&mut context, &items, settings);
    consistency::check_dimensions(&mut context);
    let warnings = lint::lint(&mut context);
    sets::fill(&mut context);
    context.finish(warnings)
}

/// The file of a tree; none if nothing is in it.
fn file_of(tree: &Ast) -> Option<FileId> {
    let span = match tree.items.first()? {
        Item::Import(item) => item.span,
        Item::Param(item) => item.span,
        Item::Let(item) => item.span,
        Item::Fn(item) => item.span,
        Item::Agent(item) => item.span,
        Item::Interaction(item) => item.span,
        Item::System(item) => item.span,
        Item::Property(item) => item.span,
        Item::Run(item) => item.span,
    };
    Some(span.file)
}
