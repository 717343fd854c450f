//! Does the program do what its interface says? The real binary, in folders of its own: exit codes, files, messages.

use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use serde_json::Value;
use tempfile::TempDir;

/// A ball that bounces until t = 4 s.
pub const BALL: &str = "\
param g: real [m/s^2] = 9.81
agent Ball(h: real [m] = 1) {
  state x: real [m] = h, v: real [m/s] = 0
  discrete n: int = 0
  flow { x' = v  v' = -g }
  bounce: when x <= 0 { v := -0.8*v  n := n + 1 }
}
system { ball = Ball()  others = Ball[2](h = 2 + index) }
run { until 1  tolerance 1e-8  record ball every 0.25 to \"ball.csv\"  events to \"events.csv\" }
";

/// A folder with files in it.
pub fn folder(files: &[(&str, &str)]) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        fs::write(folder.path().join(name), text).unwrap();
    }
    folder
}

/// What became of the program.
pub struct Done {
    pub code: i32,
    pub out: String,
    pub err: String,
}

fn done(output: Output) -> Done {
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    Done { code: output.status.code().unwrap(), out: text(output.stdout), err: text(output.stderr) }
}

fn command(folder: &Path, words: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_hyc"));
    command.args(words).current_dir(folder);
    command
}

pub fn hyc(folder: &TempDir, words: &[&str]) -> Done {
    done(command(folder.path(), words).output().unwrap())
}

pub fn read(folder: &TempDir, name: &str) -> String {
    fs::read_to_string(folder.path().join(name)).unwrap()
}

pub fn json(text: &str) -> Value {
    serde_json::from_str(text).unwrap()
}

#[track_caller]
pub fn expect(done: &Done, code: i32, words: &[&str]) {
    let said = format!("{}{}", done.out, done.err);
    assert_eq!(done.code, code, "{said}");
    for word in words {
        assert!(said.contains(word), "no {word:?} in {said}");
    }
    assert!(!said.contains("panicked"), "{said}");
}

#[test]
fn a_run_writes_what_the_model_names_and_tells_in_short() {
    let folder = folder(&[("ball.hy", BALL)]);
    let done = hyc(&folder, &["run", "ball.hy"]);
    expect(&done, 0, &["ended at t = 1 s", "3 agents", "Ball.bounce", "ball.csv", "events.csv"]);
    assert_eq!(done.err, "");
    let events = read(&folder, "events.csv");
    assert!(events.starts_with("time,micro,transition,agent,other,from,to\n"), "{events}");
    assert!(events.lines().nth(1).unwrap().ends_with(",0,Ball.bounce,ball,,,"), "{events}");
    let record = read(&folder, "ball.csv");
    let lines: Vec<&str> = record.lines().collect();
    assert_eq!(lines[0], "time,micro,agent,mode,x,v,n");
    assert_eq!(lines[1], "0,0,ball,,1,0,0");
    assert_eq!(lines.len(), 6, "{record}");
    assert!(!record.contains('\r'));
}

#[test]
fn outputs_of_the_command_line_go_where_it_says() {
    let folder = folder(&[("ball.hy", BALL)]);
    let words = ["run", "ball.hy", "-q", "-o", "new/out", "--final", "last.csv", "--stats", "stats.json"];
    let done = hyc(&folder, &words);
    expect(&done, 0, &[]);
    assert_eq!(done.out + &done.err, "");
    assert!(
        folder.path().join("new/out/ball.csv").exists() && folder.path().join("new/out/events.csv").exists()
    );
    let last = read(&folder, "last.csv");
    assert!(last.starts_with("time,agent,mode,x,v,n\n1,ball,,"), "{last}");
    assert_eq!(last.lines().nth(3).unwrap().split(',').nth(1), Some("others[1]"));
    let stats = json(&read(&folder, "stats.json"));
    assert_eq!(stats["model"], "ball.hy");
    assert_eq!(stats["algorithm"], "masim");
    assert_eq!(stats["backend"], "auto");
    assert_eq!(stats["tolerance"], 1e-8);
    assert_eq!(stats["until"], 1.0);
    assert_eq!(stats["agents"], 3);
    assert_eq!(stats["end"]["kind"], "until");
    let rows = read(&folder, "new/out/events.csv").lines().count() as u64 - 1;
    assert_eq!(stats["events"], rows);
    assert_eq!(stats["transitions"]["Ball.bounce"], rows);
    assert_eq!(stats["types"]["Ball"]["agents"], 3);
}

