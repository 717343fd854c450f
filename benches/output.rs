//! How many rows a second the tables take, on one core: a trajectory with three recorded columns, of agents with modes.
//!
//! `cargo bench --bench output`; a number after `--` says how many million rows. Files go to the folder for temporary files.

#![allow(missing_docs, reason = "a program")]
#![allow(clippy::unwrap_used, reason = "a measurement that cannot go on fails")]

use std::fs::File;
use std::time::Instant;

use hyc::output::{Cast, Column, Kind, Sink, Tables};
use hyc::runtime::observe::{Cell, Observer, Row, Who};

const AGENTS: usize = 1000;

/// The memory of this process that is in use, MiB; 0 where the system does not say.
fn memory() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:")).unwrap_or("0");
    line.split_whitespace().next().map_or(0.0, |kib| kib.parse::<f64>().unwrap_or(0.0) / 1024.0)
}

fn main() {
    let millions = std::env::args().skip(1).find_map(|word| word.parse::<usize>().ok()).unwrap_or(4);
    let cast = Cast { agents: (0..AGENTS).map(|k| format!("cars[{k}]")).collect(), types: Vec::new() };
    let columns = ["x", "y", "th"].map(|name| Column::new(name, Kind::Number));
    println!("| form | rows/s | bytes a row | memory after a tenth, at the end |\n|---|---:|---:|---:|");
    for form in ["csv", "arrows", "arrow", "parquet"] {
        let path = std::env::temp_dir().join(format!("hyc_bench_{}.{form}", std::process::id()));
        let mut tables = Tables::new(&cast);
        let name = path.display().to_string();
        let writer = Box::new(File::create(&path).unwrap());
        tables.trajectory(Sink { name, writer }, &columns).unwrap();
        let rows = millions * 1_000_000;
        let mut early = 0.0;
        // numbers with all their digits, as states have them
        let mut angle: f64 = 0.1;
        let begun = Instant::now();
        for k in 0..rows {
            angle = (angle + 0.618_033_988_749_894_9) % 1.0;
            let time = (k / AGENTS) as f64 * 0.05;
            let cells = [Cell::Number(angle * 37.0), Cell::Number(1.0 - angle), Cell::Number(angle * 1e-3)];
            let mode = if angle < 0.9 { "Cruise" } else { "Brake" };
            let row = Row { time, micro: 0, agent: Who { number: k % AGENTS, ty: 0 }, mode, cells: &cells };
            tables.sample(0, &row).unwrap();
            if k == rows / 10 {
                early = memory();
            }
        }
        tables.finish().unwrap();
        let seconds = begun.elapsed().as_secs_f64();
        let late = memory();
        drop(tables);
        let bytes = std::fs::metadata(&path).unwrap().len();
        std::fs::remove_file(&path).unwrap();
        let (rate, each) = (rows as f64 / seconds / 1e6, bytes as f64 / rows as f64);
        println!("| {form} | {rate:.1} million | {each:.0} | {early:.0} MiB, {late:.0} MiB |");
    }
}
