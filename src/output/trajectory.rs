//! A trajectory: the recorded variables of some agents over time.

use std::io;
use std::time::Duration;

use super::cast::Cast;
use super::columns::{Column, Kind};
use super::table::{Sink, Table};
use crate::runtime::observe::{Cell, Row};

/// `time,micro,agent,mode,` and a column for each recorded variable.
pub(super) struct Trajectory {
    table: Table,
}

impl Trajectory {
    pub(super) fn new(sink: Sink, columns: &[Column]) -> io::Result<Self> {
        let fixed =
            [("time", Kind::Number), ("micro", Kind::Count), ("agent", Kind::Text), ("mode", Kind::Text)];
        let fixed = fixed.map(|(name, kind)| Column::new(name, kind));
        Ok(Self { table: Table::new(sink, &[&fixed[..], columns].concat())? })
    }

    pub(super) fn sample(&mut self, cast: &Cast, row: &Row<'_>) -> io::Result<()> {
        self.table.number(row.time);
        self.table.count(row.micro);
        self.table.text(&cast.agent(row.agent));
        self.table.text(row.mode);
        for &cell in row.cells {
            write_cell(&mut self.table, cast, cell);
        }
        self.table.end_row()
    }

    pub(super) fn flush(&mut self) -> io::Result<()> {
        self.table.flush()
    }

    /// How long it took to hand on rows.
    pub(super) fn handing(&self) -> Duration {
        self.table.handing()
    }

    pub(super) fn finish(&mut self) -> io::Result<()> {
        self.table.finish()
    }
}

/// One value: nothing, a number, `true` or `false`, the path of an agent or `none`.
pub(super) fn write_cell(table: &mut Table, cast: &Cast, cell: Cell) {
    match cell {
        Cell::Empty => table.empty(),
        Cell::Number(value) => table.number(value),
        Cell::Bool(value) => table.boolean(value),
        Cell::Agent(Some(agent)) => table.text(&cast.agent(agent)),
        Cell::Agent(None) => table.text("none"),
    }
}