#[test]
fn the_command_line_is_laid_over_the_model() {
    let folder = folder(&[("ball.hy", BALL)]);
    let words = ["run", "ball.hy", "-q", "--until", "0.5", "-p", "g=20", "--tolerance", "1e-5", "--absolute"];
    let words = [&words[..], &["1e-4", "--seed", "7", "--stats", "s.json", "--final", "f.csv"]].concat();
    expect(&hyc(&folder, &words), 0, &[]);
    let stats = json(&read(&folder, "s.json"));
    assert_eq!(
        (&stats["until"], &stats["tolerance"], &stats["absolute"], &stats["seed"]),
        (&0.5.into(), &1e-5.into(), &1e-4.into(), &7.into())
    );
    assert_eq!(stats["events"], 2, "with g = 20 the balls bounce at t = 0.316, 0.447 and 0.548");
}

#[test]
fn both_back_ends_and_any_number_of_threads_give_the_same_bytes() {
    let folder = folder(&[("ball.hy", BALL)]);
    let variants: [&[&str]; 4] = [&[], &["--backend", "interp"], &["-j", "1"], &["-j", "2"]];
    let written = variants.map(|variant| {
        let words = [&["run", "ball.hy", "-q", "--final", "f.csv"], variant].concat();
        expect(&hyc(&folder, &words), 0, &[]);
        [read(&folder, "f.csv"), read(&folder, "events.csv"), read(&folder, "ball.csv")]
    });
    assert!(written.iter().all(|files| *files == written[0]));
}

#[test]
fn the_event_log_goes_to_standard_output_and_the_summary_aside() {
    let folder = folder(&[("ball.hy", BALL)]);
    let done = hyc(&folder, &["run", "ball.hy", "--events", "-"]);
    expect(&done, 0, &[]);
    assert!(done.out.starts_with("time,micro,"), "{}", done.out);
    assert!(!done.out.contains("ended at"));
    assert!(done.err.contains("ended at t = 1 s"));
    assert!(!folder.path().join("events.csv").exists());
}

#[test]
fn a_record_is_made_up_where_the_model_has_none() {
    let text = BALL.replace("record ball every 0.25 to \"ball.csv\"", "");
    let folder = folder(&[("ball.hy", BALL), ("plain.hy", &text)]);
    expect(&hyc(&folder, &["run", "plain.hy", "--record", "all.csv"]), 0, &["all.csv"]);
    let record = read(&folder, "all.csv");
    assert!(record.starts_with("time,micro,agent,mode,x,v,n\n0,0,ball,,1,0,0\n"), "{record}");
    assert!(record.contains(",others[1],"));
    expect(&hyc(&folder, &["run", "ball.hy", "--record", "mine.csv"]), 0, &["mine.csv"]);
    assert!(read(&folder, "mine.csv").starts_with("time,micro,agent,mode,x,v,n\n"));
    assert!(!folder.path().join("ball.csv").exists());
}

#[test]
fn a_model_with_errors_ends_with_1_and_writes_nothing() {
    let folder = folder(&[("bad.hy", &BALL.replace("x' = v", "x' = speed"))]);
    let done = hyc(&folder, &["run", "bad.hy"]);
    expect(&done, 1, &["error[HY02", "speed", "bad.hy:5:"]);
    assert!(!folder.path().join("events.csv").exists());
}

