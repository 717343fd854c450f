//! Data files: CSV text to columns of numbers, every problem with its place in the file.

use super::error::FileError;
use super::types::{Slot, Ty};
use crate::base::{FileId, SourceMap, Span};

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

/// How many characters of a wrong cell are shown.
const SHOWN_MAX: usize = 40;

/// How many problems of one file are told.
const PROBLEMS_MAX: usize = 5;

/// The rows of a data file, as far as they are needed.
pub(super) struct Rows {
    /// How many rows were read.
    pub count: usize,
    /// For each wanted column, its values, SI.
    pub values: Vec<Vec<f64>>,
    /// The last row, or the header if there is none.
    pub last: Span,
}

/// Why a file cannot be read, in the same words everywhere.
pub(super) fn reason(error: &std::io::Error) -> String {
    match error.kind() {
        std::io::ErrorKind::NotFound => "there is no such file".to_string(),
        _ => error.to_string(),
    }
}

fn reader(text: &str) -> csv::Reader<&[u8]> {
    csv::ReaderBuilder::new().has_headers(false).flexible(true).from_reader(text.as_bytes())
}

fn malformed(file: FileId, error: &csv::Error) -> FileError {
    let at = error.position().map_or(0, |position| position.byte() as usize);
    FileError::Malformed { why: error.to_string(), span: Span::new(file, at, at) }
}

/// The text of a data file; where it is not UTF-8, the file is added as far as it can be shown.
pub(super) fn add_text(sources: &mut SourceMap, name: &str, bytes: Vec<u8>) -> Result<FileId, FileError> {
    match String::from_utf8(bytes) {
        Ok(text) => Ok(sources.add(name, text)),
        Err(error) => {
            let at = error.utf8_error().valid_up_to();
            let file = sources.add(name, String::from_utf8_lossy(error.as_bytes()));
            let why = "it is not text in UTF-8".to_string();
            Err(FileError::Malformed { why, span: Span::new(file, at, at + '\u{fffd}'.len_utf8()) })
        }
    }
}

/// The place of a quote that is never closed.
fn open_quote(text: &str) -> Option<usize> {
    let quotes = text.bytes().enumerate().filter(|(_, byte)| *byte == b'"').map(|(at, _)| at);
    let (count, last) = quotes.fold((0usize, 0), |(count, _), at| (count + 1, at));
    (count % 2 == 1).then_some(last)
}

/// Reads the header line.
pub(super) fn read_header(file: FileId, text: &str) -> Result<Header, FileError> {
    if let Some(at) = open_quote(text) {
        let why = "a quote is never closed".to_string();
        return Err(FileError::Malformed { why, span: Span::new(file, at, at + 1) });
    }
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
        let counts = !name.is_empty() && !name.starts_with('_');
        let first = columns.iter().find(|(other, _)| counts && other == name);
        if let Some(&(_, first)) = first {
            return Err(FileError::ColumnTwice { name: name.to_string(), span, first });
        }
        columns.push((name.to_string(), span));
    }
    Ok(Header { columns })
}

/// Reads the wanted columns of the first `most` rows. All that is wrong, up to a limit.
pub(super) fn read_rows(
    file: FileId,
    text: &str,
    header: &Header,
    wanted: &[Wanted],
    most: usize,
) -> Result<Rows, Vec<FileError>> {
    let mut reader = reader(text);
    let mut record = csv::StringRecord::new();
    let mut next = |record: &mut csv::StringRecord| {
        reader.read_record(record).map_err(|error| vec![malformed(file, &error)])
    };
    next(&mut record)?;
    let mut problems = Vec::new();
    let mut last = record_start(&record);
    let mut values = wanted.iter().map(|_| Vec::new()).collect::<Vec<_>>();
    let mut count = 0;
    while count < most && problems.len() < PROBLEMS_MAX && next(&mut record)? {
        let start = record_start(&record);
        let (found, named) = (record.len(), header.columns.len());
        if found != named {
            let span = match found > named {
                true => cell_span(file, text, start, named),
                false => record_span(file, text, start),
            };
            problems.push(FileError::Ragged { found, named, span });
        } else {
            for (column, wanted) in values.iter_mut().zip(wanted) {
                match read_cell(record.get(wanted.column).unwrap_or("").trim(), wanted.slot) {
                    Ok(value) => column.push(value),
                    Err(found) => problems.push(FileError::BadCell {
                        column: header.columns[wanted.column].0.clone(),
                        expected: expected(wanted.slot.ty),
                        found,
                        span: cell_span(file, text, start, wanted.column),
                    }),
                }
            }
        }
        last = start;
        count += 1;
    }
    problems.truncate(PROBLEMS_MAX);
    let last = record_span(file, text, last);
    if problems.is_empty() { Ok(Rows { count, values, last }) } else { Err(problems) }
}

fn expected(ty: Ty) -> &'static str {
    match ty {
        Ty::Int => "a whole number",
        Ty::Bool => "`true` (1) or `false` (0)",
        Ty::Real | Ty::Text | Ty::Agent(_) | Ty::Link(_) | Ty::Nobody | Ty::List(_) | Ty::Wrong => "a number",
    }
}

/// The place of a cell, by its row (from 0, without the header) and column.
pub(super) fn cell(file: FileId, text: &str, row: usize, column: usize) -> Span {
    let mut reader = reader(text);
    let mut record = csv::StringRecord::new();
    for _ in 0..row + 2 {
        if !matches!(reader.read_record(&mut record), Ok(true)) {
            break;
        }
    }
    cell_span(file, text, record_start(&record), column)
}

/// The value of a cell, SI; else what is in it, in words.
fn read_cell(cell: &str, slot: Slot) -> Result<f64, String> {
    let shown = || match cell.char_indices().nth(SHOWN_MAX) {
        Some((end, _)) => format!("`{}...`", &cell[..end]),
        None => format!("`{cell}`"),
    };
    if cell.is_empty() {
        return Err("nothing here".to_string());
    }
    let number = cell.parse::<f64>();
    let value = match slot.ty {
        Ty::Bool => match cell {
            "true" | "1" => Some(1.0),
            "false" | "0" => Some(0.0),
            _ => None,
        },
        Ty::Int => number.ok().filter(|value| !value.is_finite() || value.fract() == 0.0),
        Ty::Real | Ty::Text | Ty::Agent(_) | Ty::Link(_) | Ty::Nobody | Ty::List(_) | Ty::Wrong => {
            number.ok().map(|value| slot.scale().to_si(value))
        }
    };
    match value {
        Some(value) if value.is_finite() => Ok(value),
        Some(_) => Err(format!("{} is not finite", shown())),
        None => Err(format!("{} is not", shown())),
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
