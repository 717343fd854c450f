//! What a run writes, and where: all files are found and opened first; only when none is refused are they emptied and the
//! tables begun.

use std::path::{Path, PathBuf};

use super::Refused;
use super::arguments::{OutputArguments, Outputs};
use super::sinks::{Sinks, prepare_folder};
use crate::base::SourceMap;
use crate::codegen::program::{self, LetValue, Program, Record, VarRef};
use crate::output::{Cast, Column, Kind, Sink, Tables};

/// Every file that a run will write: those of `run { }` in the folder, those of the command line where it says.
pub(super) struct OutputFiles {
    page: Option<Sink>,
    events: Option<Sink>,
    records: Vec<Sink>,
    final_states: Option<Sink>,
    explanations: Option<Sink>,
    statistics: Option<Sink>,
}

impl OutputFiles {
    /// Opens them all, and empties none that is refused or stands beside one that is.
    pub(super) fn open(
        wanted: &OutputArguments,
        program: &Program,
        sinks: &mut Sinks,
    ) -> Result<Self, Refused> {
        let mut open = |path: Option<&Path>| path.map(|path| sinks.open(path)).transpose();
        let page = open(wanted.report.as_deref().map(of_page).transpose()?)?;
        let folder = prepare_folder(wanted.folder.as_deref())?;
        let named = wanted.named == Outputs::Written;
        let of_model = program.run.events.as_ref().filter(|_| named).map(|file| folder.join(file));
        let events = open(wanted.events.clone().or(of_model).as_deref().map(of_table).transpose()?)?;
        let mut records = Vec::new();
        for path in record_paths(wanted, program, &folder)? {
            records.extend(open(Some(of_table(&path)?))?);
        }
        let final_states = open(wanted.final_states.as_deref().map(of_table).transpose()?)?;
        let explanations = open(wanted.explain_events.as_deref())?;
        let statistics = open(wanted.stats.as_deref())?;
        sinks.empty()?;
        Ok(Self { page, events, records, final_states, explanations, statistics })
    }

    /// Begins the tables; what is written whole at the end (statistics, page) is handed back.
    pub(super) fn begin<'a>(
        self,
        program: &Program,
        cast: &'a Cast,
        sources: &'a SourceMap,
    ) -> Result<(Tables<'a>, Whole), Refused> {
        let mut tables = Tables::new(cast);
        let begin = || {
            if let Some(sink) = self.events {
                tables.event_log(sink)?;
            }
            for (sink, record) in self.records.into_iter().zip(&program.run.records) {
                tables.trajectory(sink, &columns_of(program, record))?;
            }
            if let Some(sink) = self.final_states {
                tables.final_states(sink)?;
            }
            if let Some(sink) = self.explanations {
                tables.explanations(sink, sources);
            }
            Ok(())
        };
        begin().map_err(|error: std::io::Error| error.to_string())?;
        Ok((tables, Whole { statistics: self.statistics, page: self.page }))
    }
}

/// Endings of files that are something else than a table of text; what hyc writes there would be taken for it.
const NO_TABLE: [&str; 25] = [
    "gz", "zst", "bz2", "xz", "zip", "tsv", "json", "jsonl", "ndjson", "xml", "yaml", "xls", "xlsx", "ods",
    "h5", "hdf5", "nc", "mat", "npy", "npz", "sqlite", "db", "html", "svg", "png",
];

/// The path of a table, unless its ending promises what is not written there.
fn of_table(path: &Path) -> Result<&Path, Refused> {
    match ending(path) {
        Some(ending) if NO_TABLE.contains(&ending.as_str()) => Err(format!(
            "`{}`: tables are `.csv`, `.arrow` (or `.feather`), `.arrows` or `.parquet`",
            path.display()
        )),
        Some(_) | None => Ok(path),
    }
}

/// The path of a page, unless it ends like something else.
fn of_page(path: &Path) -> Result<&Path, Refused> {
    match ending(path) {
        Some(ending) if !matches!(ending.as_str(), "html" | "htm" | "xhtml") => {
            Err(format!("`{}`: a page is `.html`", path.display()))
        }
        Some(_) | None => Ok(path),
    }
}

fn ending(path: &Path) -> Option<String> {
    path.extension().and_then(|ending| ending.to_str()).map(str::to_ascii_lowercase)
}

/// What is written in one piece when the run is over.
pub(super) struct Whole {
    pub(super) statistics: Option<Sink>,
    pub(super) page: Option<Sink>,
}

/// Where the trajectories of the model's records go.
fn record_paths(wanted: &OutputArguments, program: &Program, folder: &Path) -> Result<Vec<PathBuf>, Refused> {
    let records = &program.run.records;
    if wanted.record.is_some() && records.len() > 1 {
        let n = records.len();
        return Err(format!("run {{ }} has {n} records with files of their own: leave `--record` out"));
    }
    let path = |record: &Record| match (&wanted.record, &record.file) {
        (Some(path), _) => Ok(path.clone()),
        (None, Some(file)) => Ok(folder.join(file)),
        (None, None) => Err("a `record` of the model names no file: add `--record FILE`".into()),
    };
    records.iter().filter(|_| wanted.named == Outputs::Written).map(path).collect()
}

/// The columns of a record: each has room for what the agents of any type have there.
fn columns_of(program: &Program, record: &Record) -> Vec<Column> {
    let kind = |k: usize| {
        let of_types = program.types.iter().zip(&record.variables);
        let kinds = of_types.filter_map(|(ty, variables)| {
            Some(match variables[k]? {
                VarRef::State(_) => Kind::Number,
                VarRef::Discrete(number) => kind_of(&ty.discretes[number]),
                VarRef::Param(number) => kind_of(&ty.params[number]),
                VarRef::Link(_) => Kind::Text,
                VarRef::Let(number) => match ty.lets[number].value {
                    LetValue::Condition(_) => Kind::Bool,
                    LetValue::Number(_) => kind_of(&ty.lets[number].column),
                },
            })
        });
        kinds.reduce(Kind::with).unwrap_or(Kind::Number)
    };
    record.columns.iter().enumerate().map(|(k, name)| Column::new(name, kind(k))).collect()
}

/// What the cells of a column hold.
pub(super) fn kind_of(column: &program::Column) -> Kind {
    if column.boolean { Kind::Bool } else { Kind::Number }
}
