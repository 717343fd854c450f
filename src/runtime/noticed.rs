//! Which discrete variables any guard reads: what is written to others is nothing to look at (rule 14).

use crate::codegen::program::{FunctionId, Guard, Trigger};
use crate::runtime::definition::Definition;
use crate::runtime::population::Agents;

/// For each type and auxiliary column, whether a change of it may be one of a guard.
#[derive(Clone, Debug, Default)]
pub struct Noticed(Vec<Vec<bool>>);

impl Noticed {
    /// What these definitions read. Whatever is not a discrete variable is noticed always, and all is where there are
    /// properties: their margins are looked at whenever somebody is written.
    pub fn new(agents: &Agents<'_>, definitions: &[Definition<'_>]) -> Self {
        let program = agents.program;
        let all = !program.properties().is_empty();
        let of_type = program.types.iter().map(|system| {
            let layout = &system.layout;
            let discretes = layout.discrete(0)..layout.discrete(layout.n_discretes);
            (0..layout.n_aux()).map(|column| all || !discretes.contains(&column)).collect()
        });
        let mut noticed = Self(of_type.collect());
        for definition in definitions {
            noticed.add(agents, definition);
        }
        noticed
    }

    fn add(&mut self, agents: &Agents<'_>, definition: &Definition<'_>) {
        let frame = definition.frame;
        let guards = definition.guard.into_iter().chain(frame.folds.iter().map(|fold| &fold.filter));
        let mut functions: Vec<FunctionId> = guards.flat_map(Guard::functions).collect();
        functions.extend(frame.folds.iter().filter_map(|fold| fold.term.as_ref()).map(|term| term.value));
        if let Some(Trigger::Chance { rate, .. }) = definition.trigger() {
            functions.push(*rate);
        }
        for function in functions {
            for &(slot, column) in &agents.program.kernel(function).reads().columns {
                self.0[frame.slots[slot].ty()][column] = true;
            }
        }
    }

    /// Whether any of these columns of an agent, which had other values before, may concern a guard.
    pub fn any(&self, ty: usize, before: &[f64], now: &[f64]) -> bool {
        let is_other = |(before, now): (&f64, &f64)| before.to_bits() != now.to_bits();
        before.iter().zip(now).zip(&self.0[ty]).any(|(pair, &noticed)| noticed && is_other(pair))
    }
}
