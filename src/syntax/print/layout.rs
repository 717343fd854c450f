//! From words with hints where lines may end to lines that fit: after D. C. Oppen, Prettyprinting, ACM TOPLAS 2(4), 1980.
//!
//! A group stands on one line if it fits. Otherwise its breaks end lines: all of them, or, where it is to be filled,
//! those behind which the next piece does not fit. What forces a line end inside a group keeps it from standing on one line.

use super::words::{Comment, Place, Word};

/// No line is longer, if it can be broken.
pub const WIDTH: usize = 100;

/// Wider than any line.
const ENDLESS: usize = usize::MAX / 4;

/// A word, or a hint.
#[derive(Clone, Debug)]
pub enum Op<'t> {
    /// A word behind this many blanks.
    Word { word: Word<'t>, blanks: usize },
    /// A comment; a line end follows.
    Comment(Comment<'t>),
    /// A blank.
    Blank,
    /// A line may end here.
    Break { how: Break, blanks: usize, deeper: usize },
    /// A line ends here, with an empty line behind it if so said; the next is so much deeper than the indentation.
    Newline { empty: bool, deeper: usize },
    /// A group begins; `fill` if only those of its breaks end lines that have to.
    Open { fill: bool },
    /// The last group ends.
    Close,
    /// From here on lines are so much deeper.
    Indent(usize),
    /// From here on lines begin where the next word does.
    Align,
    /// The last indentation ends.
    Dedent,
}

/// What a break that ends no line leaves, and when it ends one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Break {
    /// As its group says.
    Soft,
    /// If what follows would then fit on one line, and else does not.
    Useful,
    /// Between statements: also behind one of several lines.
    Statement,
}

/// A word or a comment on its line.
#[derive(Clone, Debug)]
pub struct Piece<'t> {
    /// What is written.
    pub text: &'t str,
    /// How many blanks at least are before it.
    pub blanks: usize,
    /// Where it stood.
    pub place: Place,
}

impl Piece<'_> {
    /// How many characters it has.
    pub fn width(&self) -> usize {
        self.text.chars().count()
    }

    /// Whether it is a comment.
    pub fn is_comment(&self) -> bool {
        self.text.starts_with("//")
    }
}

/// Where a line begins: so many characters behind where a piece of an earlier line begins, if there is one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Indent {
    /// The line and the piece.
    pub anchor: Option<(usize, usize)>,
    /// How many characters behind.
    pub offset: usize,
}

/// A line.
#[derive(Clone, Debug, Default)]
pub struct Line<'t> {
    /// Where it begins.
    pub indent: Indent,
    /// What stands on it.
    pub pieces: Vec<Piece<'t>>,
}

/// Lays words out.
pub fn lines<'t>(ops: Vec<Op<'t>>) -> Vec<Line<'t>> {
    let sizes = sizes(&ops);
    let mut layout = Layout {
        lines: vec![Line::default()],
        column: 0,
        blanks: 0,
        indents: vec![(Indent::default(), 0)],
        groups: vec![Group { flat: false, fill: true, line: 0 }],
    };
    for (op, size) in ops.into_iter().zip(sizes) {
        layout.put(op, size);
    }
    layout.lines
}

/// A group, read from its end.
#[derive(Default)]
struct Frame {
    /// How wide it is on one line.
    width: usize,
    /// From its last break seen on.
    piece: usize,
    /// What follows the group up to the next break.
    behind: usize,
}

impl Frame {
    fn add(&mut self, width: usize) {
        self.width = self.width.saturating_add(width).min(ENDLESS);
        self.piece = self.piece.saturating_add(width).min(ENDLESS);
    }
}

