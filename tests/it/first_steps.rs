//! Can somebody begin who has the program and nothing else? New models, completions, manual pages, colours.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

fn hyc(folder: &Path, words: &[&str]) -> Output {
    plain(folder, words).output().unwrap()
}

/// The program in an environment that says nothing about colours.
fn plain(folder: &Path, words: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_hyc"));
    command.args(words).current_dir(folder);
    for name in ["NO_COLOR", "CLICOLOR", "CLICOLOR_FORCE"] {
        command.env_remove(name);
    }
    command
}

fn out(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).unwrap()
}

fn err(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

#[test]
fn a_new_model_runs_without_a_warning() {
    let folder = tempfile::tempdir().unwrap();
    let made = hyc(folder.path(), &["new", "robots"]);
    assert!(made.status.success(), "{}", err(&made));
    assert!(out(&made).contains("hyc run robots.hy"), "{}", out(&made));
    let text = fs::read_to_string(folder.path().join("robots.hy")).unwrap();
    assert!(text.starts_with("// robots.hy: ") && !text.contains("NAME"), "{text}");
    let check = hyc(folder.path(), &["check", "robots.hy", "--deny", "warnings"]);
    assert!(check.status.success(), "{}", err(&check));
    let run = hyc(folder.path(), &["run", "robots.hy"]);
    assert!(run.status.success() && err(&run).is_empty(), "{}", err(&run));
    let events = fs::read_to_string(folder.path().join("robots_events.csv")).unwrap();
    for label in ["Robot.left", "Robot.top", "Robot.rested", "Meet.pair"] {
        assert!(events.contains(label), "no {label} in {events}");
    }
}

#[test]
fn a_new_model_overwrites_nothing() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("mine.hy"), "mine").unwrap();
    let made = hyc(folder.path(), &["new", "mine.hy"]);
    assert_eq!(made.status.code(), Some(2));
    assert!(err(&made).contains("`mine.hy` is there already"), "{}", err(&made));
    assert_eq!(fs::read_to_string(folder.path().join("mine.hy")).unwrap(), "mine");
    for name in ["", "a/", ".", "..", "no/such/folder/x"] {
        assert_eq!(hyc(folder.path(), &["new", name]).status.code(), Some(2), "{name}");
    }
}

#[test]
fn what_is_to_be_typed_for_a_new_model_can_be_typed() {
    let folder = tempfile::tempdir().unwrap();
    let made = out(&hyc(folder.path(), &["new", "1 2"]));
    assert!(made.contains("hyc run '1 2.hy' ") && made.contains("hyc report '1 2.hy' "), "{made}");
}

#[test]
fn every_shell_gets_a_script_that_knows_the_commands() {
    let folder = tempfile::tempdir().unwrap();
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let script = out(&hyc(folder.path(), &["completions", shell]));
        for word in ["run", "explain", "integrator", "stage"] {
            assert!(script.contains(word), "{shell}: no {word}");
        }
    }
    let script = hyc(folder.path(), &["completions", "bash"]).stdout;
    fs::write(folder.path().join("hyc.bash"), script).unwrap();
    let ask = "source ./hyc.bash; COMP_WORDS=(hyc sho); COMP_CWORD=1; _hyc hyc sho hyc; echo ${COMPREPLY[@]}";
    match Command::new("bash").args(["-c", ask]).current_dir(folder.path()).output() {
        Ok(answer) => assert_eq!(out(&answer).trim(), "show", "{}", err(&answer)),
        Err(_) => eprintln!("skipped: there is no bash to ask"),
    }
}

#[test]
fn there_is_a_manual_page_for_the_program_and_for_each_command() {
    let folder = tempfile::tempdir().unwrap();
    let page = out(&hyc(folder.path(), &["man"]));
    assert!(page.contains(".TH hyc 1") && page.contains("Compile a model and simulate it"), "{page}");
    for command in ["run", "compare", "check", "show", "explain", "new", "completions", "man"] {
        let page = out(&hyc(folder.path(), &["man", command]));
        assert!(page.contains(&format!(".TH hyc-{command} 1")), "{page}");
        assert!(page.contains(".SH NAME") && page.contains(".SH OPTIONS"), "{page}");
    }
    let none = hyc(folder.path(), &["man", "sing"]);
    assert_eq!(none.status.code(), Some(2));
}

#[test]
fn colours_are_there_when_they_are_wanted_and_only_then() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("bad.hy"), "param x = y\n").unwrap();
    let coloured = |words: &[&str], set: &[(&str, &str)]| {
        let output = plain(folder.path(), words).envs(set.iter().copied()).output().unwrap();
        assert!(err(&output).contains("HY0201"));
        err(&output).contains('\x1b')
    };
    let check = ["check", "bad.hy"];
    // nobody reads at a terminal here
    assert!(!coloured(&check, &[]));
    assert!(coloured(&check, &[("CLICOLOR_FORCE", "1")]));
    assert!(!coloured(&check, &[("CLICOLOR_FORCE", "0")]));
    assert!(!coloured(&check, &[("CLICOLOR_FORCE", "1"), ("NO_COLOR", "1")]));
    assert!(coloured(&check, &[("CLICOLOR_FORCE", "1"), ("NO_COLOR", "")]));
    assert!(coloured(&["check", "bad.hy", "--color", "always"], &[("NO_COLOR", "1")]));
    assert!(!coloured(&["--color=never", "check", "bad.hy"], &[("CLICOLOR_FORCE", "1")]));
}