#[test]
fn wrong_usage_ends_with_2_and_says_what_is_wrong() {
    let folder = folder(&[("ball.hy", BALL), ("endless.hy", &BALL.replace("until 1 ", ""))]);
    let cases: [(&[&str], &str); 20] = [
        (&["run", "endless.hy"], "the run has no end"),
        (&["run", "missing.hy"], "cannot read `missing.hy`: No such file"),
        (&["run"], "MODEL.hy"),
        (&["rum", "ball.hy"], "run"),
        (&["run", "ball.hy", "--untl", "3"], "--until"),
        (&["run", "ball.hy", "--until", "soon"], "soon"),
        (&["run", "ball.hy", "--tolerance", "0"], "positive"),
        (&["run", "ball.hy", "-p", "g"], "NAME=VALUE"),
        (&["run", "ball.hy", "-j", "0"], "0"),
        (&["run", "ball.hy", "--algorithm", "masim-2004", "--integrator", "tsit5"], "not by `tsit5`"),
        (&["run", "ball.hy", "--algorithm", "sasim-2004", "--h-min", "1"], "`--h-min` 1 is more"),
        (&["run", "ball.hy", "--algorithm", "sasim-2004", "--gamma", "1"], "below 1"),
        (&["run", "ball.hy", "--gamma", "0.5"], "`--gamma` belongs to"),
        (&["run", "ball.hy", "--integrator", "euler"], "write auto, taylor, tsit5, adams or stiff"),
        (&["run", "ball.hy", "--limit", "max_stepz=1"], "max_steps"),
        (&["check", "ball.hy", "--deny", "HY9999"], "no warning `HY9999`"),
        (&["check", "ball.hy", "--allow", "warnings"], "no warning `warnings`"),
        (&["run", "ball.hy", "--allow", "HY06"], "no warning `HY06`"),
        (&["explain", "HY9999"], "no code `HY9999`"),
        (&["show", "ball.hy", "--stage", "soup"], "system"),
    ];
    for (words, message) in cases {
        let done = hyc(&folder, words);
        expect(&done, 2, &[message]);
        assert_eq!(done.out, "", "{words:?}");
    }
}

#[test]
fn a_param_that_the_model_does_not_have_is_refused() {
    let folder = folder(&[("ball.hy", BALL)]);
    expect(&hyc(&folder, &["run", "ball.hy", "-p", "gg=3"]), 2, &["HY0260", "gg"]);
    expect(&hyc(&folder, &["run", "ball.hy", "-p", "g=fast"]), 2, &["HY0261", "fast"]);
    assert!(!folder.path().join("events.csv").exists());
}

#[test]
fn what_cannot_be_written_ends_with_2() {
    let folder = folder(&[("ball.hy", BALL), ("file", "")]);
    let cases: [(&[&str], &str); 5] = [
        (&["run", "ball.hy", "--events", "nowhere/e.csv"], "cannot write `nowhere/e.csv`: No such file"),
        (&["run", "ball.hy", "-o", "file/below"], "cannot make the folder `file/below`"),
        (&["run", "ball.hy", "--stats", "a", "--final", "./a"], "two outputs go to `"),
        (&["run", "ball.hy", "--final", "ball.hy"], "`ball.hy` is a file that this run reads"),
        (&["run", "ball.hy", "--events", "-", "--final", "-"], "two outputs go to standard output"),
    ];
    for (words, message) in cases {
        expect(&hyc(&folder, words), 2, &[message]);
    }
    assert_eq!(read(&folder, "ball.hy"), BALL);
}

#[cfg(target_os = "linux")]
#[test]
fn what_is_no_model_ends_with_2_and_says_why() {
    let here = folder(&[("empty.hy", "")]);
    expect(&hyc(&here, &["check", "empty.hy"]), 0, &["empty.hy: no errors"]);
    expect(&hyc(&here, &["run", "empty.hy"]), 2, &["the run has no end"]);
    fs::write(here.path().join("latin.hy"), b"param a = 1 // caf\xe9").unwrap();
    expect(&hyc(&here, &["check", "latin.hy"]), 2, &["cannot read `latin.hy`", "UTF-8"]);
    expect(&hyc(&here, &["check", "."]), 2, &["cannot read `.`", "directory"]);
    expect(&hyc(&here, &["check", "/dev/zero"]), 2, &["cannot read `/dev/zero`", "larger than 32 MiB"]);
    expect(&hyc(&here, &["check", "empty.hy/inside.hy"]), 2, &["cannot read"]);
}

