//! Does `hyc fmt` change blanks and line ends only, settle at once, and write what people like to read?

use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use hyc::base::FileId;
use hyc::syntax;

use crate::differential::dice::{Dice, WITH_AGGREGATES};
use crate::differential::generate;
use crate::robust::mutate::cut;

fn format(text: &str) -> String {
    syntax::format(FileId(0), text).unwrap_or_else(|errors| panic!("{text}\n{errors:?}"))
}

/// A text that is laid out has the same tree and the same comments, and stays as it is when it is laid out again.
pub fn assert_round_trip(text: &str) {
    let laid_out = format(text);
    assert!(syntax::same(text, &laid_out), "{text}\n----\n{laid_out}");
    assert_eq!(laid_out, format(&laid_out), "{text}");
    assert!(laid_out.lines().all(|line| line.trim_end_matches(' ') == line), "{laid_out}");
}

fn files(folder: &str, ending: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
    let paths = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let mut paths: Vec<PathBuf> = paths.filter(|path| path.to_string_lossy().ends_with(ending)).collect();
    paths.sort();
    paths
}

/// Every text in the documents that is read as a model.
fn samples() -> Vec<String> {
    let mut samples = Vec::new();
    for path in files("docs", ".md").into_iter().chain(files("", "README.md")) {
        let text = fs::read_to_string(path).unwrap();
        let fenced = text.split("\n```hy").skip(1).map(|rest| rest.split("\n```").next().unwrap());
        samples.extend(fenced.map(|fenced| fenced.split_once('\n').unwrap().1.to_string()));
    }
    samples.retain(|text| syntax::parse(FileId(0), text).is_ok());
    samples
}

fn models() -> Vec<String> {
    let paths = files("models", ".hy").into_iter().chain(files("src/cli", ".hy"));
    paths.map(|path| fs::read_to_string(path).unwrap()).collect()
}

#[test]
fn the_shipped_models_are_laid_out() {
    for text in models() {
        assert_eq!(text, format(&text));
        assert!(text.lines().all(|line| line.split("//").next().unwrap().chars().count() <= 100), "{text}");
    }
}

#[test]
fn samples_and_generated_models_keep_their_meaning() {
    let samples = samples();
    assert!(samples.len() >= 20);
    samples.iter().for_each(|text| assert_round_trip(text));
    for seed in (0..200).chain(WITH_AGGREGATES..WITH_AGGREGATES + 100) {
        assert_round_trip(&generate::model(seed));
    }
}

/// The text with blanks, empty lines, comments and `;` at random between its words.
fn scattered(dice: &mut Dice, text: &str) -> String {
    let blanks = [
        " ",
        "  ",
        "\t",
        "\n",
        "\n\n\n",
        " ;\n",
        " // c\n",
        "\n  // ä ∞ \r\n\n",
        "//\n//x\n",
        "\r\n",
        "\n\n// d\n\n",
    ];
    let mut scattered = String::new();
    for token in cut(text) {
        if dice.percent(8) {
            scattered.push_str(blanks[dice.below(blanks.len())]);
        }
        // Where a blank is, another may be.
        let blank = token.trim().is_empty() && dice.percent(15);
        scattered.push_str(if blank { blanks[dice.below(blanks.len())] } else { &token });
    }
    scattered
}

#[test]
fn comments_are_kept_wherever_they_stand() {
    let texts: Vec<String> = models().into_iter().chain(samples()).collect();
    let mut dice = Dice::new(7);
    let mut read = 0;
    for _ in 0..20 {
        for text in &texts {
            let text = scattered(&mut dice, text);
            // Within a number, a unit or a string nothing may stand.
            if syntax::parse(FileId(0), &text).is_ok() {
                read += 1;
                assert_round_trip(&text);
            }
        }
    }
    assert!(read > 300, "{read}");
}

