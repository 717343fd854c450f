//! Do warnings reach people and programs as they should? The real binary: levels, comments, summaries, SARIF.

use std::fs;
use std::process::Command;

use serde_json::Value;
use tempfile::TempDir;

/// Two warnings: HY0601 on line 1, HY0604 on line 5.
const WARNED: &str = "\
param spare = 3
agent A {
  state x = 0
  initial mode M { flow { x' = 1 }  top: when x >= 2 { x := 0 } }
  mode N { flow { x' = 0 } }
}
system { a = A() }
run { until 5 }
";

fn folder(text: &str) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("model.hy"), text).unwrap();
    folder
}

/// Exit code, standard output, standard error.
fn hyc(folder: &TempDir, words: &[&str]) -> (i32, String, String) {
    let output =
        Command::new(env!("CARGO_BIN_EXE_hyc")).args(words).current_dir(folder.path()).output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    (output.status.code().unwrap(), text(output.stdout), text(output.stderr))
}

#[test]
fn warnings_are_shown_and_counted() {
    let folder = folder(WARNED);
    let (code, out, err) = hyc(&folder, &["check", "model.hy"]);
    assert_eq!((code, out.as_str()), (0, "model.hy: no errors, 2 warnings\n"));
    assert!(err.contains("warning[HY0601]") && err.contains("model.hy:1:7"), "{err}");
    assert!(err.contains("warning[HY0604]") && err.contains("model.hy:5:8"), "{err}");
}

#[test]
fn denied_warnings_are_errors() {
    let folder = folder(WARNED);
    let (code, out, err) = hyc(&folder, &["check", "--deny", "warnings", "model.hy"]);
    assert_eq!((code, out.as_str()), (1, ""));
    assert!(err.contains("error[HY0601]") && err.contains("error[HY0604]"), "{err}");
    assert!(err.ends_with("model.hy: 2 errors\n"), "{err}");
    let (code, out, err) = hyc(&folder, &["check", "--deny", "hy0604", "model.hy"]);
    assert_eq!((code, out.as_str()), (1, ""));
    assert!(err.contains("warning[HY0601]") && err.contains("error[HY0604]"), "{err}");
    assert!(err.ends_with("model.hy: 1 error, 1 warning\n"), "{err}");
    let (code, ..) = hyc(&folder, &["check", "--deny", "HY0602", "model.hy"]);
    assert_eq!(code, 0);
    let clean = self::folder(&WARNED.replace("param spare = 3", "").replace("mode N", "mode _N"));
    let (code, out, err) = hyc(&clean, &["check", "--deny", "warnings", "model.hy"]);
    assert_eq!((code, out.as_str(), err.as_str()), (0, "model.hy: no errors\n", ""));
}

#[test]
fn allowed_warnings_are_not_shown() {
    let folder = folder(WARNED);
    let words = ["check", "model.hy", "--deny", "warnings", "--allow", "HY0601", "--allow", "HY0604"];
    let (code, out, err) = hyc(&folder, &words);
    assert_eq!((code, out.as_str(), err.as_str()), (0, "model.hy: no errors\n", ""));
    let (.., err) = hyc(&folder, &["check", "model.hy", "--allow", "HY0601"]);
    assert!(!err.contains("HY0601") && err.contains("HY0604"), "{err}");
}

#[test]
fn a_comment_allows_a_warning_where_it_stands() {
    let cases = [
        ("param spare = 3", "param spare = 3  // for later: allow HY0601", false),
        ("param spare = 3", "// allow HY0604, HY0601\nparam spare = 3", false),
        ("param spare = 3", "// allow HY0604\nparam spare = 3", true),
        ("param spare = 3", "// allow HY0601\n\nparam spare = 3", true),
        ("param spare = 3", "// HY0601\nparam spare = 3", true),
    ];
    for (from, to, shown) in cases {
        let folder = folder(&WARNED.replace(from, to));
        let (.., err) = hyc(&folder, &["check", "model.hy"]);
        assert_eq!(err.contains("HY0601"), shown, "{to}: {err}");
        assert!(err.contains("HY0604"));
    }
}

#[test]
fn a_run_warns_unless_it_is_quiet() {
    let folder = folder(WARNED);
    let (code, _, err) = hyc(&folder, &["run", "model.hy"]);
    assert_eq!(code, 0);
    assert!(err.contains("warning[HY0601]") && err.contains("warning[HY0604]"), "{err}");
    let (code, out, err) = hyc(&folder, &["run", "-q", "model.hy"]);
    assert_eq!((code, out.as_str(), err.as_str()), (0, "", ""));
    let (.., err) = hyc(&folder, &["run", "model.hy", "--allow", "HY0604"]);
    assert!(err.contains("warning[HY0601]") && !err.contains("HY0604"), "{err}");
}

#[test]
fn json_has_the_warnings_too() {
    let folder = folder(WARNED);
    let (code, out, err) = hyc(&folder, &["check", "model.hy", "--format", "json"]);
    assert_eq!((code, err.as_str()), (0, ""));
    let log: Value = serde_json::from_str(&out).unwrap();
    let found = log["models"][0]["diagnostics"].as_array().unwrap();
    assert_eq!(found.len(), 2);
    assert_eq!((&found[0]["code"], &found[0]["severity"]), (&"HY0601".into(), &"warning".into()));
    assert_eq!(log["models"][0]["ok"], true);
    let (code, out, _) = hyc(&folder, &["check", "model.hy", "--format", "json", "--deny", "HY0601"]);
    let log: Value = serde_json::from_str(&out).unwrap();
    assert_eq!((code, &log["models"][0]["ok"]), (1, &false.into()));
}

/// Fails unless this is an object with exactly these properties, the optional ones aside.
#[track_caller]
fn has(value: &Value, required: &[&str], optional: &[&str]) {
    let object = value.as_object().unwrap_or_else(|| panic!("no object: {value}"));
    let missing: Vec<_> = required.iter().filter(|name| !object.contains_key(**name)).collect();
    let known = |name: &str| required.contains(&name) || optional.contains(&name);
    let unknown: Vec<_> = object.keys().filter(|name| !known(name)).collect();
    assert!(missing.is_empty() && unknown.is_empty(), "missing {missing:?}, unknown {unknown:?}: {value}");
}

/// A `message`: one with a text that says something.
#[track_caller]
fn is_message(value: &Value) {
    has(value, &["text"], &["markdown"]);
    assert!(!value["text"].as_str().unwrap().trim().is_empty());
}

/// A `location` in one of the files; returns first line and column, last line and column.
#[track_caller]
fn is_location(value: &Value, files: &[&str]) -> [u64; 4] {
    has(value, &["physicalLocation"], &["message"]);
    let place = &value["physicalLocation"];
    has(place, &["artifactLocation", "region"], &[]);
    has(&place["artifactLocation"], &["uri"], &[]);
    let uri = place["artifactLocation"]["uri"].as_str().unwrap();
    assert!(files.contains(&uri), "{uri}");
    assert!(uri.bytes().all(|byte| byte.is_ascii_graphic()), "{uri}");
    let names = ["startLine", "startColumn", "endLine", "endColumn"];
    has(&place["region"], &names, &[]);
    let region = names.map(|name| place["region"][name].as_u64().unwrap());
    assert!(region.iter().all(|number| *number >= 1), "{region:?} counts from 1");
    assert!((region[0], region[1]) <= (region[2], region[3]), "{region:?} ends before it begins");
    if let Some(message) = value.get("message") {
        is_message(message);
    }
    region
}

/// What SARIF 2.1.0 asks of a log (sections 3.13, 3.14, 3.18, 3.19, 3.27, 3.28, 3.49), as far as there is any of it here.
#[track_caller]
fn is_sarif(log: &Value, files: &[&str]) {
    has(log, &["version", "runs"], &["$schema"]);
    assert_eq!(log["version"], "2.1.0");
    let runs = log["runs"].as_array().unwrap();
    assert_eq!(runs.len(), 1);
    has(&runs[0], &["tool", "results"], &["columnKind"]);
    assert_eq!(runs[0]["columnKind"], "unicodeCodePoints");
    has(&runs[0]["tool"], &["driver"], &[]);
    let driver = &runs[0]["tool"]["driver"];
    has(driver, &["name", "version", "rules"], &["informationUri"]);
    let rules = driver["rules"].as_array().unwrap();
    for rule in rules {
        has(rule, &["id", "shortDescription", "help"], &["defaultConfiguration"]);
        is_message(&rule["shortDescription"]);
        is_message(&rule["help"]);
    }
    let mut ids: Vec<_> = rules.iter().map(|rule| rule["id"].as_str().unwrap()).collect();
    let n_rules = ids.len();
    ids.sort_unstable();
    ids.dedup();
    assert_eq!(ids.len(), n_rules, "each rule once");
    for result in runs[0]["results"].as_array().unwrap() {
        has(result, &["ruleId", "level", "message", "locations"], &["ruleIndex", "relatedLocations"]);
        assert!(["error", "warning", "note"].contains(&result["level"].as_str().unwrap()));
        is_message(&result["message"]);
        let index = usize::try_from(result["ruleIndex"].as_u64().unwrap()).unwrap();
        assert_eq!(rules[index]["id"], result["ruleId"]);
        let locations = result["locations"].as_array().unwrap();
        assert_eq!(locations.len(), 1);
        let related = result.get("relatedLocations").map_or(&[][..], |places| places.as_array().unwrap());
        for place in locations.iter().chain(related) {
            is_location(place, files);
        }
    }
}

#[test]
fn sarif_is_sarif() {
    let folder = folder(WARNED);
    fs::write(folder.path().join("näher dran.hy"), "agent A { state x = 0, x = 1  flow { x' = y } }\n")
        .unwrap();
    let (code, out, err) = hyc(&folder, &["check", "model.hy", "näher dran.hy", "--format", "sarif"]);
    assert_eq!((code, err.as_str()), (1, ""));
    let log: Value = serde_json::from_str(&out).unwrap();
    is_sarif(&log, &["model.hy", "n%C3%A4her%20dran.hy"]);
    let results = log["runs"][0]["results"].as_array().unwrap();
    let first = &results[0];
    assert_eq!((&first["ruleId"], &first["level"]), (&"HY0601".into(), &"warning".into()));
    assert_eq!(is_location(&first["locations"][0], &["model.hy"]), [1, 7, 1, 12]);
    let twice = results.iter().find(|result| result["ruleId"] == "HY0205").unwrap();
    assert_eq!(twice["level"], "error");
    assert_eq!(is_location(&twice["locations"][0], &["n%C3%A4her%20dran.hy"]), [1, 24, 1, 25]);
    assert_eq!(is_location(&twice["relatedLocations"][0], &["n%C3%A4her%20dran.hy"]), [1, 17, 1, 18]);
    let help = |result: &Value| {
        let index = usize::try_from(result["ruleIndex"].as_u64().unwrap()).unwrap();
        log["runs"][0]["tool"]["driver"]["rules"][index]["help"]["text"].as_str().unwrap().to_string()
    };
    assert!(help(first).contains("```hy"), "the help has the examples");
}

#[test]
fn sarif_of_nothing_is_sarif_and_denied_warnings_are_errors_there() {
    let folder = folder("agent A { state x = 0  flow { x' = 1 } }\n");
    let (code, out, _) = hyc(&folder, &["check", "model.hy", "--format", "sarif"]);
    let log: Value = serde_json::from_str(&out).unwrap();
    is_sarif(&log, &[]);
    assert_eq!((code, log["runs"][0]["results"].as_array().unwrap().len()), (0, 0));
    fs::write(folder.path().join("model.hy"), WARNED).unwrap();
    let path = folder.path().join("model.hy").display().to_string();
    let (code, out, _) = hyc(&folder, &["check", &path, "--format", "sarif", "--deny", "warnings"]);
    let log: Value = serde_json::from_str(&out).unwrap();
    is_sarif(&log, &[format!("file://{path}").as_str()]);
    assert_eq!((code, &log["runs"][0]["results"][0]["level"]), (1, &"error".into()));
}
