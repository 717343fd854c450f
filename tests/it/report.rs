//! Does the page of a run show the run? Its data against the tables, its behaviour in a browser.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::Value;

pub fn model(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("models").join(name)
}

pub fn hyc(folder: &Path, words: &[&str]) -> Output {
    let output = Command::new(env!("CARGO_BIN_EXE_hyc")).args(words).current_dir(folder).output().unwrap();
    assert!(output.status.success(), "{words:?}: {}", String::from_utf8_lossy(&output.stderr));
    output
}

fn data_of(page: &str) -> Value {
    let text = page.split("<script type=\"application/json\" id=\"data\">").nth(1).unwrap();
    serde_json::from_str(text.split("</script>").next().unwrap()).unwrap()
}

/// The samples of a page: their times, and of each agent the first one's number and how many it has.
fn samples_of(data: &Value) -> (Vec<f64>, Vec<(usize, usize)>) {
    let times = data["times"].as_array().unwrap().iter().map(|time| time.as_f64().unwrap()).collect();
    let lives = numbers_of(&data["lives"], u32::from_le_bytes);
    (times, lives.chunks(2).map(|pair| (pair[0] as usize, pair[1] as usize)).collect())
}

/// Numbers of N bytes each.
fn numbers_of<const N: usize, T>(text: &Value, read: impl Fn([u8; N]) -> T) -> Vec<T> {
    let bytes = STANDARD.decode(text.as_str().unwrap()).unwrap();
    bytes.chunks(N).map(|bytes| read(bytes.try_into().unwrap())).collect()
}

/// The page of a model that is written here.
fn page_of(folder: &Path, text: &str) -> String {
    fs::write(folder.join("a.hy"), text).unwrap();
    let words = ["report", "a.hy", "-q"];
    let output = Command::new(env!("CARGO_BIN_EXE_hyc")).args(words).current_dir(folder).output().unwrap();
    let code = output.status.code().unwrap();
    assert!(matches!(code, 0 | 3), "{}", String::from_utf8_lossy(&output.stderr));
    fs::read_to_string(folder.join("a.html")).unwrap()
}

#[test]
fn a_page_holds_the_events_and_asks_for_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let path = model("bumper.hy");
    hyc(folder.path(), &["report", path.to_str().unwrap(), "-q"]);
    // the files that the model names are left alone
    let files: Vec<_> =
        fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert_eq!(files, ["bumper.html"]);
    let page = fs::read_to_string(folder.path().join("bumper.html")).unwrap();
    hyc(folder.path(), &["run", path.to_str().unwrap(), "-q", "--events", "events.csv"]);
    let events = fs::read_to_string(folder.path().join("events.csv")).unwrap();
    let data = data_of(&page);
    let shown = data["events"].as_array().unwrap();
    let name = |list: &str, number: &Value| match number.as_i64() {
        Some(-1) => String::new(),
        Some(number) => data[list][number as usize].as_str().unwrap().to_string(),
        None => panic!("{number}"),
    };
    assert_eq!(shown.len(), events.lines().count() - 1);
    for (event, line) in shown.iter().zip(events.lines().skip(1)) {
        let cells: Vec<&str> = line.split(',').collect();
        // the library that reads JSON here may be off by an ulp
        let (time, expected) = (event[0].as_f64().unwrap(), cells[0].parse::<f64>().unwrap());
        assert!((time - expected).abs() <= 2.0 * f64::EPSILON * expected, "{line}");
        let names = [name("transitions", &event[1]), name("agents", &event[2]), name("agents", &event[3])];
        assert_eq!(names, [cells[2], cells[3], cells[4]], "{line}");
    }
    assert_eq!(data["nEvents"].as_u64().unwrap() as usize, shown.len());
    assert_eq!(data["agents"].as_array().unwrap().len(), 20);
    for (attribute, outside) in [("src=\"", ""), ("href=\"", ""), ("url(", ""), ("@import", "")] {
        let own = page.split("<script type=").next().unwrap();
        assert!(!own.contains(&format!("{attribute}{outside}")), "{attribute}");
    }
    assert!(page.contains("default-src 'none'"));
}