/// For each group and each break how many characters have to fit behind it for it to stay on its line: those of the group, or up
/// to the next break of its group, and on to the next place at which the line may end.
fn sizes(ops: &[Op<'_>]) -> Vec<usize> {
    let mut sizes = vec![0; ops.len()];
    let mut frames = Vec::new();
    let mut frame = Frame::default();
    let mut behind = 0_usize;
    for (op, size) in ops.iter().zip(&mut sizes).rev() {
        match op {
            Op::Word { word, blanks } => {
                let width = blanks + word.text.chars().count();
                frame.add(width);
                behind += width;
            }
            Op::Blank => {
                frame.add(1);
                behind += 1;
            }
            Op::Break { blanks, .. } => {
                frame.add(*blanks);
                *size = frame.piece;
                frame.piece = 0;
                behind = 0;
            }
            Op::Newline { .. } => {
                frame.add(ENDLESS);
                frame.piece = 0;
                behind = 0;
            }
            Op::Close => {
                frames.push(std::mem::replace(&mut frame, Frame { width: 0, piece: behind, behind }));
            }
            Op::Open { .. } => {
                let outer = frames.pop().expect("groups are balanced");
                let inner = std::mem::replace(&mut frame, outer);
                frame.add(inner.width);
                *size = inner.width.saturating_add(inner.behind);
            }
            Op::Comment(_) | Op::Indent(_) | Op::Align | Op::Dedent => {}
        }
    }
    sizes
}

/// A group that is open.
struct Group {
    flat: bool,
    fill: bool,
    /// The line on which its last statement began.
    line: usize,
}

struct Layout<'t> {
    lines: Vec<Line<'t>>,
    /// How many characters the last line has.
    column: usize,
    /// How many of them are blanks of a break, before the next piece.
    blanks: usize,
    /// How deep lines are, and at which column that is.
    indents: Vec<(Indent, usize)>,
    groups: Vec<Group>,
}

impl<'t> Layout<'t> {
    fn put(&mut self, op: Op<'t>, size: usize) {
        match op {
            Op::Word { word, blanks } => self.piece(word.text, word.place, blanks),
            Op::Comment(comment) => self.piece(comment.text, comment.place, 2),
            Op::Blank => self.leave(1),
            Op::Break { how, blanks, deeper } => {
                if self.ends_line(how, size, deeper) {
                    self.newline(deeper);
                } else {
                    self.leave(blanks);
                }
                let line = self.lines.len();
                let group = self.group();
                group.line = if how == Break::Statement { line } else { group.line };
            }
            Op::Newline { empty, deeper } => {
                if empty {
                    self.newline(0);
                }
                self.newline(deeper);
                self.group().line = self.lines.len();
            }
            Op::Open { fill } => {
                let flat = self.group().flat || self.column + size <= WIDTH;
                self.groups.push(Group { flat, fill, line: self.lines.len() });
            }
            Op::Close => drop(self.groups.pop()),
            Op::Indent(deeper) => {
                let (indent, column) = self.indent();
                self.indents.push((Indent { offset: indent.offset + deeper, ..indent }, column + deeper));
            }
            Op::Align => {
                let line = self.lines.len() - 1;
                let anchor = Some((line, self.lines[line].pieces.len()));
                self.indents.push((Indent { anchor, offset: 0 }, self.column));
            }
            Op::Dedent => drop(self.indents.pop()),
        }
    }

    fn group(&mut self) -> &mut Group {
        self.groups.last_mut().expect("groups are balanced")
    }

    fn indent(&self) -> (Indent, usize) {
        *self.indents.last().expect("indentations are balanced")
    }

    /// Whether nothing stands on the last line.
    fn begins(&self) -> bool {
        self.lines.last().is_none_or(|line| line.pieces.is_empty())
    }

    /// Leaves blanks before the next piece, unless a line begins.
    fn leave(&mut self, blanks: usize) {
        if !self.begins() {
            self.column += blanks;
            self.blanks += blanks;
        }
    }

    fn ends_line(&mut self, how: Break, size: usize, deeper: usize) -> bool {
        let (line, column, indent) = (self.lines.len(), self.column, self.indent().1);
        let begins = self.begins();
        let group = self.group();
        if group.flat || begins {
            return false;
        }
        let fits = column + size <= WIDTH;
        match how {
            Break::Soft => !group.fill || !fits,
            Break::Useful => !fits && indent + deeper + size <= WIDTH,
            Break::Statement => !group.fill || !fits || line != group.line,
        }
    }

    fn newline(&mut self, deeper: usize) {
        let (indent, column) = self.indent();
        let indent = Indent { offset: indent.offset + deeper, ..indent };
        self.lines.push(Line { indent, pieces: Vec::new() });
        (self.column, self.blanks) = (column + deeper, 0);
    }

    fn piece(&mut self, text: &'t str, place: Place, blanks: usize) {
        let blanks = if self.begins() { 0 } else { blanks };
        let piece = Piece { text, blanks: self.blanks + blanks, place };
        self.column += blanks + piece.width();
        self.blanks = 0;
        self.lines.last_mut().expect("there is a line").pieces.push(piece);
    }
}
