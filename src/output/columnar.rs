//! A table by columns: Arrow IPC, as a stream or as a file, and Parquet. Rows are gathered in batches.
//!
//! An empty cell is null. Whoever kills the run between two batches finds those before in the stream.

use std::io::{self, Write};
use std::sync::Arc;

use arrow_array::builder::{ArrayBuilder, BooleanBuilder, Float64Builder, StringBuilder, UInt32Builder};
use arrow_array::{ArrayRef, RecordBatch};
use arrow_ipc::writer::{FileWriter, StreamWriter};
use arrow_schema::{ArrowError, DataType, Field, Schema, SchemaRef};
use parquet::arrow::ArrowWriter;
use parquet::basic::Compression;
use parquet::file::properties::WriterProperties;

use super::columns::{Column, Kind};

/// Rows of a batch.
const BATCH: usize = 1 << 15;
/// Rows of a row group of Parquet, which is held in memory until it is whole.
const ROW_GROUP: usize = 1 << 18;

/// The form in which batches are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Layout {
    /// Arrow IPC, the form that is read from its begin on.
    Stream,
    /// Arrow IPC, the form with an index at its end.
    File,
    /// Parquet.
    Parquet,
}

type Place = Box<dyn Write + Send>;

enum Writer {
    Stream(StreamWriter<Place>),
    File(FileWriter<Place>),
    Parquet(ArrowWriter<Place>),
}

/// A batch that grows, and where the batches go.
pub(super) struct Columnar {
    schema: SchemaRef,
    writer: Option<Writer>,
    cells: Vec<Cells>,
    /// The column of the next cell.
    next: usize,
    rows: usize,
}

enum Cells {
    Number(Float64Builder),
    Count(UInt32Builder),
    Bool(BooleanBuilder),
    Text(StringBuilder),
}

impl Columnar {
    /// A table without rows. Fails if what stands before them cannot be written.
    pub(super) fn new(layout: Layout, place: Place, columns: &[Column]) -> io::Result<Self> {
        let fields = columns.iter().map(|column| Field::new(&column.name, type_of(column.kind), true));
        let schema = Arc::new(Schema::new(fields.collect::<Vec<_>>()));
        let writer = match layout {
            Layout::Stream => StreamWriter::try_new(place, &schema).map(Writer::Stream).map_err(failed)?,
            Layout::File => FileWriter::try_new(place, &schema).map(Writer::File).map_err(failed)?,
            Layout::Parquet => {
                let settings = WriterProperties::builder()
                    .set_compression(Compression::SNAPPY)
                    .set_max_row_group_row_count(Some(ROW_GROUP))
                    .build();
                let writer = ArrowWriter::try_new(place, schema.clone(), Some(settings));
                writer.map(Writer::Parquet).map_err(|error| failed(error.into()))?
            }
        };
        let cells = columns.iter().map(|column| Cells::new(column.kind)).collect();
        Ok(Self { schema, writer: Some(writer), cells, next: 0, rows: 0 })
    }

    pub(super) fn empty(&mut self) {
        match self.cell() {
            Cells::Number(cells) => cells.append_null(),
            Cells::Count(cells) => cells.append_null(),
            Cells::Bool(cells) => cells.append_null(),
            Cells::Text(cells) => cells.append_null(),
        }
    }

    pub(super) fn text(&mut self, text: &str) {
        match self.cell() {
            Cells::Text(cells) => cells.append_value(text),
            Cells::Number(_) | Cells::Count(_) | Cells::Bool(_) => unreachable!("the column holds no text"),
        }
    }

    pub(super) fn number(&mut self, value: f64) {
        match self.cell() {
            Cells::Number(cells) => cells.append_value(value),
            Cells::Text(cells) => cells.append_value(crate::base::number_text(value)),
            Cells::Count(_) | Cells::Bool(_) => unreachable!("the column holds no numbers"),
        }
    }

    pub(super) fn count(&mut self, value: usize) {
        match self.cell() {
            Cells::Count(cells) => cells.append_value(u32::try_from(value).unwrap_or(u32::MAX)),
            Cells::Number(_) | Cells::Bool(_) | Cells::Text(_) => unreachable!("the column holds no counts"),
        }
    }

