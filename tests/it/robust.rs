//! Does anything make it panic, hang or eat memory? Mutants of all models and of the error cases, through every floor.
//!
//! What comes out of a mutant must be a diagnostic, which must be drawn, or a run that ends by itself or by a limit. The
//! limits of a run are small here, and what watches it interrupts it after so many rows, so that nothing rests on the
//! clock; a watchdog ends the process if one mutant takes minutes. `cargo test` tries 400 mutants;
//! `HYC_MUTANTS=20000 cargo test --test it robust:: -- --nocapture` tries so many, from number `HYC_FIRST` (0) on. A mutant
//! that takes the process with it is left in `target/tmp/mutant-N.hy`; `HYC_MUTANTS=1 HYC_FIRST=n` is mutant n alone.

pub mod mutate;
mod survive;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

use crate::differential::dice::Dice;
use crate::differential::generate;
use survive::{Library, survive};

/// A number from the environment.
fn setting(name: &str, default: u64) -> u64 {
    let text = std::env::var(name).ok();
    text.map_or(default, |text| text.parse().unwrap_or_else(|_| panic!("{name} is no number: {text}")))
}

/// All files below these folders that end so, in order.
fn files(ending: &str) -> Vec<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut folders = vec![root.join("models"), root.join("tests/it")];
    let mut found = Vec::new();
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|extension| extension == ending) {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}

/// The models that are mutated: the error cases, the shipped ones four times, the good examples of the codes, random ones.
fn models() -> Vec<String> {
    let mut texts: Vec<String> = (0..40).map(generate::model).collect();
    for explanation in hyc::cli::explanations() {
        let fenced = explanation.body.split("```hy\n").skip(1);
        texts.extend(fenced.filter_map(|rest| Some(rest.split_once("```")?.0.to_string())));
    }
    for path in files("hy") {
        let text = std::fs::read_to_string(&path).unwrap();
        let times = if path.components().any(|part| part.as_os_str() == "models") { 4 } else { 1 };
        texts.extend(std::iter::repeat_n(text, times));
    }
    texts.retain(|text| text.len() < 20_000);
    texts
}

fn mutant(number: u64, texts: &[String]) -> String {
    mutate::mutant(&mut Dice::new(number ^ 0x5eed), texts)
}

#[test]
fn a_mutant_is_refused_or_runs() {
    let (first, count) = (setting("HYC_FIRST", 0), setting("HYC_MUTANTS", 400));
    let texts = models();
    let library = Library::read(&files("csv"));
    let (next, fates) = (AtomicU64::new(first), Mutex::new(BTreeMap::<String, u64>::new()));
    let panicked = Mutex::new(Vec::new());
    let work = |worker: usize| {
        let trace = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("mutant-{worker}.hy"));
        loop {
            let number = next.fetch_add(1, Ordering::Relaxed);
            if number >= first + count {
                let _ = std::fs::remove_file(&trace);
                return;
            }
            let text = mutant(number, &texts);
            std::fs::write(&trace, &text).unwrap();
            if count == 1 {
                println!("{text}");
            }
            match survive(number, &text, &library) {
                Ok(fate) => *fates.lock().unwrap().entry(fate.to_string()).or_default() += 1,
                Err(()) => panicked.lock().unwrap().push(number),
            }
        }
    };
    std::thread::scope(|scope| {
        for worker in 0..std::thread::available_parallelism().map_or(1, usize::from) {
            scope.spawn(move || work(worker));
        }
    });
    let fates = fates.into_inner().unwrap();
    println!("{fates:#?}");
    let panicked = panicked.into_inner().unwrap();
    assert!(panicked.is_empty(), "mutants that panic (look with HYC_MUTANTS=1 HYC_FIRST=n): {panicked:?}");
    // A test of mutants that all die young is none.
    let ran: u64 = fates.iter().filter(|(fate, _)| fate.starts_with("ran")).map(|(_, n)| n).sum();
    assert!(count < 100 || 10 * ran > count, "only {ran} of {count} mutants ran: {fates:#?}");
}
