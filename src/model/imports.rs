//! The files that a model imports: read, parsed, each once.
//!
//! Paths are relative to the importing file; two paths are one file if they are the same once `.` and `..` are resolved, or lead to
//! the same place. What an imported file declares stands before what the importing file does.

use std::path::{Component, Path, PathBuf};

use super::Files;
use super::error::{FileError, ImportError};
use super::table::{self, reason};
use crate::base::{Diagnostic, SourceMap, Span};
use crate::syntax::ast::{Ast, Import, Item};

/// What imports come to.
pub(super) struct Imports {
    /// The imported files, each after those that it imports itself.
    pub trees: Vec<Ast>,
    /// What is wrong with them.
    pub diagnostics: Vec<Diagnostic>,
}

/// A file whose imports are being read.
struct Open {
    path: PathBuf,
    /// What tells it from others.
    identity: PathBuf,
    /// Where it is imported.
    span: Span,
}

struct Reader<'r> {
    sources: &'r mut SourceMap,
    files: &'r mut dyn Files,
    /// Those that are being read, outermost first.
    open: Vec<Open>,
    /// All that have been named.
    known: Vec<PathBuf>,
    found: Imports,
}

/// Reads everything that a file imports.
pub(super) fn gather(tree: &Ast, sources: &mut SourceMap, files: &mut dyn Files) -> Imports {
    let found = Imports { trees: Vec::new(), diagnostics: Vec::new() };
    let Some(first) = imports(tree).next() else { return found };
    // Other paths are relative to the model's own folder.
    let name = PathBuf::from(&sources.file(first.span.file).name);
    let path = PathBuf::from(name.file_name().unwrap_or_default());
    let identity = identity(files, &path);
    let known = vec![identity.clone()];
    let mut reader = Reader { sources, files, open: Vec::new(), known, found };
    reader.follow(tree, Open { path, identity, span: first.span });
    reader.found
}

fn imports(tree: &Ast) -> impl Iterator<Item = &Import> {
    tree.items.iter().filter_map(|item| match item {
        Item::Import(import) => Some(import),
        _ => None,
    })
}

impl Reader<'_> {
    /// Reads what a tree imports.
    fn follow(&mut self, tree: &Ast, file: Open) {
        let folder = file.path.parent().map(Path::to_path_buf).unwrap_or_default();
        self.open.push(file);
        for import in imports(tree) {
            self.import(import, normal(&folder.join(&import.path.value)));
        }
        self.open.pop();
    }

    fn import(&mut self, import: &Import, path: PathBuf) {
        let span = import.path.span;
        let identity = identity(self.files, &path);
        if let Some(first) = self.open.iter().position(|file| file.identity == identity) {
            let circle = self.open[first..].iter().map(|file| file.path.display().to_string()).collect();
            let via = self.open[first + 1..].iter().map(|file| file.span).collect();
            return self.report(ImportError::Circle { circle, via, span });
        }
        if self.known.contains(&identity) {
            return;
        }
        self.known.push(identity.clone());
        // Of `.` nothing is left once it is resolved.
        let resolved = path.display().to_string();
        let name = if resolved.is_empty() { import.path.value.clone() } else { resolved };
        let bytes = match self.files.read(&name) {
            Ok(bytes) => bytes,
            Err(error) => {
                return self.report(ImportError::Unreadable { path: name, why: reason(&error), span });
            }
        };
        let file = match table::add_text(self.sources, &name, bytes) {
            Ok(file) => file,
            Err(FileError::Malformed { why, .. }) => {
                return self.report(ImportError::Unreadable { path: name, why, span });
            }
            Err(error) => return self.report(error),
        };
        match crate::syntax::parse(file, &self.sources.file(file).text) {
            Ok(tree) => {
                self.follow(&tree, Open { path, identity, span });
                self.found.trees.push(tree);
            }
            Err(diagnostics) => self.found.diagnostics.extend(diagnostics),
        }
    }

    fn report(&mut self, error: impl Into<Diagnostic>) {
        self.found.diagnostics.push(error.into());
    }
}

/// What tells a file from others: where it is, or the path if that is not known.
fn identity(files: &dyn Files, path: &Path) -> PathBuf {
    path.to_str().and_then(|path| files.identity(path)).unwrap_or_else(|| path.to_path_buf())
}

/// A path without `.` and, where something stands before it, without `..`.
fn normal(path: &Path) -> PathBuf {
    let mut normal = PathBuf::new();
    for part in path.components() {
        let can_rise = matches!(normal.components().next_back(), Some(Component::Normal(_)));
        match part {
            Component::CurDir => {}
            Component::ParentDir if can_rise => {
                normal.pop();
            }
            other => normal.push(other),
        }
    }
    normal
}