#[test]
fn limits_have_names() {
    let here = folder(&[("ball.hy", BALL)]);
    expect(&hyc(&here, &["check", "ball.hy", "--limit", "max_agents=2"]), 1, &["HY0291"]);
    expect(&hyc(&here, &["run", "ball.hy", "--limit", "max_operations=3"]), 1, &["HY0307"]);
    expect(&hyc(&here, &["show", "ball.hy", "--stage", "model", "--limit", "max_values=3"]), 1, &["HY0296"]);
    expect(&hyc(&here, &["run", "ball.hy", "--limit", "max_steps=3"]), 3, &["HY0508"]);
    let wrong = ["there is no limit `agents`", "max_agents", "max_pieces"];
    expect(&hyc(&here, &["run", "ball.hy", "--limit", "agents=3"]), 2, &wrong);
}

#[test]
fn a_full_disk_ends_with_2_and_names_the_file() {
    let folder = folder(&[("ball.hy", BALL)]);
    for output in ["--events", "--final", "--stats", "--record"] {
        expect(&hyc(&folder, &["run", "ball.hy", output, "/dev/full"]), 2, &["`/dev/full`", "No space left"]);
    }
}

#[test]
fn a_run_that_stops_in_error_ends_with_3_and_keeps_what_it_has() {
    let text = BALL.replace("discrete n: int = 0", "discrete n: int = 0\n  invariant x <= 2.5 or time < 0.3");
    let folder = folder(&[("ball.hy", &text)]);
    let done = hyc(&folder, &["run", "ball.hy", "--final", "f.csv", "--stats", "s.json"]);
    expect(&done, 3, &["error[HY05", "others[1]", "ball.hy:", "stopped in error at t = 0.3"]);
    assert_eq!(read(&folder, "ball.csv").lines().count(), 3, "samples at 0 and 0.25");
    assert_eq!(read(&folder, "f.csv").lines().count(), 4);
    let stats = json(&read(&folder, "s.json"));
    assert_eq!(stats["end"]["kind"], "error");
    assert_eq!(stats["end"]["message"], stats["end"]["title"]);
    assert_eq!(stats["end"]["labels"][0]["file"], "ball.hy");
    assert!(
        stats["end"]["notes"]
            .as_array()
            .unwrap()
            .iter()
            .any(|note| note.as_str().unwrap().contains("at t = 0.3"))
    );
    assert!(stats["end"]["code"].as_str().unwrap().starts_with("HY05"));
}

#[test]
fn a_false_assert_ends_with_4_unless_it_is_a_warning() {
    let text = BALL.replace("flow {", "assert x >= 0.5 \"too low\"\n  flow {");
    let folder = folder(&[("ball.hy", &text)]);
    let done = hyc(&folder, &["run", "ball.hy", "--stats", "s.json"]);
    expect(&done, 4, &["HY0590", "too low", "`ball`", "ended at t = 1 s"]);
    assert_eq!(json(&read(&folder, "s.json"))["false_asserts"][0]["message"], "too low");
    expect(&hyc(&folder, &["run", "ball.hy", "--assert", "warn"]), 0, &["HY0590"]);
}

#[test]
fn a_stop_is_a_good_end() {
    let text =
        BALL.replace("until 1", "until 100").replace("{ v := -0.8*v", "{ stop \"touched\" v := -0.8*v");
    let folder = folder(&[("ball.hy", &text)]);
    let done = hyc(&folder, &["run", "ball.hy", "--stats", "s.json"]);
    expect(&done, 0, &["stopped at t = 0.45", "Ball.bounce", "touched"]);
    assert_eq!(json(&read(&folder, "s.json"))["end"]["reason"], "touched");
}

