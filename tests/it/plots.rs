//! Do plots show what is in the tables? As SVG and PNG, from trajectories, event logs and models, with defaults alone.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

fn hyc(folder: &Path, words: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_hyc")).args(words).current_dir(folder).output().unwrap()
}

fn fine(folder: &Path, words: &[&str]) {
    let output = hyc(folder, words);
    assert!(output.status.success(), "{words:?}: {}", String::from_utf8_lossy(&output.stderr));
}

fn read(folder: &Path, name: &str) -> String {
    fs::read_to_string(folder.join(name)).unwrap()
}

/// How many points of a PNG have each colour; the size.
fn points(folder: &Path, name: &str) -> (std::collections::BTreeMap<[u8; 3], usize>, (u32, u32)) {
    let bytes = fs::read(folder.join(name)).unwrap();
    let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut pixels).unwrap();
    let mut counts = std::collections::BTreeMap::new();
    for point in pixels.chunks_exact(3) {
        *counts.entry([point[0], point[1], point[2]]).or_default() += 1;
    }
    (counts, (info.width, info.height))
}

/// The polylines of an SVG: their colours and points.
fn lines(svg: &str) -> Vec<(String, Vec<(f64, f64)>)> {
    let of = |line: &str, key: &str| {
        line.split(&format!(" {key}=\"")).nth(1).map(|rest| rest.split('"').next().unwrap().to_string())
    };
    let lines = svg.lines().filter(|line| line.starts_with("<polyline"));
    lines
        .map(|line| {
            let points = of(line, "points").unwrap();
            let pairs = points.split_whitespace().map(|pair| pair.split_once(',').unwrap());
            let points = pairs.map(|(x, y)| (x.parse().unwrap(), y.parse().unwrap())).collect();
            (of(line, "stroke").unwrap(), points)
        })
        .collect()
}

const MODEL: &str = "\
agent Walker(speed: real [m/s]) {
  state x: real [m] = 0, y: real [m] = 0
  initial mode Out { flow { x' = speed  y' = 1 [m/s] }  turn: when x >= 4 -> Back }
  mode Back { flow { x' = -speed  y' = 1 [m/s] }  home: when x <= 1 -> Out }
}
system { slow = Walker(speed = 1)  fast = Walker(speed = 2) }
run { until 10  record Walker every 0.1 to \"walk.csv\"  events to \"turns.csv\" }
";

#[test]
fn a_table_becomes_a_picture_without_options() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    fs::write(folder.join("walk.hy"), MODEL).unwrap();
    fine(folder, &["run", "walk.hy", "-q"]);
    fine(folder, &["plot", "walk.csv"]);
    let svg = read(folder, "walk.svg");
    for word in ["walk.csv", "slow", "fast", "Out", "Back", "time, s", ">\nx\n<", ">\ny\n<"] {
        assert!(svg.contains(word), "{word}");
    }
    // a line for each agent and column, with as many points as there are rows
    let long: Vec<_> = lines(&svg).into_iter().filter(|(_, points)| points.len() == 101).collect();
    assert_eq!(long.len(), 4);
    assert!(long[0].0 != long[1].0 && long[0].0 == long[2].0);
    // `fast` comes back: its line over time turns, that of its y does not
    let rises = |points: &[(f64, f64)]| points.windows(2).all(|pair| pair[1].1 <= pair[0].1);
    assert!(!rises(&long[1].1) && rises(&long[3].1));
}

#[test]
fn a_model_an_event_log_and_a_plane_are_drawn_as_svg_and_png() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    fs::write(folder.join("walk.hy"), MODEL).unwrap();
    // a run for a picture writes none of the files that the model names
    fine(folder, &["plot", "walk.hy", "-o", "model.png"]);
    assert!(!folder.join("walk.csv").exists() && !folder.join("turns.csv").exists());
    fine(folder, &["run", "walk.hy", "-q"]);
    fine(folder, &["plot", "turns.csv", "-o", "turns.png"]);
    fine(folder, &["plot", "walk.csv", "--xy", "x,y", "-o", "plane.png"]);
    fine(folder, &["plot", "walk.hy", "--xy", "x,y", "-o", "plane.svg"]);
    fine(folder, &["plot", "walk.hy", "--columns", "y", "-o", "y.svg"]);
    for name in ["model.png", "turns.png", "plane.png"] {
        let (counts, (width, height)) = points(folder, name);
        let white = counts[&[255, 255, 255]];
        let all = (width * height) as usize;
        assert!(white > all / 3 && white < all - 500 && counts.len() > 20, "{name}: {white} of {all}");
    }
    // the first two agents' colours
    let (counts, _) = points(folder, "plane.png");
    assert!(counts[&[0x00, 0x72, 0xb2]] > 200 && counts[&[0xe6, 0x9f, 0x00]] > 200);
    let plane = read(folder, "plane.svg");
    assert!(plane.contains("x, m") && plane.contains("y, m"));
    // both axes have one scale: `slow` goes 45 degrees up
    let (_, path) = lines(&plane).into_iter().find(|(_, points)| points.len() > 300).unwrap();
    let (from, to) = (path[0], path[200]);
    assert!(((to.0 - from.0) - (from.1 - to.1)).abs() <= 3.0, "{from:?} {to:?}");
    assert!(!read(folder, "y.svg").contains(">\nx, m\n<"));
}

