//! The event log: a row for each transition that fires, in the order of execution.

use std::io;
use std::time::Duration;

use super::cast::Cast;
use super::columns::{Column, Kind};
use super::table::{Sink, Table};
use crate::runtime::observe::Event;

/// `time,micro,transition,agent,other,from,to`
pub(super) struct EventLog {
    table: Table,
}

impl EventLog {
    pub(super) fn new(sink: Sink) -> io::Result<Self> {
        let texts = ["transition", "agent", "other", "from", "to"].map(|name| Column::new(name, Kind::Text));
        let columns = [Column::new("time", Kind::Number), Column::new("micro", Kind::Count)];
        Ok(Self { table: Table::new(sink, &[&columns[..], &texts].concat())? })
    }

    pub(super) fn event(&mut self, cast: &Cast, event: &Event<'_>) -> io::Result<()> {
        self.table.number(event.time);
        self.table.count(event.micro);
        self.table.text(event.transition);
        self.table.text(&cast.agent(event.agent));
        match event.other {
            Some(other) => self.table.text(&cast.agent(other)),
            None => self.table.empty(),
        }
        match event.modes {
            Some((from, to)) => {
                self.table.text(from);
                self.table.text(to);
            }
            None => {
                self.table.empty();
                self.table.empty();
            }
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