#[test]
fn check_reports_every_model_and_the_worst_decides() {
    let bad = BALL.replace("x' = v", "x' = speed");
    let worse = BALL.replace("agent Ball", "agent agent");
    let folder = folder(&[("good.hy", BALL), ("bad.hy", &bad), ("worse.hy", &worse)]);
    expect(&hyc(&folder, &["check", "good.hy"]), 0, &["good.hy: no errors"]);
    let done = hyc(&folder, &["check", "bad.hy", "good.hy", "worse.hy"]);
    expect(&done, 1, &["bad.hy:5:", "worse.hy:2:", "good.hy: no errors"]);
    expect(&hyc(&folder, &["check", "bad.hy", "gone.hy"]), 2, &["bad.hy:5:", "cannot read `gone.hy`"]);
}

#[test]
fn check_in_json_gives_places_and_codes() {
    let folder = folder(&[("good.hy", BALL), ("bad.hy", &BALL.replace("x' = v", "x' = speed"))]);
    let done = hyc(&folder, &["check", "--format", "json", "good.hy", "bad.hy"]);
    assert_eq!(done.code, 1);
    assert_eq!(done.err, "");
    let models = json(&done.out);
    let (good, bad) = (&models["models"][0], &models["models"][1]);
    assert_eq!((&good["ok"], &bad["ok"]), (&true.into(), &false.into()));
    assert_eq!(good["diagnostics"].as_array().unwrap().len(), 0);
    let diagnostic = &bad["diagnostics"][0];
    assert_eq!(diagnostic["severity"], "error");
    assert!(diagnostic["code"].as_str().unwrap().starts_with("HY02"));
    let label = &diagnostic["labels"][0];
    assert_eq!(
        (&label["file"], &label["line"], &label["column"], &label["end_column"]),
        (&"bad.hy".into(), &5.into(), &15.into(), &20.into())
    );
}

#[test]
fn check_says_how_pairs_are_counted() {
    let bump = "interaction Bump(a: Ball, b: Ball) {
  touch: when a.x + b.x <= 0.1 { a.v := 0 b.v := 0 }
  infect: when a.x <= b.x - 1 { b.n := 5 }
}
";
    let folder = folder(&[("ball.hy", &format!("{bump}{BALL}"))]);
    let words =
        ["Bump.touch: one flag for each unordered pair", "Bump.infect: one flag for each ordered pair"];
    expect(&hyc(&folder, &["check", "ball.hy"]), 0, &words);
}

#[test]
fn data_that_is_not_there_ends_with_2_and_names_the_place() {
    let text = BALL.replace("Ball[2](h = 2 + index)", "Ball[] from csv(\"balls.csv\")");
    let folder = folder(&[("ball.hy", &text)]);
    expect(&hyc(&folder, &["run", "ball.hy"]), 2, &["balls.csv", "ball.hy:8:"]);
    fs::write(folder.path().join("balls.csv"), "i,h\n0,3\n1,4\n").unwrap();
    fs::create_dir(folder.path().join("elsewhere")).unwrap();
    let from = done(command(&folder.path().join("elsewhere"), &["run", "../ball.hy"]).output().unwrap());
    expect(&from, 0, &["3 agents"]);
}

#[test]
fn every_stage_can_be_shown() {
    let folder = folder(&[("ball.hy", BALL)]);
    for stage in ["ast", "model", "system", "tape", "clif"] {
        let done = hyc(&folder, &["show", "ball.hy", "--stage", stage]);
        expect(&done, 0, &["all"]);
        assert_eq!(done.err, "", "{stage}");
        assert_eq!(done.out, hyc(&folder, &["show", "ball.hy", "--stage", stage]).out, "{stage}");
    }
    fs::write(folder.path().join("bad.hy"), BALL.replace("x' = v", "x' = speed")).unwrap();
    expect(&hyc(&folder, &["show", "bad.hy", "--stage", "ast"]), 0, &["speed"]);
    expect(&hyc(&folder, &["show", "bad.hy", "--stage", "model"]), 1, &["error[HY02"]);
}