/// The walls of the bumper problem are at H = 5 ceil(sqrt(20)) - 1/2, and two cars touch at R = 1.
#[test]
fn a_page_shows_walls_and_ranges() {
    let folder = tempfile::tempdir().unwrap();
    hyc(folder.path(), &["report", model("bumper.hy").to_str().unwrap(), "-q", "--until", "1"]);
    let data = data_of(&fs::read_to_string(folder.path().join("bumper.html")).unwrap());
    let column = |name: &str| {
        let labels =
            data["columns"].as_array().unwrap().iter().map(|column| column["label"].as_str().unwrap());
        labels.into_iter().position(|label| label.starts_with(name)).unwrap() as u64
    };
    let walls = data["walls"]
        .as_array()
        .unwrap()
        .iter()
        .map(|wall| (wall[0].as_u64().unwrap(), wall[1].as_f64().unwrap()));
    let walls: Vec<(u64, f64)> = walls.collect();
    for wall in [("x, ", -24.5), ("x, ", 24.5), ("y, ", -24.5), ("y, ", 24.5)] {
        assert!(walls.contains(&(column(wall.0), wall.1)), "{wall:?} of {walls:?}");
    }
    assert_eq!(walls.len(), 4);
    let ranges = data["ranges"].as_array().unwrap();
    assert_eq!(ranges.len(), 1);
    assert_eq!(ranges[0][0], serde_json::json!([column("x, "), column("y, ")]));
    assert!((ranges[0][1].as_f64().unwrap() - 1.0).abs() < 1e-6);
    // a gap to another, and a guard with parameters that differ from agent to agent, are no walls
    fs::write(
        folder.path().join("a.hy"),
        "agent A(c: real) { state x = 0, y = 0  flow { x' = 1  y' = 0 }
           a: when x >= c { }  b: when x + y >= 3 { }  d: when 2*x - 1 >= time { }
           e: when exists o in other A: o.x > x + 9 { }  f: when 3*y <= -6 { } }
         system { a = A(c = 1)  b = A(c = 2) }  run { until 1 }",
    )
    .unwrap();
    hyc(folder.path(), &["report", "a.hy", "-q"]);
    let data = data_of(&fs::read_to_string(folder.path().join("a.html")).unwrap());
    assert_eq!(data["walls"], serde_json::json!([[1, -2.0]]));
    assert_eq!(data["ranges"], serde_json::json!([]));
}

#[test]
fn a_report_beside_a_run_changes_no_event() {
    let folder = tempfile::tempdir().unwrap();
    for (name, until) in [("two_cars.hy", "12"), ("highway_static.hy", "2.2"), ("ball.hy", "2.2")] {
        let path = model(name);
        let path = path.to_str().unwrap();
        let quiet = ["run", path, "-q", "--until", until];
        hyc(
            folder.path(),
            &[&quiet[..], &["-o", "a", "--events", "without.csv", "--final", "f1.csv"]].concat(),
        );
        hyc(
            folder.path(),
            &[&quiet[..], &["-o", "b", "--events", "with.csv", "--final", "f2.csv", "--report", "r.html"]]
                .concat(),
        );
        let read = |name: &str| fs::read_to_string(folder.path().join(name)).unwrap();
        assert!(read("without.csv").lines().count() > 1, "{name}");
        assert_eq!(read("without.csv"), read("with.csv"), "{name}");
        assert_eq!(read("f1.csv"), read("f2.csv"), "{name}");
    }
}

