//! One text through every floor, within a budget: what became of it.

use std::collections::HashMap;
use std::fmt;
use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc;
use std::time::Duration;

use hyc::base::render::{Colours, render};
use hyc::base::{Diagnostic, SourceMap};
use hyc::codegen::Backend;
use hyc::model::{Files, Settings};
use hyc::runtime::limits::Limits;
use hyc::runtime::observe::{End, Event, Observer, Row};

/// After this time a run is interrupted, as a person would; nearly all mutants take milliseconds.
const PATIENCE: Duration = Duration::from_secs(5);

/// After this time more a mutant hangs.
const HANGS: Duration = Duration::from_secs(180);

/// How many rows and events what watches a run takes before it interrupts it.
const ROWS_MAX: u64 = 20_000;

/// What became of a text.
pub enum Fate {
    /// Its text is wrong.
    Misread,
    /// The model is wrong.
    Refused,
    /// It has no equations.
    Underivable,
    /// It ran; how the run ended.
    Ran(String),
}

impl fmt::Display for Fate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Fate::Misread => f.write_str("syntax error"),
            Fate::Refused => f.write_str("model error"),
            Fate::Underivable => f.write_str("no equations"),
            Fate::Ran(end) => write!(f, "ran: {end}"),
        }
    }
}

/// The data files that models may name, by their names.
pub struct Library(HashMap<String, Vec<u8>>);

impl Library {
    /// Reads these files.
    pub fn read(paths: &[PathBuf]) -> Self {
        let name = |path: &PathBuf| path.file_name().unwrap().to_string_lossy().into_owned();
        Self(paths.iter().map(|path| (name(path), std::fs::read(path).unwrap())).collect())
    }
}

/// Every fourth mutant reads its data with a byte changed.
struct Shelf<'l> {
    library: &'l Library,
    number: u64,
}

impl Files for Shelf<'_> {
    fn read(&mut self, path: &str) -> io::Result<Vec<u8>> {
        let mut bytes = self.library.0.get(path).cloned().ok_or(io::ErrorKind::NotFound)?;
        if self.number.is_multiple_of(4) && !bytes.is_empty() {
            let place = (self.number / 4) as usize % bytes.len();
            bytes[place] = b"\",;e-.9\n\r\0\xff "[(self.number / 8) as usize % 12];
        }
        Ok(bytes)
    }
}

/// Takes a text as far as it goes. An error is a panic, which has been printed.
pub fn survive(number: u64, text: &str, library: &Library) -> Result<Fate, ()> {
    let (done, waits) = mpsc::channel::<()>();
    let interrupt = AtomicBool::new(false);
    let flag = &interrupt;
    let watch = move || {
        let late = |limit| waits.recv_timeout(limit) == Err(mpsc::RecvTimeoutError::Timeout);
        if late(PATIENCE) {
            flag.store(true, Ordering::Relaxed);
            if late(HANGS) {
                eprintln!("mutant {number} hangs");
                std::process::abort();
            }
        }
    };
    std::thread::scope(|scope| {
        scope.spawn(watch);
        let fate = catch_unwind(AssertUnwindSafe(|| go(number, text, library, &interrupt)));
        drop(done);
        fate.map_err(|_| eprintln!("mutant {number} panicked"))
    })
}

fn go(number: u64, text: &str, library: &Library, interrupt: &AtomicBool) -> Fate {
    let mut sources = SourceMap::default();
    let file = sources.add("mutant.hy", text);
    let tree = match hyc::syntax::parse(file, text) {
        Ok(tree) => tree,
        Err(found) => return refused(&sources, &found, Fate::Misread),
    };
    let mut files = Shelf { library, number };
    let checked = hyc::model::check(&tree, &mut sources, &mut files, &settings(number));
    draw(&sources, &checked.diagnostics);
    draw(&sources, &checked.warnings);
    let Some(model) = checked.model else {
        assert!(checked.diagnostics.iter().any(Diagnostic::is_error), "refused without an error");
        return Fate::Refused;
    };
    let system = match hyc::calculus::derive(&model) {
        Ok(system) => system,
        Err(found) => return refused(&sources, &found, Fate::Underivable),
    };
    draw(&sources, &hyc::calculus::lint(&system));
    let backend = if number.is_multiple_of(2) { Backend::Jit } else { Backend::Interpreter };
    let program = match hyc::codegen::compile(system, backend) {
        Ok(program) => program,
        Err(found) => return refused(&sources, &[found], Fate::Underivable),
    };
    let mut watcher = Watcher { interrupt, rows: 0 };
    let outcome = hyc::runtime::simulate(&program, &limits(), interrupt, &mut watcher);
    draw(&sources, &outcome.warnings);
    Fate::Ran(match outcome.end {
        End::Until => "until".into(),
        End::Stop { .. } => "stop".into(),
        End::Interrupted => {
            println!("mutant {number} was interrupted after {} rows at {}", watcher.rows, outcome.time);
            "interrupted".into()
        }
        End::Error(found) => {
            draw(&sources, std::slice::from_ref(&found));
            found.code.into()
        }
        End::Output(error) => panic!("the watcher never fails: {error}"),
    })
}

/// What the command line lays over the model: every third mutant gets an end.
fn settings(number: u64) -> Settings {
    Settings { until: number.is_multiple_of(3).then_some(5.0), ..Settings::default() }
}

/// The budget of a run.
fn limits() -> Limits {
    Limits {
        microsteps_max: 50,
        generations_max: 50,
        threads_max: 1,
        zeno_events: 50,
        steps_max: 200,
        agents_max: 200,
        guards_max: 5_000,
        pieces_max: 50,
    }
}

fn refused(sources: &SourceMap, found: &[Diagnostic], fate: Fate) -> Fate {
    assert!(found.iter().any(Diagnostic::is_error), "refused without an error");
    draw(sources, found);
    fate
}

/// Draws diagnostics as the command line would.
fn draw(sources: &SourceMap, found: &[Diagnostic]) {
    let text = render(sources, found, Colours::Ansi);
    for diagnostic in found {
        assert!(text.contains(diagnostic.code), "{} is not drawn:\n{text}", diagnostic.code);
        for label in &diagnostic.labels {
            sources.line_column(label.span);
        }
    }
}

/// Takes what a run says, and interrupts it when that is enough.
struct Watcher<'i> {
    interrupt: &'i AtomicBool,
    rows: u64,
}

impl Watcher<'_> {
    fn take(&mut self) -> io::Result<()> {
        self.rows += 1;
        if self.rows >= ROWS_MAX {
            self.interrupt.store(true, Ordering::Relaxed);
        }
        assert!(self.rows < 100 * ROWS_MAX, "the run does not look at its interruption");
        Ok(())
    }
}

impl Observer for Watcher<'_> {
    fn event(&mut self, _event: &Event<'_>) -> io::Result<()> {
        self.take()
    }

    fn sample(&mut self, _record: usize, _row: &Row<'_>) -> io::Result<()> {
        self.take()
    }
}
