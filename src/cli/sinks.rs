//! The files that a run writes: opened before it begins, so that nothing is computed that cannot be kept.
//!
//! All are opened before any is emptied: what a run has written stays, if the next one is refused.

use std::fs::{self, File, OpenOptions};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

use super::Refused;
use super::input::reason;
use crate::output::{STANDARD_OUTPUT, Sink};

/// Opens files for writing, each once, none that the run reads.
pub(super) struct Sinks {
    inputs: Vec<PathBuf>,
    taken: Vec<PathBuf>,
    on_stdout: bool,
    names: Vec<String>,
    opened: Vec<Opened>,
}

/// A file as it was found.
struct Opened {
    path: PathBuf,
    file: File,
    is_new: bool,
}

impl Sinks {
    /// `inputs` are the files that must not be overwritten.
    pub(super) fn new(inputs: &[PathBuf]) -> Self {
        let inputs = inputs.iter().filter_map(|path| identity(path)).collect();
        Self { inputs, taken: Vec::new(), on_stdout: false, names: Vec::new(), opened: Vec::new() }
    }

    /// Opens a file and leaves in it what is there; `-` is standard output.
    pub(super) fn open(&mut self, path: &Path) -> Result<Sink, Refused> {
        if path == Path::new("-") {
            if std::mem::replace(&mut self.on_stdout, true) {
                return Err("two outputs go to standard output".into());
            }
            return Ok(Sink { name: STANDARD_OUTPUT.into(), writer: Box::new(io::stdout()) });
        }
        self.take(path)?;
        let (file, kept, is_new) = open_as_it_is(path).map_err(|error| unwritable(path, &error))?;
        self.opened.push(Opened { path: path.to_path_buf(), file: kept, is_new });
        self.names.push(path.display().to_string());
        Ok(Sink { name: path.display().to_string(), writer: Box::new(file) })
    }

    /// The run begins: empties all files that have been opened.
    pub(super) fn empty(&mut self) -> Result<(), Refused> {
        for Opened { path, file, .. } in std::mem::take(&mut self.opened) {
            let emptied =
                file.metadata().and_then(|found| if found.is_file() { file.set_len(0) } else { Ok(()) });
            emptied.map_err(|error| unwritable(&path, &error))?;
        }
        Ok(())
    }

    /// Whether one of the outputs is standard output.
    pub(super) fn on_stdout(&self) -> bool {
        self.on_stdout
    }

    /// The files opened so far.
    pub(super) fn names(&self) -> &[String] {
        &self.names
    }

    fn take(&mut self, path: &Path) -> Result<(), Refused> {
        let Some(identity) = identity(path) else { return Ok(()) };
        if self.inputs.contains(&identity) {
            return Err(format!("`{}` is a file that this run reads; write somewhere else", path.display()));
        }
        if self.taken.contains(&identity) {
            return Err(format!("two outputs go to `{}`", path.display()));
        }
        self.taken.push(identity);
        Ok(())
    }
}

impl Drop for Sinks {
    /// A run that is refused leaves no empty files behind.
    fn drop(&mut self) {
        for opened in self.opened.iter().filter(|opened| opened.is_new) {
            // Where this fails the file stays as empty as it is.
            let _ = fs::remove_file(&opened.path);
        }
    }
}

/// A file to be written, twice, and whether it was not there.
fn open_as_it_is(path: &Path) -> io::Result<(File, File, bool)> {
    let (file, is_new) = match OpenOptions::new().write(true).create_new(true).open(path) {
        Err(error) if error.kind() == ErrorKind::AlreadyExists => {
            (OpenOptions::new().write(true).create(true).truncate(false).open(path)?, false)
        }
        created => (created?, true),
    };
    let kept = file.try_clone()?;
    Ok((file, kept, is_new))
}

fn unwritable(path: &Path, error: &io::Error) -> Refused {
    format!("cannot write `{}`: {}", path.display(), reason(error))
}

/// What tells one file from another, whether it exists or not; none for devices and pipes.
fn identity(path: &Path) -> Option<PathBuf> {
    match fs::metadata(path) {
        Ok(metadata) if !metadata.is_file() => None,
        Ok(_) => fs::canonicalize(path).ok(),
        Err(_) => {
            let parent = path.parent().filter(|parent| !parent.as_os_str().is_empty());
            let folder = fs::canonicalize(parent.unwrap_or(Path::new("."))).ok()?;
            Some(folder.join(path.file_name()?))
        }
    }
}

/// The folder for the files that a model names, made if it is not there.
pub(super) fn prepare_folder(folder: Option<&Path>) -> Result<PathBuf, Refused> {
    let Some(folder) = folder else { return Ok(PathBuf::new()) };
    fs::create_dir_all(folder)
        .map_err(|error| format!("cannot make the folder `{}`: {}", folder.display(), reason(&error)))?;
    Ok(folder.to_path_buf())
}
