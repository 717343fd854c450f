//! `table(file, column, e)`: a column of a data file against the file's first, linear between rows, constant outside; `spline`, a
//! cubic that keeps the shape between rows.
//!
//! Either becomes a choice among the pieces, a tree of `if e < knot`: so each knot is a kink where a flow reads it, and exact rows
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

/// How a table goes from row to row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Shape {
    /// By lines.
    Linear,
    /// By cubics that rise and fall only where the rows do.
    Cubic,
}

/// What a table becomes: its knots, and the values there.
struct Pieces {
    at: Vec<f64>,
    values: Vec<f64>,
    /// The slopes at the knots, of cubics; else none.
    slopes: Vec<f64>,
    argument: ExprId,
    span: Span,
}

impl<'a> Context<'a> {
    /// The value of a call of `table` or `spline`.
    pub fn lower_table(
        &mut self,
        scope: &mut Scope<'a>,
        name: &str,
        args: &'a [ast::Expr],
        span: Span,
    ) -> Value {
        let shape = if name == "spline" { Shape::Cubic } else { Shape::Linear };
        if !self.check_count(name, 3, 3, args.len(), span) {
            return self.wrong(span);
        }
        let argument = self.lower_number(scope, &args[2], name);
        let file = self.open_file(&args[0]);
        let column = self.text_or_report(&args[1], "the name of a column");
        let (Some(file), Some(column)) = (file, column) else { return self.wrong(span) };
        let Some([at, values]) = self.columns(file, &column, args[1].span, span) else {
            return self.wrong(span);
        };
        if argument.ty == Ty::Wrong {
            return self.wrong(span);
        }
        let slopes = match shape {
            Shape::Linear => Vec::new(),
            Shape::Cubic => slopes(&at, &values),
        };
        let pieces = Pieces { at, values, slopes, argument: argument.id, span };
        self.choose_piece(&pieces, 0, pieces.at.len())
    }

    /// The first column and another one, SI as they are written; the first one rises.
    fn columns(&mut self, file: FileId, column: &str, named: Span, span: Span) -> Option<[Vec<f64>; 2]> {
        let text = &self.sources.file(file).text;
        let header = table::read_header(file, text);
        let header = header.map_err(|error| self.findings.push(error.into())).ok()?;
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
        let file = opened.map_err(|error| self.findings.push(error.into())).ok()?;
        self.opened.insert(name, file);
        Some(file)
    }

