//! Source files and spans: where in which text something stands.

use std::ops::Range;

/// The number of a file in a [`SourceMap`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Default)]
pub struct FileId(pub u32);

/// A half-open range of bytes in one file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Default)]
pub struct Span {
    /// The file.
    pub file: FileId,
    /// First byte.
    pub start: u32,
    /// One past the last byte.
    pub end: u32,
}

impl Span {
    /// The bytes `start..end` of `file`.
    pub fn new(file: FileId, start: usize, end: usize) -> Self {
        let clip = |byte: usize| u32::try_from(byte).unwrap_or(u32::MAX);
        Self { file, start: clip(start), end: clip(end) }
    }

    /// The smallest span that holds both; `other` must be of the same file.
    pub fn to(self, other: Span) -> Span {
        Span { file: self.file, start: self.start.min(other.start), end: self.end.max(other.end) }
    }

    /// As a range of byte offsets.
    pub fn range(self) -> Range<usize> {
        self.start as usize..self.end as usize
    }
}

/// One text with the name that messages give it.
#[derive(Clone, Debug, PartialEq)]
pub struct SourceFile {
    /// The path as the user wrote it.
    pub name: String,
    /// The whole text; empty once it has been forgotten.
    pub text: String,
    /// Where each line begins.
    line_starts: Vec<u32>,
}

impl SourceFile {
    fn new(name: String, text: String) -> Self {
        let ends = text.bytes().enumerate().filter(|(_, byte)| *byte == b'\n');
        let starts = ends.map(|(k, _)| u32::try_from(k + 1).unwrap_or(u32::MAX));
        let line_starts = std::iter::once(0).chain(starts).collect();
        Self { name, text, line_starts }
    }

    /// The number of the line on which a byte stands, from 0.
    fn line_at(&self, byte: usize) -> usize {
        self.line_starts.partition_point(|&start| start as usize <= byte) - 1
    }

    /// A line by its number from 0, without its end; empty if there is none.
    pub fn line(&self, number: usize) -> &str {
        let Some(&start) = self.line_starts.get(number) else { return "" };
        let end = self.line_starts.get(number + 1).map_or(self.text.len(), |&end| end as usize);
        self.text.get(start as usize..end).unwrap_or("").trim_end_matches(['\n', '\r'])
    }
}

/// All texts that a run has read: models, imported models, data files.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SourceMap {
    files: Vec<SourceFile>,
}

impl SourceMap {
    /// Adds a text under a name.
    pub fn add(&mut self, name: impl Into<String>, text: impl Into<String>) -> FileId {
        let id = FileId(u32::try_from(self.files.len()).expect("fewer than 2^32 files"));
        self.files.push(SourceFile::new(name.into(), text.into()));
        id
    }

    /// Forgets the text of a file to which nothing refers any more; its name stays.
    pub fn forget(&mut self, id: FileId) {
        let file = &mut self.files[id.0 as usize];
        *file = SourceFile::new(std::mem::take(&mut file.name), String::new());
    }

    /// A file by its number.
    pub fn file(&self, id: FileId) -> &SourceFile {
        &self.files[id.0 as usize]
    }

    /// The files in the order in which they were added.
    pub fn files(&self) -> &[SourceFile] {
        &self.files
    }

    /// The text that a span covers.
    pub fn text(&self, span: Span) -> &str {
        self.file(span.file).text.get(span.range()).unwrap_or("")
    }

    /// The line on which a span begins, without its end.
    pub fn line_of(&self, span: Span) -> &str {
        let file = self.file(span.file);
        file.line(file.line_at((span.start as usize).min(file.text.len())))
    }

    /// Line and column (in characters) of the start of a span, both from 1.
    pub fn line_column(&self, span: Span) -> (usize, usize) {
        let file = self.file(span.file);
        let mut start = (span.start as usize).min(file.text.len());
        while !file.text.is_char_boundary(start) {
            start -= 1;
        }
        let line = file.line_at(start);
        let before = &file.text[file.line_starts[line] as usize..start];
        (line + 1, before.chars().count() + 1)
    }
}