/// The end of a run that an action stops is not known before it.
#[test]
fn a_page_of_a_run_that_stops_by_itself_goes_up_to_there() {
    let folder = tempfile::tempdir().unwrap();
    let text = "agent A { state x = 0  flow { x' = 1 }  when x >= 7 { stop \"far enough\" } }\nsystem { a = A() }\nrun { }\n";
    fs::write(folder.path().join("a.hy"), text).unwrap();
    hyc(folder.path(), &["report", "a.hy"]);
    let data = data_of(&fs::read_to_string(folder.path().join("a.html")).unwrap());
    let times: Vec<f64> =
        data["times"].as_array().unwrap().iter().map(|time| time.as_f64().unwrap()).collect();
    assert!(times.len() >= 100 && (times.last().unwrap() - 7.0).abs() < 0.1, "{times:?}");
    assert!(data["ending"].as_str().unwrap().contains("far enough"), "{data}");
    assert_eq!(data["nEvents"], 1);
    hyc(
        folder.path(),
        &["run", "a.hy", "-q", "--report", "b.html", "--record", "b.csv", "--events", "e.csv"],
    );
    assert_eq!(fs::read_to_string(folder.path().join("e.csv")).unwrap().lines().count(), 2);
    assert_eq!(data_of(&fs::read_to_string(folder.path().join("b.html")).unwrap())["nEvents"], 1);
    hyc(folder.path(), &["plot", "a.hy"]);
    assert!(fs::read_to_string(folder.path().join("a.svg")).unwrap().contains("<polyline"));
    // nothing ends this one
    fs::write(folder.path().join("a.hy"), text.replace("stop \"far enough\"", "x := 0")).unwrap();
    for command in ["report", "plot"] {
        let output = Command::new(env!("CARGO_BIN_EXE_hyc"))
            .args([command, "a.hy"])
            .current_dir(folder.path())
            .output()
            .unwrap();
        assert_eq!(output.status.code(), Some(2));
        assert!(String::from_utf8_lossy(&output.stderr).contains("the run has no end"));
    }
}

/// What the plane of a page shows at first, by name.
fn plane_of(folder: &Path, words: &[&str]) -> [String; 2] {
    hyc(folder, &[&["report"], words, &["-q", "-o", "plane.html"]].concat());
    let data = data_of(&fs::read_to_string(folder.join("plane.html")).unwrap());
    ["across", "up"].map(|axis| match data[axis].as_i64().unwrap() {
        -1 => "time".to_string(),
        column => data["columns"][column as usize]["label"].as_str().unwrap().to_string(),
    })
}

#[test]
fn a_plane_shows_where_agents_are() {
    let folder = tempfile::tempdir().unwrap();
    let highway = model("highway.hy");
    let highway = highway.to_str().unwrap();
    assert_eq!(plane_of(folder.path(), &[highway, "--until", "5"]), ["x, m", "lane"]);
    assert_eq!(plane_of(folder.path(), &[highway, "--until", "5", "--xy", "x,v"]), ["x, m", "v, m/s"]);
    assert_eq!(plane_of(folder.path(), &[highway, "--until", "5", "--xy", "time,x"]), ["time", "x, m"]);
    let wrong = Command::new(env!("CARGO_BIN_EXE_hyc"))
        .args(["report", highway, "--xy", "x,w"])
        .current_dir(folder.path())
        .output()
        .unwrap();
    assert!(!folder.path().join("highway.html").exists(), "nothing is left of what is refused");
    assert!(String::from_utf8_lossy(&wrong.stderr).contains("no column `w`; there are time, x, v, lane"));
    for (text, expected) in [
        // a second place in the unit of the first
        ("state v: real [m/s] = 1, x: real [m] = 0, z: real [m] = 0  flow { v' = 0  x' = v  z' = v }", ["x, m", "z, m"]),
        // a floor, for agents that ask who is on theirs
        (
            "state x = 0, v = 1  discrete n: int = 0, level: int = index  flow { x' = v  v' = 0 }
             up: when exists o in other A: o.level == level + 1 and o.x < x { n := n + 1 }",
            ["x", "level"],
        ),
        // a counter says nothing of where an agent is
        (
            "state x = 0, v = 1  discrete n: int = 0  flow { x' = v  v' = 0 }
             turn: when x >= 1 and n == 0 { n := n + 1 }  again: when exists o in other A: o.x > 3 and n == 2 { n := 0 }",
            ["x", "v"],
        ),
    ] {
        let text = format!("agent A {{ {text} }}\nsystem {{ all = A[3]() }}\nrun {{ until 1 }}\n");
        fs::write(folder.path().join("a.hy"), text).unwrap();
        assert_eq!(plane_of(folder.path(), &["a.hy"]), expected);
    }
}

