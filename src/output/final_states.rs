//! The state of every agent at the end: a row for each, in the order of their numbers.

use std::io;
use std::time::Duration;

use super::cast::{Cast, TypeColumns};
use super::columns::{Column, Kind};
use super::table::{Sink, Table};
use super::trajectory::write_cell;
use crate::runtime::observe::{Cell, Last};

/// `time,agent,mode,` and a column for each name that any agent type has among its states and discrete variables.
pub(super) struct FinalStates {
    table: Table,
    /// For each agent type, for each column, where the value lies.
    places: Vec<Vec<Place>>,
}

/// Where the value of a column lies in an agent of one type.
#[derive(Clone, Copy)]
enum Place {
    State(usize),
    Discrete(usize),
    Nowhere,
}

impl FinalStates {
    pub(super) fn new(sink: Sink, cast: &Cast) -> io::Result<Self> {
        let columns = columns_of(cast);
        let fixed = [("time", Kind::Number), ("agent", Kind::Text), ("mode", Kind::Text)];
        let fixed = fixed.map(|(name, kind)| Column::new(name, kind));
        let table = Table::new(sink, &[&fixed[..], &columns].concat())?;
        let places =
            cast.types.iter().map(|ty| columns.iter().map(|column| place_of(ty, &column.name)).collect());
        let places = places.collect();
        Ok(Self { table, places })
    }

    pub(super) fn last(&mut self, cast: &Cast, last: &Last<'_>) -> io::Result<()> {
        self.table.number(last.time);
        self.table.text(&cast.agent(last.agent));
        self.table.text(last.mode);
        for &place in &self.places[last.ty] {
            let cell = match place {
                Place::State(k) => Cell::Number(last.states[k]),
                Place::Discrete(k) => last.discretes[k],
                Place::Nowhere => Cell::Empty,
            };
            write_cell(&mut self.table, cast, cell);
        }
        self.table.end_row()
    }

    /// How long it took to hand on rows.
    pub(super) fn handing(&self) -> Duration {
        self.table.handing()
    }

    pub(super) fn finish(&mut self) -> io::Result<()> {
        self.table.finish()
    }
}

/// Every name once: type by type, states before discrete variables.
fn columns_of(cast: &Cast) -> Vec<Column> {
    let mut columns: Vec<Column> = Vec::new();
    for ty in &cast.types {
        let states = ty.states.iter().map(|name| (name, Kind::Number));
        let discretes = ty.discretes.iter().zip(ty.discrete_kinds.iter().copied());
        for (name, kind) in states.chain(discretes) {
            match columns.iter_mut().find(|column| column.name == *name) {
                Some(column) => column.kind = column.kind.with(kind),
                None => columns.push(Column::new(name, kind)),
            }
        }
    }
    columns
}

fn place_of(ty: &TypeColumns, column: &str) -> Place {
    let position = |names: &[String]| names.iter().position(|name| name == column);
    match (position(&ty.states), position(&ty.discretes)) {
        (Some(k), _) => Place::State(k),
        (None, Some(k)) => Place::Discrete(k),
        (None, None) => Place::Nowhere,
    }
}
