//! The paper, reproduced: `cargo bench --bench paper` runs every experiment, draws every figure into docs/paper/ and writes
//! the tables of docs/PAPER.md anew. Names of experiments after `--` run only those.

mod agreement;
mod arena;
mod cars;
mod figure;
mod fit;
mod report;
mod step_model;
mod studies;
mod systems;
mod two_cars;

use std::time::Instant;

use report::Report;

fn main() {
    // Without names, and with those that cargo adds, everything is run.
    let wanted: Vec<String> = std::env::args().skip(1).filter(|word| !word.starts_with('-')).collect();
    let folder = figure::folder();
    std::fs::create_dir_all(&folder)
        .unwrap_or_else(|error| panic!("cannot make {}: {error}", folder.display()));
    let begun = Instant::now();
    let tick = |what: &str| eprintln!("{:6.1} s  {what}", begun.elapsed().as_secs_f64());
    let mut report = Report::open();
    let known =
        ["two_cars", "step_model", "arena", "agreement", "spread", "gamma", "systems", "roll_back", "many"];
    if let Some(word) = wanted.iter().find(|word| !known.contains(&word.as_str())) {
        panic!("there is no experiment `{word}`, but: {}", known.join(", "));
    }
    let is_wanted = |name: &str| wanted.is_empty() || wanted.iter().any(|word| word == name);
    if is_wanted("two_cars") {
        tick("two cars");
        two_cars::figures(&mut report);
    }
    if is_wanted("step_model") {
        tick("the step-size model");
        step_model::figures(&mut report);
    }
    if is_wanted("arena") {
        arena::figures(&mut report, &tick);
    }
    if is_wanted("agreement") {
        agreement::table(&mut report, &tick);
    }
    if is_wanted("spread") {
        studies::spread(&mut report, &tick);
    }
    if is_wanted("gamma") {
        studies::gamma(&mut report, &tick);
    }
    if is_wanted("systems") {
        tick("the systems that the paper stands on");
        systems::tables(&mut report);
    }
    if is_wanted("roll_back") {
        studies::roll_back(&mut report, &tick);
    }
    if is_wanted("many") {
        studies::many(&mut report, &tick);
    }
    tick("done");
}