#[test]
fn one_word_a_line_settles_at_once() {
    let mut read = 0;
    for text in models() {
        let words: Vec<String> = cut(&text).into_iter().filter(|token| !token.trim().is_empty()).collect();
        let mut unit = 0;
        let mut column = String::new();
        for (k, word) in words.iter().enumerate() {
            unit = if word == "[" { unit + 1 } else { unit };
            column.push_str(word);
            unit -= usize::from(word == "]");
            let joined =
                unit > 0 || word.starts_with("//") || words.get(k + 1).is_some_and(|next| next == "[");
            column.push_str(if joined && !word.starts_with("//") { " " } else { "\n" });
        }
        if syntax::parse(FileId(0), &column).is_ok() {
            read += 1;
            assert_round_trip(&column);
        }
    }
    assert!(read > 20, "{read}");
}

#[test]
fn ends_of_lines_and_of_the_file() {
    assert_eq!(format(""), "");
    assert_eq!(format("\n\n ; \n"), "");
    assert_eq!(format("// only this"), "// only this\n");
    assert_eq!(format("\n\n// a\n\n\n\n// b  \n\n"), "// a\n\n// b\n");
    assert_eq!(format("param a = 1"), "param a = 1\n");
    assert_eq!(
        format("\u{FEFF}param  a=1 // Größe\r\nparam b=2"),
        "param a = 1  // Größe\r\nparam b = 2\r\n"
    );
    assert_eq!(format("param a = 1 // x\n\n\n// y\n//z"), "param a = 1  // x\n\n// y\n//z\n");
}

const UNTIDY: &str = r#"
// a file
import   "a.hy"
param a:real[m/s]=-1;   param  b = (1+2)*-3^-a/ (4 - c [ 1 ])


