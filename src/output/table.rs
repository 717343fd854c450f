//! One table, written row by row, in the form that the name of its file asks for.

use std::io::{self, Write};

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
        Ok(Self { name, form })
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

    /// Ends the row.
    #[inline]
    pub(super) fn end_row(&mut self) -> io::Result<()> {
        let done = match &mut self.form {
            Form::Text(table) => table.end_row(),
            Form::Columns(table) => table.end_row(),
        };
        done.map_err(|error| unwritten(&self.name, &error))
    }

    /// Hands on the rows so far, as far as the form allows before the end.
    pub(super) fn flush(&mut self) -> io::Result<()> {
        let done = match &mut self.form {
            Form::Text(table) => table.flush(),
            Form::Columns(table) => table.flush(),
        };
        done.map_err(|error| unwritten(&self.name, &error))
    }

    /// Hands on all rows, and the end of the table.
    pub(super) fn finish(&mut self) -> io::Result<()> {
        let done = match &mut self.form {
            Form::Text(table) => table.flush(),
            Form::Columns(table) => table.finish(),
        };
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
