//! The event log: a row for each transition that fires, in the order of execution.

use std::io;

use super::cast::Cast;
use super::table::{Sink, Table};
use crate::runtime::observe::Event;

/// `time,micro,transition,agent,other,from,to`
pub(super) struct EventLog {
    table: Table,
}

impl EventLog {
    pub(super) fn new(sink: Sink) -> io::Result<Self> {
        let header = ["time", "micro", "transition", "agent", "other", "from", "to"];
        Ok(Self { table: Table::new(sink, header)? })
    }

    pub(super) fn event(&mut self, cast: &Cast, event: &Event<'_>) -> io::Result<()> {
        let (from, to) = event.modes.unwrap_or(("", ""));
        self.table.number(event.time)?;
        self.table.count(event.micro)?;
        self.table.text(event.transition)?;
        self.table.text(&cast.agent(event.agent))?;
        match event.other {
            Some(other) => self.table.text(&cast.agent(other))?,
            None => self.table.text("")?,
        }
        self.table.text(from)?;
        self.table.text(to)?;
        self.table.end_row()
    }

    pub(super) fn flush(&mut self) -> io::Result<()> {
        self.table.flush()
    }
}