#[test]
fn a_page_shows_the_files_that_a_model_imports() {
    let folder = tempfile::tempdir().unwrap();
    imported(folder.path());
    hyc(folder.path(), &["report", "main.hy", "-q"]);
    let page = fs::read_to_string(folder.path().join("main.html")).unwrap();
    let names: Vec<&str> =
        page.split("role=\"tab\"").skip(1).map(|tab| tab.split(['>', '<']).nth(1).unwrap()).collect();
    assert_eq!(names, ["main.hy", "cars.hy", "lib.hy"]);
    let texts: Vec<&str> = page.split("<div class=\"text\"").skip(1).collect();
    assert!(
        texts[0].contains("half") && texts[1].contains("leave") && texts[2].contains("road"),
        "{names:?}"
    );
    let data = data_of(&page);
    let place = |label: &str| {
        let labels = data["transitions"].as_array().unwrap();
        data["places"][labels.iter().position(|known| known == label).unwrap()].clone()
    };
    assert_eq!(place("Car.leave"), serde_json::json!([1, 5, 7]));
    assert_eq!(place("Bike.half"), serde_json::json!([0, 2, 2]));
    // one file needs no tabs
    hyc(folder.path(), &["report", model("ball.hy").to_str().unwrap(), "-q", "-o", "ball.html"]);
    assert!(!fs::read_to_string(folder.path().join("ball.html")).unwrap().contains("role=\"tab\""));
}

/// A model that imports one that imports another.
pub fn imported(folder: &Path) {
    let files = [
        ("lib.hy", "param road: real [m] = 2\n"),
        (
            "cars.hy",
            "import \"lib.hy\"\nagent Car {\n  state x: real [m] = 0\n  flow { x' = 1 }\n  leave: when x >= road {\n    x := 0\n  }\n}\n",
        ),
        (
            "main.hy",
            "import \"cars.hy\"\nagent Bike { state x: real [m] = 0  flow { x' = 1 }  half: when x >= road/2 { x := 0 } }\nsystem { car = Car()  bike = Bike() }\nrun { until 3 }\n",
        ),
    ];
    for (name, text) in files {
        fs::write(folder.join(name), text).unwrap();
    }
}