#[test]
fn a_reader_that_goes_away_is_no_error() {
    let folder = folder(&[("ball.hy", BALL)]);
    for words in [&["show", "ball.hy", "--stage", "system"][..], &["explain"], &["check", "ball.hy"]] {
        let mut child =
            command(folder.path(), words).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        drop(child.stdout.take());
        let done = done(child.wait_with_output().unwrap());
        expect(&done, 0, &[]);
        assert_eq!(done.err, "");
    }
}

/// Runs a command until there is something in a file, and interrupts it.
#[cfg(unix)]
fn interrupted(folder: &TempDir, words: &[&str], file: &str) -> Done {
    use std::time::{Duration, Instant};
    let child = command(folder.path(), words).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let begun = Instant::now();
    let path = folder.path().join(file);
    while fs::metadata(&path).map_or(0, |file| file.len()) == 0 && begun.elapsed() < Duration::from_secs(60) {
        std::thread::sleep(Duration::from_millis(20));
    }
    Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    done(child.wait_with_output().unwrap())
}

#[cfg(unix)]
#[test]
fn an_interruption_ends_with_130_and_keeps_what_was_computed() {
    let text = BALL
        .replace("until 1 ", "until 1e9 ")
        .replace("bounce: when x <= 0 { v := -0.8*v", "bounce: when x <= 0 { v := -v");
    let folder = folder(&[("ball.hy", &text)]);
    let words = ["run", "ball.hy", "--stats", "s.json", "--final", "f.csv"];
    let done = interrupted(&folder, &words, "events.csv");
    expect(&done, 130, &["interrupted at t = "]);
    assert_eq!(json(&read(&folder, "s.json"))["end"]["kind"], "interrupted");
    assert_eq!(read(&folder, "f.csv").lines().count(), 4);
    let events = read(&folder, "events.csv");
    assert!(events.ends_with('\n'));
    assert_eq!(json(&read(&folder, "s.json"))["events"], events.lines().count() as u64 - 1);
}

#[test]
fn codes_are_explained_and_listed() {
    let folder = folder(&[]);
    let list = hyc(&folder, &["explain"]);
    expect(&list, 0, &["HY0590"]);
    let code = list.out.split_whitespace().next().unwrap();
    let text = hyc(&folder, &["explain", &code.to_lowercase()]);
    expect(&text, 0, &[code]);
    assert!(!text.out.contains("```"));
}

#[test]
fn help_and_version_are_fine() {
    let folder = folder(&[]);
    expect(&hyc(&folder, &["--help"]), 0, &["run", "check", "show", "explain"]);
    expect(&hyc(&folder, &["run", "--help"]), 0, &["--until", "--events", "--backend"]);
    expect(&hyc(&folder, &["--version"]), 0, &[env!("CARGO_PKG_VERSION")]);
}

#[test]
fn events_are_explained_where_one_says() {
    let folder = folder(&[("ball.hy", BALL)]);
    let plain = hyc(&folder, &["run", "ball.hy", "--stats", "plain.json", "--events", "plain.csv"]);
    expect(&plain, 0, &[]);
    let words = ["run", "ball.hy", "--explain-events=why.txt", "--stats", "s.json", "--events", "e.csv"];
    expect(&hyc(&folder, &words), 0, &["why.txt"]);
    let text = read(&folder, "why.txt");
    let n_events = read(&folder, "e.csv").lines().count() - 1;
    assert_eq!(text.matches("t = ").count(), n_events, "{text}");
    assert!(text.contains(" of ball") && text.contains("ball.hy:"), "{text}");
    assert_eq!(read(&folder, "e.csv"), read(&folder, "plain.csv"));
    let without_times = |name: &str| {
        let mut stats = json(&read(&folder, name));
        for key in ["compile_seconds", "compile_parts", "writing_seconds", "run_seconds"] {
            stats[key] = serde_json::Value::Null;
        }
        stats
    };
    assert_eq!(without_times("s.json"), without_times("plain.json"));
    let done = hyc(&folder, &["run", "ball.hy", "--explain-events"]);
    expect(&done, 0, &[]);
    assert_eq!(done.out, text, "the summary makes room");
}

