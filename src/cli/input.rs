//! From a path to a model: reads the file, and those that it names, and calls the doors of syntax and model.

use std::fs;
use std::io::{self, ErrorKind, Read as _};
use std::path::{Path, PathBuf};
use std::thread;

use super::limits::Limits;
use super::{Exit, Refused};
use crate::base::{Diagnostic, SourceMap, Span};
use crate::model::ir::Model;
use crate::model::{Checked, Files, Settings};
use crate::syntax::{self, Ast};

/// The largest text of a model: a little more than the floor of syntax takes, which has a message of its own.
const MODEL_BYTES_MAX: u64 = (syntax::MAX_FILE_BYTES as u64) * 2;

/// The largest data file.
const DATA_BYTES_MAX: u64 = 1 << 30;

/// What is made of shorter texts is freed at once: that takes less than another thread.
const FREED_AT_ONCE_MAX: usize = 1 << 20;

/// The name under which messages show a model's path.
pub(super) fn name_of(path: &Path) -> String {
    path.display().to_string()
}

/// A model's text and tree, or what is wrong with the text.
pub(super) struct Parsed {
    pub(super) sources: SourceMap,
    pub(super) tree: Result<Ast, Vec<Diagnostic>>,
}

/// The text of a model; `-` is standard input. Refused if it cannot be read or is not UTF-8.
pub(super) fn read_text(path: &Path) -> Result<String, Refused> {
    read_model(path)
        .and_then(|bytes| String::from_utf8(bytes).map_err(|_| ErrorKind::InvalidData.into()))
        .map_err(|error| format!("cannot read `{}`: {}", path.display(), reason(&error)))
}

fn read_model(path: &Path) -> io::Result<Vec<u8>> {
    match path.to_str() {
        Some("-") => read_all(io::stdin().lock(), MODEL_BYTES_MAX),
        _ => read_bytes(path, MODEL_BYTES_MAX),
    }
}

/// Reads and parses. Refused if the file cannot be read or is not UTF-8.
pub(super) fn parse(path: &Path) -> Result<Parsed, Refused> {
    let mut sources = SourceMap::default();
    let file = sources.add(name_of(path), read_text(path)?);
    let tree = syntax::parse(file, &sources.file(file).text);
    Ok(Parsed { sources, tree })
}

/// The same, if it cannot be read with what is wrong at its place.
fn parse_or_tell(path: &Path) -> Parsed {
    let name = name_of(path);
    let mut sources = SourceMap::default();
    let (why, text, at, help) = match read_model(path) {
        Ok(bytes) => match String::from_utf8(bytes) {
            Ok(text) => {
                let file = sources.add(name, text);
                let tree = syntax::parse(file, &sources.file(file).text);
                return Parsed { sources, tree };
            }
            Err(error) => {
                let at = error.utf8_error().valid_up_to();
                let text = String::from_utf8_lossy(error.as_bytes()).into_owned();
                (reason(&ErrorKind::InvalidData.into()), text, at, "save it in UTF-8")
            }
        },
        Err(error) => {
            (reason(&error), String::new(), 0, "name a file with the text of a model; `-` is standard input")
        }
    };
    let wide = text[at..].chars().next().map_or(0, char::len_utf8);
    let file = sources.add(name.as_str(), text);
    let diagnostic = Diagnostic::error("HY0120", format!("cannot read `{name}`: {why}"))
        .label(Span::new(file, at, at + wide), "")
        .help(help);
    Parsed { sources, tree: Err(vec![diagnostic]) }
}

/// A model, or none and why.
pub(super) struct Loaded {
    pub(super) sources: SourceMap,
    pub(super) diagnostics: Vec<Diagnostic>,
    /// What is worth a warning in a model without errors.
    pub(super) warnings: Vec<Diagnostic>,
    pub(super) model: Option<Model>,
    /// All files that were read.
    pub(super) inputs: Vec<PathBuf>,
}

/// Errors of the user's words or of files, not of the model: a `-p` that cannot be, a file that cannot be read.
const USAGE_CODES: [&str; 5] = ["HY0120", "HY0215", "HY0260", "HY0261", "HY0272"];

impl Loaded {
    /// The exit code where there is no model.
    pub(super) fn exit(&self) -> Exit {
        let of_usage = |diagnostic: &Diagnostic| USAGE_CODES.contains(&diagnostic.code);
        if self.diagnostics.iter().any(of_usage) { Exit::Usage } else { Exit::ModelErrors }
    }
}

/// Reads, parses and checks. A model that cannot be read has an error like any other.
pub(super) fn load(path: &Path, settings: &Settings) -> Result<Loaded, Refused> {
    let Parsed { mut sources, tree } = parse_or_tell(path);
    let folder = path.parent().unwrap_or(Path::new("")).to_path_buf();
    let mut files = Folder { folder, inputs: vec![path.to_path_buf()] };
    let Checked { model, diagnostics, warnings } = match tree {
        Ok(tree) => {
            let checked = crate::model::check(&tree, &mut sources, &mut files, settings);
            free(tree, &sources);
            checked
        }
        Err(diagnostics) => Checked { model: None, diagnostics, warnings: Vec::new() },
    };
    Ok(Loaded { sources, diagnostics, warnings, model, inputs: files.inputs })
}

/// Frees what was made of these texts; of long ones beside what comes next, for nobody waits for it.
pub(super) fn free(made: impl Send + 'static, sources: &SourceMap) {
    let bytes: usize = sources.files().iter().map(|file| file.text.len()).sum();
    if bytes > FREED_AT_ONCE_MAX {
        // Where there is no other thread it is freed here.
        let _ = thread::Builder::new().spawn(move || drop(made));
    }
}

/// Settings that only give params and limits.
pub(super) fn settings_with(
    params: &[(String, String)],
    limits: &[(String, u64)],
) -> Result<Settings, Refused> {
    let limits = Limits::new(limits)?.model;
    Ok(Settings { params: params.to_vec(), limits, ..Settings::default() })
}

/// A file, if it is not larger than so many bytes; one without end is refused, not read.
fn read_bytes(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    read_all(fs::File::open(path)?, most)
}

fn read_all(from: impl io::Read, most: u64) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    from.take(most + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most {
        return Err(io::Error::other(format!("it is larger than {} MiB", most >> 20)));
    }
    Ok(bytes)
}

/// The data files and imports of a model, found relative to it.
struct Folder {
    folder: PathBuf,
    inputs: Vec<PathBuf>,
}

impl Files for Folder {
    fn read(&mut self, path: &str) -> io::Result<Vec<u8>> {
        let path = self.folder.join(path);
        let bytes = read_bytes(&path, DATA_BYTES_MAX)
            .map_err(|error| io::Error::new(error.kind(), reason(&error)))?;
        self.inputs.push(path);
        Ok(bytes)
    }

    fn identity(&self, path: &str) -> Option<PathBuf> {
        fs::canonicalize(self.folder.join(path)).ok()
    }
}

/// The operating system's words, without its number.
pub(super) fn reason(error: &io::Error) -> String {
    let text = error.to_string();
    if error.kind() == io::ErrorKind::InvalidData {
        return "it is not text in UTF-8".into();
    }
    match text.find(" (os error ") {
        Some(end) => text[..end].to_string(),
        None => text,
    }
}
