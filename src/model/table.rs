//! Data files: CSV text to columns of numbers, every problem with its place in the file.

use super::error::FileError;
use super::types::{Slot, Ty};
use crate::base::{FileId, Span};

/// The header line of a data file.
pub(super) struct Header {
    /// Names of the columns with their places.
    pub columns: Vec<(String, Span)>,
}

/// A column that is wanted: its number, and what its cells go into.
pub(super) struct Wanted {
    /// From 0.
    pub column: usize,
    /// Type and unit of the variable.
    pub slot: Slot,
}

/// The rows of a data file, as far as they are needed.
pub(super) struct Rows {
    /// How many rows were read.
    pub count: usize,
    /// For each wanted column, its values, SI.
    pub values: Vec<Vec<f64>>,
    /// The last row, or the header if there is none.
    pub last: Span,
}

fn reader(text: &str) -> csv::Reader<&[u8]> {
    csv::ReaderBuilder::new().has_headers(false).flexible(true).from_reader(text.as_bytes())
}

fn malformed(file: FileId, error: &csv::Error) -> FileError {
    let at = error.position().map_or(0, |position| position.byte() as usize);
    FileError::Malformed { why: error.to_string(), span: Span::new(file, at, at) }
}

/// Reads the header line.
pub(super) fn read_header(file: FileId, text: &str) -> Result<Header, FileError> {
    let mut record = csv::StringRecord::new();
    let more = reader(text).read_record(&mut record).map_err(|error| malformed(file, &error))?;
    if !more {
        return Err(FileError::Malformed { why: "it is empty".to_string(), span: Span::new(file, 0, 0) });
    }
    let start = record_start(&record);
    let mut columns: Vec<(String, Span)> = Vec::new();
    for (number, name) in record.iter().enumerate() {
        let name = name.trim_start_matches('\u{feff}').trim();
        let span = cell_span(file, text, start, number);
        if !name.is_empty() && columns.iter().any(|(other, _)| other == name) {
            return Err(FileError::Malformed { why: format!("two columns are called `{name}`"), span });
        }
        columns.push((name.to_string(), span));
    }
    Ok(Header { columns })
}

/// Reads the wanted columns of the first `most` rows.
pub(super) fn read_rows(
    file: FileId,
    text: &str,
    header: &Header,
    wanted: &[Wanted],
    most: usize,
) -> Result<Rows, FileError> {
    let mut reader = reader(text);
    let mut record = csv::StringRecord::new();
    reader.read_record(&mut record).map_err(|error| malformed(file, &error))?;
    let mut last = record_span(file, text, record_start(&record));
    let mut values = wanted.iter().map(|_| Vec::new()).collect::<Vec<_>>();
    let mut count = 0;
    while count < most && reader.read_record(&mut record).map_err(|error| malformed(file, &error))? {
        let start = record_start(&record);
        if record.len() > header.columns.len() {
            let why =
                format!("a row has {} cells, and the header names {}", record.len(), header.columns.len());
            return Err(FileError::Malformed {
                why,
                span: cell_span(file, text, start, header.columns.len()),
            });
        }
        for (column, wanted) in values.iter_mut().zip(wanted) {
            let text_of_cell = record.get(wanted.column).map(str::trim).filter(|cell| !cell.is_empty());
            let value = text_of_cell.and_then(|cell| read_cell(cell, wanted.slot));
            let Some(value) = value else {
                return Err(FileError::BadCell {
                    column: header.columns[wanted.column].0.clone(),
                    expected: expected(wanted.slot.ty),
                    found: text_of_cell.map(str::to_string),
                    span: cell_span(file, text, start, wanted.column),
                });
            };
            column.push(value);
        }
        last = record_span(file, text, start);
        count += 1;
    }
    Ok(Rows { count, values, last })
}

fn expected(ty: Ty) -> &'static str {
    match ty {
        Ty::Int => "a whole number",
        Ty::Bool => "`true` or `false`",
        Ty::Real | Ty::Text | Ty::Agent(_) | Ty::Link(_) | Ty::Nobody | Ty::Wrong => "a number",
    }
}

fn read_cell(cell: &str, slot: Slot) -> Option<f64> {
    match slot.ty {
        Ty::Bool => match cell {
            "true" | "1" => Some(1.0),
            "false" | "0" => Some(0.0),
            _ => None,
        },
        Ty::Int => cell.parse::<f64>().ok().filter(|value| value.is_finite() && value.fract() == 0.0),
        Ty::Real | Ty::Text | Ty::Agent(_) | Ty::Link(_) | Ty::Nobody | Ty::Wrong => {
            cell.parse::<f64>().ok().map(|value| slot.scale().to_si(value)).filter(|value| value.is_finite())
        }
    }
}

fn record_start(record: &csv::StringRecord) -> usize {
    record.position().map_or(0, |position| position.byte() as usize)
}

/// The bytes of the cell with this number in the record that begins at `start`; its end, if the record is shorter.
fn cell_span(file: FileId, text: &str, start: usize, number: usize) -> Span {
    let start = skip_line_ends(text, start);
    let bytes = text.as_bytes();
    let (mut cell, mut begin, mut quoted, mut at) = (0, start, false, start);
    while at < bytes.len() {
        match bytes[at] {
            b'"' => quoted = !quoted,
            b',' if !quoted => {
                if cell == number {
                    break;
                }
                cell += 1;
                begin = at + 1;
            }
            b'\n' | b'\r' if !quoted => break,
            _ => {}
        }
        at += 1;
    }
    if cell < number { Span::new(file, at, at) } else { Span::new(file, begin, at) }
}

/// The reader counts the end of the line before to the record.
fn skip_line_ends(text: &str, start: usize) -> usize {
    let rest = text.get(start..).unwrap_or("");
    start + (rest.len() - rest.trim_start_matches(['\n', '\r']).len())
}

fn record_span(file: FileId, text: &str, start: usize) -> Span {
    let start = skip_line_ends(text, start);
    let length = text
        .get(start..)
        .and_then(|rest| rest.find(['\n', '\r']))
        .unwrap_or(text.len().saturating_sub(start));
    Span::new(file, start, start + length)
}