#[test]
fn a_false_property_has_the_exit_code_of_a_false_claim_and_is_told() {
    let text = format!(
        "{BALL}property low = always forall b in Ball: b.x <= 2.5 [m]\nproperty hit = eventually exists b in Ball: b.n >= 1\n"
    );
    let folder = folder(&[("ball.hy", &text), ("good.hy", &text.replace("2.5 [m]", "3.5 [m]"))]);
    let done = hyc(&folder, &["run", "ball.hy", "--stats", "s.json"]);
    expect(&done, 4, &["HY0521", "the property `low` is false", "margin -0.5 at t = 0 s for b = others[1]"]);
    assert!(done.out.contains("low  FALSE  margin -0.5"), "{}", done.out);
    assert!(done.out.contains("hit  holds  margin 0 at t = 0.45"), "{}", done.out);
    let stats = json(&read(&folder, "s.json"));
    assert_eq!(
        (&stats["properties"][0]["holds"], &stats["properties"][1]["holds"]),
        (&json("false"), &json("true"))
    );
    assert_eq!(stats["properties"][0]["agents"]["b"], "others[1]");
    assert_eq!(stats["types"].as_object().unwrap().len(), 1);
    expect(&hyc(&folder, &["run", "ball.hy", "--assert", "warn"]), 0, &["HY0521"]);
    let good = hyc(&folder, &["run", "good.hy"]);
    assert_eq!((good.code, good.err.as_str()), (0, ""));
    let paper = hyc(&folder, &["run", "good.hy", "--algorithm", "masim-2004"]);
    expect(&paper, 2, &["does not watch properties"]);
}

#[test]
fn stop_when_is_told_and_its_agent_is_in_no_table() {
    let text = BALL.replace("until 1 ", "until 1  stop when exists b in Ball: b.x <= 0.5 ");
    let folder = folder(&[("ball.hy", &text)]);
    let words = [
        "run",
        "ball.hy",
        "--stats",
        "s.json",
        "--final",
        "last.csv",
        "--record",
        "way.csv",
        "--explain-events=why.txt",
    ];
    let done = hyc(&folder, &words);
    expect(&done, 0, &[]);
    assert!(done.out.contains("stopped at t = 0.319") && done.out.contains("by `stop when`"), "{}", done.out);
    let end = json(&read(&folder, "s.json"))["end"].clone();
    assert_eq!((&end["kind"], &end["by"]), (&Value::from("stop"), &Value::from("stop when")));
    assert_eq!(read(&folder, "last.csv").lines().count(), 4);
    for file in ["last.csv", "way.csv", "events.csv", "why.txt"] {
        assert!(!read(&folder, file).contains("run"), "{}", read(&folder, file));
    }
}

/// A press that goes on forever in no time, and a counter of it.
const PRESS: &str = "\
agent Press {
  discrete n: int = 0
  initial mode Up { when true -> Down { n := n + 1 } }
  mode Down { when true -> Up }
}
system { press = Press() }
";