/// One firing is one event, however many rows it has in the log and however it is told.
#[test]
fn the_events_of_a_summary_are_the_sum_of_its_bars() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(
        folder.path().join("loop.hy"),
        "agent A { state x = 0  flow { x' = 1 }
           initial mode P { a: when x >= 1 -> Q }  mode Q { b: when x >= 1 -> P } }
         system { a = A() }  run { until 2 }",
    )
    .unwrap();
    hyc(folder.path(), &["new", "robots"]);
    for (model, code) in [("robots.hy", 0), ("loop.hy", 3)] {
        let words = ["run", model, "--stats", "s.json", "--events", "e.csv"];
        let run = hyc(folder.path(), &words);
        assert_eq!(run.status.code(), Some(code), "{}", err(&run));
        let stats: serde_json::Value =
            serde_json::from_str(&fs::read_to_string(folder.path().join("s.json")).unwrap()).unwrap();
        let sum = |name: &str, of: &dyn Fn(&serde_json::Value) -> u64| -> u64 {
            stats[name].as_object().unwrap().values().map(of).sum()
        };
        let events = stats["events"].as_u64().unwrap();
        assert_eq!(sum("transitions", &|count| count.as_u64().unwrap()), events);
        assert_eq!(sum("types", &|ty| ty["events"].as_u64().unwrap()), events);
        assert!(out(&run).contains(&format!(" {events} events,")), "{}", out(&run));
        let rows = fs::read_to_string(folder.path().join("e.csv")).unwrap().lines().count() as u64 - 1;
        if model == "robots.hy" {
            // both robots of a pair change their modes: two rows of one event, which is one event of each
            let pairs = stats["transitions"]["Meet.pair"].as_u64().unwrap();
            assert!(pairs > 0 && rows == events + pairs, "{rows} rows, {events} events, {pairs} pairs");
            assert_eq!(sum("busiest_agents", &|count| count.as_u64().unwrap()), events + pairs);
        } else {
            assert_eq!((rows, events), (2000, 2000));
        }
    }
}

/// Every step is some agent's: where few have lived, those who are told took them all.
#[test]
fn the_slowest_agents_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let run = |text: &str, words: &[&str]| {
        fs::write(folder.path().join("a.hy"), text).unwrap();
        let run = hyc(folder.path(), &[&["run", "a.hy", "--stats", "s.json"], words].concat());
        let stats: serde_json::Value =
            serde_json::from_str(&fs::read_to_string(folder.path().join("s.json")).unwrap()).unwrap();
        (out(&run), stats)
    };
    let hard = "agent A(w: real) { state x = 1, v = 0  flow { x' = v  v' = -w*w*x } }
        system { slow = A[29](w = 1)  hard = A(w = 2000) }  run { until 10 }";
    let (said, stats) = run(hard, &[]);
    assert!(said.contains("  slowest    hard ("), "{said}");
    let slowest = stats["slowest_agents"].as_object().unwrap();
    assert!(
        slowest.len() == 8 && slowest["hard"].as_u64().unwrap() * 10 > 9 * stats["steps"].as_u64().unwrap()
    );
    // all alike: nobody is slow
    let (said, _) = run(&hard.replace("2000", "1"), &[]);
    assert!(!said.contains("slowest"), "{said}");
    // alone, coupled, stiff, in changing modes, born and dead
    let lives = "agent A(w: real) { state x = 1, v = 0  flow { x' = v }
          initial mode P { flow { v' = -w*w*x }  a: when x <= -0.5 -> Q }  mode Q { flow { v' = -2*w*w*x }  b: when x >= 0.5 -> P } }
        agent C(o: A) { state y = 0  flow { y' = 100*(o.x - y) } }
        agent S { discrete n: int = 0  spawn: every 3 when n < 2 { n := n + 1  create B() } }
        agent B { state z = 0  flow { z' = cos(z) }  end: when z >= 1 { destroy self } }
        system { a = A(w = 3)  d = A(w = 5)  c = C(o = a)  s = S() }  run { until 20 }";
    for words in [
        &["--integrator", "auto"][..],
        &["--integrator", "tsit5"],
        &["--algorithm", "masim-plain"],
        &["-j", "2"],
    ] {
        let (_, stats) = run(lives, words);
        let slowest = stats["slowest_agents"].as_object().unwrap();
        let sum: u64 = slowest.values().map(|steps| steps.as_u64().unwrap()).sum();
        assert_eq!(Some(sum), stats["steps"].as_u64(), "{words:?}: {slowest:?}");
        assert!(slowest.keys().any(|name| name.starts_with("B#")), "{slowest:?}");
    }
}
