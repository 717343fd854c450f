//! Does `hyc compare` tell what runs cost and miss, and are the events of `masim` those of a tight run?

use std::fs;
use std::process::Command;

use crate::harness::{Case, Run};

fn hyc(words: &[&str]) -> (i32, String, String) {
    let root = env!("CARGO_MANIFEST_DIR");
    let output = Command::new(env!("CARGO_BIN_EXE_hyc")).args(words).current_dir(root).output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    (output.status.code().unwrap(), text(output.stdout), text(output.stderr))
}

#[test]
fn a_table_for_people_and_a_row_for_each_run() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("runs.csv");
    let words = "compare models/bumper_random.hy -p N=4:6:2 --seeds 3 --tolerance 1e-4,1e-6 --until 10 --csv";
    let words: Vec<&str> = words.split(' ').chain([file.to_str().unwrap()]).collect();
    let (code, table, err) = hyc(&words);
    assert_eq!((code, err.as_str()), (0, ""));
    let lines: Vec<&str> = table.lines().collect();
    assert_eq!(lines.len(), 1 + 2 * 2 * 3, "a line for each N, tolerance and algorithm:\n{table}");
    assert!(lines[0].contains("S rhs/ops/CPU"));
    let last = lines.iter().filter(|line| line.contains("sasim-2004"));
    assert!(
        last.clone().count() == 4 && last.clone().all(|line| line.ends_with("1.000 / 1.000 / 1.000")),
        "{table}"
    );
    let csv = fs::read_to_string(file).unwrap();
    let rows: Vec<Vec<&str>> = csv.lines().map(|line| line.split(',').collect()).collect();
    assert_eq!(rows.len(), 1 + 2 * 3 * 2 * 3);
    let column = |name: &str| rows[0].iter().position(|cell| *cell == name).unwrap();
    let mut events = 0;
    for row in &rows[1..] {
        assert_eq!(row.len(), rows[0].len());
        let number = |name: &str| row[column(name)].parse::<f64>().unwrap();
        assert!(number("operations") > number("rhs_evaluations"), "{row:?}");
        events += number("events") as usize;
        if row[column("algorithm")] == "masim" && number("tolerance") == 1e-6 {
            assert_eq!(row[column("agreed")], row[column("expected")], "{row:?}");
            assert_eq!(row[column("missed")], "", "certified detection is not compared with itself");
        }
    }
    assert!(events > 20, "{events}");
}

#[test]
fn own_clocks_cost_less_than_six_tenths_at_every_size_from_10_to_20() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("runs.csv");
    let words = "compare models/bumper_random.hy -p N=10:20 --tolerance 1e-3 --until 4 --csv";
    let words: Vec<&str> = words.split(' ').chain([file.to_str().unwrap()]).collect();
    assert_eq!(hyc(&words).0, 0);
    let csv = fs::read_to_string(file).unwrap();
    let rows: Vec<Vec<&str>> = csv.lines().map(|line| line.split(',').collect()).collect();
    let column = |name: &str| rows[0].iter().position(|cell| *cell == name).unwrap();
    let of = |name: &str| -> Vec<f64> {
        let rows = rows[1..].iter().filter(|row| row[column("algorithm")] == name);
        rows.map(|row| row[column("rhs_evaluations")].parse().unwrap()).collect()
    };
    let (own, one) = (of("masim-2004"), of("sasim-2004"));
    assert_eq!((own.len(), one.len()), (11, 11));
    for (n, (own, one)) in (10..).zip(own.iter().zip(&one)) {
        assert!(own / one < 0.6, "N = {n}: S = {}", own / one);
    }
}

#[test]
fn a_range_that_is_none_is_refused() {
    let (code, _, err) = hyc(&["compare", "models/bumper_random.hy", "-p", "N=5:2"]);
    assert_eq!(code, 2);
    assert!(err.contains("FROM:TO"), "{err}");
    let (code, _, err) = hyc(&["compare", "models/bumper_random.hy", "-p", "M=5"]);
    assert_eq!(code, 2, "{err}");
}

#[test]
fn cars_that_the_seed_draws_bump_where_they_should() {
    let path = format!("{}/models/bumper_random.hy", env!("CARGO_MANIFEST_DIR"));
    let text = fs::read_to_string(path).unwrap();
    let text = text.replace("run { until 20", "run { record Car.x, Car.y to \"cars.csv\" until 20");
    let run = Case::new(&text).seed(3).tolerance(1e-8).run();
    let half_side = 5.0 * 10f64.sqrt().ceil() - 0.5;
    let at = |agent: &str, time: f64| {
        let row = run.samples[0].iter().find(|row| row.agent == agent && row.time == time).unwrap();
        (row.cells[0], row.cells[1])
    };
    for event in &run.events {
        let (x, y) = at(&event.agent, event.time);
        let off = if event.other.is_empty() {
            x.abs().max(y.abs()) - half_side
        } else {
            let (other_x, other_y) = at(&event.other, event.time);
            (x - other_x).hypot(y - other_y) - 1.0
        };
        assert!(off.abs() < 1e-9, "{event:?}: {off:e}");
    }
    assert!(run.events.len() > 3, "{:?}", run.log());
}