#[test]
fn a_model_says_how_it_is_computed_and_the_command_line_overrides() {
    let settings = "run { until 1  algorithm masim-2004  gamma 0.25  h_max 0.1 [s]  engine plain  backend interp  threads 2 }";
    let ball = BALL.split("run {").next().unwrap().to_string() + settings;
    let folder = folder(&[("ball.hy", &ball)]);
    let stats = |words: &[&str]| {
        expect(&hyc(&folder, &[&["run", "ball.hy", "--stats", "s.json"], words].concat()), 0, &[]);
        json(&read(&folder, "s.json"))
    };
    let own = stats(&[]);
    let named =
        |stats: &Value| ["algorithm", "engine", "integrator", "backend"].map(|name| stats[name].clone());
    assert_eq!(named(&own), ["masim-2004", "plain", "adams", "interp"]);
    assert_eq!(
        named(&stats(&["--algorithm", "masim", "--backend", "jit"])),
        ["masim", "plain", "auto", "jit"]
    );
    assert_eq!(
        named(&stats(&["--algorithm", "masim", "--engine", "fast"])),
        ["masim", "fast", "auto", "interp"]
    );
    // the longest step of the algorithm: fewer steps with a longer one
    let longer = stats(&["--h-max", "0.5"]);
    assert!(longer["steps"].as_u64() < own["steps"].as_u64(), "{longer} {own}");
    let done = hyc(&folder, &["run", "ball.hy", "--integrator", "tsit5"]);
    expect(&done, 2, &["integrate by `adams`"]);
}

#[test]
fn a_model_sets_limits_of_its_run_and_the_command_line_overrides() {
    let five = format!("{PRESS}run {{ until 1  max_microsteps 5 }}");
    let three = "\
agent Ball {
  state x = 1, v = 0
  flow { x' = v  v' = -10 }
  bounce: when x <= 0 { v := -0.5*v }
}
system { ball = Ball() }
run { until 10  zeno_events 7 }
";
    let folder = folder(&[("press.hy", &five), ("ball.hy", three)]);
    expect(&hyc(&folder, &["run", "press.hy"]), 3, &["fired 5 times"]);
    expect(&hyc(&folder, &["run", "press.hy", "--limit", "max_microsteps=9"]), 3, &["fired 9 times"]);
    expect(&hyc(&folder, &["run", "ball.hy"]), 3, &["7 events"]);
    expect(&hyc(&folder, &["run", "ball.hy", "--limit", "zeno_events=12"]), 3, &["12 events"]);
}

#[test]
fn a_step_size_is_no_setting_and_a_wrong_name_lists_all() {
    let refused = |setting: &str| {
        let folder = folder(&[("ball.hy", &BALL.replace("until 1", &format!("until 1  {setting}")))]);
        hyc(&folder, &["check", "ball.hy"])
    };
    expect(&refused("step_max 0.1"), 1, &["HY0280", "no step size"]);
    expect(&refused("engine quick"), 1, &["HY0281", "fast or plain", "`quick`"]);
    expect(&refused("algorithm masim-2005"), 1, &["HY0281", "masim, masim-2004 or sasim-2004"]);
    expect(&refused("threads 0"), 1, &["HY0281", "whole number from 1"]);
    expect(&refused("event_tolerance 0"), 1, &["HY0281", "a time above 0"]);
    expect(&refused("gamma 1"), 1, &["HY0281", "below 1"]);
    expect(&refused("h_min 0.5 h_max 0.1"), 1, &["HY0281", "no more than `h_max`"]);
    expect(&refused("event_tolerence 1e-9"), 1, &["HY0280", "did you mean `event_tolerance`?"]);
}

/// The time that is told is that up to which the samples have been written, though a step leads much farther.
#[cfg(unix)]
#[test]
fn an_interruption_tells_up_to_when_the_tables_are_complete() {
    let text = "agent A { state x = 0  flow { x' = 1 } }  system { a = A() }
                run { until 100  record a every 1e-7 to \"a.csv\" }";
    let folder = folder(&[("a.hy", text)]);
    let done = interrupted(&folder, &["run", "a.hy", "--final", "f.csv"], "a.csv");
    expect(&done, 130, &["interrupted at t = "]);
    let value = |name: &str, column: usize| -> f64 {
        let text = read(&folder, name);
        text.lines().last().unwrap().split(',').nth(column).unwrap().parse().unwrap()
    };
    let (last, told) = (value("a.csv", 0), value("f.csv", 0));
    assert!(last < told && told < last + 1.5e-7, "the table ends at {last}, the run at {told}");
}
