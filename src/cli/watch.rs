//! What is sampled of a run for its page: all agents, so often that the page stays small. It changes no event (rule 16).

use super::Refused;
use super::landmarks::{Reach, Wall, reaches, walls};
use crate::base::Span;
use crate::codegen::program::{Pace, Program, Record, Thinning, VarRef};
use crate::model::ir::{Model, Type, TypeId, Variable};
use crate::model::shared_places;
use crate::picture::{Landmarks, Recording, Shown, Varies};

/// How many samples there are at least and at most, and about how many numbers in all.
const SAMPLES_LEAST: usize = 100;
const SAMPLES_MOST: usize = 1200;
const NUMBERS: usize = 2_000_000;
/// So many numbers there are where agents that are created make more than these; never more than the second.
const NUMBERS_BORN: usize = 3_000_000;
const NUMBERS_MOST: usize = 8_000_000;
/// So many agents are shown at a time.
pub(super) const AGENTS_MOST: usize = 20_000;
/// Samples are this often twice as near at first as a run up to `until` has them at last.
const DOUBLINGS: i32 = 20;
/// Where the run is at such a share of `until`, it is sampled as if it ended soon.
const COARSE_SHARE: f64 = 1.0 / 64.0;
/// Where no end is known: the first distance of samples, and from when on their number counts, s.
const FIRST: f64 = 1.0 / (1u64 << 40) as f64;
const COARSE: f64 = 1.0;
/// A whole number that differs from agent to agent, with no more values than these, is a place to be drawn at (a lane).
const PLACES: usize = 12;

/// What is sampled for a page: the columns of the record, which of them may make the plane, and what is drawn there besides.
pub(super) struct Watched {
    pub(super) columns: Vec<Shown>,
    pub(super) landmarks: Landmarks,
    /// Pairs of columns that some type has, those that are preferred first; none: time.
    planes: Vec<[Option<usize>; 2]>,
}

impl Watched {
    /// The two columns that are shown across and up: the first pair that somebody has.
    pub(super) fn plane(&self, recording: &Recording<'_>) -> [Option<usize>; 2] {
        let is_place = |column: Option<usize>| {
            column.is_none_or(|column| {
                self.columns[column].varies == Varies::InTime || recording.has_few(column, PLACES)
            })
        };
        let fits = |plane: &&[Option<usize>; 2]| {
            self.planes.len() == 1 || recording.shows(**plane) && is_place(plane[1])
        };
        self.planes.iter().find(fits).copied().unwrap_or([None; 2])
    }

    /// Has these two shown across and up, if they are given.
    pub(super) fn show(&mut self, names: &[String]) -> Result<(), Refused> {
        let names = match names {
            [] => return Ok(()),
            [across, up] => [across, up],
            _ => return Err("`--xy` takes two columns: `--xy x,y`".into()),
        };
        let mut plane = [None; 2];
        for (place, name) in plane.iter_mut().zip(names) {
            let column = self.columns.iter().position(|column| column.name == *name);
            if column.is_none() && name != "time" {
                let there: Vec<&str> = self.columns.iter().map(|column| column.name.as_str()).collect();
                return Err(format!("there is no column `{name}`; there are time, {}", there.join(", ")));
            }
            *place = column;
        }
        self.planes = vec![plane];
        Ok(())
    }
}

/// A record of all agents that is thinned out, and what it holds.
pub(super) fn watch(model: &Model, program: &Program) -> (Record, Watched) {
    let found = columns(model);
    let n_agents = program.population.agents.len();
    let pace = Pace::Thinning(thinning(program.run.until, n_agents, found.len().max(1)));
    let variables =
        (0..model.types.len()).map(|ty| found.iter().map(|column| column.variables[ty]).collect()).collect();
    let landmarks = landmarks(program, &found);
    let planes = planes(&found);
    let shown: Vec<Shown> = found.into_iter().map(|column| column.shown).collect();
    let record = Record {
        agents: (0..n_agents).collect(),
        born: vec![true; model.types.len()],
        columns: shown.iter().map(|column| column.name.clone()).collect(),
        variables,
        pace,
        file: None,
        span: Span::default(),
    };
    (record, Watched { columns: shown, landmarks, planes })
}

