//! Does the page of a run show the run? Its data against the tables, its behaviour in a browser.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::Value;

fn model(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("models").join(name)
}

fn hyc(folder: &Path, words: &[&str]) -> Output {
    let output = Command::new(env!("CARGO_BIN_EXE_hyc")).args(words).current_dir(folder).output().unwrap();
    assert!(output.status.success(), "{words:?}: {}", String::from_utf8_lossy(&output.stderr));
    output
}

fn data_of(page: &str) -> Value {
    let text = page.split("<script type=\"application/json\" id=\"data\">").nth(1).unwrap();
    serde_json::from_str(text.split("</script>").next().unwrap()).unwrap()
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
fn imported(folder: &Path) {
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

/// What a browser is asked to do on the page; the answers come as JSON in a `pre`.
const ASK: &str = r##"
<script>
addEventListener("load", () => setTimeout(async () => {
  const $ = id => document.getElementById(id), wait = ms => new Promise(done => setTimeout(done, ms)), said = {};
  const picture = () => { const c = $("plane"); return c.getContext("2d").getImageData(0, 0, c.width, c.height).data; };
  const differ = (a, b) => { let n = 0; for (let k = 0; k < a.length; k += 4) if (a[k] !== b[k] || a[k+1] !== b[k+1] || a[k+2] !== b[k+2]) n++; return n; };
  const press = key => document.dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true }));
  try {
    const first = picture();
    said.colours = new Set(Array.from(new Uint32Array(first.buffer))).size;
    $("time").value = +$("time").max*0.6; $("time").dispatchEvent(new Event("input"));
    said.moved = differ(first, picture());
    said.charts = document.querySelectorAll("#charts canvas").length;
    said.rows = document.querySelectorAll("#events tbody tr").length;
    const row = document.querySelectorAll("#events tbody tr")[Math.min(5, said.rows - 1)];
    row.click();
    said.jumped = Math.abs(parseFloat($("clock").textContent) - parseFloat(row.cells[0].textContent)) < 0.001;
    said.marked = document.querySelector("#events tr.now")?.textContent;
    said.clicked = row.textContent;
    const marked = said.marked; press("n"); said.next = document.querySelector("#events tr.now")?.textContent !== marked;
    $("find").value = row.cells[2].textContent; $("find").dispatchEvent(new Event("input"));
    said.found = document.querySelectorAll("#events tbody tr").length;
    const place = document.querySelector("#events td.place");
    if (place) { place.click(); said.place = document.querySelector(".text:not([hidden]) .lines")?.dataset.lines; }
    said.tabs = document.querySelectorAll("#tabs button").length;
    press("Home"); press(" "); for (let k = 0; k < 30 && +$("time").value <= +$("time").min; k++) await wait(100); press(" ");
    said.played = +$("time").value - +$("time").min;
    press("0"); press("+"); press("t"); press("l"); press("ArrowRight"); press("End"); press("d");
    said.dark = getComputedStyle(document.documentElement).colorScheme;
    said.ended = +$("time").value === +$("time").max;
  } catch (error) { errors.push(String(error)); }
  said.requests = performance.getEntriesByType("resource").map(entry => entry.name);
  said.errors = errors;
  document.body.innerHTML = "<pre id=verdict></pre>";
  $("verdict").textContent = JSON.stringify(said);
}, 100));
</script>
</body>"##;

/// Before all else: what goes wrong is noted. Frames come by the clock, which the browser's virtual time moves: its own frames
/// come by real time, and there may be none of them before virtual time has passed.
const LISTEN: &str = r#"<head>
<script>
const errors = [];
addEventListener("error", event => errors.push(String(event.message)));
addEventListener("unhandledrejection", event => errors.push(String(event.reason)));
addEventListener("securitypolicyviolation", event => errors.push("refused: " + event.blockedURI));
console.error = (...words) => errors.push(words.join(" "));
window.requestAnimationFrame = frame => setTimeout(() => frame(performance.now()), 16);
</script>"#;

