//! One table, written row by row, in the form that the name of its file asks for.

use std::io::{self, Write};
use std::time::{Duration, Instant};

use super::columnar::{Columnar, Layout};
use super::columns::Column;
use super::comma_separated::CommaSeparated;

/// The name of what is no file.
pub const STANDARD_OUTPUT: &str = "standard output";

/// A place to write to, with the name that messages give it.
pub struct Sink {
    /// `events.csv`, or [`STANDARD_OUTPUT`]. What stands behind the last dot says the form of a table.
    pub name: String,
    /// Where the bytes go; buffered here, so it need not be.
    pub writer: Box<dyn Write + Send>,
}

/// The same failure, with the name of what could not be written.
pub fn unwritten(name: &str, error: &io::Error) -> io::Error {
    let shown = if name == STANDARD_OUTPUT { name.to_string() } else { format!("`{name}`") };
    io::Error::new(error.kind(), format!("cannot write {shown}: {error}"))
}

/// A table that grows by rows; each cell is written in its turn.
pub(super) struct Table {
    name: String,
    form: Form,
    /// How long it took to hand on rows.
    handing: Duration,
}

enum Form {
    Text(CommaSeparated),
    Columns(Box<Columnar>),
}

impl Table {
    /// A table with these columns.
    pub(super) fn new(sink: Sink, columns: &[Column]) -> io::Result<Self> {
        let Sink { name, writer } = sink;
        let form = match layout_of(&name) {
            None => Ok(Form::Text(CommaSeparated::new(writer, columns))),
            Some(layout) => {
                Columnar::new(layout, writer, columns).map(|table| Form::Columns(Box::new(table)))
            }
        };
        let form = form.map_err(|error| unwritten(&name, &error))?;
        Ok(Self { name, form, handing: Duration::ZERO })
    }

    /// A cell without a value.
    #[inline]
    pub(super) fn empty(&mut self) {
        match &mut self.form {
            Form::Text(table) => table.text(""),
            Form::Columns(table) => table.empty(),
        }
    }

    /// A cell of text.
    #[inline]
    pub(super) fn text(&mut self, text: &str) {
        match &mut self.form {
            Form::Text(table) => table.text(text),
            Form::Columns(table) => table.text(text),
        }
    }

    /// A cell with a number.
    #[inline]
    pub(super) fn number(&mut self, value: f64) {
        match &mut self.form {
            Form::Text(table) => table.number(value),
            Form::Columns(table) => table.number(value),
        }
    }

    /// A cell with a whole number.
    #[inline]
    pub(super) fn count(&mut self, value: usize) {
        match &mut self.form {
            Form::Text(table) => table.count(value),
            Form::Columns(table) => table.count(value),
        }
    }

    /// A cell that is true or false.
    #[inline]
    pub(super) fn boolean(&mut self, value: bool) {
        match &mut self.form {
            Form::Text(table) => table.text(if value { "true" } else { "false" }),
            Form::Columns(table) => table.boolean(value),
        }
    }

    /// Ends the row; those that have come together are handed on, if they are enough.
    #[inline]
    pub(super) fn end_row(&mut self) -> io::Result<()> {
        let is_full = match &mut self.form {
            Form::Text(table) => table.end_row(),
            Form::Columns(table) => table.end_row(),
        };
        if is_full { self.timed(CommaSeparated::hand_on, Columnar::write_batch) } else { Ok(()) }
    }

    /// Hands on the rows so far, as far as the form allows before the end.
    pub(super) fn flush(&mut self) -> io::Result<()> {
        self.timed(CommaSeparated::flush, Columnar::flush)
    }

    /// Hands on all rows, and the end of the table.
    pub(super) fn finish(&mut self) -> io::Result<()> {
        self.timed(CommaSeparated::flush, Columnar::finish)
    }

    /// How long it took to hand on rows.
    pub(super) fn handing(&self) -> Duration {
        self.handing
    }

    fn timed(
        &mut self,
        text: impl FnOnce(&mut CommaSeparated) -> io::Result<()>,
        columns: impl FnOnce(&mut Columnar) -> io::Result<()>,
    ) -> io::Result<()> {
        let begun = Instant::now();
        let done = match &mut self.form {
            Form::Text(table) => text(table),
            Form::Columns(table) => columns(table),
        };
        self.handing += begun.elapsed();
        done.map_err(|error| unwritten(&self.name, &error))
    }
}

/// `.arrow` (and `.feather`, which is the same), `.arrows`, `.parquet`; everything else is text.
fn layout_of(name: &str) -> Option<Layout> {
    match name.rsplit_once('.')?.1.to_ascii_lowercase().as_str() {
        "arrows" => Some(Layout::Stream),
        "arrow" | "feather" => Some(Layout::File),
        "parquet" => Some(Layout::Parquet),
        _ => None,
    }
}
