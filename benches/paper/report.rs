//! The tables of docs/PAPER.md: each stands between two marks, and is written anew by every run.

use std::fs;
use std::path::PathBuf;

/// The tables of a run, by name.
pub struct Report {
    text: String,
    path: PathBuf,
}

impl Report {
    /// The document as it is.
    pub fn open() -> Self {
        let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("docs/PAPER.md");
        let text = fs::read_to_string(&path)
            .unwrap_or_else(|error| panic!("cannot read {}: {error}", path.display()));
        Self { text, path }
    }

    /// Puts a table in its place.
    pub fn table(&mut self, name: &str, table: &str) {
        let (begin, end) = (format!("<!-- table {name} -->\n"), "<!-- end -->");
        let Some(from) = self.text.find(&begin).map(|at| at + begin.len()) else {
            panic!("docs/PAPER.md has no place for the table `{name}`");
        };
        let to = from + self.text[from..].find(end).expect("a place has an end");
        self.text.replace_range(from..to, &format!("\n{}\n\n", table.trim_end()));
        fs::write(&self.path, &self.text)
            .unwrap_or_else(|error| panic!("cannot write {}: {error}", self.path.display()));
    }
}