fn browser() -> Option<String> {
    let named = std::env::var("HYC_CHROMIUM").ok();
    let known = ["chromium", "chromium-browser", "google-chrome", "chrome"].map(String::from);
    let runs = |name: &String| {
        Command::new(name).arg("--version").output().is_ok_and(|output| output.status.success())
    };
    named.into_iter().chain(known).find(runs)
}

/// What the page of a model does in a browser; none, with a word, where there is no browser.
fn asked(path: &Path, words: &[&str]) -> Option<Value> {
    let Some(browser) = browser() else {
        eprintln!("skipped: no Chromium is installed; HYC_CHROMIUM names one");
        return None;
    };
    let folder = tempfile::tempdir().unwrap();
    hyc(folder.path(), &[&["report", path.to_str().unwrap(), "-q", "-o", "page.html"], words].concat());
    let page = fs::read_to_string(folder.path().join("page.html")).unwrap();
    let page = page.replacen("<head>", LISTEN, 1);
    let (before, after) = page.rsplit_once("</body>").unwrap();
    fs::write(folder.path().join("page.html"), format!("{before}{ASK}{after}")).unwrap();
    let url = format!("file://{}", folder.path().join("page.html").display());
    let profile = format!("--user-data-dir={}", folder.path().join("profile").display());
    let output = Command::new(browser)
        .args(["--headless", "--no-sandbox", "--disable-gpu", "--window-size=1400,1000", &profile])
        .args(["--virtual-time-budget=20000", "--dump-dom", &url])
        .output()
        .unwrap();
    let dom = String::from_utf8_lossy(&output.stdout);
    let verdict = dom.split("<pre id=\"verdict\">").nth(1);
    let verdict =
        verdict.unwrap_or_else(|| panic!("no verdict: {}", String::from_utf8_lossy(&output.stderr)));
    let text = verdict.split("</pre>").next().unwrap();
    let text = text.replace("&lt;", "<").replace("&gt;", ">").replace("&amp;", "&");
    Some(serde_json::from_str(&text).unwrap())
}

#[test]
fn the_page_works_in_a_browser() {
    for (name, words, n_charts) in
        [("bumper.hy", &[][..], 3), ("highway_static.hy", &["--until", "30"][..], 3), ("ball.hy", &[][..], 2)]
    {
        let Some(said) = asked(&model(name), words) else { return };
        let number = |key: &str| said[key].as_f64().unwrap_or_else(|| panic!("{name}: no {key} in {said}"));
        assert_eq!(said["errors"], serde_json::json!([]), "{name}: {said}");
        assert_eq!(said["requests"], serde_json::json!([]), "{name}: {said}");
        assert!(number("colours") > 10.0 && number("moved") > 50.0, "{name}: {said}");
        assert_eq!(number("charts"), f64::from(n_charts), "{name}: {said}");
        assert!(
            number("rows") > 5.0 && number("found") > 0.0 && number("found") < number("rows"),
            "{name}: {said}"
        );
        assert!(
            said["jumped"] == true && said["marked"] == said["clicked"] && said["next"] == true,
            "{name}: {said}"
        );
        assert!(said["place"].is_string() && number("tabs") == 0.0, "{name}: {said}");
        assert!(number("played") > 0.0 && said["ended"] == true && said["dark"] == "dark", "{name}: {said}");
    }
}

#[test]
fn a_transition_is_shown_in_the_file_where_it_stands() {
    let folder = tempfile::tempdir().unwrap();
    imported(folder.path());
    let Some(said) = asked(&folder.path().join("main.hy"), &[]) else { return };
    assert_eq!(said["errors"], serde_json::json!([]), "{said}");
    // the first event is that of the bike, in the first file
    assert_eq!((&said["tabs"], &said["place"]), (&3.into(), &"2-2".into()), "{said}");
}
