//! A table as CSV: comma, a header line, LF, quotes only where they are needed (RFC 4180).

use std::io::{self, Write};

use super::columns::Column;
use crate::base::append_number;

/// Rows are handed on when so many bytes have come together.
const ROOM: usize = 1 << 16;

/// Rows as bytes, with the last of them not handed on yet.
pub(super) struct CommaSeparated {
    writer: Box<dyn Write + Send>,
    bytes: Vec<u8>,
    /// Where the row begins that is being written.
    row: usize,
}

impl CommaSeparated {
    /// A table with its header line.
    pub(super) fn new(writer: Box<dyn Write + Send>, columns: &[Column]) -> Self {
        let mut table = Self { writer, bytes: Vec::with_capacity(ROOM + ROOM / 8), row: 0 };
        for column in columns {
            table.text(&column.name);
        }
        table.bytes.push(b'\n');
        table.row = table.bytes.len();
        table
    }

    pub(super) fn text(&mut self, text: &str) {
        self.separate();
        let bytes = text.as_bytes();
        if !bytes.iter().any(|byte| matches!(byte, b',' | b'"' | b'\n' | b'\r')) {
            self.bytes.extend_from_slice(bytes);
            return;
        }
        self.bytes.push(b'"');
        for &byte in bytes {
            if byte == b'"' {
                self.bytes.push(b'"');
            }
            self.bytes.push(byte);
        }
        self.bytes.push(b'"');
    }

    pub(super) fn number(&mut self, value: f64) {
        self.separate();
        append_number(&mut self.bytes, value);
    }

    pub(super) fn count(&mut self, value: usize) {
        self.separate();
        if value < 10 {
            self.bytes.push(b'0' + value as u8);
        } else {
            write!(self.bytes, "{value}").expect("writing to memory cannot fail");
        }
    }

    /// The row ends; whether so many have come together that they are to be handed on.
    pub(super) fn end_row(&mut self) -> bool {
        self.bytes.push(b'\n');
        self.row = self.bytes.len();
        self.row >= ROOM
    }

    pub(super) fn flush(&mut self) -> io::Result<()> {
        self.hand_on()?;
        self.writer.flush()
    }

    /// Hands on the rows that are whole.
    pub(super) fn hand_on(&mut self) -> io::Result<()> {
        self.writer.write_all(&self.bytes[..self.row])?;
        self.bytes.drain(..self.row);
        self.row = 0;
        Ok(())
    }

    /// A comma before every cell but the first of a row.
    fn separate(&mut self) {
        if self.bytes.len() > self.row {
            self.bytes.push(b',');
        }
    }
}