/// As many samples as their size allows, at round times where the end is known.
fn thinning(until: Option<f64>, n_agents: usize, n_columns: usize) -> Thinning {
    let n_numbers = (n_agents.min(AGENTS_MOST) * n_columns).max(1);
    let samples_most = (NUMBERS / n_numbers).clamp(SAMPLES_LEAST, SAMPLES_MOST);
    let (first, coarse_until) = match until {
        Some(until) if until > 0.0 => {
            (until / samples_most as f64 * 0.5_f64.powi(DOUBLINGS), until * COARSE_SHARE)
        }
        Some(_) => (1.0, 0.0),
        None => (FIRST, COARSE),
    };
    Thinning {
        first,
        samples_most,
        rows_enough: NUMBERS_BORN / n_columns,
        samples_least: SAMPLES_LEAST,
        rows_most: NUMBERS_MOST / n_columns,
        agents_most: AGENTS_MOST,
        coarse_until,
    }
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
    /// Whether a type has both columns.
    fn is_beside(&self, other: &Found) -> bool {
        self.variables.iter().zip(&other.variables).any(|(own, other)| own.is_some() && other.is_some())
    }

    /// Whether a type has both columns, and this one as a state.
    fn is_state_beside(&self, other: &Found) -> bool {
        let both = self.variables.iter().zip(&other.variables);
        both.into_iter().any(|(own, other)| matches!((own, other), (Some(VarRef::State(_)), Some(_))))
    }
}

/// States, discrete variables, and parameters that say where an agent is; columns of one name and one unit are one.
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
            let is_same =
                |column: &Found| (&column.shown.name, &column.shown.unit) == (&variable.name, &variable.unit);
            let place = found.iter().position(is_same);
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

/// Whether a parameter may say where agents are: a whole number that differs among those that are there at t = 0, or of a type of which
/// there are none then.
fn is_place(model: &Model, ty: usize, k: usize, param: &Variable) -> bool {
    let agents = model.population.agents.iter().filter(|agent| agent.ty.index() == ty);
    let mut values: Vec<u64> = agents.map(|agent| agent.params[k].to_bits()).collect();
    values.sort_unstable();
    values.dedup();
    param.ty == Type::Int && (values.is_empty() || (2..=PLACES).contains(&values.len()))
}

/// What may be shown across and up, in order of preference, of columns that a type has together. Across: `x`, or the first column, or the
/// next; what changes in time before what does not. Up, the first that there is: `y` beside an `x`; another state in the unit of the first; a whole number that agents compare with
/// each other's (a lane); one that differs from agent to agent; another column; else the column is shown over time.
fn planes(columns: &[Found]) -> Vec<[Option<usize>; 2]> {
    let mut firsts: Vec<usize> = (0..columns.len()).collect();
    firsts.sort_by_key(|&k| {
        let Shown { name, varies, .. } = &columns[k].shown;
        (name != "x", *varies == Varies::AmongAgents)
    });
    firsts.into_iter().flat_map(|first| ups(columns, first)).collect()
}

fn ups(columns: &[Found], first: usize) -> Vec<[Option<usize>; 2]> {
    let across = &columns[first];
    let is_y = |column: &Found| across.shown.name == "x" && column.shown.name == "y";
    let is_alike = |column: &Found| {
        let unit = &column.shown.unit;
        unit.is_some() && *unit == across.shown.unit && column.is_state_beside(across)
    };
    let is_shared = |column: &Found| column.is_shared && across.is_state_beside(column);
    let is_among = |column: &Found| column.shown.varies == Varies::AmongAgents;
    let is_any = |_: &Found| true;
    let wanted: [&dyn Fn(&Found) -> bool; 5] = [&is_y, &is_alike, &is_shared, &is_among, &is_any];
    let others = |fits: &'_ &dyn Fn(&Found) -> bool| {
        let fits = *fits;
        let is_up = move |&k: &usize| k != first && across.is_beside(&columns[k]) && fits(&columns[k]);
        (0..columns.len()).filter(is_up).map(|up| [Some(first), Some(up)]).collect::<Vec<_>>()
    };
    let mut found: Vec<_> = wanted.iter().flat_map(others).collect();
    found.push([None, Some(first)]);
    found
}
