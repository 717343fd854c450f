//! What is sampled of a run for its page: all agents, so often that the page stays small. It changes no event (rule 16).

use super::Refused;
use super::landmarks::{Reach, Wall, reaches, walls};
use crate::base::Span;
use crate::codegen::program::{Program, Record, VarRef};
use crate::model::ir::{Model, Type, Variable};
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
}

/// A record of all agents, to be added to those of the model, and what it holds.
pub(super) fn watch(model: &Model, program: &Program) -> Result<(Record, Watched), Refused> {
    let until = program.run.until.ok_or("a page needs an end of the run: add `--until T`")?;
    let found = columns(model);
    let n_agents = program.population.agents.len();
    let n_numbers = (n_agents * found.len()).max(1) as f64;
    let n_samples = (NUMBERS / n_numbers).clamp(SAMPLES_LEAST, SAMPLES_MOST);
    let variables =
        (0..model.types.len()).map(|ty| found.iter().map(|column| column.variables[ty]).collect()).collect();
    let landmarks = landmarks(program, &found);
    let shown: Vec<Shown> = found.into_iter().map(|column| column.shown).collect();
    let record = Record {
        agents: (0..n_agents).collect(),
        born: vec![true; model.types.len()],
        columns: shown.iter().map(|column| column.name.clone()).collect(),
        variables,
        every: Some(if until > 0.0 { until / n_samples.floor() } else { 1.0 }),
        file: None,
        span: Span::default(),
    };
    Ok((record, Watched { plane: plane(&shown), columns: shown, landmarks }))
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
}

/// States, discrete variables, and parameters that say where an agent is; columns of one name are one.
fn columns(model: &Model) -> Vec<Found> {
    let mut found: Vec<Found> = Vec::new();
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
                found.push(Found {
                    shown: Shown { name, unit, varies },
                    variables: vec![None; model.types.len()],
                });
                found.len() - 1
            });
            found[place].variables[ty] = Some(reference);
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

/// `x` and `y`; else `x`, or the first column, and what says where an agent is beside it, or the second column; a single column
/// over time.
fn plane(columns: &[Shown]) -> [Option<usize>; 2] {
    let named = |name: &str| columns.iter().position(|column| column.name == name);
    let across = named("x").or(if columns.is_empty() { None } else { Some(0) });
    let beside = columns.iter().position(|column| column.varies == Varies::AmongAgents);
    let next = (0..columns.len()).find(|&k| Some(k) != across);
    match named("y").filter(|_| named("x").is_some()).or(beside).or(next) {
        Some(up) => [across, Some(up)],
        None => [None, across],
    }
}