    pub(super) fn boolean(&mut self, value: bool) {
        match self.cell() {
            Cells::Bool(cells) => cells.append_value(value),
            Cells::Text(cells) => cells.append_value(if value { "true" } else { "false" }),
            Cells::Number(_) | Cells::Count(_) => unreachable!("the column holds no truth values"),
        }
    }

    /// The row ends; whether the batch is full, and to be written.
    pub(super) fn end_row(&mut self) -> bool {
        self.next = 0;
        self.rows += 1;
        self.rows >= BATCH
    }

    /// Writes the rows so far, as far as the form allows without the end.
    pub(super) fn flush(&mut self) -> io::Result<()> {
        if matches!(self.writer, Some(Writer::Stream(_) | Writer::File(_))) {
            self.write_batch()?;
        }
        match &mut self.writer {
            Some(Writer::Stream(writer)) => writer.flush().map_err(failed),
            Some(Writer::File(writer)) => writer.flush().map_err(failed),
            Some(Writer::Parquet(_)) | None => Ok(()),
        }
    }

    /// Writes the last rows and the end.
    pub(super) fn finish(&mut self) -> io::Result<()> {
        self.write_batch()?;
        match self.writer.take() {
            Some(Writer::Stream(writer)) => writer.into_inner().map_err(failed)?.flush(),
            Some(Writer::File(writer)) => writer.into_inner().map_err(failed)?.flush(),
            Some(Writer::Parquet(writer)) => {
                writer.into_inner().map_err(|error| failed(error.into()))?.flush()
            }
            None => Ok(()),
        }
    }

    fn cell(&mut self) -> &mut Cells {
        self.next += 1;
        &mut self.cells[self.next - 1]
    }

    /// Writes the rows that have come together.
    pub(super) fn write_batch(&mut self) -> io::Result<()> {
        if std::mem::take(&mut self.rows) == 0 {
            return Ok(());
        }
        let arrays = self.cells.iter_mut().map(Cells::finish).collect();
        let batch = RecordBatch::try_new(self.schema.clone(), arrays).map_err(failed)?;
        match &mut self.writer {
            Some(Writer::Stream(writer)) => writer.write(&batch).map_err(failed),
            Some(Writer::File(writer)) => writer.write(&batch).map_err(failed),
            Some(Writer::Parquet(writer)) => writer.write(&batch).map_err(|error| failed(error.into())),
            None => Ok(()),
        }
    }
}

impl Cells {
    fn new(kind: Kind) -> Self {
        match kind {
            Kind::Number => Self::Number(Float64Builder::with_capacity(BATCH)),
            Kind::Count => Self::Count(UInt32Builder::with_capacity(BATCH)),
            Kind::Bool => Self::Bool(BooleanBuilder::with_capacity(BATCH)),
            Kind::Text => Self::Text(StringBuilder::with_capacity(BATCH, 8 * BATCH)),
        }
    }

    fn finish(&mut self) -> ArrayRef {
        match self {
            Self::Number(cells) => ArrayBuilder::finish(cells),
            Self::Count(cells) => ArrayBuilder::finish(cells),
            Self::Bool(cells) => ArrayBuilder::finish(cells),
            Self::Text(cells) => ArrayBuilder::finish(cells),
        }
    }
}

fn type_of(kind: Kind) -> DataType {
    match kind {
        Kind::Number => DataType::Float64,
        Kind::Count => DataType::UInt32,
        Kind::Bool => DataType::Boolean,
        Kind::Text => DataType::Utf8,
    }
}

/// The failure of the place written to, where the library wraps one.
fn failed(error: ArrowError) -> io::Error {
    match error {
        ArrowError::IoError(_, error) => error,
        ArrowError::ExternalError(inner) => match inner.downcast::<io::Error>() {
            Ok(error) => *error,
            Err(other) => io::Error::other(other.to_string()),
        },
        other => io::Error::other(other.to_string()),
    }
}
