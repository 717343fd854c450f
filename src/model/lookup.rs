//! `table(file, column, e)`: a column of a data file against the file's first, linear between rows, constant outside.
//!
//! It becomes a choice among the pieces, a tree of `if e < knot`: so each knot is a kink where a flow reads it, and exact rows
//! give their exact values. Which units the columns have is not known: the numbers are not checked.

use super::context::{Context, Home, Scope, Value};
use super::error::{FileError, LimitError, TableError, TypeError};
use super::ir::ExprId;
use super::suggest::closest;
use super::table::{self, Wanted};
use super::types::{Quantity, Slot, Ty};
use crate::base::{FileId, Span};
use crate::math::Op;
use crate::syntax::ast;

/// What a table becomes: its knots, and the values there.
struct Pieces {
    at: Vec<f64>,
    values: Vec<f64>,
    argument: ExprId,
    span: Span,
}

impl<'a> Context<'a> {
    /// The value of a call of `table`.
    pub fn lower_table(&mut self, scope: &mut Scope<'a>, args: &'a [ast::Expr], span: Span) -> Value {
        if !self.check_count("table", 3, 3, args.len(), span) {
            return self.wrong(span);
        }
        let argument = self.lower_number(scope, &args[2], "table");
        let file = self.open_file(&args[0]);
        let column = self.text_or_report(&args[1], "the name of a column");
        let (Some(file), Some(column)) = (file, column) else { return self.wrong(span) };
        let Some([at, values]) = self.columns(file, &column, args[1].span, span) else {
            return self.wrong(span);
        };
        if argument.ty == Ty::Wrong {
            return self.wrong(span);
        }
        let pieces = Pieces { at, values, argument: argument.id, span };
        self.choose_piece(&pieces, 0, pieces.at.len())
    }

    /// The first column and another one, SI as they are written; the first one rises.
    fn columns(&mut self, file: FileId, column: &str, named: Span, span: Span) -> Option<[Vec<f64>; 2]> {
        let text = &self.sources.file(file).text;
        let header = table::read_header(file, text);
        let header = header.map_err(|error| self.diagnostics.push(error.into())).ok()?;
        let Some(number) = header.columns.iter().position(|(name, _)| name == column) else {
            let similar = closest(column, header.columns.iter().map(|(name, _)| name.as_str()));
            let (name, file) = (column.to_string(), self.sources.file(file).name.clone());
            self.report(TableError::NoColumn { name, file, span: named, similar });
            return None;
        };
        let most = self.model.limits.table_rows_max;
        let wanted = [0, number].map(|column| Wanted { column, slot: Slot::plain(Ty::Real) });
        let rows = table::read_rows(file, text, &header, &wanted, most.saturating_add(1));
        let rows = match rows {
            Ok(rows) => rows,
            Err(errors) => {
                errors.into_iter().for_each(|error: FileError| self.report(error));
                return None;
            }
        };
        if rows.count == 0 {
            self.report(TableError::NoRows { span: rows.last, used: span });
            return None;
        }
        if rows.count > most {
            self.report(LimitError::TableRows { most, span });
            return None;
        }
        let [at, values]: [Vec<f64>; 2] = rows.values.try_into().expect("two columns were wanted");
        if let Some(row) = (1..at.len()).find(|&row| at[row] <= at[row - 1]) {
            let text = &self.sources.file(file).text;
            let [first, here] = [row - 1, row].map(|row| table::cell(file, text, row, 0));
            self.report(TableError::NotRising { span: here, first, used: span });
            return None;
        }
        Some([at, values])
    }

    /// The file that an expression names, opened once.
    pub fn open_file(&mut self, path: &'a ast::Expr) -> Option<FileId> {
        let name = self.text_or_report(path, "the name of a file")?;
        if let Some(&file) = self.opened.get(&name) {
            return Some(file);
        }
        let opened = match self.files.read(&name) {
            Ok(bytes) => table::add_text(self.sources, &name, bytes),
            Err(error) => {
                Err(FileError::Unreadable { path: name.clone(), why: table::reason(&error), span: path.span })
            }
        };
        let file = opened.map_err(|error| self.diagnostics.push(error.into())).ok()?;
        self.opened.insert(name, file);
        Some(file)
    }

    /// A text, or a diagnostic.
    fn text_or_report(&mut self, expr: &'a ast::Expr, what: &str) -> Option<String> {
        let text = self.text_of(expr);
        if text.is_none() {
            let errors = self.diagnostics.len();
            let value = self.lower(&mut Scope::of(Home::File), expr);
            if self.diagnostics.len() == errors && value.ty != Ty::Text {
                let found = self.describe(value.ty);
                let (what, expected) = (what.to_string(), "a text".to_string());
                self.report(TypeError::Mismatch { what, expected, found, span: expr.span, help: None });
            }
        }
        text
    }

    /// The choice among the pieces `first..=last`; piece k lies before knot k.
    fn choose_piece(&mut self, pieces: &Pieces, first: usize, last: usize) -> Value {
        if first == last {
            return self.piece(pieces, first);
        }
        let middle = first + (last - first) / 2;
        let before = self.choose_piece(pieces, first, middle);
        let after = self.choose_piece(pieces, middle + 1, last);
        let knot = self.unchecked(pieces.at[middle], pieces.span);
        let condition = self.apply(Op::Lt, [pieces.argument, knot.id], Ty::Bool, pieces.span);
        self.apply(Op::Select, [condition.id, before.id, after.id], Ty::Real, pieces.span)
    }

    /// The line before knot k: `y + s (e - x)` from the knot before it; constant outside.
    fn piece(&mut self, pieces: &Pieces, k: usize) -> Value {
        let span = pieces.span;
        let from = k.saturating_sub(1);
        let value = self.unchecked(pieces.values[from], span);
        if k == 0 || k == pieces.at.len() || pieces.values[k] == pieces.values[from] {
            return value;
        }
        let slope = (pieces.values[k] - pieces.values[from]) / (pieces.at[k] - pieces.at[from]);
        let (slope, knot) = (self.unchecked(slope, span), self.unchecked(pieces.at[from], span));
        let away = self.apply(Op::Sub, [pieces.argument, knot.id], Ty::Real, span);
        let rise = self.apply(Op::Mul, [slope.id, away.id], Ty::Real, span);
        self.apply(Op::Add, [value.id, rise.id], Ty::Real, span)
    }

    /// A number of a file, whose unit is not known.
    fn unchecked(&mut self, value: f64, span: Span) -> Value {
        let number = self.number(value, Ty::Real, span);
        self.quantities.insert(number.id, Quantity::Unchecked);
        number
    }
}