/// The events of two runs are the same up to the first whose time has moved by more than 1e-3 s. How many that are.
fn same_events(run: &Run, tight: &Run) -> usize {
    let mut n = 0;
    for (event, expected) in run.events.iter().zip(&tight.events) {
        if (event.time - expected.time).abs() > 1e-3 {
            break;
        }
        let names = |event: &crate::harness::Fired| {
            (event.transition.clone(), event.agent.clone(), event.other.clone())
        };
        assert_eq!(names(event), names(expected), "at {}", event.time);
        n += 1;
    }
    n
}

#[test]
fn the_events_of_masim_are_those_of_a_tight_run() {
    let case = |seed: u64, tolerance: f64| {
        Case::shipped("bumper_random.hy").param("N", 8).seed(seed).tolerance(tolerance).run()
    };
    let (mut same, mut all) = (0, 0);
    for seed in 1..=6 {
        let tight = case(seed, 1e-12);
        all += tight.events.len();
        for tolerance in [1e-4, 1e-6, 1e-8] {
            let n = same_events(&case(seed, tolerance), &tight);
            same += if tolerance == 1e-8 { n } else { 0 };
        }
    }
    assert!(all > 15 && same == all, "{same} of {all}");
}

#[test]
fn guards_whose_members_change_with_states_are_not_for_the_published_algorithms() {
    let folder = tempfile::tempdir().unwrap();
    let model = folder.path().join("count.hy");
    let text = "agent A { state x = index  flow { x' = 1 }  full: when (count o in A where o.x >= 2) >= 2 { x := 0 } }
        system { all = A[3] }  run { until 1 }";
    fs::write(&model, text).unwrap();
    let model = model.to_str().unwrap();
    assert_eq!(hyc(&["run", model, "-q"]).0, 0);
    for words in
        [["run", model, "--algorithm", "masim-2004"], ["compare", model, "--algorithms", "masim,sasim-2004"]]
    {
        let (code, _, err) = hyc(&words);
        assert_eq!(code, 2, "{err}");
        assert!(err.contains("does not take") && err.contains("guards with count"), "{err}");
    }
    // whom only events change is known between them, and a state-dependent `where` in an action is asked at an event only
    let text = "agent A { state x = index  discrete open: bool = true, n: int = 0  flow { x' = 1 }
            shut: when x >= 3 { open := false  n := count o in A where o.x >= 2 }
            high: when (sum o in A where o.open: o.x) >= 4 { x := 0 } }
        system { all = A[3] }  run { until 1 }";
    fs::write(model, text).unwrap();
    assert_eq!(hyc(&["compare", model, "--algorithms", "masim,masim-2004,sasim-2004"]).0, 0);
}

/// Rows are on disk as runs end, and what is complete at an interruption is told.
#[cfg(unix)]
#[test]
fn an_interrupted_comparison_keeps_what_is_done() {
    use std::process::Stdio;
    use std::time::{Duration, Instant};
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("runs.csv");
    let child = Command::new(env!("CARGO_BIN_EXE_hyc"))
        .args([
            "compare",
            "models/bumper_random.hy",
            "-p",
            "N=4",
            "--seeds",
            "100000",
            "--until",
            "10",
            "--csv",
        ])
        .arg(&file)
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let rows = || fs::read_to_string(&file).map_or(0, |text| text.lines().count());
    let begun = Instant::now();
    while rows() < 8 && begun.elapsed() < Duration::from_secs(60) {
        std::thread::sleep(Duration::from_millis(20));
    }
    Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    let output = child.wait_with_output().unwrap();
    let (table, said) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert_eq!(output.status.code(), Some(130), "{said}");
    assert!(said.contains("of 100000 settings are complete"), "{said}");
    assert_eq!(table.lines().count(), 1 + 3, "{table}");
    let text = fs::read_to_string(&file).unwrap();
    let n = text.lines().next().unwrap().split(',').count();
    assert!(text.ends_with('\n') && text.lines().count() > 7);
    assert!(text.lines().all(|line| line.split(',').count() == n), "{text}");
}