    /// A text, or a diagnostic.
    fn text_or_report(&mut self, expr: &'a ast::Expr, what: &str) -> Option<String> {
        let text = self.text_of(expr);
        if text.is_none() {
            let errors = self.findings.count();
            let value = self.lower(&mut Scope::of(Home::File), expr);
            if self.findings.count() == errors && value.ty != Ty::Text {
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
        self.split_at(pieces, pieces.at[middle], [before, after])
    }

    /// One value where the argument is less than this, the other from there on.
    fn split_at(&mut self, pieces: &Pieces, at: f64, [before, after]: [Value; 2]) -> Value {
        let at = self.unchecked(at, pieces.span);
        let condition = self.apply(Op::Lt, [pieces.argument, at.id], Ty::Bool, pieces.span);
        self.apply(Op::Select, [condition.id, before.id, after.id], Ty::Real, pieces.span)
    }

    /// The line before knot k: `y + s (e - x)` from the knot before it, of a cubic `y + d (s + d (c2 + d c3))` with d = e - x; constant outside.
    /// Where a cubic comes to rest at knot k, its second half is written from there: so rounding leads neither half beyond its row.
    fn piece(&mut self, pieces: &Pieces, k: usize) -> Value {
        let from = k.saturating_sub(1);
        let before = pieces.powers(k);
        if k == 0 || k == pieces.at.len() || before.iter().all(|&power| power == 0.0) {
            return self.unchecked(pieces.values[from], pieces.span);
        }
        let first = self.polynomial(pieces, from, before);
        if !pieces.rests_at(k) {
            return first;
        }
        let second = self.polynomial(pieces, k, pieces.powers_from_behind(k));
        self.split_at(pieces, 0.5 * pieces.at[from] + 0.5 * pieces.at[k], [first, second])
    }

    /// The value at a knot and powers of the distance from it.
    fn polynomial(&mut self, pieces: &Pieces, knot: usize, powers: Vec<f64>) -> Value {
        let span = pieces.span;
        let [value, place] =
            [pieces.values[knot], pieces.at[knot]].map(|number| self.unchecked(number, span));
        let away = self.apply(Op::Sub, [pieces.argument, place.id], Ty::Real, span);
        // From the highest power down.
        let mut powers = powers.into_iter().rev();
        let mut rise = self.unchecked(powers.next().unwrap_or(0.0), span);
        for power in powers {
            let higher = self.apply(Op::Mul, [rise.id, away.id], Ty::Real, span);
            let power = self.unchecked(power, span);
            rise = self.apply(Op::Add, [power.id, higher.id], Ty::Real, span);
        }
        let rise = self.apply(Op::Mul, [rise.id, away.id], Ty::Real, span);
        self.apply(Op::Add, [value.id, rise.id], Ty::Real, span)
    }

    /// A number of a file, whose unit is not known.
    fn unchecked(&mut self, value: f64, span: Span) -> Value {
        let number = self.number(value, Ty::Real, span);
        self.quantities.insert(number.id, Quantity::Unchecked);
        number
    }
}

impl Pieces {
    /// What stands before the first and the higher powers of the distance from the knot before knot k; nothing outside.
    fn powers(&self, k: usize) -> Vec<f64> {
        if k == 0 || k == self.at.len() {
            return Vec::new();
        }
        let h = self.at[k] - self.at[k - 1];
        let rise = (self.values[k] - self.values[k - 1]) / h;
        match self.slopes.get(k - 1..=k) {
            Some(&[first, last]) => {
                vec![first, (3.0 * rise - 2.0 * first - last) / h, (first + last - 2.0 * rise) / (h * h)]
            }
            _ => vec![self.within(k, rise)],
        }
    }

    /// The same from knot k, before which the distance is negative.
    fn powers_from_behind(&self, k: usize) -> Vec<f64> {
        let h = self.at[k] - self.at[k - 1];
        let rise = (self.values[k] - self.values[k - 1]) / h;
        let [first, last] = [self.slopes[k - 1], self.slopes[k]];
        vec![last, (first + 2.0 * last - 3.0 * rise) / h, (first + last - 2.0 * rise) / (h * h)]
    }

    /// Whether a cubic turns or ends at knot k, so that its values near the knot are all on one side of it.
    fn rests_at(&self, k: usize) -> bool {
        self.slopes.get(k).is_some_and(|&slope| slope == 0.0 || k == self.at.len() - 1)
    }

    /// The slope of the line before knot k, so that rounding does not lead it beyond the knot's value.
    fn within(&self, k: usize, mut rise: f64) -> f64 {
        let (h, from, to) = (self.at[k] - self.at[k - 1], self.values[k - 1], self.values[k]);
        let toward_zero = |rise: f64| if rise > 0.0 { rise.next_down() } else { rise.next_up() };
        // It is a few numbers away; where the values overflow there is none.
        for _ in 0..8 {
            let end = from + rise * h;
            if if rise > 0.0 { end <= to } else { end >= to } {
                return rise;
            }
            rise = toward_zero(rise);
        }
        rise
    }
}

/// The slopes at the knots: weighted harmonic means of those of the lines beside, none where these turn. So the cubics rise and fall only
/// where the rows do. (F. N. Fritsch and J. Butland, A method for constructing local monotone piecewise cubic interpolants, SIAM
/// J. Sci. Stat. Comput. 5, 1984; at the ends the slope of a parabola, bounded.)
fn slopes(at: &[f64], values: &[f64]) -> Vec<f64> {
    let n = at.len();
    let widths: Vec<f64> = at.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let rises: Vec<f64> = (0..widths.len()).map(|k| (values[k + 1] - values[k]) / widths[k]).collect();
    if n <= 2 {
        return vec![rises.first().copied().unwrap_or(0.0); n];
    }
    let end = |h: [f64; 2], rise: [f64; 2]| {
        let slope = ((2.0 * h[0] + h[1]) * rise[0] - h[0] * rise[1]) / (h[0] + h[1]);
        if slope * rise[0] <= 0.0 {
            0.0
        } else if rise[0] * rise[1] <= 0.0 && slope.abs() > 3.0 * rise[0].abs() {
            3.0 * rise[0]
        } else {
            slope
        }
    };
    let inner = |k: usize| {
        let (before, after) = (rises[k - 1], rises[k]);
        if before * after <= 0.0 {
            return 0.0;
        }
        let (w, v) = (2.0 * widths[k] + widths[k - 1], widths[k] + 2.0 * widths[k - 1]);
        (w + v) / (w / before + v / after)
    };
    let m = widths.len() - 1;
    let first = end([widths[0], widths[1]], [rises[0], rises[1]]);
    let last = end([widths[m], widths[m - 1]], [rises[m], rises[m - 1]]);
    std::iter::once(first).chain((1..n - 1).map(inner)).chain([last]).collect()
}
