//! Does the page of a run work in a browser?

use std::fs;
use std::path::Path;
use std::process::Command;

use serde_json::Value;

use crate::report::{hyc, imported, model};
use crate::skipped::tell_skipped;

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
    const rows = () => [...document.querySelectorAll("#events tr[data-event]")], count = () => parseInt($("count").textContent.slice(1));
    said.rows = count();
    const row = rows()[Math.min(5, said.rows - 1)];
    row.click();
    said.jumped = Math.abs(parseFloat($("clock").textContent) - parseFloat(row.cells[0].textContent)) < 0.001;
    said.marked = document.querySelector("#events tr.now")?.textContent;
    said.clicked = row.textContent;
    const marked = said.marked; press("n"); said.next = document.querySelector("#events tr.now")?.textContent !== marked;
    $("find").value = row.cells[2].textContent; $("find").dispatchEvent(new Event("input"));
    said.found = count();
    said.wrongly = rows().filter(found => ![found.cells[2], found.cells[3]].some(cell => cell.textContent === row.cells[2].textContent)).length;
    const place = document.querySelector("#events .place");
    if (place) { place.click(); said.place = document.querySelector(".text:not([hidden]) .lines")?.dataset.lines; }
    // the last row can be reached, and is marked by a jump to it
    $("find").value = ""; $("find").dispatchEvent(new Event("input"));
    const box = $("events").closest(".scroll");
    box.scrollTop = box.scrollHeight; box.dispatchEvent(new Event("scroll"));
    const final = rows().at(-1);
    said.last = +final.dataset.event; final.click();
    said.lastMarked = document.querySelector("#events tr.now")?.dataset.event === String(said.last);
    const focusable = document.querySelector("#events tr[tabindex='0']");
    focusable.focus();
    focusable.dispatchEvent(new KeyboardEvent("keydown", { key: "ArrowUp", bubbles: true }));
    said.up = +document.querySelector("#events tr.now").dataset.event; said.focus = document.activeElement?.dataset?.event;
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
    asked_for(path, words, ASK)
}

/// The same for what this script asks.
fn asked_for(path: &Path, words: &[&str], script: &str) -> Option<Value> {
    let Some(browser) = browser() else {
        tell_skipped("no Chromium is installed; HYC_CHROMIUM names one");
        return None;
    };
    let folder = tempfile::tempdir().unwrap();
    hyc(folder.path(), &[&["report", path.to_str().unwrap(), "-q", "-o", "page.html"], words].concat());
    let page = fs::read_to_string(folder.path().join("page.html")).unwrap();
    let page = page.replacen("<head>", LISTEN, 1);
    let (before, after) = page.rsplit_once("</body>").unwrap();
    fs::write(folder.path().join("page.html"), format!("{before}{script}{after}")).unwrap();
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
        [("bumper.hy", &[][..], 3), ("highway_static.hy", &["--until", "30"][..], 4), ("ball.hy", &[][..], 2)]
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
        assert_eq!(number("wrongly"), 0.0, "{name}: {said}");
        assert!(number("last") == number("rows") - 1.0 && said["lastMarked"] == true, "{name}: {said}");
        assert_eq!(number("up"), number("last") - 1.0, "{name}: {said}");
        assert_eq!(said["focus"], number("up").to_string(), "{name}: {said}");
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

/// A value of any size that does not change leaves the page alive.
#[test]
fn a_page_shows_what_stays_the_same() {
    let folder = tempfile::tempdir().unwrap();
    for (k, value) in ["4e6", "-8.3e6", "1e17", "3e-300", "0"].iter().enumerate() {
        let path = folder.path().join(format!("tank{k}.hy"));
        let text = format!(
            "agent Tank {{ state level: real [m] = 0, p: real [Pa] = {value}  flow {{ level' = 1 [m/s]  p' = 0 }}
               full: when level >= 5 [m] {{ level := 0 }} }}
             system {{ tank = Tank() }}  run {{ until 22 }}"
        );
        fs::write(&path, text).unwrap();
        let Some(said) = asked(&path, &[]) else { return };
        assert_eq!(said["errors"], serde_json::json!([]), "{value}: {said}");
        assert!(said["moved"].as_f64() > Some(50.0) && said["charts"] == 2, "{value}: {said}");
    }
}

/// Agents without states have their modes over time, each in a row.
#[test]
fn a_page_shows_modes_without_states() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("lamps.hy");
    let text =
        "agent L { initial mode Red { go: after 1 [s] -> Green }  mode Green { halt: after 2 [s] -> Red } }
        system { ls = L[12]() }  run { until 20 }";
    fs::write(&path, text).unwrap();
    let Some(said) = asked(&path, &[]) else { return };
    assert_eq!(said["errors"], serde_json::json!([]), "{said}");
    assert!(said["moved"].as_f64() > Some(50.0) && said["charts"] == 1, "{said}");
}

/// Where the mark of the only agent is, as a share of the plane's width, at two times.
const WHERE: &str = r##"
<script>
addEventListener("load", () => setTimeout(() => {
  const $ = id => document.getElementById(id), said = { at: [], errors };
  try {
    $("trails").click();
    for (const t of [10.01, 10.03]) {
      $("time").value = t; $("time").dispatchEvent(new Event("input"));
      const c = $("plane"), points = c.getContext("2d").getImageData(0, 0, c.width, c.height).data;
      let sum = 0, n = 0;
      for (let k = 0; k < points.length; k += 4) {
        if (points[k] === 0 && points[k + 1] === 0x72 && points[k + 2] === 0xb2) { sum += (k/4) % c.width; n++; }
      }
      said.at.push(sum/n/c.width);
    }
  } catch (error) { errors.push(String(error)); }
  document.body.innerHTML = "<pre id=verdict></pre>";
  $("verdict").textContent = JSON.stringify(said);
}, 100));
</script>
</body>"##;

/// A car that goes round is at the end of the road before its event and at the begin after it, never on the way back.
#[test]
fn a_reset_between_two_samples_is_a_jump() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("ring.hy");
    let text = "agent Car { state x: real [m] = 0, y: real [m] = 0  flow { x' = 9.98 [m/s]  y' = 0 [m/s] }
          wrap: when x >= 100 [m] { x := 0 } }
        system { c = Car() }  run { until 60 }";
    fs::write(&path, text).unwrap();
    let Some(said) = asked_for(&path, &[], WHERE) else { return };
    assert_eq!(said["errors"], serde_json::json!([]), "{said}");
    let at = |k: usize| said["at"][k].as_f64().unwrap();
    assert!(at(0) > 0.9 && at(1) < 0.1, "{said}");
}
