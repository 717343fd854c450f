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

#[test]
fn a_page_of_a_run_without_an_end_is_refused_with_what_to_type() {
    let folder = tempfile::tempdir().unwrap();
    let text =
        "agent A { state x = 0  flow { x' = 1 }  when x >= 1 { stop } }\nsystem { a = A() }\nrun { }\n";
    fs::write(folder.path().join("a.hy"), text).unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_hyc"))
        .args(["report", "a.hy"])
        .current_dir(folder.path())
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("--until T"));
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
fn asked(name: &str, words: &[&str]) -> Option<Value> {
    let Some(browser) = browser() else {
        eprintln!("skipped: no Chromium is installed; HYC_CHROMIUM names one");
        return None;
    };
    let folder = tempfile::tempdir().unwrap();
    let path = model(name);
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
        let Some(said) = asked(name, words) else { return };
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
        assert!(number("played") > 0.0 && said["ended"] == true && said["dark"] == "dark", "{name}: {said}");
    }
}
