//! Keeps in columns what the author has put into columns.
//!
//! Words of lines that follow each other stand in a column if they did so before and at least one of them had several
//! blanks before it. The column is the first that all of them reach. Comments behind lines stay in
//! the column that they share in the whole text; if there the longest line had only two blanks before it, the column follows it.

use std::collections::BTreeMap;

use super::layout::{Indent, Line, Piece, WIDTH};

/// The blanks before a comment that are no choice of a column.
const COMMENT_BLANKS: usize = 2;

/// The text of lines, whose words stood at their places.
pub fn text(mut lines: Vec<Line<'_>>) -> String {
    align_words(&mut lines);
    align_comments(&mut lines);
    let mut text = String::new();
    for (k, line) in lines.iter().enumerate() {
        let mut begin = if line.pieces.is_empty() { 0 } else { indent(&lines, line.indent) };
        for piece in &line.pieces {
            text.extend(std::iter::repeat_n(' ', begin + piece.blanks));
            text.push_str(piece.text);
            begin = 0;
        }
        if k + 1 < lines.len() || !line.pieces.is_empty() {
            text.push('\n');
        }
    }
    text
}

/// The column at which a line begins.
fn indent(lines: &[Line<'_>], indent: Indent) -> usize {
    indent.offset + indent.anchor.map_or(0, |(line, piece)| column(lines, line, piece))
}

/// The column of a piece, or of the end of its line.
fn column(lines: &[Line<'_>], line: usize, piece: usize) -> usize {
    let pieces = &lines[line].pieces;
    let before: usize = pieces[..piece].iter().map(|piece| piece.blanks + piece.width()).sum();
    indent(lines, lines[line].indent) + before + pieces.get(piece).map_or(0, |piece| piece.blanks)
}

/// How many blanks were before a piece behind another on its line.
fn blanks_before(piece: &Piece<'_>, before: &Piece<'_>) -> usize {
    piece.place.column.saturating_sub(before.place.column + before.width())
}

/// Whether all pieces of a line stood on one line.
fn was_one_line(line: &Line<'_>) -> bool {
    line.pieces.windows(2).all(|pair| pair[0].place.line == pair[1].place.line)
}

/// Words that stood in one column, on lines that follow each other.
#[derive(Default)]
struct Column {
    /// The line and the piece of each.
    members: Vec<(usize, usize)>,
    /// Whether one of them had several blanks before it.
    meant: bool,
}

fn align_words(lines: &mut [Line<'_>]) {
    for Column { members, .. } in columns(lines) {
        let at = |lines: &[Line<'_>], (line, piece)| column(lines, line, piece);
        let common = members.iter().map(|&member| at(lines, member)).max().unwrap_or(0);
        let pads: Vec<usize> = members.iter().map(|&member| common - at(lines, member)).collect();
        let fits = members.iter().zip(&pads).all(|(&(line, _), pad)| {
            let words = lines[line].pieces.iter().take_while(|piece| !piece.is_comment()).count();
            let end = column(lines, line, words - 1) + lines[line].pieces[words - 1].width();
            *pad == 0 || end + pad <= WIDTH
        });
        if fits {
            members
                .iter()
                .zip(pads)
                .for_each(|(&(line, piece), pad)| lines[line].pieces[piece].blanks += pad);
        }
    }
}

/// All columns that are meant, by the place at which they stood.
fn columns(lines: &[Line<'_>]) -> Vec<Column> {
    let mut columns: BTreeMap<(usize, usize), Column> = BTreeMap::new();
    // Of each place at which a word of the line before stood: which word, and the line on which its column begins.
    let mut open: BTreeMap<usize, (usize, usize)> = BTreeMap::new();
    for (k, line) in lines.iter().enumerate() {
        let mut next = BTreeMap::new();
        if was_one_line(line) {
            for (j, pair) in line.pieces.windows(2).enumerate().filter(|(_, pair)| !pair[1].is_comment()) {
                let place = pair[1].place.column;
                let above = open.get(&place).filter(|(piece, _)| belong_together(lines, k, j + 1, *piece));
                let first = above.map_or(k, |(_, first)| *first);
                let column = columns.entry((place, first)).or_default();
                column.members.push((k, j + 1));
                column.meant |= blanks_before(&pair[1], &pair[0]) > pair[1].blanks.max(1);
                next.insert(place, (j + 1, first));
            }
        }
        open = next;
    }
    columns.into_values().filter(|column| column.meant && column.members.len() > 1).collect()
}

/// Whether a piece of the line before may be in one column with a piece of this one: they are the same word, or words, not
/// symbols, with as many blanks before them; and they move together if the lines hang on anything.
fn belong_together(lines: &[Line<'_>], line: usize, piece: usize, above: usize) -> bool {
    let (this, before) = (&lines[line], &lines[line - 1]);
    let (text, text_above) = (this.pieces[piece].text, before.pieces[above].text);
    let is_word = |text: &str| text.starts_with(|c: char| c.is_alphanumeric() || c == '_' || c == '"');
    let alike = is_word(text) && is_word(text_above) && gaps(this, piece) == gaps(before, above);
    let anchor = this.indent.anchor;
    let together =
        anchor == before.indent.anchor || anchor.is_some_and(|(to, at)| to + 1 == line && above > at);
    together && (alike || text == text_above)
}

/// How many of the pieces up to this one have blanks before them.
fn gaps(line: &Line<'_>, piece: usize) -> usize {
    line.pieces[1..=piece].iter().filter(|piece| piece.blanks > 0).count()
}

fn align_comments(lines: &mut [Line<'_>]) {
    let mut columns: BTreeMap<usize, Vec<(usize, usize)>> = BTreeMap::new();
    for (k, line) in lines.iter().enumerate() {
        if line.pieces.len() > 1
            && let Some(comment) = line.pieces.last().filter(|piece| piece.is_comment())
        {
            columns.entry(comment.place.column).or_default().push((k, line.pieces.len() - 1));
        }
    }
    for (place, members) in columns {
        let given = members.iter().map(|&(line, piece)| {
            let pieces = &lines[line].pieces;
            let blanks = blanks_before(&pieces[piece], &pieces[piece - 1]);
            if had_its_line(lines, line) { blanks } else { 0 }
        });
        let chosen = given.min().is_some_and(|blanks| blanks > COMMENT_BLANKS);
        let natural = members.iter().map(|&(line, piece)| column(lines, line, piece)).max().unwrap_or(0);
        let common = if chosen { place } else { natural };
        for (line, piece) in members {
            let pad = common.saturating_sub(column(lines, line, piece));
            lines[line].pieces[piece].blanks += pad;
        }
    }
}

/// Whether the words of a line had a line for themselves before.
fn had_its_line(lines: &[Line<'_>], line: usize) -> bool {
    let before = lines[..line].last().and_then(|before| before.pieces.last());
    was_one_line(&lines[line])
        && before.is_none_or(|before| before.place.line != lines[line].pieces[0].place.line)
}