#[test]
fn what_cannot_be_drawn_is_refused_in_words() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    fs::write(folder.join("walk.hy"), MODEL).unwrap();
    fs::write(folder.join("other.csv"), "a,b\n1,2\n").unwrap();
    fs::write(folder.join("table.parquet"), "PAR1").unwrap();
    fs::write(folder.join("bad.csv"), "time,agent,x\nsoon,a,2\n").unwrap();
    fine(folder, &["run", "walk.hy", "-q"]);
    let cases: [(&[&str], &str); 7] = [
        (&["plot", "none.csv"], "cannot read `none.csv`"),
        (&["plot", "table.parquet"], "cannot read `table.parquet`: only tables in CSV are drawn"),
        (&["plot", "other.csv"], "no columns `time` and `agent`"),
        (&["plot", "bad.csv"], "line 2: `soon` is no time"),
        (&["plot", "walk.csv", "--xy", "x,z"], "no column `z`; there are x, y"),
        (&["plot", "walk.csv", "--xy", "x"], "--xy x,y"),
        (&["plot", "walk.csv", "-o", "walk.gif"], "`.svg` or `.png`"),
    ];
    for (words, says) in cases {
        let output = hyc(folder, words);
        let err = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.code() == Some(2) && err.contains(says), "{words:?}: {err}");
    }
}

/// What has been computed is drawn, and the exit code is that of `hyc run`.
#[test]
fn a_run_that_does_not_end_well_has_its_exit_code() {
    let folder = tempfile::tempdir().unwrap();
    let cases = [
        ("blows", "agent A { state x = 1  flow { x' = x*x } }  system { a = A() }  run { until 5 }", 3),
        (
            "lies",
            "agent A { state x = 1  flow { x' = 1 }  assert x < 2 }  system { a = A() }  run { until 5 }",
            4,
        ),
        ("fine", "agent A { state x = 1  flow { x' = 1 } }  system { a = A() }  run { until 5 }", 0),
    ];
    for (name, text, code) in cases {
        fs::write(folder.path().join(format!("{name}.hy")), text).unwrap();
        let output = hyc(folder.path(), &["plot", &format!("{name}.hy")]);
        assert_eq!(output.status.code(), Some(code), "{name}: {}", String::from_utf8_lossy(&output.stderr));
        assert!(read(folder.path(), &format!("{name}.svg")).contains("<polyline"), "{name}");
    }
}

#[test]
fn a_table_takes_no_setting_of_a_run() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("t.csv"), "time,micro,agent,mode,x\n0,0,a,,1\n1,0,a,,2\n").unwrap();
    fine(folder.path(), &["plot", "t.csv"]);
    for option in ["--until=5", "--seed=1", "-pa=1"] {
        let output = hyc(folder.path(), &["plot", "t.csv", option]);
        assert_eq!(output.status.code(), Some(2), "{option}");
        assert!(String::from_utf8_lossy(&output.stderr).contains("is for a model that is run"), "{option}");
    }
}

#[test]
fn a_column_that_is_not_there_is_told_with_those_that_are() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("walk.hy"), MODEL).unwrap();
    let said = |words: &[&str]| {
        let output = hyc(folder.path(), words);
        assert_eq!(output.status.code(), Some(2));
        String::from_utf8(output.stderr).unwrap()
    };
    let of_model = said(&["plot", "walk.hy", "--xy", "x,q"]);
    assert!(of_model.contains("there is no column `q`; there are x, y\n"), "{of_model}");
    fine(folder.path(), &["run", "walk.hy", "-q"]);
    let of_log = said(&["plot", "turns.csv", "--columns", "q"]);
    assert!(of_log.contains("an event log has times and agents only"), "{of_log}");
}

#[test]
fn a_table_can_come_through_a_pipe() {
    use std::io::Write;
    use std::process::Stdio;
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("walk.hy"), MODEL).unwrap();
    fine(folder.path(), &["run", "walk.hy", "-q"]);
    fine(folder.path(), &["plot", "walk.csv"]);
    let mut command = Command::new(env!("CARGO_BIN_EXE_hyc"));
    let mut child =
        command.args(["plot", "-"]).current_dir(folder.path()).stdin(Stdio::piped()).spawn().unwrap();
    child.stdin.take().unwrap().write_all(read(folder.path(), "walk.csv").as_bytes()).unwrap();
    assert!(child.wait().unwrap().success());
    assert_eq!(lines(&read(folder.path(), "plot.svg")), lines(&read(folder.path(), "walk.svg")));
}
