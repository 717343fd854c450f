//! One CSV table, written row by row: comma, a header line, LF, quotes only where they are needed.

use crate::base::write_number;
use std::io::{self, BufWriter, Write};

/// A place to write to, with the name that messages give it.
pub struct Sink {
    /// `events.csv`, `standard output`.
    pub name: String,
    /// Where the bytes go; buffered here, so it need not be.
    pub writer: Box<dyn Write>,
}

/// A table that grows by rows; each cell is written in its turn.
pub(super) struct Table {
    name: String,
    writer: csv::Writer<BufWriter<Box<dyn Write>>>,
    scratch: String,
}

impl Table {
    /// A table with its header line.
    pub(super) fn new<'a>(sink: Sink, header: impl IntoIterator<Item = &'a str>) -> io::Result<Self> {
        let writer = csv::WriterBuilder::new()
            .terminator(csv::Terminator::Any(b'\n'))
            .from_writer(BufWriter::with_capacity(1 << 16, sink.writer));
        let mut table = Self { name: sink.name, writer, scratch: String::new() };
        for name in header {
            table.text(name)?;
        }
        table.end_row()?;
        Ok(table)
    }

    /// A cell of text.
    pub(super) fn text(&mut self, text: &str) -> io::Result<()> {
        self.writer.write_field(text).map_err(|error| named(&self.name, unwrapped(error)))
    }

    /// A cell with a number.
    pub(super) fn number(&mut self, value: f64) -> io::Result<()> {
        self.scratch.clear();
        write_number(&mut self.scratch, value);
        self.writer.write_field(&self.scratch).map_err(|error| named(&self.name, unwrapped(error)))
    }

    /// A cell with a whole number.
    pub(super) fn count(&mut self, value: usize) -> io::Result<()> {
        self.text(&value.to_string())
    }

    /// Ends the row.
    pub(super) fn end_row(&mut self) -> io::Result<()> {
        let none: Option<&[u8]> = None;
        self.writer.write_record(none).map_err(|error| named(&self.name, unwrapped(error)))
    }

    /// Hands on all that has been written so far.
    pub(super) fn flush(&mut self) -> io::Result<()> {
        self.writer.flush().map_err(|error| named(&self.name, error))
    }
}

/// The failure of the place written to; rows of unequal length are the only other failure of the library.
fn unwrapped(error: csv::Error) -> io::Error {
    match error.into_kind() {
        csv::ErrorKind::Io(error) => error,
        other => io::Error::other(format!("{other:?}")),
    }
}

/// The same failure, with the name of what could not be written.
fn named(name: &str, error: io::Error) -> io::Error {
    io::Error::new(error.kind(), format!("cannot write `{name}`: {error}"))
}