fn f(a:Car,b:real=2):real=if(a.x>0)then not(a.y and b)else min( a.z , 3 )
agent Car(v:real [m/s],w:int=3){ state x=0,y ~ Uniform( 0,1 )   // a state
  // before the flow

  flow{x'=v y'=-x'}

  when x>=0{} // nothing
  mode A{ }
  initial mode Long { flow { x' = 0 y' = 0 } one: when x >= 1000000 and y <= 2000000 -> A { x := 0 y := 0 } }
  brake:   when x>= 1 -> A
  go: when x <= -1  ->A
  on ping( q )from lead when q>0 priority -1 -> A.history { x := q
      y := q }
  // at the end
}
system { cars=Car [ 3 ] ( v=1 , w=2 ) in A from csv("a.csv") car = Car() }
property p=always[0,5] x>0
run { until 3 [s] record cars,car.x every 1 to "x.csv" seed -1 stop when a is Car.A
}
"#;

#[test]
fn the_style() {
    insta::assert_snapshot!("untidy", format(UNTIDY));
    assert_round_trip(UNTIDY);
}

const LONG: &str = r#"
let total = first_summand*first_factor + second_summand*second_factor - third_summand*third_factor/divisor
let hypotenuse = sqrt((first_position_x - second_position_x)^2 + (first_position_y - second_position_y)^2 + softening)
let call = min(first_summand*first_factor, second_summand*second_factor, third_summand*third_factor/divisor_of_it)
let chosen = if position_of_it > boundary_of_all then velocity_of_the_first else if position_of_it < boundary_of_all then 3 else 4
agent Aircraft_with_a_long_name(first_parameter: real [m/s], second_parameter: real [km], third_parameter: int = 3) {
  state longitude: real [deg] = first_parameter, latitude: real [deg] = second_parameter, altitude: real [m] = 0
  link nearest_one = nearest other_one in other Aircraft_with_a_long_name where other_one.altitude > altitude by other_one.altitude - altitude
  assert nearest_one.altitude - altitude > third_parameter or altitude >= 100000 "the aircraft are too close to each other"
  leave: when altitude >= 100000 and longitude <= 20 or latitude >= 30 and altitude >= 100 and longitude >= 30 -> Left.Away { destroy self }
  mode Left { flow { altitude' = if nearest_one then 0.01 [1/s]*(nearest_one.altitude - altitude) else 0 [m/s] } stop_: when altitude <= 0 -> Right }
}
system { aircraft = Aircraft_with_a_long_name[3](first_parameter = 3, second_parameter = 4, third_parameter = index) in Left from csv("a_long_name.csv") }
property safe = always [0, 5] forall a in Aircraft_with_a_long_name: a.altitude >= 100 and a.longitude <= 20 and a.latitude > 0
run { until 30 [s]  record Aircraft_with_a_long_name.longitude, Aircraft_with_a_long_name.latitude every 1 [s] to "a_long_name.csv" }
"#;

#[test]
fn long_lines_are_broken() {
    let text = format(LONG);
    insta::assert_snapshot!("long", text);
    assert_round_trip(LONG);
    assert!(text.lines().all(|line| line.chars().count() <= 100), "{text}");
}

// ---- the command

fn hyc(folder: &Path, words: &[&str], input: &str) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_hyc"));
    command.args(words).current_dir(folder).stdin(Stdio::piped());
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    child.stdin.take().unwrap().write_all(input.as_bytes()).unwrap();
    child.wait_with_output().unwrap()
}

fn text(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes).unwrap()
}

#[test]
fn files_are_laid_out_in_their_places() {
    let folder = tempfile::tempdir().unwrap();
    let (untidy, tidy) = ("param a=1\n", "param a = 1\n");
    let path = |name: &str| folder.path().join(name);
    fs::write(path("untidy.hy"), untidy).unwrap();
    fs::write(path("tidy.hy"), tidy).unwrap();
    let checked = hyc(folder.path(), &["fmt", "--check", "tidy.hy", "untidy.hy"], "");
    assert_eq!((checked.status.code(), text(&checked.stdout)), (Some(1), "untidy.hy\n"));
    assert_eq!(fs::read_to_string(path("untidy.hy")).unwrap(), untidy);

    let before = fs::metadata(path("tidy.hy")).unwrap().modified().unwrap();
    let done = hyc(folder.path(), &["fmt", "tidy.hy", "untidy.hy"], "");
    assert_eq!((done.status.code(), text(&done.stdout), text(&done.stderr)), (Some(0), "", ""));
    assert_eq!(fs::read_to_string(path("untidy.hy")).unwrap(), tidy);
    assert_eq!(fs::metadata(path("tidy.hy")).unwrap().modified().unwrap(), before);
    let checked = hyc(folder.path(), &["fmt", "--check", "tidy.hy", "untidy.hy"], "");
    assert_eq!((checked.status.code(), text(&checked.stdout)), (Some(0), ""));
}

#[test]
fn standard_input_goes_to_standard_output() {
    let folder = tempfile::tempdir().unwrap();
    for words in [&["fmt"][..], &["fmt", "-"]] {
        let done = hyc(folder.path(), words, "param a=1 // one");
        assert_eq!((done.status.code(), text(&done.stdout)), (Some(0), "param a = 1  // one\n"));
    }
    let checked = hyc(folder.path(), &["fmt", "--check"], "param a=1");
    assert_eq!((checked.status.code(), text(&checked.stdout)), (Some(1), "-\n"));
}

#[test]
fn a_file_that_cannot_be_read_as_a_model_stays_as_it_is() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    fs::write(path("wrong.hy"), "param a=\n").unwrap();
    fs::write(path("untidy.hy"), "param a=1\n").unwrap();
    let done = hyc(folder.path(), &["fmt", "wrong.hy", "untidy.hy"], "");
    assert_eq!(done.status.code(), Some(1));
    assert!(text(&done.stderr).starts_with("error[HY01"), "{}", text(&done.stderr));
    assert_eq!(fs::read_to_string(path("wrong.hy")).unwrap(), "param a=\n");
    assert_eq!(fs::read_to_string(path("untidy.hy")).unwrap(), "param a = 1\n");
    let done = hyc(folder.path(), &["fmt", "missing.hy"], "");
    assert_eq!(done.status.code(), Some(2));
    assert!(text(&done.stderr).contains("cannot read `missing.hy`"), "{}", text(&done.stderr));
    let done = hyc(folder.path(), &["fmt", "-"], "agent A { // no end");
    assert_eq!((done.status.code(), text(&done.stdout)), (Some(1), ""));
}