/// What is across and up is there together, in some agent, at some time.
#[test]
fn a_plane_shows_what_somebody_has() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["sector.hy", "interlock.hy", "highway.hy"] {
        hyc(
            folder.path(),
            &["report", model(name).to_str().unwrap(), "-q", "-o", "plane.html", "--until", "30"],
        );
        let data = data_of(&fs::read_to_string(folder.path().join("plane.html")).unwrap());
        let column = |axis: &str| data[axis].as_i64().unwrap();
        let values =
            |column: i64| numbers_of(&data["columns"][column as usize]["values"], f32::from_le_bytes);
        let (n, there) = match (column("across"), column("up")) {
            (-1, up) => (1, values(up)),
            (across, up) => {
                let pairs = values(across).into_iter().zip(values(up));
                (2, pairs.map(|(x, y)| x + y).collect())
            }
        };
        let n_there = there.iter().filter(|value| value.is_finite()).count();
        assert!(n_there > 20, "{name}: {n} of {} columns, {n_there} marks", data["columns"]);
    }
    // agents that are not there at t = 0 have parameters that say where they are; those who have only these do not make the plane
    let gates = "agent Gate(way: int) { sent: every 5 [s] { create Plane(way = way) } }
        agent Plane(way: int) { state s: real [m] = 0  flow { s' = 1 [m/s] }  out: when s >= 10 [m] { destroy self } }
        system { g = Gate[2](way = index) }  run { until 20 }";
    fs::write(folder.path().join("a.hy"), gates).unwrap();
    assert_eq!(plane_of(folder.path(), &["a.hy"]), ["s, m", "way"]);
    let without = gates.replace("Plane(way = way)", "Plane()").replace("Plane(way: int)", "Plane");
    fs::write(folder.path().join("a.hy"), without).unwrap();
    assert_eq!(plane_of(folder.path(), &["a.hy"]), ["time", "s, m"]);
    // two units of one name are two columns
    let units = "agent Plane { state x: real [km] = 1 [km]  flow { x' = 0 [m/s] } }
        agent Car { state x: real [m] = 1 [km]  flow { x' = 0 [m/s] } }
        system { p = Plane()  c = Car() }  run { until 10 }";
    let data = data_of(&page_of(folder.path(), units));
    let labels: Vec<&Value> =
        data["columns"].as_array().unwrap().iter().map(|column| &column["label"]).collect();
    assert_eq!(labels, ["x, km", "x, m"]);
}

/// An agent has samples while it lives; those who live between two samples are told of.
#[test]
fn a_page_of_many_births_stays_small() {
    let folder = tempfile::tempdir().unwrap();
    let births =
        "agent P { state x: real [m] = 0  flow { x' = 1 [m/s] }  end: when x >= 0.1 [m] { destroy self } }
        agent Q { state x: real [m] = 0  flow { x' = 1 [m/s] }  end: when x >= 0.001 [m] { destroy self } }
        agent S { spawn: every 0.01 { create P()  create Q() } }
        system { s = S() }  run { until 30 }";
    let page = page_of(folder.path(), births);
    let data = data_of(&page);
    let (times, lives) = samples_of(&data);
    assert_eq!(times.len(), 1201);
    let n_rows: usize = lives.iter().map(|(_, n)| n).sum();
    assert!(lives.len() > 3000 && n_rows < 20 * times.len(), "{} agents, {n_rows} rows", lives.len());
    let per = 0.1 / (30.0 / 1200.0);
    let names = data["agents"].as_array().unwrap();
    for (name, (first, n)) in names.iter().zip(&lives) {
        let is_long = name.as_str().unwrap().starts_with("P#") && *first < 1190;
        assert!(!is_long || (*n as f64 - per).abs() <= 1.0, "{name}: {n} samples from {first} on");
    }
    let left_out = data["leftOut"].as_str().unwrap();
    assert!(left_out.contains("lived between two samples, which are 0.025 s apart"), "{left_out}");
    // where there are ever more agents, every second sample is given up again and again
    let growth = "agent P { state x = 0, y = 0  flow { x' = 1  y' = 1 } }
        agent S { spawn: every 0.01 { create P() } }  system { s = S() }  run { until 40 }";
    let (times, lives) = samples_of(&data_of(&page_of(folder.path(), growth)));
    let n_rows: usize = lives.iter().map(|(_, n)| n).sum();
    assert_eq!(times.len(), 601);
    assert!(lives.len() == 4001 && n_rows <= 1_500_000, "{} agents, {n_rows} rows", lives.len());
    assert!(times.windows(2).all(|pair| pair[1] > pair[0]) && times[600] == 40.0);
}

/// Wherever a run ends, it has between half as many samples as it may have and as many, and one at its end.
#[test]
fn a_run_that_ends_early_is_shown_as_well() {
    let folder = tempfile::tempdir().unwrap();
    for at in ["0.004", "0.7", "7.3", "130", "990"] {
        let text = format!(
            "agent A {{ state x = 0  flow {{ x' = 1 }}  when x >= {at} {{ stop \"far enough\" }} }}
             system {{ a = A() }}  run {{ until 1000 }}"
        );
        let data = data_of(&page_of(folder.path(), &text));
        let (times, lives) = samples_of(&data);
        let last = times[times.len() - 1];
        assert!((76..=1201).contains(&times.len()) && lives == [(0, times.len())], "{at}: {}", times.len());
        assert_eq!(Some(last), data["events"][0][0].as_f64());
        assert!((last - at.parse::<f64>().unwrap()).abs() < 1e-6, "{at}: {last}");
        hyc(folder.path(), &["plot", "a.hy"]);
        let svg = fs::read_to_string(folder.path().join("a.svg")).unwrap();
        let n_points = |line: &str| line.split("points=\"").nth(1).unwrap().split_whitespace().count();
        assert!(svg.lines().filter(|line| line.starts_with("<polyline")).any(|line| n_points(line) > 76));
    }
    // the page of an error says it
    let text = "agent A { state x = 0, y = 0  flow { x' = 1  y' = 1/(1 - x)^2 }  tick: every 0.1 { } }
        system { a = A() }  run { until 10000 }";
    let data = data_of(&page_of(folder.path(), text));
    assert!(samples_of(&data).0.len() > 76);
    let error = data["error"].as_str().unwrap();
    assert!(
        error.contains("error[HY0504]") && error.contains("y' = 1/(1 - x)^2") && !error.contains('\u{1b}')
    );
    let fine = data_of(&page_of(folder.path(), &text.replace("1/(1 - x)^2", "1").replace("10000", "10")));
    assert!(fine["error"].is_null() && fine["leftOut"] == "", "{}", fine["leftOut"]);
}

/// Agents with regions are in the mode of the first.
#[test]
fn agents_with_regions_have_a_mode() {
    let folder = tempfile::tempdir().unwrap();
    let text = "agent T { state x = 0
        region A { initial mode P { flow { x' = 1 } a: when x >= 1 -> Q }  mode Q { flow { x' = -1 } b: when x <= 0 -> P } }
        region B { initial mode C { c: after 0.5 -> D }  mode D { d: after 0.5 -> C } } }
        system { t = T() }  run { until 5 }";
    let data = data_of(&page_of(folder.path(), text));
    let modes = numbers_of(&data["modes"], u16::from_le_bytes);
    let named = |name: &str| {
        let number = data["modeNames"].as_array().unwrap().iter().position(|known| known == name).unwrap();
        modes.iter().filter(|&&mode| mode as usize == number).count()
    };
    assert!(named("A.P") > 500 && named("A.Q") > 400 && named("A.P") + named("A.Q") == modes.len(), "{data}");
    hyc(folder.path(), &["plot", "a.hy"]);
    let svg = fs::read_to_string(folder.path().join("a.svg")).unwrap();
    // the legend lists what is drawn
    assert!(svg.contains("A.P") && svg.contains("A.Q") && !svg.contains("B.C"));
}

/// 32 bits are enough for places far from the origin.
#[test]
fn a_page_tells_numbers_apart_that_differ_little() {
    let folder = tempfile::tempdir().unwrap();
    let text = "agent B { state y: real [m] = 5000000, th = 0  flow { y' = sin(th)*1 [m/s]  th' = 1 } }
        system { b = B() }  run { until 6.28 }";
    let data = data_of(&page_of(folder.path(), text));
    let column = &data["columns"][0];
    let mut values = numbers_of(&column["values"], f32::from_le_bytes);
    assert!((column["middle"].as_f64().unwrap() - 5_000_001.0).abs() < 1e-3);
    values.dedup();
    assert!(values.len() > 1190, "{}", values.len());
}
