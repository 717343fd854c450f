//! What becomes of files that cannot be written, and of models that cannot be read? The real binary, in a folder of its own.

use std::fs;

use crate::cli::{BALL, expect, folder, hyc, json, read};

#[test]
fn a_run_that_is_refused_leaves_what_the_last_one_wrote() {
    let folder = folder(&[("ball.hy", BALL)]);
    let written = ["run", "ball.hy", "-q", "--events", "e.csv", "--final", "f.csv"];
    expect(&hyc(&folder, &written), 0, &[]);
    let (events, finals) = (read(&folder, "e.csv"), read(&folder, "f.csv"));
    assert!(events.lines().count() > 1 && finals.lines().count() > 1);
    let refused: [&[&str]; 3] = [
        &["--events", "e.csv", "--stats", "new.json", "--final", "nowhere/f.csv"],
        &["--events", "e.csv", "--stats", "new.json", "--final", "./e.csv"],
        &["--events", "e.csv", "--stats", "new.json", "--final", "f.csv", "--explain-events", "ball.hy"],
    ];
    for outputs in refused {
        let words: Vec<&str> = ["run", "ball.hy"].iter().chain(outputs).copied().collect();
        expect(&hyc(&folder, &words), 2, &["error"]);
        assert_eq!(read(&folder, "e.csv"), events, "{outputs:?}");
        assert_eq!(read(&folder, "f.csv"), finals, "{outputs:?}");
        assert!(!folder.path().join("new.json").exists(), "no empty file is left: {outputs:?}");
    }
    // what is written is not longer than what was there by what was there
    expect(&hyc(&folder, &["run", "ball.hy", "-q", "--until", "0", "--events", "e.csv"]), 0, &[]);
    assert_eq!(read(&folder, "e.csv").lines().count(), 1);
}

#[test]
fn a_model_that_cannot_be_read_is_told_with_its_place() {
    let here = folder(&[("good.hy", BALL)]);
    fs::write(here.path().join("latin.hy"), b"param a = 1\nparam b = 2 // caf\xe9\n").unwrap();
    let done = hyc(&here, &["check", "latin.hy"]);
    expect(&done, 2, &["error[HY0120]: cannot read `latin.hy`: it is not text in UTF-8", "latin.hy:2:19"]);
    expect(&hyc(&here, &["run", "latin.hy"]), 2, &["HY0120", "latin.hy:2:19"]);
    let done = hyc(&here, &["check", "none.hy"]);
    expect(&done, 2, &["error[HY0120]: cannot read `none.hy`: No such file", "help: "]);

    let done = hyc(&here, &["check", "good.hy", "latin.hy", "none.hy", "--format", "json"]);
    assert_eq!(done.code, 2);
    let found = json(&done.out);
    let models = found["models"].as_array().unwrap();
    assert_eq!(
        models.iter().map(|model| model["ok"].as_bool().unwrap()).collect::<Vec<_>>(),
        [true, false, false]
    );
    let of_latin = &models[1]["diagnostics"][0];
    assert_eq!((&of_latin["code"], &of_latin["labels"][0]["line"]), (&"HY0120".into(), &2.into()));
    assert_eq!(models[2]["diagnostics"][0]["labels"][0]["file"], "none.hy");

    let done = hyc(&here, &["check", "latin.hy", "none.hy", "--format", "sarif"]);
    let results = json(&done.out)["runs"][0]["results"].as_array().unwrap().clone();
    assert_eq!(results.len(), 2);
    assert!(results.iter().all(|result| result["ruleId"] == "HY0120"));
}

#[test]
fn one_file_imported_by_two_spellings_is_imported_once() {
    let here = folder(&[]);
    fs::create_dir(here.path().join("b")).unwrap();
    let place = |name: &str| here.path().join("b").join(name);
    fs::write(place("lib.hy"), "param q = 2\n").unwrap();
    let model = "import \"lib.hy\"\nimport \"../b/lib.hy\"\nagent A { state x = q  flow { x' = 1 } }\nsystem { a = A() }\n";
    fs::write(place("m.hy"), model).unwrap();
    expect(&hyc(&here, &["check", "b/m.hy"]), 0, &["no errors"]);
    fs::write(place("own.hy"), "import \"../b/own.hy\"\n").unwrap();
    expect(&hyc(&here, &["check", "b/own.hy"]), 1, &["HY0214", "imports itself"]);
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink(place("lib.hy"), place("other.hy")).unwrap();
        fs::write(place("m.hy"), model.replace("../b/lib.hy", "other.hy")).unwrap();
        expect(&hyc(&here, &["check", "b/m.hy"]), 0, &["no errors"]);
    }
}

#[test]
fn a_reader_of_an_output_that_goes_away_is_no_error() {
    use std::process::{Command, Stdio};
    let model = BALL.replace("until 1 ", "until 1e9 ").replace("v := -0.8*v", "v := -v");
    let here = folder(&[("ball.hy", &model), ("short.hy", BALL)]);
    for words in [
        &["run", "ball.hy", "--events", "-"][..],
        &["run", "ball.hy", "--record", "-"],
        &["run", "ball.hy", "--explain-events"],
        &["run", "short.hy", "--final", "-"],
        &["run", "short.hy", "--stats", "-"],
        &["report", "short.hy", "-o", "-", "-q"],
    ] {
        let mut command = Command::new(env!("CARGO_BIN_EXE_hyc"));
        command.args(words).current_dir(here.path()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = command.spawn().unwrap();
        drop(child.stdout.take());
        let output = child.wait_with_output().unwrap();
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(0), "{words:?}: {said}");
        assert!(!said.contains("error") && !said.contains("Broken pipe"), "{words:?}: {said}");
    }
}

#[test]
fn an_ending_that_promises_something_else_is_refused() {
    let here = folder(&[("ball.hy", BALL)]);
    for (option, name) in
        [("--events", "e.csv.gz"), ("--record", "r.json"), ("--final", "f.tsv"), ("--record", "r.XLSX")]
    {
        let words = ["run", "ball.hy", option, name];
        expect(&hyc(&here, &words), 2, &[name, "`.csv`", "`.parquet`"]);
        assert!(!here.path().join(name).exists());
    }
    expect(&hyc(&here, &["run", "ball.hy", "--report", "r.csv"]), 2, &["`r.csv`: a page is `.html`"]);
    expect(&hyc(&here, &["report", "ball.hy", "-o", "r.svg"]), 2, &["`r.svg`: a page is `.html`"]);
    let named = BALL.replace("events.csv", "events.json");
    fs::write(here.path().join("named.hy"), named).unwrap();
    expect(&hyc(&here, &["run", "named.hy"]), 2, &["events.json"]);
    // Feather is the file form of Arrow
    expect(&hyc(&here, &["run", "ball.hy", "-q", "--final", "f.feather", "--record", "r.dat"]), 0, &[]);
    assert!(fs::read(here.path().join("f.feather")).unwrap().starts_with(b"ARROW1"));
    assert!(read(&here, "r.dat").starts_with("time,"));
}

#[test]
fn values_that_cannot_be_are_refused_with_what_can() {
    let here = folder(&[("ball.hy", BALL)]);
    let bare = ["HY0261", "must be a bare number, in its declared unit"];
    expect(&hyc(&here, &["run", "ball.hy", "-p", "g=10 [m/s^2]"]), 2, &bare);
    expect(&hyc(&here, &["run", "ball.hy", "--seed", "-1"]), 2, &["invalid value '-1' for '--seed"]);
}
