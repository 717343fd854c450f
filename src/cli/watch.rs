//! What is sampled of a run for its page: all agents, so often that the page stays small. It changes no event (rule 16).

use super::Refused;
use super::landmarks::{Reach, Wall, reaches, walls};
use crate::base::Span;
use crate::codegen::program::{Program, Record, VarRef};
use crate::model::ir::{Model, Type, TypeId, Variable};
use crate::model::shared_places;
use crate::picture::{Landmarks, Shown, Varies};

/// How many samples there are at least and at most, and about how many numbers in all.
const SAMPLES_LEAST: f64 = 100.0;
const SAMPLES_MOST: f64 = 1200.0;
const NUMBERS: f64 = 2e6;
/// A whole number that differs from agent to agent, with no more values than these, is a place to be drawn at (a lane).
const PLACES: usize = 12;

/// What is sampled for a page: the columns of the record, which of them make the plane, and what is drawn there besides.
pub(super) struct Watched {
    pub(super) columns: Vec<Shown>,
    pub(super) plane: [Option<usize>; 2],
    pub(super) landmarks: Landmarks,
    n_samples: f64,
}

impl Watched {
    /// The distance of samples of a run that ends at `end`, s.
    pub(super) fn every(&self, end: f64) -> f64 {
        if end > 0.0 { end / self.n_samples } else { 1.0 }
    }

    /// Has these two shown across and up, if they are given.
    pub(super) fn show(&mut self, names: &[String]) -> Result<(), Refused> {
        let names = match names {
            [] => return Ok(()),
            [across, up] => [across, up],
            _ => return Err("`--xy` takes two columns: `--xy x,y`".into()),
        };
        for (place, name) in self.plane.iter_mut().zip(names) {
            let column = self.columns.iter().position(|column| column.name == *name);
            if column.is_none() && name != "time" {
                let there: Vec<&str> = self.columns.iter().map(|column| column.name.as_str()).collect();
                return Err(format!("there is no column `{name}`; there are time, {}", there.join(", ")));
            }
            *place = column;
        }
        Ok(())
    }
}

/// A record of all agents, and what it holds. How often it samples follows from the end of the run ([`Watched::every`]).
pub(super) fn watch(model: &Model, program: &Program) -> (Record, Watched) {
    let found = columns(model);
    let n_agents = program.population.agents.len();
    let n_numbers = (n_agents * found.len()).max(1) as f64;
    let n_samples = (NUMBERS / n_numbers).clamp(SAMPLES_LEAST, SAMPLES_MOST).floor();
    let variables =
        (0..model.types.len()).map(|ty| found.iter().map(|column| column.variables[ty]).collect()).collect();
    let landmarks = landmarks(program, &found);
    let plane = plane(&found);
    let shown: Vec<Shown> = found.into_iter().map(|column| column.shown).collect();
    let record = Record {
        agents: (0..n_agents).collect(),
        born: vec![true; model.types.len()],
        columns: shown.iter().map(|column| column.name.clone()).collect(),
        variables,
        every: None,
        file: None,
        span: Span::default(),
    };
    (record, Watched { plane, columns: shown, landmarks, n_samples })
}

fn landmarks(program: &Program, columns: &[Found]) -> Landmarks {
    let column_of = |ty: usize, state: usize| {
        columns.iter().position(|column| column.variables[ty] == Some(VarRef::State(state)))
    };
    let wall = |Wall { ty, state, value }: Wall| Some((column_of(ty, state)?, value));
    let reach =
        |Reach { ty, states: [a, b], within }: Reach| Some(([column_of(ty, a)?, column_of(ty, b)?], within));
    Landmarks {
        walls: walls(program).into_iter().filter_map(wall).collect(),
        ranges: reaches(program).into_iter().filter_map(reach).collect(),
    }
}

/// A column of the page's record.
struct Found {
    shown: Shown,
    /// For each agent type.
    variables: Vec<Option<VarRef>>,
    /// Whether agents compare it with each other's, so that it says where they are.
    is_shared: bool,
}

impl Found {
    /// Whether a type has both columns, and this one as a state.
    fn is_state_beside(&self, other: &Found) -> bool {
        let both = self.variables.iter().zip(&other.variables);
        both.into_iter().any(|(own, other)| matches!((own, other), (Some(VarRef::State(_)), Some(_))))
    }
}

/// States, discrete variables, and parameters that say where an agent is; columns of one name are one.
fn columns(model: &Model) -> Vec<Found> {
    let mut found: Vec<Found> = Vec::new();
    let shared = shared_places(model);
    for (ty, agent) in model.types.iter().enumerate() {
        let states =
            agent.states.iter().enumerate().map(|(k, state)| (state, VarRef::State(k), Varies::InTime));
        let discretes = agent.discretes.iter().enumerate();
        let discretes = discretes.map(|(k, discrete)| (discrete, VarRef::Discrete(k), Varies::InTime));
        let params = agent.params.iter().enumerate().filter(|(k, param)| is_place(model, ty, *k, param));
        let params = params.map(|(k, param)| (param, VarRef::Param(k), Varies::AmongAgents));
        for (variable, reference, varies) in states.chain(discretes).chain(params) {
            let place = found.iter().position(|column| column.shown.name == variable.name);
            let place = place.unwrap_or_else(|| {
                let (name, unit) = (variable.name.clone(), variable.unit.clone());
                let is_whole = variable.ty == Type::Int;
                found.push(Found {
                    shown: Shown { name, unit, varies, is_whole },
                    variables: vec![None; model.types.len()],
                    is_shared: false,
                });
                found.len() - 1
            });
            found[place].variables[ty] = Some(reference);
            found[place].is_shared |= shared.contains(&(TypeId::new(ty), reference));
        }
    }
    found
}

fn is_place(model: &Model, ty: usize, k: usize, param: &Variable) -> bool {
    let agents = model.population.agents.iter().filter(|agent| agent.ty.index() == ty);
    let mut values: Vec<u64> = agents.map(|agent| agent.params[k].to_bits()).collect();
    values.sort_unstable();
    values.dedup();
    param.ty == Type::Int && (2..=PLACES).contains(&values.len())
}

/// What is shown across and up. Across: `x`, or the first column. Up, the first that there is: `y` beside an `x`; another state in the
/// unit of the first, of agents that have both; a whole number that agents compare with each other's (a lane); one that
/// differs from agent to agent; the next column. A single column is shown over time.
fn plane(columns: &[Found]) -> [Option<usize>; 2] {
    let find = |fits: &dyn Fn(&Found) -> bool| columns.iter().position(fits);
    let x = find(&|column| column.shown.name == "x");
    let Some(first) = x.or(if columns.is_empty() { None } else { Some(0) }) else { return [None; 2] };
    let across = &columns[first];
    let y = find(&|column| column.shown.name == "y").filter(|_| x.is_some());
    let alike = |column: &Found| {
        let is_other = column.shown.name != across.shown.name && column.shown.unit.is_some();
        is_other && column.shown.unit == across.shown.unit && column.is_state_beside(across)
    };
    let up = y
        .or_else(|| find(&alike))
        .or_else(|| find(&|column| column.is_shared && across.is_state_beside(column)))
        .or_else(|| find(&|column| column.shown.varies == Varies::AmongAgents))
        .or_else(|| (0..columns.len()).find(|&k| k != first));
    match up {
        Some(up) => [Some(first), Some(up)],
        None => [None, Some(first)],
    }
}
