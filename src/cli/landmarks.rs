//! What a page draws beside the agents: walls, where a state alone makes a guard true, and how near two agents have to be
//! for an interaction.

use crate::codegen::kernel::{AgentView, Kernel};
use crate::codegen::program::{AgentSystem, Guard, Near, Program, Trigger};

/// A line across the plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Wall {
    pub(super) ty: usize,
    pub(super) state: usize,
    /// In the unit of the state.
    pub(super) value: f64,
}

/// Two agents that are as near as this in both states may meet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Reach {
    pub(super) ty: usize,
    pub(super) states: [usize; 2],
    /// In the unit of the states.
    pub(super) within: f64,
}

/// So many are drawn at most.
const WALLS_MAX: usize = 32;
/// Two numbers that differ by less, as a share of them, are one.
const SAME: f64 = 1e-9;

/// Where a comparison of a guard depends on one state of its agent alone, and on parameters that all agents of the type have
/// alike: the value of the state at which it changes.
pub(super) fn walls(program: &Program) -> Vec<Wall> {
    let mut found: Vec<Wall> = Vec::new();
    for (ty, system) in program.types.iter().enumerate() {
        let guards = system.transitions.iter().filter_map(|transition| guard_of(&transition.trigger));
        for atom in guards.flat_map(|guard| &guard.atoms) {
            let kernel = program.kernel(atom.value);
            let Some(wall) = wall(program, (ty, system), kernel) else { continue };
            let is_known =
                |known: &Wall| (known.ty, known.state) == (ty, wall.state) && same(known.value, wall.value);
            if found.len() < WALLS_MAX && !found.iter().any(is_known) {
                found.push(wall);
            }
        }
    }
    found
}

fn guard_of(trigger: &Trigger) -> Option<&Guard> {
    match trigger {
        Trigger::When(guard) => Some(guard),
        Trigger::After { guard, .. } | Trigger::Every { guard, .. } | Trigger::Rate { guard, .. } => {
            guard.as_ref()
        }
        Trigger::Chance { .. } | Trigger::On { .. } => None,
    }
}

fn same(a: f64, b: f64) -> bool {
    (a - b).abs() <= SAME * a.abs().max(b.abs())
}

/// The wall of one comparison: where its g, if that is a line over one state, is zero.
fn wall(program: &Program, (ty, system): (usize, &AgentSystem), kernel: &Kernel) -> Option<Wall> {
    let reads = kernel.reads();
    let [(0, state)] = reads.states[..] else { return None };
    let params = system.layout.param(0)..system.layout.discrete(0);
    let is_alone = reads.slots.len() == 1
        && !reads.time
        && reads.moving.len() == 1
        && reads.columns.iter().all(|(_, column)| params.contains(column));
    if !is_alone {
        return None;
    }
    let agents = program.population.agents.iter().filter(|agent| agent.ty.index() == ty);
    // Of a type without agents yet what depends on no parameters is known.
    let of_agents: Vec<&[f64]> = agents.map(|agent| agent.params.as_slice()).collect();
    let of_nobody = vec![0.0; params.len()];
    let of_agents = if reads.columns.is_empty() { vec![of_nobody.as_slice()] } else { of_agents };
    let mut values = of_agents.into_iter().map(|values| {
        let mut aux = vec![0.0; system.layout.n_aux()];
        aux[params.clone()].copy_from_slice(values);
        let g = |x: f64| {
            let states = vec![x; system.layout.n_states];
            let (mut out, empty) = ([0.0], []);
            let view = AgentView { states: &states, rates: &empty, accelerations: &empty, aux: &aux };
            kernel.eval(&[view], 0.0, &mut out);
            out[0]
        };
        let [at_0, at_1, at_2] = [g(0.0), g(1.0), g(2.0)];
        let slope = at_1 - at_0;
        let is_line = slope != 0.0 && (at_2 - at_1 - slope).abs() <= SAME * (at_0.abs() + slope.abs());
        is_line.then(|| -at_0 / slope)
    });
    let first = values.next()??;
    let alike = values.all(|value| value.is_some_and(|value| same(value, first)));
    let value = system.states.get(state)?.scale.from_si(first);
    (alike && value.is_finite()).then_some(Wall { ty, state, value })
}

/// The ranges of interactions between agents of one type that are the same in two states.
pub(super) fn reaches(program: &Program) -> Vec<Reach> {
    let mut found = Vec::new();
    for interaction in program.interactions.iter().filter(|pair| pair.types[0] == pair.types[1]) {
        let ty = interaction.types[0];
        for near in interaction.transitions.iter().map(|pair| &pair.near) {
            let of_one_state = |near: &Near| match near.states()? {
                [own, other] if own == other => Some((own, near.within)),
                _ => None,
            };
            let alike: Vec<(usize, f64)> = near.iter().filter_map(of_one_state).collect();
            for (k, &(a, within)) in alike.iter().enumerate() {
                for &(b, other) in &alike[k + 1..] {
                    let scale = program.types[ty].states[a].scale;
                    let reach = Reach { ty, states: [a, b], within: scale.from_si(within) };
                    if same(within, other) && !found.contains(&reach) {
                        found.push(reach);
                    }
                }
            }
        }
    }
    found
}
