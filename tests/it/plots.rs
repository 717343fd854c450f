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
    assert!(counts[&[0x00, 0x72, 0xb2]] > 200 && counts[&[0xb8, 0x7a, 0x00]] > 200);
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

/// A PNG is the picture that the SVG is: where a line jumps, it goes straight there, and nothing of it lies outside its panel.
#[test]
fn lines_that_jump_are_the_same_in_both_forms() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let text = "agent Car(u: real [m/s]) { state x: real [m] = 0  flow { x' = u }  wrap: when x >= 100 [m] { x := 0 } }
        system { c = Car[2](u = 10 + index) }  run { until 60 }";
    fs::write(folder.join("ring.hy"), text).unwrap();
    fine(folder, &["plot", "ring.hy"]);
    fine(folder, &["plot", "ring.hy", "-o", "ring.png"]);
    let bytes = fs::read(folder.join("ring.png")).unwrap();
    let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut pixels).unwrap();
    let at = |x: usize, y: usize| &pixels[3 * (y * info.width as usize + x)..][..3];
    let colour = [0xb8, 0x7a, 0x00];
    let svg = lines(&read(folder, "ring.svg"));
    let (_, line) = svg.iter().find(|(stroke, points)| stroke == "#B87A00" && points.len() > 100).unwrap();
    // down at each wrap
    let jumps: Vec<_> = line.windows(2).filter(|pair| pair[1].1 - pair[0].1 > 50.0).collect();
    assert_eq!(jumps.len(), 6);
    for jump in jumps {
        let (x, y) = ((jump[0].0 + jump[1].0) / 2.0, (jump[0].1 + jump[1].1) / 2.0);
        let is_there = (x as usize - 1..=x as usize + 2).any(|x| at(x, y as usize) == colour);
        assert!(is_there, "{jump:?}");
    }
    let range = |of: fn(&(f64, f64)) -> f64| {
        let values = || line.iter().map(of);
        (values().fold(f64::INFINITY, f64::min) - 2.0, values().fold(0.0, f64::max) + 2.0)
    };
    let (xs, ys) = (range(|point| point.0), range(|point| point.1));
    let below = ys.1 + 60.0;
    for y in 0..info.height as usize {
        for x in 0..info.width as usize {
            let is_inside = (xs.0..=xs.1).contains(&(x as f64)) && (ys.0..=ys.1).contains(&(y as f64));
            // the legend has lines of its own
            let is_legend = y as f64 > below;
            assert!(at(x, y) != colour || is_inside || is_legend, "ink at {x}, {y}: not in {xs:?}, {ys:?}");
        }
    }
}

#[test]
fn events_are_marked_beside_a_trajectory() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    fs::write(folder.join("walk.hy"), MODEL).unwrap();
    fine(folder, &["run", "walk.hy", "-q"]);
    let n_marks = |svg: &str| {
        lines(svg).into_iter().filter(|(stroke, points)| stroke == "#1B1F24" && points.len() == 2).count()
    };
    fine(folder, &["plot", "walk.csv"]);
    let without = n_marks(&read(folder, "walk.svg"));
    fine(folder, &["plot", "walk.csv", "--events", "turns.csv"]);
    let n_events = read(folder, "turns.csv").lines().count() - 1;
    assert!(n_events > 5);
    assert_eq!(n_marks(&read(folder, "walk.svg")) - without, n_events);
    // as the model's own plot has them
    for (words, says) in [
        (["plot", "walk.hy", "--events", "turns.csv"], "is for a trajectory"),
        (["plot", "walk.csv", "--events", "walk.csv"], "`walk.csv` is no event log"),
    ] {
        let output = hyc(folder, &words);
        let err = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.code() == Some(2) && err.contains(says), "{words:?}: {err}");
    }
    // over time as well, in a plane
    for input in ["walk.csv", "walk.hy"] {
        fine(folder, &["plot", input, "--xy", "time,x", "-o", "time.svg"]);
        assert!(read(folder, "time.svg").contains("time, s"), "{input}");
    }
}

/// Agents of a log have the order of their numbers, whoever had an event first.
#[test]
fn rows_of_a_log_are_in_order() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let mut log = String::from("time,micro,transition,agent,other,from,to\n");
    for (t, agent) in ["cars[10]", "cars[2]", "b", "cars[1]", "P#7"].iter().enumerate() {
        log += &format!("{t},0,Car.go,{agent},,,\n");
    }
    fs::write(folder.join("log.csv"), log).unwrap();
    fine(folder, &["plot", "log.csv"]);
    let svg = read(folder, "log.svg");
    let mut places: Vec<usize> = Vec::new();
    for name in ["P#7", "b", "cars[1]", "cars[2]", "cars[10]"] {
        places.push(svg.find(&format!(">\n{name}\n<")).unwrap_or_else(|| panic!("{name}: {svg}")));
    }
    assert!(places.is_sorted(), "{places:?}");
}

/// Of very many points only those are in the picture that can be told apart.
#[test]
fn a_picture_of_many_agents_stays_small() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let mut table = String::from("time,micro,agent,mode,x\n");
    for k in 0..400 {
        for agent in 0..100 {
            let x = if k < 200 { k as f64 } else { 200.0 + 50.0 * (f64::from(agent) * 0.1).sin() };
            table += &format!("{},0,a[{agent}],,{x}\n", f64::from(k));
        }
    }
    fs::write(folder.join("many.csv"), table).unwrap();
    fine(folder, &["plot", "many.csv"]);
    let lines = lines(&read(folder, "many.svg"));
    let drawn: Vec<_> = lines.iter().filter(|(_, points)| (3..=6).contains(&points.len())).collect();
    assert_eq!(drawn.len(), 100);
    assert!(lines.iter().all(|(_, points)| points.len() <= 6));
}

/// What tells long names apart is seen, and the legend goes on in the next row.
#[test]
fn legends_have_room() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let mut table = String::from("time,micro,agent,mode,x\n");
    for k in 0..60 {
        for agent in 0..3 {
            table += &format!("{k},0,a_very_long_name[{agent}],AModeWithALongName{},{k}\n", k / 5);
        }
    }
    fs::write(folder.join("long.csv"), table).unwrap();
    fine(folder, &["plot", "long.csv"]);
    let svg = read(folder, "long.svg");
    assert!((0..3).all(|agent| svg.contains(&format!("a_ver\u{2026}ame[{agent}]"))));
    let widest =
        svg.split("<text x=\"").skip(1).map(|rest| rest.split('"').next().unwrap().parse::<f64>().unwrap());
    assert!(widest.fold(0.0, f64::max) < 880.0);
    assert!((0..12).all(|mode| svg.contains(&format!("AModeWithALongName{mode}\n"))));
}
