//! What a run leaves behind: event log, trajectories, final states, statistics, summary.
//!
//! In: what the runtime tells its observer, and the names that the program gives to agents and columns ([`Cast`]).
//! Out: tables written as the run proceeds ([`Tables`] is the observer), and two texts about the whole of it
//! ([`statistics`], [`summary`]). Promised: what has been told is in the files when the run ends, however it ends, and
//! the same run gives the same bytes. It opens no file: it is handed places to write to.

mod diagnostic_json;
mod columns;
mod comma_separated;
mod columnar;
mod table;
mod cast;
mod event_log;
mod trajectory;
mod final_states;
mod explanations;
mod tables;
mod report;
mod statistics;
mod summary;

#[cfg(test)]
mod tests;

pub use cast::{Cast, TypeColumns};
pub use columns::{Column, Kind};
pub use diagnostic_json::diagnostic_json;
pub use report::Report;
pub use statistics::statistics;
pub use summary::summary;
pub use table::{STANDARD_OUTPUT, Sink, unwritten};
pub use tables::Tables;
